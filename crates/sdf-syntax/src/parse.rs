//! A whole file: `parse(FileId, &str) → (File, Vec<Diagnostic>)`, one stage a line.

use crate::code::Code;
use crate::diagnostic::Diagnostic;
use crate::mistake::{self, Mistake};
use crate::outline::{Outline, Piece, outline};
use crate::parser;
use crate::span::{FileId, Span};
use crate::token::{Lexed, lex_from};
use crate::tree::{File, Item};
use chumsky::Parser;
use chumsky::input::Input;
use std::ops::Range;

/// The most bytes a file may have.
pub const FILE_LIMIT: usize = 8 << 20;

/// The most diagnostics of one file; the last one says that there are more.
pub const DIAGNOSTIC_LIMIT: usize = 200;

/// The text of a file, without its byte order mark, or why it is none.
pub fn decode(file: FileId, bytes: &[u8]) -> Result<String, Diagnostic> {
    if bytes.len() > FILE_LIMIT {
        return Err(file_too_large(file));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| not_utf8(file, error.valid_up_to()))?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text).to_string())
}

/// Reads a file. What could not be read is missing from the tree, or is an [`ExprKind::Error`] in it, and is
/// told in the diagnostics, which are in the order of the text.
///
/// The parser's recursion is bounded by [`NESTING_LIMIT`](crate::outline::NESTING_LIMIT).
///
/// [`ExprKind::Error`]: crate::tree::ExprKind::Error
pub fn parse(file: FileId, text: &str) -> (File, Vec<Diagnostic>) {
    parse_part(file, text, 0..text.len())
}

/// Reads the items in a part of a file, the bytes in `part`. Their places are those that they have in the file.
pub fn parse_part(file: FileId, text: &str, part: Range<usize>) -> (File, Vec<Diagnostic>) {
    if text.len() > FILE_LIMIT {
        return (File::default(), vec![file_too_large(file)]);
    }
    let text = &text[..part.end];
    let lexed = lex_from(file, text, part.start);
    let outlined = outline(text, file, &lexed.tokens, comment_is_open(&lexed));
    let (items, mistakes) = items(file, text, &lexed, &outlined);
    let mut diagnostics = lexed.diagnostics;
    diagnostics.extend(outlined.diagnostics);
    diagnostics.extend(mistakes);
    diagnostics.sort_by_key(|d| (d.span.start, d.span.end));
    limit(&mut diagnostics);
    (File { items }, diagnostics)
}

/// Parses the items one by one, so that a mistake in one leaves the others alone.
fn items(file: FileId, text: &str, lexed: &Lexed, outlined: &Outline) -> (Vec<Item>, Vec<Diagnostic>) {
    let rule = parser::item();
    let mut items = Vec::new();
    let mut diagnostics = Vec::new();
    for Piece { tokens, mended } in &outlined.items {
        let behind = outlined.tokens.get(tokens.end).map_or(text.len(), |(_, span)| span.start as usize);
        let slice = &outlined.tokens[tokens.clone()];
        let (item, mistakes) =
            rule.parse(slice.split_token_span(Span::new(file, behind, behind))).into_output_errors();
        if let Some(mut item) = item.flatten() {
            item.docs = docs(lexed, slice[0].1.start, item.span.start);
            items.push(item);
        }
        for mistake in mistakes.into_iter().take(DIAGNOSTIC_LIMIT + 1) {
            if !follows_from_another(&mistake, lexed, *mended) {
                diagnostics.push(mistake::explain(mistake, &lexed.tokens, text));
            }
        }
        if diagnostics.len() > DIAGNOSTIC_LIMIT {
            break;
        }
    }
    (items, diagnostics)
}

/// The documentation that stands before an item or between its attributes.
fn docs(lexed: &Lexed, from: u32, to: u32) -> String {
    let first = lexed.docs.partition_point(|(start, _)| *start < from);
    lexed.docs[first..]
        .first()
        .filter(|(start, _)| *start <= to)
        .map_or_else(String::new, |(_, text)| text.clone())
}

/// Whether a mismatch is likely due to something that has been reported: a mended bracket before it, or a
/// character directly before it that could not be read.
fn follows_from_another(mistake: &Mistake, lexed: &Lexed, mended: Option<u32>) -> bool {
    let (span, mismatch) = match mistake {
        Mistake::Mismatch { span, .. } => (*span, true),
        Mistake::Found(diagnostic) => (diagnostic.span, false),
    };
    if mended.is_some_and(|from| span.start >= from) {
        return true;
    }
    let place = lexed.tokens.partition_point(|(_, token)| token.start < span.start);
    let from = place.checked_sub(1).map_or(0, |before| lexed.tokens[before].1.start);
    let to = lexed.tokens.get(place).map_or(u32::MAX, |(_, token)| token.end);
    let first = lexed.diagnostics.partition_point(|d| d.span.start < from);
    mismatch && lexed.diagnostics.get(first).is_some_and(|d| d.span.start < to)
}

fn comment_is_open(lexed: &Lexed) -> bool {
    let after = lexed.tokens.last().map_or(0, |(_, span)| span.end);
    lexed.diagnostics.last().is_some_and(|d| d.code == Code::E005 && d.span.start >= after)
}

/// Cuts what nobody reads.
fn limit(diagnostics: &mut Vec<Diagnostic>) {
    if diagnostics.len() > DIAGNOSTIC_LIMIT {
        diagnostics.truncate(DIAGNOSTIC_LIMIT);
        let span = diagnostics[DIAGNOSTIC_LIMIT - 1].span;
        diagnostics.push(too_many_mistakes(span));
    }
}

fn not_utf8(file: FileId, offset: usize) -> Diagnostic {
    let span = Span::new(file, offset, offset);
    Diagnostic::new(Code::E001, span, format!("the file is not UTF-8: byte {offset} fits no character"))
        .help("save it as UTF-8")
}

fn file_too_large(file: FileId) -> Diagnostic {
    let message = format!("the file has more than {FILE_LIMIT} bytes");
    Diagnostic::new(Code::E009, Span::new(file, 0, 0), message)
        .help("move parts of it into files of their own and `import` them")
}

fn too_many_mistakes(span: Span) -> Diagnostic {
    Diagnostic::new(
        Code::E009,
        span,
        format!("more than {DIAGNOSTIC_LIMIT} mistakes: the others are not shown"),
    )
    .help("mend these first")
}
