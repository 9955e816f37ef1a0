//! Makes images of frames and figures: composes pictures, then draws them.

use crate::gpu::Gpu;
use crate::history::History;
use crate::moments::Moments;
use crate::picture::{Composer, NoRoom, Picture, compose_figure};
use crate::render::{RenderError, Renderer};
use crate::scene::Scene;
use crate::scene::figure::Figure;
use crate::sim::snapshot::Frame;
use crate::vector;
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

impl Composed {
    /// For each panel, whether its body leaves it.
    pub(crate) fn cut(&self) -> impl Iterator<Item = bool> + '_ {
        self.pictures.first().into_iter().flat_map(|picture| &picture.panels).map(|panel| panel.is_cut)
    }
}

impl Composed {
    /// The picture, or that on white.
    pub(crate) fn first(&self) -> &Picture {
        &self.pictures[0]
    }
}

impl<'a> Artist<'a> {
    /// For frames of a scene, with so many samples per pixel.
    ///
    /// # Errors
    /// If the device fails.
    pub(crate) fn new(gpu: &Gpu, scene: &'a Scene, samples: u32) -> Result<Self, RenderError> {
        Ok(Self { composers: composers(scene), renderer: Renderer::new(gpu, scene.view.size, samples)? })
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
        draw_with(&mut self.renderer, &composed.pictures)
    }
}

/// One for the scene's background, or two for white and black if it has none.
fn composers(scene: &Scene) -> Vec<Composer<'_>> {
    match scene.view.look.transparent {
        false => vec![Composer::new(scene)],
        true => [[255; 3], [0; 3]].map(|ground| Composer::on_ground(scene, ground)).into(),
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

/// The pictures of a frame: one, or two on white and on black if the scene has no background.
pub(crate) fn compose_frame(scene: &Scene, frame: &Frame, history: Option<&History>) -> Vec<Picture> {
    let one = |mut composer: Composer<'_>| {
        history.into_iter().for_each(|history| composer.set_history(history));
        composer.compose(frame)
    };
    composers(scene).into_iter().map(one).collect()
}

/// What a page of vectors needs of the renderer: the pixels of the lit bodies in one picture, or in two on white and on
/// black; `None` if there are none. Only then a device is needed.
///
/// # Errors
/// If the device fails.
///
/// # Panics
/// If there are lit bodies and no device.
pub(crate) fn draw_bodies(
    gpu: Option<&Gpu>,
    pictures: &[Picture],
    samples: u32,
) -> Result<Option<Vec<u8>>, RenderError> {
    let lit: Vec<_> = pictures.iter().filter_map(vector::bodies).collect();
    let device = |_: &Picture| gpu.expect("a device for lit bodies");
    lit.first().map(device).map(|gpu| draw_pictures(gpu, &lit, samples)).transpose()
}

/// The pixels of one picture, in rows from the top left: red, green and blue, and alpha if there are two, on white and on
/// black.
///
/// # Errors
/// If the device fails.
pub(crate) fn draw_pictures(gpu: &Gpu, pictures: &[Picture], samples: u32) -> Result<Vec<u8>, RenderError> {
    let mut renderer = Renderer::new(gpu, pictures[0].size, samples)?;
    draw_with(&mut renderer, pictures)
}

fn draw_with(renderer: &mut Renderer, pictures: &[Picture]) -> Result<Vec<u8>, RenderError> {
    match pictures {
        [on_white, on_black] => Ok(renderer.draw_transparent(on_white, on_black)?.into_raw()),
        pictures => Ok(renderer.draw(&pictures[0])?.into_raw()),
    }
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
