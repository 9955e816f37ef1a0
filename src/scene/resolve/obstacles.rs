//! Obstacles.

use super::motion::{self, axis};
use super::{Typed, direction, elements, vector};
use crate::reading::captions::{quantity, rounded};
use crate::reading::collector::Here;
use crate::scene::SceneBody;
use crate::scene::file::{Coordinates, ObstacleFile, SceneFile, ShapeFile};
use crate::sim::geometry::{bounds, is_inside};
use crate::sim::{Dimension, Motion, Obstacle, Shape};
use glam::{DQuat, DVec3};

/// The obstacles, or `None` after reporting every mistake in them.
pub(super) fn resolve(scene: &Typed<'_>, dimension: Option<Dimension>, bodies: &[&SceneBody]) -> Option<Vec<Obstacle>> {
    let dimension = dimension?;
    let mut obstacles = Vec::new();
    for (here, typed) in scene.each("obstacle", &scene.file.obstacle) {
        let Some(obstacle) = one(typed, dimension, &here) else { continue };
        // Where surfaces meet, they are compared once all bodies of a run are known.
        if scene.file.meets_by_nodes() {
            bodies.iter().for_each(|body| check_start(&obstacle, body, &here));
        }
        obstacles.push(obstacle);
    }
    (obstacles.len() == scene.file.obstacle.len()).then_some(obstacles)
}

/// The name of each obstacle, or its place in the file.
pub(super) fn names(file: &SceneFile) -> Vec<String> {
    let given = file.obstacle.iter().map(|one| one.as_ref().and_then(|one| one.name.clone()));
    given.enumerate().map(|(at, name)| name.unwrap_or_else(|| format!("obstacle[{at}]"))).collect()
}

fn one(typed: &ObstacleFile, dimension: Dimension, here: &Here<'_>) -> Option<Obstacle> {
    let shape = shape(&typed.shape, dimension, here);
    let motion = match (&typed.path, &typed.swing) {
        (Some(typed), _) => motion::keys(typed, dimension, &here.to("path")),
        (None, Some(typed)) => motion::swing(typed, dimension, &here.to("swing")),
        (None, None) => Some(Motion::Still),
    };
    let about = typed.about.as_ref().map(|typed| vector(typed, dimension, &here.to("about")));
    if typed.friction_of.is_some() && !here.to("friction").is_typed() {
        let message = "`friction_of` needs `friction`";
        here.to("friction_of").wrong_key(message, "give `friction`, or remove `friction_of`");
    }
    let (shape, motion) = (shape?, motion?);
    let pivot = match about {
        Some(typed) => typed?,
        None => shape.middle(),
    };
    Some(Obstacle {
        shape,
        motion,
        pivot,
        restitution: typed.restitution,
        friction: typed.friction,
        friction_of: typed.friction_of.unwrap_or_default(),
    })
}

fn shape(typed: &ShapeFile, dimension: Dimension, here: &Here<'_>) -> Option<Shape> {
    let point = |typed: &Coordinates, key| vector(typed, dimension, &here.to(key));
    match typed {
        ShapeFile::Floor { normal, height } => {
            let normal = match normal {
                None => DVec3::Y,
                Some(typed) => direction(point(typed, "normal")?, &here.to("normal"))?,
            };
            Some(Shape::Floor { normal, height: *height })
        }
        ShapeFile::Plate { point: surface, normal } => {
            let (surface, normal) = (point(surface, "point"), point(normal, "normal"));
            Some(Shape::Plate { point: surface?, normal: direction(normal?, &here.to("normal"))? })
        }
        ShapeFile::Sphere { centre, radius } => {
            Some(Shape::Sphere { centre: point(centre, "centre")?, radius: *radius })
        }
        ShapeFile::Capsule { from, to, radius } => {
            let (from, to) = (point(from, "from"), point(to, "to"));
            Some(Shape::Capsule { from: from?, to: to?, radius: *radius })
        }
        ShapeFile::Box { centre, size, rotation } => {
            let (centre, size) = (point(centre, "centre"), point(size, "size"));
            let rotation = match rotation {
                Some(typed) => {
                    let axis = axis(typed.axis.as_ref(), dimension, &here.to("rotation"))?;
                    let (sine, cosine) = libm::sincos(0.5 * typed.angle);
                    DQuat::from_xyzw(axis.x * sine, axis.y * sine, axis.z * sine, cosine)
                }
                None => DQuat::IDENTITY,
            };
            let mut half = 0.5 * size?;
            if dimension == Dimension::Plane {
                half.z = f64::INFINITY;
            }
            Some(Shape::Box { centre: centre?, half, rotation })
        }
    }
}

/// The depth that rounding may leave a node in an obstacle at the start, in body sizes.
const TOUCHING: f64 = 1e-9;

/// An obstacle in messages.
pub(super) fn shape_name(shape: &Shape) -> &'static str {
    match shape {
        Shape::Floor { .. } => "floor",
        Shape::Plate { .. } => "plate",
        Shape::Sphere { .. } => "sphere",
        Shape::Capsule { .. } => "capsule",
        Shape::Box { .. } => "box",
    }
}

