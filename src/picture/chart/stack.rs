//! Charts above each other on one axis of time, and below them those against displacements: a quantity of all runs in each, with its name at
//! the left and the names of the runs at the ends of their curves.

use super::annotation::{Annotation, Flag, flags};
use super::axis::{Axis, Kind, Stretch};
use super::event;
use super::names::{self, at_ends, fitting};
use super::series::{self, Series};
use super::{Chart, PlotArea};
use crate::look::Plot;
use crate::picture::caption::Writer;
use crate::picture::layout::steps::{BESIDE, MARGIN, NEAR, ROW, SHORT, SMALL};
use crate::picture::layout::{Room, Scale};
use crate::picture::number;
use crate::picture::text::{Fonts, Weight};
use crate::reading::captions::elements;
use crate::runner::history::History;
use crate::scene::{Run, Scene};
use crate::sim::model::ElasticModel;
use crate::sim::{Body, Diagnostic};
use std::sync::Arc;

/// The most numbers beside a chart.
const MOST_TICKS: usize = 4;
/// The most numbers along an axis of displacements.
const MOST_WAYS: usize = 9;
/// The dashes of the thin curves of bodies, by their number in a colour: neighbours differ most.
const THIN_DASHES: [usize; 8] = [0, 1, 3, 2, 7, 4, 5, 6];
/// The meaning of a band where a curve is dense.
const BAND: [&str; 2] = ["filled where it", "oscillates fast"];

/// What a chart shows of several runs.
struct Quantity {
    /// The place of the chart among all.
    at: usize,
    name: String,
    /// The lines below the name: its unit, and explanations of the axis, of curves and of bands.
    notes: Vec<String>,
    kind: Kind,
    unit: &'static str,
    /// One for each run shown, or for each of its bodies.
    series: Vec<Series>,
    /// The number of runs shown; 0 if each body has its series.
    runs: usize,
    /// The width of the names at the ends of curves (px), and whether they have samples of dashes, if there is room for them.
    ends: Option<(f64, bool)>,
    /// The range of values; `None` if there are none.
    range: Option<[f64; 2]>,
    /// Whether the axis to the right is that of a displacement, and its range (m).
    against: Option<Option<[f64; 2]>>,
    /// The size of the body (m).
    extent: f64,
}

impl Quantity {
    /// The chart of all runs at a place among others, as the mean over scenes with runs of the same names, in the colours of a picture; `label`
    /// replaces names of runs.
    fn new(
        at: usize,
        charts: &[Plot],
        of_scenes: &[(&Scene, &History)],
        writer: &Writer<'_>,
        (room, label): (f64, impl Fn(&str) -> String),
    ) -> Self {
        let (scene, plot) = (of_scenes[0].0, &charts[at]);
        let diagnostic = plot.diagnostic();
        let (mut series, runs) = all_series(at, charts, of_scenes, writer, label);
        let counted = diagnostic.filter(|one| matches!(one, Diagnostic::TurnedOver | Diagnostic::Broken));
        let in_parts = counted.map(|counted| match plot {
            // Bodies have other numbers of parts than their run.
            Plot::ByBody(_) if counted == Diagnostic::TurnedOver => "elements".to_owned(),
            Plot::ByBody(_) => "elements, springs".to_owned(),
            _ => of_parts(counted, of_scenes),
        });
        // Springs and elements have no common scale but their shares.
        let is_share = in_parts.as_deref() == Some(SHARES);
        if is_share {
            series.iter_mut().for_each(|one| one.divide_by(0.01 * whole(Diagnostic::Broken, &scene.runs[one.run])));
        }
        let is_count = counted.is_some() && !is_share;
        let of = plot.of();
        let mut one = Self {
            at,
            name: capital(series::quantity(plot, scene)),
            notes: Vec::new(),
            kind: if is_count { Kind::Count } else { Kind::Value },
            unit: of.map_or_else(|| diagnostic.map_or("", Diagnostic::unit), |of| of.plot.words()[1]),
            // Counts are bounded by the number of elements, so diverged runs are shown in full.
            range: series::range(&series, counted.is_none()),
            against: (!plot.is_over_time()).then(|| series::ways(&series)),
            ends: names::width(writer.fonts, &series, writer.scale.type_unit(), room),
            series,
            runs,
            extent: scene.extent(),
        };
        let unit = match (in_parts, one.values(MOST_TICKS)) {
            (Some(parts), _) => parts,
            (None, Some(values)) => values.unit,
            (None, None) => "none".to_owned(),
        };
        let has_zero = one.range.is_none_or(|[low, high]| low <= 0.0 && high >= 0.0);
        let unit = [&*unit, if has_zero { "" } else { "not from zero" }].into_iter().filter(|text| !text.is_empty());
        one.notes = Vec::from_iter(Some(unit.collect::<Vec<_>>().join(", ")).filter(|text| !text.is_empty()));
        if let Some(against) = of.and_then(|of| of.against.as_ref()) {
            let other = of.is_some_and(|of| of.of != *against).then(|| format!("of {against}"));
            one.notes.extend(["against displacement".to_owned()].into_iter().chain(other));
        } else if of.is_some() && one.series.iter().any(|series| !series.members.is_empty()) && of_scenes.len() == 1 {
            one.notes.push("mean, range".to_owned());
        }
        if of_scenes.len() > 1 {
            one.notes.push(format!("{} scenes: mean, range", of_scenes.len()));
        }
        one
    }

