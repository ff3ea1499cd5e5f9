//! What the library's doc comments say, as data: [`reference`], the sections of the library with their entries.
//!
//! A doc comment says what a function makes; then, each on a line of its own, what its parameters are, where its
//! formula comes from and how it is called:
//!
//! ```text
//! /// A ball.
//! ///
//! /// - `r`: its radius, at least 0
//! ///
//! /// From: the definition.
//! /// Example: sphere(0.83)
//! ```
//!
//! A function without one is there for the library alone.

use crate::contract::{Contract, Quality};
use crate::library::{self, LibraryFile};
use crate::walk;
use sdf_syntax::Span;
use sdf_syntax::tree::{Expr, ExprKind, Function, Item, ItemKind, TypeKind};

/// The functions of one file of the library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// What they have in common, in a few words.
    pub title: String,
    /// The same as a sentence.
    pub introduction: String,
    /// The file's name, such as `shapes.sdf`.
    pub file: String,
    /// The functions, in the order of the file.
    pub entries: Vec<Entry>,
}

/// All functions of one name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The name.
    pub name: String,
    /// Each of the functions.
    pub forms: Vec<Form>,
}

/// A function, and what is said of it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Form {
    /// How it is called: its name and its parameters, as written.
    pub signature: String,
    /// What each parameter is.
    pub parameters: Vec<Parameter>,
    /// What it makes: one sentence.
    pub summary: String,
    /// What else is to be said, a paragraph each.
    pub text: Vec<String>,
    /// What its contract promises, in words.
    pub promises: Vec<String>,
    /// What it demands of its arguments, in words.
    pub requirements: Vec<String>,
    /// Where its formula comes from.
    pub source: Option<String>,
    /// Expressions that call it.
    pub examples: Vec<String>,
    /// The line of its name in the file.
    pub line: usize,
    /// Whether there is a `field` in its own body, to which its contract belongs; another function may hand on the shape
    /// of a third.
    pub has_field: bool,
}

/// A parameter of a function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its type, where one is written.
    pub ty: Option<TypeKind>,
    /// Whether it takes any number of arguments.
    pub variadic: bool,
    /// What it is if nothing is given, as written.
    pub default: Option<String>,
    /// What it means. A form may leave this to an earlier one that has a parameter of the same name.
    pub meaning: Option<String>,
}

impl Form {
    /// What its parameters mean; those that are explained together stand together.
    pub fn meanings(&self) -> Vec<(Vec<&str>, &str)> {
        let mut out: Vec<(Vec<&str>, &str)> = Vec::new();
        for parameter in &self.parameters {
            match (parameter.meaning.as_deref(), out.last_mut()) {
                (Some(meaning), Some((names, before))) if *before == meaning => names.push(&parameter.name),
                (Some(meaning), _) => out.push((vec![&parameter.name], meaning)),
                (None, _) => {}
            }
        }
        out
    }

    /// Whether it makes something of shapes or of functions, and not of numbers alone.
    pub fn is_operator(&self) -> bool {
        let kinds = [TypeKind::Shape, TypeKind::Shape2, TypeKind::Fn];
        self.parameters.iter().any(|parameter| parameter.ty.is_some_and(|ty| kinds.contains(&ty)))
    }
}

/// The public functions of the library, in its order.
pub fn reference() -> Vec<Section> {
    let mut sections: Vec<Section> = Vec::new();
    let shelf = library::std();
    for file in shelf.files() {
        let introduction = introduction(file);
        let title = introduction.split([',', ':', '.']).next().unwrap_or_default().to_string();
        let mut entries: Vec<Entry> = Vec::new();
        for item in shelf.items_of(file) {
            let ItemKind::Fn(function) = &item.kind else { continue };
            let form = form(file, item, function);
            let name = &*function.name.text;
            let earlier = sections.iter_mut().flat_map(|section| &mut section.entries);
            match earlier.chain(&mut entries).find(|entry| entry.name == name) {
                Some(entry) => entry.forms.push(form),
                None => entries.push(Entry { name: name.into(), forms: vec![form] }),
            }
        }
        sections.push(Section { title, introduction, file: file.short_name().into(), entries });
    }
    for section in &mut sections {
        section.entries.retain(|entry| entry.forms.iter().any(|form| !form.summary.is_empty()));
        section.entries.iter_mut().for_each(inherit);
    }
    sections
}

/// The comment that a file begins with, on one line.
fn introduction(file: &LibraryFile) -> String {
    let lines = file.text.lines().map_while(|line| line.strip_prefix("// "));
    lines.collect::<Vec<_>>().join(" ")
}

