//! Bins of values.

/// Values in bins, in each in the order in which they came.
#[derive(Debug)]
pub(crate) struct Bins<T> {
    /// For each bin the end of its values.
    ends: Vec<u32>,
    values: Vec<T>,
}

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
    fn bins_keep_the_order_of_their_values() {
        let bins = Bins::new(4, [(2, 'c'), (0, 'b'), (2, 'a'), (0, 'd')].into_iter());
        assert_eq!([0, 1, 2, 3].map(|bin| bins.of(bin).iter().collect::<String>()), ["bd", "", "ca", ""]);
        assert_eq!(bins.sorted(|&value| value), ['b', 'd', 'a', 'c']);
    }
}
