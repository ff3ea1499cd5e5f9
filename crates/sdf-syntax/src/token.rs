//! Text to tokens: `lex(FileId, &str) → Lexed`, the tokens with their places, the documentation comments, and
//! what could not be read.
//!
//! Every mistake of this stage still leaves a token where one makes sense (a number for a bad number), so that
//! one mistake stays one message.

use crate::code::Code;
use crate::diagnostic::Diagnostic;
use crate::span::{FileId, Span};
use logos::{Lexer, Logos};

/// The most bytes one name, number, colour or string may have.
pub const TOKEN_LIMIT: usize = 1024;

/// One token. Spaces and comments make none.
#[derive(Logos, Debug, Clone, Copy, PartialEq)]
#[logos(extras = Notes)]
#[logos(skip r"[ \t\r\n\x0c]+")]
pub enum Token<'t> {
    /// `import`
    #[token("import")]
    Import,
    /// `param`
    #[token("param")]
    Param,
    /// `let`
    #[token("let")]
    Let,
    /// `fn`
    #[token("fn")]
    Fn,
    /// `if`
    #[token("if")]
    If,
    /// `else`
    #[token("else")]
    Else,
    /// `for`
    #[token("for")]
    For,
    /// `in`
    #[token("in")]
    In,
    /// `true`
    #[token("true")]
    True,
    /// `false`
    #[token("false")]
    False,
    /// `field`
    #[token("field")]
    Field,
    /// `field2`
    #[token("field2")]
    Field2,
    /// A name, or a word that is one only where an item begins.
    #[regex("[A-Za-z_][A-Za-z0-9_]*", name)]
    Name(&'t str),
    /// A number, its unit applied.
    #[regex(r"(\.[0-9][0-9_]*|[0-9][0-9_]*(\.[0-9][0-9_]*)?)([eE][+-]?[0-9][0-9_]*)?[A-Za-z0-9_]*", number)]
    Number(f64),
    /// A colour, in linear light.
    #[regex("#[A-Za-z0-9_]*", color)]
    Color([f64; 3]),
    /// `"text"`, without the quotes.
    #[regex(r#""[^"\n]*"?"#, text, allow_greedy = true)]
    Text(&'t str),
    /// `// …`, which makes no token, or `/// …`, which [`lex`] takes out again.
    #[regex(r"//[^\n]*", line_comment, allow_greedy = true)]
    #[token("/*", block_comment)]
    Doc(&'t str),
    /// `(`
    #[token("(")]
    OpenParen,
    /// `)`
    #[token(")")]
    CloseParen,
    /// `[`
    #[token("[")]
    OpenBracket,
    /// `]`
    #[token("]")]
    CloseBracket,
    /// `{`
    #[token("{")]
    OpenBrace,
    /// `}`
    #[token("}")]
    CloseBrace,
    /// `,`
    #[token(",")]
    Comma,
    /// `;`
    #[token(";")]
    Semicolon,
    /// `:`
    #[token(":")]
    Colon,
    /// `.`
    #[token(".")]
    Dot,
    /// `..`
    #[token("..")]
    DotDot,
    /// `...`
    #[token("...")]
    Ellipsis,
    /// `=`
    #[token("=")]
    Assign,
    /// `+`
    #[token("+")]
    Plus,
    /// `-`
    #[token("-")]
    Minus,
    /// `*`
    #[token("*")]
    Star,
    /// `/`
    #[token("/")]
    Slash,
    /// `%`
    #[token("%")]
    Percent,
    /// `!`
    #[token("!")]
    Bang,
    /// `&`
    #[token("&")]
    And,
    /// `|`
    #[token("|")]
    Or,
    /// `&&`
    #[token("&&")]
    AndAnd,
    /// `||`
    #[token("||")]
    OrOr,
    /// `<`
    #[token("<")]
    Less,
    /// `<=`
    #[token("<=")]
    LessEqual,
    /// `>`
    #[token(">")]
    Greater,
    /// `>=`
    #[token(">=")]
    GreaterEqual,
    /// `==`
    #[token("==")]
    Equal,
    /// `!=`
    #[token("!=")]
    NotEqual,
    /// `@`
    #[token("@")]
    At,
    /// `?`, which the language does not have, but other languages do.
    #[token("?")]
    Question,
}

/// The words that are reserved everywhere.
pub const RESERVED: [&str; 12] =
    ["import", "param", "let", "fn", "if", "else", "for", "in", "true", "false", "field", "field2"];

impl<'t> Token<'t> {
    /// The reserved word that the token is.
    pub fn keyword(self) -> Option<&'static str> {
        let place = match self {
            Token::Import => 0,
            Token::Param => 1,
            Token::Let => 2,
            Token::Fn => 3,
            Token::If => 4,
            Token::Else => 5,
            Token::For => 6,
            Token::In => 7,
            Token::True => 8,
            Token::False => 9,
            Token::Field => 10,
            Token::Field2 => 11,
            _ => return None,
        };
        Some(RESERVED[place])
    }

    /// The token as written, where it always is the same; else nothing.
    pub fn symbol(self) -> &'static str {
        match self {
            Token::OpenParen => "(",
            Token::CloseParen => ")",
            Token::OpenBracket => "[",
            Token::CloseBracket => "]",
            Token::OpenBrace => "{",
            Token::CloseBrace => "}",
            Token::Comma => ",",
            Token::Semicolon => ";",
            Token::Colon => ":",
            Token::Dot => ".",
            Token::DotDot => "..",
            Token::Ellipsis => "...",
            Token::Assign => "=",
            Token::Plus => "+",
            Token::Minus => "-",
            Token::Star => "*",
            Token::Slash => "/",
            Token::Percent => "%",
            Token::Bang => "!",
            Token::And => "&",
            Token::Or => "|",
            Token::AndAnd => "&&",
            Token::OrOr => "||",
            Token::Less => "<",
            Token::LessEqual => "<=",
            Token::Greater => ">",
            Token::GreaterEqual => ">=",
            Token::Equal => "==",
            Token::NotEqual => "!=",
            Token::At => "@",
            Token::Question => "?",
            _ => self.keyword().unwrap_or(""),
        }
    }

    /// Whether an expression can end with this token.
    pub fn ends_expression(self) -> bool {
        matches!(
            self,
            Token::Name(_)
                | Token::Number(_)
                | Token::Color(_)
                | Token::Text(_)
                | Token::True
                | Token::False
                | Token::CloseParen
                | Token::CloseBracket
                | Token::CloseBrace
        )
    }

    /// Whether an expression can begin with this token, other than with an operator or a bracket.
    pub fn begins_operand(self) -> bool {
        matches!(
            self,
            Token::Name(_)
                | Token::Number(_)
                | Token::Color(_)
                | Token::True
                | Token::False
                | Token::If
                | Token::For
                | Token::Field
                | Token::Field2
        )
    }

    /// The closing bracket that belongs to this opening one.
    pub fn partner(self) -> Option<Token<'t>> {
        match self {
            Token::OpenParen => Some(Token::CloseParen),
            Token::OpenBracket => Some(Token::CloseBracket),
            Token::OpenBrace => Some(Token::CloseBrace),
            _ => None,
        }
    }

    /// Whether it closes a bracket.
    pub fn closes(self) -> bool {
        matches!(self, Token::CloseParen | Token::CloseBracket | Token::CloseBrace)
    }
}

