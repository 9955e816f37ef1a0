//! The physics compared with the paper and with closed forms.

mod allocations;
mod body;
mod breaking;
mod carried;
mod change;
mod closed_forms;
mod conformance;
mod contact;
#[cfg(feature = "scene")]
mod continuum;
mod crumpled;
mod degenerate_starts;
mod equilibrium;
#[allow(unreachable_pub, reason = "documentation shows it, too")]
mod example_model;
mod figures;
#[cfg(feature = "scene")]
mod fill;
mod forces;
mod grips;
mod grounds;
#[cfg(feature = "scene")]
mod implicit;
mod integrators;
mod loads;
mod machines;
#[cfg(feature = "scene")]
mod mass_damping;
mod masses;
#[cfg(feature = "scene")]
mod material;
mod meeting;
#[cfg(feature = "scene")]
mod metric;
mod overlaps;
mod own_method;
mod parts;
mod readings;
mod recording;
mod rest;
mod runaway;
#[cfg(feature = "scene")]
mod settled;
mod shape_matching;
mod sliding;
mod stability;
mod state;
mod support;
mod surfaces;
mod threads;
mod touching;
mod xpbd;

use localshape_sim::Integrator;

/// All integrators.
const INTEGRATORS: [Integrator; 7] = [
    Integrator::SemiImplicitEuler,
    Integrator::ExplicitEuler,
    Integrator::VelocityVerlet,
    Integrator::Pefrl,
    Integrator::RungeKutta,
    Integrator::DormandPrince,
    Integrator::BackwardEuler,
];
