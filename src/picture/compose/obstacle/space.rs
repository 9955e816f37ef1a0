//! All obstacles of a panel.

use super::Staged;
use super::half_space::HalfSpace;
use super::shapes::{corners, rod};
use crate::look::Palette;
use crate::picture::Obstacles;
use crate::picture::compose::draft::Draft;
use crate::picture::compose::skin::Skin;
use crate::picture::shell::{boundaries, triangles};
use crate::sim::{Shape, geometry};
use glam::DVec3;

/// Draws the obstacles of one panel.
pub(in crate::picture) struct Staging<'a> {
    pub(super) draft: &'a Draft<'a>,
    /// The floor that is drawn as ground.
    pub(super) ground: Option<HalfSpace>,
    /// The surface of the body; `None` if it is not drawn.
    pub(super) skin: Option<&'a Skin>,
    /// The triangles of nodes that are left of it, if elements are broken.
    pub(super) left: Option<Vec<[u32; 3]>>,
}

impl<'a> Staging<'a> {
    /// The obstacles of a panel.
    pub(in crate::picture) fn new(draft: &'a Draft<'a>) -> Self {
        let Draft { scene, body, bodies, snapshot, .. } = *draft;
        let broken = &snapshot.broken;
        let left = || triangles(body, &boundaries(body, &[], broken)[0]);
        Self {
            draft,
            ground: geometry::ground(&scene.obstacles, snapshot.time),
            skin: (scene.view.visible.surfaces && !draft.diverged).then(|| bodies.cage()),
            left: broken.contains(&true).then(left),
        }
    }

    /// The time of the panel's state (s).
    pub(super) fn time(&self) -> f64 {
        self.draft.snapshot.time
    }

    /// The size of the body (m).
    pub(super) fn extent(&self) -> f64 {
        self.draft.composer.extent
    }

    /// Unit of soft distances (m).
    pub(super) fn soft(&self) -> f64 {
        self.draft.bodies.soft * self.draft.side
    }

    /// The colours, also of a run that has diverged.
    pub(super) fn palette(&self) -> &Palette {
        &self.draft.composer.palette
    }

    /// All obstacles but the ground.
    pub(in crate::picture) fn draw(&self) -> (Obstacles, Staged) {
        if self.draft.lens.orthographic {
            return self.flat();
        }
        let (mut staged, mut slabs) = (Staged::default(), Vec::new());
        let floors: Vec<_> = self.draft.scene.obstacles.iter().map(|obstacle| obstacle.floor(self.time())).collect();
        for (at, obstacle) in self.draft.scene.obstacles.iter().enumerate() {
            let pose = obstacle.pose(self.time());
            match obstacle.shape {
                Shape::Floor { normal, .. } => {
                    let Some(floor) = floors[at] else { continue };
                    if self.ground == Some(floor) {
                        continue;
                    }
                    let others = floors.iter().enumerate().filter(|&(other, _)| other != at);
                    let others: Vec<_> = others.filter_map(|(_, floor)| *floor).collect();
                    slabs.extend(self.wall(at, normal, floor, &others));
                }
                Shape::Plate { normal, .. } => {
                    let floors: Vec<_> = floors.iter().flatten().copied().collect();
                    slabs.extend(self.plate(at, &pose, normal, &floors));
                }
                Shape::Sphere { centre, radius } => {
                    let centre = pose.apply(centre, centre);
                    let shape = |segments| self.ball(centre, radius, segments);
                    self.round(shape, radius, centre, &mut staged);
                }
                Shape::Capsule { from, to, radius } => {
                    let ends = [from, to].map(|end| pose.apply(obstacle.pivot, end));
                    let shape = |segments| rod(ends, radius, segments);
                    let middle = ends[0].midpoint(ends[1]);
                    self.round(shape, radius, middle, &mut staged);
                }
                Shape::Box { centre, half, rotation } => {
                    let axes = DVec3::AXES.map(|axis| pose.rotation * (rotation * axis));
                    let corners = corners(pose.apply(centre, centre), axes, half);
                    self.block(&corners, axes, &mut staged);
                }
            }
        }
        let edges = slabs.iter().flat_map(|slab| slab.edges.iter().copied()).collect();
        let panes = self.in_order(slabs);
        let solids = std::mem::take(&mut staged.solids);
        (Obstacles { solids, panes, edges, occluders: self.occluders(), fade: None }, staged)
    }
}
