//! Candidates of contact, most of which sleep.

/// Features of two surfaces in their order, and from which way on each of them is looked at (m).
#[derive(Clone, Debug, Default)]
pub(super) struct Candidates {
    features: Vec<[u32; 2]>,
    wakes: Vec<[f64; Candidates::BLOCK]>,
    /// The least of each block.
    least: Vec<f64>,
}

impl Candidates {
    /// So many are passed over at once where all of them sleep.
    const BLOCK: usize = 8;

    /// Takes others, which are all awake.
    pub(super) fn renew(&mut self, features: impl Iterator<Item = [u32; 2]>) {
        self.features.clear();
        self.features.extend(features);
        let blocks = self.features.len().div_ceil(Self::BLOCK);
        self.wakes.clear();
        self.wakes.resize(blocks, [f64::NEG_INFINITY; Self::BLOCK]);
        let filled = self.features.len() % Self::BLOCK;
        if let Some(last) = self.wakes.last_mut().filter(|_| filled > 0) {
            last[filled..].fill(f64::INFINITY);
        }
        self.least.clear();
        self.least.resize(blocks, f64::NEG_INFINITY);
    }

    /// Calls `look` with those that are awake at a way (m), in order. It returns when each wakes next.
    pub(super) fn for_each_awake(&mut self, way: f64, mut look: impl FnMut([u32; 2]) -> f64) {
        for (block, least) in self.least.iter_mut().enumerate().filter(|(_, least)| **least <= way) {
            let wakes = &mut self.wakes[block];
            let mut awake = 0u32;
            for (at, wake) in wakes.iter().enumerate() {
                awake |= u32::from(*wake <= way) << at;
            }
            while awake != 0 {
                let at = awake.trailing_zeros() as usize;
                wakes[at] = look(self.features[block * Self::BLOCK + at]);
                awake &= awake - 1;
            }
            *least = wakes.iter().fold(f64::INFINITY, |least, &wake| if wake < least { wake } else { least });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_awake_are_seen_in_order() {
        let mut list = Candidates::default();
        list.renew((0..21).map(|at| [at, at + 1]));
        let mut seen = |way: f64, next: fn(u32) -> f64| {
            let mut all = Vec::new();
            list.for_each_awake(way, |[first, _]| {
                all.push(first);
                next(first)
            });
            all
        };
        assert_eq!(seen(0.0, f64::from), (0..21).collect::<Vec<_>>());
        assert_eq!(seen(4.5, |_| f64::NEG_INFINITY), [0, 1, 2, 3, 4]);
        assert_eq!(seen(5.0, |_| f64::INFINITY), [0, 1, 2, 3, 4, 5]);
        assert_eq!(seen(100.0, f64::from), (6..21).collect::<Vec<_>>());
    }
}
