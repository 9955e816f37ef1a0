//! The closest points of many candidates of contact at once, in lanes.

use super::closest::{self, Nearest};
use super::lanewise::{self, Vector};
use super::surface::Placed;
use crate::lanes::{Lanes, MOST, Work};
use glam::DVec3;

/// The closest points of two features.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    /// Of a point and a facet: the shares of the corners. Of two edges: how far along each the points are, and the squared sine of the angle
    /// between them.
    pub(super) shares: [f64; 3],
    /// Of a point and a facet: the part of the facet on which the point lies, as [`On::of`](super::closest::On::of) reads it.
    pub(super) part: f64,
    /// From the point of the second feature to that of the first (m); of a point and a facet to the point.
    pub(super) way: DVec3,
    /// Its length (m).
    pub(super) distance: f64,
}

impl Found {
    /// That of a point and a segment.
    pub(super) fn on_segment(point: DVec3, ends: [DVec3; 2]) -> Self {
        let Nearest { shares, part } = closest::of_segment(point, ends);
        let way = point - (ends[0] * shares[0] + ends[1] * shares[1]);
        Self { shares, part, way, distance: way.length() }
    }
}

/// Points of one surface and facets of the other.
pub(super) struct PointsAndFacets<'a> {
    pub(super) of: [Placed<'a>; 2],
    pub(super) features: &'a [[u32; 2]],
    pub(super) found: &'a mut Vec<Found>,
}

/// Edges of both surfaces.
pub(super) struct TwoEdges<'a> {
    pub(super) of: [Placed<'a>; 2],
    pub(super) features: &'a [[u32; 2]],
    pub(super) found: &'a mut Vec<Found>,
}

/// Four points of each of some candidates, at most as many as lanes.
#[inline(always)]
fn lanes<L: Lanes>(features: &[[u32; 2]], points: impl Fn([u32; 2]) -> [DVec3; 4]) -> [Vector<L>; 4] {
    let mut all = [[[0.0; MOST]; 3]; 4];
    for (lane, &features) in features.iter().enumerate() {
        for (at, point) in all.iter_mut().zip(points(features)) {
            (at[0][lane], at[1][lane], at[2][lane]) = (point.x, point.y, point.z);
        }
    }
    all.map(|at| at.map(L::from_array))
}

/// Appends what was found for so many lanes.
#[inline(always)]
fn append<L: Lanes>(found: &mut Vec<Found>, count: usize, shares: [L; 3], part: L, way: Vector<L>) {
    let [x, y, z] = way.map(L::to_array);
    let distance = lanewise::dot(way, way).sqrt().to_array();
    let (shares, part) = (shares.map(L::to_array), part.to_array());
    found.extend((0..count).map(|lane| Found {
        shares: shares.map(|shares| shares[lane]),
        part: part[lane],
        way: DVec3::new(x[lane], y[lane], z[lane]),
        distance: distance[lane],
    }));
}

impl Work for PointsAndFacets<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { of: [one, other], features, found } = self;
        for features in features.chunks(L::WIDTH) {
            let [point, corners @ ..] = lanes(features, |[point, facet]| {
                let [a, b, c] = other.surface.facets[facet as usize].corners.map(|corner| other.point(corner));
                [one.point(point), a, b, c]
            });
            let (shares, part) = lanewise::in_triangle::<L>(point, corners);
            let way = lanewise::minus(point, lanewise::mixed(corners, shares));
            append(found, features.len(), shares, part, way);
        }
    }
}

impl Work for TwoEdges<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { of, features, found } = self;
        for features in features.chunks(L::WIDTH) {
            let [a, b, c, d] = lanes(features, |features| {
                let ends = |side: usize| of[side].surface.edges[features[side] as usize].map(|end| of[side].point(end));
                let ([a, b], [c, d]) = (ends(0), ends(1));
                [a, b, c, d]
            });
            let [s, t, sine] = lanewise::along_segments::<L>([a, b], [c, d]);
            let way = lanewise::minus(lanewise::between([a, b], s), lanewise::between([c, d], t));
            append(found, features.len(), [s, t, sine], L::splat(0.0), way);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::Surface;
    use super::*;
    use crate::body::Body;
    use crate::lanes::Set;
    use crate::noise::Noise;

    /// Two cubes with points at places that look random, of which some are the same.
    fn places(surface: &Surface) -> [Vec<DVec3>; 2] {
        let mut noise = Noise(3);
        // Few numbers, so that parallel edges, flat triangles and ties are among them.
        [(); 2].map(|()| (0..surface.points.len()).map(|_| (noise.vector() * 4.0).floor() * 0.25).collect())
    }

    /// Each lane of each set has the bits of the same pair alone.
    #[test]
    fn lanes_have_the_bits_of_single_pairs() {
        let corner = |at: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(at >> axis & 1)));
        let nodes: Vec<u32> = (0..8).collect();
        let cube = Body::builder((0..8).map(corner).collect()).elements([&nodes[..]].into_iter().collect());
        let surface = Surface::of(&cube.build().expect("a cube"));
        let places = places(&surface);
        let of = places.each_ref().map(|at| Placed { surface: &surface, at });
        let all = |first: usize, second: usize| -> Vec<[u32; 2]> {
            (0..first as u32).flat_map(|one| (0..second as u32).map(move |other| [one, other])).collect()
        };
        let (points, edges) = (surface.points.len(), surface.edges.len());
        for set in Set::all() {
            let features = all(points, surface.facets.len());
            let mut found = Vec::new();
            set.run(PointsAndFacets { of, features: &features, found: &mut found });
            for (found, &[point, facet]) in found.iter().zip(&features) {
                let corners = surface.facets[facet as usize].corners.map(|corner| of[1].point(corner));
                let Nearest { shares, part } = closest::of_triangle(of[0].point(point), corners);
                assert_eq!((bits(&found.shares), found.part), (bits(&shares), part));
                assert_eq!(bits(&[found.way.length()]), bits(&[found.distance]));
            }
            let features = all(edges, edges);
            found.clear();
            set.run(TwoEdges { of, features: &features, found: &mut found });
            assert_eq!(found.len(), features.len());
            for (found, &features) in found.iter().zip(&features) {
                let ends = [0, 1].map(|side| surface.edges[features[side] as usize].map(|end| of[side].point(end)));
                assert_eq!(bits(&found.shares[..2]), bits(&closest::of_segments(ends[0], ends[1])));
            }
        }
    }

    /// The bits of numbers; all that are not a number are the same.
    fn bits(numbers: &[f64]) -> Vec<u64> {
        numbers.iter().map(|number| if number.is_nan() { f64::NAN.to_bits() } else { number.to_bits() }).collect()
    }
}
