//! One function of a program, run by the interpreter and by shaders on a device.

use sdf_emit::{KernelLanguage, emit_kernel};
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::{Constant, FunctionId, Program, Role, Type};
use sdf_render::gpu::{DevicePreference, Gpu, GpuError, Shader};

/// What a device, found by a part of its name, and its driver call themselves.
pub fn version_of(device: &str) -> String {
    let gpu = Gpu::new(&DevicePreference::Named(device.into())).unwrap_or_else(|error| panic!("{error}"));
    format!("{}, {}", gpu.name().name, gpu.name().driver)
}

/// What the `f32` lanes of the interpreter make of the columns, as bits.
pub fn on_lanes(program: &Program, function: FunctionId, columns: &[Vec<f32>]) -> Vec<Vec<u32>> {
    let tape = Tape::compile(program, function);
    let mut outputs = vec![vec![0.0f32; columns[0].len()]; tape.output_count()];
    let inputs: Vec<&[f32]> = columns.iter().map(Vec::as_slice).collect();
    let mut slices: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    Machine::<f32>::new(&tape).run(&inputs, &mut slices);
    let results = program.function(function).result_types();
    let is_bool = results.iter().flat_map(|ty| vec![*ty == Type::Bool; ty.size()]);
    let word = |x: &f32, is_bool| if is_bool { *x as u32 } else { x.to_bits() };
    outputs.iter().zip(is_bool).map(|(column, b)| column.iter().map(|x| word(x, b)).collect()).collect()
}

/// What a compute shader in the language makes of the columns, as bits. The program has no uniforms.
pub fn on_device(
    gpu: &Gpu,
    program: &Program,
    function: FunctionId,
    language: KernelLanguage,
    columns: &[Vec<f32>],
) -> Vec<Vec<u32>> {
    Kernel::of(program, function, language, &[], columns).on_device(gpu)
}

/// A compute shader with all that it takes, so that another process can run it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kernel {
    /// The language of the text.
    pub language: KernelLanguage,
    /// The shader.
    pub text: String,
    /// The words of its arguments.
    pub input: Vec<u32>,
    /// For how many points it is run.
    pub invocations: usize,
    /// How many words it leaves for each point.
    pub width: usize,
}

impl Kernel {
    /// One function of a legalised program, for the points of the columns, with these values of its uniforms.
    pub fn of(
        program: &Program,
        function: FunctionId,
        language: KernelLanguage,
        uniforms: &[Constant],
        columns: &[Vec<f32>],
    ) -> Kernel {
        let text = emit_kernel(program, function, language).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(uniforms.len(), program.uniforms.len(), "every uniform has a value");
        let types: Vec<Type> = program.function(function).parameters.iter().map(|p| p.ty).collect();
        let is_bool: Vec<bool> = types.iter().flat_map(|ty| vec![*ty == Type::Bool; ty.size()]).collect();
        let (invocations, results) = (columns[0].len(), program.function(function).result_types());
        let mut input = Vec::with_capacity(invocations * columns.len());
        for (value, uniform) in uniforms.iter().zip(&program.uniforms) {
            match (value, uniform.role) {
                (_, Role::Setting) => {}
                (Constant::Bool(b), _) => input.push(u32::from(*b)),
                (numbers, _) => input.extend(numbers.components().iter().map(|x| (*x as f32).to_bits())),
            }
        }
        for i in 0..invocations {
            let word = |c: &Vec<f32>, is_bool: &bool| if *is_bool { c[i] as u32 } else { c[i].to_bits() };
            input.extend(columns.iter().zip(&is_bool).map(|(c, b)| word(c, b)));
        }
        Kernel { language, text, input, invocations, width: results.iter().map(|ty| ty.size()).sum() }
    }

    /// The same in WGSL with an expression in the place of a function, where it has one of this name: `0` and `1` in braces
    /// stand for its parameters.
    pub fn with_bare(self, function: &str, expression: &str) -> Kernel {
        let head = format!("fn {function}(");
        let Some((before, rest)) = self.text.split_once(&head) else { return self };
        let (parameters, rest) = rest.split_once(')').expect("an end of the parameters");
        let (result, rest) = rest.split_once('{').expect("a body");
        let (_, after) = rest.split_once("\n}\n").expect("an end of the function");
        let names = parameters.split(", ").map(|parameter| parameter.split(':').next().expect("a name"));
        let value = names
            .enumerate()
            .fold(expression.to_owned(), |text, (i, name)| text.replace(&format!("{{{i}}}"), name));
        let text = format!("{before}{head}{parameters}){result}{{ return {value}; }}\n{after}");
        Kernel { text, ..self }
    }

    /// The columns that it leaves on a device, as bits.
    pub fn on_device(&self, gpu: &Gpu) -> Vec<Vec<u32>> {
        let output = self.words_on(gpu).unwrap_or_else(|error| panic!("{error}\n{}", self.text));
        self.columns(&output)
    }

    /// The words that it leaves on a device.
    pub fn words_on(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let shader = match self.language {
            KernelLanguage::Wgsl => Shader::Wgsl(&self.text),
            KernelLanguage::Glsl450 => Shader::Glsl450(&self.text),
        };
        gpu.compute(shader, &self.input, self.invocations * self.width, self.invocations as u32)
    }

    /// The words that were left, as columns.
    pub fn columns(&self, words: &[u32]) -> Vec<Vec<u32>> {
        assert_eq!(words.len(), self.invocations * self.width, "the words of all points");
        let column = |first: usize| words.iter().skip(first).step_by(self.width).copied().collect();
        (0..self.width).map(column).collect()
    }
}
