//! Prescribed motions of obstacles and kinematic constraints.

use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};
use std::fmt;
use std::sync::Arc;

/// A rigid displacement: a rotation about a pivot, then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The translation (m).
    pub shift: DVec3,
    /// The rotation about the pivot.
    pub rotation: DQuat,
}

impl Pose {
    /// No displacement.
    pub const NONE: Self = Self { shift: DVec3::ZERO, rotation: DQuat::IDENTITY };

    /// The new place of a point (m) of the body.
    pub fn apply(&self, pivot: DVec3, point: DVec3) -> DVec3 {
        pivot + self.shift + self.rotation * (point - pivot)
    }

    /// The point (m) of the body that is moved to `point`.
    pub fn undo(&self, pivot: DVec3, point: DVec3) -> DVec3 {
        pivot + self.rotation.conjugate() * (point - pivot - self.shift)
    }
}

/// A rigid displacement as written in a scene: the rotation is a vector, so that it can be more than one turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offset {
    /// The translation (m).
    pub shift: DVec3,
    /// Rotation vector: axis times angle (rad).
    pub rotation: DVec3,
}

impl Offset {
    fn pose(self) -> Pose {
        Pose { shift: self.shift, rotation: quaternion(self.rotation) }
    }

    fn lerp(self, other: Self, share: f64) -> Self {
        Self { shift: self.shift.lerp(other.shift, share), rotation: self.rotation.lerp(other.rotation, share) }
    }
}

/// The time interval of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Its start (s).
    pub begin: f64,
    /// Its end (s).
    pub end: f64,
    /// Its length ΔT (s). Start and end are multiples of it, rounded.
    pub step: f64,
}

impl Interval {
    /// The time (s) after a share of it.
    pub fn after(&self, share: f64) -> f64 {
        if share == 1.0 { self.end } else { self.begin + share * self.step }
    }
}

/// A displacement at a time: a key of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The time (s).
    pub time: f64,
    /// The displacement.
    pub offset: Offset,
}

/// The interpolation of a path between keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "scene", serde(rename_all = "kebab-case"))]
pub enum Ease {
    /// Starts and ends at rest: after the fraction `s` of the time the path has covered the fraction `(1 − cos πs)/2`.
    #[default]
    Smooth,
    /// At constant speed.
    Linear,
}

impl Ease {
    pub(crate) fn share(self, s: f64) -> f64 {
        match self {
            // With the same bits on every machine: this library uses basic arithmetic only.
            Self::Smooth => 0.5 * (1.0 - libm::cos(PI * s)),
            Self::Linear => s,
        }
    }

    /// The greatest speed between two keys divided by the mean speed.
    fn peak(self) -> f64 {
        match self {
            Self::Smooth => 0.5 * PI,
            Self::Linear => 1.0,
        }
    }
}

/// A displacement as a function of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Motion {
    /// No motion.
    #[default]
    Still,
    /// From key to key, with rising times. Before the first key the displacement is that of the first, after the last
    /// key that of the last.
    Keys {
        /// The keys, at least one.
        keys: Vec<Key>,
        /// The interpolation between them.
        ease: Ease,
        /// Whether the path starts again at the first key when it has reached the last one.
        repeat: bool,
    },
    /// An oscillation about the initial position: `sin(2π t / period + phase)` times an amplitude.
    Swing {
        /// Period (s).
        period: f64,
        /// Phase at time zero (rad).
        phase: f64,
        /// The greatest displacement.
        amplitude: Offset,
    },
    /// A path of the caller's own. Two are equal if they are the same object.
    Along(Arc<dyn Path>),
}

/// A path of the caller's own, such as that of a hand or a machine in an engine. Closures from times to poses are paths, too.
pub trait Path: Send + Sync {
    /// The displacement at a time (s). The same time has the same one.
    fn pose(&self, time: f64) -> Pose;
}

impl<F: Fn(f64) -> Pose + Send + Sync> Path for F {
    fn pose(&self, time: f64) -> Pose {
        self(time)
    }
}

