//! A function of a program as a compute shader: many arguments in, many results out, as bits.

use crate::dialect::Dialect;
use crate::symbols::Symbols;
use crate::validate::validate_kernel;
use crate::wrapper::settings;
use crate::{EmitError, Target, functions, globals};
use sdf_ir::{FunctionId, Program, Role, Type, Uniform};

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

/// A compute shader that evaluates a function of a legalised program.
///
/// Group 0 holds two storage buffers of 32-bit words, the arguments at binding 0 and the results at binding 1. The
/// arguments begin with the values of the program's uniforms, settings apart, in its order. Then each invocation takes
/// the words of its arguments one after the other, a float as its bits and a bool as 0 or 1, and leaves its results
/// likewise. Workgroups are of 64 invocations and lie in rows of 32,768.
pub fn emit_kernel(
    program: &Program,
    function: FunctionId,
    language: KernelLanguage,
) -> Result<String, EmitError> {
    let target = language.target();
    let symbols = Symbols::of(program, target);
    let roots: Vec<FunctionId> = program.frame.into_iter().chain([function]).collect();
    let (functions, _) = functions(program, target, &symbols, &roots)?;
    let kernel = Kernel { program, symbols: &symbols, function, dialect: target.dialect() };
    let values = settings(program, &symbols, target, &[]);
    let parts = [values].into_iter().chain(globals(program, target, &symbols)).chain(functions);
    let body = parts.filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n");
    let text = match language {
        KernelLanguage::Glsl450 => kernel.glsl(&body),
        KernelLanguage::Wgsl => kernel.wgsl(&body),
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
        let first = self.uniform_words();
        let declared: String =
            self.uniforms().map(|(u, name)| format!("{} u_{name};\n", self.dialect.ty(u.ty))).collect();
        let frame = self.frame("u_", read);
        format!(
            "#version 450
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) readonly buffer Arguments {{ uint words_in[]; }};
layout(set = 0, binding = 1) buffer Results {{ uint words_out[]; }};
#define ZERO 0

{declared}{functions}
void main() {{
    uint invocation = gl_GlobalInvocationID.y * 2097152u + gl_GlobalInvocationID.x;
    if (invocation >= (uint(words_in.length()) - {first}u) / {takes}u) {{
        return;
    }}
{frame}{call}{stores}}}
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
        let first = self.uniform_words();
        let frame = self.frame("uniforms.", read);
        let declared = self.wgsl_uniforms();
        format!(
            "@group(0) @binding(0) var<storage, read> words_in: array<u32>;
@group(0) @binding(1) var<storage, read_write> words_out: array<u32>;

{declared}{functions}
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    let invocation = id.y * 2097152u + id.x;
    if (invocation >= (arrayLength(&words_in) - {first}u) / {takes}u) {{
        return;
    }}
{frame}{call}{stores}}}
"
        )
    }

    /// The uniforms that come in, with their names.
    fn uniforms(&self) -> impl Iterator<Item = (&Uniform, &String)> {
        let all = self.program.uniforms.iter().zip(&self.symbols.uniform_fields);
        all.filter(|(uniform, _)| uniform.role != Role::Setting)
    }

    /// How many words the uniforms take.
    fn uniform_words(&self) -> usize {
        self.uniforms().map(|(uniform, _)| uniform.ty.size()).sum()
    }

    /// The structure through which WGSL's functions read the uniforms.
    fn wgsl_uniforms(&self) -> String {
        let ty = |ty| if ty == Type::Bool { "u32" } else { self.dialect.ty(ty) };
        let members: String =
            self.uniforms().map(|(u, name)| format!("    {name}: {},\n", ty(u.ty))).collect();
        if members.is_empty() {
            return members;
        }
        format!("struct Uniforms {{\n{members}}}\n\nvar<private> uniforms: Uniforms;\n")
    }

    /// The lines that take the uniforms' values from the first words, and compute the values of the frame.
    fn frame(&self, prefix: &str, read: impl Fn(&str) -> String) -> String {
        let mut next = 0;
        let mut lines = String::new();
        for (uniform, name) in self.uniforms() {
            let word = |i: usize| format!("words_in[{}u]", next + i);
            let value = match (uniform.ty, prefix) {
                (Type::Bool, "uniforms.") => word(0),
                (Type::Bool, _) => format!("{} != 0u", word(0)),
                (Type::Float, _) => read(&word(0)),
                (vector, _) => {
                    let parts: Vec<String> = (0..vector.size()).map(|i| read(&word(i))).collect();
                    format!("{}({})", self.dialect.ty(vector), parts.join(", "))
                }
            };
            lines += &format!("    {prefix}{name} = {value};\n");
            next += uniform.ty.size();
        }
        if let Some(frame) = self.program.frame {
            lines += &format!("    {}();\n", self.symbols.functions[frame.0 as usize]);
        }
        lines
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
        let mut word = self.uniform_words();
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
