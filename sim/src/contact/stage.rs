//! The surfaces of a world that meet each other, and by which law.

use super::cross::crossings;
use super::extent::Extent;
use super::ground::Ground;
use super::inside::enclosed;
use super::known::Memory;
use super::rule::Law;
use super::shown::{Seen, Shown};
use super::solid::Solid;
use super::surface::{Placed, Surface};
use super::{Contacts, Obstacle, PairContact, Side};
use crate::body::Body;
use crate::motion::Interval;
use glam::DVec3;
use std::sync::Arc;

/// The surfaces of a world, and what is known of their places. What is known only saves work: it changes no bit of what a step does.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub(super) contacts: Contacts,
    /// Of the bodies, then of obstacles with an extent. Their nodes are numbered as in `nodes`, and the points of obstacles after them.
    pub(super) surfaces: Vec<Surface>,
    pub(super) bodies: usize,
    pub(super) obstacles: Vec<Solid>,
    /// The nodes of the surfaces of bodies among all nodes of the world, in rising order.
    pub(crate) nodes: Vec<u32>,
    /// Of each of these its position at rest (m) and 1/m (1/kg).
    pub(super) rest: Vec<DVec3>,
    pub(super) inverse_mass: Vec<f64>,
    pub(super) grounds: Vec<Ground>,
    pub(super) known: Memory,
}

impl Stage {
    /// The surfaces of bodies, whose nodes are numbered one body after the other, and of obstacles.
    pub(crate) fn new(contacts: &Contacts, bodies: &[Arc<Body>], obstacles: &[Obstacle]) -> Self {
        let (mut surfaces, mut nodes) = (Vec::new(), Vec::new());
        let (mut rest, mut inverse_mass) = (Vec::new(), Vec::new());
        let mut first = 0;
        for (number, body) in bodies.iter().enumerate() {
            let surface = Surface::of(body);
            let own = surface.nodes.clone();
            let mut surface = surface.numbered(nodes.len() as u32).ready();
            surface.thickness =
                contacts.bodies.get(number).and_then(|body| body.thickness).unwrap_or(surface.thickness);
            surfaces.push(surface);
            rest.extend(own.iter().map(|&node| body.rest[node as usize]));
            inverse_mass.extend(own.iter().map(|&node| body.mass[node as usize].recip()));
            nodes.extend(own.iter().map(|node| first + node));
            first += body.len() as u32;
        }
        let mut solids = Vec::new();
        let mut first = nodes.len() as u32;
        for (number, obstacle) in obstacles.iter().enumerate().filter(|_| !bodies.is_empty()) {
            let Some((surface, points)) = obstacle.shape.surface_of(bodies[0].dimension, first) else { continue };
            first += points.len() as u32;
            surfaces.push(surface.ready());
            let far = points.iter().fold(0.0, |most: f64, point| most.max(point.distance(obstacle.pivot)));
            let greatest_speed = obstacle.motion.greatest_speed(far);
            solids.push(Solid { number, obstacle: obstacle.clone(), points, greatest_speed });
        }
        let grounds = Ground::all(bodies, &surfaces, obstacles);
        let (contacts, bodies, known) = (contacts.clone(), bodies.len(), Memory::default());
        Self { contacts, surfaces, bodies, obstacles: solids, nodes, rest, inverse_mass, known, grounds }
    }

    /// Whether two surfaces can meet, or a surface and a half-space.
    pub(crate) fn can_meet(&self) -> bool {
        let meets_itself = self.contacts.bodies.iter().any(|body| body.itself);
        self.bodies > 0 && (!self.grounds.is_empty() || meets_itself || self.surfaces.len() > 1)
    }

    pub(super) fn side(&self, surface: usize) -> Side {
        match surface.checked_sub(self.bodies) {
            None => Side::Body(surface),
            Some(solid) => Side::Obstacle(self.obstacles[solid].number),
        }
    }

    /// How two surfaces meet; `None` if they do not.
    pub(super) fn law(&self, one: usize, other: usize) -> Option<Law> {
        if one >= self.bodies || one == other && !self.contacts.bodies.get(one).is_some_and(|body| body.itself) {
            return None;
        }
        let Contacts { restitution, friction, .. } = self.contacts;
        let solid = other.checked_sub(self.bodies).map(|solid| &self.obstacles[solid].obstacle);
        let usual = solid.map_or([restitution, friction], |solid| [solid.restitution, solid.friction]);
        let own = self.pair(one, other);
        Some(Law {
            restitution: own.and_then(|own| own.restitution).unwrap_or(usual[0]),
            friction: own.and_then(|own| own.friction).unwrap_or(usual[1]),
            gap: self.gap(one, other) + self.surfaces[other].radius(),
        })
    }

