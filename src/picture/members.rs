//! Time series of one run in several scenes, such as one body with several seeds: their mean, in a band from the least
//! to the greatest value.

use super::Item;
use super::axis::Axis;
use super::caption::Writer;
use super::chart::Chart;
use super::series::{EXACT, Series, simplified, steps, value, within};

/// Opacity of the band.
const RANGE: f64 = 0.22;
/// Width of the curves of single scenes (px in the reference picture), and their opacity.
const SINGLE: f64 = 1.0;
const SINGLE_ALPHA: f64 = 0.5;

impl Series {
    /// The mean of a run's time series in several scenes, up to the earliest end. A single one is returned as it is.
    pub(super) fn mean(mut all: Vec<Self>) -> Option<Self> {
        if all.len() < 2 {
            return all.pop();
        }
        let members: Vec<_> = all.iter_mut().map(|one| std::mem::take(&mut one.points)).collect();
        let diverged = all.iter().filter_map(|one| one.diverged).reduce(f64::min);
        let first = all.swap_remove(0);
        let at = |time: f64| {
            let values: Option<Vec<_>> = members.iter().map(|member| value(member, time, first.is_count)).collect();
            values.map(|values| [time, values.iter().sum::<f64>() / values.len() as f64])
        };
        let points = members[0].iter().filter_map(|&[time, _]| at(time)).collect();
        Some(Self { points, members, diverged, ..first })
    }

    /// All its points, with those of its members.
    pub(super) fn all(&self) -> impl Iterator<Item = &[f64; 2]> {
        self.points.iter().chain(self.members.iter().flatten())
    }

    /// Draws the band between the least and the greatest value of several scenes, and the thin curve of each: the mean
    /// may be far from all of them.
    pub(super) fn draw_range(&self, writer: &mut Writer<'_>, chart: Chart, [times, values]: [&Axis; 2]) {
        let member = |points: &Vec<[f64; 2]>| {
            let at = |&[time, value]: &[f64; 2]| [chart.x(times, time), chart.y(values, value)];
            let points: Vec<_> = points.iter().map(at).collect();
            if self.is_count { steps(&points) } else { points }
        };
        let members: Vec<_> = self.members.iter().map(member).collect();
        // The band ends with the shortest time series.
        let end =
            members.iter().map(|points| points.last().map_or(chart.left, |end| end[0])).fold(chart.right, f64::min);
        if members.is_empty() {
            return;
        }
        let range = |left: f64| {
            let ends = [left, left + 1.0];
            let inside = members.iter().flat_map(|points| {
                let inside = points.iter().filter(move |[x, _]| (ends[0]..=ends[1]).contains(x)).map(|[_, y]| *y);
                inside.chain(ends.into_iter().filter_map(|x| value(points, x, false)))
            });
            inside.fold([f64::INFINITY, f64::NEG_INFINITY], |[high, low], y| [high.min(y), low.max(y)])
        };
        let mut left = chart.left;
        while left < end {
            let [high, low] = range(left).map(|y| y.clamp(chart.top, chart.bottom));
            if high < low {
                let mark = Item::rectangle([left, high, (end - left).min(1.0), low - high], self.style.colour);
                writer.marks.extend(mark.faded(RANGE));
            }
            left += 1.0;
        }
        for part in members.iter().flat_map(|points| within(points, [chart.top, chart.bottom])) {
            writer.curves.push(Item::curve(
                &simplified(&part, EXACT),
                SINGLE * chart.line,
                &[],
                (self.style.colour, SINGLE_ALPHA),
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::series::range;
    use crate::picture::series::tests::series;

    #[test]
    fn several_scenes_have_a_mean_within_their_band() {
        let mean = Series::mean(vec![series(&[0.0, 2.0, 4.0], false), series(&[2.0, 8.0], true)]).expect("two");
        assert_eq!(mean.points, [[0.0, 1.0], [1.0, 5.0]]);
        assert_eq!((mean.members.len(), mean.diverged), (2, Some(2.0)));
        // The scale includes all members.
        assert_eq!(range(std::slice::from_ref(&mean), false), Some([0.0, 8.0]));
        let part = mean.between([0.5, 0.75]);
        assert_eq!(part.members, [[[0.5, 1.0], [0.75, 1.5]], [[0.5, 5.0], [0.75, 6.5]]]);
        // A single scene has no band.
        let alone = Series::mean(vec![series(&[1.0], false)]).expect("one");
        assert!(alone.members.is_empty() && alone.points == [[0.0, 1.0]]);
    }
}
