//! Closed surfaces of sets of elements: triangles, edges and contours. All of them come from the pieces of a cut face,
//! so they are in one long file.

use super::draft::Draft;
use crate::bins::Bins;
use crate::look::BODIES;
use crate::picture::cut::{CutPatch, Cuts};
use crate::picture::ears::{self, newell};
use crate::picture::field::Shades;
use crate::picture::measures::SMALLEST_ELEMENT;
use crate::picture::narrow::{narrow, narrow_count, narrow_point};
use crate::picture::shell::Side;
use crate::picture::{Line, LineKind, Mesh, Vertex};
use crate::sim::geometry::{around, ordered};
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::f64::consts::FRAC_1_SQRT_2;

/// The largest distance of the flat pieces of a patch from it (px).
const FLATNESS: f64 = 0.35;
/// The finest cut of a patch in each direction, and of few faces: the cut that gives this many cells in all.
const FINEST_CUT: usize = 6;
const FINEST_OF_FEW: usize = 24;
const CELLS_OF_FEW: usize = 4000;
/// More faces than this are cut in two at most, and still more are not cut: their patches are small, and drawing them
/// takes longest.
const MANY_FACES: usize = 3000;
const VERY_MANY_FACES: usize = 12_000;

/// Faces with a greater cosine of their normals are lit so alike that no border is visible between them.
const SMOOTH: f64 = 0.995;
/// Edges of elements smaller than this (px) are not visible through the body: their opacity would be less than 1 %.
const SEEN_THROUGH: f64 = 7.2;
/// Edges of so many elements or more, smaller than this (px), are drawn with their faces instead of as lines: a line takes
/// longer than a small face. Edges behind such faces would be too many to be of use.
const MANY_ELEMENTS: usize = 100;
const FINE: f64 = 40.0;
/// Faces of elements larger than this (px) have edges dark enough to need no smooth borders below them.
const DARK: f64 = 13.0;

/// Turns faces into the parts of a panel.
pub(super) struct Surfaces<'a> {
    pub(super) draft: &'a Draft<'a>,
    /// The hatch of each body.
    pub(super) hatches: Vec<Hatch>,
}

/// The hatch of a body. Stripes have a period (m) along `X + Y + Z` of the body at rest or, around a middle (m), at right angles
/// to `X + Y` of the body now.
pub(super) struct Hatch {
    pub(super) period: f64,
    pub(super) middle: Option<DVec3>,
}

/// One face cut into triangles. Its memory is reused for the next one.
#[derive(Default)]
struct Patch {
    /// The corners of the face, seen from outside counter-clockwise.
    nodes: Vec<u32>,
    corners: Vec<DVec3>,
    /// The place of each corner in the pattern on the face.
    phases: Vec<f64>,
    points: Vec<DVec3>,
    /// The triangles, as places in `points`.
    triangles: Vec<[u32; 3]>,
    /// Whether it is a bilinear patch, whose normals vary over it; otherwise each triangle has a normal.
    is_curved: bool,
    /// The component of the normals towards the viewer: at each point of a bilinear patch, else of each triangle. If it
    /// is negative, the viewer sees the inside.
    facing: Vec<f64>,
}

/// The lines of surfaces: drawn lines, and borders, at which colours change with or without a line.
#[derive(Default)]
pub(super) struct SurfaceLines {
    pub(super) drawn: Vec<Line>,
    pub(super) borders: Vec<Border>,
}

/// A line at which colours change.
pub(super) struct Border {
    pub(super) line: Line,
    /// The nodes of its edge; none within a face.
    pub(super) edge: Option<[u32; 2]>,
}

/// A side of a face.
#[derive(Clone, Copy, Default)]
struct FaceSide {
    /// Its nodes.
    ends: [u32; 2],
    /// The index of its first value in [`FaceSides`], and the number of its pieces.
    first: u32,
    pieces: u32,
    face: u32,
}

/// The sides of all faces of a surface, cut into pieces, with the component of the face's normals towards the viewer.
#[derive(Default)]
struct FaceSides {
    /// The values at the ends of the pieces, side after side.
    facing: Vec<f64>,
    /// The mean unit normal of each face.
    normals: Vec<DVec3>,
    sides: Vec<FaceSide>,
}

