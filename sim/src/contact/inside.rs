//! Points inside closed surfaces, by how often facets wind around them, with exact signs.

use super::extent::{Extent, near, sweep};
use super::surface::Placed;
use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Which of some points lie inside a surface, in order. Surfaces without an inside, such as cloths and chains, contain none.
pub(super) fn inside(points: &[DVec3], other: Placed<'_>) -> Vec<u32> {
    let is_plane = other.surface.bounding.first().is_some_and(|&facet| other.used(facet).len() == 2);
    let whole = Extent::around(other.at.iter().copied());
    let extents = (0u32..).zip(points).map(|(number, &point)| (number, Extent::around(std::iter::once(point))));
    // A ray goes from each point: along x in the plane, along z in space. So it is swept along y.
    let ray = if is_plane { DVec3::X } else { DVec3::Z };
    let far = |point: DVec3| DVec3::select(ray.cmpgt(DVec3::ZERO), DVec3::INFINITY, point);
    let rays: Vec<_> = near(extents, &whole)
        .into_iter()
        .map(|(number, _)| {
            (number, Extent::around([points[number as usize], far(points[number as usize])].into_iter()))
        })
        .collect();
    let corners = |facet: u32| other.used(facet).iter().map(|&corner| other.at[corner as usize]);
    let facets = other.surface.bounding.iter().map(|&facet| (facet, Extent::around(corners(facet)))).collect();
    let mut turns = vec![0; points.len()];
    sweep([&rays, &facets], 0.0, [1, 2], |[number, facet]| {
        let point = points[number as usize];
        let corners: Vec<_> = corners(facet).collect();
        turns[number as usize] += match corners[..] {
            [a, b] => turn([a, b], point),
            [a, b, c] => turn_above([a, b, c], point),
            _ => 0,
        };
    });
    (0u32..).zip(turns).filter(|&(_, turns)| turns != 0).map(|(number, _)| number).collect()
}

/// The number of facets of one of two surfaces that lie wholly inside the other, where none cross.
pub(super) fn enclosed(of: [Placed<'_>; 2]) -> usize {
    let count = |one: Placed<'_>, other: Placed<'_>| {
        let within = inside(one.at, other);
        let is_within = |corner: &u32| within.binary_search(corner).is_ok();
        let facets = 0..one.surface.facets.len() as u32;
        if within.is_empty() { 0 } else { facets.filter(|&facet| one.used(facet).iter().all(is_within)).count() }
    };
    count(of[0], of[1]) + count(of[1], of[0])
}

/// 1 if a side in the plane of x and y crosses the ray along x from a point upwards, −1 if downwards, 0 if it does not.
fn turn([a, b]: [DVec3; 2], point: DVec3) -> i32 {
    if (a.y > point.y) == (b.y > point.y) {
        return 0;
    }
    let way = if b.y > a.y { 1 } else { -1 };
    let [a, b, point] = [a, b, point].map(|DVec3 { x, y, .. }| Coord { x, y });
    if f64::from(way) * orient2d(a, b, point) > 0.0 { way } else { 0 }
}

/// 1 if the ray along z from a point leaves through a triangle, −1 if it enters, 0 if it does not meet it.
fn turn_above([a, b, c]: [DVec3; 3], point: DVec3) -> i32 {
    let way: i32 = [[a, b], [b, c], [c, a]].into_iter().map(|side| turn(side, point)).sum();
    if way == 0 {
        return 0;
    }
    let [a, b, c, point] = [a, b, c, point].map(|DVec3 { x, y, z }| Coord3D { x, y, z });
    if f64::from(way) * orient3d(a, b, c, point) > 0.0 { way } else { 0 }
}
