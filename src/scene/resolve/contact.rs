//! How surfaces meet: names of pairs, thicknesses, and bodies that overlap at the start.

use super::Typed;
use super::choice::{Choice, check_names};
use super::obstacles::shape_name;
use crate::reading::captions::quantity;
use crate::reading::collector::{Collector, Here};
use crate::reading::words::{count, list, nearest, quoted};
use crate::scene::file::{BodyFile, PairFile, ShapeFile};
use crate::scene::{Run, Scene, SceneBody};
use crate::sim::{BodyContact, Contacts, Obstacle, Overlap, PairContact, Shape, Side, Surfaces};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Reports names of obstacles that are not unique, or are those of bodies.
pub(super) fn check_obstacle_names(scene: &Typed<'_>) {
    let named = || scene.each("obstacle", &scene.file.obstacle).map(|(here, one)| (here, one.name.as_deref()));
    check_names(["obstacle", "obstacles"], named());
    let bodies: BTreeSet<_> = scene.file.body.iter().flatten().filter_map(|body| body.name.as_deref()).collect();
    for (here, name) in named().filter_map(|(here, name)| Some((here, name.filter(|name| bodies.contains(name))?))) {
        let message = format!("a body and an obstacle are called {}", quoted(name));
        here.to("name").wrong(message, "give the obstacle another name");
    }
}

/// Contact of surfaces; `None` for contact of nodes, or after reporting a mistake.
pub(super) fn resolve(scene: &Typed<'_>, bodies: &[SceneBody]) -> Option<Contacts> {
    let contact = scene.report.to("contact");
    if scene.file.meets_by_nodes() {
        check_idle(scene, &contact);
        return None;
    }
    check_friction_of(scene);
    let typed = scene.file.contact.clone().unwrap_or_default();
    let of_body = |(at, typed): (usize, &Option<BodyFile>)| {
        let typed = typed.as_ref()?;
        if let Some(thickness) = typed.thickness {
            check_thickness(thickness, bodies[at..=at].iter(), &scene.place(at).to("thickness"));
        }
        Some(BodyContact { thickness: typed.thickness, itself: typed.self_contact })
    };
    let of_bodies = scene.file.body.iter().enumerate().map(of_body).collect::<Option<Vec<_>>>()?;
    let mut pairs = Vec::new();
    for (at, pair) in typed.pair.iter().enumerate() {
        pairs.extend(resolve_pair(scene, pair, bodies, &pairs, &contact.to("pair").to(at)));
    }
    Some(Contacts { restitution: typed.restitution, friction: typed.friction, bodies: of_bodies, pairs })
}

/// Reports keys that have no effect where nodes alone meet obstacles.
fn check_idle(scene: &Typed<'_>, contact: &Here<'_>) {
    let of_contact = ["restitution", "friction", "separate", "pair"].map(|key| contact.to(key));
    let of_body = |body| ["self_contact", "thickness"].map(|key| scene.place(body).to(key));
    for here in of_contact.into_iter().chain((0..scene.file.body.len()).flat_map(of_body)).filter(Here::is_typed) {
        let message = format!("`{here}` has no effect, as `contact.rule` is \"nodes\"");
        here.wrong_key(message, "remove it, or write contact.rule = \"surfaces\"");
    }
}

/// Reports `friction_of` where surfaces meet an obstacle.
fn check_friction_of(scene: &Typed<'_>) {
    for (here, obstacle) in scene.each("obstacle", &scene.file.obstacle) {
        let is_met_by_nodes = matches!(obstacle.shape, ShapeFile::Floor { .. } | ShapeFile::Plate { .. });
        if here.to("friction_of").is_typed() && !is_met_by_nodes {
            let message =
                "`friction_of` has no effect, as surfaces meet this obstacle: their friction acts on the path";
            here.to("friction_of").wrong_key(message, "remove it, or write contact.rule = \"nodes\"");
        }
    }
}

/// Reports pairs of bodies and obstacles that are in no run together.
pub(super) fn check_pairs(scene: &Scene, contacts: &Contacts, report: &Collector<'_>) {
    for (at, PairContact { of, .. }) in contacts.pairs.iter().enumerate() {
        let bodies: Vec<_> =
            of.iter().filter_map(|side| if let Side::Body(at) = side { Some(*at) } else { None }).collect();
        let is_in = |run: &Run| run.recording.is_none() && bodies.iter().all(|body| run.of.contains(body));
        if !scene.runs.iter().any(is_in) {
            let names: Vec<_> = bodies.iter().map(|&body| scene.bodies[body].name.as_str()).collect();
            let names = list(&names, "and", quoted);
            let message = format!("the pair changes nothing, as no run simulates {names}");
            let here = report.to("contact").to("pair").to(at).to("of");
            here.wrong(message, "name what is in one run, or remove the pair");
        }
    }
}

