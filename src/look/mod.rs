//! What pictures look like: view, colours, fonts, scales, and where cameras stand. A scene keeps a [`View`] that has been
//! made here of its `[view]` table and of the body, the models and the surroundings that it shows; nothing here draws.

mod contrast;
pub(crate) mod file;
pub(crate) mod font;
mod framing;
mod inside;
mod palette;
pub(crate) mod ramp;
mod reach;
mod resolve;
mod run_lines;
mod scene_colours;
mod subject;
pub(crate) mod typed;
mod view;

pub(crate) use contrast::check_runs;
pub(crate) use framing::camera;
pub use palette::{Palette, Theme};
pub(crate) use resolve::{columns, resolve};
pub use run_lines::LineStyle;
pub(crate) use subject::Subject;
#[cfg(feature = "render")]
pub(crate) use view::axes;
pub use view::{
    Camera, ColourMap, ColourScale, FloorStyle, Follow, FontFiles, Labels, Light, Look, StrainScale, View, Visible,
};
