//! Marks on nodes that grips hold or drag.

use super::Colour;
use super::Item;
use super::layout::{Rectangle, Scale};
use super::narrow::narrow;
use super::page::{self, Path, Pen};
use super::pointer::{Going, Pointers};
use super::skin::Skin;
use crate::look::Palette;
use crate::sim::{Grip, Motion};
use glam::{DVec3, Vec2};

/// Half the width of a pin, and of the ring around a dragged node (px in the reference picture), in space and in the
/// plane, where nodes are discs.
const PIN: [f64; 2] = [6.5, 9.0];
const HAND: [f64; 2] = [9.5, 12.0];
/// More dragged nodes than this are marked like held ones; the arrow shows their motion.
const FEW: usize = 4;
/// The largest width of a mark in lengths of an element, and its least width (px).
const SHARE: f64 = 0.45;
const NARROWEST: f64 = 3.0;
/// A dragged node, in radii of its mark: its disc, radius and width of its ring, and the halo around both.
const DISC: f32 = 0.36;
const RING: [f32; 2] = [0.76, 0.22];
const HALO: f32 = 0.12;
const HALO_ALPHA: f64 = 0.75;
/// A held node: half the width of its diamond without and with its halo, in radii of its mark.
const DIAMOND: [f32; 2] = [0.74, 0.98];
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
    pub(super) fn draw(&self, marks: &mut Vec<Item>) {
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

    fn mark(&self, point: DVec3, opacity: f64, ringed: bool, marks: &mut Vec<Item>) {
        let sizes = if ringed { HAND } else { PIN };
        let flat = self.pointers.lens.orthographic;
        let radius = (sizes[usize::from(flat)] * self.scale.line()).min(SHARE * self.element);
        let Some((pixel, _)) = self.pointers.lens.project(point).filter(|_| radius >= NARROWEST / 2.0) else { return };
        let [left, top, width, height] = self.viewport.map(f64::from);
        let inside = |at: f64, low: f64, length: f64| (low + radius..=low + length - radius).contains(&at);
        if !inside(pixel[0], left, width) || !inside(pixel[1], top, height) {
            return;
        }
        let (pixel, radius) = (page::point(pixel.into()), narrow(radius));
        let layers = [((self.palette.background, HALO_ALPHA), HALO), ((self.palette.pointer, 1.0), 0.0)];
        let hand = || {
            let one = |(paint, halo): ((Colour, f64), f32)| {
                let pen = Pen::solid((RING[1] + 2.0 * halo) * radius);
                let disc = Item::fill(Path::circle(pixel, (DISC + halo) * radius), paint);
                [disc, Item::stroke(Path::circle(pixel, RING[0] * radius), pen, paint)]
            };
            Item::part("hand", layers.into_iter().flat_map(one).collect::<Vec<_>>())
        };
        let pin = || {
            let one = |(paint, halo): ((Colour, f64), f32)| {
                // The halo has sharp corners, too.
                let reach = radius * if halo > 0.0 { DIAMOND[1] } else { DIAMOND[0] };
                let corners = [-Vec2::X, -Vec2::Y, Vec2::X, Vec2::Y].map(|way| pixel + reach * way);
                Item::fill(Path::polygon(&corners), paint)
            };
            Item::part("pin", layers.map(one))
        };
        marks.extend(if ringed { hand() } else { pin() }.faded(opacity));
    }
}
