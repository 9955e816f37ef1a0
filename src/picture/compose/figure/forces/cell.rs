//! The cells of a diagram of forces: their contents, and the places of their bodies.

use crate::picture::camera::{Framing, Lens};
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::layout::tree::Place;
use crate::picture::layout::{Scale, whole};
use crate::runner::RunFrame;
use crate::runner::moments;
use glam::{DVec2, DVec3};

/// The contents of one cell.
pub(super) struct Cell<'a> {
    pub(super) composer: &'a Composer<'a>,
    pub(super) frame: RunFrame,
    /// The force on each node over the stiffness (m): its arrow.
    pub(super) ways: Vec<DVec3>,
    /// The arrows of the run for comparison, with its index.
    pub(super) compared: Option<(usize, Vec<DVec3>)>,
    /// The nodes of the rest shape in its best fit (m), drawn faintly behind the body.
    pub(super) ghost: Vec<DVec3>,
    /// The camera of the scene, turned to the middle of the body.
    framing: Framing,
}

impl<'a> Cell<'a> {
    pub(super) fn new(
        composer: &'a Composer<'a>,
        runs: &[moments::RunForces],
        run: usize,
        compare: Option<usize>,
    ) -> Self {
        let scene = composer.scene;
        let snapshot = runs[run].snapshot.clone();
        let ways = |run: usize| {
            let on_nodes = &runs[run].on_nodes;
            let run = &scene.runs[run];
            let of_bodies: Vec<_> =
                run.models_and_bodies().map(|(model, body)| model.properties(body).stiffness).collect();
            let stiffness = |node: usize| of_bodies[run.bodies.body_of_node(node)];
            let forces = on_nodes.iter().enumerate();
            forces.map(|(node, &force)| force / stiffness(node)).collect::<Vec<_>>()
        };
        let middle = snapshot.position.iter().sum::<DVec3>() / snapshot.position.len().max(1) as f64;
        Self {
            composer,
            ways: ways(run),
            compared: compare.map(|run| (run, ways(run))),
            ghost: scene.runs[run].bodies.placed(&snapshot.placements),
            framing: Framing { target: middle, ..Framing::still(&scene.view.camera) },
            frame: RunFrame::new(run, snapshot),
        }
    }

    /// The middle of the nodes (m).
    pub(super) fn middle(&self) -> DVec3 {
        self.framing.target
    }

    /// The box around the contents, seen from far away: to the right and up from the middle of the body (m).
    pub(super) fn extent(&self) -> [DVec2; 2] {
        let (scene, position) = (self.composer.scene, &self.frame.snapshot.position);
        let lens = Lens::new(&scene.view, &self.framing, scene.dimension(), [0.0, 0.0, 64.0, 64.0], 1.0);
        let ways = self.compared.iter().map(|(_, ways)| ways).chain([&self.ways]);
        let tips = ways.flat_map(|ways| position.iter().zip(ways).map(|(&at, &way)| at + way));
        let all = position.iter().chain(&self.ghost).copied().chain(tips);
        let seen = all.map(|at| DVec2::from([lens.right, lens.up].map(|axis| (at - self.middle()).dot(axis))));
        seen.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    }

    /// The cell as a panel at a place, seen at a scale (px/m) with the middle of its body at a pixel.
    pub(super) fn draft(&self, place: Place, scale: Scale, pixels: f64, centre: DVec2) -> Draft<'_> {
        let mut draft = Draft::new(self.composer, whole(place), &self.frame, &self.framing, scale);
        let lens = &mut draft.lens;
        lens.focal = if lens.orthographic { pixels } else { pixels * self.framing.distance };
        lens.centre = centre.to_array();
        draft.element = pixels * draft.side;
        draft
    }
}
