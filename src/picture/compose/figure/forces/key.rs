//! The key of a diagram of forces.

use super::marks::{GHOST_LINE, ghost_colour, outlined};
use crate::picture::Item;
use crate::picture::arrows::arrow;
use crate::picture::caption::Writer;
use crate::picture::layout::Scale;
use crate::picture::number::round_below;
use crate::picture::text::Weight;
use crate::scene::Scene;
use crate::scene::figure::{Figure, Forces};
use glam::DVec2;

/// The approximate length of the key's arrow (px in the reference picture).
const KEY_ARROW: f64 = 60.0;

/// The key at the bottom.
pub(super) struct Key<'a> {
    pub(super) figure: &'a Figure,
    pub(super) forces: &'a Forces,
    pub(super) scene: &'a Scene,
    pub(super) pixels: f64,
    pub(super) columns: usize,
    pub(super) scale: Scale,
}

impl Key<'_> {
    pub(super) fn draw(&self, writer: &mut Writer<'_>, marks: &mut Vec<Item>) {
        let Self { figure, forces, scene, pixels, scale, .. } = *self;
        let (palette, unit) = (&figure.look.palette(), scale.unit);
        let [width, height] = figure.size.map(f64::from);
        let size = scale.caption();
        let baseline = height - scale.margin() - 1.0 * unit;
        let middle = baseline - 0.33 * size;
        let gap = 12.0 * unit;
        let mut left = scale.margin();
        let column = width / self.columns as f64;
        // A letter after `_` is an index.
        let say = |text: &str, left: f64, writer: &mut Writer<'_>| {
            let mut left = left;
            for (at, part) in text.split('_').enumerate() {
                let index = if at > 0 { part.chars().next().map_or(0, char::len_utf8) } else { 0 };
                let (index, part) = part.split_at(index);
                let small = 0.72 * size;
                writer.left(index, Weight::Regular, small, palette.second_text, left, baseline + 0.2 * size);
                left += writer.fonts.width(index, Weight::Regular, small);
                let room = width - left - scale.margin();
                let part = if writer.fonts.width(part, Weight::Regular, size) <= room {
                    part.to_owned()
                } else {
                    String::new()
                };
                writer.left(&part, Weight::Regular, size, palette.second_text, left, baseline);
                left += writer.fonts.width(&part, Weight::Regular, size);
            }
            left
        };
        // Arrow.
        let side = scene.view.side * pixels;
        let share = round_below(1.3 * KEY_ARROW * unit / side);
        let ends = [DVec2::new(left, middle), DVec2::new(left + share * side, middle)];
        marks.push(arrow(ends, scale.line(), palette.text, palette.background));
        let text = if forces.vectors {
            "from r_i to R_i: the force on the node over k".to_owned()
        } else {
            format!("{share} k × side")
        };
        left = say(&text, ends[1].x + gap, writer) + 3.0 * gap;
        // Ghost.
        let icon = 22.0 * unit;
        let rectangle = [left, middle - 0.5 * icon, icon, icon].map(f64::round);
        marks.push(Item::rectangle(rectangle, ghost_colour(palette)));
        let [x, y, w, h] = rectangle;
        let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]].map(DVec2::from);
        for at in 0..4 {
            let ends = [corners[at], corners[(at + 1) % 4]];
            for part in [[0.0, 0.2], [0.4, 0.6], [0.8, 1.0]] {
                let dash = part.map(|share| ends[0].lerp(ends[1], share));
                marks.push(Item::line(dash, GHOST_LINE * scale.line(), palette.axis));
            }
        }
        left = say("rest shape, best fit", left + icon + gap, writer) + 3.0 * gap;
        let Some(compare) = forces.compare else { return };
        let second = column + scale.margin();
        if left <= second {
            left = second;
        }
        let ends = [DVec2::new(left, middle), DVec2::new(left + 54.0 * unit, middle)];
        let compared = &scene.runs[compare];
        marks.extend(outlined(ends, scale, compared.line(palette).colour, palette.background, true));
        say(&format!("forces of “{}”, for comparison", compared.name), ends[1].x + gap, writer);
    }
}
