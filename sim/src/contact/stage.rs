//! Contact of surfaces at the end of a step: which pairs may meet, what touches, and the impulses in a fixed order.

use super::cross::crossings;
use super::end::End;
use super::extent::Extent;
use super::features::Placed;
use super::ground::Grounds;
use super::pair::Pair;
use super::places::Places;
use super::rule::{Law, Moved};
use super::shown::{Seen, Shown};
use super::surface::Surface;
use super::{Contacts, Impulses, Obstacle, Side, Source};
use crate::crew::Crew;
use crate::motion::Interval;
use crate::part::Part;
use crate::state::Nodes;
use glam::DVec3;
use std::sync::{Mutex, PoisonError};

/// The surfaces of a world, and what is known of their places. What is known only saves work: it changes no bit of what a step does.
#[derive(Debug)]
pub(crate) struct Stage {
    contacts: Contacts,
    /// Of the bodies, then of obstacles with an extent.
    pub(super) surfaces: Vec<Surface>,
    bodies: usize,
    obstacles: Vec<Solid>,
    /// Positions of all nodes at rest (m).
    pub(super) rest: Vec<DVec3>,
    inverse_mass: Vec<f64>,
    /// The nodes of the surfaces of bodies, each once.
    nodes: Vec<u32>,
    known: Mutex<Known>,
    pub(super) grounds: Mutex<Grounds>,
}

/// An obstacle with an extent, and its points at the start (m).
#[derive(Clone, Debug)]
struct Solid {
    /// Its number among all obstacles.
    number: usize,
    obstacle: Obstacle,
    points: Vec<DVec3>,
    /// The greatest speed of its points (m/s).
    greatest_speed: f64,
}

/// What is known of the last step.
#[derive(Clone, Debug, Default)]
struct Known {
    /// Positions at the start of the last step, of nodes and of points of obstacles (m); empty if nothing is known.
    last: Vec<DVec3>,
    /// Points of obstacles at the start and at the end of the step, and their velocities.
    obstacles: [Vec<DVec3>; 3],
    /// How far each surface has moved since the last step, and in this one.
    moved: [Vec<Way>; 2],
    pairs: Vec<Pair>,
    /// The way (m) of any two surfaces until others than the pairs may meet.
    left: f64,
    shown: Vec<Shown>,
    inverse_mass: Vec<f64>,
    /// The nodes that grips hold, in rising order, and the grip of each, if impulses are asked for.
    held: Vec<[usize; 2]>,
    /// The velocities at the start of the step minus those at its end (m/s), of nodes of surfaces.
    slowed: Vec<DVec3>,
    /// Whether each node was changed in this step.
    is_changed: Vec<bool>,
    /// Boxes around the surfaces, and the order in which they begin, while bodies are asked whether they can go alone.
    extents: Vec<Extent>,
    order: Vec<usize>,
}

/// How far the points of a surface have moved: by `drift`, and from there by at most `spread` (m).
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    drift: DVec3,
    spread: f64,
}

impl Way {
    fn relative(self, other: Self) -> f64 {
        (self.drift - other.drift).length() + self.spread + other.spread
    }

    fn length(self) -> f64 {
        self.drift.length() + self.spread
    }
}

impl Clone for Stage {
    fn clone(&self) -> Self {
        let Self { contacts, surfaces, bodies, obstacles, rest, inverse_mass, nodes, grounds, .. } = self;
        Self {
            contacts: contacts.clone(),
            surfaces: surfaces.clone(),
            bodies: *bodies,
            obstacles: obstacles.clone(),
            rest: rest.clone(),
            inverse_mass: inverse_mass.clone(),
            nodes: nodes.clone(),
            known: Mutex::default(),
            grounds: Mutex::new(grounds.lock().unwrap_or_else(PoisonError::into_inner).clone()),
        }
    }
}

