//! All obstacles of a panel.

use super::half_space::HalfSpace;
use super::shapes::{corners, rod};
use super::{Site, Staged};
use crate::picture::skin::Skin;
use crate::picture::{Line, Obstacles};
use crate::runner::history::NearObstacles;
use crate::sim::Shape;
use glam::DVec3;

/// The data for the obstacles of one panel.
pub(in crate::picture) struct Staging<'a> {
    pub(in crate::picture) site: Site<'a>,
    /// Distance of the grid's lines (sides).
    pub(in crate::picture) cell: f64,
    /// The floor that is drawn as ground.
    pub(in crate::picture) ground: Option<HalfSpace>,
    /// The nodes now (m).
    pub(in crate::picture) position: &'a [DVec3],
    /// The surface of the body; `None` if it is not drawn.
    pub(in crate::picture) skin: Option<&'a Skin>,
    /// The triangles of nodes that are left of it, if elements are broken.
    pub(in crate::picture) left: Option<Vec<[u32; 3]>>,
    /// The width of rims in the plane (m).
    pub(in crate::picture) rim: f64,
    /// Unit of soft distances (m).
    pub(in crate::picture) soft: f64,
    /// The box around the nodes at the start (m).
    pub(in crate::picture) start: [DVec3; 2],
    /// The places where nodes of all runs come near plates and walls at any time.
    pub(in crate::picture) reach: &'a NearObstacles,
}

impl Staging<'_> {
    /// All obstacles but the ground.
    pub(in crate::picture) fn draw(&self, lines: &mut Vec<Line>) -> (Obstacles, Staged) {
        if self.site.lens.orthographic {
            return self.flat();
        }
        let (mut solids, mut staged, mut slabs) = (Vec::new(), Staged::default(), Vec::new());
        let floors: Vec<_> = self.site.obstacles.iter().map(|obstacle| obstacle.floor(self.site.time)).collect();
        for (at, obstacle) in self.site.obstacles.iter().enumerate() {
            let pose = obstacle.pose(self.site.time);
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
                    self.round(shape, radius, centre, &mut solids, lines, &mut staged);
                }
                Shape::Capsule { from, to, radius } => {
                    let ends = [from, to].map(|end| pose.apply(obstacle.pivot, end));
                    let shape = |segments| rod(ends, radius, segments);
                    let middle = ends[0].midpoint(ends[1]);
                    self.round(shape, radius, middle, &mut solids, lines, &mut staged);
                }
                Shape::Box { centre, half, rotation } => {
                    let axes = DVec3::AXES.map(|axis| pose.rotation * (rotation * axis));
                    let corners = corners(pose.apply(centre, centre), axes, half);
                    self.block(&corners, axes, &mut solids, lines, &mut staged);
                }
            }
        }
        let edges = slabs.iter().flat_map(|slab| slab.edges.iter().copied()).collect();
        let panes = self.in_order(slabs);
        (Obstacles { solids, panes, edges, occluders: self.occluders(), fade: None }, staged)
    }
}
