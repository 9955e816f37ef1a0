//! Scenes made in code. Builders fill in the same description that a scene file is, so that both mean the same, have the same
//! limits, and are checked by the same code.

use super::error::SceneError;
use super::file::{
    BarsFile, BodyFile, BoxFile, CapsuleFile, Cells, Coordinates, DiscFile, FloorFile, GrabFile, HoldFile, KeyFile,
    Lattice, MotionPath, NodesFile, ObstacleFile, PlateFile, PolygonFile, Positive, RegionFile, Rotation, RunFile,
    SceneFile, SideFile, SphereFile, SpinFile, Start, StartShape, StepFile, Swing, TimeFile,
};
use super::resolve::Unwritten;
use super::step::FractionOfCycle;
use super::{Limits, Scene};
use crate::look::file::{ColourFile, ViewFile};
use crate::look::typed::TypedColour;
use crate::look::{Colour, ColourMap, Theme};
use crate::reading::Mistakes;
use crate::sim::diagnostics::Diagnostic;
use crate::sim::field::Field;
use crate::sim::integrate::Integrator;
use crate::sim::model::{ElasticModel, ModelParameters, shape_based};
use crate::sim::motion::Ease;
use crate::sim::world::Kernel;
use std::ops::RangeBounds;
use std::path::Path;
use std::sync::Arc;

/// Makes a [`Scene`] in code; see [`Scene::builder`]. What is not said is as in a scene file that does not say it.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until `build` is called"]
pub struct SceneBuilder(SceneFile);

impl Scene {
    /// Begins a scene of a name, which is also its title, and of a body: a second of it at 60 frames per second, without
    /// gravity, obstacles and grips.
    ///
    /// ```
    /// use localshape::scene::{BodyBuilder, Lattice, Limits, ObstacleBuilder, Rotation, Scene};
    /// use localshape::sim::model::shape_based;
    ///
    /// let body = BodyBuilder::lattice(Lattice::new([3, 3, 3], 0.1)).rotation(Rotation::about([0.0, 0.0, 1.0], 0.3));
    /// let scene = Scene::builder("cubes", body.lowest(0.2))
    ///     .gravity([0.0, -9.8, 0.0])
    ///     .obstacle(ObstacleBuilder::floor(0.0).restitution(0.3))
    ///     .run("Local shape", shape_based::Parameters::new(1e4))
    ///     .build(&Limits::default())?;
    /// assert_eq!((scene.body.len(), scene.last_frame()), (64, 60));
    /// # Ok::<(), localshape::scene::SceneError>(())
    /// ```
    ///
    /// Mistakes are found together when the scene is built, and named as in a scene file:
    ///
    /// ```
    /// # use localshape::scene::{BodyBuilder, Limits, Scene};
    /// # use localshape::sim::model::shape_based;
    /// let body = BodyBuilder::arrays([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0, 1, 3]]);
    /// let scene = Scene::builder("triangle", body).run("Local shape", shape_based::Parameters::new(-1.0));
    /// let error = scene.build(&Limits::default()).unwrap_err();
    /// assert_eq!(error.mistakes().len(), 2);
    /// assert!(error.to_string().starts_with(
    ///     "triangle: `body.elements[0][2]`: there is no node 3; the body has nodes 0 to 2; nodes are counted from 0\n\
    ///      triangle: `run[0].model.stiffness` is -1.0; expected a number greater than 0"
    /// ));
    /// ```
    pub fn builder(name: impl Into<String>, body: BodyBuilder) -> SceneBuilder {
        SceneBuilder(SceneFile {
            title: Some(name.into()),
            gravity: None,
            time: TimeFile {
                duration: 1.0,
                step: StepFile::default(),
                frames_per_second: 60.0,
                integrator: Integrator::default(),
            },
            body: body.0,
            run: Vec::new(),
            obstacle: Vec::new(),
            hold: Vec::new(),
            grab: Vec::new(),
            view: ViewFile::default(),
        })
    }
}

impl SceneBuilder {
    /// Acceleration of gravity (m/s²).
    pub fn gravity(mut self, acceleration: impl Into<Coordinates>) -> Self {
        self.0.gravity = Some(acceleration.into());
        self
    }

    /// Simulated time (s).
    pub fn duration(mut self, seconds: f64) -> Self {
        self.0.time.duration = seconds;
        self
    }

