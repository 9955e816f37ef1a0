//! Which surfaces may meet: those that are near each other, and for how many steps none are.

use super::extent::Extent;
use super::known::Known;
use super::pair::Pair;
use super::rule::Law;
use super::stage::Stage;
use crate::motion::Interval;
use crate::state::Nodes;
use glam::DVec3;

impl Stage {
    /// Chooses the pairs of surfaces that are near each other, and returns the way (m) of any two until others may meet.
    pub(super) fn choose(&self, at: &[DVec3], ahead: f64, pairs: &mut Vec<Pair>) -> f64 {
        let extents: Vec<_> = self.surfaces.iter().map(|surface| Extent::of(surface, at)).collect();
        let bodies = &extents[..self.bodies];
        let size = bodies.iter().map(|extent| extent.size().max_element()).sum::<f64>() / self.bodies as f64;
        let margin = (0.1 * size).max(16.0 * ahead);
        let reach = margin + self.widest_gap();
        let mut order: Vec<usize> = (0..extents.len()).collect();
        order.sort_by(|&one, &other| extents[one].low.x.total_cmp(&extents[other].low.x));
        let mut chosen = Vec::new();
        for (at, &one) in order.iter().enumerate() {
            if one < self.bodies {
                chosen.push([one, one]);
            }
            let end = extents[one].high.x + reach;
            let beside = order[at + 1..].iter().take_while(|&&other| extents[other].low.x <= end);
            let near = beside.filter(|&&other| extents[one].distance(&extents[other]) <= reach);
            chosen.extend(near.map(|&other| [one.min(other), one.max(other)]));
        }
        chosen.sort_unstable();
        let mut old = std::mem::take(pairs).into_iter().peekable();
        for of in chosen {
            while old.next_if(|pair| pair.of < of).is_some() {}
            match old.next_if(|pair| pair.of == of) {
                Some(pair) => pairs.push(pair),
                None => pairs.extend(self.law(of[0], of[1]).map(|law| Pair::new(of, law))),
            }
        }
        margin
    }

    /// How many steps of ΔT (s), at most `most`, bodies can take alone, and the speed (m/s) up to which they can: above it they might
    /// meet. `None` if they may meet in the next step.
    pub(crate) fn alone(&self, at: Nodes<'_>, interval: Interval, most: u64) -> Option<(u64, f64)> {
        /// A node moves at most so many times as far as its speed says: it may be thrown back by an obstacle.
        const THROWN: f64 = 3.0;
        if self.contacts.bodies.iter().any(|body| body.itself) {
            return None;
        }
        let mut known = self.known.lock();
        let Known { now: places, extents, order, .. } = &mut *known;
        places.clear();
        places.extend_from_slice(at.position);
        self.add_obstacles(interval.begin, places);
        extents.clear();
        extents.extend(self.surfaces.iter().map(|surface| Extent::of(surface, places)));
        let speeds = at.velocity.iter().map(|velocity| velocity.length_squared());
        let fastest = speeds.fold(0.0, f64::max).sqrt();
        let quickest = self.obstacles.iter().map(|solid| solid.greatest_speed).fold(0.0, f64::max);
        let widest = self.widest_gap();
        let lever = self.surfaces.iter().map(|surface| surface.lever).fold(1.0, f64::max);
        let bearable = |way: f64, own: f64| (way / (most as f64 * interval.step) - own) / (2.0 * THROWN * lever);
        order.clear();
        order.extend(0..extents.len());
        order
            .sort_unstable_by(|&one, &other| extents[one].low.x.total_cmp(&extents[other].low.x).then(one.cmp(&other)));
        let clear = self
            .grounds
            .iter()
            .try_fold(f64::INFINITY, |least, ground| Some(least.min(ground.clear(&self.surfaces, places)?)));
        let mut speed = bearable(clear?, 0.0);
        for (at, &one) in order.iter().enumerate() {
            for &other in &order[at + 1..] {
                // No later one is nearer.
                let least = extents[other].low.x - extents[one].high.x - widest;
                if speed <= 1.1 * fastest || bearable(least, quickest) >= speed {
                    break;
                }
                let Some(Law { gap, .. }) = self.law(one.min(other), one.max(other)) else { continue };
                let own =
                    one.max(other).checked_sub(self.bodies).map_or(0.0, |solid| self.obstacles[solid].greatest_speed);
                speed = speed.min(bearable(extents[one].distance(&extents[other]) - gap, own));
            }
        }
        (speed > 1.1 * fastest).then_some((most, speed))
    }
}
