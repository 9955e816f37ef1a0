//! The reference positions at each moment.

use super::method::{Attempt, End, MOMENTS, Method};
use super::{Reference, Subject};
use glam::DVec3;
use localshape::sim::model::ElasticModel;
use std::sync::Arc;

/// The tolerance of the reference, and the least tolerance: with a smaller one, round-off is larger.
pub(super) const TOLERANCE: f64 = 1e-11;
/// Two methods that are farther apart than this share of the body's size do not agree.
const MOST_APART: f64 = 0.03;

/// The positions (m) at each moment.
pub(super) type Course = Vec<Vec<DVec3>>;

/// A course by two different methods, or why there is none. `most` is the number of evaluations of the finest run.
pub(super) fn reference(
    subject: &Subject,
    accepted: &[(Method, Arc<dyn ElasticModel>)],
    most: f64,
) -> Result<(Course, Reference), String> {
    // With obstacles only the adaptive method is of high order. Of the others, the one with the smallest steps is best.
    let best: &[Method] = if subject.scene.obstacles.is_empty() {
        &[Method::BLANES_MOAN, Method::KAHAN_LI, Method::DORMAND_PRINCE, Method::RUNGE_KUTTA]
    } else {
        &[Method::DORMAND_PRINCE]
    };
    let best = best.iter().chain(&[Method::VERLET, Method::DEFAULT]);
    let methods = best.filter_map(|one| accepted.iter().find(|(method, _)| method == one));
    let mut courses = methods.filter_map(|(method, model)| Some((*method, finest(subject, model, *method, most)?)));
    let mut next = || courses.next().unwrap_or((Method::DEFAULT, None));
    let ((first, one), (second, other)) = (next(), next());
    let (Some(one), Some(other)) = (one, other) else {
        return Err("the body diverges also with small steps: there is no finite reference".to_owned());
    };
    let apart = one.iter().zip(&other).map(|(one, other)| farthest(one, other));
    let error = apart.fold(0.0, larger) / subject.body().extent();
    // NaN is not an agreement.
    if error.is_nan() || error > MOST_APART {
        return Err(format!(
            "{} and {} are {error:.0e} of the body's size apart also with small steps: the motion is chaotic, and there is no finite \
             reference; shorten `time.duration`",
            first.name(),
            second.name(),
        ));
    }
    Ok((one, Reference { methods: [first, second], error }))
}

/// The course with more than a number of evaluations, or with the tolerance of an adaptive method that leads to them;
/// its inner `None` means that the body diverges. `None` for a method that needs far more evaluations.
fn finest(subject: &Subject, model: &Arc<dyn ElasticModel>, method: Method, most: f64) -> Option<Option<Course>> {
    let mut tolerance = if method.is_adaptive() { 1e-4 } else { TOLERANCE };
    let mut before = None;
    loop {
        let mut course = vec![Vec::new(); MOMENTS];
        let attempt = Attempt::new(method, most, tolerance).finer();
        let (end, count) = attempt.run(subject, model, most, |at, positions| course[at] = positions.to_vec());
        match end {
            End::Reached => {}
            End::Diverged => return Some(None),
            End::GivenUp => return before,
        }
        if tolerance <= TOLERANCE || count as f64 > 1.5 * most {
            return Some(Some(course));
        }
        before = Some(Some(course));
        tolerance = (0.1 * tolerance).max(TOLERANCE);
    }
}

/// The greatest distance of a node from its place (m).
pub(super) fn farthest(ones: &[DVec3], others: &[DVec3]) -> f64 {
    ones.iter().zip(others).map(|(one, other)| one.distance(*other)).fold(0.0, larger)
}

/// Unlike the maximum of two numbers, this keeps NaN.
pub(super) fn larger(one: f64, other: f64) -> f64 {
    if other <= one { one } else { other }
}
