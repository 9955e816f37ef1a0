//! Where the surface of the turned-over elements cuts that of the others: their colours change there without a line.

use super::{Mesh, Vertex};
use glam::{DVec3, IVec3};
use std::collections::HashMap;

/// The turned-over set is drawn this much nearer (sides), as in the shader.
const NEARER: f64 = 0.02;
/// What lies nearer to a common corner than this many times that is no cut.
const AWAY: f64 = 3.0;
/// Above this number of triangles elements are so small, and cuts so many, that borders without steps are not worth their time.
const MOST_TRIANGLES: usize = 60_000;
/// Boxes in which triangles are looked for are so many times larger than these.
const BOX: f64 = 2.0;

/// A triangle of a surface: its corners as they are, and as they are drawn.
struct Piece {
    own: [[f32; 3]; 3],
    drawn: [DVec3; 3],
}

impl Piece {
    fn all(mesh: &Mesh, drawn: impl Fn(DVec3) -> DVec3) -> impl Iterator<Item = Self> {
        mesh.triangles.iter().map(move |corners| {
            let own = corners.map(|at| mesh.vertices[at as usize]).map(|Vertex { position, .. }| position);
            Self { own, drawn: own.map(|at| drawn(DVec3::from(at.map(f64::from)))) }
        })
    }

