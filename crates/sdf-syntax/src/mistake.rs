//! What the grammar expected and did not find, told as a person would: from the place of the mismatch, the
//! tokens around it and what was expected there, to a [`Diagnostic`].

use crate::code::Code;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::outline::ITEM_WORDS;
use crate::span::Span;
use crate::token::{RESERVED, Spanned, Token};
use crate::tree::TypeKind;
use chumsky::DefaultExpected;
use chumsky::error::Error;
use chumsky::input::Input;
use chumsky::label::LabelError;
use chumsky::util::MaybeRef;

/// Something that the grammar can expect, as a message names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Expected {
    /// What is possible nearly everywhere and would only lengthen a message: an operator, for example.
    Unsaid,
    Item,
    Expression,
    Name,
    Type,
    Text,
    Block,
    Comma,
    Colon,
    Assign,
    Semicolon,
    In,
    DotDot,
    Else,
    Bar,
    OpenParen,
    OpenBrace,
    CloseParen,
    CloseBracket,
    CloseBrace,
}

/// All that can be expected, in the order in which a message lists it.
const WORDS: [(Expected, &str); 19] = [
    (Expected::Item, "an item"),
    (Expected::Expression, "an expression"),
    (Expected::Name, "a name"),
    (Expected::Type, "a type"),
    (Expected::Text, "a text"),
    (Expected::Block, "a block"),
    (Expected::Comma, "`,`"),
    (Expected::Colon, "`:`"),
    (Expected::Assign, "`=`"),
    (Expected::Semicolon, "`;`"),
    (Expected::In, "`in`"),
    (Expected::DotDot, "`..`"),
    (Expected::Else, "`else`"),
    (Expected::Bar, "`|`"),
    (Expected::OpenParen, "`(`"),
    (Expected::OpenBrace, "`{`"),
    (Expected::CloseParen, "`)`"),
    (Expected::CloseBracket, "`]`"),
    (Expected::CloseBrace, "`}`"),
];

impl From<Token<'_>> for Expected {
    fn from(token: Token<'_>) -> Expected {
        match token {
            Token::Comma => Expected::Comma,
            Token::Colon => Expected::Colon,
            Token::Assign => Expected::Assign,
            Token::Semicolon => Expected::Semicolon,
            Token::In => Expected::In,
            Token::DotDot => Expected::DotDot,
            Token::Else => Expected::Else,
            Token::Or => Expected::Bar,
            Token::OpenParen => Expected::OpenParen,
            Token::OpenBrace => Expected::OpenBrace,
            Token::CloseParen => Expected::CloseParen,
            Token::CloseBracket => Expected::CloseBracket,
            Token::CloseBrace => Expected::CloseBrace,
            _ => Expected::Unsaid,
        }
    }
}

/// A set of [`Expected`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Expectations(u32);

impl Expectations {
    fn insert(&mut self, expected: Expected) {
        if expected != Expected::Unsaid {
            self.0 |= 1 << expected as u32;
        }
    }

    fn has(self, expected: Expected) -> bool {
        self.0 & (1 << expected as u32) != 0
    }

    /// `a, b or c`; empty where nothing is worth saying.
    fn words(self) -> String {
        let words: Vec<&str> =
            WORDS.iter().filter(|(expected, _)| self.has(*expected)).map(|(_, word)| *word).collect();
        match words.split_last() {
            Some((last, [])) => (*last).to_string(),
            Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
            None => String::new(),
        }
    }
}

/// What a rule of the grammar reports.
#[derive(Debug, Clone)]
pub(crate) enum Mistake {
    /// The token at `span` does not fit.
    Mismatch { span: Span, expected: Expectations },
    /// Something that fits the grammar and is wrong nevertheless.
    Found(Box<Diagnostic>),
}

impl From<Diagnostic> for Mistake {
    fn from(diagnostic: Diagnostic) -> Mistake {
        Mistake::Found(Box::new(diagnostic))
    }
}

impl<'t, I: Input<'t, Span = Span, Token = Token<'t>>> Error<'t, I> for Mistake {
    fn merge(mut self, other: Mistake) -> Mistake {
        if let (Mistake::Mismatch { expected, .. }, Mistake::Mismatch { expected: more, .. }) =
            (&mut self, &other)
        {
            expected.0 |= more.0;
        }
        self
    }
}

impl<'t, I: Input<'t, Span = Span, Token = Token<'t>>> LabelError<'t, I, Expected> for Mistake {
    fn expected_found<E: IntoIterator<Item = Expected>>(
        words: E,
        _: Option<MaybeRef<'t, Token<'t>>>,
        span: Span,
    ) -> Mistake {
        let mut expected = Expectations::default();
        for word in words {
            expected.insert(word);
        }
        Mistake::Mismatch { span, expected }
    }

