//! Values of a view as typed, which the scene completes.

use crate::sim::Field;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The arrangement of panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PanelsFile {
    Row,
    Column,
    #[serde(untagged)]
    Columns(#[schemars(range(min = 1, max = 64))] u32),
}

/// A scalar field and its colour map.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColourFile {
    /// The field.
    pub(crate) by: Field,
    /// The run to which `distance` is measured. All runs must have the same time step.
    #[schemars(length(min = 1, max = 80))]
    pub(crate) to: Option<String>,
    /// The values at both ends of the colour bar, in the field's unit. Values beyond have the colours of the ends.
    /// Default: from zero to an estimate for the scene: a strain of 0.5, a displacement of half an element's edge or of half the way of a
    /// grab, a distance of half the body, the speed of a fall or at the start, the energy of an element with a strain of 0.5.
    pub(crate) range: Option<[f64; 2]>,
    /// The colour map.
    #[serde(default)]
    pub(crate) map: ColourMap,
}

/// Named colour maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ColourMap {
    /// From pale mint through teal to indigo: far from the vermilion of turned-over elements, with visible edges
    /// everywhere. Large values are dark in the light theme and light in the dark one.
    #[default]
    MintIndigo,
    /// From dark violet through teal to yellow (matplotlib), in either theme.
    Viridis,
    /// From dark blue to yellow, the same with colour blindness (Nuñez, Anderton, Renslow 2018), in either theme.
    Cividis,
    /// From purple through crimson to pale yellow, in either theme: matplotlib's without its black end. Its orange
    /// resembles turned-over elements.
    Magma,
    /// From light to dark grey in the light theme, from dark to light in the dark one.
    Greys,
    /// From violet through grey to green, for lines: values near the middle recede, but stay visible.
    VioletGreen,
    /// From purple through white to green (ColorBrewer PRGn), in either theme: diverging, for values of both signs.
    PurpleGreen,
}
