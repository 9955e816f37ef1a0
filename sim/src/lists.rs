//! Many short lists of indices in one allocation.

/// Lists of indices of varying length, stored one behind the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexLists {
    offsets: Vec<usize>,
    indices: Vec<u32>,
}

impl Default for IndexLists {
    fn default() -> Self {
        Self { offsets: vec![0], indices: Vec::new() }
    }
}

impl IndexLists {
    /// Appends one list.
    pub fn push(&mut self, list: &[u32]) {
        self.indices.extend_from_slice(list);
        self.offsets.push(self.indices.len());
    }

    /// Appends all lists of others, whose indices are counted from `first`.
    pub fn append(&mut self, others: &Self, first: u32) {
        let end = self.indices.len();
        self.offsets.extend(others.offsets[1..].iter().map(|offset| end + offset));
        self.indices.extend(others.indices.iter().map(|index| first + index));
    }

    /// The number of lists.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there are no lists.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The range of list `at` in [`Self::indices`].
    pub fn range(&self, at: usize) -> std::ops::Range<usize> {
        self.offsets[at]..self.offsets[at + 1]
    }

    /// All indices, list after list.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// The lists in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        (0..self.len()).map(|at| &self[at])
    }
}

impl std::ops::Index<usize> for IndexLists {
    type Output = [u32];
    fn index(&self, at: usize) -> &[u32] {
        &self.indices[self.range(at)]
    }
}

impl<'a> FromIterator<&'a [u32]> for IndexLists {
    fn from_iter<I: IntoIterator<Item = &'a [u32]>>(lists: I) -> Self {
        let mut all = Self::default();
        for list in lists {
            all.push(list);
        }
        all
    }
}
