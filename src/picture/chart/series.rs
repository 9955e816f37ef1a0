//! Series of one run in a chart, in one scene or as the mean over several, and their range.

use super::layer::{Layer, value};
use crate::look::{LineStyle, Measure, Palette, Plot, PlotByBody, PlotOf};
use crate::picture::layout::steps::{HAIR, STRONG};
use crate::picture::number;
use crate::runner::history::TimeSeries;
use crate::scene::{Reading, Scene};
use crate::sim::{Diagnostic, Dimension};

/// Values of a diverged run do not determine the scale above this many times the largest value of the other runs.
const BEYOND: f64 = 3.0;
/// The range includes zero unless zero is farther away than this many times its width.
const NEAR_ZERO: f64 = 3.0;
/// A force that is smaller than this part of the weight of the bodies on Earth is round-off.
const ROUND_OFF: f64 = 1e-9;
/// A range is at least this part of its values, so that round-off does not fill a chart.
pub(super) const LEAST_RANGE: f64 = 0.02;

/// The series of one run in a chart.
#[derive(Clone, Debug, Default)]
pub(in crate::picture) struct Series {
    pub run: usize,
    /// The name beside its curve.
    pub name: String,
    /// Colour and dashes of its curve.
    pub style: LineStyle,
    /// Whether it is a count.
    pub is_count: bool,
    /// Whether it is of one body of a run: its curve is thin.
    pub is_part: bool,
    /// Times (s), or displacements (m), and finite values, those of counts as steps.
    pub points: Vec<[f64; 2]>,
    /// The number by which its diagnostic is divided.
    pub divisor: f64,
    /// When each of them was there (s); empty for diagnostics, which have the times as points.
    pub times: Vec<f64>,
    /// For a mean of several scenes or nodes, the time series between which they lie: a band shows their least and greatest values.
    /// Empty otherwise.
    pub members: Vec<Vec<[f64; 2]>>,
    /// When the run diverged (s).
    pub diverged: Option<f64>,
    /// Whether it did not diverge, but its recording ends there.
    pub is_end: bool,
}

/// The line of a run in all charts of a picture and beside its name. One chart of counts makes lines solid, as dashed steps look ragged,
/// but not those of runs that share a colour.
pub(in crate::picture) fn style(charts: &[Plot], run: usize, scene: &Scene, palette: &Palette) -> LineStyle {
    let line = scene.runs[run].line(palette);
    let mut others = scene.runs.iter().enumerate().filter(|&(other, _)| other != run);
    let is_alone = !others.any(|(_, other)| other.line(palette).colour == line.colour);
    let is_solid = is_alone && charts.contains(&Diagnostic::TurnedOver.into());
    if is_solid { LineStyle { dash: &[], ..line } } else { line }
}

impl Series {
    /// What the chart at a place among all shows of a run of a scene, with the line of the run.
    pub(super) fn new(charts: &[Plot], at: usize, of_run: &TimeSeries, scene: &Scene, style: LineStyle) -> Self {
        let diverged = of_run.divergence.map(|divergence| divergence.time);
        let one = match &charts[at] {
            &Plot::Diagnostic(diagnostic) | &Plot::ByBody(PlotByBody { plot: diagnostic, .. }) => {
                Self::over(diagnostic, of_run, scene, of_run.diagnostics.iter().map(|all| diagnostic.of(all)), style)
            }
            Plot::Of(of) => {
                let place = charts[..at].iter().filter_map(Plot::of).count();
                Self::measured(of, of_run.readings.get(place).map_or(&[], |all| all), of_run, scene, style)
            }
        };
        let is_end = of_run.divergence.is_some_and(|divergence| divergence.is_end);
        Self { name: scene.runs[of_run.run].name.clone(), diverged, is_end, ..one }
    }

    /// What is measured of one thing in a run.
    fn measured(of: &PlotOf, all: &[Reading], of_run: &TimeSeries, scene: &Scene, style: LineStyle) -> Self {
        let readings = || of_run.times.iter().copied().zip(all);
        let over_time = |value: fn(&Reading) -> f64| readings().map(|(time, one)| [time, value(one)]).collect();
        let whole: Vec<[f64; 2]> = over_time(|one| one.value);
        let (mut times, mut points, mut members): (Vec<f64>, _, _) = (of_run.times.clone(), whole, Vec::new());
        if of.against.is_some() {
            let ways: Vec<[f64; 2]> = over_time(|one| one.against);
            if of.plot == Measure::Displacement {
                points.iter_mut().zip(&ways).for_each(|(point, way)| point[0] = way[1]);
            } else {
                (times, points) = of_intervals(&points, &ways, scene.interval(of_run.run), scene.runs[of_run.run].step);
            }
        } else if of.plot != Measure::Displacement {
            points.retain(|point| point[1].is_finite());
            points = over_intervals(&points, scene.interval(of_run.run), scene.runs[of_run.run].step);
            times = points.iter().map(|point| point[0]).collect();
        } else if all.iter().any(|one| one.range[0] < one.range[1]) {
            members = vec![over_time(|one| one.range[0]), over_time(|one| one.range[1])];
        }
        let is_there = |point: &[f64; 2]| point.iter().all(|number| number.is_finite());
        let (times, points) = times.into_iter().zip(points).filter(|(_, point)| is_there(point)).unzip();
        members.iter_mut().for_each(|member| member.retain(is_there));
        Self { times, members, ..Self::plain(of_run.run, style, points) }
    }

