//! Stress: bodies of every model under treatments that are likely to break them, and the promises of the shape model.
//!
//! Each trial is one body with one treatment, simulated with every model and the same time step, at most half of the shape
//! model's limit of stability.

mod text;
mod trials;

use crate::material::{Model, of_cells};
use crate::models::Alike;
use crate::study::{Findings, Study, Watch, each};
use glam::DVec3;
use localshape::sim::{Integrator, Motion, State, Status, Stepping, World};
use trials::{Trial, trials};

/// The study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stress {
    /// Steps of bodies that rest or spin.
    pub(crate) steps: u64,
    /// The models that are compared.
    pub(crate) models: Vec<Model>,
}

/// The usual number of steps.
pub(crate) const STEPS: u64 = 1_000_000;

impl Study for Stress {
    fn work(&self) -> u64 {
        (trials(self.steps).len() * self.models.len()) as u64
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self.steps, &self.models, watch)?;
        Some(Findings { text: results.text(), tables: vec![("stress", results.table())], page: None })
    }
}

/// The shape model, whose promises are tested, and models by their names, which are kept for ever; without any, those of the paper.
pub(crate) fn compared(kinds: &[String]) -> Vec<Model> {
    let shape = of_cells("shape-based");
    if !kinds.is_empty() {
        return [shape].into_iter().chain(kinds.iter().map(|kind| of_cells(kind.clone().leak()))).collect();
    }
    let springs = |name, topology| of_cells("mass-spring").with(name, ["springs", topology]);
    vec![
        shape,
        // Two passes, as the paper advises.
        shape.with("shape-based, Eq. (15) twice", ["rotation", "arctangent"]),
        springs("springs, edges and face diagonals", "edges+face-diagonals"),
        springs("springs, all pairs of an element", "all"),
    ]
}

/// The promise of the default model for the end of a trial, besides finite numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Promise {
    /// No element is turned over, and the shape error (see [`Outcome::shape_error`]) is at most this.
    Restored(f64),
    /// No element is turned over, and all heights equal the static equilibrium within this part of a side.
    Settled(f64),
    /// No promise about the shape: the motion is not damped.
    Bounded,
}

/// The outcome for a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outcome {
    /// The time at which it diverged (s), if it did.
    pub(crate) diverged: Option<f64>,
    /// Whether all positions and velocities are finite.
    pub(crate) is_finite: bool,
    /// The number of elements that are turned over at the end.
    pub(crate) turned_over: usize,
    /// RMS distance of the nodes from the best placement of the rest shape, as a part of a side.
    pub(crate) shape_error: f64,
    /// The greatest difference of a height from the static equilibrium, as a part of a side; NaN if there is none.
    pub(crate) unsettled: f64,
    /// The greatest total energy over that at the start; NaN if work is done on the body.
    pub(crate) energy: f64,
    /// The change of momentum, and of angular momentum about the centre of mass, over the sums of their terms at the
    /// fastest moment; NaN if an external force acts, or damping that brakes rotation.
    pub(crate) momentum: [f64; 2],
    /// The sideways creep of the centre of mass, as a part of a side; NaN if the body is to move.
    pub(crate) creep: f64,
}

/// A trial, with its outcomes, one for each model that takes the body.
#[derive(Debug)]
pub(crate) struct Tried {
    trial: Trial,
    pub(crate) outcomes: Vec<Option<Outcome>>,
}

/// The findings, which do not depend on the machine.
pub(crate) struct Results {
    pub(crate) models: Vec<Model>,
    pub(crate) rows: Vec<Tried>,
}

/// The greatest energy over the initial one: semi-implicit Euler oscillates at half of its limit, and rebounds add to
/// it.
const MOST_ENERGY: f64 = 1.5;
/// The greatest relative change of momentum: round-off of a million steps.
const MOST_CHANGE: f64 = 1e-9;
/// The farthest that a body on a level floor creeps, in sides.
const MOST_CREEP: f64 = 1e-3;

/// Makes all trials on the thread pool of the caller; `None` if `watch` stops it.
pub(crate) fn measure(steps: u64, models: &[Model], watch: &Watch<'_>) -> Option<Results> {
    let trials = trials(steps);
    let pairs: Vec<_> = trials.iter().flat_map(|trial| models.iter().map(move |model| (trial, model))).collect();
    let mut outcomes = each(&pairs, watch, |(trial, model)| trial.outcome(model))?.into_iter();
    let row = |trial| Tried { trial, outcomes: outcomes.by_ref().take(models.len()).collect() };
    Some(Results { models: models.to_vec(), rows: trials.into_iter().map(row).collect() })
}

impl Tried {
    /// The promises that the default model breaks.
    pub(crate) fn broken(&self) -> Vec<String> {
        let one = self.outcomes[0].as_ref().expect("the shape model takes all bodies");
        let mut broken = Vec::new();
        let mut demand = |holds: bool, what: String| {
            if !holds {
                broken.push(what);
            }
        };
        demand(one.diverged.is_none(), "diverged".to_owned());
        if self.trial.promise != Promise::Bounded {
            demand(one.turned_over == 0, format!("{} of {} turned over", one.turned_over, self.trial.elements()));
        }
        match self.trial.promise {
            Promise::Restored(most) => demand(one.shape_error <= most, format!("shape error {:.1e}", one.shape_error)),
            Promise::Settled(most) => demand(one.unsettled <= most, format!("not settled by {:.1e}", one.unsettled)),
            Promise::Bounded => {}
        }
        // A value that is not measured is NaN.
        demand(one.energy.is_nan() || one.energy <= MOST_ENERGY, format!("energy × {:.2}", one.energy));
        for change in one.momentum {
            demand(change.is_nan() || change <= MOST_CHANGE, format!("momentum changed by {change:.0e}"));
        }
        demand(one.creep.is_nan() || one.creep <= MOST_CREEP, format!("crept by {:.1e}", one.creep));
        // No model may give NaN or infinite numbers.
        for (at, outcome) in self.outcomes.iter().enumerate() {
            demand(outcome.is_none_or(|outcome| outcome.is_finite), format!("model {at} is not finite"));
        }
        broken
    }
}

