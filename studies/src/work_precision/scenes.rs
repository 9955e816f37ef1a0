//! The default scenes.

use super::Subject;
use crate::models::Alike;
use crate::study::built_in;
use glam::DVec3;

/// A free body that is twisted and stretched, one that falls onto a floor, and one in the plane with damping: with these models, or the
/// shape-based one.
pub(crate) fn usual(kinds: &[String]) -> Vec<Subject> {
    match kinds {
        [] => with("shape-based", ""),
        _ => kinds.iter().flat_map(|kind| with(kind, &format!(", {kind}"))).collect(),
    }
}

/// The bodies with one model, which their names tell by a suffix.
fn with(kind: &str, suffix: &str) -> Vec<Subject> {
    let run = |damping_ratio: f64| {
        let model = Alike::constant(1e4, 0.05).typed(kind, damping_ratio);
        format!("run = [{{ name = '{kind}', model = {model} }}]")
    };
    let twist = |at: DVec3| {
        let (sine, cosine) = libm::sincos(5.0 * at.z);
        DVec3::new(at.x * cosine - at.y * sine, at.x * sine + at.y * cosine, 1.5 * at.z)
    };
    let stretch = |at: DVec3| DVec3::new(1.2 * at.x, 0.9 * at.y, 0.0);
    let (free, damped) = (run(0.0), run(0.02));
    vec![
        subject(
            format!("Free lattice of 27 cubes, twisted and stretched{suffix}"),
            &format!(
                "time.duration = 1
                body.lattice = {{ cells = [3, 3, 3], side = 0.1 }}
                {free}"
            ),
            Some(&twist),
        ),
        subject(
            format!("Drop of 8 cubes onto a floor{suffix}"),
            &format!(
                "gravity = [0, -9.8, 0]
                time.duration = 0.06
                body = {{ lattice = {{ cells = [2, 2, 2], side = 0.1 }}, velocity = [0, -1, 0], lowest = 0.03, \
                         rotation = {{ axis = [1, 0.3, 2], angle = 0.4 }} }}
                obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3, friction_of = 'velocity' }}]
                {free}"
            ),
            None,
        ),
        subject(
            format!("Disc in the plane, stretched, with damping{suffix}"),
            &format!(
                "time.duration = 0.5
                body.disc = {{ radius = 0.2, rings = 2, sectors = 9 }}
                {damped}"
            ),
            Some(&stretch),
        ),
    ]
}

/// A scene, deformed at its start about the middle of its body.
fn subject(name: String, text: &str, deform: Option<&dyn Fn(DVec3) -> DVec3>) -> Subject {
    let mut scene = built_in(text, "study");
    if let Some(deform) = deform {
        let position = &mut scene.runs[0].initial.position;
        let middle = position.iter().sum::<DVec3>() / position.len() as f64;
        position.iter_mut().for_each(|at| *at = middle + deform(*at - middle));
    }
    Subject { name, scene, run: 0 }
}
