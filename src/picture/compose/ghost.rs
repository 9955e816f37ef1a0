//! The outline of another state over the body of a panel.

use super::Composer;
use super::draft::Draft;
use crate::colour::Colour;
use crate::look::Ghost;
use crate::picture::Item;
use crate::picture::ghost;
use crate::picture::layout::Rectangle;
use crate::picture::layout::steps::{STRONG, TICK};
use crate::picture::narrow::narrow;
use crate::picture::page::Pen;
use crate::runner::RunFrame;
use crate::sim::Status;
use glam::DVec3;

/// The opacity of the casing of outlines.
const HALO_ALPHA: f64 = 0.65;

impl Composer<'_> {
    /// The name and the colour of the scene's ghosts, if it has any.
    pub(super) fn ghost(&self) -> Option<(&str, Colour)> {
        Some(match self.scene.view.ghost? {
            Ghost::Rest => ("rest shape, best fit", self.palette.second_text),
            Ghost::Run(run) => (&self.scene.runs[run].name, self.scene.runs[run].line(&self.palette).colour),
        })
    }
}

impl Draft<'_> {
    /// The ghost of the scene, inside a part of the picture. `others` are runs at the same moment.
    pub(super) fn ghost(&self, others: &[RunFrame], room: Rectangle, curves: &mut Vec<Item>) {
        let Some((_, colour)) = self.composer.ghost() else { return };
        match self.scene.view.ghost {
            Some(Ghost::Rest) => {
                let bodies = &self.scene.runs[self.run.run].bodies;
                self.outline(&bodies.placed(&self.run.snapshot.placements), colour, room, curves);
            }
            Some(Ghost::Run(run)) if run != self.run.run => {
                let other = others.iter().find(|other| other.run == run);
                if let Some(other) = other.filter(|other| other.snapshot.status == Status::Ok) {
                    self.outline(&other.snapshot.position, colour, room, curves);
                }
            }
            _ => {}
        }
    }

    /// The outline of the body with its nodes at other positions (m).
    pub(super) fn outline(&self, position: &[DVec3], colour: Colour, room: Rectangle, curves: &mut Vec<Item>) {
        if self.diverged || position.len() != self.body.len() {
            return;
        }
        let skin = &self.bodies.skin;
        let node = |at: u32| skin.nodes[at as usize];
        let mut triangles: Vec<_> = skin.triangles.iter().map(|corners| corners.map(node)).collect();
        // All nodes, and after them the points of carried surfaces.
        let mut points = position.to_vec();
        for fine in &skin.fine {
            let first = points.len() as u32;
            triangles.extend(fine.surface.triangles.iter().map(|triangle| triangle.map(|point| first + point)));
            fine.place(position, &mut points);
        }
        let pixels = points.iter().map(|&at| self.pixel(at)).collect::<Option<Vec<_>>>();
        let Some(pixels) = pixels else { return };
        let bars = self.bodies.bare.iter().flat_map(|&element| self.body.topology().edges_of(element));
        let path = ghost::outline(&pixels, &triangles, &bars.collect::<Vec<_>>(), self.around(room));
        let [width, halo] = [STRONG, TICK].map(|width| narrow(width * self.scale.line()));
        let dash = ghost::DASH.map(|length| narrow(length * self.scale.line())).to_vec();
        let casing = Item::stroke(path.clone(), Pen::solid(halo), (self.composer.palette.background, HALO_ALPHA));
        let line = Item::stroke(path, Pen { dash, round: false, width }, colour);
        curves.push(Item::inside(room, vec![casing, line]));
    }
}
