//! Shaders on a graphics device, by wgpu: this is the only file that knows it.
//!
//! `Gpu::new → render → pixels`, or `Gpu::new → compute → words`; what is drawn many times is prepared once,
//! `Gpu::new → prepare → draw → … → pixels`. Whatever a driver does, an error comes back and nothing panics. The Vulkan
//! loader's device layers may write to the terminal; a binary that minds sets `NODEVICE_SELECT=1` before its threads
//! start.

use std::fmt::{self, Display, Formatter};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// How long one submission may take. A software driver compiles the shader within the first.
const TIMEOUT: Duration = Duration::from_secs(300);
/// naga recurses as deep as the text does; the usual 2 MiB are too few.
const STACK: usize = 64 << 20;
/// A copy to a buffer wants rows of a multiple of this many bytes.
const ROW: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;
/// About how many bytes are read back at once.
const BAND: u32 = 64 << 20;
/// Invocations in one workgroup of [`Gpu::compute`], as its shaders must declare.
pub const WORKGROUP: u32 = 64;

/// Which device to take.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum DevicePreference {
    /// Any: hardware before software.
    #[default]
    Any,
    /// The first whose name contains this, in any case.
    Named(String),
}

/// A device that could be taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceName {
    /// What the driver calls it.
    pub name: String,
    /// The driver and its version.
    pub driver: String,
    /// Whether it is a program that runs on the CPU.
    pub software: bool,
}

/// A shader. Both kinds have the uniform block in group 0 at binding 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shader<'a> {
    /// WGSL: `vs_main` and `fs_main` to draw, `main` to compute.
    Wgsl(&'a str),
    /// GLSL 450: a fragment shader to draw, a compute shader to compute.
    Glsl450(&'a str),
    /// SPIR-V, to draw, as it is given to a Vulkan driver: a module with `vs_main` and one with `fs_main`, which may
    /// be the same. It must be valid, since nothing looks at it before the driver does.
    SpirV {
        /// The bytes of the module with `vs_main`.
        vertex: &'a [u8],
        /// The bytes of the module with `fs_main`.
        fragment: &'a [u8],
    },
}

/// Why there is no result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum GpuError {
    /// There is no device, or none of that name; the names of those that are there.
    NoDevice {
        /// What was asked for.
        wanted: DevicePreference,
        /// The names of all devices.
        found: Vec<String>,
    },
    /// The picture is larger than the device allows.
    TooLarge {
        /// The device's limit, in pixels a side.
        limit: u32,
    },
    /// The device or its driver failed.
    Failed {
        /// What it was asked to do.
        doing: &'static str,
        /// What it said.
        message: String,
    },
}

impl GpuError {
    fn failed(doing: &'static str, message: impl Display) -> GpuError {
        GpuError::Failed { doing, message: message.to_string() }
    }
}

impl Display for GpuError {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            GpuError::NoDevice { wanted: DevicePreference::Any, .. } => {
                write!(f, "there is no graphics device; a software one is Mesa's lavapipe")
            }
            GpuError::NoDevice { wanted: DevicePreference::Named(name), found } => {
                write!(f, "no graphics device is called `{name}`; there are: {}", found.join(", "))
            }
            GpuError::TooLarge { limit } => write!(f, "the device draws at most {limit} pixels a side"),
            GpuError::Failed { doing, message } => write!(f, "{doing} failed: {message}"),
        }
    }
}

impl std::error::Error for GpuError {}

/// The devices, in the order in which they are preferred.
pub fn devices() -> Vec<DeviceName> {
    adapters().iter().map(device_name).collect()
}

fn adapters() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

fn device_name(adapter: &wgpu::Adapter) -> DeviceName {
    let info = adapter.get_info();
    let software = info.device_type == wgpu::DeviceType::Cpu;
    DeviceName { name: info.name, driver: format!("{} {}", info.driver, info.driver_info), software }
}

