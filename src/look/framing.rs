//! Cameras that show a body and objects near it.

use super::file::CameraFile;
use super::reach;
use super::subject::Subject;
use super::view::{Camera, axes};
use crate::sim::geometry::{self, bounds};
use crate::sim::{Dimension, Obstacle, Shape};
use glam::{DVec2, DVec3};

/// Azimuth, elevation and field of view that show a cube's three sides well and with little perspective (rad).
const AZIMUTH: f64 = 31.0 / 180.0 * std::f64::consts::PI;
const ELEVATION: f64 = 17.0 / 180.0 * std::f64::consts::PI;
/// Elevation under a plate, which would hide the body from higher up (rad).
const UNDER_PLATE: f64 = 13.0 / 180.0 * std::f64::consts::PI;
const FIELD_OF_VIEW: f64 = 20.0 / 180.0 * std::f64::consts::PI;

/// Distance in body sizes at which a body fills a third of the picture's height and has room to jump.
const DISTANCE: f64 = 8.5;

/// The largest distances of bodies from the target, sideways, up and down, clear of margins and words, in heights of
/// the picture at the reference shape. In pictures of other shapes the whole scene is smaller and has as much room.
const ROOM: [f64; 3] = [0.388, 0.395, 0.34];

/// The camera of a scene: as typed, with defaults that show the body and objects near it.
pub(crate) fn camera(typed: &CameraFile, target: Option<DVec3>, scene: &Subject<'_>) -> Camera {
    let (dimension, obstacles) = (scene.body.dimension, scene.obstacles);
    let (azimuth, elevation) = match dimension {
        Dimension::Plane => (0.0, 0.0),
        Dimension::Space => {
            let elevation = if is_under_plate(obstacles) { UNDER_PLATE } else { ELEVATION };
            (typed.azimuth.unwrap_or(AZIMUTH), typed.elevation.unwrap_or(elevation))
        }
    };
    let start = &scene.initial.position;
    let standing = standing(start, obstacles);
    let mut chosen = Camera {
        azimuth,
        elevation,
        field_of_view: typed.field_of_view.unwrap_or(FIELD_OF_VIEW),
        target: standing,
        distance: typed.distance.unwrap_or_else(|| DISTANCE * size(scene)),
        follow: typed.follow && target.is_none() && typed.distance.is_none(),
        near: Vec::new(),
    };
    let (low, high) = bounds(start);
    let drop = standing - (low + high) / 2.0;
    let near = reach::near(scene, [low.min(low + drop), high.max(high + drop)], size(scene));
    if let Some(target) = target {
        chosen.target = target;
    } else if typed.distance.is_none() {
        let both = start.iter().flat_map(|&at| [at, at + drop]);
        show(&mut chosen, &both.chain(near.iter().copied()).collect::<Vec<_>>(), dimension);
    }
    if chosen.follow {
        chosen.near = near;
    }
    chosen
}

/// The largest side of the box around the body at the start (m), or at rest if it starts as a point.
fn size(scene: &Subject<'_>) -> f64 {
    let (low, high) = bounds(&scene.initial.position);
    let start = (high - low).max_element();
    if start > 0.0 { start } else { scene.body.extent() }
}

/// The middle of the body moved down or up until it stands on the first floor that faces upwards.
fn standing(start: &[DVec3], obstacles: &[Obstacle]) -> DVec3 {
    let (low, high) = bounds(start);
    let middle = (low + high) / 2.0;
    let Some((normal, height)) = geometry::ground(obstacles, 0.0) else { return middle };
    let ground = (height - normal.x * middle.x - normal.z * middle.z) / normal.y;
    DVec3::new(middle.x, ground + (high.y - low.y) / 2.0, middle.z)
}

/// Moves a camera aside and back so that it shows points. If all are in the picture already, the camera stays.
fn show(camera: &mut Camera, points: &[DVec3], dimension: Dimension) {
    if least_distance(camera, points, dimension) <= camera.distance {
        return;
    }
    // The middle depends a little on the distance, so iterate.
    for _ in 0..4 {
        let step = middle_of(camera, points, dimension);
        camera.target += step;
        camera.distance = camera.distance.max(least_distance(camera, points, dimension));
    }
}

/// The shift (m) of the target that brings points into the middle of the room.
fn middle_of(camera: &Camera, points: &[DVec3], dimension: Dimension) -> DVec3 {
    let [right, up, towards] = axes(camera.azimuth, camera.elevation);
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for from_target in points.iter().map(|&point| point - camera.target) {
        let depth = if dimension == Dimension::Plane { 0.0 } else { from_target.dot(towards) };
        let scale = camera.distance / (camera.distance - depth).max(0.1 * camera.distance);
        let at = scale * DVec2::new(from_target.dot(right), from_target.dot(up));
        (low, high) = (low.min(at), high.max(at));
    }
    let [_, above, below] = ROOM;
    let aside = 0.5 * (low.x + high.x);
    let upward = (low.y * above + high.y * below) / (above + below);
    let (_, level) = libm::sincos(camera.elevation);
    // Upwards in the world, unless that is hardly visible.
    let upward = if level > 0.3 { upward / level * DVec3::Y } else { upward * up };
    aside * right + upward
}

/// Whether a plate presses from above.
fn is_under_plate(obstacles: &[Obstacle]) -> bool {
    let above = |obstacle: &Obstacle| matches!(obstacle.shape, Shape::Plate { normal, .. } if normal.y < -0.5);
    obstacles.iter().any(above)
}

/// The least distance at which a camera has points in the picture (m).
fn least_distance(camera: &Camera, points: &[DVec3], dimension: Dimension) -> f64 {
    let [right, up, towards] = axes(camera.azimuth, camera.elevation);
    let [aside, above, below] = ROOM.map(|share| share * 2.0 * libm::tan(camera.field_of_view / 2.0));
    let least = points.iter().map(|&point| {
        let from_target = point - camera.target;
        let (x, y) = (from_target.dot(right), from_target.dot(up));
        let depth = if dimension == Dimension::Plane { 0.0 } else { from_target.dot(towards) };
        depth + (x.abs() / aside).max(y / above).max(-y / below)
    });
    least.fold(0.0, f64::max)
}
