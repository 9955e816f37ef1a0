//! The elastic models, one file each. The rest of the crate refers to them only through the list below.
//!
//! To add a model, write a file with three types: the model with its parameters resolved, which implements [`ElasticModel`]; the law of
//! its elements, which implements [`Law`] and may be the same type; and with the feature `scene` its `Parameters` in a scene file, which
//! implement `TypedModel`. Its forces are then [`ByLaw`], its steps and energies vectorised. Or write its forces alone, which implement
//! [`ForceModel`]. Then add it to the list.

pub(crate) mod blocks;
pub mod continuum;
pub mod corotational;
pub mod limited_springs;
pub mod linear;
pub mod mass_spring;
pub mod metric;
pub mod neo_hookean;
#[cfg(feature = "scene")]
mod parameters;
mod properties;
pub mod shape_based;
pub mod volume_springs;
pub mod xpbd;

use super::body::Body;
use super::crew::Crew;
use super::element::Dimension;
pub use super::kernel::{Compiled, Conditions, Vectorised};
pub use super::lanes::Lanes;
use super::law::{Breaking, Strained};
pub use super::law::{ByLaw, Corners, Element, Law};
use super::material::Material;
pub use super::mode::Mode;
use super::state::Nodes;
use super::volume::volumes_at_rest;
use glam::DVec3;
#[cfg(feature = "scene")]
pub use parameters::{ModelParameters, Ratio};
#[cfg(feature = "scene")]
use parameters::{TypedModel, breaks_at, damping, stiffness};
pub use properties::{Parameter, Properties, Setting};
use std::fmt::Debug;
use std::sync::{Arc, LazyLock};

/// A parameter of the model that does not fit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Misfit {
    /// The name of the parameter.
    pub key: &'static str,
    /// The mistake and its remedy.
    pub message: String,
}

/// An elastic model with all its parameters in SI units. It is immutable; [`Self::prepare`] makes the object that
/// evaluates the forces.
pub trait ElasticModel: Debug + Send + Sync {
    /// Its constants and parameters on a body.
    fn properties(&self, body: &Body) -> Properties;

    /// An upper bound of the stiffness and the damping of any mode in any state, divided by the masses; `None` if none is known.
    /// Where it suffices to show that a step is stable, no eigenvalue is computed.
    fn bound(&self, body: &Body) -> Option<Mode> {
        let _ = body;
        None
    }

    /// The material that the model is on a body, in uniform strain; `None` if it is none.
    fn material(&self, body: &Body) -> Option<Material> {
        self.properties(body).given_material()
    }

    /// The two nodes of each spring; empty for models without springs.
    fn springs(&self) -> &[[u32; 2]] {
        &[]
    }

    /// This model, if it has vectorised steps; `None` for a model that has the reference code only.
    fn vectorised(&self) -> Option<&dyn Vectorised> {
        None
    }

    /// The constraints on positions by which the model moves the nodes of a body itself, in place of forces; `None` for a model that exerts
    /// forces. A world then steps all its bodies by semi-implicit Euler, with the projections at the end, whatever its integrator. The forces
    /// that the model [prepares](Self::prepare) are those of the energy of the constraints.
    fn projection(&self, body: &Arc<Body>) -> Option<Box<dyn Projection>> {
        let _ = body;
        None
    }

    /// The memory at the start, with the nodes of `body` at `position` (m). Its length never changes.
    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        let _ = (body, position);
        Vec::new()
    }

    /// The evaluation of the forces on `body`. Vectorised steps make it, too, and may never use it.
    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel>;
}

/// The internal forces of a body, as a pure function: the same nodes and the same memory give the same forces and the
/// same next memory. So trial evaluations and rejected steps have no side effects. Forces and energies of an element are in
/// proportion to its [filled part](Body::fill) and to its [stiffness](Body::stiffness).
///
/// [`ByLaw`] makes them from the [`Law`] of the elements, which is less work and faster.
pub trait ForceModel: Send + Sync {
    /// Adds elastic and damping forces (N) to `forces`, one per node, and writes every entry of the `next` memory.
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]);

    /// Whether the forces depend on velocities.
    fn is_damped(&self) -> bool;

    /// Whether forces depend, beyond round-off, on the memory, that is, on the evaluation before. Methods that evaluate
    /// forces several times a step are of their order only if they do not.
    ///
    /// Broken elements do not count: they depend on the memory, but only once. Each evaluation passes its memory on to the next, so that an
    /// element that is strained too far at an inner stage of Runge–Kutta stays broken, even if the step ends without that strain.
    fn depends_on_history(&self) -> bool {
        false
    }

    /// Energy and residual, from the same computation as the forces with these nodes and this memory. Calls `share`
    /// for each element or spring, in order.
    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report;

    /// α of Eq. (18) of each element (rad/s²) at the evaluation of the forces with the nodes at `position` (m) that
    /// returned this memory; empty for a model without rotations.
    fn residuals(&self, position: &[DVec3], memory: &[f64]) -> Vec<f64> {
        let _ = (position, memory);
        Vec::new()
    }
}