    fn label_with(&mut self, label: Expected) {
        if let Mistake::Mismatch { expected, .. } = self {
            *expected = Expectations::default();
            expected.insert(label);
        }
    }
}

impl<'t, I: Input<'t, Span = Span, Token = Token<'t>>> LabelError<'t, I, DefaultExpected<'t, Token<'t>>>
    for Mistake
{
    fn expected_found<E: IntoIterator<Item = DefaultExpected<'t, Token<'t>>>>(
        words: E,
        found: Option<MaybeRef<'t, Token<'t>>>,
        span: Span,
    ) -> Mistake {
        let words = words.into_iter().map(|word| match word {
            DefaultExpected::Token(token) => Expected::from(*token),
            DefaultExpected::EndOfInput => Expected::Item,
            _ => Expected::Unsaid,
        });
        <Mistake as LabelError<'t, I, Expected>>::expected_found(words, found, span)
    }
}

/// The tokens around the place of a mismatch.
struct Around<'t> {
    before_last: Option<Token<'t>>,
    last: Option<Spanned<'t>>,
    found: Option<Spanned<'t>>,
    next: Option<Token<'t>>,
    /// Whether the last token and the found one stand on one line.
    same_line: bool,
    /// Whether the found token belongs to the next item.
    outside: bool,
}

/// Tells what is wrong at a mismatch. `tokens` are all tokens of the file.
pub(crate) fn explain(mistake: Mistake, tokens: &[Spanned], text: &str) -> Diagnostic {
    let (span, expected) = match mistake {
        Mistake::Found(diagnostic) => return *diagnostic,
        Mistake::Mismatch { span, expected } => (span, expected),
    };
    let place = tokens.partition_point(|(_, token)| token.start < span.start);
    let around = Around {
        before_last: place.checked_sub(2).map(|p| tokens[p].0),
        last: place.checked_sub(1).map(|p| tokens[p]),
        found: tokens.get(place).copied(),
        next: tokens.get(place + 1).map(|(token, _)| *token),
        same_line: match (place.checked_sub(1).map(|p| tokens[p].1.end), tokens.get(place)) {
            (Some(end), Some((_, found))) => !text[end as usize..found.start as usize].contains('\n'),
            _ => false,
        },
        outside: span.start == span.end,
    };
    known_mistake(&around, expected).unwrap_or_else(|| mismatch(&around, expected, span))
}

/// The mistakes that have a message of their own, the surest first.
fn known_mistake(around: &Around, expected: Expectations) -> Option<Diagnostic> {
    let last = around.last.map(|(token, _)| token);
    let last_span = around.last.map_or(Span::default(), |(_, span)| span);
    let (found, span) = around.found?;
    let adjacent = last_span.end == span.start;
    if let Some(Token::Name("return")) = last
        && (found.begins_operand() || found.partner().is_some())
    {
        return Some(no_return(last_span));
    }
    match found {
        Token::Question => return Some(no_ternary(span)),
        Token::Star if last == Some(Token::Star) && adjacent => return Some(no_power(last_span.to(span))),
        Token::Plus | Token::Minus if last == Some(found) && adjacent => {
            return Some(no_increment(last_span.to(span)));
        }
        Token::Plus if expected.has(Expected::Expression) => return Some(no_prefix_plus(span)),
        Token::Assign
            if matches!(last, Some(Token::Plus | Token::Minus | Token::Star | Token::Slash)) && adjacent =>
        {
            return Some(no_assignment(last_span.to(span)));
        }
        Token::Assign if expected.has(Expected::Colon) => return Some(colon_not_assign(span)),
        Token::Assign if expected.has(Expected::OpenBrace) => return Some(equal_not_assign(span)),
        Token::Assign if matches!(around.before_last, Some(Token::OpenBrace | Token::Semicolon)) => {
            return Some(let_missing(last_span));
        }
        Token::Assign if expected.has(Expected::Item) || expected.has(Expected::CloseBrace) => {
            return Some(equal_not_assign(span));
        }
        Token::Colon if expected.has(Expected::Assign) => return Some(assign_not_colon(span)),
        Token::Colon if around.before_last == Some(Token::OpenBrace) => return Some(record_in_braces(span)),
        Token::Semicolon if expected.has(Expected::CloseBrace) && around.next == Some(Token::CloseBrace) => {
            return Some(semicolon_after_value(span));
        }
        Token::Minus if around.next == Some(Token::Greater) && expected.has(Expected::OpenBrace) => {
            return Some(no_result_type(span));
        }
        Token::OpenParen if matches!(last, Some(Token::Field | Token::Field2)) => {
            return Some(field_without_parameters(span));
        }
        Token::Text(_) if !expected.has(Expected::Text) => return Some(text_elsewhere(span)),
        Token::Name(written) if expected.has(Expected::Item) => {
            return Some(unknown_item(span, written, around));
        }
        Token::Fn | Token::Param | Token::Import if expected.has(Expected::Expression) && !around.outside => {
            return Some(item_inside(span, found));
        }
        _ => {}
    }
    let operand = found.begins_operand() || found == Token::OpenBrace || found == Token::Let;
    if expected.has(Expected::Comma) && operand && last.is_some_and(Token::ends_expression) {
        return Some(comma_missing(Span { start: last_span.end, ..last_span }, span));
    }
    None
}