/// Reports obstacles that contain nodes at the start, and obstacles that start inside the body.
fn check_start(obstacle: &Obstacle, body: &SceneBody, here: &Here<'_>) {
    let (placed, of, name) = (obstacle.at(0.0, 1.0), body.in_words(), shape_name(&obstacle.shape));
    let depths = (0..).zip(&body.initial.position).filter_map(|(node, &at): (usize, _)| {
        let (contact, _) = placed.contact(at)?;
        (contact.depth > TOUCHING * body.body.extent()).then_some((node, contact.depth))
    });
    // The first of equals.
    if let Some((node, depth)) = depths.reduce(|deepest, this| if this.1 > deepest.1 { this } else { deepest }) {
        let below = quantity(depth, "m");
        let message = format!("{of} starts inside this {name}: node {node} lies {below} below its surface");
        let help = match obstacle.shape {
            Shape::Floor { .. } => "move the floor, or set the body on it with its `lowest` or `offset`",
            _ => "move one of them; a path can move the obstacle there later",
        };
        return here.wrong(message, help);
    }
    let (pose, pivot) = (obstacle.pose(0.0), obstacle.pivot);
    let (low, high) = bounds(&body.initial.position);
    let near = |point: &DVec3| point.cmpge(low).all() && point.cmple(high).all();
    let points = inner_points(&obstacle.shape, body.body.dimension());
    let points: Vec<_> = points.into_iter().map(|point| pose.apply(pivot, point)).filter(near).collect();
    // For large bodies fewer points are tested, but always the centre of the obstacle.
    let faces = body.body.faces().nodes.len().max(1);
    let stride = (points.len() * faces).div_ceil(MOST_COMPARED).max(1);
    let is_within = |&point: &DVec3| is_inside(point, &body.body, &body.initial.position);
    let within = points.into_iter().step_by(stride).find(is_within);
    if let Some(point) = within {
        let near = DVec3::from(point.to_array().map(|at| rounded(at, 4) + 0.0));
        let point = elements::point(near, body.body.dimension());
        let message = format!("this {name} starts inside {of}, at {point}, between its nodes");
        here.wrong(message, "move one of them; bodies collide with an obstacle from outside");
    }
}

/// The most points of an obstacle, times faces of the body, that are tested. This many take some tenths of a second.
const MOST_COMPARED: usize = 10_000_000;

/// The number of tested points of an obstacle along each axis.
const SAMPLES: u32 = 8;

/// Points inside an obstacle, its centre first; none for half-spaces, where testing the nodes is enough.
fn inner_points(shape: &Shape, dimension: Dimension) -> Vec<DVec3> {
    let steps = || (0..=SAMPLES).map(|at| f64::from(at) / f64::from(SAMPLES) * 2.0 - 1.0);
    let across =
        || steps().filter(move |_| dimension == Dimension::Space).chain((dimension == Dimension::Plane).then_some(0.0));
    let cube = || steps().flat_map(move |x| steps().flat_map(move |y| across().map(move |z| DVec3::new(x, y, z))));
    let ball =
        |centre: DVec3, radius: f64| cube().filter(|at| at.length_squared() <= 1.0).map(move |at| centre + radius * at);
    let middle = shape.middle();
    match *shape {
        Shape::Floor { .. } | Shape::Plate { .. } => Vec::new(),
        Shape::Sphere { centre, radius } => std::iter::once(middle).chain(ball(centre, radius)).collect(),
        Shape::Capsule { from, to, radius } => {
            let along = (0..=32).map(move |at| from.lerp(to, f64::from(at) / 32.0));
            let ends = ball(from, radius).chain(ball(to, radius)).chain(ball(middle, radius));
            std::iter::once(middle).chain(along).chain(ends).collect()
        }
        Shape::Box { centre, half, rotation } => {
            let half = DVec3::select(half.is_finite_mask(), half, DVec3::ZERO);
            std::iter::once(middle).chain(cube().map(|at| centre + rotation * (at * half))).collect()
        }
    }
}

/// Reports motions that are too fast for the time step, so that the obstacle would jump.
pub(super) fn check_steps(scene: &Typed<'_>, step: f64) {
    for (here, obstacle) in scene.each("obstacle", &scene.file.obstacle) {
        if let Some(typed) = &obstacle.path {
            motion::check_steps(typed, step, &here.to("path"));
        }
        if let Some(swing) = obstacle.swing.as_ref().filter(|swing| swing.period < LEAST_STEPS * step) {
            let message = format!("one oscillation takes {} s, but a time step takes {step:.3e} s", swing.period);
            let help = format!("use a period of at least {LEAST_STEPS} steps, or shorter steps");
            here.to("swing").to("period").wrong(message, help);
        }
    }
}

/// The least number of steps in a period.
const LEAST_STEPS: f64 = 4.0;