    /// The axis of values with at most `most` ticks; `None` if there are no values.
    fn values(&self, most: usize) -> Option<Stretch> {
        self.range.map(|range| Stretch::new(self.kind, range, self.unit, self.extent, most))
    }

    /// The series that are drawn at a place, with names up to an extent above and below it (px). Curves of bodies without a name would say
    /// nothing; those of runs have the colours and dashes beside the runs' names.
    fn shown(&self, place: PlotArea, beyond: f64) -> &[Series] {
        let named = self.ends.map_or(0, |_| fitting(place.bottom - place.top + 2.0 * beyond, place.unit));
        &self.series[..if self.runs == 0 { named.min(self.series.len()) } else { self.series.len() }]
    }

    /// The chart of some series over an axis of time, or an own axis of displacements, at a place.
    fn chart(&self, series: &[Series], time: Axis, writer: &Writer<'_>, place: PlotArea) -> Chart {
        let rows = ((place.bottom - place.top) / (ROW * place.unit)) as usize + 1;
        let y = Axis(self.values(rows.min(MOST_TICKS)).into_iter().collect());
        if let Some(ways) = self.against {
            let most = ((place.right - place.left) / (2.0 * MARGIN * place.unit)) as usize;
            let x = ways.map(|ways| Stretch::new(Kind::Value, ways, "m", self.extent, most.clamp(2, MOST_WAYS)));
            let layers = if y.0.is_empty() { Vec::new() } else { series.iter().map(Series::line).collect() };
            return Chart { x: Axis(x.into_iter().collect()), y, layers, annotations: Vec::new() };
        }
        let areas = series.iter().filter_map(|one| one.area(writer.palette));
        let layers = areas.chain(series.iter().flat_map(Series::curves));
        let layers = layers.filter(|_| !y.0.is_empty()).collect();
        let crosses = series.iter().filter(|one| !one.points.is_empty()).filter_map(cross);
        Chart { x: time, layers, annotations: crosses.collect(), y }
    }

    /// The width of the numbers beside it (px), for any number of ticks, with the gap to its name.
    fn numbers_width(&self, fonts: &Fonts, unit: f64) -> f64 {
        let texts = (2..=MOST_TICKS).filter_map(|most| self.values(most)).flat_map(|axis| axis.texts);
        let widths = texts.map(|text| fonts.width(&text, Weight::Regular, SMALL * unit));
        widths.fold(0.0, f64::max) + (NEAR + BESIDE) * unit
    }

    /// The width of its name, with the lines below it (px).
    fn name_width(&self, fonts: &Fonts, scale: Scale) -> f64 {
        let below = |text: &str| fonts.width(text, Weight::Regular, SMALL * scale.type_unit());
        let name = fonts.width(&self.name, Weight::SemiBold, scale.caption());
        self.notes.iter().map(|note| below(note)).fold(name.max(below(BAND[1])), f64::max)
    }

    /// Writes the name with its notes, as many as fit into a height, from a left end around a place (px).
    fn write_name(&self, writer: &mut Writer<'_>, notes: &[&str], [left, middle]: [f64; 2]) {
        let (scale, palette) = (writer.scale, writer.palette);
        let unit = scale.type_unit();
        let baseline = middle + 0.36 * scale.caption() - 0.5 * notes.len() as f64 * SHORT * unit;
        writer.left(&self.name, Weight::SemiBold, scale.caption(), palette.text, left, baseline);
        for (text, line) in notes.iter().zip(1..) {
            let baseline = baseline + f64::from(line) * SHORT * unit;
            writer.left(text, Weight::Regular, SMALL * unit, palette.second_text, left, baseline);
        }
    }
}

