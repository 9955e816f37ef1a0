//! Marks on nodes that grips hold or drag.

use crate::picture::compose::draft::Draft;
use crate::picture::layout::steps::{CLOSE, FREE, RING, THIN};
use crate::picture::narrow::narrow;
use crate::picture::page::{self, Path};
use crate::picture::{Colour, Item};
use crate::sim::{Grip, Motion};
use glam::{DVec3, Vec2};

/// Half the width of a mark (px in the reference picture), in space and in the plane, where nodes are discs.
const PIN: [f64; 2] = [CLOSE, RING];
/// The largest half width of a mark in lengths of an element.
const SHARE: f64 = 0.45;
/// The opacity of its halo, and its size without the halo.
const HALO_ALPHA: f64 = 0.75;
const INNER: f32 = 0.75;
/// The opacity of the mark of a hidden node.
const HIDDEN: f64 = 0.38;

/// Marks on all nodes that are held at a panel's time.
pub(super) fn draw(draft: &Draft<'_>, marks: &mut Vec<Item>) {
    let time = draft.snapshot.time;
    let held: Vec<_> = draft.scene.runs[draft.run].grips.iter().filter(|grip| grip.holds(time)).collect();
    if draft.diverged || held.is_empty() || draft.position.is_empty() {
        return;
    }
    // Nodes that no element is left of hold nothing.
    let whole = draft.whole_nodes();
    let is_whole = |node: usize| whole.as_ref().is_none_or(|whole| whole[node]);
    let visible = draft.bodies.cage().visible(&draft.position, &draft.lens);
    for grip in held {
        let nodes =
            grip.nodes.iter().map(|&node| node as usize).filter(|&node| node < draft.position.len() && is_whole(node));
        let nodes: Vec<_> = nodes.collect();
        for &node in &nodes {
            draft.mark(draft.position[node], HIDDEN + (1.0 - HIDDEN) * visible[node], marks);
        }
        if grip.motion != Motion::Still {
            let middle = nodes.iter().map(|&node| draft.position[node]).sum::<DVec3>() / nodes.len().max(1) as f64;
            let gap = PIN[usize::from(draft.flat)] + FREE;
            let (velocity, greatest) = draft.going(grip);
            marks.extend(draft.pointer((middle, velocity, greatest), false, gap, draft.room));
        }
    }
}

impl Draft<'_> {
    /// The velocity of the middle of dragged nodes, and its greatest speed (m/s).
    fn going(&self, grip: &Grip) -> (DVec3, f64) {
        let (half, now) = (0.25 / self.scene.frames_per_second, self.snapshot.time);
        let shift = |time: f64| grip.motion.pose(time.clamp(grip.from, grip.until)).shift;
        let [before, after] = [now - half, now + half].map(shift);
        ((after - before) / (2.0 * half), grip.motion.greatest_speed(0.0))
    }

    /// A diamond on a halo.
    fn mark(&self, point: DVec3, opacity: f64, marks: &mut Vec<Item>) {
        let radius = (PIN[usize::from(self.flat)] * self.scale.line()).min(SHARE * self.element);
        let Some(pixel) = self.pixel(point).filter(|&pixel| radius >= THIN && self.holds(pixel, radius)) else {
            return;
        };
        let palette = &self.composer.palette;
        let diamond = |reach: f32, paint: (Colour, f64)| {
            let corners = [-Vec2::X, -Vec2::Y, Vec2::X, Vec2::Y];
            let corners = corners.map(|way| page::point(pixel) + reach * narrow(radius) * way);
            Item::fill(Path::polygon(&corners), paint)
        };
        let halo = diamond(1.0, (palette.background, HALO_ALPHA));
        marks.extend(Item::part("pin", [halo, diamond(INNER, (palette.pointer, 1.0))]).faded(opacity));
    }
}
