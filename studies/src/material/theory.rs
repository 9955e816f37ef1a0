//! Closed forms of beams.

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
/// `load = P L²/EI`: the elastica.
///
/// Its slope obeys `θ'' = −(P L²/EI) cos θ`, with `θ(0) = 0` and `θ'(1) = 0` (K. Bisshopp, D. Drucker, Quarterly of Applied Mathematics 3, 272
/// (1945), by elliptic integrals). The curvature at the clamp is found by bisection.
pub(super) fn elastica(load: f64) -> [f64; 2] {
    // No slope exceeds a right angle, so the curvature at the clamp is at most √(2 load).
    let (mut low, mut high) = (0.0, libm::sqrt(2.0 * load));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if curve(load, middle)[1] < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let [_, _, across, along] = curve(load, 0.5 * (low + high));
    [across, 1.0 - along]
}

/// Slope, curvature and place of the end, across and along, from the curvature at the clamp. By Runge and Kutta's method.
fn curve(load: f64, curvature: f64) -> [f64; 4] {
    const STEPS: u32 = 1000;
    let step = 1.0 / f64::from(STEPS);
    let rate = |[slope, curvature, ..]: [f64; 4]| {
        let (sine, cosine) = libm::sincos(slope);
        [curvature, -load * cosine, sine, cosine]
    };
    let moved = |from: [f64; 4], rate: [f64; 4], by: f64| [0, 1, 2, 3].map(|at| from[at] + by * rate[at]);
    (0..STEPS).fold([0.0, curvature, 0.0, 0.0], |from, _| {
        let one = rate(from);
        let two = rate(moved(from, one, 0.5 * step));
        let three = rate(moved(from, two, 0.5 * step));
        let four = rate(moved(from, three, step));
        let mean = [0, 1, 2, 3].map(|at| (one[at] + 2.0 * two[at] + 2.0 * three[at] + four[at]) / 6.0);
        moved(from, mean, step)
    })
}
