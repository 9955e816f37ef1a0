//! The physics compared with the paper and with closed forms.

mod breaking;
mod carried;
mod closed_forms;
mod conformance;
mod contact;
mod continuum;
mod degenerate_starts;
#[allow(unreachable_pub, reason = "documentation shows it, too")]
mod example_model;
mod figures;
mod fill;
mod grips;
mod implicit;
mod integrators;
mod masses;
mod material;
mod metric;
mod own_method;
mod parts;
mod readings;
mod recording;
mod rest;
mod runaway;
mod shape_matching;
mod stability;
mod state;
mod support;
mod threads;
mod xpbd;