    /// Time step ΔT of all runs that have none of their own (s).
    pub fn step(mut self, seconds: f64) -> Self {
        self.0.time.step = StepFile::Seconds(seconds);
        self
    }

    /// So many steps in the shortest period T = 2π√(m/k) of all runs, instead of 50, for runs without a step of their own.
    pub fn steps_per_cycle(mut self, steps: f64) -> Self {
        self.0.time.step = StepFile::Cycles(FractionOfCycle::Divided(steps));
        self
    }

    /// How positions and velocities move from one step to the next, in all runs that do not say it themselves.
    pub fn integrator(mut self, integrator: Integrator) -> Self {
        self.0.time.integrator = integrator;
        self
    }

    /// Frames per second of simulated time (1/s).
    pub fn frames_per_second(mut self, rate: f64) -> Self {
        self.0.time.frames_per_second = rate;
        self
    }

    /// Adds a run: a model on the body, and a panel of the picture. Each run has a name of its own. It is stepped like the
    /// others, unless a [`RunBuilder`] says more than the model.
    pub fn run(mut self, name: impl Into<String>, run: impl Into<RunBuilder>) -> Self {
        self.0.run.push(RunFile { name: name.into(), ..run.into().0 });
        self
    }

    /// Adds something that the body bounces off. Obstacles act in the order in which they are added.
    pub fn obstacle(mut self, obstacle: ObstacleBuilder) -> Self {
        self.0.obstacle.push(obstacle.0);
        self
    }

    /// Holds nodes where they are, in a range of time (s): `..` from the start for good, `0.5..2.0` for a while.
    pub fn hold(mut self, nodes: NodeSet, time: impl RangeBounds<f64>) -> Self {
        let [from, until] = [time.start_bound(), time.end_bound()].map(|bound| match bound {
            std::ops::Bound::Included(&time) | std::ops::Bound::Excluded(&time) => Some(time),
            std::ops::Bound::Unbounded => None,
        });
        self.0.hold.push(HoldFile { nodes: nodes.0, from: from.unwrap_or(0.0), until });
        self
    }

    /// Grabs nodes at the first time of a path, drags them along it, and lets them go at the last.
    pub fn grab(mut self, nodes: NodeSet, path: MotionPath) -> Self {
        self.0.grab.push(GrabFile { nodes: nodes.0, path });
        self
    }

    /// Width and height of pictures (px).
    pub fn size(mut self, size: [u32; 2]) -> Self {
        self.0.view.size = size;
        self
    }

    /// The colours of pictures.
    pub fn theme(mut self, theme: Theme) -> Self {
        self.0.view.theme = theme;
        self
    }

    /// Colours the body by a field.
    pub fn colour_by(mut self, field: Field) -> Self {
        self.0.view.colour = Some(ColourFile { by: field, range: None, map: ColourMap::default() });
        self
    }

    /// Opacity of elements that are not turned over, from 0.1 to 1.
    pub fn opacity(mut self, opacity: f64) -> Self {
        self.0.view.opacity = opacity;
        self
    }

    /// Draws a diagnostic of all runs over time below the panels.
    pub fn strip(mut self, diagnostic: Diagnostic) -> Self {
        self.0.view.strip = Some(diagnostic);
        self
    }

    /// Turns the camera to the right around the vertical, and raises it above the horizon (rad).
    pub fn camera(mut self, azimuth: f64, elevation: f64) -> Self {
        (self.0.view.camera.azimuth, self.0.view.camera.elevation) = (Some(azimuth), Some(elevation));
        self
    }

    /// Checks all that was said, and gives it its meaning. The camera shows the body and what comes near it.
    ///
    /// # Errors
    /// [`SceneError::Mistakes`] with all mistakes: each says which setting is wrong, what it is, what is expected, and,
    /// if that is not all, what to do.
    pub fn build(self, limits: &Limits) -> Result<Scene, SceneError> {
        let Self(mut file) = self;
        let name = file.title.clone().unwrap_or_default();
        let lists = file.body.nodes.is_some().then(|| file.body.take_lists());
        let models = file.run.iter().map(|run| run.own.clone()).collect();
        let text = toml::to_string(&file).expect("numbers, texts and lists of them can be written");
        let scene = Scene::read(&text, &name, Path::new(""), limits, Unwritten { lists, models });
        match scene {
            Ok(scene) => {
                let warnings = scene.warnings.into_iter().map(|warning| warning.without_text()).collect();
                Ok(Scene { name, warnings, ..scene })
            }
            Err(SceneError::Mistakes(Mistakes { file, found, total })) => {
                let found = found.into_iter().map(|mistake| mistake.without_text()).collect();
                Err(SceneError::Mistakes(Mistakes { file, found, total }))
            }
            Err(other) => Err(other),
        }
    }
}

