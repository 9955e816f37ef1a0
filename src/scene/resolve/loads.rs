//! Loads: on which nodes and faces of which bodies they act, and when.

use super::faces::{Faces, outside, surface};
use super::grips::SceneGrip;
use super::nodes::select;
use super::{Typed, vector};
use crate::reading::collector::Here;
use crate::reading::words::{list, several};
use crate::scene::SceneBody;
use crate::scene::file::{AxialFile, Coordinates, LoadFile, NodesFile};
use crate::sim::{Assembly, Body, Course, Dimension, Ease, Loading, Turning};
use glam::DVec3;

/// A load: what it does, when, and on which parts of each body of the scene.
#[derive(Debug)]
pub(super) struct SceneLoad<'s> {
    here: Here<'s>,
    kind: Kind,
    course: Course,
    on: Vec<Option<Borne>>,
}

/// What bears a load on a body: nodes, counted from its first, with their weights, and the faces on which it acts, if it acts on some.
#[derive(Debug)]
struct Borne {
    weights: Vec<(u32, f64)>,
    faces: Option<Faces>,
}

impl SceneLoad<'_> {
    /// The loads in a run of some of the bodies.
    pub(super) fn in_run<'a>(&'a self, of: &'a [usize], bodies: &'a Assembly) -> impl Iterator<Item = Loading> {
        of.iter().enumerate().filter_map(|(at, &body)| {
            let borne = self.on[body].as_ref()?;
            Some(borne.loading(&self.kind, &bodies.bodies()[at], bodies.nodes(at).start as u32, self.course.clone()))
        })
    }
}

/// The loads, without those with mistakes, which are reported.
pub(super) fn resolve<'s>(scene: &Typed<'s>, bodies: &[SceneBody]) -> Vec<SceneLoad<'s>> {
    let load = |(here, typed): (Here<'s>, _)| {
        let reading = Reading { typed, here: here.clone(), bodies };
        let (course, kind) = (reading.course(), reading.kind());
        let kind = kind?;
        Some(SceneLoad { on: reading.borne(&kind)?, kind, course: course?, here })
    };
    scene.each("load", &scene.file.load).filter_map(load).collect()
}

/// Reports loads that are shorter than a time step (s), which would have no effect.
pub(super) fn check_steps(scene: &Typed<'_>, step: f64) {
    for (here, load) in scene.each("load", &scene.file.load) {
        let lasts = load.until.map(|until| until - load.from);
        if let Some(lasts) = lasts.filter(|lasts| (0.0..step).contains(lasts)) {
            let message = format!("`{here}` lasts {lasts:.3e} s, but a time step takes {step:.3e} s");
            here.to("until").wrong(message, "make it longer, or it does nothing");
        }
    }
}

/// Warns of loads whose nodes are held or grabbed as long as they act: what holds the nodes carries them, and nothing moves.
pub(super) fn warn_of_held(loads: &[SceneLoad<'_>], grips: &[SceneGrip<'_>]) {
    for SceneLoad { here, course, on, .. } in loads {
        let on = on.iter().enumerate().filter_map(|(body, borne)| Some((body, borne.as_ref()?)));
        let mut nodes = on.flat_map(|(body, borne)| borne.weights.iter().map(move |&(node, _)| (body, node)));
        if nodes.all(|node| grips.iter().any(|grip| grip.holds(node, &course.during))) {
            let message = format!("`{here}` moves nothing: all nodes on which it acts are held or grabbed");
            here.warn(message, "choose other nodes or faces, or remove it");
        }
    }
}

/// What a load does.
#[derive(Debug)]
enum Kind {
    Force(DVec3),
    Traction(DVec3),
    Pressure(f64),
    Acceleration(DVec3),
    Torque(DVec3),
    /// The rate of the frame, and a point of its axis.
    Centrifugal(DVec3, DVec3),
}

/// A load that is read.
struct Reading<'a> {
    typed: &'a LoadFile,
    here: Here<'a>,
    bodies: &'a [SceneBody],
}

