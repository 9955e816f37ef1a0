//! The words of a picture: names, clock, counts and numbers, and the lines between panels.

use super::layout::{Baselines, Rectangle, Scale};
use super::narrow::narrow;
use super::palette::{Colour, Palette};
use super::tally::Tally;
use super::text::{TextRun, Weight, lay_out, shortened, width};
use super::{Curve, Mark, MarkShape, number};
use crate::scene::Scene;
use crate::sim::snapshot::{Snapshot, Status};

/// The widest times that a clock shows: room is kept for them, so that nothing moves when the digits change.
const WIDEST_TIME: &str = "8888.8 s";
/// The largest part of a panel's inner width that the clock's label may take.
const LABEL_SHARE: f64 = 0.55;

/// Writes one panel after the other.
pub(super) struct Writer<'a> {
    pub(super) palette: &'a Palette,
    pub(super) scale: Scale,
    pub(super) marks: Vec<Mark>,
    pub(super) curves: Vec<Curve>,
    pub(super) words: Vec<TextRun>,
}

/// The edges of the room for words in a panel (px).
#[derive(Clone, Copy)]
struct Room {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Room {
    fn new(panel: Rectangle, scale: Scale) -> Self {
        let [left, top, width, height] = panel.map(f64::from);
        let margin = scale.margin();
        Self { left: left + margin, right: left + width - margin, top, bottom: top + height }
    }

    fn width(self) -> f64 {
        (self.right - self.left).max(0.0)
    }
}

impl Writer<'_> {
    /// Name and second line, upper left, with `taken` (px) kept free at the right of each.
    pub(super) fn heading(&mut self, panel: Rectangle, name: &str, second: &str, taken: [f64; 2]) {
        let (room, lines) = (Room::new(panel, self.scale), Baselines::new(self.scale, panel));
        let [title, caption] = [self.scale.title(), self.scale.caption()];
        let free = taken.map(|taken| room.width() - if taken > 0.0 { taken + self.scale.gap() } else { 0.0 });
        let name = shortened(name, Weight::SemiBold, title, free[0]);
        self.left(&name, Weight::SemiBold, title, self.palette.text, room.left, room.top + lines.title);
        let second = shortened(second, Weight::Regular, caption, free[1]);
        self.left(&second, Weight::Regular, caption, self.palette.second_text, room.left, room.top + lines.second);
    }

    /// How much room the clock and its label take (px), at any time.
    pub(super) fn clock_room(&self, panel: Rectangle, label: &str) -> [f64; 2] {
        let label = self.clock_label(panel, label);
        let time = width(WIDEST_TIME, Weight::Regular, self.scale.title());
        [time, width(&label, Weight::Regular, self.scale.caption())]
    }

    fn clock_label(&self, panel: Rectangle, label: &str) -> String {
        let room = LABEL_SHARE * Room::new(panel, self.scale).width();
        shortened(label, Weight::Regular, self.scale.caption(), room)
    }

    /// The clock with its label, upper right.
    pub(super) fn clock(&mut self, panel: Rectangle, time: f64, label: &str) {
        let (room, lines) = (Room::new(panel, self.scale), Baselines::new(self.scale, panel));
        let [title, caption] = [self.scale.title(), self.scale.caption()];
        let time = shortened(&number::time(time), Weight::Regular, title, room.width());
        self.right(&time, Weight::Regular, title, self.palette.text, room.right, room.top + lines.title);
        let label = self.clock_label(panel, label);
        self.right(&label, Weight::Regular, caption, self.palette.second_text, room.right, room.top + lines.second);
    }

