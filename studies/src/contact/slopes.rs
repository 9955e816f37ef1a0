//! Bodies on slopes: what friction holds, how fast they slide, where they stop, and how they roll.

use super::bodies::{GRAVITY, MASS, Placed, SIDE, Setting, block, cubes, mean, obstacle};
use super::{Measured, Trial};
use crate::study::built_in;
use glam::{DQuat, DVec3};
use localshape::sim::{Body, Shape, World};
use std::sync::Arc;

/// Friction coefficient of blocks that slide.
const FRICTION: f64 = 0.5;

pub(super) fn trials(refined: u32) -> Vec<Trial> {
    let mut all: Vec<Trial> = Vec::new();
    for ground in [Ground::Floor, Ground::Slab] {
        all.push(Box::new(move || creeps(ground)));
        all.push(Box::new(move || slides(ground)));
        all.push(Box::new(move || stops(ground)));
    }
    for at in 0..refined {
        all.push(Box::new(move || disc(24 << at)));
        all.push(Box::new(move || ball(4 + 2 * at)));
    }
    all
}

/// What a body lies on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ground {
    /// A half-space, which nodes meet.
    Floor,
    /// A box, which surfaces meet.
    Slab,
}

impl Ground {
    fn name(self) -> &'static str {
        match self {
            Self::Floor => "floor",
            Self::Slab => "box",
        }
    }

    /// With its top at the height 0.
    fn shape(self) -> Shape {
        match self {
            Self::Floor => Shape::Floor { normal: DVec3::Y, height: 0.0 },
            Self::Slab => {
                Shape::Box { centre: DVec3::NEG_Y, half: DVec3::new(50.0, 1.0, 1.0), rotation: DQuat::IDENTITY }
            }
        }
    }
}

/// A stiff block at rest, or thrown (m/s), on a ground along x, with gravity at an angle (rad).
fn stiff(ground: Ground, friction: f64, angle: f64, speed: f64) -> (Setting, Vec<Placed>) {
    let mut setting = Setting::new(1e5, [0.0; 2]);
    setting.damping = 0.2 * (1e5 * MASS).sqrt();
    let (sine, cosine) = libm::sincos(angle);
    setting.around.gravity = DVec3::new(sine, -cosine, 0.0) * GRAVITY;
    setting.around.obstacles = vec![obstacle(ground.shape(), [0.0, friction])];
    let height = 2.0 * SIDE + if ground == Ground::Slab { 0.03 * SIDE } else { 0.0 };
    let body = cubes([4; 3]);
    (setting, vec![Placed { speed: DVec3::X * speed, ..Placed::still(&body, DVec3::Y * height) }])
}

fn way(world: &World, body: &Body) -> f64 {
    mean(body, &world.state().position).x
}

/// The mean acceleration (m/s²) down a slope in a time (s), after as long a time from rest.
fn acceleration(setting: &Setting, bodies: &[Placed], time: f64) -> f64 {
    let mut world = setting.world(bodies);
    let mut speed = || {
        world.advance(setting.steps(time));
        mean(&bodies[0].body, &world.state().velocity).x
    };
    let first = speed();
    (speed() - first) / (setting.steps(time) as f64 * setting.step())
}

/// A block on a ground that is tilted slowly, so that it is at rest when friction just holds it.
fn creeps(ground: Ground) -> Vec<Measured> {
    /// The times (s) of tilting, of rest after it, and of measuring.
    const TIMES: [f64; 3] = [2.0, 1.0, 1.0];
    // tan 26.565° = 0.5.
    let limit = 26.565f64.to_radians();
    let cases = [
        ("tan θ = .483, μ = .5", libm::atan(0.483), FRICTION, true),
        ("θ = 26.565°, μ = .50", limit, 0.5, true),
        ("θ = 26.565°, μ = .49", limit, 0.49, false),
    ];
    let case = |(name, angle, friction, holds): (&str, f64, f64, bool)| {
        let (mut setting, bodies) = stiff(ground, friction, 0.0, 0.0);
        let body = &bodies[0].body;
        setting.around.gravity = DVec3::ZERO;
        let mass = body.mass().to_vec();
        let tilted = move |time: f64, _: &[DVec3], forces: &mut [DVec3]| {
            let share = (time / TIMES[0]).min(1.0);
            let (sine, cosine) = libm::sincos(angle * share * share * (3.0 - 2.0 * share));
            let down = DVec3::new(sine, -cosine, 0.0) * GRAVITY;
            forces.iter_mut().zip(&mass).for_each(|(force, mass)| *force += down * *mass);
        };
        setting.around.loads = vec![Arc::new(tilted)];
        let mut world = setting.world(&bodies);
        world.advance(setting.steps(TIMES[0] + TIMES[1]));
        let (first, before) = (way(&world, body), mean(body, &world.state().velocity).x);
        world.advance(setting.steps(TIMES[2]));
        let passed = setting.steps(TIMES[2]) as f64 * setting.step();
        let (sine, cosine) = libm::sincos(angle);
        if holds {
            let what = format!("{}: speed (m/s), {name}", ground.name());
            return Measured::most(what, (way(&world, body) - first).abs() / passed, 1e-4);
        }
        let gained = (mean(body, &world.state().velocity).x - before) / passed;
        let wanted = GRAVITY * (sine - friction * cosine);
        Measured::near(format!("{}: acceleration (m/s²), {name}", ground.name()), gained, wanted, 0.01)
    };
    cases.map(case).to_vec()
}

