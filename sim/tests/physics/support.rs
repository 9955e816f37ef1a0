//! Small bodies and worlds for the tests.

use glam::{DQuat, DVec3};
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::model::shape_based::{RotationReading, ShapeBased};
use localshape_sim::model::{ElasticModel, ForceModel, Report, Scratch};
use localshape_sim::{
    Body, Dimension, IndexLists, Integrator, Motion, Obstacle, Shape, Springs, State, Stepping, Surroundings, World,
};
use std::sync::Arc;

/// `cells`³ cubes of a side (m), 1 kg per node, nodes numbered x fastest.
pub(crate) fn lattice(cells: u32, side: f64) -> Arc<Body> {
    bricks([cells; 3], DVec3::splat(side))
}

/// Boxes with these sides (m), 1 kg per node, nodes numbered x fastest, z slowest.
pub(crate) fn bricks(cells: [u32; 3], sides: DVec3) -> Arc<Body> {
    let nodes = cells.map(|cells| cells + 1);
    let at = |x, y, z| x + nodes[0] * (y + nodes[1] * z);
    let grid =
        |[nx, ny, nz]: [u32; 3]| (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| (x, y, z))));
    let rest: Vec<_> =
        grid(nodes).map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * sides).collect();
    let mut elements = IndexLists::default();
    for (x, y, z) in grid(cells) {
        elements.push(&[0u32, 1, 2, 3, 4, 5, 6, 7].map(|bit| at(x + (bit & 1), y + (bit >> 1 & 1), z + (bit >> 2))));
    }
    let mass = vec![1.0; rest.len()];
    Arc::new(Body::builder(rest).elements(elements).masses(mass).build().expect("a body"))
}

/// A body in the plane or in space from lists.
pub(crate) fn body(dimension: Dimension, rest: &[[f64; 3]], elements: &[&[u32]]) -> Arc<Body> {
    let rest: Vec<_> = rest.iter().copied().map(DVec3::from_array).collect();
    let mass = vec![1.0; rest.len()];
    Arc::new(
        Body::builder(rest)
            .dimension(dimension)
            .elements(elements.iter().copied().collect())
            .masses(mass)
            .build()
            .expect("a body"),
    )
}

pub(crate) fn shape_based(stiffness: f64, damping: f64) -> ShapeBased {
    ShapeBased { damping, rotation: RotationReading::Arctangent, ..ShapeBased::new(stiffness) }
}

pub(crate) fn mass_spring(body: &Body, stiffness: f64, damping: f64, named: Springs) -> MassSpring {
    MassSpring { stiffness, damping, springs: body.topology().springs(named).into(), breaks_at: None }
}

pub(crate) fn floor(restitution: f64, friction: f64) -> Obstacle {
    let shape = Shape::Floor { normal: DVec3::Y, height: 0.0 };
    Obstacle {
        shape,
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution,
        friction,
        friction_of: Default::default(),
    }
}

/// A world without gravity and obstacles.
pub(crate) fn free(body: &Arc<Body>, initial: State, model: &dyn ElasticModel, step: f64) -> World {
    world(body, initial, model, step, Surroundings::default())
}

pub(crate) fn world(
    body: &Arc<Body>,
    initial: State,
    model: &dyn ElasticModel,
    step: f64,
    around: Surroundings,
) -> World {
    World::new(body, initial, model, around, Stepping::new(Integrator::SemiImplicitEuler, step))
}

/// A world without gravity and obstacles, stepped by some integrator.
pub(crate) fn stepped(
    body: &Arc<Body>,
    initial: State,
    model: &dyn ElasticModel,
    integrator: Integrator,
    step: f64,
) -> World {
    World::new(body, initial, model, Surroundings::default(), Stepping::new(integrator, step))
}

/// Internal forces (N) at a state.
pub(crate) fn forces(body: &Arc<Body>, model: &dyn ElasticModel, state: &State) -> Vec<DVec3> {
    world(body, state.clone(), model, 1e-3, Surroundings::default()).forces()
}

/// A model's forces with the memory that goes with them.
pub(crate) struct Remembering {
    pub(crate) forces: Box<dyn ForceModel>,
    pub(crate) memory: Vec<f64>,
}

impl Remembering {
    pub(crate) fn new(body: &Arc<Body>, model: &dyn ElasticModel, start: &State) -> Self {
        Self { memory: model.start(body, &start.position), forces: model.prepare(body) }
    }

    /// The forces (N) and the next memory.
    pub(crate) fn evaluate(&self, state: &State) -> (Vec<DVec3>, Vec<f64>) {
        let (mut forces, mut next) = (vec![DVec3::ZERO; state.position.len()], vec![f64::NAN; self.memory.len()]);
        self.forces.add_forces(state.nodes(), &self.memory, &mut next, &mut Scratch::default(), &mut forces);
        (forces, next)
    }

    /// The forces (N); the memory is updated.
    pub(crate) fn follow(&mut self, state: &State) -> Vec<DVec3> {
        let (forces, next) = self.evaluate(state);
        self.memory = next;
        forces
    }

    /// The report of the model, with the energy of each node (J).
    pub(crate) fn report(&self, state: &State) -> (Report, Vec<f64>) {
        let mut energies = vec![0.0; state.position.len()];
        let mut share = |_: usize, nodes: &[u32], shares: &[f64]| {
            nodes.iter().zip(shares).for_each(|(&node, share)| energies[node as usize] += share);
        };
        let report = self.forces.report(state.nodes(), &self.memory, &mut share);
        (report, energies)
    }
}

/// Pseudo-random numbers between −1 and 1, the same on every machine.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    pub(crate) fn rotation(&mut self) -> DQuat {
        loop {
            let q = DQuat::from_xyzw(self.next(), self.next(), self.next(), self.next());
            if (0.1..1.0).contains(&q.length()) {
                return q.normalize();
            }
        }
    }
}
