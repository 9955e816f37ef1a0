//! Insets: a part of a body beside it, seen by the same camera through a longer lens.

use super::Composer;
use super::panel::Draft;
use crate::look::{Inset, View};
use crate::picture::layout::{self, Rectangle, Scale};
use crate::picture::locator;
use crate::picture::narrow::narrow;
use crate::picture::text::{TextRun, Weight};
use crate::picture::{Curve, Mark, Panel};
use glam::DVec2;
use std::f64::consts::TAU;

/// The part of a panel's width that an inset takes at most, and the smallest one (px).
const SHARE: f64 = 0.32;
const LEAST: f64 = 40.0;
/// Width of the frames and of their halo (px in the reference picture), and the opacity of the lines between them.
const FRAME: f64 = 1.3;
const HALO: f64 = 2.8;
const LEADER_ALPHA: f32 = 0.6;
/// Radius of the ring around its node, and the dashes of that if the node is hidden (px in the reference picture).
const RING: f64 = 5.5;
const RING_DASH: [f64; 2] = [2.6, 2.4];
/// Smooth borders of marks may reach so far out of it (px).
const SMOOTHED: f64 = 1.0;
/// From an inset to the words above it, and the room for these, in sizes of their type.
const WORDS: f64 = 0.5;
const ABOVE: f64 = 1.6;

/// The place of an inset, and what it shows.
pub(super) struct Enlarged {
    inset: Inset,
    /// Its square (px).
    square: Rectangle,
}

impl Enlarged {
    /// Whether it leaves a place in its panel free (px: left, top, width and height).
    pub(super) fn leaves_free(&self, [_, top, _, height]: [f64; 4]) -> bool {
        top + height < f64::from(self.square[1])
    }
}

/// Where the parts of a picture go.
pub(super) struct Sinks<'a> {
    pub(super) under: &'a mut Vec<Mark>,
    pub(super) above: &'a mut Vec<Mark>,
    pub(super) curves: &'a mut Vec<Curve>,
    pub(super) words: &'a mut Vec<TextRun>,
}

impl Composer<'_> {
    /// The part of a panel for the body, and its inset, if it has one.
    pub(super) fn body_room(&self, panel: Rectangle, scale: Scale) -> (Rectangle, Option<Enlarged>) {
        rooms(&self.scene.view, panel, scale)
    }
}

/// The part of a panel of a view for the body, and its inset, if it has one and there is room for it.
pub(super) fn rooms(view: &View, panel: Rectangle, scale: Scale) -> (Rectangle, Option<Enlarged>) {
    let Some(inset) = view.inset else { return (panel, None) };
    let [left, top, width, height] = panel;
    let [_, clear_top, _, clear_height] = layout::clear_of_words(panel, view, scale);
    let above = (ABOVE * scale.caption()).round();
    let free = f64::from(clear_height) - above;
    let side = |free: f64| (SHARE * f64::from(width)).min(free).floor();
    // Above it stands the overview, if the camera may need one and both have room.
    let below_overview = side(free - locator::HEIGHT * f64::from(clear_height) - scale.gap());
    let is_below = view.camera.follow && below_overview >= LEAST;
    let side = if is_below { below_overview } else { side(free) };
    let taken = side + scale.margin() + scale.gap();
    if side < LEAST || taken > 0.5 * f64::from(width) {
        return (panel, None);
    }
    let (side, margin) = (side as u32, scale.margin().round() as u32);
    let down = if is_below { clear_height - side } else { (clear_height + above as u32 - side) / 2 };
    let square = [left + width - margin - side, clear_top + down, side, side];
    ([left, top, width - taken.ceil() as u32, height], Some(Enlarged { inset, square }))
}

