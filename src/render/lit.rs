//! Lit bodies in space, with their floors, obstacles and lines, in this order:
//!
//! 1. `key`: what is nearest to the key light, where surfaces can shade each other.
//! 2. `surface`: turned-over elements, alone, to be seen through the body, and as surfaces of the body.
//! 3. `surface`: other elements; `ground`: the floor with its grid and its shadows, where no body is.
//! 4. `surface`: solid obstacles, less where bodies lie behind them; their depths are kept apart from those of bodies. `pane`: transparent obstacles, less where bodies lie behind them.
//! 5. `border` smooths pixels that lines between two colours cross, and `line` draws edges, contours, springs and nodes. Both
//!    need the depths of the picture, which are read back, and no device.
//!
//! Every pixel has one sample. The passes `key`, `surface`, `ground` and `pane` have one file here and one in `shaders/`.

use super::key::KeyMaps;
use super::pane::Panes;
use super::panel::{self, Panels};
use super::pipeline::PICTURE_FORMAT;
use super::surface::{Set, Surfaces};
use super::target::{Behind, Drawn, FAR, Layouts, Target, begin};
use super::{RenderError, border, ground, line};
use crate::gpu::{Gpu, Pending, ReadBack};
use crate::picture::{Item, Picture};
use wgpu::LoadOp;

/// Draws the lit bodies of pictures of one size. The same picture gives the same bytes, whatever was drawn before.
#[derive(Debug)]
pub(super) struct Lit {
    gpu: Gpu,
    size: [u32; 2],
    layouts: Layouts,
    panels: Panels,
    key_maps: KeyMaps,
    surfaces: Surfaces,
    grounds: ground::Grounds,
    picture: Target,
    drawn: Drawn,
    /// Made when first needed.
    panes: Option<Panes>,
    behind: Option<Behind>,
    solids: Option<Drawn>,
    read_back: ReadBack,
}

impl Lit {
    /// Prepares to draw pictures of a width and height (px).
    ///
    /// # Errors
    /// The device fails.
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, RenderError> {
        let ([width, height], longest) = (size, gpu.longest_side(size));
        if width.max(height) > longest {
            return Err(RenderError::Size { width, height, longest });
        }
        let (layouts, panels) = (Layouts::new(gpu), Panels::new(gpu));
        let lit = Self {
            gpu: gpu.clone(),
            size,
            key_maps: KeyMaps::new(gpu),
            surfaces: Surfaces::new(gpu),
            grounds: ground::Grounds::new(gpu, &panels),
            picture: Target::new(gpu, "picture", size, PICTURE_FORMAT),
            drawn: Drawn::new(gpu, &layouts, size),
            panes: None,
            behind: None,
            solids: None,
            read_back: ReadBack::new(size),
            layouts,
            panels,
        };
        gpu.check()?;
        Ok(lit)
    }

