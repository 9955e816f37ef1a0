//! What figures need of their simulations: states of runs at chosen moments, and the course of a scene for strips.

use crate::history::{History, Rehearsal};
use crate::scene::Scene;
use crate::scene::figure::{Content, Figure, Sheet};
use crate::sim::snapshot::{RunFrame, Snapshot, Status};
use crate::sim::world::World;
use rayon::prelude::*;
use std::borrow::Cow;

/// What a figure shows of its simulations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moments {
    /// The cells of a contact sheet, row by row; empty for other figures. The index of each run is that in its scene.
    pub cells: Vec<Vec<RunFrame>>,
    /// The course of the first scene, if strips are shown.
    pub history: Option<History>,
}

impl Moments {
    /// Simulates what a figure shows.
    ///
    /// It works on the rayon pool it is called from; the result has the same bits for any number of threads.
    pub fn new(figure: &Figure) -> Self {
        let mut taking = Taking::new(figure);
        while !taking.advance(u64::MAX) {}
        taking.finish()
    }

    /// The states behind a figure, each with a name of its own: those of a contact sheet cell by cell; of a diagram of
    /// forces those at the start of all runs of its scenes.
    pub fn states<'a>(&'a self, figure: &'a Figure) -> Vec<(String, Cow<'a, Snapshot>)> {
        self.runs_and_states(figure).into_iter().map(|(name, _, state)| (name, state)).collect()
    }

    /// The same with the scene and the run in it that each is of.
    pub(crate) fn runs_and_states<'a>(&'a self, figure: &'a Figure) -> Vec<(String, OfRun<'a>, Cow<'a, Snapshot>)> {
        let mut states = self.named_states(figure);
        // Two scenes may have one title.
        for at in 1..states.len() {
            let same = states[..at].iter().filter(|state| state.0 == states[at].0).count();
            if same > 0 {
                states[at].0 += &format!(" ({})", same + 1);
            }
        }
        states
    }

    fn named_states<'a>(&'a self, figure: &'a Figure) -> Vec<(String, OfRun<'a>, Cow<'a, Snapshot>)> {
        let named = |scene: &Scene, run: usize| format!("{} · {}", scene.title, scene.runs[run].name);
        match &figure.content {
            Content::Sheet(sheet) => {
                let rows = self.cells.iter().enumerate();
                rows.flat_map(|(row, cells)| {
                    cells.iter().enumerate().map(move |(column, cell)| {
                        let (scene, run, _) = sheet.cell(row, column);
                        let scene = &sheet.scenes[scene];
                        let name = format!("{}, row {}, column {}", named(scene, run), row + 1, column + 1);
                        (name, (scene, run), Cow::Borrowed(&cell.snapshot))
                    })
                })
                .collect()
            }
            Content::Forces(forces) => {
                let runs = |scene: &'a Scene| (0..scene.runs.len()).map(move |run| (scene, run));
                let states = forces.scenes.iter().flat_map(runs);
                let state = |(scene, run): OfRun<'a>| {
                    (named(scene, run), (scene, run), Cow::Owned(scene.world(run).snapshot()))
                };
                states.map(state).collect()
            }
        }
    }
}

/// A run of a scene.
type OfRun<'a> = (&'a Scene, usize);

/// A figure's simulations on their way, in slices.
pub struct Taking {
    rows: usize,
    columns: usize,
    parts: Vec<Part>,
    course: Option<Rehearsal>,
}

/// One run on its way through the moments that are shown of it.
struct Part {
    run: usize,
    world: World,
    /// Steps to stop at, rising, with the cells (row by row) that show the state then.
    stops: Vec<(u64, Vec<usize>)>,
    taken: Vec<Snapshot>,
}

impl Taking {
    /// The simulations of a figure at their start.
    pub fn new(figure: &Figure) -> Self {
        match &figure.content {
            Content::Sheet(sheet) => Self::of_sheet(sheet),
            Content::Forces(_) => Self { rows: 0, columns: 0, parts: Vec::new(), course: None },
        }
    }