impl Draft<'_> {
    /// Draws the inset of a panel, which stands outside of this draft's part of it, with what `draw` adds, and marks the part
    /// that it enlarges; lines lead there unless an overview would be in their way.
    pub(super) fn enlarged(
        mut self,
        enlarged: &Enlarged,
        draw: impl Fn(&Self, &mut Vec<Curve>),
        sinks: Sinks<'_>,
    ) -> Option<Panel> {
        let Enlarged { inset: Inset { node, times }, square } = *enlarged;
        let &at = self.position.get(node as usize)?;
        let (pixel, _) = self.lens.project(at)?;
        let [left, top, width, height] = square.map(f64::from);
        let half = 0.5 * DVec2::new(width, height);
        let (here, there) = (DVec2::from(pixel), DVec2::new(left, top) + half);
        let frame = |middle: DVec2, half: DVec2| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| middle + half * DVec2::new(x, y))
        };
        let outside = |ends: [DVec2; 2]| [ends[0].lerp(ends[1], self.leaves(ends)), ends[1]];
        let (small, large) = (frame(here, half / times), frame(there, half));
        // To the corners that face each other, from where the lines leave the body.
        // What it enlarges may have left the panel.
        let [x, y, wide, high] = self.viewport.map(f64::from);
        let (low, high) = (DVec2::new(x, y), DVec2::new(x + wide, y + high));
        let is_here = small[0].cmpge(low).all() && small[2].cmple(high).all();
        let leaders = [[1, 0], [2, 3]].map(|[one, other]| outside([small[one], large[other]]));
        // The same camera: what is in front of something else stays there.
        self.lens.focal *= times;
        self.lens.centre = (there + times * (DVec2::from(self.lens.centre) - here)).to_array();
        self.element *= times;
        self.enlarged = times;
        (self.viewport, self.clear) = (square, square);
        let palette = &self.composer.palette;
        let line = |points: &[DVec2], width: f64, dash: &[f64], colour| Curve {
            points: points.iter().map(|at| at.to_array().map(narrow)).collect(),
            width: narrow(width * self.scale.line()),
            dash: dash.iter().map(|length| narrow(length * self.scale.line())).collect(),
            colour,
            alpha: 1.0,
        };
        for ends in leaders.iter().filter(|_| is_here && !self.framing.moves) {
            sinks.curves.push(Curve { alpha: LEADER_ALPHA, ..line(ends, FRAME, &[], palette.second_text) });
        }
        let frames =
            [(small, HALO, palette.halo), (small, FRAME, palette.second_text), (large, FRAME, palette.second_text)];
        for &(frame, width, colour) in &frames[if is_here { 0 } else { 2 }..] {
            // Each side for itself: joints would be rounded.
            sinks.curves.extend((0..4).map(|at| line(&[frame[at], frame[(at + 1) % 4]], width, &[], colour)));
        }
        let is_inside = |mark: &Mark| {
            let ([x, y, wide, high], along) = (mark.rectangle.map(f64::from), DVec2::from(mark.along.map(f64::from)));
            let corner = |share: [f64; 2]| DVec2::new(x, y) + share[0] * wide * along + share[1] * high * along.perp();
            let off = |at: DVec2| (at - there).abs() - half;
            [[0.0; 2], [1.0, 0.0], [1.0; 2], [0.0, 1.0]].map(corner).iter().all(|&at| off(at).max_element() <= SMOOTHED)
        };
        let (mut under, mut above) = (Vec::new(), Vec::new());
        let panel = self.panel(&mut under, &mut above);
        draw(&self, sinks.curves);
        // The node that it shows, which surfaces may hide; in the plane it is seen.
        if !self.flat {
            let corner = |at: u32| {
                let (sine, cosine) = libm::sincos(TAU / 24.0 * f64::from(at % 24));
                there + RING * self.scale.line() * DVec2::new(cosine, sine)
            };
            let ring: Vec<_> = (0..25).map(corner).collect();
            let is_hidden = self.composer.skin.visible(&self.position, &self.lens)[node as usize] == 0.0;
            let dash = if is_hidden { &RING_DASH[..] } else { &[] };
            sinks.curves.push(line(&ring, HALO, &[], palette.halo));
            sinks.curves.push(line(&ring, FRAME, dash, palette.text));
        }
        self.points(square, &mut above);
        sinks.under.extend(under.into_iter().filter(is_inside));
        sinks.above.extend(above.into_iter().filter(is_inside));
        let (text, size) = (format!("×\u{2009}{times}"), self.scale.caption());
        let (fonts, colour) = (&self.composer.fonts, self.composer.palette.second_text);
        sinks.words.push(fonts.lay_out(&text, Weight::Regular, size, colour, left, top - WORDS * size));
        Some(Panel { is_cut: false, ..panel })
    }

    /// The share of a way from a pixel to another one after which no surface of the body is crossed any more.
    fn leaves(&self, [from, to]: [DVec2; 2]) -> f64 {
        let skin = &self.composer.skin;
        let pixel = |at: u32| Some(DVec2::from(self.lens.project(self.position[skin.nodes[at as usize] as usize])?.0));
        let way = to - from;
        let crossing = |[a, b]: [u32; 2]| {
            let (a, b) = (pixel(a)?, pixel(b)?);
            let turned = way.perp_dot(b - a);
            let [share, beside] = [(a - from).perp_dot(b - a) / turned, (a - from).perp_dot(way) / turned];
            ((0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&beside)).then_some(share)
        };
        let edges = skin.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        edges.filter_map(crossing).fold(0.0, f64::max)
    }
}
