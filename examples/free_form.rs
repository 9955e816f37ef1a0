//! Makes the bodies of the free-form scenes: a bear of irregular cells, in the plane and in space.
//!
//! The cells are those of a Voronoi diagram whose seeds fill the shape: polygons in the plane, polyhedra in space. Other
//! seeds around the shape, without cells of their own, make the outer cells end near the surface.
//!
//! ```sh
//! cargo run --release --example free_form
//! ```

use glam::DVec3;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Write};
use zip::write::{SimpleFileOptions, ZipWriter};

/// Middle (m) and radius (m) of the balls whose union is the shape.
const BEAR: [(DVec3, f64); 8] = [
    (DVec3::new(0.0, 0.22, 0.0), 0.155),
    (DVec3::new(0.0, 0.44, 0.0), 0.115),
    (DVec3::new(-0.09, 0.535, 0.0), 0.05),
    (DVec3::new(0.09, 0.535, 0.0), 0.05),
    (DVec3::new(-0.185, 0.27, 0.02), 0.065),
    (DVec3::new(0.185, 0.27, 0.02), 0.065),
    (DVec3::new(-0.1, 0.075, 0.045), 0.08),
    (DVec3::new(0.1, 0.075, 0.045), 0.08),
];

/// The number of times that seeds are moved to the middles of their cells, which makes short edges and thin cells rare.
const RELAXATIONS: usize = 30;
/// Corners of neighbouring cells closer than this are one (m).
const SAME: f64 = 1e-7;

/// Distance from the shape's surface (m), negative inside, and the direction out.
fn surface(point: DVec3) -> (f64, DVec3) {
    let of = |&(middle, radius): &(DVec3, f64)| {
        let away = point - middle;
        (away.length() - radius, away.normalize_or(DVec3::Y))
    };
    BEAR.iter().map(of).min_by(|one, other| one.0.total_cmp(&other.0)).expect("the shape has balls")
}

/// A convex cell: its faces, each counter-clockwise from outside. In the plane one face, seen from in front.
type Cell = Vec<Vec<DVec3>>;

fn main() -> io::Result<()> {
    for (name, spacing, is_flat) in [("bear-plane", 0.062, true), ("bear", 0.078, false)] {
        let (mut seeds, ghosts) = (seeds(spacing, is_flat), ghosts(spacing, is_flat));
        let mut cells = cells(&seeds, &ghosts, is_flat);
        for _ in 0..RELAXATIONS {
            seeds = cells.iter().map(centroid).collect();
            cells = self::cells(&seeds, &ghosts, is_flat);
        }
        let body = Body::new(&cells, is_flat);
        let path = format!("{}/scenes/{name}.npz", env!("CARGO_MANIFEST_DIR"));
        body.write(File::create(&path)?, is_flat)?;
        println!("{path}: {} nodes, {} elements", body.nodes.len(), body.elements.len());
    }
    Ok(())
}

/// Points of a slightly disordered lattice inside the shape.
fn seeds(spacing: f64, is_flat: bool) -> Vec<DVec3> {
    let flattened = |point: DVec3| if is_flat { point.with_z(0.0) } else { point };
    let mut seeds: Vec<_> = BEAR.iter().map(|&(middle, _)| flattened(middle)).collect();
    let steps = |length: f64| (length / spacing).ceil() as i32;
    let depth = if is_flat { 0 } else { steps(0.2) };
    let mut state = 1u64;
    // Enough disorder to start from; the same on every run.
    let mut disorder = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 0.6 * spacing
    };
    for y in -1..=steps(0.7) {
        for x in -steps(0.3)..=steps(0.3) {
            for z in -depth..=depth {
                let mut point = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * spacing;
                point += DVec3::new(disorder(), disorder(), if is_flat { 0.0 } else { disorder() });
                let is_free = seeds.iter().all(|other| other.distance(point) > 0.6 * spacing);
                if is_free && surface(point).0 < -0.3 * spacing {
                    seeds.push(point);
                }
            }
        }
    }
    seeds
}

/// Points around the shape, at about the distance that the outermost seeds have inside it: cells end half-way.
fn ghosts(spacing: f64, is_flat: bool) -> Vec<DVec3> {
    // Distance from the surface, and from each other, in spacings.
    const OFF: f64 = 0.4;
    let apart = if is_flat { 0.8 } else { 1.05 };
    let mut ghosts: Vec<DVec3> = Vec::new();
    for &(middle, radius) in &BEAR {
        let radius = radius + OFF * spacing;
        let around = std::f64::consts::TAU * radius / (apart * spacing);
        let count = if is_flat { around.round() } else { (around * around / std::f64::consts::PI).round() };
        for at in 0..count as u32 {
            let share = (f64::from(at) + 0.5) / count;
            let direction = if is_flat {
                let angle = std::f64::consts::TAU * share;
                DVec3::new(angle.cos(), angle.sin(), 0.0)
            } else {
                // Steps by the golden angle spread evenly over a ball.
                let (angle, height) = (f64::from(at) * 2.399_963_229_728_653, 1.0 - 2.0 * share);
                let level = (1.0 - height * height).sqrt();
                DVec3::new(level * angle.cos(), height, level * angle.sin())
            };
            let ghost = if is_flat { middle.with_z(0.0) } else { middle } + radius * direction;
            let is_free = ghosts.iter().all(|other| other.distance(ghost) > 0.5 * apart * spacing);
            if is_free && surface(if is_flat { ghost.with_z(middle.z) } else { ghost }).0 > 0.8 * OFF * spacing {
                ghosts.push(ghost);
            }
        }
    }
    ghosts
}

