//! The largest stable step of each integrator for one mode of vibration, `d²x/dt² = −a x − c dx/dt`.
//!
//! A linear system with symmetric, positive semidefinite stiffness and damping has eigenvectors that obey this equation with their
//! own Rayleigh quotients `a` and `c`, so a step that is stable for all eigenvectors is stable for the system.

use crate::integrate::Integrator;
use crate::mode::Mode;

/// `ωΔT` up to which an undamped oscillation is stable with PEFRL. [`tests`] compute it from the coefficients of the method.
///
/// The trace of the matrix of a step leaves [−2, 2] there.
const PEFRL: f64 = 2.9894;

impl Mode {
    /// The largest stable step (s): 0 if none is stable, infinite if all are.
    pub(crate) fn largest_step(self, integrator: Integrator) -> f64 {
        let Self { stiffness: a, damping: c } = self;
        if a <= 0.0 && c <= 0.0 {
            return f64::INFINITY;
        }
        match integrator {
            // The matrix of a step has the determinant 1 − cΔT and the trace 2 − aΔT² − cΔT: `aΔT² + 2cΔT < 4`.
            Integrator::SemiImplicitEuler => 4.0 / (c + (c * c + 4.0 * a).sqrt()),
            // Determinant 1 − cΔT + c²ΔT²/2 − acΔT³/4, trace 2 − aΔT² − cΔT + c²ΔT²/2 + acΔT³/4: `cΔT < 2` and
            // `aΔT² < 3 + (1 − cΔT)²`.
            Integrator::VelocityVerlet if a < c * c => 2.0 / c,
            Integrator::VelocityVerlet => 4.0 / (c + (4.0 * a - 3.0 * c * c).sqrt()),
            // `|1 + λΔT| < 1` for both roots λ of `λ² + cλ + a = 0`.
            Integrator::ExplicitEuler => {
                let discriminant = c * c - 4.0 * a;
                if discriminant < 0.0 { c / a } else { 4.0 / (c + discriminant.sqrt()) }
            }
            Integrator::Pefrl => PEFRL / a.sqrt(),
            Integrator::RungeKutta => self.largest_runge_kutta_step(),
            Integrator::BackwardEuler | Integrator::DormandPrince => f64::INFINITY,
        }
    }

    /// The weights of stiffness and damping in the search for a mode with a smaller limit than the `step` (s) of this mode: the
    /// outward normal of the region of stability.
    pub(super) fn outwards(self, integrator: Integrator, step: f64) -> [f64; 2] {
        let Self { stiffness: a, damping: c } = self;
        // The faster of two roots that do not oscillate: the largest `t` with an eigenvalue 0 of `t² − C t + K`.
        let slow = |root: f64| [-1.0, root];
        let discriminant = c * c - 4.0 * a;
        match integrator {
            Integrator::VelocityVerlet if a < c * c => [0.0, 1.0],
            Integrator::VelocityVerlet => [step, 2.0 * (1.0 - c * step)],
            Integrator::ExplicitEuler | Integrator::RungeKutta if discriminant >= 0.0 => {
                slow(0.5 * (c + discriminant.sqrt()))
            }
            Integrator::ExplicitEuler => [step, -1.0],
            _ => [step, 2.0],
        }
    }

    /// A step (s) that is stable for every mode with at most this stiffness and this damping; 0 if none is known.
    pub(crate) fn certain_step(self, integrator: Integrator) -> f64 {
        match integrator {
            Integrator::ExplicitEuler => 0.0,
            // With half the step of semi-implicit Euler, `aΔT² + cΔT ≤ 1`: inside both regions for all smaller `a` and `c`.
            Integrator::VelocityVerlet | Integrator::RungeKutta if self.damping > 0.0 => {
                0.5 * self.largest_step(Integrator::SemiImplicitEuler)
            }
            _ => self.largest_step(integrator),
        }
    }

    /// Where `|1 + z + z²/2 + z³/6 + z⁴/24| = 1` for `z = λΔT`, λ the faster root of `λ² + cλ + a = 0`. Found by bisection: seen
    /// from 0, each direction to the left leaves the region of stability once.
    fn largest_runge_kutta_step(self) -> f64 {
        /// `2√2` and 2.785 are the limits of oscillations and of pure damping; no direction reaches farther than this.
        const FARTHEST: f64 = 4.0;
        let Self { stiffness: a, damping: c } = self;
        let discriminant = c * c - 4.0 * a;
        let root = match discriminant < 0.0 {
            true => [-0.5 * c, 0.5 * (-discriminant).sqrt()],
            false => [-0.5 * (c + discriminant.sqrt()), 0.0],
        };
        let size = (root[0] * root[0] + root[1] * root[1]).sqrt();
        let grows = |reach: f64| {
            let z = root.map(|part| part / size * reach);
            let [mut re, mut im] = [1.0, 0.0];
            // By Horner's rule.
            for divisor in [4.0, 3.0, 2.0, 1.0] {
                [re, im] = [1.0 + (re * z[0] - im * z[1]) / divisor, (re * z[1] + im * z[0]) / divisor];
            }
            re * re + im * im > 1.0
        };
        let (mut low, mut high) = (1.0, FARTHEST);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if grows(middle) { high = middle } else { low = middle }
        }
        low / size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::composition;

