//! A function of a program as a compute shader: many arguments in, many results out, as bits.

use crate::dialect::Dialect;
use crate::symbols::Symbols;
use crate::validate::validate_kernel;
use crate::{EmitError, Target, functions};
use sdf_ir::{FunctionId, Program, Type};

/// The language of a compute shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum KernelLanguage {
    /// GLSL of `#version 450`.
    Glsl450,
    /// WGSL.
    Wgsl,
}

impl KernelLanguage {
    fn target(self) -> Target {
        match self {
            KernelLanguage::Glsl450 => Target::Glsl450,
            KernelLanguage::Wgsl => Target::Wgsl,
        }
    }
}

/// A compute shader that evaluates a function of a legalised program, which uses neither uniforms nor globals.
///
/// Group 0 holds two storage buffers of 32-bit words, the arguments at binding 0 and the results at binding 1. Each
/// invocation takes the words of its arguments one after the other, a float as its bits and a bool as 0 or 1, and
/// leaves its results likewise. Workgroups are of 64 invocations and lie in rows of 32,768.
pub fn emit_kernel(
    program: &Program,
    function: FunctionId,
    language: KernelLanguage,
) -> Result<String, EmitError> {
    let target = language.target();
    let symbols = Symbols::of(program, target);
    let (functions, _) = functions(program, target, &symbols, &[function])?;
    let kernel = Kernel { program, symbols: &symbols, function, dialect: target.dialect() };
    let text = match language {
        KernelLanguage::Glsl450 => kernel.glsl(&functions.join("\n")),
        KernelLanguage::Wgsl => kernel.wgsl(&functions.join("\n")),
    };
    validate_kernel(language, &text).map_err(EmitError::Invalid)?;
    Ok(text)
}

struct Kernel<'a> {
    program: &'a Program,
    symbols: &'a Symbols,
    function: FunctionId,
    dialect: &'a Dialect,
}

impl Kernel<'_> {
    fn glsl(&self, functions: &str) -> String {
        let read = |at: &str| format!("uintBitsToFloat({at})");
        let write = |x: &str| format!("floatBitsToUint({x})");
        let choose = |x: &str| format!("({x} ? 1u : 0u)");
        let (arguments, results) = self.body(read, write, choose);
        let bind = |name: &str, value: &str| format!("    {name} = {value};\n");
        let call = bind(&format!("{} outcome", self.result_type()), &self.call(&arguments));
        let stores = self.stores(&results);
        let (takes, _) = self.words();
        format!(
            "#version 450
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) readonly buffer Arguments {{ uint words_in[]; }};
layout(set = 0, binding = 1) buffer Results {{ uint words_out[]; }};
#define ZERO 0

{functions}
void main() {{
    uint invocation = gl_GlobalInvocationID.y * 2097152u + gl_GlobalInvocationID.x;
    if (invocation >= uint(words_in.length()) / {takes}u) {{
        return;
    }}
{call}{stores}}}
"
        )
    }

    fn wgsl(&self, functions: &str) -> String {
        let read = |at: &str| format!("bitcast<f32>({at})");
        let write = |x: &str| format!("bitcast<u32>({x})");
        let choose = |x: &str| format!("select(0u, 1u, {x})");
        let (arguments, results) = self.body(read, write, choose);
        let call = format!("    let outcome = {};\n", self.call(&arguments));
        let stores = self.stores(&results);
        let (takes, _) = self.words();
        format!(
            "@group(0) @binding(0) var<storage, read> words_in: array<u32>;
@group(0) @binding(1) var<storage, read_write> words_out: array<u32>;

{functions}
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    let invocation = id.y * 2097152u + id.x;
    if (invocation >= arrayLength(&words_in) / {takes}u) {{
        return;
    }}
{call}{stores}}}
"
        )
    }

    fn function(&self) -> &sdf_ir::Function {
        self.program.function(self.function)
    }

    /// How many words an invocation takes and leaves.
    fn words(&self) -> (usize, usize) {
        let parameters = self.function().parameters.iter().map(|p| p.ty.size()).sum();
        (parameters, self.function().result_types().iter().map(|ty| ty.size()).sum())
    }

    fn result_type(&self) -> &str {
        match &self.symbols.structures[self.function.0 as usize] {
            Some(structure) => &structure.name,
            None => self.dialect.ty(self.function().result_types()[0]),
        }
    }

    fn call(&self, arguments: &[String]) -> String {
        format!("{}({})", self.symbols.functions[self.function.0 as usize], arguments.join(", "))
    }

    fn stores(&self, results: &[String]) -> String {
        let (_, leaves) = self.words();
        let store =
            |(i, word): (usize, &String)| format!("    words_out[invocation * {leaves}u + {i}u] = {word};\n");
        results.iter().enumerate().map(store).collect()
    }

    /// The arguments as expressions of the words that come in, and the words of the results.
    fn body(
        &self,
        read: impl Fn(&str) -> String,
        write: impl Fn(&str) -> String,
        choose: impl Fn(&str) -> String,
    ) -> (Vec<String>, Vec<String>) {
        let (takes, _) = self.words();
        let mut word = 0;
        let mut next = || {
            word += 1;
            format!("words_in[invocation * {takes}u + {}u]", word - 1)
        };
        let arguments = self.function().parameters.iter().map(|p| match p.ty {
            Type::Bool => format!("{} != 0u", next()),
            Type::Float => read(&next()),
            vector => {
                let parts: Vec<String> = (0..vector.size()).map(|_| read(&next())).collect();
                format!("{}({})", self.dialect.ty(vector), parts.join(", "))
            }
        });
        let arguments = arguments.collect();
        let mut results = Vec::new();
        for (i, ty) in self.function().result_types().into_iter().enumerate() {
            let result = match &self.symbols.structures[self.function.0 as usize] {
                Some(structure) => format!("outcome.{}", structure.fields[i]),
                None => "outcome".to_owned(),
            };
            match ty {
                Type::Bool => results.push(choose(&result)),
                Type::Float => results.push(write(&result)),
                vector => {
                    let component = |c: &&str| write(&format!("{result}.{c}"));
                    results.extend(["x", "y", "z"][..vector.size()].iter().map(component));
                }
            }
        }
        (arguments, results)
    }
}
