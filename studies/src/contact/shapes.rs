//! Ten situations in which methods of contact fail, each from several disturbed starts: nothing crosses.
//!
//! They are those of K. Erleben, "Methodology for assessing mesh-based contact point methods", ACM Transactions on Graphics 37, 39 (2018), with
//! the proportions of the meshes that `ipc-sim/IPC` has of them: a spike is a pyramid of 1×1×3, a wedge a prism of 1×2×3. Here the unit is two
//! cells, all bodies are soft, and the lower ones lie on a floor.

use super::bodies::{GRAVITY, MASS, Placed, SIDE, Setting, cubes, obstacle};
use super::solids::{HEIGHT, cliff, crack, hole, slab, spike, wedge};
use super::{Measured, Trial};
use crate::random::Random;
use glam::{DQuat, DVec3};
use localshape::sim::{Body, Shape, Status};
use std::sync::Arc;

/// How fast upper bodies fall at the start, and how fast those go sideways that slide (m/s).
const SPEED: f64 = 1.0;

/// A body that falls on another one.
struct Situation {
    name: &'static str,
    /// The upper body, and its height from its lowest point to its origin (cells).
    upper: (Arc<Body>, f64),
    /// The lower body, and the height at which the upper one meets it (cells).
    lower: (Arc<Body>, f64),
    slides: bool,
}

/// All situations, in the order of the paper's names.
fn situations() -> [Situation; 10] {
    let (spike, wedge, cube) = ((spike(), HEIGHT), (wedge(), HEIGHT), (cubes([2; 3]), 1.0));
    let plate = |body: Arc<Body>| (body, 2.0);
    let on = |name: &'static str, upper: &(Arc<Body>, f64), lower: (Arc<Body>, f64), slides: bool| Situation {
        name,
        upper: upper.clone(),
        lower,
        slides,
    };
    [
        on("spike on spike", &spike, spike.clone(), false),
        on("spike on wedge", &spike, wedge.clone(), false),
        on("wedge on wedge", &wedge, wedge.clone(), false),
        on("spike in a hole", &spike, plate(hole()), true),
        on("spike in a crack", &spike, plate(crack()), true),
        on("wedge in a crack", &wedge, plate(crack()), true),
        on("sliding spike", &spike, plate(slab([8, 4])), true),
        on("sliding wedge", &wedge, plate(slab([8, 6])), true),
        on("internal edges", &cube, plate(slab([8, 4])), true),
        on("cliff edges", &cube, plate(cliff()), false),
    ]
}

pub(super) fn trials(starts: u64) -> Vec<Trial> {
    (0..10).map(|at| Box::new(move || vec![falls(at, starts)]) as Trial).collect()
}

/// The number of disturbed starts after which triangles cross in any frame of a second.
fn falls(at: usize, starts: u64) -> Measured {
    let Situation { name, upper: (upper, below), lower: (lower, top), slides } =
        situations().into_iter().nth(at).expect("one of the ten");
    let mut setting = Setting::new(1e4, [0.2, 0.3]);
    setting.damping = 0.1 * (setting.stiffness * MASS).sqrt();
    setting.around.gravity = DVec3::Y * -GRAVITY;
    setting.around.obstacles = vec![obstacle(Shape::Floor { normal: DVec3::Y, height: 0.0 }, [0.2, 0.5])];
    let crosses = |&start: &u64| {
        let mut random = Random(1000 * at as u64 + start);
        let mut small = || 0.1 * SIDE * (2.0 * random.next() - 1.0);
        let aside = DVec3::new(small(), small().abs(), small());
        let upside = if below == HEIGHT { DQuat::from_rotation_z(std::f64::consts::PI) } else { DQuat::IDENTITY };
        let first = Placed {
            at: DVec3::Y * ((top + below + 0.1) * SIDE) + aside,
            turned: DQuat::from_rotation_y(small()) * upside,
            speed: DVec3::new(if slides { SPEED } else { 0.0 }, -SPEED, 0.0),
            body: Arc::clone(&upper),
        };
        let mut world = setting.world(&[first, Placed::still(&lower, DVec3::ZERO)]);
        (0..60).any(|_| {
            world.advance(setting.steps(1.0 / 60.0));
            world.status() != Status::Ok || world.crossings().is_some_and(|found| !found.is_empty())
        })
    };
    let crossed = (1..=starts).filter(crosses).count();
    Measured::most(format!("{name}: of {starts} falls those in which triangles cross"), crossed as f64, 0.0)
}
