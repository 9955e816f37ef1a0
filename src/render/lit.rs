//! Lit bodies in space, with their floors, obstacles and lines. The passes, in order:
//!
//! 1. `surface`: turned-over elements, alone, to be seen through the body, and as surfaces of the body.
//! 2. `surface`: other elements over them, in textures no larger than the bodies, with solid obstacles (`obstacle`).
//! 3. `border`: smooth borders where colours change at a line.
//! 4. `visibility`, then `line`: edges and contours as opacities, with smooth borders of their own.
//! 5. `ground`: the floor with its grid and its shadows, into the picture.
//! 6. `composite`: bodies and lines over the ground, between transparent obstacles (`obstacle`).
//! 7. `stroke`: coloured lines and nodes in space, over the bodies, if there are any.
//!
//! Every pixel has one sample. All borders are found from the geometry, which costs nothing without borders. With a scalar
//! field, `tint` takes the place of `surface`. Each pass has one file here and one of the same name in `shaders/`.

use super::obstacle::{Slabs, Solids};
use super::panel::{self, Panels};
use super::pass::Pass;
use super::target::{self, Bodies, Canvas};
use super::{RenderError, border, composite, ground, line, stroke, surface, tint};
use crate::gpu::{Gpu, Pending, ReadBack};
use crate::picture::Picture;

/// Draws the lit bodies of pictures of one size. The same picture gives the same bytes, whatever was drawn before.
#[derive(Debug)]
pub(super) struct Lit {
    gpu: Gpu,
    panels: Panels,
    surfaces: surface::Surfaces,
    lines: line::Lines,
    borders: border::Borders,
    /// Made when first needed.
    solids: Option<Solids>,
    slabs: Option<Slabs>,
    grounds: ground::Grounds,
    composite: composite::Composite,
    /// Made when first needed, like the tint.
    strokes: Option<stroke::Strokes>,
    tint: Option<tint::Tint>,
    canvas: Canvas,
    bodies: Option<Bodies>,
    read_back: ReadBack,
}

impl Lit {
    /// Prepares to draw pictures of a width and height (px).
    ///
    /// # Errors
    /// The device fails.
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, RenderError> {
        let ([width, height], longest) = (size, gpu.longest_side());
        if width.max(height) > longest {
            return Err(RenderError::Size { width, height, longest });
        }
        let panels = Panels::new(gpu);
        let lit = Self {
            surfaces: surface::Surfaces::new(gpu),
            lines: line::Lines::new(gpu),
            borders: border::Borders::new(gpu),
            solids: None,
            slabs: None,
            grounds: ground::Grounds::new(gpu, &panels),
            composite: composite::Composite::new(gpu),
            strokes: None,
            tint: None,
            canvas: Canvas::new(gpu, size),
            bodies: None,
            read_back: ReadBack::new(gpu, width, height),
            panels,
            gpu: gpu.clone(),
        };
        gpu.check()?;
        Ok(lit)
    }

    /// Waits for a submitted picture, and returns its pixels: red, green, blue and opacity of each, in rows from the top left.
    ///
    /// # Errors
    /// The device fails.
    pub(super) fn collect(&self, pending: Pending) -> Result<Vec<u8>, RenderError> {
        Ok(self.read_back.collect(&self.gpu, pending)?)
    }

