//! The exact rotation for any input: the eigenvector of Davenport's 4×4 matrix with the largest eigenvalue.
//!
//! P. Davenport, "A vector approach to the algebra of rotations with applications", NASA TN D-4696, 1968; in the form
//! of B. Horn, "Closed-form solution of absolute orientation using unit quaternions", J. Opt. Soc. Am. A 4(4), 1987, p.
//! 635. The eigenvectors are computed by the cyclic Jacobi method, which always converges and needs only square roots.

use glam::{DMat3, DQuat, DVec4};

/// Eigenvalues that differ from the largest by less than this, relative to the size of the matrix, count as equal to
/// it.
///
/// With a smaller bound the round-off of the Jacobi method (1e-15) would select an arbitrary direction where all are
/// equally good. With a larger one distinct optima would be mixed. A wrong decision costs this fraction of the elastic
/// energy.
const EQUAL: f64 = 1e-12;

/// The rotation `M` that maximises `tr(M Σ R0 rᵀ)`, that is, minimises `Σ |r − M R0|²`.
///
/// `at_rest` is `Σ R0 rᵀ`. If several rotations are optimal (corners on a line or at a point, or turned inside out),
/// the one nearest to `last` is returned. Never NaN: if nothing can be determined, `last` is returned.
pub fn optimum(at_rest: DMat3, last: DQuat) -> DQuat {
    let size = at_rest.to_cols_array().iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
    if !(size > 0.0 && at_rest.is_finite()) {
        return last;
    }
    let (values, vectors) = eigen(matrix(at_rest * size.recip()));
    let largest = values.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
    let last = DVec4::new(last.w, last.x, last.y, last.z);
    let best = || values.iter().zip(vectors).filter(|(value, _)| **value >= largest - EQUAL);
    // The point of the optimal set nearest to the last rotation is its projection on these eigenvectors.
    let nearest: DVec4 = best().map(|(_, vector)| vector * vector.dot(last)).sum();
    let chosen = nearest.try_normalize().or_else(|| best().next().map(|(_, vector)| vector));
    let q = chosen.unwrap_or(last);
    DQuat::from_xyzw(q.y, q.z, q.w, q.x).normalize()
}

/// Davenport's matrix (Horn 1987, p. 635) of `S = Σ R0 rᵀ`, for quaternions in the order w, x, y, z.
fn matrix(s: DMat3) -> [[f64; 4]; 4] {
    let [xx, yx, zx, xy, yy, zy, xz, yz, zz] = s.to_cols_array();
    [
        [xx + yy + zz, yz - zy, zx - xz, xy - yx],
        [yz - zy, xx - yy - zz, xy + yx, zx + xz],
        [zx - xz, xy + yx, yy - xx - zz, yz + zy],
        [xy - yx, zx + xz, yz + zy, zz - xx - yy],
    ]
}

/// Eigenvalues and eigenvectors of a symmetric matrix by the cyclic Jacobi method.
///
/// The method converges quadratically; six sweeps suffice for every input, the others are a reserve.
fn eigen(mut m: [[f64; 4]; 4]) -> ([f64; 4], [DVec4; 4]) {
    let mut vectors = [DVec4::X, DVec4::Y, DVec4::Z, DVec4::W];
    for _sweep in 0..12 {
        let mut turned = false;
        for p in 0..3 {
            for q in p + 1..4 {
                let off = m[p][q];
                // Below this an off-diagonal entry cannot change the diagonal any more.
                if off.abs() <= f64::EPSILON * 0.125 * (m[p][p].abs() + m[q][q].abs()) {
                    m[p][q] = 0.0;
                    m[q][p] = 0.0;
                    continue;
                }
                turned = true;
                let half = 0.5 * (m[q][q] - m[p][p]) / off;
                let tangent = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                let sine = tangent * cosine;
                for row in &mut m {
                    let (a, b) = (row[p], row[q]);
                    row[p] = cosine * a - sine * b;
                    row[q] = sine * a + cosine * b;
                }
                let (row_p, row_q) = (m[p], m[q]);
                m[p] = std::array::from_fn(|column| cosine * row_p[column] - sine * row_q[column]);
                m[q] = std::array::from_fn(|column| sine * row_p[column] + cosine * row_q[column]);
                let (a, b) = (vectors[p], vectors[q]);
                vectors[p] = a * cosine - b * sine;
                vectors[q] = a * sine + b * cosine;
            }
        }
        if !turned {
            break;
        }
    }
    ([m[0][0], m[1][1], m[2][2], m[3][3]], vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::{corners, moment};
    use glam::DVec3;

    fn near(a: DQuat, b: DQuat) -> bool {
        a.dot(b).abs() > 1.0 - 1e-14
    }

    #[test]
    fn finds_every_rotation_from_anywhere() {
        let rest = corners([1.0, 0.7, 0.4]);
        let mut turn = DQuat::from_xyzw(0.1, -0.2, 0.3, 0.9).normalize();
        for _ in 0..200 {
            turn = (turn * DQuat::from_xyzw(0.5, 0.3, -0.7, 0.4)).normalize();
            let a = moment(&rest, rest.iter().map(|&r| turn * r));
            assert!(near(optimum(a, DQuat::IDENTITY), turn), "{turn}");
        }
    }

    #[test]
    fn keeps_the_last_rotation_where_nothing_decides() {
        let last = DQuat::from_xyzw(0.1, -0.2, 0.3, 0.9).normalize();
        assert_eq!(optimum(DMat3::ZERO, last), last);
        assert_eq!(optimum(DMat3::from_cols_array(&[f64::NAN; 9]), last), last);
        // On a line: the last rotation about the line is kept, and the line itself is matched.
        let rest = corners([1.0; 3]);
        let line = DVec3::new(1.0, 2.0, -0.5).normalize();
        let a = moment(&rest, rest.iter().map(|r| line * r.x));
        let found = optimum(a, DQuat::IDENTITY);
        assert!((found * DVec3::X - line).length() < 1e-14);
        let shortest = DQuat::from_rotation_arc(DVec3::X, line);
        assert!(near(found, shortest), "nearest to no turn at all: {found} {shortest}");
    }

    #[test]
    fn a_mirrored_or_inverted_cube_has_some_optimum_and_always_the_same() {
        let rest = corners([1.0; 3]);
        for mirror in [DVec3::new(1.0, 1.0, -1.0), DVec3::splat(-1.0)] {
            let a = moment(&rest, rest.iter().map(|&r| r * mirror));
            let found = optimum(a, DQuat::IDENTITY);
            assert!(found.is_normalized() && found.is_finite());
            assert_eq!(found, optimum(a, DQuat::IDENTITY));
        }
    }
}
