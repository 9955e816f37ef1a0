//! A rod that bends, twists, shears and stretches: what a slender bar under a load at its end is in the limit.
//!
//! E. Reissner, Studies in Applied Mathematics 52, 87 (1973); J. Simo, Computer Methods in Applied Mechanics and Engineering 49, 55 (1985).

use glam::{DMat3, DVec3};
use localshape::sim::Material;

/// The torsion constant of a square over the fourth power of its side: A. Saint-Venant, 1855; S. Timoshenko, J. Goodier, Theory of Elasticity
/// (1951), article 94.
pub(crate) const SQUARE: f64 = 0.140_577;

/// A rod that is clamped at one end. Vectors are in the axes of a section, of which the third one is along the rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rod {
    pub(crate) length: f64,
    /// The curvature at rest (1/m).
    pub(crate) curvature: DVec3,
    /// The stiffness against bending and twist (N m²), and against shear and stretch (N).
    pub(super) turning: DVec3,
    pub(super) pulling: DVec3,
}

impl Rod {
    /// A rod of a material with a square section of side 1.
    pub(crate) fn square(length: f64, curvature: DVec3, material: Material) -> Self {
        let (young, shear) = (material.young, material.shear());
        let turning = DVec3::new(young / 12.0, young / 12.0, SQUARE * shear);
        let pulling = DVec3::new(5.0 / 6.0 * shear, 5.0 / 6.0 * shear, young);
        Self { length, curvature, turning, pulling }
    }

    /// The place of the free end under a force (N) that turns with it, in the axes of the clamped end and from there (m).
    pub(crate) fn followed(&self, force: DVec3) -> DVec3 {
        self.end(force).0
    }

    /// The same under a force that keeps its direction.
    pub(crate) fn dead(&self, force: DVec3) -> DVec3 {
        const PARTS: u32 = 8;
        let mut inside = DVec3::ZERO;
        for force in (1..=PARTS).map(|part| force * f64::from(part) / f64::from(PARTS)) {
            // Newton's method, for the force in the axes of the free end.
            for _ in 0..8 {
                let off = |inside: DVec3| self.end(inside).1 * inside - force;
                let small = 1e-6 * force.length();
                let by = |axis: DVec3| (off(inside + axis * small) - off(inside - axis * small)) / (2.0 * small);
                inside -= DMat3::from_cols(by(DVec3::X), by(DVec3::Y), by(DVec3::Z)).inverse() * off(inside);
            }
        }
        self.end(inside).0
    }

    /// Where the free end is in the axes of the clamped one, and its own axes there, with a force in these: from the free end inwards, by
    /// Runge and Kutta's method.
    fn end(&self, force: DVec3) -> (DVec3, DMat3) {
        const STEPS: u32 = 400;
        let step = self.length / f64::from(STEPS);
        let rate = |(place, axes): (DVec3, DMat3)| {
            let turn = axes * (axes.transpose() * force.cross(place) / self.turning + self.curvature);
            let along = axes * (DVec3::Z + axes.transpose() * force / self.pulling);
            let turned = |axis: DVec3| axis.cross(turn);
            (-along, DMat3::from_cols(turned(axes.x_axis), turned(axes.y_axis), turned(axes.z_axis)))
        };
        let moved = |from: (DVec3, DMat3), rate: (DVec3, DMat3), by: f64| (from.0 + rate.0 * by, from.1 + rate.1 * by);
        let (place, axes) = (0..STEPS).fold((DVec3::ZERO, DMat3::IDENTITY), |from, _| {
            let one = rate(from);
            let two = rate(moved(from, one, 0.5 * step));
            let three = rate(moved(from, two, 0.5 * step));
            let four = rate(moved(from, three, step));
            [(one, 1.0), (two, 2.0), (three, 2.0), (four, 1.0)]
                .iter()
                .fold(from, |to, &(rate, weight)| moved(to, rate, weight * step / 6.0))
        });
        (axes.transpose() * -place, axes.transpose())
    }
}
