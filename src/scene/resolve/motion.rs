//! Rotations and paths.

use super::{direction, vector};
use crate::reading::collector::Here;
use crate::scene::file::{Coordinates, MotionPath, Rotation, Swing};
use crate::sim::{Dimension, Key, Motion, Offset};
use glam::DVec3;

/// The unit axis of a rotation. Reports a missing axis in space, and an axis in the plane.
pub(super) fn axis(typed: Option<&Coordinates>, dimension: Dimension, rotation: &Here<'_>) -> Option<DVec3> {
    let here = rotation.to("axis");
    match (typed, dimension) {
        (None, Dimension::Plane) => Some(DVec3::Z),
        (Some(_), Dimension::Plane) => {
            let message = format!("`{rotation}` has an `axis`, but the body is in the plane");
            here.wrong_key(message, "remove `axis`; a positive angle rotates counter-clockwise");
            None
        }
        (None, Dimension::Space) => {
            let message = format!("`{rotation}` has no `axis`, which a rotation in space needs");
            here.wrong(message, "such as axis = [0, 0, 1]");
            None
        }
        (Some(axis), Dimension::Space) => direction(vector(axis, dimension, &here)?, &here),
    }
}

/// A translation and a rotation.
fn offset(
    shift: Option<&Coordinates>,
    rotation: Option<&Rotation>,
    dimension: Dimension,
    here: &Here<'_>,
) -> Option<Offset> {
    let shift = match shift {
        Some(typed) => vector(typed, dimension, &here.to("shift")),
        None => Some(DVec3::ZERO),
    };
    let rotation = match rotation {
        Some(typed) => axis(typed.axis.as_ref(), dimension, &here.to("rotation")).map(|axis| axis * typed.angle),
        None => Some(DVec3::ZERO),
    };
    Some(Offset { shift: shift?, rotation: rotation? })
}

/// A path of keyframes. With a single key it is constant.
pub(super) fn keys(typed: &MotionPath, dimension: Dimension, here: &Here<'_>) -> Option<Motion> {
    let mut keys = Vec::with_capacity(typed.keys.len());
    let mut in_order = true;
    for (at, key) in typed.keys.iter().enumerate() {
        let here = here.to("keys").to(at);
        if let Some(before) =
            at.checked_sub(1).map(|before| typed.keys[before].time).filter(|&before| before >= key.time)
        {
            let message = format!("`{here}` is at {} s, not later than the key before it at {before} s", key.time);
            here.to("time").wrong(message, "list the keys in rising order of time");
            in_order = false;
        }
        let offset = offset(key.shift.as_ref(), key.rotation.as_ref(), dimension, &here);
        keys.extend(offset.map(|offset| Key { time: key.time, offset }));
    }
    if keys.len() < typed.keys.len() || !in_order {
        return None;
    }
    if let (true, Some(first), Some(last)) = (typed.repeat, keys.first(), keys.last()) {
        if keys.len() == 1 {
            here.wrong(format!("`{here}` repeats, but has a single key"), "add keys, or remove `repeat`");
            return None;
        }
        if !same(first.offset, last.offset) {
            let message = format!("`{here}` repeats, but does not end where it begins, so the motion would jump");
            let help = "give the last key the first one's `shift`, and its `rotation` up to whole turns";
            here.to("keys").to(keys.len() - 1).wrong(message, help);
            return None;
        }
    }
    Some(Motion::Keys { keys, ease: typed.ease, repeat: typed.repeat })
}

/// Whether two offsets are equal, to round-off and whole turns.
fn same(one: Offset, other: Offset) -> bool {
    /// A smaller difference is round-off of typed numbers.
    const CLOSE: f64 = 1e-6;
    let [one_pose, other_pose] = [one, other].map(|offset| Motion::at(offset).pose(0.0));
    one.shift.distance(other.shift) <= CLOSE * (one.shift.length() + other.shift.length()).max(1e-3)
        && one_pose.rotation.dot(other_pose.rotation).abs() >= 1.0 - CLOSE * CLOSE
}

/// An oscillation.
pub(super) fn swing(typed: &Swing, dimension: Dimension, here: &Here<'_>) -> Option<Motion> {
    if typed.shift.is_none() && typed.rotation.is_none() {
        let message = format!("`{here}` has neither `shift` nor `rotation`: nothing would move");
        here.wrong(message, "such as shift = [0.1, 0, 0]");
        return None;
    }
    let amplitude = offset(typed.shift.as_ref(), typed.rotation.as_ref(), dimension, here)?;
    Some(Motion::Swing { period: typed.period, phase: typed.phase, amplitude })
}

/// Reports keys that are closer to each other than a time step (s).
pub(super) fn check_steps(typed: &MotionPath, step: f64, here: &Here<'_>) {
    for (at, pair) in typed.keys.windows(2).enumerate() {
        let apart = pair[1].time - pair[0].time;
        if apart > 0.0 && apart < step {
            let key = here.to("keys").to(at + 1);
            let message = format!(
                "`{key}` is {apart:.3e} s after the key before it, but a time step takes {step:.3e} s: the motion would jump"
            );
            key.to("time").wrong(message, "leave more time between them");
        }
    }
}
