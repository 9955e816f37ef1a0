//! Bodies made in code.

use super::NodeSet;
use crate::scene::file::{
    BarsFile, BodyFile, Cells, CellsFile, Coordinates, DiscFile, FillFile, FillKind, Lattice, PolygonFile, Positive,
    Rotation, SideFile, SpinFile, Start, StartShape, Up,
};
use localshape_mesh::Fill;

/// Builds a body of a scene: rest shape, masses and initial state.
///
/// The rest shape is rotated by [`Self::rotation`], moved by [`Self::offset`], set down by [`Self::lowest`] and thrown
/// with [`Self::velocity`], in this order. Coordinates are two in the plane and three in space.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct BodyBuilder(pub(super) BodyFile);

impl BodyBuilder {
    /// A body of nodes (m), and of elements as lists of nodes, counted from 0. In the plane elements are polygons,
    /// counter-clockwise. In space they are tetrahedra and pyramids (the base counter-clockwise seen from the last
    /// node), wedges (both triangles counter-clockwise seen from the second), hexahedra (corners with x fastest, then
    /// y, then z), or the convex hulls of any other number of nodes in any order. Two nodes make a bar.
    pub fn arrays(
        nodes: impl IntoIterator<Item = impl Into<Coordinates>>,
        elements: impl IntoIterator<Item = impl Into<Vec<u32>>>,
    ) -> Self {
        Self(BodyFile { nodes: all(nodes), elements: all(elements), ..BodyFile::default() })
    }

    /// A block of cells.
    pub fn lattice(lattice: Lattice) -> Self {
        Self(BodyFile { lattice: Some(lattice), ..BodyFile::default() })
    }

    /// One regular polygon in the plane as a single element, with its corners at a radius (m). It stands with a side on
    /// y = 0, its centre above the origin.
    pub fn polygon(sides: u32, radius: f64) -> Self {
        Self(BodyFile { polygon: Some(PolygonFile { sides, radius: Positive(radius) }), ..BodyFile::default() })
    }

    /// A regular polygon in the plane, cut into triangles around a node in its centre.
    pub fn fan(sides: u32, radius: f64) -> Self {
        Self(BodyFile { fan: Some(PolygonFile { sides, radius: Positive(radius) }), ..BodyFile::default() })
    }

    /// A disc in the plane with a radius (m): triangles around its centre, and rings of quadrilaterals around the
    /// triangles.
    pub fn disc(radius: f64, rings: u32, sectors: u32) -> Self {
        Self(BodyFile { disc: Some(DiscFile { radius: Positive(radius), rings, sectors }), ..BodyFile::default() })
    }

    /// A chain of two-node elements of a length (m) from the origin, in a direction of any length but zero.
    pub fn bars(count: u32, length: f64, direction: impl Into<Coordinates>) -> Self {
        let bars = BarsFile { count, length: Positive(length), direction: direction.into() };
        Self(BodyFile { bars: Some(bars), ..BodyFile::default() })
    }

    /// A mesh file, by its path from the current directory: cells as they are, or a surface, which is filled with elements and
    /// needs [`Self::density`] or [`Self::mass_total`].
    ///
    /// ```
    /// use localshape::mesh::Fill;
    /// use localshape::scene::{BodyBuilder, Limits, Scene};
    /// use localshape::sim::model::shape_based;
    ///
    /// let hare = BodyBuilder::mesh("scenes/hare.ply").fill(Fill::Cubes { side: 0.1 }).density(300.0).lowest(0.5);
    /// let scene = Scene::builder("hare", hare).run("Local shape", shape_based::Parameters::new(800.0));
    /// let body = &scene.build(&Limits::default())?.bodies[0].body;
    /// assert!(body.elements().len() < 200 && body.carried().is_some());
    /// # Ok::<(), localshape::scene::SceneError>(())
    /// ```
    pub fn mesh(file: impl Into<String>) -> Self {
        Self(BodyFile { mesh: Some(file.into()), ..BodyFile::default() })
    }

    /// Adds a region with a material of its own.
    pub fn region(mut self, region: RegionBuilder) -> Self {
        self.0.region.push(region.0);
        self
    }

