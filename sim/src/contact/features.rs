//! The closest points of two features, and whether contact counts there.

use super::batch::{Found, PointsAndFacets, TwoEdges};
use super::closest::{self, On};
use super::surface::Placed;
use crate::lanes::Set;
use glam::DVec3;

/// The kinds of features that meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A point of one of two surfaces, 0 or 1, and a facet of the other.
    Point {
        /// The surface with the point.
        of: usize,
    },
    /// An edge of the first surface and one of the second.
    Edges,
}

/// Two closest points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    /// The point of the first feature (m).
    pub(super) here: DVec3,
    /// From the point of the second feature to that of the first (m).
    pub(super) way: DVec3,
    /// The shares of the corners of the two features in their points.
    pub(super) shares: [[f64; 3]; 2],
    /// Zero for a contact: a local minimum of the distance that no other feature counts. Otherwise how far points of the features have to move
    /// at least (m) until it can be one.
    pub(super) rests: f64,
    /// Whether the distance is a local minimum on both surfaces, and not only nearly so.
    pub(super) is_least: bool,
}

/// A way of one point changes what depends on lengths of features by at most so many times as much.
const LEVER: f64 = 6.0;

/// Whether contact counts at closest points whose way leads by `lean` (m) along a face that meets there: how far (m) the way leads too far, and
/// whether the distance is a local minimum.
///
/// Where a surface is nearly flat along an edge that presses on it, each feature is the nearest in turn, from step to step, and the others go
/// through meanwhile. So all count whose way is steeper than 46° to the faces.
fn counts(lean: f64, way: DVec3) -> (f64, bool) {
    /// The cosines of the least angles between the way and a face.
    const SLACK: f64 = 0.7;
    const LEAST: f64 = 0.02;
    let length = way.length();
    let beyond = lean - SLACK * length;
    (if beyond > 0.0 { beyond } else { 0.0 }, lean <= LEAST * length)
}

impl Kind {
    /// Those that are resolved in the same pass.
    pub(super) const POINTS: &[Self] = &[Self::Point { of: 0 }, Self::Point { of: 1 }];
    pub(super) const EDGES: &[Self] = &[Self::Edges];

    /// Its number among the kinds.
    pub(super) fn number(self) -> usize {
        match self {
            Self::Point { of } => of,
            Self::Edges => 2,
        }
    }

