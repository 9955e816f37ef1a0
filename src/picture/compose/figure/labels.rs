//! Label placement: at the tips of arrows and beside points, hiding as little as possible.

use crate::picture::layout::steps::{CLOSE, FREE, NEAR, SMALL, TALL_ROW};
use crate::picture::plane::{clipped, is_inside};
use glam::DVec2;

/// Distances that are tried between a point and its label (px in the reference picture).
const DISTANCES: [f64; 3] = [NEAR, SMALL, TALL_ROW];
/// Directions that are tried, as angles from the preferred one (rad).
const ANGLES: [f64; 9] = [0.0, 0.4, -0.4, 0.8, -0.8, 1.2, -1.2, 1.6, -1.6];
/// The cost of an angle (per rad) and of a distance (per px in the reference picture); each hidden pixel of a line
/// costs 1.
const ANGLE_COST: f64 = 14.0;
const DISTANCE_COST: f64 = 1.2;
/// The cost of a place at the tail of an arrow.
const TAIL_COST: f64 = 38.0;
/// The cost of each corner and of the middle of a label that lies on a surface.
const SURFACE_COST: f64 = 9.0;
/// The cost of leaving the room (per px), and of covering another label (per px²).
const OUTSIDE_COST: f64 = 500.0;
const LABEL_COST: f64 = 8.0;

/// A box: left, top, right, bottom (px).
pub(super) type Edges = [f64; 4];

/// The lines and surfaces that labels should not hide, and the labels placed so far.
#[derive(Clone, Debug)]
pub(super) struct LabelPlaces {
    /// The room for labels.
    pub(super) room: Edges,
    /// Pixels for one pixel of the reference picture.
    pub(super) unit: f64,
    /// Straight pieces of arrows and edges.
    pub(super) lines: Vec<[DVec2; 2]>,
    /// Surfaces, which labels may cover at a cost.
    pub(super) surfaces: Vec<Vec<DVec2>>,
    boxes: Vec<Edges>,
}

impl LabelPlaces {
    pub(super) fn new(room: Edges, unit: f64) -> Self {
        Self { room, unit, lines: Vec::new(), surfaces: Vec::new(), boxes: Vec::new() }
    }

    /// The place of a label of a size at the tip of an arrow or, if that is crowded and it may be there, behind its tail:
    /// its upper left corner.
    pub(super) fn place(&mut self, [from, to]: [DVec2; 2], size: DVec2, may_be_behind: bool) -> DVec2 {
        let back = (from - to).normalize_or_zero() * CLOSE * self.unit;
        let (at_tip, at_tail) = (self.best(to, to - from, size), self.best(from + back, from - to, size));
        let is_behind = may_be_behind && at_tail.0 + TAIL_COST < at_tip.0;
        let (_, corner) = if is_behind { at_tail } else { at_tip };
        self.boxes.push([corner.x, corner.y, corner.x + size.x, corner.y + size.y]);
        corner
    }

    /// The cheapest place beside a point, and its cost.
    fn best(&self, point: DVec2, away: DVec2, size: DVec2) -> (f64, DVec2) {
        let away = away.try_normalize().unwrap_or(DVec2::NEG_Y);
        let mut best = (f64::INFINITY, DVec2::ZERO);
        for distance in DISTANCES {
            for angle in ANGLES {
                let (sine, cosine) = libm::sincos(angle);
                let along = DVec2::new(cosine, sine).rotate(away);
                // The middle of the label is moved away by its extent in this direction, so that only its edge is at
                // the distance.
                let reach = (0.5 * size * along.abs()).element_sum().min(0.5 * size.max_element());
                let middle = point + (distance * self.unit + reach) * along;
                let corner = (middle - 0.5 * size).round();
                let cost = self.cost(corner, size) + ANGLE_COST * angle.abs() + DISTANCE_COST * distance;
                if cost < best.0 {
                    best = (cost, corner);
                }
            }
        }
        best
    }

    fn cost(&self, corner: DVec2, size: DVec2) -> f64 {
        let free = FREE * self.unit;
        let edges = [corner.x - free, corner.y - free, corner.x + size.x + free, corner.y + size.y + free];
        let [left, top, right, bottom] = self.room;
        let outside = (left - edges[0]).max(0.0)
            + (top - edges[1]).max(0.0)
            + (edges[2] - right).max(0.0)
            + (edges[3] - bottom).max(0.0);
        let covered: f64 = self.boxes.iter().map(|other| shared(edges, *other)).sum();
        let hidden: f64 = self.lines.iter().map(|line| inside(*line, edges)).sum();
        let points =
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]].map(|at| corner + size * DVec2::from(at));
        let on_surface = |point: &&DVec2| self.surfaces.iter().any(|surface| is_inside(surface, **point));
        let on_surfaces = points.iter().filter(on_surface).count() as f64;
        OUTSIDE_COST * outside + LABEL_COST * covered + hidden + SURFACE_COST * on_surfaces
    }
}

/// The common area of two boxes (px²).
fn shared(one: Edges, other: Edges) -> f64 {
    let width = one[2].min(other[2]) - one[0].max(other[0]);
    let height = one[3].min(other[3]) - one[1].max(other[1]);
    width.max(0.0) * height.max(0.0)
}

/// The length of a straight piece inside a box (px).
fn inside([from, to]: [DVec2; 2], edges: Edges) -> f64 {
    let share = clipped(from, to - from, edges, [0.0, 1.0]).map_or(0.0, |[begin, end]| end - begin);
    share * from.distance(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stand_where_they_are_wanted_if_nothing_is_in_the_way() {
        let mut labels = LabelPlaces::new([0.0, 0.0, 400.0, 400.0], 1.0);
        let corner = labels.place([DVec2::ZERO.with_y(200.0), DVec2::splat(200.0)], DVec2::new(40.0, 12.0), false);
        assert_eq!(corner, DVec2::new(208.0, 194.0));
    }

    #[test]
    fn labels_hide_neither_lines_nor_each_other_and_stay_in_their_room() {
        let mut labels = LabelPlaces::new([0.0, 0.0, 200.0, 200.0], 1.0);
        let point = DVec2::new(150.0, 100.0);
        labels.lines.push([point, DVec2::new(200.0, 100.0)]);
        let size = DVec2::new(45.0, 14.0);
        let corners: Vec<_> = (0..3).map(|_| labels.place([point - DVec2::X, point], size, false)).collect();
        for (at, corner) in corners.iter().enumerate() {
            let edges = [corner.x, corner.y, corner.x + size.x, corner.y + size.y];
            assert!(edges[0] >= 0.0 && edges[2] <= 200.0 && inside(labels.lines[0], edges) == 0.0, "{edges:?}");
            for other in &corners[..at] {
                assert_eq!(shared(edges, [other.x, other.y, other.x + size.x, other.y + size.y]), 0.0);
            }
        }
    }
}
