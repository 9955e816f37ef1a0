//! The simulations of figures: states of runs at chosen moments, and the time series of a scene for charts.

use crate::look::Plot;
use crate::runner::RunFrame;
use crate::runner::Runner;
use crate::runner::history::History;
use crate::scene::Scene;
use crate::scene::figure::{Content, Figure, Sheet};
use crate::sim::{Diagnostic, Moment, Scope, Snapshot};
use glam::DVec3;
use rayon::prelude::*;

/// The states that a figure shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moments {
    /// The cells of a sheet, row by row; empty for other figures. The run index is that in its scene.
    pub cells: Vec<Vec<RunFrame>>,
    /// For each cell the runs that its picture needs besides its own, at the same moment.
    pub others: Vec<Vec<Vec<RunFrame>>>,
    /// The time series of each scene, for the runs in its rows, in the scene's order. They end with the scene if charts
    /// show them, and with the last cell if only paths need them. Empty for other scenes and other figures.
    pub histories: Vec<History>,
    /// The forces of each run of each scene, for a diagram of forces; empty for other figures.
    pub forces: Vec<Vec<RunForces>>,
}

/// A run at its start and the forces there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunForces {
    /// The state.
    pub snapshot: Snapshot,
    /// The internal forces on each node (N), after Eq. (1) or Eq. (4) of the paper, without gravity.
    pub on_nodes: Vec<DVec3>,
}

impl Moments {
    /// Simulates the states that a figure shows.
    ///
    /// It uses the rayon thread pool of the caller; the result has the same bits for any number of threads.
    pub fn new(figure: &Figure) -> Self {
        let mut taking = Taking::new(figure, Scope::Frames);
        while taking.advance(u64::MAX).is_some() {}
        taking.finish()
    }

    /// The states of a figure, each with a unique name, its scene and its run: cell by cell for a sheet; the initial states
    /// of all runs of its scenes for a diagram of forces.
    pub(crate) fn runs_and_states<'a>(&'a self, figure: &'a Figure) -> Vec<(String, OfRun<'a>, &'a Snapshot)> {
        let mut states = self.named_states(figure);
        // Two scenes may have the same title.
        for at in 1..states.len() {
            let same = states[..at].iter().filter(|state| state.0 == states[at].0).count();
            if same > 0 {
                states[at].0 += &format!(" ({})", same + 1);
            }
        }
        states
    }

    fn named_states<'a>(&'a self, figure: &'a Figure) -> Vec<(String, OfRun<'a>, &'a Snapshot)> {
        let named = |scene: &Scene, run: usize| format!("{} · {}", scene.title, scene.runs[run].name);
        match &figure.content {
            Content::Sheet(sheet) => {
                let rows = self.cells.iter().enumerate();
                rows.flat_map(|(row, cells)| {
                    cells.iter().enumerate().map(move |(column, cell)| {
                        let (scene, run, _) = sheet.cell(row, column);
                        let scene = &sheet.scenes[scene];
                        let name = format!("{}, row {}, column {}", named(scene, run), row + 1, column + 1);
                        (name, (scene, run), &cell.snapshot)
                    })
                })
                .collect()
            }
            Content::Forces(forces) => {
                let scenes = forces.scenes.iter().zip(&self.forces);
                let states = scenes.flat_map(|(scene, runs)| (0..).zip(runs).map(move |(run, of)| (scene, run, of)));
                states.map(|(scene, run, of)| (named(scene, run), (scene, run), &of.snapshot)).collect()
            }
        }
    }
}

/// A run of a scene.
type OfRun<'a> = (&'a Scene, usize);

/// The simulations of a figure, advanced in slices.
pub(crate) struct Taking<'a> {
    figure: &'a Figure,
    /// The diagnostics of its states.
    wanted: Vec<Diagnostic>,
    parts: Vec<ShownRun<'a>>,
    /// For each scene the parts with time series of its runs, if these are shown.
    series: Vec<Vec<usize>>,
}

/// One run, advanced through its shown moments.
struct ShownRun<'a> {
    /// Index of the scene, and of the run in it.
    of: [usize; 2],
    runner: Runner<'a>,
    /// Moments to stop at, rising, each with the cells (row by row) that show that state.
    stops: Vec<(Moment, Vec<usize>)>,
    taken: Vec<RunFrame>,
    /// The last moment.
    end: Moment,
}

