//! A page as a tree of boxes. A column holds rows below each other, and a row holds columns beside each other. If not
//! all boxes have room, the least important ones are left out, and their names are told.

/// A rectangle: left, top, width, height (px).
pub(in crate::picture) type Place = [f64; 4];

/// A box, named by a key. Its lengths are along the box around it (px).
#[derive(Clone, Debug, PartialEq)]
pub(in crate::picture) struct Node<K> {
    key: K,
    /// The least, the wanted and the largest length.
    least: f64,
    wanted: f64,
    most: f64,
    /// The largest part of the box around it.
    share: f64,
    /// The gap before it, which is part of its length.
    gap: f64,
    /// Boxes of higher ranks get room first, and earlier ones of equal rank. A box without a rank is kept.
    rank: Option<u8>,
    /// The boxes in it, in a row if it lies in a column, and in a column if it lies in a row.
    inside: Vec<Self>,
}

impl<K: Copy + PartialEq> Node<K> {
    /// A box of one length.
    pub(in crate::picture) fn new(key: K, length: f64) -> Self {
        Self { key, least: length, wanted: length, most: length, share: 1.0, gap: 0.0, rank: None, inside: Vec::new() }
    }

    /// The box with a smaller least length.
    pub(in crate::picture) fn least(self, least: f64) -> Self {
        Self { least: least.min(self.wanted), ..self }
    }

    /// The box, which takes spare room up to a length.
    pub(in crate::picture) fn most(self, most: f64) -> Self {
        Self { most: most.max(self.wanted), ..self }
    }

    /// The box, which takes all spare room.
    pub(in crate::picture) fn stretched(self) -> Self {
        self.most(f64::INFINITY)
    }

    /// The box, which takes at most a part of the box around it.
    pub(in crate::picture) fn share(self, share: f64) -> Self {
        Self { share, ..self }
    }

    /// The box with a gap before it.
    pub(in crate::picture) fn after(self, gap: f64) -> Self {
        let [least, wanted, most] = [self.least, self.wanted, self.most].map(|length| length + gap);
        Self { least, wanted, most, gap: self.gap + gap, ..self }
    }

    /// The box, which may be left out.
    pub(in crate::picture) fn rank(self, rank: u8) -> Self {
        Self { rank: Some(rank), ..self }
    }

    /// The box with boxes in it.
    pub(in crate::picture) fn with(self, inside: Vec<Self>) -> Self {
        Self { inside, ..self }
    }
}

/// The places of all boxes that have room.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::picture) struct Solved<K> {
    places: Vec<(K, Place)>,
    /// The boxes without room.
    pub(in crate::picture) left_out: Vec<K>,
}

impl<K: Copy + PartialEq> Solved<K> {
    /// The place of the first box with a key.
    pub(in crate::picture) fn get(&self, key: K) -> Option<Place> {
        self.all(key).next()
    }

    /// The places of all boxes with a key.
    pub(in crate::picture) fn all(&self, key: K) -> impl Iterator<Item = Place> {
        self.places.iter().filter(move |(own, _)| *own == key).map(|&(_, place)| place)
    }
}

/// Places the boxes of a column and all boxes in them.
pub(in crate::picture) fn column<K: Copy + PartialEq>(nodes: &[Node<K>], place: Place) -> Solved<K> {
    let mut solved = Solved { places: Vec::new(), left_out: Vec::new() };
    fill(nodes, place, 1, &mut solved);
    solved
}

/// Places boxes along an axis: 0 across, 1 down.
fn fill<K: Copy + PartialEq>(nodes: &[Node<K>], place: Place, axis: usize, solved: &mut Solved<K>) {
    let mut at = place[axis];
    for (node, length) in nodes.iter().zip(lengths(nodes, place[axis + 2])) {
        let Some(length) = length else {
            solved.left_out.push(node.key);
            continue;
        };
        let mut own = place;
        let gap = node.gap.min(length);
        (own[axis], own[axis + 2]) = (at + gap, length - gap);
        solved.places.push((node.key, own));
        fill(&node.inside, own, 1 - axis, solved);
        at += length;
    }
}

/// The lengths of boxes that share a length, `None` for those without room. Boxes without a rank get their least
/// lengths, then each of the others, from the highest rank, if it still has room and no box of its key before it is
/// left out. Then these get as much as they want, then all, then the rest.
fn lengths<K: PartialEq>(nodes: &[Node<K>], length: f64) -> Vec<Option<f64>> {
    let length = length.max(0.0);
    let limit = |node: &Node<K>, most: f64| most.min(node.share * length).max(node.least);
    let mut given: Vec<_> = nodes.iter().map(|node| node.rank.is_none().then_some(node.least)).collect();
    let taken = |given: &[Option<f64>]| given.iter().flatten().sum::<f64>();
    let mut ranked: Vec<_> = (0..nodes.len()).filter(|&at| nodes[at].rank.is_some()).collect();
    ranked.sort_by_key(|&at| std::cmp::Reverse(nodes[at].rank));
    for at in ranked {
        given[at] = Some(nodes[at].least).filter(|least| {
            let is_first =
                nodes[..at].iter().zip(&given).all(|(node, given)| given.is_some() || node.key != nodes[at].key);
            is_first && *least <= nodes[at].share * length && taken(&given) + least <= length * (1.0 + 1e-9)
        });
    }
    let smaller = (length / taken(&given).max(f64::MIN_POSITIVE)).min(1.0);
    given.iter_mut().flatten().for_each(|given| *given *= smaller);
    let ranked = |node: &Node<K>| if node.rank.is_some() { node.wanted } else { node.least };
    for most in [ranked, |node: &Node<K>| node.wanted, |node: &Node<K>| node.most] {
        // Spare room is shared alike, until the first boxes have enough.
        loop {
            let spare = length - taken(&given);
            let needs = nodes
                .iter()
                .zip(&given)
                .map(|(node, given)| given.map_or(0.0, |given| limit(node, most(node)) - given));
            let needs: Vec<_> = needs.collect();
            let growing = needs.iter().filter(|&&need| need > 0.0);
            let step = growing.clone().copied().fold(spare / growing.count().max(1) as f64, f64::min);
            if spare <= 1e-9 * length || step <= 0.0 || !needs.iter().any(|&need| need > 0.0) {
                break;
            }
            for (given, need) in given.iter_mut().zip(needs).filter(|(_, need)| *need > 0.0) {
                *given = given.map(|given| given + step.min(need));
            }
        }
    }
    given
}

#[cfg(test)]
#[path = "../../../tests/inside/tree.rs"]
mod tests;
