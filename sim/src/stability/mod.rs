//! The largest stable step of a run, predicted before it starts: from the largest eigenvalue of its stiffness, linearised at rest
//! and divided by the masses, and from its damping.
//!
//! No matrix is stored: its products with vectors are differences of the run's own forces, so any model will do. The limit
//! at rest also holds for a moving shape-based body, up to changes of its stiffness with deformation. A stretched spring also resists
//! across its direction, with a stiffness that approaches its own; a second limit allows for this.

mod lanczos;
mod limits;

use super::assembly::Assembly;
use super::body::Body;
use super::element::Dimension;
use super::fill;
use super::grip::Grip;
use super::integrate::Integrator;
use super::mode::Mode;
use super::model::{ElasticModel, ForceModel, Properties, Scratch};
use super::noise::Noise;
use super::state::Nodes;
use glam::DVec3;
use std::sync::Arc;

/// The largest stable step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stability {
    /// At rest (s): 0 if no step is stable, infinite if all are.
    pub largest: f64,
    /// For springs of any stretch and direction (s); `None` for other models.
    pub stretched: Option<f64>,
}

impl Stability {
    /// The share of [`Self::largest`] that `step = "auto"` takes, at most.
    ///
    /// In falls, elements deform far from rest, for which the limit was computed. Stretched springs are within this share: averaged
    /// over three directions at right angles, the stiffness at rest is a third of the bound, so that the limit at rest is at most √3
    /// times the limit of stretched springs.
    pub const SHARE: f64 = 0.5;

    /// The step (s) that `step = "auto"` takes at most for models that move their nodes themselves, stably for any step: twenty in a
    /// frame of film or video, as M. Macklin et al., Small Steps in Physics Simulation (2019), do.
    pub const PROJECTED: f64 = 1.0 / 1200.0;

    /// Predicts the largest stable step for a model on a body. Nodes that a grip holds from the start to the end do not vibrate. All others
    /// count as free, because free nodes only raise frequencies.
    pub fn of(body: &Arc<Body>, model: &dyn ElasticModel, integrator: Integrator, restraint: Restraint<'_>) -> Self {
        let certain = Self::certain(body, model, integrator, restraint.mass_damping);
        let is_implicit = matches!(integrator, Integrator::BackwardEuler | Integrator::DormandPrince);
        if is_implicit || certain == Some(f64::INFINITY) {
            return Self { largest: f64::INFINITY, stretched: None };
        }
        let corners = body.elements.indices().len().max(2 * model.springs().len());
        if let Some(step) = certain.filter(|&step| corners > MOST_CORNERS && step > 0.0) {
            return Self { largest: step, stretched: None };
        }
        let is_free = restraint.free(body);
        let has_springs = !model.springs().is_empty();
        let braked = |mode: Mode| mode.damped_more(restraint.mass_damping);
        let stretched = has_springs.then(|| braked(stretched(body, model, &is_free)).largest_step(integrator));
        let linear = Linear::new(body, model, is_free, restraint.mass_damping);
        Self { largest: linear.largest_step(integrator).min(restraint.largest_step(integrator)), stretched }
    }

    /// Whether a step (s) is below the largest stable one at rest for each body of a run, told by fewer products than [`Self::of_each`] takes.
    /// False does not tell that it is above.
    pub fn is_below(
        bodies: &Assembly,
        models: &[Arc<dyn ElasticModel>],
        integrator: Integrator,
        restraint: Restraint<'_>,
        step: f64,
    ) -> bool {
        /// So many products find the largest eigenvalue to some tenths, so that a step is below the limit up to this share of it.
        const FEW: usize = 12;
        const FAR: f64 = 0.67;
        let is_implicit = matches!(integrator, Integrator::BackwardEuler | Integrator::DormandPrince);
        let mut parts = bodies.bodies().iter().zip(models).enumerate();
        parts.all(|(at, (body, model))| {
            let certain = Self::certain(body, &**model, integrator, restraint.mass_damping);
            let rough = || {
                let is_free = Restraint { grips: &of_body(bodies, at, restraint.grips), ..restraint }.free(body);
                let linear = Linear::new(body, &**model, is_free, restraint.mass_damping);
                FAR * Linear { most: FEW, ..linear }.rough_step(integrator).min(restraint.largest_step(integrator))
            };
            is_implicit || step <= certain.unwrap_or_else(rough)
        })
    }

