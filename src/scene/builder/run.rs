//! Runs made in code.

use crate::colour::Colour;
use crate::look::typed::TypedColour;
use crate::scene::file::{ModelFile, RunFile, StepFile};
use crate::scene::step::NamedStep;
use crate::sim::model::{ElasticModel, ModelParameters};
use crate::sim::{Integrator, Kernel};
use std::sync::Arc;

/// Builds a run with more settings than a model: its own bodies, time step, integrator, kernel or colour, or a model of your
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
pub struct RunBuilder(pub(super) RunFile);

impl RunBuilder {
    /// A run with a model.
    pub fn new(model: impl Into<ModelParameters>) -> Self {
        Self::of(ModelFile::Typed(model.into()))
    }

    /// A run with a model for each of its bodies, by name.
    ///
    /// ```
    /// use localshape::scene::{BodyBuilder, Lattice, Limits, RunBuilder, Scene};
    /// use localshape::sim::model::{mass_spring, shape_based};
    ///
    /// let cube = BodyBuilder::lattice(Lattice::new([3, 3, 3], 0.1)).name("cube");
    /// let brick = BodyBuilder::lattice(Lattice::new([6, 3, 3], 0.1)).name("brick").offset([1.0, 0.0, 0.0]);
    /// let shape = shape_based::Parameters::new(1e4);
    /// let models = [("cube", shape.clone().into()), ("brick", mass_spring::Parameters::new(1e4).into())];
    /// let scene = Scene::builder("pair", cube)
    ///     .body(brick)
    ///     .run("Both", RunBuilder::by_body(models))
    ///     .run("Cube alone", RunBuilder::new(shape).bodies(["cube"]))
    ///     .build(&Limits::default())?;
    /// assert_eq!((scene.bodies.len(), scene.runs[0].body().len(), scene.runs[1].body().len()), (2, 64 + 112, 64));
    /// # Ok::<(), localshape::scene::SceneError>(())
    /// ```
    pub fn by_body(models: impl IntoIterator<Item = (impl Into<String>, ModelParameters)>) -> Self {
        let models = models.into_iter().map(|(name, model)| (name.into(), ModelFile::Typed(model)));
        Self(RunFile { models: Some(models.collect()), ..RunFile::default() })
    }

    /// A run with a model of your own. The scene then has no digest.
    pub fn own(model: Arc<dyn ElasticModel>) -> Self {
        Self::of(ModelFile::Own(model))
    }

    fn of(model: ModelFile) -> Self {
        Self(RunFile { model: Some(model), ..RunFile::default() })
    }

    setters! {
        /// The names of the bodies of this run, instead of all.
        bodies(names: impl IntoIterator<Item = impl Into<String>>)
            0.bodies = Some(names.into_iter().map(Into::into).collect());
        /// Time step ΔT of this run (s).
        step(seconds: f64) 0.step = Some(StepFile::Seconds(seconds));
        /// The number of steps of this run in the shortest period T = 2π√(m/k) of all runs.
        steps_per_cycle(steps: f64) 0.step = Some(StepFile::Named(NamedStep::Divided(steps)));
        /// The error allowed in each step of this run, for an integrator that chooses its steps, as a share of the size
        /// of the body.
        tolerance(share: f64) 0.tolerance = Some(share);
        /// The integrator of this run.
        integrator(integrator: Integrator) 0.integrator = Some(integrator);
        /// The code that computes a step of this run, instead of the fastest for its model.
        kernel(kernel: Kernel) 0.kernel = Some(kernel);
        /// The colour of the run's lines. It must differ enough from the background and from turned-over elements.
        colour(colour: Colour) 0.colour = Some(TypedColour(colour));
    }
}

impl<M: Into<ModelParameters>> From<M> for RunBuilder {
    fn from(model: M) -> Self {
        Self::new(model)
    }
}
