//! The edges of triangles, and what hangs together.

/// A triangle's use of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct EdgeUse {
    pub(crate) low: u32,
    pub(crate) high: u32,
    pub(crate) triangle: u32,
    /// Whether the triangle passes the edge from its lower to its higher point.
    pub(crate) forward: bool,
}

impl EdgeUse {
    /// All uses, by edge and then by triangle.
    pub(crate) fn all(triangles: &[[u32; 3]]) -> Vec<Self> {
        let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
        // Most points are the lower ends of few edges, so that little is left to sort.
        let points = triangles.as_flattened().iter().max().map_or(0, |&most| most as usize + 1);
        let mut next = vec![0; points + 1];
        triangles.iter().flat_map(sides).for_each(|(from, to)| next[from.min(to) as usize + 1] += 1);
        (0..points).for_each(|point| next[point + 1] += next[point]);
        let mut sorted = vec![Self { low: 0, high: 0, triangle: 0, forward: false }; 3 * triangles.len()];
        for (triangle, of) in (0..).zip(triangles) {
            for (from, to) in sides(of) {
                let place = &mut next[from.min(to) as usize];
                sorted[*place] = Self { low: from.min(to), high: from.max(to), triangle, forward: from < to };
                *place += 1;
            }
        }
        let key = |one: &Self| (u64::from(one.high) << 32 | u64::from(one.triangle), one.forward);
        sorted.chunk_by_mut(|one, other| one.low == other.low).for_each(|of| of.sort_unstable_by_key(key));
        sorted
    }

    pub(crate) fn same(&self, other: &Self) -> bool {
        (self.low, self.high) == (other.low, other.high)
    }
}

/// How much more often an edge is passed from its lower to its higher point than back.
pub(crate) fn net(edge: &[EdgeUse]) -> i32 {
    edge.iter().map(|edge| if edge.forward { 1 } else { -1 }).sum()
}

/// The piece of some triangles to which each point belongs, and how many there are.
pub(crate) fn pieces(points: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let mut sets = Sets::new(points);
    for &[a, b, c] in triangles {
        sets.join(a, b);
        sets.join(a, c);
    }
    sets.numbered()
}

/// Disjoint sets of numbers from 0 on, such as the points of pieces of a surface.
#[derive(Clone, Debug)]
pub struct Sets(Vec<u32>);

impl Sets {
    /// Each number alone.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The lowest number of the set of one.
    pub fn of(&mut self, mut one: u32) -> u32 {
        while self.0[one as usize] != one {
            self.0[one as usize] = self.0[self.0[one as usize] as usize];
            one = self.0[one as usize];
        }
        one
    }

    /// Unites two sets.
    pub fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.of(one), self.of(other));
        self.0[one.max(other) as usize] = one.min(other);
    }

    /// The set of each number, counted in the order of the lowest numbers of sets, and how many there are.
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut count = 0;
        let mut number: Vec<u32> = Vec::with_capacity(self.0.len());
        for one in 0..self.0.len() as u32 {
            let of = self.of(one);
            if of == one {
                number.push(count);
                count += 1;
            } else {
                number.push(number[of as usize]);
            }
        }
        (number, count as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uses_are_in_the_order_of_edges_and_triangles() {
        // Points beside all others, and triangles that have a point or all of them in common.
        let triangle = |at: u32| [at * 7 % 31, at * 13 % 29, if at.is_multiple_of(3) { 0 } else { at * 5 % 23 }];
        let uses = EdgeUse::all(&(0..2000).map(triangle).collect::<Vec<_>>());
        assert_eq!(uses.len(), 6000);
        assert!(uses.is_sorted(), "{uses:?}");
        assert_eq!(EdgeUse::all(&[]), []);
    }

    #[test]
    fn sets_are_united() {
        let mut sets = Sets::new(6);
        [[4, 2], [5, 4], [0, 1]].into_iter().for_each(|[one, other]| sets.join(one, other));
        assert_eq!([0, 1, 2, 3, 4, 5].map(|one| sets.of(one)), [0, 0, 2, 3, 2, 2]);
        assert_eq!(sets.numbered(), (vec![0, 0, 1, 2, 1, 1], 3));
    }
}
