//! The promises of all solvers, tested against the reference.

use super::reference::{angle, by_svd, refined};
use super::sample::{Kind, LEAST_GAP, Sample, samples};
use super::solver::{self, Solver};
use super::{Rotation, measure};
use crate::random::Random;
use crate::reading::documented;
use crate::study::Study;
use glam::{DMat3, DQuat, DVec3};
use localshape::sim::rotation::{davenport1968, robust};

/// `tr(M Σ R0 rᵀ)`, which the optimum maximises.
fn objective(at_rest: DMat3, rotation: DQuat) -> f64 {
    let a = DMat3::from_quat(rotation) * at_rest;
    a.x_axis.x + a.y_axis.y + a.z_axis.z
}

fn size(at_rest: DMat3) -> f64 {
    at_rest.to_cols_array().iter().fold(0.0, |size: f64, entry| size.max(entry.abs()))
}

/// The default, and the library's solver.
fn of(wanted: impl Fn(&Solver) -> bool) -> Solver {
    solver::all().into_iter().find(wanted).expect("it is in the list")
}

#[test]
fn all_solvers_agree_on_well_shaped_elements_that_have_turned_a_little() {
    for increment in [1e-3, 0.03, 0.3] {
        for (sample, sought) in samples(Kind::Warm { strain: 0.5, increment }, 100) {
            for solver in solver::all() {
                // The result of Eq. (16) is not a rotation, and relaxation converges linearly.
                let (passes, tolerance) = match solver.name {
                    "linear-update" => (1, 0.2 * increment * increment),
                    "mueller" => (100, 1e-12),
                    _ => (8, 1e-14),
                };
                let error = angle(solver.with_passes(passes).rotation(&sample), sought);
                assert!(error < tolerance, "{}, {increment}: {error:e}", solver.name);
            }
        }
    }
}

#[test]
fn the_default_is_as_accurate_as_it_says() {
    let default = of(Solver::is_default);
    for strain in [0.0, 0.25, 0.5] {
        for increment in [1e-4, 1e-3, 0.0125, 0.03, 0.1, 0.3] {
            for (sample, sought) in samples(Kind::Warm { strain, increment }, 500) {
                let error = angle(default.rotation(&sample), sought);
                assert!(error < 1e-14, "{strain} {increment}: {error:e}");
                assert_eq!(default.is_global(&sample), Some(false), "{strain} {increment}");
            }
        }
    }
    let errors = samples(Kind::Cold, 5000).into_iter().map(|(sample, sought)| angle(default.rotation(&sample), sought));
    let worst = errors.fold(0.0, f64::max);
    assert!(worst < 1e-12, "{worst:e}");
}

/// Moments of every rank and sign, of sizes over a hundred decades.
fn moments(random: &mut Random) -> DMat3 {
    let sign = |random: &mut Random| if random.next() < 0.5 { -1.0 } else { 1.0 };
    let rank = (4.0 * random.next()) as usize;
    let mut stretch = DVec3::from_array(std::array::from_fn(|axis| {
        if axis < rank { sign(random) * libm::exp10(-6.0 * random.next() * random.next()) } else { 0.0 }
    }));
    // With equal sizes, optima are no longer unique.
    if random.next() < 0.3 {
        stretch.y = sign(random) * stretch.x;
    }
    if random.next() < 0.3 {
        stretch.z = sign(random) * stretch.y;
    }
    let (left, right) = (DMat3::from_quat(random.rotation()), DMat3::from_quat(random.rotation()));
    left * DMat3::from_diagonal(stretch) * right * libm::exp10(100.0 * random.next() - 50.0)
}

#[test]
fn the_default_is_the_maximum_for_moments_of_every_rank_and_sign() {
    let mut random = Random(1);
    for number in 0..20_000 {
        let (at_rest, last) = (moments(&mut random), random.rotation());
        let found = robust::follow(at_rest, last).rotation;
        assert!((found.length() - 1.0).abs() < 1e-15, "{number}: {found}");
        let turned = DMat3::from_quat(found);
        let product = turned * turned.transpose() - DMat3::IDENTITY;
        assert!(size(product) < 1e-14, "{number}: {product}");
        let best = by_svd(at_rest).map_or(f64::NEG_INFINITY, |other| objective(at_rest, other));
        assert!(objective(at_rest, found) >= best - 1e-13 * size(at_rest), "{number}: {at_rest} {last}");
        // Closed form and eigenvectors are global, too.
        for solver in ["davenport", "closed-form"].map(|name| of(|one| one.name == name)) {
            let other = solver.rotation(&Sample { at_rest, last });
            assert!(other.is_normalized(), "{number}: {} {other}", solver.name);
            let lost = objective(at_rest, found) - objective(at_rest, other);
            assert!(lost.abs() <= 1e-11 * size(at_rest), "{number}: {} {lost:e} {at_rest}", solver.name);
        }
    }
}

#[test]
fn no_solver_makes_something_that_is_not_a_number() {
    let mut random = Random(2);
    let odd = [DMat3::ZERO, DMat3::from_diagonal(DVec3::splat(5e-324)), DMat3::from_diagonal(DVec3::splat(1e300))];
    let many = std::iter::repeat_with(|| moments(&mut Random(random.next().to_bits()))).take(2000);
    for at_rest in odd.into_iter().chain(many.collect::<Vec<_>>()) {
        let sample = Sample { at_rest, last: DQuat::from_xyzw(0.5, -0.5, 0.5, 0.5) };
        for solver in solver::all() {
            let is_library = solver.name.starts_with("SVD");
            let found = solver.rotation(&sample);
            assert!(is_library || (found.length() - 1.0).abs() < 1e-14, "{} {found}: {at_rest}", solver.title());
        }
    }
    for number in [f64::NAN, f64::INFINITY] {
        let last = DQuat::from_xyzw(0.5, -0.5, 0.5, 0.5);
        assert_eq!(robust::follow(DMat3::from_diagonal(DVec3::splat(number)), last).rotation, last);
    }
}

