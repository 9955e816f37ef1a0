//! `figure`: the paper's figures, and figures of the user.

use super::console;
use super::failure::{Failure, Status, note_no_room, warn};
use super::interrupt;
use super::options::{DeviceOptions, PrintOptions, ThreadOptions, number_in, size};
use super::record;
use super::still::{Still, StillFile, StillFormat, replaceable, size_text};
use crate::gpu::{Gpu, adapter_name};
use crate::look::Theme;
use crate::output::{AtomicFile, FolderLock, OutputError, Tags, folder_of, is_folder, read_tags};
use crate::picture::compose_figure;
use crate::reading::setting::Setting;
use crate::reading::words::nearest;
use crate::runner::RunFrame;
use crate::runner::moments::{Moments, RunForces, Taking};
use crate::scene::figure::built_in::NAMES;
use crate::scene::figure::{Content, Figure};
use crate::scene::{Limits, Scene, SceneError};
use crate::sim::{self, Chosen, Diagnostics, Scope, Snapshot};
use clap::{Args, ValueHint};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::thread;

const EXAMPLES: &str = "\
Examples:
  localshape figure                              the names of the figures
  localshape figure all                          every figure of the paper into output/figures/
  localshape figure fig1 fig4 -o paper --theme dark
  localshape figure my-sheet.toml                a figure of your own
  localshape figure fig4b -o fig4b.pdf           vectors for print, with text that can be searched

A figure file arranges runs and moments of scenes on a sheet. The files of the paper's figures are in figures/; copy one \
to make your own.";

/// The default folder for figures.
const FOLDER: &str = "output/figures";
/// The shortest side of a figure (px).
const LEAST_SIDE: u32 = 64;

/// Draw the paper's figures, or your own
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct FigureCommand {
    /// Names (fig1, fig2, fig3, fig4 or fig4a, fig4b, fig4c, restore, all) or figure files (TOML); without any, the names
    /// are listed
    #[arg(value_name = "FIGURE", value_hint = ValueHint::FilePath)]
    figures: Vec<String>,

    /// Output folder, with a file NAME.png for each figure; or the file of one figure, whose extension chooses the
    /// format: png, or svg and pdf for print
    #[arg(short, long, value_name = "DIR|FILE", default_value = FOLDER, value_hint = ValueHint::AnyPath)]
    out: PathBuf,

    /// Also replace pictures of the same name that this program did not make
    #[arg(long)]
    overwrite: bool,

    /// Width and height (px) [default: that of each figure]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,

    /// Change a key of the figures' scenes for this command, such as run[0].model.stiffness=1e4. The key is written as in
    /// messages, the value as in a scene file; words need no quotation marks. Can be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Setting>,

    /// Scale of the figures, from 0.1 to 4: 0.5 for web pages
    #[arg(long, value_name = "TIMES", value_parser = number_in(0.1, 4.0), conflicts_with = "size")]
    scale: Option<f64>,

    /// The colours: light for papers, dark for talks [default: those of each figure]
    #[arg(long, value_name = "THEME")]
    theme: Option<Theme>,

    #[command(flatten)]
    device: DeviceOptions,
    #[command(flatten)]
    threads: ThreadOptions,
    #[command(flatten)]
    printing: PrintOptions,
}

