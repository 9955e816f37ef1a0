//! The cost of a fine surface that a coarse body carries: `cargo bench --bench carried`. `benches/README.md` explains the numbers.

use glam::DVec3;
use localshape::mesh::{Fill, Filled, Surface, fill};
use localshape::sim::Carried;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::hint::black_box;
use std::time::Instant;

/// Rows and columns of points of surfaces: a million triangles, which the filling of some 11 000 cubes carries, and 70 000
/// triangles, which are filled with some 20 000 cubes.
const CARRIED: [u32; 2] = [501, 1000];
const FILLED: [u32; 2] = [176, 200];
/// Radii of the surfaces (sides of a cube).
const RADII: [f64; 2] = [13.0, 16.6];
const SAMPLES: usize = 40;
const FILLS: usize = 8;
/// More elements than there will be.
const MOST: usize = 1_000_000;

/// A closed sphere of a radius with waves.
fn sphere([rows, columns]: [u32; 2], radius: f64) -> Surface {
    let mut surface = Surface::default();
    let at = |polar: f64, round: f64| {
        let way = DVec3::new(polar.sin() * round.cos(), polar.cos(), polar.sin() * round.sin());
        way * (radius + 0.4 * (20.0 * polar).sin())
    };
    for row in 0..rows {
        let polar = std::f64::consts::PI * (f64::from(row) + 0.5) / f64::from(rows);
        let columns = (0..columns).map(|at| std::f64::consts::TAU * f64::from(at) / f64::from(columns));
        surface.points.extend(columns.map(|round| at(polar, round)));
    }
    let poles = [rows * columns, rows * columns + 1];
    surface.points.extend([at(0.0, 0.0), at(std::f64::consts::PI, 0.0)]);
    for column in 0..columns {
        let place = |row: u32, column: u32| row * columns + column % columns;
        for row in 1..rows {
            let [a, b] = [0, 1].map(|right| place(row - 1, column + right));
            let [c, d] = [1, 0].map(|right| place(row, column + right));
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
        let last = rows - 1;
        surface.triangles.push([poles[0], place(0, column + 1), place(0, column)]);
        surface.triangles.push([poles[1], place(last, column), place(last, column + 1)]);
    }
    surface
}

/// The time of some work (ms).
fn time<T>(work: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64() * 1e3
}

/// The shortest of times.
fn best(times: impl Iterator<Item = f64>) -> f64 {
    times.fold(f64::INFINITY, f64::min)
}

fn main() {
    let pool = |threads: usize| ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let pools = [pool(1), pool(2)];
    let filled = |surface: &Surface| fill(surface, Fill::Cubes { side: 1.0 }, MOST).expect("a closed surface");

    let coarse = sphere(FILLED, RADII[1]);
    let cubes = filled(&coarse).cage.elements.len();
    println!("{} triangles, filled with {cubes} cubes", coarse.triangles.len());
    let [one, two] = pools
        .each_ref()
        .map(|pool: &ThreadPool| pool.install(|| best((0..FILLS).map(|_| time(|| filled(black_box(&coarse)))))));
    println!("fill-ms: {one:.0}");
    println!("fill-threads-2: {:.2}", one / two);

    let made = filled(&sphere(CARRIED, RADII[0]));
    let Filled { cage, surface, weights, .. } = made;
    let triangles = surface.triangles.len();
    println!("{} points, {triangles} triangles, carried by {} cubes", weights.len(), cage.elements.len());
    let (carried, nodes) = (Carried { rest: surface.points, triangles: surface.triangles, weights }, cage.nodes);
    let sample = |pool: &ThreadPool| pool.install(|| time(|| carried.positions(black_box(&nodes))));
    let times: Vec<_> = (0..SAMPLES).map(|_| pools.each_ref().map(sample)).collect();
    let [one, two] = [0, 1].map(|at| best(times.iter().map(|pair| pair[at])));
    println!("carried-ms-per-100k: {:.2}", one / (triangles as f64 / 1e5));
    println!("carried-threads-2: {:.2}", one / two);
}
