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
    composer: Composer<'a>,
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
pub(crate) struct Composed(Arc<Picture>);

impl PartialEq for Composed {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

impl Composed {
    /// For each panel, whether its body leaves it.
    pub(crate) fn cut(&self) -> impl Iterator<Item = bool> + '_ {
        self.0.panels.iter().map(|panel| panel.is_cut)
    }

    pub(crate) fn picture(&self) -> &Picture {
        &self.0
    }
}

impl<'a> Artist<'a> {
    /// For frames of a scene.
    ///
    /// # Errors
    /// If the device fails.
    pub(crate) fn new(gpu: &Gpu, scene: &'a Scene) -> Result<Self, RenderError> {
        Ok(Self {
            composer: Composer::new(scene),
            renderer: Renderer::new(gpu, scene.view.size)?,
            last: None,
            repeated: 0,
            still: None,
            is_still: !scene.shows_time(),
        })
    }

    /// Sets the time series of the scene, which the chart shows; see [`Composer::set_history`].
    pub(crate) fn set_history(&mut self, history: &History) {
        self.composer.set_history(history);
    }

    /// Composes a frame.
    pub(crate) fn compose(&mut self, frame: &Frame) -> Composed {
        if let Some((before, composed)) = &self.still
            && have_same_states(before, frame)
        {
            return composed.clone();
        }
        let composed = Composed(Arc::new(self.composer.compose(frame)));
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
        let state = match same {
            Some((_, pixels)) => {
                self.repeated += 1;
                State::Drawn(Arc::clone(pixels))
            }
            None => State::Submitted(self.renderer.submit(&composed.0)?),
        };
        Ok(Begun { composed, state })
    }

    /// The frame that was begun: red, green and blue of each pixel, in rows from the top left.
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

/// The picture of a frame.
pub(crate) fn compose_frame(scene: &Scene, frame: &Frame, history: Option<&History>) -> Picture {
    let mut composer = Composer::new(scene);
    history.into_iter().for_each(|history| composer.set_history(history));
    composer.compose(frame)
}

/// What a page of vectors needs of the renderer: the pixels of the lit bodies in a picture; `None` if there are none. Only
/// then a device is needed.
///
/// # Errors
/// If the device fails.
///
/// # Panics
/// If there are lit bodies and no device.
pub(crate) fn draw_bodies(gpu: Option<&Gpu>, picture: &Picture) -> Result<Option<Vec<u8>>, RenderError> {
    let draw = |lit: Picture| draw_picture(gpu.expect("a device for lit bodies"), &lit);
    vector::bodies(picture).map(draw).transpose()
}

/// The pixels of a picture, red, green and blue of each, in rows from the top left.
///
/// # Errors
/// If the device fails.
pub(crate) fn draw_picture(gpu: &Gpu, picture: &Picture) -> Result<Vec<u8>, RenderError> {
    Ok(Renderer::new(gpu, picture.size)?.draw(picture)?.into_raw())
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
