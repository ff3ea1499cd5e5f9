//! Where something stands in a file, for whoever counts lines.

use sdf_syntax::{Sources, Span};
use std::ops::Range;

/// The bytes of a span, within its file and on the borders of characters.
pub fn bytes(sources: &Sources, span: Span) -> Range<usize> {
    let text = sources.get(span.file).map_or("", |source| &source.text);
    let border = |at: u32| {
        let at = (at as usize).min(text.len());
        (0..=at).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
    };
    let (start, end) = (border(span.start), border(span.end));
    start..end.max(start)
}

/// The name of a file, as the user gave it.
pub fn name(sources: &Sources, span: Span) -> &str {
    sources.get(span.file).map_or("", |source| &source.name)
}
