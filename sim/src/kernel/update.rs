//! The update of velocities and positions in lanes, from known forces: Eqs. (2) and (3) and alternatives, the test of the speed limit, and
//! contact.

use super::{Around, Resolve};
use crate::contact::{Bound, FrictionOf, Obstacle, Placed, ROUND_OFF, Shape};
use crate::lanes::{Lanes, MOST, each};
use glam::DVec3;

/// The part of a step that a pass computes from the forces of one evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stage {
    /// Eq. (2), then Eq. (3) with the new velocity.
    SemiImplicitEuler,
    /// Eq. (3) with the old velocity.
    ExplicitEuler,
    /// The first half of velocity Verlet: the new position, and the velocity predicted with constant acceleration.
    Drift,
    /// The second half of velocity Verlet, with the acceleration at the new position.
    Finish,
    /// The second half of one step and the first of the next, where the forces do not depend on velocities.
    FinishDrift,
    /// The first half with known accelerations: no force is evaluated.
    Coast,
    /// The first drift of a composition, by a share of the step: no force is evaluated.
    Leave(f64),
    /// A kick and a drift of a composition, by shares of the step.
    Kick([f64; 2]),
    /// The last kick and drift of a composition, with contact at the end.
    Arrive([f64; 2]),
}

impl Stage {
    /// Whether accelerations are kept from one stage to the next; in a composition it is the velocity at the start.
    pub(crate) fn keeps_acceleration(self) -> bool {
        !matches!(self, Self::SemiImplicitEuler | Self::ExplicitEuler)
    }

    /// Whether it reads the stored acceleration.
    pub(crate) fn loads_acceleration(self) -> bool {
        matches!(self, Self::Finish | Self::FinishDrift | Self::Coast | Self::Arrive(_))
    }

    /// Whether it changes the stored acceleration.
    pub(crate) fn stores_acceleration(self) -> bool {
        self.keeps_acceleration() && !matches!(self, Self::Coast | Self::Kick(_))
    }

    /// Whether forces are evaluated.
    pub(crate) fn has_forces(self) -> bool {
        !matches!(self, Self::Coast | Self::Leave(_))
    }

    /// Whether contact is computed at its end.
    pub(crate) fn has_contact(self) -> bool {
        !matches!(self, Self::Finish | Self::Leave(_) | Self::Kick(_))
    }
}

/// How one pass updates velocities and positions.
#[derive(Clone, Copy)]
pub(crate) struct NodeUpdate<'a, L> {
    stage: Stage,
    step: L,
    half: L,
    gravity: [L; 3],
    /// Damping in proportion to masses (1/s), if there is any.
    mass_damping: Option<L>,
    /// The squares of the speed limits at the end of the previous step and in the present one.
    limits: [L; 2],
    number: u64,
    bounds: &'a [Bound],
    around: Around<'a>,
}

/// A vector of nodes.
#[derive(Clone, Copy)]
pub(crate) struct NodeVector<L> {
    pub(crate) position: [L; 3],
    pub(crate) velocity: [L; 3],
    pub(crate) acceleration: [L; 3],
}

impl<'a, L: Lanes> NodeUpdate<'a, L> {
    #[inline(always)]
    pub(crate) fn new(stage: Stage, step: f64, number: u64, around: Around<'a>) -> Self {
        let limits = match stage {
            Stage::FinishDrift => [number - 1, number],
            _ => [number; 2],
        };
        Self {
            stage,
            step: L::splat(step),
            half: L::splat(0.5 * step),
            gravity: each!(3, axis => L::splat(around.gravity[axis])),
            mass_damping: (around.mass_damping > 0.0).then(|| L::splat(-around.mass_damping)),
            limits: each!(2, at => {
                let limit = (around.speed_limit)(limits[at]);
                L::splat(limit * limit)
            }),
            number,
            bounds: &around.bounds[(around.row)(number)],
            around,
        }
    }

    /// What the pass computes.
    #[inline(always)]
    pub(crate) fn stage(&self) -> Stage {
        self.stage
    }

    /// The forces of elements on nodes (N) with those from outside. `node` tells the node in each lane.
    #[inline(always)]
    pub(crate) fn pushed(&self, force: [L; 3], node: impl Fn(usize) -> usize) -> [L; 3] {
        if self.around.forces[0].is_empty() {
            return force;
        }
        let columns = columns(self.around.forces, each!(8, lane => node(lane.min(L::WIDTH - 1))), L::WIDTH);
        each!(3, axis => force[axis] + L::from_array(columns[axis]))
    }