/// Gives forms what they leave to those before them: what parameters mean, and the source.
fn inherit(entry: &mut Entry) {
    for i in 1..entry.forms.len() {
        let (before, after) = entry.forms.split_at_mut(i);
        let form = &mut after[0];
        for parameter in form.parameters.iter_mut().filter(|parameter| parameter.meaning.is_none()) {
            let said = before.iter().rev().flat_map(|form| &form.parameters);
            let mut said = said.filter(|p| p.name == parameter.name).filter_map(|p| p.meaning.clone());
            parameter.meaning = said.next();
        }
        if form.source.is_none() {
            form.source = before.iter().rev().find_map(|form| form.source.clone());
        }
    }
}

fn form(file: &LibraryFile, item: &Item, function: &Function) -> Form {
    let quoted = |span: Span| one_line(&file.text[span.start as usize..span.end as usize]);
    let doc = Doc::of(&item.docs);
    let parameters = function.parameters.iter().map(|parameter| Parameter {
        name: parameter.name.text.to_string(),
        ty: parameter.ty.map(|ty| ty.kind),
        variadic: parameter.variadic,
        default: parameter.default.as_ref().map(|default| quoted(default.span)),
        meaning: doc
            .parameters
            .iter()
            .find(|(names, _)| names.iter().any(|name| **name == *parameter.name.text))
            .map(|(_, meaning)| meaning.clone()),
    });
    let mut form = Form {
        parameters: parameters.collect(),
        summary: doc.summary,
        text: doc.text,
        source: doc.source,
        examples: doc.examples,
        has_field: walk::any(&function.body, &mut |e| matches!(e.kind, ExprKind::Shape(..))),
        line: file.text[..function.name.span.start as usize].matches('\n').count() + 1,
        ..Form::default()
    };
    let written: Vec<String> = form.parameters.iter().map(Parameter::written).collect();
    form.signature = format!("{}({})", function.name.text, written.join(", "));
    let contract = Contract::of(&item.attributes, true, &mut Vec::new());
    form.promises = promises(&contract, form.is_operator(), quoted);
    form.requirements = contract.requirements.iter().map(|r| r.message.to_string()).collect();
    form
}

impl Parameter {
    /// The parameter as a signature has it.
    fn written(&self) -> String {
        let variadic = if self.variadic { "..." } else { "" };
        let ty = self.ty.map_or(String::new(), |ty| format!(": {}", ty.word()));
        let default = self.default.as_ref().map_or(String::new(), |value| format!(" = {value}"));
        format!("{}{variadic}{ty}{default}", self.name)
    }
}

/// The box that is stated where a shape has no end.
const ENDLESS: [&str; 2] = ["-1e20", "1e20"];

/// What a contract promises of a field, in words. `quoted` is the text of the file.
fn promises(contract: &Contract, is_operator: bool, quoted: impl Fn(Span) -> String) -> Vec<String> {
    let mut out = Vec::new();
    out.extend(contract.quality.map(|(quality, _)| {
        let words = match (quality, is_operator) {
            (Quality::Exact, false) => "exact: the distance itself, everywhere outside",
            (Quality::Exact, true) => "as exact as the shapes that it is given",
            (Quality::Bound, false) => "a bound: never more than the distance, and nowhere steeper than it",
            (Quality::Bound, true) => "a bound: no steeper than the shapes that it is given",
        };
        words.to_string()
    }));
    out.extend(contract.slope.map(|(slope, _)| format!("its slope is at most `{}`", quoted(slope.span))));
    out.extend(contract.bounds.map(|(lo, hi, _)| {
        let text = |end: &Expr| quoted(end.span);
        match [text(lo), text(hi)] {
            [lo, hi] if [&*lo, &*hi] == ENDLESS => "its box has no end".to_string(),
            _ if is_operator => "its box follows from those of the shapes that it is given".to_string(),
            [lo, hi] => format!("its box reaches from `{lo}` to `{hi}`"),
        }
    }));
    out.extend(contract.convex.map(|_| {
        let words = match is_operator {
            false => "convex: with any two points it holds what lies between them",
            true => "convex if the shapes that it is given are",
        };
        words.to_string()
    }));
    out
}

/// A doc comment, taken apart.
#[derive(Debug, Default, PartialEq)]
struct Doc {
    summary: String,
    text: Vec<String>,
    /// The parameters that have a line, by their names.
    parameters: Vec<(Vec<String>, String)>,
    source: Option<String>,
    examples: Vec<String>,
}