/// A device that is ready.
pub struct Gpu {
    name: DeviceName,
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// What the device complained about outside of any error scope.
    complaint: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Takes a device.
    pub fn new(preference: &DevicePreference) -> Result<Gpu, GpuError> {
        let adapters = adapters();
        let wanted = |adapter: &&wgpu::Adapter| match preference {
            DevicePreference::Any => true,
            DevicePreference::Named(name) => {
                adapter.get_info().name.to_lowercase().contains(&name.to_lowercase())
            }
        };
        let adapter = adapters.iter().find(wanted).ok_or_else(|| GpuError::NoDevice {
            wanted: preference.clone(),
            found: adapters.iter().map(|a| device_name(a).name).collect(),
        })?;
        let descriptor = wgpu::DeviceDescriptor {
            required_limits: adapter.limits(),
            required_features: adapter.features()
                & (wgpu::Features::PASSTHROUGH_SHADERS | wgpu::Features::TIMESTAMP_QUERY),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::failed("opening the device", error))?;
        let complaint = Arc::new(Mutex::new(None));
        let (errors, losses) = (complaint.clone(), complaint.clone());
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(&errors, error.to_string())));
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                note(&losses, format!("the device was lost: {message}"));
            }
        });
        Ok(Gpu { name: device_name(adapter), device, queue, complaint })
    }

    /// What the device is called.
    pub fn name(&self) -> &DeviceName {
        &self.name
    }

    /// The pixels of a picture, four bytes each, row by row from the top. `uniforms` are the bytes of the uniform
    /// block. It is drawn in tiles of `tile` pixels a side, each a submission of its own; `progress` is told how
    /// many are done, and of how many.
    pub fn render(
        &self,
        shader: Shader,
        size: [u32; 2],
        uniforms: &[u8],
        tile: u32,
        progress: &mut (dyn FnMut(u32, u32) + Send),
    ) -> Result<Vec<u8>, GpuError> {
        self.render_as(wgpu::TextureFormat::Rgba8Unorm, shader, size, uniforms, tile, progress)
    }

    /// [`Gpu::render`] with four floats for each pixel, as the shader gives them.
    pub fn render_floats(
        &self,
        shader: Shader,
        size: [u32; 2],
        uniforms: &[u8],
        tile: u32,
        progress: &mut (dyn FnMut(u32, u32) + Send),
    ) -> Result<Vec<f32>, GpuError> {
        let format = wgpu::TextureFormat::Rgba32Float;
        let bytes = self.render_as(format, shader, size, uniforms, tile, progress)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    fn render_as(
        &self,
        format: wgpu::TextureFormat,
        shader: Shader,
        [width, height]: [u32; 2],
        uniforms: &[u8],
        tile: u32,
        progress: &mut (dyn FnMut(u32, u32) + Send),
    ) -> Result<Vec<u8>, GpuError> {
        if width == 0 || height == 0 {
            return Ok(Vec::new());
        }
        let prepared = self.prepare_as(format, shader, [width, height], uniforms)?;
        prepared.draw(tile, progress)?;
        prepared.pixels()
    }

    /// A picture that is ready to be drawn, as [`render`](Gpu::render) would draw it: its pipeline is built.
    pub fn prepare(&self, shader: Shader, size: [u32; 2], uniforms: &[u8]) -> Result<Prepared<'_>, GpuError> {
        self.prepare_as(wgpu::TextureFormat::Rgba8Unorm, shader, size, uniforms)
    }

    fn prepare_as(
        &self,
        format: wgpu::TextureFormat,
        shader: Shader,
        [width, height]: [u32; 2],
        uniforms: &[u8],
    ) -> Result<Prepared<'_>, GpuError> {
        let limit = self.device.limits().max_texture_dimension_2d;
        if width > limit || height > limit {
            return Err(GpuError::TooLarge { limit });
        }
        deep(|| {
            let layout = self.layout(wgpu::ShaderStages::FRAGMENT, &[wgpu::BufferBindingType::Uniform])?;
            let pipeline = self.render_pipeline(shader, format, &layout)?;
            let block = self.buffer("the uniforms", wgpu::BufferUsages::UNIFORM, uniforms)?;
            let group = self.bind_group(&layout, &[&block])?;
            let texture = self.texture(format, width, height)?;
            Ok(Prepared { gpu: self, pipeline, group, texture })
        })
    }

    /// What a compute shader makes of the words `input` (storage, read only, binding 0): `output` words (storage,
    /// binding 1). It is run by `invocations` invocations or a few more, in workgroups of [`WORKGROUP`]; the
    /// workgroups lie in rows of 32,768.
    pub fn compute(
        &self,
        shader: Shader,
        input: &[u32],
        output: usize,
        invocations: u32,
    ) -> Result<Vec<u32>, GpuError> {
        deep(|| {
            let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
            let layout = self.layout(wgpu::ShaderStages::COMPUTE, &[storage(true), storage(false)])?;
            let pipeline = self.compute_pipeline(shader, &layout)?;
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let input = self.buffer("the input", usage, bytemuck::cast_slice(input))?;
            let output = self.buffer("the output", usage, &vec![0; 4 * output])?;
            let group = self.bind_group(&layout, &[&input, &output])?;
            let workgroups = invocations.div_ceil(WORKGROUP);
            let rows = workgroups.div_ceil(32_768);
            self.submit("computing", |encoder| {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(workgroups.min(32_768), rows, 1);
            })?;
            let bytes = self.read_buffer(output.size(), |encoder, to| {
                encoder.copy_buffer_to_buffer(&output, 0, to, 0, output.size());
            })?;
            Ok(bytemuck::pod_collect_to_vec(&bytes))
        })
    }
}