    /// Predicts the largest stable step for each body of a run with its model, as [`Self::of`]. Grips number the nodes of all
    /// bodies.
    pub fn of_each(
        bodies: &Assembly,
        models: &[Arc<dyn ElasticModel>],
        integrator: Integrator,
        restraint: Restraint<'_>,
    ) -> Vec<Self> {
        let parts = bodies.bodies().iter().zip(models).enumerate();
        let of = |(at, (body, model)): (usize, (&Arc<Body>, &Arc<dyn ElasticModel>))| {
            let own = Restraint { grips: &of_body(bodies, at, restraint.grips), ..restraint };
            Self::of(body, &**model, integrator, own)
        };
        parts.map(of).collect()
    }

    /// The largest step that is stable for all of several bodies.
    pub fn of_all(each: &[Self]) -> Self {
        Self {
            largest: each.iter().map(|one| one.largest).fold(f64::INFINITY, f64::min),
            stretched: each.iter().filter_map(|one| one.stretched).reduce(f64::min),
        }
    }

    /// A step (s) that is stable for certain with damping of masses (1/s), without computing eigenvalues: 0 if none is known, `None` for models that do not
    /// say how stiff they are. Infinite for a model that moves its nodes itself.
    pub fn certain(body: &Body, model: &dyn ElasticModel, integrator: Integrator, mass_damping: f64) -> Option<f64> {
        Some(model.bound(body)?.damped_more(mass_damping).certain_step(integrator))
    }
}

/// The grips of one of several bodies, with its own numbers of nodes.
fn of_body(bodies: &Assembly, body: usize, grips: &[Grip]) -> Vec<Grip> {
    let own = bodies.nodes(body);
    let nodes = |grip: &Grip| -> Vec<u32> {
        let nodes = grip.nodes.iter().filter(|&&node| own.contains(&(node as usize)));
        nodes.map(|node| node - own.start as u32).collect()
    };
    grips.iter().map(|grip| Grip { nodes: nodes(grip), ..grip.clone() }).collect()
}

/// What keeps nodes of a run from vibrating.
#[derive(Clone, Copy, Debug, Default)]
pub struct Restraint<'a> {
    /// Its grips.
    pub grips: &'a [Grip],
    /// The end of the run (s).
    pub duration: f64,
    /// [`Surroundings::mass_damping`](crate::Surroundings::mass_damping) (1/s).
    pub mass_damping: f64,
}

impl Restraint<'_> {
    /// The largest stable step (s) of a mode without stiffness, which some methods allow less than an oscillation.
    fn largest_step(&self, integrator: Integrator) -> f64 {
        Mode::default().damped_more(self.mass_damping).largest_step(integrator)
    }

    /// Whether each node of a body vibrates: no grip holds it from the start to the end.
    fn free(&self, body: &Body) -> Vec<bool> {
        let mut is_free = vec![true; body.len()];
        let holding = self.grips.iter().filter(|grip| grip.from <= 0.0 && grip.until >= self.duration);
        holding.flat_map(|grip| &grip.nodes).for_each(|&node| is_free[node as usize] = false);
        is_free
    }
}

/// Elements and springs of bodies up to this size are looked at, by their corners and ends: a prediction takes some seconds on one
/// processor. For larger ones it is the bound of their models, which for lattices is 3 % lower.
const MOST_CORNERS: usize = 1_000_000;

/// The most products of the matrix with a vector in one search of an eigenvalue: fewer for bodies of many corners.
fn most_products(corners: usize) -> usize {
    const LEAST: usize = 24;
    const MOST: usize = 80;
    (20_000_000 / corners.max(1)).clamp(LEAST, MOST)
}

