//! The default scenes.

use super::Subject;
use glam::DVec3;
use localshape::{Limits, Scene};

/// A free body that is twisted and stretched, one that falls onto a floor, and one in the plane with damping.
pub(crate) fn usual() -> Vec<Subject> {
    let twist = |at: DVec3| {
        let (sine, cosine) = libm::sincos(5.0 * at.z);
        DVec3::new(at.x * cosine - at.y * sine, at.x * sine + at.y * cosine, 1.5 * at.z)
    };
    let stretch = |at: DVec3| DVec3::new(1.2 * at.x, 0.9 * at.y, 0.0);
    vec![
        subject(
            "Free lattice of 27 cubes, twisted and stretched",
            "time.duration = 1
            body.lattice = { cells = [3, 3, 3], side = 0.1 }
            run = [{ name = 'shape', model = { kind = 'shape-based', stiffness = 1e4 } }]",
            Some(&twist),
        ),
        subject(
            "Drop of 8 cubes onto a floor",
            "gravity = [0, -9.8, 0]
            time.duration = 0.06
            body = { lattice = { cells = [2, 2, 2], side = 0.1 }, velocity = [0, -1, 0], lowest = 0.03, \
                     rotation = { axis = [1, 0.3, 2], angle = 0.4 } }
            obstacle = [{ kind = 'floor', restitution = 0.5, friction = 0.3 }]
            run = [{ name = 'shape', model = { kind = 'shape-based', stiffness = 1e4 } }]",
            None,
        ),
        subject(
            "Disc in the plane, stretched, with damping",
            "time.duration = 0.5
            body.disc = { radius = 0.2, rings = 2, sectors = 9 }
            run = [{ name = 'shape', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.02 } }]",
            Some(&stretch),
        ),
    ]
}

/// A scene, deformed at its start about the middle of its body.
fn subject(name: &str, text: &str, deform: Option<&dyn Fn(DVec3) -> DVec3>) -> Subject {
    let mut scene = Scene::parse(text, "study", &Limits::default())
        .unwrap_or_else(|error| panic!("a scene without mistakes: {error}"));
    if let Some(deform) = deform {
        let position = &mut scene.runs[0].initial.position;
        let middle = position.iter().sum::<DVec3>() / position.len() as f64;
        position.iter_mut().for_each(|at| *at = middle + deform(*at - middle));
    }
    Subject { name: name.to_owned(), scene, run: 0 }
}
