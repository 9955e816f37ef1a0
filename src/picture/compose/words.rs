//! The words of a scene's pictures: their places, which are the same in all frames, and words without room.

use super::numbers::NumberPart;
use super::{Arranged, Composer};
use crate::look::{Ghost, Labels, LineStyle, Plot};
use crate::picture::caption::{self, Heading};
use crate::picture::chart::{event, style};
use crate::picture::description::{are_shortened, second_lines};
use crate::picture::layout::{self, Layout, Part, Scale, Wanted, WordPlaces};
use crate::picture::legend::Legend;
use crate::picture::text::Weight;
use crate::runner::history::History;
use crate::scene::Scene;
use std::ops::RangeInclusive;

/// The text around panels, and the layout.
#[derive(Debug)]
pub(super) struct PageWords {
    pub(super) layout: Layout,
    /// The lines of the title and of the caption.
    pub(super) titles: [Vec<String>; 2],
    /// The key of colours and arrows.
    pub(super) legend: Option<Legend>,
    /// The row of the clock above all panels, if it has no room beside the heading of one.
    pub(super) clock_above: Option<Part>,
}

impl Composer<'_> {
    /// The text around the panels of some runs, in columns.
    pub(super) fn around(&self, runs: &[usize], columns: usize) -> PageWords {
        let (view, panels) = (&self.scene.view, runs.len());
        let scale = Layout::around(view);
        let (writer, width) = (self.writer(scale), f64::from(view.size[0]));
        // Panels' margins are no wider than the margins around them.
        let titles = writer.titles(scale, [&view.title, &view.caption], width - 2.0 * scale.margin());
        let legend = Legend::of(view, scale);
        let wanted = Wanted {
            titles: titles.each_ref().map(Vec::len),
            charts: [view.charts.len(), panels],
            own_axes: view.charts.iter().filter(|plot| !plot.is_over_time()).count(),
            legend: legend.map(|legend| legend.height),
            ..Wanted::default()
        };
        let room = width - 2.0 * scale.margin() - scale.gap() - writer.clock_width(scale, &view.clock);
        let laid_out = |wanted: Wanted| {
            let layout = Layout::new(view, panels, columns, wanted);
            // If names are long or type is large, the clock is beside a short title, or in a row of its own.
            let has_title = wanted.titles[0] > 0;
            let title = matches!(&titles[0][..], [line] if has_title
                && self.fonts.width(line, Weight::SemiBold, scale.heading()) < room);
            let row = if title { Part::Title } else { Part::Clock };
            let clock_above = self.is_crowded(&layout, runs, columns).then_some(row);
            match clock_above {
                Some(Part::Clock) => {
                    (Layout::new(view, panels, columns, Wanted { clock: true, ..wanted }), clock_above)
                }
                _ => (layout, clock_above),
            }
        };
        // Where panels have no room for their names, charts go, and then the title.
        let (mut layout, mut clock_above) = laid_out(wanted);
        let without_charts = Wanted { charts: [0; 2], own_axes: 0, ..wanted };
        let without_title = Wanted { titles: [0; 2], ..without_charts };
        let lacks_names = |layout: &Layout| view.labels.name && layout.written.left_out.contains(&Part::Name);
        if lacks_names(&layout) {
            let fewer = [(without_charts, false), (without_title, true)].map(|(fewer, title)| (laid_out(fewer), title));
            let chosen = fewer.into_iter().find(|((layout, _), _)| !lacks_names(layout));
            if let Some(((found, clock), without_title)) = chosen {
                (layout, clock_above) = (found, clock);
                let charts = std::iter::repeat_n(Part::Chart, wanted.charts[0]);
                let title = [Part::Title].into_iter().filter(|_| without_title && wanted.titles[0] > 0);
                layout.parts.left_out.extend(charts.chain(title));
            }
        }
        let legend = legend.filter(|_| layout.parts.get(Part::Legend).is_some());
        PageWords { titles, legend, layout, clock_above }
    }

    /// The words below the clock.
    pub(super) fn clock_label(&self, layout: &Layout) -> &str {
        if layout.written.second { &self.scene.view.clock } else { "" }
    }

    /// The names of runs.
    pub(super) fn names(&self, runs: &[usize]) -> Vec<&str> {
        runs.iter().map(|&run| self.scene.runs.get(run).map_or("", |run| &*run.name)).collect()
    }

    /// The descriptions of runs, if panels have them.
    fn described(&self, runs: &[usize], layout: &Layout) -> Vec<&str> {
        let own = |&run: &usize| self.descriptions.get(run).filter(|_| layout.written.labels.model);
        runs.iter().map(|run| own(run).map_or("", String::as_str)).collect()
    }

    /// The second lines of the panels of runs.
    pub(super) fn seconds(&self, runs: &[usize], layout: &Layout) -> Vec<String> {
        let room = layout.panels.first().map_or(0.0, |&panel| WordPlaces::new(layout.scale, panel).width());
        let size = layout.scale.caption();
        second_lines(&self.described(runs, layout), |text| self.fonts.width(text, Weight::Regular, size) <= room)
    }

    /// The heading of a panel of several runs.
    pub(super) fn heading<'w>(
        &'w self,
        at: usize,
        runs: &[usize],
        names: &'w [&'w str],
        seconds: &'w [String],
        layout: &Layout,
    ) -> Heading<'w> {
        let labels = layout.written.labels;
        let shown = |is_shown: bool, text| if is_shown { text } else { "" };
        Heading {
            letter: if labels.letters { caption::letter(at) } else { String::new() },
            name: shown(labels.name, names.get(at).copied().unwrap_or_default()),
            names,
            sample: self.sample(runs[at], layout.parts.get(Part::Chart).is_some()),
            second: seconds.get(at).map_or("", String::as_str),
        }
    }

    /// The line of a run in the chart, or that of its paths or its ghost, if there are any.
    fn sample(&self, run: usize, has_chart: bool) -> Option<LineStyle> {
        let view = &self.scene.view;
        let has_curves = !view.paths.is_empty() || view.ghost == Some(Ghost::Run(run));
        if !view.labels.legend || !(has_chart || has_curves) {
            return None;
        }
        // Without a chart of runs, only colours count.
        let line = style(&view.charts, run, self.scene, &self.palette);
        let has_dashes = has_chart && view.charts.iter().any(|chart| !matches!(chart, Plot::ByBody(_)));
        Some(if has_dashes { line } else { LineStyle { dash: &[], ..line } })
    }

    /// Whether the clock has no room beside the heading of its panel.
    fn is_crowded(&self, layout: &Layout, runs: &[usize], columns: usize) -> bool {
        let (names, at) = (self.names(runs), clock_panel(layout.panels.len(), columns));
        let Some(&panel) = layout.panels.get(at).filter(|_| at < runs.len()) else { return false };
        let seconds = self.seconds(runs, layout);
        let heading = self.heading(at, runs, &names, &seconds, layout);
        let label = self.clock_label(layout);
        layout.written.labels.clock && self.writer(layout.scale).is_crowded(panel, &heading, label)
    }

    /// The words without room in pictures of some runs, each with the consequence, and the runs whose names and whose
    /// descriptions are shortened.
    fn without_room(&self, runs: &[usize], columns: usize) -> (Vec<String>, [Vec<&str>; 2]) {
        let (view, PageWords { layout, .. }) = (&self.scene.view, self.around(runs, columns));
        let Labels { name, model, count, number, .. } = view.labels;
        let is_missed = |part: &Part| match part {
            Part::Name => name,
            Part::Second => model,
            Part::Numbers => count || number,
            _ => true,
        };
        let in_panels: Vec<_> = layout.written.left_out.iter().copied().filter(is_missed).collect();
        let mut told = layout::told(&layout.parts, &in_panels);
        let writer = self.writer(layout.scale);
        if let Some((plot, &panel)) = view
            .charts
            .iter()
            .find(|plot| plot.is_over_time())
            .zip(layout.panels.first())
            .filter(|_| layout.written.events)
        {
            let events = event::narrowest(plot, self.scene);
            if writer.explained(panel, &events.iter().collect::<Vec<_>>()) < events.len() {
                told.push("panels do not name all possible events of the chart".to_owned());
            }
        }
        let (names, seconds) = (self.names(runs), self.seconds(runs, &layout));
        let are_shortened = are_shortened(&self.described(runs, &layout), &seconds);
        let mut shortened = [Vec::new(), Vec::new()];
        for (at, &panel) in layout.panels.iter().enumerate().take(runs.len()) {
            let heading = self.heading(at, runs, &names, &seconds, &layout);
            let room = WordPlaces::new(layout.scale, panel).width();
            let is_shortened = [writer.is_shortened(&heading, room), are_shortened[at]];
            for (of, is_shortened) in shortened.iter_mut().zip(is_shortened) {
                of.extend(is_shortened.then_some(names[at]));
            }
        }
        (told, shortened)
    }
}

