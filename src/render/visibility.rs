//! The visibility of lines, tested once for each pixel of their length before they are drawn. Testing each pixel that a
//! line covers would take several times as long.

use super::panel::Panels;
use super::pipeline::{
    bind, compute_pipeline, element, group_layout, shader, storage_entry, texture_entry, uniform_entry,
};
use super::segment::{self, Kind, Segment};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer, Work};
use crate::picture::Rectangle;
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/visibility.wgsl");
/// The part of the shader about solid obstacles, without obstacles and with some.
const ALONE_SHADER: &str = include_str!("../../shaders/line_alone.wgsl");
const AMONG_SHADER: &str = include_str!("../../shaders/line_among.wgsl");

/// The format of results: four shares, used with the precision of a byte.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// As in the shaders: samples in a row of the texture, samples of a chunk, and threads of a group.
pub(super) const WIDTH: u32 = 2048;
pub(super) const CHUNK: u32 = 4;
pub(super) const GROUP: u32 = 128;

/// The distance between two ranges in their buffer (bytes).
const STRIDE: usize = 256;

/// The parts of the shader, without or with solid obstacles.
pub(super) fn parts(among: bool) -> [&'static str; 8] {
    let obstacles = if among { AMONG_SHADER } else { ALONE_SHADER };
    let [panel, segment, line] = segment::parts();
    [panel, segment, super::TAPS_SHADER, super::BODIES_SHADER, obstacles, super::TURNED_OVER_SHADER, line, SHADER]
}

/// Pipelines and their bindings.
#[derive(Debug)]
struct Variant {
    among: bool,
    module: wgpu::ShaderModule,
    /// Pipelines for each kind of line, made when first needed.
    pipelines: [Option<wgpu::ComputePipeline>; Kind::TESTED.len()],
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
}

/// The pipelines, and the visibility of the lines of one picture.
#[derive(Debug)]
pub(super) struct Visibility {
    alone: Variant,
    /// Pipelines with solid obstacles, made for the first ones.
    among: Option<Variant>,
    layout: wgpu::BindGroupLayout,
    /// The line of each chunk of samples, and the chunk's first sample on it.
    chunks: GrowingBuffer<[u32; 2]>,
    ranges: GrowingBuffer<u8>,
    bind_group: Option<wgpu::BindGroup>,
    found: wgpu::Texture,
    /// The numbers of chunks of each panel and kind.
    counts: Vec<[u32; Kind::TESTED.len()]>,
}

