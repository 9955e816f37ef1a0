//! The paper's numbers compared with ours: Table 1, and the ratio of computation times of the shape model and springs.
//!
//! A measurement reports its progress to a callback that may stop it; its result is then formatted. It does not depend
//! on files or the command line. All simulations use [`Scene::world`](crate::scene::Scene::world) with scenes that this
//! module writes.

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

/// Called with the amount of work just done, from any thread; `false` stops the measurement.
pub(crate) type Watch<'a> = dyn Fn(u64) -> bool + Sync + 'a;

/// The times of so many turns of each of `count` tasks, which `time` does by their numbers; `None` if `watch`, which is called
/// after each turn, stops them. The order is rotated, so that no task always follows the same one.
pub(crate) fn take_turns(
    count: usize,
    rounds: u32,
    watch: &Watch<'_>,
    mut time: impl FnMut(usize) -> f64,
) -> Option<Vec<Vec<f64>>> {
    let mut times = vec![Vec::new(); count];
    for turn in 0..count * rounds as usize {
        let number = (turn / count + turn) % count;
        times[number].push(time(number));
        if !watch(1) {
            return None;
        }
    }
    Some(times)
}

/// A scene written by this module, which has no mistakes.
fn scene(text: &str, name: &str) -> Scene {
    Scene::parse(text, name, &Limits::default()).unwrap_or_else(|error| panic!("a scene without mistakes: {error}"))
}
