//! How surfaces meet: names of pairs, thicknesses, and bodies that overlap at the start.

use super::choice::check_names;
use super::{KeyPath, Typed};
use crate::reading::captions::quantity;
use crate::reading::collector::{Collector, PathPart, key_path, written};
use crate::reading::words::{count, list, nearest, quoted};
use crate::scene::file::{BodyFile, PairFile, ShapeFile};
use crate::scene::{Scene, SceneBody};
use crate::sim::geometry::overlaps;
use crate::sim::{BodyContact, Contacts, PairContact, Shape, Side};
use glam::DVec3;
use std::collections::BTreeSet;

/// Reports names of obstacles that are not unique, or are those of bodies.
pub(super) fn check_obstacle_names(scene: &Typed<'_>, report: &mut Collector<'_>) {
    let named =
        || (0..).zip(&scene.file.obstacle).map(|(at, one)| (at, one.as_ref().and_then(|one| one.name.as_deref())));
    check_names(
        ["obstacle", "obstacles"],
        named().map(|(at, name)| (key_path!["obstacle", at].to_vec(), name)),
        report,
    );
    let bodies: BTreeSet<_> = scene.file.body.iter().flatten().filter_map(|body| body.name.as_deref()).collect();
    for (at, name) in named().filter_map(|(at, name)| Some((at, name.filter(|name| bodies.contains(name))?))) {
        let message = format!("a body and an obstacle are called {}", quoted(name));
        report.at(&key_path!["obstacle", at, "name"], message, "give the obstacle another name");
    }
}

/// Contact of surfaces; `None` for contact of nodes, or after reporting a mistake.
pub(super) fn resolve(scene: &Typed<'_>, bodies: &[SceneBody], report: &mut Collector<'_>) -> Option<Contacts> {
    if scene.file.meets_by_nodes() {
        check_idle(scene, report);
        return None;
    }
    let typed = scene.file.contact.clone().unwrap_or_default();
    let of_body = |(at, typed): (usize, &Option<BodyFile>)| {
        let typed = typed.as_ref()?;
        if let Some(thickness) = typed.thickness {
            check_thickness(thickness, &bodies[at..=at], &key_path![scene.place(at); "thickness"], report);
        }
        Some(BodyContact { thickness: typed.thickness, itself: typed.self_contact })
    };
    let of_bodies = scene.file.body.iter().enumerate().map(of_body).collect::<Option<Vec<_>>>()?;
    let mut pairs = Vec::new();
    for (at, pair) in typed.pair.iter().enumerate() {
        let path = key_path!["contact", "pair", at].to_vec();
        pairs.extend(resolve_pair(scene, pair, bodies, &pairs, &path, report));
    }
    Some(Contacts { restitution: typed.restitution, friction: typed.friction, bodies: of_bodies, pairs })
}

/// Reports keys that have no effect where nodes alone meet obstacles.
fn check_idle(scene: &Typed<'_>, report: &mut Collector<'_>) {
    let of_contact = ["restitution", "friction", "pair"].map(|key| key_path!["contact", key].to_vec());
    let of_body = |body| ["self_contact", "thickness"].map(|key| key_path![scene.place(body); key].to_vec());
    for path in of_contact.into_iter().chain((0..scene.file.body.len()).flat_map(of_body)) {
        if report.is_typed(&path) {
            let message = format!("`{}` has no effect, as `contact.rule` is \"nodes\"", written(&path));
            report.at_key(&path, message, "remove it, or write contact.rule = \"surfaces\"");
        }
    }
}

/// Reports a thickness (m) larger than a cell of some bodies.
fn check_thickness(thickness: f64, bodies: &[SceneBody], path: &[PathPart<'_>], report: &mut Collector<'_>) {
    let Some(finest) = bodies.iter().min_by(|one, other| one.side.total_cmp(&other.side)) else { return };
    if thickness > finest.side {
        let [found, cell] = [thickness, finest.side].map(|length| quantity(length, "m"));
        let message = format!("the thickness {found} is larger than a cell of {}, {cell}", finest.in_words());
        report.at(path, message, format!("expected at most {cell}"));
    }
}

/// A pair; `None` after reporting a mistake in it.
fn resolve_pair(
    scene: &Typed<'_>,
    typed: &PairFile,
    bodies: &[SceneBody],
    earlier: &[PairContact],
    path: &KeyPath,
    report: &mut Collector<'_>,
) -> Option<PairContact> {
    let of = [0, 1].map(|at| side(scene, &typed.of[at], &key_path![path; "of", at], report));
    let of = [of[0]?, of[1]?];
    let [one, other] = [0, 1].map(|at| quoted(&typed.of[at]));
    let mut wrong = |message: String, help: &str| {
        report.at(&key_path![path; "of"], message, help);
        None
    };
    if of[0] == of[1] {
        return wrong(
            format!("this is a pair of {one} with itself"),
            "a body with `self_contact = true` meets itself, with the restitution and friction of [contact]",
        );
    }
    if let [Side::Obstacle(_), Side::Obstacle(_)] = of {
        return wrong(format!("{one} and {other} are obstacles, which do not meet"), "name a body");
    }
    let is_same = |pair: &PairContact| pair.of == of || pair.of == [of[1], of[0]];
    if let Some(first) = earlier.iter().position(is_same) {
        let message = format!("{one} and {other} are a pair already, `contact.pair[{first}]`");
        return wrong(message, "keep one of the two");
    }
    if typed.restitution.is_none() && typed.friction.is_none() && typed.thickness.is_none() {
        let message = format!("the pair of {one} and {other} changes nothing");
        return wrong(message, "give it a `restitution`, a `friction` or a `thickness`, or remove it");
    }
    if let Some(thickness) = typed.thickness {
        let of_pair: Vec<_> = of
            .iter()
            .filter_map(|side| if let Side::Body(at) = side { bodies.get(*at) } else { None })
            .cloned()
            .collect();
        check_thickness(thickness, &of_pair, &key_path![path; "thickness"], report);
    }
    let PairFile { restitution, friction, thickness, .. } = *typed;
    Some(PairContact { of, restitution, friction, thickness })
}

/// The body or obstacle of a name.
fn side(scene: &Typed<'_>, name: &str, path: &[PathPart<'_>], report: &mut Collector<'_>) -> Option<Side> {
    let bodies = scene.file.body.iter().map(|body| body.as_ref().and_then(|body| body.name.as_deref()));
    let obstacles = scene.file.obstacle.iter().map(|one| one.as_ref().and_then(|one| one.name.as_deref()));
    let sides = bodies.enumerate().map(|(at, name)| (name, Side::Body(at)));
    let sides: Vec<_> = sides.chain(obstacles.enumerate().map(|(at, name)| (name, Side::Obstacle(at)))).collect();
    let Some(&(_, side)) = sides.iter().find(|(known, _)| *known == Some(name)) else {
        let names: Vec<_> = sides.iter().filter_map(|(name, _)| *name).collect();
        let help = match nearest(name, &names) {
            Some(near) => format!("did you mean {}?", quoted(near)),
            None if names.is_empty() => "no body and no obstacle has a `name`; give them one".to_owned(),
            None => format!("the names are {}", list(&names, "and", quoted)),
        };
        report.at(path, format!("there is no body or obstacle {}", quoted(name)), help);
        return None;
    };
    if let Side::Obstacle(at) = side
        && let Some(ShapeFile::Floor { .. } | ShapeFile::Plate { .. }) =
            scene.file.obstacle[at].as_ref().map(|obstacle| &obstacle.shape)
    {
        let message = format!("{} is a half-space, which nodes meet, all in the same way", quoted(name));
        report.at(path, message, "give the obstacle its own `restitution` and `friction`");
        return None;
    }
    Some(side)
}

