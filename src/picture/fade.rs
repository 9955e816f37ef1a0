//! Lines fade where they leave their room, and where they come to an overview in it: nothing is cut off hard.

use super::layout::Rectangle;
use super::plane::sides;
use glam::DVec2;

/// Over what distance lines fade at the sides of their room and around an overview (px in the reference picture), and
/// in how many steps.
pub(super) const FADING: f64 = 28.0;
const AROUND: f64 = 14.0;
const STEPS: f64 = 8.0;
/// No piece of a line is cut shorter than this (px).
const PIECE: f64 = 1.0;

/// Where lines fade.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fade {
    /// The left, upper, right and lower side of the room, and over what distance lines fade from each (px).
    sides: [f64; 4],
    distances: [f64; 4],
    /// The sides of an overview, which covers lines, and over what distance they fade from it (px).
    overview: Option<[f64; 4]>,
    around: f64,
}

impl Fade {
    /// In a room and around an overview in it (px: left, top, width and height), where a pixel of the reference picture
    /// has `unit` pixels.
    pub(super) fn new(room: Rectangle, distances: [f64; 4], overview: Option<[f64; 4]>, unit: f64) -> Self {
        Self { sides: sides(room.map(f64::from)), distances, overview: overview.map(sides), around: AROUND * unit }
    }

    /// The opacity of a line at a place (px), in steps.
    pub(super) fn opacity(&self, at: DVec2) -> f64 {
        let [left, top, right, bottom] = self.sides;
        let inside = [at.x - left, at.y - top, right - at.x, bottom - at.y];
        let shares = inside.into_iter().zip(self.distances).filter(|(_, distance)| *distance > 0.0);
        let share = shares.map(|(inside, distance)| inside / distance).fold(1.0, f64::min);
        let outside = self.overview.map_or(f64::INFINITY, |[left, top, right, bottom]| {
            let off = DVec2::new((left - at.x).max(at.x - right), (top - at.y).max(at.y - bottom));
            off.max(DVec2::ZERO).length() / self.around
        });
        if outside <= 0.0 { 0.0 } else { ((share.min(outside).max(0.0) * STEPS).floor() + 1.0).min(STEPS) / STEPS }
    }

    /// A line, parted so that it fades, with the opacity of each part; without what an overview covers.
    pub(super) fn parts(&self, line: &[[f64; 2]]) -> Vec<(Vec<[f64; 2]>, f64)> {
        let around = self.overview.map_or(f64::INFINITY, |_| self.around);
        let shortest = self.distances.into_iter().filter(|&distance| distance > 0.0).fold(around, f64::min);
        let mut parts: Vec<(Vec<[f64; 2]>, f64)> = Vec::new();
        for two in line.windows(2) {
            let [from, to] = [two[0], two[1]].map(DVec2::from);
            // Pieces as short as a step where it may fade.
            let fades = self.opacity(from).min(self.opacity(to)) < 1.0 || self.may_cross_overview(from, to);
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
        parts.retain(|(_, alpha)| *alpha > 0.0);
        parts
    }

    /// Whether a piece of a line may come near the overview.
    fn may_cross_overview(&self, from: DVec2, to: DVec2) -> bool {
        let (low, high) = (from.min(to) - self.around, from.max(to) + self.around);
        self.overview
            .is_some_and(|[left, top, right, bottom]| low.x < right && high.x > left && low.y < bottom && high.y > top)
    }
}

/// A line cut into dashes with gaps between them (px).
pub(super) fn dashed(line: &[DVec2], [dash, gap]: [f64; 2]) -> Vec<Vec<DVec2>> {
    let mut dashes: Vec<Vec<DVec2>> = Vec::new();
    // How much of the present dash or gap is left.
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
        let fade = |distances| Fade::new([0, 0, 10, 200], distances, None, 1.0);
        let parts = fade([0.0, 40.0, 0.0, 40.0]).parts(&line);
        // They join without a gap, and become steadily more opaque.
        assert_eq!(parts.len(), STEPS as usize);
        assert!(parts.windows(2).all(|two| two[0].0.last() == two[1].0.first() && two[0].1 < two[1].1));
        assert_eq!((parts[0].0[0], parts[7].0.last(), parts[7].1), ([5.0, 0.0], Some(&[5.0, 100.0]), 1.0));
        assert_eq!(fade([0.0; 4]).parts(&line), [(line.to_vec(), 1.0)]);
        // At the left and right, too.
        let across = [[0.0, 50.0], [100.0, 50.0]];
        let parts = Fade::new([0, 0, 100, 100], [40.0; 4], None, 1.0).parts(&across);
        assert_eq!((parts.len(), parts[0].1, parts[7].1, parts[14].1), (15, 0.125, 1.0, 0.125));
    }

    #[test]
    fn lines_do_not_cross_an_overview() {
        let fade = Fade::new([0, 0, 200, 200], [0.0; 4], Some([80.0, 80.0, 40.0, 40.0]), 1.0);
        let parts = fade.parts(&[[0.0, 100.0], [200.0, 100.0]]);
        assert!(parts.len() > 10 && [&parts[0], &parts[parts.len() - 1]].iter().all(|part| part.1 == 1.0));
        let inside = |at: &[f64; 2]| (82.0..118.0).contains(&at[0]);
        assert!(parts.iter().flat_map(|(points, _)| points).all(|at| !inside(at)), "{parts:?}");
        assert_eq!(fade.parts(&[[0.0, 50.0], [200.0, 50.0]]).len(), 1);
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
