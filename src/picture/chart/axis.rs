//! Round numbers along an axis of a chart or a scale of colours.

use crate::picture::number::{self, times_ten, with_minus};
use crate::reading::captions::{power_of_ten, prefix, rounded, scientific, takes_prefix};

/// The quantity along an axis, which determines its division.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::picture) enum Kind {
    /// A value. The axis ends at its ends.
    Fixed,
    /// A number of things.
    Count,
    /// A value. The axis may end at round numbers beyond its ends.
    Value,
}

/// An axis of a chart: a stretch of numbers, or two with a gap between where its scale changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis(pub(in crate::picture) Vec<Stretch>);

/// A stretch of an axis: a range with numbers on it.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::picture) struct Stretch {
    /// The ends of the range.
    pub range: [f64; 2],
    /// Its ends on the axis, which goes from 0 to 1.
    pub along: [f64; 2],
    /// Whether equal ratios of values are equally far apart.
    pub is_logarithmic: bool,
    /// The values with numbers, rising.
    pub ticks: Vec<f64>,
    /// The text at each of the ticks.
    pub texts: Vec<String>,
    /// The unit of the texts, with its prefix, and how large it is.
    pub unit: String,
    pub factor: f64,
}

/// An axis ends at round numbers that enclose its values, if these fill at least this part of it.
const FULL: f64 = 0.66;
/// Otherwise it extends to the next round number up to one of these parts of its range away, the first with few ticks, or else by the last
/// part, so that no curve runs along its border.
const NEAR: [f64; 3] = [0.3, 0.13, 0.0];
const BEYOND: f64 = 0.05;

impl Axis {
    /// An axis between two values, with texts at some of them.
    pub fn linear(range: [f64; 2], texts: Vec<(f64, String)>) -> Self {
        let (ticks, texts) = texts.into_iter().unzip();
        Self(vec![Stretch { range, ticks, texts, ..Stretch::default() }])
    }

    /// A logarithmic axis between two positive values, with numbers at powers of ten, at most `most` of them. A short
    /// one has numbers at twos and fives, too.
    pub fn logarithmic(ends: [f64; 2], most: usize) -> Self {
        let [low, high] = ends.map(|end| end.clamp(f64::MIN_POSITIVE, f64::MAX)).map(libm::log10);
        // Numbers far from 1 are powers of ten, on the whole axis.
        let is_plain = low > -3.5 && high < 4.5;
        let is_on = |&(power, digit): &(i32, f64)| {
            (low - 1e-9..=high + 1e-9).contains(&(f64::from(power) + libm::log10(digit)))
        };
        let powers = libm::floor(low) as i32..=libm::ceil(high) as i32;
        let at = |digits: &'static [f64]| {
            let all = powers.clone().flat_map(move |power| digits.iter().map(move |&digit| (power, digit)));
            all.filter(is_on).collect::<Vec<_>>()
        };
        let fine = Some(at(&[1.0, 2.0, 5.0])).filter(|all| is_plain && high - low < 2.5 && all.len() <= most);
        let all = fine.unwrap_or_else(|| {
            let all = at(&[1.0]);
            let apart = (1..).find(|apart| all.len() as i32 <= most.max(1) as i32 * apart).unwrap_or(1);
            all.into_iter().filter(|(power, _)| power.rem_euclid(apart) == 0).collect()
        });
        let text = |&(power, digit): &(i32, f64)| match is_plain {
            true => times_ten(digit, f64::from(power)).to_string(),
            false => power_of_ten(power),
        };
        Self(vec![Stretch {
            range: [low, high].map(libm::exp10),
            is_logarithmic: true,
            texts: all.iter().map(text).collect(),
            ticks: all.iter().map(|&(power, digit)| times_ten(digit, f64::from(power))).collect(),
            ..Stretch::default()
        }])
    }

    /// The place of a value: 0 at the low end, 1 at the high end, and beyond for values outside.
    pub fn share(&self, value: f64) -> f64 {
        let Some(on) = self.stretch(value) else { return f64::NAN };
        on.along[0] + on.share(value) * (on.along[1] - on.along[0])
    }

    /// The stretch of a value, the last one for values beyond all.
    pub(super) fn stretch(&self, value: f64) -> Option<&Stretch> {
        self.0.iter().find(|stretch| value <= stretch.range[1]).or(self.0.last())
    }
}

impl Default for Stretch {
    /// A whole axis of even numbers without a unit, from 0 to 1.
    fn default() -> Self {
        let (ticks, texts, unit) = Default::default();
        Self { range: [0.0, 1.0], along: [0.0, 1.0], is_logarithmic: false, ticks, texts, unit, factor: 1.0 }
    }
}

