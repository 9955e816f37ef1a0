//! The summary after a scene.

use super::console::columns;
use crate::output::{Numbers, Outcome, RunEntry, RunStatus, Spent, Summary};
use crate::reading::captions::quantity;
use crate::reading::words::{several, short};
use crate::sim::{Diagnostic, Unsolved};
use std::path::Path;

/// A block of text: the results and their folder, the state of each run at the end, and the time taken.
pub(super) fn report(summary: &Summary, folder: &Path, timings: bool) -> String {
    let mut text = format!("{}\n{}\n", summary.scene.title, made(summary, folder));
    text += &table(&summary.runs);
    text += &causes(summary);
    text += &cut(summary);
    text += &times(summary);
    if timings {
        text += &all_times(summary);
    }
    text + &summary.films.concat()
}

fn made(summary: &Summary, folder: &Path) -> String {
    let frames = &summary.frames;
    let made = frames.written.map_or(frames.recorded, |written| written + frames.kept);
    let plural = if made == 1 { "" } else { "s" };
    let mut text = match summary.outcome {
        Outcome::Interrupted => format!("interrupted after {made} of {} frames", frames.asked),
        _ => format!("{made} frame{plural}"),
    };
    let size = frames.size.map_or(" simulated".to_owned(), |[width, height]| format!(" of {width}×{height}"));
    text += &format!("{size} in {}", folder.display());
    if let Some([reached, end]) = summary.reached {
        text += &format!(", simulated to {} s of {} s", short(reached), short(end));
    }
    match frames.kept {
        0 => text,
        kept => text + &format!(", {kept} of them drawn before"),
    }
}

/// The state of each run at the end, with the broken parts if some run breaks.
fn table(runs: &[RunEntry]) -> String {
    let heads = ["run", "status", "turned over", "broken", "shape error"].map(str::to_owned);
    let rows: Vec<_> = std::iter::once(heads).chain(runs.iter().flat_map(rows)).collect();
    if runs.iter().any(|run| run.last.as_ref().is_some_and(|last| last.all.broken.is_some())) {
        return columns(&rows, [false, false, true, true, true]);
    }
    let rows: Vec<_> = rows.into_iter().map(|[name, status, over, _, error]| [name, status, over, error]).collect();
    columns(&rows, [false, false, true, true])
}

/// The row of a run, and one of each of its bodies if there are several.
fn rows(run: &RunEntry) -> Vec<[String; 5]> {
    let mut status = match &run.status {
        RunStatus::Ok => "ok".to_owned(),
        RunStatus::Ended { time } => format!("recording ends at {} s", short(*time)),
        RunStatus::Diverged { time, step, body, element } => {
            let element = element.map(|element| format!("element {element}"));
            let place: Vec<_> = element.into_iter().chain(body.clone()).collect();
            let place = if place.is_empty() { String::new() } else { format!(", {}", place.join(" of ")) };
            format!("diverged at {} s (step {step}{place})", short(*time))
        }
    };
    if let Some(Unsolved { steps, .. }) = run.unsolved {
        status += &format!(", {} not solved", several(steps, "step"));
    }
    let row = |name: String, status: String, numbers: Option<&Numbers>| {
        let Some(Numbers { diagnostics, broken, .. }) = numbers else {
            return [name, status, String::new(), String::new(), String::new()];
        };
        let turned_over = diagnostics.get(Diagnostic::TurnedOver).to_string();
        let broken = broken.map_or_else(String::new, |count| count.to_string());
        [name, status, turned_over, broken, quantity(diagnostics.get(Diagnostic::ShapeError), "m")]
    };
    let all = row(run.name.clone(), status, run.last.as_ref().map(|last| &last.all));
    let bodies = run.last.iter().flat_map(|last| &last.bodies);
    let of_bodies = bodies.map(|body| row(format!("  {}", body.name), String::new(), Some(&body.numbers)));
    std::iter::once(all).chain(of_bodies).collect()
}

/// Why runs diverged, one line each.
fn causes(summary: &Summary) -> String {
    let line = |run: &RunEntry| Some(format!("{} diverged: {}\n", run.name, run.cause.as_ref()?.words));
    summary.runs.iter().filter_map(line).collect()
}

/// A warning for each run with steps that its integrator has not solved.
pub(super) fn unsolved(summary: &Summary) -> impl Iterator<Item = String> {
    summary.runs.iter().filter_map(|run| {
        let Unsolved { steps, residual, first } = run.unsolved?;
        let (run, first, step) = (&run.name, short(first), quantity(run.time_step, "s"));
        let (of, residual) = (if steps == 1 { "a step" } else { "steps" }, quantity(residual, "m/s"));
        Some(format!(
            "“{run}” has {of} of {step} that `backward-euler` could not solve, first at {first} s, with a residual of up to {residual}; \
             take shorter steps"
        ))
    })
}

/// A warning for each run whose body leaves its panel.
fn cut(summary: &Summary) -> String {
    let warning = |run: &RunEntry| {
        let first = run.cut.first()?;
        let (count, all) = (run.cut.len(), summary.frames.written.unwrap_or(summary.frames.recorded));
        let help = "move the camera back, or let it follow the body: `view.camera` without `target` and `distance`";
        Some(format!(
            "warning: {} leaves its panel in {count} of {all} frames, first in frame {first}; {help}\n",
            run.name
        ))
    };
    summary.runs.iter().filter_map(warning).collect()
}

fn times(summary: &Summary) -> String {
    let Some(times) = &summary.times else { return String::new() };
    let stages = [(Some(times.simulate), "simulating"), (times.draw, "drawing"), (times.encode, "encoding")];
    let shares = stages.into_iter().filter_map(|(spent, name)| Some(format!("{name} {}", seconds(spent?.wall))));
    let overlap = if times.encode.is_some() { ", overlapping" } else { "" };
    format!("{}: {}{overlap}\n", seconds(times.total.wall), shares.collect::<Vec<_>>().join(", "))
}

fn all_times(summary: &Summary) -> String {
    let Some(times) = &summary.times else { return String::new() };
    let stages = [
        ("simulate", Some(times.simulate)),
        ("compose", times.compose),
        ("draw", times.draw),
        ("encode and write", times.encode),
        ("all, overlapping", Some(times.total)),
    ];
    let frames = summary.frames.recorded.max(1) as f64;
    let row = |(name, spent): (&str, Option<Spent>)| {
        let Spent { wall, cpu } = spent?;
        let cpu = |scale: f64| cpu.map_or("–".to_owned(), |cpu| format!("{:.1}", cpu * scale));
        let [wall_frame, cpu_frame] = [format!("{:.2}", wall * 1e3 / frames), cpu(1e3 / frames)];
        Some([name.to_owned(), format!("{:.1}", wall * 1e3), cpu(1e3), wall_frame, cpu_frame])
    };
    let heads = ["stage", "wall ms", "cpu ms", "wall ms/frame", "cpu ms/frame"].map(str::to_owned);
    let rows: Vec<_> = std::iter::once(heads).chain(stages.into_iter().filter_map(row)).collect();
    columns(&rows, [false, true, true, true, true])
}

fn seconds(time: f64) -> String {
    if time < 0.9995 {
        format!("{:.0} ms", time * 1e3)
    } else if time < 59.95 {
        format!("{time:.1} s")
    } else {
        let whole = time.round() as u64;
        let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
        if hours > 0 { format!("{hours} h {minutes} min") } else { format!("{minutes} min {seconds} s") }
    }
}
