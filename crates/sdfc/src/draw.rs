//! Shaders to pictures: on a graphics device, or by the interpreter.

use crate::measured::{Measured, type_beside};
use crate::{Clock, Shader};
use sdf_ir::Type;
use sdf_render::{Drawn, Frame, Picture, cpu};
use sdf_syntax::Diagnostic;
use std::fmt::{self, Display, Formatter};

#[cfg(feature = "gpu")]
use {
    crate::{Format, Target},
    sdf_emit::UniformLayout,
    sdf_render::gpu::{DevicePreference, Gpu, GpuError, Shader as Source},
};

/// What draws.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Device {
    /// A graphics device, hardware before software; the CPU where there is none.
    #[default]
    Auto,
    /// A graphics device, hardware before software.
    Gpu,
    /// The interpreter.
    Cpu,
    /// The graphics device whose name contains this.
    Named(String),
}

/// In which language a graphics device is given the shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Language {
    /// WGSL.
    #[default]
    Wgsl,
    /// GLSL.
    Glsl,
    /// SPIR-V, which the driver is given as it is.
    SpirV,
}

/// Is told the part of a picture that is done, 0 to 1, perhaps by several threads at once.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// A picture that has been drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// The picture.
    pub picture: Picture,
    /// What was measured, where the scene was compiled for a [`View`](sdf_lang::View).
    pub measured: Option<Measured>,
    /// What drew it.
    pub device: String,
    /// Why it is not what was preferred, where that is so.
    pub fallback: Option<String>,
}

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq)]
pub enum DrawError {
    /// What the device, or the search for one, said.
    Device(String),
    /// The shader is not valid, which is a mistake of the compiler's.
    Shader(Diagnostic),
}

impl Display for DrawError {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            DrawError::Device(message) => f.write_str(message),
            DrawError::Shader(diagnostic) => f.write_str(&diagnostic.message),
        }
    }
}

impl std::error::Error for DrawError {}

/// A graphics device that is ready.
#[cfg(feature = "gpu")]
pub(crate) fn open(device: &Device) -> Result<Gpu, DrawError> {
    let preference = match device {
        Device::Named(name) => DevicePreference::Named(name.clone()),
        Device::Auto | Device::Gpu | Device::Cpu => DevicePreference::Any,
    };
    Gpu::new(&preference).map_err(failed)
}

/// What a device has said.
#[cfg(feature = "gpu")]
pub(crate) fn failed(error: GpuError) -> DrawError {
    DrawError::Device(error.to_string())
}

impl Shader {
    /// Draws the scene.
    pub fn draw(
        &self,
        frame: &Frame,
        device: &Device,
        language: Language,
        progress: Progress,
        clock: &mut Clock,
    ) -> Result<Drawing, DrawError> {
        match device {
            Device::Cpu => Ok(self.draw_on_cpu(frame, None, progress, clock)),
            Device::Gpu | Device::Named(_) => self.draw_on_gpu(frame, device, language, progress, clock),
            Device::Auto => match self.draw_on_gpu(frame, device, language, progress, clock) {
                Err(DrawError::Device(why)) => Ok(self.draw_on_cpu(frame, Some(why), progress, clock)),
                other => other,
            },
        }
    }

    fn draw_on_cpu(
        &self,
        frame: &Frame,
        fallback: Option<String>,
        progress: Progress,
        clock: &mut Clock,
    ) -> Drawing {
        let (drawn, _) =
            clock.time("draw on the CPU", || cpu::render_with(&self.program, frame, false, progress));
        self.drawing(drawn, "CPU".into(), fallback)
    }

    fn drawing(&self, drawn: Drawn, device: String, fallback: Option<String>) -> Drawing {
        let measured = Measured::of(&self.program, &drawn.beside);
        Drawing { picture: drawn.picture, measured, device, fallback }
    }

    #[cfg(feature = "gpu")]
    fn draw_on_gpu(
        &self,
        frame: &Frame,
        device: &Device,
        language: Language,
        progress: Progress,
        clock: &mut Clock,
    ) -> Result<Drawing, DrawError> {
        /// The side of the tiles that are drawn at once, in pixels: small enough that no driver loses patience.
        const TILE: u32 = 128;

        let gpu = clock.time("open the device", || open(device))?;
        let format = match language {
            Language::Wgsl => Format::Text(Target::Wgsl),
            Language::Glsl => Format::Text(Target::Glsl450),
            Language::SpirV => Format::SpirV,
        };
        let file = clock.time("write and validate", || self.file(format)).map_err(DrawError::Shader)?;
        let text = || std::str::from_utf8(&file).expect("a text is UTF-8");
        let shader = match language {
            Language::Wgsl => Source::Wgsl(text()),
            Language::Glsl => Source::Glsl450(text()),
            Language::SpirV => Source::SpirV { vertex: &file, fragment: &file },
        };
        let size = [frame.width, frame.height];
        let uniforms = self.uniforms(frame);
        let mut tell = |done: u32, of: u32| progress(f64::from(done) / f64::from(of));
        let [width, height] = size;
        let drawn = clock.time("draw", || match type_beside(&self.program) {
            Some(Type::Float) => {
                let floats = gpu.render_floats(shader, size, &uniforms, TILE, &mut tell);
                floats.map(|floats| Drawn::from_floats(width, height, &floats))
            }
            beside => {
                let bytes = gpu.render(shader, size, &uniforms, TILE, &mut tell);
                bytes.map(|rgba| match beside {
                    Some(_) => Drawn::from_bytes(width, height, rgba),
                    None => Drawn { picture: Picture { width, height, rgba }, beside: Vec::new() },
                })
            }
        });
        Ok(self.drawing(drawn.map_err(failed)?, gpu.name().name.clone(), None))
    }

    /// The bytes of the uniform block.
    #[cfg(feature = "gpu")]
    pub(crate) fn uniforms(&self, frame: &Frame) -> Vec<u8> {
        let values = frame.uniforms(&self.program);
        UniformLayout::of(&self.program).bytes([frame.width, frame.height], &values)
    }

    #[cfg(not(feature = "gpu"))]
    fn draw_on_gpu(
        &self,
        _: &Frame,
        _: &Device,
        _: Language,
        _: Progress,
        _: &mut Clock,
    ) -> Result<Drawing, DrawError> {
        Err(DrawError::Device("this build of sdfc cannot use graphics devices".into()))
    }
}