/// Reports thicknesses of bodies whose surface meets nothing: their nodes meet half-spaces.
pub(super) fn check_idle_thickness(scene: &Scene, contacts: &Contacts, typed: &Typed<'_>) {
    for (at, (body, own)) in scene.bodies.iter().zip(&contacts.bodies).enumerate() {
        let meets = |run: &Run| run.recording.is_none() && run.of.len() > 1 && run.of.contains(&at);
        let counts = scene.has_solids() || own.itself || body.body.carried().is_some() || scene.runs.iter().any(meets);
        if own.thickness.is_some() && !counts {
            let message = format!(
                "the thickness of {} changes nothing: nothing meets its surface, and floors and plates meet its nodes",
                body.in_words()
            );
            typed.place(at).to("thickness").wrong(message, "remove it");
        }
    }
}

/// Reports a thickness (m) larger than a cell of some bodies.
fn check_thickness<'b>(thickness: f64, bodies: impl Iterator<Item = &'b SceneBody>, here: &Here<'_>) {
    let Some(finest) = bodies.min_by(|one, other| one.side.total_cmp(&other.side)) else { return };
    if thickness > finest.side {
        let [found, cell] = [thickness, finest.side].map(|length| quantity(length, "m"));
        let message = format!("the thickness {found} is larger than a cell of {}, {cell}", finest.in_words());
        here.wrong(message, format!("expected at most {cell}"));
    }
}

/// A pair; `None` after reporting a mistake in it.
fn resolve_pair(
    scene: &Typed<'_>,
    typed: &PairFile,
    bodies: &[SceneBody],
    earlier: &[PairContact],
    here: &Here<'_>,
) -> Option<PairContact> {
    let of = [0, 1].map(|at| side(scene, &typed.of[at], &here.to("of").to(at)));
    let of = [of[0]?, of[1]?];
    let [one, other] = [0, 1].map(|at| quoted(&typed.of[at]));
    let wrong = |message: String, help: &str| {
        here.to("of").wrong(message, help);
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
        let of_pair = of.iter().filter_map(|side| if let Side::Body(at) = side { bodies.get(*at) } else { None });
        check_thickness(thickness, of_pair, &here.to("thickness"));
    }
    let PairFile { restitution, friction, thickness, .. } = *typed;
    Some(PairContact { of, restitution, friction, thickness })
}

/// The body or obstacle of a name.
fn side(scene: &Typed<'_>, name: &str, here: &Here<'_>) -> Option<Side> {
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
        here.wrong(format!("there is no body or obstacle {}", quoted(name)), help);
        return None;
    };
    if let Side::Obstacle(at) = side
        && let Some(ShapeFile::Floor { .. } | ShapeFile::Plate { .. }) =
            scene.file.obstacle[at].as_ref().map(|obstacle| &obstacle.shape)
    {
        let message = format!("{} is a half-space, which all bodies meet in the same way", quoted(name));
        here.wrong(message, "give the obstacle its own `restitution` and `friction`");
        return None;
    }
    Some(side)
}

/// Whether surfaces can meet in a run: those of several bodies, of an obstacle, or of a body with itself.
fn can_meet(scene: &Scene, run: &Run, contacts: &Contacts) -> bool {
    run.of.len() > 1 || scene.has_solids() || run.contacts(contacts).bodies.iter().any(|body| body.itself)
}

/// Warns of models whose elements break, where surfaces can meet.
pub(super) fn warn_of_breaking(scene: &Scene, report: &Collector<'_>) {
    let Some(contacts) = &scene.contacts else { return };
    for (at, run) in scene.runs.iter().enumerate().filter(|(_, run)| can_meet(scene, run, contacts)) {
        let here = report.to("run").to(at);
        let by_name = run.of.iter().map(|&body| here.to("models").to(scene.bodies[body].name.as_str()));
        let models = by_name.chain([here.to("model")]);
        for place in models.map(|model| model.to("breaks_at")).filter(Here::is_typed) {
            let message =
                format!("elements of {} break, but the surface that meets others stays whole", quoted(&run.name));
            place.warn(message, "write contact.rule = \"nodes\" if others shall go through a break");
        }
    }
}

