//! Tokens to tree: `item() → Rule<Item>`, one function for each production, its production as its comment.
//!
//! The notation: `"x"` is a token, `A B` one after the other, `A | B` a choice, `A?` at most one, `A*` any number,
//! `A,*` any number with commas between and, if wanted, after them. Names in capitals are tokens.
//!
//! A mistake inside a list (arguments, records, shapes) costs its element, another one its item; the parser goes
//! on behind it. [`crate::outline`] has matched the brackets and limited the nesting before.

use crate::mistake::{self, Expected, Mistake};
use crate::span::Span;
use crate::token::{Spanned, Token};
use crate::tree::*;
use chumsky::input::{Emitter, MappedInput};
use chumsky::prelude::*;
use std::iter::Peekable;
use std::sync::Arc;

/// The balanced tokens of one item.
pub(crate) type Tokens<'t> = MappedInput<'t, Token<'t>, Span, &'t [Spanned<'t>]>;

type Extra = extra::Err<Mistake>;

/// The parser of a production.
pub(crate) type Rule<'t, T> = Boxed<'t, 't, Tokens<'t>, T, Extra>;

// ---- Items ----

/// `item = attribute* (import | param | let | fn | material | light | settings | scene) ";"?`
pub(crate) fn item<'t>() -> Rule<'t, Option<Item>> {
    let expr = expr();
    let rest = skip(&[]).ignored();
    let kind = choice((
        scene(expr.clone()),
        let_item(expr.clone()),
        function(expr.clone()),
        param(expr.clone()),
        material(expr.clone()),
        light(expr.clone()),
        settings(expr.clone()),
        import(),
    ));
    attribute(expr)
        .repeated()
        .collect::<Vec<_>>()
        .then(kind.labelled(Expected::Item).map_with(|kind, e| (kind, e.span())))
        .map(|(attributes, (kind, span))| Some(Item { docs: String::new(), attributes, kind, span }))
        .then_ignore(token(Token::Semicolon).or_not().then(end().recover_with(via_parser(rest))))
        .recover_with(via_parser(skip(&[]).to(None)))
        .boxed()
}

/// `attribute = "@" ID ("(" (expr | STRING),* ")")?`
fn attribute<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Attribute> {
    let text = select! { Token::Text(text) = e => AttributeArgument::Text(text.to_string(), e.span()) };
    let argument = text.or(complete(expr, Token::CloseParen).map(AttributeArgument::Expr));
    let arguments = list(argument).delimited_by(just(Token::OpenParen), just(Token::CloseParen));
    just(Token::At)
        .ignore_then(name())
        .then(arguments.or_not())
        .map_with(|(name, arguments), e| Attribute {
            name,
            arguments: arguments.unwrap_or_default(),
            span: e.span(),
        })
        .boxed()
}

/// `import = "import" STRING`
fn import<'t>() -> Rule<'t, ItemKind> {
    let path =
        select! { Token::Text(path) = e => ItemKind::Import { path: path.to_string(), span: e.span() } };
    just(Token::Import).ignore_then(path.labelled(Expected::Text)).boxed()
}

/// `param = "param" ID "=" expr ("in" sum ".." sum)?`
fn param<'t>(expr: Rule<'t, Expr>) -> Rule<'t, ItemKind> {
    let bound = sum(expr.clone()).recover_with(via_parser(error(&[])));
    let range = just(Token::In).ignore_then(bound.clone()).then_ignore(just(Token::DotDot)).then(bound);
    let swapped = range.clone().map_with(|range, e| (range, e.span())).then_ignore(just(Token::Assign));
    let swapped = swapped.then(expr.clone()).validate(|((range, span), default), _, emitter| {
        emitter.emit(mistake::range_before_default(span).into());
        (default, Some(range))
    });
    just(Token::Param)
        .ignore_then(name())
        .then(swapped.or(assigned(expr, &[Token::In]).then(range.or_not())))
        .map(|(name, (default, range))| ItemKind::Param { name, default, range })
        .boxed()
}