    /// Half the trace of the matrix of a step of PEFRL at `ωΔT`.
    fn half_trace(phase: f64) -> f64 {
        let method = composition::PEFRL;
        let mut columns = [[1.0, 0.0], [0.0, 1.0]];
        for [x, v] in &mut columns {
            for at in 0..=method.evaluations() {
                *x += method.drift(at) * *v;
                if at < method.evaluations() {
                    *v -= method.kick(at) * phase * phase * *x;
                }
            }
        }
        0.5 * (columns[0][0] + columns[1][1])
    }

    #[test]
    fn the_limit_of_pefrl_follows_from_its_coefficients() {
        let is_stable = |phase: f64| half_trace(phase).abs() <= 1.0;
        let steps = (PEFRL * 1e4) as u32;
        assert!((1..=steps).all(|at| is_stable(f64::from(at) * 1e-4)));
        assert!(!is_stable(PEFRL + 3e-4));
    }

    /// The growth of a vector in one step of an integrator with one evaluation, in the long run.
    fn growth(integrator: Integrator, a: f64, c: f64) -> f64 {
        let step = |[x, v]: [f64; 2]| match integrator {
            Integrator::SemiImplicitEuler => {
                let v = v - a * x - c * v;
                [x + v, v]
            }
            Integrator::ExplicitEuler => [x + v, v - a * x - c * v],
            Integrator::VelocityVerlet => {
                let before = -a * x - c * v;
                let (next, predicted) = (x + v + 0.5 * before, v + before);
                [next, v + 0.5 * (before - a * next - c * predicted)]
            }
            _ => {
                let rate = |[x, v]: [f64; 2]| [v, -a * x - c * v];
                let along = |[dx, dv]: [f64; 2], share: f64| [x + share * dx, v + share * dv];
                let first = rate([x, v]);
                let second = rate(along(first, 0.5));
                let third = rate(along(second, 0.5));
                let last = rate(along(third, 1.0));
                [0, 1].map(|at| [x, v][at] + (first[at] + 2.0 * second[at] + 2.0 * third[at] + last[at]) / 6.0)
            }
        };
        let [[p, r], [q, s]] = [step([1.0, 0.0]), step([0.0, 1.0])];
        let (trace, determinant) = (p + s, p * s - q * r);
        let discriminant = trace * trace - 4.0 * determinant;
        if discriminant < 0.0 { determinant.sqrt() } else { 0.5 * (trace.abs() + discriminant.sqrt()) }
    }

    #[test]
    fn limits_with_damping_are_those_of_the_matrix_of_a_step() {
        let methods = [
            Integrator::SemiImplicitEuler,
            Integrator::VelocityVerlet,
            Integrator::ExplicitEuler,
            Integrator::RungeKutta,
        ];
        for (integrator, at) in methods.into_iter().flat_map(|one| (0..=40).map(move |at| (one, at))) {
            // From pure oscillation to overdamped.
            let damping = 0.1 * f64::from(at);
            let mode = Mode { stiffness: 1.0, damping };
            let limit = mode.largest_step(integrator);
            let at = |share: f64| {
                let step = share * limit;
                growth(integrator, step * step, damping * step)
            };
            if limit == 0.0 {
                assert_eq!((integrator, damping), (Integrator::ExplicitEuler, 0.0));
                continue;
            }
            for share in [0.2, 0.5, 0.9, 0.999] {
                assert!(at(share) <= 1.0 + 1e-12, "{integrator:?} {damping} {share}: {}", at(share));
            }
            assert!(at(1.001) > 1.0 + 1e-6, "{integrator:?} {damping}: {}", at(1.001));
        }
    }

    #[test]
    fn certain_steps_are_stable_for_every_softer_mode() {
        for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet, Integrator::RungeKutta] {
            for damping in [0.0, 0.1, 1.0, 3.0, 100.0] {
                let certain = Mode { stiffness: 1.0, damping }.certain_step(integrator);
                for (a, c) in (0..=20).flat_map(|a| (0..=20).map(move |c| (0.05 * f64::from(a), 0.05 * f64::from(c)))) {
                    let limit = Mode { stiffness: a, damping: c * damping }.largest_step(integrator);
                    assert!(limit >= certain * (1.0 - 1e-12), "{integrator:?} {a} {c}×{damping}: {limit} {certain}");
                }
            }
        }
    }
}
