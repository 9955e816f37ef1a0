//! Loads in code.

use super::NodeSet;
use crate::scene::file::{AxialFile, Coordinates, LoadFile, NodesFile, Positive};
use std::ops::RangeBounds;

/// A load on bodies: a force, a traction, a pressure, an acceleration, a torque or a centrifugal force.
#[derive(Clone, Debug)]
pub struct LoadBuilder(pub(super) LoadFile);

impl LoadBuilder {
    /// A force of constant direction on each body (N), which nodes share equally.
    pub fn force(nodes: NodeSet, force: impl Into<Coordinates>) -> Self {
        Self(LoadFile { force: Some(force.into()), ..on_nodes(nodes) })
    }

    /// A force of constant direction on each body (N), which the faces with all corners among some nodes share by their areas at rest.
    pub fn force_on_faces(corners: NodeSet, force: impl Into<Coordinates>) -> Self {
        Self(LoadFile { force: Some(force.into()), ..on_faces(corners) })
    }

    /// A force of constant direction on each area at rest (Pa) of the faces with all corners among some nodes.
    pub fn traction(corners: NodeSet, traction: impl Into<Coordinates>) -> Self {
        Self(LoadFile { traction: Some(traction.into()), ..on_faces(corners) })
    }

    /// A pressure towards the body (Pa) on the faces with all corners among some nodes, as they are now.
    pub fn pressure(corners: NodeSet, pressure: f64) -> Self {
        Self(LoadFile { pressure: Some(pressure), ..on_faces(corners) })
    }

    /// An acceleration of the masses of nodes (m/s²).
    pub fn acceleration(nodes: NodeSet, acceleration: impl Into<Coordinates>) -> Self {
        Self(LoadFile { acceleration: Some(acceleration.into()), ..on_nodes(nodes) })
    }

    /// A torque about the centre of nodes (N m), in space.
    pub fn torque(nodes: NodeSet, torque: impl Into<Coordinates>) -> Self {
        Self(LoadFile { torque: Some(AxialFile::Vector(torque.into())), ..on_nodes(nodes) })
    }

    /// A torque about the centre of nodes (N m), counter-clockwise in the plane.
    pub fn torque_in_the_plane(nodes: NodeSet, torque: f64) -> Self {
        Self(LoadFile { torque: Some(AxialFile::Number(torque)), ..on_nodes(nodes) })
    }

    /// The centrifugal force on the masses of nodes in a frame that turns at a rate (rad/s) about an axis through a point (m), in space.
    pub fn centrifugal(nodes: NodeSet, rate: impl Into<Coordinates>, about: impl Into<Coordinates>) -> Self {
        let (centrifugal, about) = (Some(AxialFile::Vector(rate.into())), Some(about.into()));
        Self(LoadFile { centrifugal, about, ..on_nodes(nodes) })
    }

    /// When it acts (s): `..` for ever, `0.5..2.0` for a while.
    pub fn during(mut self, time: impl RangeBounds<f64>) -> Self {
        let [from, until] = super::times(&time);
        (self.0.from, self.0.until) = (from.unwrap_or(0.0), until);
        self
    }

    /// The time in which it rises from nothing (s).
    pub fn ramp(mut self, seconds: f64) -> Self {
        self.0.ramp = Some(Positive(seconds));
        self
    }
}

fn on_nodes(NodeSet { body, nodes }: NodeSet) -> LoadFile {
    LoadFile { body, nodes: Some(nodes), ..LoadFile::default() }
}

fn on_faces(NodeSet { body, nodes }: NodeSet) -> LoadFile {
    LoadFile { body, faces: Some(nodes), ..LoadFile::default() }
}

impl NodeSet {
    /// All nodes, for loads.
    pub fn all() -> Self {
        Self { body: None, nodes: NodesFile::Named("all".to_owned()) }
    }
}
