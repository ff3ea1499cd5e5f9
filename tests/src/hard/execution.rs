//! Where a scene's probe is run.

use crate::canvas::Canvas;
use crate::run::{Kernel, lavapipe};
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
    /// Mesa's software driver, by a compute shader.
    Lavapipe(KernelLanguage),
    /// SwiftShader, by the program `compute` that lies at this path.
    SwiftShader(&'a str, KernelLanguage),
    /// Chromium's WebGPU.
    Chromium(&'a Canvas<'a>),
}

impl Execution<'_> {
    /// What tables call it.
    pub fn name(&self) -> &'static str {
        match self {
            Execution::Interpreter => "interpreter",
            Execution::Lavapipe(KernelLanguage::Wgsl) => "lavapipe, WGSL",
            Execution::Lavapipe(KernelLanguage::Glsl450) => "lavapipe, GLSL",
            Execution::SwiftShader(_, KernelLanguage::Wgsl) => "SwiftShader, WGSL",
            Execution::SwiftShader(_, KernelLanguage::Glsl450) => "SwiftShader, GLSL",
            Execution::Chromium(_) => "Chromium, WebGPU",
        }
    }

    /// The language of the shader, if it is one.
    fn language(&self) -> Option<KernelLanguage> {
        match self {
            Execution::Interpreter => None,
            Execution::Lavapipe(language) | Execution::SwiftShader(_, language) => Some(*language),
            Execution::Chromium(_) => Some(KernelLanguage::Wgsl),
        }
    }

    /// What the pixels of a frame show, by a program whose entry is a probe; `change` is what becomes of its shader before a
    /// driver takes it.
    pub fn buffers(&self, program: &Program, frame: &Frame, change: fn(Kernel) -> Kernel) -> Buffers {
        let Some(language) = self.language() else { return Buffers::of_program(program, frame) };
        let probe = program.entry.expect("a probe");
        let kernel =
            change(Kernel::of(program, probe, language, &frame.uniforms(program), &coordinates(frame)));
        let words = match self {
            Execution::SwiftShader(path, _) => swiftshader::compute(path, &kernel),
            Execution::Chromium(canvas) => canvas.compute(&kernel),
            _ => kernel.words_on(lavapipe()).map_err(|error| error.to_string()),
        };
        let words = words.unwrap_or_else(|said| panic!("{}: {said}\n{}", self.name(), kernel.text));
        let numbers = |column: Vec<u32>| column.into_iter().map(f32::from_bits).collect();
        let columns: Vec<Vec<f32>> = kernel.columns(&words).into_iter().map(numbers).collect();
        Buffers::of_columns(frame, &columns)
    }
}
