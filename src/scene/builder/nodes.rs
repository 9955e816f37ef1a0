//! Nodes that are held or grabbed, chosen in code.

use crate::reading::captions::typed;
use crate::scene::file::{Coordinates, NodesFile, RegionFile, Side};

/// Some nodes of all bodies, or of one.
#[derive(Clone, Debug)]
pub struct NodeSet {
    pub(super) body: Option<String>,
    pub(super) nodes: NodesFile,
}

impl NodeSet {
    /// A list of nodes, counted from 0. In a scene of several bodies it needs [`Self::of`].
    pub fn list(nodes: impl Into<Vec<u32>>) -> Self {
        Self::new(NodesFile::List(nodes.into()))
    }

    /// The nodes of a side of the rest shape of each body.
    pub fn side(side: Side) -> Self {
        Self::new(NodesFile::Named(typed(&side)))
    }

    /// The nodes that start in a ball with a centre and a radius (m).
    pub fn ball(middle: impl Into<Coordinates>, radius: f64) -> Self {
        let (of, within) = (Some(middle.into()), Some(radius));
        Self::new(NodesFile::Region(RegionFile { of, within, low: None, high: None }))
    }

    /// The nodes that start in an axis-aligned box, with its lowest and highest corner (m).
    pub fn cuboid(low: impl Into<Coordinates>, high: impl Into<Coordinates>) -> Self {
        let (low, high) = (Some(low.into()), Some(high.into()));
        Self::new(NodesFile::Region(RegionFile { of: None, within: None, low, high }))
    }

    /// The nodes among them of the body with a name.
    pub fn of(self, body: impl Into<String>) -> Self {
        Self { body: Some(body.into()), ..self }
    }

    fn new(nodes: NodesFile) -> Self {
        Self { body: None, nodes }
    }
}