/// A picture that is ready to be drawn, once or again and again.
pub struct Prepared<'g> {
    gpu: &'g Gpu,
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    texture: wgpu::Texture,
}

impl Prepared<'_> {
    /// Draws the picture, and waits until it is drawn; a software driver compiles the shader the first time. It is
    /// drawn in tiles of `tile` pixels a side, each a submission of its own; `progress` is told how many are done, and
    /// of how many.
    pub fn draw(&self, tile: u32, progress: &mut (dyn FnMut(u32, u32) + Send)) -> Result<(), GpuError> {
        let (width, height) = (self.texture.width(), self.texture.height());
        let (columns, rows) = (width.div_ceil(tile.max(1)), height.div_ceil(tile.max(1)));
        deep(|| {
            for i in 0..columns * rows {
                let [x, y] = [i % columns * tile, i / columns * tile];
                let area = [x, y, tile.min(width - x), tile.min(height - y)];
                self.gpu.draw(&self.pipeline, &self.group, &self.texture, area)?;
                progress(i + 1, columns * rows);
            }
            Ok(())
        })
    }

    /// Draws the picture some times in one submission, each in a pass of its own, and tells how long one takes by the
    /// device's own clock, in the mean: from the beginning of the first pass to the end of the last. What the submission
    /// itself costs, and the way to the device, are no part of it. An error where the device has no clock.
    pub fn time(&self, passes: u32) -> Result<Duration, GpuError> {
        const DOING: &str = "timing";
        if passes == 0 {
            return Err(GpuError::failed(DOING, "there is no pass to time"));
        }
        let ticks = self.gpu.time(&self.pipeline, &self.group, &self.texture, passes)?;
        let nanoseconds = ticks as f64 * f64::from(self.gpu.queue.get_timestamp_period());
        Ok(Duration::from_secs_f64(nanoseconds * 1e-9 / f64::from(passes)))
    }

    /// The pixels as they were drawn last, in the bytes of their format, row by row from the top.
    pub fn pixels(&self) -> Result<Vec<u8>, GpuError> {
        self.gpu.read_texture(&self.texture)
    }
}

fn note(complaint: &Mutex<Option<String>>, message: String) {
    let mut complaint = complaint.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    complaint.get_or_insert(message);
}

/// Runs `work` on a thread with enough stack for deep shaders.
fn deep<T: Send>(work: impl FnOnce() -> Result<T, GpuError> + Send) -> Result<T, GpuError> {
    std::thread::scope(|scope| {
        let thread =
            std::thread::Builder::new().name("gpu".into()).stack_size(STACK).spawn_scoped(scope, work);
        let thread = thread.map_err(|error| GpuError::failed("starting a thread", error))?;
        thread.join().unwrap_or_else(|_| Err(GpuError::failed("driving the device", "it panicked")))
    })
}

// ---- making things

