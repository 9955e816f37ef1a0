//! Loads: on which nodes and faces of which bodies they act, and when.

use super::faces::{Faces, outside, surface};
use super::nodes::select;
use super::vector;
use crate::reading::collector::{Collector, PathPart, key_path, written};
use crate::reading::words::{list, several};
use crate::scene::SceneBody;
use crate::scene::file::{AxialFile, LoadFile, NodesFile};
use crate::sim::{Assembly, Body, Course, Dimension, Ease, Loading, Turning, Weights};
use glam::DVec3;

/// A load: on each body of the scene, if it has one.
#[derive(Debug)]
pub(super) struct SceneLoad {
    of_bodies: Vec<Option<OnBody>>,
    course: Course,
}

/// A load on a body, whose nodes are counted from its first.
#[derive(Debug)]
enum OnBody {
    Dead(Vec<(u32, DVec3)>),
    Torque(Vec<(u32, f64)>, DVec3),
    Pressure(Vec<Vec<u32>>, f64),
    CarriedPressure(Vec<[u32; 3]>, Weights, f64),
    Centrifugal(Vec<u32>, Turning),
}

impl SceneLoad {
    /// The loads in a run of some of the bodies.
    pub(super) fn in_run<'a>(&'a self, of: &'a [usize], bodies: &'a Assembly) -> impl Iterator<Item = Loading> {
        of.iter().enumerate().filter_map(|(at, &body)| {
            let (first, course) = (bodies.nodes(at).start as u32, self.course.clone());
            Some(match self.of_bodies[body].as_ref()? {
                OnBody::Dead(forces) => {
                    let (nodes, forces) = forces.iter().map(|&(node, force)| (first + node, force)).unzip();
                    Loading::dead(nodes, forces, course)
                }
                OnBody::Torque(weights, torque) => {
                    let (nodes, weights) = weights.iter().map(|&(node, weight)| (first + node, weight)).unzip();
                    Loading::torque(nodes, weights, *torque, course)
                }
                OnBody::Pressure(faces, pressure) => {
                    let moved = faces.iter().map(|face| face.iter().map(|node| first + node).collect());
                    Loading::pressure(moved.collect(), *pressure, course)
                }
                OnBody::CarriedPressure(triangles, points, pressure) => {
                    let points = points.some(0..points.len() as u32, first);
                    Loading::pressure_on_carried(triangles.clone(), points, *pressure, course)
                }
                OnBody::Centrifugal(nodes, turning) => {
                    let nodes = nodes.iter().map(|node| first + node).collect();
                    Loading::centrifugal(nodes, turning.clone(), course)
                }
            })
        })
    }
}

/// The loads, or `None` after reporting every mistake in them.
pub(super) fn resolve(
    loads: &[Option<LoadFile>],
    bodies: &[SceneBody],
    report: &mut Collector<'_>,
) -> Option<Vec<SceneLoad>> {
    let load = |(at, typed): (usize, &Option<LoadFile>)| {
        let path = key_path!["load", at];
        let reading = Reading { typed: typed.as_ref()?, path: &path, bodies };
        let (course, kind) = (reading.course(report), reading.kind(report));
        let of_bodies = reading.on_bodies(kind?, report)?;
        Some(SceneLoad { of_bodies, course: course? })
    };
    let all: Vec<_> = loads.iter().enumerate().map(load).collect();
    all.into_iter().collect()
}

/// Reports loads that are shorter than a time step (s), which would have no effect.
pub(super) fn check_steps(loads: &[Option<LoadFile>], step: f64, report: &mut Collector<'_>) {
    for (at, load) in loads.iter().enumerate() {
        let Some((from, until)) = load.as_ref().and_then(|load| Some((load.from, load.until?))) else { continue };
        if (0.0..step).contains(&(until - from)) {
            let message = format!("`load[{at}]` lasts {:.3e} s, but a time step takes {step:.3e} s", until - from);
            report.at(&key_path!["load", at, "until"], message, "make it longer, or it does nothing".to_owned());
        }
    }
}

