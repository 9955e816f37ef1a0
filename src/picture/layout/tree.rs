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
mod tests {
    use super::*;

    /// A page of a size in words: each box with its left, top, width and height, then those without room.
    fn said(size: [f64; 2]) -> String {
        let panel = || {
            Node::new("panel", 0.0).stretched().with(vec![
                Node::new("name", 20.0).rank(1),
                Node::new("events", 20.0).rank(0),
                Node::new("body", 60.0).stretched(),
            ])
        };
        let page = [
            Node::new("title", 30.0).rank(2),
            Node::new("panels", 100.0).stretched().with(vec![panel(), panel()]),
            Node::new("chart", 80.0).least(40.0).share(0.25).rank(1),
            Node::new("caption", 20.0).rank(0),
            Node::new("caption", 20.0).rank(0),
        ];
        let Solved { places, left_out } = column(&page, [0.0, 0.0, size[0], size[1]]);
        let places =
            places.iter().map(|(key, [left, top, width, height])| format!("{key} {left} {top} {width} {height}"));
        places.chain([format!("left out: {}", left_out.join(", "))]).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_page_has_fewer_boxes_the_smaller_it_is() {
        let large = "title 0 0 400 30\npanels 0 30 400 310\n\
                     panel 0 30 200 310\nname 0 30 200 20\nevents 0 50 200 20\nbody 0 70 200 270\n\
                     panel 200 30 200 310\nname 200 30 200 20\nevents 200 50 200 20\nbody 200 70 200 270\n\
                     chart 0 340 400 80\ncaption 0 420 400 20\ncaption 0 440 400 20\nleft out: ";
        assert_eq!(said([400.0, 460.0]), large);
        let small = "title 0 0 90 30\npanels 0 30 90 100\n\
                     panel 0 30 45 100\nname 0 30 45 20\nevents 0 50 45 20\nbody 0 70 45 60\n\
                     panel 45 30 45 100\nname 45 30 45 20\nevents 45 50 45 20\nbody 45 70 45 60\n\
                     chart 0 130 90 40\nleft out: caption, caption";
        assert_eq!(said([90.0, 170.0]), small);
        let least = "panels 0 0 90 70\n\
                     panel 0 0 45 70\nbody 0 0 45 70\npanel 45 0 45 70\nbody 45 0 45 70\n\
                     left out: title, name, events, name, events, chart, caption, caption";
        assert_eq!(said([90.0, 70.0]), least);
    }

    #[test]
    fn a_smaller_box_has_room_where_a_more_important_one_has_none() {
        let caption = |gap| Node::new("caption", 20.0).after(gap).rank(1);
        let nodes = [
            Node::new("panels", 100.0),
            Node::new("chart", 60.0).rank(2),
            Node::new("chart", 20.0).rank(0),
            caption(10.0),
            caption(0.0),
        ];
        let left_out = |height| column(&nodes, [0.0, 0.0, 10.0, height]).left_out;
        assert_eq!(left_out(230.0), [""; 0]);
        assert_eq!(left_out(210.0), ["chart"]);
        assert_eq!(left_out(190.0), ["chart", "caption"]);
        // No chart without the chart before it, and no line of the caption without the line before it.
        assert_eq!(left_out(150.0), ["chart", "chart"]);
        assert_eq!(left_out(125.0), ["chart", "chart", "caption", "caption"]);
    }

    #[test]
    fn spare_room_is_shared_up_to_the_largest_lengths() {
        let nodes = [Node::new(0, 10.0).most(25.0), Node::new(1, 10.0), Node::new(2, 40.0).least(20.0).most(60.0)];
        let of = |length: f64| lengths(&nodes, length).into_iter().map(Option::unwrap).collect::<Vec<_>>();
        assert_eq!(of(20.0), [5.0, 5.0, 10.0]);
        assert_eq!(of(50.0), [10.0, 10.0, 30.0]);
        assert_eq!(of(80.0), [20.0, 10.0, 50.0]);
        assert_eq!(of(200.0), [25.0, 10.0, 60.0]);
    }
}