    setters! {
        /// The elements that fill the surface of [`Self::mesh`], with sides (m). Without it, 20 cubes along its longest side.
        fill(fill: Fill) 0.fill = Some(FillFile::of(fill));
        /// Length of the unit of a mesh file (m), such as 0.001 for millimetres.
        scale(scale: f64) 0.scale = Some(Positive(scale));
        /// The axis of a mesh file that points up. Scenes have y up.
        up(up: Up) 0.up = Some(up);
        /// The distance within which points of a mesh file become one (m).
        weld(distance: f64) 0.weld = Some(Positive(distance));
        /// The name, which [`RunBuilder::bodies`](super::RunBuilder::bodies) and
        /// [`RunBuilder::by_body`](super::RunBuilder::by_body) use, and result files.
        name(name: impl Into<String>) 0.name = Some(name.into());
        /// Reads elements in space as the convex hulls of their nodes, in any order.
        convex() 0.convex = true;
        /// Lets its surface meet itself, so that it cannot be folded through itself.
        self_contact() 0.self_contact = true;
        /// The distance that its surface keeps from an obstacle, and half of that between two such bodies (m).
        thickness(distance: f64) 0.thickness = Some(distance);
        /// Springs as pairs of nodes, for mass-spring models without a named topology. Only with [`Self::arrays`].
        springs(springs: impl IntoIterator<Item = [u32; 2]>) 0.springs = all(springs);
        /// Faces to draw instead of those of the elements, counter-clockwise from outside. Only with [`Self::arrays`].
        faces(faces: impl IntoIterator<Item = impl Into<Vec<u32>>>) 0.faces = all(faces);
        /// Mass of every node (kg), instead of 1.
        mass(mass: f64) 0.mass = Some(mass);
        /// Density (kg/m³; in the plane kg/m²), instead of a mass of every node: the volume of each element at rest is
        /// shared equally by its nodes.
        density(density: f64) 0.density = Some(density);
        /// Mass of the whole body (kg), instead of a mass of every node. It is shared as by [`Self::density`], or equally
        /// by all nodes if some have no element with a volume.
        mass_total(mass: f64) 0.mass_total = Some(mass);
        /// Mass of each node (kg). Only with [`Self::arrays`].
        masses(masses: impl IntoIterator<Item = f64>) 0.masses = Some(masses.into_iter().map(Positive).collect());
        /// Initial position of each node (m), instead of the rest position. Only with [`Self::arrays`].
        positions(positions: impl IntoIterator<Item = impl Into<Coordinates>>) 0.positions = all(positions);
        /// Initial velocity of each node (m/s). Only with [`Self::arrays`].
        velocities(velocities: impl IntoIterator<Item = impl Into<Coordinates>>) 0.velocities = all(velocities);
        /// A degenerate, inverted or random initial shape.
        start(start: Start) 0.start = Some(start);
        /// A rotation about the mean of the nodes at the start.
        rotation(rotation: Rotation) 0.rotation = Some(rotation);
        /// A translation after the rotation (m).
        offset(offset: impl Into<Coordinates>) 0.offset = Some(offset.into());
        /// Height of the lowest node at the start, along y (m).
        lowest(height: f64) 0.lowest = Some(height);
        /// Initial velocity of all nodes (m/s).
        velocity(velocity: impl Into<Coordinates>) 0.velocity = Some(velocity.into());
        /// A rigid spin about the mean of the nodes: the rotation in one second (rad/s).
        spin(rotation: Rotation) 0.spin = Some(SpinFile { axis: rotation.axis, rate: rotation.angle });
    }
}

/// A region of a body with a material of its own.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct RegionBuilder(CellsFile);

impl RegionBuilder {
    /// A region with a name, of a list of elements, of those whose middle starts in a ball or a box, or of those with a corner on a side.
    pub fn new(name: impl Into<String>, cells: NodeSet) -> Self {
        Self(CellsFile { name: name.into(), cells: cells.nodes, stiffness: None, young: None, density: None })
    }

    setters! {
        /// Its stiffness and its damping relative to those of the model.
        stiffness(factor: f64) 0.stiffness = Some(factor);
        /// Its Young's modulus (Pa; N/m in the plane), if all models of the body have the same.
        young(modulus: f64) 0.young = Some(modulus);
        /// Its density (kg/m³; in the plane kg/m²), if the body has one.
        density(density: f64) 0.density = Some(density);
    }
}

impl FillFile {
    fn of(fill: Fill) -> Self {
        let (with, side) = match fill {
            Fill::Cubes { side } => (FillKind::Cubes, side),
            Fill::Graded { side } => (FillKind::Graded, side),
            Fill::Tetrahedra { side } => (FillKind::Tetrahedra, side),
            Fill::Polyhedra { side } => (FillKind::Polyhedra, side),
        };
        Self { with, side: Some(Positive(side)), cells: None }
    }
}

/// A list of given entries.
fn all<T>(entries: impl IntoIterator<Item = impl Into<T>>) -> Option<Vec<T>> {
    Some(entries.into_iter().map(Into::into).collect())
}

impl Lattice {
    /// A block of cells along x, y and z, cubes of a side (m). Two numbers make squares in the plane.
    pub fn new(cells: impl Into<Vec<u32>>, side: f64) -> Self {
        Self { cells: cells.into(), side: SideFile::Equal(side), elements: Cells::Cells, irregular: 0.0, seed: 1 }
    }

    setters! {
        /// Cells with a length for each axis (m).
        sides(sides: impl IntoIterator<Item = f64>) side = SideFile::PerAxis(sides.into_iter().map(Positive).collect());
        /// The elements of each cell.
        elements(elements: Cells) elements = elements;
        /// Moves nodes at random by up to this part of a cell's shortest side, at most 0.4. No element becomes flat.
        irregular(part: f64) irregular = part;
        /// The seed of random blocks.
        seed(seed: u32) seed = seed;
    }
}

impl Start {
    /// A start of a shape. Lines, planes and mirror images are along x; clouds have seed 1.
    pub fn new(shape: StartShape) -> Self {
        Self { shape, direction: None, seed: 1 }
    }

    setters! {
        /// The direction of the line, or the normal of the plane or mirror.
        direction(direction: impl Into<Coordinates>) direction = Some(direction.into());
        /// The seed of a cloud.
        seed(seed: u32) seed = seed;
    }
}

impl Rotation {
    /// A rotation by an angle (rad) about an axis of any length but zero, counter-clockwise when the axis points at the
    /// viewer.
    pub fn about(axis: impl Into<Coordinates>, angle: f64) -> Self {
        Self { axis: Some(axis.into()), angle }
    }

    /// A rotation by an angle (rad) in the plane, counter-clockwise.
    pub fn in_plane(angle: f64) -> Self {
        Self { axis: None, angle }
    }
}
