//! Programs as text: GLSL and WGSL from one printer.
//!
//! The typical way is `(Program, Target, Header) → emit → text`, or `(Program, Format, Header) → write → bytes` for
//! files, which are texts and what is made from them. The program must be *legalised*: it holds only
//! operations that every target computes alike. The text is what naga has read and validated; it depends on
//! nothing but the arguments, to the byte. Nothing here knows syntax, the names of shapes, files or drivers.
#![warn(missing_docs)]

mod back;
mod bits;
mod dialect;
mod expression;
mod format;
mod function;
pub mod html;
mod kernel;
mod layout;
mod names;
mod page;
mod plan;
mod split;
mod symbols;
mod validate;
mod wrapper;

pub use format::{Format, write};
pub use kernel::{KernelLanguage, emit_kernel};
pub use layout::{UniformField, UniformLayout};
pub use validate::{ValidationError, validate};

use function::Context;
use plan::Plan;
use sdf_ir::{Function, FunctionId, Program, Type};
use std::fmt::{self, Debug, Display, Formatter};
use symbols::{Reachable, Symbols};
use wrapper::Wrapper;

/// What a text is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Target {
    /// GLSL for Shadertoy's Image tab: functions and `mainImage`; params are constants.
    Shadertoy,
    /// A whole fragment shader of `#version 300 es`, with loose uniforms.
    GlslEs,
    /// A module with `vs_main`, `fs_main` and one uniform block.
    Wgsl,
    /// A whole fragment shader of `#version 450`, with the uniform block of [`Target::Wgsl`]: what naga reads, so
    /// that the GLSL text runs through wgpu.
    Glsl450,
}

/// What stands at the head of a text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Header {
    /// What was compiled, with which settings, effects and cost. The lines are the caller's and must hold no text of
    /// a user. What is not printable ASCII is replaced.
    pub lines: Vec<String>,
    /// What a page is called. It may hold any text.
    pub title: String,
    /// What was measured of settings that are named constants: a setting's name, and the lines that stand below its constant.
    /// They are as [`lines`](Header::lines) are.
    pub figures: Vec<(String, Vec<String>)>,
}

/// Why there is no text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum EmitError {
    /// An operation that legalising should have replaced.
    NotBasic {
        /// The operation.
        operation: String,
        /// The function that it stands in.
        function: String,
    },
    /// A number that no `f32` holds.
    NotFinite,
    /// The entry is missing, or is no function from a vec2 to a vec3, with or without a bool or a float beside it.
    NoEntry,
    /// The function returns nothing.
    NoResult {
        /// Its name.
        function: String,
    },
    /// Our text is not valid, which is a bug here.
    Invalid(ValidationError),
}

impl EmitError {
    fn not_basic(function: &Function, operation: impl Debug) -> EmitError {
        EmitError::NotBasic { operation: format!("{operation:?}"), function: function.name.to_string() }
    }
}

impl Display for EmitError {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            EmitError::NotBasic { operation, function } => {
                write!(f, "{operation} in `{function}` is no basic operation: the program is not legalised")
            }
            EmitError::NotFinite => write!(f, "the program holds a number that is not finite in 32 bits"),
            EmitError::NoEntry => write!(f, "the program has no entry from a vec2 to a vec3"),
            EmitError::NoResult { function } => write!(f, "`{function}` returns nothing"),
            EmitError::Invalid(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for EmitError {}

/// The program as a text for the target, which naga has validated.
pub fn emit(program: &Program, target: Target, header: &Header) -> Result<String, EmitError> {
    let text = print(program, target, header)?;
    validate(target, &text).map_err(EmitError::Invalid)?;
    Ok(text)
}

fn print(program: &Program, target: Target, header: &Header) -> Result<String, EmitError> {
    let entry = program.entry.ok_or(EmitError::NoEntry)?;
    let function = program.function(entry);
    let takes: Vec<Type> = function.parameters.iter().map(|p| p.ty).collect();
    let yields = function.result_types();
    if takes != [Type::Vec2] || !matches!(yields[..], [Type::Vec3] | [Type::Vec3, Type::Bool | Type::Float]) {
        return Err(EmitError::NoEntry);
    }
    let symbols = Symbols::of(program, target);
    let roots: Vec<FunctionId> = program.frame.into_iter().chain([entry]).collect();
    let (functions, loops) = functions(program, target, &symbols, &roots)?;
    let name = |id: FunctionId| symbols.functions[id.0 as usize].as_str();
    let outcome = symbols.structures[entry.0 as usize].as_ref();
    let frame = program.frame.map(name);
    let wrapper = Wrapper { program, symbols: &symbols, loops, frame, entry: name(entry), outcome, header };
    let body = globals(program, target, &symbols).into_iter().chain(functions).collect::<Vec<_>>().join("\n");
    let parts = [head(target, header, &wrapper), wrapper.before(target), body, wrapper.after(target)];
    Ok(parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n"))
}

/// The texts of the functions that the roots need, callees first, and whether any of them loops.
fn functions(
    program: &Program,
    target: Target,
    symbols: &Symbols,
    roots: &[FunctionId],
) -> Result<(Vec<String>, bool), EmitError> {
    let dialect = target.dialect();
    let plans: Vec<Plan> = program.functions.iter().map(Plan::of).collect();
    let reachable = Reachable::of(program, &plans, roots);
    let context = Context { program, dialect, symbols };
    let mut texts = bits::functions(dialect, &reachable.bits);
    for id in reachable.functions {
        texts.push(context.function(id, &plans[id.0 as usize])?);
    }
    Ok((texts, reachable.loops))
}

fn globals(program: &Program, target: Target, symbols: &Symbols) -> Option<String> {
    let dialect = target.dialect();
    let declared = program.globals.iter().zip(&symbols.globals);
    let lines: Vec<String> =
        declared.map(|(g, name)| (dialect.global)(dialect.ty(g.ty), name) + "\n").collect();
    (!lines.is_empty()).then(|| format!("// Computed once a frame.\n{}", lines.concat()))
}

fn head(target: Target, header: &Header, wrapper: &Wrapper) -> String {
    let version = match target {
        Target::GlslEs => "#version 300 es\n",
        Target::Glsl450 => "#version 450\n",
        Target::Shadertoy | Target::Wgsl => "",
    };
    let described = match target {
        Target::Wgsl => {
            let types = ["u32", "f32", "vec2f", "vec3f"];
            wrapper::described(wrapper.program, wrapper.symbols, "group 0, binding 0", types)
        }
        _ => Vec::new(),
    };
    let comments = header.lines.iter().chain(&described).map(|line| format!("{}\n", comment(line)));
    version.to_owned() + &comments.collect::<String>()
}

/// A line as a comment. A backslash would glue the next line of GLSL to it.
pub(crate) fn comment(line: &str) -> String {
    let safe = |c: char| if (c.is_ascii_graphic() && c != '\\') || c == ' ' { c } else { '?' };
    let line: String = line.chars().map(safe).collect();
    format!("// {line}").trim_end().to_owned()
}

impl Target {
    /// All targets.
    pub const ALL: [Target; 4] = [Target::Shadertoy, Target::GlslEs, Target::Wgsl, Target::Glsl450];

    fn dialect(self) -> &'static dialect::Dialect {
        match self {
            Target::Shadertoy | Target::GlslEs | Target::Glsl450 => &dialect::GLSL,
            Target::Wgsl => &dialect::WGSL,
        }
    }
}
