//! The work that forces from outside do on nodes, for the balance of energy.
//!
//! It is the sum of `½ (F + F') · ΔP` over the way of the nodes, with the forces at both ends. For methods of higher order it is Simpson's rule,
//! of fourth order, with positions in the middle by Hermite's cubic. Where forces are the same over several steps both are exact, and
//! nothing is added up until they change. So the places where it is added up depend on the load and the step alone.

use super::state::Nodes;
use super::surroundings::Surroundings;
use glam::DVec3;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The work on each part.
#[derive(Debug)]
pub(crate) struct Work {
    /// The nodes with loads, in rising order, and the range of those of each part.
    nodes: Vec<u32>,
    parts: Vec<Range<usize>>,
    /// Whether the method that moves them is of an order above 2.
    is_fine: bool,
    /// The present account, and the one to which steps go back.
    accounts: Mutex<[Account; 2]>,
}

#[derive(Clone, Debug, Default)]
struct Account {
    /// The work until a time (J), of each part.
    sums: Vec<f64>,
    /// The positions of the nodes (m), their velocities (m/s) and the forces on them (N) then.
    position: Vec<DVec3>,
    velocity: Vec<DVec3>,
    force: Vec<DVec3>,
    time: f64,
}

impl Clone for Work {
    fn clone(&self) -> Self {
        let (nodes, parts, accounts) = (self.nodes.clone(), self.parts.clone(), Mutex::new(self.lock().clone()));
        Self { nodes, parts, is_fine: self.is_fine, accounts }
    }
}

impl Work {
    /// With the work so far (J), from a time (s) on. `None` without loads. `is_fine` for methods of an order above 2.
    pub(crate) fn new(
        around: &Surroundings,
        parts: impl Iterator<Item = Range<usize>>,
        is_fine: bool,
        sums: Vec<f64>,
        time: f64,
        at: Nodes<'_>,
    ) -> Option<Self> {
        if around.loads.is_empty() {
            return None;
        }
        let nodes = around.loaded(at.position.len());
        let until = |end: usize| nodes.partition_point(|&node| (node as usize) < end);
        let parts = parts.map(|part| until(part.start)..until(part.end)).collect();
        let work = Self { nodes, parts, is_fine, accounts: Mutex::default() };
        let account = Account { sums, ..work.account(around, time, at) };
        *work.lock() = [account.clone(), account];
        Some(work)
    }

    fn lock(&self) -> MutexGuard<'_, [Account; 2]> {
        self.accounts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The nodes with loads.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Positions, velocities and forces of the nodes.
    fn account(&self, around: &Surroundings, time: f64, at: Nodes<'_>) -> Account {
        let mut forces = vec![DVec3::ZERO; at.position.len()];
        around.push(time, at.position, &mut forces);
        self.of_nodes(time, at, &forces)
    }

    fn of_nodes(&self, time: f64, at: Nodes<'_>, forces: &[DVec3]) -> Account {
        let some = |all: &[DVec3]| self.nodes.iter().map(|&node| all[node as usize]).collect();
        Account {
            sums: Vec::new(),
            position: some(at.position),
            velocity: some(at.velocity),
            force: some(forces),
            time,
        }
    }

    /// The sums with the work since one account, until another.
    fn until(&self, around: &Surroundings, from: &Account, to: &Account, nodes: usize) -> Vec<f64> {
        let way = |at: usize| to.position[at] - from.position[at];
        let halfway = self.is_fine.then(|| self.halfway(around, from, to, nodes));
        let done = |at: usize| match &halfway {
            None => 0.5 * (from.force[at] + to.force[at]).dot(way(at)),
            // Simpson's rule for force times velocity. Hermite's cubic has the velocity `1.5 ΔP/ΔT - (V + V')/4` halfway.
            Some(force) => {
                let [before, after] = [from, to].map(|end| end.velocity[at] * ((to.time - from.time) / 6.0));
                from.force[at].dot(before) + to.force[at].dot(after) + force[at].dot(way(at) - before - after)
            }
        };
        from.sums.iter().zip(&self.parts).map(|(sum, part)| sum + part.clone().map(done).sum::<f64>()).collect()
    }

    /// The forces at the time halfway between two accounts, with nodes where Hermite's cubics between them are then (N).
    fn halfway(&self, around: &Surroundings, from: &Account, to: &Account, nodes: usize) -> Vec<DVec3> {
        let (mut position, eighth) = (vec![DVec3::ZERO; nodes], (to.time - from.time) / 8.0);
        for (at, &node) in self.nodes.iter().enumerate() {
            let bow = (from.velocity[at] - to.velocity[at]) * eighth;
            position[node as usize] = 0.5 * (from.position[at] + to.position[at]) + bow;
        }
        let nodes = Nodes { position: &position, velocity: &position };
        self.account(around, 0.5 * (from.time + to.time), nodes).force
    }

    /// Adds up the work until a time (s), with the forces then (N).
    pub(crate) fn add(&self, around: &Surroundings, time: f64, at: Nodes<'_>, forces: &[DVec3]) {
        let to = self.of_nodes(time, at, forces);
        let [account, _] = &mut *self.lock();
        *account = Account { sums: self.until(around, account, &to, at.position.len()), ..to };
    }

    /// The work until a time (s), of each part (J).
    pub(crate) fn sums(&self, around: &Surroundings, time: f64, at: Nodes<'_>) -> Vec<f64> {
        let [account, _] = &*self.lock();
        self.until(around, account, &self.account(around, time, at), at.position.len())
    }

    /// Keeps the account for [`Self::restore`].
    pub(crate) fn keep(&self) {
        let [account, kept] = &mut *self.lock();
        kept.clone_from(account);
    }

    /// Goes back to the account that was kept.
    pub(crate) fn restore(&self) {
        let [account, kept] = &mut *self.lock();
        account.clone_from(kept);
    }

    /// Writes the account for a state.
    pub(crate) fn store(&self, numbers: &mut Vec<f64>) {
        let [Account { sums, position, velocity, time, .. }, _] = &*self.lock();
        let vectors = position.iter().chain(velocity);
        numbers.clear();
        numbers.extend(sums.iter().copied().chain([*time]).chain(vectors.flat_map(DVec3::to_array)));
    }

    /// Takes the account of a state. Returns whether it is one of these loads.
    pub(crate) fn load(&self, around: &Surroundings, numbers: &[f64], nodes: usize) -> bool {
        let Some((sums, [time, rest @ ..])) = numbers.split_at_checked(self.parts.len()) else { return false };
        let (vectors, []) = rest.as_chunks::<3>() else { return false };
        if vectors.len() != 2 * self.nodes.len() {
            return false;
        }
        let (position, velocity) = vectors.split_at(self.nodes.len());
        let [position, velocity] = [position, velocity].map(|some| {
            let mut all = vec![DVec3::ZERO; nodes];
            self.nodes.iter().zip(some).for_each(|(&node, &vector)| all[node as usize] = DVec3::from_array(vector));
            all
        });
        let at = Nodes { position: &position, velocity: &velocity };
        let account = Account { sums: sums.to_vec(), ..self.account(around, *time, at) };
        *self.lock() = [account.clone(), account];
        true
    }
}
