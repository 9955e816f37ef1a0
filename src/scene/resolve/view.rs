//! How the scene is looked at.

use super::camera::{eye, is_inside};
use super::{look, reach, vector};
use crate::scene::Run;
use crate::scene::file::{ArrangementFile, CameraFile, ColourFile, EdgesFile, LabelFile, ShowFile, ViewFile};
use crate::scene::report::{Report, Way};
use crate::scene::view::{Camera, ColourScale, Follow, FontFiles, Labels, Light, StrainScale, View, Visible};
use crate::sim::body::{Body, Dimension, bounds};
use crate::sim::contact::{self, Obstacle, Shape};
use crate::sim::field::Field;
use crate::sim::grip::Grip;
use crate::sim::state::State;
use crate::sim::words::rounded;
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Azimuth, elevation and field of view that show a cube's three sides well and with little perspective (rad).
const AZIMUTH: f64 = 31.0 / 180.0 * std::f64::consts::PI;
const ELEVATION: f64 = 17.0 / 180.0 * std::f64::consts::PI;
/// Elevation under a plate, which would hide the body from higher up (rad).
const UNDER_PLATE: f64 = 13.0 / 180.0 * std::f64::consts::PI;
const FIELD_OF_VIEW: f64 = 20.0 / 180.0 * std::f64::consts::PI;

/// Distance in body sizes at which a body fills a third of the picture's height and has room to jump.
const DISTANCE: f64 = 8.5;

/// How far bodies may reach from the point looked at, sideways, up and down, in heights of the picture at the reference
/// shape: clear of margins and of words. Pictures of other shapes show everything smaller and have as much room.
const ROOM: [f64; 3] = [0.388, 0.395, 0.34];

/// How many panels stand beside each other unless the scene says so.
const COLUMNS: usize = 3;

/// The view, or `None` if there is a mistake in it.
pub(super) fn resolve(
    typed: &ViewFile,
    scene: &Around<'_>,
    font: Option<FontFiles>,
    report: &mut Report<'_>,
) -> Option<View> {
    let body = scene.body;
    let runs = scene.runs.len();
    let dimension = body.dimension;
    let camera = |key| [Way::Key("view"), Way::Key("camera"), Way::Key(key)];
    let given = [("azimuth", typed.camera.azimuth), ("elevation", typed.camera.elevation)];
    for (key, _) in given.iter().filter(|(_, value)| dimension == Dimension::Plane && value.is_some()) {
        let message = format!("`view.camera.{key}` is given, but a body in the plane is looked at from the front");
        report.at_key(&camera(key), message, format!("take `{key}` out"));
    }
    let target = match &typed.camera.target {
        Some(target) => Some(vector(target, dimension, &camera("target"), report)?),
        None => None,
    };
    let chosen = self::camera(&typed.camera, target, typed.explode, scene);
    if dimension == Dimension::Space && is_inside(eye(&chosen), body, &scene.initial.position) {
        let [x, y, z] = eye(&chosen).to_array().map(|length| rounded(length, 3));
        let message = format!("the camera stands at [{x}, {y}, {z}], inside the body at its start");
        let help = "move it out with a larger `view.camera.distance` or another `target`".to_owned();
        report.at(&[Way::Key("view"), Way::Key("camera")], message, help);
    }
    let columns = match (typed.columns, typed.panels) {
        (Some(columns), _) => columns as usize,
        (None, Some(ArrangementFile::Row)) => runs,
        (None, Some(ArrangementFile::Column)) => 1,
        (None, Some(ArrangementFile::Grid)) => roomiest(typed.size, runs),
        (None, None) => columns(runs),
    };
    let columns = columns.clamp(1, runs.max(1));
    let colour = match &typed.colour {
        Some(typed) => Some(colour(typed, scene, report)?),
        None => None,
    };
    let visible = match &typed.show {
        Some(shown) => Visible {
            surfaces: shown.contains(&ShowFile::Surfaces),
            nodes: shown.contains(&ShowFile::Nodes),
            springs: shown.contains(&ShowFile::Springs),
            displacements: shown.contains(&ShowFile::Displacements),
        },
        None => Visible::usual(dimension, body.len()),
    };
    let look = look::resolve(typed, font.unwrap_or_default(), report)?;
    let at = |key| [Way::Key("view"), Way::Key(key)];
    if typed.explode > 0.0 && (visible.springs || visible.displacements) {
        let what = if visible.springs { "springs" } else { "displacements" };
        let message = format!("`view.explode` draws elements apart, where {what} have no place");
        report.at_key(&at("explode"), message, format!("take `explode` or `\"{what}\"` out"));
    }
    let spring_strain = match &typed.spring_colour {
        Some(_) if !visible.springs => {
            let message = "`view.spring_colour` is given, but springs are not shown".to_owned();
            report.at_key(&at("spring_colour"), message, "add `\"springs\"` to `show`".to_owned());
            None
        }
        Some(_) if scene.runs.iter().all(|run| run.model.springs().is_empty()) => {
            let message = "`view.spring_colour` is given, but no run has springs".to_owned();
            report.at_key(&at("spring_colour"), message, "take it out, or add a run with springs".to_owned());
            None
        }
        Some(springs) => {
            let way = [Way::Key("view"), Way::Key("spring_colour"), Way::Key("range")];
            let range = rising(springs.range.unwrap_or(SPRING_STRAIN), &way, report)?;
            Some(StrainScale { range, map: springs.map })
        }
        None => None,
    };
    Some(View {
        size: typed.size,
        look,
        camera: chosen,
        clock: typed.clock.clone(),
        columns,
        visible,
        colour,
        arrow_scale: typed.arrow_scale,
        side: scene.side,
        has_cells: scene.has_cells,
        title: typed.title.trim().to_owned(),
        caption: typed.caption.trim().to_owned(),
        labels: labels(typed),
        scale_bar: typed.scale_bar,
        legend: typed.legend,
        strip: typed.strip,
        opacity: typed.opacity,
        explode: typed.explode,
        spring_strain,
        light: Light { azimuth: typed.light.azimuth, elevation: typed.light.elevation },
        shadow: typed.shadow,
        floor: typed.floor,
        edges: match typed.edges {
            EdgesFile::All => [true, true],
            EdgesFile::Visible => [true, false],
            EdgesFile::Outline => [false, false],
        },
        outline: typed.outline,
        hatch: typed.hatch,
    })
}