    /// Divides all values by a number; runs without parts stay as they are.
    pub(super) fn divide_by(&mut self, whole: f64) {
        if whole > 0.0 {
            self.divisor *= whole;
            let points = self.points.iter_mut().chain(self.members.iter_mut().flatten());
            points.for_each(|point| point[1] /= whole);
        }
    }

    /// Points of a run.
    pub(super) fn plain(run: usize, style: LineStyle, points: Vec<[f64; 2]>) -> Self {
        Self { run, style, points, divisor: 1.0, ..Self::default() }
    }

    /// A diagnostic of each body of a run of a scene, if it has several, in the colour of the run.
    pub(super) fn of_bodies<'a>(
        diagnostic: Diagnostic,
        of_run: &'a TimeSeries,
        (scene, run): (&'a Scene, &'a str),
        palette: &'a Palette,
    ) -> impl Iterator<Item = Self> + 'a {
        let style = LineStyle { dash: &[], ..scene.runs[of_run.run].line(palette) };
        let bodies = scene.runs[of_run.run].several(scene).zip(&of_run.of_bodies);
        bodies.map(move |((body, _), all)| {
            let one = Self::over(diagnostic, of_run, scene, all.iter().map(|all| diagnostic.of(all)), style);
            Self { name: format!("{run} · {body}"), is_part: true, ..one }
        })
    }

    /// Values at the times of a run of a scene.
    fn over(
        diagnostic: Diagnostic,
        of_run: &TimeSeries,
        scene: &Scene,
        values: impl Iterator<Item = f64>,
        style: LineStyle,
    ) -> Self {
        let is_count = diagnostic == Diagnostic::TurnedOver;
        let points = of_run.times.iter().zip(values).map(|(&time, value)| [time, value]);
        let mut points: Vec<_> = points.filter(|[_, value]| value.is_finite()).collect();
        if is_count {
            points = steps(&points);
        } else if diagnostic.is_of_forces() {
            let run = &scene.runs[of_run.run];
            // Forces between bodies cancel up to round-off.
            let least =
                ROUND_OFF * number::EARTH * run.bodies.bodies().iter().flat_map(|body| body.mass()).sum::<f64>();
            points.iter_mut().filter(|point| point[1].abs() < least).for_each(|point| point[1] = 0.0);
            points = over_intervals(&points, scene.interval(of_run.run), run.step);
        }
        Self { is_count, ..Self::plain(of_run.run, style, points) }
    }

    /// The mean of a run's time series in several scenes, up to the earliest end. A single one is returned as it is.
    pub(super) fn mean(mut all: Vec<Self>) -> Option<Self> {
        if all.len() < 2 {
            return all.pop();
        }
        let members: Vec<_> = all.iter_mut().map(|one| std::mem::take(&mut one.points)).collect();
        let diverged = all.iter().filter_map(|one| one.diverged).reduce(f64::min);
        let first = all.swap_remove(0);
        let at = |time: f64| {
            let values: Option<Vec<_>> = members.iter().map(|member| value(member, time)).collect();
            values.map(|values| [time, values.iter().sum::<f64>() / values.len() as f64])
        };
        let points: Vec<_> = members[0].iter().filter_map(|&[time, _]| at(time)).collect();
        let points = if first.is_count { steps(&points) } else { points };
        Some(Self { points, members, diverged, ..first })
    }

    /// All its points, with those of its members.
    fn all(&self) -> impl Iterator<Item = &[f64; 2]> {
        self.points.iter().chain(self.members.iter().flatten())
    }

    /// The area below a count.
    pub(super) fn area(&self, palette: &Palette) -> Option<Layer> {
        (self.is_count && !self.is_part).then(|| Layer::Area { points: self.points.clone(), colour: palette.alarm })
    }

    /// Its curve.
    pub(super) fn line(&self) -> Layer {
        let LineStyle { colour, dash } = self.style;
        let width = if self.is_part { HAIR } else { STRONG };
        Layer::Line { points: self.points.clone(), colour, width, dash: dash.to_vec() }
    }

    /// Its curve over time, that of several scenes or nodes on a band.
    pub(super) fn curves(&self) -> impl Iterator<Item = Layer> {
        let colour = self.style.colour;
        let band = (!self.members.is_empty()).then(|| Layer::Band { curves: self.members.clone(), colour });
        band.into_iter().chain([self.line()])
    }
}