/// A token with its place.
pub type Spanned<'t> = (Token<'t>, Span);

/// The tokens of a text.
#[derive(Debug, Default)]
pub struct Lexed<'t> {
    /// The tokens.
    pub tokens: Vec<Spanned<'t>>,
    /// The `///` lines that stand directly before a token: the token's first byte, and the lines.
    pub docs: Vec<(u32, String)>,
    /// What could not be read, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// What the callbacks below have found wrong, with the range of bytes.
#[derive(Debug, Default, Clone)]
pub struct Notes(Vec<Problem>);

#[derive(Debug, Clone)]
struct Problem {
    start: usize,
    end: usize,
    make: fn(Span, &str) -> Diagnostic,
}

/// Reads all tokens of a text.
pub fn lex(file: FileId, text: &str) -> Lexed<'_> {
    lex_from(file, text, 0)
}

/// The same of what stands behind the first `skipped` bytes.
pub fn lex_from(file: FileId, text: &str, skipped: usize) -> Lexed<'_> {
    let mut lexed = Lexed::default();
    let mut docs: Vec<&str> = Vec::new();
    let mut unknown: Option<Span> = None;
    let mut lexer = Token::lexer(&text[skipped..]);
    if skipped == 0 && text.starts_with('\u{feff}') {
        lexer.bump('\u{feff}'.len_utf8());
    }
    while let Some(result) = lexer.next() {
        let range = lexer.span();
        let span = Span::new(file, skipped + range.start, skipped + range.end);
        let Ok(token) = result else {
            match &mut unknown {
                Some(run) if run.end == span.start => *run = run.to(span),
                _ => {
                    report_unknown(text, unknown.replace(span), &mut lexed.diagnostics);
                }
            }
            continue;
        };
        if let Token::Doc(line) = token {
            docs.push(line);
            continue;
        }
        if let Some((previous, before)) = lexed.tokens.last().copied()
            && before.end == span.start
            && let Some(problem) = cut_number(previous, token, text, span)
        {
            lexed.diagnostics.push(problem);
            continue;
        }
        if !docs.is_empty() {
            lexed.docs.push((span.start, docs.join("\n")));
            docs.clear();
        }
        lexed.tokens.push((token, span));
    }
    report_unknown(text, unknown, &mut lexed.diagnostics);
    for Problem { start, end, make } in std::mem::take(&mut lexer.extras.0) {
        let (start, end) = (skipped + start, skipped + end);
        lexed.diagnostics.push(make(Span::new(file, start, end), &text[start..end]));
    }
    lexed.diagnostics.sort_by_key(|d| d.span.start);
    lexed
}

