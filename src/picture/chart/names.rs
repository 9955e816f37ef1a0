//! Names at the ends of lines, right of a chart.

use super::series::{OWN, Series};
use super::{Chart, NUMBERS, Place};
use crate::colour::Colour;
use crate::picture::caption::Writer;
use crate::picture::layout::{CURVE_NAME, Scale};
use crate::picture::text::{Fonts, Weight};

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
/// Lengths of dots and gaps of thin lines (px in the reference picture).
pub(super) const DOTS: [f64; 2] = [1.0, 3.5];
/// A name that is moved by less than this needs no line (px in the reference picture).
const HARDLY: f64 = 3.0;
/// The least room for names (sizes of type).
const LEAST_ROOM: f64 = 3.0;

/// A name at the end of a line, one of [`Annotation::Names`](super::Annotation::Names).
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// Its text, on one line.
    pub text: String,
    /// The end of the line, in the values of the axes.
    pub end: [f64; 2],
    /// The colour of the line.
    pub colour: Colour,
    /// The dashes of the line (px), for a sample before the name; `None` without a sample.
    pub sample: Option<Vec<f64>>,
}

/// Names of runs in a room beside charts.
#[derive(Clone, Debug)]
pub(super) struct Shortened {
    /// A name for each run, shortened to the room.
    names: Vec<String>,
    with_samples: bool,
    /// Their width right of the chart, with the gap (px).
    pub width: f64,
}

impl Shortened {
    /// The names of runs in a room of a width and a height (px). `None` for a single run, which needs no name, and if no
    /// name would be legible.
    pub(super) fn new(fonts: &Fonts, series: &[Series], unit: f64, [width, height]: [f64; 2]) -> Option<Self> {
        let size = NUMBERS * unit;
        let shown = series.iter().filter(|one| !one.points.is_empty()).count();
        let with_samples = shown > FEW;
        let before = GAP * unit + if with_samples { SAMPLE.iter().sum::<f64>() * unit } else { 0.0 };
        let room = width - before;
        let has_room = fitting(height, unit) > 0 && room >= LEAST_ROOM * size && Scale::legible(size);
        if shown == 0 || series.len() < 2 || !has_room {
            return None;
        }
        let whole: Vec<_> = series.iter().map(|one| &*one.name).collect();
        let short = |name: &&str| fonts.told_apart(name, &whole, Weight::Regular, size, room);
        let names: Vec<_> = whole.iter().map(short).collect();
        let widest = names.iter().map(|name| fonts.width(name, Weight::Regular, size)).fold(0.0, f64::max);
        Some(Self { names, with_samples, width: before + widest })
    }

    /// The names at the ends of time series that have values.
    pub(super) fn at(&self, series: &[Series]) -> Vec<Name> {
        let name = |(one, text): (&Series, &String)| {
            let sample = self.with_samples.then(|| one.style.dash.to_vec());
            Some(Name { text: text.clone(), end: *one.points.last()?, colour: one.style.colour, sample })
        };
        series.iter().zip(&self.names).filter_map(name).collect()
    }
}

/// Writes names right of a chart, as many as fit above each other within an extent above and below it (px).
pub(super) fn write(writer: &mut Writer<'_>, chart: &Chart, place: Place, names: &[Name], beyond: [f64; 2]) {
    let (unit, size) = (place.unit, NUMBERS * place.unit);
    let [top, bottom] = [place.top - beyond[0], place.bottom + beyond[1]];
    let end =
        |one: &Name| [place.x(&chart.x, one.end[0]), place.y(&chart.y, one.end[1]).clamp(place.top, place.bottom)];
    let all = names.iter().enumerate().map(|(at, one)| (at, end(one))).collect();
    let mut order = farthest(all, fitting(bottom - top, unit));
    order.sort_by(|(_, [_, one]), (_, [_, other])| one.total_cmp(other));
    let heights: Vec<_> = order.iter().map(|&(_, [_, y])| y).collect();
    let half = 0.5 * CURVE_NAME * unit;
    let places = spread(&heights, CURVE_NAME * unit, [top + half, bottom - half]);
    let left = place.right + GAP * unit;
    for (&(at, [x, y]), &height) in order.iter().zip(&places) {
        let Name { text, colour, .. } = &names[at];
        let is_early = x < place.right - 1.0;
        if is_early || (height - y).abs() > HARDLY * unit {
            let free = FREE * unit;
            let from = [x + if is_early { 2.0 * free } else { free }, y];
            let to = [left - free, height];
            let points = if is_early { vec![from, [place.right, y], to] } else { vec![from, to] };
            let dash = if is_early { &DOTS[..] } else { &[] };
            writer.curves.push(place.curve(&points, LEADER, dash, (*colour, LEADER_ALPHA)));
        }
        let mut start = left;
        if let Some(dash) = &names[at].sample {
            let ends = [[left, height], [left + SAMPLE[0] * unit, height]];
            writer.curves.push(place.curve(&ends, OWN, dash, *colour));
            start += SAMPLE.iter().sum::<f64>() * unit;
        }
        let colour = writer.palette.text_like(*colour);
        writer.left(text, Weight::Regular, size, colour, start, height + 0.36 * size);
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
pub(in crate::picture) fn spread(places: &[f64], apart: f64, [low, high]: [f64; 2]) -> Vec<f64> {
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