impl Reading<'_> {
    fn course(&self) -> Option<Course> {
        let LoadFile { from, until, ramp, keys, ease, .. } = self.typed;
        let (here, until) = (&self.here, until.unwrap_or(f64::INFINITY));
        if until <= *from {
            let message = format!("`{here}` ends at {until} s, not later than it begins at {from} s");
            here.to("until").wrong(message, None);
            return None;
        }
        let rise = ramp.as_ref().map(|ramp| vec![[*from, 0.0], [from + ramp.0, 1.0]]);
        let typed = keys.as_ref().map(|keys| keys.iter().map(|key| [key.time, key.share]).collect::<Vec<_>>());
        if rise.is_some() && typed.is_some() {
            let message = format!("`{here}` has `ramp` and `keys`, which both say how it rises");
            here.to("ramp").wrong_key(message, "remove one of them");
            return None;
        }
        let keys = typed.or(rise).unwrap_or_default();
        if let Some(at) = (1..keys.len()).find(|&at| keys[at][0] <= keys[at - 1][0]) {
            let key = here.to("keys").to(at);
            let [before, time] = [keys[at - 1][0], keys[at][0]];
            let message = format!("`{key}` is at {time} s, not later than the key before it at {before} s");
            key.to("time").wrong(message, "list the keys in rising order of time");
            return None;
        }
        let ease = if keys.is_empty() { Ease::Linear } else { *ease };
        Some(Course { during: *from..until, keys, ease })
    }

    /// The only kind that is typed.
    fn kind(&self) -> Option<Kind> {
        let LoadFile { force, traction, pressure, acceleration, torque, centrifugal, about, .. } = self.typed;
        let (dimension, here) = (self.bodies.first()?.body.dimension(), &self.here);
        let keys = ["force", "traction", "pressure", "acceleration", "torque", "centrifugal"];
        let vectors = [force.is_some(), traction.is_some(), pressure.is_some(), acceleration.is_some()];
        let given = vectors.into_iter().chain([torque.is_some(), centrifugal.is_some()]);
        let given: Vec<_> = keys.into_iter().zip(given).filter_map(|(key, is_given)| is_given.then_some(key)).collect();
        let [only] = given[..] else {
            let all = list(&keys, "or", |key| format!("`{key}`"));
            let (message, help) = match given.len() {
                0 => (format!("`{here}` has no load; expected one of {all}"), "such as force = [0, -10, 0]"),
                _ => {
                    let given = list(&given, "and", |key| format!("`{key}`"));
                    (format!("`{here}` has {given}; expected one load"), "write another [[load]] for each of them")
                }
            };
            here.wrong(message, help);
            return None;
        };
        if about.is_some() && only != "centrifugal" {
            let message = format!("`{here}` has `about`, which is the axis of `centrifugal`, with `{only}`");
            here.to("about").wrong_key(message, "remove it");
            return None;
        }
        let at = here.to(only);
        let straight = |typed: &Option<Coordinates>| vector(typed.as_ref()?, dimension, &at);
        let around = |typed: &Option<AxialFile>| axial(typed.as_ref()?, (dimension, only), &at);
        Some(match only {
            "force" => Kind::Force(straight(force)?),
            "traction" => Kind::Traction(straight(traction)?),
            "acceleration" => Kind::Acceleration(straight(acceleration)?),
            "torque" => Kind::Torque(around(torque)?),
            "centrifugal" => {
                let point = |typed| vector(typed, dimension, &here.to("about"));
                let about = about.as_ref().map_or(Some(DVec3::ZERO), point);
                Kind::Centrifugal(around(centrifugal)?, about?)
            }
            _ => Kind::Pressure((*pressure)?),
        })
    }

    /// What bears the load on each body that has one; `None` after a mistake.
    fn borne(&self, kind: &Kind) -> Option<Vec<Option<Borne>>> {
        let LoadFile { nodes, faces, body, .. } = self.typed;
        let needs_faces = match kind {
            Kind::Traction(_) => Some("traction"),
            Kind::Pressure(_) => Some("pressure"),
            _ => None,
        };
        if let (Some(key), Some(_)) = (needs_faces, nodes) {
            let message = format!("`{}` has a `{key}`, which acts on faces, with `nodes`", self.here);
            self.here.to("nodes").wrong_key(message, "write `faces` in place of `nodes`");
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
        let selected = select(body.as_deref(), (!is_all).then_some(chosen), bodies, (&self.here, key))?;
        let mut all = Vec::new();
        for (body, points) in self.bodies.iter().zip(selected) {
            let faces = on_faces.then(|| Faces::among(&body.body, &points));
            all.push(match faces {
                _ if points.is_empty() => None,
                Some(faces) if faces.is_empty() => {
                    self.report_no_faces(body, points.len());
                    return None;
                }
                Some(faces) => Some(Borne { weights: faces.areas(&body.body), faces: Some(faces) }),
                None => Some(Borne { weights: shared(&body.body, &points), faces: None }),
            });
            if let (Kind::Torque(torque), Some(Some(borne))) = (kind, all.last()) {
                self.check_arms(body, borne, *torque)?;
            }
        }
        Some(all)
    }

    fn report_no_faces(&self, body: &SceneBody, nodes: usize) {
        let (faces, of) = (self.here.to("faces"), body.in_words());
        if body.body.carried().is_some() || !surface(&body.body).is_empty() {
            let what = if body.body.carried().is_some() { "point" } else { "node" };
            let nodes = several(nodes as u64, what);
            let message = format!("`{faces}` takes {nodes} of {of}, but no face has all corners among them");
            faces.wrong(message, "choose a larger part of the surface, or write `nodes` for a force on nodes");
        } else {
            let message = format!("`{}` acts on faces, but {of} has none: it is made of bars", self.here);
            self.here.wrong(message, "write a `force` on `nodes`");
        }
    }

    /// Reports a torque about a line on which all nodes lie at rest.
    fn check_arms(&self, body: &SceneBody, borne: &Borne, torque: DVec3) -> Option<()> {
        let rest = body.body.rest();
        let weights = borne.shares();
        let centre: DVec3 = weights.iter().map(|&(node, weight)| rest[node as usize] * weight).sum();
        let farthest = weights.iter().map(|&(node, _)| (rest[node as usize] - centre).cross(torque).length());
        let most = farthest.fold(0.0, f64::max);
        if most > 1e-9 * body.body.extent() * torque.length() || torque == DVec3::ZERO {
            return Some(());
        }
        let here = self.here.to("torque");
        let message = format!("`{here}` has no arm: all its nodes of {} lie on its axis", body.in_words());
        here.wrong(message, "choose nodes beside the axis");
        None
    }
}