impl Gpu {
    /// Makes something inside error scopes, so that no error is lost and none is fatal.
    fn guarded<T>(&self, doing: &'static str, make: impl FnOnce() -> T) -> Result<T, GpuError> {
        let filters =
            [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::Validation];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let made = make();
        let mut errors = Vec::new();
        for scope in scopes.into_iter().rev() {
            errors.extend(pollster::block_on(scope.pop()));
        }
        match errors.first() {
            None => Ok(made),
            Some(error) => Err(GpuError::failed(doing, error)),
        }
    }

    fn module(&self, source: wgpu::ShaderSource) -> Result<wgpu::ShaderModule, GpuError> {
        let descriptor = wgpu::ShaderModuleDescriptor { label: None, source };
        self.guarded("compiling the shader", || self.device.create_shader_module(descriptor))
    }

    fn shader(&self, shader: Shader, stage: wgpu::naga::ShaderStage) -> Result<wgpu::ShaderModule, GpuError> {
        self.module(match shader {
            Shader::Wgsl(text) => wgpu::ShaderSource::Wgsl(text.into()),
            Shader::Glsl450(text) => wgpu::ShaderSource::Glsl { shader: text.into(), stage, defines: &[] },
            Shader::SpirV { vertex, fragment } => {
                return match stage {
                    wgpu::naga::ShaderStage::Vertex => self.spir_v(vertex),
                    wgpu::naga::ShaderStage::Fragment => self.spir_v(fragment),
                    _ => Err(GpuError::failed("compiling the shader", "SPIR-V is taken to draw only")),
                };
            }
        })
    }

    /// A module that goes to the driver as it is.
    fn spir_v(&self, bytes: &[u8]) -> Result<wgpu::ShaderModule, GpuError> {
        if !self.device.features().contains(wgpu::Features::PASSTHROUGH_SHADERS) {
            return Err(GpuError::failed("compiling the shader", "this device takes no SPIR-V"));
        }
        let (words, rest) = bytes.as_chunks::<4>();
        if !rest.is_empty() {
            return Err(GpuError::failed("compiling the shader", "SPIR-V comes in words of four bytes"));
        }
        let words: Vec<u32> = words.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let entry = |name| wgpu::PassthroughShaderEntryPoint { name, workgroup_size: (1, 1, 1) };
        let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
            entry_points: ["vs_main", "fs_main"].map(|name| entry(name.into())).to_vec().into(),
            spirv: Some(words.into()),
            ..wgpu::ShaderModuleDescriptorPassthrough::default()
        };
        // SAFETY: the caller has promised that the module is valid.
        self.guarded("compiling the shader", || unsafe {
            self.device.create_shader_module_passthrough(descriptor)
        })
    }

    /// One buffer at each binding of group 0.
    fn layout(
        &self,
        visibility: wgpu::ShaderStages,
        bindings: &[wgpu::BufferBindingType],
    ) -> Result<wgpu::BindGroupLayout, GpuError> {
        let entry = |(binding, ty): (usize, &wgpu::BufferBindingType)| wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility,
            ty: wgpu::BindingType::Buffer { ty: *ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let entries: Vec<wgpu::BindGroupLayoutEntry> = bindings.iter().enumerate().map(entry).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        self.guarded("laying out buffers", || self.device.create_bind_group_layout(&descriptor))
    }

    fn bind_group(
        &self,
        layout: &wgpu::BindGroupLayout,
        buffers: &[&wgpu::Buffer],
    ) -> Result<wgpu::BindGroup, GpuError> {
        let buffers = buffers.iter().enumerate();
        let entries: Vec<wgpu::BindGroupEntry> = buffers
            .map(|(i, b)| wgpu::BindGroupEntry { binding: i as u32, resource: b.as_entire_binding() })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        self.guarded("binding buffers", || self.device.create_bind_group(&descriptor))
    }

    fn pipeline_layout(&self, layout: &wgpu::BindGroupLayout) -> Result<wgpu::PipelineLayout, GpuError> {
        let layouts = [Some(layout)];
        let descriptor = wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts,
            ..wgpu::PipelineLayoutDescriptor::default()
        };
        self.guarded("laying out the pipeline", || self.device.create_pipeline_layout(&descriptor))
    }

    fn render_pipeline(
        &self,
        shader: Shader,
        format: wgpu::TextureFormat,
        layout: &wgpu::BindGroupLayout,
    ) -> Result<wgpu::RenderPipeline, GpuError> {
        let fragment = self.shader(shader, wgpu::naga::ShaderStage::Fragment)?;
        let (vertex, entry_point) = match shader {
            Shader::Wgsl(_) => (fragment.clone(), "fs_main"),
            Shader::Glsl450(_) => (self.module(wgpu::ShaderSource::Wgsl(VERTEX.into()))?, "main"),
            Shader::SpirV { .. } => (self.shader(shader, wgpu::naga::ShaderStage::Vertex)?, "fs_main"),
        };
        let layout = self.pipeline_layout(layout)?;
        let targets = [Some(format.into())];
        let descriptor = wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &vertex,
                entry_point: Some("vs_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &fragment,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        };
        self.guarded("building the pipeline", || self.device.create_render_pipeline(&descriptor))
    }

    fn compute_pipeline(
        &self,
        shader: Shader,
        layout: &wgpu::BindGroupLayout,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let module = self.shader(shader, wgpu::naga::ShaderStage::Compute)?;
        let layout = self.pipeline_layout(layout)?;
        let descriptor = wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        };
        self.guarded("building the pipeline", || self.device.create_compute_pipeline(&descriptor))
    }

    /// A buffer with these bytes, at least one word.
    fn buffer(
        &self,
        doing: &'static str,
        usage: wgpu::BufferUsages,
        bytes: &[u8],
    ) -> Result<wgpu::Buffer, GpuError> {
        let buffer =
            self.empty_buffer(doing, usage | wgpu::BufferUsages::COPY_DST, (bytes.len() as u64).max(16))?;
        self.guarded(doing, || self.queue.write_buffer(&buffer, 0, bytes))?;
        Ok(buffer)
    }

    fn empty_buffer(
        &self,
        doing: &'static str,
        usage: wgpu::BufferUsages,
        size: u64,
    ) -> Result<wgpu::Buffer, GpuError> {
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        self.guarded(doing, || self.device.create_buffer(&descriptor))
    }

    fn texture(
        &self,
        format: wgpu::TextureFormat,
        width: u32,
        height: u32,
    ) -> Result<wgpu::Texture, GpuError> {
        let descriptor = wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        };
        self.guarded("making the picture", || self.device.create_texture(&descriptor))
    }
}

