//! Contact of surfaces at the end of a step: which pairs may meet, what touches, and the impulses in a fixed order.

use super::end::{End, Ends};
use super::features::Kind;
use super::ground::{Ground, Near};
use super::known::Known;
use super::pair::{Look, Pair};
use super::rule::{Law, Term};
use super::shown::{Shown, Way};
use super::stage::Stage;
use super::touches::Touches;
use super::{Side, Source};
use crate::crew::Crew;
use glam::DVec3;

impl Stage {
    /// Corrects positions and velocities at the end of a step. `held` are the nodes that grips hold, each with the number of its grip: they
    /// stay as they are.
    pub(crate) fn resolve(&self, mut end: End<'_>, held: impl Iterator<Item = [usize; 2]>, crew: &Crew) {
        let mut known = self.known.lock();
        let (known, interval) = (&mut *known, end.interval);
        let Known { last, ends, .. } = known;
        std::mem::swap(last, &mut ends.start);
        for (places, nodes, time) in
            [(&mut ends.start, end.before.position, interval.begin), (&mut ends.position, &*end.position, interval.end)]
        {
            places.clear();
            places.extend_from_slice(nodes);
            self.add_obstacles(time, places);
        }
        ends.held.clear();
        let numbers = held.map(|[grip, node]| (grip, self.nodes.binary_search(&(node as u32))));
        ends.held.extend(numbers.filter_map(|(grip, node)| Some([node.ok()?, grip])));
        ends.take(&self.inverse_mass, &end);
        self.meet_grounds(known, &end);
        self.go(known, crew);
        self.meet(known, &end, crew);
        known.ends.give(&mut end);
    }

    /// Lets surfaces meet half-spaces at the end of a step, in the order of bodies, half-spaces and points.
    fn meet_grounds(&self, known: &mut Known, end: &End<'_>) {
        let Known { ends, near, feet, .. } = known;
        if self.grounds.is_empty() {
            return;
        }
        near.resize(self.grounds.len(), Near::default());
        feet.clear();
        let places = [&ends.start[..], &ends.position];
        for (ground, near) in self.grounds.iter().zip(&mut *near) {
            ground.look(near, &self.surfaces[ground.body], places, end.interval, feet);
        }
        let count = ends.position.len();
        ends.position.extend(feet.iter().map(|(foot, _)| foot));
        ends.motion.extend(feet.iter().map(|(_, motion)| motion));
        for (Ground { body, number, law, .. }, near) in self.grounds.iter().zip(near) {
            ends.push(&near.touches, *law, [Side::Body(*body), Side::Obstacle(*number)], count as u32, end);
        }
        ends.position.truncate(count);
        ends.motion.truncate(count);
        ends.go_on(end);
    }

    /// Finds which surfaces may meet in a step.
    fn go(&self, known: &mut Known, crew: &Crew) {
        let Known { last, ends, pairs, left, shown, is_near, .. } = known;
        if last.len() != ends.start.len() {
            // Nothing is known.
            pairs.clear();
            shown.clear();
            *left = f64::NEG_INFINITY;
            last.clone_from(&ends.start);
        }
        shown.resize(self.surfaces.len(), Shown::default());
        crew.each(shown, |number, shown| {
            let surface = &self.surfaces[number];
            shown.go(surface, [&*last, &ends.start, &ends.position].map(|all| &all[surface.range()]));
        });
        let longest = |way: fn(&Shown) -> Way| shown.iter().map(|shown| way(shown).length()).fold(0.0, f64::max);
        let [since, ahead] = [longest(|shown| shown.since), longest(|shown| shown.ahead)];
        *left -= 2.0 * since;
        if *left < 4.0 * ahead || left.is_nan() {
            *left = self.choose(&ends.start, ahead, pairs);
        }
        is_near.clear();
        is_near.resize(shown.len(), false);
        pairs.iter().flat_map(|pair| pair.of).for_each(|surface| is_near[surface] = true);
        crew.each(shown, |number, shown| {
            if is_near[number] {
                shown.place(&self.surfaces[number], &ends.start);
            }
        });
    }

    /// Gives all that touches its impulse: first points and facets, then edges, in the order of pairs. What touches depends on the start of the
    /// step alone. Folds of one body press on many others at once, so that surfaces meet themselves twice, the first time before all else.
    fn meet(&self, known: &mut Known, end: &End<'_>, crew: &Crew) {
        /// So many pairs for each thread are looked at before they are resolved.
        const AHEAD: usize = 4;
        let Known { ends, pairs, shown, looks, .. } = known;
        let seen = self.seen(shown, Some(end.interval));
        crew.each(pairs, |_, pair| pair.go(&seen));
        let ahead = if crew.threads() > 1 { AHEAD * crew.threads() } else { 1 };
        looks.resize(ahead, Look::default());
        let mut meet = |kinds: &[Kind], pairs: &mut [Pair]| {
            pairs.iter_mut().zip(&mut *looks).for_each(|(pair, look)| std::mem::swap(&mut pair.look, look));
            crew.each(pairs, |_, pair| pair.look(kinds, &seen));
            for pair in &*pairs {
                let sides = pair.of.map(|surface| self.side(surface));
                let second = self.surfaces[pair.of[1]].range().start as u32;
                ends.push(&pair.look.touches, pair.law, sides, second, end);
            }
            pairs.iter_mut().zip(&mut *looks).for_each(|(pair, look)| std::mem::swap(&mut pair.look, look));
        };
        for kinds in [Kind::POINTS, Kind::EDGES] {
            pairs.iter_mut().filter(|pair| pair.is_own()).for_each(|own| meet(kinds, std::slice::from_mut(own)));
        }
        for kinds in [Kind::POINTS, Kind::EDGES] {
            pairs.chunks_mut(ahead).for_each(|pairs| meet(kinds, pairs));
        }
    }
}

impl Ends {
    /// Gives all that touches of two sides its impulse. The nodes of the second one are numbered from `second` on. A body exerts nothing on
    /// itself.
    pub(super) fn push(&mut self, touches: &Touches, law: Law, of: [Side; 2], second: u32, end: &End<'_>) {
        for (touch, terms) in touches.iter() {
            let Some(impulses) = end.impulses else {
                self.resolve(law, touch, terms);
                continue;
            };
            let Some((sums, impulse)) = self.resolve_and_tell(law, touch, terms, second) else { continue };
            let tell = |from: Source, on: Side, changes: [DVec3; 2]| {
                if let Side::Body(on) = on {
                    impulses.feel_surface(end.interval.end, from, on, changes);
                }
            };
            if of[0] != of[1] {
                tell(of[1].into(), of[0], sums[0]);
                tell(of[0].into(), of[1], sums[1]);
            }
            // What grips give the nodes that they hold against their shares.
            for &Term { node, weight } in terms {
                let Ok(at) = self.held.binary_search_by_key(&(node as usize), |&[node, _]| node) else { continue };
                let against = -impulse * weight;
                let changes = [against, self.place(node).cross(against)];
                tell(Source::Grip(self.held[at][1]), of[usize::from(node >= second)], changes);
            }
        }
    }
}
