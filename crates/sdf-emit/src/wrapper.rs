//! What stands before and after the functions: everything that differs between the targets of one language.

use crate::dialect::GLSL;
use crate::expression::Expression;
use crate::layout::UniformLayout;
use crate::symbols::{Structure, Symbols};
use crate::{Header, Target, comment};
use sdf_ir::{Constant, Program, Role, Type, Uniform};
use std::fmt::Write;

/// What a wrapper needs to know.
pub(crate) struct Wrapper<'a> {
    /// The program.
    pub program: &'a Program,
    /// Its names.
    pub symbols: &'a Symbols,
    /// Whether loops need their start.
    pub loops: bool,
    /// The call that computes the values of the frame, if there are any, and the one that computes a pixel.
    pub frame: Option<&'a str>,
    /// The function from a coordinate to a colour.
    pub entry: &'a str,
    /// What it returns, if there is something beside the colour.
    pub outcome: Option<&'a Structure>,
    /// What stands at the head.
    pub header: &'a Header,
}

impl Wrapper<'_> {
    /// The text before the functions.
    pub fn before(&self, target: Target) -> String {
        let loops =
            |start: &str| if self.loops { format!("\n#define ZERO {start}\n") } else { String::new() };
        let settings = settings(self.program, self.symbols, target, &self.header.figures);
        match target {
            Target::Shadertoy => {
                format!("{}{settings}{}", self.shadertoy_uniforms(), loops("min(iFrame, 0)"))
            }
            Target::GlslEs => format!("{}{settings}{}", self.loose_uniforms(), loops("0")),
            Target::Glsl450 => format!("{}{settings}{}", self.glsl_block(), loops("0")),
            Target::Wgsl => format!("{}{settings}", self.wgsl_block()),
        }
    }

    /// The text after the functions.
    pub fn after(&self, target: Target) -> String {
        let frame = self.frame.map_or(String::new(), |frame| format!("    {frame}();\n"));
        let pixel = |coordinate: &str| self.pixel(target, coordinate);
        match target {
            Target::Shadertoy => {
                let (call, color) = pixel("fragCoord");
                format!(
                    "void mainImage(out vec4 fragColor, in vec2 fragCoord) {{\n{frame}{call}    \
                     fragColor = {color};\n}}\n"
                )
            }
            Target::GlslEs => {
                let (call, color) = pixel("gl_FragCoord.xy");
                format!("void main() {{\n{frame}{call}    fragColor = {color};\n}}\n")
            }
            Target::Glsl450 => {
                let (call, color) = pixel("fragCoord");
                format!(
                    "void main() {{\n{frame}    vec2 fragCoord = vec2(gl_FragCoord.x, u_resolution.y - gl_FragCoord.y);\n\
                     {call}    fragColor = {color};\n}}\n"
                )
            }
            Target::Wgsl => {
                let (call, color) = pixel("coordinate");
                format!(
                    "@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {{
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    return vec4f(corner * 4.0 - 1.0, 0.0, 1.0);
}}

@fragment
fn fs_main(@builtin(position) position: vec4f) -> @location(0) vec4f {{
{frame}    let coordinate = vec2f(position.x, uniforms.resolution.y - position.y);
{call}    return {color};
}}
"
                )
            }
        }
    }

    /// What calls the entry beforehand, and the vector of four that a pixel becomes: the colour, and 1 or what the
    /// entry yields beside it.
    fn pixel(&self, target: Target, coordinate: &str) -> (String, String) {
        let dialect = target.dialect();
        let vector = if target == Target::Wgsl { "vec4f" } else { "vec4" };
        let call = format!("{}({coordinate})", self.entry);
        let Some(Structure { name, fields }) = self.outcome else {
            return (String::new(), format!("{vector}({call}, 1.0)"));
        };
        let call = format!("    {}\n", (dialect.bind)(name, "outcome", &call));
        let beside = format!("{}(outcome.{})", dialect.float, fields[1]);
        (call, format!("{vector}(outcome.{}, {beside})", fields[0]))
    }

    fn wgsl_block(&self) -> String {
        let mut out = String::from("struct Uniforms {\n");
        for (ty, name, _) in block(self.program, self.symbols) {
            let ty = if ty == Type::Bool { "u32" } else { crate::dialect::WGSL.ty(ty) };
            writeln!(out, "    {name}: {ty},").expect("writing to a string cannot fail");
        }
        out + "}\n\n@group(0) @binding(0) var<uniform> uniforms: Uniforms;\n"
    }

    fn glsl_block(&self) -> String {
        let mut members = String::new();
        let mut bools = String::new();
        for (ty, name, _) in block(self.program, self.symbols) {
            if ty == Type::Bool {
                members += &format!("    uint u_{name}_word;\n");
                bools += &format!("#define u_{name} (u_{name}_word != 0u)\n");
            } else {
                members += &format!("    {} u_{name};\n", GLSL.ty(ty));
            }
        }
        format!(
            "layout(set = 0, binding = 0) uniform Uniforms {{\n{members}}};\n{bools}\n\
             layout(location = 0) out vec4 fragColor;\n"
        )
    }

    fn loose_uniforms(&self) -> String {
        let mut out = String::from("precision highp float;\nprecision highp int;\n\n");
        for (uniform, Expression { text: name, .. }) in
            self.program.uniforms.iter().zip(&self.symbols.uniforms)
        {
            if uniform.role == Role::Setting {
                continue;
            }
            writeln!(out, "uniform {} {name}; // {}", GLSL.ty(uniform.ty), meaning(uniform))
                .expect("writing to a string cannot fail");
        }
        out + if self.program.uniforms.is_empty() {
            "out vec4 fragColor;\n"
        } else {
            "\nout vec4 fragColor;\n"
        }
    }

    fn shadertoy_uniforms(&self) -> String {
        let mut out = String::new();
        for (uniform, Expression { text: name, .. }) in
            self.program.uniforms.iter().zip(&self.symbols.uniforms)
        {
            out += &match uniform.role {
                Role::Setting => String::new(),
                Role::Time => format!("#define {name} iTime\n"),
                Role::Resolution => format!("#define {name} iResolution.xy\n"),
                // The middle, until the pointer is used.
                Role::Mouse => format!(
                    "#define {name} (iMouse.xy == vec2(0.0) ? vec2(0.5) : iMouse.xy / iResolution.xy)\n"
                ),
                Role::Orbit { .. } | Role::Param { .. } => {
                    let ty = GLSL.ty(uniform.ty);
                    format!("const {ty} {name} = {}; // {}\n", constant(&uniform.default), meaning(uniform))
                }
            };
        }
        out
    }
}