impl FaceSides {
    /// The sides sorted by edge.
    fn sorted(&self, nodes: usize) -> Vec<FaceSide> {
        // Sorted into bins by the first node, which leaves hardly anything to sort.
        let sides = self.sides.iter().map(|side| (side.ends[0].min(side.ends[1]), *side));
        Bins::new(nodes, sides).sorted(|side| (ordered(side.ends), side.first))
    }

    /// The value of a side at a part of its edge's length, which runs from the lower node to the higher one.
    fn at(&self, side: &FaceSide, share: f64) -> f64 {
        let [from, to] = side.ends;
        let along = (if from < to { share } else { 1.0 - share }) * f64::from(side.pieces);
        let piece = (along as usize).min(side.pieces as usize - 1);
        let [a, b] = [0, 1].map(|end| self.facing[side.first as usize + piece + end]);
        a + (b - a) * (along - piece as f64)
    }

    /// The values at the ends of the pieces of a side.
    fn of(&self, side: &FaceSide) -> &[f64] {
        &self.facing[side.first as usize..][..=side.pieces as usize]
    }

    /// Whether the faces of two sides are lit differently.
    fn are_bent(&self, sides: &[FaceSide]) -> bool {
        let normal = |side: &FaceSide| self.normals[side.face as usize];
        sides.iter().skip(1).any(|side| normal(side).dot(normal(&sides[0])) < SMOOTH)
    }

    /// Calls `draw` with the parts of an edge at which the surface turns away from the viewer: the outside of one of
    /// its sides is visible, that of another is not. An edge with a single side is a border of the surface.
    fn contours(&self, sides: &[FaceSide], draw: &mut dyn FnMut([f64; 2])) {
        // Nearly all edges have no such part.
        let are_away = |side: &FaceSide, away: bool| self.of(side).iter().all(|&seen| (seen < 0.0) == away);
        if sides.len() > 1 && [false, true].iter().any(|&away| sides.iter().all(|side| are_away(side, away))) {
            return;
        }
        // The places where the values of the sides change their sign, in lengths of the edge.
        let mut changes = Vec::new();
        for side in sides {
            let ([from, to], values) = (side.ends, self.of(side));
            for (piece, two) in values.windows(2).enumerate().filter(|(_, two)| (two[0] < 0.0) != (two[1] < 0.0)) {
                let share = (piece as f64 + two[0] / (two[0] - two[1])) / f64::from(side.pieces);
                changes.push(if from < to { share } else { 1.0 - share });
            }
        }
        changes.sort_unstable_by(f64::total_cmp);
        let (mut begin, mut from) = (None, 0.0);
        for to in changes.iter().copied().chain([1.0]) {
            let middle = f64::midpoint(from, to);
            let away = sides.iter().filter(|side| self.at(side, middle) < 0.0).count();
            let is_contour = sides.len() == 1 || (away > 0 && away < sides.len());
            match begin {
                None if is_contour => begin = Some(from),
                Some(start) if !is_contour => {
                    draw([start, from]);
                    begin = None;
                }
                _ => {}
            }
            from = to;
        }
        if let Some(start) = begin {
            draw([start, 1.0]);
        }
    }
}

