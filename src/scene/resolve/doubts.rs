//! Warnings about a resolved scene: allowed settings that are probably mistakes.

use super::Typed;
use crate::look::{View, font};
use crate::reading::captions::rounded;
use crate::reading::collector::Collector;
use crate::reading::words::{count, ends, list, quoted, short};
use crate::scene::file::{MotionPath, Positive, SceneFile, ShapeFile};
use crate::scene::mesh::longest;
use crate::scene::plausible::LONG;
use crate::scene::{Run, Scene, SceneBody};
use std::f64::consts::TAU;

/// Warns of all that is probably not meant.
pub(super) fn warn(scene: &Scene, typed: &Typed<'_>) {
    let report = typed.report;
    warn_of_missing_letters(scene, report);
    warn_of_unused(scene, typed);
    warn_of_time(scene, report);
    warn_of_uneven_rows(scene, report);
    warn_of_late(scene, typed);
    warn_of_rising_loads(scene, typed);
    warn_of_degrees(scene, typed);
    warn_of_steps(scene, typed);
    match &scene.contacts {
        Some(contacts) => super::contact::warn_of_ways(scene, contacts, typed),
        None => super::contact::warn_of_overlaps(scene, typed),
    }
    super::contact::warn_of_breaking(scene, report);
    warn_of_braked_rotation(scene, report);
    warn_of_sizes(scene, typed);
    if let Some((run, [message, help])) = scene.too_soft() {
        report.to("run").to(run).to("model").warn(message, help);
    }
}

/// Warns of bodies that no run has. A recording with a body of its own has no other.
fn warn_of_unused(scene: &Scene, typed: &Typed<'_>) {
    let several = if typed.file.body.len() > 1 { typed.file.body.len() } else { 0 };
    for body in (0..several).filter(|body| scene.runs.iter().all(|run| !run.of.contains(body))) {
        let message = format!("no run has {}", scene.bodies[body].in_words());
        typed.place(body).warn(message, "add it to `bodies` of a run, or remove it");
    }
}

/// Warns of texts in pictures with characters that no font has.
fn warn_of_missing_letters(scene: &Scene, report: &Collector<'_>) {
    let View { title, caption, clock, look, .. } = &scene.view;
    let around = [("title", title), ("caption", caption), ("clock", clock)];
    let around = around.into_iter().map(|(key, text)| (report.to("view").to(key), text));
    let runs = scene.runs.iter().enumerate();
    let runs = runs.map(|(at, run)| (report.to("run").to(at).to("name"), &run.name));
    for (here, text) in around.chain(runs) {
        let missing = font::missing(&look.font, text);
        let letter = |&letter: &char| format!("{} (U+{:04X})", quoted(&letter.to_string()), u32::from(letter));
        let mut letters: Vec<_> = missing.iter().map(letter).collect();
        let what = match letters.len() {
            0 => continue,
            1 => "its code is drawn in its place",
            _ => "their codes are drawn in their place",
        };
        if letters.len() > 5 {
            let others = letters.split_off(2).len();
            letters.push(format!("{others} other characters"));
        }
        let letters = list(&letters, "and", str::to_owned);
        let help = "write it in other letters, or give a `view.font` that has them";
        here.warn(format!("no font has {letters}, so that {what}"), help);
    }
}

