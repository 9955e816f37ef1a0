//! Names at the ends of lines, right of a chart.

use super::series::Series;
use super::{Chart, PlotArea};
use crate::colour::Colour;
use crate::picture::Item;
use crate::picture::caption::Writer;
use crate::picture::layout::Scale;
use crate::picture::layout::steps::{APART, BESIDE, FREE, GAP, HAIR, NEAR, SMALL, STRONG};
use crate::picture::text::{Fonts, Weight};

/// The opacity of a leader line. It is dotted if its curve ends early, or it would look like a part of the curve.
const LEADER: f64 = 0.7;
/// Lengths of dots and gaps of thin lines (px in the reference picture).
pub(super) const DOTS: [f64; 2] = [HAIR, FREE];

/// A name at the end of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// Its text, on one line.
    pub text: String,
    /// The end of the line, in the values of the axes.
    pub end: [f64; 2],
    /// The colour of the line.
    pub colour: Colour,
    /// The lengths of its dashes and gaps in turn (px); empty for a solid line. Where one of the names has dashes, all have a sample of their
    /// line before them: the ends of lines on each other look alike.
    pub dash: Vec<f64>,
}

/// The width of the names of series right of a chart, with the gap, in a room of a width (px), and whether their dashes have samples. `None` for
/// a single run, which needs no name, and if not all names have room: samples of lines beside the names of panels and of rows are a key
/// without them.
pub(super) fn width(fonts: &Fonts, series: &[Series], unit: f64, room: f64) -> Option<(f64, bool)> {
    let size = SMALL * unit;
    let widest = series.iter().map(|one| fonts.width(&one.name, Weight::Regular, size)).fold(0.0, f64::max);
    let are_dashed = series.iter().any(|one| !one.style.dash.is_empty());
    let ways =
        [(BESIDE + APART + NEAR, true), (BESIDE, false)].into_iter().filter(|&(_, sampled)| are_dashed || !sampled);
    let mut fitting = ways.map(|(before, sampled)| (before * unit + widest, sampled)).filter(|&(wide, _)| wide <= room);
    let is_named = series.len() > 1 && series.iter().any(|one| !one.points.is_empty());
    fitting.next().filter(|_| is_named && Scale::legible(size))
}

/// The names at the ends of time series that have values, with samples of dashes or without.
pub(super) fn at_ends(series: &[Series], sampled: bool) -> Vec<Name> {
    let name = |one: &Series| {
        // A loop ends in the midst of a chart: its rightmost point has the name.
        let end = one.points.iter().copied().max_by(|a, b| a[0].total_cmp(&b[0]))?;
        let dash = if sampled { one.style.dash.to_vec() } else { Vec::new() };
        Some(Name { text: one.name.clone(), end, colour: one.style.colour, dash })
    };
    series.iter().filter_map(name).collect()
}

/// Writes names right of a chart, the first ones that fit above each other within an extent above and below it (px).
pub(super) fn write(writer: &mut Writer<'_>, chart: &Chart, place: PlotArea, names: &[Name], beyond: [f64; 2]) {
    let (unit, size) = (place.unit, SMALL * place.unit);
    let [top, bottom] = [place.top - beyond[0], place.bottom + beyond[1]];
    let end =
        |one: &Name| [place.x(&chart.x, one.end[0]), place.y(&chart.y, one.end[1]).clamp(place.top, place.bottom)];
    let mut named: Vec<_> = names.iter().take(fitting(bottom - top, unit)).map(|one| (one, end(one))).collect();
    named.sort_by(|(_, [_, one]), (_, [_, other])| one.total_cmp(other));
    let heights: Vec<_> = named.iter().map(|&(_, [_, y])| y).collect();
    let half = 0.5 * GAP * unit;
    let places = spread(&heights, GAP * unit, [top + half, bottom - half]);
    let left = place.right + BESIDE * unit;
    let sampled = names.iter().any(|name| !name.dash.is_empty());
    for (&(Name { text, colour, dash: own, .. }, [x, y]), &height) in named.iter().zip(&places) {
        let is_early = x < place.right - 1.0;
        if is_early || (height - y).abs() > FREE * unit {
            let free = FREE * unit;
            let from = [x + if is_early { 2.0 * free } else { free }, y];
            let to = [left - free, height];
            let points = if is_early { vec![from, [place.right, y], to] } else { vec![from, to] };
            let dash = if is_early { &DOTS[..] } else { &[] };
            writer.curves.push(place.curve(&points, HAIR, dash, (*colour, LEADER)));
        }
        let end = left + APART * unit;
        let sample = || Item::part("sample", [place.curve(&[[left, height], [end, height]], STRONG, own, *colour)]);
        writer.marks.extend(sampled.then(sample));
        let left = if sampled { end + NEAR * unit } else { left };
        let colour = writer.palette.text_like(*colour);
        writer.left(text, Weight::Regular, size, colour, left, height + 0.36 * size);
    }
}

/// The number of names that fit above each other into a height (px).
pub(super) fn fitting(height: f64, unit: f64) -> usize {
    (height / (GAP * unit) + 1e-6) as usize
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
    use super::spread;

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