    /// The distance that two surfaces keep (m), beside the radius of an obstacle.
    pub(super) fn gap(&self, one: usize, other: usize) -> f64 {
        let own = |number: usize| if self.surfaces[number].is_round { 0.0 } else { self.surfaces[number].thickness };
        self.pair(one, other).and_then(|pair| pair.thickness).unwrap_or(own(one) + own(other))
    }

    /// What is special of two surfaces.
    fn pair(&self, one: usize, other: usize) -> Option<&PairContact> {
        let [one, other] = [one, other].map(|number| self.side(number));
        self.contacts.pairs.iter().find(|pair| pair.of == [one, other] || pair.of == [other, one])
    }

    /// A bound of the gaps of all pairs (m).
    pub(super) fn widest_gap(&self) -> f64 {
        let thickest = self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.thickness));
        let own = self.contacts.pairs.iter().filter_map(|pair| pair.thickness).fold(thickest, f64::max);
        thickest + own
    }

    /// The places of nodes of surfaces and then of points of obstacles at a time (s), from the positions of all nodes (m).
    pub(super) fn place(&self, position: &[DVec3], time: f64) -> Vec<DVec3> {
        let mut places: Vec<_> = self.nodes.iter().map(|&node| position[node as usize]).collect();
        self.add_obstacles(time, &mut places);
        places
    }

    /// Appends the places of points of obstacles at a time (s).
    pub(super) fn add_obstacles(&self, time: f64, places: &mut Vec<DVec3>) {
        for Solid { obstacle, points, .. } in &self.obstacles {
            let pose = obstacle.pose(time);
            places.extend(points.iter().map(|&point| pose.apply(obstacle.pivot, point)));
        }
    }

    /// What pairs are looked at with: surfaces in a step, or at one moment without an interval.
    pub(super) fn seen<'a>(&'a self, start: &'a [Shown], interval: Option<Interval>) -> Seen<'a> {
        Seen { surfaces: &self.surfaces, rest: &self.rest, solids: &self.obstacles, start, interval }
    }

    /// The number of pairs of facets that cross at a time (s), of each two surfaces that meet, with positions of all nodes (m). Where none do
    /// and one surface lies inside the other, the number of its facets.
    pub(crate) fn crossings(&self, position: &[DVec3], time: f64) -> Vec<([Side; 2], usize)> {
        let moment = self.moment(position, time);
        let pairs = (0..self.bodies).flat_map(|one| (one..self.surfaces.len()).map(move |other| [one, other]));
        let count = |of: [usize; 2]| {
            let both = of.map(|number| self.placed(&moment, number));
            let is_near = moment.distance(of) <= both[0].surface.radius() + both[1].surface.radius();
            let count = match is_near && self.law(of[0], of[1]).is_some() {
                true => match crossings(both).len() {
                    0 if of[0] != of[1] => enclosed(both),
                    count => count,
                },
                false => 0,
            };
            (of.map(|number| self.side(number)), count)
        };
        pairs.map(count).filter(|&(_, count)| count > 0).collect()
    }

    /// The places of the points of all surfaces at a time (s), from the positions of all nodes (m).
    pub(super) fn moment(&self, position: &[DVec3], time: f64) -> Moment {
        let places = self.place(position, time);
        let at: Vec<Vec<_>> = self.surfaces.iter().map(|surface| surface.places(&places).collect()).collect();
        let extents = at.iter().map(|points| Extent::around(points.iter().copied())).collect();
        Moment { at, extents }
    }

    pub(super) fn placed<'a>(&'a self, moment: &'a Moment, number: usize) -> Placed<'a> {
        Placed { surface: &self.surfaces[number], at: &moment.at[number] }
    }
}

/// The places of points of all surfaces, and boxes around them (m).
pub(super) struct Moment {
    pub(super) at: Vec<Vec<DVec3>>,
    pub(super) extents: Vec<Extent>,
}

impl Moment {
    /// The distance between the boxes of two surfaces (m).
    pub(super) fn distance(&self, [one, other]: [usize; 2]) -> f64 {
        self.extents[one].distance(&self.extents[other])
    }
}
