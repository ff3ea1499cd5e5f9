//! Messages of one line each, for editors.

use crate::terminal::human::message;
use sdf_syntax::{Diagnostic, Severity, Sources};

/// `file:line:column: error[E020]: message (help: …)`
pub fn diagnostic(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let word = match diagnostic.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let span = diagnostic.span;
    let (line, column) = sources.line_column(span.file, span.start);
    let place = format!("{}:{line}:{column}", crate::terminal::place::name(sources, span));
    let kind = format!("{word}[{}]", diagnostic.code);
    entry(&place, &kind, &diagnostic.message, diagnostic.help.as_deref())
}

/// A line about a place or about the call.
pub fn entry(place: &str, kind: &str, text: &str, help: Option<&str>) -> String {
    let help = help.map_or_else(String::new, |help| format!(" (help: {help})"));
    // What quotes a file or an argument may have line ends in it.
    let line = message(&format!("{place}: {kind}: {text}{help}")).replace(['\n', '\r'], " ");
    line + "\n"
}
