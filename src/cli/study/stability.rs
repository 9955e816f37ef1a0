//! `study stability`: the runs of a scene, from small steps to beyond the predicted limit.

use super::{Findings, OfScene, Plan};
use crate::cli::console::print;
use crate::cli::failure::{Failure, Status};
use crate::cli::options::ThreadOptions;
use crate::cli::record;
use crate::output::OutputError;
#[cfg(feature = "render")]
use crate::picture::{Map, Maps, Tile};
#[cfg(feature = "render")]
use crate::reading::words::short;
use crate::study::stability::{Cell, Outcome, Protocol, measure, read, usual};
#[cfg(feature = "render")]
use crate::study::stability::{Grid, Results};
use clap::Args;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The runs of a scene for stiffnesses over three decades and steps up to beyond the predicted limit: whole, turned over or diverged
#[derive(Args, Debug)]
pub(super) struct Stability {
    #[command(flatten)]
    of: OfScene,

    #[command(flatten)]
    threads: ThreadOptions,
}

impl Stability {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let protocol = if self.of.full { Protocol::full() } else { Protocol::usual() };
        let scene = self.of.subject()?.unwrap_or_else(usual);
        let mark = self.of.mark("stability");
        if protocol.work(&scene) == 0 {
            let message = format!(
                "all runs of “{}” find their own steps: there is nothing to map; give one another integrator",
                scene.title
            );
            return Err(Failure::usage(message));
        }
        let plan = Plan { name: "stability", mark: mark.clone(), plots: &["stability"], work: protocol.work(&scene) };
        let pool = record::pool(self.threads.count())?;
        let made = Made::new(&self.of.options.folder(&plan), &mark, &scene.digest);
        made.check(self.of.options.overwrite)?;
        let status = self.of.options.run(&plan, Some(&self.of.plots), |watch| {
            let known = made.read();
            let done = |cell: &Cell| made.add(cell);
            let results =
                pool.install(|| measure(protocol, &scene, &|cell| known.get(&cell.key()).copied(), &done, watch))?;
            Some(Findings {
                markdown: results.markdown(&mark),
                csv: results.csv(),
                #[cfg(feature = "render")]
                plots: vec![Box::new(maps(&results))],
                json: results.json(),
            })
        })?;
        if status == Status::Done {
            made.remove();
        }
        if status == Status::Interrupted && self.of.options.printing.prints_text() {
            print("the same command goes on from here\n")?;
        }
        Ok(status)
    }
}

/// The cells that are made, in a file beside the results, from which an interrupted study goes on. It is removed at the end. Errors of
/// that file are ignored: it only saves time.
struct Made {
    folder: PathBuf,
    path: PathBuf,
    /// The command that makes the study.
    mark: String,
    /// The first line, which says of which study the cells are.
    head: String,
    file: Mutex<Option<File>>,
}

impl Made {
    fn new(folder: &Path, mark: &str, digest: &str) -> Self {
        let head = format!("{mark} {} {digest}\n", env!("CARGO_PKG_VERSION"));
        let path = folder.join("stability.unfinished");
        Self { folder: folder.to_owned(), path, mark: mark.to_owned(), head, file: Mutex::new(None) }
    }

    /// Refuses a folder with the cells of a study by another command, unless they may be lost.
    fn check(&self, overwrite: bool) -> Result<(), Failure> {
        let text = fs::read_to_string(&self.path).unwrap_or_default();
        let head = text.lines().next().unwrap_or_default();
        match head.rsplitn(3, ' ').last() {
            Some(other) if !head.is_empty() && other != self.mark && !overwrite => {
                let what = format!("what `{other}` has made until it was interrupted");
                Err(OutputError::Occupied { path: self.folder.clone(), what }.into())
            }
            _ => Ok(()),
        }
    }

