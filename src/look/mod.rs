//! The look of pictures: view, colours, fonts, colour scales and cameras. A scene has a [`View`], which `scene` resolves
//! from its `[view]` table and from its body, models and surroundings. Nothing here draws.

mod azimuth;
mod camera;
mod camera_box;
mod contrast;
#[cfg(feature = "render")]
mod drawn;
pub(crate) mod file;
pub(crate) mod font;
mod palette;
mod plot;
pub(crate) mod print;
#[cfg(feature = "render")]
pub(crate) mod ramp;
mod run_lines;
mod scene_colours;
pub(crate) mod typed;
mod view;

pub use crate::colour::Colour;
pub(crate) use azimuth::Hidden;
pub use camera::Camera;
pub(crate) use camera::{CameraFile, axes};
pub(crate) use camera_box::CameraBoxes;
pub(crate) use contrast::check_runs;
pub use file::ColourMap;
pub use font::FontFiles;
pub(crate) use palette::Palette;
pub use palette::Theme;
pub use plot::{By, Measure, Plot, PlotByBody, PlotOf};
pub use print::Print;
pub(crate) use run_lines::{LinePlace, Lined};
pub use view::{ColourScale, EdgeStyle, FloorStyle, Ghost, Labels, Style, Traced, View, Visible};
#[cfg(feature = "render")]
pub(crate) use {azimuth::azimuths, camera_box::CameraBox, drawn::LineStyle, palette::BODIES, ramp::SHADES};