    /// Submits a picture and returns at once. Collect it before the next one is submitted: there is one buffer for
    /// each texture that is read back.
    pub(super) fn submit(&mut self, picture: &Picture) -> Pending {
        let Self { gpu, size, layouts, .. } = self;
        if self.behind.is_none() && picture.panels.iter().any(panel::has_behind) {
            self.behind = Some(Behind::new(gpu, layouts, *size));
        }
        if self.solids.is_none() && picture.panels.iter().any(|panel| !panel.obstacles.solids.is_empty()) {
            self.solids = Some(Drawn::new(gpu, layouts, *size));
        }
        let are_new = self.key_maps.write(gpu, &self.panels, picture);
        self.panels.write(gpu, picture, &self.key_maps.view, are_new);
        self.surfaces.write(gpu, &self.panels, layouts, picture);
        self.grounds.write(gpu, picture);
        let panes = Panes::are_in(picture).then(|| {
            let panes = self.panes.get_or_insert_with(|| Panes::new(gpu, &self.panels, layouts));
            panes.write(gpu, picture);
            &*panes
        });

        let mut commands = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.key_maps.draw(&mut commands, &self.panels, &self.surfaces, picture);
        let [r, g, b] = panel::linear(picture.palette.background).to_array().map(f64::from);
        let (mut ground, mut far) = (LoadOp::Clear(wgpu::Color { r, g, b, a: 0.0 }), FAR);
        let (drawn, depth) = (&self.picture, &self.drawn.depth);
        if let Some(Behind { colour, depth: alone, .. }) = &self.behind {
            // One drawing serves both uses: the other surfaces are drawn over it.
            let targets = [(colour, LoadOp::Clear(wgpu::Color::TRANSPARENT)), (drawn, ground)];
            let mut pass = begin(&mut commands, &targets, Some((&alone.view, far)));
            self.surfaces.draw(&mut pass, &self.panels, picture, Set::TurnedOver);
            drop(pass);
            let [from, to] = [alone, depth].map(|target| target.texture.as_image_copy());
            commands.copy_texture_to_texture(from, to, depth.texture.size());
            (ground, far) = (LoadOp::Load, LoadOp::Load);
        }
        {
            let mut pass = begin(&mut commands, &[(drawn, ground)], Some((&depth.view, far)));
            if let Some(behind) = &self.behind {
                pass.set_bind_group(1, &behind.group, &[]);
            }
            self.surfaces.draw(&mut pass, &self.panels, picture, Set::Sound);
            self.grounds.draw(&mut pass, &self.panels, picture);
        }
        let mut before = &self.drawn.group;
        if let Some(solids) = &self.solids {
            let [from, to] = [depth, &solids.depth].map(|target| target.texture.as_image_copy());
            commands.copy_texture_to_texture(from, to, depth.texture.size());
            let mut pass = begin(&mut commands, &[(drawn, LoadOp::Load)], Some((&solids.depth.view, LoadOp::Load)));
            pass.set_bind_group(1, before, &[]);
            self.surfaces.draw(&mut pass, &self.panels, picture, Set::Obstacles);
            before = &solids.group;
        }
        if let Some(panes) = panes {
            let mut pass = begin(&mut commands, &[(drawn, LoadOp::Load)], None);
            pass.set_bind_group(1, before, &[]);
            panes.draw(&mut pass, &self.panels, picture);
        }
        let others =
            [self.behind.as_ref().map(|behind| &behind.depth), self.solids.as_ref().map(|solids| &solids.depth)];
        let textures = [drawn, depth].into_iter().chain(others.into_iter().flatten());
        let textures: Vec<_> = textures.map(|target| &target.texture).collect();
        self.read_back.submit(gpu, commands, &textures)
    }

    /// Waits for a submitted picture, and returns the lines over its bodies. Its pixels are red, green, blue and full opacity,
    /// in rows from the top left.
    ///
    /// # Errors
    /// The device fails.
    pub(super) fn collect(
        &self,
        pending: Pending,
        picture: &Picture,
        pixels: &mut Vec<u8>,
    ) -> Result<Vec<Item>, RenderError> {
        let has = [self.behind.is_some(), self.solids.is_some()];
        Ok(self.read_back.collect(&self.gpu, pending, |layers| {
            let rows = layers.of::<u8>(0).chunks_exact(4 * layers.stride());
            rows.for_each(|row| pixels.extend_from_slice(&row[..4 * self.size[0] as usize]));
            // The painter needs full opacity. Marks of bodies and obstacles are read from the layer.
            pixels.as_chunks_mut::<4>().0.iter_mut().for_each(|pixel| pixel[3] = u8::MAX);
            let mut items = Vec::new();
            for panel in picture.panels.iter().filter(|panel| !panel.sight.flat && !panel.viewport[2..].contains(&0)) {
                let depths = line::Depths::new(panel, layers, has);
                border::smooth(&depths, pixels, self.size[0] as usize);
                items.extend(line::item(&depths, picture));
            }
            items
        })?)
    }
}
