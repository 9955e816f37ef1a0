//! The masses of a body's nodes.

use super::Place;
use crate::reading::collector::{Collector, key_path, written};
use crate::scene::file::{BodyFile, LARGEST};
use crate::sim::geometry::volumes_at_rest;
use crate::sim::{Body, Dimension};

/// The mass of each node of a body without masses of its nodes (kg), or `None` after reporting a mistake. Nodes may have parts of the
/// body's volume of their own.
pub(super) fn resolve(
    file: &BodyFile,
    body: &Body,
    volumes: Option<Vec<f64>>,
    place: &Place,
    report: &mut Collector<'_>,
) -> Option<Vec<f64>> {
    let nodes = body.len();
    let volumes = || volumes.unwrap_or_else(|| shares(body));
    let (key, masses) = match (file.density, file.mass_total) {
        (Some(density), _) => {
            let volumes = volumes();
            if let Some(node) = volumes.iter().position(|&volume| volume <= 0.0) {
                let (measure, per) = match body.dimension {
                    Dimension::Plane => ("an area", "area"),
                    Dimension::Space => ("a volume", "volume"),
                };
                let found = match volumes.iter().all(|&volume| volume <= 0.0) {
                    true => format!("no element of the body has {measure}"),
                    false => format!("node {node} belongs to no element with {measure}"),
                };
                let path = key_path![place; "density"];
                let message = format!("`{}` is a mass per {per}, but {found}", written(&path));
                report.at_key(&path, message, "give `mass_total`, or the `mass` of every node");
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
        (None, None) => return Some(vec![file.mass.unwrap_or(1.0); nodes]),
    };
    // Masses of nodes that are typed have the same limits.
    if let Some(node) = masses.iter().position(|&mass| !(mass > 0.0 && mass <= LARGEST)) {
        let path = key_path![place; key];
        let message = format!("`{}` gives node {node} a mass of {:e} kg", written(&path), masses[node]);
        report.at(&path, message, format!("expected more than 0, up to {LARGEST:e} kg"));
        return None;
    }
    Some(masses)
}

/// The part of the body's volume at rest (m³, in the plane m²) of each node: what is filled of each element is shared equally by its
/// nodes.
fn shares(body: &Body) -> Vec<f64> {
    let mut shares = vec![0.0; body.len()];
    for (element, (nodes, volume)) in body.elements.iter().zip(volumes_at_rest(body)).enumerate() {
        let filled = body.fill.as_ref().map_or(1.0, |fill| fill[element]);
        let share = volume * filled / nodes.len() as f64;
        nodes.iter().for_each(|&node| shares[node as usize] += share);
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Solids;
    use glam::DVec3;

    #[test]
    fn what_is_filled_of_an_element_is_shared_by_its_nodes() {
        let rest = (0..6).map(|at| DVec3::new(f64::from(at / 2), f64::from(at % 2), 0.0)).collect();
        let elements = [&[0, 2, 3, 1][..], &[2, 4, 5, 3]].into_iter().collect();
        let body = Body::new(Dimension::Plane, rest, vec![1.0; 6], elements, Solids::Ordered, None);
        let body = Body { fill: Some(vec![1.0, 0.5]), ..body };
        assert_eq!(shares(&body), [0.25, 0.25, 0.375, 0.375, 0.125, 0.125]);
    }
}