impl FigureCommand {
    pub(super) fn run(self) -> Result<Status, Failure> {
        if self.figures.is_empty() {
            if self.printing.json {
                console::print_json(&json!({ "names": NAMES }))?;
                return Ok(Status::Done);
            }
            console::print(&format!("figures: {}, fig4 (all of Fig. 4), all\n", NAMES.join(", ")))?;
            return Ok(Status::Done);
        }
        StillFormat::check_name(&self.out)?;
        self.threads.start()?;
        let mut figures = self.load()?;
        if !self.printing.quiet {
            figures.iter().for_each(warn_of_figure);
        }
        for figure in &mut figures {
            self.fit(figure)?;
        }
        let paths = self.paths(&figures)?;
        let lit = figures.iter().filter(|figure| figure.is_lit());
        let gpu = self.device.open(lit.map(|figure| figure.size))?;
        interrupt::listen();
        let pool = self.threads.pool()?;
        let folder = self.folder();
        std::fs::create_dir_all(folder).map_err(OutputError::writing(folder))?;
        let _lock = FolderLock::beside_others(folder);
        let (mut made, mut result) = (Vec::new(), Ok(Status::Done));
        // Figures are compressed and written while the next ones are simulated and drawn, each on a thread.
        thread::scope(|scope| {
            let (mut figures, mut writing) = (figures.iter().zip(&paths), VecDeque::new());
            loop {
                let next = figures.next().filter(|_| matches!(result, Ok(Status::Done)));
                if let Some((figure, path)) = next {
                    match pool.install(|| self.make(figure, path, gpu.as_ref())) {
                        Ok(Some((made, numbers))) => {
                            writing.push_back((figure, path, numbers, scope.spawn(|| made.write())));
                        }
                        Ok(None) => result = Ok(Status::Interrupted),
                        Err(failure) => result = Err(failure),
                    }
                    if writing.len() < self.threads.count() {
                        continue;
                    }
                }
                let Some((figure, path, numbers, thread)) = writing.pop_front() else { break };
                match thread.join().unwrap_or_else(|panic| resume_unwind(panic)) {
                    Ok(true) => made.push((figure, path, numbers)),
                    // Only the first error is reported.
                    _ if result.is_err() => {}
                    Ok(false) => result = Ok(Status::Interrupted),
                    Err(failure) => result = Err(failure),
                }
            }
        });
        // Finished figures are listed before the failure.
        self.report(&made)?;
        result
    }

    /// Sets the requested size and colours of a figure.
    fn fit(&self, figure: &mut Figure) -> Result<(), Failure> {
        if let Some(size) = self.size {
            (figure.size, figure.print) = (size, None);
        }
        if let Some(times) = self.scale {
            if let Some(print) = &mut figure.print {
                print.mm = print.mm.map(|side| side * times);
            }
            figure.size = figure.size.map(|side| (f64::from(side) * times).round() as u32);
        }
        let [width, height] = figure.size;
        if width.min(height) < LEAST_SIDE {
            bail!("{}: {width}×{height} is too small; expected at least {LEAST_SIDE} pixels a side", figure.name);
        }
        if let Some(theme) = self.theme {
            figure.set_theme(theme);
        }
        Ok(())
    }

    /// Makes one figure, ready to be written, and returns it with its numbers; `None` if it was interrupted. Before the
    /// work, checks that its file can be written.
    fn make(&self, figure: &Figure, path: &Path, gpu: Option<&Gpu>) -> Result<Option<(Made, Value)>, Failure> {
        let file = AtomicFile::create_anew(path)?;
        let Some(moments) = self.take(figure) else { return Ok(None) };
        figure.scenes().iter().try_for_each(Scene::check_recordings).map_err(OutputError::reading(path))?;
        let [width, height] = figure.size;
        let (picture, left_out) = compose_figure(figure, &moments)
            .map_err(|error| Failure::usage(format!("{}: at {width}×{height} {error}", figure.name)))?;
        if !self.printing.quiet {
            note_no_room(&figure.name, figure.size, &left_out);
        }
        let gpu = gpu.filter(|_| figure.is_lit());
        let tags = Tags::of_figure(figure, &moments, &adapter_name(gpu)).texts();
        let title = &figure.title;
        let print = figure.print.as_ref();
        let source = print.map_or("", |print| &print.file);
        let still = Still { picture: &picture, print, source, title, tags: &tags };
        let drawn = still.draw(self.format(), gpu)?;
        Ok(Some((Made { drawn, file }, numbers(figure, &moments))))
    }

    /// The format of the files.
    fn format(&self) -> StillFormat {
        StillFormat::of(&self.out).unwrap_or(StillFormat::Png)
    }

    fn folder(&self) -> &Path {
        if StillFormat::of(&self.out).is_some() { folder_of(&self.out) } else { &self.out }
    }

