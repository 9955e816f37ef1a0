//! A recorded run, and its states between recorded moments.

use super::rows::{Axes, Quantity, Rows};
use crate::reading::words::{several, short};
use crate::sim::{Divergence, Recording, State};
use glam::DVec3;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A moment is shown exactly if it is nearer than this share of the time to the next recorded one.
const AT: f64 = 1e-9;
/// Rows that are kept: those of central differences on both sides of a moment, with velocities or without.
const KEPT: usize = 4;

/// A run of a file.
#[derive(Debug)]
pub struct Recorded {
    /// The file.
    pub(crate) path: PathBuf,
    /// Its name in the file; empty for plain names.
    pub(super) name: String,
    /// The recorded moments (s), rising.
    pub(super) times: Vec<f64>,
    /// The time step of the program that made it (s), if it is known.
    pub(in crate::scene) step: Option<f64>,
    /// The program that made it, in its own words, or the name of the file.
    pub(super) source: String,
    /// The number of nodes.
    pub(crate) nodes: usize,
    /// The number of coordinates of each node.
    pub(in crate::scene) columns: usize,
    /// Whether the third coordinate in the scene, if there is one, is zero everywhere.
    pub(in crate::scene) is_flat: bool,
    pub(super) axes: Axes,
    pub(super) has_velocities: bool,
    /// The length of the memory of models, constraints and contact in each moment, if it is recorded.
    pub(crate) memory: Option<usize>,
    /// Where the run diverged, if it is known. Its last moment is then the last finite state.
    pub(super) divergence: Option<Divergence>,
    /// The drawn state of a run that diverges, if it is known.
    pub(crate) last_fit: Option<State>,
    /// A digest of its moments, words and end, 64 hexadecimal digits.
    pub(in crate::scene) digest: String,
    pub(super) rows: Mutex<Rows>,
    /// The places of the nodes in each row, if some have none.
    pub(super) places: Option<Vec<u32>>,
    /// Why a row could not be read.
    pub(super) fault: Mutex<Option<String>>,
}

impl Recorded {
    /// The number of recorded moments.
    pub fn moments(&self) -> usize {
        self.times.len()
    }

    /// Whether velocities are recorded. Otherwise they are central differences of positions.
    pub fn has_velocities(&self) -> bool {
        self.has_velocities
    }

    /// The program that made it, or the name of the file.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Its source, and its number of states: `MuJoCo 4.0, recorded, 61 states`.
    pub(crate) fn description(&self) -> String {
        format!("{}, recorded, {}", self.source(), several(self.moments(), "state"))
    }

    /// Its states after numbers of steps (s).
    pub(crate) fn player(self: &Arc<Self>, step: f64) -> Player {
        Player { recorded: Arc::clone(self), step, rows: VecDeque::new() }
    }

    /// The recording of some of its nodes only.
    pub(in crate::scene) fn only(self, places: Vec<u32>) -> Self {
        Self { nodes: places.len(), places: Some(places), ..self }
    }

    /// The state at the start.
    pub(in crate::scene) fn start(self: &Arc<Self>) -> State {
        let mut state = State::default();
        self.player(1.0).show(0, &mut state);
        state
    }

    /// Why a row could not be read since it was opened, if one could not. The states shown are then wrong.
    pub(crate) fn fault(&self) -> Option<String> {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The numbers of a quantity in a recorded moment.
    fn row(&self, of: Quantity, moment: usize) -> Result<Vec<f64>, String> {
        let row = self.rows.lock().unwrap_or_else(PoisonError::into_inner).row(of, moment);
        row.map_err(|what| {
            let of = if self.name.is_empty() { String::new() } else { format!(" of “{}”", self.name) };
            format!("the state{of} at {} s {what}", short(self.times[moment]))
        })
    }
}

/// The states of a recording after numbers of steps. Moments between two recorded ones are linear in time.
#[derive(Debug)]
pub(crate) struct Player {
    recorded: Arc<Recorded>,
    /// Time of a step (s).
    step: f64,
    /// The rows read last: their quantities, moments and vectors.
    rows: VecDeque<(Quantity, usize, Arc<[DVec3]>)>,
}

impl Player {
    /// Positions or velocities in a recorded moment.
    fn row(&mut self, of: Quantity, moment: usize) -> Result<Arc<[DVec3]>, String> {
        if let Some((_, _, row)) = self.rows.iter().find(|(known, at, _)| (*known, *at) == (of, moment)) {
            return Ok(Arc::clone(row));
        }
        let numbers = self.recorded.row(of, moment)?;
        let vector = |node: &[f64]| DVec3::new(node[0], node[1], node.get(2).copied().unwrap_or(0.0));
        let all = numbers.chunks_exact(self.recorded.columns);
        let mut row: Vec<DVec3> = match &self.recorded.places {
            None => all.map(vector).collect(),
            Some(places) => {
                let all: Vec<_> = all.collect();
                places.iter().map(|&place| vector(all[place as usize])).collect()
            }
        };
        self.recorded.axes.place(&mut row);
        let row: Arc<[DVec3]> = row.into();
        if self.rows.len() == KEPT {
            self.rows.pop_front();
        }
        self.rows.push_back((of, moment, Arc::clone(&row)));
        Ok(row)
    }