/// The series of a chart at a place among others, one for each run, with the number of runs; with each body by itself one for each of them,
/// and 0.
fn all_series(
    at: usize,
    charts: &[Plot],
    of_scenes: &[(&Scene, &History)],
    writer: &Writer<'_>,
    label: impl Fn(&str) -> String,
) -> (Vec<Series>, usize) {
    let (scene, plot) = (of_scenes[0].0, &charts[at]);
    let one = |(scene, history): &(&Scene, &History), name: &str| {
        let own = history.series.iter().find(|series| scene.runs[series.run].name == name);
        own.map(|own| Series::new(charts, at, own, scene, series::style(charts, own.run, scene, writer.palette)))
    };
    let of_run = |run: usize| {
        let name = &scene.runs[run].name;
        let mean = Series::mean(of_scenes.iter().filter_map(|of_scene| one(of_scene, name)).collect());
        mean.map(|mean| Series { name: label(&mean.name), ..mean })
    };
    let mut series: Vec<_> = of_scenes[0].1.series.iter().filter_map(|series| of_run(series.run)).collect();
    let runs = if let Plot::ByBody(all) = plot {
        let of_bodies = |(own, run): (_, Series)| {
            let bodies: Vec<_> = Series::of_bodies(all.plot, own, (scene, &run.name), writer.palette).collect();
            if bodies.is_empty() { vec![run] } else { bodies }
        };
        let of_runs: Vec<Vec<Series>> = of_scenes[0].1.series.iter().zip(series).map(of_bodies).collect();
        series = by_turns(of_runs);
        // Curves of one colour differ in dashes, whichever run they are of.
        for at in 0..series.len() {
            let alike = series[..at].iter().filter(|other| other.style.colour == series[at].style.colour).count();
            series[at].style.dash = writer.palette.dash(THIN_DASHES[alike % THIN_DASHES.len()]);
        }
        0
    } else {
        series.len()
    };
    (series, runs)
}