/// Makes a run of a scene that has more than a model: its own time step, integrator, kernel or colour, or a model of your
/// own.
///
/// ```
/// use localshape::scene::{BodyBuilder, Limits, RunBuilder, Scene};
/// use localshape::sim::Integrator;
/// use localshape::sim::model::shape_based;
///
/// let model = shape_based::Parameters::new(1e4);
/// let fine = RunBuilder::new(model.clone()).steps_per_cycle(200.0).integrator(Integrator::VelocityVerlet);
/// let scene = Scene::builder("hexagon", BodyBuilder::polygon(6, 1.0)).run("Coarse", model).run("Fine", fine);
/// let runs = scene.build(&Limits::default())?.runs;
/// assert_eq!(runs[0].step, 4.0 * runs[1].step);
/// # Ok::<(), localshape::scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct RunBuilder(RunFile);

impl RunBuilder {
    /// A run of a model.
    pub fn new(model: impl Into<ModelParameters>) -> Self {
        let (name, model) = (String::new(), model.into());
        Self(RunFile { name, model, step: None, integrator: None, kernel: None, colour: None, own: None })
    }

    /// A run of a model of your own. The scene then has no digest.
    pub fn own(model: Arc<dyn ElasticModel>) -> Self {
        // Its stiffness is checked like that of any other.
        let Self(run) = Self::new(shape_based::Parameters::new(model.stiffness()));
        Self(RunFile { own: Some(model), ..run })
    }

    /// Time step ΔT of this run (s).
    pub fn step(mut self, seconds: f64) -> Self {
        self.0.step = Some(StepFile::Seconds(seconds));
        self
    }

    /// So many steps of this run in the shortest period T = 2π√(m/k) of all runs.
    pub fn steps_per_cycle(mut self, steps: f64) -> Self {
        self.0.step = Some(StepFile::Cycles(FractionOfCycle::Divided(steps)));
        self
    }

    /// How positions and velocities of this run move from one step to the next.
    pub fn integrator(mut self, integrator: Integrator) -> Self {
        self.0.integrator = Some(integrator);
        self
    }

    /// How a step of this run is computed, instead of in the fastest way that its model has.
    pub fn kernel(mut self, kernel: Kernel) -> Self {
        self.0.kernel = Some(kernel);
        self
    }

    /// The colour of its lines. It must stand out from the background and from elements that are turned over.
    pub fn colour(mut self, colour: Colour) -> Self {
        self.0.colour = Some(TypedColour(colour));
        self
    }
}

impl<M: Into<ModelParameters>> From<M> for RunBuilder {
    fn from(model: M) -> Self {
        Self::new(model)
    }
}

/// Makes the body of a scene: its shape at rest, its masses, and how it starts.
///
/// It starts as at rest, is turned by [`Self::rotation`], moved by [`Self::offset`], set down by [`Self::lowest`] and
/// thrown with [`Self::velocity`], in this order. Coordinates are two in the plane and three in space.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct BodyBuilder(BodyFile);

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

/// Makes something rigid that nodes bounce off. It stays where it is unless a path or a swing moves it.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct ObstacleBuilder(ObstacleFile);

impl ObstacleBuilder {
    /// A level floor at a height (m).
    pub fn floor(height: f64) -> Self {
        Self(FloorFile::new(None, height))
    }

    /// A floor or wall at a distance from the origin (m) along a direction out of it.
    pub fn wall(normal: impl Into<Coordinates>, distance: f64) -> Self {
        Self(FloorFile::new(Some(normal.into()), distance))
    }

    /// A half-space that is drawn as a plate around a point of its surface (m), with a direction out of it.
    pub fn plate(point: impl Into<Coordinates>, normal: impl Into<Coordinates>) -> Self {
        Self(PlateFile::new(point.into(), normal.into()))
    }

    /// A ball, in the plane a disc, with its centre and radius (m).
    pub fn sphere(centre: impl Into<Coordinates>, radius: f64) -> Self {
        Self(SphereFile::new(centre.into(), radius))
    }