/// The camera of a scene: what is asked of it, and for the rest what shows the body and what comes near it. Elements may
/// be drawn `apart`, in parts of their distance from the body's middle.
pub(super) fn camera(typed: &CameraFile, target: Option<DVec3>, apart: f64, scene: &Around<'_>) -> Camera {
    let (dimension, obstacles) = (scene.body.dimension, scene.obstacles);
    let (azimuth, elevation) = match dimension {
        Dimension::Plane => (0.0, 0.0),
        Dimension::Space => {
            let elevation = if is_under_plate(obstacles) { UNDER_PLATE } else { ELEVATION };
            (typed.azimuth.unwrap_or(AZIMUTH), typed.elevation.unwrap_or(elevation))
        }
    };
    let start = &spread(&scene.initial.position, apart, obstacles);
    let standing = standing(start, obstacles);
    let mut chosen = Camera {
        azimuth,
        elevation,
        field_of_view: typed.field_of_view.unwrap_or(FIELD_OF_VIEW),
        target: standing,
        distance: typed.distance.unwrap_or_else(|| DISTANCE * size(scene) * (1.0 + apart)),
        rise: 0.0,
        follow: typed.follow.into(),
    };
    match target {
        Some(target) => chosen.target = target,
        // A camera that follows shows by itself how high a body is.
        None if chosen.follow != Follow::Nothing => {}
        None => show_start(&mut chosen, start, dimension, typed.distance.is_some()),
    }
    if target.is_none() && typed.distance.is_none() {
        show_reach(&mut chosen, start, standing, scene);
    }
    chosen
}

/// How many panels stand beside each other of so many, unless a scene says so.
pub(in crate::scene) fn columns(runs: usize) -> usize {
    COLUMNS.min(runs.max(1))
}

/// Into how many columns panels are put so that the smaller of their sides is largest.
fn roomiest([width, height]: [u32; 2], runs: usize) -> usize {
    let side = |columns: usize| {
        let rows = runs.div_ceil(columns);
        (f64::from(width) / columns as f64).min(f64::from(height) / rows as f64)
    };
    // Of equal ones the first, with more rows and wider panels.
    (1..=runs.max(1)).fold(1, |best, columns| if side(columns) > side(best) { columns } else { best })
}

