//! The masses of a body's nodes.

use super::table::BodyTable;
use crate::scene::file::LARGEST;
use crate::sim::geometry::node_volumes;
use crate::sim::{Body, Dimension};

/// The mass of each node of a body without masses of its nodes (kg), or `None` after reporting a mistake. Nodes may have parts of the
/// body's volume of their own.
pub(super) fn resolve(table: &BodyTable<'_>, body: &Body, volumes: Option<Vec<f64>>) -> Option<Vec<f64>> {
    let nodes = body.len();
    let volumes = || volumes.unwrap_or_else(|| node_volumes(body));
    let (key, masses) = match (table.file.density, table.file.mass_total) {
        (Some(density), _) => {
            let volumes = volumes();
            if let Some(node) = volumes.iter().position(|&volume| volume <= 0.0) {
                let (measure, per) = match body.dimension() {
                    Dimension::Plane => ("an area", "area"),
                    Dimension::Space => ("a volume", "volume"),
                };
                let found = match volumes.iter().all(|&volume| volume <= 0.0) {
                    true => format!("no element of the body has {measure}"),
                    false => format!("node {node} belongs to no element with {measure}"),
                };
                let here = table.here.to("density");
                let message = format!("`{here}` is a mass per {per}, but {found}");
                here.wrong_key(message, "give `mass_total`, or the `mass` of every node");
                return None;
            }
            ("density", volumes.into_iter().map(|volume| density * volume).collect())
        }
        (None, Some(total)) => {
            let volumes = volumes();
            let all: f64 = volumes.iter().sum();
            let has_volumes = volumes.iter().all(|&volume| volume > 0.0);
            let equal = total / nodes as f64;
            let share = |volume| if has_volumes { total * (volume / all) } else { equal };
            ("mass_total", volumes.into_iter().map(share).collect::<Vec<_>>())
        }
        (None, None) => return Some(vec![table.file.mass.unwrap_or(1.0); nodes]),
    };
    // Masses of nodes that are typed have the same limits.
    if let Some(node) = masses.iter().position(|&mass| !(mass > 0.0 && mass <= LARGEST)) {
        let here = table.here.to(key);
        let message = format!("`{here}` gives node {node} a mass of {:e} kg", masses[node]);
        here.wrong(message, format!("expected more than 0, up to {LARGEST:e} kg"));
        return None;
    }
    Some(masses)
}
