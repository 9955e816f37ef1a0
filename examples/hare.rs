//! Makes the surface of the scenes with a mesh: a sitting hare, a smooth blend of balls, ellipsoids and cones.
//!
//! The surface is where a blended distance is zero. Each cell of a lattice that the surface crosses gets a point, and each
//! edge that it crosses a quadrilateral of the four cells around it (surface nets, after S. Gibson, 1998). Points are then
//! evened out and brought onto the surface.
//!
//! ```sh
//! cargo run --release --example hare
//! ```

use glam::{DVec3, IVec3};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};

/// The side of the lattice's cells (m).
const SIDE: f64 = 0.0113;
/// The number of times that points are evened out.
const ROUNDS: usize = 12;

/// A part of the shape.
enum Part {
    /// A middle (m), and a radius along each axis (m).
    Ellipsoid(DVec3, DVec3),
    /// A middle (m), the radii across (m), and the end of the longest one from the middle (m).
    Ear(DVec3, [f64; 2], DVec3),
    /// Two ends (m) with their radii (m).
    Cone([DVec3; 2], [f64; 2]),
}

/// The parts of the right half and of the middle, each with the width of its blend with those before it (m).
const HARE: [(Part, f64); 12] = {
    use Part::{Cone, Ear, Ellipsoid};
    const fn at(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }
    [
        (Ellipsoid(at(0.0, 0.17, -0.04), at(0.125, 0.155, 0.15)), 0.0),
        (Ellipsoid(at(0.0, 0.23, 0.045), at(0.1, 0.12, 0.09)), 0.06),
        (Ellipsoid(at(0.1, 0.105, -0.05), at(0.062, 0.1, 0.115)), 0.03),
        (Cone([at(0.118, 0.03, -0.05), at(0.142, 0.028, 0.085)], [0.034, 0.03]), 0.03),
        (Cone([at(0.048, 0.2, 0.09), at(0.05, 0.03, 0.13)], [0.038, 0.028]), 0.02),
        (Cone([at(0.05, 0.026, 0.13), at(0.052, 0.025, 0.16)], [0.027, 0.025]), 0.012),
        (Ellipsoid(at(0.0, 0.39, 0.075), at(0.088, 0.082, 0.098)), 0.045),
        (Ellipsoid(at(0.03, 0.362, 0.145), at(0.042, 0.034, 0.036)), 0.03),
        (Ear(at(0.056, 0.55, 0.005), [0.036, 0.023], at(0.03, 0.125, -0.05)), 0.022),
        (Ellipsoid(at(0.0, 0.11, -0.2), at(0.05, 0.05, 0.045)), 0.02),
        (Ellipsoid(at(0.063, 0.41, 0.124), at(0.022, 0.024, 0.022)), 0.004),
        (Ellipsoid(at(0.0, 0.378, 0.184), at(0.016, 0.011, 0.01)), 0.008),
    ]
};