impl Visibility {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let found = wgpu::BindGroupLayoutEntry {
            binding: 2,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: FORMAT,
                view_dimension: wgpu::TextureViewDimension::D2,
            },
            count: None,
        };
        let entries = [storage_entry(0), storage_entry(1), found, uniform_entry(3, size_of::<[u32; 2]>(), true)];
        Self {
            alone: Variant::new(gpu, false),
            among: None,
            layout: group_layout(gpu, "visibility", &entries),
            chunks: GrowingBuffer::new(gpu, "samples of lines", wgpu::BufferUsages::STORAGE, 1024),
            ranges: GrowingBuffer::new(gpu, "ranges of samples", wgpu::BufferUsages::UNIFORM, 16 * STRIDE),
            bind_group: None,
            found: texture(gpu, 64),
            counts: Vec::new(),
        }
    }

    /// The results.
    pub(super) fn found(&self) -> wgpu::TextureView {
        self.found.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Binds new textures of bodies.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        self.alone.retarget(gpu, bodies);
        self.among.iter_mut().for_each(|among| among.retarget(gpu, bodies));
    }

    /// Prepares to test the lines of a picture, which lie in `lines` by panel and kind. Returns true if the results
    /// have a new texture.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        panels: &Panels,
        bodies: &Bodies,
        (segments, lines, is_new): (&[Segment], &wgpu::Buffer, bool),
        ranges_of_lines: &[[Range<u32>; Kind::ALL.len()]],
        among: bool,
    ) -> bool {
        if among && self.among.is_none() {
            let mut variant = Variant::new(gpu, true);
            variant.retarget(gpu, bodies);
            self.among = Some(variant);
        }
        let (mut chunks, mut ranges) = (Vec::new(), Vec::new());
        self.counts.clear();
        let mut samples = 0;
        for panel in ranges_of_lines {
            self.counts.push(std::array::from_fn(|kind| {
                let first = chunks.len() as u32;
                for line in panel[kind].clone() {
                    let own = segments[line as usize].samples();
                    samples = own.end;
                    chunks.extend((0..own.len() as u32).step_by(CHUNK as usize).map(|at| [line, at]));
                }
                let count = chunks.len() as u32 - first;
                ranges.extend_from_slice(bytemuck::bytes_of(&[first, count]));
                ranges.resize(ranges.len().next_multiple_of(STRIDE), 0);
                count
            }));
        }
        let rows = samples.div_ceil(WIDTH);
        let is_small = self.found.height() < rows;
        if is_small {
            self.found = texture(gpu, rows.next_power_of_two().min(gpu.longest_side()));
        }
        let replaced = [self.chunks.write(gpu, chunks), self.ranges.write(gpu, ranges), is_small, is_new];
        if replaced.contains(&true) || self.bind_group.is_none() {
            let found = self.found();
            let resources = [
                (0, self.chunks.buffer().as_entire_binding()),
                (1, lines.as_entire_binding()),
                (2, wgpu::BindingResource::TextureView(&found)),
                (3, element::<[u32; 2]>(self.ranges.buffer())),
            ];
            self.bind_group = Some(bind(gpu, "visibility", &self.layout, &resources));
        }
        let variant = if among { self.among.as_mut().expect("made above") } else { &mut self.alone };
        let is_tested = |kind: usize| self.counts.iter().any(|counts| counts[kind] > 0);
        for kind in (0..Kind::TESTED.len()).filter(|&kind| is_tested(kind)) {
            variant.prepare(gpu, &panels.layout, &self.layout, kind);
        }
        is_small
    }

    /// Tests all lines, with solid obstacles if there are any.
    pub(super) fn find(
        &self,
        gpu: &Gpu,
        commands: &mut wgpu::CommandEncoder,
        panels: &Panels,
        places: &[Rectangle],
        among: bool,
    ) {
        let variant = self.among.as_ref().filter(|_| among).unwrap_or(&self.alone);
        let mut pass = commands.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_bind_group(1, variant.textures.as_ref(), &[]);
        for (kind, pipeline) in variant.pipelines.iter().enumerate() {
            let Some(pipeline) = pipeline else { continue };
            pass.set_pipeline(pipeline);
            for (panel, counts) in self.counts.iter().enumerate() {
                let groups = (counts[kind] * CHUNK).div_ceil(GROUP);
                if groups == 0 || !super::panel::is_visible(places[panel]) {
                    continue;
                }
                panels.bind_region(&mut pass, panel);
                let range = (panel * Kind::TESTED.len() + kind) * STRIDE;
                pass.set_bind_group(2, self.bind_group.as_ref(), &[range as u32]);
                let wide = groups.min(MOST_GROUPS);
                gpu.note(Work::Draw(Kind::TESTED[kind]));
                pass.dispatch_workgroups(wide, groups.div_ceil(wide), 1);
            }
        }
    }
}

/// The number of groups in each direction that all devices support.
const MOST_GROUPS: u32 = 65_535;

/// The number of samples that a device has room for.
pub(super) fn most_samples(gpu: &Gpu) -> u64 {
    u64::from(WIDTH) * u64::from(gpu.longest_side())
}

/// The number of lines that a device has room for: two samples each take half of its room for samples.
pub(super) fn most_lines<T>(gpu: &Gpu) -> usize {
    most_bound::<T>(gpu).min((most_samples(gpu) / 4) as usize)
}

/// The number of lines that a device can bind.
pub(super) fn most_bound<T>(gpu: &Gpu) -> usize {
    let in_buffer = gpu.device().limits().max_storage_buffer_binding_size / size_of::<T>() as u64;
    // Buffers grow to powers of two.
    (if in_buffer.is_power_of_two() { in_buffer } else { in_buffer.next_power_of_two() / 2 }) as usize
}

fn texture(gpu: &Gpu, height: u32) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("visibility"),
        size: wgpu::Extent3d { width: WIDTH, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

impl Variant {
    fn new(gpu: &Gpu, among: bool) -> Self {
        let mut entries = vec![texture_entry(1, true), texture_entry(2, true)];
        if among {
            entries.push(texture_entry(0, false));
        }
        Self {
            among,
            module: shader(gpu, "visibility", &parts(among)),
            pipelines: [const { None }; Kind::TESTED.len()],
            layout: group_layout(gpu, "depth", &entries),
            textures: None,
        }
    }

    /// Makes the pipeline of a kind.
    fn prepare(&mut self, gpu: &Gpu, panel: &wgpu::BindGroupLayout, own: &wgpu::BindGroupLayout, kind: usize) {
        let groups = [panel, &self.layout, own];
        let build = || compute_pipeline(gpu, "visibility", &self.module, Kind::TESTED[kind], &groups);
        self.pipelines[kind].get_or_insert_with(build);
    }

    fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let all = [(1, &bodies.depth), (2, &bodies.alarm_depth), (0, &bodies.colour)];
        let views = if self.among { &all[..] } else { &all[..2] };
        self.textures = Some(super::pipeline::bind_textures(gpu, "depth", &self.layout, views));
    }
}