/// A text that begins with a capital letter.
fn capital(mut text: String) -> String {
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

/// All entries of lists: the first of each, then the second of each, and so on.
fn by_turns<T>(lists: Vec<Vec<T>>) -> Vec<T> {
    let mut rest: Vec<_> = lists.into_iter().map(Vec::into_iter).collect();
    let mut all = Vec::new();
    loop {
        let before = all.len();
        all.extend(rest.iter_mut().filter_map(Iterator::next));
        if all.len() == before {
            return all;
        }
    }
}

/// The unit of counts of unlike things.
const SHARES: &str = "% of elements, springs";

/// The kinds of parts of a run that a diagnostic counts, with their numbers: elements, or springs where these break.
fn parts_of(diagnostic: Diagnostic, run: &Run) -> Vec<(usize, &'static str)> {
    if diagnostic != Diagnostic::Broken {
        return elements(run.body());
    }
    let breaking = run.models_and_bodies().filter(|(model, body)| model.properties(body).breakable.is_some());
    let of_body = |(model, body): (&dyn ElasticModel, &Arc<Body>)| match model.springs().len() {
        0 => elements(body),
        springs => vec![(springs, "springs")],
    };
    breaking.flat_map(of_body).collect()
}

/// The number of all parts of a run that a diagnostic counts.
fn whole(diagnostic: Diagnostic, run: &Run) -> f64 {
    parts_of(diagnostic, run).iter().map(|(count, _)| count).sum::<usize>() as f64
}

/// The unit of a count of elements, or of springs where these break: how many there are, if all runs have equally many.
fn of_parts(diagnostic: Diagnostic, of_scenes: &[(&Scene, &History)]) -> String {
    let of_scene = |(scene, history): &(&Scene, &History)| -> Vec<_> {
        let of_runs = history.series.iter().map(|series| parts_of(diagnostic, &scene.runs[series.run]));
        of_runs.filter(|parts| !parts.is_empty()).collect()
    };
    let all: Vec<_> = of_scenes.iter().flat_map(of_scene).collect();
    let has_springs = |parts: &Vec<(usize, &str)>| parts.iter().any(|(_, name)| *name == "springs");
    match all.first() {
        Some(first) if all.iter().all(|other| other == first) => match first[..] {
            [(count, name)] => format!("of {} {name}", number::count(count)),
            _ => format!("of {} elements", number::count(first.iter().map(|(count, _)| count).sum())),
        },
        _ if all.iter().all(has_springs) => "springs".to_owned(),
        _ if all.iter().any(has_springs) => SHARES.to_owned(),
        _ => "elements".to_owned(),
    }
}

/// The cross at the divergence of a run.
fn cross(series: &Series) -> Option<Annotation> {
    let colour = series.style.colour;
    series.diverged.map(|at| Annotation::Cross { line: series.points.clone(), at, colour })
}

/// Charts above each other.
pub(in crate::picture) struct Stack {
    quantities: Vec<Quantity>,
    /// The widths of the names, and of the numbers beside the charts with gaps (px).
    pub names_width: f64,
    pub numbers_width: f64,
}

impl Stack {
    /// Charts, each with the time series of scenes, with a width for the names of runs (px).
    ///
    /// # Panics
    /// If there is no scene.
    pub(in crate::picture) fn new(
        charts: &[Plot],
        of_scenes: &[(&Scene, &History)],
        writer: &Writer<'_>,
        room: f64,
        label: impl Fn(&str) -> String,
    ) -> Self {
        let (fonts, scale) = (writer.fonts, writer.scale);
        let unit = scale.type_unit();
        let quantities = (0..charts.len()).map(|at| Quantity::new(at, charts, of_scenes, writer, (room, &label)));
        let mut quantities: Vec<_> = quantities.collect();
        quantities.sort_by_key(|one| one.against.is_some());
        let widest = |wide: &dyn Fn(&Quantity) -> f64| quantities.iter().map(wide).fold(0.0, f64::max);
        Self {
            names_width: widest(&|one| one.name_width(fonts, scale)),
            numbers_width: widest(&|one| one.numbers_width(fonts, unit)),
            quantities,
        }
    }

    /// The width of the names right of the charts (px).
    pub(in crate::picture) fn ends_width(&self) -> f64 {
        self.quantities.iter().filter_map(|one| one.ends).map(|(width, _)| width).fold(0.0, f64::max)
    }

    /// The most names at the ends of the curves of a chart.
    pub(in crate::picture) fn names(&self) -> usize {
        self.quantities.iter().filter(|one| one.ends.is_some()).map(|one| one.series.len()).max().unwrap_or(0)
    }

    pub(in crate::picture) fn count(&self) -> usize {
        self.quantities.len()
    }

    /// The number of charts over time, which come first.
    pub(in crate::picture) fn over_time(&self) -> usize {
        self.quantities.iter().filter(|one| one.against.is_none()).count()
    }

    /// The time series of the first chart of runs over time, its axis, and its quantity where extremes name it.
    pub(super) fn first(&self, charts: &[Plot], scene: &Scene) -> (&[Series], Option<Stretch>, String) {
        let of_runs = |one: &&Quantity| one.against.is_none() && one.runs > 0;
        let first = self.quantities.iter().find(of_runs);
        first.map_or_else(Default::default, |one| {
            (&one.series[..], one.values(MOST_TICKS), event::named(&charts[one.at], scene))
        })
    }

    /// The places of the charts among all, in the order in which they are drawn, each with the series of runs.
    pub(super) fn into_runs(self) -> impl Iterator<Item = (usize, Vec<Series>)> {
        self.quantities.into_iter().map(|mut one| {
            one.series.truncate(one.runs);
            (one.at, one.series)
        })
    }

    /// Draws as many charts as have room, over a span of time whose scale may change between (s): what lies below the
    /// curves with one writer, the curves with another. Returns the charts and their places.
    pub(in crate::picture) fn draw(
        &self,
        [ground, curves]: [&mut Writer<'_>; 2],
        room: &Room,
        (span, split): ([f64; 2], Option<f64>),
        marked: &[Flag],
    ) -> Vec<(Chart, PlotArea)> {
        let scale = ground.scale;
        let (unit, line) = (scale.type_unit(), scale.unit);
        let [left, right] = room.span;
        let x = Axis::of_time(room.span, unit, span, split);
        let placed = self.quantities.iter().zip(&room.charts).map(|(one, &[top, bottom])| {
            let place = PlotArea { left, right, top, bottom, unit, line };
            (one.chart(one.shown(place, room.beyond), x.clone(), ground, place), place)
        });
        let mut placed: Vec<_> = placed.collect();
        let over_time = self.over_time().min(placed.len());
        if let [first, ..] = &placed[..over_time] {
            flags(ground, marked, room.rings, (&first.0, first.1), placed[over_time - 1].1.bottom);
        }
        for (at, (one, (chart, place))) in self.quantities.iter().zip(&mut placed).enumerate() {
            let shown = one.shown(*place, room.beyond);
            let names = |(_, sampled)| Annotation::Names { names: at_ends(shown, sampled), beyond: [room.beyond; 2] };
            chart.annotations.extend(one.ends.map(names));
            chart.ground(ground, *place, at + 1 >= over_time);
            chart.curves(curves, *place);
            let Some(left) = room.names else { continue };
            let few =
                (shown.len() < one.series.len()).then(|| format!("{} of {} curves", shown.len(), one.series.len()));
            let mut notes: Vec<_> = one.notes.iter().chain(&few).map(|note| &**note).collect();
            let free = place.bottom - place.top + 2.0 * room.beyond - scale.caption();
            let fitting = if Scale::legible(SMALL * unit) { (free / (SHORT * unit)).max(0.0) as usize } else { 0 };
            // A sentence is written whole or not at all.
            let has_band = chart.layers.iter().any(|layer| layer.has_band(chart, *place));
            if has_band && notes.len() + BAND.len() <= fitting {
                notes.extend(BAND);
            }
            notes.truncate(fitting);
            one.write_name(ground, &notes, [left, 0.5 * (place.top + place.bottom)]);
        }
        placed
    }
}
