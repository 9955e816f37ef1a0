//! The closest points of many points and triangles, or of many segments, at once: one in each lane.
//!
//! C. Ericson, Real-Time Collision Detection (2005), sections 5.1.5 and 5.1.9, without branches.

use crate::lanes::{Lanes, each};

/// The number of the inside of a triangle or segment among its parts.
pub(super) const INSIDE: f64 = 6.0;

/// A vector in each lane.
pub(super) type Vector<L> = [L; 3];

#[inline(always)]
pub(super) fn minus<L: Lanes>(a: Vector<L>, b: Vector<L>) -> Vector<L> {
    each!(3, at => a[at] - b[at])
}

#[inline(always)]
pub(super) fn dot<L: Lanes>(a: Vector<L>, b: Vector<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The point that has these shares of three points.
#[inline(always)]
pub(super) fn mixed<L: Lanes>([a, b, c]: [Vector<L>; 3], [u, v, w]: [L; 3]) -> Vector<L> {
    each!(3, at => a[at] * u + b[at] * v + c[at] * w)
}

/// The point at a share of the way from one point to another.
#[inline(always)]
pub(super) fn between<L: Lanes>([a, b]: [Vector<L>; 2], share: L) -> Vector<L> {
    each!(3, at => a[at] * (L::splat(1.0) - share) + b[at] * share)
}

#[inline(always)]
fn clamp<L: Lanes>(share: L) -> L {
    let [zero, one] = [0.0, 1.0].map(L::splat);
    let low = zero.select(share.lt(zero), share);
    one.select(one.lt(low), low)
}

/// The closest point of a triangle to a point: the shares of its corners, and the part of the triangle on which it lies, as
/// [`On::of`](super::closest::On::of) reads it.
#[inline(always)]
pub(super) fn in_triangle<L: Lanes>(point: Vector<L>, [a, b, c]: [Vector<L>; 3]) -> ([L; 3], L) {
    let [zero, one] = [0.0, 1.0].map(L::splat);
    let (ab, ac) = (minus(b, a), minus(c, a));
    let (from_a, from_b, from_c) = (minus(point, a), minus(point, b), minus(point, c));
    let (a1, a2) = (dot(ab, from_a), dot(ac, from_a));
    let (b1, b2) = (dot(ab, from_b), dot(ac, from_b));
    let (c1, c2) = (dot(ab, from_c), dot(ac, from_c));
    let (of_c, of_b, of_a) = (a1 * b2 - b1 * a2, c1 * a2 - a1 * c2, b1 * c2 - c1 * b2);
    // Inside, unless one of the parts below applies; the last one of them counts.
    let whole = of_a + of_b + of_c;
    let (v, w) = (of_b / whole, of_c / whole);
    let mut shares = [one - v - w, v, w];
    let mut part = L::splat(INSIDE);
    // Along a side the numerator and the denominator of the share of its second corner.
    let (mut way, mut length) = (b2 - b1, (b2 - b1) + (c1 - c2));
    let on_a = L::both(of_a.le(zero), L::both(b1.le(b2), c2.le(c1)));
    part = L::splat(4.0).select(on_a, part);
    let on_b = L::both(of_b.le(zero), L::both(zero.le(a2), c2.le(zero)));
    (way, length, part) = (c2.select(on_b, way), (c2 - a2).select(on_b, length), L::splat(5.0).select(on_b, part));
    let on_c = L::both(of_c.le(zero), L::both(zero.le(a1), b1.le(zero)));
    (way, length, part) = (a1.select(on_c, way), (a1 - b1).select(on_c, length), L::splat(3.0).select(on_c, part));
    let corner_c = L::both(zero.le(c2), c1.le(c2));
    part = L::splat(2.0).select(corner_c, part);
    let corner_b = L::both(zero.le(b1), b2.le(b1));
    part = L::splat(1.0).select(corner_b, part);
    let corner_a = L::both(a1.le(zero), a2.le(zero));
    part = zero.select(corner_a, part);
    let share = way / length;
    let is_side = L::both(L::splat(2.5).lt(part), part.lt(L::splat(5.5)));
    let is_corner = part.lt(L::splat(2.5));
    for (at, own) in shares.iter_mut().enumerate() {
        // The side from this corner, and the one that ends in it.
        let [from, to] = [at, (at + 2) % 3].map(|side| L::splat(3.0 + side as f64));
        let begins = L::both(part.le(from), from.le(part));
        let ends = L::both(part.le(to), to.le(part));
        let on_side = (one - share).select(begins, share.select(ends, zero));
        let number = L::splat(at as f64);
        let on_corner = one.select(L::both(part.le(number), number.le(part)), zero);
        *own = on_corner.select(is_corner, on_side.select(is_side, *own));
    }
    (shares, part)
}

/// The closest points of two segments: how far along each they are, from 0 to 1, and the squared sine of the angle between them.
#[inline(always)]
pub(super) fn along_segments<L: Lanes>([a, b]: [Vector<L>; 2], [c, d]: [Vector<L>; 2]) -> [L; 3] {
    let [zero, one] = [0.0, 1.0].map(L::splat);
    let (mine, theirs, from) = (minus(b, a), minus(d, c), minus(a, c));
    let (aa, cc, ac) = (dot(mine, mine), dot(theirs, theirs), dot(mine, theirs));
    let (at_a, at_c) = (dot(mine, from), dot(theirs, from));
    let sine = aa * cc - ac * ac;
    let crossing = clamp((ac * at_c - at_a * cc) / sine).select(zero.lt(sine), zero);
    let along = (ac * crossing + at_c) / cc;
    // Where the point would be beyond an end of the second segment, or where that is a point, the end decides.
    let (is_point, low, high) = (cc.le(zero), along.lt(zero), one.le(along));
    let end = clamp((ac - at_a).select(high, -at_a) / aa);
    let first = end.select(low, end.select(high, crossing));
    let first = clamp(-at_a / aa).select(is_point, first);
    let second = zero.select(low, one.select(high, along));
    let across = {
        let [[x, y, z], [u, v, w]] = [mine, theirs];
        [y * w - v * z, z * u - w * x, x * v - u * y]
    };
    [zero.select(aa.le(zero), first), zero.select(is_point, second), dot(across, across) / (aa * cc)]
}
