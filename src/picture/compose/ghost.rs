//! The outline of another state over the body of a panel.

use super::Composer;
use super::draft::Draft;
use crate::colour::Colour;
use crate::look::Ghost;
use crate::picture::Item;
use crate::picture::ghost;
use crate::picture::layout::Rectangle;
use crate::sim::{RunFrame, Status};
use glam::DVec3;

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
                let placement = &self.run.snapshot.placement;
                let position: Vec<_> = self.body.rest.iter().map(|&rest| placement.place(rest)).collect();
                self.outline(&position, colour, room, curves);
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
        let skin = &self.composer.skin;
        let bars = self.composer.bare.iter().flat_map(|&element| self.body.topology().edges_of(element));
        let bars: Vec<_> = bars.collect();
        let ghost = ghost::Ghost {
            lens: &self.lens,
            position,
            nodes: &skin.nodes,
            triangles: &skin.triangles,
            bars: &bars,
            room,
        };
        ghost.draw(self.scale, colour, self.composer.palette.background, curves);
    }
}