/// The words without room in the pictures of a scene, in every arrangement that its course may ask for.
pub(crate) fn left_out(scene: &Scene) -> Vec<String> {
    let composer = Composer::new(scene, &History::default());
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let columns = composer.columns(&runs);
    // The course of the scene may change the arrangement, between that of the start and side by side.
    let last = if scene.view.columns.is_none() { runs.len().max(columns) } else { columns };
    composer.lacks(&runs, columns..=last)
}

impl Composer<'_> {
    /// The words without room in its pictures.
    pub(crate) fn left_out(&self) -> Vec<String> {
        let runs: Vec<_> = (0..self.scene.runs.len()).collect();
        let columns = self.columns(&runs);
        self.lacks(&runs, columns..=columns)
    }

    /// What has no room in pictures of runs with all of these numbers of columns.
    fn lacks(&self, runs: &[usize], columns: RangeInclusive<usize>) -> Vec<String> {
        // A thumbnail needs no words.
        if !Scale::legible(Layout::around(&self.scene.view).title()) {
            return Vec::new();
        }
        let (mut told, mut shortened) = self.without_room(runs, *columns.start());
        for columns in columns.clone().skip(1) {
            let (there, also) = self.without_room(runs, columns);
            told.retain(|one| there.contains(one));
            shortened.iter_mut().zip(also).for_each(|(of, also)| of.retain(|run| also.contains(run)));
        }
        for (of, what) in shortened.iter().zip(["name", "description"]) {
            match of[..] {
                [] => {}
                [run] => told.push(format!("the {what} of run `{run}` is shortened")),
                [first, .., last] => {
                    told.push(format!("the {what}s of {} runs are shortened, of `{first}` to `{last}`", of.len()));
                }
            }
        }
        let lacks_bar = |columns: usize| {
            let Arranged { around, numbers, .. } = self.arrange(runs, columns);
            let has_panels = !around.layout.panels.is_empty();
            self.scene.view.labels.scale_bar && has_panels && numbers.get(NumberPart::Bar).is_none()
        };
        let lacks_bar: Vec<_> = columns.map(lacks_bar).collect();
        if lacks_bar.contains(&true) {
            let may = if lacks_bar.contains(&false) { "may be" } else { "is" };
            told.push(format!("the scale bar {may} left out"));
        }
        told
    }
}

/// The size of the words of a scene (px) if it is too small to be read, so that they are left out.
pub(crate) fn type_left_out(scene: &Scene) -> Option<f64> {
    let view = &scene.view;
    let Labels { name, model, clock, count, number, .. } = view.labels;
    let has_words =
        [name, model, clock, count, number, !view.charts.is_empty(), !view.title.is_empty()].contains(&true);
    let usual = Layout::around(view).caption();
    (has_words && !Scale::legible(usual)).then_some(usual)
}

/// The panel with the clock, upper right, among panels in columns.
pub(super) fn clock_panel(panels: usize, columns: usize) -> usize {
    columns.clamp(1, panels.max(1)) - 1
}
