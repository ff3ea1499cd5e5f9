//! What pictures cost in evaluations of the scene's field: counted by the interpreter, which draws what shaders draw.

use crate::{Clock, Options, Shader, compile};
use sdf_render::{Frame, cpu};

/// How often a pixel evaluates the scene's field. An evaluation is a distance, a distance with its gradient or a step, or the
/// distances that tell materials apart; [`sdf_ir::cost`] has what counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evaluations {
    /// The mean of the pixels of a picture.
    pub mean: f64,
    /// The most that a pixel may take, whatever it shows: every loop is run to its last round.
    pub most: u64,
}

/// A scene without some of its effects, as a shader.
#[derive(Debug, Clone)]
pub struct Variant {
    /// The effects that are left out, by their places in [`Scene::effects`](crate::Scene::effects).
    pub left_out: Vec<usize>,
    /// The shader.
    pub shader: Shader,
}

impl Shader {
    /// How often a pixel of a picture evaluates the scene's field; `progress` is told which part has been drawn.
    pub fn evaluations(&self, frame: &Frame, progress: impl Fn(f64) + Sync) -> Evaluations {
        let pixels = u64::from(frame.width) * u64::from(frame.height);
        let (_, counts) = cpu::render_with(&self.program, frame, true, progress);
        let most = self.program.entry.map_or(0, |entry| sdf_ir::cost::evaluations(&self.program, entry));
        Evaluations { mean: counts.evaluations as f64 / pixels.max(1) as f64, most }
    }
}

/// A scene without mistakes once more, without some of its effects. It is for measuring alone what they take.
pub fn without(name: &str, text: &str, options: &Options, left_out: Vec<usize>) -> Variant {
    let options = Options { left_out: left_out.clone(), attack: Some(0), facts: false, ..options.clone() };
    let compiled = compile(name, text, &options, &mut Clock::default());
    let (_, shader) = compiled.output.expect("what has no mistakes has none without an effect");
    Variant { left_out, shader }
}
