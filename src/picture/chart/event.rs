//! Events in time series, in words. Flags in a chart and in panels mark them.

use super::axis::Stretch;
use super::ring;
use super::series::{LEAST_RANGE, Series, quantity};
use crate::colour::Colour;
use crate::look::Plot;
use crate::picture::caption::{DIVERGES, RECORDING_ENDS, Writer};
use crate::picture::layout::steps::{GAP, NEAR};
use crate::picture::layout::{Rectangle, Scale, WordPlaces};
use crate::picture::number;
use crate::picture::text::Weight;
use crate::scene::Scene;
use crate::sim::Diagnostic;

/// The most events of a picture: their numbers have one digit.
const MOST: usize = 9;
/// A count that does not change in this last part of the scene has settled.
const SETTLED: f64 = 0.1;
/// An extreme value differs from the values at the start and at the end by more than this part of the range.
const EXTREME: f64 = 0.1;
/// If this part of all changes happens in the first of these parts of the scene, that part gets a scale of its own,
/// which ends at a round time.
const NEARLY_ALL: f64 = 0.95;
const SHORT: f64 = 0.1;

/// Radius of the ring of an event, in sizes of its number.
const EVENT_RING: f64 = 0.68;

/// An event of a run.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::picture) struct Event {
    pub run: usize,
    /// The time (s).
    pub time: f64,
    /// The name with its time, shorter, and without its time.
    pub words: [String; 3],
}

/// The events in time series beside an axis, up to an end (s), in the order of time. Extremes name their `quantity`, if it is not empty.
pub(in crate::picture) fn events(series: &[Series], axis: Option<&Stretch>, quantity: &str, end: f64) -> Vec<Event> {
    let widest = series
        .iter()
        .flat_map(|one| &one.points)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at[1]), high.max(at[1])]);
    let value = |value: f64| axis.map_or_else(String::new, |axis| axis.in_words(value));
    let event = |one: &Series, time: f64, words: String, joint: &str| Event {
        run: one.run,
        time,
        words: wordings(words, joint, &number::time(time, end)),
    };
    // First events of all runs come before second ones.
    let mut all: Vec<(usize, Event)> = Vec::new();
    for one in series {
        let mut own = Vec::new();
        let changes: Vec<_> = one.points.windows(2).filter(|two| two[0][1] != two[1][1]).map(|two| two[1]).collect();
        if one.is_count {
            let first = changes.first().filter(|_| one.points[0][1] == 0.0);
            let first = first.map(|&[time, _]| event(one, time, "first turned over".to_owned(), "at"));
            let last = changes.last().filter(|[time, _]| changes.len() > 1 && *time <= (1.0 - SETTLED) * end);
            let last = last.filter(|_| one.diverged.is_none());
            let time_of = |time: f64| number::time(time, end);
            own.extend(match (first, last) {
                (Some(first), Some(&[time, 0.0])) if time_of(first.time) == time_of(time) => {
                    vec![event(one, first.time, "turned over briefly".to_owned(), "at")]
                }
                (first, last) => {
                    let settled = last.map(|&[time, count]| {
                        // Elements that are no longer turned over may be flat.
                        let words = if count == 0.0 { "none".to_owned() } else { format!("settles at {count}") };
                        event(one, time, words, "after")
                    });
                    first.into_iter().chain(settled).collect()
                }
            });
        } else if let (Some(&[_, start]), Some(&[_, last])) = (one.points.first(), one.points.last()) {
            let apart = |value: f64, other: f64| (value - other).abs();
            let extreme = one.points.iter().max_by(|a, b| apart(a[1], start).total_cmp(&apart(b[1], start)));
            // The axis of a value that hardly changes is wider than its range.
            let shown = (widest[1] - widest[0]).max(LEAST_RANGE * widest[0].abs().max(widest[1].abs()));
            let stands_out = |value: f64| [start, last].iter().all(|&other| apart(value, other) > EXTREME * shown);
            let extreme = extreme.filter(|[_, value]| one.diverged.is_none() && stands_out(*value));
            own.extend(extreme.map(|&[time, most]| {
                let which = if most > start { "highest" } else { "lowest" };
                event(one, time, extreme_of(which, quantity, &value(most)), "at")
            }));
        }
        let word = if one.is_end { RECORDING_ENDS } else { DIVERGES };
        own.extend(one.diverged.map(|time| event(one, time, word.to_owned(), "at")));
        all.extend(own.into_iter().enumerate());
    }
    all.sort_by_key(|&(rank, _)| rank);
    all.truncate(MOST);
    let mut events: Vec<_> = all.into_iter().map(|(_, event)| event).collect();
    events.sort_by(|one, other| one.time.total_cmp(&other.time));
    events
}

