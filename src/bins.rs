//! Disjoint sets of numbers, and bins of values.

/// Disjoint sets of numbers from 0 on. The first number of a set is its lowest.
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// Each number alone.
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The first number of the set of one.
    pub(crate) fn first(&mut self, mut of: u32) -> u32 {
        while self.0[of as usize] != of {
            // Shorter paths.
            let next = self.0[of as usize];
            self.0[of as usize] = self.0[next as usize];
            of = next;
        }
        of
    }

    /// Unites two sets.
    pub(crate) fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.first(one), self.first(other));
        self.0[one.max(other) as usize] = one.min(other);
    }

    /// The number of sets.
    pub(crate) fn count(&self) -> usize {
        (0..).zip(&self.0).filter(|&(number, &leads)| number == leads).count()
    }
}

/// Values in bins, in each in the order in which they came.
#[cfg(feature = "render")]
#[derive(Debug)]
pub(crate) struct Bins<T> {
    /// For each bin the end of its values.
    ends: Vec<u32>,
    values: Vec<T>,
}

#[cfg(feature = "render")]
impl<T: Copy + Default> Bins<T> {
    /// Puts values into a number of bins, each value into the bin with which it comes.
    pub(crate) fn new(bins: usize, all: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut ends = vec![0_u32; bins + 1];
        all.clone().for_each(|(bin, _)| ends[bin as usize + 1] += 1);
        (0..bins).for_each(|bin| ends[bin + 1] += ends[bin]);
        let mut values = vec![T::default(); ends[bins] as usize];
        for (bin, value) in all {
            // The start of a bin becomes its end.
            let place = &mut ends[bin as usize];
            values[*place as usize] = value;
            *place += 1;
        }
        Self { ends, values }
    }

    /// The values in a bin.
    pub(crate) fn of(&self, bin: usize) -> &[T] {
        let start = bin.checked_sub(1).map_or(0, |before| self.ends[before]) as usize;
        &self.values[start..self.ends[bin] as usize]
    }

    /// All values, bin after bin, each sorted by a key.
    pub(crate) fn sorted<K: Ord>(mut self, key: impl Fn(&T) -> K) -> Vec<T> {
        let mut start = 0;
        for &end in &self.ends[..self.ends.len() - 1] {
            self.values[start..end as usize].sort_unstable_by_key(&key);
            start = end as usize;
        }
        self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_united() {
        let mut sets = Sets::new(6);
        [[4, 2], [5, 4], [0, 1]].into_iter().for_each(|[one, other]| sets.join(one, other));
        assert_eq!([0, 1, 2, 3, 4, 5].map(|one| sets.first(one)), [0, 0, 2, 3, 2, 2]);
        assert_eq!(sets.count(), 3);
    }

    #[cfg(feature = "render")]
    #[test]
    fn bins_keep_the_order_of_their_values() {
        let bins = Bins::new(4, [(2, 'c'), (0, 'b'), (2, 'a'), (0, 'd')].into_iter());
        assert_eq!([0, 1, 2, 3].map(|bin| bins.of(bin).iter().collect::<String>()), ["bd", "", "ca", ""]);
        assert_eq!(bins.sorted(|&value| value), ['b', 'd', 'a', 'c']);
    }
}
