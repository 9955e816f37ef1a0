//! Bodies made in code.

use crate::scene::file::{
    BarsFile, BodyFile, Cells, Coordinates, DiscFile, Lattice, PolygonFile, Positive, Rotation, SideFile, SpinFile,
    Start, StartShape,
};

/// Makes the body of a scene: its shape at rest, its masses, and how it starts.
///
/// It starts as at rest, is turned by [`Self::rotation`], moved by [`Self::offset`], set down by [`Self::lowest`] and
/// thrown with [`Self::velocity`], in this order. Coordinates are two in the plane and three in space.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct BodyBuilder(pub(super) BodyFile);

impl BodyBuilder {
    /// A body of nodes (m) and elements, the numbers of their nodes counted from 0. In the plane elements are polygons,
    /// counter-clockwise; in space tetrahedra and pyramids (the base counter-clockwise seen from the last node), wedges (two
    /// triangles, both counter-clockwise seen from the second), hexahedra (corners in bit order: x fastest, then y, then z)
    /// or, with any other number of nodes in any order, whatever their convex hull is. Two nodes make a bar.
    pub fn arrays(
        nodes: impl IntoIterator<Item = impl Into<Coordinates>>,
        elements: impl IntoIterator<Item = impl Into<Vec<u32>>>,
    ) -> Self {
        let nodes = Some(nodes.into_iter().map(Into::into).collect());
        let elements = Some(elements.into_iter().map(Into::into).collect());
        Self(BodyFile { nodes, elements, ..BodyFile::default() })
    }

    /// A block of cells.
    pub fn lattice(lattice: Lattice) -> Self {
        Self(BodyFile { lattice: Some(lattice), ..BodyFile::default() })
    }

    /// One regular polygon in the plane as a single element, with its corners at a radius (m). It stands with a side on
    /// y = 0, its middle above the origin.
    pub fn polygon(sides: u32, radius: f64) -> Self {
        Self(BodyFile { polygon: Some(PolygonFile { sides, radius: Positive(radius) }), ..BodyFile::default() })
    }

    /// The same polygon, cut into triangles around a node in its middle.
    pub fn fan(sides: u32, radius: f64) -> Self {
        Self(BodyFile { fan: Some(PolygonFile { sides, radius: Positive(radius) }), ..BodyFile::default() })
    }

    /// A disc in the plane of a radius (m): triangles around its middle, and rings of quadrilaterals around them.
    pub fn disc(radius: f64, rings: u32, sectors: u32) -> Self {
        Self(BodyFile { disc: Some(DiscFile { radius: Positive(radius), rings, sectors }), ..BodyFile::default() })
    }

    /// Two-node elements of a length (m), end to end from the origin on, in a direction of any length but zero.
    pub fn bars(count: u32, length: f64, direction: impl Into<Coordinates>) -> Self {
        let bars = BarsFile { count, length: Positive(length), direction: direction.into() };
        Self(BodyFile { bars: Some(bars), ..BodyFile::default() })
    }

    /// Takes elements in space for the convex hulls of their nodes, listed in any order.
    pub fn convex(mut self) -> Self {
        self.0.convex = true;
        self
    }

    /// Springs by hand, pairs of nodes, for mass-spring models without a named topology. Only with [`Self::arrays`].
    pub fn springs(mut self, springs: impl IntoIterator<Item = [u32; 2]>) -> Self {
        self.0.springs = Some(springs.into_iter().collect());
        self
    }

    /// Faces to draw instead of those of the elements, counter-clockwise from outside. Only with [`Self::arrays`].
    pub fn faces(mut self, faces: impl IntoIterator<Item = impl Into<Vec<u32>>>) -> Self {
        self.0.faces = Some(faces.into_iter().map(Into::into).collect());
        self
    }

    /// Mass of every node (kg), instead of 1.
    pub fn mass(mut self, mass: f64) -> Self {
        self.0.mass = Some(mass);
        self
    }

