//! Nothing leaves this crate that naga has not read and validated.

use crate::{KernelLanguage, Target};
use naga::front::{glsl, wgsl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
use std::fmt::{self, Display, Formatter};

/// naga recurses as deep as the text does; the usual 2 MiB are too few.
const STACK: usize = 64 << 20;

/// What naga found wrong with a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ValidationError {
    /// naga's message, with the place in the text.
    pub message: String,
}

impl Display for ValidationError {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(f, "naga rejects the shader: {}", self.message)
    }
}

impl std::error::Error for ValidationError {}

/// Whether naga accepts the text, which is a whole shader of that target.
pub fn validate(target: Target, text: &str) -> Result<(), ValidationError> {
    match target {
        Target::Wgsl => deep(|| check_wgsl(text)),
        Target::Glsl450 => deep(|| check_glsl(text, ShaderStage::Fragment)),
        Target::GlslEs => deep(|| check_glsl(&es_as_450(text), ShaderStage::Fragment)),
        Target::Shadertoy => {
            deep(|| check_glsl(&format!("{SHADERTOY_BEFORE}{text}{SHADERTOY_AFTER}"), ShaderStage::Fragment))
        }
    }
}

/// Whether naga accepts the text, which is a compute shader.
pub(crate) fn validate_kernel(language: KernelLanguage, text: &str) -> Result<(), ValidationError> {
    match language {
        KernelLanguage::Wgsl => deep(|| check_wgsl(text)),
        KernelLanguage::Glsl450 => deep(|| check_glsl(text, ShaderStage::Compute)),
    }
}

/// What `read` makes of the module that a WGSL text is, if naga accepts it.
pub(crate) fn with_wgsl<T: Send>(
    text: &str,
    read: impl FnOnce(&Module, &ModuleInfo) -> Result<T, String> + Send,
) -> Result<T, ValidationError> {
    deep(|| {
        let module = wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
        let info = check(&module, text)?;
        read(&module, &info)
    })
}

/// Runs a check on a thread with enough stack.
fn deep<T: Send>(check: impl FnOnce() -> Result<T, String> + Send) -> Result<T, ValidationError> {
    let thread = std::thread::Builder::new().name("naga".into()).stack_size(STACK);
    std::thread::scope(|scope| match thread.spawn_scoped(scope, check).map(|t| t.join()) {
        Ok(Ok(result)) => result,
        Ok(Err(_)) => Err("it panicked".into()),
        Err(error) => Err(format!("no thread to run it on: {error}")),
    })
    .map_err(|message| ValidationError { message })
}

fn check_wgsl(text: &str) -> Result<(), String> {
    let module = wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    check(&module, text).map(drop)
}

fn check_glsl(text: &str, stage: ShaderStage) -> Result<(), String> {
    let module = glsl::Frontend::default().parse(&glsl::Options::from(stage), text);
    check(&module.map_err(|error| error.emit_to_string(text))?, text).map(drop)
}

fn check(module: &Module, text: &str) -> Result<ModuleInfo, String> {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(module).map_err(|error| error.emit_to_string(text))
}

/// What Shadertoy puts before and after the text, as naga can read it.
const SHADERTOY_BEFORE: &str = "#version 450
layout(set = 0, binding = 0) uniform Shadertoy { vec3 iResolution; float iTime; vec4 iMouse; int iFrame; };
layout(location = 0) out vec4 shadertoyColor;
";
const SHADERTOY_AFTER: &str = "
void main() {
    mainImage(shadertoyColor, gl_FragCoord.xy);
}
";

/// A shader of `#version 300 es` as naga can read it, line for line: naga knows no loose uniforms, and no bool
/// that comes from outside.
fn es_as_450(text: &str) -> String {
    let mut out = String::new();
    for (i, line) in text.lines().enumerate() {
        if line == "#version 300 es" {
            out.push_str("#version 450");
        } else if line.starts_with("precision ") {
            // 450 has one precision.
        } else if let Some((name, _)) = line.strip_prefix("uniform bool ").and_then(|u| u.split_once(';')) {
            out.push_str(&format!("bool {name} = true;"));
        } else if let Some((uniform, _)) = line.strip_prefix("uniform ").and_then(|u| u.split_once(';')) {
            out.push_str(&format!("layout(set = 0, binding = {i}) uniform Line{i} {{ {uniform}; }};"));
        } else if line.starts_with("out vec4 ") {
            out.push_str("layout(location = 0) ");
            out.push_str(line);
        } else {
            out.push_str(line);
        }
        out.push('\n');
    }
    out
}