/// A vector along an axis, at a key.
fn axial(typed: &AxialFile, (dimension, key): (Dimension, &str), here: &Here<'_>) -> Option<DVec3> {
    match (typed, dimension) {
        (AxialFile::Vector(typed), Dimension::Space) => vector(typed, dimension, here),
        (AxialFile::Number(size), Dimension::Plane) => Some(DVec3::Z * *size),
        (_, dimension) => {
            let (body, example) = match dimension {
                Dimension::Space => ("a number, but the body is in space", "[0, 0, 5]"),
                Dimension::Plane => ("a vector, but the body is in the plane", "5"),
            };
            here.wrong(format!("`{here}` is {body}"), format!("such as {key} = {example}"));
            None
        }
    }
}

/// Nodes of a body with their shares of a load: equal ones, or in a filled surface their masses, as elements that are hardly filled
/// would not bear equal ones.
fn shared(body: &Body, nodes: &[u32]) -> Vec<(u32, f64)> {
    let share = |node: u32| if body.carried().is_some() { body.mass()[node as usize] } else { 1.0 };
    nodes.iter().map(|&node| (node, share(node))).collect()
}

impl Borne {
    /// The nodes with their shares of the whole.
    fn shares(&self) -> Vec<(u32, f64)> {
        let whole: f64 = self.weights.iter().map(|(_, weight)| weight).sum();
        self.weights.iter().map(|&(node, weight)| (node, weight / whole)).collect()
    }

    /// A load on a body, whose first node has a number in its run.
    fn loading(&self, kind: &Kind, body: &Body, first: u32, course: Course) -> Loading {
        let nodes = self.weights.iter().map(|&(node, _)| first + node).collect();
        let mass = |&(node, _): &(u32, f64)| body.mass()[node as usize];
        match *kind {
            Kind::Force(force) => {
                let forces = self.shares().iter().map(|(_, share)| force * *share).collect();
                Loading::dead(nodes, forces, course)
            }
            Kind::Traction(traction) => {
                let forces = self.weights.iter().map(|(_, area)| traction * *area).collect();
                Loading::dead(nodes, forces, course)
            }
            Kind::Acceleration(acceleration) => {
                let forces = self.weights.iter().map(|one| acceleration * mass(one)).collect();
                Loading::dead(nodes, forces, course)
            }
            Kind::Torque(torque) => {
                let shares = self.shares().into_iter().map(|(_, share)| share).collect();
                Loading::torque(nodes, shares, torque, course)
            }
            Kind::Pressure(pressure) => match (&self.faces, body.carried()) {
                (Some(Faces::Carried(triangles)), Some(fine)) => {
                    let mut points: Vec<u32> = triangles.iter().flatten().copied().collect();
                    points.sort_unstable();
                    points.dedup();
                    let place = |point: u32| points.partition_point(|&other| other < point) as u32;
                    let triangles = triangles.iter().map(|face| face.map(place)).collect();
                    let points = fine.weights.some(points.iter().copied(), first);
                    Loading::pressure_on_carried(triangles, points, pressure, course)
                }
                (Some(Faces::Own(faces)), _) => {
                    let moved = faces.iter().map(|face| face.iter().map(|node| first + node).collect());
                    Loading::pressure(moved.collect(), pressure, course)
                }
                _ => unreachable!("a pressure acts on faces"),
            },
            Kind::Centrifugal(rate, about) => {
                let masses = self.weights.iter().map(mass).collect();
                Loading::centrifugal(nodes, Turning { rate, about, masses }, course)
            }
        }
    }
}
