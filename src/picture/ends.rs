//! Names at the ends of curves, right of a chart. Where curves end close to each other, names are shifted apart, and thin
//! lines lead to them.

use super::Curve;
use super::caption::Writer;
use super::chart::{Chart, NUMBERS};
use super::course::Line;
use super::layout::Scale;
use super::narrow::narrow;
use super::text::{Fonts, Weight};

/// From the chart to the names: the mark of the present moment has room there. From one name to the next (px in the
/// reference picture).
const GAP: f64 = 14.0;
pub(super) const APART: f64 = 15.0;
/// Free at both ends of a line that leads to a name, its width, its dots and gaps where it comes from a curve that ends
/// early and must not look like its course (px in the reference picture), and its opacity.
const FREE: f64 = 3.0;
const LEADER: f64 = 1.0;
const DOTS: [f64; 2] = [1.0, 3.5];
const LEADER_ALPHA: f64 = 0.7;
/// A name that is shifted by less than this needs no line (px in the reference picture).
const HARDLY: f64 = 3.0;
/// Names have room for so many letters at least (sizes of type).
const LEAST_ROOM: f64 = 3.0;

/// The names of several curves.
#[derive(Debug)]
pub(super) struct Ends {
    /// One for each curve, as far as it has room.
    names: Vec<String>,
    /// What they take right of the chart, with the gap (px).
    pub(super) width: f64,
}

impl Ends {
    /// The names of curves in a room of a width and a height (px). `None` for a single curve, which needs no name, and if
    /// names could not be read, or not told from one another.
    pub(super) fn new(fonts: &Fonts, lines: &[Line], unit: f64, [width, height]: [f64; 2]) -> Option<Self> {
        let size = NUMBERS * unit;
        let shown: Vec<_> = lines.iter().filter(|line| !line.points.is_empty()).collect();
        let room = width - GAP * unit;
        let is_low = shown.len() as f64 * APART * unit > height;
        if shown.len() < 2 || is_low || room < LEAST_ROOM * size || !Scale::legible(size) {
            return None;
        }
        let names: Vec<_> =
            lines.iter().map(|line| fonts.shortened(&line.name, Weight::SemiBold, size, room)).collect();
        let is_alike = |at: usize| {
            lines[..at].iter().zip(&names).any(|(line, name)| names[at] == *name && line.name != lines[at].name)
        };
        if (0..names.len()).any(is_alike) {
            return None;
        }
        let widest = names.iter().map(|name| fonts.width(name, Weight::SemiBold, size)).fold(0.0, f64::max);
        Some(Self { names, width: GAP * unit + widest })
    }

    /// Writes them beside a chart, between two heights (px). `ends` are the ends of the curves (px), of those that have
    /// any; the name of one run may be stronger than the others. Where not all have room, none is written.
    pub(super) fn write(
        &self,
        writer: &mut Writer<'_>,
        chart: Chart,
        lines: &[Line],
        ends: &[Option<[f64; 2]>],
        strong: Option<usize>,
        [top, bottom]: [f64; 2],
    ) {
        let (unit, size) = (chart.unit, NUMBERS * chart.unit);
        let mut order: Vec<_> = (0..lines.len()).filter_map(|at| Some((at, ends[at]?))).collect();
        if order.len() as f64 * APART * unit > bottom - top {
            return;
        }
        order.sort_by(|(_, [_, one]), (_, [_, other])| one.total_cmp(other));
        let heights: Vec<_> = order.iter().map(|&(_, [_, y])| y).collect();
        let half = 0.5 * APART * unit;
        let places = spread(&heights, APART * unit, [top + half, bottom - half]);
        let left = chart.right + GAP * unit;
        for (&(at, [x, y]), &place) in order.iter().zip(&places) {
            let line = &lines[at];
            let is_early = x < chart.right - 1.0;
            if is_early || (place - y).abs() > HARDLY * unit {
                let free = FREE * unit;
                let from = [x + if is_early { 2.0 * free } else { free }, y];
                let to = [left - free, place];
                let points = if is_early { vec![from, [chart.right, y], to] } else { vec![from, to] };
                writer.curves.push(Curve {
                    points: points.into_iter().map(|point| point.map(narrow)).collect(),
                    width: narrow(LEADER * chart.thin),
                    dash: if is_early { DOTS.map(|length| narrow(length * unit)).to_vec() } else { Vec::new() },
                    colour: line.style.colour,
                    alpha: narrow(LEADER_ALPHA),
                });
            }
            let weight = if strong == Some(line.run) { Weight::SemiBold } else { Weight::Regular };
            let colour = writer.palette.text_like(line.style.colour);
            writer.left(&self.names[at], weight, size, colour, left, place + 0.36 * size);
        }
    }
}

/// Places as near as possible to the given ones, which rise, at least so far apart and within two ends.
pub(super) fn spread(places: &[f64], apart: f64, [low, high]: [f64; 2]) -> Vec<f64> {
    // Neighbours that would be too near stand around their common middle (isotonic regression).
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