/// Warns of steps in which nodes move so far relative to others, or to obstacles, at the speeds of the start and of paths, that features may pass
/// each other sideways.
pub(super) fn warn_of_ways(scene: &Scene, contacts: &Contacts, typed: &Typed<'_>) {
    /// The longest way in a step, in cells: above it some facets of blocks that met at random crossed for a few steps (`docs/contact.md`).
    const LONGEST: f64 = 0.5;
    let is_solid = |one: &&Obstacle| !one.shape.is_half_space();
    let stepped = scene.runs.iter().enumerate().filter(|(_, run)| run.recording.is_none() && run.tolerance.is_none());
    for (at, run) in stepped.filter(|(_, run)| can_meet(scene, run, contacts)) {
        // Obstacles that rest are there as well.
        let speeds = run.initial.velocity.iter().copied().chain(scene.has_solids().then_some(DVec3::ZERO));
        let [low, high] =
            speeds.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], speed| [low.min(speed), high.max(speed)]);
        let side = run.of.iter().map(|&body| scene.bodies[body].side).fold(f64::INFINITY, f64::min);
        let size = run.of.iter().map(|&body| scene.bodies[body].body.extent()).fold(0.0, f64::max);
        // What a path turns is not larger than the largest body.
        let paths = run
            .grips
            .iter()
            .map(|grip| &grip.motion)
            .chain(scene.obstacles.iter().filter(is_solid).map(|one| &one.motion));
        let on_path = paths.map(|path| path.greatest_speed(0.5 * size)).fold(0.0, f64::max);
        let speed = (high - low).length().max(on_path);
        let when = if on_path < speed { "at the start" } else { "along its path" };
        let most = LONGEST * side / speed;
        if run.step > most {
            let [way, cell, speed] =
                [(speed * run.step, "m"), (side, "m"), (speed, "m/s")].map(|(it, unit)| quantity(it, unit));
            let message = format!(
                "nodes of {} move {way} in a step relative to others, at {speed} {when}, and a cell has {cell}: surfaces may cross sideways",
                quoted(&run.name)
            );
            typed.of_run(at, "step").warn(message, format!("use a step of at most {most:.3e} s"));
        }
    }
}

