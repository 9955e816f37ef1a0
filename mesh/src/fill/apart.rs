//! Parts of a surface that stand apart, each filled by itself.

use super::allowed::Allowed;
use super::embed::body;
use super::{Cage, Fill, FillError, Filled};
use crate::Surface;
use crate::boxes::Boxes;
use crate::edges::{Sets, pieces};
use glam::DVec3;
use localshape_sim::geometry::{bounds, node_volumes};
use rayon::prelude::*;
use robust::{Coord3D, orient3d};

/// Fills each part of a surface by itself, so that no element reaches from one into another.
///
/// # Errors
/// As `fill`, or if all parts together need more than `most` elements of this side.
pub(super) fn fill(
    mut surface: Surface,
    (part_of, count): (Vec<u32>, usize),
    with: Fill,
    most: usize,
    fill: impl Fn(Surface) -> Result<Filled, FillError> + Sync,
) -> Result<Filled, FillError> {
    let mut parts = vec![Surface::default(); count];
    let mut numbers = Vec::with_capacity(surface.points.len());
    for (&part, &point) in part_of.iter().zip(&surface.points) {
        let points = &mut parts[part as usize].points;
        numbers.push(points.len() as u32);
        points.push(point);
    }
    for &of in &surface.triangles {
        parts[part_of[of[0] as usize] as usize].triangles.push(of.map(|point| numbers[point as usize]));
    }
    let allowed = Allowed::new(&parts, with, most);
    if count > most {
        return Err(allowed.too_many(with.side(), count as f64, "at least "));
    }
    allowed.check()?;
    // The first error is told, whichever part is filled first.
    let filled: Vec<_> = parts.into_par_iter().map(&fill).collect();
    let filled = filled.into_iter().collect::<Result<Vec<_>, _>>()?;
    let needed: usize = filled.iter().map(|part| part.cage.elements.len()).sum();
    if needed > most {
        return Err(allowed.too_many(with.side(), needed as f64, ""));
    }
    let mut whole = Filled { surface: Surface::default(), ..filled[0].clone() };
    let mut firsts = vec![0];
    for part in &filled[1..] {
        let cage = &mut whole.cage;
        let first = cage.nodes.len() as u32;
        firsts.push(first);
        let full = |cage: &Cage| cage.filled.clone().unwrap_or_else(|| vec![1.0; cage.elements.len()]);
        if cage.filled.is_some() || part.cage.filled.is_some() {
            cage.filled = Some([full(cage), full(&part.cage)].concat());
        }
        cage.nodes.extend(&part.cage.nodes);
        cage.elements.append(&part.cage.elements, first);
        cage.volumes.iter_mut().zip(&part.cage.volumes).for_each(|(all, own)| all.extend(own));
        cage.overlap += part.cage.overlap;
        cage.thin.cubes += part.cage.thin.cubes;
        cage.thin.of += part.cage.thin.of;
        cage.thin.filled += part.cage.thin.filled;
    }
    whole.weights = Default::default();
    for ((&part, &number), point) in part_of.iter().zip(&numbers).zip(&mut surface.points) {
        let (part, first) = (&filled[part as usize], firsts[part as usize]);
        *point = part.surface.points[number as usize];
        let (nodes, weights) = part.weights.of(number as usize);
        whole.weights.push(&nodes.iter().map(|node| first + node).collect::<Vec<_>>(), weights);
    }
    Ok(Filled { surface, ..whole })
}

/// The part with the volume of each node (m³), together that inside its surface where this is closed.
pub(super) fn weighed(mut part: Filled) -> Filled {
    let (mut volumes, measures) = (node_volumes(&body(&part.cage)), part.surface.measures());
    if measures.closed {
        let found: f64 = volumes.iter().sum();
        volumes.iter_mut().for_each(|volume| *volume *= (measures.volume - part.cage.overlap) / found);
    }
    part.cage.volumes = Some(volumes);
    part
}

