//! The points of carried surfaces, by all threads of the caller's pool (rayon).

use crate::sim::Carried;
use glam::DVec3;
use rayon::prelude::*;

/// The position of each point of a surface (m), from those of the body's nodes.
pub(crate) fn positions(surface: &Carried, nodes: &[DVec3]) -> Vec<DVec3> {
    let mut positions = Vec::new();
    append_positions(surface, nodes, &mut positions);
    positions
}

/// Appends the position of each point (m), as [`positions`].
pub(crate) fn append_positions(surface: &Carried, nodes: &[DVec3], positions: &mut Vec<DVec3>) {
    /// Points in one task, at least: each takes some 10 ns.
    const LEAST: usize = 2048;
    let points = (0..surface.weights.len()).into_par_iter().with_min_len(LEAST);
    positions.par_extend(points.map(|point| surface.weights.place(point, nodes)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Weights;

    #[test]
    fn points_have_the_same_bits_for_1_2_and_8_threads() {
        let nodes: Vec<_> = (0..9).map(f64::from).map(|at| DVec3::new(at.sin(), at.cos(), at * at)).collect();
        let mut weights = Weights::default();
        for point in 0..10_000u32 {
            let share = f64::from(point) / 1e4;
            weights.push(&[point % 9, (point + 4) % 9], &[share, 1.0 - share]);
        }
        let surface = Carried { rest: vec![DVec3::ZERO; weights.len()], triangles: Vec::new(), weights };
        for threads in [1, 2, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            assert_eq!(pool.install(|| positions(&surface, &nodes)), surface.positions(&nodes));
        }
    }
}
