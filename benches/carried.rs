//! The cost of a fine surface that a coarse body carries: `cargo bench --bench carried`. `benches/README.md` explains the numbers.

use glam::DVec3;
use localshape::sim::{Carried, Weights};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::hint::black_box;
use std::time::Instant;

/// Cells along an edge of the block: some 20 000.
const CELLS: u32 = 27;
/// Points along a meridian and along the equator of the surface: a million triangles.
const POINTS: [u32; 2] = [500, 1000];
const SAMPLES: usize = 40;

/// The nodes of the block, whose cells have a side of 1, and a sphere in it with waves.
fn block() -> (Vec<DVec3>, Carried) {
    let n = CELLS + 1;
    let nodes =
        (0..n * n * n).map(|at| DVec3::new((at % n).into(), (at / n % n).into(), (at / n / n).into())).collect();
    let [rows, columns] = POINTS;
    let mut carried = Carried { rest: Vec::new(), triangles: Vec::new(), weights: Weights::default() };
    for row in 0..rows {
        for column in 0..columns {
            let polar = std::f64::consts::PI * (f64::from(row) + 0.5) / f64::from(rows);
            let round = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            let way = DVec3::new(polar.sin() * round.cos(), polar.cos(), polar.sin() * round.sin());
            let at = DVec3::splat(0.5 * f64::from(CELLS)) + way * (13.0 + 0.4 * (20.0 * polar).sin());
            let cell = at.floor().min(DVec3::splat(f64::from(CELLS - 1)));
            let [u, v, w] = (at - cell).to_array();
            let [x, y, z] = cell.to_array().map(|place| place as u32);
            let corners = [0u32, 1, 2, 3, 4, 5, 6, 7].map(|bits| {
                let share = |part: f64, bit: u32| if bits >> bit & 1 == 1 { part } else { 1.0 - part };
                let node = x + (bits & 1) + n * (y + (bits >> 1 & 1) + n * (z + (bits >> 2)));
                (node, share(u, 0) * share(v, 1) * share(w, 2))
            });
            carried.rest.push(at);
            carried.weights.push(&corners.map(|corner| corner.0), &corners.map(|corner| corner.1));
            let next = |row: u32, column: u32| row * columns + column % columns;
            if row + 1 < rows {
                let [a, b, c, d] =
                    [next(row, column), next(row, column + 1), next(row + 1, column + 1), next(row + 1, column)];
                carried.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (nodes, carried)
}

/// The shortest of times of one frame (ms).
fn best(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

fn main() {
    let (nodes, carried) = block();
    let pool = |threads: usize| ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let pools = [pool(1), pool(2)];
    let time = |pool: &ThreadPool| {
        pool.install(|| {
            let start = Instant::now();
            black_box(carried.positions(black_box(&nodes)));
            start.elapsed().as_secs_f64() * 1e3
        })
    };
    let times: Vec<_> = (0..SAMPLES).map(|_| pools.each_ref().map(time)).collect();
    let [one, two] = [0, 1].map(|at| best(&times.iter().map(|pair| pair[at]).collect::<Vec<_>>()));
    let hundred_thousands = carried.triangles.len() as f64 / 1e5;
    println!("{} points, {} triangles", carried.rest.len(), carried.triangles.len());
    println!("carried-ms-per-100k: {:.2}", one / hundred_thousands);
    println!("carried-threads-2: {:.2}", one / two);
}
