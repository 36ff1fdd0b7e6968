//! The terrain's GPU side: pipelines, the ground's textures, and one image that egui shows.
//!
//! The image is drawn by a command buffer of its own, before egui's pass, and only when what it depends on changed.

use bytemuck::{Pod, Zeroable};
use eframe::egui_wgpu::{RenderState, wgpu};
use wgpu::util::DeviceExt as _;

use crate::decal::Decal;
use crate::detail::{PATCH_QUADS, Patch};
use crate::ground::Ground;
use crate::shapes::{LineSegment, ShapeCorner, Shapes};
use crate::sunlight::Sunlight;

const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// What every shader knows of the view; the layout is that of `View` in `shading.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ViewUniform {
    /// Column by column.
    pub clip_from_world: [[f32; 4]; 4],
    /// The eye in meters, and the distance at which haze is full.
    pub eye: [f32; 4],
    /// Toward the sun, and the share of ambient light.
    pub sun: [f32; 4],
    /// Center of cell (0, 0), meters per cell, exaggeration of heights.
    pub origin_cell: [f32; 4],
    /// Least and greatest height, contour interval (0: none), grid spacing (0: none).
    pub range: [f32; 4],
    /// Width and height in pixels, coloring (0 natural, 1 height, 2 slope), strength of the overlay.
    pub image: [f32; 4],
    /// The color of distance, and the distance of the near plane in meters.
    pub horizon: [f32; 4],
    /// Column by column.
    pub world_from_clip: [[f32; 4]; 4],
    /// How strong the ground's detail is, whether there is a sky (1) or not (0), how strong shadows are, and how much
    /// daylight there is.
    pub look: [f32; 4],
}

/// Everything one image depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub view: ViewUniform,
    /// The ground's patches.
    pub patches: Vec<Patch>,
    /// What stands and lies on it.
    pub shapes: Shapes,
    /// Whether the volumes of obstacles are shown.
    pub has_volumes: bool,
    /// Color behind everything.
    pub background: [f32; 3],
}

/// GPU resources of one terrain view.
pub struct TerrainImage {
    pipelines: Pipelines,
    grid: wgpu::Buffer,
    grid_indices: wgpu::Buffer,
    index_count: u32,
    view_buffer: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    ground: Option<GroundTextures>,
    ground_group: Option<wgpu::BindGroup>,
    /// The volumes of obstacles, and how many corners they have.
    volumes: Option<(wgpu::Buffer, u32)>,
    targets: Option<Targets>,
    drawn: Option<Frame>,
}