/// What a load does, and its key.
enum Kind {
    Force(DVec3),
    Traction(DVec3),
    Pressure(f64),
    Acceleration(DVec3),
    Torque(DVec3),
    /// The rate of the frame, and a point of its axis.
    Centrifugal(DVec3, DVec3),
}

/// The nodes or the faces of a body with their weights.
type Weighted = Vec<(u32, f64)>;

/// A load that is read.
struct Reading<'a> {
    typed: &'a LoadFile,
    path: &'a [PathPart<'a>],
    bodies: &'a [SceneBody],
}

impl Reading<'_> {
    fn course(&self, report: &mut Collector<'_>) -> Option<Course> {
        let LoadFile { from, until, ramp, keys, ease, .. } = self.typed;
        let (name, until) = (written(self.path), until.unwrap_or(f64::INFINITY));
        if until <= *from {
            let message = format!("`{name}` ends at {until} s, not later than it begins at {from} s");
            report.at(&key_path![self.path; "until"], message, None);
            return None;
        }
        let rise = ramp.as_ref().map(|ramp| vec![[*from, 0.0], [from + ramp.0, 1.0]]);
        let typed = keys.as_ref().map(|keys| keys.iter().map(|key| [key.time, key.share]).collect::<Vec<_>>());
        if rise.is_some() && typed.is_some() {
            let message = format!("`{name}` has `ramp` and `keys`, which both say how it rises");
            report.at_key(&key_path![self.path; "ramp"], message, "remove one of them");
            return None;
        }
        let keys = typed.or(rise).unwrap_or_default();
        if let Some(at) = (1..keys.len()).find(|&at| keys[at][0] <= keys[at - 1][0]) {
            let path = key_path![self.path; "keys", at];
            let [before, time] = [keys[at - 1][0], keys[at][0]];
            let message =
                format!("`{}` is at {time} s, not later than the key before it at {before} s", written(&path));
            report.at(&key_path![path; "time"], message, "list the keys in rising order of time");
            return None;
        }
        let ease = if keys.is_empty() { Ease::Linear } else { *ease };
        Some(Course { during: *from..until, keys, ease })
    }

    /// The only kind that is typed.
    fn kind(&self, report: &mut Collector<'_>) -> Option<Kind> {
        let LoadFile { force, traction, pressure, acceleration, torque, centrifugal, about, .. } = self.typed;
        let dimension = self.bodies.first()?.body.dimension();
        let keys = ["force", "traction", "pressure", "acceleration", "torque", "centrifugal"];
        let vectors = [force.is_some(), traction.is_some(), pressure.is_some(), acceleration.is_some()];
        let given = vectors.into_iter().chain([torque.is_some(), centrifugal.is_some()]);
        let given: Vec<_> = keys.into_iter().zip(given).filter_map(|(key, is_given)| is_given.then_some(key)).collect();
        let [only] = given[..] else {
            let (name, all) = (written(self.path), list(&keys, "or", |key| format!("`{key}`")));
            let (message, help) = match given.len() {
                0 => (format!("`{name}` has no load; expected one of {all}"), "such as force = [0, -10, 0]"),
                _ => {
                    let given = list(&given, "and", |key| format!("`{key}`"));
                    (format!("`{name}` has {given}; expected one load"), "write another [[load]] for each of them")
                }
            };
            report.at(self.path, message, help.to_owned());
            return None;
        };
        if about.is_some() && only != "centrifugal" {
            let message =
                format!("`{}` has `about`, which is the axis of `centrifugal`, with `{only}`", written(self.path));
            report.at_key(&key_path![self.path; "about"], message, "remove it");
            return None;
        }
        let path = key_path![self.path; only];
        let typed = [force, traction, acceleration].into_iter().flatten().next();
        Some(match (only, torque.as_ref().or(centrifugal.as_ref())) {
            ("force", _) => Kind::Force(vector(typed?, dimension, &path, report)?),
            ("traction", _) => Kind::Traction(vector(typed?, dimension, &path, report)?),
            ("acceleration", _) => Kind::Acceleration(vector(typed?, dimension, &path, report)?),
            ("centrifugal", Some(rate)) => {
                let point = key_path![self.path; "about"];
                let about = about.as_ref().map_or(Some(DVec3::ZERO), |typed| vector(typed, dimension, &point, report));
                Kind::Centrifugal(axial(rate, (dimension, only), &path, report)?, about?)
            }
            (_, Some(torque)) => Kind::Torque(axial(torque, (dimension, only), &path, report)?),
            _ => Kind::Pressure((*pressure)?),
        })
    }

    /// The load on each body that has one; `None` after a mistake.
    fn on_bodies(&self, kind: Kind, report: &mut Collector<'_>) -> Option<Vec<Option<OnBody>>> {
        let LoadFile { nodes, faces, body, .. } = self.typed;
        let needs_faces = match kind {
            Kind::Traction(_) => Some("traction"),
            Kind::Pressure(_) => Some("pressure"),
            _ => None,
        };
        if let (Some(key), Some(_)) = (needs_faces, nodes) {
            let message = format!("`{}` has a `{key}`, which acts on faces, with `nodes`", written(self.path));
            report.at_key(&key_path![self.path; "nodes"], message, "write `faces` in place of `nodes`");
            return None;
        }
        let all = NodesFile::Named("all".to_owned());
        let key = if faces.is_some() || needs_faces.is_some() { "faces" } else { "nodes" };
        let chosen = faces.as_ref().or(nodes.as_ref()).unwrap_or(&all);
        let is_all = matches!(chosen, NodesFile::Named(name) if name == "all");
        let on_faces = key == "faces";
        let have_skins = on_faces && self.bodies.iter().any(|body| body.body.carried().is_some());
        let skins: Vec<_> = self.bodies.iter().filter(|_| have_skins).map(outside).collect();
        let bodies = if have_skins { &skins } else { self.bodies };
        let selected = select(body.as_deref(), (!is_all).then_some(chosen), bodies, (self.path, key), report)?;
        let mut of_bodies = Vec::new();
        for (body, points) in self.bodies.iter().zip(selected) {
            let faces = on_faces.then(|| Faces::among(&body.body, &points));
            of_bodies.push(match faces {
                _ if points.is_empty() => None,
                Some(faces) if faces.is_empty() => {
                    self.report_no_faces(body, points.len(), report);
                    return None;
                }
                Some(faces) => Some(on_body(&kind, &body.body, faces.areas(&body.body), Some(faces))),
                None => Some(on_body(&kind, &body.body, shared(&body.body, &points), None)),
            });
            if let Some(Some(OnBody::Torque(weights, torque))) = of_bodies.last() {
                self.check_arms(body, weights, *torque, report)?;
            }
        }
        Some(of_bodies)
    }

    fn report_no_faces(&self, body: &SceneBody, nodes: usize, report: &mut Collector<'_>) {
        let (path, body_words) = (key_path![self.path; "faces"], body.in_words());
        let has_faces = body.body.carried().is_some() || !surface(&body.body).is_empty();
        let (message, help) = if has_faces {
            let what = if body.body.carried().is_some() { "point" } else { "node" };
            let nodes = several(nodes as u64, what);
            let message =
                format!("`{}` takes {nodes} of {body_words}, but no face has all corners among them", written(&path));
            (message, "choose a larger part of the surface, or write `nodes` for a force on nodes")
        } else {
            let message =
                format!("`{}` acts on faces, but {body_words} has none: it is made of bars", written(self.path));
            (message, "write a `force` on `nodes`")
        };
        report.at(if has_faces { &path } else { self.path }, message, help.to_owned());
    }

    /// Reports a torque about a line on which all nodes lie at rest.
    fn check_arms(
        &self,
        body: &SceneBody,
        weights: &Weighted,
        torque: DVec3,
        report: &mut Collector<'_>,
    ) -> Option<()> {
        let rest = body.body.rest();
        let centre: DVec3 = weights.iter().map(|&(node, weight)| rest[node as usize] * weight).sum();
        let farthest = weights.iter().map(|&(node, _)| (rest[node as usize] - centre).cross(torque).length());
        let most = farthest.fold(0.0, f64::max);
        if most > 1e-9 * body.body.extent() * torque.length() || torque == DVec3::ZERO {
            return Some(());
        }
        let message = format!(
            "`{}` has no arm: all its nodes of {} lie on its axis",
            written(&key_path![self.path; "torque"]),
            body.in_words()
        );
        report.at(&key_path![self.path; "torque"], message, "choose nodes beside the axis");
        None
    }
}