impl Stretch {
    /// A stretch for values of a unit between two ends, with at least two and at most `most` ticks, if there are such
    /// round numbers. Lengths have the unit for a body of a size (m) unless they are far larger or smaller. The unit is one in which no number
    /// has four digits, however many ticks there are.
    pub(in crate::picture) fn new(kind: Kind, [low, high]: [f64; 2], unit: &str, extent: f64, most: usize) -> Self {
        let prefix = |largest: f64| match unit {
            "m" if number::suits(largest, extent) => number::metre(extent),
            // Kiloseconds are not in use.
            "s" => prefix(largest.min(1.0)),
            _ if takes_prefix(unit) => prefix(largest),
            _ => (1.0, ""),
        };
        let size = |[low, high]: [f64; 2]| low.abs().max(high.abs());
        let mut largest = size([low, high]);
        if high - low > 0.0 && (high - low).is_finite() {
            let (factor, _) = prefix(largest);
            let with = |most: usize| factor * size(divide(kind, [low / factor, high / factor], most).range);
            largest = [2, 3, 4, most.max(2)].map(with).into_iter().fold(largest, f64::max);
        }
        let (factor, prefix) = prefix(largest);
        let unit = format!("{prefix}{unit}");
        let [low, high] = [low / factor, high / factor];
        let span = high - low;
        if !(span > 0.0 && span.is_finite()) {
            // The value is constant.
            let ticks = match (kind, low) {
                (Kind::Count, 0.0) => vec![0.0, 1.0],
                (_, 0.0) => vec![0.0],
                _ => Vec::new(),
            };
            let texts = ticks.iter().map(f64::to_string).collect();
            let range = [low * factor, low * factor + (low * factor).abs().max(1.0)];
            return Self { range, ticks, texts, unit, factor, ..Self::default() };
        }
        let division = divide(kind, [low, high], most.max(2));
        let digits = (libm::log10(largest / factor / span).max(0.0) + 3.0) as usize;
        let plain = division.decimals <= 4 && largest / factor < 99_999.5;
        let text = |value: f64| match plain {
            // Adjacent numbers may have different numbers of decimals.
            _ if value == 0.0 => "0".to_owned(),
            true => with_minus(format!("{value:.*}", division.decimals)),
            false => with_minus(scientific(rounded(value, digits))),
        };
        Self {
            range: division.range.map(|end| end * factor),
            ticks: division.ticks.iter().map(|tick| tick * factor).collect(),
            texts: division.ticks.iter().copied().map(text).collect(),
            unit,
            factor,
            ..Self::default()
        }
    }

    /// A value in the unit of the numbers beside it, to three digits of the largest one, and two of the range.
    pub(super) fn in_words(&self, value: f64) -> String {
        let [low, high] = self.range;
        let [largest, span] =
            [low.abs().max(high.abs()), high - low].map(|size| (size / self.factor).clamp(1e-300, 1e300));
        let power = libm::floor((libm::log10(largest) - 2.0).min(libm::log10(span) - 1.0));
        let value = times_ten(libm::round(value / self.factor * libm::exp10(-power)), power);
        let text = if (-6.0..3.0).contains(&power) { value.to_string() } else { scientific(value) };
        with_minus(format!("{text} {}", self.unit)).trim_end().to_owned()
    }

    /// The place of a value: 0 at the low end, 1 at the high end.
    pub(in crate::picture) fn share(&self, value: f64) -> f64 {
        let scaled = |value: f64| if self.is_logarithmic { libm::log10(value) } else { value / 2.0 };
        let [low, high] = self.range.map(scaled);
        (scaled(value) - low) / (high - low)
    }
}

/// A range divided by round numbers.
struct Division {
    range: [f64; 2],
    ticks: Vec<f64>,
    decimals: usize,
    /// The number of ticks, plus one for each end with a tick.
    worth: usize,
    /// The part of the range that the values fill.
    filled: f64,
}