/// A start vector of the search, which no symmetry of a body makes normal to an eigenvector.
fn start(body: &Body, is_free: &[bool]) -> Vec<DVec3> {
    let mut noise = Noise(1);
    let across = if body.dimension == Dimension::Plane { 0.0 } else { 1.0 };
    let mut vector = |&is_free: &bool| {
        let vector = noise.vector() * DVec3::new(1.0, 1.0, across);
        if is_free { vector } else { DVec3::ZERO }
    };
    is_free.iter().map(&mut vector).collect()
}

/// The stiffness and damping of springs that are stretched without limit: each resists motion in all directions as along itself. No
/// state exceeds them.
fn stretched(body: &Body, model: &dyn ElasticModel, is_free: &[bool]) -> Mode {
    let scale: Vec<f64> = body.mass.iter().map(|mass| 1.0 / mass.sqrt()).collect();
    let parts = fill::parts(body, model.springs().iter().map(|ends| &ends[..]));
    let product = |from: &[DVec3], to: &mut [DVec3]| {
        to.fill(DVec3::ZERO);
        for (spring, &[i, j]) in model.springs().iter().enumerate() {
            let [i, j] = [i as usize, j as usize];
            let part = parts.as_ref().map_or(1.0, |parts| parts[spring]);
            let stretch = (from[i] * scale[i] - from[j] * scale[j]) * part;
            to[i] += stretch * scale[i];
            to[j] -= stretch * scale[j];
        }
        let fixed = to.iter_mut().zip(is_free).filter(|(_, is_free)| !**is_free);
        fixed.for_each(|(to, _)| *to = DVec3::ZERO);
    };
    let most = most_products(2 * model.springs().len());
    let (value, _) = lanczos::largest(&start(body, is_free), most, false, product);
    let Properties { stiffness, damping, .. } = model.properties(body);
    Mode { stiffness: stiffness * value, damping: damping * value }
}

/// The forces of a model around rest.
struct Linear {
    body: Arc<Body>,
    forces: Box<dyn ForceModel>,
    memory: Vec<f64>,
    /// `1/√m` of each node (1/√kg).
    scale: Vec<f64>,
    is_free: Vec<bool>,
    /// Damping of masses, the same of all modes (1/s).
    mass_damping: f64,
    /// The greatest displacement (m) in a difference of forces.
    small: f64,
    /// At rest (N).
    at_rest: Vec<DVec3>,
    /// The most products in one search of an eigenvalue.
    most: usize,
}

impl Linear {
    fn new(body: &Arc<Body>, model: &dyn ElasticModel, is_free: Vec<bool>, mass_damping: f64) -> Self {
        /// As a share of the smallest element: forces are linear to about this share, and round-off is far smaller.
        const SMALL: f64 = 1e-6;
        let size = |nodes: &[u32]| {
            let first = body.rest[nodes[0] as usize];
            nodes.iter().map(|&node| body.rest[node as usize].distance(first)).fold(0.0, f64::max)
        };
        let smallest = body.elements.iter().map(size).filter(|&size| size > 0.0).fold(body.extent(), f64::min);
        let memory = model.start(body, &body.rest);
        let mut own = Self {
            forces: model.prepare(body),
            memory,
            scale: body.mass.iter().map(|mass| 1.0 / mass.sqrt()).collect(),
            is_free,
            mass_damping,
            small: SMALL * smallest,
            at_rest: Vec::new(),
            most: most_products(body.elements.indices().len().max(2 * model.springs().len())),
            body: Arc::clone(body),
        };
        own.at_rest = own.evaluate(&body.rest, &vec![DVec3::ZERO; body.len()], &mut Scratch::default());
        own
    }

