//! Obstacles.

use super::body::ResolvedBody;
use super::motion::{self, axis};
use super::{direction, vector};
use crate::scene::file::{Coordinates, ObstacleFile};
use crate::scene::report::{Report, Way};
use crate::sim::body::{Dimension, IndexLists};
use crate::sim::contact::{Motion, Obstacle, Shape};
use glam::{DQuat, DVec3};

/// The obstacles, or `None` after reporting every mistake in them.
pub(super) fn resolve(
    typed: &[Option<ObstacleFile>],
    dimension: Option<Dimension>,
    body: Option<&ResolvedBody>,
    report: &mut Report<'_>,
) -> Option<Vec<Obstacle>> {
    let dimension = dimension?;
    let mut obstacles = Vec::new();
    for (at, obstacle) in typed.iter().enumerate() {
        let Some(typed) = obstacle else { continue };
        let path = [Way::Key("obstacle"), Way::Index(at)];
        let Some(obstacle) = one(typed, dimension, &path, report) else { continue };
        if let Some(body) = body {
            check_start(&obstacle, body, &path, report);
        }
        obstacles.push(obstacle);
    }
    (obstacles.len() == typed.len()).then_some(obstacles)
}

fn one(typed: &ObstacleFile, dimension: Dimension, path: &[Way<'_>], report: &mut Report<'_>) -> Option<Obstacle> {
    let shape = shape(typed, dimension, path, report);
    let common = typed.common();
    let motion = match (common.path, common.swing) {
        (Some(typed), _) => motion::keys(typed, dimension, &[path, &[Way::Key("path")]].concat(), report),
        (None, Some(typed)) => motion::swing(typed, dimension, &[path, &[Way::Key("swing")]].concat(), report),
        (None, None) => Some(Motion::Still),
    };
    Some(Obstacle { shape: shape?, motion: motion?, restitution: common.restitution, friction: common.friction })
}

fn shape(typed: &ObstacleFile, dimension: Dimension, path: &[Way<'_>], report: &mut Report<'_>) -> Option<Shape> {
    let way = |key| [path, &[Way::Key(key)]].concat();
    let mut point = |typed: &Coordinates, key| vector(typed, dimension, &way(key), report);
    match typed {
        ObstacleFile::Floor(floor) => {
            let normal = match &floor.normal {
                None => DVec3::Y,
                Some(typed) => direction(point(typed, "normal")?, &way("normal"), report)?,
            };
            Some(Shape::Floor { normal, height: floor.height })
        }
        ObstacleFile::Plate(plate) => {
            let [surface, normal] =
                [(&plate.point, "point"), (&plate.normal, "normal")].map(|(typed, key)| point(typed, key));
            Some(Shape::Plate { point: surface?, normal: direction(normal?, &way("normal"), report)? })
        }
        ObstacleFile::Sphere(sphere) => {
            Some(Shape::Sphere { centre: point(&sphere.centre, "centre")?, radius: sphere.radius })
        }
        ObstacleFile::Capsule(capsule) => {
            let [from, to] = [(&capsule.from, "from"), (&capsule.to, "to")].map(|(typed, key)| point(typed, key));
            Some(Shape::Capsule { from: from?, to: to?, radius: capsule.radius })
        }
        ObstacleFile::Box(cuboid) => {
            let [centre, size] =
                [(&cuboid.centre, "centre"), (&cuboid.size, "size")].map(|(typed, key)| point(typed, key));
            let turn = match &cuboid.rotation {
                Some(typed) => {
                    let axis = axis(typed.axis.as_ref(), dimension, &way("rotation"), report)?;
                    let (sine, cosine) = libm::sincos(0.5 * typed.angle);
                    DQuat::from_xyzw(axis.x * sine, axis.y * sine, axis.z * sine, cosine)
                }
                None => DQuat::IDENTITY,
            };
            let mut half = 0.5 * size?;
            if dimension == Dimension::Plane {
                half.z = f64::INFINITY;
            }
            Some(Shape::Box { centre: centre?, half, turn })
        }
    }
}

/// How deep a node may lie in an obstacle at the start, in body sizes: the rounding of a body set down on it.
const TOUCHING: f64 = 1e-9;

/// Reports an obstacle in which nodes start, or which starts within the body.
fn check_start(obstacle: &Obstacle, body: &ResolvedBody, path: &[Way<'_>], report: &mut Report<'_>) {
    let placed = obstacle.at(0.0, 1.0);
    let name = match obstacle.shape {
        Shape::Floor { .. } => "floor",
        Shape::Plate { .. } => "plate",
        Shape::Sphere { .. } => "sphere",
        Shape::Capsule { .. } => "capsule",
        Shape::Box { .. } => "box",
    };
    let depths = (0..).zip(&body.initial.position).filter_map(|(node, &at): (usize, _)| {
        let (contact, _) = placed.contact(at)?;
        (contact.depth > TOUCHING * body.body.extent()).then_some((node, contact.depth))
    });
    let deepest = depths.fold(None, |deepest: Option<(usize, f64)>, this| match deepest {
        Some(other) if other.1 >= this.1 => Some(other),
        _ => Some(this),
    });
    if let Some((node, depth)) = deepest {
        let message = format!("the body starts inside this {name}: node {node} lies {depth:.3e} m below its surface");
        let help = match obstacle.shape {
            Shape::Floor { .. } => "move the floor, or set the body on it with `lowest` or `offset` in [body]",
            _ => "move one of them; a path may bring the obstacle there later",
        };
        return report.at(path, message, help.to_owned());
    }
    let (pose, pivot) = (obstacle.pose(0.0), obstacle.shape.pivot());
    let inner = match obstacle.shape {
        Shape::Floor { .. } | Shape::Plate { .. } => return,
        Shape::Sphere { centre, .. } | Shape::Box { centre, .. } => vec![centre],
        Shape::Capsule { from, to, .. } => vec![from, 0.5 * (from + to), to],
    };
    if let Some(point) = inner.into_iter().map(|point| pose.apply(pivot, point)).find(|&point| is_within(body, point)) {
        let [x, y, z] = point.to_array();
        let point =
            if body.body.dimension == Dimension::Plane { format!("[{x}, {y}]") } else { format!("[{x}, {y}, {z}]") };
        let message = format!("this {name} starts inside the body, at {point}: no node would ever meet it");
        report.at(path, message, "move one of them; nodes bounce off an obstacle from outside".to_owned());
    }
}

/// Whether a point lies within the outer surface of a body at its start, by how often that winds around it.
fn is_within(body: &ResolvedBody, point: DVec3) -> bool {
    let (shape, position) = (&body.body, &body.initial.position);
    let at = |node: u32| position[node as usize] - point;
    if shape.dimension == Dimension::Plane {
        return shape.elements.iter().filter(|nodes| nodes.len() > 2).any(|nodes| winds_around(nodes, at));
    }
    let faces: &IndexLists = &shape.faces.nodes;
    let outside = faces.iter().zip(&shape.faces.outer).filter(|(_, outer)| outer.is_none());
    // Van Oosterom and Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30(2), 1983.
    let angle = |[a, b, c]: [DVec3; 3]| {
        let [la, lb, lc] = [a, b, c].map(DVec3::length);
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * libm::atan2(a.dot(b.cross(c)), below)
    };
    let angles = outside.flat_map(|(face, _)| (2..face.len()).map(|at| [face[0], face[at - 1], face[at]]));
    let whole: f64 = angles.map(|corners| angle(corners.map(at))).sum();
    whole.abs() > std::f64::consts::TAU
}

/// Whether a polygon winds around the origin.
fn winds_around(nodes: &[u32], at: impl Fn(u32) -> DVec3) -> bool {
    let sides = nodes.iter().zip(nodes.iter().cycle().skip(1)).map(|(&a, &b)| (at(a), at(b)));
    let crossed = sides.filter(|(a, b)| (a.y > 0.0) != (b.y > 0.0) && a.x + (b.x - a.x) * a.y / (a.y - b.y) > 0.0);
    crossed.count() % 2 == 1
}
