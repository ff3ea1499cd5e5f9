//! Diagnostics for people: with the lines of the source that they are about.

use crate::terminal::place;
use ariadne::{Cache, Config, IndexType, Label, Report, ReportKind};
use sdf_syntax::{Diagnostic, FileId, Severity, Sources, Span};
use std::fmt::{self, Debug, Display};
use std::io;
use std::ops::Range;

/// Lines longer than this, in bytes, are not shown: their mistakes would be lost in them.
const LINE_LIMIT: usize = 400;
/// Messages longer than this, in characters, are cut.
const MESSAGE_LIMIT: usize = 1000;

pub const RED: &str = "\x1b[31m";
const YELLOW: &str = "\x1b[33m";
pub const GREEN: &str = "\x1b[32m";
pub const RESET: &str = "\x1b[0m";

/// The text of diagnostics, with colours.
pub fn diagnostics(sources: &Sources, diagnostics: &[Diagnostic]) -> Vec<u8> {
    let mut files = Files::new(sources);
    let mut out = Vec::new();
    for diagnostic in diagnostics {
        let start = out.len();
        if !files.can_show(diagnostic) || report(diagnostic, &mut files, &mut out).is_err() {
            out.truncate(start);
            out.extend_from_slice(in_words(diagnostic, sources).as_bytes());
        }
    }
    out
}

fn kind(severity: Severity) -> (&'static str, ariadne::Color, &'static str) {
    match severity {
        Severity::Error => ("error", ariadne::Color::Red, RED),
        Severity::Warning => ("warning", ariadne::Color::Yellow, YELLOW),
    }
}

/// A diagnostic with the lines of the source that it is about.
fn report(diagnostic: &Diagnostic, files: &mut Files, out: &mut Vec<u8>) -> io::Result<()> {
    let (word, color, _) = kind(diagnostic.severity());
    let place = files.place(diagnostic.span);
    // A place without a text would not be marked.
    let label = if diagnostic.label.is_empty() { "here" } else { &diagnostic.label };
    let main = Label::new(place.clone()).with_color(color).with_message(message(label));
    let related = diagnostic.related.iter().map(|label| {
        Label::new(files.place(label.span))
            .with_message(message(&label.text))
            .with_color(ariadne::Color::Blue)
    });
    let config = Config::default().with_index_type(IndexType::Byte).with_compact(false);
    let mut report = Report::build(ReportKind::Custom(word, color), place)
        .with_config(config)
        .with_code(diagnostic.code)
        .with_message(message(&diagnostic.message))
        .with_labels(related.chain([main]).collect::<Vec<_>>());
    if let Some(help) = &diagnostic.help {
        report = report.with_help(message(help));
    }
    report.finish().write(files, out)
}

/// A diagnostic without the source: where there is none to show, or its lines are too long.
fn in_words(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let (word, _, color) = kind(diagnostic.severity());
    let mut out = format!("{color}[{}] {word}{RESET}: {}\n", diagnostic.code, message(&diagnostic.message));
    let mut line = |what: &str, text: &str| {
        if !text.is_empty() {
            out.push_str(&format!("  {what}{}\n", message(text)));
        }
    };
    let name = place::name(sources, diagnostic.span);
    let label = match diagnostic.label.as_str() {
        "" => String::new(),
        label => format!(": {label}"),
    };
    if is_nowhere(diagnostic.span, sources) {
        line("in ", &format!("{name}{label}"));
    } else {
        let at = |span: Span| {
            let (line, column) = sources.line_column(span.file, span.start);
            let name = sources.get(span.file).map_or("", |source| &source.name);
            format!("{name}:{line}:{column}")
        };
        line("at ", &format!("{}{label}", at(diagnostic.span)));
        for related in &diagnostic.related {
            line("at ", &format!("{}: {}", at(related.span), related.text));
        }
    }
    line(&format!("{GREEN}help{RESET}: "), diagnostic.help.as_deref().unwrap_or_default());
    out
}

/// Whether a span stands for the file as a whole.
fn is_nowhere(span: Span, sources: &Sources) -> bool {
    span.end == 0 || sources.get(span.file).is_none_or(|source| source.text.is_empty())
}

/// The sources as the library for reports wants them.
struct Files<'a> {
    sources: &'a Sources,
    texts: Vec<Option<ariadne::Source>>,
}