    /// Moves nodes by their forces (N) and inverse masses (1/kg; zero in lanes without a node), and computes contact.
    /// `node` tells the node in each lane. Returns one bit for each lane that exceeds the speed limit.
    #[inline(always)]
    pub(crate) fn advance(
        &self,
        nodes: &mut NodeVector<L>,
        force: [L; 3],
        inverse_mass: L,
        node: impl Fn(usize) -> usize,
    ) -> u32 {
        let lost = self.go(nodes, force, inverse_mass);
        self.meet(nodes, inverse_mass, node);
        lost
    }

    /// The first half of [`Self::advance`]: velocities and positions.
    #[inline(always)]
    pub(crate) fn go(&self, nodes: &mut NodeVector<L>, force: [L; 3], inverse_mass: L) -> u32 {
        let zero = L::splat(0.0);
        let alive = zero.lt(inverse_mass);
        // The acceleration (m/s²).
        let mut now = each!(3, axis => force[axis].mul_add(inverse_mass, self.gravity[axis]).select(alive, zero));
        if let Some(damping) = self.mass_damping {
            now = each!(3, axis => damping.mul_add(nodes.velocity[axis], now[axis]));
        }
        let mut lost = 0;
        match self.stage {
            Stage::SemiImplicitEuler => {
                for axis in 0..3 {
                    nodes.velocity[axis] = now[axis].mul_add(self.step, nodes.velocity[axis]);
                    nodes.position[axis] = nodes.velocity[axis].mul_add(self.step, nodes.position[axis]);
                }
            }
            Stage::ExplicitEuler => {
                for axis in 0..3 {
                    nodes.position[axis] = nodes.velocity[axis].mul_add(self.step, nodes.position[axis]);
                    nodes.velocity[axis] = now[axis].mul_add(self.step, nodes.velocity[axis]);
                }
            }
            Stage::Drift => {
                nodes.acceleration = now;
                self.drift(nodes);
            }
            Stage::Coast => self.drift(nodes),
            Stage::Leave(share) => {
                nodes.acceleration = nodes.velocity;
                self.shift(nodes, share);
                return 0;
            }
            Stage::Kick([kick, drift]) => {
                self.kick(nodes, now, kick);
                self.shift(nodes, drift);
                return 0;
            }
            Stage::Arrive([kick, drift]) => {
                self.kick(nodes, now, kick);
                self.shift(nodes, drift);
                for axis in 0..3 {
                    nodes.acceleration[axis] = (nodes.velocity[axis] - nodes.acceleration[axis]).div(self.step);
                }
            }
            Stage::Finish | Stage::FinishDrift => {
                for axis in 0..3 {
                    let gain = now[axis] - nodes.acceleration[axis];
                    nodes.velocity[axis] = gain.mul_add(self.half, nodes.velocity[axis]);
                }
                nodes.acceleration = now;
                lost = self.lost(nodes, 0);
                if self.stage == Stage::Finish {
                    return lost;
                }
                self.drift(nodes);
            }
        }
        lost | self.lost(nodes, 1)
    }

    /// The lanes inside a bound, which need contact; also lanes without a node.
    #[inline(always)]
    pub(crate) fn near(&self, nodes: &NodeVector<L>) -> u32 {
        if !self.stage.has_contact() {
            return 0;
        }
        let mut near = 0;
        for bound in self.bounds {
            near |= L::bits(reaches(bound, nodes.position));
        }
        near
    }

    /// The second half of [`Self::advance`]: contact at the end of a step. It does nothing where no lane is
    /// [near](Self::near).
    #[inline(always)]
    pub(crate) fn meet(&self, nodes: &mut NodeVector<L>, inverse_mass: L, node: impl Fn(usize) -> usize) {
        let zero = L::splat(0.0);
        let inside = self.near(nodes) & L::bits(zero.lt(inverse_mass));
        if inside == 0 {
            return;
        }
        if let (Some(floor), false) = (self.around.floor, self.stage.keeps_acceleration()) {
            return rebound(floor, nodes, L::mask(inside));
        }
        let mut position = each!(3, axis => nodes.position[axis].to_array());
        let mut velocity = each!(3, axis => nodes.velocity[axis].to_array());
        // The constant acceleration in the step, or the mean one: zero, except in velocity Verlet and compositions.
        let rests = if self.stage.keeps_acceleration() { nodes.acceleration } else { [zero; 3] };
        let rests = each!(3, axis => rests[axis].to_array());
        let numbers = each!(8, lane => node(lane.min(L::WIDTH - 1)));
        touch(self.around.resolve, (self.number, numbers), inside, &mut position, &mut velocity, &rests);
        nodes.position = each!(3, axis => L::from_array(position[axis]));
        nodes.velocity = each!(3, axis => L::from_array(velocity[axis]));
    }

