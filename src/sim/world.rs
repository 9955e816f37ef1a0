//! The world of one run. Its step is section 2 of the paper: forces, motion, collisions.

use super::body::{Body, State, bounds};
use super::contact::Obstacle;
use super::diagnose::Diagnose;
use super::field::Field;
use super::grip::{Grip, Hand};
use super::integrate::{Acting, Integrator, Step, Stepper};
use super::model::{ElasticModel, ForceModel, Measure};
use super::snapshot::{Diagnostics, Divergence, Snapshot, Status};
use glam::DVec3;
use std::sync::Arc;

/// What acts on a body from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Acceleration of gravity (m/s²).
    pub gravity: DVec3,
    /// Obstacles, in the order in which they act.
    pub obstacles: Vec<Obstacle>,
    /// What holds and drags nodes, after all obstacles.
    pub grips: Vec<Grip>,
}

/// How a run is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// The way of stepping.
    pub integrator: Integrator,
    /// Time step ΔT (s).
    pub step: f64,
}

/// One body with one elastic model, on its way through time. It cannot fail: when it blows up it stops at its last
/// finite state and says so.
pub struct World {
    body: Arc<Body>,
    surroundings: Surroundings,
    stepping: Stepping,
    forces_of: Box<dyn ForceModel>,
    stepper: Stepper,
    hands: Vec<Hand>,
    diagnose: Diagnose,
    /// What snapshots show besides positions and velocities.
    field: Option<Field>,
    state: State,
    /// Steps of the clock, which goes on after a divergence.
    steps: u64,
    bounds: SpeedBounds,
    status: Status,
}

impl World {
    /// A body at `initial`, about to be stepped.
    ///
    /// # Panics
    /// If `initial` has not one position and one velocity per node.
    pub fn new(
        body: &Arc<Body>,
        initial: State,
        model: &dyn ElasticModel,
        surroundings: Surroundings,
        stepping: Stepping,
    ) -> Self {
        assert!(initial.position.len() == body.len() && initial.velocity.len() == body.len(), "one entry per node");
        let mut state = initial;
        let mut hands: Vec<_> = surroundings.grips.iter().cloned().map(Hand::new).collect();
        hands.iter_mut().for_each(|hand| hand.start(&mut state));
        Self {
            forces_of: model.prepare(body, &state),
            stepper: Stepper::new(stepping.integrator, body.len()),
            hands,
            diagnose: Diagnose::new(body),
            bounds: SpeedBounds::new(body, &state, model.stiffness(), &surroundings, stepping.step),
            body: Arc::clone(body),
            surroundings,
            stepping,
            field: None,
            state,
            steps: 0,
            status: Status::Ok,
        }
    }

    /// Makes snapshots show a field from now on, or none.
    pub fn show(&mut self, field: Option<Field>) {
        self.field = field;
    }

    /// Goes on by a number of steps. A diverged world only lets its clock go on.
    pub fn advance(&mut self, steps: u64) {
        let last = self.steps + steps;
        while self.steps < last && self.status == Status::Ok {
            self.step();
            self.steps += 1;
        }
        self.steps = last;
    }

    /// One step: forces, Eqs. (2)–(3), collisions (paper, section 2), and hands.
    fn step(&mut self) {
        let Self { body, surroundings, stepping: Stepping { step, .. }, stepper, hands, forces_of, state, .. } = self;
        let (time, step) = ((self.steps + 1) as f64 * *step, *step);
        hands.iter_mut().for_each(|hand| hand.reach(time, state));
        let bounds = Step { mass: &body.mass, step, speed_limit: self.bounds.at(time) };
        let mut acting = StepOfWorld { body, surroundings, forces_of: &mut **forces_of, hands, time, step };
        if let Err(runaway) = stepper.advance(&bounds, state, &mut acting) {
            let element = body.elements.iter().position(|nodes| nodes.contains(&(runaway.node as u32)));
            self.status = Status::Diverged(Divergence { time, step: self.steps + 1, element });
        }
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The present positions and velocities.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Whether it goes on.
    pub fn status(&self) -> Status {
        self.status
    }

    /// What the model says of the present state: its energy, and the error α of Eq. (18) with the rotations of the forces
    /// here. Every integrator evaluates its forces here, so asked before each step this is α at every evaluation, with
    /// velocity Verlet as with both Euler methods. Costs about one evaluation, and changes nothing.
    pub fn measure(&self) -> Measure {
        self.forces_of.measure(&self.state)
    }

    /// The numbers of the present moment alone, without copies of all positions and velocities.
    pub fn diagnostics(&self) -> Diagnostics {
        self.diagnose.state(&self.state, self.surroundings.gravity, self.measure()).0
    }

    /// The present moment with its diagnostics.
    pub fn snapshot(&self) -> Snapshot {
        let (diagnostics, turned_over, placement) =
            self.diagnose.state(&self.state, self.surroundings.gravity, self.measure());
        let field = self.field.map_or_else(Vec::new, |field| {
            field.values(&self.body, &self.state, &placement, |out| self.forces_of.share_energy(&self.state, out))
        });
        Snapshot {
            step: self.steps,
            time: self.steps as f64 * self.stepping.step,
            position: self.state.position.clone(),
            velocity: self.state.velocity.clone(),
            turned_over,
            placement,
            field,
            diagnostics,
            status: self.status,
        }
    }
}

/// All that acts on the nodes in one step.
struct StepOfWorld<'a> {
    body: &'a Body,
    surroundings: &'a Surroundings,
    forces_of: &'a mut dyn ForceModel,
    hands: &'a mut [Hand],
    /// When the step ends (s).
    time: f64,
    /// How long it takes (s).
    step: f64,
}

