//! Bars along x: two that meet, one that meets a wall, and a held one that bounces on a wall.
//!
//! A bar of cubes with the side `a` and the mass `m` has the modulus `E = 2k/a`, so that waves have the speed `c = a √(2k/m)`. Times are
//! in `L/c`, forces in `ρ c v A`.

use super::bodies::{MASS, Placed, SIDE, Setting, cubes, obstacle};
use super::{Measured, Trial};
use crate::material::hold;
use glam::{DQuat, DVec3};
use localshape::sim::{BodyContact, Shape, World};

const STIFFNESS: f64 = 1e4;

/// `c` (m/s).
fn speed_of_waves() -> f64 {
    SIDE * (2.0 * STIFFNESS / MASS).sqrt()
}

pub(super) fn trials(refined: u32, periods: u32) -> Vec<Trial> {
    let mut all: Vec<Trial> = Vec::new();
    for (parts, restitution) in [(50, 0.0), (50, 1.0), (200, 1.0)] {
        for at in 0..refined {
            all.push(Box::new(move || meet(10 << at, parts, restitution, false)));
            all.push(Box::new(move || meet(10 << at, parts, restitution, true)));
            if parts == 50 || at + 1 < refined {
                all.push(Box::new(move || bounces(4 << at, parts, restitution, periods)));
            }
        }
    }
    all.extend([0.1, 0.25, 0.5, 0.75, 0.9].map(|restitution| Box::new(move || lost(restitution)) as Trial));
    all
}

fn setting(parts: u32, restitution: f64) -> Setting {
    let mut setting = Setting { share: 1.0 / f64::from(parts), ..Setting::new(STIFFNESS, [restitution, 0.0]) };
    let thin = BodyContact { itself: false, thickness: Some(0.025 * SIDE) };
    setting.around.contacts.as_mut().expect("contacts").bodies = vec![thin; 2];
    setting
}

/// A box with its right side at a place (m).
fn wall(at: f64) -> Shape {
    Shape::Box { centre: DVec3::X * (at - 10.0), half: DVec3::splat(10.0), rotation: DQuat::IDENTITY }
}

fn curve(parts: u32, restitution: f64) -> String {
    format!("e = {restitution}, T/{parts}")
}

/// The energy that two bars lose by a restitution.
fn lost(restitution: f64) -> Vec<Measured> {
    let kept = meet(20, 50, restitution, false).remove(2);
    let axes = ["restitution", "loss of energy"];
    let point = [restitution, (1.0 - kept.value).abs()];
    vec![kept.at("Energy lost by two bars of 20 cells", axes, "T/50", point)]
}

/// A bar of cells that flies at another one, or at a wall, with a fiftieth of the speed of waves: with more, slender bars buckle.
fn meet(cells: u32, parts: u32, restitution: f64, is_wall: bool) -> Vec<Measured> {
    let body = cubes([cells, 1, 1]);
    let (half, gap, c) = (0.5 * f64::from(cells) * SIDE, 0.06 * SIDE, speed_of_waves());
    let speed = 0.02 * c;
    let mut setting = setting(parts, restitution);
    let right = Placed { speed: DVec3::NEG_X * speed, ..Placed::still(&body, DVec3::X * (half + 0.5 * gap)) };
    let left = Placed { speed: DVec3::X * speed, ..Placed::still(&body, DVec3::NEG_X * (half + 0.5 * gap)) };
    let mut bodies = vec![right];
    if is_wall {
        setting.around.obstacles = vec![obstacle(wall(0.0), [restitution, 0.0])];
    } else {
        bodies.push(left);
    }
    let mut world = setting.world(&bodies);
    let momentum =
        |world: &World| world.state().velocity.iter().zip(body.mass()).map(|(speed, mass)| speed.x * mass).sum::<f64>();
    let (energy, before) = (world.diagnostics().energy, momentum(&world));
    let (mut last, mut touched) = (before, None::<[u64; 2]>);
    for step in 0..setting.steps(4.0 * 2.0 * half / c) {
        world.advance(1);
        let now = momentum(&world);
        if (now - last).abs() > 1e-9 * before.abs() {
            let first = touched.map_or(step, |[first, _]| first);
            touched = Some([first, step + 1]);
        }
        last = now;
    }
    let [first, end] = touched.unwrap_or_default();
    let time = (end - first) as f64 * setting.step();
    let area = SIDE * SIDE;
    let force = (last - before) / time / (MASS / (SIDE * area) * c * speed * area);
    let kept = world.diagnostics().energy / energy;
    let (what, plot) =
        if is_wall { ("a bar against a wall", "A bar against a wall") } else { ("two bars", "Two bars that meet") };
    let named = |of: &str| format!("{what} of {cells} cells, e = {restitution}, ΔT = T/{parts}: {of}");
    let error = |number: f64| [f64::from(cells), number.abs()];
    let axes = ["cells along the bar", "error of the time of contact"];
    vec![
        Measured::near(named("time of contact over 2 L/c"), time * c / (4.0 * half), 1.0, 0.1).at(
            plot,
            axes,
            &curve(parts, restitution),
            error(time * c / (4.0 * half) - 1.0),
        ),
        Measured::near(named("mean force over ρ c v A"), force, 1.0, 0.1),
        Measured::shown(named("energy at the end over that at the start"), kept).at(
            if is_wall { "Energy lost at a wall" } else { "Energy lost by two bars" },
            ["cells along the bar", "loss of energy"],
            &curve(parts, restitution),
            error(1.0 - kept),
        ),
    ]
}