    /// The closest points of pairs of features.
    pub(super) fn find(self, placed: [Placed<'_>; 2], features: &[[u32; 2]], found: &mut Vec<Found>) {
        found.clear();
        let Self::Point { of } = self else {
            return Set::best().run(TwoEdges { of: placed, features, found });
        };
        let of @ [one, other] = [placed[of], placed[1 - of]];
        Set::best().run(PointsAndFacets { of, features, found });
        for (found, &[point, facet]) in found.iter_mut().zip(features) {
            // What lanes have found is of triangles.
            match *other.used(facet) {
                [a, b] => *found = Found::on_segment(one.point(point), [a, b].map(|end| other.point(end))),
                [a] => *found = Found::on_segment(one.point(point), [a, a].map(|end| other.point(end))),
                _ => {}
            }
        }
    }

    /// Whether contact counts at the closest points of two features that are nearer to each other than what can touch.
    pub(super) fn judge(self, placed: [Placed<'_>; 2], is_same: bool, features: [u32; 2], found: &Found) -> Closest {
        match self {
            Self::Point { of } => point_facet([placed[of], placed[1 - of]], features, of == 0, is_same, found),
            Self::Edges => edges(placed, features, found),
        }
    }
}

/// `counts_corners`: whether two points that meet are counted here, and not from the other side.
fn point_facet(
    [one, other]: [Placed<'_>; 2],
    [point, facet]: [u32; 2],
    counts_corners: bool,
    is_same: bool,
    &Found { shares, part, way, .. }: &Found,
) -> Closest {
    let Placed { surface, .. } = other;
    let facet = &surface.facets[facet as usize];
    let (here, place) = (one.point(point), |corner: u32| other.point(corner));
    let closest = |(rests, is_least)| Closest { here, way, shares: [[1.0, 0.0, 0.0], shares], rests, is_least };
    // Whether contact is counted here, the corners around the place, and the ends of the side or the corner twice.
    let (is_owned, around, on) = match On::of(part) {
        On::Inside => return closest((0.0, true)),
        On::Side(side) => {
            let wings = &surface.wings[facet.sides[side] as usize];
            (facet.owns_sides[side], wings, [side, (side + 1) % 3])
        }
        On::Corner(corner) => {
            let number = facet.corners[corner] as usize;
            let is_first = counts_corners && (!is_same || (point as usize) < number);
            (is_first && facet.owns_corners[corner], &surface.rings[number], [corner; 2])
        }
    };
    let corners = facet.corners.map(place);
    let there: DVec3 = corners.iter().zip(shares).map(|(&corner, share)| corner * share).sum();
    // How far the point has to move until another part of the facet is the nearest. No way to a corner is towards the point.
    let leaves = || {
        let others = corners[..facet.count as usize].iter().enumerate().filter(|(corner, _)| !on.contains(corner));
        let inwards = others.map(|(_, &corner)| {
            let (along, squared) = (way.dot(corner - there).min(0.0), (corner - there).length_squared());
            if squared > 0.0 { along * along / squared } else { 0.0 }
        });
        let ends = on.iter().filter(|_| on[0] != on[1]).map(|&end| corners[end].distance_squared(there));
        ends.chain(inwards).fold(f64::INFINITY, f64::min).sqrt()
    };
    let lean = || {
        let ring = one.surface.rings[point as usize].iter().map(|&at| one.point(at));
        closest::lean(way, there, around.iter().map(|&at| place(at))).max(closest::lean(-way, here, ring))
    };
    let (beyond, is_least) = if is_owned { counts(lean(), way) } else { (f64::INFINITY, false) };
    closest((if beyond > 0.0 { (beyond.min(leaves()) / LEVER).max(f64::MIN_POSITIVE) } else { 0.0 }, is_least))
}

/// Edges that cross each other.
fn edges([one, other]: [Placed<'_>; 2], [first, second]: [u32; 2], found: &Found) -> Closest {
    /// The least squared sine of the angle between them: parallel edges meet with their ends.
    const LEAST_SINE: f64 = 1e-6;
    let &Found { shares: [s, t, sine], way, .. } = found;
    let mine = one.surface.edges[first as usize].map(|end| one.point(end));
    let theirs = other.surface.edges[second as usize].map(|end| other.point(end));
    let (here, there) = (mine[0].lerp(mine[1], s), theirs[0].lerp(theirs[1], t));
    let shares = [s, t].map(|share| [1.0 - share, share, 0.0]);
    let lean = |placed: Placed<'_>, edge: u32, from: DVec3, way: DVec3| {
        closest::lean(way, from, placed.surface.wings[edge as usize].iter().map(|&corner| placed.point(corner)))
    };
    let is_inside = |share: f64| share > 0.0 && share < 1.0;
    let (beyond, is_least) = if is_inside(s) && is_inside(t) && sine > LEAST_SINE {
        counts(lean(one, first, here, -way).max(lean(other, second, there, way)), way)
    } else {
        (past_ends(mine, theirs, sine).max(f64::MIN_POSITIVE), false)
    };
    Closest { here, way, shares, rests: beyond / LEVER, is_least }
}

/// How far the ends of two segments have to move (m) until their lines are closest between them; zero if nearly parallel. `sine` is the squared
/// one of their angle, by which ways grow to those of the closest points.
fn past_ends([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], sine: f64) -> f64 {
    let (one, other, from) = (b - a, d - c, a - c);
    let (aa, cc, ac) = (one.length_squared(), other.length_squared(), one.dot(other));
    let s = (ac * other.dot(from) - one.dot(from) * cc) / (aa * cc * sine);
    let t = (ac * s + other.dot(from)) / cc;
    let past = |share: f64, squared: f64| (-share).max(share - 1.0) * squared.sqrt();
    let past = past(s, aa).max(past(t, cc)).min(aa.min(cc).sqrt());
    if past > 0.0 { 0.5 * past * sine } else { 0.0 }
}
