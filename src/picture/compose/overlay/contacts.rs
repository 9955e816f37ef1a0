//! Contacts: a dot where bodies touch, and an arrow for the mean force of each obstacle and body on each body.

use super::KeyPlace;
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::legend::Sample;
use crate::picture::order::farthest_first;
use crate::picture::{Item, arrows, number};
use crate::scene::Scene;
use crate::sim::{Diagnostic, Reaction, Side, Source};
use glam::DVec3;

/// A force as large as the mean weight of bodies on Earth has an arrow as long as this share of the size of the largest body.
const LENGTH: f64 = 0.5;
/// The largest radius of a dot, in lengths of an element.
const MOST_DOT: f64 = 0.09;

/// A hollow arrow with its force in words.
pub(super) fn samples(composer: &Composer<'_>, place: &KeyPlace) -> Vec<Sample> {
    let length = place.pixels * metres_a_newton(composer.scene);
    let force = number::round_below(place.legend.arrow_length() / length);
    let words = number::value(Diagnostic::ContactForce, force, composer.extent);
    vec![place.arrow(composer, vec![format!("contact force {words}"), words], force * length, arrows::hollow)]
}

/// Dots and arrows of contact. Each arrow begins at the middle of the places where two bodies, or a body and an obstacle, touch. It is hollow, as
/// loads are filled. Dots lie above all arrows.
pub(super) fn draw(draft: &Draft<'_>, marks: &mut Vec<Item>) {
    let snapshot = draft.snapshot;
    if !draft.scene.view.visible.contacts || draft.diverged {
        return;
    }
    let metres = metres_a_newton(draft.scene);
    let arrows = snapshot.reactions.iter().filter_map(|&Reaction { from, on, force, .. }| {
        let own = snapshot.contact_points.iter().filter(|point| {
            let is_back = point.from == Side::Body(on) && from == Source::Body(point.on);
            (Source::from(point.from), point.on) == (from, on) || is_back
        });
        let (count, sum) = own.fold((0, DVec3::ZERO), |(count, sum), point| (count + 1, sum + point.at));
        let start = (count > 0).then(|| sum / f64::from(count))?;
        draft.arrow([start, start + force * metres], 0.0, 1.0, arrows::hollow)
    });
    marks.extend(farthest_first(arrows.collect()));
    let colour = draft.composer.palette.pointer;
    marks.extend(
        snapshot.contact_points.iter().filter_map(|point| draft.dot(point.at, MOST_DOT * draft.element, colour)),
    );
}

/// The length of arrows (m) for each newton.
pub(super) fn metres_a_newton(scene: &Scene) -> f64 {
    let masses = scene.bodies.iter().map(|body| body.body.mass().iter().sum::<f64>());
    let mass = masses.sum::<f64>() / scene.bodies.len() as f64;
    let size = scene.bodies.iter().map(|body| body.body.extent()).fold(0.0, f64::max);
    scene.view.arrow_scale * LENGTH * size / (mass * number::EARTH)
}
