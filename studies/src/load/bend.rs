//! An arc of 45° that is bent out of its plane.
//!
//! K. Bathe, S. Bolourchi, International Journal for Numerical Methods in Engineering 14, 961 (1979), print (15.9, 47.2, 53.4) as the place of its end;
//! J. Simo, L. Vu-Quoc, Computer Methods in Applied Mechanics and Engineering 58, 79 (1986), print (15.79, 47.23, 53.37). The former, as the way
//! (−13.4, 53.4, −23.5) from (29.29, 70.71, 0), is quoted by the tests of `OpenFAST` (`bd_curved_beam` of BeamDyn) and by the documentation of Kynema.

use super::Case;
use crate::material::{Bar, Model, Rod, moved, rest_of};
use glam::DVec3;
use localshape::sim::Material;
use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

const MATERIAL: Material = Material { young: 1e7, poisson: 0.0 };
const RADIUS: f64 = 100.0;
const LOAD: f64 = 600.0;

pub(super) const CASE: Case = Case {
    name: "An arc of 45° bent out of its plane",
    what: "A cantilever that is an arc of 45° and radius 100 with a section of 1 × 1, `E = 1e7`, `ν = 0`, has a force of 600 on its end at right angles to its \
           plane (Bathe and Bolourchi 1979). The way of the end of a rod (Reissner 1973) over that of its end.",
    measure,
    levels: 2,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let across = 1 << refined;
    let along = libm::round(RADIUS * FRAC_PI_4) as u32 * across;
    let straight = Bar::new(model.elements, [across, across, along], 1.0 / f64::from(across), 1.0);
    // From a bar along z, with its corner at y = 0.
    let place = |at: DVec3| {
        let (sine, cosine) = libm::sincos((at.z / straight.length + 0.5) * FRAC_PI_4);
        DVec3::new(RADIUS - (RADIUS + at.x) * cosine, (RADIUS + at.x) * sine, at.y)
    };
    let body = moved(&straight.body, place);
    let made = model.on(&body, MATERIAL, 1.0 / f64::from(across))?;
    let around = straight.under(DVec3::Z * LOAD);
    let found = rest_of(&[(Arc::clone(&body), made.as_ref())], body.rest().to_vec(), &around, 1.0)?;
    let whole = straight.load(DVec3::Z * LOAD);
    let ways = whole.iter().zip(&found).zip(body.rest()).map(|((force, now), rest)| (*now - *rest) * (force.z / LOAD));
    let start = DVec3::new(RADIUS * (1.0 - libm::cos(FRAC_PI_4)), RADIUS * libm::sin(FRAC_PI_4), 0.0);
    Some((end() - start).length() / ways.sum::<DVec3>().length())
}

/// The end of a rod.
pub(super) fn end() -> DVec3 {
    let rod = Rod::square(RADIUS * FRAC_PI_4, DVec3::NEG_Y / RADIUS, MATERIAL);
    let DVec3 { x, y, z } = rod.dead(DVec3::Y * LOAD);
    DVec3::new(-x, z, y)
}
