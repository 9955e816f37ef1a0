//! Bodies of the study, worlds of them, and the triangles of their surfaces that cross.

use crate::material::Elements;
use glam::{DQuat, DVec3};
use localshape::sim::geometry::bounds;
use localshape::sim::model::ElasticModel;
use localshape::sim::model::shape_based::{DampingReading, ShapeBased};
use localshape::sim::{
    Body, Contacts, FrictionOf, IndexLists, Integrator, Motion, Obstacle, Shape, State, Stepping, Surroundings, World,
};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The side of a cell (m), and its mass (kg).
pub(super) const SIDE: f64 = 0.1;
pub(super) const MASS: f64 = 1.0;
/// Acceleration of gravity (m/s²).
pub(super) const GRAVITY: f64 = 9.81;

/// A block of cells around the origin, each of [`MASS`] and in eight parts for its corners, with its nodes moved by `place`, which gets
/// coordinates from −1 to 1 and places (m).
pub(super) fn block(cells: [u32; 3], place: impl Fn(DVec3, DVec3) -> DVec3) -> Arc<Body> {
    let half = DVec3::from_array(cells.map(f64::from)) * 0.5;
    let (rest, elements) = lattice(cells, |at| place((at - half) / half, (at - half) * SIDE));
    let mut mass = vec![0.0; rest.len()];
    elements.indices().iter().for_each(|&node| mass[node as usize] += MASS / 8.0);
    Arc::new(Body::builder(rest).elements(elements).masses(mass).build().expect("a block"))
}

/// The nodes and the cells of a lattice, both with x fastest. `place` gets the numbers of cells before a node along each axis.
pub(crate) fn lattice(cells: [u32; 3], place: impl Fn(DVec3) -> DVec3) -> (Vec<DVec3>, IndexLists) {
    let body = Elements::Cells.block(&cells, 1.0, (0.0, 1), 1.0);
    let (corner, _) = bounds(body.rest());
    (body.rest().iter().map(|&at| place(at - corner)).collect(), body.elements().clone())
}

/// A block of cubes.
pub(super) fn cubes(cells: [u32; 3]) -> Arc<Body> {
    block(cells, |_, at| at)
}

/// A body, where it is, how it is turned, and how it moves.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) body: Arc<Body>,
    pub(super) at: DVec3,
    pub(super) turned: DQuat,
    pub(super) speed: DVec3,
}

impl Placed {
    pub(super) fn still(body: &Arc<Body>, at: DVec3) -> Self {
        Self { body: Arc::clone(body), at, turned: DQuat::IDENTITY, speed: DVec3::ZERO }
    }
}

/// What the bodies of a world have in common.
#[derive(Clone)]
pub(super) struct Setting {
    /// The elastic constant of cells (N/m), and their damping constant (N s/m), of their deformation.
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    /// The step as a share of `T = 2π √(m/k)`, with the mass of a cell.
    pub(super) share: f64,
    pub(super) around: Surroundings,
}

impl Setting {
    /// Bodies that meet with a restitution and a friction, without gravity.
    pub(super) fn new(stiffness: f64, [restitution, friction]: [f64; 2]) -> Self {
        let contacts = Contacts { restitution, friction, ..Contacts::default() };
        let around = Surroundings { contacts: Some(contacts), ..Surroundings::default() };
        Self { stiffness, damping: 0.0, share: 1.0 / 50.0, around }
    }

    /// ΔT (s).
    pub(super) fn step(&self) -> f64 {
        self.share * TAU * (MASS / self.stiffness).sqrt()
    }

    /// The number of steps in a time (s).
    pub(super) fn steps(&self, time: f64) -> u64 {
        libm::ceil(time / self.step()) as u64
    }

    pub(super) fn world(&self, bodies: &[Placed]) -> World {
        let damping_of = DampingReading::Deformation;
        let model = ShapeBased { damping: self.damping, damping_of, ..ShapeBased::new(self.stiffness) };
        let mut all = State::default();
        for Placed { body, at, turned, speed } in bodies {
            all.position.extend(body.rest().iter().map(|&rest| *at + *turned * rest));
            all.velocity.extend(vec![*speed; body.len()]);
        }
        let parts: Vec<_> =
            bodies.iter().map(|placed| (Arc::clone(&placed.body), &model as &dyn ElasticModel)).collect();
        let stepping = Stepping::new(Integrator::SemiImplicitEuler, self.step());
        World::of_parts(&parts, all, self.around.clone(), stepping)
    }
}

/// An obstacle at rest.
pub(crate) fn obstacle(shape: Shape, [restitution, friction]: [f64; 2]) -> Obstacle {
    let friction_of = FrictionOf::default();
    Obstacle { shape, motion: Motion::Still, pivot: DVec3::ZERO, restitution, friction, friction_of }
}

/// A mean of values of the nodes of a body, by their masses.
pub(super) fn mean(body: &Body, of: &[DVec3]) -> DVec3 {
    let sum: DVec3 = of.iter().zip(body.mass()).map(|(&value, &mass)| value * mass).sum();
    sum / body.mass().iter().sum::<f64>()
}
