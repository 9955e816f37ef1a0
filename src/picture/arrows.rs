//! Displacements as arrows: from the place of each node in the best fit of the rest shape to its present place.

use super::Item;
use super::layout::Rectangle;
use super::layout::steps::{CHART, GAP, HAIR, STRONG, THIN};
use super::narrow::narrow;
use super::page::{Path, Pen, point};
use super::plane::{cut, sides};
use crate::colour::{Colour, mixed};
use crate::look::Palette;
use glam::DVec2;

/// Width (in widths of the head) and opacity of an arrow's halo.
const HALO: f64 = 0.147;
const HALO_ALPHA: f64 = 0.92;
/// A long arrow in widths of its head: length and notch of the head, thickness of the shaft. The last number is the head
/// of a short arrow, in lengths of the arrow.
const SHAPE: [f64; 4] = [1.235, 0.2, 0.247, 0.62];
/// Strengths of the inside and of the outline of arrows for comparison.
const OUTLINED: [f64; 2] = [0.16, 0.75];
/// Width of the head of a long arrow (px in the reference picture).
const HEAD: f64 = GAP;
/// Arrows up to this length go with their body beyond the room for arrows (px in the reference picture): cut, they would look like
/// smaller ones.
pub(super) const SHORT: f64 = 4.0 * HEAD;
/// Small elements get smaller arrows, down to this part of their size; not smaller than the least size, relative to the
/// reference picture, which could not be seen.
const SMALLEST: f64 = 0.36;
const FAINTEST: f64 = 0.33;
/// Arrows fade where they are longer than the shortest by less than this part of its length.
pub(super) const FADING: f64 = 0.35;
/// More arrows than this would hide the body.
const MOST_ARROWS: usize = 500;

/// How an arrow is drawn: from one pixel to another, with a size, in a colour on a ground.
pub(super) type DrawArrow = fn([DVec2; 2], f64, Colour, Colour) -> [Item; 2];

/// The nodes with arrows: those on the surface. Of very many, a subset that looks even but follows no rows.
pub(super) fn bearers(on_surface: &[u32]) -> Vec<u32> {
    let mut nodes = on_surface.to_vec();
    if nodes.len() > MOST_ARROWS {
        // An order that looks even but follows no rows (Fibonacci hashing), the same in every frame, run and picture.
        nodes.sort_by_key(|&node| (u64::from(node).wrapping_mul(0x9e37_79b9_7f4a_7c15), node));
        nodes.truncate(MOST_ARROWS);
    }
    nodes.sort_unstable();
    nodes
}

/// The size of arrows relative to the reference picture, for elements of a length (px) in type of a unit.
pub(super) fn size(element: f64, unit: f64) -> f64 {
    (unit * (element / (CHART * unit)).clamp(SMALLEST, 1.0)).max(FAINTEST)
}

/// An arrow from one pixel to another, with its tip exactly at the second one.
pub(super) fn arrow(ends: [DVec2; 2], size: f64, colour: Colour, halo: Colour) -> Item {
    Item::part("arrow", with_halo(ends, size, colour, halo))
}

/// The halo and the shape of an arrow.
pub(super) fn with_halo(ends: [DVec2; 2], size: f64, colour: Colour, halo: Colour) -> [Item; 2] {
    let (corners, part) = outline(ends, HEAD * size);
    let path = Path::polygon(&corners.map(point));
    let pen = Pen::solid(narrow(2.0 * HALO * HEAD * size * part.max(0.5)));
    [Item::stroke(path.clone(), pen, (halo, HALO_ALPHA)), Item::fill(path, colour)]
}

/// An arrow without a halo, which would cover what lies beside it.
pub(super) fn bare(ends: [DVec2; 2], size: f64, colour: Colour) -> Item {
    let (corners, _) = outline(ends, HEAD * size);
    Item::part("arrow", [Item::fill(Path::polygon(&corners.map(point)), colour)])
}

/// A curve through pixels, two or more, that ends with the head of an arrow, for type of a unit and arrows of a size.
pub(super) fn bent(pixels: &[DVec2], [unit, size]: [f64; 2], palette: &Palette) -> Item {
    let (tip, long) = (pixels[pixels.len() - 1], SHAPE[0] * HEAD * size);
    // A curve that is short in the picture, as from its side, has a shorter head, of up to a third of its pieces.
    let (far, first) = (|&at: &usize| pixels[at].distance(tip) >= long, 2 * pixels.len() / 3);
    let joint = (first..pixels.len()).rev().find(far).unwrap_or(first);
    let way = (tip - pixels[joint]) / SHAPE[3];
    let (corners, part) = outline([tip - way, tip], HEAD * size);
    let head = Path::polygon(&corners[1..6].iter().copied().map(point).collect::<Vec<_>>());
    let curve: Vec<_> =
        pixels[..=joint].iter().chain([&corners[1].midpoint(corners[5])]).map(DVec2::to_array).collect();
    let (line, rim) = (STRONG * unit, 2.0 * HALO * HEAD * size * part.max(0.5));
    // All of the halo lies below: that of the head would cut the line.
    let halo = (palette.background, HALO_ALPHA);
    let below = [Item::curve(&curve, line + rim, &[], halo), Item::stroke(head.clone(), Pen::solid(narrow(rim)), halo)];
    let above = [Item::curve(&curve, line, &[], palette.text), Item::fill(head, palette.text)];
    Item::part("arrow", below.into_iter().chain(above).collect::<Vec<_>>())
}

