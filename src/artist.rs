//! Makes images of frames and figures: composes pictures, then draws them.

use crate::gpu::{Gpu, Pending};
use crate::picture::{Composer, NoRoom, Picture, compose_figure};
use crate::render::{RenderError, Renderer};
use crate::runner::history::History;
use crate::runner::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::Figure;
use crate::sim::snapshot::{Diagnostic, Frame, RunFrame, Snapshot};
use crate::vector;
use image::RgbImage;
use std::sync::Arc;

/// Draws frames of one scene.
pub(crate) struct Artist<'a> {
    /// One for the scene's background, or two for white and black if it has none.
    composers: Vec<Composer<'a>>,
    renderer: Renderer,
    /// The last frame and its pixels. One that is the same is not drawn again.
    last: Option<(Composed, Arc<Vec<u8>>)>,
    /// The number of frames that were not.
    repeated: usize,
    /// The last frame that was composed, and what came of it, if only states change pictures. The same states are not
    /// composed again.
    still: Option<(Frame, Composed)>,
    is_still: bool,
}

/// A frame that is being drawn.
pub(crate) struct Begun {
    composed: Composed,
    state: State,
}

/// How far drawing is.
enum State {
    Submitted(Pending),
    Drawn(Arc<Vec<u8>>),
}

/// A frame that is composed and can be drawn.
#[derive(Clone, Debug)]
pub(crate) struct Composed {
    /// One picture, or two on white and on black.
    pictures: Arc<Vec<Picture>>,
}

impl PartialEq for Composed {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pictures, &other.pictures) || self.pictures == other.pictures
    }
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
    /// For frames of a scene.
    ///
    /// # Errors
    /// If the device fails.
    pub(crate) fn new(gpu: &Gpu, scene: &'a Scene) -> Result<Self, RenderError> {
        Ok(Self {
            composers: composers(scene),
            renderer: Renderer::new(gpu, scene.view.size)?,
            last: None,
            repeated: 0,
            still: None,
            is_still: !scene.shows_time(),
        })
    }

    /// Sets the time series of the scene, which the chart shows; see [`Composer::set_history`].
    pub(crate) fn set_history(&mut self, history: &History) {
        self.composers.iter_mut().for_each(|composer| composer.set_history(history));
    }

    /// Composes a frame.
    pub(crate) fn compose(&mut self, frame: &Frame) -> Composed {
        if let Some((before, composed)) = &self.still
            && have_same_states(before, frame)
        {
            return composed.clone();
        }
        let pictures = self.composers.iter().map(|composer| composer.compose(frame)).collect();
        let composed = Composed { pictures: Arc::new(pictures) };
        self.still = self.is_still.then(|| (frame.clone(), composed.clone()));
        composed
    }

    /// The number of frames so far that were the same as the one before and not drawn again.
    pub(crate) fn repeated(&self) -> usize {
        self.repeated
    }

    /// Begins to draw a frame, which [`Self::finish`] must complete before the next one begins. Meanwhile the next one may be
    /// composed.
    ///
    /// # Errors
    /// If the device fails.
    pub(crate) fn begin(&mut self, composed: Composed) -> Result<Begun, RenderError> {
        let same = self.last.as_ref().filter(|(last, _)| *last == composed);
        let state = match (same, &composed.pictures[..]) {
            (Some((_, pixels)), _) => {
                self.repeated += 1;
                State::Drawn(Arc::clone(pixels))
            }
            (None, [picture]) => State::Submitted(self.renderer.submit(picture)?),
            (None, pictures) => State::Drawn(Arc::new(draw_with(&mut self.renderer, pictures)?)),
        };
        Ok(Begun { composed, state })
    }

    /// The frame that was begun: pixels in rows from the top left, red, green and blue, and alpha if the scene has no background.
    ///
    /// # Errors
    /// If the device fails.
    pub(crate) fn finish(&mut self, Begun { composed, state }: Begun) -> Result<Arc<Vec<u8>>, RenderError> {
        let pixels = match state {
            State::Submitted(pending) => Arc::new(self.renderer.collect(pending)?),
            State::Drawn(pixels) => pixels,
        };
        self.last = Some((composed, Arc::clone(&pixels)));
        Ok(pixels)
    }
}

/// Whether two frames show the same runs in the same states, at any times.
fn have_same_states(one: &Frame, other: &Frame) -> bool {
    // By their bits: what is not a number is not equal to itself. Directions follow from the nodes.
    let values = |run: &RunFrame| -> Vec<_> {
        Diagnostic::ALL.iter().map(|one| one.value(&run.snapshot.diagnostics).size().to_bits()).collect()
    };
    let nodes = |run: &RunFrame| {
        let (step, time, diagnostics) = Default::default();
        Snapshot { step, time, diagnostics, ..run.snapshot.clone() }
    };
    let same = |(one, other): (&RunFrame, &RunFrame)| {
        (one.run, &one.last_fit) == (other.run, &other.last_fit)
            && values(one) == values(other)
            && nodes(one) == nodes(other)
    };
    one.runs.len() == other.runs.len() && one.runs.iter().zip(&other.runs).all(same)
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
pub(crate) fn draw_bodies(gpu: Option<&Gpu>, pictures: &[Picture]) -> Result<Option<Vec<u8>>, RenderError> {
    let lit: Vec<_> = pictures.iter().filter_map(vector::bodies).collect();
    let device = |_: &Picture| gpu.expect("a device for lit bodies");
    lit.first().map(device).map(|gpu| draw_pictures(gpu, &lit)).transpose()
}

/// The pixels of one picture, in rows from the top left: red, green and blue, and alpha if there are two, on white and on
/// black.
///
/// # Errors
/// If the device fails.
pub(crate) fn draw_pictures(gpu: &Gpu, pictures: &[Picture]) -> Result<Vec<u8>, RenderError> {
    let mut renderer = Renderer::new(gpu, pictures[0].size)?;
    draw_with(&mut renderer, pictures)
}

fn draw_with(renderer: &mut Renderer, pictures: &[Picture]) -> Result<Vec<u8>, RenderError> {
    match pictures {
        [on_white, on_black] => Ok(renderer.draw_transparent(on_white, on_black)?.into_raw()),
        pictures => Ok(renderer.draw(&pictures[0])?.into_raw()),
    }
}

/// Draws a figure from its simulated states.
///
/// # Errors
/// If the figure is too small for its contents, or the device fails.
///
/// # Panics
/// If `moments` are those of another figure.
pub(crate) fn draw_figure(gpu: &Gpu, figure: &Figure, moments: &Moments) -> Result<RgbImage, FigureError> {
    let picture = compose_figure(figure, moments)?;
    Ok(Renderer::new(gpu, figure.size)?.draw(&picture)?)
}
