//! The height of a body above the ground, where the camera follows it: without it a body that flies high looks like one that rests.

use super::Overlay;
use crate::colour::{Colour, mixed};
use crate::picture::compose::draft::{Draft, PixelBox};
use crate::picture::layout::Scale;
use crate::picture::layout::steps::{BESIDE, CLOSE, FREE, GAP, HAIR, RING, SHORT};
use crate::picture::number;
use crate::picture::text::{TextRun, Weight};
use crate::picture::{Item, arrows};
use crate::sim::geometry;
use glam::{DVec2, DVec3};

/// A body that is this high (sizes) has a line to the ground; at the second height it has its full strength.
const HIGH: [f64; 2] = [0.5, 0.6];
/// The same where the ground lies beyond the panel.
const ABOVE_UNSEEN: [f64; 2] = [0.02, 0.05];

/// A line from below the lowest body down to the ground, with the height as a number. Where the ground lies beyond the panel, an arrow of a fixed
/// length points down to it.
pub(super) struct Height;

impl Overlay for Height {
    fn draw(&self, draft: &Draft<'_>, marks: &mut Vec<Item>) {
        let time = draft.run.snapshot.time;
        let ground = geometry::ground(&draft.scene.obstacles, time).filter(|_| draft.framing.moves && !draft.greyed);
        let is_held = draft.scene.runs[draft.run.run].grips.iter().any(|grip| grip.holds(time));
        if let Some(ground) = ground.filter(|_| draft.scene.view.labels.number && !is_held) {
            draft.drop_line(ground, marks);
        }
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
        let [_, top, _, length] = self.between_words().map(f64::from);
        // It begins below all that is seen of the bodies, and stays above the words. Without room there it stands beside them.
        let [right, bottom] = PixelBox::new(&self.lens, points).corners[1].to_array();
        let level = |y: f64| start.lerp(end, (y - start.y) / (end.y - start.y));
        let (first, limit) = (start.y.max(bottom) + CLOSE * unit, top + length + CLOSE * unit);
        let share = |[from, full]: [f64; 2]| ((lowest / self.composer.extent - from) / (full - from)).clamp(0.0, 1.0);
        let unseen = ((end.y - limit) / (RING * unit)).clamp(0.0, 1.0);
        let strength = share(HIGH).max(unseen * share(ABOVE_UNSEEN));
        if points.is_empty() || strength.is_nan() || strength <= 0.0 || end.y - start.y < 1.0 {
            return;
        }
        // Where the ground goes out of sight the line shortens to an arrow.
        let short = first + SHORT * unit;
        let last = (end.y + unseen * (short - end.y)).min(limit);
        let is_beside = end.y.min(limit) - first < SHORT * unit;
        let line = match is_beside {
            false => [first, last].map(level),
            true => [SHORT * unit, 0.0].map(|above| DVec2::new(right + GAP * unit, end.y.min(limit) - above)),
        };
        let palette = &self.composer.palette;
        let to_ground = || {
            let across = DVec2::new(RING * unit, 0.0);
            [line, [line[1] - across, line[1] + across]].map(|ends| Item::line(ends, HAIR * unit, palette.second_text))
        };
        let arrow = || arrows::with_halo(line, self.scale.unit, palette.second_text, palette.background);
        let arrow_share = if is_beside { 1.0 } else { unseen };
        // A line without its number means nothing.
        let number = format!("{} up", number::with_unit(lowest, "m"));
        let colour = mixed(palette.background, palette.second_text, strength);
        let Some(number) = self.number_beside(&number, colour, line, top + length) else { return };
        let faded = |items: Vec<Item>, share: f64| items.into_iter().filter_map(move |item| item.faded(share));
        let drawn = faded(to_ground().into(), 1.0 - arrow_share).chain(faded(arrow().into(), arrow_share));
        marks.extend(Item::part("height", drawn.collect::<Vec<_>>()).faded(strength));
        marks.push(Item::Text(number));
    }

    /// A number to the right or to the left of a line, above a height in the picture (px); `None` without room.
    fn number_beside(&self, text: &str, colour: Colour, [from, to]: [DVec2; 2], lowest: f64) -> Option<TextRun> {
        let (fonts, size) = (&self.composer.fonts, self.scale.caption());
        let [left, _, width, _] = self.between_words().map(f64::from);
        let (wide, apart) = (fonts.width(text, Weight::Regular, size), (BESIDE + FREE) * self.scale.line());
        let middle = from.midpoint(to);
        let fits = |at: &f64| *at >= left && at + wide <= left + width;
        let at = [middle.x + apart, middle.x - apart - wide].into_iter().find(fits)?;
        let baseline = (middle.y + 0.36 * size).min(lowest - 0.25 * size);
        let run = fonts.lay_out(text, Weight::Regular, size, colour, at, baseline);
        Scale::legible(size).then_some(TextRun { has_halo: true, ..run })
    }
}
