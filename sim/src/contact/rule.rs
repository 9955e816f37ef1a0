//! The rule of contact between surfaces: a closest pair of points at the start of a step gets an impulse at its end.
//!
//! The pair keeps its direction and its weights for the whole step. So its impulse acts along the line through both points, before
//! and after it: without friction it has no torque. The velocity in the middle of the step, which semi-implicit Euler conserves the
//! energy of, decides the rebound. Whatever approaches along the line cannot pass within one step, however fast it is.
//!
//! Impulses that are distributed over nodes by weights: F. Cirak and M. West, Int. J. Numer. Meth. Engng 64, 1078 (2005).

use super::end::{Ends, Timing};
use glam::{DMat3, DVec2, DVec3};

/// How two surfaces meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law {
    /// The distance that is kept (m).
    pub(super) gap: f64,
    /// Restitution coefficient `e`.
    pub(super) restitution: f64,
    /// Friction coefficient `μ`.
    pub(super) friction: f64,
}

impl Law {
    /// The law for points whose distance is a local minimum only nearly: they may come nearer, and rebound less. A push along the line between
    /// them would brake what slides over a flat surface, at each of its edges. These shares lose little speed there, and let hardly anything cross.
    fn of_nearly_least(self) -> Self {
        Self { gap: 0.25 * self.gap, restitution: 0.5 * self.restitution, ..self }
    }
}

/// A node of the features with a pair of closest points, with its weight: positive on the first surface, negative on the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    pub(super) node: u32,
    pub(super) weight: f64,
}

/// A pair of closest points at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// The point on the first surface (m).
    pub(super) at: DVec3,
    /// Unit vector from the point on the second surface to that on the first.
    pub(super) normal: DVec3,
    /// Their distance at the start of the step (m).
    pub(super) distance: f64,
    /// Whether the whole law holds: the distance is a local minimum on both surfaces, or they are of one body, whose folds press on each
    /// other along lines that lean.
    pub(super) keeps_law: bool,
    /// The velocity (m/s) by which the surface of a round obstacle that turns moves along at the contact, beside that of its axis.
    pub(super) drag: DVec3,
    /// Where its terms begin and end.
    pub(super) terms: [u32; 2],
}

/// Whether all further bounces of a pair would be over within some steps, so that it comes to rest now: with a restitution below 1 each one is
/// shorter than the one before, which steps cannot follow. In a step that has gained `gained` of approach (m/s), bounces at the speed `start`
/// (m/s), negative where the pair approaches at the start of the step, last `2 e |start|/gained` steps, and all after it `1/(1 − e)` times as long.
fn ends_bouncing(restitution: f64, start: f64, gained: f64) -> bool {
    const STEPS: f64 = 4.0;
    2.0 * restitution * (-start).max(0.0) < STEPS * (1.0 - restitution) * gained
}

impl Ends {
    pub(super) fn place(&self, node: u32) -> DVec3 {
        self.position[node as usize]
    }

    fn speed(&self, node: u32) -> DVec3 {
        self.motion[node as usize].velocity
    }

    fn mobility(&self, node: u32) -> f64 {
        self.motion[node as usize].inverse_mass
    }

    /// Momentum (kg m/s) and angular momentum about the origin (kg m²/s) of the nodes of a pair that are free, on each of its sides: those
    /// of the first surface are numbered before `second`.
    fn momenta(&self, terms: &[Term], second: u32) -> [[DVec3; 2]; 2] {
        let mut sums = [[DVec3::ZERO; 2]; 2];
        for &Term { node, .. } in terms.iter().filter(|term| self.mobility(term.node) > 0.0) {
            let momentum = self.speed(node) / self.mobility(node);
            let [sum, turn] = &mut sums[usize::from(node >= second)];
            *sum += momentum;
            *turn += self.place(node).cross(momentum);
        }
        sums
    }

    /// As [`Self::resolve`]. Returns by how much the pair changes momentum (N s) and angular momentum about the origin (N m s) on each of its sides;
    /// `None` if it changes nothing. A node that is held counts with its share of the impulse.
    pub(super) fn resolve_and_tell(
        &mut self,
        law: Law,
        touch: &Touch,
        terms: &[Term],
        second: u32,
    ) -> Option<([[DVec3; 2]; 2], DVec3)> {
        let before = self.momenta(terms, second);
        let impulse = self.resolve(law, touch, terms);
        let after = self.momenta(terms, second);
        let mut sums = [0, 1].map(|side| [0, 1].map(|at| after[side][at] - before[side][at]));
        for &Term { node, weight } in terms.iter().filter(|term| self.mobility(term.node) == 0.0) {
            let [sum, turn] = &mut sums[usize::from(node >= second)];
            *sum += impulse * weight;
            *turn += self.place(node).cross(impulse * weight);
        }
        (impulse != DVec3::ZERO || sums != [[DVec3::ZERO; 2]; 2]).then_some((sums, impulse))
    }