/// `let = "let" ID "=" expr`
fn binding<'t>(expr: Rule<'t, Expr>, stops: &'static [Token<'static>]) -> Rule<'t, Binding> {
    just(Token::Let)
        .ignored()
        .or(instead_of_let())
        .ignore_then(name())
        .then(assigned(expr, stops))
        .map(|(name, value)| Binding { name, value })
        .boxed()
}

/// What other languages write instead of `let`, as in `float x = 1`: reported, and read on as if it were one.
fn instead_of_let<'t>() -> Rule<'t, ()> {
    let named = any().filter(|token: &Token| matches!(token, Token::Name(_)));
    any()
        .filter(|token: &Token| mistake::instead_of_let(*token))
        .then_ignore(named.then(just(Token::Assign)).rewind())
        .labelled(Expected::Unsaid)
        .validate(|token: Token, e, emitter| emitter.emit(mistake::let_not_type(e.span(), token).into()))
        .boxed()
}

fn let_item<'t>(expr: Rule<'t, Expr>) -> Rule<'t, ItemKind> {
    binding(expr, &[]).map(ItemKind::Let).boxed()
}

/// `fn = "fn" ID "(" parameter,* ")" ("=" expr | block)`
fn function<'t>(expr: Rule<'t, Expr>) -> Rule<'t, ItemKind> {
    let parameters = list(
        followed(parameter(expr.clone()), Token::CloseParen)
            .recover_with(via_parser(skip_element().to(None))),
    )
    .delimited_by(just(Token::OpenParen), just(Token::CloseParen))
    .validate(|parameters, _, emitter| one_variadic(parameters.into_iter().flatten().collect(), emitter));
    let body = just(Token::Assign)
        .ignore_then(expr.clone())
        .or(block_expr(expr))
        .recover_with(via_parser(error(&[])));
    just(Token::Fn)
        .ignore_then(name())
        .then(parameters)
        .then(body)
        .map(|((name, parameters), body)| ItemKind::Fn(Arc::new(Function { name, parameters, body })))
        .boxed()
}

/// `parameter = ID "..."? (":" TYPE)? ("=" expr)?`
fn parameter<'t>(default: Rule<'t, Expr>) -> Rule<'t, Option<Parameter>> {
    name()
        .then(token(Token::Ellipsis).or_not())
        .then(just(Token::Colon).ignore_then(type_name()).or_not())
        .then(just(Token::Assign).ignore_then(default).or_not())
        .map(|(((name, dots), ty), default)| {
            Some(Parameter { name, variadic: dots.is_some(), ty: ty.flatten(), default })
        })
        .boxed()
}

/// Reports parameters that would never get an argument, since one before takes any number.
fn one_variadic(parameters: Vec<Parameter>, emitter: &mut Emitter<Mistake>) -> Vec<Parameter> {
    for second in parameters.iter().filter(|parameter| parameter.variadic).skip(1) {
        emitter.emit(mistake::second_variadic(second.name.span, &second.name.text).into());
    }
    parameters
}

/// `TYPE = "float" | "vec2" | "vec3" | "bool" | "shape" | "shape2" | "material" | "list" | "fn"`
///
/// Another name is reported, and the parameter is read on as one without a type.
fn type_name<'t>() -> Rule<'t, Option<TypeName>> {
    let kind = select! {
        Token::Fn => Ok(TypeKind::Fn),
        Token::Name(word) => TypeKind::ALL.into_iter().find(|kind| kind.word() == word).ok_or(word),
    };
    kind.labelled(Expected::Type)
        .validate(|kind, e, emitter| {
            let unknown = |word| emitter.emit(mistake::unknown_type(e.span(), word).into());
            kind.map_err(unknown).ok().map(|kind| TypeName { kind, span: e.span() })
        })
        .boxed()
}

/// `material = "material" ID record`
fn material<'t>(expr: Rule<'t, Expr>) -> Rule<'t, ItemKind> {
    word("material")
        .ignore_then(name())
        .then(record(expr))
        .map(|(name, record)| ItemKind::Material(name, record))
        .boxed()
}

/// `light = "light" ID record`
fn light<'t>(expr: Rule<'t, Expr>) -> Rule<'t, ItemKind> {
    word("light")
        .ignore_then(name())
        .then(record(expr))
        .map(|(name, record)| ItemKind::Light(name, record))
        .boxed()
}

