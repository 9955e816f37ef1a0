//! Generated bodies: lattices, polygons, discs and chains of bars.
//!
//! Sizes are computed first, to be validated before the body is made. The input has been checked.

mod block;
mod irregular;
mod lattice;
mod mixed;
pub(crate) mod random;
mod shapes;
mod start;

pub(super) use start::brought_to_start;

use super::file::BodyFile;
use super::file::{BarsFile, Cells, DiscFile, Lattice, PolygonFile, SideFile};
use super::limits::BodySize;
use crate::sim::{Dimension, IndexLists};
use glam::DVec3;

/// A generated body.
#[derive(Clone, Copy, Debug)]
pub(super) enum Generator<'a> {
    /// A block of cells.
    Lattice(&'a Lattice),
    /// One regular polygon.
    Polygon(&'a PolygonFile),
    /// Triangles around a middle node.
    Fan(&'a PolygonFile),
    /// Rings of quadrilaterals around a fan.
    Disc(&'a DiscFile),
    /// Two-node elements end to end.
    Bars(&'a BarsFile),
}

/// The nodes (m) and elements of a body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Made {
    pub(super) nodes: Vec<DVec3>,
    pub(super) elements: IndexLists,
}

impl<'a> Generator<'a> {
    /// The first generator in a scene.
    pub(super) fn of(file: &'a BodyFile) -> Option<Self> {
        let lattice = file.lattice.as_ref().map(Self::Lattice);
        let polygon = || file.polygon.as_ref().map(Self::Polygon);
        let fan = || file.fan.as_ref().map(Self::Fan);
        let disc = || file.disc.as_ref().map(Self::Disc);
        let bars = || file.bars.as_ref().map(Self::Bars);
        lattice.or_else(polygon).or_else(fan).or_else(disc).or_else(bars)
    }

    /// In the plane or in space.
    pub(super) fn dimension(self) -> Dimension {
        let coordinates = match self {
            Self::Lattice(typed) => typed.cells.len(),
            Self::Polygon(_) | Self::Fan(_) | Self::Disc(_) => 2,
            Self::Bars(typed) => typed.direction.0.len(),
        };
        if coordinates == 2 { Dimension::Plane } else { Dimension::Space }
    }

    /// The largest size of the body.
    pub(super) fn size(self) -> BodySize {
        match self {
            Self::Lattice(typed) => lattice::size(typed),
            Self::Polygon(typed) => BodySize::new(typed.sides.into(), [(typed.sides as usize, 1)]),
            Self::Fan(typed) => shapes::disc_size(1, typed.sides),
            Self::Disc(typed) => shapes::disc_size(typed.rings, typed.sectors),
            Self::Bars(typed) => BodySize::new(u128::from(typed.count) + 1, [(2, typed.count.into())]),
        }
    }

    /// The body. `direction` is the unit direction of bars.
    pub(super) fn make(self, direction: DVec3) -> Made {
        match self {
            Self::Lattice(typed) => lattice::make(typed),
            Self::Polygon(typed) => shapes::polygon(typed),
            Self::Fan(typed) => shapes::disc(typed.radius.0, 1, typed.sides),
            Self::Disc(typed) => shapes::disc(typed.radius.0, typed.rings, typed.sectors),
            Self::Bars(typed) => shapes::bars(typed, direction),
        }
    }

    /// The length of all edges (m), if the scene has it.
    pub(super) fn side(self) -> Option<f64> {
        match self {
            Self::Lattice(Lattice { side: SideFile::Equal(side), elements: Cells::Cells, .. }) => Some(*side),
            _ => None,
        }
    }
}
