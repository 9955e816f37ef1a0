//! Distances beside an independent evaluation, and the rule beside the exact truth of moving features.

use super::closest::{of_segments, of_triangle};
use super::end::Ends;
use super::end::Motion;
use super::rule::{Law, Term, Touch};
use crate::noise::Noise;
use glam::DVec3;

/// Four points that look random.
fn points(noise: &mut Noise) -> [DVec3; 4] {
    [(); 4].map(|()| noise.vector())
}

/// Four points, and which features they are.
#[derive(Clone, Copy)]
enum Features {
    /// A vertex, then the corners of a face.
    VertexFace,
    /// The ends of two edges.
    EdgeEdge,
}

impl Features {
    /// The weights of the closest points.
    fn weights(self, [a, b, c, d]: [DVec3; 4]) -> [f64; 4] {
        match self {
            Self::VertexFace => {
                let [u, v, w] = of_triangle(a, [b, c, d]).shares;
                [1.0, -u, -v, -w]
            }
            Self::EdgeEdge => {
                let [s, t] = of_segments([a, b], [c, d]);
                [1.0 - s, s, t - 1.0, -t]
            }
        }
    }

    fn way(self, at: [DVec3; 4]) -> DVec3 {
        let weights = self.weights(at);
        (0..4).map(|point| at[point] * weights[point]).sum()
    }

    /// The distance by planes, lines and points alone: the least of all that apply.
    fn distance(self, [a, b, c, d]: [DVec3; 4]) -> f64 {
        let to_line = |point: DVec3, from: DVec3, to: DVec3| {
            let along = to - from;
            let share = (point - from).dot(along) / along.dot(along);
            let ends = point.distance(from).min(point.distance(to));
            if (0.0..=1.0).contains(&share) { along.cross(point - from).length() / along.length() } else { ends }
        };
        match self {
            Self::VertexFace => {
                let normal = (c - b).cross(d - b);
                let inside =
                    [[b, c], [c, d], [d, b]].iter().all(|&[from, to]| normal.cross(to - from).dot(a - from) >= 0.0);
                let plane = normal.dot(a - b).abs() / normal.length();
                if inside { plane } else { to_line(a, b, c).min(to_line(a, c, d)).min(to_line(a, d, b)) }
            }
            Self::EdgeEdge => {
                // The common normal of two lines meets both edges where each edge's ends are on different sides of the plane through
                // the other edge and the normal.
                let normal = (b - a).cross(d - c);
                let parts = |from: DVec3, to: DVec3, [one, other]: [DVec3; 2]| {
                    let across = normal.cross(to - from);
                    across.dot(one - from) * across.dot(other - from) <= 0.0
                };
                let is_between = parts(a, b, [c, d]) && parts(c, d, [a, b]);
                let ends = to_line(a, c, d).min(to_line(b, c, d)).min(to_line(c, a, b)).min(to_line(d, a, b));
                if is_between { normal.dot(c - a).abs() / normal.length() } else { ends }
            }
        }
    }

    /// Whether features that move straight touch, to a part of their size: by steps that are too short for it.
    fn touch(self, from: [DVec3; 4], to: [DVec3; 4]) -> bool {
        const NEAR: f64 = 1e-7;
        let size = from.iter().map(|at| at.distance(from[0])).fold(0.0, f64::max);
        let ways = [0, 1, 2, 3].map(|at| to[at] - from[at]);
        // A motion in common brings nothing nearer.
        let mean = ways.iter().sum::<DVec3>() * 0.25;
        let fastest = |points: &[usize]| points.iter().map(|&at| (ways[at] - mean).length()).fold(0.0, f64::max);
        let closing = match self {
            Self::VertexFace => fastest(&[0]) + fastest(&[1, 2, 3]),
            Self::EdgeEdge => fastest(&[0, 1]) + fastest(&[2, 3]),
        };
        let mut time = 0.0;
        while time < 1.0 {
            let gap = self.way([0, 1, 2, 3].map(|at| from[at] + ways[at] * time)).length();
            if gap < NEAR * size {
                return true;
            }
            time += gap / closing;
        }
        false
    }