/// `settings = ("camera" | "ambient" | "sky" | "fog" | "rim" | "render") record`
fn settings<'t>(expr: Rule<'t, Expr>) -> Rule<'t, ItemKind> {
    let kind = select! {
        Token::Name("camera") => SettingsKind::Camera,
        Token::Name("ambient") => SettingsKind::Ambient,
        Token::Name("sky") => SettingsKind::Sky,
        Token::Name("fog") => SettingsKind::Fog,
        Token::Name("rim") => SettingsKind::Rim,
        Token::Name("render") => SettingsKind::Render,
    };
    kind.then(record(expr)).map(|(kind, record)| ItemKind::Settings(kind, record)).boxed()
}

/// `scene = "scene" "{" (let ";"?)* expr,* "}"`
fn scene<'t>(expr: Rule<'t, Expr>) -> Rule<'t, ItemKind> {
    let shapes = list(complete(expr.clone(), Token::CloseBrace));
    let body = bindings(expr).then(shapes).delimited_by(just(Token::OpenBrace), just(Token::CloseBrace));
    word("scene")
        .ignore_then(body)
        .map_with(|(bindings, shapes), e| ItemKind::Scene(Scene { bindings, shapes, span: e.span() }))
        .boxed()
}

/// `record = "{" (ID ":" expr),* "}"`
fn record<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Record> {
    let value = complete_or_missing(expr, Token::CloseBrace);
    let field = name()
        .then_ignore(just(Token::Colon))
        .then(value)
        .map(|(name, value)| Some(Field { name, value }))
        .recover_with(via_parser(skip_element().to(None)));
    list(field)
        .delimited_by(just(Token::OpenBrace), just(Token::CloseBrace))
        .map_with(|fields, e| Record { fields: fields.into_iter().flatten().collect(), span: e.span() })
        .boxed()
}

// ---- Expressions ----

/// `expr = lambda | operators`
///
/// `operators = unary (INFIX unary)*`
///
/// `INFIX = "*" | "/" | "%" | "+" | "-" | "&" | "|" | "<" | "<=" | ">" | ">=" | "==" | "!=" | "&&" | "||" | ".."`
pub(crate) fn expr<'t>() -> Rule<'t, Expr> {
    recursive(|expr| {
        let expr = expr.boxed();
        lambda(expr.clone()).or(operators(expr, LOOSEST)).labelled(Expected::Expression)
    })
    .boxed()
}

/// `sum = unary (("*" | "/" | "%" | "+" | "-") unary)*`
fn sum<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    operators(expr, SUM).labelled(Expected::Expression).boxed()
}

/// The tightest level of [`level`], that of `*`.
const TIGHTEST: u8 = 0;
/// The level of `+`.
const SUM: u8 = 1;
/// The loosest level, that of `..`.
const LOOSEST: u8 = 7;

/// How loosely an operator binds. Operators of one level are read from left to right.
fn level(op: BinaryOp) -> u8 {
    match op {
        BinaryOp::Multiply | BinaryOp::Divide | BinaryOp::Modulo => TIGHTEST,
        BinaryOp::Add | BinaryOp::Subtract => SUM,
        BinaryOp::Intersection => 2,
        BinaryOp::Union => 3,
        BinaryOp::Less | BinaryOp::LessEqual | BinaryOp::Greater | BinaryOp::GreaterEqual => 4,
        BinaryOp::Equal | BinaryOp::NotEqual => 4,
        BinaryOp::And => 5,
        BinaryOp::Or => 6,
        BinaryOp::Range => LOOSEST,
    }
}

/// Whether operators of the level can follow one another.
fn chains(op: BinaryOp) -> bool {
    level(op) != level(BinaryOp::Less) && op != BinaryOp::Range
}