/// Constraints on the nodes of a body, as a pure function of positions and memory. They move nodes in place of forces.
pub trait Projection: Send + Sync {
    /// Moves nodes that have gone freely for a step (s), none by more than its constraints demand in that step, from `position` (m) to the end of
    /// the step. Writes every entry of the `next` memory of the model.
    fn project(&self, nodes: Projected<'_>, step: f64, memory: &[f64], next: &mut [f64]);

    /// How many times as much as its stiffness says the body gives way in uniform strain, with a step (s).
    fn softening(&self, step: f64) -> f64 {
        let _ = step;
        1.0
    }
}

/// The nodes of a body that have gone freely for a step.
#[derive(Debug)]
pub struct Projected<'a> {
    /// The position of each node (m).
    pub position: &'a mut [DVec3],
    /// The inverse mass of each node (1/kg), zero for nodes that a kinematic constraint holds.
    pub inverse_mass: &'a [f64],
    /// The impulse on each node that is held (N s), to which a [`Projection`] adds its own.
    pub impulse: &'a mut [DVec3],
}

/// Forces that are prepared at their first use. Vectorised steps need none, and forces of large bodies take several times the
/// memory of a state.
struct Late<F>(LazyLock<F, Box<dyn FnOnce() -> F + Send>>);

impl<F: ForceModel + 'static> Late<F> {
    fn boxed(prepare: impl FnOnce() -> F + Send + 'static) -> Box<dyn ForceModel> {
        Box::new(Self(LazyLock::new(Box::new(prepare))))
    }
}

impl<F: ForceModel> ForceModel for Late<F> {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        self.0.add_forces(at, memory, next, scratch, forces);
    }

    fn is_damped(&self) -> bool {
        self.0.is_damped()
    }

    fn depends_on_history(&self) -> bool {
        self.0.depends_on_history()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        self.0.report(at, memory, share)
    }

    fn residuals(&self, position: &[DVec3], memory: &[f64]) -> Vec<f64> {
        self.0.residuals(position, memory)
    }
}

/// Called with the number of an element or spring, its nodes, and the part of its energy (J) that belongs to each node.
pub type Share<'a> = dyn FnMut(usize, &[u32], &[f64]) + 'a;

/// The threads of an evaluation, and a buffer for intermediate results, kept to avoid allocations. Its contents do not survive from one
/// evaluation to the next.
#[derive(Debug, Default)]
pub struct Scratch {
    vectors: Vec<DVec3>,
    crew: Arc<Crew>,
}

impl Scratch {
    /// A slice of this many vectors, with unspecified values.
    pub fn vectors(&mut self, count: usize) -> &mut [DVec3] {
        self.parts(count).1
    }

    /// The same beside the threads.
    pub(crate) fn parts(&mut self, count: usize) -> (&Crew, &mut [DVec3]) {
        if self.vectors.len() < count {
            self.vectors.resize(count, DVec3::ZERO);
        }
        (&self.crew, &mut self.vectors[..count])
    }

    /// Takes the threads for evaluations from now on.
    pub(crate) fn share(&mut self, crew: &Arc<Crew>) {
        self.crew.clone_from(crew);
    }
}

/// Energy and residual of a model in a state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Elastic energy (J); its negative gradient is the elastic forces. `None` for a model without energy.
    pub energy: Option<f64>,
    /// The largest α of Eq. (18) over all elements (rad/s²); `None` for a model without rotations.
    pub residual: Option<f64>,
}

/// Checks that a material gives each element of a body a stiffness.
fn check(Material { poisson, .. }: Material, body: &Body) -> Result<(), Misfit> {
    // The schema has the same bounds; scenes made in code pass them by.
    if !(0.0..0.5).contains(&poisson) {
        let message = format!("`poisson` is {poisson}; expected a number from 0 to less than 0.5");
        return Err(Misfit { key: "poisson", message });
    }
    if let Some(element) = volumes_at_rest(body).iter().position(|&volume| volume <= 0.0) {
        let measure = if body.dimension == Dimension::Plane { "area" } else { "volume" };
        let message = format!(
            "element {element} has no {measure}, so that a material gives it no stiffness; give `stiffness` (N/m) in place of `young`"
        );
        return Err(Misfit { key: "young", message });
    }
    Ok(())
}
