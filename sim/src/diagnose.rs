//! The quantities from which diagnostics are computed, for a body: what is known at rest, and what its states need.

use super::body::Body;
use super::crew::Crew;
use super::fill;
use super::model::Report;
use super::placement::Placement;
use super::rotation::{self, moment};
use super::state::Nodes;
use super::volume::{Affine, at_rest, mean, volumes_by_faces};
use glam::DVec3;
use std::cell::LazyCell;
use std::sync::Arc;

/// The precomputed part of the diagnostics of a body.
pub(crate) struct Diagnose {
    pub(super) body: Arc<Body>,
    /// Signed volume of each element at rest (m³, in the plane m²). It is zero for segments, triangles in space and all
    /// elements that are flat at rest, which therefore never count as turned over.
    pub(super) volumes_at_rest: Vec<f64>,
    /// The sum of what is filled of them.
    pub(super) volume_at_rest: f64,
    /// The elements without a volume from faces.
    affine: Vec<Affine>,
    /// Mean of the rest positions (m).
    rest_centre: DVec3,
    /// Rest positions relative to their mean (m).
    pub(super) centred: Vec<DVec3>,
}

/// A value that is computed when it is first used.
pub(super) type Lazy<'a, T> = LazyCell<T, Box<dyn FnOnce() -> T + 'a>>;

/// What is known of what acts on a body from outside.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outside {
    /// The mean force of contact (N) and its torque about the origin (N m).
    pub(super) contact: Option<[DVec3; 2]>,
    /// The same of kinematic constraints.
    pub(super) grips: Option<[DVec3; 2]>,
    /// Its triangles that cross its own or those of obstacles, and those that cross those of other bodies.
    pub(super) crossings: Option<[usize; 2]>,
    /// The work of loads since the start (J).
    pub(super) work: Option<f64>,
}

/// The quantities of one body from which diagnostics are computed.
pub(super) struct BodyFacts<'a> {
    /// What is known of it at rest.
    pub(super) of: &'a Diagnose,
    pub(super) state: Nodes<'a>,
    /// Rotations that the global solver has computed.
    pub(super) global_rotations: f64,
    /// Elements or springs that are broken; NaN if none can be.
    pub(super) broken: f64,
    pub(super) outside: Outside,
    /// Energy and residuals from the model.
    pub(super) report: Lazy<'a, Report>,
    /// Signed volume of each element (m³, in the plane m²).
    pub(super) volumes: Lazy<'a, Vec<f64>>,
    /// Whether each element is broken; empty if none can be.
    pub(super) gone: Vec<bool>,
    pub(super) placement: Lazy<'a, Placement>,
}

impl Diagnose {
    /// Precomputes the quantities of the body at rest.
    pub(crate) fn new(body: &Arc<Body>) -> Self {
        let affine = Affine::all(body);
        let volumes_at_rest = at_rest(body, &affine);
        let volume_at_rest = fill::volume(body.fill.as_deref(), &volumes_at_rest);
        let rest_centre = mean(&body.rest);
        let centred = body.rest.iter().map(|&rest| rest - rest_centre).collect();
        Self { body: Arc::clone(body), volumes_at_rest, volume_at_rest, affine, rest_centre, centred }
    }

    /// The quantities that the diagnostics of a state need, each computed at its first use. `report` gives energy and residuals.
    pub(super) fn facts<'a>(
        &'a self,
        state: Nodes<'a>,
        [global_rotations, broken]: [f64; 2],
        outside: Outside,
        gone: Vec<bool>,
        report: impl FnOnce() -> Report + 'a,
        crew: &'a Crew,
    ) -> BodyFacts<'a> {
        BodyFacts {
            of: self,
            state,
            global_rotations,
            broken,
            outside,
            report: Lazy::new(Box::new(report)),
            volumes: Lazy::new(Box::new(move || self.volumes(state.position, crew))),
            gone,
            placement: Lazy::new(Box::new(move || self.placement(state.position))),
        }
    }

    /// Signed volume of each element (m³, in the plane m²).
    fn volumes(&self, position: &[DVec3], crew: &Crew) -> Vec<f64> {
        let mut volumes = volumes_by_faces(&self.body, position, crew);
        let measured = crew.map(self.affine.len(), |at| self.affine[at].stretch(&self.body, position));
        for (affine, stretch) in self.affine.iter().zip(measured) {
            volumes[affine.element] = stretch * self.volumes_at_rest[affine.element];
        }
        volumes
    }

    /// The rigid placement of the rest shape that is nearest to the nodes.
    fn placement(&self, position: &[DVec3]) -> Placement {
        let centre = mean(position);
        let at_rest = moment(&self.centred, position.iter().map(|&position| position - centre));
        let turn = rotation::best(self.body.dimension, at_rest);
        Placement { rest_centre: self.rest_centre, centre, turn }
    }
}

#[cfg(test)]
mod tests {
    use super::super::diagnostics::{Diagnostic, Diagnostics, Facts, is_flat, is_turned_over};
    use super::*;
    use crate::element::Solids;
    use crate::lists::IndexLists;
    use crate::state::State;
    use glam::DQuat;

