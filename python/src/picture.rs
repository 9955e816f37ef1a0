//! Pictures of frames: pixels and files.

use crate::error;
use localshape::internals::{Compression, Tags, encode_print, unprintable, width_to_set};
use localshape::picture::{self, Composer};
use localshape::runner::{Frame, History};
use localshape::sim::Dimension;
use localshape::vector::{self, Format, Page};
use localshape::{AdapterChoice, Gpu, Renderer};
use numpy::ndarray::Array;
use numpy::{IntoPyArray, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::error::Error;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

type Failed = Box<dyn Error + Send + Sync>;

/// The picture of a frame. It is drawn when its pixels are first asked for. In Jupyter it shows itself.
///
/// Bodies in space need a graphics device: without a Vulkan driver `DeviceError` tells what to install.
#[pyclass(frozen, module = "localshape")]
pub(crate) struct Picture {
    scene: Arc<localshape::Scene>,
    frame: Frame,
    picture: picture::Picture,
    /// Red, green and blue of each pixel.
    pixels: OnceLock<Vec<u8>>,
}

/// The device of this process, and the renderer of the last picture.
#[derive(Default)]
struct Device {
    gpu: Option<Gpu>,
    renderer: Option<(bool, [u32; 2], Renderer)>,
}

static DEVICE: Mutex<Option<Device>> = Mutex::new(None);

/// Gives software drivers a width with which they draw the same everywhere.
pub(crate) fn prepare_driver(py: Python<'_>) -> PyResult<()> {
    match width_to_set() {
        Some([name, value]) => py.import("os")?.getattr("environ")?.set_item(name, value),
        None => Ok(()),
    }
}

impl Device {
    /// The name of the adapter in files.
    fn name(&self, is_lit: bool) -> String {
        let gpu = self.gpu.as_ref().filter(|_| is_lit);
        gpu.map_or_else(|| "none".to_owned(), |gpu| gpu.description().to_string())
    }

    /// Red, green and blue of each pixel of a picture, which may be lit.
    fn draw(&mut self, picture: &picture::Picture, is_lit: bool) -> Result<Vec<u8>, Failed> {
        if self.renderer.as_ref().is_none_or(|(lit, size, _)| (*lit, *size) != (is_lit, picture.size())) {
            let gpu = self.gpu.as_ref().filter(|_| is_lit);
            self.renderer = Some((is_lit, picture.size(), Renderer::new(gpu, picture.size())?));
        }
        let (_, _, renderer) = self.renderer.as_mut().expect("made above");
        Ok(renderer.draw(picture)?.into_raw())
    }
}

impl Picture {
    /// The picture of a frame of a scene, or why it cannot be printed.
    pub(crate) fn compose(scene: &Arc<localshape::Scene>, history: &History, frame: Frame) -> Result<Self, String> {
        let picture = Composer::new(scene, history).compose(&frame);
        match unprintable(scene, &picture) {
            Some(words) => Err(words),
            None => Ok(Self { scene: Arc::clone(scene), frame, picture, pixels: OnceLock::new() }),
        }
    }

    /// Uses the device, which is opened first if this picture needs it. A device that fails is opened anew the next time.
    fn with_device<T>(
        &self,
        py: Python<'_>,
        draw: impl Fn(&mut Device, bool) -> Result<T, Failed> + Sync,
    ) -> PyResult<T>
    where
        T: Send,
    {
        let is_lit = self.scene.bodies[0].body.dimension() == Dimension::Space;
        if is_lit {
            prepare_driver(py)?;
        }
        let drawn = py.detach(|| {
            let mut device = DEVICE.lock().unwrap_or_else(PoisonError::into_inner);
            let used = device.get_or_insert_default();
            if is_lit && used.gpu.is_none() {
                used.gpu = Some(Gpu::new(&AdapterChoice::Auto)?);
            }
            let drawn = draw(used, is_lit);
            if drawn.is_err() {
                *device = None;
            }
            drawn
        });
        drawn.map_err(|error| error::of_device(py, &*error))
    }

    /// Red, green and blue of each pixel, drawn once.
    fn pixels(&self, device: &mut Device, is_lit: bool) -> Result<&[u8], Failed> {
        if self.pixels.get().is_none() {
            let drawn = device.draw(&self.picture, is_lit)?;
            return Ok(self.pixels.get_or_init(|| drawn));
        }
        Ok(self.pixels.get().expect("drawn before"))
    }

    /// A page of a vector file.
    fn page<'py>(&self, py: Python<'py>, format: Format) -> PyResult<Bound<'py, PyBytes>> {
        let Self { scene, frame, picture, .. } = self;
        let file = self.with_device(py, |device, is_lit| {
            let size_mm = scene.view.print.as_ref().map(|print| print.mm);
            let bodies = vector::bodies(picture, size_mm).map(|bodies| device.draw(&bodies, is_lit)).transpose()?;
            let tags = Tags::of_frame(scene, frame, &device.name(is_lit)).texts();
            let maker = concat!("made by localshape ", env!("CARGO_PKG_VERSION"));
            let page = Page { bodies: bodies.as_deref(), size_mm, title: &scene.title, maker, tags: &tags, picture };
            Ok(vector::write(&page, format)?)
        })?;
        Ok(PyBytes::new(py, &file))
    }
}

#[pymethods]
impl Picture {
    /// The pixels from the top left: H × W × 4, uint8, red, green, blue and opacity, which is 255. A new array each time.
    #[getter]
    fn array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let [width, height] = self.size();
        let opaque = self.with_device(py, |device, is_lit| {
            let pixels = self.pixels(device, is_lit)?.as_chunks::<3>().0;
            let mut opaque = vec![u8::MAX; 4 * pixels.len()];
            for (&[red, green, blue], to) in pixels.iter().zip(opaque.as_chunks_mut::<4>().0) {
                *to = [red, green, blue, u8::MAX];
            }
            Ok(opaque)
        })?;
        let shape = [height as usize, width as usize, 4];
        Ok(Array::from_shape_vec(shape, opaque).expect("four bytes a pixel").into_pyarray(py))
    }

    /// The time of the step that is shown (s).
    #[getter]
    fn time(&self) -> f64 {
        self.frame.time
    }

    /// The number of the frame.
    #[getter]
    fn number(&self) -> u64 {
        self.frame.index
    }

    /// Width and height (px).
    #[getter]
    fn size(&self) -> [u32; 2] {
        self.picture.size()
    }

    /// The picture as a PNG file, with the bytes of a frame of `localshape render`.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let Self { scene, frame, picture, .. } = self;
        let file = self.with_device(py, |device, is_lit| {
            let tags = Tags::of_frame(scene, frame, &device.name(is_lit)).texts();
            let dpi = scene.view.print.as_ref().map(|print| print.dpi);
            Ok(encode_print(picture.size(), self.pixels(device, is_lit)?, &tags, Compression::Fast, dpi))
        })?;
        Ok(PyBytes::new(py, &file))
    }

    /// The picture as an SVG file, in which text stays text.
    fn svg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.page(py, Format::Svg)
    }

    /// The picture as a PDF file, in which text stays text.
    fn pdf<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.page(py, Format::Pdf)
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.png(py)
    }

    fn __repr__(&self) -> String {
        let [width, height] = self.size();
        format!("<localshape.Picture of “{}” at {} s, {width} × {height} px>", self.scene.title, self.frame.time)
    }
}
