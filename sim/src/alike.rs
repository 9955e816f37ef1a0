//! Finding lists with the same indices in any order: faces that two elements share, elements that are listed twice.

/// Marks the end of a chain.
const NONE: u32 = u32::MAX;

/// A hash table of index lists, which finds a list with the same indices.
///
/// The hash is the sum of the indices. Neighbouring elements have neighbouring sums, so the chains of a large body stay
/// in the cache; sorted keys or scattered hashes took several times as long for a million elements.
#[derive(Clone, Debug)]
pub struct Alike {
    /// The list last added to each chain; the number of chains is a power of two.
    last: Vec<u32>,
    /// The list before each list in its chain.
    before: Vec<u32>,
}

impl Alike {
    /// A table for about this number of lists at a time.
    pub fn new(lists: usize) -> Self {
        Self { last: vec![NONE; lists.max(1).next_power_of_two()], before: Vec::new() }
    }

    fn chain(&self, list: &[u32]) -> usize {
        list.iter().fold(0, |sum: usize, &index| sum.wrapping_add(index as usize)) & (self.last.len() - 1)
    }

    /// Adds a list under a number below 2³² − 1 that is not in use.
    pub fn put(&mut self, number: usize, list: &[u32]) {
        let chain = self.chain(list);
        if self.before.len() <= number {
            self.before.resize(number + 1, NONE);
        }
        self.before[number] = std::mem::replace(&mut self.last[chain], number as u32);
    }

    /// The number of the last added list with the same indices; `known` returns the list of a number. The indices
    /// within a list are different.
    pub fn find<'l>(&self, list: &[u32], known: impl Fn(usize) -> &'l [u32]) -> Option<usize> {
        let mut number = self.last[self.chain(list)];
        while number != NONE && !have_the_same(known(number as usize), list) {
            number = self.before[number as usize];
        }
        (number != NONE).then_some(number as usize)
    }

    /// Like [`Self::find`], and removes the list.
    pub(crate) fn take<'l>(&mut self, list: &[u32], known: impl Fn(usize) -> &'l [u32]) -> Option<usize> {
        let chain = self.chain(list);
        let (mut after, mut number) = (NONE, self.last[chain]);
        while number != NONE && !have_the_same(known(number as usize), list) {
            (after, number) = (number, self.before[number as usize]);
        }
        let before = *self.before.get(number as usize)?;
        *if after == NONE { &mut self.last[chain] } else { &mut self.before[after as usize] } = before;
        Some(number as usize)
    }
}

fn have_the_same(one: &[u32], other: &[u32]) -> bool {
    one.len() == other.len() && one.iter().all(|index| other.contains(index))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_the_same_indices_are_found_until_they_are_taken() {
        // All in one chain; the last two have the same indices.
        let lists: [&[u32]; 5] = [&[0, 9], &[4, 5], &[1, 2, 6], &[3, 6], &[6, 3]];
        let known = |number: usize| lists[number];
        let mut alike = Alike::new(1);
        (0..5).for_each(|number| alike.put(number, lists[number]));
        assert_eq!([&[9, 0][..], &[6, 2, 1], &[2, 7]].map(|list| alike.find(list, known)), [Some(0), Some(2), None]);
        assert_eq!([0; 3].map(|_| alike.take(&[6, 3], known)), [Some(4), Some(3), None]);
        assert_eq!([0; 2].map(|_| alike.take(&[5, 4], known)), [Some(1), None]);
        assert_eq!(alike.find(&[0, 9], known), Some(0));
    }
}
