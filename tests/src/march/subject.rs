//! A scene that a march is measured with.

use crate::march::Variant;
use crate::scenes::Example;
use sdf_ir::Program;
use sdf_lang::{Options, Scene};

/// A scene, compiled with a march.
#[derive(Debug)]
pub struct Subject {
    /// What the march is called.
    pub march: String,
    /// The scene, with a probe.
    pub scene: Scene,
    /// Its program, in operations that mean the same on every target.
    pub program: Program,
}

impl Subject {
    /// A scene compiled with a march. An error says what is wrong with it.
    pub fn new(example: &Example, march: &Variant) -> Result<Subject, String> {
        let mut text = example.text.clone();
        if let Some(tolerance) = &march.tolerance {
            if text.lines().any(|line| line.trim_start().starts_with("render")) {
                return Err(format!("{} has a block `render` of its own", example.name));
            }
            text += &format!("\nrender {{ tolerance: {tolerance} }}\n");
        }
        let options =
            Options { attack: Some(0), probe: true, replaced: march.replaced.clone(), ..Options::default() };
        let compilation = sdf_lang::compile(&example.name, &text, &options);
        let said: Vec<&str> = compilation.diagnostics.iter().map(|d| &*d.message).collect();
        let scene = compilation.scene.ok_or_else(|| format!("{}, {}: {said:?}", example.name, march.name))?;
        let program = sdf_ir::legalise(&scene.program);
        Ok(Subject { march: march.name.clone(), scene, program })
    }
}
