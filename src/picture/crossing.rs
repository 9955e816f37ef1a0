//! Where the surface of the turned-over elements cuts that of the others: their colours change there without a line.

use super::Mesh;
use glam::{DVec3, UVec3};

/// The turned-over set is drawn this much nearer (sides), as in the shader.
const NEARER: f64 = 0.02;
/// What lies nearer to a common corner than this many times that is no cut.
const AWAY: f64 = 3.0;
/// Above this number of triangles elements are so small, and cuts so many, that borders without steps are not worth
/// their time.
const MOST_TRIANGLES: usize = 40_000;
/// Cells in which triangles are looked for are so many times larger than these, and at most so many along an axis.
const BOX: f64 = 2.0;
const MOST_CELLS: f64 = 20.0;

/// A triangle of a surface.
struct Piece {
    /// Its corners as they are, and as they are drawn.
    own: [[f32; 3]; 3],
    drawn: [DVec3; 3],
    /// The corners of the box around it.
    low: DVec3,
    high: DVec3,
    /// A vector across it.
    normal: DVec3,
}

impl Piece {
    fn all(mesh: &Mesh, drawn: impl Fn(DVec3) -> DVec3) -> impl Iterator<Item = Self> {
        let points: Vec<_> = mesh.vertices.iter().map(|at| drawn(DVec3::from(at.position.map(f64::from)))).collect();
        mesh.triangles.iter().map(move |corners| {
            let own = corners.map(|at| mesh.vertices[at as usize].position);
            let [a, b, c] = corners.map(|at| points[at as usize]);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            Self { own, drawn: [a, b, c], low, high, normal: (b - a).cross(c - a) }
        })
    }

    /// The part of it that lies in the plane of another one.
    fn in_plane_of(&self, other: &Self) -> Option<[DVec3; 2]> {
        let (normal, on) = (other.normal, other.drawn[0]);
        let off = self.drawn.map(|at| normal.dot(at - on));
        let mut crossed = [(0, 1), (1, 2), (2, 0)].into_iter().filter(|&(a, b)| (off[a] < 0.0) != (off[b] < 0.0));
        let mut next = || crossed.next().map(|(a, b)| self.drawn[a].lerp(self.drawn[b], off[a] / (off[a] - off[b])));
        Some([next()?, next()?])
    }

    /// The line in which it cuts another one, unless that is what becomes of a common side or corner as one is drawn
    /// nearer.
    fn cut_away(&self, other: &Self) -> Option<[DVec3; 2]> {
        let line = self.cut(other)?;
        let middle = line[0].midpoint(line[1]);
        let common: Vec<_> = (0..3).filter(|&at| other.own.contains(&self.own[at])).map(|at| self.drawn[at]).collect();
        let apart = match common[..] {
            [] => f64::INFINITY,
            [corner] => middle.distance(corner),
            [from, to] => {
                let side = to - from;
                let share = ((middle - from).dot(side) / side.length_squared()).clamp(0.0, 1.0);
                middle.distance(from.lerp(to, share))
            }
            _ => 0.0,
        };
        (apart > AWAY * NEARER).then_some(line)
    }

    /// The line in which it cuts another one.
    fn cut(&self, other: &Self) -> Option<[DVec3; 2]> {
        let (own, others) = (self.in_plane_of(other)?, other.in_plane_of(self)?);
        let way = self.normal.cross(other.normal);
        let [[a, b], others] = [own, others].map(|line| line.map(|at| way.dot(at)));
        let (from, to) = (others[0].min(others[1]).max(a.min(b)), others[0].max(others[1]).min(a.max(b)));
        let point = |at: f64| own[0].lerp(own[1], (at - a) / (b - a));
        (from < to).then(|| [point(from), point(to)])
    }
}

/// The lines in which the surface of the turned-over elements cuts that of the others, as seen from an eye in a
/// direction.
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
    let grid = Grid::new(&over);
    let mut lines = Vec::new();
    for piece in Piece::all(sound, |at| at) {
        let (low, high) = (piece.low.max(grid.low), piece.high.min(grid.high));
        if !low.cmple(high).all() {
            continue;
        }
        for cell in grid.cells(low, high) {
            for other in grid.of(cell).iter().map(|&at| &over[at as usize]) {
                let meet = low.max(other.low);
                // Each pair counts in the first cell that both share.
                if meet.cmple(high.min(other.high)).all() && grid.cell(grid.place(meet)) == cell {
                    lines.extend(piece.cut_away(other));
                }
            }
        }
    }
    lines
}

/// Triangles in the cells of a box around them.
struct Grid {
    low: DVec3,
    high: DVec3,
    /// Cells for a unit of length, and how many there are along each axis.
    fineness: DVec3,
    counts: UVec3,
    /// Where those of each cell begin among the triangles of all.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Grid {
    fn new(pieces: &[Piece]) -> Self {
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = pieces.iter().fold(none, |(low, high), one| (low.min(one.low), high.max(one.high)));
        let mean = pieces.iter().map(|one| (one.high - one.low).max_element()).sum::<f64>() / pieces.len() as f64;
        let counts = ((high - low) / (BOX * mean)).ceil().clamp(DVec3::ONE, DVec3::splat(MOST_CELLS));
        let counts = if counts.is_finite() { counts } else { DVec3::ONE };
        let fineness = counts / (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
        let cells = counts.element_product() as usize;
        let mut grid =
            Self { low, high, fineness, counts: counts.as_uvec3(), starts: vec![0; cells + 1], triangles: Vec::new() };
        for one in pieces {
            for cell in grid.cells(one.low, one.high) {
                grid.starts[cell + 1] += 1;
            }
        }
        for cell in 0..cells {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        let mut free = grid.starts.clone();
        grid.triangles = vec![0; free[cells] as usize];
        for (at, one) in pieces.iter().enumerate() {
            for cell in grid.cells(one.low, one.high) {
                grid.triangles[free[cell] as usize] = at as u32;
                free[cell] += 1;
            }
        }
        grid
    }

    /// Where the cell of a point is along each axis.
    fn place(&self, at: DVec3) -> UVec3 {
        ((at - self.low) * self.fineness).as_uvec3().min(self.counts - 1)
    }

    fn cell(&self, UVec3 { x, y, z }: UVec3) -> usize {
        ((x * self.counts.y + y) * self.counts.z + z) as usize
    }

    /// The cells of a box.
    fn cells(&self, low: DVec3, high: DVec3) -> impl Iterator<Item = usize> + use<> {
        let (low, high, counts) = (self.place(low), self.place(high), self.counts);
        (low.x..=high.x).flat_map(move |x| {
            let row = move |y| ((x * counts.y + y) * counts.z) as usize;
            (low.y..=high.y).flat_map(move |y| row(y) + low.z as usize..=row(y) + high.z as usize)
        })
    }

    /// The triangles of a cell.
    fn of(&self, cell: usize) -> &[u32] {
        &self.triangles[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Vertex;

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