/// The name of a diagnostic of a scene in a picture.
pub(in crate::picture) fn name(diagnostic: Diagnostic, scene: &Scene) -> &'static str {
    match (diagnostic, scene.dimension()) {
        (Diagnostic::VolumeRatio, Dimension::Plane) => "area ratio",
        _ => diagnostic.name(),
    }
}

/// What a chart shows of a scene, in words.
pub(super) fn quantity(plot: &Plot, scene: &Scene) -> String {
    match plot {
        Plot::Diagnostic(diagnostic) | Plot::ByBody(PlotByBody { plot: diagnostic, .. }) => {
            name(*diagnostic, scene).to_owned()
        }
        Plot::Of(of) => of.name(),
    }
}

/// The mean forces of intervals (s), each against the displacement in its middle, and when each interval ended (s); from the force of the last
/// interval and the displacement at each time, in a run with a step (s).
fn of_intervals(forces: &[[f64; 2]], ways: &[[f64; 2]], interval: f64, step: f64) -> (Vec<f64>, Vec<[f64; 2]>) {
    let (mut times, mut points, mut last) = (Vec::new(), Vec::new(), 0.0);
    for &[time, force] in forces {
        // An interval ends with the step nearest to its end.
        let number = ((time + 0.5 * step) / interval).floor();
        let middle = value(ways, (number - 0.5) * interval).filter(|_| number > last);
        if let Some(way) = middle {
            points.push([way, force]);
            times.push(time);
            last = number;
        }
    }
    (times, points)
}

/// The mean forces of intervals (s) as steps over the intervals to which they belong: what is known at a time is that of the last whole
/// interval, in a run with a step (s).
fn over_intervals(forces: &[[f64; 2]], interval: f64, step: f64) -> Vec<[f64; 2]> {
    let (mut steps, mut last) = (Vec::<[f64; 2]>::new(), 0.0);
    for &[time, force] in forces {
        let number = ((time + 0.5 * step) / interval).floor();
        if number <= last {
            continue;
        }
        let begin = steps.last().filter(|_| number == last + 1.0).map_or((number - 1.0) * interval, |&[end, _]| end);
        // An interval ends with the step nearest to its end.
        let end = number * interval;
        steps.extend([[begin, force], [if (time - end).abs() < step { time } else { end }, force]]);
        last = number;
    }
    steps
}

/// The largest absolute value.
fn peak(one: &Series) -> f64 {
    one.all().fold(0.0, |most, [_, value]| value.abs().max(most))
}

/// The range of shown values: all values of runs that did not diverge, and the values of diverged runs that are not far
/// larger.
pub(super) fn range(series: &[Series], may_diverge: bool) -> Option<[f64; 2]> {
    let with_values = || series.iter().filter(|one| !one.points.is_empty());
    let is_wild = |one: &Series| may_diverge && one.diverged.is_some() && !one.is_end;
    let calm = with_values().filter(|one| !is_wild(one)).map(peak).reduce(f64::max);
    let limit = match calm {
        Some(calm) if calm > 0.0 => BEYOND * calm,
        // If all runs diverged, the median counts as ordinary.
        _ => {
            let mut sizes: Vec<_> = with_values().flat_map(Series::all).map(|[_, value]| value.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            BEYOND * sizes.get(sizes.len() / 2).copied()?
        }
    };
    let shown = |one: &Series, value: f64| value.abs() <= limit || !is_wild(one);
    let values = with_values().flat_map(|one| {
        let shown = one.all().filter(|[_, value]| shown(one, *value));
        shown.map(|&[_, value]| value).collect::<Vec<_>>()
    });
    extent(values)
}

/// The range of displacements.
pub(super) fn ways(series: &[Series]) -> Option<[f64; 2]> {
    extent(series.iter().flat_map(|one| &one.points).map(|point| point[0]))
}

/// The range of values, widened.
fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let ends = values.map(|value| [value; 2]).reduce(|[low, high], [from, to]| [low.min(from), high.max(to)]);
    ends.map(widened)
}

/// A range that is not too narrow and includes zero unless that is far away.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    let nearest = if low > 0.0 { low } else { (-high).max(0.0) };
    if nearest <= NEAR_ZERO * (high - low) {
        return [low.min(0.0), high.max(0.0)];
    }
    let largest = low.abs().max(high.abs());
    let missing = (LEAST_RANGE * largest - (high - low)).max(0.0) / 2.0;
    [low - missing, high + missing]
}

/// A count as steps: level until it changes, then straight up or down.
fn steps(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for &[x, y] in points {
        if let Some(&[_, before]) = steps.last().filter(|&&[_, before]| before != y) {
            steps.push([x, before]);
        }
        steps.push([x, y]);
    }
    steps
}

#[cfg(test)]
#[path = "../../../tests/inside/series.rs"]
mod tests;
