//! The outline of a body that is not drawn: dashed curves along the border of its projection.

use super::Item;
use super::camera::Lens;
use super::fade::{FADING, Fade, dashed};
use super::layout::{Rectangle, Scale};
use super::plane::{clipped, sides};
use crate::colour::Colour;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// Width of the outline and of its casing, the opacity of the casing, and the lengths of dashes and gaps (px in the
/// reference picture).
const WIDTH: f64 = 2.0;
const HALO: f64 = 4.4;
const HALO_ALPHA: f64 = 0.65;
pub(super) const DASH: [f64; 2] = [6.5, 4.5];
/// Length of an arrow to a body outside of the room, length of its head, and distance from its tip to the border (px in
/// the reference picture).
const POINTER: [f64; 3] = [34.0, 11.0, 6.0];
/// A ghost with this part visible needs no arrow.
const MOSTLY: f64 = 0.9;
/// The length of pieces of edges, and the distance at which an edge is inside the projection if both sides are covered
/// (px).
const PIECE: f64 = 3.0;
const BESIDE: f64 = 1.6;
/// The distance up to which two ends of lines touch (px).
const TOUCH: f64 = 1.0;

/// A triangulated surface seen by a camera.
pub(super) struct Ghost<'a> {
    pub(super) lens: &'a Lens,
    /// The positions of nodes (m), the nodes of the surface, and its triangles as places among these nodes.
    pub(super) position: &'a [DVec3],
    pub(super) nodes: &'a [u32],
    pub(super) triangles: &'a [[u32; 3]],
    /// The ends of the edges of elements without faces, as nodes.
    pub(super) bars: &'a [[u32; 2]],
    /// The room; nothing is drawn outside.
    pub(super) room: Rectangle,
}

