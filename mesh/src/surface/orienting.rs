//! Triangles turned so that they look out.

use super::{Flaws, Surface};
use crate::edges::{EdgeUse, Sets};

impl Surface {
    /// Turns triangles over, and counts edges and pieces.
    pub(super) fn orient(&mut self, flaws: &mut Flaws) {
        let uses = EdgeUse::all(&self.triangles);
        let count = self.triangles.len();
        // The neighbour at each edge of two triangles, and whether the two pass it in the same direction.
        let mut beside = vec![[None::<(u32, bool)>; 3]; count];
        let mut meet = |one: u32, other: u32, differs| {
            let free = beside[one as usize].iter_mut().find(|beside| beside.is_none());
            free.into_iter().for_each(|free| *free = Some((other, differs)));
        };
        let mut pieces = Sets::new(count);
        for edge in uses.chunk_by(EdgeUse::same) {
            match edge {
                [_] => flaws.boundary += 1,
                [a, b] => {
                    meet(a.triangle, b.triangle, a.forward == b.forward);
                    meet(b.triangle, a.triangle, a.forward == b.forward);
                }
                _ => flaws.non_manifold += 1,
            }
            edge.iter().for_each(|other| pieces.join(edge[0].triangle, other.triangle));
        }
        let mut turned: Vec<Option<bool>> = vec![None; count];
        for first in 0..count {
            if turned[first].is_some() {
                continue;
            }
            turned[first] = Some(false);
            let mut patch = vec![first as u32];
            let mut next = 0;
            while let Some(&triangle) = patch.get(next) {
                next += 1;
                for &(other, differs) in beside[triangle as usize].iter().flatten() {
                    if turned[other as usize].is_none() {
                        turned[other as usize] = Some(turned[triangle as usize] == Some(!differs));
                        patch.push(other);
                    }
                }
            }
            let minority = patch.iter().filter(|&&triangle| turned[triangle as usize] == Some(true)).count();
            if 2 * minority > patch.len() {
                patch.iter().for_each(|&triangle| {
                    turned[triangle as usize] = turned[triangle as usize].map(|turned| !turned);
                });
            }
        }
        let mut turned: Vec<bool> = turned.into_iter().map(|turned| turned == Some(true)).collect();
        flaws.inconsistent = uses
            .chunk_by(EdgeUse::same)
            .filter(|edge| match edge {
                [a, b] => (a.forward == b.forward) == (turned[a.triangle as usize] == turned[b.triangle as usize]),
                _ => false,
            })
            .count();
        let (piece_of, number) = pieces.numbered();
        flaws.pieces = number;
        let before = self.triangles.clone();
        self.turn(&turned);
        let outwards = self.outwards(&piece_of, number);
        turned.iter_mut().zip(&piece_of).for_each(|(turned, &piece)| *turned ^= !outwards[piece as usize]);
        self.triangles = before;
        self.turn(&turned);
        flaws.turned = turned.iter().filter(|turned| **turned).count();
    }

    fn turn(&mut self, turned: &[bool]) {
        self.triangles.iter_mut().zip(turned).filter(|(_, turned)| **turned).for_each(|(of, _)| of.swap(1, 2));
    }

    /// Whether each piece can stay as it is.
    fn outwards(&self, piece_of: &[u32], count: usize) -> Vec<bool> {
        let pieces = self.enclosed(piece_of, count);
        // A sheet stays as it is.
        let is_out = |piece: usize| pieces[piece].is_solid() || pieces[piece].is_sheet();
        if count < 2 {
            return (0..count).map(is_out).collect();
        }
        let mut outermost: Vec<usize> = (0..count).collect();
        self.nested(piece_of, &pieces, |piece, around| {
            let others = around.iter().map(|&(other, _)| other);
            let found =
                others.reduce(|best, other| if pieces[other].size() > pieces[best].size() { other } else { best });
            outermost[piece] = found.unwrap_or(piece);
        });
        outermost.into_iter().map(is_out).collect()
    }
}
