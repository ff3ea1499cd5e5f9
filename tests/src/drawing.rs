//! Examples as shaders and as pictures.

use crate::scenes::{Buffers, Example, scene};
use sdf_ir::Role;
use sdf_lang::Options;
use sdf_render::{Frame, Picture};
use sdfc::{Clock, Device, Language, Shader};

/// The size of all pictures.
pub const SIZE: [u32; 2] = [320, 180];
/// When animated scenes are drawn, in seconds; the others are drawn at the first of these.
pub const TIMES: [f64; 2] = [0.0, 1.7];

/// What a client makes of a shader.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Verdict {
    /// What it has against the text, if anything.
    pub complaint: Option<String>,
    /// What it drew, a picture for each frame; none where it drew nothing.
    pub pictures: Vec<Picture>,
}

/// The shader of an example, which must have no mistakes.
pub fn shader(example: &Example) -> Shader {
    compiled(example, &Options::default())
}

/// The shader of an example with a camera that can be turned from outside.
pub fn turnable(example: &Example) -> Shader {
    compiled(example, &Options { orbit: true, ..Options::default() })
}

fn compiled(example: &Example, options: &Options) -> Shader {
    let compiled = sdfc::compile(&example.name, &example.text, options, &mut Clock::default());
    let said: Vec<&String> = compiled.diagnostics.iter().map(|d| &d.message).collect();
    compiled.output.unwrap_or_else(|| panic!("{}: {said:?}", example.name)).1
}

/// A picture of [`SIZE`] at a time, with the pointer in the middle and every param at its default.
pub fn frame_at(time: f64) -> Frame {
    Frame { time, ..Frame::new(SIZE[0], SIZE[1]) }
}

/// The pictures that a shader is drawn as: at two times if it asks for the time.
pub fn frames(shader: &Shader) -> Vec<Frame> {
    let animated = shader.program.uniforms.iter().any(|u| u.role == Role::Time);
    TIMES.into_iter().take(if animated { 2 } else { 1 }).map(frame_at).collect()
}

/// The interpreter's picture.
pub fn on_cpu(shader: &Shader, frame: &Frame) -> Picture {
    let drawing = shader.draw(frame, &Device::Cpu, Language::Wgsl, &|_| {}, &mut Clock::default());
    drawing.unwrap_or_else(|error| panic!("{error}")).picture
}

/// What the graphics device of this name makes of a shader.
pub fn on_device(shader: &Shader, frames: &[Frame], name: &str, language: Language) -> Verdict {
    let device = Device::Named(name.into());
    let draw = |frame| shader.draw(frame, &device, language, &|_| {}, &mut Clock::default());
    let pictures: Result<Vec<_>, _> = frames.iter().map(|frame| Ok(draw(frame)?.picture)).collect();
    pictures.map_or_else(
        |error: sdfc::DrawError| Verdict { complaint: Some(error.to_string()), pictures: Vec::new() },
        |pictures| Verdict { complaint: None, pictures },
    )
}

/// The buffers of a scene, from a compilation of its own: what is drawn has no probe.
pub fn buffers(example: &Example, frame: &Frame) -> Buffers {
    // A camera that is not turned stands where it stood.
    let options = Options { probe: true, orbit: frame.orbit != [0.0, 0.0, 1.0], ..Options::default() };
    Buffers::of(&scene(&example.name, &example.text, &options), frame)
}
