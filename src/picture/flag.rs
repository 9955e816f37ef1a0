//! Flags above charts: letters or numbers in rings, with lines down to their places.

use super::caption::{Room, Writer};
use super::ends::spread;
use super::event::Event;
use super::layout::{Baselines, Rectangle, Scale};
use super::text::Weight;
use super::{Colour, Item};

/// Radius of a ring, thickness of its rim, size of the letter in it, the gap beside the letter, and the gap between
/// rings (px in the reference picture).
const RING: f64 = 10.0;
const RIM: f64 = 1.3;
const LETTER: f64 = 14.0;
const BESIDE_LETTER: f64 = 4.0;
const RINGS_APART: f64 = 3.0;
/// The largest share of the margin for crowded rings at each end.
const BEYOND: f64 = 0.35;
/// The height above the charts at which the lines become upright, their width (px in the reference picture), and their
/// opacity.
const UPRIGHT_ABOVE: f64 = 9.0;
const LINE: f64 = 1.1;
const LINE_ALPHA: f64 = 0.62;

/// Radius of the ring of an event, in sizes of its number; the gap between it and its words, and the gap between events
/// (px in the reference picture).
const EVENT_RING: f64 = 0.68;
const EVENT_BESIDE: f64 = 7.0;
const EVENTS_APART: f64 = 18.0;

/// A letter or a number at a place in a chart.
#[derive(Clone, Debug)]
pub(super) struct Flag {
    /// Its place (px from the left).
    pub(super) at: f64,
    pub(super) text: String,
    /// The colour of its line and rim.
    pub(super) colour: Colour,
}

/// Draws flags, sorted by their places: rings at a height, side by side within a span, with lines from the top of all
/// charts to their bottom (px).
pub(super) fn draw(
    writer: &mut Writer<'_>,
    flags: &[Flag],
    middle: f64,
    [left, right]: [f64; 2],
    [top, bottom]: [f64; 2],
) {
    let (scale, fonts, palette) = (writer.scale, writer.fonts, writer.palette);
    let top = top - UPRIGHT_ABOVE * scale.type_unit();
    let wide = |text: &str| fonts.width(text, Weight::SemiBold, LETTER * scale.type_unit());
    let widest = flags.iter().map(|flag| wide(&flag.text)).fold(0.0, f64::max);
    let radius = (RING * scale.type_unit()).max(0.5 * widest + BESIDE_LETTER * scale.type_unit());
    let apart = 2.0 * radius + RINGS_APART * scale.type_unit();
    // The outermost rings reach into the margins, but not to the picture's sides.
    let span = right - left + 2.0 * radius.min(BEYOND * scale.margin());
    // Many rings become smaller while their letters can be read; otherwise they are left out.
    let smaller = (span / (apart * flags.len().max(1) as f64)).min(1.0);
    let letter = LETTER * scale.type_unit() * smaller;
    let with_rings = Scale::legible(letter);
    let places: Vec<_> = flags.iter().map(|flag| flag.at.floor() + 0.5).collect();
    let rings = spread(&places, apart * smaller, [left, right]);
    for ((flag, &x), &ring) in flags.iter().zip(&places).zip(&rings) {
        let from = if with_rings { [ring, middle] } else { [x, top] };
        let is_straight = (ring - x).abs() < 0.75 || !with_rings;
        let points: &[_] = if is_straight { &[[x, from[1]], [x, bottom]] } else { &[from, [x, top], [x, bottom]] };
        writer.curves.push(Item::curve(points, LINE * scale.line(), &[], (flag.colour, LINE_ALPHA)));
    }
    if !with_rings {
        return;
    }
    for ((flag, &x), &ring_at) in flags.iter().zip(&places).zip(&rings) {
        let at = [if (ring_at - x).abs() < 0.75 { x } else { ring_at }, middle];
        ring(writer, at, [radius * smaller, letter], [flag.colour, palette.background, palette.text], &flag.text);
    }
}

/// A ring with a letter of a size around a place (px), and the colours of its rim, its ground and the letter.
pub(super) fn ring(
    writer: &mut Writer<'_>,
    at: [f64; 2],
    [radius, size]: [f64; 2],
    [rim, ground, letter]: [Colour; 3],
    text: &str,
) {
    let thickness = RIM * writer.scale.line();
    for (radius, colour) in [(radius, rim), (radius - thickness, ground)] {
        writer.curves.push(Item::disc(at, radius, colour));
    }
    let left = at[0] - 0.5 * writer.fonts.width(text, Weight::SemiBold, size);
    writer.left(text, Weight::SemiBold, size, letter, left, at[1] + 0.36 * size);
}

impl Writer<'_> {
    /// The number of a run's events, from the first one on, whose words fit into a panel.
    pub(super) fn explained(&self, panel: Rectangle, events: &[&Event]) -> usize {
        let room = Room::new(panel, self.scale).width();
        let fits = |count: &usize| self.events_width(events[..*count].iter().copied(), 1) <= room;
        (0..=events.len()).rev().find(fits).filter(|_| Scale::legible(self.scale.caption())).unwrap_or(0)
    }

    /// Whether the words of all events fit into a panel, without and with their times.
    pub(super) fn explains(&self, panel: Rectangle, events: &[Event]) -> [bool; 2] {
        let room = Room::new(panel, self.scale).width();
        [1, 0].map(|at| Scale::legible(self.scale.caption()) && self.events_width(events.iter(), at) <= room)
    }

    /// The width of events with their words, with or without their times (px).
    fn events_width<'e>(&self, events: impl Iterator<Item = &'e Event>, at: usize) -> f64 {
        let (unit, size) = (self.scale.type_unit(), self.scale.caption());
        let [beside, apart] = [EVENT_BESIDE, EVENTS_APART].map(|length| length * unit);
        let one = 2.0 * EVENT_RING * self.scale.small() + beside + apart;
        let all: f64 = events.map(|event| one + self.fonts.width(&event.words[at], Weight::Regular, size)).sum();
        (all - apart).max(0.0)
    }

    /// The events of a run, each with a number in a ring of a colour, in a line below its heading, with as many words
    /// as fit. The rings of past events are filled.
    pub(super) fn events<'e>(
        &mut self,
        panel: Rectangle,
        events: impl Iterator<Item = (usize, &'e Event)>,
        colour: Colour,
        now: f64,
    ) {
        let (room, lines) = (Room::new(panel, self.scale), Baselines::new(self.scale, panel));
        let (unit, size) = (self.scale.type_unit(), self.scale.caption());
        let events: Vec<_> = events.collect();
        let number_size = self.scale.small();
        let radius = EVENT_RING * number_size;
        let [beside, apart] = [EVENT_BESIDE, EVENTS_APART].map(|length| length * unit);
        let wide = |words: &str| 2.0 * radius + beside + self.fonts.width(words, Weight::Regular, size);
        let width = |at: usize| self.events_width(events.iter().map(|(_, event)| *event), at);
        let Some(at) = (0..=1).find(|&at| width(at) <= room.width()) else { return };
        let (mut left, baseline) = (room.left, room.top + lines.events);
        let palette = self.palette;
        for (number, event) in &events {
            let [ground, letter] =
                if event.time <= now { [colour, palette.background] } else { [palette.background, palette.text] };
            let middle = [left + radius, baseline - 0.36 * size];
            ring(self, middle, [radius, number_size], [colour, ground, letter], &number.to_string());
            let text = &event.words[at];
            self.left(text, Weight::Regular, size, palette.second_text, left + 2.0 * radius + beside, baseline);
            left += wide(text) + apart;
        }
    }
}