/// The ground on the graphics card, and what lies on it.
struct GroundTextures {
    heights: wgpu::TextureView,
    normals: wgpu::TextureView,
    decal: wgpu::TextureView,
    sunlight: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

struct Pipelines {
    sky: wgpu::RenderPipeline,
    ground: wgpu::RenderPipeline,
    shapes: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    ground_layout: wgpu::BindGroupLayout,
    samples: u32,
}

struct Targets {
    size: [u32; 2],
    multisampled: Option<wgpu::TextureView>,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    texture: egui::TextureId,
}

impl TerrainImage {
    /// Makes the pipelines. Where the adapter is a processor, edges are not smoothed: it would be too slow.
    pub fn new(state: &RenderState) -> Self {
        let device = &state.device;
        let samples = if state.adapter.get_info().device_type == wgpu::DeviceType::Cpu { 1 } else { 4 };
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrain view"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let pipelines = Pipelines::new(device, &view_layout, samples);
        let view_buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrain view"),
            size: size_of::<ViewUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrain view"),
            layout: &view_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: view_buffer.as_entire_binding() }],
        });
        let (corners, indices) = patch_mesh();
        let buffer = |contents: &[u8], usage| filled_buffer(state, "terrain patch", contents, usage);
        Self {
            pipelines,
            grid: buffer(bytemuck::cast_slice(&corners), wgpu::BufferUsages::VERTEX),
            grid_indices: buffer(bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            index_count: indices.len() as u32,
            view_buffer,
            view_group,
            ground: None,
            ground_group: None,
            volumes: None,
            targets: None,
            drawn: None,
        }
    }

    /// Returns whether the graphics card holds a ground of this size: some browsers allow textures of 2048 a side only.
    pub fn holds(state: &RenderState, ground: &Ground) -> bool {
        ground.width.max(ground.height) <= max_side(state)
    }

    /// Uploads the ground, with nothing lying on it; none if the graphics card does not hold it.
    pub fn set_ground(&mut self, state: &RenderState, ground: &Ground) {
        if !Self::holds(state, ground) {
            (self.ground, self.ground_group, self.drawn) = (None, None, None);
            return;
        }
        let normals: Vec<[u8; 4]> = (0..ground.height)
            .flat_map(|row| (0..ground.width).map(move |column| (column, row)))
            .map(|(column, row)| {
                let normal = ground.cell_normal(column, row);
                let byte = |value: f32| ((value * 0.5 + 0.5) * 255.0).round() as u8;
                [byte(normal.x), byte(normal.y), byte(normal.z), 255]
            })
            .collect();
        let size = [ground.width, ground.height];
        let heights = bytemuck::cast_slice(&ground.heights_m);
        self.ground = Some(GroundTextures {
            heights: texture(state, wgpu::TextureFormat::R32Float, heights, size),
            normals: texture(state, wgpu::TextureFormat::Rgba8Unorm, bytemuck::cast_slice(&normals), size),
            decal: no_decal(state),
            sunlight: texture(state, wgpu::TextureFormat::R8Unorm, &[255], [1, 1]),
            sampler: state.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("terrain ground"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        });
        self.bind_ground(state);
    }

    /// Lays an image on the ground, or takes it away.
    pub fn set_decal(&mut self, state: &RenderState, decal: Option<&Decal>) {
        let Some(ground) = &mut self.ground else { return };
        ground.decal = match decal {
            Some(decal) => {
                let data = bytemuck::cast_slice(&decal.pixels);
                texture(state, wgpu::TextureFormat::Rgba8Unorm, data, [decal.width, decal.height])
            }
            None => no_decal(state),
        };
        self.bind_ground(state);
    }

    /// Tells which ground the sun reaches.
    pub fn set_sunlight(&mut self, state: &RenderState, light: &Sunlight) {
        let Some(ground) = &mut self.ground else { return };
        ground.sunlight =
            texture(state, wgpu::TextureFormat::R8Unorm, &light.pixels, [light.width, light.height]);
        self.bind_ground(state);
    }

    /// Puts the volumes of obstacles on the ground, in place of those before.
    pub fn set_volumes(&mut self, state: &RenderState, volumes: &Shapes) {
        let corners = bytemuck::cast_slice(&volumes.triangles);
        let count = volumes.triangles.len() as u32;
        self.volumes = (count > 0)
            .then(|| (filled_buffer(state, "terrain volumes", corners, wgpu::BufferUsages::VERTEX), count));
        self.drawn = None;
    }

    fn bind_ground(&mut self, state: &RenderState) {
        let Some(ground) = &self.ground else { return };
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        self.ground_group = Some(state.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrain ground"),
            layout: &self.pipelines.ground_layout,
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(&ground.heights)),
                entry(1, wgpu::BindingResource::TextureView(&ground.normals)),
                entry(2, wgpu::BindingResource::TextureView(&ground.decal)),
                entry(3, wgpu::BindingResource::Sampler(&ground.sampler)),
                entry(4, wgpu::BindingResource::TextureView(&ground.sunlight)),
            ],
        }));
        self.drawn = None;
    }

    /// Draws `frame` in an image of `size` pixels, unless it already shows just that, and gives egui's name of it.
    pub fn draw(&mut self, state: &RenderState, size: [u32; 2], frame: Frame) -> egui::TextureId {
        let size = size.map(|side| side.clamp(1, max_side(state).min(4096)));
        if self.targets.as_ref().is_none_or(|targets| targets.size != size) {
            if let Some(old) = self.targets.take() {
                state.renderer.write().free_texture(&old.texture);
            }
            self.targets = Some(Targets::new(state, size, self.pipelines.samples));
            self.drawn = None;
        }
        let Some(targets) = &self.targets else { return egui::TextureId::default() };
        if self.drawn.as_ref() == Some(&frame) {
            return targets.texture;
        }
        self.record(state, targets, &frame);
        let texture = targets.texture;
        self.drawn = Some(frame);
        texture
    }

    fn record(&self, state: &RenderState, targets: &Targets, frame: &Frame) {
        let device = &state.device;
        state.queue.write_buffer(&self.view_buffer, 0, bytemuck::bytes_of(&frame.view));
        let vertex_buffer =
            |contents: &[u8]| filled_buffer(state, "terrain shapes", contents, wgpu::BufferUsages::VERTEX);
        let patches: Vec<[u32; 4]> =
            frame.patches.iter().map(|patch| [patch.cell[0], patch.cell[1], patch.stride, 0]).collect();
        let patch_buffer = vertex_buffer(bytemuck::cast_slice(&patches));
        let triangle_buffer = vertex_buffer(bytemuck::cast_slice(&frame.shapes.triangles));
        let line_buffer = vertex_buffer(bytemuck::cast_slice(&frame.shapes.lines));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = targets.begin(&mut encoder, frame.background);
            pass.set_bind_group(0, &self.view_group, &[]);
            if frame.view.look[1] > 0.0 {
                pass.set_pipeline(&self.pipelines.sky);
                pass.draw(0..3, 0..1);
            }
            if let Some(ground) = self.ground_group.as_ref().filter(|_| !patches.is_empty()) {
                pass.set_pipeline(&self.pipelines.ground);
                pass.set_bind_group(1, ground, &[]);
                pass.set_vertex_buffer(0, self.grid.slice(..));
                pass.set_vertex_buffer(1, patch_buffer.slice(..));
                pass.set_index_buffer(self.grid_indices.slice(..), wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..self.index_count, 0, 0..patches.len() as u32);
            }
            if let Some((volumes, corners)) = self.volumes.as_ref().filter(|_| frame.has_volumes) {
                pass.set_pipeline(&self.pipelines.shapes);
                pass.set_vertex_buffer(0, volumes.slice(..));
                pass.draw(0..*corners, 0..1);
            }
            if !frame.shapes.triangles.is_empty() {
                pass.set_pipeline(&self.pipelines.shapes);
                pass.set_vertex_buffer(0, triangle_buffer.slice(..));
                pass.draw(0..frame.shapes.triangles.len() as u32, 0..1);
            }
            if !frame.shapes.lines.is_empty() {
                pass.set_pipeline(&self.pipelines.lines);
                pass.set_vertex_buffer(0, line_buffer.slice(..));
                pass.draw(0..6, 0..frame.shapes.lines.len() as u32);
            }
        }
        state.queue.submit([encoder.finish()]);
    }
}