    /// The corners of the box around it.
    fn bounds(&self) -> [DVec3; 2] {
        let [a, b, c] = self.drawn;
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// A vector across it.
    fn normal(&self) -> DVec3 {
        let [a, b, c] = self.drawn;
        (b - a).cross(c - a)
    }

    /// The part of it that lies in the plane of another one.
    fn in_plane_of(&self, other: &Self) -> Option<[DVec3; 2]> {
        let (normal, on) = (other.normal(), other.drawn[0]);
        let off = self.drawn.map(|at| normal.dot(at - on));
        let mut crossed = [(0, 1), (1, 2), (2, 0)].into_iter().filter(|&(a, b)| (off[a] < 0.0) != (off[b] < 0.0));
        let mut next = || crossed.next().map(|(a, b)| self.drawn[a].lerp(self.drawn[b], off[a] / (off[a] - off[b])));
        Some([next()?, next()?])
    }

    /// The line in which it cuts another one, unless that is what becomes of a common side or corner as one is drawn nearer.
    fn cut_away(&self, other: &Self) -> Option<[DVec3; 2]> {
        let common: Vec<_> = (0..3).filter(|&at| other.own.contains(&self.own[at])).map(|at| self.drawn[at]).collect();
        let apart = |at: DVec3| match common[..] {
            [] => f64::INFINITY,
            [corner] => at.distance(corner),
            [from, to] => {
                let side = to - from;
                let share = ((at - from).dot(side) / side.length_squared()).clamp(0.0, 1.0);
                at.distance(from.lerp(to, share))
            }
            _ => 0.0,
        };
        let is_away = |line: &[DVec3; 2]| apart(line[0].midpoint(line[1])) > AWAY * NEARER;
        self.cut(other).filter(is_away)
    }

    /// The line in which it cuts another one.
    fn cut(&self, other: &Self) -> Option<[DVec3; 2]> {
        let (own, others) = (self.in_plane_of(other)?, other.in_plane_of(self)?);
        let way = self.normal().cross(other.normal());
        let [[a, b], others] = [own, others].map(|line| line.map(|at| way.dot(at)));
        let (from, to) = (others[0].min(others[1]).max(a.min(b)), others[0].max(others[1]).min(a.max(b)));
        let point = |at: f64| own[0].lerp(own[1], (at - a) / (b - a));
        (from < to).then(|| [point(from), point(to)])
    }
}

/// The lines in which the surface of the turned-over elements cuts that of the others, as seen from an eye in a direction.
pub(super) fn crossings([sound, turned_over]: [&Mesh; 2], eye: DVec3, forward: DVec3) -> Vec<[DVec3; 2]> {
    let count = sound.triangles.len() + turned_over.triangles.len();
    if turned_over.triangles.is_empty() || count > MOST_TRIANGLES {
        return Vec::new();
    }
    let nearer = |at: DVec3| {
        let distance = (at - eye).dot(forward);
        eye + (at - eye) * ((distance - NEARER) / distance)
    };
    let over: Vec<_> = Piece::all(turned_over, nearer).collect();
    let size = |[low, high]: [DVec3; 2]| (high - low).max_element();
    let mean = over.iter().map(|piece| size(piece.bounds())).sum::<f64>() / over.len() as f64;
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let whole = over.iter().map(Piece::bounds).fold(none, |one, other| [one[0].min(other[0]), one[1].max(other[1])]);
    let cell = (BOX * mean).max(size(whole) / 100.0);
    if !(cell > 0.0 && cell.is_finite()) {
        return Vec::new();
    }
    let cell_of = |at: DVec3| ((at - whole[0]) / cell).floor().as_ivec3();
    let cells = |[low, high]: [DVec3; 2]| {
        let [low, high] = [cell_of(low), cell_of(high)];
        (low.x..=high.x)
            .flat_map(move |x| (low.y..=high.y).map(move |y| [x, y]))
            .flat_map(move |[x, y]| (low.z..=high.z).map(move |z| IVec3::new(x, y, z)))
    };
    let mut grid: HashMap<IVec3, Vec<usize>> = HashMap::new();
    for (at, piece) in over.iter().enumerate() {
        cells(piece.bounds()).for_each(|cell| grid.entry(cell).or_default().push(at));
    }
    let mut lines = Vec::new();
    for piece in Piece::all(sound, |at| at) {
        let [low, high] = piece.bounds();
        let [inside, outside] = [low.max(whole[0]), high.min(whole[1])];
        if !inside.cmple(outside).all() {
            continue;
        }
        for cell in cells([inside, outside]) {
            for other in grid.get(&cell).into_iter().flatten().map(|&at| &over[at]) {
                let [other_low, other_high] = other.bounds();
                // Each pair counts in the first cell that both share.
                let meet = low.max(other_low);
                let is_near = meet.cmple(high.min(other_high)).all() && cell_of(meet.max(whole[0])) == cell;
                if is_near {
                    lines.extend(piece.cut_away(other));
                }
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(corners: [[f32; 3]; 3]) -> Mesh {
        let vertices = corners.map(|position| Vertex { position, ..Vertex::default() }).to_vec();
        Mesh { vertices, triangles: vec![[0, 1, 2]], shades: Vec::new() }
    }

    #[test]
    fn triangles_cut_each_other_where_they_are_drawn() {
        let level = mesh([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]]);
        let upright = mesh([[0.0, 0.2, -1.0], [1.0, 0.2, -1.0], [0.0, 0.2, 1.0]]);
        // Seen from far away to the left, the second one is drawn further left.
        let (eye, forward) = (DVec3::new(-1e6, 0.0, 0.0), DVec3::X);
        let found = crossings([&level, &upright], eye, forward);
        let [[from, to]] = found[..] else { panic!("{found:?}") };
        let ends = [[-0.02, 0.2, 0.0], [0.48, 0.2, 0.0]].map(DVec3::from);
        let is_near = |one: DVec3, other: DVec3| one.distance(other) < 1e-5;
        assert!(
            is_near(from, ends[0]) && is_near(to, ends[1]) || is_near(from, ends[1]) && is_near(to, ends[0]),
            "{found:?}"
        );
        // Not where they only would, and not where they hang together.
        let aside = mesh([[0.0, 9.2, -1.0], [1.0, 9.2, -1.0], [0.0, 9.2, 1.0]]);
        assert!(crossings([&level, &aside], eye, forward).is_empty());
        let joined = mesh([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, -1.0, 3.0]]);
        assert!(crossings([&level, &joined], eye, forward).is_empty());
        assert!(crossings([&level, &Mesh::default()], eye, forward).is_empty());
    }
}