/// The strains at the ends of the scale that colours springs.
const SPRING_STRAIN: [f64; 2] = [-0.3, 0.3];

/// The narrowest range of colours, in parts of its larger end: ticks still differ in a few digits.
const NARROWEST: f64 = 1e-9;

/// The colours of a field, over a range that follows from the scene if none is typed.
fn colour(typed: &ColourFile, scene: &Around<'_>, report: &mut Report<'_>) -> Option<ColourScale> {
    let way = [Way::Key("view"), Way::Key("colour"), Way::Key("range")];
    let range = match typed.range {
        Some(range) => rising(range, &way, report)?,
        None => [0.0, scene.largest(typed.by)],
    };
    Some(ColourScale { field: typed.by, range, map: typed.map })
}

/// The ends of a scale, if they rise and are far enough apart to be told from each other.
fn rising([low, high]: [f64; 2], way: &[Way<'_>; 3], report: &mut Report<'_>) -> Option<[f64; 2]> {
    let keys = way.iter().filter_map(|step| if let Way::Key(key) = step { Some(*key) } else { None });
    let name = keys.collect::<Vec<_>>().join(".");
    if low >= high {
        report.at(way, format!("`{name}` runs from {low} to {high}; expected a rising range"), None);
        return None;
    }
    if high - low < NARROWEST * low.abs().max(high.abs()) {
        let message = format!("`{name}` from {low} to {high} is too narrow for its numbers");
        report.at(way, message, "move its ends apart".to_owned());
        return None;
    }
    Some([low, high])
}

/// What is written in panels.
fn labels(typed: &ViewFile) -> Labels {
    let has = |label| typed.labels.contains(&label);
    Labels {
        letter: typed.letters,
        name: has(LabelFile::Name),
        model: has(LabelFile::Model),
        clock: has(LabelFile::Clock),
        count: has(LabelFile::Count),
        number: has(LabelFile::Number),
    }
}

/// What a view follows from.
pub(super) struct Around<'a> {
    pub(super) body: &'a Body,
    pub(super) initial: &'a State,
    /// Mean length of the elements' edges (m).
    pub(super) side: f64,
    /// Whether that is the side of a lattice's cells.
    pub(super) has_cells: bool,
    pub(super) gravity: DVec3,
    pub(super) obstacles: &'a [Obstacle],
    pub(super) grips: &'a [Grip],
    /// Simulated time (s).
    pub(super) duration: f64,
    pub(super) runs: &'a [Run],
}

impl Around<'_> {
    /// The largest value of a field that the scene lets expect.
    fn largest(&self, field: Field) -> f64 {
        /// The strain, and the displacement in edges of an element, that count as large.
        const LARGE: f64 = 0.5;
        let side = self.side;
        match field {
            Field::Strain => LARGE,
            Field::Displacement => LARGE * side,
            Field::ElasticEnergy => {
                let stiffness = self.runs.iter().fold(0.0, |most: f64, run| most.max(run.model.stiffness()));
                0.5 * stiffness * (LARGE * side) * (LARGE * side)
            }
            Field::Speed => {
                let start = self.initial.velocity.iter().fold(0.0, |most: f64, v| most.max(v.length()));
                let (_, high) = bounds(&self.initial.position);
                let drop = contact::ground(self.obstacles, 0.0).map_or(0.0, |(_, ground)| (high.y - ground).max(0.0));
                let fall = (2.0 * self.gravity.length() * drop).sqrt();
                let pushed = self.obstacles.iter().map(|obstacle| obstacle.motion.greatest_speed(side));
                let fastest = pushed.fold((start * start + fall * fall).sqrt(), f64::max);
                // A body that nothing moves swings by itself at the most.
                let periods = self.runs.iter().map(|run| run.model.shortest_period(self.body));
                let swing = LARGE * side * TAU / periods.fold(f64::INFINITY, f64::min);
                if fastest > 0.0 { fastest } else { swing }
            }
        }
    }
}

/// The largest side of the box around the body at the start (m), or at rest if it starts as a point.
fn size(scene: &Around<'_>) -> f64 {
    let (low, high) = bounds(&scene.initial.position);
    let start = (high - low).max_element();
    if start > 0.0 { start } else { scene.body.extent() }
}