/// An arrow for comparison with others: faintly filled, with an outline.
pub(super) fn outlined(ends: [DVec2; 2], size: f64, colour: Colour, ground: Colour) -> [Item; 2] {
    let (corners, _) = outline(ends, HEAD * size);
    let [inside, rim] = OUTLINED.map(|strength| mixed(ground, colour, strength));
    let path = Path::polygon(&corners.map(point));
    [Item::fill(path.clone(), inside), Item::stroke(path, Pen::solid(narrow(HAIR * size)), rim)]
}

/// An arrow that differs from others and is as easily seen: its outline.
pub(super) fn hollow(ends: [DVec2; 2], size: f64, colour: Colour, ground: Colour) -> [Item; 2] {
    let (corners, _) = outline(ends, HEAD * size);
    let path = Path::polygon(&corners.map(point));
    let rim = Item::stroke(path.clone(), Pen::solid(narrow(2.0 * THIN * size)), colour);
    [rim, Item::fill(path, ground)]
}

/// The corners of an arrow with a head of a width (px): one side of the shaft, the joint, a wing, the tip and back; and
/// the size of its head, from 0 to 1: less than 1 for a short arrow.
fn outline([from, to]: [DVec2; 2], width: f64) -> ([DVec2; 7], f64) {
    let length = from.distance(to);
    let along = (to - from).try_normalize().unwrap_or(DVec2::X);
    let head = (SHAPE[0] * width).min(SHAPE[3] * length);
    let part = head / (SHAPE[0] * width);
    let [half_head, half_shaft, notch] = [0.5 * width * part, 0.5 * SHAPE[2] * width * part, SHAPE[1] * width * part];
    let back = length - head;
    let joint = back + notch * (1.0 - half_shaft / half_head.max(1e-9));
    let at = |x: f64, y: f64| from + x * along + y * along.perp();
    let side = |y: f64| [at(0.0, y * half_shaft), at(joint, y * half_shaft), at(back, y * half_head)];
    let ([a, b, c], [g, f, e]) = (side(1.0), side(-1.0));
    ([a, b, c, to, e, f, g], part)
}

/// The part of an arrow of a size inside a room, and its opacity, which is less than 1 where it is hardly longer than the shortest
/// (px). Long arrows are cut rather than left out, or the remaining small ones would mislead. One that hardly leaves the room is whole: a
/// break would hide more of it.
pub(super) fn inside(whole: [DVec2; 2], room: Rectangle, size: f64, shortest: f64) -> Option<([DVec2; 2], f64)> {
    let length = |[from, to]: [DVec2; 2]| from.distance(to);
    let ends = cut(whole, sides(room.map(f64::from)))?;
    let ends = if length(whole) - length(ends) < HEAD * size { whole } else { ends };
    let longer = ends[0].distance(ends[1]) / shortest - 1.0;
    (longer > 0.0).then_some((ends, (longer / FADING).min(1.0)))
}

/// A break in the shaft of an arrow that is longer than it is drawn: two slanted strokes with the ground between them, which leave
/// most of a short arrow to be seen.
pub(super) fn broken([from, to]: [DVec2; 2], size: f64, colour: Colour, ground: Colour) -> [Item; 3] {
    let along = (to - from).normalize_or(DVec2::X) * (HEAD * size).min(0.3 * from.distance(to));
    let (slanted, middle) = (0.75 * along.perp() + 0.3 * along, from.lerp(to, 0.4));
    let [first, second] = [-0.22, 0.22].map(|share| middle + share * along);
    let corners = [first - slanted, first + slanted, second + slanted, second - slanted];
    let gap = Item::fill(Path::polygon(&corners.map(point)), ground);
    let stroke = |at: DVec2| Item::line([at - slanted, at + slanted], STRONG * size, colour);
    [gap, stroke(first), stroke(second)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_ends_where_it_should() {
        let [from, to] = [DVec2::new(100.0, 50.0), DVec2::new(130.0, 90.0)];
        let (corners, part) = outline([from, to], 17.0);
        assert_eq!((corners[3], part), (to, 1.0));
        assert!((corners[0].midpoint(corners[6]) - from).length() < 1e-9);
        assert!(corners.iter().all(|at| (to - from).normalize().dot(*at - from) < 50.0 + 1e-9));
    }

    #[test]
    fn an_arrow_that_hardly_leaves_its_room_is_whole() {
        let ends = |to: f64| [DVec2::new(50.0, 50.0), DVec2::new(to, 50.0)];
        let of = |to: f64| inside(ends(to), [0, 0, 100, 100], 1.0, 1.0).map(|(ends, _)| ends[1].x);
        assert_eq!([90.0, 110.0, 150.0].map(of), [Some(90.0), Some(110.0), Some(100.0)]);
    }

    #[test]
    fn few_nodes_of_many_get_arrows_and_always_the_same() {
        let all: Vec<u32> = (0..10_000).collect();
        let chosen = bearers(&all);
        assert_eq!(chosen.len(), MOST_ARROWS);
        assert!(chosen.windows(2).all(|two| two[0] < two[1]));
        assert_eq!(chosen, bearers(&all));
        // Each tenth of the nodes has about a tenth of the arrows.
        for tenth in 0..10 {
            let here = chosen.iter().filter(|&&node| node / 1000 == tenth).count();
            assert!((40..=60).contains(&here), "{here}");
        }
        assert_eq!(bearers(&all[..64]), all[..64]);
    }
}