/// The part of the surface to which each point belongs, and how many there are: pieces that touch, or lie in the inside of each other,
/// are one part, and so is an open piece with those whose boxes meet its own. What encloses nothing, as a sheet does, goes with the
/// nearest part.
///
/// # Errors
/// If very many pieces lie about each other.
pub(super) fn parts(surface: &Surface) -> Result<(Vec<u32>, usize), FillError> {
    let (piece_of, count) = pieces(surface.points.len(), &surface.triangles);
    let mut boxes = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); count];
    for (&piece, &point) in piece_of.iter().zip(&surface.points) {
        let (low, high) = &mut boxes[piece as usize];
        (*low, *high) = (low.min(point), high.max(point));
    }
    let of_triangles: Vec<u32> = surface.triangles.iter().map(|of| piece_of[of[0] as usize]).collect();
    let enclosed = surface.enclosed(&of_triangles, count);
    let grid = grid(&boxes);
    check(count, grid.in_cells().map(|all| all.len() * all.len() / 2).sum())?;
    let (mut sets, mut is_near) = (Sets::new(count), vec![false; count]);
    for all in grid.in_cells() {
        for (at, &one) in all.iter().enumerate() {
            for &other in all[at + 1..].iter().filter(|&&other| grid.meet(other, boxes[one as usize])) {
                let pair = [one, other].map(|piece| piece as usize);
                match pair.iter().any(|&piece| enclosed[piece].is_open) {
                    true => sets.join(one, other),
                    false => pair.iter().for_each(|&piece| is_near[piece] = true),
                }
            }
        }
    }
    if is_near.contains(&true) {
        join_touching(surface, &of_triangles, &is_near, &mut sets)?;
        surface.nested(&of_triangles, &enclosed, |piece, around| {
            let nearest =
                around.iter().min_by(|one, other| enclosed[one.0].size().total_cmp(&enclosed[other.0].size()));
            if let Some(&(nearest, _)) = nearest
                && around.iter().map(|(_, winding)| winding).sum::<i32>() > 0
            {
                sets.join(piece as u32, nearest as u32);
            }
        });
    }
    let set_of: Vec<u32> = (0..count as u32).map(|piece| sets.of(piece)).collect();
    for (&set, (low, high)) in set_of.iter().zip(boxes.clone()) {
        let whole = &mut boxes[set as usize];
        *whole = (whole.0.min(low), whole.1.max(high));
    }
    let of_triangles: Vec<u32> = of_triangles.iter().map(|&piece| set_of[piece as usize]).collect();
    let enclosed = surface.enclosed(&of_triangles, count);
    let (solid, empty): (Vec<usize>, Vec<usize>) =
        (0..count).filter(|&set| set_of[set] as usize == set).partition(|&set| enclosed[set].is_solid());
    check(count, empty.len() * solid.len())?;
    for set in empty {
        let (low, high) = boxes[set];
        let gap = |other: usize| (boxes[other].0 - high).max(low - boxes[other].1).max(DVec3::ZERO).length_squared();
        let nearest = solid.iter().copied().min_by(|&one, &other| gap(one).total_cmp(&gap(other)));
        sets.join(set as u32, nearest.unwrap_or(0) as u32);
    }
    let (part_of, count) = sets.numbered();
    Ok((piece_of.into_iter().map(|piece| part_of[piece as usize]).collect(), count))
}

/// Boxes in cells about as large as they are.
fn grid(boxes: &[(DVec3, DVec3)]) -> Boxes {
    let mean = boxes.iter().map(|(low, high)| low.distance(*high)).sum::<f64>() / boxes.len() as f64;
    let ends =
        boxes.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |ends, of| (ends.0.min(of.0), ends.1.max(of.1)));
    Boxes::new(boxes.to_vec(), ends, mean.max(f64::MIN_POSITIVE))
}

/// Joins those of some pieces whose triangles cross or touch.
fn join_touching(surface: &Surface, of: &[u32], is_near: &[bool], sets: &mut Sets) -> Result<(), FillError> {
    let all = surface.triangles.iter().zip(of).filter(|(_, piece)| is_near[**piece as usize]);
    let (triangles, of): (Vec<[DVec3; 3]>, Vec<u32>) = all.map(|(&of, &piece)| (surface.corners(of), piece)).unzip();
    let boxes: Vec<_> = triangles.iter().map(|corners| bounds(corners)).collect();
    let grid = grid(&boxes);
    let shared = || grid.in_cells().filter(|all| all.iter().any(|&at| of[at as usize] != of[all[0] as usize]));
    check(is_near.iter().filter(|near| **near).count(), shared().map(|all| all.len() * all.len() / 2).sum())?;
    for all in shared() {
        for (at, &one) in all.iter().enumerate() {
            for &other in &all[at + 1..] {
                let [a, b] = [one, other].map(|at| of[at as usize]);
                let touch = || {
                    let [one, other] = [one, other].map(|at| triangles[at as usize]);
                    passes(one, other) || passes(other, one)
                };
                if a != b && sets.of(a) != sets.of(b) && grid.meet(other, boxes[one as usize]) && touch() {
                    sets.join(a, b);
                }
            }
        }
    }
    Ok(())
}

/// Whether a side of one triangle passes another one or touches it, unless it is in its plane: other sides are not, then.
fn passes(one: [DVec3; 3], [a, b, c]: [DVec3; 3]) -> bool {
    let turn = |points: [DVec3; 4]| {
        let [a, b, c, d] = points.map(|point| Coord3D { x: point.x, y: point.y, z: point.z });
        orient3d(a, b, c, d)
    };
    let heights = one.map(|corner| turn([a, b, c, corner]));
    [[0, 1], [1, 2], [2, 0]].into_iter().any(|[from, to]| {
        let is_in_plane = heights[from] == 0.0 && heights[to] == 0.0;
        if is_in_plane || heights[from] * heights[to] > 0.0 {
            return false;
        }
        let turns = [[a, b], [b, c], [c, a]].map(|[start, end]| turn([one[from], one[to], start, end]));
        turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
    })
}

/// Refuses more comparisons than take some seconds.
fn check(pieces: usize, pairs: usize) -> Result<(), FillError> {
    const MOST: usize = 1_000_000_000;
    if pairs <= MOST {
        return Ok(());
    }
    let message = format!("has {pieces} pieces that lie about each other, too many to tell which stand apart");
    Err(FillError::new(message, "unite them in the program that made it, or fill it with cubes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn very_many_pieces_over_each_other_are_refused() {
        let pieces = |count: u32, apart: f64| {
            let points =
                (0..count).flat_map(|at| [DVec3::X, DVec3::Y, DVec3::Z].map(|point| point + apart * f64::from(at)));
            let triangles = (0..count).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect();
            parts(&Surface { points: points.collect(), triangles, ..Surface::default() })
        };
        let refused = pieces(50_000, 1e-6).unwrap_err();
        assert_eq!(refused.message, "has 50000 pieces that lie about each other, too many to tell which stand apart");
        // Sheets go with the first.
        assert_eq!(pieces(50_000, 2.0).map(|(_, count)| count).ok(), Some(1));
    }
}