fn report_unknown(text: &str, run: Option<Span>, diagnostics: &mut Vec<Diagnostic>) {
    if let Some(span) = run {
        diagnostics.push(unknown_characters(span, &text[span.start as usize..span.end as usize]));
    }
}

/// A mistake made of a number and what directly follows it: `1.` and `.5.5`.
fn cut_number(before: Token, token: Token, text: &str, span: Span) -> Option<Diagnostic> {
    let rest = &text[span.end as usize..];
    match (before, token) {
        (Token::Number(_), Token::Number(_)) => Some(two_points(span)),
        (Token::Number(_), Token::Dot)
            if !rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') =>
        {
            let digits = text[..span.start as usize]
                .rfind(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '.')
                .map_or(0, |i| i + text[i..].chars().next().map_or(1, char::len_utf8));
            Some(point_without_digit(span, &text[digits..span.start as usize]))
        }
        _ => None,
    }
}

fn note<'t>(lexer: &mut Lexer<'t, Token<'t>>, make: fn(Span, &str) -> Diagnostic) {
    let range = lexer.span();
    lexer.extras.0.push(Problem { start: range.start, end: range.end, make });
}

/// Whether the token is too long; that is noted.
fn too_long<'t>(lexer: &mut Lexer<'t, Token<'t>>) -> bool {
    let long = lexer.slice().len() > TOKEN_LIMIT;
    if long {
        note(lexer, token_too_long);
    }
    long
}

fn name<'t>(lexer: &mut Lexer<'t, Token<'t>>) -> &'t str {
    if too_long(lexer) { &lexer.slice()[..TOKEN_LIMIT] } else { lexer.slice() }
}

fn number<'t>(lexer: &mut Lexer<'t, Token<'t>>) -> f64 {
    if too_long(lexer) {
        return 1.0;
    }
    match read_number(lexer.slice()) {
        Ok(value) => value,
        Err(make) => {
            note(lexer, make);
            1.0
        }
    }
}

/// The units of angles.
pub const UNITS: [&str; 3] = ["deg", "rad", "turn"];

/// The value of a number as written, unit applied, or what is wrong with it.
fn read_number(written: &str) -> Result<f64, fn(Span, &str) -> Diagnostic> {
    let (digits, unit) = split_unit(written);
    let factor: fn(f64) -> f64 = match unit {
        "" | "rad" => |v| v,
        "deg" => f64::to_radians,
        "turn" => |v| v * std::f64::consts::TAU,
        _ => return Err(unknown_unit),
    };
    let value = digits.replace('_', "").parse().map(factor).map_err(|_| unknown_unit as fn(_, &_) -> _)?;
    if (value as f32).is_finite() { Ok(value) } else { Err(number_too_large) }
}

/// A number's digits and the letters after them. An `e` belongs to the digits where digits follow it.
fn split_unit(written: &str) -> (&str, &str) {
    let letters = |from: usize| {
        written[from..].find(|c: char| c.is_ascii_alphabetic()).map_or(written.len(), |i| from + i)
    };
    let first = letters(0);
    let exponent = written[first..].strip_prefix(['e', 'E']).map(|rest| rest.trim_start_matches(['+', '-']));
    match exponent {
        Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => written.split_at(letters(first + 1)),
        _ => written.split_at(first),
    }
}

