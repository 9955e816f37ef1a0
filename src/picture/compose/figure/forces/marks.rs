//! The marks of diagrams of forces: outlined arrows, smooth lines, the tint of the rest shape.

use crate::colour::{Colour, mixed};
use crate::look::Palette;
use crate::picture::arrows::{HEAD, arrow};
use crate::picture::layout::Scale;
use crate::picture::narrow::narrow;
use crate::picture::{Mark, MarkShape};
use glam::DVec2;

/// Opacity of the rest shape, and of the inside and the outline of arrows for comparison.
const GHOST: f64 = 0.075;
const COMPARED: f64 = 0.16;
const OUTLINE_ALPHA: f64 = 0.75;
/// Widths of the outlines of the rest shape and of an arrow (px in the reference picture).
pub(super) const GHOST_LINE: f64 = 1.3;
const OUTLINE: f64 = 1.1;

/// The colour of the rest shape on the background.
pub(super) fn ghost_colour(palette: &Palette) -> Colour {
    mixed(palette.background, palette.edge_on_ground(), GHOST)
}

/// An arrow of the run for comparison: faintly filled, with an outline.
pub(super) fn outlined(ends: [DVec2; 2], scale: Scale, colour: Colour, ground: Colour, has_halo: bool) -> Vec<Mark> {
    let points = outline(ends, HEAD * scale.line());
    let edge = mixed(ground, colour, OUTLINE_ALPHA);
    let sides = points.windows(2).map(|two| Mark::line([two[0], two[1]], OUTLINE * scale.line(), edge));
    let fill = mixed(ground, colour, COMPARED);
    let filled =
        if has_halo { vec![arrow(ends, scale.line(), fill, ground)] } else { bare(ends, scale.line(), fill).into() };
    filled.into_iter().chain(sides).collect()
}

/// An arrow without a halo, which would cover the lines beside it.
pub(super) fn bare([from, to]: [DVec2; 2], size: f64, colour: Colour) -> [Mark; 2] {
    let points = outline([from, to], HEAD * size);
    // The points run around the arrow: both sides of the shaft, the joint, a wing and the tip.
    let [shaft, joint, wing, tip] = [points[0], points[1], points[2], points[3]];
    let along = (to - from).normalize_or_zero();
    let [half_shaft, half_head] = [shaft, wing].map(|at| (at - from).perp_dot(along).abs());
    let end = from + (joint - from).dot(along) * along;
    let high = 2.0 * half_head;
    let corner = tip - (tip - wing).dot(along) * along - half_head * along.perp();
    let head = Mark::upright([corner.x, corner.y, (tip - wing).dot(along), high], MarkShape::Point, colour);
    let head = Mark { along: along.to_array().map(narrow), ..head };
    [Mark::line([from, end], 2.0 * half_shaft, colour), head]
}

/// The closed outline of an arrow with a head of a width (px). The shader for arrows has the same proportions.
fn outline([from, to]: [DVec2; 2], width: f64) -> Vec<DVec2> {
    /// Length of the head, depth of its notch and width of the shaft in widths of the head, and length of the head of a
    /// short arrow in lengths of the arrow.
    const SHAPE: [f64; 4] = [1.235, 0.2, 0.247, 0.62];
    let length = from.distance(to);
    let along = (to - from) / length.max(1e-9);
    let head = (SHAPE[0] * width).min(SHAPE[3] * length);
    let part = head / (SHAPE[0] * width);
    let [half_head, half_shaft, notch] = [0.5 * width * part, 0.5 * SHAPE[2] * width * part, SHAPE[1] * width * part];
    let back = length - head;
    let joint = back + notch * (1.0 - half_shaft / half_head.max(1e-9));
    let half = [(0.0, half_shaft), (joint, half_shaft), (back, half_head), (length, 0.0)];
    let at = |(x, y): (f64, f64)| from + x * along + y * along.perp();
    let other = half.iter().rev().skip(1).map(|&(x, y)| (x, -y));
    let mut points: Vec<_> = half.iter().copied().chain(other).map(at).collect();
    points.push(points[0]);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlined_arrow_ends_at_its_tip() {
        let [from, to] = [DVec2::new(10.0, 20.0), DVec2::new(110.0, 20.0)];
        let points = outline([from, to], 17.0);
        assert!(points.iter().any(|at| at.distance(to) < 1e-9));
        assert_eq!(points.first(), points.last());
        assert!(
            points.iter().all(|at| at.x >= 10.0 - 1e-9 && at.x <= 110.0 + 1e-9 && (at.y - 20.0).abs() <= 8.5 + 1e-9)
        );
    }
}
