//! Names at the ends of curves, right of a chart. Names of close ends are moved apart, and thin lines lead to them.

use super::Item;
use super::caption::{Writer, letter};
use super::chart::{Chart, NUMBERS};
use super::layout::{CURVE_NAME, Scale};
use super::series::{DOTS, OWN, Series};
use super::text::{Fonts, Weight};

/// The gap from the chart to the names, with room for the mark of the present moment (px in the reference picture).
const GAP: f64 = 14.0;
/// With more names than this, a sample of its line stands before each name; its length, and the gap after it (px in the
/// reference picture).
const FEW: usize = 4;
const SAMPLE: [f64; 2] = [30.0, 6.0];
/// The gaps at both ends of a leader line, its width (px in the reference picture), and its opacity. It is dotted if
/// its curve ends early, or it would look like a part of the curve.
const FREE: f64 = 3.0;
const LEADER: f64 = 1.0;
const LEADER_ALPHA: f64 = 0.7;
/// A name that is moved by less than this needs no line (px in the reference picture).
const HARDLY: f64 = 3.0;
/// The least room for names (sizes of type).
const LEAST_ROOM: f64 = 3.0;
/// If a name is longer than this many times its room, all names are replaced by the letters of panels.
const LONG: f64 = 1.2;

/// The names of several curves.
#[derive(Debug)]
pub(super) struct Ends {
    /// A name for each curve, shortened to the room, and whether it differs from all others.
    names: Vec<(String, bool)>,
    /// The width of the sample before each, with its gap (px).
    sample: f64,
    /// Their width right of the chart, with the gap (px).
    pub(super) width: f64,
}

impl Ends {
    /// The names of curves in a room of a width and a height (px). `None` for a single run, which needs no name, and if
    /// no name would be legible or unique. Panels may have letters beside these names.
    pub(super) fn new(
        fonts: &Fonts,
        series: &[Series],
        unit: f64,
        [width, height]: [f64; 2],
        have_letters: bool,
    ) -> Option<Self> {
        let size = NUMBERS * unit;
        let shown = series.iter().filter(|one| !one.points.is_empty()).count();
        let sample = if shown > FEW { SAMPLE.iter().sum::<f64>() * unit } else { 0.0 };
        let room = width - GAP * unit - sample;
        if shown == 0
            || series.len() < 2
            || fitting(height, unit) == 0
            || room < LEAST_ROOM * size
            || !Scale::legible(size)
        {
            return None;
        }
        let whole: Vec<_> = series.iter().map(|one| &*one.name).collect();
        let is_long = |name: &&str| fonts.width(name, Weight::Regular, size) > LONG * room;
        let by_letter = have_letters && whole.iter().any(is_long);
        let name = |(at, name): (usize, &&str)| match by_letter {
            true => letter(at),
            false => fonts.told_apart(name, &whole, Weight::Regular, size, room),
        };
        let names: Vec<_> = whole.iter().enumerate().map(name).collect();
        let is_alike =
            |at: usize| series.iter().zip(&names).any(|(one, name)| names[at] == *name && one.name != series[at].name);
        let are_clear: Vec<_> = (0..names.len()).map(|at| !is_alike(at)).collect();
        let widest = names.iter().map(|name| fonts.width(name, Weight::Regular, size)).fold(0.0, f64::max);
        let width = GAP * unit + sample + widest;
        are_clear.contains(&true).then(|| Self { names: names.into_iter().zip(are_clear).collect(), sample, width })
    }