    /// The velocities in a recorded moment: the recorded ones, or central differences of positions. At the first and last
    /// moment, differences on one side. Moments of the same time are one.
    fn velocity(&mut self, moment: usize) -> Result<Vec<DVec3>, String> {
        if self.recorded.has_velocities() {
            return Ok(self.row(Quantity::Velocity, moment)?.to_vec());
        }
        let recorded = Arc::clone(&self.recorded);
        let times = &recorded.times;
        let here = self.row(Quantity::Position, moment)?;
        let mut slope = |other: Option<usize>| -> Result<Option<(f64, Vec<DVec3>)>, String> {
            let Some(other) = other.filter(|&other| other < times.len()) else { return Ok(None) };
            let (there, apart) = (self.row(Quantity::Position, other)?, times[other] - times[moment]);
            Ok(Some((apart.abs(), there.iter().zip(&*here).map(|(&there, &here)| (there - here) / apart).collect())))
        };
        let before = times.partition_point(|&time| time < times[moment]).checked_sub(1);
        let after = times.partition_point(|&time| time <= times[moment]);
        Ok(match (slope(before)?, slope(Some(after))?) {
            // The slope of the parabola through three moments: with equal intervals the mean of both slopes.
            (Some((before, falling)), Some((after, rising))) => {
                let share = before / (before + after);
                falling.iter().zip(&rising).map(|(falling, rising)| falling.lerp(*rising, share)).collect()
            }
            (Some((_, slope)), None) | (None, Some((_, slope))) => slope,
            (None, None) => vec![DVec3::ZERO; here.len()],
        })
    }

    /// Writes positions, velocities, and in a recorded moment the memory, at a time (s).
    fn show_at(&mut self, time: f64, state: &mut State) -> Result<(), String> {
        let (times, last) = (&self.recorded.times, self.recorded.times.len() - 1);
        let before = times.partition_point(|&moment| moment <= time).saturating_sub(1);
        let share = if before == last { 0.0 } else { (time - times[before]) / (times[before + 1] - times[before]) };
        let exact = match share {
            ..=AT => Some(before),
            _ if share >= 1.0 - AT => Some(before + 1),
            _ => None,
        };
        if let Some(moment) = exact {
            state.position = self.row(Quantity::Position, moment)?.to_vec();
            state.velocity = self.velocity(moment)?;
            if self.recorded.memory.is_some() {
                let numbers = self.recorded.row(Quantity::Memory, moment)?;
                state.memory.shown_mut().zip(numbers).for_each(|(to, from)| *to = from);
            }
            return Ok(());
        }
        let between = |one: &[DVec3], other: &[DVec3]| {
            one.iter().zip(other).map(|(one, other)| one.lerp(*other, share)).collect()
        };
        let (from, to) = (self.velocity(before)?, self.velocity(before + 1)?);
        state.velocity = between(&from, &to);
        state.position = between(&self.row(Quantity::Position, before)?, &self.row(Quantity::Position, before + 1)?);
        Ok(())
    }
}

impl Recording for Player {
    fn end(&self) -> Divergence {
        let time = self.recorded.times.last().copied().unwrap_or_default();
        self.recorded.divergence.unwrap_or(Divergence {
            time,
            // A moment shows the nearest step.
            step: ((time / self.step).round() as u64).saturating_add(1),
            part: 0,
            element: None,
            is_end: true,
        })
    }

    fn show(&mut self, steps: u64, state: &mut State) {
        if let Err(what) = self.show_at(steps as f64 * self.step, state) {
            let mut fault = self.recorded.fault.lock().unwrap_or_else(PoisonError::into_inner);
            fault.get_or_insert(what);
        }
    }
}