/// Warns of models whose elements break, where surfaces can meet.
pub(super) fn warn_of_breaking(scene: &Scene, report: &mut Collector<'_>) {
    let Some(contacts) = &scene.contacts else { return };
    let has_extent = scene.obstacles.iter().any(|one| !matches!(one.shape, Shape::Floor { .. } | Shape::Plate { .. }));
    for (at, run) in scene.runs.iter().enumerate() {
        let meets_itself = |&body: &usize| contacts.bodies.get(body).is_some_and(|body| body.itself);
        if !has_extent && run.of.len() < 2 && !run.of.iter().any(meets_itself) {
            continue;
        }
        let by_name =
            run.of.iter().map(|&body| key_path!["run", at, "models", scene.bodies[body].name.as_str()].to_vec());
        let models = by_name.chain([key_path!["run", at, "model"].to_vec()]);
        for path in models.map(|model| key_path![model; "breaks_at"]) {
            if !report.is_typed(&path) {
                continue;
            }
            let message =
                format!("elements of {} break, but the surface that meets others stays whole", quoted(&run.name));
            report.warn(&path, message, "write contact.rule = \"nodes\" if others shall go through a break");
        }
    }
}

/// The share of a cell by which bodies, and boxes, are moved to see whether they touch: half of the distance that they keep.
pub(super) const CLEARANCE: f64 = 0.025;

/// Reports bodies that overlap or touch at the start of a run: contact keeps surfaces apart, but cannot part them.
pub(super) fn check_starts(scene: &Scene, typed: &Typed<'_>, report: &mut Collector<'_>) {
    let mut found = BTreeSet::new();
    let mut known: BTreeSet<&[usize]> = BTreeSet::new();
    let simulated = scene.runs.iter().filter(|run| run.recording.is_none() && run.of.len() > 1);
    for run in simulated.filter(|run| known.insert(run.of.as_slice())) {
        let side = run.of.iter().map(|&body| scene.bodies[body].side).fold(f64::INFINITY, f64::min);
        let mut add = |position: &[DVec3]| {
            let pairs = overlaps(&run.bodies, position, |_| true);
            found.extend(pairs.map(|pair| pair.map(|body| run.of[body])));
        };
        add(&run.initial.position);
        // The numbers of any two bodies differ in a bit: those with it are moved, and the others are not. Whichever way two bodies
        // touch, one of these motions drives them into each other.
        for bit in 0..usize::BITS - (run.of.len() - 1).leading_zeros() {
            for way in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
                let mut moved = run.initial.position.clone();
                for body in (0..run.of.len()).filter(|body| body >> bit & 1 == 1) {
                    moved[run.bodies.nodes(body)].iter_mut().for_each(|node| *node += CLEARANCE * side * way);
                }
                add(&moved);
            }
        }
    }
    let Some(&[first, second]) = found.first() else { return };
    let [one, other] = [first, second].map(|body| quoted(&scene.bodies[body].name));
    let more = match found.len() - 1 {
        0 => String::new(),
        1 => ", and so does another pair".to_owned(),
        pairs => format!(", and so do {} other pairs", count(pairs as u128)),
    };
    let gap = 2.0 * CLEARANCE * scene.bodies[first].side.max(scene.bodies[second].side);
    let help = format!(
        "move one of them, with `offset` or `lowest`, until {} lie between them, or write contact.rule = \"nodes\"",
        quantity(gap, "m")
    );
    let message = format!("{one} and {other} overlap or touch at the start{more}: contact cannot part them");
    report.at(&typed.place(second), message, help);
}