fn slides(ground: Ground) -> Vec<Measured> {
    let slide = |steep: f64| {
        let angle = libm::atan(steep);
        let (setting, bodies) = stiff(ground, FRICTION, angle, 0.0);
        let (sine, cosine) = libm::sincos(angle);
        let what = format!("{}: acceleration over g (sin θ − μ cos θ), tan θ = {steep}, μ = .5", ground.name());
        let wanted = GRAVITY * (sine - FRICTION * cosine);
        let found = acceleration(&setting, &bodies, 0.5);
        let axes = ["tan θ", "acceleration (m/s²)"];
        Measured::near(what, found / wanted, 1.0, 0.01).at("Sliding, μ = 0.5", axes, ground.name(), [steep, found])
    };
    [0.55, 0.6, 0.684, 0.8].map(slide).to_vec()
}

fn stops(ground: Ground) -> Vec<Measured> {
    const SPEED: f64 = 2.0;
    let (setting, bodies) = stiff(ground, FRICTION, 0.0, SPEED);
    let mut world = setting.world(&bodies);
    world.advance(setting.steps(1.0));
    let wanted = SPEED * SPEED / (2.0 * FRICTION * GRAVITY);
    let what = format!("{}: stopping distance over v²/2μg, v = 2 m/s, μ = .5", ground.name());
    vec![Measured::near(what, way(&world, &bodies[0].body) / wanted, 1.0, 0.01)]
}

/// A disc in the plane on a slope of 15°, from a regular polygon of so many sides.
fn disc(sides: u32) -> Vec<Measured> {
    let text = format!(
        "time = {{ duration = 1 }}
         body = {{ disc = {{ radius = 0.5, rings = {rings}, sectors = {sides} }}, density = 100 }}
         run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e6 }} }}]",
        rings = sides / 8,
    );
    let body = Arc::clone(&built_in(&text, "disc").bodies[0].body);
    vec![rolls("disc", "sides", &body, sides, 2.0 / 3.0)]
}

/// A ball on a slope of 15°, from a cube of so many cells along each side.
fn ball(cells: u32) -> Vec<Measured> {
    let round = |unit: DVec3, _: DVec3| {
        let far = unit.abs().max_element();
        if far > 0.0 { unit.normalize() * (0.5 * far) } else { unit }
    };
    vec![rolls("ball", "cells across", &block([cells; 3], round), cells, 5.0 / 7.0)]
}

/// The acceleration of a round body of the radius 0.5 m that rolls, over that of a rigid one with its moment of inertia.
fn rolls(name: &'static str, parts: &str, body: &Arc<Body>, count: u32, rigid: f64) -> Measured {
    const ANGLE: f64 = 15.0;
    let (lightest, whole) = body.mass().iter().fold((f64::INFINITY, 0.0), |(least, sum), &m| (least.min(m), sum + m));
    let centre = mean(body, body.rest());
    let arms = body.rest().iter().map(|&at| (at - centre).truncate().length_squared());
    let inertia: f64 = arms.zip(body.mass()).map(|(arm, mass)| arm * mass).sum();
    let lowest = body.rest().iter().fold(f64::INFINITY, |low, at| low.min(at.y));
    let stiffness = 1e6;
    let mut setting = Setting::new(stiffness, [0.0; 2]);
    setting.share *= (lightest / MASS).sqrt();
    setting.damping = 0.2 * (stiffness * lightest).sqrt();
    let (sine, cosine) = libm::sincos(ANGLE.to_radians());
    setting.around.gravity = DVec3::new(sine, -cosine, 0.0) * GRAVITY;
    setting.around.obstacles = vec![obstacle(Ground::Floor.shape(), [0.0, 1.0])];
    let found = acceleration(&setting, &[Placed::still(body, DVec3::NEG_Y * lowest)], 0.25) / (GRAVITY * sine);
    let closed = 1.0 / (1.0 + inertia / (whole * 0.25));
    let what = format!("{name} of {count} {parts}: acceleration over g sin θ (rigid and round: {rigid:.3})");
    let axes = ["sides, or cells across", "error of the acceleration"];
    let point = [f64::from(count), (found / closed - 1.0).abs()];
    Measured::near(what, found, closed, 0.05).at("Rolling on a slope", axes, name, point)
}