impl fmt::Debug for dyn Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Path")
    }
}

impl PartialEq for dyn Path {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::addr_eq(self, other)
    }
}

impl Motion {
    /// A constant displacement.
    pub fn at(offset: Offset) -> Self {
        Self::Keys { keys: vec![Key { time: 0.0, offset }], ease: Ease::Linear, repeat: false }
    }

    /// The displacement at a time (s).
    pub fn pose(&self, time: f64) -> Pose {
        match self {
            Self::Still => Pose::NONE,
            Self::Keys { keys, ease, repeat } => along(keys, *ease, *repeat, time).pose(),
            Self::Swing { period, phase, amplitude } => {
                // Whole periods are removed first, so that the rest is precise at any time.
                let swings = time / period;
                let share = libm::sin(TAU * (swings - swings.floor()) + phase);
                Offset::default().lerp(*amplitude, share).pose()
            }
            Self::Along(path) => path.pose(time),
        }
    }

    /// The time (s) after which nothing moves: infinite for a motion without end, and for a path of the caller's own.
    pub fn end(&self) -> f64 {
        match self {
            Self::Still => 0.0,
            Self::Keys { keys, repeat: false, .. } => keys.last().map_or(0.0, |key| key.time),
            Self::Keys { .. } | Self::Swing { .. } | Self::Along(_) => f64::INFINITY,
        }
    }

    /// The greatest distance (m) between two points of the path, at a distance from the pivot (m). A kinematic
    /// constraint may stretch a body by as much, and the speed of nodes after their release has no bound by the size of
    /// the body at rest. Infinite for a path of the caller's own.
    pub fn longest_way(&self, distance: f64) -> f64 {
        let way = |offset: Offset| offset.shift.length() + offset.rotation.length().min(PI) * distance;
        match self {
            Self::Still => 0.0,
            Self::Keys { keys, .. } => 2.0 * keys.iter().map(|key| way(key.offset)).fold(0.0, f64::max),
            Self::Swing { amplitude, .. } => 2.0 * way(*amplitude),
            Self::Along(_) => f64::INFINITY,
        }
    }

    /// The greatest speed (m/s) at a distance from the pivot (m); infinite for a path of the caller's own.
    pub fn greatest_speed(&self, distance: f64) -> f64 {
        let way = |offset: Offset| offset.shift.length() + offset.rotation.length() * distance;
        match self {
            Self::Still => 0.0,
            Self::Keys { keys, ease, .. } => {
                let speed = |two: &[Key]| {
                    let [from, to] = [two[0], two[1]];
                    let shift = to.offset.shift - from.offset.shift;
                    let rotation = to.offset.rotation - from.offset.rotation;
                    way(Offset { shift, rotation }) / (to.time - from.time) * ease.peak()
                };
                keys.windows(2).map(speed).fold(0.0, f64::max)
            }
            Self::Swing { period, amplitude, .. } => TAU / period * way(*amplitude),
            Self::Along(_) => f64::INFINITY,
        }
    }
}

fn along(keys: &[Key], ease: Ease, repeat: bool, time: f64) -> Offset {
    let (Some(first), Some(last)) = (keys.first(), keys.last()) else { return Offset::default() };
    let length = last.time - first.time;
    let mut time = time;
    if repeat && length > 0.0 && time > first.time {
        let rounds = (time - first.time) / length;
        time = first.time + (rounds - rounds.floor()) * length;
    }
    let after = keys.partition_point(|key| key.time <= time);
    match (after.checked_sub(1).map(|at| keys[at]), keys.get(after)) {
        (None, _) => first.offset,
        (Some(last), None) => last.offset,
        (Some(from), Some(to)) => {
            let share = (time - from.time) / (to.time - from.time);
            from.offset.lerp(to.offset, ease.share(share))
        }
    }
}