    /// Tally and count, lower left, and one number, lower right.
    pub(super) fn count(&mut self, panel: Rectangle, tally: &Tally, snapshot: &Snapshot, numbers: &[String]) {
        let (room, lines) = (Room::new(panel, self.scale), Baselines::new(self.scale, panel));
        let [title, caption] = [self.scale.title(), self.scale.caption()];
        let baseline = room.top + lines.caption;
        let mut right_of_count = room.left;
        if Scale::legible(caption) && !snapshot.turned_over.is_empty() {
            let over = snapshot.turned_over.iter().filter(|&&over| over).count();
            let (colour, second) = match over {
                0 => (self.palette.text, self.palette.second_text),
                _ => (self.palette.alarm_text, self.palette.alarm_text),
            };
            let bottom = room.bottom - self.scale.margin();
            let taken = tally.draw(
                &snapshot.turned_over,
                self.palette,
                self.scale,
                0.42 * room.width(),
                [room.left, bottom],
                &mut self.marks,
            );
            let left = room.left + taken + if taken > 0.0 { self.scale.gap() } else { 0.0 };
            let all = snapshot.turned_over.len();
            let free = room.right - left;
            let count = shortened(&format!("{over} of {all}"), Weight::SemiBold, title, free);
            self.left(&count, Weight::SemiBold, title, colour, left, room.top + lines.count);
            let explained = shortened("turned over", Weight::Regular, caption, free);
            self.left(&explained, Weight::Regular, caption, second, left, baseline);
            // The widest count, so that the number beside it does not come and go.
            right_of_count =
                left + width(&format!("{all} of {all}"), Weight::SemiBold, title).max(width(
                    &explained,
                    Weight::Regular,
                    caption,
                )) + self.scale.gap();
        }
        // That a run blew up is said as loudly as there is room for.
        let (weight, colour, sizes) = match snapshot.status {
            Status::Diverged(_) => (Weight::SemiBold, self.palette.text, [title, caption]),
            Status::Ok => (Weight::Regular, self.palette.second_text, [caption; 2]),
        };
        let wordings = numbers.iter().flat_map(|text| sizes.map(|size| (text, size)));
        let free = room.right - right_of_count;
        // By the room of the widest number, or the words beside it would come and go.
        if let Some((text, size)) = { wordings }.find(|&(text, size)| width(&widest(text), weight, size) <= free) {
            self.right(text, weight, size, colour, room.right, baseline);
        }
    }

    /// Hairlines between panels that stand beside or above each other.
    pub(super) fn hairlines(&mut self, panels: &[Rectangle]) {
        let inset = self.scale.margin();
        // A hairline of one pixel that lies between two pixels fills half of both.
        let thickness = (2.0 * self.scale.unit).round().max(1.0);
        let (line, ground) = (self.palette.hairline, self.palette.background);
        let halved = if thickness < 2.0 { line } else { std::array::from_fn(|at| line[at].midpoint(ground[at])) };
        for &[left, top, width, height] in panels {
            let [left, top, width, height] = [left, top, width, height].map(f64::from);
            let mut line = |rectangle: [f64; 4]| {
                self.marks.push(Mark {
                    rectangle: rectangle.map(narrow),
                    along: Mark::UPRIGHT,
                    colour: halved,
                    second: halved,
                    shape: MarkShape::Filled,
                });
            };
            if left > 0.0 && height > 2.0 * inset {
                line([
                    left - (thickness / 2.0).floor(),
                    top + inset.round(),
                    thickness,
                    (height - 2.0 * inset).round(),
                ]);
            }
            if top > 0.0 && width > 2.0 * inset {
                line([left + inset.round(), top - (thickness / 2.0).floor(), (width - 2.0 * inset).round(), thickness]);
            }
        }
    }

    fn left(&mut self, text: &str, weight: Weight, size: f64, colour: Colour, left: f64, baseline: f64) {
        if Scale::legible(size) && !text.is_empty() {
            self.words.push(lay_out(text, weight, size, colour, left, baseline));
        }
    }

    fn right(&mut self, text: &str, weight: Weight, size: f64, colour: Colour, right: f64, baseline: f64) {
        let left = right - width(text, weight, size);
        self.left(text, weight, size, colour, left, baseline);
    }
}

/// A wording with the widest number that may stand in the place of its own.
fn widest(text: &str) -> String {
    const WIDEST: &str = "−0.00";
    let is_part = |c: char| c.is_ascii_digit() || c == '−' || c == '.';
    match (text.find(is_part), text.rfind(is_part)) {
        (Some(first), Some(last))
            if text[first..].chars().take_while(|&c| is_part(c)).count() < WIDEST.chars().count() =>
        {
            let after = text[last..].chars().next().map_or(last, |c| last + c.len_utf8());
            format!("{}{WIDEST}{}", &text[..first], &text[after..])
        }
        _ => text.to_owned(),
    }
}

/// The number at the lower right, from its longest wording to its shortest.
pub(super) fn numbers(scene: &Scene, snapshot: &Snapshot, area_ratio: Option<f64>) -> Vec<String> {
    if let Status::Diverged(divergence) = snapshot.status {
        return vec![format!("diverged at {}", number::time(divergence.time)), "diverged".to_owned()];
    }
    if let Some(ratio) = area_ratio {
        let ratio = number::ratio(ratio);
        return vec![format!("smallest area ratio {ratio}"), format!("area ratio {ratio}")];
    }
    let error = number::length(snapshot.diagnostics.shape_error, scene.body.extent());
    vec![format!("shape error {error}"), format!("error {error}"), error]
}
