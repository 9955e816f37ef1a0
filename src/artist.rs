//! Makes images of frames and figures: composes pictures, then draws them.

use crate::gpu::Gpu;
use crate::history::History;
use crate::moments::Moments;
use crate::picture::{Composer, NoRoom, Picture, compose_figure};
use crate::render::{RenderError, Renderer};
use crate::scene::Scene;
use crate::scene::figure::Figure;
use crate::sim::snapshot::Frame;
use image::RgbImage;

/// Draws frames of one scene.
pub(crate) struct Artist<'a> {
    /// One for the scene's background, or two for white and black if it has none.
    composers: Vec<Composer<'a>>,
    renderer: Renderer,
}

/// A frame that is composed and can be drawn.
#[derive(Clone, Debug)]
pub(crate) struct Composed {
    /// One picture, or two on white and on black.
    pictures: Vec<Picture>,
}

impl<'a> Artist<'a> {
    /// For frames of a scene, with so many samples per pixel.
    ///
    /// # Errors
    /// If the device fails.
    pub(crate) fn new(gpu: &Gpu, scene: &'a Scene, samples: u32) -> Result<Self, RenderError> {
        let composers = match scene.view.look.transparent {
            false => vec![Composer::new(scene)],
            true => [[255; 3], [0; 3]].map(|ground| Composer::on_ground(scene, ground)).into(),
        };
        Ok(Self { composers, renderer: Renderer::new(gpu, scene.view.size, samples)? })
    }

    /// Sets the time series of the scene, which the chart shows; see [`Composer::set_history`].
    pub(crate) fn set_history(&mut self, history: &History) {
        self.composers.iter_mut().for_each(|composer| composer.set_history(history));
    }

    /// Composes a frame.
    pub(crate) fn compose(&self, frame: &Frame) -> Composed {
        Composed { pictures: self.composers.iter().map(|composer| composer.compose(frame)).collect() }
    }

    /// Draws a frame: pixels in rows from the top left, red, green and blue, and alpha if the scene has no background.
    ///
    /// # Errors
    /// If the device fails.
    pub(crate) fn draw(&mut self, composed: &Composed) -> Result<Vec<u8>, RenderError> {
        match &composed.pictures[..] {
            [on_white, on_black] => Ok(self.renderer.draw_transparent(on_white, on_black)?.into_raw()),
            pictures => Ok(self.renderer.draw(&pictures[0])?.into_raw()),
        }
    }
}

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FigureError {
    /// It is too small for its contents.
    #[error(transparent)]
    NoRoom(#[from] NoRoom),
    /// The device failed.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Draws a figure from its simulated states, with so many samples per pixel.
///
/// # Errors
/// If the figure is too small for its contents, or the device fails.
///
/// # Panics
/// If `moments` are those of another figure.
pub(crate) fn draw_figure(
    gpu: &Gpu,
    figure: &Figure,
    moments: &Moments,
    samples: u32,
) -> Result<RgbImage, FigureError> {
    let picture = compose_figure(figure, moments)?;
    Ok(Renderer::new(gpu, figure.size, samples)?.draw(&picture)?)
}
