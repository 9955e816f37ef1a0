//! Insets: a part of a body beside it, seen by the same camera through a longer lens.

use super::Composer;
use super::panel::Draft;
use crate::look::{Inset, View};
use crate::picture::layout::{self, Rectangle, Scale};
use crate::picture::narrow::narrow;
use crate::picture::text::{TextRun, Weight};
use crate::picture::{Curve, Mark, Panel};
use glam::DVec2;

/// The part of a panel's width that an inset takes at most, and the smallest one (px).
const SHARE: f64 = 0.32;
const LEAST: f64 = 40.0;
/// Width of the frames and of their halo (px in the reference picture), and the opacity of the lines between them.
const FRAME: f64 = 1.3;
const HALO: f64 = 2.8;
const LEADER_ALPHA: f64 = 0.6;
/// From an inset to the words above it, and the room for these, in sizes of their type.
const WORDS: f64 = 0.5;
const ABOVE: f64 = 1.6;

/// The place of an inset, and what it shows.
pub(super) struct Enlarged {
    inset: Inset,
    /// Its square (px).
    square: Rectangle,
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
    let side = (SHARE * f64::from(width)).min(f64::from(clear_height) - above).floor();
    let taken = side + scale.margin() + scale.gap();
    if side < LEAST || taken > 0.5 * f64::from(width) {
        return (panel, None);
    }
    let (side, margin) = (side as u32, scale.margin().round() as u32);
    let square = [left + width - margin - side, clear_top + (clear_height + above as u32 - side) / 2, side, side];
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
        // The same camera: what is in front of something else stays there.
        self.lens.focal *= times;
        self.lens.centre = (there + times * (DVec2::from(self.lens.centre) - here)).to_array();
        self.element *= times;
        (self.viewport, self.clear) = (square, square);
        let frame = |middle: DVec2, half: DVec2| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| middle + half * DVec2::new(x, y))
        };
        let (small, large) = (frame(here, half / times), frame(there, half));
        let palette = &self.composer.palette;
        let line = |points: [DVec2; 2], width: f64, colour, alpha: f64| Curve {
            points: points.into_iter().map(|at| at.to_array().map(narrow)).collect(),
            width: narrow(width * self.scale.line()),
            dash: Vec::new(),
            colour,
            alpha: narrow(alpha),
        };
        // To the corners that face each other.
        for corners in [[1, 0], [2, 3]].into_iter().filter(|_| !self.framing.moves) {
            let ends = [small[corners[0]], large[corners[1]]];
            sinks.curves.push(line(ends, FRAME, palette.second_text, LEADER_ALPHA));
        }
        for (frame, width, colour) in
            [(small, HALO, palette.halo), (small, FRAME, palette.second_text), (large, FRAME, palette.second_text)]
        {
            // Each side for itself: joints would be rounded.
            sinks.curves.extend((0..4).map(|at| line([frame[at], frame[(at + 1) % 4]], width, colour, 1.0)));
        }
        let is_inside = |mark: &Mark| {
            let [x, y, wide, high] = mark.rectangle.map(f64::from);
            x >= left && y >= top && x + wide <= left + width && y + high <= top + height
        };
        let (mut under, mut above) = (Vec::new(), Vec::new());
        let panel = self.panel(&mut under, &mut above);
        draw(&self, sinks.curves);
        self.points(square, &mut above);
        sinks.under.extend(under.into_iter().filter(is_inside));
        sinks.above.extend(above.into_iter().filter(is_inside));
        let (text, size) = (format!("×\u{2009}{times}"), self.scale.caption());
        let (fonts, colour) = (&self.composer.fonts, self.composer.palette.second_text);
        sinks.words.push(fonts.lay_out(&text, Weight::Regular, size, colour, left, top - WORDS * size));
        Some(Panel { is_cut: false, ..panel })
    }
}
