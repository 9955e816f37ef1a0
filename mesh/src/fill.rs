//! Surfaces filled with elements.

mod aligned;
mod allowed;
mod apart;
mod clip;
mod cubes;
mod cuts;
mod draft;
mod embed;
mod ends;
mod facet;
mod graded;
mod lattice;
mod parts;
mod polyhedra;
mod sight;
mod tetrahedra;
mod tighten;
mod union;

use super::{Flaws, Group, Surface};
use allowed::{Allowed, JOINED};
use glam::DVec3;
use localshape_sim::{IndexLists, Weights};

/// Weights below this are round-off.
const CLOSE: f64 = 1e-9;

/// The elements that fill a surface, all of one size (m). Where it ends in flat faces across an axis, tetrahedra and polyhedra are by up to a
/// half shorter along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fill {
    /// Cubes of a lattice that contain a part of the inside.
    Cubes {
        /// Their side.
        side: f64,
    },
    /// Cubes of twice the side away from the surface.
    Graded {
        /// The side of those at the surface.
        side: f64,
    },
    /// Tetrahedra whose faces follow the surface.
    Tetrahedra {
        /// The side of the lattice's cubes.
        side: f64,
    },
    /// Cubes cut at the surface into polyhedra.
    Polyhedra {
        /// The side of the uncut cubes.
        side: f64,
    },
}

impl Fill {
    fn side(self) -> f64 {
        let (Self::Cubes { side } | Self::Graded { side } | Self::Tetrahedra { side } | Self::Polyhedra { side }) =
            self;
        side
    }

    /// Whether elements end at the surface.
    fn is_cut(self) -> bool {
        matches!(self, Self::Tetrahedra { .. } | Self::Polyhedra { .. })
    }

    /// About how many elements a cube of the lattice has.
    fn each(self) -> f64 {
        match self {
            Self::Cubes { .. } | Self::Polyhedra { .. } => 1.0,
            Self::Graded { .. } => 1.0 / JOINED as f64,
            Self::Tetrahedra { .. } => 12.0,
        }
    }
}

/// Elements that contain a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cage {
    /// Position of each node (m).
    pub nodes: Vec<DVec3>,
    /// The nodes of each element.
    pub elements: IndexLists,
    /// The part of each element's volume that is inside the surface, above 0 and at most 1; `None` if all are known to be full.
    pub filled: Option<Vec<f64>>,
    /// Whether elements are the convex hulls of their nodes, in any order.
    pub convex: bool,
    /// For each group of points of the surface, the nodes that carry some of them.
    pub groups: Vec<Group>,
    /// The volume inside that each node carries (m³); `None` if the nodes of an element share equally what is filled of it.
    pub volumes: Option<Vec<f64>>,
    /// The volume that lies in several shells of a closed surface, which cross or lie in each other (m³). It is filled once.
    pub overlap: f64,
    /// Where the body is thinner than elements.
    pub thin: Thin,
}

/// The cubes of a lattice in which a body is thinner than they are: each holds a part of it, and has no neighbour that is full.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thin {
    /// Their number.
    pub cubes: usize,
    /// The number of all cubes with a part of the body, thin or not. Separate parts in one cube count one each.
    pub of: usize,
    /// The sum of what is inside of thin ones: of the mean thickness of the body in each, in sides of elements.
    pub filled: f64,
}

/// A filled surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Filled {
    /// The elements.
    pub cage: Cage,
    /// The surface, mended. Triangles larger than the elements are divided, so that they follow them.
    pub surface: Surface,
    /// How the points of the surface follow the nodes of the cage.
    pub weights: Weights,
    /// What was wrong with the surface.
    pub flaws: Flaws,
}

/// Why a surface was not filled, as the predicate of a sentence about the surface, and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct FillError {
    /// What was found, and what was expected: “has 12 open edges”.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// If too many elements were needed, a side with which few enough are (m); infinite if none is known.
    pub fitting: Option<f64>,
}

impl FillError {
    fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { message: message.into(), help: Some(help.into()), fitting: None }
    }
}

/// Fills a surface, which is mended first, with at most so many elements. Points of the surface that are almost on a plane of
/// the elements' lattice are moved onto it, by some millionths of the side.
///
/// # Errors
/// If the surface has no inside, or more elements would be needed.
pub fn fill(surface: &Surface, fill: Fill, most: usize) -> Result<Filled, FillError> {
    let (mut surface, flaws) = surface.mended();
    if surface.triangles.is_empty() {
        return Err(FillError::new("has no face with an area", "use a file with faces"));
    }
    let (side, is_cut) = (fill.side(), fill.is_cut());
    allowed::check(&surface.measures(), fill, &Allowed::new(std::slice::from_ref(&surface), fill, most))?;
    if is_cut {
        check_joined(&surface, &flaws)?;
    }
    surface.refine(side, most);
    let alone = |surface, corner| match fill {
        Fill::Cubes { .. } => cubes::fill(surface, flaws, side, corner, false, most),
        Fill::Graded { .. } => cubes::fill(surface, flaws, side, corner, true, most),
        Fill::Polyhedra { .. } => {
            aligned::fill(surface, fill, most, |surface, allowed| polyhedra::fill(surface, flaws, side, allowed))
        }
        Fill::Tetrahedra { .. } => {
            aligned::fill(surface, fill, most, |surface, allowed| tetrahedra::fill(surface, flaws, side, allowed))
        }
    };
    let parts = if flaws.pieces > 1 { apart::parts(&surface) } else { Ok((Vec::new(), 1)) };
    let filled = match parts {
        Ok(parts) if parts.1 > 1 => {
            let corner = lattice::Lattice::origin(&surface.measures(), side);
            let part = |part| alone(part, Some(corner)).map(|part| if is_cut { apart::weighed(part) } else { part });
            match apart::fill(surface.clone(), parts, fill, most, part) {
                // A part may have no inside by itself. Cubes tell in each cell what stands apart.
                Err(_) if !is_cut => alone(surface, None),
                filled => filled,
            }
        }
        Err(error) if is_cut => Err(error),
        _ => alone(surface, None),
    };
    filled.map(Filled::with_groups)
}

/// The least and the greatest of numbers.
fn range(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| (low.min(number), high.max(number)))
}

/// Refuses triangles that lie about by themselves, for which elements that end at the surface would be made in vain for a long time. Those
/// that only miss each other's corners by little are a surface.
fn check_joined(surface: &Surface, flaws: &Flaws) -> Result<(), FillError> {
    let triangles = surface.triangles.len();
    if flaws.pieces == 1 || flaws.boundary <= 2 * triangles || surface.closing_weld().is_some() {
        return Ok(());
    }
    let message = format!("is {triangles} triangles in {} pieces that do not join", flaws.pieces);
    Err(FillError::new(message, "join them in the program that made it, or fill it with cubes"))
}

impl Filled {
    fn with_groups(mut self) -> Self {
        let nodes = |&point: &u32| {
            let (nodes, weights) = self.weights.of(point as usize);
            // Points in a face do not follow the nodes beyond it.
            nodes.iter().zip(weights).filter(|(_, weight)| weight.abs() > CLOSE).map(|(&node, _)| node)
        };
        let group = |group: &Group| {
            Group::new(group.name.clone(), group.points.iter().flat_map(nodes).collect(), self.cage.nodes.len())
        };
        self.cage.groups = self.surface.groups.iter().map(group).collect();
        self
    }
}