    fn at_rest(rest: Vec<DVec3>) -> Diagnostics {
        let mut elements = IndexLists::default();
        elements.push(&(0..rest.len() as u32).collect::<Vec<_>>());
        let body = Arc::new(Body::builder(rest.clone()).elements(elements).build().expect("a body"));
        diagnostics(&Diagnose::new(&body), &State::at_rest(rest))
    }

    fn diagnostics(diagnose: &Diagnose, state: &State) -> Diagnostics {
        let crew = Crew::new(1);
        let bodies = [diagnose.facts(state.nodes(), [0.0; 2], Outside::default(), Vec::new(), Report::default, &crew)];
        Diagnostics::of(Facts { bodies: &bodies, gravity: DVec3::ZERO }, Diagnostic::ALL)
    }

    /// An element with seven corners has no table of faces: its volume is the affine estimate.
    fn heptad(thickness: f64) -> Vec<DVec3> {
        let tilt = DQuat::from_xyzw(0.1, -0.2, 0.3, 0.9).normalize();
        let corner = |at: u32| {
            DVec3::new(f64::from(at % 3), f64::from(at / 3), thickness * f64::from(at * at % 5)) * 0.1 + DVec3::ONE
        };
        (0..7).map(|at| tilt * corner(at)).collect()
    }

    #[test]
    fn what_is_flat_in_space_has_no_volume_and_cannot_turn_over() {
        for flat in [heptad(0.0), heptad(0.0)[..3].to_vec(), heptad(0.0)[..2].to_vec()] {
            let diagnostics = at_rest(flat);
            assert!(diagnostics.volume_ratio.is_nan());
            assert_eq!(diagnostics.turned_over, 0);
            assert!(diagnostics.shape_error < 1e-15);
        }
    }

    #[test]
    fn a_thin_element_without_faces_has_a_volume() {
        for thickness in [1.0, 1e-3] {
            assert!((at_rest(heptad(thickness)).volume_ratio - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn what_is_pressed_flat_has_not_turned_over_however_it_lies() {
        let corner = |bit: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(bit >> axis & 1)));
        let rest: Vec<_> = (0..8).map(corner).collect();
        let elements = [&[0, 1, 2, 3, 4, 5, 6, 7][..]].into_iter().collect();
        let body = Body::builder(rest.clone()).elements(elements).build().expect("a body");
        let diagnose = Diagnose::new(&Arc::new(body));
        let over = |height: f64, turn: u32| {
            let tilt = DQuat::from_xyzw(0.1, -0.2, 0.01 * f64::from(turn), 0.9).normalize();
            let place = |at: &DVec3| tilt * (*at * DVec3::new(1.0, 1.0, height)) + DVec3::new(3.0, -2.0, 1.0);
            let now = State::at_rest(rest.iter().map(place).collect());
            diagnostics(&diagnose, &now).turned_over
        };
        assert!((0..100).all(|turn| over(0.0, turn) == 0));
        assert!((0..100).all(|turn| over(-0.9e-3, turn) == 0));
        assert!((0..100).all(|turn| over(-1.1e-3, turn) == 1));
    }

    #[test]
    fn an_element_is_flat_below_a_hundredth_of_its_volume_and_turned_over_below_minus_a_thousandth() {
        let cases = [(0.011, [false; 2]), (0.009, [true, false]), (0.0, [true, false]), (-0.9e-3, [true, false])];
        for (part, expected) in cases.into_iter().chain([(-1.1e-3, [false, true]), (-0.5, [false, true])]) {
            for at_rest in [1.0, 2e-6, -3.0] {
                let now = part * at_rest;
                assert_eq!([is_flat(now, at_rest), is_turned_over(now, at_rest)], expected, "{part} of {at_rest}");
            }
        }
        assert!(!is_turned_over(-1.0, 0.0), "what has no volume cannot turn over");
        assert!(!is_flat(0.0, 0.0), "what has no volume cannot lose it");
    }

    #[test]
    fn hulls_count_with_their_own_volume() {
        // An octahedron of volume 4/3, squashed to a half, above a cube of volume 1 that keeps its shape.
        let octahedron = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
        let cube =
            (0..8u32).map(|bit| DVec3::from_array([0, 1, 2].map(|axis| f64::from(bit >> axis & 1))) - DVec3::Y * 3.0);
        let rest: Vec<_> = octahedron.into_iter().chain(cube).collect();
        let elements = [&[0, 1, 2, 3, 4, 5][..], &[6, 7, 8, 9, 10, 11, 12, 13]].into_iter().collect();
        let body = Body::builder(rest.clone()).elements(elements).solids(Solids::Convex).build().expect("a body");
        let mut now = rest;
        now[..6].iter_mut().for_each(|corner| corner.y *= 0.5);
        let ratio = diagnostics(&Diagnose::new(&Arc::new(body)), &State::at_rest(now)).volume_ratio;
        assert!((ratio - (2.0 / 3.0 + 1.0) / (4.0 / 3.0 + 1.0)).abs() < 1e-12, "{ratio}");
    }
}
