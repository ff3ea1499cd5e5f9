//! Tokens to items: `outline(&str, FileId, &[Spanned]) → Outline`, before any parsing.
//!
//! The walk matches brackets, limits the nesting, and cuts the tokens where an item begins. What it hands on is
//! balanced: a missing bracket is added and a spare one is dropped, so that the parser sees neither and its
//! recursion is bounded. An item that was mended in this way is marked, and the parser's own errors in it are
//! not shown: one mistake is one message.

use crate::code::Code;
use crate::diagnostic::Diagnostic;
use crate::span::{FileId, Span};
use crate::token::{Spanned, Token};
use std::ops::Range;

/// How deeply brackets, prefix operators, lambdas and `else if` may nest, all of them together.
pub const NESTING_LIMIT: usize = 256;

/// The words that begin an item and are names elsewhere.
pub const ITEM_WORDS: [&str; 9] =
    ["material", "camera", "light", "ambient", "sky", "fog", "rim", "render", "scene"];

/// The balanced tokens of a file, cut into items.
#[derive(Debug, Default)]
pub struct Outline<'t> {
    /// All tokens, balanced within each item.
    pub tokens: Vec<Spanned<'t>>,
    /// The items, in order, without gaps.
    pub items: Vec<Piece>,
    /// What is wrong with the brackets.
    pub diagnostics: Vec<Diagnostic>,
}

/// The tokens of one item.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Which tokens.
    pub tokens: Range<usize>,
    /// From which byte on a mistake has been reported already, so that others are likely to follow from it.
    pub mended: Option<u32>,
}

/// Matches brackets, checks the nesting and finds the items. Where the tokens are `cut_off`, by a comment that
/// does not end, brackets that are open at the end are no mistake.
pub fn outline<'t>(text: &str, file: FileId, tokens: &[Spanned<'t>], cut_off: bool) -> Outline<'t> {
    let mut walk = Walk {
        text,
        tokens,
        out: Outline::default(),
        open: Vec::new(),
        level: Level::default(),
        depth: 0,
        begin: 0,
        mended: None,
        too_deep: false,
        in_attributes: false,
    };
    for place in 0..tokens.len() {
        walk.step(place);
    }
    let end = Span::new(file, text.len(), text.len());
    if cut_off {
        walk.close_silently(end);
    } else {
        walk.close_all(end, "the end of the file");
    }
    walk.finish_item();
    walk.out
}

/// An open bracket.
struct Open<'t> {
    token: Token<'t>,
    span: Span,
    /// What was pending around it.
    outer: Level,
}

/// What is pending at one level of brackets, beside the brackets themselves. Each entry is one level of
/// recursion in the parser or of depth in the tree.
#[derive(Default, Clone, Copy)]
struct Level {
    /// Prefix operators directly before this place.
    prefixes: usize,
    /// Lambdas whose body is not over.
    lambdas: usize,
    /// Whether the parameters of a lambda are being read.
    in_parameters: bool,
    /// `if` and `for` whose block has not begun.
    heads: usize,
    /// `else if`s of the chain that is being read.
    elses: usize,
}

impl Level {
    fn depth(&self) -> usize {
        self.prefixes + self.lambdas + self.heads + self.elses
    }
}

struct Walk<'s, 't> {
    text: &'s str,
    tokens: &'s [Spanned<'t>],
    out: Outline<'t>,
    open: Vec<Open<'t>>,
    level: Level,
    /// The depths of the levels around, and one for each bracket.
    depth: usize,
    /// Where the current item begins, in the balanced tokens.
    begin: usize,
    mended: Option<u32>,
    too_deep: bool,
    /// Whether all that the item has so far is attributes.
    in_attributes: bool,
}

