//! Figures: scenes on one sheet. A figure file names scenes and arranges their runs and moments. The scenes determine
//! their look.

pub(crate) mod built_in;
mod file;
mod forces;
mod resolve;
mod sheet;

use super::Scene;
use super::error::SceneError;
use super::limits::Limits;
use super::load::{self, Document};
use super::schema::schema_of;
use crate::look::{Plot, Print, Style, Theme};
use crate::reading::setting::Setting;
use crate::sim::Diagnostic;
use serde_json::Value;
use std::path::Path;
use std::sync::LazyLock;

/// A resolved figure: every scene is read, every run exists, every moment is within its scene.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name of its file without the ending, for output.
    pub name: String,
    /// The title; empty for none.
    pub title: String,
    /// A line below it; empty for none.
    pub caption: String,
    /// Width and height (px).
    pub size: [u32; 2],
    /// The size in print, if it has one.
    pub print: Option<Print>,
    /// Colours, type and lines of the figure.
    pub look: Style,
    /// The content.
    pub content: Content,
}

/// The content of a figure.
#[derive(Clone, Debug)]
pub enum Content {
    /// Runs at chosen moments.
    Sheet(Sheet),
    /// Forces at the start.
    Forces(Forces),
}

/// A contact sheet: rows of runs, columns of moments.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The scenes of the columns.
    pub scenes: Vec<Scene>,
    /// The columns, from left to right.
    pub columns: Vec<Column>,
    /// The rows, from top to bottom.
    pub rows: Vec<Row>,
    /// Charts below the pictures. With them, all columns show the first scene.
    pub charts: Vec<Plot>,
    /// The diagnostic written below each picture.
    pub number: Option<Diagnostic>,
    /// The start of the time axis (s).
    pub from: f64,
    /// The time at which the time axis changes its scale (s).
    pub split: Option<f64>,
}

/// A column of a contact sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Index of the scene.
    pub scene: usize,
    /// The moment shown (s); `None` if the rows have it.
    pub time: Option<f64>,
    /// The label above it; the moment if `None`.
    pub label: Option<String>,
}

/// A row of a contact sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The name of the run shown, which every scene has.
    pub run: String,
    /// The moment shown (s), instead of that of the column.
    pub time: Option<f64>,
    /// The label beside it.
    pub label: String,
    /// A second line beside it; empty for none.
    pub note: String,
}

impl Sheet {
    /// The scene, the run and the moment (s) of a cell.
    pub fn cell(&self, row: usize, column: usize) -> (usize, usize, f64) {
        let (row, column) = (&self.rows[row], &self.columns[column]);
        let run = self.scenes[column.scene].runs.iter().position(|run| run.name == row.run);
        (column.scene, run.expect("a run of all scenes"), row.time.or(column.time).expect("one of them has it"))
    }
}

/// A diagram of forces.
#[derive(Clone, Debug)]
pub struct Forces {
    /// The scenes: rows if they have several runs, else columns.
    pub scenes: Vec<Scene>,
    /// A line below the name of each run; empty for none.
    pub notes: Vec<String>,
    /// The run whose forces are outlined beside those of all others.
    pub compare: Option<usize>,
    /// Whether the vectors from the centre are drawn.
    pub vectors: bool,
    /// Whether the magnitude of each force is written beside it.
    pub numbers: bool,
}

impl Figure {
    /// A built-in figure of the paper; `None` if [`built_in::NAMES`] does not list the name.
    pub fn built_in(name: &str) -> Option<Self> {
        Some(Self::built_in_with(name, &[])?.unwrap_or_else(|error| panic!("{error}")))
    }

    /// A built-in figure, with settings of the command line for each of its scenes.
    ///
    /// # Errors
    /// Mistakes in the settings.
    pub(crate) fn built_in_with(name: &str, settings: &[Setting]) -> Option<Result<Self, SceneError>> {
        let path = built_in::path(name)?;
        let text = built_in::text(&path).expect("listed");
        let scene = |path: &Path| {
            let text = built_in::text(path).expect("figures name scenes that come with the program");
            let document = Document { text, name: &path.display().to_string(), settings, lists: None };
            Scene::read(document, Path::new(""), &Limits::default())
        };
        Some(Self::read(text, &path.display().to_string(), Path::new("figures"), &scene))
    }

    /// Reads a figure from a file.
    ///
    /// # Errors
    /// The file, or a scene that it names, cannot be read. All mistakes in it are reported.
    pub fn load(path: &Path, limits: &Limits) -> Result<Self, SceneError> {
        Self::load_with(path, &[], limits)
    }

    /// Reads a figure from a file, with settings of the command line for each of its scenes.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub(crate) fn load_with(path: &Path, settings: &[Setting], limits: &Limits) -> Result<Self, SceneError> {
        let text = load::text_of(path, limits, load::SCENE)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::read(&text, &path.display().to_string(), folder, &|path| Scene::load_with(path, settings, limits))
    }

    /// The scenes of the figure.
    pub fn scenes(&self) -> &[Scene] {
        match &self.content {
            Content::Sheet(Sheet { scenes, .. }) | Content::Forces(Forces { scenes, .. }) => scenes,
        }
    }

    /// Whether its picture needs a graphics device: bodies in space are lit.
    #[cfg(feature = "render")]
    pub(crate) fn is_lit(&self) -> bool {
        self.scenes().iter().any(Scene::is_lit)
    }

    /// Gives the figure the colours of a theme.
    pub fn set_theme(&mut self, theme: Theme) {
        self.look = look(&self.scenes()[0], Some(theme), Some(self.look.text_scale));
    }

    /// Reads a figure from a text, with scenes relative to `folder`.
    fn read(
        text: &str,
        name: &str,
        folder: &Path,
        scene: &dyn Fn(&Path) -> Result<Scene, SceneError>,
    ) -> Result<Self, SceneError> {
        load::checked(Document { text, name, settings: &[], lists: None }, &SCHEMA, load::SCENE, |checked, report| {
            resolve::resolve(checked, name, folder, scene, report)
        })
    }
}

/// The JSON Schema of figure files.
pub(crate) fn schema() -> Value {
    SCHEMA.clone()
}

static SCHEMA: LazyLock<Value> = LazyLock::new(|| schema_of::<file::FigureFile>("Figure file of localshape"));

/// The style of a figure: the first scene's, or in another theme and with another text scale if the figure has them.
fn look(first: &Scene, theme: Option<Theme>, text_scale: Option<f64>) -> Style {
    let look = match theme {
        Some(theme) if theme != first.view.look.theme => {
            let Style { font, text_scale, .. } = first.view.look.clone();
            Style { font, text_scale, ..Style::of(theme) }
        }
        _ => first.view.look.clone(),
    };
    Style { text_scale: text_scale.unwrap_or(look.text_scale), ..look }
}