/// The Voronoi cells of seeds among ghosts.
fn cells(seeds: &[DVec3], ghosts: &[DVec3], is_flat: bool) -> Vec<Cell> {
    let cell = |&seed: &DVec3| {
        let mut cell = if is_flat { square(seed) } else { cube(seed) };
        let mut others: Vec<_> = seeds.iter().chain(ghosts).filter(|&&other| other != seed).collect();
        others.sort_by(|a, b| a.distance_squared(seed).total_cmp(&b.distance_squared(seed)));
        for &other in others {
            let reach = cell.iter().flatten().map(|corner| corner.distance(seed)).fold(0.0, f64::max);
            if other.distance(seed) > 2.0 * reach {
                break;
            }
            cell = clip(&cell, (seed + other) / 2.0, (other - seed).normalize(), is_flat);
        }
        cell
    };
    seeds.iter().map(cell).collect()
}

const FAR: f64 = 1.0;

fn square(middle: DVec3) -> Cell {
    vec![[(-FAR, -FAR), (FAR, -FAR), (FAR, FAR), (-FAR, FAR)].map(|(x, y)| middle + DVec3::new(x, y, 0.0)).to_vec()]
}

fn cube(middle: DVec3) -> Cell {
    let corner =
        |bits: u32| middle + FAR * DVec3::from_array([0, 1, 2].map(|axis| f64::from(bits >> axis & 1) * 2.0 - 1.0));
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    faces.iter().map(|face| face.map(corner).to_vec()).collect()
}

/// The part of a cell behind a plane.
fn clip(cell: &Cell, point: DVec3, normal: DVec3, is_flat: bool) -> Cell {
    let height = |corner: DVec3| normal.dot(corner - point);
    let mut kept = Cell::new();
    let mut rim: Vec<DVec3> = Vec::new();
    for face in cell {
        let mut clipped = Vec::with_capacity(face.len() + 1);
        for (at, &a) in face.iter().enumerate() {
            let b = face[(at + 1) % face.len()];
            let (ha, hb) = (height(a), height(b));
            if ha <= 0.0 {
                clipped.push(a);
            }
            if (ha < 0.0 && hb > 0.0) || (ha > 0.0 && hb < 0.0) {
                // The order gives the same bits from both faces of the edge.
                let (low, high, hl, hh) = if ha < hb { (a, b, ha, hb) } else { (b, a, hb, ha) };
                let crossing = low + (high - low) * (hl / (hl - hh));
                clipped.push(crossing);
                rim.push(crossing);
            }
        }
        if clipped.len() > 2 {
            kept.push(clipped);
        }
    }
    if !is_flat && !rim.is_empty() {
        let mut corners: Vec<DVec3> = Vec::new();
        for corner in rim {
            if corners.iter().all(|other| other.distance(corner) > SAME * 0.1) {
                corners.push(corner);
            }
        }
        if corners.len() > 2 {
            let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
            let first = (corners[0] - middle).normalize();
            let second = normal.cross(first);
            let angle = |corner: &DVec3| (*corner - middle).dot(second).atan2((*corner - middle).dot(first));
            corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            kept.push(corners);
        }
    }
    kept
}

/// The middle of a cell, weighted by area or volume.
fn centroid(cell: &Cell) -> DVec3 {
    let corners: Vec<_> = cell.iter().flatten().copied().collect();
    let origin = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let (mut weight, mut sum) = (0.0, DVec3::ZERO);
    for face in cell {
        for at in 2..face.len() {
            let [a, b, c] = [face[0], face[at - 1], face[at]].map(|corner| corner - origin);
            let (part, middle) = match cell.len() {
                1 => ((b - a).cross(c - a).z, (a + b + c) / 3.0),
                _ => (a.dot(b.cross(c)), (a + b + c) / 4.0),
            };
            weight += part;
            sum += middle * part;
        }
    }
    origin + sum / weight
}

/// Nodes and elements in the scene format.
struct Body {
    nodes: Vec<DVec3>,
    elements: Vec<Vec<i32>>,
    faces: Vec<Vec<i32>>,
}