/// The possible events of a run of a scene, in the narrowest words.
pub(in crate::picture) fn narrowest(plot: &Plot, scene: &Scene) -> Vec<Event> {
    let at = number::time(1e-3 * scene.duration.min(1.0), scene.duration);
    let event = |words: String, joint: &str| Event { run: 0, time: 0.0, words: wordings(words, joint, &at) };
    if plot.diagnostic() == Some(Diagnostic::TurnedOver) {
        return vec![event("first turned over".to_owned(), "at"), event("settles at 1".to_owned(), "after")];
    }
    vec![event(extreme_of("lowest", &named(plot, scene), "0.12 mm"), "at")]
}

/// The quantity of a chart of a scene where its extremes name it: where there are others.
pub(super) fn named(plot: &Plot, scene: &Scene) -> String {
    if scene.view.charts.len() > 1 { quantity(plot, scene) } else { String::new() }
}

/// An extreme in words.
fn extreme_of(which: &str, quantity: &str, value: &str) -> String {
    [which, quantity, value].into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
}

/// The words of an event at a time: whole, shorter, and without the time.
fn wordings(words: String, joint: &str, time: &str) -> [String; 3] {
    let short = words.strip_suffix(" turned over").or(words.strip_prefix("settles at ")).unwrap_or(&words);
    let [whole, short] = [&*words, short].map(|words| format!("{words} {joint} {time}"));
    [whole, short, words]
}

/// The time (s) at which the scale of time changes in a scene up to an end (s): soon after nearly all changes, if that
/// is early.
pub(in crate::picture) fn split(series: &[Series], end: f64) -> Option<f64> {
    let steps =
        series.iter().flat_map(|one| one.points.windows(2).map(|two| (two[1][0], (two[1][1] - two[0][1]).abs())));
    let mut steps: Vec<_> = steps.filter(|&(_, change)| change > 0.0 && change.is_finite()).collect();
    steps.sort_by(|one, other| one.0.total_cmp(&other.0));
    let all: f64 = steps.iter().map(|(_, change)| change).sum();
    let mut sum = 0.0;
    let (nearly, _) = steps.iter().find(|(_, change)| {
        sum += change;
        sum >= NEARLY_ALL * all
    })?;
    let below = number::round_below(*nearly);
    let after = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
        .map(|times| times * below)
        .into_iter()
        .find(|round| round > nearly)?;
    (*nearly <= SHORT * end && after < 0.5 * end).then_some(after)
}

