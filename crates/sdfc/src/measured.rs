//! What a program yields beside the colours of a picture, taken together; [`sdf_lang::View`] says what it is.

use crate::cost::scene_word;
use sdf_ir::{Program, Type};
use sdf_syntax::tree::{File, ItemKind, SettingsKind};
use sdf_syntax::{Code, Diagnostic, Span};

/// What was measured of the pixels of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// How many rays there were: one a pixel.
    pub rays: usize,
    /// How many of them ran out of steps.
    pub lost: usize,
    /// The least and the largest of what is more than 0, if anything is.
    pub range: Option<(f32, f32)>,
}

impl Measured {
    /// What the entry of a program has yielded beside the colours, if it yields anything there.
    pub(crate) fn of(program: &Program, beside: &[f32]) -> Option<Measured> {
        let rays = beside.len();
        let count = |is_lost: fn(&f32) -> bool| beside.iter().filter(|x| is_lost(x)).count();
        match type_beside(program)? {
            Type::Bool => Some(Measured { rays, lost: count(|x| *x == 1.0), range: None }),
            _ => {
                let measures = beside.iter().copied().filter(|x| *x > 0.0).map(|x| (x, x));
                let range = measures.reduce(|(low, high), (x, _)| (low.min(x), high.max(x)));
                Some(Measured { rays, lost: count(|x| *x < 0.0), range })
            }
        }
    }

    /// The warning about rays that ran out of steps, in a scene of this tree.
    pub fn warning(&self, tree: &File) -> Option<Diagnostic> {
        (self.lost > 0).then(|| out_of_steps(place_of_steps(tree), self.lost, self.rays))
    }
}

/// The type of what the entry of a program yields beside the colour of a pixel, if it yields anything there.
pub(crate) fn type_beside(program: &Program) -> Option<Type> {
    program.function(program.entry?).result_types().get(1).copied()
}

/// Where the steps of rays are set; the scene, where they are not.
fn place_of_steps(tree: &File) -> Span {
    let mut items = tree.items.iter();
    let render = items.find_map(|item| match &item.kind {
        ItemKind::Settings(SettingsKind::Render, record) => Some(record),
        _ => None,
    });
    let steps = render.and_then(|record| record.fields.iter().find(|field| &*field.name.text == "steps"));
    steps.map_or_else(|| scene_word(tree), |field| field.value.span)
}

fn out_of_steps(span: Span, lost: usize, rays: usize) -> Diagnostic {
    let percent = 100.0 * lost as f64 / rays as f64;
    let share = if percent < 0.01 { "less than 0.01 %".into() } else { format!("{percent:.2} %") };
    let they = if lost == 1 { "it is" } else { "they are" };
    Diagnostic::new(
        Code::W005,
        span,
        format!("{lost} of {rays} rays ran out of steps ({share}); {they} magenta"),
    )
    .label("too few steps")
    .help("raise `render { steps }`, or see where with `--view steps`")
}
