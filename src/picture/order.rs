//! Sorting by depth (painter's algorithm).

/// Depths that differ by less than this part of the largest are equal.
const EQUALLY_DEEP: f64 = 1e-6;

/// Items with their distances from the eye, the farthest first. Items of equal depth keep their order; depths are
/// rounded to steps, so that round-off hardly ever changes it.
pub(super) fn farthest_first<T>(mut things: Vec<(f64, T)>) -> impl Iterator<Item = T> {
    let step = EQUALLY_DEEP * things.iter().map(|(depth, _)| depth.abs()).fold(0.0, f64::max);
    let rank = |depth: f64| (depth / step.max(f64::MIN_POSITIVE)).round();
    things.sort_by(|one, other| rank(other.0).total_cmp(&rank(one.0)));
    things.into_iter().map(|(_, thing)| thing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_farthest_comes_first_and_round_off_changes_no_order() {
        let order = |things: Vec<(f64, char)>| farthest_first(things).collect::<String>();
        for size in [1e-9, 1.0, 1e9] {
            assert_eq!(order(vec![(size, 'a'), (3.0 * size, 'b'), (2.0 * size, 'c')]), "bca");
            let nearly = |depth: f64| [depth, depth * (1.0 + 1e-12), depth * (1.0 - 1e-12)];
            let [a, b, c] = nearly(size);
            assert_eq!(order(vec![(a, 'a'), (b, 'b'), (c, 'c')]), "abc");
            assert_eq!(order(vec![(b, 'a'), (c, 'b'), (a, 'c')]), "abc");
        }
        assert_eq!(order(vec![(0.0, 'a'), (0.0, 'b')]), "ab");
        assert_eq!(order(Vec::new()), "");
    }
}
