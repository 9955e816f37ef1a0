//! Obstacles.

use super::{direction, vector};
use crate::scene::file::ObstacleFile;
use crate::scene::report::{Report, Way};
use crate::sim::body::Dimension;
use crate::sim::contact::{Obstacle, Shape};
use glam::DVec3;

/// The obstacles, or `None` after reporting every mistake in them.
pub(super) fn resolve(
    typed: &[Option<ObstacleFile>],
    dimension: Option<Dimension>,
    report: &mut Report<'_>,
) -> Option<Vec<Obstacle>> {
    let mut obstacles = Vec::new();
    for (at, obstacle) in typed.iter().enumerate() {
        let Some(ObstacleFile::Floor(floor)) = obstacle else { continue };
        let path = [Way::Key("obstacle"), Way::Index(at), Way::Key("normal")];
        let normal = match (&floor.normal, dimension) {
            (None, _) => Some(DVec3::Y),
            (Some(typed), Some(dimension)) => {
                vector(typed, dimension, &path, report).and_then(|vector| direction(vector, &path, report))
            }
            (Some(_), None) => None,
        };
        obstacles.extend(normal.map(|normal| Obstacle {
            shape: Shape::Floor { normal, height: floor.height },
            restitution: floor.restitution,
            friction: floor.friction,
        }));
    }
    (obstacles.len() == typed.len()).then_some(obstacles)
}
