//! Closed forms of beams.

use super::rod::Rod;
use glam::DVec3;
use localshape::sim::Material;

/// The deflection of the end of a cantilever under a load (N) across it at its end, by Timoshenko's theory of small deflections (m), with
/// a rectangular section of `width` and `depth` (m).
///
/// S. Timoshenko, Philosophical Magazine 41, 744 (1921). The shear coefficient is that of G. Cowper, "The shear coefficient in Timoshenko's
/// beam theory", Journal of Applied Mechanics 33, 335 (1966): 5/6 without contraction.
pub(super) fn timoshenko(material: Material, length: f64, [width, depth]: [f64; 2], load: f64) -> f64 {
    let Material { young, poisson } = material;
    let coefficient = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    let (area, inertia) = (width * depth, width * depth * depth * depth / 12.0);
    load * length * length * length / (3.0 * young * inertia) + load * length / (coefficient * material.shear() * area)
}

/// Across and along, over its length, the deflection of the end of a thin cantilever under a load that keeps its direction, with
/// `load = P L²/EI`: the elastica, a rod that neither shears nor stretches (K. Bisshopp, D. Drucker, Quarterly of Applied Mathematics 3, 272
/// (1945), by elliptic integrals).
pub(super) fn elastica(load: f64) -> [f64; 2] {
    let rod = Rod { length: 1.0, curvature: DVec3::ZERO, turning: DVec3::ONE, pulling: DVec3::INFINITY };
    let end = rod.dead(DVec3::X * load);
    [end.x, 1.0 - end.z]
}
