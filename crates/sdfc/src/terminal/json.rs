//! Messages for programs: one JSON object a line.
//!
//! Lines and columns count from 1, and columns count Unicode characters; bytes count from 0, in the text without a
//! byte order mark. Ends are those of the first character behind the place.

use crate::terminal::place;
use sdf_syntax::{Diagnostic, Severity, Sources, Span};
use sdfc::Clock;
use serde::Serialize;

/// A diagnostic, a note, or why the command stops.
#[derive(Debug, Serialize)]
pub struct Message<'a> {
    /// `error`, `warning` or `note`.
    severity: &'static str,
    /// The code, which `sdfc explain` knows more about; null for what is no diagnostic of a scene.
    code: Option<&'static str>,
    message: &'a str,
    /// What to do, where that is known.
    help: Option<&'a str>,
    /// The place that it is about; null for what is about no place in a file.
    span: Option<Place<'a>>,
    /// Other places that explain it.
    related: Vec<Place<'a>>,
}

/// A place with what is to be said about it.
#[derive(Debug, Serialize)]
struct Place<'a> {
    file: &'a str,
    /// What stands beside the place; may be empty.
    label: &'a str,
    start: Position,
    end: Position,
}

#[derive(Debug, Serialize)]
struct Position {
    byte: usize,
    line: usize,
    column: usize,
}

/// How long each stage took.
#[derive(Debug, Serialize)]
struct Timings {
    timings: Vec<Stage>,
}

#[derive(Debug, Serialize)]
struct Stage {
    stage: &'static str,
    milliseconds: f64,
}

impl<'a> Message<'a> {
    /// What a diagnostic says.
    pub fn of(diagnostic: &'a Diagnostic, sources: &'a Sources) -> Message<'a> {
        let related = diagnostic.related.iter();
        Message {
            severity: severity(diagnostic.severity()),
            code: Some(diagnostic.code.as_str()),
            message: &diagnostic.message,
            help: diagnostic.help.as_deref(),
            span: Some(Place::of(sources, diagnostic.span, &diagnostic.label)),
            related: related.map(|label| Place::of(sources, label.span, &label.text)).collect(),
        }
    }

    /// What is said about no place in a file.
    pub fn without_place(severity: &'static str, message: &'a str, help: Option<&'a str>) -> Message<'a> {
        Message { severity, code: None, message, help, span: None, related: Vec::new() }
    }

    /// The message as a line.
    pub fn line(&self) -> String {
        line(self)
    }
}

impl<'a> Place<'a> {
    fn of(sources: &'a Sources, span: Span, label: &'a str) -> Place<'a> {
        let bytes = place::bytes(sources, span);
        let position = |byte: usize| {
            let (line, column) = sources.line_column(span.file, byte as u32);
            Position { byte, line, column }
        };
        let (start, end) = (position(bytes.start), position(bytes.end));
        Place { file: place::name(sources, span), label, start, end }
    }
}

/// The times of stages as a line.
pub fn timings(clock: &Clock) -> String {
    let stages = clock.stages().iter();
    let timings = stages.map(|(stage, time)| Stage { stage, milliseconds: time.as_secs_f64() * 1e3 });
    line(&Timings { timings: timings.collect() })
}

fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}

fn line(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string(value).expect("strings and numbers can be written");
    text.push('\n');
    text
}
