//! What a scene costs, and the lines that say so at the head of each text.

use crate::VERSION;
use sdf_emit::Header;
use sdf_ir::{Program, cost};
use sdf_lang::{Scene, Summary};
use sdf_syntax::tree::{File, ItemKind};
use sdf_syntax::{Code, Diagnostic, Span};

/// How many rounds of loops a pixel may take before graphics drivers are likely to give up.
pub const ITERATION_LIMIT: u64 = 60_000;

/// What a scene costs: counted, not measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Scalar operations of one evaluation of the scene's distance at most; 0 for a scene that is nothing.
    pub map: u64,
    /// Scalar operations of a pixel at most.
    pub pixel: u64,
    /// Rounds of loops of a pixel at most.
    pub iterations: u64,
}

impl Cost {
    /// The cost of a scene, whose program has become `program`.
    pub(crate) fn of(scene: &Scene, program: &Program) -> Cost {
        let of_entry = |count: fn(&Program, sdf_ir::FunctionId) -> u64| {
            program.entry.map_or(0, |entry| count(program, entry))
        };
        Cost {
            map: scene.map.map_or(0, |map| cost::operations(&scene.program, map)),
            pixel: of_entry(cost::operations),
            iterations: of_entry(cost::iterations),
        }
    }

    /// The warning about a scene that costs more than a shader can spend.
    pub(crate) fn warning(&self, tree: &File) -> Option<Diagnostic> {
        (self.iterations > ITERATION_LIMIT).then(|| too_costly(scene_word(tree), self.iterations))
    }
}

/// The first word of the scene block: the block may fill the screen.
pub fn scene_word(tree: &File) -> Span {
    let scene = tree.items.iter().find(|item| matches!(item.kind, ItemKind::Scene(_)));
    let span = scene.map_or(Span::default(), |item| item.span);
    Span { end: span.end.min(span.start + "scene".len() as u32), ..span }
}

fn too_costly(span: Span, iterations: u64) -> Diagnostic {
    let message = format!("a pixel of this scene takes up to {iterations} rounds of loops");
    Diagnostic::new(Code::W001, span, message)
        .label(format!("drivers are likely to give up above {ITERATION_LIMIT}"))
        .help("lower `steps`, `antialias`, `bounces` or the number of lights with shadows")
}

/// What stands at the head of each text. Its lines hold nothing that a user wrote.
/// The title is the name of the scene's file.
pub(crate) fn header(title: &str, summary: &Summary, cost: &Cost) -> Header {
    let shapes = match summary.shapes {
        1 => "1 shape".to_string(),
        n => format!("{n} shapes"),
    };
    let list = |items: Vec<&str>| if items.is_empty() { "none".to_string() } else { items.join(", ") };
    let mut lines = vec![
        format!("A scene of {shapes}, compiled by sdfc {VERSION}."),
        format!("Settings: {}.", list(summary.settings.iter().map(String::as_str).collect())),
        format!("Effects: {}.", list(summary.effects.clone())),
        format!(
            "Cost: {} operations an evaluation of the distance; at most {} rounds of loops a pixel.",
            cost.map, cost.iterations
        ),
    ];
    if summary.shapes > 0 {
        lines.push(
            "A shape's numbers stand in the map, in its gradient (normals) and in surface (colours): \
             change them in all."
                .to_string(),
        );
    }
    if cost.iterations > ITERATION_LIMIT {
        lines.push(format!("Warning: drivers are likely to give up above {ITERATION_LIMIT} rounds."));
    }
    Header { lines, title: title.to_owned(), figures: Vec::new() }
}