/// Warns of a scene with one frame, and of a very long computation.
fn warn_of_time(scene: &Scene, report: &Collector<'_>) {
    /// Computation time for one corner of an element and one step (s), measured on one cube.
    const CORNER: f64 = 3e-8;
    const LONG: f64 = 7200.0;
    let last = scene.last_frame();
    if last == 0 && scene.duration > 0.0 {
        let (duration, rate) = (short(scene.duration), short(scene.frames_per_second));
        let message = format!("at {rate} frames per second, {duration} s have only one frame, the start");
        report.to("time").to("frames_per_second").warn(
            message,
            // Rounded down, there would be one frame again.
            format!("use at least {} to show the end", ends([0.0, 1.0 / scene.duration])[1]),
        );
    }
    let simulated = || (0..).zip(&scene.runs).filter(|(_, run)| run.recording.is_none());
    let steps = |run| scene.frame_step(run, last);
    let elements = |run: &Run| run.body().elements().len();
    let corners = |run: &Run| run.body().elements().indices().len().max(8) as f64;
    let seconds: f64 = simulated().map(|(at, run)| steps(at) as f64 * corners(run) * CORNER).sum();
    if seconds > LONG {
        let hours = seconds / 3600.0;
        let long = match hours {
            ..48.0 => format!("{hours:.0} hours"),
            ..10_000.0 => format!("{:.0} days", hours / 24.0),
            _ => format!("{:.0} years", hours / 8766.0),
        };
        let steps = count(simulated().map(|(at, _)| steps(at)).fold(0, u64::saturating_add).into());
        let (least, most) =
            simulated().map(|(_, run)| elements(run)).fold((usize::MAX, 0), |(a, b), one| (a.min(one), b.max(one)));
        let [fewest, elements] = [least, most].map(|elements| count(elements as u128));
        let elements = match most {
            1 => "1 element".to_owned(),
            _ if least < most => format!("{fewest} to {elements} elements"),
            _ => format!("{elements} elements"),
        };
        let message = format!("{steps} steps of all runs × {elements} take about {long} on one processor");
        let help = "make `duration` shorter, `step` larger or the body smaller, unless you can wait".to_owned();
        report.to("time").to("duration").warn(message, help);
    }
}

/// Warns of rows of frames that do not end an interval of mean forces.
fn warn_of_uneven_rows(scene: &Scene, report: &Collector<'_>) {
    let Some(every) = scene.every.filter(|_| scene.keeps_forces()) else { return };
    let rows = 1.0 / (scene.frames_per_second * every);
    if (rows - rows.round()).abs() > 1e-6 * rows {
        let message = "`time.every` does not divide the time between frames, so that rows of frames repeat the forces of the row before".to_owned();
        let even = 1.0 / (scene.frames_per_second * rows.round().max(1.0));
        report.to("time").to("every").warn(message, format!("write every = {}", rounded(even, 12)));
    }
}

/// Warns of what begins only when the scene has ended.
fn warn_of_late(scene: &Scene, typed: &Typed<'_>) {
    /// The time (s) until which an obstacle stands still: the pose of the first key holds from the start.
    fn first_move(path: &MotionPath) -> Option<f64> {
        path.keys.get(1).and(path.keys.first()).map(|key| key.time)
    }
    let SceneFile { load, hold, grab, obstacle, .. } = typed.file;
    let loads = typed.each("load", load).map(|(here, load)| (here, load.begin()));
    let holds = typed.each("hold", hold).map(|(here, hold)| (here, hold.from));
    let grabs = typed.each("grab", grab).filter_map(|(here, grab)| Some((here, grab.path.keys.first()?.time)));
    let paths = typed.each("obstacle", obstacle);
    let paths = paths.filter_map(|(here, one)| Some((here.to("path"), first_move(one.path.as_ref()?)?)));
    let begins = loads.chain(holds).chain(grabs).chain(paths);
    for (here, time) in begins.filter(|&(_, time)| time >= scene.duration && scene.duration > 0.0) {
        let [time, end] = [time, scene.duration].map(short);
        let message = format!("`{here}` does nothing: it begins at {time} s, and the scene ends at {end} s");
        here.warn(message, "let it begin earlier, or make `duration` longer");
    }
}

/// Warns of loads that are 0 in a scene without a duration, and of those that are not whole before the end.
fn warn_of_rising_loads(scene: &Scene, typed: &Typed<'_>) {
    for (here, load) in typed.each("load", &typed.file.load) {
        let ramp = load.ramp.map(|Positive(ramp)| load.from + ramp);
        let is_zero = load.from > 0.0 || ramp.is_some() || load.shares().first().is_some_and(|key| key.share == 0.0);
        if scene.duration == 0.0 && is_zero {
            let message = format!("`{here}` does nothing: it is 0 at the start, and the scene has no duration");
            here.warn(message, "leave out `from`, `ramp` and `keys`");
        } else if let Some(end) = ramp.filter(|_| load.from < scene.duration) {
            let until = load.until.unwrap_or(f64::INFINITY);
            let (what, last) = if until < scene.duration { ("it", until) } else { ("the scene", scene.duration) };
            if end > last {
                let [end, last] = [end, last].map(short);
                let message = format!("`{here}` is never whole: it rises until {end} s, and {what} ends at {last} s");
                here.warn(message, "make `ramp` shorter, or let the load and the scene last longer");
            }
        }
    }
}