impl Writer<'_> {
    /// The number of a run's events, from the first one on, whose words fit into a panel.
    pub(in crate::picture) fn explained(&self, panel: Rectangle, events: &[&Event]) -> usize {
        let room = WordPlaces::new(self.scale, panel).width();
        let fits = |count: &usize| self.events_width(events[..*count].iter().copied(), 2) <= room;
        (0..=events.len()).rev().find(fits).filter(|_| Scale::legible(self.scale.caption())).unwrap_or(0)
    }

    /// The width of events in one of their wordings (px).
    fn events_width<'e>(&self, events: impl Iterator<Item = &'e Event>, at: usize) -> f64 {
        let (unit, size) = (self.scale.type_unit(), self.scale.caption());
        let [beside, apart] = [NEAR, GAP].map(|length| length * unit);
        let one = 2.0 * EVENT_RING * self.scale.small() + beside + apart;
        let all: f64 = events.map(|event| one + self.fonts.width(&event.words[at], Weight::Regular, size)).sum();
        (all - apart).max(0.0)
    }

    /// The events of a run, each with a number in a ring of a colour, in a line below its heading, with as many words
    /// as fit. The rings of past events are filled.
    pub(in crate::picture) fn events<'e>(
        &mut self,
        panel: Rectangle,
        events: impl Iterator<Item = (usize, &'e Event)>,
        colour: Colour,
        now: f64,
    ) {
        let words = WordPlaces::new(self.scale, panel);
        let (unit, size) = (self.scale.type_unit(), self.scale.caption());
        let events: Vec<_> = events.collect();
        let number_size = self.scale.small();
        let radius = EVENT_RING * number_size;
        let [beside, apart] = [NEAR, GAP].map(|length| length * unit);
        let wide = |words: &str| 2.0 * radius + beside + self.fonts.width(words, Weight::Regular, size);
        let width = |at: usize| self.events_width(events.iter().map(|(_, event)| *event), at);
        let Some(at) = (0..=2).find(|&at| width(at) <= words.width()) else { return };
        let (mut left, baseline) = (words.left, words.events);
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

#[cfg(test)]
mod tests {
    use super::super::axis::Kind;
    use super::*;
    use crate::look::LineStyle;

    fn series(run: usize, is_count: bool, points: &[[f64; 2]]) -> Series {
        let style = LineStyle { colour: [0; 3], dash: &[] };
        Series { is_count, ..Series::plain(run, style, points.to_vec()) }
    }

    /// The events beside the axis of a diagnostic of a body of 0.3 m.
    fn words(diagnostic: Diagnostic, series: &[Series]) -> Vec<String> {
        let range = super::super::series::range(series, true).expect("values");
        let axis = Stretch::new(Kind::Value, range, diagnostic.unit(), 0.3, 4);
        events(series, Some(&axis), "", 3.0).into_iter().map(|event| event.words[0].clone()).collect()
    }

    #[test]
    fn counts_begin_and_settle() {
        let springs = series(1, true, &[[0.0, 0.0], [0.02, 3.0], [0.03, 9.0], [0.085, 8.0], [0.1, 9.0], [3.0, 9.0]]);
        let shape = series(0, true, &[[0.0, 0.0], [3.0, 0.0]]);
        let told = words(Diagnostic::TurnedOver, &[shape, springs.clone()]);
        assert_eq!(told, ["first turned over at 20 ms", "settles at 9 after 100 ms"]);
        // A run that changes at the end has not settled, and one that never changes has no events.
        let restless = series(0, true, &[[0.0, 0.0], [1.0, 1.0], [2.9, 2.0]]);
        assert_eq!(words(Diagnostic::TurnedOver, &[restless]), ["first turned over at 1.00 s"]);
        let flat = series(0, true, &[[0.0, 0.0], [0.02, 8.0], [0.1, 0.0], [3.0, 0.0]]);
        let told = words(Diagnostic::TurnedOver, &[flat]);
        assert_eq!(told, ["first turned over at 20 ms", "none after 100 ms"]);
        // "First at 20 ms, none after 20 ms" would contradict itself.
        let brief = series(0, true, &[[0.0, 0.0], [0.0196, 1.0], [0.0204, 0.0], [3.0, 0.0]]);
        assert_eq!(words(Diagnostic::TurnedOver, &[brief]), ["turned over briefly at 20 ms"]);
        assert_eq!(wordings("first turned over".to_owned(), "at", "20 ms")[1], "first at 20 ms");
        assert_eq!(wordings("settles at 9".to_owned(), "after", "113 ms")[1], "9 after 113 ms");
        let many: Vec<_> = (0..20).map(|run| Series { run, ..springs.clone() }).collect();
        assert_eq!(words(Diagnostic::TurnedOver, &many), vec!["first turned over at 20 ms"; MOST]);
    }

    #[test]
    fn values_have_extremes_that_stand_out() {
        let error = series(0, false, &[[0.0, 0.0], [0.05, 0.102], [1.0, 0.01], [3.0, 0.005]]);
        assert_eq!(words(Diagnostic::ShapeError, &[error]), ["highest 102 mm at 50 ms"]);
        let volume = series(0, false, &[[0.0, 1.0], [0.05, 0.6], [3.0, 1.0]]);
        assert_eq!(words(Diagnostic::VolumeRatio, &[volume]), ["lowest 0.6 at 50 ms"]);
        let near = series(0, false, &[[0.0, 1.0], [0.05, 0.9965], [3.0, 1.0]]);
        assert_eq!(words(Diagnostic::VolumeRatio, &[near]), ["lowest 0.997 at 50 ms"]);
        // Beside an axis in micrometres, "< 0.1 mm" would say nothing; beside one in metres, −830 mm little.
        let small = series(0, false, &[[0.0, 0.0], [0.05, 3.141e-5], [3.0, 0.0]]);
        assert_eq!(words(Diagnostic::ShapeError, &[small]), ["highest 31.4 µm at 50 ms"]);
        let far = series(0, false, &[[0.0, 0.0], [0.05, -0.8304], [3.0, 0.0]]);
        assert_eq!(words(Diagnostic::ShapeError, std::slice::from_ref(&far)), ["lowest −0.83 m at 50 ms"]);
        let axis = Stretch::new(Kind::Value, [-0.9, 0.0], "m", 0.3, 3);
        let among_others = &events(&[far], Some(&axis), "displacement of end", 3.0)[0].words;
        assert_eq!(among_others[0], "lowest displacement of end −0.83 m at 50 ms");
        assert_eq!(among_others[2], "lowest displacement of end −0.83 m");
        // What stays but for round-off has none.
        let kept = series(0, false, &[[0.0, 30.0], [0.05, 30.0 - 1e-12], [3.0, 30.0]]);
        assert!(words(Diagnostic::Momentum, &[kept]).is_empty());
        let rising = series(0, false, &[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]);
        let blown = Series { diverged: Some(0.971), ..rising.clone() };
        assert_eq!(words(Diagnostic::Kinetic, &[rising, blown]), ["diverges at 971 ms"]);
    }

    #[test]
    fn time_has_two_scales_where_all_happens_early() {
        let early = series(0, true, &[[0.0, 0.0], [0.02, 3.0], [0.085, 9.0], [3.0, 9.0]]);
        assert_eq!(split(std::slice::from_ref(&early), 3.0), Some(0.1));
        assert_eq!(split(std::slice::from_ref(&early), 0.5), None);
        let late = series(1, true, &[[0.0, 0.0], [2.0, 3.0], [3.0, 3.0]]);
        assert_eq!(split(&[early, late], 3.0), None);
        assert_eq!(split(&[series(0, true, &[[0.0, 0.0], [3.0, 0.0]])], 3.0), None);
    }
}
