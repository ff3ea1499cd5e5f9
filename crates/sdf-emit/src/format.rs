//! What a shader is written as: the texts that are printed here, and what is made from them.

use crate::{EmitError, Header, Target, back, emit, page};
use sdf_ir::Program;

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// The text for a target.
    Text(Target),
    /// A page for browsers with WebGL2 that runs by itself. A program whose uniforms have one of the role
    /// [`Orbit`](sdf_ir::Role::Orbit) lets the page's user look around.
    Page,
    /// SPIR-V 1.0, for Vulkan: the module of [`Target::Wgsl`], in words of four bytes, the lowest first.
    SpirV,
    /// A text in the Metal Shading Language: the module of [`Target::Wgsl`].
    Metal,
    /// A text in HLSL of shader model 5.0: the module of [`Target::Wgsl`].
    Hlsl,
}

impl Format {
    /// All formats of files.
    pub const ALL: [Format; 7] = [
        Format::Text(Target::Shadertoy),
        Format::Text(Target::GlslEs),
        Format::Text(Target::Wgsl),
        Format::Page,
        Format::SpirV,
        Format::Metal,
        Format::Hlsl,
    ];
}

/// The program as a file. What it is made from has been validated by naga.
pub fn write(program: &Program, format: Format, header: &Header) -> Result<Vec<u8>, EmitError> {
    match format {
        Format::Text(target) => emit(program, target, header).map(String::into_bytes),
        Format::Page => page::page(program, header).map(String::into_bytes),
        Format::SpirV => back::spir_v(program, header),
        Format::Metal => back::metal(program, header).map(String::into_bytes),
        Format::Hlsl => back::hlsl(program, header).map(String::into_bytes),
    }
}