/// A vector along an axis, at a key.
fn axial(
    typed: &AxialFile,
    (dimension, key): (Dimension, &str),
    path: &[PathPart<'_>],
    report: &mut Collector<'_>,
) -> Option<DVec3> {
    match (typed, dimension) {
        (AxialFile::Vector(typed), Dimension::Space) => vector(typed, dimension, path, report),
        (AxialFile::Number(size), Dimension::Plane) => Some(DVec3::Z * *size),
        (_, dimension) => {
            let (body, example) = match dimension {
                Dimension::Space => ("a number, but the body is in space", "[0, 0, 5]"),
                Dimension::Plane => ("a vector, but the body is in the plane", "5"),
            };
            report.at(path, format!("`{}` is {body}", written(path)), format!("such as {key} = {example}"));
            None
        }
    }
}

/// Nodes of a body with their shares of a load: equal ones, or in a filled surface their masses, as elements that are hardly filled
/// would not bear equal ones.
fn shared(body: &Body, nodes: &[u32]) -> Weighted {
    let share = |node: u32| if body.carried().is_some() { body.mass()[node as usize] } else { 1.0 };
    nodes.iter().map(|&node| (node, share(node))).collect()
}

/// A load on nodes of a body with their shares, which bear faces if it acts on some.
fn on_body(kind: &Kind, body: &Body, weights: Weighted, faces: Option<Faces>) -> OnBody {
    let whole: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let dead = |of: &dyn Fn(u32, f64) -> DVec3| {
        OnBody::Dead(weights.iter().map(|&(node, weight)| (node, of(node, weight))).collect())
    };
    match *kind {
        Kind::Force(force) => dead(&|_, weight| force * (weight / whole)),
        Kind::Traction(traction) => dead(&|_, area| traction * area),
        Kind::Acceleration(acceleration) => dead(&|node, _| acceleration * body.mass()[node as usize]),
        Kind::Torque(torque) => {
            OnBody::Torque(weights.iter().map(|&(node, weight)| (node, weight / whole)).collect(), torque)
        }
        Kind::Pressure(pressure) => match (faces, body.carried()) {
            (Some(Faces::Carried(triangles)), Some(fine)) => {
                let mut points: Vec<u32> = triangles.iter().flatten().copied().collect();
                points.sort_unstable();
                points.dedup();
                let place = |point: u32| points.partition_point(|&other| other < point) as u32;
                let triangles = triangles.iter().map(|face| face.map(place)).collect();
                OnBody::CarriedPressure(triangles, fine.weights.some(points.iter().copied(), 0), pressure)
            }
            (Some(Faces::Own(faces)), _) => OnBody::Pressure(faces, pressure),
            _ => unreachable!("a pressure acts on faces"),
        },
        Kind::Centrifugal(rate, about) => {
            let nodes: Vec<u32> = weights.iter().map(|&(node, _)| node).collect();
            let masses = nodes.iter().map(|&node| body.mass()[node as usize]).collect();
            OnBody::Centrifugal(nodes, Turning { rate, about, masses })
        }
    }
}