    fn of_sheet(sheet: &Sheet) -> Self {
        let (rows, columns) = (sheet.rows.len(), sheet.columns.len());
        let mut parts: Vec<(usize, Part)> = Vec::new();
        for at in 0..rows * columns {
            let (scene_at, run, time) = sheet.cell(at / columns, at % columns);
            let scene = &sheet.scenes[scene_at];
            let step = (time / scene.runs[run].step).round() as u64;
            let known = parts.iter().position(|(scene, part)| (*scene, part.run) == (scene_at, run));
            let known = known.unwrap_or_else(|| {
                let part = Part { run, world: scene.world(run), stops: Vec::new(), taken: Vec::new() };
                parts.push((scene_at, part));
                parts.len() - 1
            });
            let stops = &mut parts[known].1.stops;
            match stops.binary_search_by_key(&step, |stop| stop.0) {
                Ok(place) => stops[place].1.push(at),
                Err(place) => stops.insert(place, (step, vec![at])),
            }
        }
        let course = (!sheet.strips.is_empty()).then(|| {
            let scene = &sheet.scenes[0];
            // The runs shown, in the order of the scene.
            let runs: Vec<_> = (0..scene.runs.len())
                .filter(|&run| sheet.rows.iter().any(|row| row.run == scene.runs[run].name))
                .collect();
            let shown: Vec<_> = sheet.columns.iter().filter_map(|column| column.time).collect();
            Rehearsal::new(scene, &runs).with(scene, sheet.split.map(|split| [sheet.from, split]), &shown)
        });
        Self { rows, columns, parts: parts.into_iter().map(|(_, part)| part).collect(), course }
    }

    /// Goes on, each run by `most_steps` at most, and returns whether all are at their end. However the way is cut up,
    /// the result has the same bits.
    pub fn advance(&mut self, most_steps: u64) -> bool {
        let Self { parts, course, .. } = self;
        let (arrived, ended) = rayon::join(
            || parts.par_iter_mut().map(|part| part.advance(most_steps)).reduce(|| true, |one, other| one && other),
            || course.as_mut().is_none_or(|course| course.advance(most_steps)),
        );
        arrived && ended
    }

    /// Steps done with so far, and steps at the end, of all simulations together.
    pub fn steps(&self) -> [u64; 2] {
        let last = |part: &Part| part.stops.last().map_or(0, |stop| stop.0);
        let of_parts = self.parts.iter().fold([0_u64; 2], |[done, all], part| {
            let end = last(part);
            [done.saturating_add(part.world.steps().min(end)), all.saturating_add(end)]
        });
        let of_course = self.course.as_ref().map_or([0; 2], |course| [course.steps(), course.steps_at_end()]);
        [0, 1].map(|at| of_parts[at].saturating_add(of_course[at]))
    }

    /// What was taken.
    ///
    /// # Panics
    /// If the simulations are not at their end.
    pub fn finish(self) -> Moments {
        let mut cells: Vec<Option<RunFrame>> = vec![None; self.rows * self.columns];
        for part in self.parts {
            assert_eq!(part.taken.len(), part.stops.len(), "finished when all moments are taken");
            for ((_, places), snapshot) in part.stops.iter().zip(part.taken) {
                for &place in places {
                    cells[place] = Some(RunFrame { run: part.run, snapshot: snapshot.clone() });
                }
            }
        }
        let cells: Vec<_> = cells.into_iter().map(|cell| cell.expect("each cell has a run")).collect();
        let rows = cells.chunks(self.columns.max(1)).map(<[RunFrame]>::to_vec).collect();
        Moments { cells: rows, history: self.course.map(Rehearsal::finish) }
    }
}

impl Part {
    fn advance(&mut self, most_steps: u64) -> bool {
        let mut left = most_steps;
        while let Some(&(stop, _)) = self.stops.get(self.taken.len()) {
            let steps = stop - self.world.steps();
            // What blew up only lets its clock go on.
            let through = if self.world.status() == Status::Ok { left } else { u64::MAX };
            self.world.advance(steps.min(through));
            if steps > through {
                return false;
            }
            left = left.saturating_sub(steps);
            self.taken.push(self.world.snapshot());
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::Sequence;

    #[test]
    fn moments_are_those_of_the_scene_however_the_way_is_cut_up() {
        let figure = Figure::built_in("fig4b").unwrap();
        let Content::Sheet(sheet) = &figure.content else { panic!("a contact sheet") };
        let whole = Moments::new(&figure);
        assert_eq!((whole.cells.len(), whole.cells[0].len()), (sheet.rows.len(), sheet.columns.len()));
        let mut taking = Taking::new(&figure);
        while !taking.advance(17) {
            assert!(taking.steps()[0] < taking.steps()[1]);
        }
        // A run without rotations has no residual, and NaN equals nothing: compared as text.
        assert_eq!(format!("{:?}", taking.finish()), format!("{whole:?}"));
        let last = sheet.scenes[0].last_frame();
        let frame = Sequence::new(&sheet.scenes[0], &[0, 1]).frame(last);
        let time = Some(sheet.scenes[0].frame_time(last));
        let column = sheet.columns.iter().position(|column| column.time == time).expect("the last moment is shown");
        assert_eq!(whole.cells[1][column].snapshot.position, frame.runs[1].snapshot.position);
        assert_eq!(whole.history.unwrap().courses.len(), 2);
    }
}
