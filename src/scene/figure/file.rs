//! What a figure file says, as typed. As with scenes, the documentation of the fields is what messages and the schema
//! say, and the schema made from these types is what files are checked against.

use crate::look::Theme;
use crate::sim::snapshot::Diagnostic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A figure: scenes put together on one sheet, as contact sheet or as diagram of forces.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FigureFile {
    /// The title above everything. Default: none.
    #[schemars(length(max = 200))]
    pub(super) title: Option<String>,
    /// A line below the title. Default: none.
    #[schemars(length(max = 400))]
    pub(super) caption: Option<String>,
    /// Width and height (px).
    #[serde(default = "size")]
    #[schemars(inner(range(min = 64, max = 16384)))]
    pub(super) size: [u32; 2],
    /// The colours. Default: those of the first scene.
    pub(super) theme: Option<Theme>,
    /// How many times larger than usual all type is, with the rows it stands in. What has no room, or would be too small to
    /// be read, is left out. Default: that of the first scene.
    #[schemars(range(min = 0.5, max = 3.0))]
    pub(super) text_scale: Option<f64>,
    /// A contact sheet: runs of scenes at chosen moments. Either this or `forces`.
    pub(super) sheet: Option<SheetFile>,
    /// A diagram of the forces at the start of scenes. Either this or `sheet`.
    pub(super) forces: Option<ForcesFile>,
}

fn size() -> [u32; 2] {
    [1600, 900]
}

/// A contact sheet.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SheetFile {
    /// The scene, beside the figure's file, of all columns that name none.
    pub(super) scene: Option<String>,
    /// The moments shown (s), a column for each, instead of `column`.
    #[schemars(length(min = 1, max = 40), inner(range(min = 0.0)))]
    pub(super) moments: Option<Vec<f64>>,
    /// The columns, if they are more than moments of one scene.
    #[serde(default)]
    #[schemars(length(max = 40))]
    pub(super) column: Vec<ColumnFile>,
    /// The rows. Default: one for each run of the first scene.
    #[serde(default)]
    #[schemars(length(max = 20))]
    pub(super) row: Vec<RowFile>,
    /// Diagnostics over time below the pictures, with marks at the moments shown; all columns are then of one scene.
    /// Default: none.
    #[serde(default)]
    #[schemars(length(max = 6))]
    pub(super) strips: Vec<Diagnostic>,
    /// A diagnostic written below each picture. Default: none.
    pub(super) number: Option<Diagnostic>,
    /// Where the axis of time begins (s), not after any moment shown. Default: 0.
    #[schemars(range(min = 0.0))]
    pub(super) from: Option<f64>,
    /// Where the axis of time changes its scale (s): what comes before takes most of the width. Default: nowhere.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(super) split: Option<f64>,
}

/// A column of a contact sheet.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ColumnFile {
    /// The scene, beside the figure's file. Default: that of the sheet.
    pub(super) scene: Option<String>,
    /// The moment shown (s). Default: that of the row.
    #[schemars(range(min = 0.0))]
    pub(super) time: Option<f64>,
    /// What stands above it. Default: the moment.
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
    /// What stands beside it. Default: the name of the run.
    #[schemars(length(max = 80))]
    pub(super) label: Option<String>,
    /// A second line beside it. Default: none.
    #[schemars(length(max = 80))]
    pub(super) note: Option<String>,
}

/// A diagram of forces: at the start of each scene, what each run's model does to the nodes. Scenes of several runs are
/// rows, with a column for each run; scenes of one run stand beside each other.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ForcesFile {
    /// The scenes, beside the figure's file. All have runs of the same names.
    #[schemars(length(min = 1, max = 12))]
    pub(super) scenes: Vec<String>,
    /// A line below the name of each run. Default: none.
    #[serde(default)]
    #[schemars(length(max = 12))]
    pub(super) notes: Vec<String>,
    /// The run whose forces are outlined beside those of all others, with the angles between them. Default: none.
    pub(super) compare: Option<String>,
    /// What the vectors of the paper's section 3 are is shown, too: `r` from the centre `c` to a node, `R` to its place
    /// in the equilibrium shape.
    #[serde(default)]
    pub(super) vectors: bool,
    /// The numbers: `force` at each arrow, `none`.
    #[serde(default)]
    pub(super) numbers: NumbersFile,
}

/// What is written at arrows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum NumbersFile {
    /// The size of each force, in stiffness times side.
    #[default]
    Force,
    /// Nothing.
    None,
}
