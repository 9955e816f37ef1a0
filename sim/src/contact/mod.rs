//! Contact: of nodes with obstacles, as in the paper, and of surfaces with each other.
//!
//! A step ends in this order: each node meets the [`Obstacle`]s, which kernels compute while they move it; grips place their nodes; then
//! surfaces meet ([`Stage`]), by the rule in [`rule`]. Half-spaces are met by nodes, or by the points of a carried surface, all else by
//! surfaces, unless a world has no [`Contacts`].

mod batch;
mod bound;
mod closest;
mod cross;
mod end;
mod extent;
mod features;
mod ground;
mod impulses;
mod inside;
mod known;
mod lanewise;
mod near;
mod obstacle;
mod overlap;
mod pair;
mod points;
#[cfg(test)]
mod queries;
mod rule;
mod separate;
mod shape;
mod shown;
mod sleepers;
mod solid;
mod spread;
mod stage;
mod step;
mod surface;
mod touches;

pub(crate) use bound::Bound;
pub(crate) use end::{End, Timing};
pub(crate) use impulses::{Felt, Impulses};
pub use impulses::{Reaction, Source};
pub use obstacle::ground;
pub use obstacle::{FrictionOf, Obstacle, Placed};
pub use overlap::{Overlap, Surfaces};
pub use points::ContactPoint;
pub use shape::Contact;
pub(crate) use shape::ROUND_OFF;
pub use shape::Shape;
pub(crate) use stage::Stage;

/// How the surfaces of bodies meet each other, obstacles with an extent, and themselves: points with faces, and edges with edges, so that
/// nothing goes through. In a world without it nodes meet obstacles, as in the paper, and nothing else meets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    /// Restitution coefficient `e` between bodies, 0 to 1.
    pub restitution: f64,
    /// Friction coefficient `μ` between bodies, 0 or more.
    pub friction: f64,
    /// What is special of each body; bodies that are missing at the end are as usual.
    pub bodies: Vec<BodyContact>,
    /// Pairs that meet otherwise than usual.
    pub pairs: Vec<PairContact>,
}

/// How the surface of a body meets others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyContact {
    /// The distance (m) that it keeps from an obstacle: half of that between two such bodies. Usual is the fortieth part of the mean
    /// length of its edges.
    pub thickness: Option<f64>,
    /// Whether it meets itself.
    pub itself: bool,
}

/// How two bodies, or a body and an obstacle, meet. What is `None` is as usual: as [`Contacts`] says for bodies, and as the obstacle says
/// for obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// The two, in any order.
    pub of: [Side; 2],
    /// Restitution coefficient `e`, 0 to 1.
    pub restitution: Option<f64>,
    /// Friction coefficient `μ`, 0 or more.
    pub friction: Option<f64>,
    /// The distance (m) that they keep.
    pub thickness: Option<f64>,
}

/// One side of a pair, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// A body.
    Body(usize),
    /// An obstacle.
    Obstacle(usize),
}