/// The start of a body that is drawn with its elements apart, a little larger than it is drawn.
fn spread<'s>(start: &'s [DVec3], apart: f64, obstacles: &[Obstacle]) -> Cow<'s, [DVec3]> {
    if apart == 0.0 || start.is_empty() {
        return Cow::Borrowed(start);
    }
    let mut anchor = start.iter().sum::<DVec3>() / start.len() as f64;
    if let Some((normal, _)) = contact::ground(obstacles, 0.0) {
        let lowest = start.iter().map(|at| at.dot(normal)).fold(f64::INFINITY, f64::min);
        anchor += (lowest - anchor.dot(normal)) * normal;
    }
    Cow::Owned(start.iter().map(|&at| at + apart * (at - anchor)).collect())
}

/// The middle of the body moved down or up until it stands on the first floor that faces upwards.
fn standing(start: &[DVec3], obstacles: &[Obstacle]) -> DVec3 {
    let (low, high) = bounds(start);
    let middle = (low + high) / 2.0;
    let Some((normal, height)) = contact::ground(obstacles, 0.0) else { return middle };
    let ground = (height - normal.x * middle.x - normal.z * middle.z) / normal.y;
    DVec3::new(middle.x, ground + (high.y - low.y) / 2.0, middle.z)
}

/// Moves a camera that looks at where a body will stand so that the body is also in the picture where it starts. A start
/// that is in the picture already changes nothing.
fn show_start(camera: &mut Camera, start: &[DVec3], dimension: Dimension, keep_distance: bool) {
    let (low, high) = bounds(start);
    let drop = camera.target - (low + high) / 2.0;
    let shown: Vec<_> = start.iter().flat_map(|&at| [at, at + drop]).collect();
    if least_distance(camera, start, dimension) <= camera.distance {
        return;
    }
    camera.rise = -drop.y;
    camera.target -= drop / 2.0;
    if !keep_distance {
        camera.distance = camera.distance.max(least_distance(camera, &shown, dimension));
    }
}

/// Moves a camera aside and back so that it also shows what comes near the body. If all of that is in the picture
/// already, or if there is nothing, nothing changes.
fn show_reach(camera: &mut Camera, start: &[DVec3], standing: DVec3, scene: &Around<'_>) {
    let (low, high) = bounds(start);
    let (dimension, drop) = (scene.body.dimension, standing - (low + high) / 2.0);
    let body: Vec<_> = match camera.follow {
        Follow::Nothing => start.iter().flat_map(|&at| [at, at + drop]).collect(),
        Follow::Height | Follow::Body => start.iter().map(|&at| at + drop).collect(),
    };
    let mut shown = reach::near(scene, &body, size(scene));
    if shown.is_empty() || least_distance(camera, &shown, dimension) <= camera.distance {
        return;
    }
    shown.extend(body);
    // Each distance shows another middle, but hardly.
    for _ in 0..4 {
        let step = middle_of(camera, &shown, dimension);
        camera.target += step;
        camera.distance = camera.distance.max(least_distance(camera, &shown, dimension));
    }
}

/// The way (m) from the point that a camera looks at to the one in whose picture points stand in the middle of the room.
fn middle_of(camera: &Camera, points: &[DVec3], dimension: Dimension) -> DVec3 {
    let [(across, along), (rise, level)] = [camera.azimuth, camera.elevation].map(libm::sincos);
    let towards = DVec3::new(across * level, rise, along * level);
    let right = DVec3::new(along, 0.0, -across);
    let up = towards.cross(right);
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
    // Upwards in the world, unless that is hardly to be seen.
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
    let [(across, along), (rise, level)] = [camera.azimuth, camera.elevation].map(libm::sincos);
    let towards = DVec3::new(across * level, rise, along * level);
    let right = DVec3::new(along, 0.0, -across);
    let up = towards.cross(right);
    let [aside, above, below] = ROOM.map(|share| share * 2.0 * libm::tan(camera.field_of_view / 2.0));
    let least = points.iter().map(|&point| {
        let from_target = point - camera.target;
        let (x, y) = (from_target.dot(right), from_target.dot(up));
        let depth = if dimension == Dimension::Plane { 0.0 } else { from_target.dot(towards) };
        depth + (x.abs() / aside).max(y / above).max(-y / below)
    });
    least.fold(0.0, f64::max)
}