/// Warns of angles of more than a whole turn that turn something once.
fn warn_of_degrees(scene: &Scene, typed: &Typed<'_>) {
    let bodies = typed.file.body.iter().enumerate();
    let bodies = bodies.filter_map(|(at, body)| {
        let angle = body.as_ref()?.rotation.as_ref()?.angle;
        Some((typed.place(at).to("rotation").to("angle"), angle))
    });
    let obstacles = typed.each("obstacle", &typed.file.obstacle).filter_map(|(here, one)| match &one.shape {
        ShapeFile::Box { rotation: Some(rotation), .. } => Some((here.to("rotation").to("angle"), rotation.angle)),
        _ => None,
    });
    let camera = (typed.report.to("view").to("camera").to("azimuth"), scene.view.camera.azimuth);
    for (here, angle) in bodies.chain(obstacles).chain([camera]).filter(|(_, angle)| angle.abs() > TAU) {
        let [turned, degrees] = [angle, rounded(angle.to_radians(), 4)].map(short);
        let message = format!("`{here}` is {turned} rad, more than a whole turn");
        here.warn(message, format!("angles are in radians: {turned}° are {degrees}"));
    }
}

/// Warns of steps near or above the largest stable one, or with which bodies are soft, and of integrators that are never stable.
fn warn_of_steps(scene: &Scene, typed: &Typed<'_>) {
    for run in 0..scene.runs.len() {
        let of_step = scene.near_limit(run).into_iter().chain(scene.softened(run)).map(|doubt| ("step", doubt));
        for (key, [message, help]) in of_step.chain(scene.never_stable(run).map(|doubt| ("integrator", doubt))) {
            typed.of_run(run, key).warn(message, help);
        }
    }
}

/// Warns of damping that also brakes rotation where bodies turn, unless it is asked for by name.
fn warn_of_braked_rotation(scene: &Scene, report: &Collector<'_>) {
    for (at, run) in scene.runs.iter().enumerate() {
        if let Some([message, help]) = scene.brakes_rotation(at) {
            let here = report.to("run").to(at);
            let (own, models) = (here.to("model"), here.to("models"));
            let by_name = run.of.iter().map(|&body| models.to(&*scene.bodies[body].name));
            if !by_name.chain([own.clone()]).any(|model| model.to("damping_of").is_typed()) {
                if own.is_typed() { own } else { models }.warn(message, help);
            }
        }
    }
}

/// Warns of sizes far from metres, unless a `scale` is given, and of recordings of another size.
fn warn_of_sizes(scene: &Scene, typed: &Typed<'_>) {
    let length = |SceneBody { body, .. }: &SceneBody| longest(body.carried().map_or(body.rest(), |fine| &fine.rest));
    let sizes = scene.bodies.iter().map(length).zip(typed.file.body.iter().flatten()).enumerate();
    let long: Vec<_> = sizes.filter(|(_, (length, file))| *length >= LONG && file.scale.is_none()).collect();
    if let Some(&(at, (length, file))) = long.first() {
        let place = typed.place(at);
        let more = if long.len() > 1 { ", as are others" } else { "" };
        let length = short(length);
        match &file.mesh {
            Some(name) => place.to("mesh").warn(
                format!("`{name}` is {length} m long{more}, as no `scale` is given"),
                "write scale = 0.001 if its unit is the millimetre, scale = 1 if it is the metre",
            ),
            None => place.warn(
                format!("{} is {length} m long{more}", scene.bodies[at].in_words()),
                "lengths are in metres: divide those of the body by 1000 if they are in millimetres, unless it is that long",
            ),
        }
    }
    for run in 0..scene.runs.len() {
        let here = typed.report.to("run").to(run);
        // A scale that was given is meant.
        if !here.to("scale").is_typed()
            && let Some([message, help]) = scene.misfits(run)
        {
            here.to("states").warn(message, help);
        }
    }
}
