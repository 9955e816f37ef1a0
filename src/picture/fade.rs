//! Lines fade at the sides of their room instead of being cut off.

use super::layout::Rectangle;
use super::plane::sides;
use glam::DVec2;

/// The distance over which lines fade at the sides of their room (px in the reference picture), and its steps.
pub(super) const FADING: f64 = 28.0;
const STEPS: f64 = 8.0;
/// The least length of a piece of a line (px).
const PIECE: f64 = 1.0;

/// The fading of lines at the sides of a room.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fade {
    /// The left, upper, right and lower side of the room, and the distance of fading from each (px).
    sides: [f64; 4],
    distances: [f64; 4],
}

impl Fade {
    /// The fading in a room (px), over distances from its left, upper, right and lower side (px).
    pub(super) fn new(room: Rectangle, distances: [f64; 4]) -> Self {
        Self { sides: sides(room.map(f64::from)), distances }
    }

    /// The opacity of a line at a place (px), in steps.
    pub(super) fn opacity(&self, at: DVec2) -> f64 {
        let [left, top, right, bottom] = self.sides;
        let inside = [at.x - left, at.y - top, right - at.x, bottom - at.y];
        let shares = inside.into_iter().zip(self.distances).filter(|(_, distance)| *distance > 0.0);
        let share = shares.map(|(inside, distance)| inside / distance).fold(1.0, f64::min);
        ((share.max(0.0) * STEPS).floor() + 1.0).min(STEPS) / STEPS
    }

    /// A line, divided into parts with the opacity of each.
    pub(super) fn parts(&self, line: &[[f64; 2]]) -> Vec<(Vec<[f64; 2]>, f64)> {
        let shortest = self.distances.into_iter().filter(|&distance| distance > 0.0).fold(f64::INFINITY, f64::min);
        let mut parts: Vec<(Vec<[f64; 2]>, f64)> = Vec::new();
        for two in line.windows(2) {
            let [from, to] = [two[0], two[1]].map(DVec2::from);
            // Pieces are as short as a step if the line may fade.
            let fades = self.opacity(from).min(self.opacity(to)) < 1.0;
            let piece = (shortest / STEPS).max(PIECE);
            let count = if fades { (from.distance(to) / piece).ceil().max(1.0) as u32 } else { 1 };
            for at in 0..count {
                let [start, end] = [at, at + 1].map(|at| from.lerp(to, f64::from(at) / f64::from(count)));
                let alpha = self.opacity(start.midpoint(end));
                match parts.last_mut().filter(|part| part.1 == alpha) {
                    Some((points, _)) => points.push(end.to_array()),
                    None => parts.push((vec![start.to_array(), end.to_array()], alpha)),
                }
            }
        }
        parts
    }
}

/// A line cut into dashes with gaps between them (px).
pub(super) fn dashed(line: &[DVec2], [dash, gap]: [f64; 2]) -> Vec<Vec<DVec2>> {
    let mut dashes: Vec<Vec<DVec2>> = Vec::new();
    // The rest of the present dash or gap.
    let (mut is_dash, mut left) = (false, 0.0);
    for two in line.windows(2) {
        let (mut at, mut rest) = (two[0], two[0].distance(two[1]));
        while rest > 0.0 {
            if left <= 0.0 {
                is_dash = !is_dash;
                left = if is_dash { dash } else { gap };
                if is_dash {
                    dashes.push(vec![at]);
                }
            }
            let step = left.min(rest);
            at = if step == rest { two[1] } else { at + step * (two[1] - at).normalize_or_zero() };
            (left, rest) = (left - step, rest - step);
            if is_dash {
                dashes.last_mut().expect("one was begun").push(at);
            }
        }
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fade_where_they_leave() {
        let line = [[5.0, 0.0], [5.0, 100.0]];
        let fade = |distances| Fade::new([0, 0, 10, 200], distances);
        let parts = fade([0.0, 40.0, 0.0, 40.0]).parts(&line);
        // The parts join without a gap, and become steadily more opaque.
        assert_eq!(parts.len(), STEPS as usize);
        assert!(parts.windows(2).all(|two| two[0].0.last() == two[1].0.first() && two[0].1 < two[1].1));
        assert_eq!((parts[0].0[0], parts[7].0.last(), parts[7].1), ([5.0, 0.0], Some(&[5.0, 100.0]), 1.0));
        assert_eq!(fade([0.0; 4]).parts(&line), [(line.to_vec(), 1.0)]);
        // Lines also fade at the left and right.
        let across = [[0.0, 50.0], [100.0, 50.0]];
        let parts = Fade::new([0, 0, 100, 100], [40.0; 4]).parts(&across);
        assert_eq!((parts.len(), parts[0].1, parts[7].1, parts[14].1), (15, 0.125, 1.0, 0.125));
    }

    #[test]
    fn dashes_go_around_corners() {
        let corner = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]].map(DVec2::from);
        let at = |points: &[[f64; 2]]| points.iter().copied().map(DVec2::from).collect::<Vec<_>>();
        let dashes = [
            at(&[[0.0, 0.0], [6.0, 0.0]]),
            at(&[[9.0, 0.0], [10.0, 0.0], [10.0, 5.0]]),
            at(&[[10.0, 8.0], [10.0, 10.0]]),
        ];
        assert_eq!(dashed(&corner, [6.0, 3.0]), dashes);
    }
}
