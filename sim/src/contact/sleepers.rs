//! What is looked at again only after a way, because until then nothing about it can change.

/// From which way on each of many things is looked at (m), by their numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct Sleepers {
    wakes: Vec<[f64; Sleepers::BLOCK]>,
    /// The least of each block.
    least: Vec<f64>,
}

impl Sleepers {
    /// So many are passed over at once where all of them sleep.
    const BLOCK: usize = 8;

    /// Takes so many others, which are all awake.
    pub(super) fn renew(&mut self, count: usize) {
        let (blocks, filled) = (count.div_ceil(Self::BLOCK), count % Self::BLOCK);
        self.wakes.clear();
        self.wakes.resize(blocks, [f64::NEG_INFINITY; Self::BLOCK]);
        if let Some(last) = self.wakes.last_mut().filter(|_| filled > 0) {
            last[filled..].fill(f64::INFINITY);
        }
        self.least.clear();
        self.least.resize(blocks, f64::NEG_INFINITY);
    }

    /// Lists those that are awake at a way (m), in order. Each of them is then told [until when it sleeps](Self::sleep).
    pub(super) fn awake(&mut self, way: f64, all: &mut Vec<u32>) {
        all.clear();
        for (block, least) in self.least.iter_mut().enumerate().filter(|(_, least)| **least <= way) {
            let (mut awake, mut others) = (0u32, self.wakes[block]);
            for (at, wake) in others.iter_mut().enumerate() {
                awake |= u32::from(*wake <= way) << at;
                *wake = if *wake <= way { f64::INFINITY } else { *wake };
            }
            // By halves, so that no comparison waits for all before it.
            for half in [4, 2, 1] {
                (0..half).for_each(|at| others[at] = others[at].min(others[at + half]));
            }
            *least = others[0];
            while awake != 0 {
                all.push((block * Self::BLOCK) as u32 + awake.trailing_zeros());
                awake &= awake - 1;
            }
        }
    }

    /// Until when one sleeps (m).
    pub(super) fn wake(&self, at: u32) -> f64 {
        self.wakes[at as usize / Self::BLOCK][at as usize % Self::BLOCK]
    }

    /// Lets one sleep up to a way (m).
    pub(super) fn sleep(&mut self, at: u32, wake: f64) {
        let (block, at) = (at as usize / Self::BLOCK, at as usize % Self::BLOCK);
        self.wakes[block][at] = wake;
        self.least[block] = self.least[block].min(wake);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_awake_are_seen_in_order() {
        let mut list = Sleepers::default();
        list.renew(21);
        let mut seen = |way: f64, next: fn(u32) -> f64| {
            let mut all = Vec::new();
            list.awake(way, &mut all);
            all.iter().for_each(|&at| list.sleep(at, next(at)));
            all
        };
        assert_eq!(seen(0.0, f64::from), (0..21).collect::<Vec<_>>());
        assert_eq!(seen(4.5, |_| f64::NEG_INFINITY), [0, 1, 2, 3, 4]);
        assert_eq!(seen(5.0, |_| f64::INFINITY), [0, 1, 2, 3, 4, 5]);
        assert_eq!(seen(100.0, f64::from), (6..21).collect::<Vec<_>>());
    }
}