impl Ghost<'_> {
    /// The dashed outline in a colour, on a casing without dashes; nothing if a part of the surface is not in front of
    /// the camera. If hardly any part of the body is in the room, an arrow may point to it.
    pub(super) fn draw(&self, scale: Scale, colour: Colour, halo: Colour, curves: &mut Vec<Item>) {
        let lines = [without_stray(self.outline(), DASH[0] * scale.line()), self.bars()].concat();
        let fade = self.fade(scale);
        let whole: f64 = lines.iter().map(|line| length(line)).sum();
        // Fading lines are cut into dashes here.
        let (mut pieces, mut casing) = (Vec::new(), Vec::new());
        let mut seen = 0.0;
        for line in lines {
            let dash = dashes(&line, scale.line());
            let points: Vec<_> = line.iter().map(DVec2::to_array).collect();
            let parts = fade.parts(&points);
            let is_whole = matches!(parts[..], [(_, 1.0)]);
            let points = |part: Vec<[f64; 2]>| part.into_iter().map(DVec2::from).collect();
            casing.extend(parts.into_iter().map(|(part, opacity)| (points(part), None, opacity)));
            if is_whole {
                seen += length(&line);
                pieces.push((line, Some(dash), 1.0));
                continue;
            }
            for dash in dashed(&line, dash) {
                let opacity = fade.opacity(dash[0].midpoint(dash[dash.len() - 1]));
                seen += opacity * length(&dash);
                pieces.extend((opacity > 0.0).then_some((dash, None, opacity)));
            }
        }
        if seen < (POINTER[0] * scale.line()).min(MOSTLY * whole) || whole == 0.0 {
            let pointer = self.pointer(scale, seen > 0.0);
            if !pointer.is_empty() {
                casing = pointer.iter().map(|line| (line.clone(), None, 1.0)).collect();
                // The shaft has the dashes of the ghost in the key.
                let dash = |at: usize| (at == 0).then_some(DASH.map(|length| length * scale.line()));
                pieces = pointer.into_iter().enumerate().map(|(at, line)| (line, dash(at), 1.0)).collect();
            }
        }
        for (pieces, width, colour, alpha) in [(casing, HALO, halo, HALO_ALPHA), (pieces, WIDTH, colour, 1.0)] {
            let curve = |(line, dash, opacity): &(Vec<DVec2>, Option<[f64; 2]>, f64)| {
                let points: Vec<_> = line.iter().map(|point| point.to_array()).collect();
                let dash = dash.as_ref().map_or(&[][..], |dash| dash);
                Item::curve(&points, width * scale.line(), dash, (colour, alpha * opacity))
            };
            curves.extend(pieces.iter().map(curve));
        }
    }

    /// The fading at the sides that it leaves, over at most its length outside, so that nothing changes suddenly.
    fn fade(&self, scale: Scale) -> Fade {
        let [left, top, right, bottom] = sides(self.room.map(f64::from));
        let [low, high] = self.bounds();
        let over = [left - low.x, top - low.y, high.x - right, high.y - bottom];
        Fade::new(self.room, over.map(|over| over.clamp(0.0, FADING * scale.unit)))
    }

    /// The corners of the box around all nodes before the camera (px).
    fn bounds(&self) -> [DVec2; 2] {
        let seen = self.position.iter().filter_map(|&at| self.lens.project(at)).map(|(pixel, _)| DVec2::from(pixel));
        seen.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    }

    /// An arrow at the border of the room towards a body whose middle lies outside: its shaft and its head (px). No
    /// arrow if an invisible body surrounds the room.
    fn pointer(&self, scale: Scale, is_seen: bool) -> Vec<Vec<DVec2>> {
        let [left, top, right, bottom] = sides(self.room.map(f64::from));
        let [low, high] = self.bounds();
        let reaches_in = low.cmplt(DVec2::new(right, bottom)).all() && high.cmpgt(DVec2::new(left, top)).all();
        if !is_seen && reaches_in {
            return Vec::new();
        }
        let middle = self.position.iter().sum::<DVec3>() / self.position.len().max(1) as f64;
        let Some((pixel, _)) = self.lens.project(middle) else { return Vec::new() };
        let [length, wing, free] = POINTER.map(|length| length * scale.line());
        let from = DVec2::new(left.midpoint(right), top.midpoint(bottom));
        let way = DVec2::from(pixel) - from;
        let inner = [left + free, top + free, right - free, bottom - free];
        let Some([_, end]) = clipped(from, way, inner, [0.0, 1.0]).filter(|[_, end]| *end < 1.0) else {
            return Vec::new();
        };
        let (tip, along) = (from + end * way, way.normalize_or_zero());
        let back = |aside: f64| tip - wing * (along + aside * along.perp());
        vec![vec![tip - length * along, tip], vec![back(0.6), tip, back(-0.6)]]
    }

    /// The elements without faces (px).
    fn bars(&self) -> Vec<Vec<DVec2>> {
        let line = |ends: &[u32; 2]| {
            let [from, to] = ends.map(|node| self.lens.project(self.position[node as usize]));
            let [from, to] = [from?, to?].map(|(pixel, _)| DVec2::from(pixel));
            let shares = clipped(from, to - from, sides(self.room.map(f64::from)), [0.0, 1.0])?;
            Some(shares.map(|share| from.lerp(to, share)).to_vec())
        };
        self.bars.iter().filter_map(line).collect()
    }

    /// The border of the projection as lines, as long as possible (px). A closed line ends where it begins.
    fn outline(&self) -> Vec<Vec<DVec2>> {
        let pixels = self.nodes.iter().map(|&node| self.lens.project(self.position[node as usize]));
        let Some(pixels) = pixels.map(|seen| Some(DVec2::from(seen?.0))).collect::<Option<Vec<_>>>() else {
            return Vec::new();
        };
        let cover = Cover::new(self.room, self.triangles.iter().map(|corners| corners.map(|at| pixels[at as usize])));
        let mut lines = Lines::default();
        for [a, b] in self.turning_edges(&pixels) {
            lines.add([a, b], [pixels[a as usize], pixels[b as usize]], &cover);
        }
        lines.joined(&pixels)
    }

    /// The edges at which the surface ends, or turns from facing the viewer to facing away.
    fn turning_edges(&self, pixels: &[DVec2]) -> Vec<[u32; 2]> {
        // For each edge, the number of triangles that face the viewer, and that face away.
        let mut edges: BTreeMap<[u32; 2], [u32; 2]> = BTreeMap::new();
        for corners in self.triangles {
            let [a, b, c] = corners.map(|at| pixels[at as usize]);
            let faces_away = usize::from((b - a).perp_dot(c - a) > 0.0);
            for side in 0..3 {
                let [from, to] = [corners[side], corners[(side + 1) % 3]];
                edges.entry([from.min(to), from.max(to)]).or_default()[faces_away] += 1;
            }
        }
        edges
            .into_iter()
            .filter(|(_, [towards, away])| towards + away == 1 || towards * away > 0)
            .map(|(edge, _)| edge)
            .collect()
    }
}

/// The length of a line (px).
fn length(line: &[DVec2]) -> f64 {
    line.windows(2).map(|two| two[0].distance(two[1])).sum()
}

/// Lines without those shorter than a length (px) that touch no end of a longer one: in folds they would flicker.
fn without_stray(lines: Vec<Vec<DVec2>>, least: f64) -> Vec<Vec<DVec2>> {
    let (long, short): (Vec<_>, Vec<_>) = lines.into_iter().partition(|line| length(line) >= least);
    let ends = |line: &[DVec2]| [line[0], line[line.len() - 1]];
    let of_long: Vec<_> = long.iter().flat_map(|line| ends(line)).collect();
    let touches = |line: &Vec<DVec2>| {
        let own = ends(line);
        of_long.iter().any(|&end| own.iter().any(|own| own.distance(end) <= TOUCH))
    };
    // A very small body has only short lines.
    let kept: Vec<_> = short.into_iter().filter(|line| long.is_empty() || touches(line)).collect();
    [long, kept].concat()
}

