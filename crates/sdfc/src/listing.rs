//! What the compiler has made of a scene, stage by stage, as text.

use crate::arguments::Stage;
use crate::facts;
use sdf_syntax::dump;
use sdfc::{Compiled, Cost};

/// The stages that can be shown; those after a mistake are missing. Several have a line above each that names it.
pub fn listing(stages: &[Stage], text: &str, compiled: &Compiled) -> String {
    let shown: Vec<(Stage, String)> =
        stages.iter().filter_map(|stage| Some((*stage, show(*stage, text, compiled)?))).collect();
    match &shown[..] {
        [(_, only)] => only.clone(),
        several => several.iter().map(|(stage, text)| format!("== {}\n{text}", name(*stage))).collect(),
    }
}

fn name(stage: Stage) -> &'static str {
    match stage {
        Stage::Tokens => "tokens",
        Stage::Ast => "ast",
        Stage::Facts => "facts",
        Stage::Ir => "ir",
        Stage::Total => "total",
        Stage::Cost => "cost",
    }
}

fn show(stage: Stage, text: &str, compiled: &Compiled) -> Option<String> {
    let output = compiled.output.as_ref();
    match stage {
        Stage::Tokens => Some(dump::tokens(sdf_lang::USER_FILE, text)),
        Stage::Ast => Some(dump::tree(&compiled.tree)),
        Stage::Facts => output.map(|(scene, _)| facts::table(&scene.facts)),
        Stage::Ir => output.map(|(scene, _)| scene.program.to_string()),
        Stage::Total => output.map(|(_, shader)| shader.program.to_string()),
        Stage::Cost => output.map(|(_, shader)| cost(shader.cost)),
    }
}

fn cost(Cost { map, pixel, iterations }: Cost) -> String {
    let rows = [
        ("operations of one evaluation of the distance", map),
        ("operations of a pixel, at most", pixel),
        ("rounds of loops of a pixel, at most", iterations),
    ];
    rows.iter().map(|(what, count)| format!("{what:<46}{count:>14}\n")).collect()
}