    /// The cells of an interrupted study of the same settings. Those that are added follow them.
    fn read(&self) -> HashMap<String, Outcome> {
        let text = fs::read_to_string(&self.path).unwrap_or_default();
        let known: HashMap<_, _> = read(text.strip_prefix(&self.head).unwrap_or_default()).collect();
        let kept: String = known.iter().map(|(key, outcome)| outcome.line(key)).collect();
        let open = || {
            fs::write(&self.path, format!("{}{kept}", self.head))?;
            File::options().append(true).open(&self.path)
        };
        *self.file.lock().unwrap_or_else(PoisonError::into_inner) = open().ok();
        known
    }

    fn add(&self, cell: &Cell) {
        if let Some(file) = self.file.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
            let _ = file.write_all(cell.outcome.line(&cell.key()).as_bytes());
        }
    }

    fn remove(&self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// A map for each run, damping and speed.
#[cfg(feature = "render")]
fn maps(results: &Results) -> Maps {
    /// Shares at which steps are written.
    const TICKS: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];
    let map = |(grid, speed): (&Grid, f64)| {
        let cells: Vec<_> = results.of(grid, speed).collect();
        let mut across: Vec<f64> = cells.iter().map(|cell| cell.rate).collect();
        across.dedup();
        let tile = |cell: &&Cell| match cell.outcome {
            Outcome::Whole => Tile::Whole,
            Outcome::TurnedOver(_) => Tile::TurnedOver,
            Outcome::Diverged => Tile::Diverged,
        };
        let tick = |share: f64| (share, [short(share), format!("T/{:.1}", grid.steps_per_cycle(share))]);
        let limit = grid.limit.map(|_| (1.0, "predicted limit"));
        let stretched = grid.stretched.filter(|&share| share < 1.0).map(|share| (share, "with stretched springs"));
        // Of several maps of a run, what tells them apart; the model stands in the tables.
        let [name, conditions, model] = results.words(grid, speed);
        Map {
            name: [name, if conditions.is_empty() { model } else { conditions }],
            across,
            up: results.shares().to_vec(),
            cells: cells.iter().map(tile).collect(),
            ticks: TICKS.map(tick).into(),
            lines: limit.into_iter().chain(stretched).collect(),
            axes: [
                "k/m (1/s²)".to_owned(),
                if grid.limit.is_some() { "ΔT, as a share of the limit" } else { "ΔT, as a share of T/π" }.to_owned(),
                "ΔT".to_owned(),
            ],
        }
    };
    Maps {
        title: format!("Stability: {}", results.told.title),
        caption: vec![
            "Each cell is a run. The stiffness changes with the same damping ratio; the limit is predicted before the run, at rest."
                .to_owned(),
        ],
        maps: results.maps().map(map).collect(),
        columns: results.speeds().clamp(2, 3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finished_cells_are_found_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let cell = |share: f64| Cell {
            run: 1,
            rate: 1e4,
            speed: 1.0,
            damping: 0.1,
            share,
            step: 1e-3,
            outcome: if share > 0.5 { Outcome::Diverged } else { Outcome::TurnedOver(9) },
        };
        let made = Made::new(folder.path(), "study 1", "ab");
        assert!(made.read().is_empty());
        [0.2, 0.4, 0.8].map(cell).iter().for_each(|cell| made.add(cell));
        // As if the program was killed while it wrote.
        let path = folder.path().join("stability.unfinished");
        let text = fs::read_to_string(&path).expect("cells");
        fs::write(&path, &text[..text.len() - 3]).expect("to cut it");
        let again = Made::new(folder.path(), "study 1", "ab");
        let known = again.read();
        assert_eq!(known, HashMap::from([0.2, 0.4].map(|share| (cell(share).key(), Outcome::TurnedOver(9)))));
        again.add(&cell(0.8));
        assert_eq!(Made::new(folder.path(), "study 1", "ab").read().len(), 3);
        let other = Made::new(folder.path(), "study 2", "ab");
        assert!(other.check(false).is_err() && other.check(true).is_ok(), "of another command");
        let edited = Made::new(folder.path(), "study 1", "cd");
        assert!(edited.check(false).is_ok() && edited.read().is_empty(), "of an edited scene");
        again.remove();
        assert!(!path.exists());
    }
}