impl<'a> Taking<'a> {
    /// The simulations of a figure at their start. The states have the diagnostics that are written at this `scope` or
    /// wider, and the diagnostics that the figure shows.
    pub(crate) fn new(figure: &'a Figure, scope: Scope) -> Self {
        let wanted = Diagnostic::within(scope);
        match &figure.content {
            Content::Sheet(sheet) => Self::of_sheet(figure, sheet, wanted.chain(sheet.number).collect()),
            Content::Forces(_) => Self { figure, wanted: wanted.collect(), parts: Vec::new(), series: Vec::new() },
        }
    }

    fn of_sheet(figure: &'a Figure, sheet: &'a Sheet, wanted: Vec<Diagnostic>) -> Self {
        let mut parts: Vec<ShownRun<'a>> = Vec::new();
        let mut part = |of: [usize; 2]| match parts.iter().position(|part| part.of == of) {
            Some(known) => known,
            None => {
                // Most sheets show more runs than there are threads.
                let runner = Runner::among(usize::MAX, &sheet.scenes[of[0]], &[of[1]]).with_diagnostics(&wanted);
                let numbers = wanted.iter().copied().map(Plot::from);
                let runner = runner.keeping_contact(&sheet.charts.iter().cloned().chain(numbers).collect::<Vec<_>>());
                parts.push(ShownRun { of, runner, stops: Vec::new(), taken: Vec::new(), end: Moment::at(0.0) });
                parts.len() - 1
            }
        };
        let (rows, columns) = (sheet.rows.len(), sheet.columns.len());
        let cells = (0..rows * columns).map(|at| sheet.cell(at / columns, at % columns));
        let shown: Vec<_> = cells.clone().map(|(scene, run, time)| (part([scene, run]), Moment::at(time))).collect();
        let has_charts = !sheet.charts.is_empty();
        let of_scene = |(at, scene): (usize, &Scene)| {
            let is_shown = |run: &usize| sheet.rows.iter().any(|row| row.run == scene.runs[*run].name);
            let has_series = has_charts || !scene.view.paths.is_empty();
            let runs = (0..scene.runs.len()).filter(|run| has_series && is_shown(run));
            runs.map(|run| part([at, run])).collect::<Vec<_>>()
        };
        let series: Vec<_> = sheet.scenes.iter().enumerate().map(of_scene).collect();
        // The runs that pictures of other runs need come after the cells.
        let others = cells.flat_map(|(scene, run, time)| {
            let compared = sheet.scenes[scene].view.compared();
            compared.map(|other| other.filter(|&(_, other)| other != run).map(|(_, other)| (scene, other, time)))
        });
        let others = others.map(|other| other.map(|(scene, run, time)| (part([scene, run]), Moment::at(time))));
        let others: Vec<_> = others.collect();
        let shown = shown.into_iter().map(Some).chain(others).enumerate();
        for (at, (part, moment)) in shown.filter_map(|(at, shown)| Some((at, shown?))) {
            let ShownRun { runner, stops, end, .. } = &mut parts[part];
            let steps = runner.steps_at(moment);
            match stops.binary_search_by_key(&steps, |stop| runner.steps_at(stop.0)) {
                Ok(place) => stops[place].1.push(at),
                Err(place) => stops.insert(place, (moment, vec![at])),
            }
            *end = stops.last().expect("one at least").0;
        }
        let times: Vec<_> = sheet.columns.iter().filter_map(|column| column.time).collect();
        let closer = sheet.split.map(|split| [sheet.from, split]);
        let parts = parts.into_iter().enumerate().map(|(at, mut part)| {
            if series[part.of[0]].contains(&at) {
                part.runner = part.runner.with_closer_time_series(&sheet.charts, closer, &times);
                let scene = &sheet.scenes[part.of[0]];
                let last = scene.moment(scene.last_frame());
                if has_charts && part.runner.steps_at(last) > part.runner.steps_at(part.end) {
                    part.end = last;
                }
            }
            part
        });
        let parts = parts.collect();
        Self { figure, wanted, parts, series }
    }

