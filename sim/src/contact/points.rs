//! Where bodies touch each other and obstacles, for pictures. It depends on positions alone.

use super::ground::Grounds;
use super::pair::Pair;
use super::places::{ContactPoint, Places, SLACK};
use super::shown::{Seen, Shown};
use super::stage::Stage;
use crate::motion::Interval;
use glam::DVec3;
use std::sync::PoisonError;

/// Places of a pair that are nearer than so many times the distance that is kept are one: the fifth part of a usual element.
const SAME: f64 = 8.0;

impl Stage {
    /// Where surfaces touch at a time (s), with positions of all nodes (m), in the order of pairs.
    pub(crate) fn points(&self, position: &[DVec3], time: f64) -> Vec<ContactPoint> {
        let mut obstacles = [const { Vec::new() }; 3];
        self.place_obstacles(Interval { begin: time, end: time, step: 1.0 }, &mut obstacles);
        let places = Places { nodes: position, obstacles: &obstacles[0] };
        let mut shown = vec![Shown::default(); self.surfaces.len()];
        shown.iter_mut().zip(&self.surfaces).for_each(|(shown, surface)| shown.place(surface, &places));
        let rest = Places { nodes: &self.rest, obstacles: &[] };
        let seen = Seen { surfaces: &self.surfaces, rest, start: &shown, drag: &|_, _, _| DVec3::ZERO };
        let mut pairs = Vec::new();
        self.choose(&places, 0.0, &mut pairs);
        let mut found = Vec::new();
        for pair in &mut pairs {
            self.points_of(pair, &seen, &places, &mut found);
        }
        let grounds = self.grounds.lock().unwrap_or_else(PoisonError::into_inner);
        Grounds::points(&grounds, &self.surfaces, position, time, &mut found);
        found
    }

    fn points_of(&self, pair: &mut Pair, seen: &Seen<'_>, places: &Places<'_>, found: &mut Vec<ContactPoint>) {
        let ahead = 0.5 * SLACK * pair.law.gap;
        pair.go(seen, 0.0, ahead);
        pair.look(seen, ahead);
        let ([on, other], second) = (pair.of, self.first_node(pair.of[1]));
        let first = found.len();
        for touch in pair.touches.of_points.iter().chain(&pair.touches.of_edges) {
            let [begin, end] = touch.terms.map(|at| at as usize);
            let terms = &pair.touches.terms[begin..end];
            // Of one surface the nodes of both features are mixed.
            let own = terms.iter().filter(|term| if on == other { term.weight > 0.0 } else { term.node < second });
            let at = own.map(|term| places.node(term.node) * term.weight).sum::<DVec3>();
            let is_new = |point: &ContactPoint| point.at.distance(at) > SAME * pair.law.gap;
            if found[first..].iter().all(is_new) {
                found.push(ContactPoint { from: self.side(other), on, at });
            }
        }
    }
}
