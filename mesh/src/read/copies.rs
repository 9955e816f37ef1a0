//! Copies of points and cells that the pieces of a parallel run have of each other.

use super::Cells;
use crate::edges::Sets;
use glam::DVec3;
use std::collections::HashMap;

/// A position by its bits.
type Place = [u64; 3];

impl Cells {
    /// Pairs of points that are one: the corners of each copy and of the only cell, or the only point, at its place. Elsewhere, points at
    /// one place may be the sides of a crack.
    fn pairs(&self) -> Vec<[u32; 2]> {
        let sorted = |list: &[u32]| {
            // Adding zero turns −0 into 0.
            let place = |point: u32| (self.points[point as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
            let mut list: Vec<(Place, u32)> = list.iter().map(|&point| (place(point), point)).collect();
            list.sort_unstable();
            list.into_iter().unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let mut copies: HashMap<Vec<Place>, (Vec<u32>, Vec<u32>)> = HashMap::new();
        let mut is_copy = vec![false; self.points.len()];
        for list in self.copies.iter() {
            let (places, points) = sorted(list);
            copies.entry(places).or_default().0.extend(points);
            list.iter().filter(|_| list.len() == 1).for_each(|&point| is_copy[point as usize] = true);
        }
        let points: Vec<u32> = (0..).zip(&is_copy).filter(|(_, is_copy)| !**is_copy).map(|(point, _)| point).collect();
        for list in self.corners.iter().filter(|list| list.len() > 1).chain(points.chunks(1)) {
            let (places, own) = sorted(list);
            if let Some((_, originals)) = copies.get_mut(&places) {
                originals.extend(own);
            }
        }
        let only = copies.into_iter().filter(|(places, (_, originals))| originals.len() == places.len());
        only.flat_map(|(_, (copies, own))| copies.into_iter().zip(own.into_iter().cycle()).map(Into::into)).collect()
    }

    /// Makes each cell name the first of several points that are one.
    pub(super) fn join(&mut self) {
        if self.copies.is_empty() {
            return;
        }
        let mut sets = Sets::new(self.points.len());
        self.pairs().into_iter().for_each(|[one, other]| sets.join(one, other));
        let first: Vec<u32> = (0..self.points.len() as u32).map(|point| sets.of(point)).collect();
        self.rename(&first);
    }
}