    /// Writes the names beside a chart, between two heights (px), as many as fit. `ends` are the ends of the curves
    /// (px) that have any.
    pub(super) fn write(
        &self,
        writer: &mut Writer<'_>,
        chart: Chart,
        series: &[Series],
        ends: &[Option<[f64; 2]>],
        [top, bottom]: [f64; 2],
    ) {
        let (unit, size) = (chart.unit, NUMBERS * chart.unit);
        let all = (0..series.len()).filter(|&at| self.names[at].1);
        let all: Vec<_> = all.filter_map(|at| Some((at, ends[at]?))).collect();
        let mut order = farthest(all, fitting(bottom - top, unit));
        order.sort_by(|(_, [_, one]), (_, [_, other])| one.total_cmp(other));
        let heights: Vec<_> = order.iter().map(|&(_, [_, y])| y).collect();
        let half = 0.5 * CURVE_NAME * unit;
        let places = spread(&heights, CURVE_NAME * unit, [top + half, bottom - half]);
        let left = chart.right + GAP * unit;
        for (&(at, [x, y]), &place) in order.iter().zip(&places) {
            let one = &series[at];
            let is_early = x < chart.right - 1.0;
            if is_early || (place - y).abs() > HARDLY * unit {
                let free = FREE * unit;
                let from = [x + if is_early { 2.0 * free } else { free }, y];
                let to = [left - free, place];
                let points = if is_early { vec![from, [chart.right, y], to] } else { vec![from, to] };
                let dash = DOTS.map(|length| length * unit);
                let dash = if is_early { &dash[..] } else { &[] };
                let paint = (one.style.colour, LEADER_ALPHA);
                writer.curves.push(Item::curve(&points, LEADER * chart.unit, dash, paint));
            }
            if self.sample > 0.0 {
                let length = SAMPLE[0] * unit;
                let dash: Vec<_> = one.style.dash.iter().map(|length| length * chart.line).collect();
                let ends = [[left, place], [left + length, place]];
                writer.curves.push(Item::curve(&ends, OWN * chart.line, &dash, one.style.colour));
            }
            let colour = writer.palette.text_like(one.style.colour);
            writer.left(&self.names[at].0, Weight::Regular, size, colour, left + self.sample, place + 0.36 * size);
        }
    }
}

/// The number of names that fit above each other into a height (px).
fn fitting(height: f64, unit: f64) -> usize {
    (height / (CURVE_NAME * unit) + 1e-6) as usize
}

/// At most `most` ends of curves: the first one, then repeatedly the one farthest from all chosen ones.
fn farthest(mut all: Vec<(usize, [f64; 2])>, most: usize) -> Vec<(usize, [f64; 2])> {
    if all.len() <= most || most == 0 {
        all.truncate(most);
        return all;
    }
    let mut chosen = vec![all.remove(0)];
    while chosen.len() < most {
        let apart = |(_, [_, y]): &(usize, [f64; 2])| {
            chosen.iter().map(|(_, [_, other])| (y - other).abs()).fold(f64::INFINITY, f64::min)
        };
        let next = (0..all.len()).max_by(|&one, &other| apart(&all[one]).total_cmp(&apart(&all[other])));
        chosen.extend(next.map(|next| all.remove(next)));
    }
    chosen
}

/// The places nearest to given rising ones that are at least `apart` from each other and within two ends (isotonic
/// regression).
pub(super) fn spread(places: &[f64], apart: f64, [low, high]: [f64; 2]) -> Vec<f64> {
    // Neighbours that would be too close are centred around their common mean.
    let mut groups: Vec<(f64, usize)> = Vec::new();
    for (at, place) in places.iter().enumerate() {
        let mut group = (place - at as f64 * apart, 1);
        while let Some(&(middle, count)) = groups.last().filter(|last| last.0 > group.0) {
            groups.pop();
            group = ((middle * count as f64 + group.0 * group.1 as f64) / (count + group.1) as f64, count + group.1);
        }
        groups.push(group);
    }
    let most = (high - places.len().saturating_sub(1) as f64 * apart).max(low);
    let all = groups.into_iter().flat_map(|(middle, count)| std::iter::repeat_n(middle.clamp(low, most), count));
    all.enumerate().map(|(at, middle)| middle + at as f64 * apart).collect()
}

#[cfg(test)]
mod tests {
    use super::{farthest, spread};

    #[test]
    fn where_few_names_have_room_those_apart_are_chosen() {
        let all: Vec<_> = [10.0, 11.0, 12.0, 50.0, 90.0].into_iter().map(|y| [0.0, y]).enumerate().collect();
        let chosen = |most| farthest(all.clone(), most).iter().map(|one| one.0).collect::<Vec<_>>();
        assert_eq!((chosen(1), chosen(2), chosen(3)), (vec![0], vec![0, 4], vec![0, 4, 3]));
        assert_eq!((chosen(5), chosen(0)), (vec![0, 1, 2, 3, 4], vec![]));
    }

    #[test]
    fn places_part_as_little_as_they_must() {
        let near = |places: &[f64], expected: &[f64]| {
            let found = spread(places, 20.0, [0.0, 100.0]);
            let off = found.iter().zip(expected).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
            assert!(found.len() == expected.len() && off < 1e-9, "{places:?}: {found:?}");
        };
        near(&[0.0, 50.0, 100.0], &[0.0, 50.0, 100.0]);
        near(&[50.0, 50.0, 53.0], &[31.0, 51.0, 71.0]);
        near(&[0.0, 2.0], &[0.0, 20.0]);
        near(&[98.0, 99.0], &[80.0, 100.0]);
        near(&[], &[]);
    }
}
