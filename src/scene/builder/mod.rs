//! Scenes made in code. Builders fill in the structs that scene files are read into. So both have the same meaning and
//! limits, and are checked by the same code.

/// Setters: name, arguments, the part, and its value.
macro_rules! setters {
    ($($(#[$doc:meta])* $name:ident($($argument:ident: $type:ty),*) $($part:tt).+ = $value:expr;)*) => {$(
        $(#[$doc])*
        pub fn $name(mut self, $($argument: $type),*) -> Self {
            self.$($part).+ = $value;
            self
        }
    )*};
}

mod body;
mod contact;
mod load;
mod nodes;
mod obstacle;
mod run;

pub use body::{BodyBuilder, RegionBuilder};
pub use contact::{ContactBuilder, PairBuilder};
pub use load::LoadBuilder;
pub use nodes::NodeSet;
pub use obstacle::ObstacleBuilder;
pub use run::RunBuilder;

use super::error::SceneError;
use super::file::{
    Coordinates, EndFile, GrabFile, HoldFile, MassDamping, MotionPath, Positive, ProbeFile, RunFile, SceneFile,
    StartFile, StepFile, TimeFile,
};
use super::resolve::Typed;
use super::schema::SCHEMA_OF_CODE;
use super::step::NamedStep;
use super::{Limits, Scene, structure};
use crate::look::{Plot, Theme};
use crate::reading::collector::Collector;
use crate::sim::{Field, Integrator};
use serde::Serialize;
use serde_json::json;
use std::ops::{Bound, RangeBounds};
use std::path::Path;
use toml::de::DeTable;

/// Builds a [`Scene`] in code; see [`Scene::builder`]. Defaults are those of scene files.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until `build` is called"]
pub struct SceneBuilder {
    file: SceneFile,
    time: TimeFile,
}

impl Scene {
    /// Begins a scene with a name, which is also its title, and a body. By default it lasts a second at 60 frames per
    /// second, without gravity, obstacles and constraints.
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
    /// assert_eq!((scene.bodies[0].body.len(), scene.last_frame()), (64, 60));
    /// # Ok::<(), localshape::scene::SceneError>(())
    /// ```
    ///
    /// All mistakes are found when the scene is built, and named as in a scene file. Wrong values come before wrong references:
    ///
    /// ```
    /// # use localshape::scene::{BodyBuilder, Limits, Scene};
    /// # use localshape::sim::model::shape_based;
    /// let body = BodyBuilder::arrays([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0, 1, 3]]);
    /// let scene = Scene::builder("triangle", body).run("Local shape", shape_based::Parameters::new(-1.0));
    /// let error = scene.build(&Limits::default()).unwrap_err();
    /// assert_eq!(error.mistakes().len(), 2);
    /// let text = error.to_string();
    /// assert!(text.starts_with("triangle: `run[0].model.stiffness` is -1.0; expected a number greater than 0"), "{text}");
    /// assert!(text.contains("`body.elements[0][2]`: there is no node 3; the body has nodes 0 to 2"), "{text}");
    /// ```
    pub fn builder(name: impl Into<String>, body: BodyBuilder) -> SceneBuilder {
        let time = TimeFile { duration: 1.0, frames_per_second: 60.0, ..TimeFile::default() };
        let file = SceneFile { title: Some(name.into()), body: vec![Some(body.0)], ..SceneFile::default() };
        SceneBuilder { file, time }
    }
}

/// The ends of a range of time (s).
fn times(range: &impl RangeBounds<f64>) -> [Option<f64>; 2] {
    [range.start_bound(), range.end_bound()].map(|bound| match bound {
        Bound::Included(&time) | Bound::Excluded(&time) => Some(time),
        Bound::Unbounded => None,
    })
}

impl SceneBuilder {
    setters! {
        /// Acceleration of gravity (m/s²).
        gravity(acceleration: impl Into<Coordinates>) file.gravity = Some(acceleration.into());
        /// Damping in proportion to masses (1/s).
        mass_damping(rate: f64) file.mass_damping = Some(MassDamping::Rate(rate));
        /// Simulated time (s).
        duration(seconds: f64) time.duration = seconds;
        /// Starts each run where its bodies are at rest.
        at_rest() time.start = Some(StartFile::Equilibrium);
        /// Ends at the first frame at which all runs are at rest, if that is before the end.
        until_rest() time.until = Some(EndFile::Rest);
        /// Time step ΔT (s) of runs without a step of their own.
        step(seconds: f64) time.step = Some(StepFile::Seconds(seconds));
        /// The number of steps in the shortest period T = 2π√(m/k) of all runs, 50 by default, for runs without a step
        /// of their own.
        steps_per_cycle(steps: f64) time.step = Some(StepFile::Named(NamedStep::Divided(steps)));
        /// The error allowed in each step of an integrator that chooses its steps, as a share of the size of the body,
        /// for runs without a tolerance of their own.
        tolerance(share: f64) time.tolerance = Some(share);
        /// The integrator of runs without one of their own.
        integrator(integrator: Integrator) time.integrator = integrator;
        /// Frames per second of simulated time (1/s).
        frames_per_second(rate: f64) time.frames_per_second = rate;
        /// Time between rows of `diagnostics.csv` (s), which then has rows between frames.
        every(seconds: f64) time.every = Some(Positive(seconds));
    }

    /// Adds a body. Each of several bodies needs a unique [name](BodyBuilder::name).
    pub fn body(mut self, body: BodyBuilder) -> Self {
        self.file.body.push(Some(body.0));
        self
    }

    /// Adds a run: a model on the bodies, and a panel of the picture. Names are unique. A [`RunBuilder`] gives the run
    /// more settings than its model.
    pub fn run(mut self, name: impl Into<String>, run: impl Into<RunBuilder>) -> Self {
        self.file.run.push(Some(RunFile { name: name.into(), ..run.into().0 }));
        self
    }

    /// Adds an obstacle. Obstacles act in the order in which they are added.
    pub fn obstacle(mut self, obstacle: ObstacleBuilder) -> Self {
        self.file.obstacle.push(Some(obstacle.0));
        self
    }

    /// Says how the surfaces of bodies meet.
    pub fn contact(mut self, contact: ContactBuilder) -> Self {
        self.file.contact = Some(contact.0);
        self
    }

    /// Holds nodes in a range of time (s): `..` for ever, `0.5..2.0` for a while.
    pub fn hold(mut self, nodes: NodeSet, time: impl RangeBounds<f64>) -> Self {
        let [from, until] = times(&time);
        let NodeSet { body, nodes } = nodes;
        self.file.hold.push(Some(HoldFile { body, nodes, from: from.unwrap_or(0.0), until }));
        self
    }

    /// Grabs nodes at the first key of a path, drags them along it, and releases them at the last.
    pub fn grab(mut self, nodes: NodeSet, path: MotionPath) -> Self {
        let NodeSet { body, nodes } = nodes;
        self.file.grab.push(Some(GrabFile { body, nodes, path }));
        self
    }

    /// Adds a load on bodies.
    pub fn load(mut self, load: LoadBuilder) -> Self {
        self.file.load.push(Some(load.0));
        self
    }

    /// Gives nodes a name, and measures their displacement.
    pub fn probe(mut self, name: impl Into<String>, nodes: NodeSet) -> Self {
        let NodeSet { body, nodes } = nodes;
        self.file.probe.push(Some(ProbeFile { name: name.into(), body, nodes }));
        self
    }

    /// Width and height of pictures (px).
    pub fn size(self, size: [u32; 2]) -> Self {
        self.show("size", size)
    }

    /// The colours of pictures.
    pub fn theme(self, theme: Theme) -> Self {
        self.show("theme", theme)
    }

    /// A scalar field that colours the body.
    pub fn colour_by(self, field: Field) -> Self {
        self.show("colour", json!({ "by": field }))
    }

    /// Plots diagnostics over time below all panels, or what is [measured of one thing](crate::look::PlotOf).
    pub fn charts(self, plots: impl IntoIterator<Item = impl Into<Plot>>) -> Self {
        self.show("charts", plots.into_iter().map(Into::into).collect::<Vec<Plot>>())
    }

    /// The direction of the camera: azimuth to the right, and elevation above the horizon (rad).
    pub fn camera(self, azimuth: f64, elevation: f64) -> Self {
        self.show("camera", json!({ "azimuth": azimuth, "elevation": elevation }))
    }

    /// Sets a key of the view.
    fn show(mut self, key: &str, value: impl Serialize) -> Self {
        let value = serde_json::to_value(value).expect("numbers and words");
        self.file.view.insert(key.to_owned(), value);
        self
    }

    /// Checks all settings and resolves the scene. The camera shows the body and objects near it.
    ///
    /// [`Scene::view`] has the other settings of pictures, to be changed before they are composed: title, caption and
    /// labels, the drawn parts of the body, edges, text scale, and every number of the camera.
    ///
    /// ```
    /// # use localshape::scene::{BodyBuilder, Limits, Scene};
    /// # use localshape::sim::model::shape_based;
    /// # let scene = Scene::builder("hexagon", BodyBuilder::polygon(6, 1.0)).run("One", shape_based::Parameters::new(1e4));
    /// let mut scene = scene.build(&Limits::default())?;
    /// scene.view.title = "A hexagon at rest".into();
    /// scene.view.labels.model = false;
    /// scene.view.camera.distance *= 0.8;
    /// scene.view.look.text_scale = 1.5;
    /// # Ok::<(), localshape::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Mistakes`] with all mistakes: each names the setting, its value, the expectation and, if needed,
    /// the remedy.
    pub fn build(self, limits: &Limits) -> Result<Scene, SceneError> {
        let Self { mut file, time } = self;
        file.time = Some(time);
        let name = file.title.clone().unwrap_or_default();
        // The scene file that says the same, without entries of lists and models of the caller's own, which are checked as they are.
        let text = toml::to_string(&file).expect("numbers, texts, and lists and tables of them");
        let root = DeTable::parse(&text).expect("as it was written");
        let report = Collector::of_code(root.get_ref());
        let checked = structure::check(&SCHEMA_OF_CODE, root.get_ref(), &report);
        file.drop_mistakes(&checked);
        let (flawed, is_list, folder) = (&checked.flawed, file.body.len() > 1, Path::new(""));
        let scene = Typed { file: &file, flawed, is_list, folder, limits, report: &report }.resolve(&name);
        scene.filter(|_| report.total() == 0).ok_or_else(|| SceneError::Mistakes(report.finish(&name)))
    }
}