fn color<'t>(lexer: &mut Lexer<'t, Token<'t>>) -> [f64; 3] {
    read_color(&lexer.slice()[1..]).unwrap_or_else(|| {
        if !too_long(lexer) {
            note(lexer, bad_color);
        }
        [0.5; 3]
    })
}

fn read_color(hex: &str) -> Option<[f64; 3]> {
    let digits: Vec<u32> = hex.chars().map(|c| c.to_digit(16)).collect::<Option<_>>()?;
    let bytes = match digits[..] {
        [r, g, b] => [r * 17, g * 17, b * 17],
        [r, s, g, h, b, c] => [r * 16 + s, g * 16 + h, b * 16 + c],
        _ => return None,
    };
    Some(bytes.map(|byte| linear_from_srgb(f64::from(byte) / 255.0)))
}

/// The linear light of an sRGB component, by the curve of IEC 61966-2-1.
pub fn linear_from_srgb(component: f64) -> f64 {
    if component <= 0.04045 { component / 12.92 } else { ((component + 0.055) / 1.055).powf(2.4) }
}

fn text<'t>(lexer: &mut Lexer<'t, Token<'t>>) -> &'t str {
    let inner = &lexer.slice()[1..];
    match inner.strip_suffix('"') {
        Some(inner) => {
            too_long(lexer);
            inner
        }
        None => {
            note(lexer, open_text);
            inner.trim_end_matches('\r')
        }
    }
}

fn line_comment<'t>(lexer: &mut Lexer<'t, Token<'t>>) -> logos::Filter<&'t str> {
    let line = lexer.slice().trim_end_matches('\r');
    match line.strip_prefix("///") {
        Some(doc) if !doc.starts_with('/') => logos::Filter::Emit(doc.strip_prefix(' ').unwrap_or(doc)),
        _ => logos::Filter::Skip,
    }
}

/// Skips to the `*/` that belongs to the `/*` just read.
fn block_comment<'t>(lexer: &mut Lexer<'t, Token<'t>>) -> logos::Filter<&'t str> {
    let rest = lexer.remainder().as_bytes();
    let mut depth = 1;
    let mut at = 0;
    while depth > 0 && at < rest.len() {
        let step = match &rest[at..] {
            [b'/', b'*', ..] => {
                depth += 1;
                2
            }
            [b'*', b'/', ..] => {
                depth -= 1;
                2
            }
            _ => 1,
        };
        at += step;
    }
    if depth > 0 {
        note(lexer, open_comment);
    }
    lexer.bump(at);
    logos::Filter::Skip
}

fn unknown_characters(span: Span, written: &str) -> Diagnostic {
    let shown: String = written.chars().take(8).flat_map(shown_character).collect();
    let more = if written.chars().count() > 8 { "…" } else { "" };
    let message = match written.chars().next().and_then(|c| Some((c, invisible(c)?))) {
        Some((c, (name, _))) => format!("there is {name} (U+{:04X}), which has no meaning here", c as u32),
        None => format!("`{shown}{more}` has no meaning here"),
    };
    let diagnostic = Diagnostic::new(Code::E002, span, message);
    let help = match written.chars().next() {
        Some('“' | '”' | '„' | '«' | '»' | '\'' | '‘' | '’') => {
            "texts stand in straight double quotes: `\"file.sdf\"`"
        }
        Some('−' | '–' | '—' | '‐' | '‑') => "write the minus as `-`",
        Some('≤') => "write `<=`",
        Some('≥') => "write `>=`",
        Some('≠') => "write `!=`",
        Some('²' | '³') => "write a power as `pow(a, b)`, or `a * a`",
        Some('°') => "write an angle as `45deg`",
        Some('∪') => "write the union as `a | b`",
        Some('∩') => "write the intersection as `a & b`",
        Some('…') => "write three points: `...`",
        Some('τ') => "write `tau`",
        Some(c) if full_width(c).is_some() => {
            let plain: String = written.chars().map(|c| full_width(c).unwrap_or(c)).take(40).collect();
            return diagnostic.help(format!("these are wide characters: write `{plain}`"));
        }
        Some(c) if invisible(c).is_some_and(|(_, space)| space) => "replace it by a plain space",
        Some('×' | '·') => "write the product as `*`",
        Some('÷') => "write the quotient as `/`",
        Some('π') => "write `pi`",
        Some('^') => "write a power as `pow(a, b)`",
        Some('~') => "write the complement of a shape as `!s`",
        Some('$' | '\\' | '`') => "remove it",
        Some(c) if c.is_alphabetic() => "names are made of `A-Z`, `a-z`, `0-9` and `_`",
        _ => return diagnostic.help("remove it"),
    };
    diagnostic.help(help)
}