    fn evaluate(&self, position: &[DVec3], velocity: &[DVec3], scratch: &mut Scratch) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; position.len()];
        let at = Nodes { position, velocity };
        self.forces.add_forces(at, &self.memory, &mut self.memory.clone(), scratch, &mut forces);
        forces
    }

    /// Adds stiffness and damping, with weights, times a vector, all divided by the square roots of the masses.
    fn product(&self, weights: [f64; 2], from: &[DVec3], to: &mut [DVec3], scratch: &mut Scratch) {
        let own: Vec<_> = from.iter().zip(&self.scale).map(|(&from, &scale)| from * scale).collect();
        let largest = own.iter().map(|own| own.length_squared()).fold(0.0, f64::max).sqrt();
        to.fill(DVec3::ZERO);
        let mut add = |forces: &[DVec3], factor: f64| {
            for (node, to) in to.iter_mut().enumerate().filter(|(node, _)| self.is_free[*node]) {
                *to -= (forces[node] - self.at_rest[node]) * (factor * self.scale[node]);
            }
        };
        if largest == 0.0 {
            return;
        }
        if weights[0] != 0.0 {
            let share = self.small / largest;
            let moved: Vec<_> = self.body.rest.iter().zip(&own).map(|(&rest, &own)| rest + own * share).collect();
            let still = vec![DVec3::ZERO; moved.len()];
            add(&self.evaluate(&moved, &still, scratch), weights[0] / share);
        }
        if weights[1] != 0.0 {
            add(&self.evaluate(&self.body.rest, &own, scratch), weights[1]);
        }
        if self.body.dimension == Dimension::Plane {
            to.iter_mut().for_each(|to| to.z = 0.0);
        }
    }

    /// The mode in which stiffness and damping, with these weights, have the largest sum.
    fn top(&self, weights: [f64; 2]) -> Mode {
        let mut scratch = Scratch::default();
        let is_damped = self.forces.is_damped();
        let start = start(&self.body, &self.is_free);
        let (value, vector) = lanczos::largest(&start, self.most, is_damped, |from, to| {
            self.product(weights, from, to, &mut scratch);
        });
        let Some(vector) = vector else { return Mode { stiffness: value / weights[0], damping: self.mass_damping } };
        let mut image = vec![DVec3::ZERO; vector.len()];
        let mut quotient = |weights: [f64; 2]| {
            self.product(weights, &vector, &mut image, &mut scratch);
            lanczos::dot(&vector, &image).max(0.0)
        };
        let elastic = Mode { stiffness: quotient([1.0, 0.0]), damping: quotient([0.0, 1.0]) };
        elastic.damped_more(self.mass_damping)
    }

    /// The largest step that is stable for a mode with the largest stiffness and the largest damping.
    fn rough_step(&self, integrator: Integrator) -> f64 {
        let stiffness = self.top([1.0, 0.0]).stiffness;
        let damping = if self.forces.is_damped() { self.top([0.0, 1.0]).damping } else { self.mass_damping };
        Mode { stiffness, damping }.largest_step(integrator)
    }

    /// The largest step that is stable for the modes that limit it, beginning with those of the largest stiffness and the largest
    /// damping.
    ///
    /// For semi-implicit Euler, a step is stable exactly if `K ΔT² + 2 C ΔT` has no eigenvalue above 4, and the search below is
    /// Newton's method for that, from above. For the others it is exact where stiffness and damping have the same modes, and a
    /// lower bound, up to a tenth less, where they do not.
    fn largest_step(&self, integrator: Integrator) -> f64 {
        const MOST_SEARCHES: usize = 5;
        if !self.forces.is_damped() {
            return match integrator {
                Integrator::ExplicitEuler if self.mass_damping == 0.0 => 0.0,
                _ => self.top([1.0, 0.0]).largest_step(integrator),
            };
        }
        let with_step = |mode: Mode| (mode.largest_step(integrator), mode);
        let [first, second] = [[1.0, 0.0], [0.0, 1.0]].map(|weights| with_step(self.top(weights)));
        let (mut step, mut mode) = if second.0 < first.0 { second } else { first };
        for _ in 0..MOST_SEARCHES {
            if !step.is_finite() {
                break;
            }
            let (next, other) = with_step(self.top(mode.outwards(integrator, step)));
            if next >= step * (1.0 - 1e-4) {
                break;
            }
            (step, mode) = (next, other);
        }
        step
    }
}