/// Operands with the operators of some levels between them. They are read as a flat list, and [`climb`] makes
/// the tree, so that a long sum needs no deep stack.
fn operators<'t>(expr: Rule<'t, Expr>, loosest: u8) -> Rule<'t, Expr> {
    let operand = unary(expr);
    let infix = select! {
        Token::Star => BinaryOp::Multiply,
        Token::Slash => BinaryOp::Divide,
        Token::Percent => BinaryOp::Modulo,
        Token::Plus => BinaryOp::Add,
        Token::Minus => BinaryOp::Subtract,
        Token::And => BinaryOp::Intersection,
        Token::Or => BinaryOp::Union,
        Token::Less => BinaryOp::Less,
        Token::LessEqual => BinaryOp::LessEqual,
        Token::Greater => BinaryOp::Greater,
        Token::GreaterEqual => BinaryOp::GreaterEqual,
        Token::Equal => BinaryOp::Equal,
        Token::NotEqual => BinaryOp::NotEqual,
        Token::AndAnd => BinaryOp::And,
        Token::OrOr => BinaryOp::Or,
        Token::DotDot => BinaryOp::Range,
    }
    .filter(move |op| level(*op) <= loosest)
    .labelled(Expected::Unsaid)
    .map_with(|op, e| (op, e.span()));
    let rest = infix
        .then(operand.clone().labelled(Expected::Expression))
        .map(|((op, span), right)| (op, span, right))
        .repeated()
        .collect::<Vec<_>>();
    operand
        .then(rest)
        .validate(move |(first, rest), _, emitter| {
            if rest.is_empty() {
                return first;
            }
            let mut wrong = Vec::new();
            let whole = climb(first, &mut rest.into_iter().peekable(), loosest, &mut wrong);
            if wrong.is_empty() {
                return whole;
            }
            for (op, span) in wrong {
                emitter.emit(mistake::chained(span, op.symbol()).into());
            }
            // What it means is not known.
            Expr { kind: ExprKind::Error, ..whole }
        })
        .boxed()
}

type Link = (BinaryOp, Span, Expr);

/// Takes all operators from `rest` that bind at least as tightly as `loosest`, with their operands, and joins
/// them to `first`. What does not chain and is chained nevertheless is added to `wrong`.
fn climb(
    first: Expr,
    rest: &mut Peekable<impl Iterator<Item = Link>>,
    loosest: u8,
    wrong: &mut Vec<(BinaryOp, Span)>,
) -> Expr {
    let mut whole = first;
    while let Some(here) = rest.peek().map(|(op, ..)| level(*op)).filter(|here| *here <= loosest) {
        let mut links: Vec<Link> = Vec::new();
        while let Some((op, span, right)) = rest.next_if(|(op, ..)| level(*op) == here) {
            let right = if here == TIGHTEST { right } else { climb(right, rest, here - 1, wrong) };
            if !links.is_empty() && !chains(op) {
                wrong.push((op, span));
            }
            links.push((op, span, right));
        }
        let span = links.last().map_or(whole.span, |(_, _, last)| whole.span.to(last.span));
        whole = Expr { kind: ExprKind::Chain { first: Box::new(whole), rest: links }, span };
    }
    whole
}

/// `lambda = ("||" | "|" parameter,* "|") expr`
///
/// The default of a parameter is a sum here, since `|` ends the parameters.
fn lambda<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    let parameters = list(parameter(sum(expr.clone())))
        .delimited_by(just(Token::Or), just(Token::Or))
        .validate(|parameters: Vec<_>, _, emitter| {
            one_variadic(parameters.into_iter().flatten().collect(), emitter)
        });
    token(Token::OrOr)
        .to(Vec::new())
        .or(parameters)
        .then(expr)
        .map(|(parameters, body)| ExprKind::Lambda(Arc::new(Lambda { parameters, body })))
        .map_with(spanned)
        .boxed()
}

/// `unary = ("-" | "!")* postfix`
fn unary<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    let prefix = select! { Token::Minus = e => (UnaryOp::Negate, e.span()), Token::Bang = e => (UnaryOp::Not, e.span()) };
    prefix
        .repeated()
        .collect::<Vec<(UnaryOp, Span)>>()
        .then(postfix(expr))
        .map(|(prefixes, operand)| {
            prefixes.into_iter().rev().fold(operand, |operand, (op, span)| Expr {
                span: span.to(operand.span),
                kind: ExprKind::Unary(op, Box::new(operand)),
            })
        })
        .boxed()
}