/// One triangle that covers the picture, for fragment shaders that come alone.
const VERTEX: &str = "
@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    return vec4f(corner * 4.0 - 1.0, 0.0, 1.0);
}
";

// ---- running things

/// Records a pass that draws the part of the picture that lies in `[x, y, width, height]`.
fn pass(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::RenderPipeline,
    group: &wgpu::BindGroup,
    texture: &wgpu::Texture,
    [x, y, width, height]: [u32; 4],
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites>,
) {
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let attachment = wgpu::RenderPassColorAttachment {
        view: &view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
    };
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(attachment)],
        timestamp_writes,
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.set_scissor_rect(x, y, width, height);
    pass.draw(0..3, 0..1);
}

impl Gpu {
    /// Runs what `record` records, and waits for its end.
    fn submit(
        &self,
        doing: &'static str,
        record: impl FnOnce(&mut wgpu::CommandEncoder),
    ) -> Result<(), GpuError> {
        let index = self.guarded(doing, || {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            record(&mut encoder);
            self.queue.submit([encoder.finish()])
        })?;
        let wait = wgpu::PollType::Wait { submission_index: Some(index), timeout: Some(TIMEOUT) };
        self.device.poll(wait).map_err(|error| GpuError::failed(doing, error))?;
        let complaint = self.complaint.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take();
        complaint.map_or(Ok(()), |message| Err(GpuError::failed(doing, message)))
    }

    /// Draws the part of the picture that lies in `[x, y, width, height]`.
    fn draw(
        &self,
        pipeline: &wgpu::RenderPipeline,
        group: &wgpu::BindGroup,
        texture: &wgpu::Texture,
        area: [u32; 4],
    ) -> Result<(), GpuError> {
        self.submit("drawing", |encoder| pass(encoder, pipeline, group, texture, area, None))
    }