impl Stage {
    /// The surfaces of bodies and obstacles; `None` if no two of them can meet.
    pub(crate) fn new(contacts: &Contacts, parts: &[Part], obstacles: &[Obstacle]) -> Option<Self> {
        let dimension = parts.first()?.body.dimension;
        let rest: Vec<DVec3> = parts.iter().flat_map(|part| part.body.rest.iter().copied()).collect();
        let inverse_mass = parts.iter().flat_map(|part| part.body.mass.iter().map(|mass| mass.recip())).collect();
        let mut surfaces = Vec::new();
        for part in parts {
            let mut surface = Surface::of(&part.body, part.nodes.start as u32);
            let own = contacts.bodies.get(part.number).and_then(|body| body.thickness);
            surface.thickness = own.unwrap_or(surface.thickness);
            surfaces.push(surface);
        }
        let bodies = surfaces.len();
        let mut nodes: Vec<u32> = surfaces.iter().flat_map(|surface| surface.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        let mut solids = Vec::new();
        let mut first = rest.len() as u32;
        for (number, obstacle) in obstacles.iter().enumerate() {
            let Some((surface, points)) = obstacle.shape.surface_of(dimension, first) else { continue };
            first += points.len() as u32;
            surfaces.push(surface);
            let far = points.iter().fold(0.0, |most: f64, point| most.max(point.distance(obstacle.pivot)));
            let greatest_speed = obstacle.motion.greatest_speed(far);
            solids.push(Solid { number, obstacle: obstacle.clone(), points, greatest_speed });
        }
        let grounds = Grounds::new(parts, &surfaces, obstacles);
        let has_grounds = !grounds.is_empty();
        let meets_itself = contacts.bodies.iter().any(|body| body.itself);
        let stage = Self {
            contacts: contacts.clone(),
            surfaces,
            bodies,
            obstacles: solids,
            rest,
            inverse_mass,
            nodes,
            known: Mutex::default(),
            grounds: Mutex::new(grounds),
        };
        (has_grounds || meets_itself || stage.surfaces.len() > 1).then_some(stage)
    }

    pub(super) fn side(&self, surface: usize) -> Side {
        match surface.checked_sub(self.bodies) {
            None => Side::Body(surface),
            Some(solid) => Side::Obstacle(self.obstacles[solid].number),
        }
    }

    /// How two surfaces meet; `None` if they do not.
    fn law(&self, one: usize, other: usize) -> Option<Law> {
        if one >= self.bodies || one == other && !self.contacts.bodies.get(one).is_some_and(|body| body.itself) {
            return None;
        }
        let Contacts { restitution, friction, pairs, .. } = &self.contacts;
        let solid = other.checked_sub(self.bodies).map(|solid| &self.obstacles[solid].obstacle);
        let gap = self.surfaces[one].thickness + self.surfaces[other].thickness;
        let usual = solid.map_or([*restitution, *friction], |solid| [solid.restitution, solid.friction]);
        let own = pairs.iter().find(|pair| {
            let ([a, b], sides) = (pair.of, [self.side(one), self.side(other)]);
            [a, b] == sides || [b, a] == sides
        });
        let law = Law { gap, restitution: usual[0], friction: usual[1] };
        Some(own.map_or(law, |own| Law {
            restitution: own.restitution.unwrap_or(law.restitution),
            friction: own.friction.unwrap_or(law.friction),
            gap: own.thickness.map_or(law.gap, |gap| gap + solid.map_or(0.0, |_| self.surfaces[other].thickness)),
        }))
    }

    /// The nodes of the surfaces of bodies, in their order.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// A bound of the gaps of all pairs (m).
    fn widest_gap(&self) -> f64 {
        let thickest = self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.thickness));
        let own = self.contacts.pairs.iter().filter_map(|pair| pair.thickness).fold(thickest, f64::max);
        thickest + own
    }

    /// Corrects positions and velocities at the end of a step. `held` are the nodes that grips hold, each with the number of its grip: they
    /// stay as they are.
    pub(crate) fn resolve(&self, mut end: End<'_>, held: impl Iterator<Item = [usize; 2]>, crew: &Crew) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let (known, interval) = (&mut *known, end.interval);
        self.place_obstacles(interval, &mut known.obstacles);
        known.inverse_mass.clone_from(&self.inverse_mass);
        known.held.clear();
        for [grip, node] in held {
            known.inverse_mass[node] = 0.0;
            known.held.extend(end.impulses.map(|_| [node, grip]));
        }
        known.held.sort_unstable();
        known.is_changed.clear();
        known.is_changed.resize(end.position.len(), false);
        known.slowed.resize(end.position.len(), DVec3::ZERO);
        let slow = |slowed: &mut [DVec3], nodes: &[u32], end: &End<'_>| {
            for node in nodes.iter().map(|&node| node as usize) {
                slowed[node] = end.before.velocity[node] - end.velocity[node];
            }
        };
        slow(&mut known.slowed, &self.nodes, &end);
        let mut grounds = self.grounds.lock().unwrap_or_else(PoisonError::into_inner);
        let masses = (&known.inverse_mass[..], &known.held[..]);
        grounds.resolve(&self.surfaces, &mut end, masses, &known.slowed, &mut known.is_changed);
        slow(&mut known.slowed, end.changed, &end);
        let End { before, position, velocity, timing, changed, impulses, .. } = end;
        let [start, moved, speed] = &known.obstacles;
        let start = Places { nodes: before.position, obstacles: start };
        let ended = Places { nodes: position, obstacles: moved };
        let is_new = known.last.is_empty();
        if is_new {
            known.pairs.clear();
            known.left = f64::NEG_INFINITY;
        } else {
            let (nodes, obstacles) = known.last.split_at(position.len());
            self.ways(&Places { nodes, obstacles }, &start, &mut known.moved[0]);
        }
        known.last.clear();
        known.last.extend(before.position.iter().chain(start.obstacles));
        self.ways(&start, &ended, &mut known.moved[1]);
        if is_new {
            known.moved[0] = vec![Way::default(); self.surfaces.len()];
        }
        let longest = |ways: &[Way]| ways.iter().fold(0.0, |most: f64, way| most.max(way.length()));
        let [since, ahead] = [0, 1].map(|at| longest(&known.moved[at]));
        known.left -= 2.0 * since;
        if known.left < 4.0 * ahead || known.left.is_nan() {
            known.left = self.choose(&start, ahead, &mut known.pairs);
        }
        known.shown.resize(self.surfaces.len(), Shown::default());
        for (shown, way) in known.shown.iter_mut().zip(&known.moved[0]) {
            shown.go(way.spread);
        }
        if is_new {
            known.shown.iter_mut().for_each(Shown::forget);
        }
        for surface in known.pairs.iter().flat_map(|pair| pair.of) {
            known.shown[surface].place(&self.surfaces[surface], &start);
        }
        let seen = Seen {
            surfaces: &self.surfaces,
            rest: Places { nodes: &self.rest, obstacles: &[] },
            start: &known.shown,
            drag: &|surface, at, out| self.drag(surface, interval, at, out),
        };
        let [since, ahead] = &known.moved;
        let relative = |ways: &[Way], [one, other]: [usize; 2]| ways[one].relative(ways[other]);
        crew.each(&mut known.pairs, |pair| {
            let ahead = relative(ahead, pair.of);
            pair.go(&seen, relative(since, pair.of), ahead);
            pair.look(&seen, ahead);
        });
        let obstacles = [&moved[..], &speed[..]];
        let (inverse_mass, is_changed) = (&known.inverse_mass[..], &mut known.is_changed[..]);
        let (step, slowed) = (interval.step, &known.slowed[..]);
        let mut nodes =
            Moved { inverse_mass, position, velocity, slowed, obstacles, step, timing, is_changed, changed };
        let points = known.pairs.iter().map(|pair| (pair, &pair.touches.of_points));
        let edges = known.pairs.iter().map(|pair| (pair, &pair.touches.of_edges));
        for (pair, touches) in points.chain(edges) {
            for touch in touches {
                let [first, last] = touch.terms.map(|at| at as usize);
                let terms = &pair.touches.terms[first..last];
                match impulses {
                    None => drop(nodes.resolve(pair.law, touch, terms)),
                    Some(impulses) => {
                        let second = self.first_node(pair.of[1]);
                        let told = nodes.resolve_and_tell(pair.law, touch, terms, second);
                        let Some((sums, impulse)) = told else { continue };
                        self.tell(impulses, interval.end, pair.of, sums);
                        for (grip, node, changes) in nodes.holding(&known.held, terms, impulse) {
                            let on = pair.of[usize::from(node >= second)];
                            impulses.feel_surface(interval.end, Source::Grip(grip), on, changes);
                        }
                    }
                }
            }
        }
    }

    /// The first node of a surface; of obstacles the number after those of nodes.
    pub(super) fn first_node(&self, surface: usize) -> u32 {
        let nodes = self.surfaces.get(..self.bodies).and_then(|bodies| bodies.get(surface)).map(|body| &body.nodes);
        nodes.and_then(|nodes| nodes.first().copied()).unwrap_or(self.rest.len() as u32)
    }

    /// Adds what the sides of a pair have got in a step that ends at a time (s). A body exerts nothing on itself.
    fn tell(&self, impulses: &Impulses, time: f64, [one, other]: [usize; 2], [on_one, on_other]: [[DVec3; 2]; 2]) {
        if one != other {
            impulses.feel_surface(time, self.side(other).into(), one, on_one);
        }
        if let (true, Side::Body(body)) = (one != other, self.side(other)) {
            impulses.feel_surface(time, self.side(one).into(), body, on_other);
        }
    }

    /// Writes where the points of obstacles are at the start and at the end of a step, and their velocities in it.
    pub(super) fn place_obstacles(&self, interval: Interval, [start, end, speed]: &mut [Vec<DVec3>; 3]) {
        [&mut *start, &mut *end, &mut *speed].into_iter().for_each(Vec::clear);
        for Solid { obstacle, points, .. } in &self.obstacles {
            let [from, to] = [interval.begin, interval.end].map(|time| obstacle.pose(time));
            for &point in points {
                let [before, after] = [from, to].map(|pose| pose.apply(obstacle.pivot, point));
                start.push(before);
                end.push(after);
                speed.push((after - before) / interval.step);
            }
        }
    }

    /// The velocity (m/s) of the surface of a round obstacle, at a way `out` (m) from a point of its axis at the start of a step, beside that of
    /// this point.
    fn drag(&self, surface: usize, interval: Interval, at: DVec3, out: DVec3) -> DVec3 {
        let Some(solid) = surface.checked_sub(self.bodies).filter(|_| self.surfaces[surface].is_round) else {
            return DVec3::ZERO;
        };
        let Obstacle { pivot, .. } = self.obstacles[solid].obstacle;
        let [before, after] = [interval.begin, interval.end].map(|time| self.obstacles[solid].obstacle.pose(time));
        let way = |point: DVec3| after.apply(pivot, before.undo(pivot, point)) - point;
        (way(at + out) - way(at)) / interval.step
    }

    /// How far the points of each surface move from places to others.
    fn ways(&self, from: &Places<'_>, to: &Places<'_>, ways: &mut Vec<Way>) {
        ways.clear();
        ways.extend(self.surfaces.iter().map(|surface| {
            let by = |node: u32| to.node(node) - from.node(node);
            // Any vector will do: the nearer it is to the mean, the less is left.
            let some = surface.nodes.iter().step_by(surface.nodes.len().div_ceil(8).max(1));
            let count = some.len().max(1) as f64;
            let drift = some.map(|&node| by(node)).sum::<DVec3>() / count;
            let spread = |most: f64, &node: &u32| most.max(by(node).distance_squared(drift));
            Way { drift, spread: surface.nodes.iter().fold(0.0, spread).sqrt() }
        }));
    }

    /// Chooses the pairs of surfaces that are near each other, and returns the way (m) of any two until others may meet.
    pub(super) fn choose(&self, at: &Places<'_>, ahead: f64, pairs: &mut Vec<Pair>) -> f64 {
        let extents: Vec<_> = self.surfaces.iter().map(|surface| Extent::of(surface, at)).collect();
        let bodies = &extents[..self.bodies];
        let size = bodies.iter().map(|extent| extent.size().max_element()).sum::<f64>() / self.bodies as f64;
        let margin = (0.1 * size).max(16.0 * ahead);
        let reach = margin + self.widest_gap();
        let mut order: Vec<usize> = (0..extents.len()).collect();
        order.sort_by(|&one, &other| extents[one].begins().total_cmp(&extents[other].begins()));
        let mut chosen = Vec::new();
        for (at, &one) in order.iter().enumerate() {
            if one < self.bodies {
                chosen.push([one, one]);
            }
            let end = extents[one].ends() + reach;
            let beside = order[at + 1..].iter().take_while(|&&other| extents[other].begins() <= end);
            let near = beside.filter(|&&other| extents[one].distance(&extents[other]) <= reach);
            chosen.extend(near.map(|&other| [one.min(other), one.max(other)]));
        }
        chosen.sort_unstable();
        let mut old = std::mem::take(pairs).into_iter().peekable();
        for of in chosen {
            while old.next_if(|pair| pair.of < of).is_some() {}
            match old.next_if(|pair| pair.of == of) {
                Some(pair) => pairs.push(pair),
                None => pairs.extend(self.law(of[0], of[1]).map(|law| Pair::new(of, law))),
            }
        }
        margin
    }

    /// The number of pairs of facets that cross at a time (s), of each two surfaces that meet, with positions of all nodes (m).
    pub(crate) fn crossings(&self, position: &[DVec3], time: f64) -> Vec<([Side; 2], usize)> {
        let mut obstacles = [const { Vec::new() }; 3];
        self.place_obstacles(Interval { begin: time, end: time, step: 1.0 }, &mut obstacles);
        let places = Places { nodes: position, obstacles: &obstacles[0] };
        let placed = |surface: &Surface| -> Vec<DVec3> {
            (0..surface.points.len() as u32).map(|point| places.point(&surface.points, point)).collect()
        };
        let at: Vec<_> = self.surfaces.iter().map(placed).collect();
        let extents: Vec<_> = at.iter().map(|points| Extent::around(points.iter().copied())).collect();
        let pairs = (0..self.bodies).flat_map(|one| (one..extents.len()).map(move |other| [one, other]));
        let count = |[one, other]: [usize; 2]| {
            let both = [one, other].map(|number| Placed { surface: &self.surfaces[number], at: &at[number] });
            let is_near = extents[one].distance(&extents[other]) <= both[0].radius() + both[1].radius();
            let count = if is_near && self.law(one, other).is_some() { crossings(both).len() } else { 0 };
            ([self.side(one), self.side(other)], count)
        };
        pairs.map(count).filter(|&(_, count)| count > 0).collect()
    }

    /// How many steps of ΔT (s), at most `most`, bodies can take alone, and the speed (m/s) up to which they can: above it they might
    /// meet. `None` if they may meet in the next step.
    pub(crate) fn alone(&self, at: Nodes<'_>, interval: Interval, most: u64) -> Option<(u64, f64)> {
        /// A node moves at most so many times as far as its speed says: it may be thrown back by an obstacle.
        const THROWN: f64 = 3.0;
        if self.contacts.bodies.iter().any(|body| body.itself) {
            return None;
        }
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let Known { obstacles, extents, order, .. } = &mut *known;
        self.place_obstacles(interval, obstacles);
        let places = Places { nodes: at.position, obstacles: &obstacles[0] };
        extents.clear();
        extents.extend(self.surfaces.iter().map(|surface| Extent::of(surface, &places)));
        let speeds = self.nodes.iter().map(|&node| at.velocity[node as usize].length_squared());
        let fastest = speeds.fold(0.0, f64::max).sqrt();
        let quickest = self.obstacles.iter().map(|solid| solid.greatest_speed).fold(0.0, f64::max);
        let widest = self.widest_gap();
        let bearable = |way: f64, own: f64| (way / (most as f64 * interval.step) - own) / (2.0 * THROWN);
        order.clear();
        order.extend(0..extents.len());
        order.sort_unstable_by(|&one, &other| {
            extents[one].begins().total_cmp(&extents[other].begins()).then(one.cmp(&other))
        });
        let clear = self.grounds.lock().unwrap_or_else(PoisonError::into_inner).clear(&self.surfaces, at.position)?;
        let mut speed = bearable(clear, 0.0);
        for (at, &one) in order.iter().enumerate() {
            for &other in &order[at + 1..] {
                // No later one is nearer.
                let least = extents[other].begins() - extents[one].ends() - widest;
                if speed <= 1.1 * fastest || bearable(least, quickest) >= speed {
                    break;
                }
                let Some(Law { gap, .. }) = self.law(one.min(other), one.max(other)) else { continue };
                let own =
                    one.max(other).checked_sub(self.bodies).map_or(0.0, |solid| self.obstacles[solid].greatest_speed);
                speed = speed.min(bearable(extents[one].distance(&extents[other]) - gap, own));
            }
        }
        (speed > 1.1 * fastest).then_some((most, speed))
    }
}