    /// Gives a pair its impulse, and returns it (N s): that on the first surface.
    pub(super) fn resolve(&mut self, law: Law, touch: &Touch, terms: &[Term]) -> DVec3 {
        let Touch { normal, distance, keeps_law, drag, .. } = *touch;
        let Law { gap, restitution, friction } = if keeps_law { law } else { law.of_nearly_least() };
        let way: DVec3 = terms.iter().map(|&Term { node, weight }| self.place(node) * weight).sum();
        let reached = normal.dot(way);
        if reached >= gap {
            return DVec3::ZERO;
        }
        let (mut mobility, mut is_free, mut speed, mut slowed) = (0.0, true, DVec3::ZERO, DVec3::ZERO);
        for &Term { node, weight } in terms {
            let own = &self.motion[node as usize];
            mobility += weight * weight * own.inverse_mass;
            is_free &= own.inverse_mass > 0.0;
            speed += own.velocity * weight;
            slowed += own.slowed * weight;
        }
        if mobility == 0.0 {
            return DVec3::ZERO;
        }
        let relative = speed - drag;
        let along = normal.dot(relative);
        // How much the step has added to the approach; the speeds that decide the rebound, and the mean one in the step.
        let gained = normal.dot(slowed);
        let [bounced, moved] = self.timing.lags().map(|lag| along + lag * gained);
        let restitution = if ends_bouncing(restitution, along + gained, gained) { 0.0 } else { restitution };
        // The speed that leaves the pair as near as it may come, and the one that throws it back.
        let apart = (gap.min(distance) - distance) / self.step - moved;
        let back = -(1.0 + restitution) * bounced;
        let kick = apart.max(back).max(0.0);
        let short = (gap - reached - self.step * kick).max(0.0);
        let slip = relative - normal * along;
        let slip_speed = slip.length();
        let hold = if slip_speed > 0.0 { (friction * kick / slip_speed).min(1.0) } else { 0.0 };
        let impulse = (normal * kick - slip * hold) / mobility;
        let out = normal * (short / mobility);
        for &Term { node, weight } in terms {
            let own = &mut self.motion[node as usize];
            let share = weight * own.inverse_mass;
            if share != 0.0 {
                own.velocity += impulse * share;
                own.is_changed = true;
                self.position[node as usize] += (impulse * self.step + out) * share;
            }
        }
        if self.timing == Timing::End && is_free {
            // The change of Σ m x × v by the impulse and by the push.
            let torque = (way - speed * self.step).cross(impulse) + out.cross(speed + impulse * mobility);
            // Without friction only the round-off of positions is left.
            let round_off = 8.0 * f64::EPSILON * self.place(terms[0].node).length() * impulse.length();
            if torque.length_squared() > round_off * round_off {
                self.turn_back(terms, torque);
            }
        }
        impulse
    }

    /// Turns the nodes of a pair so that they lose an angular momentum (kg m²/s), unless they lie too near one line for it.
    fn turn_back(&mut self, terms: &[Term], torque: DVec3) {
        /// The least determinant of an inertia tensor, relative to that of a ball with the same trace.
        const ROUND: f64 = 1e-3;
        let from = self.place(terms[0].node);
        let (mut whole, mut centre, mut outer) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for &Term { node, .. } in terms {
            let (mass, arm) = (self.mobility(node).recip(), self.place(node) - from);
            let heavy = arm * mass;
            whole += mass;
            centre += heavy;
            outer += DMat3::from_cols(heavy * arm.x, heavy * arm.y, heavy * arm.z);
        }
        let centre = centre / whole;
        let heavy = centre * whole;
        outer -= DMat3::from_cols(heavy * centre.x, heavy * centre.y, heavy * centre.z);
        let trace = outer.x_axis.x + outer.y_axis.y + outer.z_axis.z;
        let (inertia, centre) = (DMat3::from_diagonal(DVec3::splat(trace)) - outer, from + centre);
        let mean = 2.0 * trace / 3.0;
        let is_plane = torque.truncate() == DVec2::ZERO && inertia.z_axis.truncate() == DVec2::ZERO;
        let spin = if is_plane {
            torque / inertia.z_axis.z
        } else if inertia.determinant() > ROUND * mean * mean * mean {
            inertia.inverse() * torque
        } else {
            return;
        };
        for &Term { node, .. } in terms {
            let arm = self.place(node) - centre;
            let own = &mut self.motion[node as usize];
            own.velocity -= spin.cross(arm);
            own.is_changed = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ends_bouncing;

    /// With e = ½ and a gain of 1 m/s in a step, a bounce at 2 m/s lasts two steps, the next one step, and all of them four.
    #[test]
    fn bounces_end_when_all_would_be_over_in_four_steps() {
        assert!(ends_bouncing(0.5, -1.99, 1.0) && !ends_bouncing(0.5, -2.01, 1.0));
        // Elastic ones never end, and without a force towards each other there is one only.
        assert!(!ends_bouncing(1.0, -1e-9, 1.0) && !ends_bouncing(1.0, 1.0, 1.0));
        assert!(!ends_bouncing(0.5, -1e-9, 0.0) && !ends_bouncing(0.5, -1.0, -1.0));
        // What parts at the start of a step and is pressed together in it does not bounce.
        assert!(ends_bouncing(0.5, 0.1, 1.0));
    }
}