impl Part {
    /// Distance from its surface (m), negative inside; that of ellipsoids is exact only near their surface.
    fn distance(&self, point: DVec3) -> f64 {
        let ellipsoid = |away: DVec3, radii: DVec3| {
            let (scaled, gradient) = ((away / radii).length(), (away / radii / radii).length());
            if gradient == 0.0 { -radii.min_element() } else { scaled * (scaled - 1.0) / gradient }
        };
        match *self {
            Self::Ellipsoid(middle, radii) => ellipsoid(point - middle, radii),
            Self::Ear(middle, [across, deep], end) => {
                let (away, long) = (point - middle, end.normalize());
                let side = long.cross(DVec3::Z).normalize();
                let turned = DVec3::new(away.dot(side), away.dot(long), away.dot(side.cross(long)));
                ellipsoid(turned, DVec3::new(across, end.length(), deep))
            }
            Self::Cone([from, to], [first, last]) => {
                let along = ((point - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
                point.distance(from.lerp(to, along)) - (first + along * (last - first))
            }
        }
    }
}

/// The blended distance from the surface (m), negative inside.
fn distance(point: DVec3) -> f64 {
    let mirrored = DVec3::new(point.x.abs(), point.y, point.z);
    HARE.iter().fold(f64::INFINITY, |nearest, (part, width)| {
        let other = part.distance(mirrored);
        let near = (width - (nearest - other).abs()).max(0.0);
        nearest.min(other) - if near > 0.0 { near * near / (4.0 * width) } else { 0.0 }
    })
}

/// The direction out of the shape.
fn outwards(point: DVec3) -> DVec3 {
    const NEAR: f64 = 1e-5;
    let slope = DVec3::AXES.map(|axis| distance(point + NEAR * axis) - distance(point - NEAR * axis));
    DVec3::from_array(slope).normalize_or(DVec3::Y)
}

/// The nearest point of the surface, roughly.
fn onto(mut point: DVec3) -> DVec3 {
    for _ in 0..5 {
        point -= distance(point) * outwards(point);
    }
    point
}

fn main() -> io::Result<()> {
    let (low, high) = (IVec3::new(-20, -2, -28), IVec3::new(20, 70, 24));
    let corner = |at: IVec3| (at.as_dvec3() + DVec3::splat(0.5)) * SIDE;
    let inside = |at: IVec3| distance(corner(at)) < 0.0;
    // The point of each cell, and quadrilaterals of the cells around each edge that leaves the shape.
    let mut cells: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    let mut points: Vec<DVec3> = Vec::new();
    let mut quadrilaterals: Vec<[u32; 4]> = Vec::new();
    for z in low.z..high.z {
        for y in low.y..high.y {
            for x in low.x..high.x {
                let from = IVec3::new(x, y, z);
                for axis in 0..3 {
                    let [along, one, other] = [0, 1, 2].map(|turn| IVec3::AXES[(axis + turn) % 3]);
                    let (is_in, is_out) = (inside(from), !inside(from + along));
                    if is_in != is_out {
                        continue;
                    }
                    let mut around = [from - one - other, from - other, from, from - one].map(|cell| {
                        *cells.entry(cell.to_array()).or_insert_with(|| {
                            points.push(corner(cell) + DVec3::splat(SIDE / 2.0));
                            points.len() as u32 - 1
                        })
                    });
                    if !is_in {
                        around.reverse();
                    }
                    quadrilaterals.push(around);
                }
            }
        }
    }
    let mut neighbours = vec![Vec::new(); points.len()];
    for quadrilateral in &quadrilaterals {
        for corner in 0..4 {
            neighbours[quadrilateral[corner] as usize].push(quadrilateral[(corner + 1) % 4]);
        }
    }
    points.iter_mut().for_each(|point| *point = onto(*point));
    for _ in 0..ROUNDS {
        let mean = |of: &Vec<u32>| of.iter().map(|&at| points[at as usize]).sum::<DVec3>() / of.len() as f64;
        let even: Vec<DVec3> = neighbours.iter().zip(&points).map(|(of, point)| point.lerp(mean(of), 0.5)).collect();
        points = even.into_iter().map(onto).collect();
    }
    let at = |corner: u32| points[corner as usize];
    let cut = |&[a, b, c, d]: &[u32; 4]| match at(a).distance(at(c)) < at(b).distance(at(d)) {
        true => [[a, b, c], [a, c, d]],
        false => [[a, b, d], [b, c, d]],
    };
    let triangles: Vec<[u32; 3]> = quadrilaterals.iter().flat_map(cut).collect();
    let path = format!("{}/scenes/hare.ply", env!("CARGO_MANIFEST_DIR"));
    write(BufWriter::new(File::create(&path)?), &points, &triangles)?;
    println!("{path}: {} points, {} triangles", points.len(), triangles.len());
    Ok(())
}

/// Writes a binary PLY file.
fn write(mut file: impl Write, points: &[DVec3], triangles: &[[u32; 3]]) -> io::Result<()> {
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\ncomment a hare in metres, made by cargo run --release --example hare\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        points.len(),
        triangles.len()
    )?;
    for point in points {
        file.write_all(point.as_vec3().to_array().map(f32::to_le_bytes).as_flattened())?;
    }
    for triangle in triangles {
        file.write_all(&[3])?;
        file.write_all(triangle.map(u32::to_le_bytes).as_flattened())?;
    }
    file.flush()
}
