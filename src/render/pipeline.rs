//! Short forms for making pipelines and bindings.

use crate::gpu::Gpu;
use crate::picture::measures;

/// The format of the picture, written as linear light. Its opacity is that of obstacles where one is nearest, and else 1 on bodies and 0 on the ground.
pub(super) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Depth is the near distance over the distance: 1 nearest, 0 infinitely far.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A pipeline.
pub(super) struct Recipe<'a> {
    pub(super) label: &'static str,
    pub(super) shader: &'a wgpu::ShaderModule,
    /// The entry points of its vertices and, with targets, of its pixels.
    pub(super) entries: [&'static str; 2],
    pub(super) groups: &'a [&'a wgpu::BindGroupLayout],
    pub(super) vertices: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(super) topology: wgpu::PrimitiveTopology,
    /// The number of targets, all in the format of the picture; without any, only depths are drawn.
    pub(super) targets: usize,
    pub(super) blend: Option<wgpu::BlendState>,
    pub(super) writes: wgpu::ColorWrites,
    /// The test of depth, if there is one, and whether depths are written.
    pub(super) depth: Option<(wgpu::CompareFunction, bool)>,
    /// Faces that are left out.
    pub(super) cull: Option<wgpu::Face>,
}

impl<'a> Recipe<'a> {
    /// Opaque triangles with depth.
    pub(super) fn new(label: &'static str, shader: &'a wgpu::ShaderModule, entries: [&'static str; 2]) -> Self {
        Self {
            label,
            shader,
            entries,
            groups: &[],
            vertices: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            targets: 1,
            blend: None,
            writes: wgpu::ColorWrites::ALL,
            depth: Some((wgpu::CompareFunction::Greater, true)),
            cull: None,
        }
    }

    pub(super) fn build(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let groups: Vec<_> = self.groups.iter().map(|group| Some(*group)).collect();
        let layout = gpu.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let target = wgpu::ColorTargetState { format: PICTURE_FORMAT, blend: self.blend, write_mask: self.writes };
        gpu.device().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(self.entries[0]),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: self.vertices,
            },
            primitive: wgpu::PrimitiveState { topology: self.topology, cull_mode: self.cull, ..Default::default() },
            depth_stencil: self.depth.map(|(compare, is_written)| wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(is_written),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: (self.targets > 0).then_some(wgpu::FragmentState {
                module: self.shader,
                entry_point: Some(self.entries[1]),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &vec![Some(target); self.targets],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// The layout of a buffer with one element for each vertex.
pub(super) fn for_vertices<T>(attributes: &[wgpu::VertexAttribute]) -> wgpu::VertexBufferLayout<'_> {
    let step_mode = wgpu::VertexStepMode::Vertex;
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}

/// The text of a shader from its parts, in order, after the measures that all share.
pub(super) fn joined(parts: &[&str]) -> String {
    measures::WGSL.to_owned() + &parts.concat()
}

/// A shader from its parts, in order.
pub(super) fn shader(gpu: &Gpu, label: &str, parts: &[&str]) -> wgpu::ShaderModule {
    gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(joined(parts).into()),
    })
}

/// A uniform struct of a size (bytes).
pub(super) fn uniform_entry(binding: u32, size: usize, has_dynamic_offset: bool) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: wgpu::BufferSize::new(size as u64),
        },
        count: None,
    }
}

/// A texture that is read pixel by pixel, or several of one size.
pub(super) fn texture_entry(
    binding: u32,
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false },
        count: None,
    }
}

/// A binding layout.
pub(super) fn group_layout(gpu: &Gpu, label: &str, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
}

/// Resources bound to numbers.
pub(super) fn bind(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// One element of a type in a buffer of uniforms, to be moved by a dynamic offset.
pub(super) fn element<T>(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(size_of::<T>() as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
}

/// A texture of a width, a height and a number of layers, with one sample a pixel.
pub(super) fn texture(
    gpu: &Gpu,
    label: &str,
    [width, height, layers]: [u32; 3],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