/// The amplitude of the first strain of a bar that bounces.
const STRAIN: f64 = 0.02;

/// A bar that is held at one end, and whose other end comes to a wall without strain, again and again with the period `3 L/c`.
fn bounces(cells: u32, parts: u32, restitution: f64, periods: u32) -> Vec<Measured> {
    let across = (cells / 2).max(1);
    let body = cubes([cells, across, across]);
    let (length, c) = (f64::from(cells) * SIDE, speed_of_waves());
    let near = -0.5 * length;
    let end = |at: f64| (0..body.len()).filter(|&node| (body.rest()[node].x - at).abs() < 1e-9).collect::<Vec<_>>();
    let tip = end(near);
    let mut setting = setting(parts, restitution);
    setting.around.grips = vec![hold(&end(-near))];
    setting.around.obstacles = vec![obstacle(wall(near - 0.025 * SIDE), [restitution, 0.0])];
    let mut world = setting.world(&[Placed::still(&body, DVec3::ZERO)]);
    let mut start = world.state().clone();
    start.position.iter_mut().for_each(|at| at.x += 0.5 * STRAIN * (0.5 * length - at.x));
    world.set_state(start);
    let energy = world.diagnostics().energy;
    let each = setting.steps(3.0 * length / c / 60.0);
    let exact = |time: f64| {
        let phase = (time * c / length).rem_euclid(3.0);
        let share = if phase < 1.0 { 1.0 - phase } else { (phase - 2.0).max(0.0) };
        0.5 * STRAIN * length * share
    };
    let mut squares = Vec::new();
    let mut time = 0.0;
    while time < 3.0 * length / c * f64::from(periods) {
        world.advance(each);
        time += each as f64 * setting.step();
        let at = tip.iter().map(|&node| world.state().position[node].x - near).sum::<f64>() / tip.len() as f64;
        squares.push(((at - exact(time)) / (0.5 * STRAIN * length)).powi(2));
    }
    let in_period = squares.len() / periods as usize;
    let rms = |of: &[f64]| (of.iter().sum::<f64>() / of.len() as f64).sqrt();
    let [first, last] = [rms(&squares[..in_period]), rms(&squares[squares.len() - in_period..])];
    let kept = world.diagnostics().energy / energy;
    let named = |of: &str| format!("a held bar of {cells} cells, e = {restitution}, ΔT = T/{parts}: {of}");
    let at = |number: f64| [f64::from(cells), number.abs()];
    let axes = ["cells along the bar", "error of the end over its amplitude"];
    let name = curve(parts, restitution);
    vec![
        Measured::shown(named("error of the end in the first period"), first).at(
            "A held bar that bounces: first period",
            axes,
            &name,
            at(first),
        ),
        Measured::shown(named(&format!("error of the end in period {periods}")), last),
        Measured::shown(named(&format!("energy after {periods} periods over that at the start")), kept).at(
            "A held bar that bounces: loss of energy",
            ["cells along the bar", "loss of energy"],
            &name,
            at(1.0 - kept),
        ),
    ]
}