    /// Mass of each node (kg). Only with [`Self::arrays`].
    pub fn masses(mut self, masses: impl IntoIterator<Item = f64>) -> Self {
        self.0.masses = Some(masses.into_iter().map(Positive).collect());
        self
    }

    /// Initial position of each node (m), instead of that at rest. Only with [`Self::arrays`].
    pub fn positions(mut self, positions: impl IntoIterator<Item = impl Into<Coordinates>>) -> Self {
        self.0.positions = Some(positions.into_iter().map(Into::into).collect());
        self
    }

    /// Initial velocity of each node (m/s). Only with [`Self::arrays`].
    pub fn velocities(mut self, velocities: impl IntoIterator<Item = impl Into<Coordinates>>) -> Self {
        self.0.velocities = Some(velocities.into_iter().map(Into::into).collect());
        self
    }

    /// Starts the body without depth, turned inside out, or at random places.
    pub fn start(mut self, start: Start) -> Self {
        self.0.start = Some(start);
        self
    }

    /// A turn about the mean of the nodes before the start.
    pub fn rotation(mut self, rotation: Rotation) -> Self {
        self.0.rotation = Some(rotation);
        self
    }

    /// A shift after the turn (m).
    pub fn offset(mut self, offset: impl Into<Coordinates>) -> Self {
        self.0.offset = Some(offset.into());
        self
    }

    /// Height at which the lowest node starts, along y (m).
    pub fn lowest(mut self, height: f64) -> Self {
        self.0.lowest = Some(height);
        self
    }

    /// Initial velocity of all nodes (m/s).
    pub fn velocity(mut self, velocity: impl Into<Coordinates>) -> Self {
        self.0.velocity = Some(velocity.into());
        self
    }

    /// A rigid spin about the mean of the nodes: the rotation of one second (rad/s).
    pub fn spin(mut self, rotation: Rotation) -> Self {
        self.0.spin = Some(SpinFile { axis: rotation.axis, rate: rotation.angle });
        self
    }
}

impl Lattice {
    /// So many cells along x, y and z, cubes of a side (m); with two numbers, squares in the plane.
    pub fn new(cells: impl Into<Vec<u32>>, side: f64) -> Self {
        Self { cells: cells.into(), side: SideFile::Equal(side), elements: Cells::Cells, irregular: 0.0, seed: 1 }
    }

    /// Cells of another length along each axis (m).
    pub fn sides(self, sides: impl IntoIterator<Item = f64>) -> Self {
        Self { side: SideFile::PerAxis(sides.into_iter().map(Positive).collect()), ..self }
    }

    /// Cuts the cells, or joins them.
    pub fn elements(self, elements: Cells) -> Self {
        Self { elements, ..self }
    }

    /// Moves nodes at random by up to this part of a cell's shortest side, at most 0.4. No element comes out flat.
    pub fn irregular(self, part: f64) -> Self {
        Self { irregular: part, ..self }
    }

    /// Chooses another of the random blocks.
    pub fn seed(self, seed: u32) -> Self {
        Self { seed, ..self }
    }
}

impl Start {
    /// A start of a shape; lines, planes and mirror images along x, clouds with seed 1.
    pub fn new(shape: StartShape) -> Self {
        Self { shape, direction: None, seed: 1 }
    }

    /// Where the line leads, or where plane and mirror face.
    pub fn direction(self, direction: impl Into<Coordinates>) -> Self {
        Self { direction: Some(direction.into()), ..self }
    }

    /// Chooses another of the clouds.
    pub fn seed(self, seed: u32) -> Self {
        Self { seed, ..self }
    }
}

impl Rotation {
    /// By an angle (rad) about an axis of any length but zero, counter-clockwise when it points at the viewer.
    pub fn about(axis: impl Into<Coordinates>, angle: f64) -> Self {
        Self { axis: Some(axis.into()), angle }
    }

    /// By an angle (rad) in the plane, counter-clockwise.
    pub fn in_plane(angle: f64) -> Self {
        Self { axis: None, angle }
    }
}
