//! Where a scene's probe is run.

use crate::adapter::{self, adapter};
use crate::canvas::Canvas;
use crate::run::Kernel;
use crate::scenes::{Buffers, coordinates};
use crate::swiftshader;
use sdf_emit::KernelLanguage;
use sdf_ir::Program;
use sdf_render::Frame;

/// An execution of a program.
#[derive(Clone, Copy)]
pub enum Execution<'a> {
    /// The interpreter's lanes, in `f32`.
    Interpreter,
    /// The [device](crate::adapter), by a compute shader.
    Adapter(KernelLanguage),
    /// SwiftShader, by the program `compute` that lies at this path.
    SwiftShader(&'a str, KernelLanguage),
    /// Chromium's WebGPU.
    Chromium(&'a Canvas<'a>),
}

impl Execution<'_> {
    /// What tables call it.
    pub fn name(&self) -> String {
        let of = |driver, language: &KernelLanguage| match language {
            KernelLanguage::Wgsl => format!("{driver}, WGSL"),
            KernelLanguage::Glsl450 => format!("{driver}, GLSL"),
        };
        match self {
            Execution::Interpreter => "interpreter".into(),
            Execution::Adapter(language) => of(adapter::title(), language),
            Execution::SwiftShader(_, language) => of("SwiftShader", language),
            Execution::Chromium(_) => "Chromium, WebGPU".into(),
        }
    }

    /// The language of the shader, if it is one.
    fn language(&self) -> Option<KernelLanguage> {
        match self {
            Execution::Interpreter => None,
            Execution::Adapter(language) | Execution::SwiftShader(_, language) => Some(*language),
            Execution::Chromium(_) => Some(KernelLanguage::Wgsl),
        }
    }

    /// What the pixels of a frame show, by a program whose entry is a probe; or what a driver has against it. `change` is what
    /// becomes of its shader before a driver takes it.
    pub fn buffers(
        &self,
        program: &Program,
        frame: &Frame,
        change: fn(Kernel) -> Kernel,
    ) -> Result<Buffers, String> {
        let Some(language) = self.language() else { return Ok(Buffers::of_program(program, frame)) };
        let probe = program.entry.expect("a probe");
        let kernel =
            change(Kernel::of(program, probe, language, &frame.uniforms(program), &coordinates(frame)));
        let words = match self {
            Execution::SwiftShader(path, _) => swiftshader::compute(path, &kernel),
            Execution::Chromium(canvas) => canvas.compute(&kernel),
            _ => kernel.words_on(adapter()).map_err(|error| error.to_string()),
        }?;
        let numbers = |column: Vec<u32>| column.into_iter().map(f32::from_bits).collect();
        let columns: Vec<Vec<f32>> = kernel.columns(&words).into_iter().map(numbers).collect();
        Ok(Buffers::of_columns(frame, &columns))
    }
}