    /// A rod with round ends, with the middles of these and its radius (m).
    pub fn capsule(from: impl Into<Coordinates>, to: impl Into<Coordinates>, radius: f64) -> Self {
        Self(CapsuleFile::new(from.into(), to.into(), radius))
    }

    /// A cuboid along the axes, in the plane a rectangle, with its centre and sides (m).
    pub fn cuboid(centre: impl Into<Coordinates>, size: impl Into<Coordinates>) -> Self {
        Self(BoxFile::new(centre.into(), size.into(), None))
    }

    /// A turned cuboid.
    pub fn turned_cuboid(centre: impl Into<Coordinates>, size: impl Into<Coordinates>, rotation: Rotation) -> Self {
        Self(BoxFile::new(centre.into(), size.into(), Some(rotation)))
    }

    /// Restitution coefficient e, 0 to 1: the part of the normal velocity that a rebound gives back.
    pub fn restitution(mut self, coefficient: f64) -> Self {
        *self.0.common_mut().restitution = coefficient;
        self
    }

    /// Friction coefficient μ.
    pub fn friction(mut self, coefficient: f64) -> Self {
        *self.0.common_mut().friction = coefficient;
        self
    }

    /// The point about which it turns when it moves (m), instead of its middle.
    pub fn about(mut self, point: impl Into<Coordinates>) -> Self {
        *self.0.common_mut().about = Some(point.into());
        self
    }

    /// Moves it along a path, and not by a swing.
    pub fn path(mut self, path: MotionPath) -> Self {
        *self.0.common_mut().path = Some(path);
        self
    }

    /// Moves it to and fro, and not along a path.
    pub fn swing(mut self, swing: Swing) -> Self {
        *self.0.common_mut().swing = Some(swing);
        self
    }
}

impl MotionPath {
    /// A path without keys, which needs some.
    #[expect(clippy::new_without_default, reason = "no path is meant to have no keys")]
    pub fn new() -> Self {
        Self { keys: Vec::new(), ease: Ease::default(), repeat: false }
    }

    /// Adds a time (s), later than those before, at which it is shifted (m) from where it stands without a path.
    pub fn key(mut self, time: f64, shift: impl Into<Coordinates>) -> Self {
        self.keys.push(KeyFile { time, shift: Some(shift.into()), rotation: None });
        self
    }

    /// Adds a time (s) at which it is shifted (m) and turned.
    pub fn turned_key(mut self, time: f64, shift: impl Into<Coordinates>, rotation: Rotation) -> Self {
        self.keys.push(KeyFile { time, shift: Some(shift.into()), rotation: Some(rotation) });
        self
    }

    /// How it runs between two keys.
    pub fn ease(self, ease: Ease) -> Self {
        Self { ease, ..self }
    }

    /// Begins again at the last key, which must be where the first one is.
    pub fn repeating(self) -> Self {
        Self { repeat: true, ..self }
    }
}

impl Swing {
    /// A swing of a period (s), which needs a shift or a rotation.
    pub fn new(period: f64) -> Self {
        Self { period, phase: 0.0, shift: None, rotation: None }
    }

    /// Where in the swing it is at the start (rad).
    pub fn phase(self, phase: f64) -> Self {
        Self { phase, ..self }
    }

    /// The farthest shift (m).
    pub fn shift(self, shift: impl Into<Coordinates>) -> Self {
        Self { shift: Some(shift.into()), ..self }
    }

    /// The farthest turn.
    pub fn rotation(self, rotation: Rotation) -> Self {
        Self { rotation: Some(rotation), ..self }
    }
}

/// Some nodes of a body, as they start.
#[derive(Clone, Debug)]
pub struct NodeSet(NodesFile);

impl NodeSet {
    /// A list of nodes, counted from 0.
    pub fn list(nodes: impl Into<Vec<u32>>) -> Self {
        Self(NodesFile::List(nodes.into()))
    }

    /// Those in a ball with a middle and a radius (m).
    pub fn ball(middle: impl Into<Coordinates>, radius: f64) -> Self {
        let (of, within) = (Some(middle.into()), Some(radius));
        Self(NodesFile::Region(RegionFile { of, within, low: None, high: None }))
    }

    /// Those in a box along the axes, with its lowest and highest corner (m).
    pub fn cuboid(low: impl Into<Coordinates>, high: impl Into<Coordinates>) -> Self {
        let (low, high) = (Some(low.into()), Some(high.into()));
        Self(NodesFile::Region(RegionFile { of: None, within: None, low, high }))
    }
}