/// `postfix = primary ("(" argument,* ")" | "." ID ("(" argument,* ")")? | "[" expr "]")*`
fn postfix<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    let arguments = arguments(expr.clone()).validate(|(arguments, _), _, emitter| {
        let named = arguments.iter().position(|a: &Argument| a.name.is_some()).unwrap_or(arguments.len());
        for late in arguments[named..].iter().filter(|a| a.name.is_none() && a.value.kind != ExprKind::Error)
        {
            emitter.emit(mistake::positional_after_named(late.value.span).into());
        }
        arguments
    });
    let arguments = arguments.boxed();
    let member =
        just(Token::Dot).ignore_then(name()).then(arguments.clone().or_not()).map(|(name, arguments)| {
            match arguments {
                Some(arguments) => PostfixKind::Method(name, arguments),
                None => PostfixKind::Member(name),
            }
        });
    let index = complete_or_missing(expr.clone(), Token::CloseBracket)
        .delimited_by(just(Token::OpenBracket), just(Token::CloseBracket))
        .map(PostfixKind::Index);
    let operation = choice((arguments.map(PostfixKind::Call), member, index))
        .labelled(Expected::Unsaid)
        .map_with(|kind, e| Postfix { kind, span: e.span() });
    primary(expr)
        .then(operation.repeated().collect::<Vec<_>>())
        .map_with(|(base, operations), e| {
            if operations.is_empty() {
                return base;
            }
            Expr { kind: ExprKind::Postfix { base: Box::new(base), operations }, span: e.span() }
        })
        .boxed()
}

/// `argument = (ID ":")? expr`
///
/// The arguments in their parentheses, and whether the last is followed by a comma.
fn arguments<'t>(expr: Rule<'t, Expr>) -> Rule<'t, (Vec<Argument>, Span)> {
    let label = name().then_ignore(just(Token::Colon));
    let named = label
        .then(complete_or_missing(expr.clone(), Token::CloseParen))
        .map(|(name, value)| Argument { name: Some(name), value });
    let positional = complete(expr, Token::CloseParen).map(|value| Argument { name: None, value });
    list(named.labelled(Expected::Expression).or(positional))
        .delimited_by(just(Token::OpenParen), just(Token::CloseParen))
        .map_with(|arguments, e| (arguments, e.span()))
        .boxed()
}

/// `primary = NUMBER | COLOUR | "true" | "false" | ID | paren | list | block | shape | appearance | if | for`
///
/// `appearance = "material" record`
fn primary<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    let literal = select! {
        Token::Number(value) => ExprKind::Number(value),
        Token::Color(value) => ExprKind::Color(value),
        Token::True => ExprKind::Bool(true),
        Token::False => ExprKind::Bool(false),
    };
    let appearance = word("material")
        .ignore_then(just(Token::OpenBrace).rewind())
        .ignore_then(record(expr.clone()))
        .map(ExprKind::Material);
    let name = select! { Token::Name(name) => ExprKind::Name(name.into()) };
    choice((
        appearance.map_with(spanned).boxed(),
        name.or(literal).map_with(spanned).boxed(),
        paren(expr.clone()),
        sequence(expr.clone()),
        block_expr(expr.clone()),
        shape(expr.clone()),
        if_expr(expr.clone()),
        for_expr(expr),
    ))
    .boxed()
}

/// `paren = "(" expr ("," expr)* ","? ")" | "(" ID ":" expr ("," ID ":" expr)* ","? ")"`
fn paren<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    arguments(expr)
        .validate(|(mut values, span), _, emitter| {
            if values.iter().any(|value| value.name.is_some()) {
                for value in values.iter().filter(|v| v.name.is_none() && v.value.kind != ExprKind::Error) {
                    emitter.emit(mistake::field_without_name(value.value.span).into());
                }
                let field = |a: Argument| a.name.map(|name| Field { name, value: a.value });
                let fields = values.into_iter().filter_map(field).collect();
                return Expr { kind: ExprKind::Record(Record { fields, span }), span };
            }
            match values.len() {
                0 => {
                    emitter.emit(mistake::empty_tuple(span).into());
                    Expr { kind: ExprKind::Error, span }
                }
                1 => Expr { span, ..values.remove(0).value },
                _ => Expr { kind: ExprKind::Tuple(values.into_iter().map(|v| v.value).collect()), span },
            }
        })
        .boxed()
}