impl Trial {
    /// `None` for a model that does not take the body.
    fn world(&self, model: &Model, integrator: Integrator, start: State) -> Option<World> {
        let alike = Alike::on_body(self.stiffness, &self.body);
        let model = alike.model(&self.body, model.kind, self.damping, model.more)?;
        let stepping = Stepping::new(integrator, self.step);
        Some(World::new(&self.body, start, model.as_ref(), self.around.clone(), stepping))
    }

    fn outcome(&self, model: &Model) -> Option<Outcome> {
        /// The number of checks of the state.
        const LOOKS: u64 = 64;
        let mut world = self.world(model, Integrator::default(), self.start.clone())?;
        let first = Look::of(self, &world);
        let (mut most, mut fastest, mut changed) = (first.energy, first.sizes, [0.0f64; 2]);
        for look in 0..LOOKS {
            world.advance(self.steps * (look + 1) / LOOKS - self.steps * look / LOOKS);
            let now = Look::of(self, &world);
            // Unlike the maximum of two numbers, these comparisons keep NaN.
            most = if now.energy <= most { most } else { now.energy };
            fastest = [0, 1].map(|at| now.sizes[at].max(fastest[at]));
            changed = [0, 1].map(|at| changed[at].max((now.momenta[at] - first.momenta[at]).length()));
        }
        let (d, state) = (world.diagnostics(), world.state());
        let diverged = match world.status() {
            Status::Ok => None,
            Status::Diverged(at) => Some(at.time),
        };
        let last = Look::of(self, &world);
        let measured = |is_measured: bool, value: f64| if is_measured { value } else { f64::NAN };
        let obstacles = &self.around.obstacles;
        let has_energy = obstacles.iter().all(|obstacle| obstacle.motion == Motion::Still);
        Some(Outcome {
            diverged,
            is_finite: state.position.iter().chain(&state.velocity).all(|vector| vector.is_finite()),
            turned_over: d.turned_over,
            shape_error: d.shape_error / self.side,
            unsettled: measured(matches!(self.promise, Promise::Settled(_)), self.unsettled(model, state)?),
            energy: measured(has_energy, most / first.energy),
            momentum: [0, 1].map(|at| {
                let is_kept = obstacles.is_empty() && (at == 0 || self.damping == 0.0);
                measured(is_kept && diverged.is_none(), changed[at] / fastest[at].max(f64::MIN_POSITIVE))
            }),
            creep: measured(self.is_still, (last.centre - first.centre).with_y(0.0).length() / self.side),
        })
    }

    /// The greatest difference of a height from the body at rest on its side, as a part of a side. Heights are compared
    /// in order, so a cube may lie on any side.
    fn unsettled(&self, model: &Model, state: &State) -> Option<f64> {
        let heights = |state: &State| {
            let mut heights: Vec<_> = state.position.iter().map(|at| at.y).collect();
            heights.sort_by(f64::total_cmp);
            heights
        };
        // Velocity Verlet comes to complete rest on a floor. XPBD steps by itself.
        let integrator = if model.kind == "xpbd" { Integrator::default() } else { Integrator::VelocityVerlet };
        let mut world = self.world(model, integrator, State::at_rest(self.body.rest().to_vec()))?;
        world.advance(self.steps.min(20_000));
        let pairs = heights(state).into_iter().zip(heights(world.state()));
        Some(pairs.fold(0.0, |most: f64, (one, other)| most.max((one - other).abs())) / self.side)
    }
}

/// The watched values of a state.
struct Look {
    energy: f64,
    centre: DVec3,
    /// Momentum, and angular momentum about the centre of mass.
    momenta: [DVec3; 2],
    /// The sums of the sizes of all their terms.
    sizes: [f64; 2],
}

impl Look {
    fn of(trial: &Trial, world: &World) -> Self {
        let (d, state, mass) = (world.diagnostics(), world.state(), trial.body.mass());
        let whole: f64 = mass.iter().sum();
        let centre = mass.iter().zip(&state.position).map(|(&mass, &at)| at * mass).sum::<DVec3>() / whole;
        let (mut momenta, mut sizes) = ([DVec3::ZERO; 2], [0.0; 2]);
        for ((&mass, &at), &velocity) in mass.iter().zip(&state.position).zip(&state.velocity) {
            for (place, momentum) in [velocity * mass, (at - centre).cross(velocity * mass)].into_iter().enumerate() {
                momenta[place] += momentum;
            }
            sizes[0] += mass * velocity.length();
            sizes[1] += mass * velocity.length() * (at - centre).length();
        }
        Self { energy: d.kinetic + d.elastic + d.gravitational, centre, momenta, sizes }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/stress.rs"]
mod tests;
