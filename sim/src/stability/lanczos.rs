//! The largest eigenvalue of a symmetric matrix, from its products with vectors.
//!
//! C. Lanczos, Journal of Research of the National Bureau of Standards 45, 255 (1950). Vectors are not made orthogonal again: that
//! would only remove copies of eigenvalues already found.

use glam::DVec3;

/// The tridiagonal matrix after some steps.
#[derive(Debug, Default)]
struct Tridiagonal {
    /// On the diagonal.
    diagonal: Vec<f64>,
    /// Beside the diagonal, with one entry for the next step.
    beside: Vec<f64>,
}

/// The largest eigenvalue, and an eigenvector of length 1 if `vector`. `product` writes the matrix times its first argument to its
/// second, `most` limits the number of products, which `vector` doubles. The result is never above the eigenvalue,
/// and has the same bits everywhere.
pub(super) fn largest(
    start: &[DVec3],
    most: usize,
    vector: bool,
    mut product: impl FnMut(&[DVec3], &mut [DVec3]),
) -> (f64, Option<Vec<DVec3>>) {
    /// The final residual as a share of the eigenvalue, where `most` permits.
    const RESIDUAL: f64 = 3e-4;
    let mut found = Tridiagonal::default();
    let (mut value, mut last) = (0.0, Vec::new());
    run(start, most, &mut product, |_, _, alpha, beta| {
        found.diagonal.push(alpha);
        found.beside.push(beta);
        (value, last) = found.largest();
        let residual = beta * last.last().map_or(0.0, |share: &f64| share.abs());
        // The error of the value is the square of the residual over the distance to the next eigenvalue.
        residual > RESIDUAL * value.abs()
    });
    let sum = vector.then(|| {
        let mut sum = vec![DVec3::ZERO; start.len()];
        run(start, last.len(), &mut product, |at, basis, _, _| {
            sum.iter_mut().zip(basis).for_each(|(sum, &own)| *sum += own * last[at]);
            true
        });
        normalise(&mut sum);
        sum
    });
    (value, sum)
}

/// Calls `each` with the number of each step, its vector, and what it adds to the tridiagonal matrix; until it returns `false`,
/// after `most` steps, or where the space is exhausted.
fn run(
    start: &[DVec3],
    most: usize,
    product: &mut impl FnMut(&[DVec3], &mut [DVec3]),
    mut each: impl FnMut(usize, &[DVec3], f64, f64) -> bool,
) {
    let mut own = start.to_vec();
    let (mut before, mut next) = (vec![DVec3::ZERO; start.len()], vec![DVec3::ZERO; start.len()]);
    if normalise(&mut own) == 0.0 {
        return;
    }
    let mut beta = 0.0;
    let mut size = 0.0_f64;
    for at in 0..most {
        product(&own, &mut next);
        let alpha = dot(&next, &own);
        for ((next, &own), &before) in next.iter_mut().zip(&own).zip(&before) {
            *next -= own * alpha + before * beta;
        }
        beta = normalise(&mut next);
        size = size.max(alpha.abs()).max(beta);
        let is_exhausted = beta <= 1e-13 * size;
        if !each(at, &own, alpha, if is_exhausted { 0.0 } else { beta }) || is_exhausted {
            return;
        }
        std::mem::swap(&mut before, &mut own);
        std::mem::swap(&mut own, &mut next);
    }
}

impl Tridiagonal {
    /// The largest eigenvalue and its eigenvector of length 1.
    fn largest(&self) -> (f64, Vec<f64>) {
        let (diagonal, beside) = (&self.diagonal, &self.beside);
        let count = diagonal.len();
        let beside = |at: usize| if at + 1 < count { beside[at] } else { 0.0 };
        // All eigenvalues lie between these (Gershgorin).
        let reach = |at: usize| beside(at) + if at > 0 { beside(at - 1) } else { 0.0 };
        let mut low = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut high = (0..count).map(|at| diagonal[at] + reach(at)).fold(low, f64::max);
        // `shift − T` is positive definite above all eigenvalues, and only there all its pivots are positive.
        let pivots = |shift: f64| {
            let mut last = f64::INFINITY;
            (0..count).all(|at| {
                let across = if at > 0 { beside(at - 1) } else { 0.0 };
                last = shift - diagonal[at] - across * across / last;
                last > 0.0
            })
        };
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if pivots(middle) { high = middle } else { low = middle }
        }
        // Inverse iteration, from above, where no pivot is zero.
        let shift = high + 1e-14 * high.abs() + f64::MIN_POSITIVE;
        let mut vector = vec![1.0; count];
        for _ in 0..3 {
            let mut pivot = vec![0.0; count];
            for at in 0..count {
                pivot[at] = shift - diagonal[at];
                if at > 0 {
                    let factor = beside(at - 1) / pivot[at - 1];
                    pivot[at] -= factor * beside(at - 1);
                    vector[at] += factor * vector[at - 1];
                }
            }
            for at in (0..count).rev() {
                let after = if at + 1 < count { beside(at) * vector[at + 1] } else { 0.0 };
                vector[at] = (vector[at] + after) / pivot[at];
            }
            let length = vector.iter().map(|share| share * share).sum::<f64>().sqrt();
            vector.iter_mut().for_each(|share| *share /= length);
        }
        (high, vector)
    }
}

/// The sum of all products, in order.
pub(super) fn dot(one: &[DVec3], other: &[DVec3]) -> f64 {
    one.iter().zip(other).map(|(one, &other)| one.dot(other)).sum()
}

/// Makes a vector one of length 1, and returns its length before; leaves zero as it is.
fn normalise(vector: &mut [DVec3]) -> f64 {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 {
        vector.iter_mut().for_each(|part| *part /= length);
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    /// Symmetric matrices with random entries, of full and of lower rank, against their eigenvalues by another method.
    #[test]
    fn agrees_with_dense_eigenvalues() {
        for (nodes, rank) in [(1, 3), (2, 6), (5, 4), (20, 60), (20, 7)] {
            let size = 3 * nodes;
            let mut noise = Noise(7);
            let half = nalgebra::DMatrix::from_fn(size, rank, |_, _| noise.next());
            let matrix = &half * half.transpose();
            let start: Vec<_> = (0..nodes).map(|_| noise.vector()).collect();
            let product = |from: &[DVec3], to: &mut [DVec3]| {
                let from: Vec<f64> = from.iter().flat_map(|part| part.to_array()).collect();
                let out = &matrix * nalgebra::DVector::from_vec(from);
                to.iter_mut().enumerate().for_each(|(at, to)| *to = DVec3::from_slice(&out.as_slice()[3 * at..]));
            };
            let (value, vector) = largest(&start, 100, true, product);
            let expected = matrix.clone().symmetric_eigenvalues().max();
            assert!((value / expected - 1.0).abs() < 1e-6, "{nodes} {rank}: {value} {expected}");
            let vector = vector.expect("it was asked for");
            let mut image = vec![DVec3::ZERO; nodes];
            product(&vector, &mut image);
            assert!(
                (dot(&vector, &image) / expected - 1.0).abs() < 1e-6 && (dot(&vector, &vector) - 1.0).abs() < 1e-12
            );
        }
    }

    #[test]
    fn zero_is_its_own_largest_eigenvalue() {
        let zero = |_: &[DVec3], to: &mut [DVec3]| to.fill(DVec3::ZERO);
        let (value, vector) = largest(&[DVec3::X, DVec3::Y], 10, true, zero);
        assert_eq!((value, vector.map(|vector| vector.len())), (0.0, Some(2)));
        assert_eq!(largest(&[DVec3::ZERO], 10, false, zero).0, 0.0);
    }
}