/// The largest side of a texture.
fn max_side(state: &RenderState) -> u32 {
    state.device.limits().max_texture_dimension_2d
}

/// A buffer with this content. It is filled by the queue: a buffer that is mapped at its creation throws in a browser
/// whose device is lost.
fn filled_buffer(
    state: &RenderState,
    label: &str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let padded_bytes = contents.len().next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT as usize);
    let buffer = state.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: padded_bytes.max(wgpu::COPY_BUFFER_ALIGNMENT as usize) as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    if padded_bytes == contents.len() {
        state.queue.write_buffer(&buffer, 0, contents);
    } else {
        let mut padded = contents.to_vec();
        padded.resize(padded_bytes, 0);
        state.queue.write_buffer(&buffer, 0, &padded);
    }
    buffer
}

fn texture(
    state: &RenderState,
    format: wgpu::TextureFormat,
    data: &[u8],
    [width, height]: [u32; 2],
) -> wgpu::TextureView {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("terrain ground"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = state.device.create_texture_with_data(&state.queue, &descriptor, order, data);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn no_decal(state: &RenderState) -> wgpu::TextureView {
    texture(state, wgpu::TextureFormat::Rgba8Unorm, &[0; 4], [1, 1])
}

/// The corners of a patch (column, row, 1 on the skirt) and the triangles between them. The skirt hangs from the
/// border and hides the cracks between patches of different detail.
fn patch_mesh() -> (Vec<[u8; 4]>, Vec<u16>) {
    let side = PATCH_QUADS as u16 + 1;
    let mut corners: Vec<[u8; 4]> =
        (0..side).flat_map(|row| (0..side).map(move |column| [column as u8, row as u8, 0, 0])).collect();
    let mut indices = Vec::new();
    let at = |column: u16, row: u16| row * side + column;
    for row in 0..side - 1 {
        for column in 0..side - 1 {
            let (a, b, c, d) =
                (at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1));
            indices.extend([a, b, c, a, c, d]);
        }
    }
    let last = side - 1;
    let border: Vec<u16> = (0..last)
        .map(|i| at(i, 0))
        .chain((0..last).map(|i| at(last, i)))
        .chain((0..last).map(|i| at(last - i, last)))
        .chain((0..last).map(|i| at(0, last - i)))
        .collect();
    let skirt = corners.len() as u16;
    for &corner in &border {
        let [column, row, ..] = corners[corner as usize];
        corners.push([column, row, 1, 0]);
    }
    let around = border.len() as u16;
    for index in 0..around {
        let next = (index + 1) % around;
        let (a, b) = (border[index as usize], border[next as usize]);
        let (low_a, low_b) = (skirt + index, skirt + next);
        indices.extend([a, low_a, b, b, low_a, low_b]);
    }
    (corners, indices)
}

impl Pipelines {
    fn new(device: &wgpu::Device, view_layout: &wgpu::BindGroupLayout, samples: u32) -> Self {
        let module = device.create_shader_module(wgpu::include_wgsl!("shading.wgsl"));
        let texture_entry = |binding, visibility, filterable| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let ground_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrain ground"),
            entries: &[
                texture_entry(0, wgpu::ShaderStages::VERTEX, false),
                texture_entry(1, wgpu::ShaderStages::FRAGMENT, true),
                texture_entry(2, wgpu::ShaderStages::FRAGMENT, true),
                wgpu::BindGroupLayoutEntry {
                    binding: 3,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
                texture_entry(4, wgpu::ShaderStages::FRAGMENT, true),
            ],
        });
        let layout = |groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("terrain"),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let ground_layouts = layout(&[Some(view_layout), Some(&ground_layout)]);
        let shape_layouts = layout(&[Some(view_layout)]);
        let attributes = |format, count: u32, first: u32| -> Vec<wgpu::VertexAttribute> {
            (0..count)
                .map(|index| wgpu::VertexAttribute {
                    format,
                    offset: u64::from(index) * 16,
                    shader_location: first + index,
                })
                .collect()
        };
        let grid = attributes(wgpu::VertexFormat::Uint8x4, 1, 0);
        let patch = attributes(wgpu::VertexFormat::Uint32x4, 1, 1);
        let line = attributes(wgpu::VertexFormat::Float32x4, 3, 0);
        let shape = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x4];
        let buffer = |stride: usize, step_mode, attributes| {
            Some(wgpu::VertexBufferLayout { array_stride: stride as u64, step_mode, attributes })
        };
        let ground_buffers = [
            buffer(4, wgpu::VertexStepMode::Vertex, &grid[..]),
            buffer(16, wgpu::VertexStepMode::Instance, &patch[..]),
        ];
        let shape_buffers = [buffer(size_of::<ShapeCorner>(), wgpu::VertexStepMode::Vertex, &shape[..])];
        let line_buffers = [buffer(size_of::<LineSegment>(), wgpu::VertexStepMode::Instance, &line[..])];
        let make = |name: &str, layout, buffers: &[Option<wgpu::VertexBufferLayout<'_>>], writes_depth| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(name),
                layout: Some(layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(&format!("{name}_vertex")),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(writes_depth),
                    depth_compare: Some(wgpu::CompareFunction::LessEqual),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(&format!("{name}_fragment")),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: COLOR_FORMAT,
                        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            sky: make("sky", &shape_layouts, &[], false),
            ground: make("ground", &ground_layouts, &ground_buffers, true),
            shapes: make("shape", &shape_layouts, &shape_buffers, true),
            lines: make("line", &shape_layouts, &line_buffers, false),
            ground_layout,
            samples,
        }
    }
}

impl Targets {
    fn new(state: &RenderState, size: [u32; 2], samples: u32) -> Self {
        let view = |format, usage, sample_count| {
            state
                .device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some("terrain image"),
                    size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                    mip_level_count: 1,
                    sample_count,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage,
                    view_formats: &[],
                })
                .create_view(&wgpu::TextureViewDescriptor::default())
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let color = view(COLOR_FORMAT, attachment | wgpu::TextureUsages::TEXTURE_BINDING, 1);
        let texture =
            state.renderer.write().register_native_texture(&state.device, &color, wgpu::FilterMode::Linear);
        Self {
            size,
            multisampled: (samples > 1).then(|| view(COLOR_FORMAT, attachment, samples)),
            depth: view(DEPTH_FORMAT, attachment, samples),
            color,
            texture,
        }
    }

    fn begin<'encoder>(
        &self,
        encoder: &'encoder mut wgpu::CommandEncoder,
        background: [f32; 3],
    ) -> wgpu::RenderPass<'encoder> {
        let [r, g, b] = background.map(f64::from);
        let (view, resolve_target) = match &self.multisampled {
            Some(multisampled) => (multisampled, Some(&self.color)),
            None => (&self.color, None),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrain"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }
}
