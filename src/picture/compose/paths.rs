//! Paths of bodies up to the present moment.

use super::Composer;
use super::draft::Draft;
use crate::look::Traced;
use crate::picture::Item;
use crate::picture::chart::simplified;
use crate::picture::fade::{FADING, Fade};
use crate::picture::layout::Rectangle;
use crate::picture::plane::{clipped, sides};
use crate::runner::history::TimeSeries;
use glam::DVec2;

/// Widths of the paths of the centre and of a node, the extra width of their halo (px in the reference picture), and
/// its opacity.
const CENTRE: f64 = 2.2;
const NODE: f64 = 1.4;
const HALO: f64 = 2.0;
const HALO_ALPHA: f64 = 0.6;
/// Radius of the dot at the end of a path, in widths.
const DOT: f64 = 1.7;

impl Composer<'_> {
    /// The names of the paths in the key, from the longest wording to the shortest; none if there are no paths. The
    /// path of the centre is thicker.
    pub(super) fn path_names(&self) -> Vec<String> {
        let paths = &self.scene.view.paths;
        let nodes: Vec<_> = paths
            .iter()
            .filter_map(|traced| if let Traced::Node(node) = traced { Some(node.to_string()) } else { None })
            .collect();
        let all = nodes.join(", ");
        match (nodes.len() < paths.len(), nodes.len()) {
            (false, 0) => Vec::new(),
            (true, 0) => vec!["path of the centre".to_owned()],
            (false, 1) => vec![format!("path of node {all}")],
            (false, count) => vec![format!("paths of nodes {all}"), format!("paths of {count} nodes")],
            (true, count) => {
                let plural = if count == 1 { "" } else { "s" };
                let wordings = [format!("node{plural} {all}"), format!("{count} node{plural}")];
                let [named, counted] = wordings.map(|nodes| format!("paths: centre (thick), {nodes}"));
                vec![named, counted.clone(), counted.replace(" (thick)", "")]
            }
        }
    }
}

impl Draft<'_> {
    /// The paths up to the present moment inside a part of the picture, for the known part of the run's time series.
    pub(super) fn paths(&self, series: &[TimeSeries], room: Rectangle, curves: &mut Vec<Item>) {
        let snapshot = &self.run.snapshot;
        let own = series.iter().find(|series| series.run == self.run.run);
        let Some(own) = own.filter(|_| snapshot.position.len() == self.body.len()) else { return };
        let (colour, halo) =
            (self.scene.runs[self.run.run].line(&self.composer.palette).colour, self.composer.palette.background);
        for (traced, path) in self.scene.view.paths.iter().zip(&own.paths) {
            let width = if *traced == Traced::Centre { CENTRE } else { NODE };
            let past = own.times.iter().take_while(|&&time| time < snapshot.time).count();
            let now = traced.of(&self.scene.body, &snapshot.position);
            let way = path.iter().take(past).copied().chain([now]);
            let lines = within(way.map(|at| self.lens.project(at).map(|(pixel, _)| DVec2::from(pixel))), room);
            let pieces = lines.iter().flat_map(|line| parted(simplified(line)));
            // Without words they extend to the border.
            let fading = if self.clear == self.viewport { 0.0 } else { FADING * self.scale.unit };
            let fade = Fade::new(room, [fading; 4]);
            let pieces: Vec<_> = pieces.flat_map(|piece| fade.parts(&piece)).collect();
            let last = self.lens.project(now).map(|(pixel, _)| pixel).filter(|&pixel| holds(room, pixel.into()));
            for (more, colour, alpha) in [(HALO, halo, HALO_ALPHA), (0.0, colour, 1.0)] {
                let line = self.scale.line();
                let curve = |(piece, part): &(Vec<_>, f64)| {
                    Item::curve(piece, (width + more) * line, &[], (colour, alpha * part))
                };
                curves.extend(pieces.iter().map(curve));
                curves.extend(last.map(|pixel| Item::disc(pixel, (DOT * width + 0.75 * more) * line, colour)));
            }
        }
    }
}

fn holds(room: Rectangle, pixel: DVec2) -> bool {
    let [left, top, right, bottom] = sides(room.map(f64::from));
    (left..=right).contains(&pixel.x) && (top..=bottom).contains(&pixel.y)
}

/// A line, divided where it turns back on itself: the shader of curves joins pieces that continue in about the same
/// direction.
fn parted(line: Vec<[f64; 2]>) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    for two in line.windows(2) {
        let [from, to] = [two[0], two[1]].map(DVec2::from);
        let turns_back = |piece: &[[f64; 2]]| {
            let [.., before, last] = piece else { return false };
            (DVec2::from(*last) - DVec2::from(*before)).normalize_or_zero().dot((to - from).normalize_or_zero()) < -0.5
        };
        match pieces.last_mut().filter(|piece| !turns_back(piece)) {
            Some(piece) => piece.push(two[1]),
            None => pieces.push(two.to_vec()),
        }
    }
    pieces
}

/// The parts of a line in a rectangle (px). Points that the camera does not see divide it.
fn within(points: impl Iterator<Item = Option<DVec2>>, room: Rectangle) -> Vec<Vec<[f64; 2]>> {
    let edges = sides(room.map(f64::from));
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    let (mut before, mut is_open): (Option<DVec2>, bool) = (None, false);
    for point in points {
        // A resting body repeats its point.
        if before == point {
            continue;
        }
        if let (Some(from), Some(to)) = (before, point) {
            match clipped(from, to - from, edges, [0.0, 1.0]) {
                Some([begin, end]) => {
                    let [first, last] = [begin, end].map(|share| from.lerp(to, share).to_array());
                    match lines.last_mut().filter(|_| is_open && begin == 0.0) {
                        Some(line) => line.push(last),
                        None => lines.push(vec![first, last]),
                    }
                    is_open = end == 1.0;
                }
                None => is_open = false,
            }
        } else {
            is_open = false;
        }
        before = point;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_parted_where_they_leave() {
        let points = [[5.0, 5.0], [15.0, 5.0], [5.0, 8.0], [5.0, 8.0], [6.0, 9.0]].map(|at| Some(DVec2::from(at)));
        let lines = within(points.into_iter(), [0, 0, 10, 10]);
        assert_eq!(lines, [vec![[5.0, 5.0], [10.0, 5.0]], vec![[10.0, 6.5], [5.0, 8.0], [6.0, 9.0]]]);
        assert_eq!(within([points[0], None, points[4], points[3]].into_iter(), [0, 0, 10, 10]).len(), 1);
    }

    #[test]
    fn lines_are_parted_where_they_turn_back() {
        let line = vec![[5.0, 5.0], [5.0, 9.0], [5.001, 1.0], [9.0, 1.0]];
        assert_eq!(parted(line), [vec![[5.0, 5.0], [5.0, 9.0]], vec![[5.0, 9.0], [5.001, 1.0], [9.0, 1.0]]]);
        assert!(parted(vec![[1.0, 1.0]]).is_empty());
    }
}
