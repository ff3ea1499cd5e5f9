//! One function of a program, run by the interpreter and by shaders on a device.

use sdf_emit::{KernelLanguage, emit_kernel};
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::{FunctionId, Program, Type};
use sdf_render::gpu::{DevicePreference, Gpu, Shader};
use std::sync::OnceLock;

/// Mesa's software driver. The tests need it: what they compare is its bits.
pub fn lavapipe() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        let wanted = DevicePreference::Named("llvmpipe".into());
        Gpu::new(&wanted).unwrap_or_else(|error| {
            panic!("this test needs Mesa's software Vulkan driver (Debian: mesa-vulkan-drivers): {error}")
        })
    })
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

/// What a compute shader in the language makes of the columns, as bits.
pub fn on_device(
    gpu: &Gpu,
    program: &Program,
    function: FunctionId,
    language: KernelLanguage,
    columns: &[Vec<f32>],
) -> Vec<Vec<u32>> {
    let text = emit_kernel(program, function, language).unwrap_or_else(|error| panic!("{error}"));
    let shader = match language {
        KernelLanguage::Wgsl => Shader::Wgsl(&text),
        KernelLanguage::Glsl450 => Shader::Glsl450(&text),
    };
    let types: Vec<Type> = program.function(function).parameters.iter().map(|p| p.ty).collect();
    let is_bool: Vec<bool> = types.iter().flat_map(|ty| vec![*ty == Type::Bool; ty.size()]).collect();
    let (count, results) = (columns[0].len(), program.function(function).result_types());
    let width: usize = results.iter().map(|ty| ty.size()).sum();
    let mut input = Vec::with_capacity(count * columns.len());
    for i in 0..count {
        input
            .extend(columns.iter().zip(&is_bool).map(|(c, b)| if *b { c[i] as u32 } else { c[i].to_bits() }));
    }
    let output = gpu
        .compute(shader, &input, count * width, count as u32)
        .unwrap_or_else(|error| panic!("{error}\n{text}"));
    (0..width).map(|column| output.iter().skip(column).step_by(width).copied().collect()).collect()
}