/// Moves bodies apart that overlap or touch at the start, where the scene says so. Bodies meet those of their runs.
pub(super) fn separate(
    scene: &Typed<'_>,
    bodies: &mut [SceneBody],
    obstacles: &[Obstacle],
    contacts: &Contacts,
    choices: &[Option<Choice<'_>>],
) {
    if !scene.file.separates() {
        return;
    }
    let of: Vec<_> = bodies.iter().map(|body| Arc::clone(&body.body)).collect();
    let mut position: Vec<_> = bodies.iter().flat_map(|body| body.initial.position.iter().copied()).collect();
    let simulated = || choices.iter().flatten().filter(|choice| !choice.models.is_empty());
    let meets = |pair: [usize; 2]| simulated().any(|choice| pair.iter().all(|body| choice.of.contains(body)));
    let ways = Surfaces::new(&of, obstacles, contacts).separate(&mut position, 0.0, meets);
    let mut moved = position.into_iter();
    for (body, way) in bodies.iter_mut().zip(ways) {
        body.separated = way;
        body.initial.position.iter_mut().zip(&mut moved).for_each(|(node, to)| *node = to);
    }
}

/// What overlaps or touches at the start of runs, by the places of two bodies in the scene, or of a body and an obstacle, which are
/// numbered after bodies: the deepest of each two. Of a node and its body the body is named twice.
fn overlaps(scene: &Scene, obstacles: &[Obstacle], contacts: &Contacts) -> BTreeMap<[usize; 2], Overlap> {
    let mut found = BTreeMap::new();
    let mut known: BTreeSet<&[usize]> = BTreeSet::new();
    for run in scene.runs.iter().filter(|run| run.recording.is_none() && known.insert(run.of.as_slice())) {
        let surfaces = Surfaces::new(run.bodies.bodies(), obstacles, &run.contacts(contacts));
        for overlap in surfaces.overlaps(&run.initial.position, 0.0, |_| true) {
            let number = |side: Side| match side {
                Side::Body(body) => run.of[body],
                Side::Obstacle(number) => scene.bodies.len() + number,
            };
            let body = run.bodies.body_of_node(overlap.node);
            let node = overlap.node - run.bodies.nodes(body).start;
            let own = Overlap { of: [Side::Body(run.of[body]); 2], node, ..overlap };
            let deepest = found.entry(overlap.of.map(number)).or_insert(own);
            if own.depth > deepest.depth {
                *deepest = own;
            }
        }
    }
    found
}

/// The words for all pairs but one.
fn and_others(pairs: usize) -> String {
    match pairs - 1 {
        0 => String::new(),
        1 => ", and so does another pair".to_owned(),
        pairs => format!(", and so do {} other pairs", count(pairs as u128)),
    }
}

/// Why contact does not bear it.
fn why(overlap: &Overlap) -> String {
    match overlap.depth {
        ..0.0 => format!(
            "contact keeps them {} apart, and the first step would throw them there",
            quantity(overlap.keeps, "m")
        ),
        _ => "contact cannot part them".to_owned(),
    }
}

/// What else than moving a body helps, with the punctuation before it.
fn or_separate(overlap: &Overlap, typed: &Typed<'_>) -> &'static str {
    match overlap.depth {
        _ if typed.file.separates() => "; `contact.separate` did not part them",
        ..0.0 => ", write contact.separate = true, or give their `contact.pair` a smaller `thickness`",
        _ => ", or write contact.separate = true",
    }
}

/// Warns of bodies that overlap at the start of a run, where nodes alone meet obstacles.
pub(super) fn warn_of_overlaps(scene: &Scene, typed: &Typed<'_>) {
    let mut found = overlaps(scene, &[], &Contacts::default());
    found.retain(|_, overlap| overlap.depth > 0.0);
    let Some((&[first, second], _)) = found.first_key_value() else { return };
    let [one, other] = [first, second].map(|body| quoted(&scene.bodies[body].name));
    let more = and_others(found.len());
    let message = format!("{one} and {other} overlap at the start{more}: bodies go through each other");
    typed.place(second).warn(message, "move one of them, with `offset` or `lowest`, unless they may overlap");
}

/// Reports bodies that overlap or touch each other, or obstacles, at the start of a run: contact keeps surfaces apart, but cannot part
/// them.
pub(super) fn check_starts(scene: &Scene, contacts: &Contacts, typed: &Typed<'_>) {
    let found = overlaps(scene, &scene.obstacles, contacts);
    let pairs = found.keys().filter(|of| of[1] < scene.bodies.len()).count();
    let of_bodies = found.iter().find(|(of, _)| of[1] < scene.bodies.len());
    if let Some((&[first, second], overlap)) = of_bodies {
        let [one, other] = [first, second].map(|body| quoted(&scene.bodies[body].name));
        let more = and_others(pairs);
        let Overlap { node, depth, of: [own, _], .. } = *overlap;
        let of_node = match own {
            Side::Body(body) if first != second => format!(" of {}", quoted(&scene.bodies[body].name)),
            _ => String::new(),
        };
        let (reach, is_itself) = (quantity(depth, "m"), first == second);
        let what = match depth {
            0.0 if is_itself => format!("{} touches itself", scene.bodies[first].in_words()),
            _ if is_itself => format!("{} reaches {reach} into itself", scene.bodies[first].in_words()),
            0.0 => format!("{one} and {other} touch"),
            ..0.0 => format!("{one} and {other} are {} apart", quantity(-depth, "m")),
            _ => format!("{one} and {other} reach {reach} into each other"),
        };
        let message = format!("{what} at the start, at node {node}{of_node}{more}: {}", why(overlap));
        let help = match is_itself {
            true => "move these nodes apart, join them if they are one, or remove `self_contact`".to_owned(),
            false => format!("move one of them, with `offset` or `lowest`{}", or_separate(overlap, typed)),
        };
        typed.place(second).wrong(message, help);
    }
    for (&[body, obstacle], overlap) in found.iter().filter(|(of, _)| of[1] >= scene.bodies.len()) {
        let number = obstacle - scene.bodies.len();
        let (of, shape) = (scene.bodies[body].in_words(), &scene.obstacles[number].shape);
        let (name, node) = (shape_name(shape), overlap.node);
        let reach = quantity(overlap.depth, "m");
        let message = match shape {
            _ if shape.is_half_space() => {
                format!("{of} starts inside this {name}: node {node} lies {reach} below its surface")
            }
            _ if overlap.depth == 0.0 => format!("{of} touches this {name} at the start, at node {node}"),
            _ if overlap.depth < 0.0 => {
                let apart = quantity(-overlap.depth, "m");
                format!("{of} is {apart} from this {name} at the start, at node {node}: {}", why(overlap))
            }
            _ => format!("{of} reaches {reach} into this {name} at the start, at node {node}"),
        };
        let help = match shape {
            Shape::Floor { .. } => {
                format!(
                    "move the floor, set the body on it with its `lowest` or `offset`{}",
                    or_separate(overlap, typed)
                )
            }
            _ => {
                format!("move one of them{}; a path can move the obstacle there later", or_separate(overlap, typed))
            }
        };
        typed.report.to("obstacle").to(number).wrong(message, help);
    }
}