impl Doc {
    /// Takes the lines of a doc comment apart. A line goes on with what the line before it said, unless it begins
    /// something else or stands behind an empty line.
    fn of(lines: &str) -> Doc {
        let mut doc = Doc::default();
        let mut paragraphs: Vec<String> = Vec::new();
        let mut open: Option<Part> = None;
        for line in lines.lines().map(str::trim) {
            let part = if line.is_empty() {
                open = None;
                continue;
            } else if let Some((names, meaning)) = parameter_line(line) {
                doc.parameters.push((names, meaning.into()));
                Some(Part::Parameter)
            } else if let Some(source) = line.strip_prefix("From: ") {
                doc.source = Some(source.trim().to_string());
                Some(Part::Source)
            } else if let Some(example) = line.strip_prefix("Example: ") {
                doc.examples.push(example.trim().to_string());
                None
            } else {
                match open {
                    Some(Part::Paragraph) => append(paragraphs.last_mut(), line),
                    Some(Part::Parameter) => append(doc.parameters.last_mut().map(|(_, m)| m), line),
                    Some(Part::Source) => append(doc.source.as_mut(), line),
                    None => paragraphs.push(line.to_string()),
                }
                open.or(Some(Part::Paragraph))
            };
            open = part;
        }
        if let Some(first) = paragraphs.first_mut() {
            let rest = first.split_off(end_of_sentence(first));
            doc.summary = std::mem::take(first);
            *first = rest.trim_start().to_string();
        }
        doc.text = paragraphs.into_iter().filter(|paragraph| !paragraph.is_empty()).collect();
        doc
    }
}

/// What a line of a doc comment may go on with.
#[derive(Debug, Clone, Copy)]
enum Part {
    Paragraph,
    Parameter,
    Source,
}

fn append(to: Option<&mut String>, line: &str) {
    if let Some(to) = to {
        to.push(' ');
        to.push_str(line);
    }
}

/// The names and the meaning of "- `name`: meaning", or of "- `a`, `b`: meaning" where it is that of several.
fn parameter_line(line: &str) -> Option<(Vec<String>, &str)> {
    let (names, meaning) = line.strip_prefix("- `")?.split_once("`: ")?;
    Some((names.split("`, `").map(String::from).collect(), meaning.trim()))
}

/// Where the first sentence of a text ends.
pub(crate) fn end_of_sentence(text: &str) -> usize {
    text.find(". ").map_or(text.len(), |place| place + 1)
}

/// A text without line breaks.
pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doc_comment_is_taken_apart() {
        let doc = Doc::of(
            "A box with\nrounded edges. It is solid.\nAnd more.\n\nAnother paragraph.\n\n- `half`: half of its sizes,\n  \
             each above 0\n- `r`: the radius\n- `x`, `y`: the rest\n\nFrom: Inigo Quilez,\n\"Distance functions\".\nExample: round_box(0.5, 0.1)\n\
             Example: round_box(0.5, 0)",
        );
        let expected = Doc {
            summary: "A box with rounded edges.".into(),
            text: vec!["It is solid. And more.".into(), "Another paragraph.".into()],
            parameters: vec![
                (vec!["half".into()], "half of its sizes, each above 0".into()),
                (vec!["r".into()], "the radius".into()),
                (vec!["x".into(), "y".into()], "the rest".into()),
            ],
            source: Some("Inigo Quilez, \"Distance functions\".".into()),
            examples: vec!["round_box(0.5, 0.1)".into(), "round_box(0.5, 0)".into()],
        };
        assert_eq!(doc, expected);
        assert_eq!(Doc::of(""), Doc::default());
    }

    #[test]
    fn a_form_leaves_to_another_what_is_the_same() {
        let named = |name: &str, meaning: Option<&str>| Parameter {
            name: name.into(),
            ty: None,
            variadic: false,
            default: None,
            meaning: meaning.map(String::from),
        };
        let first = Form {
            parameters: vec![named("s", Some("a shape")), named("r", Some("how far"))],
            source: Some("the definition".into()),
            ..Form::default()
        };
        let second = Form { parameters: vec![named("r", None), named("q", None)], ..Form::default() };
        let mut entry = Entry { name: "f".into(), forms: vec![first, second] };
        inherit(&mut entry);
        assert_eq!(entry.forms[1].parameters, [named("r", Some("how far")), named("q", None)]);
        assert_eq!(entry.forms[1].source.as_deref(), Some("the definition"));
    }
}