/// Whether other languages begin a binding with this word.
pub(crate) fn instead_of_let(token: Token) -> bool {
    const WORDS: [&str; 18] = [
        "float", "int", "uint", "double", "bool", "vec2", "vec3", "vec4", "mat2", "mat3", "mat4", "const",
        "var", "auto", "f32", "def", "define", "set",
    ];
    matches!(token, Token::Name(word) if WORDS.contains(&word))
}

/// The found token as a message names it.
fn found_words(found: Option<Spanned>) -> String {
    let Some((token, _)) = found else { return "the end of the file".to_string() };
    if let Some(word) = token.keyword() {
        return format!("`{word}`");
    }
    match token {
        Token::Name(name) => format!("`{}`", shorten(name)),
        Token::Number(_) => "a number".to_string(),
        Token::Color(_) => "a colour".to_string(),
        Token::Text(_) => "a text".to_string(),
        other => format!("`{}`", other.symbol()),
    }
}

/// A name, cut where it is longer than a message should be.
fn shorten(name: &str) -> String {
    if name.len() > 40 { format!("{}…", &name[..40]) } else { name.to_string() }
}

fn mismatch(around: &Around, expected: Expectations, span: Span) -> Diagnostic {
    let found = found_words(around.found);
    let message = match expected.words().as_str() {
        "" => format!("{found} does not fit here"),
        "an item" if around.same_line => format!("expected an operator or an item, found {found}"),
        words => format!("expected {words}, found {found}"),
    };
    let diagnostic = match (around.outside, around.last, around.found) {
        (true, Some((_, last)), _) => Diagnostic::new(Code::E007, last, message).label("expected after this"),
        (_, _, Some((_, found))) => Diagnostic::new(Code::E007, found, message),
        _ => Diagnostic::new(Code::E007, span, message),
    };
    match help_for(around, expected) {
        Some(help) => diagnostic.help(help),
        None => diagnostic,
    }
}

/// What can be said about a mismatch that has no message of its own.
fn help_for(around: &Around, expected: Expectations) -> Option<String> {
    let found = around.found.map(|(token, _)| token);
    if expected.has(Expected::Item) && around.same_line {
        return None;
    }
    if expected.has(Expected::Text) {
        return Some("write the path in quotes: `import \"file.sdf\"`".to_string());
    }
    if found == Some(Token::Semicolon) && expected.has(Expected::Comma) {
        return Some("write `,`".to_string());
    }
    if found == Some(Token::Comma) && expected.has(Expected::CloseBrace) {
        return Some("a block has one value; a list is written `[a, b]`".to_string());
    }
    if expected.has(Expected::Item) {
        return Some(SHAPES_STAND.to_string());
    }
    if let (Some((Token::Name(word @ ("light" | "material")), _)), Some(Token::OpenBrace)) =
        (around.last, found)
    {
        return Some(format!("a {word} has a name: `{word} a {{ … }}`"));
    }
    None
}

pub(crate) fn reserved_name(span: Span, word: &str) -> Diagnostic {
    Diagnostic::new(Code::E023, span, format!("`{word}` is reserved")).help("choose another name")
}

pub(crate) fn chained(span: Span, symbol: &str) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E007, span, format!("`{symbol}` cannot follow another of its kind"));
    match symbol {
        ".." => diagnostic.help("a range has one beginning and one end"),
        _ => diagnostic.help("write `a < b && b < c`"),
    }
}

pub(crate) fn else_missing(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "the `if` has no `else`")
        .help("every `if` has a value: add `else { … }`")
}

pub(crate) fn block_without_value(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "the block has no value").help("end it with an expression, without `;`")
}

pub(crate) fn empty_tuple(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "expected an expression between `(` and `)`")
}

pub(crate) fn field_without_name(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "a value without a name in a record")
        .help("give every value a name, `(a: 1, b: 2)`, or none, `(1, 2)`")
}

pub(crate) fn positional_after_named(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "a positional argument after a named one")
        .help("put it first, or give it its name")
}