/// A cube at each row of the table: its corners scaled along the axes and then turned, the eigenvalues of
/// the matrix of Eq. (15) over that of a cube at rest, and whether the optimum is unique.
#[test]
fn the_degenerate_cases_row_by_row() {
    let half_turn = DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0));
    let rows: [(&str, DMat3, [f64; 3], bool); 6] = [
        ("at a point", DMat3::ZERO, [0.0, 0.0, 0.0], false),
        ("on a line", DMat3::from_diagonal(DVec3::X), [0.0, 1.0, 1.0], false),
        ("in a plane", DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)), [1.0, 1.0, 2.0], true),
        ("mirrored", DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)), [0.0, 0.0, 2.0], false),
        ("turned by 180°", half_turn, [-2.0, 0.0, 0.0], true),
        ("point inversion", DMat3::from_diagonal(DVec3::NEG_ONE), [-2.0, -2.0, -2.0], false),
    ];
    // From no rotation, as at the start of a scene.
    let last = DQuat::IDENTITY;
    for (name, at_rest, eigenvalues, is_unique) in rows {
        let trace = at_rest.x_axis.x + at_rest.y_axis.y + at_rest.z_axis.z;
        // All are diagonal.
        let mut own = [0, 1, 2].map(|axis: usize| trace - at_rest.col(axis)[axis]);
        own.sort_by(f64::total_cmp);
        assert_eq!(own, eigenvalues, "{name}");

        let found = robust::follow(at_rest, last);
        assert_eq!(found, robust::follow(at_rest, last), "{name}: the same on every run");
        assert!(found.rotation.is_normalized(), "{name}: {}", found.rotation);
        let best = objective(at_rest, by_svd(at_rest).expect("it converges"));
        assert!((objective(at_rest, found.rotation) - best).abs() < 1e-14, "{name}: {}", found.rotation);
        // In a plane the Hessian is positive definite; everywhere else the global solver is needed, and counted.
        assert_eq!(found.is_global, name != "in a plane", "{name}");
        match name {
            "turned by 180°" => {
                assert!(angle(found.rotation, DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0)) < 1e-15, "the half turn");
            }
            "point inversion" => assert!(angle(found.rotation, last) > 3.0, "some half turn: {}", found.rotation),
            // The last rotation is optimal.
            _ => assert!(angle(found.rotation, last) < 1e-15, "{name}: {}", found.rotation),
        }
        if is_unique {
            let elsewhere = DQuat::from_xyzw(0.3, -0.4, 0.5, 0.7).normalize();
            assert!(angle(robust::follow(at_rest, elsewhere).rotation, found.rotation) < 1e-14, "{name}");
        }
    }
}

#[test]
fn a_line_turns_with_its_element_and_no_more() {
    // The last rotation about the line is kept: the shortest way from the old line to the new one is taken.
    let line = DMat3::from_diagonal(DVec3::X);
    let mut random = Random(3);
    for _ in 0..100 {
        let (last, turn) = (random.rotation(), random.rotation());
        let found = robust::follow((DMat3::from_quat(turn) * line).transpose(), last).rotation;
        assert!((found * DVec3::X - turn * DVec3::X).length() < 1e-14);
        let shortest = DQuat::from_rotation_arc(last * DVec3::X, turn * DVec3::X) * last;
        assert!(angle(found, shortest) < 1e-13, "{found} {shortest}");
    }
    let last = random.rotation();
    assert_eq!(robust::follow(DMat3::ZERO, last).rotation, last, "at a point all of it is kept");
}

#[test]
fn the_gap_decides_whether_the_optimum_is_unique() {
    for (sample, sought) in samples(Kind::Cold, 500) {
        let best = davenport1968::optimum(sample.at_rest, DQuat::IDENTITY);
        assert!(angle(best, sought) < 1e-12 && LEAST_GAP > 0.0);
        assert!(angle(refined(sample.at_rest, best), sought) < 1e-15);
    }
}

fn quick() -> Rotation {
    Rotation { strains: vec![0.5], increments: vec![0.01, 0.3], elements: 8, repeats: 1, rounds: 2 }
}

#[test]
fn every_method_on_every_kind_of_elements() {
    let turns = std::sync::atomic::AtomicU64::new(0);
    let count = |more| turns.fetch_add(more, std::sync::atomic::Ordering::Relaxed) < u64::MAX;
    let results = measure(&quick(), &count).expect("it is never stopped");
    assert_eq!(turns.into_inner(), quick().work());
    assert_eq!(results.measured.len(), 3 * results.solvers.len());
    assert!(results.measured.iter().all(|one| one.time.least >= 0.0 && one.time.most.is_finite()));
    assert!(measure(&quick(), &|_| false).is_none());
}

#[test]
fn columns_are_documented() {
    let results = measure(&quick(), &|_| true).expect("it is never stopped");
    let csv = results.table().csv();
    assert_eq!(csv.lines().next().expect("heads").split(',').collect::<Vec<_>>(), documented("rotation.csv"));
    assert_eq!(csv.lines().count(), 1 + results.measured.len());
}

#[test]
fn errors_are_the_same_on_every_run() {
    let errors = || {
        let results = measure(&quick(), &|_| true).expect("it is never stopped");
        results.measured.iter().map(|one| (one.median, one.worst)).collect::<Vec<_>>()
    };
    assert_eq!(errors(), errors());
}