impl<'a> Files<'a> {
    fn new(sources: &'a Sources) -> Files<'a> {
        Files { sources, texts: Vec::new() }
    }

    /// Whether the lines of a diagnostic can be shown.
    fn can_show(&self, diagnostic: &Diagnostic) -> bool {
        let related = diagnostic.related.iter().map(|label| label.span);
        let mut spans = related.chain([diagnostic.span]);
        !is_nowhere(diagnostic.span, self.sources) && spans.all(|span| self.has_short_lines(span))
    }

    fn has_short_lines(&self, span: Span) -> bool {
        let Some(source) = self.sources.get(span.file) else { return false };
        let bytes = source.text.as_bytes();
        let (_, range) = self.place(span);
        let start = bytes[..range.start].iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        let end =
            bytes[range.end..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |at| range.end + at);
        bytes[start..end].split(|b| *b == b'\n').all(|line| line.len() <= LINE_LIMIT)
    }

    fn place(&self, span: Span) -> (FileId, Range<usize>) {
        (span.file, place::bytes(self.sources, span))
    }
}

impl Cache<FileId> for &mut Files<'_> {
    type Storage = String;

    fn fetch(&mut self, id: &FileId) -> Result<&ariadne::Source, impl Debug> {
        let place = id.0 as usize;
        let Some(source) = self.sources.get(*id) else {
            return Err("the file belongs to another compilation");
        };
        if self.texts.len() <= place {
            self.texts.resize_with(place + 1, || None);
        }
        Ok(self.texts[place].get_or_insert_with(|| visible(&source.text).into()) as &ariadne::Source)
    }

    fn display<'b>(&self, id: &'b FileId) -> Option<impl fmt::Display + 'b> {
        self.sources.get(*id).map(|source| Box::new(visible(&source.name)) as Box<dyn Display>)
    }
}

/// A message that fits on a terminal, whatever names it quotes.
pub fn message(text: &str) -> String {
    match text.char_indices().nth(MESSAGE_LIMIT) {
        Some((end, _)) => visible(&text[..end]) + "…",
        None => visible(text),
    }
}

/// The text without characters that a terminal would obey or that would end a line elsewhere than for us. Each is
/// replaced by one of as many bytes, so that places stay the same.
fn visible(text: &str) -> String {
    let harmless = |c: char| match (c, c.len_utf8()) {
        ('\n' | '\t', _) => c,
        // The \r of a line that ends in \r\n would move to its beginning, where it is shown.
        ('\r', _) => ' ',
        ('\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}', _) => '\u{fffd}',
        (_, 1) if c.is_control() => '?',
        (_, 2) if c.is_control() => '\u{bf}',
        _ => c,
    };
    text.chars().map(harmless).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sdf_syntax::Code;

    fn shown(text: &str, span: Range<usize>) -> String {
        let mut sources = Sources::default();
        let file = sources.add("a.sdf", text);
        let diagnostic = Diagnostic::new(Code::E007, Span::new(file, span.start, span.end), "message")
            .label("label")
            .help("help");
        let mut files = Files::new(&sources);
        let mut out = Vec::new();
        if files.can_show(&diagnostic) {
            report(&diagnostic, &mut files, &mut out).unwrap();
        } else {
            out = in_words(&diagnostic, &sources).into_bytes();
        }
        anstream::adapter::strip_str(std::str::from_utf8(&out).unwrap()).to_string()
    }

    #[test]
    fn a_place_is_shown_with_its_line() {
        let out = shown("scene {\r\n  é(1)\r\n}\r\n", 11..13);
        assert!(out.contains("a.sdf:2:3"), "{out}");
        assert!(out.contains("é(1)") && out.contains("label") && out.contains("help"), "{out}");
    }

    #[test]
    fn any_span_can_be_shown() {
        let text = "a\u{85}b\u{2028}\x1b[31mé\r\n\r\x0b\n";
        for start in 0..text.len() + 3 {
            for end in start..text.len() + 5 {
                let out = shown(text, start..end);
                assert!(out.contains("message"), "{start}..{end}: {out}");
                assert!(!out.contains('\x1b') && !out.contains('\r'), "{start}..{end}: {out}");
            }
        }
        assert!(shown("", 0..0).contains("in a.sdf: label"));
    }

    #[test]
    fn a_long_line_is_told_in_words() {
        let out = shown(&"x".repeat(1_000_000), 500_000..500_001);
        assert!(out.len() < 200 && out.contains("at a.sdf:1:500001: label"), "{out}");
    }
}
