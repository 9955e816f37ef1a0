//! The visibility of lines, tested once for each pixel of their length before they are drawn. Testing each pixel that a
//! line covers would take several times as long.

use super::pipeline::{bind, compute_pipeline, element, group_layout, shader, storage_entry, uniform_entry};
use super::segment::{self, Kind, LineBuffer};
use super::stage::Stage;
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer, Work};
use crate::picture::Rectangle;
use std::collections::HashMap;
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/visibility.wgsl");

/// The format of results: four shares, used with the precision of a byte.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// As in the shaders: samples in a row of the texture, samples of a chunk, and threads of a group.
pub(super) const WIDTH: u32 = 2048;
pub(super) const CHUNK: u32 = 4;
pub(super) const GROUP: u32 = 128;

/// The distance between two ranges in their buffer (bytes).
const STRIDE: usize = 256;

/// The parts of the shader, without or with solid obstacles.
pub(super) fn parts(among: bool) -> [&'static str; 7] {
    let obstacles = if among { "const AMONG = true;\n" } else { "const AMONG = false;\n" };
    let [panel, segment, line] = segment::parts();
    [obstacles, panel, segment, super::BODIES_SHADER, super::TAPS_SHADER, line, SHADER]
}

/// The pipelines, and the visibility of the lines of one picture.
#[derive(Debug)]
pub(super) struct Visibility {
    /// Pipelines for each kind of line, without solid obstacles and with some, made when they are first needed.
    pipelines: HashMap<(usize, bool), wgpu::ComputePipeline>,
    /// Whether the picture has solid obstacles.
    among: bool,
    layout: wgpu::BindGroupLayout,
    /// The line of each chunk of samples, and the chunk's first sample on it.
    chunks: GrowingBuffer<[u32; 2]>,
    ranges: GrowingBuffer<u8>,
    bind_group: Option<wgpu::BindGroup>,
    found: wgpu::Texture,
    /// The numbers of chunks of each panel and kind.
    counts: Vec<[u32; Kind::ALL.len()]>,
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
            pipelines: HashMap::new(),
            among: false,
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

    /// Prepares to test the lines of a picture, which lie in `lines` by panel and kind. Returns true if the results
    /// have a new texture.
    pub(super) fn write(
        &mut self,
        stage: &Stage,
        (lines, is_new): (&LineBuffer, bool),
        ranges_of_lines: &[[Range<u32>; Kind::ALL.len()]],
        among: bool,
    ) -> bool {
        let (gpu, segments) = (&stage.gpu, lines.buffer.contents());
        self.among = among;
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
                (1, lines.buffer.buffer().as_entire_binding()),
                (2, wgpu::BindingResource::TextureView(&found)),
                (3, element::<[u32; 2]>(self.ranges.buffer())),
            ];
            self.bind_group = Some(bind(gpu, "visibility", &self.layout, &resources));
        }
        let is_tested = |kind: usize| self.counts.iter().any(|counts| counts[kind] > 0);
        for kind in (0..Kind::ALL.len()).filter(|&kind| is_tested(kind)) {
            let build = || {
                let groups = [&stage.panels.layout, &stage.layouts.drawn, &self.layout];
                let module = shader(gpu, "visibility", &parts(among));
                compute_pipeline(gpu, "visibility", &module, Kind::ALL[kind].entries()[0], &groups)
            };
            self.pipelines.entry((kind, among)).or_insert_with(build);
        }
        is_small
    }

    /// Tests all lines. The bodies must have been drawn.
    pub(super) fn find(
        &self,
        commands: &mut wgpu::CommandEncoder,
        stage: &Stage,
        bodies: &Bodies,
        places: &[Rectangle],
    ) {
        let mut pass = commands.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_bind_group(1, &bodies.drawn, &[]);
        for (at, kind) in Kind::ALL.into_iter().enumerate() {
            let Some(pipeline) = self.pipelines.get(&(at, self.among)) else { continue };
            pass.set_pipeline(pipeline);
            for (panel, counts) in self.counts.iter().enumerate() {
                let groups = (counts[at] * CHUNK).div_ceil(GROUP);
                if groups == 0 || !super::panel::is_visible(places[panel]) {
                    continue;
                }
                stage.panels.bind_region(&mut pass, panel);
                let range = (panel * Kind::ALL.len() + at) * STRIDE;
                pass.set_bind_group(2, self.bind_group.as_ref(), &[range as u32]);
                let wide = groups.min(MOST_GROUPS);
                stage.gpu.note(Work::Draw(kind.entries()[0]));
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
