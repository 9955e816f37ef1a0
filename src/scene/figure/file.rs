//! The structs that figure files are read into. The documentation of their fields is part of messages and of the
//! schema, against which files are checked.

use crate::look::file::ColourFile;
use crate::look::print::{SizeFile, TextScaleFile};
use crate::look::{Plot, Theme};
use crate::sim::Diagnostic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A figure: scenes on one sheet, as a contact sheet or as a diagram of forces.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FigureFile {
    /// The title above all panels. Default: none.
    #[schemars(length(max = 200))]
    pub(super) title: Option<String>,
    /// A line below the title. Default: none.
    #[schemars(length(max = 400))]
    pub(super) caption: Option<String>,
    /// Width and height (px, at least 64), or for print, such as `{ mm = [180, 101] }`.
    #[serde(default = "size")]
    pub(super) size: SizeFile,
    /// The colours. Default: those of the first scene.
    pub(super) theme: Option<Theme>,
    /// Scale of all text, or for print the size of most text, such as `{ pt = 7 }`. Text without room, or too small to
    /// read, is left out; type below 5 pt is refused in figures for print. Default: that of the first scene.
    pub(super) text_scale: Option<TextScaleFile>,
    /// A contact sheet: runs of scenes as rows, moments as columns. Either `sheet` or `forces`.
    pub(super) sheet: Option<SheetFile>,
    /// A diagram of the forces of each run's model on the nodes at the start. Scenes with several runs are rows, with
    /// one column for each run. Scenes with one run stand side by side. Either `forces` or `sheet`.
    pub(super) forces: Option<ForcesFile>,
}

fn size() -> SizeFile {
    SizeFile::Pixels([1600, 900])
}

/// A contact sheet.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SheetFile {
    /// The scene file of columns without one, relative to the figure file.
    pub(super) scene: Option<String>,
    /// The moments shown (s), one column for each, such as `[0.0, 0.5]`, instead of `column`.
    #[schemars(length(min = 1, max = 40), inner(range(min = 0.0)))]
    pub(super) moments: Option<Vec<f64>>,
    /// The columns, instead of `moments`: for different scenes or labels.
    #[serde(default)]
    #[schemars(length(max = 40))]
    pub(super) column: Vec<ColumnFile>,
    /// The rows. Default: one for each run of the first scene.
    #[serde(default)]
    #[schemars(length(max = 20))]
    pub(super) row: Vec<RowFile>,
    /// Diagnostics plotted over time below the pictures, with marks at the moments shown, such as `["turned_over"]`.
    /// Several scenes of equal duration, such as one body with several seeds, have a curve for each run: the mean over
    /// the scenes, in a band from the least to the greatest value. Also what is measured of one thing, as in
    /// `view.charts` of scenes; of one scene only against a displacement. Default: none.
    #[serde(default)]
    #[schemars(length(max = 6))]
    pub(super) charts: Vec<Plot>,
    /// A diagnostic written below each picture, such as `"volume_ratio"`. Default: none.
    pub(super) number: Option<Diagnostic>,
    /// A scalar field that colours all bodies, such as `{ by = "strain" }`, with one colour bar. By default the bar
    /// goes from zero to the largest estimate of all scenes. Default: the field that all scenes share, if any.
    pub(super) colour: Option<ColourFile>,
    /// Start of the time axis (s), not after any moment shown. Default: 0.
    #[schemars(range(min = 0.0))]
    pub(super) from: Option<f64>,
    /// Time at which the time axis changes its scale (s): the time before takes most of the width. Default: nowhere.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(super) split: Option<f64>,
}

/// A column of a contact sheet.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ColumnFile {
    /// The scene file, relative to the figure file. Default: that of the sheet.
    pub(super) scene: Option<String>,
    /// The moment shown (s). Default: that of the row.
    #[schemars(range(min = 0.0))]
    pub(super) time: Option<f64>,
    /// The label above it. Default: the moment, after the name of its scene if columns show several.
    #[schemars(length(max = 80))]
    pub(super) label: Option<String>,
}

/// A row of a contact sheet.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RowFile {
    /// The name of the run shown.
    pub(super) run: String,
    /// The moment shown (s). Default: that of the column.
    #[schemars(range(min = 0.0))]
    pub(super) time: Option<f64>,
    /// The label beside it. Default: the name of the run.
    #[schemars(length(max = 80))]
    pub(super) label: Option<String>,
    /// A second line beside it. Default: none.
    #[schemars(length(max = 80))]
    pub(super) note: Option<String>,
}

/// A diagram of forces.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ForcesFile {
    /// The scene files, relative to the figure file. All have runs of the same names.
    #[schemars(length(min = 1, max = 12))]
    pub(super) scenes: Vec<String>,
    /// A line below the name of each run. Default: none.
    #[serde(default)]
    #[schemars(length(max = 12))]
    pub(super) notes: Vec<String>,
    /// A run whose forces are outlined beside those of all others, with the angles between them. Default: none.
    pub(super) compare: Option<String>,
    /// Whether the vectors of the paper's section 3 are drawn: `r` from the centre `c` to a node, `R` to its place in the
    /// equilibrium shape.
    #[serde(default)]
    pub(super) vectors: bool,
    /// The numbers at the arrows.
    #[serde(default)]
    pub(super) numbers: NumbersFile,
}

/// The numbers at arrows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum NumbersFile {
    /// The magnitude of each force, in units of stiffness times side.
    #[default]
    Force,
    /// No numbers.
    None,
}
