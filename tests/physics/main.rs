//! The physics as the paper and its closed forms have it, without files and without a graphics device.

mod closed_forms;
mod conformance;
mod degenerate_starts;
mod fig4b;
mod figures;
mod support;
mod threads;