impl Division {
    /// The division of values with a step of a digit times a power of ten. It extends to the next round number up to a part `near` of the values
    /// away.
    fn new(kind: Kind, [low, high]: [f64; 2], (digit, power): (f64, f64), near: f64, most: usize) -> Self {
        let step = times_ten(digit, power);
        let [from, to] = [low / step, high / step];
        let [mut first, mut last] = [libm::ceil(from - 1e-6), libm::floor(to + 1e-6)];
        let mut range = [low, high];
        let [below, above] = [from - (first - 1.0), last + 1.0 - to].map(|parts| parts % 1.0 * step / (high - low));
        let apart = |parts: f64| (1e-6..1.0 - 1e-6).contains(&parts.rem_euclid(1.0));
        if kind != Kind::Fixed {
            if apart(from) {
                let near = below <= near;
                first -= f64::from(u8::from(near));
                range[0] = if near { first * step } else { low - BEYOND * (high - low) };
            }
            if apart(to) {
                let near = above <= near;
                last += f64::from(u8::from(near));
                range[1] = if near { last * step } else { high + BEYOND * (high - low) };
            }
        }
        let count = (last - first + 1.0) as usize;
        let at_end = |tick: f64, end: f64| usize::from((tick * step - end).abs() <= 1e-6 * (high - low));
        let worth = count + at_end(first, range[0]) + at_end(last, range[1]);
        let ticks = (0..count.min(2 * most + 1)).map(|at| (first + at as f64) * step).collect();
        let decimals = (-power).clamp(0.0, 300.0) as usize + usize::from(digit == 2.5 && power <= 0.0);
        Self { range, ticks, decimals, worth, filled: (high - low) / (range[1] - range[0]) }
    }

    /// How good it is: among equals three ticks are better than two, and then ticks at the ends, 0, 5, 10 instead of 0, 3, 6, 9.
    fn rank(&self, kind: Kind) -> [usize; 3] {
        let (worth, count) = (self.worth, self.ticks.len());
        match kind {
            Kind::Fixed => [usize::from(worth == count + 2), count, 0],
            _ => [worth, count.min(3), worth - count],
        }
    }
}

/// The division of values by few round numbers that enclose them: another tick is worth a tenth of the axis.
fn enclosing(kind: Kind, ends: [f64; 2], highest: f64, most: usize) -> Option<Division> {
    let digits: &[f64] = if kind == Kind::Count { &[5.0, 2.0, 1.0, 4.0, 3.0] } else { &[5.0, 2.0, 1.0, 4.0, 3.0, 2.5] };
    let powers = [1.0, 0.0, -1.0].map(|more| highest + more);
    let steps = powers.into_iter().flat_map(|power| digits.iter().map(move |&digit| (digit, power)));
    let whole = steps.filter(|&(_, power)| kind != Kind::Count || power >= 0.0);
    let all = whole.map(|step| (step.0, Division::new(kind, ends, step, 1.0, most)));
    let good = all.filter(|(digit, division)| {
        let few = if [5.0, 2.0, 1.0].contains(digit) { most } else { most.min(4) };
        (2..=few).contains(&division.ticks.len()) && division.filled >= FULL
    });
    let worth = |division: &Division| division.filled + 0.1 * division.ticks.len().min(5) as f64;
    // The first of equals.
    good.map(|(_, division)| division)
        .reduce(|best, other| if worth(&other) > worth(&best) + 1e-9 { other } else { best })
}

/// The division by round numbers that enclose the values, or else with most ticks, preferably with ticks at its ends. If these are fixed, ticks
/// at both ends take precedence over their number.
fn divide(kind: Kind, [low, high]: [f64; 2], most: usize) -> Division {
    let highest = libm::floor(libm::log10(high - low));
    if let Some(found) =
        Some(kind).filter(|&kind| kind != Kind::Fixed).and_then(|kind| enclosing(kind, [low, high], highest, most))
    {
        return found;
    }
    let digits: &[f64] = match kind {
        Kind::Count => &[5.0, 3.0, 2.0, 1.0],
        Kind::Value => &[5.0, 2.0, 1.0],
        Kind::Fixed => &[5.0, 2.5, 2.0, 1.0],
    };
    // Counts have no fractions.
    let powers = [highest, highest - 1.0].map(|power| if kind == Kind::Count { power.max(0.0) } else { power });
    let steps = powers.into_iter().flat_map(|power| digits.iter().map(move |&digit| (digit, power)));
    // With or without an extension to a round number farther or nearer.
    let ways = steps.flat_map(|step| NEAR.map(|near| (step, near)));
    let mut all: Vec<_> = ways.map(|(step, near)| Division::new(kind, [low, high], step, near, most)).collect();
    let best = (0..all.len()).filter(|&at| (2..=most).contains(&all[at].ticks.len()));
    let best = best.rev().max_by_key(|&at| all[at].rank(kind));
    // Some ranges have too many ticks or too few with every step. Then every second of too many is kept.
    let crowded = || (0..all.len()).filter(|&at| all[at].ticks.len() > most).min_by_key(|&at| all[at].ticks.len());
    let best = best.or_else(crowded).unwrap_or(0);
    let mut division = all.swap_remove(best);
    if division.ticks.len() > most {
        division.ticks = division.ticks.into_iter().step_by(2).take(most).collect();
    }
    division
}

#[cfg(test)]
#[path = "../../../tests/inside/axis.rs"]
mod tests;