impl Surfaces<'_> {
    /// The place of each element among the colours of bodies and regions; empty if there is one, or a field colours surfaces.
    pub(super) fn colours(&self) -> &[u8] {
        if self.draft.shades.is_none() { &self.draft.bodies.colours } else { &[] }
    }

    pub(super) fn at(&self, node: u32) -> DVec3 {
        self.draft.position[node as usize]
    }

    /// The corners of a face as seen from outside of the set that it bounds.
    pub(super) fn corners(&self, side: &Side, nodes: &mut Vec<u32>) {
        nodes.clear();
        nodes.extend_from_slice(&self.draft.body.faces().nodes[side.face as usize]);
        if side.reversed {
            nodes.reverse();
        }
    }

    /// Adds a surface to a mesh and its lines to the lines.
    ///
    /// There are `total` faces in this and other surfaces.
    pub(super) fn add(&self, faces: &[Side], total: usize, kind: LineKind, mesh: &mut Mesh, lines: &mut SurfaceLines) {
        if faces.is_empty() {
            return;
        }
        let (cuts, mut grids) = (self.cuts(faces, total), HashMap::new());
        // The memory for uncut faces.
        mesh.vertices.reserve(4 * faces.len());
        mesh.triangles.reserve(2 * faces.len());
        mesh.shades.reserve(if self.draft.shades.is_some() || !self.colours().is_empty() {
            4 * faces.len()
        } else {
            0
        });
        let is_edged = self.is_fine() && self.edges(kind)[0];
        // Faces on the far side of the body are drawn last: the others hide them, so that they need no light.
        let mut last = Vec::new();
        let is_inside_out = kind != LineKind::Edge;
        let (mut patch, mut borders) = (Patch::default(), FaceSides::default());
        borders.sides.reserve(4 * faces.len());
        borders.facing.reserve(8 * faces.len());
        for (at, side) in faces.iter().enumerate() {
            self.corners(side, &mut patch.nodes);
            let ears = self.ears(&patch.nodes);
            let ears = ears.as_deref();
            let cut = self.bilinear(&patch.nodes, ears).map(|corners| cuts.face(at, corners));
            let grid = cut.map(|cut| &*grids.entry(cut).or_insert_with(|| CutPatch::new(cut)));
            let before = mesh.triangles.len();
            // Turned-over elements are hatched, flat ones among the others dotted.
            let dots = (kind == LineKind::Edge).then(|| f64::from(u8::from(self.is_flat(side))));
            self.emit(side, ears, dots, grid, &mut patch, mesh);
            if is_edged {
                note_edges(&patch, grid, &mut mesh.edges);
            }
            if patch.facing.iter().all(|&seen| (seen < 0.0) != is_inside_out) {
                last.extend(mesh.triangles.drain(before..));
            }
            self.inner_contours(&patch, kind, lines);
            note_borders(&patch, ears, grid, &cuts, &mut borders);
        }
        mesh.triangles.append(&mut last);
        let sides = borders.sorted(self.draft.body.len());
        for edge in sides.chunk_by(|one, other| ordered(one.ends) == ordered(other.ends)) {
            self.edge(edge, &borders, kind, lines);
        }
    }

    /// The lines along one edge, at which the sides of some faces meet.
    fn edge(&self, sides: &[FaceSide], borders: &FaceSides, kind: LineKind, lines: &mut SurfaceLines) {
        let [a, b] = ordered(sides[0].ends);
        let (start, end) = (self.at(a), self.at(b));
        let faces_away = |side: &FaceSide| borders.of(side).iter().all(|&seen| seen < 0.0);
        let is_hidden = kind == LineKind::Edge && sides.iter().all(faces_away);
        let [in_front, behind] = self.edges(kind);
        // Smaller ones would be invisible.
        let is_large = self.draft.element > if is_hidden { SEEN_THROUGH } else { SMALLEST_ELEMENT.into() };
        if is_large && !self.is_fine() && if is_hidden { behind } else { in_front } {
            lines.drawn.push(self.draft.line([start, end], kind, if behind { 1.0 } else { 0.0 }));
        }
        let mut is_contour = false;
        borders.contours(sides, &mut |part| {
            self.contour(part.map(|at| start.lerp(end, at)), Some([a, b]), kind, lines);
            is_contour = true;
        });
        let is_dark = self.is_fine() && in_front && self.draft.element > DARK;
        if !is_hidden
            && !is_contour
            && !is_dark
            && (borders.are_bent(sides) || self.draft.shades.as_ref().is_some_and(Shades::jump))
        {
            lines.borders.push(Border { line: self.draft.line([start, end], kind, 1.0), edge: Some([a, b]) });
        }
    }

    /// Whether edges in front of the body, and behind it, are drawn: those of few turned-over elements always. Of many only the outline
    /// is seen through the body.
    fn edges(&self, kind: LineKind) -> [bool; 2] {
        let [in_front, behind] = self.draft.scene.view.edges.are_drawn();
        match kind {
            LineKind::Edge => [in_front, behind],
            _ if self.draft.marks_outline() => [in_front, false],
            _ => [true; 2],
        }
    }

    /// A place where the surface turns away from the viewer.
    fn contour(&self, ends: [DVec3; 2], edge: Option<[u32; 2]>, kind: LineKind, lines: &mut SurfaceLines) {
        let line = self.draft.line(ends, kind.contour(), 1.0);
        lines.drawn.push(line);
        lines.borders.push(Border { line, edge });
    }

    /// Whether faces draw the edges of their elements.
    fn is_fine(&self) -> bool {
        !self.draft.lens.orthographic
            && self.draft.bodies.ears.is_empty()
            && self.draft.element < FINE
            && self.draft.body.elements().len() >= MANY_ELEMENTS
    }

    /// The component of an outward normal at a point towards the viewer, in units of its length times the distance.
    /// In the plane all are visible.
    pub(super) fn facing(&self, point: DVec3, normal: DVec3) -> f64 {
        if self.draft.lens.orthographic { 1.0 } else { -normal.dot(point - self.draft.lens.eye) }
    }

    /// The triangles of a face that is not convex: in space as at rest, in the plane as now, on a page whose y-axis points down.
    fn ears(&self, nodes: &[u32]) -> Option<Cow<'_, [[u32; 3]]>> {
        if !self.draft.lens.orthographic {
            return self.draft.bodies.ears.of(nodes).map(Cow::Borrowed);
        }
        let mut corners: Vec<_> = nodes.iter().map(|&node| DVec2::new(self.at(node).x, -self.at(node).y)).collect();
        let is_reversed = newell(&corners.iter().map(|at| at.extend(0.0)).collect::<Vec<_>>()).z < 0.0;
        if is_reversed {
            corners.reverse();
        }
        let last = corners.len() as u32 - 1;
        let own = |ear: [u32; 3]| if is_reversed { ear.map(|at| last - at) } else { ear };
        ears::ears(&corners).map(|ears| ears.into_iter().map(own).collect())
    }

    /// The corners of a face in space that is a bilinear patch.
    fn bilinear(&self, nodes: &[u32], ears: Option<&[[u32; 3]]>) -> Option<[u32; 4]> {
        nodes.try_into().ok().filter(|_| ears.is_none() && !self.draft.lens.orthographic)
    }

    /// The number of pieces of each face, among a total number of faces.
    fn cuts(&self, faces: &[Side], total: usize) -> Cuts {
        if self.draft.lens.orthographic || total > VERY_MANY_FACES {
            return Cuts::new(0);
        }
        let of_few = (CELLS_OF_FEW / total.max(1)).isqrt().clamp(FINEST_CUT, FINEST_OF_FEW);
        let affordable = if total > MANY_FACES { 2 } else { of_few };
        let mut cuts = Cuts::new(self.draft.body.len());
        let mut nodes = Vec::new();
        for side in faces {
            self.corners(side, &mut nodes);
            let corners = self.bilinear(&nodes, self.draft.bodies.ears.of(&nodes));
            cuts.add(&nodes, corners.map_or(1, |corners| self.cells(corners).min(affordable as f64) as u8));
        }
        cuts
    }

    /// The number of cells in each direction that a bilinear patch needs.
    fn cells(&self, corners: [u32; 4]) -> f64 {
        let [a, b, c, d] = corners.map(|node| self.at(node));
        let distances = [a, b, c, d].into_iter().filter_map(|corner| Some(self.draft.lens.project(corner)?.1));
        let Some(distance) = distances.reduce(f64::min) else { return 1.0 };
        // In the middle of a patch the distance of its diagonals is half of this, and each is a quarter away from the
        // patch.
        let off = (a - b + c - d).length() / 4.0 * self.draft.lens.focal / distance;
        (off / FLATNESS).sqrt().ceil().max(1.0)
    }

    /// Whether a face belongs to a flat element.
    fn is_flat(&self, side: &Side) -> bool {
        side.element.and_then(|element| self.draft.snapshot.flat.get(element as usize)).copied().unwrap_or(false)
    }

    /// Cuts a face into triangles and adds them to a mesh, with dots or, without a value, with the hatch.
    fn emit(
        &self,
        side: &Side,
        ears: Option<&[[u32; 3]]>,
        dots: Option<f64>,
        grid: Option<&CutPatch>,
        patch: &mut Patch,
        mesh: &mut Mesh,
    ) {
        let base = u32::try_from(mesh.vertices.len()).expect("fewer than 2^32 vertices");
        let Patch { nodes, corners, phases, points, triangles, is_curved, facing } = patch;
        corners.clear();
        corners.extend(nodes.iter().map(|&node| self.at(node)));
        phases.clear();
        let body = self.draft.bodies.assembly.body_of_node(nodes[0] as usize);
        let Hatch { period, middle } = self.hatches[body];
        let phase = |node: u32| match middle {
            Some(middle) => (self.at(node) - middle).dot(DVec3::X - DVec3::Y) * FRAC_1_SQRT_2 / period,
            None => self.draft.body.rest()[node as usize].dot(DVec3::ONE) / period,
        };
        phases.extend(nodes.iter().map(|&node| dots.unwrap_or_else(|| phase(node))));
        points.clear();
        triangles.clear();
        facing.clear();
        let vertex = |point: DVec3, normal: DVec3, phase: f64| Vertex {
            position: self.draft.relative(point),
            normal: narrow_point(normal / (self.draft.side * self.draft.side)).to_array(),
            hatch: narrow(phase),
        };
        let shades = self.draft.shades.as_ref().map(|shades| shades.corners(nodes, side.element));
        *is_curved = grid.is_some();
        if let (&[a, b, c, d], Some(grid)) = (&corners[..], grid) {
            for &([u, v], weights) in &grid.points {
                let point = a.lerp(b, u).lerp(d.lerp(c, u), v);
                let normal = bilinear_normal([a, b, c, d], [u, v]);
                mesh.vertices.push(vertex(point, normal, weighted(&weights, phases)));
                points.push(point);
                facing.push(self.facing(point, normal));
            }
            if let Some(shades) = shades {
                mesh.shades.extend(grid.points.iter().map(|(_, weights)| narrow(weighted(weights, &shades))));
            }
            triangles.extend_from_slice(&grid.triangles);
        } else {
            let normal = newell(corners);
            points.extend_from_slice(corners);
            mesh.vertices.extend(points.iter().zip(&*phases).map(|(&point, &phase)| vertex(point, normal, phase)));
            mesh.shades.extend(shades.iter().flatten().map(|&shade| narrow(shade)));
            let count = nodes.len() as u32;
            match ears {
                Some(ears) => triangles.extend_from_slice(ears),
                None if count == 3 => triangles.push([0, 1, 2]),
                None => {
                    // A fan around the middle.
                    let share = 1.0 / f64::from(count);
                    let mean = |of: &[f64]| of.iter().map(|value| share * value).sum::<f64>();
                    let middle = corners.iter().sum::<DVec3>() / f64::from(count);
                    points.push(middle);
                    mesh.vertices.push(vertex(middle, normal, mean(phases)));
                    mesh.shades.extend(shades.map(|shades| narrow(mean(&shades))));
                    triangles.extend((0..count).map(|at| [at, (at + 1) % count, count]));
                }
            }
        }
        if !*is_curved {
            facing.extend(triangles.iter().map(|triangle| {
                let [a, b, c] = triangle.map(|at| points[at as usize]);
                self.facing(a, (b - a).cross(c - a))
            }));
        }
        mesh.triangles.extend(triangles.iter().map(|triangle| triangle.map(|at| base + at)));
        if !self.colours().is_empty() {
            let own = side.element.and_then(|element| self.colours().get(element as usize));
            let place = own.map_or(body % BODIES, |&own| own.into());
            mesh.shades.resize(mesh.vertices.len(), -1.0 - narrow_count(place));
        }
    }

    /// Contours within one face. On a bilinear patch they run where its normal is at right angles to the line of sight,
    /// interpolated within each triangle. They end exactly at the contours along the edges.
    fn inner_contours(&self, patch: &Patch, kind: LineKind, lines: &mut SurfaceLines) {
        let Patch { points, triangles, is_curved, facing, .. } = patch;
        let is_away = |at: usize| facing[at] < 0.0;
        if (1..facing.len()).all(|at| is_away(at) == is_away(0)) {
            return;
        }
        let mut draw = |ends: [DVec3; 2]| self.contour(ends, None, kind, lines);
        if *is_curved {
            for triangle in triangles {
                let crossed = around(triangle).map(|side| ordered(side).map(|at| at as usize));
                let mut ends = crossed
                    .filter(|&[a, b]| is_away(a) != is_away(b))
                    .map(|[a, b]| points[a].lerp(points[b], facing[a] / (facing[a] - facing[b])));
                if let (Some(from), Some(to)) = (ends.next(), ends.next()) {
                    draw([from, to]);
                }
            }
            return;
        }
        let mut sides: HashMap<[u32; 2], bool> = HashMap::new();
        for (at, triangle) in triangles.iter().enumerate() {
            for side in around(triangle) {
                if sides.insert(ordered(side), is_away(at)).is_some_and(|other| other != is_away(at)) {
                    draw(side.map(|at| points[at as usize]));
                }
            }
        }
    }
}