pub(crate) fn second_variadic(span: Span, name: &str) -> Diagnostic {
    let message = format!("`{}...` is the second parameter that takes any number", shorten(name));
    Diagnostic::new(Code::E007, span, message)
        .help("leave the `...` out here, and pass a list: `name: [a, b]`")
}

fn no_ternary(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E008, span, "there is no `?:`").help("write `if c { a } else { b }`")
}

fn no_result_type(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E008, span, "a function does not state what it gives")
        .help("leave out the `->` and the type: `fn f(a: vec3) { … }`")
}

fn field_without_parameters(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "a field has no parameters")
        .help("write `field { … }`; the point is called `p`")
}

pub(crate) fn range_before_default(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "the range of a param stands after its default")
        .help("write for example `param a = 0.5 in 0..1`")
}

fn no_power(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E008, span, "there is no `**`").help("write `pow(a, b)`")
}

fn no_increment(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E008, span, "there is no `++` or `--`")
        .help("names keep their value: bind a new one with `let`")
}

fn no_assignment(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E008, span, "there is no assignment")
        .help("names keep their value: bind a new one with `let`, or loop with `iterate`")
}

fn no_prefix_plus(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "expected an expression, found `+`").help("remove the `+`")
}

fn no_return(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E008, span, "there is no `return`")
        .help("the last expression of a block is its value: leave the word out")
}

fn colon_not_assign(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "expected `:`, found `=`")
        .help("names in calls and records are followed by `:`")
}

fn assign_not_colon(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "expected `=`, found `:`").help("write `name = value`")
}

fn equal_not_assign(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "`=` compares nothing").help("compare with `==`")
}

fn let_missing(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "a binding begins with `let`").help("write `let` before the name")
}

/// `float x = 1` and its like; `word` stands where `let` should.
pub(crate) fn let_not_type(span: Span, word: Token) -> Diagnostic {
    let message = match word {
        Token::Name("const" | "var" | "auto" | "def" | "define" | "set") => "a binding begins with `let`",
        _ => "a binding does not state its type",
    };
    Diagnostic::new(Code::E008, span, message).help("write `let name = value`")
}

fn record_in_braces(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "a record as a value has parentheses").help("write `(a: 1, b: 2)`")
}

fn semicolon_after_value(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "`;` after the value of a block").help("remove it")
}

fn text_elsewhere(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E007, span, "texts stand only in `import` and in attributes")
        .help("names have no quotes: `s.paint(gold)`")
}

fn comma_missing(between: Span, found: Span) -> Diagnostic {
    let place = Span { end: between.start, ..between };
    Diagnostic::new(Code::E007, found, "a `,` is missing before this")
        .related(place, "after this")
        .help("add a `,`")
}

fn item_inside(span: Span, found: Token) -> Diagnostic {
    Diagnostic::new(
        Code::E007,
        span,
        format!("`{}` begins an item and cannot stand in another", found.symbol()),
    )
    .help("move it out of the braces; a small function can be a lambda, `let f = |a| …`")
}

/// Where to put what is no item.
const SHAPES_STAND: &str = "shapes stand in `scene { … }`, values in `let name = …`";

pub(crate) fn unknown_type(span: Span, written: &str) -> Diagnostic {
    let types = TypeKind::ALL.map(TypeKind::word);
    let diagnostic = Diagnostic::new(Code::E007, span, format!("`{}` is no type", shorten(written)));
    match did_you_mean(&shorten(written), types) {
        Some(name) => diagnostic.help(format!("did you mean `{name}`?")),
        None => diagnostic.help(format!("the types are {}", types.join(", "))),
    }
}

fn unknown_item(span: Span, written: &str, around: &Around) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E007, span, format!("expected an item, found `{}`", shorten(written)));
    let replacement = match written {
        _ if instead_of_let(Token::Name(written)) => Some("let"),
        "function" | "func" | "fun" | "void" => Some("fn"),
        "uniform" => Some("param"),
        "include" | "use" => Some("import"),
        _ => None,
    };
    if let Some(word) = replacement {
        return diagnostic.help(format!("write `{word}`"));
    }
    let items = RESERVED[..4].iter().chain(&ITEM_WORDS).copied();
    let looks_alike = matches!(around.next, Some(Token::Name(_) | Token::OpenBrace | Token::Text(_)));
    match did_you_mean(&shorten(written), items).filter(|_| looks_alike) {
        Some(word) => diagnostic.help(format!("did you mean `{word}`?")),
        None if around.next == Some(Token::Assign) => {
            diagnostic.help(format!("write `let {} = …`", shorten(written)))
        }
        None if around.same_line => diagnostic.help("an operator or a `,` is missing before it"),
        None => diagnostic.help(SHAPES_STAND),
    }
}
