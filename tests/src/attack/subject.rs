//! A call of a function of the library, compiled: the field, its gradient and what is proved of it.

use super::points::Points;
use crate::fields::{Field, entry};
use sdf_ir::eval::{Machine, Tape};
use sdf_lang::{Fact, Options};
use sdf_syntax::{Code, Diagnostic, Severity};

/// What a call gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A shape.
    Solid,
    /// A shape of the plane.
    Area,
    /// A number; the field is that number.
    Number,
    /// A vector; the field is its second component.
    Vector,
}

impl Kind {
    /// Whether it is a shape.
    pub fn is_shape(self) -> bool {
        matches!(self, Kind::Solid | Kind::Area)
    }

    /// How many coordinates its points have.
    pub fn axes(self) -> usize {
        if self == Kind::Area { 2 } else { 3 }
    }

    /// A scene whose field is that of the call. `stated` stands before what the call gives.
    pub fn scene(self, stated: &str, call: &str) -> String {
        match self {
            Kind::Solid => format!("{stated} let subject = {call}\nscene {{ subject }}\n"),
            Kind::Area => format!(
                "{stated} let subject = {call}\n@exact @bounds((lo(s), -1e20), (hi(s), 1e20)) \
                 fn area(s: shape2) = field {{ s(p.xy) }}\nscene {{ area(subject) }}\n"
            ),
            Kind::Number => format!("{stated} let subject = field {{ {call} }}\nscene {{ subject }}\n"),
            Kind::Vector => format!("{stated} let subject = field {{ ({call}).y }}\nscene {{ subject }}\n"),
        }
    }
}

/// Why there is no field.
#[derive(Debug, Clone, PartialEq)]
pub enum Refusal {
    /// What a function requires does not hold; the messages.
    Required(Vec<String>),
    /// The field's slope has no bound.
    Steep,
    /// It is larger than programs may be.
    TooLarge,
    /// Another mistake, in words.
    Mistake(String),
}

/// A compiled call.
#[derive(Debug)]
pub struct Subject {
    /// The call.
    pub call: String,
    /// What it gives.
    pub kind: Kind,
    /// What is proved of it; nothing where its slope had to be stated for it to compile.
    pub fact: Option<Fact>,
    /// The distance and the gradient.
    pub field: Field,
    /// Whether it is nothing at all.
    pub is_nothing: bool,
    distance: Tape,
    gradient: Tape,
}

/// The distance and its gradient at points.
#[derive(Debug)]
pub struct Sampled {
    /// The distances.
    pub distance: Vec<f64>,
    /// The gradients, a column for each component.
    pub gradient: Points,
}

impl Subject {
    /// That of a call that gives this.
    pub fn new(call: &str, kind: Kind) -> Result<Subject, Refusal> {
        match Subject::compile("", "", call, kind) {
            Err(Refusal::Steep) if !kind.is_shape() => {
                let mut subject = Subject::compile("", "@lipschitz(1)", call, kind)?;
                subject.fact = None;
                Ok(subject)
            }
            result => result,
        }
    }

    /// That of a shape of space in a file that begins with other items.
    pub fn with(items: &str, call: &str) -> Result<Subject, Refusal> {
        Subject::compile(items, "", call, Kind::Solid)
    }

    fn compile(items: &str, stated: &str, call: &str, kind: Kind) -> Result<Subject, Refusal> {
        let text = format!("{items}\n{}", kind.scene(stated, call));
        let options = Options { facts: true, attack: Some(0), ..Options::default() };
        let compilation = sdf_lang::compile(call, &text, &options);
        let Some(scene) = compilation.scene else { return Err(refusal(&compilation.diagnostics)) };
        // Below the scene's own row stands that of the shape, or of what makes it one of space and then that of the shape.
        let row = if kind == Kind::Area { 2 } else { 1 };
        let fact = Some(scene.facts.get(row).unwrap_or_else(|| panic!("{call}: no row {row}")).clone());
        let is_nothing = scene.map.is_none();
        let field = match scene.map {
            Some(map) => Field::of_map(&scene.program, map),
            None => Field::of_expression("sphere(1)"),
        };
        let tape = |program| Tape::compile(program, entry(program));
        let (distance, gradient) = (tape(&field.distance), tape(&field.gradient));
        Ok(Subject { call: call.into(), kind, fact, field, is_nothing, distance, gradient })
    }

    /// The distances at points.
    pub fn distances(&self, points: &Points) -> Vec<f64> {
        let mut out = vec![0.0; points[0].len()];
        Machine::<f64>::new(&self.distance).run(&[&points[0], &points[1], &points[2]], &mut [&mut out]);
        out
    }

    /// The distances and gradients at points.
    pub fn sample(&self, points: &Points) -> Sampled {
        let column = || vec![0.0; points[0].len()];
        let (mut distance, mut gradient) = (column(), [column(), column(), column()]);
        let [x, y, z] = &mut gradient;
        Machine::<f64>::new(&self.gradient)
            .run(&[&points[0], &points[1], &points[2]], &mut [&mut distance, x, y, z]);
        Sampled { distance, gradient }
    }

    /// What is proved of it; there must be something.
    pub fn fact(&self) -> &Fact {
        self.fact.as_ref().unwrap_or_else(|| panic!("{}: nothing is proved", self.call))
    }
}

fn refusal(diagnostics: &[Diagnostic]) -> Refusal {
    let errors: Vec<&Diagnostic> = diagnostics.iter().filter(|d| d.severity() == Severity::Error).collect();
    let required = errors.iter().filter(|d| d.code == Code::E043).map(|d| d.message.clone());
    if errors.iter().any(|d| d.code == Code::E043) {
        Refusal::Required(required.collect())
    } else if errors.iter().any(|d| d.code == Code::E052) {
        Refusal::Steep
    } else if errors.iter().any(|d| matches!(d.code, Code::E044 | Code::E045)) {
        Refusal::TooLarge
    } else {
        Refusal::Mistake(
            errors.iter().map(|d| format!("{}: {}", d.code, d.message)).collect::<Vec<_>>().join("; "),
        )
    }
}

/// What a call gives.
pub fn kind_of(call: &str) -> Result<Kind, String> {
    match sdf_lang::kind_of(call) {
        Ok(sdf_lang::Kind::Shape) => Ok(Kind::Solid),
        Ok(sdf_lang::Kind::Shape2) => Ok(Kind::Area),
        Ok(sdf_lang::Kind::Float) => Ok(Kind::Number),
        Ok(sdf_lang::Kind::Vec2 | sdf_lang::Kind::Vec3) => Ok(Kind::Vector),
        Ok(kind) => Err(format!("{call} is a {kind:?}")),
        Err(diagnostics) => Err(format!("{call}: {:?}", refusal(&diagnostics))),
    }
}