/// The quaternion of a rotation vector (rad).
fn quaternion(rotation: DVec3) -> DQuat {
    let angle = rotation.length();
    if angle == 0.0 {
        return DQuat::IDENTITY;
    }
    let (sine, cosine) = libm::sincos(0.5 * angle);
    let axis = rotation / angle * sine;
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time: f64, x: f64, turn: f64) -> Key {
        Key { time, offset: Offset { shift: DVec3::X * x, rotation: DVec3::Z * turn } }
    }

    #[test]
    fn paths_meet_their_keys_and_rest_before_and_after() {
        for ease in [Ease::Smooth, Ease::Linear] {
            let path = Motion::Keys { keys: vec![key(1.0, 0.5, 0.0), key(2.0, 1.5, PI)], ease, repeat: false };
            for (time, x) in [(0.0, 0.5), (1.0, 0.5), (1.5, 1.0), (2.0, 1.5), (9.0, 1.5)] {
                assert!((path.pose(time).shift.x - x).abs() < 1e-15, "{ease:?} {time}");
            }
            let quarter = path.pose(1.5).apply(DVec3::Y, DVec3::Y + DVec3::X);
            assert!(quarter.distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-15, "{quarter}");
            assert!(
                path.pose(1.3).undo(DVec3::Y, path.pose(1.3).apply(DVec3::Y, DVec3::ONE)).distance(DVec3::ONE) < 1e-15
            );
        }
    }

    #[test]
    fn a_swing_starts_at_its_phase() {
        let amplitude = Offset { shift: DVec3::X, rotation: DVec3::Z * 0.4 };
        for (phase, share) in [(0.0, 0.0), (0.5 * PI, 1.0), (PI / 6.0, 0.5), (-0.5 * PI, -1.0)] {
            let swing = Motion::Swing { period: 0.8, phase, amplitude };
            for time in [0.0, 0.8, 8.0] {
                let pose = swing.pose(time);
                assert!((pose.shift - DVec3::X * share).length() < 1e-13, "{phase} {time}: {}", pose.shift);
                assert!(pose.rotation.angle_between(DQuat::from_rotation_z(0.4 * share)) < 1e-7, "{phase} {time}");
            }
            let quarter = (phase + 0.5 * PI).sin();
            assert!((swing.pose(0.2).shift.x - quarter).abs() < 1e-13);
        }
    }

    #[test]
    fn a_smooth_stroke_follows_a_cosine() {
        let keys = vec![key(0.0, 0.0, 0.0), key(0.2, 0.22, 0.0), key(0.4, 0.0, 0.0)];
        let path = Motion::Keys { keys, ease: Ease::Smooth, repeat: true };
        for step in 0..100 {
            let time = 0.013 * f64::from(step);
            let depth = 0.11 * (1.0 - (TAU * time / 0.4).cos());
            assert!((path.pose(time).shift.x - depth).abs() < 1e-13, "{time}");
        }
    }

    #[test]
    fn no_path_is_faster_than_its_greatest_speed() {
        let amplitude = Offset { shift: DVec3::X, rotation: DVec3::Z };
        let paths = [
            Motion::Swing { period: 0.7, phase: 0.4, amplitude },
            Motion::Keys {
                keys: vec![key(0.0, 0.0, 0.0), key(0.5, 1.0, 2.0), key(0.6, 0.8, 0.0)],
                ease: Ease::Smooth,
                repeat: true,
            },
            Motion::Keys { keys: vec![key(0.0, 0.0, 0.0), key(0.5, 1.0, 2.0)], ease: Ease::Linear, repeat: false },
        ];
        for path in &paths {
            let mut greatest: f64 = 0.0;
            let place = |time: f64| path.pose(time).apply(DVec3::ZERO, DVec3::new(0.0, 0.3, 0.0));
            for step in 1..6000 {
                let time = 1e-4 * f64::from(step);
                greatest = greatest.max((place(time) - place(time - 1e-4)).length() / 1e-4);
            }
            assert!(greatest <= path.greatest_speed(0.3) * (1.0 + 1e-9), "{greatest} {path:?}");
            assert!(greatest > 0.4 * path.greatest_speed(0.3), "{greatest} {path:?}");
        }
    }
}
