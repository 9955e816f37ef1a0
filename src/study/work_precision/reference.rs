//! The positions at the end of a run that errors are measured against.

use super::way::{End, Way};
use super::{Reference, Subject};
use crate::sim::integrate::Integrator;
use crate::sim::model::ElasticModel;
use glam::DVec3;
use std::sync::Arc;

/// The reference has so many times the evaluations of the finest run: not a power of two, so that no run is the reference.
const FINER: f64 = 1.4;
/// The tolerance of the reference, and the least that is tried: below, round-off is larger.
pub(super) const TOLERANCE: f64 = 1e-11;

/// The positions at the end (m) by two different methods; why there are none otherwise.
pub(super) fn reference(
    subject: &Subject,
    model: &Arc<dyn ElasticModel>,
    accepted: &[(Integrator, f64)],
    most: f64,
    size: f64,
) -> Result<(Vec<DVec3>, Reference), String> {
    // With obstacles only the adaptive method is of high order, and of the others that with the smallest steps is best.
    let best: &[Integrator] = if subject.scene.obstacles.is_empty() {
        &[Integrator::BlanesMoan, Integrator::QuinlanTremaine, Integrator::DormandPrince, Integrator::RungeKutta]
    } else {
        &[Integrator::DormandPrince]
    };
    let rest = [Integrator::VelocityVerlet, Integrator::SemiImplicitEuler];
    let methods = best.iter().chain(&rest).filter_map(|wanted| accepted.iter().find(|(one, _)| one == wanted));
    let mut ends = methods.filter_map(|&method| Some((method.0, finest(subject, model, method, FINER * most)?)));
    let mut next = || ends.next().unwrap_or((Integrator::default(), None));
    let ((first, one), (second, other)) = (next(), next());
    let (Some(one), Some(other)) = (one, other) else {
        return Err("the body diverges also with small steps: there is no finite reference".to_owned());
    };
    let error = farthest(&one, &other) / size;
    // NaN is no agreement.
    if error.is_nan() || error > MOST_APART {
        return Err(format!(
            "{} and {} end {error:.0e} of the body's size apart also with small steps: the motion is chaotic, and there is no \
             finite reference; shorten `time.duration`",
            crate::sim::words::typed(&first),
            crate::sim::words::typed(&second),
        ));
    }
    Ok((one, Reference { integrators: [first, second], error }))
}

/// The positions at the end (m) with about so many evaluations, or the tolerance of an adaptive method that leads to them, which are
/// `None` if the body diverges; `None` for a method that needs far more evaluations.
fn finest(
    subject: &Subject,
    model: &Arc<dyn ElasticModel>,
    method: (Integrator, f64),
    evaluations: f64,
) -> Option<Option<Vec<DVec3>>> {
    let mut tolerance = if method.0.is_adaptive() { 1e-4 } else { TOLERANCE };
    let mut before = None;
    loop {
        let (end, count) = Way::new(method, evaluations, tolerance).run(subject, model, evaluations);
        let end = match end {
            End::Reached(positions) => Some(positions),
            End::Diverged => None,
            End::GivenUp => return before,
        };
        if tolerance <= TOLERANCE || count as f64 > evaluations {
            return Some(end);
        }
        before = Some(end);
        tolerance = (0.1 * tolerance).max(TOLERANCE);
    }
}

/// Two methods that end farther apart than this share of the body's size do not agree.
const MOST_APART: f64 = 0.03;

/// The greatest distance of a node from its place (m).
pub(super) fn farthest(ones: &[DVec3], others: &[DVec3]) -> f64 {
    // Unlike the maximum of two numbers, this keeps NaN.
    ones.iter()
        .zip(others)
        .map(|(one, other)| one.distance(*other))
        .fold(0.0, |far, one| if one <= far { far } else { one })
}