    /// Advances each run by at most `most_steps`. Returns the steps taken so far and those at the end, of all simulations
    /// together; `None` when all have reached their end. The result has the same bits however the steps are divided into calls.
    pub(crate) fn advance(&mut self, most_steps: u64) -> Option<[u64; 2]> {
        let arrived = self.parts.par_iter_mut().map(|part| part.advance(most_steps));
        let arrived = arrived.reduce(|| true, |one, other| one && other);
        let steps = |[done, all]: [u64; 2], part: &ShownRun<'_>| {
            [done.saturating_add(part.runner.steps()), all.saturating_add(part.runner.steps_at(part.end))]
        };
        (!arrived).then(|| self.parts.iter().fold([0; 2], steps))
    }

    /// The states and time series.
    ///
    /// # Panics
    /// If the simulations have not reached their end.
    pub(crate) fn finish(mut self) -> Moments {
        match &self.figure.content {
            Content::Sheet(sheet) => {
                let mut cells: Vec<Option<RunFrame>> = vec![None; 3 * sheet.rows.len() * sheet.columns.len()];
                for part in &self.parts {
                    assert_eq!(part.taken.len(), part.stops.len(), "finished when all moments are taken");
                    for ((_, places), taken) in part.stops.iter().zip(&part.taken) {
                        places.iter().for_each(|&place| cells[place] = Some(taken.clone()));
                    }
                }
                let columns = sheet.columns.len().max(1);
                let others = cells.split_off(cells.len() / 3);
                let others: Vec<Vec<_>> = others.chunks(2).map(|two| two.iter().flatten().cloned().collect()).collect();
                let mut cells: Vec<_> = cells.into_iter().map(|cell| cell.expect("each cell has a run")).collect();
                for (at, (cell, others)) in cells.iter_mut().zip(&others).enumerate() {
                    let (scene, ..) = sheet.cell(at / columns, at % columns);
                    let to = sheet.scenes[scene].view.colour.and_then(|scale| scale.to);
                    others.iter().filter(|other| Some(other.run) == to).for_each(|other| cell.measure(other));
                }
                let others = others.chunks(columns).map(<[_]>::to_vec).collect();
                let rows = cells.chunks(columns).map(<[RunFrame]>::to_vec).collect();
                let histories = self.series.into_iter().map(|series| {
                    let mut all = series.into_iter().map(|part| self.parts[part].runner.take_history());
                    let mut history = all.next().unwrap_or_default();
                    history.series.extend(all.flat_map(|one| one.series));
                    history
                });
                Moments { cells: rows, others, histories: histories.collect(), forces: Vec::new() }
            }
            Content::Forces(forces) => {
                let of_run = |scene: &Scene, run: usize| {
                    let mut world = scene.world(run);
                    world.want(&self.wanted);
                    RunForces { snapshot: world.snapshot(), on_nodes: world.forces() }
                };
                let of_scene = |scene: &Scene| (0..scene.runs.len()).map(|run| of_run(scene, run)).collect();
                Moments { forces: forces.scenes.iter().map(of_scene).collect(), ..Moments::default() }
            }
        }
    }
}

impl ShownRun<'_> {
    fn advance(&mut self, most_steps: u64) -> bool {
        let mut left = most_steps;
        while let Some(&(stop, _)) = self.stops.get(self.taken.len()) {
            let before = self.runner.steps();
            if !self.runner.advance_towards(stop, left) {
                return false;
            }
            // After a divergence only the clock advances.
            left = left.saturating_sub(self.runner.steps() - before);
            self.taken.extend(self.runner.snapshots());
        }
        self.runner.advance_towards(self.end, left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_scene_however_the_way_is_cut_up() {
        let figure = Figure::built_in("fig4b").unwrap();
        let Content::Sheet(sheet) = &figure.content else { panic!("a contact sheet") };
        let whole = Moments::new(&figure);
        assert_eq!((whole.cells.len(), whole.cells[0].len()), (sheet.rows.len(), sheet.columns.len()));
        let mut taking = Taking::new(&figure, Scope::Frames);
        while let Some([done, all]) = taking.advance(17) {
            assert!(done < all);
        }
        // A run without rotations has no residual. NaN is not equal to itself, so texts are compared.
        assert_eq!(format!("{:?}", taking.finish()), format!("{whole:?}"));
        let last = sheet.scenes[0].last_frame();
        let frame = Runner::new(&sheet.scenes[0], &[0, 1]).frame(last);
        let time = Some(sheet.scenes[0].frame_time(last));
        let column = sheet.columns.iter().position(|column| column.time == time).expect("the last moment is shown");
        assert_eq!(whole.cells[1][column].snapshot.position, frame.runs[1].snapshot.position);
        assert_eq!(whole.histories[0].series.len(), 2);
    }
}