impl<'t> Walk<'_, 't> {
    fn token(&self, place: usize) -> Option<Token<'t>> {
        self.tokens.get(place).map(|(token, _)| *token)
    }

    fn step(&mut self, place: usize) {
        let (token, span) = self.tokens[place];
        if token == Token::Let && self.lets_are_impossible(place) {
            self.close_while(span, "this `let`", |open| open != Token::OpenBrace);
        }
        if self.begins_item(place) {
            self.close_all(span, "the next item");
            if !self.in_attributes {
                self.finish_item();
            }
            self.in_attributes = token == Token::At;
        }
        if token.partner().is_some() {
            self.push_bracket(place);
        } else if token.closes() {
            self.pop_bracket(place);
            return;
        } else {
            self.count(place);
        }
        self.emit(token, span);
        if !self.too_deep && self.depth + self.level.depth() > NESTING_LIMIT {
            self.too_deep = true;
            self.mended = Some(0);
            self.out.diagnostics.push(too_deep(span));
        }
    }

    /// Hands a token on, except where the nesting is too deep to be parsed.
    fn emit(&mut self, token: Token<'t>, span: Span) {
        if !self.too_deep {
            self.out.tokens.push((token, span));
        }
    }

    /// Whether the token at `place` begins an item. Inside of open brackets this is only believed at the very
    /// beginning of a line.
    fn begins_item(&self, place: usize) -> bool {
        let (token, span) = self.tokens[place];
        let previous = place.checked_sub(1).and_then(|p| self.token(p));
        let inside = !self.open.is_empty();
        if inside && (!self.begins_line(span) || token == Token::Let) {
            return false;
        }
        let next = self.token(place + 1);
        let free = previous.is_none_or(|p| p.ends_expression() || p == Token::Semicolon);
        let first = self.begins_line(span);
        match token {
            Token::At => free || first,
            Token::Import | Token::Param | Token::Let | Token::Fn if next == Some(Token::OpenBrace) => false,
            Token::Import | Token::Param | Token::Let | Token::Fn => match previous {
                Some(Token::Let | Token::Param | Token::Fn) => {
                    !matches!(next, Some(Token::Assign | Token::OpenParen | Token::Colon))
                }
                Some(Token::Dot) => first,
                Some(Token::Colon) => !inside && !self.level.in_parameters,
                _ => true,
            },
            Token::Name(name) => {
                let known = ITEM_WORDS.contains(&name);
                let named = next.is_some_and(|t| matches!(t, Token::Name(_)) || t.keyword().is_some())
                    && self.token(place + 2) == Some(Token::OpenBrace);
                let shape = named || next == Some(Token::OpenBrace);
                if inside {
                    free && known && shape
                } else if free {
                    let words = shape || matches!(next, Some(Token::Name(_)));
                    (known && shape && !self.names_item()) || (first && words)
                } else {
                    first && known && shape && (named || name != "material")
                }
            }
            _ => false,
        }
    }

    /// Whether the next name is the one in `light NAME {`.
    fn names_item(&self) -> bool {
        matches!(self.out.tokens[self.begin..], [(Token::Name(_), _)])
    }

    fn begins_line(&self, span: Span) -> bool {
        let before = &self.text.as_bytes()[..span.start as usize];
        before.last().is_none_or(|byte| *byte == b'\n') || before == [0xef, 0xbb, 0xbf]
    }

    /// Whether the `let` at `place` is a binding and stands where none can: in parentheses or brackets.
    fn lets_are_impossible(&self, place: usize) -> bool {
        let binds = matches!(self.token(place + 1), Some(Token::Name(_)));
        binds && self.open.last().is_some_and(|open| open.token != Token::OpenBrace)
    }

    fn finish_item(&mut self) {
        if self.too_deep {
            self.keep_heading();
        }
        let tokens = self.begin..self.out.tokens.len();
        self.begin = tokens.end;
        if !tokens.is_empty() {
            self.out.items.push(Piece { tokens, mended: self.mended });
        }
        self.level = Level::default();
        self.depth = 0;
        self.mended = None;
        self.too_deep = false;
        self.in_attributes = false;
    }

    /// Of an item that is nested too deeply only what names it is handed on: `let a =`, `fn f`.
    fn keep_heading(&mut self) {
        let item = &self.out.tokens[self.begin..];
        let heading = item.iter().take(3).take_while(|(token, _)| token.partner().is_none()).count();
        self.out.tokens.truncate(self.begin + heading);
    }

    fn push_bracket(&mut self, place: usize) {
        let (token, span) = self.tokens[place];
        let previous = place.checked_sub(1).and_then(|p| self.token(p));
        if token == Token::OpenBrace && self.level.heads > 0 && ends_head(previous) {
            self.level.heads -= 1;
        }
        self.open.push(Open { token, span, outer: self.level });
        self.depth += 1 + self.level.depth();
        self.level = Level::default();
    }

    fn pop_bracket(&mut self, place: usize) {
        let (token, span) = self.tokens[place];
        let fits = |open: &Open| open.token.partner() == Some(token);
        let Some(top) = self.open.last() else {
            return self.report_spare(span, token);
        };
        if fits(top) {
            self.pop(span);
        } else if self.too_deep {
            return;
        } else if self.open.iter().any(fits) {
            self.close_while(span, word(token), |open| open.partner() != Some(token));
            self.pop(span);
        } else {
            let partner = top.token.partner().unwrap_or(token);
            let opener = top.span;
            let next_fits = self.token(place + 1) == Some(partner);
            if next_fits {
                return self.report_spare(span, token);
            }
            self.report(mistaken(span, token, partner, opener));
            self.pop(span);
        }
        self.end_of_operand(place);
    }

    /// Closes the innermost bracket with its partner at `span`.
    fn pop(&mut self, span: Span) {
        if let Some(open) = self.open.pop() {
            self.level = open.outer;
            self.depth -= 1 + open.outer.depth();
            self.level.prefixes = 0;
            let partner = open.token.partner().unwrap_or(open.token);
            self.emit(partner, span);
        }
    }

    /// Ends a chain of `else if` that does not go on after this place.
    fn end_of_operand(&mut self, place: usize) {
        if self.level.heads == 0 && self.token(place + 1) != Some(Token::Else) {
            self.level.elses = 0;
        }
    }

    /// Closes the innermost brackets as long as they are of the kind in question; one message for all.
    fn close_while(&mut self, at: Span, found: &str, matches: impl Fn(Token) -> bool) {
        let unclosed = self.open.iter().rev().take_while(|open| matches(open.token)).count();
        if unclosed == 0 {
            return;
        }
        let from = self.open.len() - unclosed;
        let places: Vec<(Token, Span)> =
            self.open[from..].iter().rev().take(8).map(|open| (open.token, open.span)).collect();
        self.report(unclosed_brackets(&places, at, found));
        for _ in 0..unclosed {
            self.pop(Span { end: at.start, ..at });
        }
    }

    fn close_all(&mut self, at: Span, found: &str) {
        self.close_while(at, found, |_| true);
    }

    fn close_silently(&mut self, at: Span) {
        self.mended = self.mended.or(self.open.first().map(|open| open.span.start));
        while !self.open.is_empty() {
            self.pop(at);
        }
    }

    /// Reports a bracket, and marks the item from there on as mended.
    fn report(&mut self, diagnostic: Diagnostic) {
        let start = diagnostic.span.start;
        self.mended = Some(self.mended.map_or(start, |first| first.min(start)));
        if !self.too_deep {
            self.out.diagnostics.push(diagnostic);
        }
    }

    /// Reports a bracket that closes nothing, unless that is likely due to another mistake in the item.
    fn report_spare(&mut self, span: Span, token: Token) {
        if self.mended.is_none() {
            self.report(spare(span, token));
        }
    }

    /// Keeps count of what nests without brackets.
    fn count(&mut self, place: usize) {
        let token = self.tokens[place].0;
        let operand_before =
            place.checked_sub(1).and_then(|p| self.token(p)).is_some_and(Token::ends_expression);
        let level = &mut self.level;
        match token {
            Token::Minus | Token::Bang if !operand_before => level.prefixes += 1,
            Token::Or if level.in_parameters => level.in_parameters = false,
            Token::Or if !operand_before => {
                level.lambdas += 1;
                level.in_parameters = true;
            }
            Token::OrOr if !operand_before => level.lambdas += 1,
            Token::If | Token::For => {
                level.prefixes = 0;
                level.heads += 1;
                if place.checked_sub(1).and_then(|p| self.token(p)) == Some(Token::Else) {
                    self.level.elses += 1;
                }
            }
            Token::Comma if level.in_parameters => {}
            Token::Comma | Token::Semicolon | Token::Let => *level = Level::default(),
            _ => level.prefixes = 0,
        }
    }
}