    /// The ends of a motion by one step of contact without restitution and friction; `None` for features that touch at its start.
    fn resolved(self, from: [DVec3; 4], to: [DVec3; 4]) -> Option<[DVec3; 4]> {
        let weights = self.weights(from);
        let way = self.way(from);
        let distance = way.length();
        if distance == 0.0 {
            return None;
        }
        let law = Law { gap: 0.05 * from[2].distance(from[3]), restitution: 0.0, friction: 0.0 };
        let (at, normal) = (way, way / distance);
        let touch = Touch { at, normal, distance, keeps_law: true, drag: DVec3::ZERO, terms: [0, 4] };
        let motion = [0, 1, 2, 3].map(|at| Motion { inverse_mass: 1.0, ..Motion::held(to[at] - from[at]) });
        let mut ends = Ends { position: to.to_vec(), motion: motion.to_vec(), step: 1.0, ..Ends::default() };
        ends.resolve(law, &touch, &[0, 1, 2, 3].map(|node| Term { node, weight: weights[node as usize] }));
        ends.position.try_into().ok()
    }
}

/// The distances of 20 000 random pairs of each kind are those of another formula, to round-off of their size.
#[test]
fn distances_are_those_of_another_formula() {
    for features in [Features::VertexFace, Features::EdgeEdge] {
        let mut noise = Noise(50);
        for _ in 0..20_000 {
            let at = points(&mut noise);
            let [found, other] = [features.way(at).length(), features.distance(at)];
            assert!((found - other).abs() < 1e-14 + 1e-14 * other, "{found} {other} {at:?}");
        }
    }
}

/// What approaches along the line between its closest points does not touch, however far it would go.
#[test]
fn an_approach_along_the_line_is_stopped() {
    for features in [Features::VertexFace, Features::EdgeEdge] {
        let mut noise = Noise(51);
        for far in [0.5, 1.5, 20.0, 1e3].repeat(25) {
            let from = points(&mut noise);
            let way = features.way(from);
            let first = match features {
                Features::VertexFace => 1,
                Features::EdgeEdge => 2,
            };
            let to = [0, 1, 2, 3].map(|at| if at < first { from[at] - way * far } else { from[at] });
            assert_eq!(features.touch(from, to), far > 1.0);
            let end = features.resolved(from, to).expect("features that are apart");
            assert!(!features.touch(from, end), "{far} {from:?}");
        }
    }
}

/// The queries of moving vertices, faces and edges with exact truth (B. Wang and others, "A large-scale benchmark and an inclusion-based
/// algorithm for continuous collision detection", 2021; MIT licence), each as one step. `LOCALSHAPE_QUERIES` names a file with, for each
/// query, 0 or 1 for edges, 0 or 1 for a hit, and the points at the start and at the end, as 26 numbers (little-endian).
#[test]
#[ignore = "needs the file in LOCALSHAPE_QUERIES"]
fn queries_with_exact_truth() {
    let bytes = std::fs::read(std::env::var("LOCALSHAPE_QUERIES").expect("a file")).expect("queries");
    let numbers: Vec<f64> =
        bytes.chunks(8).map(|bytes| f64::from_le_bytes(bytes.try_into().expect("8 bytes"))).collect();
    // Touching at the start; then by the angle of the approach: hits, those that are resolved, and motions that touched nothing but do
    // after the rule.
    let (mut touching, mut counts) = (0, [[0; 3]; 4]);
    for query in numbers.chunks(26) {
        let features = if query[0] == 0.0 { Features::VertexFace } else { Features::EdgeEdge };
        let at = |point: usize| DVec3::from_slice(&query[2 + 3 * point..]);
        let (from, to) = ([0, 1, 2, 3].map(at), [4, 5, 6, 7].map(at));
        let is_hit = query[1] == 1.0;
        let Some(end) = features.resolved(from, to) else {
            touching += 1;
            continue;
        };
        let weights = features.weights(from);
        let way: DVec3 = (0..4).map(|point| (to[point] - from[point]) * weights[point]).sum();
        let cosine = -way.dot(features.way(from)) / (way.length() * features.way(from).length());
        let bin = [0.99, 0.7, 0.0].iter().position(|&least| cosine > least).unwrap_or(3);
        let touches = features.touch(from, end);
        counts[bin][0] += usize::from(is_hit);
        counts[bin][1] += usize::from(is_hit && !touches);
        counts[bin][2] += usize::from(!is_hit && touches);
    }
    assert_eq!((numbers.len() / 26, touching), (6955, 0));
    // Within 8°, 45°, 90° and beyond. Six hits are edges that lie parallel above each other, and so are the motions that only graze.
    assert_eq!(counts, [[169, 163, 7], [8, 8, 0], [80, 80, 0], [18, 18, 0]]);
}