/// `list = "[" expr,* "]"`
fn sequence<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    list(complete(expr, Token::CloseBracket))
        .delimited_by(just(Token::OpenBracket), just(Token::CloseBracket))
        .map(ExprKind::List)
        .map_with(spanned)
        .boxed()
}

/// `block = "{" (let ";"?)* expr "}"`
fn block<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Block> {
    let nothing = just(Token::CloseBrace).rewind().labelled(Expected::Unsaid).to(None);
    let result =
        expr.clone().then_ignore(just(Token::CloseBrace).rewind()).recover_with(via_parser(error(&[])));
    bindings(expr)
        .then(nothing.or(result.map(Some)))
        .delimited_by(just(Token::OpenBrace), just(Token::CloseBrace))
        .validate(|(bindings, result), e, emitter| {
            let whole: Span = e.span();
            let result = result.unwrap_or_else(|| {
                if bindings.last().is_none_or(|last: &Binding| last.value.kind != ExprKind::Error) {
                    emitter.emit(mistake::block_without_value(whole).into());
                }
                Expr { kind: ExprKind::Error, span: whole }
            });
            Block { bindings, result }
        })
        .boxed()
}

/// The `let`s that open a block or a scene.
fn bindings<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Vec<Binding>> {
    binding(expr, &[Token::Semicolon, Token::Let])
        .then_ignore(token(Token::Semicolon).or_not())
        .repeated()
        .collect()
        .boxed()
}

fn block_expr<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    block(expr).map(|block| ExprKind::Block(Box::new(block))).map_with(spanned).boxed()
}

/// `shape = ("field" | "field2") block`
fn shape<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    let dimension = select! { Token::Field => Dimension::Three, Token::Field2 => Dimension::Two };
    dimension
        .then(block(expr))
        .map(|(dimension, block)| ExprKind::Shape(dimension, Box::new(block)))
        .map_with(spanned)
        .boxed()
}

/// `if = "if" expr block ("else" "if" expr block)* "else" block`
fn if_expr<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    let block = block(expr.clone());
    let branch = expr.then(block.clone());
    let more = just(Token::Else)
        .then(token(Token::If))
        .map_with(|_, e| e.span())
        .then(branch.clone())
        .repeated()
        .collect::<Vec<(Span, (Expr, Block))>>();
    let otherwise = just(Token::Else).ignore_then(block).map(Some).or(just(Token::Else).not().to(None));
    just(Token::If)
        .ignore_then(branch)
        .then(more)
        .then(otherwise)
        .validate(|((first, more), otherwise), e, emitter| {
            let whole: Span = e.span();
            let last = otherwise.unwrap_or_else(|| {
                emitter.emit(mistake::else_missing(Span { end: whole.start + 2, ..whole }).into());
                Block { bindings: Vec::new(), result: Expr { kind: ExprKind::Error, span: whole } }
            });
            let last = more.into_iter().rev().fold(last, |otherwise, (start, branch)| {
                let span = Span { start: start.end - 2, end: whole.end, ..whole };
                Block { bindings: Vec::new(), result: decision(branch, otherwise, span) }
            });
            decision(first, last, whole)
        })
        .boxed()
}

fn decision((condition, then): (Expr, Block), otherwise: Block, span: Span) -> Expr {
    let kind =
        ExprKind::If { condition: Box::new(condition), then: Box::new(then), otherwise: Box::new(otherwise) };
    Expr { kind, span }
}

/// `for = "for" ID "in" expr block`
fn for_expr<'t>(expr: Rule<'t, Expr>) -> Rule<'t, Expr> {
    just(Token::For)
        .ignore_then(name())
        .then_ignore(just(Token::In))
        .then(expr.clone())
        .then(block(expr))
        .map(|((name, list), body)| ExprKind::For { name, list: Box::new(list), body: Box::new(body) })
        .map_with(spanned)
        .boxed()
}

