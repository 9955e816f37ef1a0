//! The physics compared with the paper and with closed forms, without files and without a graphics device.

mod asked;
mod checkpoints;
mod closed_forms;
mod conformance;
mod contact;
mod degenerate_starts;
#[allow(unreachable_pub, reason = "documentation shows it, too")]
mod example_model;
mod fig4a;
mod fig4b;
mod fig4c;
mod figures;
mod free_form;
mod grips;
mod integrators;
mod masses;
mod readings;
mod rest;
mod restore;
mod runaway;
mod stability;
mod state;
mod support;
mod threads;
