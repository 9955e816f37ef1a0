//! Spheres, capsules and boxes: lit solids and their outlines.

use super::Staged;
use super::half_space::clipped_line;
use super::shapes::{FACES, Lathe, edges, lathe};
use super::space::Staging;
use crate::picture::narrow::{narrow, narrow_point};
use crate::picture::plane::around;
use crate::picture::{LineKind, Mesh, Solid, Vertex};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// The largest distance of a round outline from its polygon (px).
const FLATNESS: f64 = 0.12;
/// The least and the largest number of segments of a round outline, and their number for shadows only.
const SEGMENTS: [usize; 2] = [16, 128];
const SHADOW_SEGMENTS: usize = 20;
/// The size of cells of surfaces near the body (soft units), and their largest number along a side of a box.
const CELL: f64 = 0.3;
const MOST_CELLS: f64 = 64.0;
/// Balls larger than this (body sizes) are cut finely where the body is, and coarsely elsewhere.
const LARGE_BALL: f64 = 3.0;

impl Staging<'_> {
    /// Draws a round obstacle of a radius around a middle (m), whose shape has any number of segments.
    pub(super) fn round(&self, shape: impl Fn(usize) -> Lathe, radius: f64, middle: DVec3, staged: &mut Staged) {
        let distance = (middle - self.draft.lens.eye).dot(self.draft.lens.forward) - radius;
        let pixels = self.draft.lens.focal * radius / distance.max(self.draft.lens.near);
        let needed = (PI / (2.0 * FLATNESS / pixels.max(1e-3)).sqrt()).ceil();
        let segments = needed.clamp(SEGMENTS[0] as f64, SEGMENTS[1] as f64) as usize;
        let lathe = shape(segments.next_multiple_of(4));
        let near = self.near(lathe.points().into_iter());
        // Finer where the body occludes its light.
        let mesh = match near {
            Some(near) => self.turned(&lathe.refined(CELL * self.soft()), |at, out| near.to(at, out)),
            None => self.turned(&lathe, |_, _| 0.0),
        };
        self.outline(&lathe, staged);
        staged.outermost.extend(lathe.rings.iter().flatten().map(|(at, _)| *at));
        staged.solids.push(Solid { mesh, colour: self.palette().obstacle });
        let coarse = shape(SHADOW_SEGMENTS);
        staged.add(&coarse.points(), &coarse.triangles());
    }

    /// The surface of a ball.
    pub(super) fn ball(&self, centre: DVec3, radius: f64, segments: usize) -> Lathe {
        let rings = segments / 2;
        if radius <= LARGE_BALL * self.extent() {
            let profile = (0..=rings).map(|ring| (PI * ring as f64 / rings as f64 - FRAC_PI_2, 0.0));
            return lathe(centre, DVec3::Y, radius, profile, segments);
        }
        // The rings become closer towards the body.
        let axis = (self.draft.origin - centre).try_normalize().unwrap_or(DVec3::Y);
        let growth = 1.2 * libm::log(1.0 + radius / self.extent());
        let profile = (0..=rings).rev().map(|ring| {
            let share = libm::expm1(growth * ring as f64 / rings as f64) / libm::expm1(growth);
            (FRAC_PI_2 - PI * share, 0.0)
        });
        lathe(centre, axis, radius, profile, segments)
    }

    /// Draws a box.
    pub(super) fn block(&self, corners: &[DVec3; 8], axes: [DVec3; 3], staged: &mut Staged) {
        let mut mesh = Mesh::default();
        let near = self.near(corners.iter().copied());
        let mut seen = [false; 6];
        for (face, nodes) in FACES.iter().enumerate() {
            let normal = axes[face / 2] * if face % 2 == 0 { -1.0 } else { 1.0 };
            let base = mesh.vertices.len() as u32;
            let polygon = nodes.map(|node| corners[node]);
            // Faces are cut into cells where the body occludes their light.
            let cells = |one: usize, other: usize| match near {
                Some(_) => (polygon[one].distance(polygon[other]) / (CELL * self.soft())).ceil().clamp(1.0, MOST_CELLS),
                None => 1.0,
            };
            let counts = [cells(0, 1), cells(0, 3)];
            let [across, along] = counts.map(|count| count as u32);
            for (row, column) in (0..=along).flat_map(|row| (0..=across).map(move |column| (row, column))) {
                let [x, y] = [f64::from(column) / counts[0], f64::from(row) / counts[1]];
                let at = polygon[0].lerp(polygon[1], x).lerp(polygon[3].lerp(polygon[2], x), y);
                let near = near.as_ref().map_or(0.0, |near| near.to(at, normal));
                mesh.vertices.push(self.corner(at, normal, near));
            }
            for (row, column) in (0..along).flat_map(|row| (0..across).map(move |column| (row, column))) {
                let at = base + row * (across + 1) + column;
                let above = at + across + 1;
                mesh.triangles.extend([[at, at + 1, above + 1], [at, above + 1, above]]);
            }
            seen[face] = self.draft.lens.sees(polygon[0], normal);
            if seen[face] {
                self.ground_line(&polygon, staged);
            }
        }
        for ([a, b], [one, other]) in edges() {
            let line = [corners[a], corners[b]];
            match (seen[one], seen[other]) {
                (true, true) => self.line(line, LineKind::ObstacleEdge, staged),
                (false, false) => {}
                _ => self.line(line, LineKind::ObstacleContour, staged),
            }
        }
        staged.outermost.extend(corners);
        let triangles: Vec<_> = FACES
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .map(|three| three.map(|at| at as u32))
            .collect();
        staged.add(corners, &triangles);
        staged.solids.push(Solid { mesh, colour: self.palette().obstacle });
    }

    /// The mesh of a round obstacle with the ambient light that the body takes at points with normals.
    fn turned(&self, lathe: &Lathe, near: impl Fn(DVec3, DVec3) -> f64) -> Mesh {
        let vertices = lathe.rings.iter().flatten().map(|&(at, out)| self.corner(at, out, near(at, out))).collect();
        Mesh { vertices, triangles: lathe.triangles(), ..Mesh::default() }
    }

    fn corner(&self, at: DVec3, normal: DVec3, near: f64) -> Vertex {
        let position = self.draft.relative(at);
        Vertex { position, normal: narrow_point(normal).to_array(), hatch: narrow(near) }
    }

    /// The lines where a round surface turns away from the viewer, and where it meets the ground.
    fn outline(&self, lathe: &Lathe, staged: &mut Staged) {
        let count = lathe.rings.first().map_or(0, Vec::len);
        let at = |ring: usize, segment: usize| lathe.rings[ring][segment % count].0;
        let seen: Vec<Vec<bool>> = (1..lathe.rings.len())
            .map(|ring| {
                let quad = |segment| {
                    let [a, b] = [at(ring - 1, segment), at(ring - 1, segment + 1)];
                    let [c, d] = [at(ring, segment + 1), at(ring, segment)];
                    self.draft.lens.sees(a.midpoint(c), (c - a).cross(d - b))
                };
                (0..count).map(quad).collect()
            })
            .collect();
        for ring in 0..seen.len() {
            for segment in 0..count {
                if seen[ring][segment] != seen[ring][(segment + 1) % count] {
                    let two = [at(ring, segment + 1), at(ring + 1, segment + 1)];
                    self.line(two, LineKind::ObstacleContour, staged);
                }
                if ring > 0 && seen[ring][segment] != seen[ring - 1][segment] {
                    let two = [at(ring, segment), at(ring, segment + 1)];
                    self.line(two, LineKind::ObstacleContour, staged);
                }
            }
        }
        for ring in 1..lathe.rings.len() {
            for segment in (0..count).filter(|&segment| seen[ring - 1][segment]) {
                let quad = [at(ring - 1, segment), at(ring - 1, segment + 1), at(ring, segment + 1), at(ring, segment)];
                self.ground_line(&quad, staged);
            }
        }
    }

    /// Adds a line, cut off where it goes below the ground.
    fn line(&self, ends: [DVec3; 2], kind: LineKind, staged: &mut Staged) {
        let left = clipped_line(ends, self.ground.as_slice());
        staged.lines.extend(left.map(|ends| self.draft.line(ends, kind, 1.0)));
    }

    /// The line in which a polygon meets the ground.
    fn ground_line(&self, polygon: &[DVec3], staged: &mut Staged) {
        let Some((normal, height)) = self.ground else { return };
        let above = |point: DVec3| normal.dot(point) - height;
        let through: Vec<_> = around(polygon)
            .filter_map(|(&a, &b)| {
                let (x, y) = (above(a), above(b));
                ((x < 0.0) != (y < 0.0)).then(|| a.lerp(b, x / (x - y)))
            })
            .collect();
        if let [from, to] = through[..] {
            staged.lines.push(self.draft.line([from, to], LineKind::ObstacleContour, 1.0));
        }
    }
}
