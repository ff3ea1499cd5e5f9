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

    /// What the pixels of a frame show, by a program whose entry is a probe.
    pub fn buffers(&self, program: &Program, frame: &Frame) -> Buffers {
        let (language, run): (_, Box<dyn Fn(&Kernel) -> Result<Vec<u32>, String>>) = match *self {
            Execution::Interpreter => return Buffers::of_program(program, frame),
            Execution::Lavapipe(language) => {
                (language, Box::new(|k| k.words_on(lavapipe()).map_err(|error| error.to_string())))
            }
            Execution::SwiftShader(path, language) => {
                (language, Box::new(move |k| swiftshader::compute(path, k)))
            }
            Execution::Chromium(canvas) => (KernelLanguage::Wgsl, Box::new(move |k| canvas.compute(k))),
        };
        let probe = program.entry.expect("a probe");
        let kernel = Kernel::of(program, probe, language, &frame.uniforms(program), &coordinates(frame));
        let words = run(&kernel).unwrap_or_else(|error| panic!("{}: {error}\n{}", self.name(), kernel.text));
        let columns: Vec<Vec<f32>> =
            kernel.columns(&words).into_iter().map(|c| c.into_iter().map(f32::from_bits).collect()).collect();
        Buffers::of_columns(frame, &columns)
    }
}