/// The accuracy settings as named constants.
pub(crate) fn settings(
    program: &Program,
    symbols: &Symbols,
    target: Target,
    figures: &[(String, Vec<String>)],
) -> String {
    let mut out = String::new();
    for (uniform, Expression { text: name, .. }) in program.uniforms.iter().zip(&symbols.uniforms) {
        if uniform.role == Role::Setting {
            let (value, what) = (constant(&uniform.default), meaning(uniform));
            out += &match target {
                Target::Wgsl => format!("const {name}: f32 = {value}; // {what}\n"),
                _ => format!("const float {name} = {value}; // {what}\n"),
            };
            for (_, lines) in figures.iter().filter(|(setting, _)| **setting == *uniform.name) {
                out.extend(lines.iter().map(|line| format!("{}\n", comment(line))));
            }
        }
    }
    if out.is_empty() { out } else { format!("\n{out}") }
}

/// The members of the uniform block: type, name and offset.
fn block<'a>(program: &Program, symbols: &'a Symbols) -> Vec<(Type, &'a str, usize)> {
    let layout = UniformLayout::of(program);
    let name = |uniform: Option<usize>| match uniform {
        Some(i) => symbols.uniform_fields[i].as_str(),
        None => "resolution",
    };
    layout.fields.iter().map(|f| (f.ty, name(f.uniform), f.offset)).collect()
}

/// How to draw with a module that has both entries: what its uniform block holds and where, as comment lines. `types`
/// are what the language calls an unsigned number, a float, and vectors of 2 and 3.
pub(crate) fn described(
    program: &Program,
    symbols: &Symbols,
    binding: &str,
    types: [&str; 4],
) -> Vec<String> {
    let layout = UniformLayout::of(program);
    let mut lines =
        vec![format!("one triangle of 3 vertices; the uniform block, {binding}, {} bytes:", layout.size)];
    for (field, (ty, name, offset)) in layout.fields.iter().zip(block(program, symbols)) {
        let ty = match ty {
            Type::Bool => format!("{}, 0 or 1", types[0]),
            Type::Float => types[1].to_owned(),
            Type::Vec2 => types[2].to_owned(),
            Type::Vec3 => types[3].to_owned(),
        };
        let what = match field.uniform.map(|i| &program.uniforms[i]) {
            Some(uniform) => meaning(uniform),
            None => RESOLUTION.to_owned(),
        };
        lines.push(format!("  at {offset:>3}: {name}: {ty}, {what}"));
    }
    lines
}

const RESOLUTION: &str = "width and height of the picture in pixels";

/// What a uniform is for, as a comment.
fn meaning(uniform: &Uniform) -> String {
    match uniform.role {
        Role::Setting => match &*uniform.name {
            "tolerance" => "pixels: how far from the true surface a hit may be".to_owned(),
            "steps" => "how many steps a ray is given".to_owned(),
            "far" => "how far a ray goes".to_owned(),
            "shadow_accuracy" => "how much darker a soft shadow may be between two samples".to_owned(),
            "occlusion_samples" => "how many samples occlusion is summed up from".to_owned(),
            other => format!("the setting {other}"),
        },
        Role::Time => "seconds".to_owned(),
        Role::Mouse => "the pointer, 0 to 1 from the bottom left".to_owned(),
        Role::Orbit { .. } => {
            "the camera about its target: two angles in radians, factor of its distance".to_owned()
        }
        Role::Resolution => RESOLUTION.to_owned(),
        Role::Param { range: Some((lo, hi)), .. } => {
            format!("{} to {}, at first {}", lo as f32, hi as f32, constant(&uniform.default))
        }
        Role::Param { color: true, .. } => {
            format!("a linear colour, at first {}", constant(&uniform.default))
        }
        Role::Param { .. } => format!("at first {}", constant(&uniform.default)),
    }
}

fn constant(c: &Constant) -> String {
    let numbers: Vec<Expression> = c.components().iter().map(|x| Expression::number(*x as f32)).collect();
    match (c, numbers.as_slice()) {
        (Constant::Bool(b), _) => b.to_string(),
        (_, [number]) => number.text.clone(),
        (_, numbers) => Expression::call(GLSL.ty(c.ty()), numbers).text,
    }
}
