//! The paper's numbers beside ours: Table 1, and the cost of the shape model over that of springs.
//!
//! A table is measured through a callback that is told of the work done and may stop it, and then says itself as text.
//! It knows neither files nor the command line. All simulation is that of [`Scene::world`](crate::scene::Scene::world)
//! on scenes that these tables write themselves.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod printed;
pub mod ratio;
mod sheet;
mod spread;
pub(crate) mod table1;
mod table1_text;

pub(crate) use sheet::Sheet;
pub(crate) use spread::Spread;

use crate::scene::{Limits, Scene};

/// Told how much work was just done; `false` stops the measurement. Called from any thread.
pub(crate) type Watch<'a> = dyn Fn(u64) -> bool + Sync + 'a;

/// A scene of our own, which has no mistakes.
fn scene(text: &str, name: &str) -> Scene {
    Scene::parse(text, name, &Limits::default()).unwrap_or_else(|error| panic!("a scene without mistakes: {error}"))
}