// ---- What the productions are made of ----

/// A name. A reserved word is reported and taken as one.
fn name<'t>() -> Rule<'t, Name> {
    any()
        .filter(|token: &Token| matches!(token, Token::Name(_)) || token.keyword().is_some())
        .labelled(Expected::Name)
        .validate(|token, e, emitter| {
            let text = match (token, token.keyword()) {
                (Token::Name(text), _) => text,
                (_, word) => {
                    let word = word.unwrap_or_default();
                    emitter.emit(mistake::reserved_name(e.span(), word).into());
                    word
                }
            };
            Name { text: text.into(), span: e.span() }
        })
        .boxed()
}

/// A word that is one only where an item begins.
fn word<'t>(word: &'static str) -> Rule<'t, ()> {
    any().filter(move |token| *token == Token::Name(word)).ignored().boxed()
}

/// A token that need not be there, and that messages therefore do not ask for.
fn token<'t>(token: Token<'t>) -> Rule<'t, ()> {
    just(token).ignored().labelled(Expected::Unsaid).boxed()
}

/// `= expr`. After a mistake the value is what stands up to one of `stops`.
fn assigned<'t>(expr: Rule<'t, Expr>, stops: &'static [Token<'static>]) -> Rule<'t, Expr> {
    just(Token::Assign).ignore_then(expr).recover_with(via_parser(error(stops))).boxed()
}

/// Elements with commas between, and perhaps one after them.
fn list<'t, T: 't>(element: impl Parser<'t, Tokens<'t>, T, Extra> + 't) -> Rule<'t, Vec<T>> {
    element.separated_by(just(Token::Comma)).allow_trailing().collect().boxed()
}

/// What `rule` reads, with a comma or the closing bracket behind it.
fn followed<'t, T: 't>(rule: Rule<'t, T>, close: Token<'t>) -> Rule<'t, T> {
    rule.then_ignore(just(Token::Comma).or(just(close)).rewind()).boxed()
}

/// An element of a list: an expression up to a comma or the closing bracket. One that is wrong is skipped.
fn complete<'t>(expr: Rule<'t, Expr>, close: Token<'t>) -> Rule<'t, Expr> {
    followed(expr, close)
        .recover_with(via_parser(skip_element().map(|span| Expr { kind: ExprKind::Error, span })))
        .boxed()
}

/// Like [`complete`], where the expression cannot be absent.
fn complete_or_missing<'t>(expr: Rule<'t, Expr>, close: Token<'t>) -> Rule<'t, Expr> {
    followed(expr, close).recover_with(via_parser(error(&[Token::Comma]))).boxed()
}

/// What is skipped after a mistake, as an expression.
fn error<'t>(stops: &'static [Token<'static>]) -> Rule<'t, Expr> {
    skip(stops).map(|span| Expr { kind: ExprKind::Error, span }).boxed()
}

/// Skips to the comma or closing bracket that ends an element; fails where there is no element.
fn skip_element<'t>() -> Rule<'t, Span> {
    any().filter(|token: &Token| !token.closes()).rewind().ignore_then(skip(&[Token::Comma])).boxed()
}

/// Skips to one of `stops`, or to the bracket that closes the innermost one here, or to the end.
fn skip<'t>(stops: &'static [Token<'static>]) -> Rule<'t, Span> {
    custom(move |input| {
        let start = input.cursor();
        let mut depth = 0usize;
        while let Some(token) = input.peek() {
            if depth == 0 && (stops.contains(&token) || token.closes()) {
                break;
            }
            depth += usize::from(token.partner().is_some());
            depth -= usize::from(token.closes());
            input.skip();
        }
        Ok(input.span_since(&start))
    })
    .boxed()
}

/// An expression from its kind, with the place of what was read.
fn spanned<'t>(kind: ExprKind, extra: &mut chumsky::input::MapExtra<'t, '_, Tokens<'t>, Extra>) -> Expr {
    Expr { kind, span: extra.span() }
}