    /// Draws the whole picture so many times in one submission; the ticks of the device's clock from the beginning of the
    /// first to the end of the last.
    fn time(
        &self,
        pipeline: &wgpu::RenderPipeline,
        group: &wgpu::BindGroup,
        texture: &wgpu::Texture,
        passes: u32,
    ) -> Result<u64, GpuError> {
        const DOING: &str = "timing";
        if !self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(GpuError::failed(DOING, "this device does not tell the time"));
        }
        let descriptor = wgpu::QuerySetDescriptor { label: None, ty: wgpu::QueryType::Timestamp, count: 2 };
        let queries = self.guarded(DOING, || self.device.create_query_set(&descriptor))?;
        let size = u64::from(wgpu::QUERY_SIZE) * 2;
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let ticks = self.empty_buffer(DOING, usage, size)?;
        let area = [0, 0, texture.width(), texture.height()];
        self.submit(DOING, |encoder| {
            for i in 0..passes {
                let (begin, end) = ((i == 0).then_some(0), (i + 1 == passes).then_some(1));
                let times = wgpu::RenderPassTimestampWrites {
                    query_set: &queries,
                    beginning_of_pass_write_index: begin,
                    end_of_pass_write_index: end,
                };
                // A pass that neither begins nor ends the time writes none.
                let times = (begin.is_some() || end.is_some()).then_some(times);
                pass(encoder, pipeline, group, texture, area, times);
            }
            encoder.resolve_query_set(&queries, 0..2, &ticks, 0);
        })?;
        let bytes = self.read_buffer(size, |encoder, to| {
            encoder.copy_buffer_to_buffer(&ticks, 0, to, 0, size);
        })?;
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
        ticks[1].checked_sub(ticks[0]).ok_or_else(|| GpuError::failed(DOING, "the clock went backwards"))
    }

    /// The bytes of a picture without gaps, some rows at a time.
    fn read_texture(&self, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
        let (width, height) = (texture.width(), texture.height());
        let pixel = texture.format().block_copy_size(None).expect("a format of colours has one size");
        let row = (pixel * width).next_multiple_of(ROW);
        let band = (BAND / row).max(1);
        let mut pixels = Vec::with_capacity(pixel as usize * width as usize * height as usize);
        for top in (0..height).step_by(band as usize) {
            let rows = band.min(height - top);
            let bytes = self.read_buffer(u64::from(row) * u64::from(rows), |encoder, to| {
                encoder.copy_texture_to_buffer(
                    wgpu::TexelCopyTextureInfo {
                        texture,
                        mip_level: 0,
                        origin: wgpu::Origin3d { x: 0, y: top, z: 0 },
                        aspect: wgpu::TextureAspect::All,
                    },
                    wgpu::TexelCopyBufferInfo {
                        buffer: to,
                        layout: wgpu::TexelCopyBufferLayout {
                            offset: 0,
                            bytes_per_row: Some(row),
                            rows_per_image: None,
                        },
                    },
                    wgpu::Extent3d { width, height: rows, depth_or_array_layers: 1 },
                );
            })?;
            pixels.extend(bytes.chunks(row as usize).flat_map(|row| &row[..(pixel * width) as usize]));
        }
        Ok(pixels)
    }

    /// The bytes that `copy` copies to a buffer of `size` bytes.
    fn read_buffer(
        &self,
        size: u64,
        copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
    ) -> Result<Vec<u8>, GpuError> {
        const DOING: &str = "reading back";
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let buffer = self.empty_buffer(DOING, usage, size)?;
        self.submit(DOING, |encoder| copy(encoder, &buffer))?;
        let (sender, receiver) = std::sync::mpsc::channel();
        self.guarded(DOING, || {
            // The receiver lives as long as this function.
            buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result)));
        })?;
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(TIMEOUT) };
        self.device.poll(wait).map_err(|error| GpuError::failed(DOING, error))?;
        // Another thread that polls the device may be the one that runs the callback.
        match receiver.recv_timeout(TIMEOUT) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(GpuError::failed(DOING, error)),
            Err(error) => return Err(GpuError::failed(DOING, error)),
        }
        let bytes = buffer.get_mapped_range(..).map_err(|error| GpuError::failed(DOING, error))?.to_vec();
        buffer.unmap();
        Ok(bytes)
    }
}
