//! The linear map that fits an element best, for what goes beyond the paper.

use crate::element::Dimension;
use crate::rotation::moment;
use glam::{DMat3, DVec3};

/// What of the rest shape of an element the map follows from.
#[derive(Clone, Copy)]
pub(super) struct AtRest {
    /// The pseudo-inverse of `M = Σ R0 R0ᵀ` (1/m²).
    pub(super) inverse: DMat3,
    /// `Σ |R0|² / 2d` (m²) in `d` dimensions, which is `μ V / k`; 0 for an element without volume.
    pub(super) size: f64,
    dimension: Dimension,
}

/// The linear map `F` of an element, and what follows from it.
#[derive(Clone, Copy)]
pub(super) struct Stretch {
    /// `F = A M⁻¹` with `A = Σ r R0ᵀ`: it minimises `Σ |r − F R0|²`.
    pub(super) map: DMat3,
    /// The force of the volume on a corner is `−k` times this matrix times `R0`.
    pub(super) pressure: DMat3,
    /// The energy of the volume over `k/2` (m²).
    pub(super) volume: f64,
}

/// Whether the nodes of an element with these `R0` (m) are those of a simplex, so that a linear map fits all their displacements.
#[cfg(feature = "scene")]
pub(super) fn is_simplex(rest: &[DVec3]) -> bool {
    pseudo_inverse(moment(rest, rest.iter().copied())).1 + 1 == rest.len()
}

impl AtRest {
    /// Of an element with these `R0` (m).
    pub(super) fn new(rest: &[DVec3], dimension: Dimension) -> Self {
        Self::of_moment(moment(rest, rest.iter().copied()), dimension)
    }

    /// Of an element with this `M` (m²).
    pub(super) fn of_moment(moment: DMat3, dimension: Dimension) -> Self {
        let (inverse, rank) = pseudo_inverse(moment);
        let whole = if dimension == Dimension::Plane { 2 } else { 3 };
        let spread = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
        let size = if rank < whole { 0.0 } else { spread / (2.0 * whole as f64) };
        Self { inverse, size, dimension }
    }

    /// The map for `Σ R0 rᵀ` (m²), with `λ/μ`.
    pub(super) fn stretch(&self, at_rest: DMat3, lame_over_shear: f64) -> Stretch {
        let map = at_rest.transpose() * self.inverse;
        let mut full = map;
        if self.dimension == Dimension::Plane {
            full.z_axis.z = 1.0;
        }
        let (weight, excess) = (lame_over_shear * self.size, full.determinant() - 1.0);
        let [x, y, z] = [full.x_axis, full.y_axis, full.z_axis];
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        Stretch { map, pressure: cofactors * self.inverse * (weight * excess), volume: weight * excess * excess }
    }
}

/// The pseudo-inverse of a symmetric matrix without negative eigenvalues, and its rank.
fn pseudo_inverse(matrix: DMat3) -> (DMat3, usize) {
    /// Relative to the mean eigenvalue: smaller ones count as 0.
    const SMALL: f64 = 1e-9;
    const SWEEPS: usize = 12;
    let mean = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z) / 3.0;
    if matrix.determinant() > 1e-6 * mean * mean * mean {
        return (matrix.inverse(), 3);
    }
    // Jacobi's method: rotations, each of which makes an entry beside the diagonal zero.
    let mut rows = matrix.to_cols_array_2d();
    let mut vectors = DMat3::IDENTITY.to_cols_array_2d();
    for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(3 * SWEEPS) {
        let off = rows[p][q];
        if off == 0.0 {
            continue;
        }
        let slope = (rows[q][q] - rows[p][p]) / (2.0 * off);
        let tangent = slope.signum() / (slope.abs() + (slope * slope + 1.0).sqrt());
        let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
        let sine = tangent * cosine;
        for row in &mut rows {
            (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
        }
        for column in 0..3 {
            let (a, b) = (rows[p][column], rows[q][column]);
            (rows[p][column], rows[q][column]) = (cosine * a - sine * b, sine * a + cosine * b);
            let (a, b) = (vectors[p][column], vectors[q][column]);
            (vectors[p][column], vectors[q][column]) = (cosine * a - sine * b, sine * a + cosine * b);
        }
    }
    let (mut inverse, mut rank) = (DMat3::ZERO, 0);
    for (axis, vector) in vectors.into_iter().enumerate() {
        if rows[axis][axis] > SMALL * mean {
            let vector = DVec3::from_array(vector);
            let scaled = vector / rows[axis][axis];
            inverse += DMat3::from_cols(scaled * vector.x, scaled * vector.y, scaled * vector.z);
            rank += 1;
        }
    }
    (inverse, rank)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn singular_matrices_are_inverted_where_they_are_not() {
        for vectors in [
            vec![],
            vec![DVec3::new(1.0, 2.0, -0.5)],
            vec![DVec3::new(1.0, 2.0, -0.5), DVec3::new(0.3, -0.2, 1.0)],
            vec![DVec3::new(1.0, 2.0, -0.5), DVec3::new(0.3, -0.2, 1.0), DVec3::X],
            vec![DVec3::X, DVec3::X],
        ] {
            let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
            let matrix = vectors.iter().fold(DMat3::ZERO, |sum, &v| sum + outer(v));
            let (inverse, rank) = pseudo_inverse(matrix);
            assert_eq!(rank, if vectors.len() == 2 && vectors[0] == vectors[1] { 1 } else { vectors.len() });
            let off = (matrix * inverse * matrix - matrix)
                .to_cols_array()
                .into_iter()
                .fold(0.0, |far: f64, e| far.max(e.abs()));
            assert!(off < 1e-13, "{off:e}");
        }
    }
}