impl Body {
    fn new(cells: &[Cell], is_flat: bool) -> Self {
        let mut nodes: Vec<DVec3> = Vec::new();
        let mut places: HashMap<[i64; 3], Vec<i32>> = HashMap::new();
        // The cells of this grid are twice the tolerance: equal corners lie in one cell or in neighbouring ones.
        let key = |point: DVec3| (point / (2.0 * SAME)).floor().to_array().map(|at| at as i64);
        let mut place = |point: DVec3| {
            let [x, y, z] = key(point);
            let around =
                (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])));
            let known = around.filter_map(|key| places.get(&key)).flatten();
            if let Some(&node) = known.into_iter().find(|&&node| nodes[node as usize].distance(point) < SAME) {
                return node;
            }
            let node = nodes.len() as i32;
            nodes.push(point);
            places.entry([x, y, z]).or_default().push(node);
            node
        };
        let (mut elements, mut faces) = (Vec::new(), Vec::new());
        let mut known = HashMap::new();
        for cell in cells {
            let mut element = Vec::new();
            for face in cell {
                let mut corners: Vec<i32> = face.iter().map(|&corner| place(corner)).collect();
                corners.dedup();
                if corners.len() > 1 && corners.first() == corners.last() {
                    corners.pop();
                }
                if corners.len() < 3 {
                    continue;
                }
                element.extend(&corners);
                let mut sorted = corners.clone();
                sorted.sort_unstable();
                // Each face once, from either of its two cells.
                if !is_flat && known.insert(sorted, ()).is_none() {
                    faces.push(corners);
                }
            }
            if is_flat {
                elements.push(element);
                continue;
            }
            element.sort_unstable();
            element.dedup();
            elements.push(element);
        }
        if is_flat {
            elements = (0..).zip(elements).flat_map(|(at, polygon)| divided(polygon, at, &nodes)).collect();
        }
        Self { nodes, elements, faces }
    }

    /// Writes arrays as NumPy does; lists of different lengths are filled up with −1.
    fn write(&self, file: File, is_flat: bool) -> io::Result<()> {
        let mut archive = ZipWriter::new(file);
        let coordinates = if is_flat { 2 } else { 3 };
        let nodes = self.nodes.iter().flat_map(|node| node.to_array().into_iter().take(coordinates));
        array(
            &mut archive,
            "nodes",
            "<f8",
            [self.nodes.len(), coordinates],
            nodes.flat_map(f64::to_le_bytes).collect(),
        )?;
        let mut lists = |name: &str, lists: &[Vec<i32>]| {
            let longest = lists.iter().map(Vec::len).max().unwrap_or(0);
            let padded =
                lists.iter().flat_map(|list| list.iter().copied().chain(std::iter::repeat_n(-1, longest - list.len())));
            array(&mut archive, name, "<i4", [lists.len(), longest], padded.flat_map(i32::to_le_bytes).collect())
        };
        lists("elements", &self.elements)?;
        if !is_flat {
            lists("faces", &self.faces)?;
        }
        archive.finish()?;
        Ok(())
    }
}

/// Cuts some polygons in two, so that triangles and quadrilaterals stand beside the others.
fn divided(polygon: Vec<i32>, number: usize, nodes: &[DVec3]) -> Vec<Vec<i32>> {
    let cut = match number % 5 {
        0 => 2,
        3 => 3,
        _ => 0,
    };
    if cut == 0 || polygon.len() < cut + 3 {
        return vec![polygon];
    }
    // The cut makes the smaller part as large as possible, to avoid slivers.
    let area = |part: &[i32]| {
        let [first, rest @ ..] = part else { return 0.0 };
        let from = nodes[*first as usize];
        let corner = |node: i32| nodes[node as usize] - from;
        rest.windows(2).map(|two| corner(two[0]).cross(corner(two[1])).z).sum::<f64>()
    };
    let halves = |start: usize| {
        let turned: Vec<i32> = polygon.iter().cycle().skip(start).take(polygon.len()).copied().collect();
        let rest = turned[cut..].iter().chain(&turned[..1]).copied().collect::<Vec<_>>();
        vec![turned[..=cut].to_vec(), rest]
    };
    let smaller = |halves: &Vec<Vec<i32>>| halves.iter().map(|half| area(half)).fold(f64::INFINITY, f64::min);
    (0..polygon.len()).map(halves).max_by(|one, other| smaller(one).total_cmp(&smaller(other))).unwrap_or_default()
}

/// One array in the format that NumPy calls NPY 1.0.
fn array(
    archive: &mut ZipWriter<File>,
    name: &str,
    kind: &str,
    [rows, columns]: [usize; 2],
    data: Vec<u8>,
) -> io::Result<()> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    // Magic, version and length take ten bytes; the whole header is a multiple of 64.
    let header = format!("{header:<width$}\n", width = (header.len() + 11).next_multiple_of(64) - 11);
    archive.start_file(
        format!("{name}.npy"),
        SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored),
    )?;
    archive.write_all(b"\x93NUMPY\x01\x00")?;
    archive.write_all(&(header.len() as u16).to_le_bytes())?;
    archive.write_all(header.as_bytes())?;
    archive.write_all(&data)
}