    /// `V += A ΔT` for a share of the step.
    #[inline(always)]
    fn kick(&self, nodes: &mut NodeVector<L>, acceleration: [L; 3], share: f64) {
        let step = self.step * L::splat(share);
        for axis in 0..3 {
            nodes.velocity[axis] = acceleration[axis].mul_add(step, nodes.velocity[axis]);
        }
    }

    /// `P += V ΔT` for a share of the step.
    #[inline(always)]
    fn shift(&self, nodes: &mut NodeVector<L>, share: f64) {
        let step = self.step * L::splat(share);
        for axis in 0..3 {
            nodes.position[axis] = nodes.velocity[axis].mul_add(step, nodes.position[axis]);
        }
    }

    /// The new position of velocity Verlet, and the velocity predicted with constant acceleration.
    #[inline(always)]
    fn drift(&self, nodes: &mut NodeVector<L>) {
        for axis in 0..3 {
            let predicted = nodes.acceleration[axis].mul_add(self.step, nodes.velocity[axis]);
            nodes.position[axis] = (nodes.velocity[axis] + predicted).mul_add(self.half, nodes.position[axis]);
            nodes.velocity[axis] = predicted;
        }
    }

    /// The lanes that exceed the speed limit or are NaN.
    #[inline(always)]
    fn lost(&self, nodes: &NodeVector<L>, at: usize) -> u32 {
        let [x, y, z] = nodes.velocity;
        let squared = z.mul_add(z, y.mul_add(y, x * x));
        !L::bits(squared.le(self.limits[at])) & L::ALL
    }
}

/// Computes contact for the lanes `inside` a bound. Not inlined: the fraction of nodes in contact varies from none to
/// all.
#[inline(never)]
fn touch(
    resolve: &Resolve<'_>,
    (number, nodes): (u64, [usize; MOST]),
    inside: u32,
    position: &mut [[f64; MOST]; 3],
    velocity: &mut [[f64; MOST]; 3],
    acceleration: &[[f64; MOST]; 3],
) {
    for lane in (0..MOST).filter(|lane| inside >> lane & 1 == 1) {
        let of = |all: &[[f64; MOST]; 3]| DVec3::from_array(all.map(|axis| axis[lane]));
        let (mut p, mut v) = (of(position), of(velocity));
        resolve(number, nodes[lane], &mut p, &mut v, of(acceleration));
        for axis in 0..3 {
            (position[axis][lane], velocity[axis][lane]) = (p[axis], v[axis]);
        }
    }
}