/// A character as a message can show it: what a terminal would act upon is shown as its number.
fn shown_character(c: char) -> Vec<char> {
    if invisible(c).is_some() { c.escape_unicode().collect() } else { vec![c] }
}

/// What a character that cannot be seen, or looks like a space, is called, and whether it is some space.
fn invisible(c: char) -> Option<(&'static str, bool)> {
    Some(match c {
        '\u{a0}' | '\u{202f}' => ("a no-break space", true),
        '\u{1680}' | '\u{2000}'..='\u{200a}' | '\u{205f}' | '\u{3000}' => ("a special space", true),
        '\u{2028}' | '\u{2029}' | '\u{85}' | '\u{b}' => ("a special line break", true),
        '\u{200b}'..='\u{200d}' | '\u{2060}' => ("a character without width", false),
        '\u{feff}' => ("a byte order mark", false),
        '\u{ad}' => ("a soft hyphen", false),
        '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            ("a mark that changes the direction of writing", false)
        }
        c if c.is_control() => ("a control character", false),
        _ => return None,
    })
}

/// The plain character that a wide one of East Asian typography looks like.
fn full_width(c: char) -> Option<char> {
    matches!(c, '\u{ff01}'..='\u{ff5e}').then(|| char::from_u32(c as u32 - 0xfee0)).flatten()
}

fn token_too_long(span: Span, written: &str) -> Diagnostic {
    let message = format!("a word of {} bytes: at most {TOKEN_LIMIT} are allowed", written.len());
    Diagnostic::new(Code::E009, span, message)
}

fn unknown_unit(span: Span, written: &str) -> Diagnostic {
    let (digits, unit) = split_unit(written);
    let diagnostic = Diagnostic::new(Code::E003, span, format!("`{unit}` is no unit"));
    match unit {
        "f" | "F" | "u" | "lf" | "LF" => diagnostic.help(format!("numbers have no suffix: write `{digits}`")),
        "e" | "E" => diagnostic.help(format!("the exponent needs digits: `{digits}e3`")),
        "x" => diagnostic.help("numbers are decimal; colours are written `#ff8800`"),
        _ if let Some(meant) = crate::did_you_mean(unit, UNITS) => {
            diagnostic.help(format!("did you mean `{digits}{meant}`?"))
        }
        _ => diagnostic.help("the units are `deg`, `rad` and `turn`; a name cannot begin with a digit"),
    }
}

fn number_too_large(span: Span, _: &str) -> Diagnostic {
    Diagnostic::new(Code::E003, span, "the number is too large")
        .help("numbers are 32-bit floats: at most about 3.4e38")
}

fn point_without_digit(span: Span, digits: &str) -> Diagnostic {
    Diagnostic::new(Code::E003, span, "a decimal point needs a digit after it")
        .help(format!("write `{digits}.0`"))
}

fn two_points(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E003, span, "a number with two decimal points")
        .help("write a `,` between two numbers")
}

fn bad_color(span: Span, written: &str) -> Diagnostic {
    let digits = written.len() - 1;
    let hex = written[1..].chars().all(|c| c.is_ascii_hexdigit());
    let diagnostic = Diagnostic::new(Code::E004, span, "a colour has three or six hexadecimal digits");
    match (hex, digits) {
        (true, 4 | 8) => {
            diagnostic.label("has an alpha").help("colours have no alpha: write `#rgb` or `#rrggbb`")
        }
        _ => diagnostic.help("write `#rgb` or `#rrggbb`, for example `#ff8800`"),
    }
}

fn open_text(span: Span, _: &str) -> Diagnostic {
    Diagnostic::new(Code::E005, span, "the text does not end").help("add a `\"` on the same line")
}

fn open_comment(span: Span, _: &str) -> Diagnostic {
    Diagnostic::new(Code::E005, span, "the comment does not end")
        .label("begins here")
        .help("add `*/`; comments nest, so every `/*` needs its own")
}