impl Acting for StepOfWorld<'_> {
    /// Gravity, then the elastic model's Eq. (1) or Eq. (4).
    fn forces(&mut self, state: &State, forces: &mut [DVec3]) {
        for (force, &mass) in forces.iter_mut().zip(&self.body.mass) {
            *force = self.surroundings.gravity * mass;
        }
        self.forces_of.add_forces(state, forces);
    }

    fn commit(&mut self) {
        self.forces_of.commit();
    }

    fn is_damped(&self) -> bool {
        self.forces_of.is_damped()
    }

    fn constrain(&mut self, state: &mut State, acceleration: Option<&[DVec3]>) {
        for obstacle in &self.surroundings.obstacles {
            obstacle.at(self.time, self.step).rebound_all(state, acceleration);
        }
        for hand in &mut *self.hands {
            hand.drag(self.time, self.step, state);
        }
    }

    fn hold(&mut self, state: &mut State) {
        for hand in &*self.hands {
            hand.hold(self.time, state);
        }
    }
}

/// Beyond which speed a node is lost, so that a run that blows up stops while its last state can still be drawn.
///
/// Swinging through its whole extent, a body moves at 2π extents per cycle. The factor leaves a wide margin above that,
/// and keeps the last state within some extents. What it had at the start and what gravity, obstacles and hands add
/// comes on top.
struct SpeedBounds {
    own: f64,
    gravity: f64,
}

impl SpeedBounds {
    /// For a node of one element; more elements pull harder, and its frequency grows with the root of their number.
    const EXTENTS_PER_CYCLE: f64 = 50.0;
    const MARGIN: f64 = 10.0;

    fn new(body: &Body, initial: &State, stiffness: f64, surroundings: &Surroundings, step: f64) -> Self {
        let (low, high) = bounds(&initial.position);
        let extent = body.extent().max((high - low).max_element());
        let cycle = cycle(body, stiffness);
        let start = initial.velocity.iter().fold(0.0, |fastest: f64, v| fastest.max(v.length()));
        let mut elements_of_node = vec![0u32; body.len()];
        body.elements.indices().iter().for_each(|&node| elements_of_node[node as usize] += 1);
        let most = f64::from(elements_of_node.into_iter().max().unwrap_or(1).max(1));
        let Surroundings { gravity, obstacles, grips } = surroundings;
        let pushing = obstacles.iter().map(|obstacle| {
            // A half-space turns under a body that is somewhere near.
            let reach = obstacle.shape.reach() + obstacle.shape.middle().distance(obstacle.pivot);
            let near = (low - obstacle.pivot).length().max((high - obstacle.pivot).length());
            (&obstacle.motion, if reach.is_finite() { reach } else { near + extent })
        });
        let dragging = grips.iter().map(|grip| (&grip.motion, extent));
        // What it meets in one step is never faster than its whole way in that step.
        let moving = pushing.chain(dragging).map(|(motion, distance)| {
            let way = motion.longest_way(distance);
            (way, motion.greatest_speed(distance).min(way / step))
        });
        // A hand may draw a body out to many times its size.
        let (farthest, fastest) =
            moving.fold((0.0, start), |(far, fast), (way, speed)| (way.max(far), speed.max(fast)));
        let extent = extent + farthest;
        let own = Self::EXTENTS_PER_CYCLE * most.sqrt() * extent / cycle + Self::MARGIN * fastest;
        Self { own, gravity: Self::MARGIN * gravity.length() }
    }

    fn at(&self, time: f64) -> f64 {
        self.own + self.gravity * time
    }
}

/// The cycle `T = 2π√(m/k)` (s) of a body's lightest node with stiffness `k` (N/m).
pub fn cycle(body: &Body, stiffness: f64) -> f64 {
    std::f64::consts::TAU * (body.lightest() / stiffness).sqrt()
}