/// The rebound from a floor of nodes that moved at constant velocity: the operations of `Obstacle::push_out` in the
/// same order and with the same rounding.
#[inline(always)]
fn rebound<L: Lanes>(floor: &Placed<'_>, nodes: &mut NodeVector<L>, inside: L::Mask) {
    let &Obstacle { shape: Shape::Floor { normal, height }, restitution, friction, friction_of, .. } = floor.obstacle
    else {
        return;
    };
    let NodeVector { position, velocity, .. } = nodes;
    let dot = |a: [L; 3], b: [L; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (zero, one, e) = (L::splat(0.0), L::splat(1.0), L::splat(restitution));
    let normal = each!(3, axis => L::splat(normal[axis]));
    let depth = L::splat(height) - dot(normal, *position);
    let farthest = position[0].abs().max(position[1].abs().max(position[2].abs()));
    let round_off = L::splat(ROUND_OFF) * (L::splat(height.abs()) + farthest);
    let touches = L::both(inside, (-round_off).lt(depth));
    let approach = -dot(normal, *velocity);
    let (rise, speed) = (e * depth, e * approach);
    let slip = each!(3, axis => velocity[axis] + normal[axis] * approach);
    let slip_speed = dot(slip, slip).sqrt();
    let kept = (one - (L::splat(friction) * (approach + speed)).div(slip_speed)).max(zero);
    let kept = kept.select(zero.lt(slip_speed), zero);
    let approaches = L::both(touches, zero.lt(approach));
    let is_deep = L::both(touches, zero.lt(depth));
    for axis in 0..3 {
        let out = position[axis] + normal[axis] * (depth * (one + e));
        let mut bounced = position[axis] + normal[axis] * (depth + rise);
        if friction_of == FrictionOf::Path {
            let longest = L::splat(floor.step);
            let touching = (one + e) * (L::splat(2.0) * depth.max(zero)).div(approach + (approach * approach).sqrt());
            let time = touching.select(touching.lt(longest), longest);
            bounced = bounced - slip[axis] * time * (one - kept);
        }
        let turned = slip[axis] * kept + normal[axis] * speed + zero;
        position[axis] = bounced.select(approaches, out.select(is_deep, position[axis]));
        velocity[axis] = turned.select(approaches, velocity[axis]);
    }
}

/// The forces on the nodes of a vector, coordinate by coordinate; none on lanes without a node. It is apart from the loops over nodes of
/// all laws, each of which would be longer with it, and takes as long to compile.
#[cold]
#[inline(never)]
fn columns(forces: [&[f64]; 3], nodes: [usize; MOST], width: usize) -> [[f64; MOST]; 3] {
    let first = nodes[0];
    // Nodes of a body that is divided are in any order.
    if nodes[..width].iter().zip(first..).all(|(&node, next)| node == next)
        && let [Some(x), Some(y), Some(z)] = forces.map(|of| of.get(first..)?.first_chunk::<MOST>())
    {
        return [*x, *y, *z];
    }
    forces.map(|of| nodes.map(|node| of.get(node).copied().unwrap_or(0.0)))
}

/// The lanes inside a bound.
#[inline(always)]
fn reaches<L: Lanes>(bound: &Bound, [x, y, z]: [L; 3]) -> L::Mask {
    match bound {
        Bound::HalfSpace { normal, height } => {
            let [nx, ny, nz] = each!(3, axis => L::splat(normal[axis]));
            nz.mul_add(z, ny.mul_add(y, nx * x)).lt(L::splat(*height))
        }
        Bound::Box { low, high } => {
            let [lx, ly, lz] = each!(3, axis => L::splat(low[axis]));
            let [hx, hy, hz] = each!(3, axis => L::splat(high[axis]));
            let inside = L::both(L::both(lx.lt(x), x.lt(hx)), L::both(ly.lt(y), y.lt(hy)));
            L::both(inside, L::both(lz.lt(z), z.lt(hz)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Set, Work};
    use crate::motion::Motion;
    use crate::noise::Noise;

    struct Bounce<'a>(&'a Placed<'a>, [DVec3; MOST], [DVec3; MOST]);

    impl Work for Bounce<'_> {
        type Output = (usize, [[f64; MOST]; 3], [[f64; MOST]; 3]);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let Self(floor, position, velocity) = self;
            let lanes = |of: [DVec3; MOST]| each!(3, axis => L::from_array(of.map(|vector| vector[axis])));
            let acceleration = each!(3, _axis => L::splat(0.0));
            let mut nodes = NodeVector { position: lanes(position), velocity: lanes(velocity), acceleration };
            rebound(floor, &mut nodes, L::mask(L::ALL));
            let arrays = |of: [L; 3]| each!(3, axis => of[axis].to_array());
            (L::WIDTH, arrays(nodes.position), arrays(nodes.velocity))
        }
    }

    /// Above, below and on floors, with and without slip, friction and restitution.
    #[test]
    fn the_rebound_in_lanes_has_the_bits_of_the_plain_one() {
        let mut noise = Noise(9);
        for round in 0..400 {
            let normal =
                if round % 2 == 0 { DVec3::Y } else { DVec3::new(noise.next(), 1.0, noise.next()).normalize() };
            let pick = |of: [f64; 3]| of[round / 2 % 3];
            let (height, restitution, friction) = (noise.next(), pick([0.0, 0.5, 1.0]), pick([0.3, 0.0, 10.0]));
            let (shape, pivot) = (Shape::Floor { normal, height }, DVec3::ZERO);
            let friction_of = if round / 6 % 2 == 0 { FrictionOf::Path } else { FrictionOf::Velocity };
            let obstacle = Obstacle { shape, motion: Motion::Still, pivot, restitution, friction, friction_of };
            let floor = obstacle.at(1.0, 0.1);
            let position: [DVec3; MOST] = std::array::from_fn(|lane| {
                let free = noise.vector() * 0.1 + normal * height;
                if lane % 3 == 0 { free + normal * (height - normal.dot(free)) } else { free }
            });
            let velocity: [DVec3; MOST] = std::array::from_fn(|lane| match lane {
                0 => -normal,
                1 => DVec3::ZERO,
                _ => noise.vector(),
            });
            for set in Set::all() {
                let (width, p, v) = set.run(Bounce(&floor, position, velocity));
                for lane in 0..width {
                    let (mut at, mut speed) = (position[lane], velocity[lane]);
                    floor.rebound(&mut at, &mut speed, DVec3::ZERO);
                    let bits = |vector: DVec3| vector.to_array().map(f64::to_bits);
                    let of = |all: &[[f64; MOST]; 3]| all.map(|axis| axis[lane].to_bits());
                    assert_eq!((of(&p), of(&v)), (bits(at), bits(speed)), "{round} {lane} {floor:?}");
                }
            }
        }
    }
}
