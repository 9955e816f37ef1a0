//! Loads: an arrow for each force on nodes, arrows on faces under pressure, and an arc for each torque.

use super::{KeyPlace, contacts, shortest_arrow};
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::legend::{Sample, SampleKind};
use crate::picture::order::farthest_first;
use crate::picture::{Item, arrows, number};
use crate::reading::captions::quantity;
use crate::scene::Scene;
use crate::sim::{Dimension, Load, Loading, Pull, for_each_area};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;
use std::ops::Range;

/// The length of the arrow of the largest load, and of one of the largest pressure, in sizes of the largest body.
const LENGTH: [f64; 2] = [0.22, 0.12];
/// Of a whole torque: the radius of its arc in distances of the farthest node from the axis, and the part of a turn.
const ARC: [f64; 2] = [1.25, 0.75];
/// Pieces of an arc.
const PIECES: usize = 32;

/// An arrow with its force or its pressure in words, and an arc with the largest torque.
pub(super) fn samples(composer: &Composer<'_>, place: &KeyPlace) -> Vec<Sample> {
    let pixels = place.pixels;
    let room = place.legend.arrow_length() / pixels;
    let scales = Scales::new(composer.scene);
    // Not longer than the arrow of any largest load that there is.
    let all = [scales.newton, scales.pascal];
    let lengths = all.into_iter().zip(scales.largest).filter(|&(metres, _)| metres > 0.0);
    let longest = lengths.map(|(metres, largest)| metres * largest).fold(room, f64::min);
    let [force, pressure] = all.map(|metres| (metres > 0.0).then(|| longest / metres));
    let straight = match (force, pressure) {
        (Some(force), _) => Some((number::round_below(force), scales.newton, "N")),
        (None, Some(pressure)) => Some((number::round_below(pressure), scales.pascal, scales.unit)),
        (None, None) => None,
    };
    let straight = straight.map(|(value, metres, unit)| {
        let also = pressure.filter(|_| force.is_some()).map(|_| value * scales.newton / scales.pascal);
        let also = also.map_or_else(String::new, |pascal| format!(" or {}", quantity(pascal, scales.unit)));
        let size = quantity(value, unit) + &also;
        // Loads that rise or fall, and small ones beside a large one, may be seen as dots.
        let mut names = vec![format!("load {size}"), size];
        if has_small(composer.scene, &scales, shortest_load(place.size) / pixels) {
            names.insert(0, format!("{}, dots: smaller loads", names[0]));
        }
        place.arrow(composer, names, value * metres * pixels, arrows::with_halo)
    });
    let turning = (scales.torque > 0.0).then(|| {
        let size = quantity(scales.torque, "N m");
        Sample { names: vec![format!("torque {size}"), size], kind: SampleKind::Arc(place.size) }
    });
    straight.into_iter().chain(turning).collect()
}

/// The length that arrows of loads exceed, for arrows of a size (px). Shorter ones would be faint.
fn shortest_load(size: f64) -> f64 {
    (1.0 + arrows::FADING) * shortest_arrow(size)
}

/// Whether some load has at some time an arrow that is not longer than a length (m).
fn has_small(scene: &Scene, scales: &Scales, shortest: f64) -> bool {
    scene.runs.iter().flat_map(|run| &run.loads).any(|load| {
        let metres = match load.pull() {
            Pull::Dead(forces) => forces.iter().sum::<DVec3>().length() * scales.newton,
            Pull::Pressure(pressure, _) | Pull::CarriedPressure(pressure, ..) => pressure.abs() * scales.pascal,
            Pull::Torque(..) | Pull::Centrifugal(_) => return false,
        };
        let shares = || load.course().keys.iter().map(|&[_, share]| share);
        let [low, high] = [shares().reduce(f64::min), shares().reduce(f64::max)].map(|share| share.unwrap_or(1.0));
        metres * if low * high > 0.0 { low.abs().min(high.abs()) } else { 0.0 } <= shortest
    })
}

/// Arrows of loads. A force that pushes its body ends at the middle of its nodes, and one that pulls it begins there.
pub(super) fn draw(draft: &Draft<'_>, marks: &mut Vec<Item>) {
    if !draft.scene.view.visible.loads || draft.diverged || draft.position.is_empty() {
        return;
    }
    let scales = Scales::new(draft.scene);
    let mut found = Vec::new();
    for load in &draft.scene.runs[draft.run].loads {
        let share = load.course().share(draft.snapshot.time);
        if share == 0.0 {
            continue;
        }
        match load.pull() {
            Pull::Dead(forces) => {
                let way = forces.iter().sum::<DVec3>() * (share * scales.newton);
                let (at, centre) = (draft.middle_of(load), draft.centre(draft.own_nodes(load)));
                let start = if way.dot(at - centre) < 0.0 { at - way } else { at };
                found.extend(draft.load([start, start + way], at));
            }
            Pull::Pressure(pressure, faces) => {
                let length = scales.pascal * pressure * share;
                let all: Vec<u32> = (0..faces.len() as u32).collect();
                let chosen = arrows::bearers(&all).into_iter().map(|face| &faces[face as usize]);
                found.extend(chosen.filter_map(|face| draft.pressed(face, &draft.position, length)));
            }
            Pull::CarriedPressure(pressure, triangles, points) => {
                let length = scales.pascal * pressure * share;
                let at: Vec<_> = (0..points.len()).map(|point| points.place(point, &draft.position)).collect();
                let all: Vec<u32> = (0..triangles.len() as u32).collect();
                let chosen = arrows::bearers(&all).into_iter().map(|face| &triangles[face as usize]);
                found.extend(chosen.filter_map(|face| draft.pressed(face, &at, length)));
            }
            Pull::Centrifugal(_) => {}
            Pull::Torque(torque, _) => {
                let turn = ARC[1] * TAU * share / load.course().greatest();
                let (middle, axis) = (draft.middle_of(load), torque.normalize_or_zero());
                let nodes = load.nodes().unwrap_or_default().iter().map(|&node| draft.position[node as usize]);
                let farthest = nodes.fold(0.0, |far: f64, at| far.max((at - middle).cross(axis).length()));
                found.extend(draft.arc(middle, axis, [ARC[0] * farthest, turn]));
            }
        }
    }
    marks.extend(farthest_first(found));
}