    /// All requested figures, each once.
    fn load(&self) -> Result<Vec<Figure>, Failure> {
        let mut figures: Vec<(Figure, PathBuf)> = Vec::new();
        for asked in &self.figures {
            let is_meant = |name: &str| asked == "all" || name == asked || asked == "fig4" && name.starts_with("fig4");
            let meant: Vec<_> = NAMES.into_iter().filter(|name| is_meant(name)).collect();
            let is_path = asked.contains(['/', '\\']) || asked.ends_with(".toml") || Path::new(asked).exists();
            let found: Vec<(Figure, PathBuf)> = if !meant.is_empty() {
                let built_in = meant.into_iter().filter_map(|name| Figure::built_in_with(name, &self.set));
                // A built-in figure is not at any path.
                built_in.map(|figure| Ok((figure?, PathBuf::new()))).collect::<Result<_, SceneError>>()?
            } else if is_path {
                vec![(Figure::load_with(Path::new(asked), &self.set, &Limits::default())?, PathBuf::from(asked))]
            } else {
                return Err(Failure::usage(unknown(asked)));
            };
            for (figure, path) in found {
                match figures.iter().find(|(known, _)| known.name == figure.name) {
                    None => figures.push((figure, path)),
                    Some((_, known)) if *known == path => {}
                    Some(_) => {
                        let file = self.out.join(format!("{}.png", figure.name));
                        bail!(
                            "two figures would both be written to {}; draw them one at a time with -o",
                            file.display()
                        );
                    }
                }
            }
        }
        Ok(figures.into_iter().map(|(figure, _)| figure).collect())
    }

    /// The file of each figure. Files of other programs are not replaced.
    fn paths(&self, figures: &[Figure]) -> Result<Vec<PathBuf>, Failure> {
        if StillFormat::of(&self.out).is_some() {
            return match figures {
                [_] if self.overwrite => Ok(vec![self.out.clone()]),
                [_] => replaceable(&self.out, self.format()).map(|()| vec![self.out.clone()]),
                _ => {
                    let (file, count) = (self.out.display(), figures.len());
                    bail!("{file} is a file for one figure, but {count} are asked for; draw them one at a time")
                }
            };
        }
        is_folder(&self.out)?;
        let path = |figure: &Figure| {
            let name = format!("{}.png", figure.name);
            let path = self.out.join(&name);
            let is_figure = || Ok::<_, OutputError>(read_tags(&path)?.is_some_and(|(_, tags)| tags.frame().is_none()));
            if path.is_dir() || !self.overwrite && path.exists() && !is_figure()? {
                let what = format!("{name}, which is not a figure of this program");
                return Err(Failure::from(OutputError::Occupied { path: self.out.clone(), what }));
            }
            Ok(path)
        };
        figures.iter().map(path).collect()
    }

    /// Simulates the states that a figure shows; `None` if it was interrupted.
    fn take(&self, figure: &Figure) -> Option<Moments> {
        let mut taking = Taking::new(figure, Scope::Summaries);
        let slice = record::slice(figure.scenes().iter().flat_map(|scene| &scene.runs));
        let bar = self.printing.progress(&figure.name, 0);
        while !interrupt::requested()
            && let Some([done, all]) = taking.advance(slice)
        {
            bar.set_length(all);
            bar.set_position(done);
        }
        bar.finish_and_clear();
        (!interrupt::requested()).then(|| taking.finish())
    }

    /// Lists the figures that were made.
    fn report(&self, made: &[(&Figure, &PathBuf, Value)]) -> Result<(), Failure> {
        if self.printing.json {
            let entry = |(figure, path, numbers): &(&Figure, &PathBuf, Value)| {
                let file = path.to_string_lossy();
                json!({ "name": figure.name, "file": file, "size": figure.size, "numbers": numbers })
            };
            let figures: Vec<_> = made.iter().map(entry).collect();
            return console::print_json(&json!({ "figures": figures }));
        }
        if !self.printing.quiet {
            for (figure, path, _) in made {
                let size = size_text(self.format(), figure.size, figure.print.as_ref());
                console::print(&format!("{}  {size}\n", path.display()))?;
            }
        }
        Ok(())
    }
}

/// A drawn figure, and its file.
struct Made {
    drawn: StillFile,
    file: AtomicFile,
}