/// Whether a `{` after this token is the block that a head (`if c`, `for i in list`) waits for, and not the
/// beginning of an operand.
fn ends_head(previous: Option<Token>) -> bool {
    previous.is_some_and(|token| token.ends_expression() && token != Token::Name("material"))
}

/// A bracket as a message names it.
fn word(token: Token) -> &'static str {
    match token {
        Token::OpenParen => "`(`",
        Token::CloseParen => "`)`",
        Token::OpenBracket => "`[`",
        Token::CloseBracket => "`]`",
        Token::OpenBrace => "`{`",
        _ => "`}`",
    }
}

fn too_deep(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E009, span, format!("nested more than {NESTING_LIMIT} deep"))
        .label("too deep from here on")
        .help("name an inner part with `let`")
}

fn spare(span: Span, token: Token) -> Diagnostic {
    Diagnostic::new(Code::E006, span, format!("{} closes nothing", word(token))).help("remove it")
}

fn mistaken(span: Span, found: Token, partner: Token, opener: Span) -> Diagnostic {
    Diagnostic::new(Code::E006, span, format!("expected {}, found {}", word(partner), word(found)))
        .related(opener, "opened here")
        .help(format!("write {} here", word(partner)))
}

fn unclosed_brackets(open: &[(Token, Span)], at: Span, found: &str) -> Diagnostic {
    let (token, span) = open[0];
    let partners: String =
        open.iter().filter_map(|(t, _)| t.partner()).map(|t| word(t).trim_matches('`')).collect();
    let mut diagnostic = Diagnostic::new(Code::E006, span, format!("{} is not closed", word(token)))
        .label("opened here")
        .related(Span { end: at.start, ..at }, format!("`{partners}` expected before {found}"));
    for (_, span) in &open[1..] {
        diagnostic = diagnostic.related(*span, "not closed either");
    }
    diagnostic.help(format!("add `{partners}`"))
}
