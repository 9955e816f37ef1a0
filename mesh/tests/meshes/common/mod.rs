//! Surfaces to test with.

pub(crate) mod near;

use glam::DVec3;
use localshape_mesh::{Format, Limits, Mesh, Surface, read};

/// A box of 12 triangles.
pub(crate) fn block(low: DVec3, high: DVec3) -> Surface {
    let points = (0..8).map(|n| DVec3::select(glam::BVec3::new(n & 1 > 0, n & 2 > 0, n & 4 > 0), high, low)).collect();
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Surface { points, triangles, ..Surface::default() }
}

/// Several surfaces as one.
pub(crate) fn together(all: &[Surface]) -> Surface {
    let mut sum = Surface::default();
    for surface in all {
        let first = sum.points.len() as u32;
        sum.points.extend(&surface.points);
        sum.triangles.extend(surface.triangles.iter().map(|of| of.map(|point| point + first)));
    }
    sum
}

/// A closed surface with a grid of points over two angles, by a function of two numbers from 0 to 1.
fn grid(around: u32, along: u32, closes: bool, at: impl Fn(f64, f64) -> DVec3) -> Surface {
    let rows = if closes { along } else { along + 1 };
    let mut surface = Surface::default();
    for row in 0..rows {
        let v = f64::from(row) / f64::from(along);
        surface.points.extend((0..around).map(|n| at(f64::from(n) / f64::from(around), v)));
    }
    for row in 0..along {
        for n in 0..around {
            let at = |row: u32, n: u32| row % rows * around + n % around;
            let [a, b, c, d] = [at(row, n), at(row, n + 1), at(row + 1, n + 1), at(row + 1, n)];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// A ball.
pub(crate) fn ball(middle: DVec3, radius: f64, around: u32) -> Surface {
    use std::f64::consts::{PI, TAU};
    grid(around, around / 2, false, |u, v| {
        let (u, v) = (TAU * u, PI * v);
        let out = if v == PI || v == 0.0 { 0.0 } else { libm::sin(v) };
        middle + radius * DVec3::new(out * libm::cos(u), out * libm::sin(u), -libm::cos(v))
    })
}

/// A ring about the z-axis.
pub(crate) fn ring(radius: f64, thickness: f64, around: u32) -> Surface {
    use std::f64::consts::TAU;
    grid(around, around / 2, true, |u, v| {
        let (u, v) = (TAU * u, TAU * v);
        let out = radius + thickness * libm::cos(v);
        DVec3::new(out * libm::cos(u), out * libm::sin(u), thickness * libm::sin(v))
    })
}

/// The triangles of a surface as they are in a file without shared points.
pub(crate) fn apart(surface: &Surface) -> Surface {
    let points = surface.triangles.as_flattened().iter().map(|&point| surface.points[point as usize]).collect();
    let triangles = (0..surface.triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    Surface { points, triangles, ..Surface::default() }
}

/// A surface of Debian's package `libcgal-demo`, if it is installed.
pub(crate) fn scan(name: &str) -> Option<Surface> {
    let archive = "/usr/share/doc/libcgal-dev/data.tar.gz";
    let member = format!("data/meshes/{name}");
    let output = std::process::Command::new("tar").args(["xzOf", archive, "--occurrence", &member]).output().ok()?;
    if !output.status.success() {
        let _ = std::io::Write::write_all(&mut std::io::stderr(), b"skipped: libcgal-demo is not installed\n");
        return None;
    }
    // Its polygons may be concave, so that they are no fans.
    match read(&output.stdout, Format::Off, &Limits { points: 1_000_000, corners: 8_000_000 }) {
        Ok(Mesh::Surface(surface)) => Some(surface),
        other => panic!("{name}: {other:?}"),
    }
}