impl Made {
    /// Compresses and writes the figure, unless the user interrupts the command. Returns whether it did.
    fn write(mut self) -> Result<bool, Failure> {
        let bytes = (self.drawn)();
        if interrupt::requested() {
            return Ok(false);
        }
        self.file.append(&bytes)?;
        self.file.commit()?;
        Ok(true)
    }
}

/// The numbers of a figure: for a diagram of forces, forces over stiffness of every run in sides; for a sheet, what
/// each cell shows (SI). Several bodies of a run also have theirs.
fn numbers(figure: &Figure, moments: &Moments) -> Value {
    match &figure.content {
        Content::Forces(forces) => {
            let of_scene = |(scene, found): (&Scene, &Vec<RunForces>)| {
                let runs = scene.runs.iter().zip(found).map(|(run, found)| {
                    let of_body = |body: usize| {
                        let stiffness = run.models[body].properties(&run.bodies.bodies()[body]).stiffness;
                        let unit = stiffness * scene.view.side;
                        found.on_nodes[run.bodies.nodes(body)].iter().map(move |force| (*force / unit).to_array())
                    };
                    let forces: Vec<_> = (0..run.of.len()).flat_map(of_body).collect();
                    let mut entry = json!({ "run": run.name, "forces_over_stiffness_and_side": forces });
                    let bodies = (0..).zip(run.several(scene)).map(|(at, (name, _))| {
                        let forces: Vec<_> = of_body(at).collect();
                        json!({ "name": name, "forces_over_stiffness_and_side": forces })
                    });
                    add_bodies(&mut entry, bodies.collect());
                    entry
                });
                json!({ "scene": scene.title, "runs": runs.collect::<Vec<_>>() })
            };
            Value::Array(forces.scenes.iter().zip(&moments.forces).map(of_scene).collect())
        }
        Content::Sheet(sheet) => {
            let cell = |row: usize, column: usize| {
                let (scene, run, _) = sheet.cell(row, column);
                let RunFrame { snapshot: Snapshot { time, diagnostics, of_bodies, status, .. }, .. } =
                    &moments.cells[row][column];
                let (scene, number) = (&sheet.scenes[scene], |all: &Diagnostics| {
                    sheet.number.map(|number| number.of(all)).filter(|number| number.is_finite())
                });
                let described = |mut entry: Value, all: &Diagnostics| {
                    record::merge(&mut entry, json!(Chosen::within(Scope::Summaries, all)));
                    entry
                };
                let diverged = match status {
                    sim::Status::Diverged(divergence) => Some(divergence.time),
                    sim::Status::Ok => None,
                };
                let mut cell = json!({
                    "diverged_at": diverged,
                    "number": number(diagnostics),
                    "scene": scene.title,
                    "run": scene.runs[run].name,
                    "time": time,
                });
                cell = described(cell, diagnostics);
                let bodies = scene.runs[run].several(scene).zip(of_bodies);
                let bodies =
                    bodies.map(|((name, _), all)| described(json!({ "name": name, "number": number(all) }), all));
                add_bodies(&mut cell, bodies.collect());
                cell
            };
            let rows = 0..sheet.rows.len();
            let all = rows.map(|row| (0..sheet.columns.len()).map(|column| cell(row, column)).collect::<Vec<_>>());
            json!(all.collect::<Vec<_>>())
        }
    }
}

/// Prints the warnings of the scenes of a figure.
pub(super) fn warn_of_figure(figure: &Figure) {
    for scene in figure.scenes() {
        warn(scene.file.as_deref().unwrap_or(Path::new(&scene.name)), scene);
    }
}

/// Adds the entries of several bodies to that of their run.
fn add_bodies(entry: &mut Value, bodies: Vec<Value>) {
    if !bodies.is_empty() {
        record::merge(entry, json!({ "bodies": bodies }));
    }
}

/// The message for an unknown name.
fn unknown(asked: &str) -> String {
    let names: Vec<_> = NAMES.iter().copied().chain(["fig4", "all"]).collect();
    let hint = nearest(asked, &names).map_or(".".to_owned(), |near| format!("; did you mean `{near}`?"));
    format!(
        "there is no figure `{asked}`{hint} The figures are {}; a figure of your own is a .toml file",
        names.join(", ")
    )
}
