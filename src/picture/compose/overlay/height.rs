//! The height of a body above the ground, where the camera follows it: without it a body that flies high looks like one that rests.

use crate::picture::compose::draft::{Draft, PixelBox};
use crate::picture::layout::Scale;
use crate::picture::layout::steps::{BESIDE, CLOSE, FREE, GAP, HAIR, RING, SHORT};
use crate::picture::number;
use crate::picture::text::{TextRun, Weight};
use crate::picture::{Item, arrows};
use crate::sim::geometry;
use glam::{DVec2, DVec3};

/// A body that is this high (sizes) has a line to the ground.
const HIGH: f64 = 0.55;
/// The same where the ground lies beyond the panel.
const ABOVE_UNSEEN: f64 = 0.035;

/// The opacity of the part of a line before which the body stands.
const HIDDEN: f64 = 0.35;

/// A line from the height of the lowest body down to the ground, faint where the body stands before it, with the height as a number. Where the
/// ground lies beyond the panel, an arrow of a fixed length points down to it.
pub(super) fn draw(draft: &Draft<'_>, marks: &mut Vec<Item>) {
    let time = draft.snapshot.time;
    let ground = geometry::ground(&draft.scene.obstacles, time).filter(|_| draft.framing.moves && !draft.greyed);
    let is_held = draft.scene.runs[draft.run].grips.iter().any(|grip| grip.holds(time));
    if let Some(ground) = ground.filter(|_| draft.scene.view.labels.number && !is_held) {
        draft.drop_line(ground, marks);
    }
}

impl Draft<'_> {
    /// The line down to the ground with an outward normal and a height along it (m).
    fn drop_line(&self, (normal, height): (DVec3, f64), marks: &mut Vec<Item>) {
        let points = if self.skin.is_empty() { &self.position[..] } else { &self.skin };
        let lowest = points.iter().map(|&at| normal.dot(at) - height).fold(f64::INFINITY, f64::min);
        let centre = self.centre(0..self.position.len());
        let foot = centre - (normal.dot(centre) - height) * normal;
        let ends = [foot + lowest * normal, foot].map(|at| self.pixel(at));
        let [Some(start), Some(end)] = ends else { return };
        let unit = self.scale.line();
        let [_, top, _, length] = self.room.map(f64::from);
        // It is strong below all that is seen of the bodies, and stays above the words. Without room there it stands beside them.
        let [right, bottom] = PixelBox::new(&self.lens, points).corners[1].to_array();
        let level = |y: f64| start.lerp(end, (y - start.y) / (end.y - start.y));
        let (first, limit) = (start.y.max(bottom) + CLOSE * unit, top + length + CLOSE * unit);
        let unseen = ((end.y - limit) / (RING * unit)).clamp(0.0, 1.0);
        // Pale words could not be read: it comes and goes at once.
        let high = if unseen < 0.5 { HIGH } else { ABOVE_UNSEEN } * self.composer.extent;
        if points.is_empty() || lowest.is_nan() || lowest < high || end.y - start.y < 1.0 {
            return;
        }
        // Where the ground goes out of sight the line shortens to an arrow.
        let short = first + SHORT * unit;
        let last = (end.y + unseen * (short - end.y)).min(limit);
        let is_beside = end.y.min(limit) - first < SHORT * unit;
        let beside = |y: f64| DVec2::new(right + GAP * unit, y);
        let line = match is_beside {
            false => [first, last].map(level),
            true if unseen > 0.0 => [SHORT * unit, 0.0].map(|above| beside(end.y.min(limit) - above)),
            true => [start.y, end.y].map(beside),
        };
        let palette = &self.composer.palette;
        let stroke = |ends: [DVec2; 2]| Item::line(ends, HAIR * unit, palette.second_text);
        let tick = |at: DVec2| stroke([-1.0, 1.0].map(|side| at + DVec2::new(side * RING * unit, 0.0)));
        let to_ground = || {
            let top = if is_beside { line[0] } else { start };
            let hidden = (first > start.y && !is_beside).then(|| stroke([start, level(first)]).faded(HIDDEN)).flatten();
            [stroke(line), tick(line[1]), tick(top)].into_iter().chain(hidden).collect()
        };
        let arrow = || arrows::with_halo(line, self.scale.unit, palette.second_text, palette.background);
        let arrow_share = if is_beside && unseen > 0.0 { 1.0 } else { unseen };
        // A line without its number means nothing.
        let number = format!("{} up", number::with_unit(lowest, "m"));
        let Some(number) = self.number_beside(&number, line, top + length) else { return };
        let faded = |items: Vec<Item>, share: f64| items.into_iter().filter_map(move |item| item.faded(share));
        let drawn = faded(to_ground(), 1.0 - arrow_share).chain(faded(arrow().into(), arrow_share));
        marks.push(Item::part("height", drawn.collect::<Vec<_>>()));
        marks.push(Item::Text(number));
    }

    /// A number to the right or to the left of a line, above a height in the picture (px); `None` without room.
    fn number_beside(&self, text: &str, [from, to]: [DVec2; 2], lowest: f64) -> Option<TextRun> {
        let (fonts, size, colour) = (&self.composer.fonts, self.scale.caption(), self.composer.palette.second_text);
        let [left, _, width, _] = self.room.map(f64::from);
        let (wide, apart) = (fonts.width(text, Weight::Regular, size), (BESIDE + FREE) * self.scale.line());
        let middle = from.midpoint(to);
        let fits = |at: &f64| *at >= left && at + wide <= left + width;
        let at = [middle.x + apart, middle.x - apart - wide].into_iter().find(fits)?;
        let baseline = (middle.y + 0.36 * size).min(lowest - 0.25 * size);
        let run = fonts.lay_out(text, Weight::Regular, size, colour, at, baseline);
        Scale::legible(size).then_some(TextRun { has_halo: true, ..run })
    }
}
