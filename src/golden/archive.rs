//! The exact states in a folder of frames: `states.npz`, whose frames are listed in `diagnostics.csv`.

use super::states::{Positions, State, States};
use crate::output::{DIAGNOSTICS_FILE, STATES_FILE, state_digest};
use crate::scene::npz::Npz;
use crate::sim::diagnostics::{Chosen, Diagnostic, Reach};
use crate::sim::snapshot::Snapshot;
use glam::DVec3;
use serde::Deserialize;
use std::collections::HashMap;
use std::path::Path;

/// The largest archive that is read (bytes): its states are held in memory.
const LARGEST: u64 = 2 << 30;

/// The columns of the diagnostics that are read.
#[derive(Deserialize)]
struct Row {
    run: String,
    frame: u64,
    time: f64,
}

/// The states in a folder; `None` if it has no archive of them.
pub(super) fn read(folder: &Path) -> Result<Option<States>, String> {
    let path = folder.join(STATES_FILE);
    match path.metadata() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(format!("{STATES_FILE} cannot be read: {error}")),
        Ok(found) if found.len() > LARGEST => {
            return Err(format!("{STATES_FILE} has {} GiB; archives of up to 2 GiB are read", found.len() >> 30));
        }
        Ok(_) => {}
    }
    let rows = rows(&folder.join(DIAGNOSTICS_FILE))?;
    let mut archive = Npz::open(&path).map_err(|what| format!("{STATES_FILE} {what}"))?;
    let mut states = States::default();
    let names: Vec<String> =
        archive.names().iter().filter_map(|name| name.strip_suffix(".position").map(str::to_owned)).collect();
    if names.is_empty() {
        return Err(format!("{STATES_FILE} has no positions"));
    }
    for run in names {
        let frames =
            rows.get(&run).ok_or_else(|| format!("{DIAGNOSTICS_FILE} has no run “{run}”, {STATES_FILE} has"))?;
        let mut vectors = |quantity: &str| {
            let name = format!("{run}.{quantity}");
            let told = |what: String| format!("{STATES_FILE}: `{name}` {what}");
            let array = archive.array(&name).ok_or_else(|| told("is missing".to_owned()))?.map_err(told)?;
            let told = |what: String| format!("{STATES_FILE}: `{name}` {what}");
            if array.shape.len() != 3 || array.shape[0] != frames.len() as u64 || array.shape[2] != 3 {
                let (shape, count) = (array.shape_in_words(), frames.len());
                return Err(told(format!("has the shape {shape}; {DIAGNOSTICS_FILE} has {count} frames")));
            }
            // Unpacked, arrays can be far larger than the file.
            if array.bytes().is_none_or(|bytes| bytes > LARGEST) {
                return Err(told("is too large to be read".to_owned()));
            }
            archive.values(&array).map_err(told)
        };
        let [position, velocity] = [vectors("position")?, vectors("velocity")?];
        if position.columns() != velocity.columns() {
            return Err(format!("{STATES_FILE}: “{run}” has not as many velocities as positions"));
        }
        for (at, (row, numbers)) in frames.iter().enumerate() {
            let vectors = |numbers: &crate::scene::npz::Values| -> Vec<DVec3> {
                let vector = |node: usize| DVec3::from_array([0, 1, 2].map(|axis| numbers.double(at, 3 * node + axis)));
                (0..numbers.columns() / 3).map(vector).collect()
            };
            let snapshot =
                Snapshot { position: vectors(&position), velocity: vectors(&velocity), ..Snapshot::default() };
            let digest = state_digest(&snapshot);
            let positions = Positions { quantum: 0.0, every: 1, nodes: snapshot.position.len(), at: snapshot.position };
            let (positions, numbers) = (Some(positions), Some(numbers.clone()));
            states.add(&run, row.frame, State { time: Some(row.time), digest, positions, numbers });
        }
    }
    Ok(Some(states))
}

/// The rows of each run, with the diagnostics.
fn rows(path: &Path) -> Result<HashMap<String, Vec<(Row, Chosen)>>, String> {
    let mut reader = csv::Reader::from_path(path).map_err(|error| {
        format!("{DIAGNOSTICS_FILE}, which lists the frames of {STATES_FILE}, cannot be read: {error}")
    })?;
    let told = |error: csv::Error| format!("{DIAGNOSTICS_FILE}: {error}");
    let heads = reader.headers().map_err(told)?.clone();
    let mut rows: HashMap<String, Vec<(Row, Chosen)>> = HashMap::new();
    for record in reader.records() {
        let record = record.map_err(told)?;
        let row: Row = record.deserialize(Some(&heads)).map_err(told)?;
        let cell = |diagnostic: Diagnostic| record.get(heads.iter().position(|head| head == diagnostic.key())?);
        let numbers = Chosen::read(Reach::Goldens, |_, diagnostic| cell(diagnostic)).ok_or_else(|| {
            let keys: Vec<_> = Diagnostic::within(Reach::Goldens).map(Diagnostic::key).collect();
            let (frame, run) = (row.frame, &row.run);
            format!("{DIAGNOSTICS_FILE}: frame {frame} of “{run}” has no number in one of {}", keys.join(", "))
        })?;
        rows.entry(row.run.clone()).or_default().push((row, numbers));
    }
    Ok(rows)
}