/// Records coordinates of the points of a face that are 0 or 255 at its sides.
fn note_edges(patch: &Patch, grid: Option<&CutPatch>, edges: &mut Vec<[u8; 4]>) {
    const INSIDE: u8 = 128;
    match (grid, patch.points.len() - patch.nodes.len()) {
        (Some(grid), _) => edges.extend(grid.points.iter().map(|&([u, v], _)| {
            let [u, v] = [u, v].map(|at| (255.0 * at).round() as u8);
            [u, v, INSIDE, 0]
        })),
        (None, 0) => edges.extend([[255, 0, 0, 0], [0, 255, 0, 0], [0, 0, 255, 0]]),
        // A fan around the middle.
        _ => {
            edges.extend(patch.nodes.iter().map(|_| [0, INSIDE, INSIDE, 0]));
            edges.push([INSIDE; 4]);
        }
    }
}

/// Records the component towards the viewer of the normals along the sides of a face.
fn note_borders(
    patch: &Patch,
    ears: Option<&[[u32; 3]]>,
    grid: Option<&CutPatch>,
    cuts: &Cuts,
    borders: &mut FaceSides,
) {
    let Patch { nodes, facing, .. } = patch;
    let face = borders.normals.len() as u32;
    borders.normals.push(newell(&patch.corners).normalize_or_zero());
    for (side, ends) in around(nodes).enumerate() {
        let first = u32::try_from(borders.facing.len()).expect("fewer than 2^32 pieces");
        let pieces = u32::from(cuts.edge(ends));
        borders.sides.push(FaceSide { ends, first, pieces, face });
        if let Some(grid) = grid {
            borders.facing.extend(grid.sides[side].iter().map(|&at| facing[at as usize]));
            continue;
        }
        let two = [side as u32, ((side + 1) % nodes.len()) as u32];
        let seen = match ears {
            // The only triangle with this side.
            Some(ears) => {
                let ear = ears.iter().position(|ear| two.iter().all(|corner| ear.contains(corner)));
                ear.map_or(1.0, |at| facing[at])
            }
            None if nodes.len() == 3 => facing[0],
            None => facing[side],
        };
        borders.facing.extend(std::iter::repeat_n(seen, pieces as usize + 1));
    }
}

/// The weighted sum of values at the corners of a face.
fn weighted(weights: &[f64; 4], of_corners: &[f64]) -> f64 {
    weights.iter().zip(of_corners).map(|(weight, corner)| weight * corner).sum()
}

/// The normal of a bilinear patch, with the length of its area. It is linear in both directions, so that its values at
/// the corners of any triangulation determine it everywhere.
fn bilinear_normal([a, b, c, d]: [DVec3; 4], [u, v]: [f64; 2]) -> DVec3 {
    let along_u = (b - a).lerp(c - d, v);
    let along_v = (d - a).lerp(c - b, u);
    along_u.cross(along_v)
}