/// The scales of arrows.
struct Scales {
    /// The length of an arrow (m) for each newton, and for each pascal; zero without such a load.
    newton: f64,
    pascal: f64,
    /// The largest force (N), and the largest pressure.
    largest: [f64; 2],
    /// The unit of pressures.
    unit: &'static str,
    /// The largest torque (N m).
    torque: f64,
}

impl Scales {
    fn new(scene: &Scene) -> Self {
        let [mut force, mut pressure, mut torque] = [0.0_f64; 3];
        for load in scene.runs.iter().flat_map(|run| &run.loads) {
            let most = load.course().greatest();
            match load.pull() {
                Pull::Dead(forces) => force = force.max(most * forces.iter().sum::<DVec3>().length()),
                Pull::Pressure(size, _) | Pull::CarriedPressure(size, ..) => pressure = pressure.max(most * size.abs()),
                Pull::Torque(turn, _) => torque = torque.max(most * turn.length()),
                // Its forces differ from node to node.
                Pull::Centrifugal(_) => {}
            }
        }
        let size = scene.bodies.iter().map(|body| body.body.extent()).fold(0.0, f64::max);
        let scale = |[length, most]: [f64; 2]| {
            if most > 0.0 { scene.view.arrow_scale * length * size / most } else { 0.0 }
        };
        // Forces of contact have the same scale where they are shown, too.
        let newton = match scene.view.visible.contacts {
            true if force > 0.0 => contacts::metres_a_newton(scene),
            _ => scale([LENGTH[0], force]),
        };
        let unit = if scene.dimension() == Dimension::Plane { "N/m" } else { "Pa" };
        Self { newton, pascal: scale([LENGTH[1], pressure]), largest: [force, pressure], unit, torque }
    }
}

impl Draft<'_> {
    /// The middle of the nodes of a load (m).
    fn middle_of(&self, load: &Loading) -> DVec3 {
        let nodes = load.nodes().unwrap_or_default();
        nodes.iter().map(|&node| self.position[node as usize]).sum::<DVec3>() / nodes.len().max(1) as f64
    }

    /// The nodes of the body of a load.
    fn own_nodes(&self, load: &Loading) -> Range<usize> {
        let bodies = self.bodies.assembly;
        let first = load.nodes().and_then(|nodes| nodes.first()).map_or(0, |&node| node as usize);
        bodies.nodes(bodies.body_of_node(first))
    }

    /// An arrow of a length (m) on the outside of a face that faces the viewer: towards the face, or away from it if the length is negative.
    fn pressed(&self, face: &[u32], position: &[DVec3], length: f64) -> Option<(f64, Item)> {
        let (mut area, count) = (DVec3::ZERO, face.len() as f64);
        for_each_area(face, position, |_, part| area += part);
        let at = face.iter().map(|&node| position[node as usize]).sum::<DVec3>() / count;
        let out = area.normalize_or_zero() * length.abs();
        let faces_viewer = self.flat || self.lens.facing(at, area) > 0.0;
        let start = if length > 0.0 { at + out } else { at };
        let end = if length > 0.0 { start - out } else { start + out };
        faces_viewer.then(|| self.load([start, end], at))?
    }

    /// The arrow of a load at a point (m). A small load has a dot in its place, or it would seem to be none.
    fn load(&self, ends: [DVec3; 2], at: DVec3) -> Option<(f64, Item)> {
        let length = ends[0].distance(ends[1]) * self.element / self.scene.view.side;
        if length > shortest_load(arrows::size(self.element, self.scale.unit)) {
            return self.arrow(ends, 0.0, 1.0, arrows::with_halo);
        }
        Some((self.lens.project(at)?.1, self.dot(at, f64::INFINITY, self.composer.palette.text)?))
    }

    /// An arc of a radius (m) and an angle (rad) about an axis, which ends with the head of an arrow.
    fn arc(&self, middle: DVec3, axis: DVec3, [radius, angle]: [f64; 2]) -> Option<(f64, Item)> {
        let start = axis.any_orthonormal_vector() * radius;
        let at = |piece: usize| middle + DQuat::from_axis_angle(axis, angle * piece as f64 / PIECES as f64) * start;
        let pixels: Vec<_> = (0..=PIECES).map(|piece| self.pixel(at(piece))).collect::<Option<_>>()?;
        let size = arrows::size(self.element, self.scale.unit);
        let (_, depth) = self.lens.project(middle)?;
        Some((depth, arrows::bent(&pixels, [self.scale.unit, size], &self.composer.palette)))
    }
}
