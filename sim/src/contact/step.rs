//! Contact of surfaces at the end of a step: which pairs may meet, what touches, and the impulses in a fixed order.

use super::end::End;
use super::features::Kind;
use super::known::Known;
use super::pair::{Look, Pair};
use super::rule::Moved;
use super::shown::{Seen, Shown, Way};
use super::stage::Stage;
use super::{Impulses, Side, Source};
use crate::crew::Crew;
use glam::DVec3;
use std::sync::PoisonError;

impl Stage {
    /// Corrects positions and velocities at the end of a step. `held` are the nodes that grips hold, each with the number of its grip: they
    /// stay as they are.
    pub(crate) fn resolve(&self, mut end: End<'_>, held: impl Iterator<Item = [usize; 2]>, crew: &Crew) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
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
        let mut grounds = self.grounds.lock().unwrap_or_else(PoisonError::into_inner);
        if !grounds.is_empty() {
            grounds.resolve(&self.surfaces, &end, ends);
            ends.go_on(&end);
        }
        self.go(known, crew);
        self.meet(known, &end, crew);
        known.ends.give(&mut end);
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
        crew.each_of(shown, |number, shown| {
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
        crew.each_of(shown, |number, shown| {
            if is_near[number] {
                shown.place(&self.surfaces[number], &ends.start);
            }
        });
    }

    /// Gives all that touches its impulse: first points and facets, then edges, in the order of pairs. What touches depends on the start of the
    /// step alone.
    fn meet(&self, known: &mut Known, end: &End<'_>, crew: &Crew) {
        /// So many pairs for each thread are looked at before they are resolved.
        const AHEAD: usize = 4;
        let Known { ends, pairs, shown, looks, .. } = known;
        let seen = Seen {
            surfaces: &self.surfaces,
            rest: &self.rest,
            start: shown,
            drag: &|surface, at, out| self.drag(surface, end.interval, at, out),
        };
        crew.each(pairs, |pair| pair.go(&seen));
        looks.resize(if crew.threads() > 1 { AHEAD * crew.threads() } else { 1 }, Look::default());
        let (mut nodes, held) = ends.moved(end);
        for kinds in [Kind::POINTS, Kind::EDGES] {
            for pairs in pairs.chunks_mut(looks.len()) {
                pairs.iter_mut().zip(&mut *looks).for_each(|(pair, look)| std::mem::swap(&mut pair.look, look));
                crew.each(pairs, |pair| pair.look(kinds, &seen));
                pairs.iter().for_each(|pair| self.push(pair, &mut nodes, held, end));
                pairs.iter_mut().zip(&mut *looks).for_each(|(pair, look)| std::mem::swap(&mut pair.look, look));
            }
        }
    }

    /// Gives all that touches in a pair its impulse.
    fn push(&self, pair: &Pair, nodes: &mut Moved<'_>, held: &[[usize; 2]], end: &End<'_>) {
        let second = self.first_node(pair.of[1]);
        for (touch, terms) in pair.look.touches.iter() {
            let Some(impulses) = end.impulses else {
                nodes.resolve(pair.law, touch, terms);
                continue;
            };
            let Some((sums, impulse)) = nodes.resolve_and_tell(pair.law, touch, terms, second) else { continue };
            self.tell(impulses, end.interval.end, pair.of, sums);
            for (grip, node, changes) in nodes.holding(held, terms, impulse) {
                let on = pair.of[usize::from(node >= second)];
                impulses.feel_surface(end.interval.end, Source::Grip(grip), on, changes);
            }
        }
    }

    /// Adds what the sides of a pair have got in a step that ends at a time (s). A body exerts nothing on itself.
    fn tell(&self, impulses: &Impulses, time: f64, [one, other]: [usize; 2], [on_one, on_other]: [[DVec3; 2]; 2]) {
        if one != other {
            impulses.feel_surface(time, self.side(other).into(), one, on_one);
        }
        if let (true, Side::Body(body)) = (one != other, self.side(other)) {
            impulses.feel_surface(time, self.side(one).into(), body, on_other);
        }
    }
}
