//! The work that forces from outside do on nodes, for the balance of energy.
//!
//! It is the sum of `½ (F + F\') · ΔP` over the way of the nodes, with the forces at both ends. Where forces are the same over several steps
//! the sum is exact, and nothing is added up until they change. So the places where it is added up depend on the load and the step alone.

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
    /// The present account, and the one to which steps go back.
    accounts: Mutex<[Account; 2]>,
}

#[derive(Clone, Debug, Default)]
struct Account {
    /// The work until a time (J), of each part.
    sums: Vec<f64>,
    /// The positions of the nodes (m) and the forces on them (N) then.
    position: Vec<DVec3>,
    force: Vec<DVec3>,
    time: f64,
}

impl Clone for Work {
    fn clone(&self) -> Self {
        Self { nodes: self.nodes.clone(), parts: self.parts.clone(), accounts: Mutex::new(self.lock().clone()) }
    }
}

impl Work {
    /// With the work so far (J), from a time (s) and positions (m) on. `None` without loads.
    pub(crate) fn new(
        around: &Surroundings,
        parts: impl Iterator<Item = Range<usize>>,
        sums: Vec<f64>,
        time: f64,
        position: &[DVec3],
    ) -> Option<Self> {
        if around.loads.is_empty() {
            return None;
        }
        let nodes = around.loaded(position.len());
        let until = |end: usize| nodes.partition_point(|&node| (node as usize) < end);
        let parts = parts.map(|part| until(part.start)..until(part.end)).collect();
        let work = Self { nodes, parts, accounts: Mutex::default() };
        let account = Account { sums, time, ..work.account(around, time, position) };
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

    /// Positions and forces of the nodes.
    fn account(&self, around: &Surroundings, time: f64, position: &[DVec3]) -> Account {
        let mut forces = vec![DVec3::ZERO; position.len()];
        around.push(time, position, &mut forces);
        self.of_nodes(time, position, &forces)
    }

    fn of_nodes(&self, time: f64, position: &[DVec3], forces: &[DVec3]) -> Account {
        let some = |all: &[DVec3]| self.nodes.iter().map(|&node| all[node as usize]).collect();
        Account { sums: Vec::new(), position: some(position), force: some(forces), time }
    }

    /// The sums with the work since the account, until nodes are at other positions (m) with other forces (N).
    fn until(&self, from: &Account, to: &Account) -> Vec<f64> {
        let done = |at: usize| 0.5 * (from.force[at] + to.force[at]).dot(to.position[at] - from.position[at]);
        from.sums.iter().zip(&self.parts).map(|(sum, part)| sum + part.clone().map(done).sum::<f64>()).collect()
    }

    /// Adds up the work until a time (s) at which nodes are at other positions (m) with other forces (N).
    pub(crate) fn add(&self, time: f64, position: &[DVec3], forces: &[DVec3]) {
        let to = self.of_nodes(time, position, forces);
        let [account, _] = &mut *self.lock();
        *account = Account { sums: self.until(account, &to), ..to };
    }

    /// The work until a time (s) at which nodes are at some positions (m), of each part (J).
    pub(crate) fn sums(&self, around: &Surroundings, time: f64, position: &[DVec3]) -> Vec<f64> {
        let [account, _] = &*self.lock();
        self.until(account, &self.account(around, time, position))
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
        let [Account { sums, position, time, .. }, _] = &*self.lock();
        numbers.clear();
        numbers.extend(sums.iter().copied().chain([*time]).chain(position.iter().flat_map(DVec3::to_array)));
    }

    /// Takes the account of a state. Returns whether it is one of these loads.
    pub(crate) fn load(&self, around: &Surroundings, numbers: &[f64], nodes: usize) -> bool {
        let Some((sums, [time, rest @ ..])) = numbers.split_at_checked(self.parts.len()) else { return false };
        let (vectors, []) = rest.as_chunks::<3>() else { return false };
        if vectors.len() != self.nodes.len() {
            return false;
        }
        let mut position = vec![DVec3::ZERO; nodes];
        self.nodes.iter().zip(vectors).for_each(|(&node, &at)| position[node as usize] = DVec3::from_array(at));
        let account = Account { sums: sums.to_vec(), ..self.account(around, *time, &position) };
        *self.lock() = [account.clone(), account];
        true
    }
}
