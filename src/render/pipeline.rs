//! Short forms for making pipelines and bindings.

use crate::gpu::{Gpu, Work};
use crate::picture::measures;

/// The format of bodies: square roots of linear colours, multiplied with alpha.
pub(super) const BODY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Depth is the near distance over the distance: 1 nearest, 0 infinitely far.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The format of borders: additions to linear colours, multiplied with alpha.
pub(super) const BORDER_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Opacities of four kinds of lines.
pub(super) const LINE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// The finished picture, written as linear light.
pub(super) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A pipeline and its label.
#[derive(Debug)]
pub(super) struct Pipeline {
    pub(super) label: &'static str,
    pub(super) pipeline: wgpu::RenderPipeline,
}

/// The properties in which pipelines differ.
pub(super) struct Recipe<'a> {
    pub(super) label: &'static str,
    pub(super) shader: &'a wgpu::ShaderModule,
    pub(super) entries: [&'static str; 2],
    pub(super) groups: &'a [&'a wgpu::BindGroupLayout],
    pub(super) vertices: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(super) topology: wgpu::PrimitiveTopology,
    pub(super) target: wgpu::TextureFormat,
    /// The number of targets of that format.
    pub(super) targets: usize,
    pub(super) blend: Option<wgpu::BlendState>,
    pub(super) depth: bool,
}

impl<'a> Recipe<'a> {
    /// Rectangles of four corners without depth, blended by their opacity.
    pub(super) fn rectangles(
        label: &'static str,
        shader: &'a wgpu::ShaderModule,
        entries: [&'static str; 2],
        target: wgpu::TextureFormat,
    ) -> Self {
        Self {
            label,
            shader,
            entries,
            groups: &[],
            vertices: &[],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            target,
            targets: 1,
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            depth: false,
        }
    }

    /// Triangles without depth, blended by their opacity: three vertices for each line.
    pub(super) fn lines(
        label: &'static str,
        shader: &'a wgpu::ShaderModule,
        entries: [&'static str; 2],
        target: wgpu::TextureFormat,
    ) -> Self {
        let topology = wgpu::PrimitiveTopology::TriangleList;
        Self { topology, ..Self::rectangles(label, shader, entries, target) }
    }

    /// Opaque triangles with depth, in the textures that hold bodies.
    pub(super) fn bodies(label: &'static str, shader: &'a wgpu::ShaderModule, entries: [&'static str; 2]) -> Self {
        let topology = wgpu::PrimitiveTopology::TriangleList;
        let rectangles = Self::rectangles(label, shader, entries, BODY_FORMAT);
        Self { topology, blend: None, depth: true, ..rectangles }
    }

    pub(super) fn build(&self, gpu: &Gpu) -> Pipeline {
        let layout = pipeline_layout(gpu, self.label, self.groups);
        gpu.note(Work::Pipeline(self.label));
        let target =
            wgpu::ColorTargetState { format: self.target, blend: self.blend, write_mask: wgpu::ColorWrites::ALL };
        let pipeline = gpu.device().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(self.entries[0]),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: self.vertices,
            },
            primitive: wgpu::PrimitiveState { topology: self.topology, ..Default::default() },
            depth_stencil: self.depth.then(|| wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: self.shader,
                entry_point: Some(self.entries[1]),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &vec![Some(target); self.targets],
            }),
            multiview_mask: None,
            cache: None,
        });
        Pipeline { label: self.label, pipeline }
    }
}

/// A pipeline without any drawing.
pub(super) fn compute_pipeline(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    entry: &'static str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    gpu.note(Work::Pipeline(entry));
    gpu.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(label),
        layout: Some(&pipeline_layout(gpu, label, groups)),
        module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

fn pipeline_layout(gpu: &Gpu, label: &str, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|group| Some(*group)).collect();
    gpu.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

/// The layout of a buffer with one element for each vertex.
pub(super) fn for_vertices<T>(attributes: &[wgpu::VertexAttribute]) -> wgpu::VertexBufferLayout<'_> {
    let step_mode = wgpu::VertexStepMode::Vertex;
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}

/// The layout of a buffer with one element for each instance.
pub(super) fn for_instances<T>(attributes: &[wgpu::VertexAttribute]) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { step_mode: wgpu::VertexStepMode::Instance, ..for_vertices::<T>(attributes) }
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
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: wgpu::BufferSize::new(size as u64),
        },
        count: None,
    }
}

/// A buffer of any length that is read.
pub(super) fn storage_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX | wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

/// A texture that is read pixel by pixel.
pub(super) fn texture_entry(binding: u32, depth: bool) -> wgpu::BindGroupLayoutEntry {
    let sample_type = match depth {
        true => wgpu::TextureSampleType::Depth,
        false => wgpu::TextureSampleType::Float { filterable: false },
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
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

/// Textures bound to numbers.
pub(super) fn bind_textures(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    views: &[(u32, &wgpu::TextureView)],
) -> wgpu::BindGroup {
    let resources: Vec<_> =
        views.iter().map(|&(binding, view)| (binding, wgpu::BindingResource::TextureView(view))).collect();
    bind(gpu, label, layout, &resources)
}

/// One element of a type in a buffer of uniforms, to be moved by a dynamic offset.
pub(super) fn element<T>(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(size_of::<T>() as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
}

/// A texture of a width, a height and a number of layers, with one sample a pixel, written by the processor.
pub(super) fn written_texture(
    gpu: &Gpu,
    label: &str,
    [width, height, layers]: [u32; 3],
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}