/// The lengths of dashes and gaps along a line, such that a closed line has whole dashes (px).
fn dashes(line: &[DVec2], unit: f64) -> [f64; 2] {
    let dash = DASH.map(|length| length * unit);
    let length = length(line);
    let period = dash[0] + dash[1];
    if line.first() != line.last() || length < period {
        return dash;
    }
    dash.map(|part| part * length / ((length / period).round() * period))
}

/// The pixels that a projection covers.
struct Cover {
    room: Rectangle,
    is_covered: Vec<bool>,
}

impl Cover {
    fn new(room: Rectangle, triangles: impl Iterator<Item = [DVec2; 3]>) -> Self {
        let [left, top, width, height] = room;
        let mut is_covered = vec![false; width as usize * height as usize];
        let corner = DVec2::new(f64::from(left), f64::from(top));
        for triangle in triangles {
            let [a, b, c] = triangle.map(|at| at - corner);
            let area = (b - a).perp_dot(c - a);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let range = |low: f64, high: f64, length: u32| {
                let inside = |at: f64| at.clamp(0.0, f64::from(length)) as u32;
                inside(low.floor())..inside(high.ceil())
            };
            for y in range(low.y, high.y, height) {
                for x in range(low.x, high.x, width) {
                    let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let is_left = |from: DVec2, to: DVec2| (to - from).perp_dot(at - from) * area >= 0.0;
                    if is_left(a, b) && is_left(b, c) && is_left(c, a) {
                        is_covered[(y * width + x) as usize] = true;
                    }
                }
            }
        }
        Self { room, is_covered }
    }

    /// Whether the pixel at a place in the room is covered.
    fn holds(&self, at: DVec2) -> bool {
        let [left, top, width, height] = self.room;
        let [x, y] = [at.x - f64::from(left), at.y - f64::from(top)];
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(width) && y < f64::from(height);
        inside && self.is_covered[(y as u32 * width + x as u32) as usize]
    }
}

/// Pieces of edges, to be joined to longer lines.
#[derive(Default)]
struct Lines {
    /// The ends of whole edges.
    edges: Vec<[u32; 2]>,
    /// Parts of other edges (px).
    parts: Vec<Vec<DVec2>>,
}

impl Lines {
    /// Adds the part of an edge in the room and on the border.
    fn add(&mut self, nodes: [u32; 2], [from, to]: [DVec2; 2], cover: &Cover) {
        let way = to - from;
        let length = way.length();
        let Some([begin, end]) = clipped(from, way, sides(cover.room.map(f64::from)), [0.0, 1.0]) else { return };
        if length <= 0.0 {
            // Two nodes at one place: lines pass through it.
            return self.edges.push(nodes);
        }
        let beside = BESIDE * way.perp() / length;
        let count = (length * (end - begin) / PIECE).ceil().max(1.0) as usize;
        let share = |at: usize| begin + (end - begin) * at as f64 / count as f64;
        let is_border = |piece: usize| {
            let middle = from + share(piece).midpoint(share(piece + 1)) * way;
            !(cover.holds(middle + beside) && cover.holds(middle - beside))
        };
        let on_border: Vec<_> = (0..count).map(is_border).collect();
        if [begin, end] == [0.0, 1.0] && !on_border.contains(&false) {
            return self.edges.push(nodes);
        }
        let mut first = 0;
        for pieces in on_border.chunk_by(|one, other| one == other) {
            if pieces[0] {
                self.parts.push([first, first + pieces.len()].map(|at| from + share(at) * way).to_vec());
            }
            first += pieces.len();
        }
    }

    /// All lines, with whole edges joined at their nodes.
    fn joined(self, pixels: &[DVec2]) -> Vec<Vec<DVec2>> {
        let mut at_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (edge, nodes) in self.edges.iter().enumerate() {
            nodes.iter().for_each(|&node| at_node.entry(node).or_default().push(edge));
        }
        let mut is_taken = vec![false; self.edges.len()];
        let mut follow = |start: u32| {
            let (mut line, mut node) = (vec![pixels[start as usize]], start);
            while let Some(&edge) = at_node[&node].iter().find(|&&edge| !is_taken[edge]) {
                is_taken[edge] = true;
                let [a, b] = self.edges[edge];
                node = if node == a { b } else { a };
                line.push(pixels[node as usize]);
            }
            line
        };
        // Open lines come first, then closed ones.
        let odd = at_node.iter().filter(|(_, edges)| edges.len() % 2 == 1).map(|(&node, _)| node);
        let starts: Vec<_> = odd.chain(at_node.keys().copied()).collect();
        let lines = starts.into_iter().map(&mut follow).filter(|line| line.len() > 1);
        lines.chain(self.parts).collect()
    }
}

#[cfg(test)]
#[path = "../../tests/inside/ghost.rs"]
mod tests;
