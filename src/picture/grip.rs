//! Marks on nodes that grips hold or drag.

use super::layout::{Rectangle, Scale};
use super::pointer::{Going, Pointers};
use super::skin::Skin;
use super::{Mark, MarkShape};
use crate::look::Palette;
use crate::sim::{Grip, Motion};
use glam::DVec3;

/// Half the width of a pin, and of the ring around a dragged node (px in the reference picture), in space and in the
/// plane, where nodes are discs.
const PIN: [f64; 2] = [6.5, 9.0];
const HAND: [f64; 2] = [9.5, 12.0];
/// More dragged nodes than this are marked like held ones; the arrow shows their motion.
const FEW: usize = 4;
/// The largest width of a mark in lengths of an element, and its least width (px).
const SHARE: f64 = 0.45;
const NARROWEST: f64 = 3.0;
/// The opacity of the mark of a hidden node.
const HIDDEN: f64 = 0.38;

/// The data for marking the nodes of one panel.
pub(super) struct Hands<'a> {
    pub(super) grips: &'a [Grip],
    /// The time of the panel's state (s).
    pub(super) time: f64,
    /// The time between two frames (s).
    pub(super) frame: f64,
    /// The nodes (m).
    pub(super) position: &'a [DVec3],
    pub(super) skin: &'a Skin,
    /// Length of an element's edge (px).
    pub(super) element: f64,
    pub(super) viewport: Rectangle,
    pub(super) scale: Scale,
    pub(super) palette: &'a Palette,
    pub(super) pointers: &'a Pointers<'a>,
}

impl Hands<'_> {
    /// Marks all nodes that are held at the panel's time.
    pub(super) fn draw(&self, marks: &mut Vec<Mark>) {
        let held: Vec<_> = self.grips.iter().filter(|grip| grip.holds(self.time)).collect();
        if held.is_empty() || self.position.is_empty() {
            return;
        }
        let visible = self.skin.visible(self.position, self.pointers.lens);
        for grip in held {
            let nodes = || grip.nodes.iter().filter(|&&node| (node as usize) < self.position.len());
            let dragged = grip.motion != Motion::Still;
            for &node in nodes() {
                let ringed = dragged && grip.nodes.len() <= FEW;
                let opacity = HIDDEN + (1.0 - HIDDEN) * visible[node as usize];
                self.mark(self.position[node as usize], opacity, ringed, marks);
            }
            if dragged {
                let points: Vec<_> = nodes().map(|&node| self.position[node as usize]).collect();
                let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
                let gap = HAND[usize::from(self.pointers.lens.orthographic)] + 3.0;
                self.pointers.draw(middle, self.going(grip), false, gap, marks);
            }
        }
    }

    /// The motion of the middle of dragged nodes.
    fn going(&self, grip: &Grip) -> Going {
        let half = 0.25 * self.frame;
        let shift = |time: f64| grip.motion.pose(time.clamp(grip.from, grip.until)).shift;
        let [before, after] = [self.time - half, self.time + half].map(shift);
        Going { velocity: (after - before) / (2.0 * half), greatest: grip.motion.greatest_speed(0.0) }
    }

    fn mark(&self, point: DVec3, opacity: f64, ringed: bool, marks: &mut Vec<Mark>) {
        let sizes = if ringed { HAND } else { PIN };
        let flat = self.pointers.lens.orthographic;
        let radius = (sizes[usize::from(flat)] * self.scale.line()).min(SHARE * self.element);
        let Some((pixel, _)) = self.pointers.lens.project(point).filter(|_| radius >= NARROWEST / 2.0) else { return };
        let [left, top, width, height] = self.viewport.map(f64::from);
        let inside = |at: f64, low: f64, length: f64| (low + radius..=low + length - radius).contains(&at);
        if !inside(pixel[0], left, width) || !inside(pixel[1], top, height) {
            return;
        }
        let shape = if ringed { MarkShape::Hand } else { MarkShape::Pin };
        let whole = Mark::around(pixel.into(), radius, shape, self.palette.pointer);
        marks.extend(Mark { second: self.palette.background, ..whole }.faded(opacity));
    }
}