    /// Submits a picture and returns at once. Collect it before the next one is submitted: there is one buffer for
    /// reading back.
    pub(super) fn submit(&mut self, picture: &Picture) -> Result<Pending, RenderError> {
        let gpu = self.gpu.clone();
        let (places, needed) = panel::place(picture);
        // Items behind surfaces are drawn only where they are read: over turned-over elements, and by lines of turned-over
        // elements without faces.
        let has_behind = picture.panels.iter().any(|panel| panel::has_behind(panel) || line::has_alarm(panel));
        let bodies = match self.bodies.take().filter(|bodies| bodies.suit(needed, has_behind)) {
            Some(bodies) => bodies,
            None => {
                let bodies = Bodies::new(&gpu, target::rounded(needed), has_behind);
                self.surfaces.retarget(&gpu, &bodies);
                self.lines.retarget(&gpu, &bodies);
                self.borders.retarget(&gpu, &bodies);
                self.composite.retarget(&gpu, &bodies);
                if let Some(slabs) = &mut self.slabs {
                    slabs.retarget(&gpu, &bodies);
                }
                self.strokes.iter_mut().for_each(|strokes| strokes.retarget(&gpu, &bodies));
                self.tint.iter_mut().for_each(|tint| tint.retarget(&gpu, &bodies));
                bodies
            }
        };
        self.panels.write(&gpu, picture, &places);
        self.surfaces.write(&gpu, picture);
        self.borders.write(&gpu, &self.panels, picture)?;
        self.composite.write(&gpu, &self.panels, picture);
        self.grounds.write(&gpu, picture);
        let [with_solids, with_slabs] = [Solids::are_in(picture), Slabs::are_in(picture)];
        self.lines.write(&gpu, &self.panels, &bodies, picture, with_solids)?;
        if with_solids {
            self.solids.get_or_insert_with(|| Solids::new(&gpu, &self.panels)).write(&gpu, picture);
        }
        if with_slabs {
            let new = || {
                let mut slabs = Slabs::new(&gpu, &self.panels);
                slabs.retarget(&gpu, &bodies);
                slabs
            };
            self.slabs.get_or_insert_with(new).write(&gpu, picture);
        }
        let solids = self.solids.as_ref().filter(|_| with_solids);
        let slabs = self.slabs.as_ref().filter(|_| with_slabs);
        let occluders = surface::occluders(picture);
        let colouring = if picture.ramp.is_empty() {
            self.surfaces.prepare(&gpu, &self.panels, picture);
            self.surfaces.plain(occluders)
        } else {
            let tint = self.tint.get_or_insert_with(|| tint::Tint::new(&gpu, &bodies));
            tint.prepare(&gpu, &self.panels, picture);
            tint.write(&gpu, picture);
            tint.colouring(occluders)
        };
        if stroke::Strokes::are_in(picture) {
            let made = || stroke::Strokes::new(&gpu, &self.panels, &bodies);
            self.strokes.get_or_insert_with(made).write(&gpu, picture);
        }
        let strokes = self.strokes.as_ref().filter(|_| stroke::Strokes::are_in(picture));

        let mut commands = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (mut load, mut deep) = (CLEAR, FAR);
        if has_behind {
            // One drawing serves both uses: the other surfaces are drawn over it.
            let targets = [(&bodies.alarm_colour, CLEAR), (&bodies.colour, CLEAR)];
            let depth = Some((&bodies.alarm_depth, FAR));
            let mut pass = Pass::begin(&gpu, &mut commands, "turned over", &targets, depth);
            self.surfaces.draw_turned_over(&mut pass, &self.panels, &places, colouring);
            drop(pass);
            bodies.copy_depth(&mut commands);
            (load, deep) = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
        }
        {
            let depth = Some((&bodies.depth, deep));
            let mut pass = Pass::begin(&gpu, &mut commands, "bodies", &[(&bodies.colour, load)], depth);
            self.surfaces.draw_sound(&mut pass, &self.panels, &places, colouring);
            if let Some(solids) = solids {
                solids.draw(&mut pass, &self.panels, &places);
            }
        }
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "borders", &[(&bodies.borders, CLEAR)], None);
            self.borders.draw(&mut pass, &self.panels, &places);
        }
        self.lines.test(&gpu, &mut commands, &self.panels, &places, with_solids);
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "lines", &[(&bodies.lines, CLEAR)], None);
            self.lines.draw(&mut pass, &self.panels, &places);
        }
        let [r, g, b] = panel::linear(picture.palette.background).to_array().map(f64::from);
        let background = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 });
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "picture", &[(&self.canvas.view, background)], None);
            self.grounds.draw(&mut pass, &self.panels, picture);
            if let Some(slabs) = slabs {
                slabs.draw(&mut pass, &self.panels, picture, false);
            }
            self.composite.draw(&mut pass, &self.panels, picture);
            if let Some(strokes) = strokes {
                strokes.draw(&mut pass, &self.panels, picture);
            }
            if let Some(slabs) = slabs {
                slabs.draw(&mut pass, &self.panels, picture, true);
            }
        }
        self.bodies = Some(bodies);
        Ok(self.read_back.submit(&gpu, commands, &self.canvas.texture))
    }
}

/// Empty: transparent, and infinitely far away.
const CLEAR: wgpu::LoadOp<wgpu::Color> = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
const FAR: wgpu::LoadOp<f32> = wgpu::LoadOp::Clear(0.0);
