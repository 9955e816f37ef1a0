//! Scenes that were simulated elsewhere, compared with their goldens: for tests in other languages.

use super::comparison::Comparison;
use super::device::TestDevice;
use super::drawing::{Drawing, PICTURES, size};
use super::folder::{Drawn, Golden};
use super::said;
use crate::picture::Composer;
use crate::render::RenderError;
use crate::runner::{Frame, History};
use crate::scene::{Scene, SceneKeys, Setting};
use std::path::Path;

/// A scene that was simulated.
pub struct Simulated<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its keys, if they are in memory and not in its file.
    pub keys: Option<&'a SceneKeys>,
    /// What was set in place of values of its file.
    pub settings: &'a [Setting],
    /// What pictures show of the course.
    pub course: &'a History,
    /// A frame by its number, with the states of the simulated runs, or why there is none.
    pub frame: &'a dyn Fn(u64) -> Result<Frame, String>,
}

/// What messages say of a test.
pub struct Told {
    /// Its name: the title of the page.
    pub title: String,
    /// The command that makes or renews the golden.
    pub command: String,
}

/// A scene beside its golden.
pub struct Outcome {
    golden: Golden,
    drawn: Drawn,
    comparison: Comparison,
}

impl Simulated<'_> {
    /// Draws the frames of the golden in a folder, and compares them with it. One that is to be accepted may be damaged.
    ///
    /// # Errors
    /// The golden cannot be read, or nothing can be drawn.
    pub fn compare(
        &self,
        folder: &Path,
        told: Told,
        device: &mut TestDevice,
        accepts: bool,
    ) -> Result<Outcome, String> {
        let golden = Golden::read(folder, accepts).map_err(|error| error.to_string())?;
        let gpu = if self.scene.is_lit() { device.of(&golden)? } else { None };
        let mut scene = self.scene.clone();
        scene.view.size = size(scene.view.size, &golden);
        let failed = |error: RenderError| error.to_string();
        let mut drawing = Drawing::new(&scene, &golden, PICTURES, gpu).map_err(failed)?;
        let mut composer = None;
        for frame in drawing.frames() {
            let frame = (self.frame)(frame)?;
            let compose = || composer.get_or_insert_with(|| Composer::new(&scene, self.course)).compose(&frame);
            drawing.add(&frame, compose).map_err(failed)?;
        }
        let keys = said::of_scene(&scene, self.keys, self.settings);
        let drawn = drawing.finish(Path::new(&told.title), told.title.clone(), keys);
        let mut comparison = Comparison::of_golden(&golden, &drawn);
        comparison.title = told.title;
        comparison.command = Some(told.command);
        Ok(Outcome { golden, drawn, comparison })
    }
}

impl Outcome {
    /// Whether everything is as expected.
    pub fn passes(&self) -> bool {
        self.comparison.passes()
    }

    /// The overall verdict in words: the worst one.
    pub fn verdict(&self) -> &'static str {
        self.comparison.verdict().words()
    }

    /// All findings, line by line, and the command that accepts them.
    pub fn words(&self) -> String {
        self.comparison.advised()
    }

    /// The page for a browser, with all pictures.
    pub fn page(&self) -> String {
        self.comparison.page().html()
    }

    /// Makes the golden, or replaces its parts that changed, and returns a line on each change, states that moved first.
    ///
    /// # Errors
    /// There are no pictures, or a file cannot be written.
    pub fn accept(&self) -> Result<Vec<String>, String> {
        self.comparison.accept(&self.golden, &self.drawn).map_err(|error| error.to_string())
    }
}
