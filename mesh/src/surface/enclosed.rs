//! What pieces of a surface enclose, and which lie in which.

use super::Surface;
use crate::edges::{EdgeUse, net};
use crate::inside::Columns;
use glam::DVec3;

/// What a piece of a surface encloses. An open one is closed by a fan of triangles over the middle of its open edges.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Enclosed {
    /// Negative if its triangles look inwards.
    volume: f64,
    area: f64,
    pub(crate) is_open: bool,
    /// A point of it.
    first: DVec3,
}

impl Enclosed {
    /// Whether it is flat but for round-off.
    pub(super) fn is_sheet(&self) -> bool {
        self.size() <= 1e-9 * self.area * self.area.sqrt()
    }

    /// Its volume, whichever way it looks.
    pub(crate) fn size(&self) -> f64 {
        self.volume.abs()
    }

    pub(crate) fn is_solid(&self) -> bool {
        self.volume > 0.0 && !self.is_sheet()
    }
}

impl Surface {
    /// What each of so many pieces encloses, by the piece of each triangle.
    pub(crate) fn enclosed(&self, piece_of: &[u32], count: usize) -> Vec<Enclosed> {
        let uses = EdgeUse::all(&self.triangles);
        let mut middles = vec![(DVec3::ZERO, 0u32); count];
        for edge in uses.chunk_by(EdgeUse::same) {
            if net(edge) != 0 {
                let (sum, number) = &mut middles[piece_of[edge[0].triangle as usize] as usize];
                *sum += self.points[edge[0].low as usize] + self.points[edge[0].high as usize];
                *number += 2;
            }
        }
        let mut pieces = vec![Enclosed::default(); count];
        for (&triangle, &piece) in self.triangles.iter().zip(piece_of).rev() {
            pieces[piece as usize].first = self.corners(triangle)[0];
        }
        for (&triangle, &piece) in self.triangles.iter().zip(piece_of) {
            let ((sum, number), piece) = (middles[piece as usize], &mut pieces[piece as usize]);
            piece.is_open = number > 0;
            let origin = if piece.is_open { sum / f64::from(number) } else { piece.first };
            let [a, b, c] = self.corners(triangle).map(|corner| corner - origin);
            piece.volume += a.dot(b.cross(c)) / 6.0;
            piece.area += 0.5 * (b - a).cross(c - a).length();
        }
        pieces
    }

    /// Calls `visit` with each piece and the closed ones that go around its first point, with their winding numbers.
    pub(crate) fn nested(&self, piece_of: &[u32], pieces: &[Enclosed], mut visit: impl FnMut(usize, &[(usize, i32)])) {
        let columns = Columns::new(&self.points, &self.triangles);
        for (piece, Enclosed { first: from, .. }) in pieces.iter().enumerate() {
            let mut crossed = Vec::new();
            columns.crossings(from.y, from.z, |crossing| {
                let other = piece_of[crossing.triangle as usize] as usize;
                if other != piece && !pieces[other].is_open && crossing.is_after(from.x) {
                    crossed.push((other, crossing.sign));
                }
            });
            crossed.sort_unstable();
            let of_piece = |all: &[(usize, i32)]| (all[0].0, all.iter().map(|(_, sign)| sign).sum());
            let mut around: Vec<_> = crossed.chunk_by(|one, other| one.0 == other.0).map(of_piece).collect();
            around.retain(|&(_, winding)| winding != 0);
            visit(piece, &around);
        }
    }
}
