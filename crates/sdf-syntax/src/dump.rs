//! Tokens and trees as text, for `--emit tokens`, `--emit ast` and tests. The tree is written as lists in
//! parentheses, the first word of each saying what it is.

use crate::span::FileId;
use crate::token::{Token, lex};
use crate::tree::*;
use std::fmt::Write;

/// The width up to which a list stays on one line.
const WIDTH: usize = 100;

/// The tokens of a text, one a line: the range of bytes, and what it is.
pub fn tokens(file: FileId, text: &str) -> String {
    let mut out = String::new();
    for (token, span) in lex(file, text).tokens {
        let place = format!("{}..{}", span.start, span.end);
        let _ = writeln!(out, "{place:<12} {}", token_text(token));
    }
    out
}

fn token_text(token: Token) -> String {
    match token {
        Token::Name(name) => format!("name {name}"),
        Token::Number(value) => format!("number {value}"),
        Token::Color(c) => format!("colour {}", color(c)),
        Token::Text(text) => format!("text {text:?}"),
        other => other.symbol().to_string(),
    }
}

/// The tree of a file, an item a paragraph.
pub fn tree(file: &File) -> String {
    let mut out = String::new();
    for item in &file.items {
        write_node(&item_node(item), 0, &mut out);
        out.push('\n');
    }
    out
}

/// A word, or a list of nodes.
enum Node {
    Word(String),
    List(Vec<Node>),
}

impl Node {
    fn width(&self) -> usize {
        match self {
            Node::Word(word) => word.chars().count(),
            Node::List(nodes) => nodes.iter().map(|n| n.width() + 1).sum::<usize>() + 1,
        }
    }
}

fn write_node(node: &Node, indent: usize, out: &mut String) {
    let nodes = match node {
        Node::Word(word) => return out.push_str(word),
        Node::List(nodes) => nodes,
    };
    let fits = indent + node.width() <= WIDTH;
    out.push('(');
    for (place, node) in nodes.iter().enumerate() {
        if place > 0 && (fits || matches!((node, place), (Node::Word(_), 1))) {
            out.push(' ');
        } else if place > 0 {
            let _ = write!(out, "\n{:1$}", "", indent + 2);
        }
        write_node(node, indent + 2, out);
    }
    out.push(')');
}

fn word(text: impl Into<String>) -> Node {
    Node::Word(text.into())
}

/// A list that says what it is.
fn named(what: &str, rest: impl IntoIterator<Item = Node>) -> Node {
    Node::List(std::iter::once(word(what)).chain(rest).collect())
}

fn item_node(item: &Item) -> Node {
    let kind = match &item.kind {
        ItemKind::Import { path, .. } => named("import", [word(format!("{path:?}"))]),
        ItemKind::Param { name, default, range } => {
            let range = range.iter().flat_map(|(low, high)| [expr(low), expr(high)]);
            named("param", [word(&*name.text), expr(default)].into_iter().chain(range))
        }
        ItemKind::Let(let_) => binding(let_),
        ItemKind::Fn(function) => {
            let parameters = Node::List(function.parameters.iter().map(parameter).collect());
            named("fn", [word(&*function.name.text), parameters, expr(&function.body)])
        }
        ItemKind::Material(name, record) => {
            named("material", std::iter::once(word(&*name.text)).chain(fields(record)))
        }
        ItemKind::Light(name, record) => {
            named("light", std::iter::once(word(&*name.text)).chain(fields(record)))
        }
        ItemKind::Settings(kind, record) => named(settings_word(*kind), fields(record)),
        ItemKind::Scene(scene) => {
            named("scene", scene.bindings.iter().map(binding).chain(scene.shapes.iter().map(expr)))
        }
    };
    if item.docs.is_empty() && item.attributes.is_empty() {
        return kind;
    }
    let docs = (!item.docs.is_empty()).then(|| named("docs", [word(format!("{:?}", item.docs))]));
    let attributes = item.attributes.iter().map(|attribute| {
        let arguments = attribute.arguments.iter().map(|argument| match argument {
            AttributeArgument::Expr(e) => expr(e),
            AttributeArgument::Text(text, _) => word(format!("{text:?}")),
        });
        named(&format!("@{}", attribute.name.text), arguments)
    });
    Node::List(docs.into_iter().chain(attributes).chain([kind]).collect())
}

/// The word of a block of settings.
fn settings_word(kind: SettingsKind) -> &'static str {
    match kind {
        SettingsKind::Camera => "camera",
        SettingsKind::Ambient => "ambient",
        SettingsKind::Sky => "sky",
        SettingsKind::Fog => "fog",
        SettingsKind::Rim => "rim",
        SettingsKind::Render => "render",
    }
}

fn binding(binding: &Binding) -> Node {
    named("let", [word(&*binding.name.text), expr(&binding.value)])
}

fn fields(record: &Record) -> impl Iterator<Item = Node> {
    record.fields.iter().map(|field| named(&format!("{}:", field.name.text), [expr(&field.value)]))
}

fn parameter(parameter: &Parameter) -> Node {
    let dots = if parameter.variadic { "..." } else { "" };
    let ty = parameter.ty.map_or(String::new(), |ty| format!(":{}", ty.kind.word()));
    let name = format!("{}{dots}{ty}", parameter.name.text);
    match &parameter.default {
        Some(default) => named(&name, [word("="), expr(default)]),
        None => word(name),
    }
}

fn block(block: &Block) -> Node {
    named("block", block.bindings.iter().map(binding).chain([expr(&block.result)]))
}

fn expr(e: &Expr) -> Node {
    match &e.kind {
        ExprKind::Number(value) => word(value.to_string()),
        ExprKind::Color(value) => word(color(*value)),
        ExprKind::Bool(value) => word(value.to_string()),
        ExprKind::Name(name) => word(&**name),
        ExprKind::Tuple(values) => named("tuple", values.iter().map(expr)),
        ExprKind::Record(record) => named("record", fields(record)),
        ExprKind::List(values) => named("list", values.iter().map(expr)),
        ExprKind::Block(inner) => block(inner),
        ExprKind::Shape(Dimension::Three, inner) => named("field", [block(inner)]),
        ExprKind::Shape(Dimension::Two, inner) => named("field2", [block(inner)]),
        ExprKind::Material(record) => named("material", fields(record)),
        ExprKind::If { condition, then, otherwise } => {
            named("if", [expr(condition), block(then), block(otherwise)])
        }
        ExprKind::For { name, list, body } => named("for", [word(&*name.text), expr(list), block(body)]),
        ExprKind::Lambda(lambda) => {
            let parameters = Node::List(lambda.parameters.iter().map(parameter).collect());
            named("lambda", [parameters, expr(&lambda.body)])
        }
        ExprKind::Unary(UnaryOp::Negate, operand) => named("-", [expr(operand)]),
        ExprKind::Unary(UnaryOp::Not, operand) => named("!", [expr(operand)]),
        ExprKind::Chain { first, rest } => {
            let rest = rest.iter().flat_map(|(op, _, right)| [word(op.symbol()), expr(right)]);
            Node::List(std::iter::once(expr(first)).chain(rest).collect())
        }
        ExprKind::Postfix { base, operations } => {
            named("of", std::iter::once(expr(base)).chain(operations.iter().map(operation)))
        }
        ExprKind::Error => word("ERROR"),
    }
}

fn operation(operation: &Postfix) -> Node {
    match &operation.kind {
        PostfixKind::Call(arguments) => named("call", arguments.iter().map(argument)),
        PostfixKind::Method(name, arguments) => {
            named(&format!(".{}", name.text), arguments.iter().map(argument))
        }
        PostfixKind::Member(name) => word(format!(".{}", name.text)),
        PostfixKind::Index(index) => named("at", [expr(index)]),
    }
}

fn argument(argument: &Argument) -> Node {
    match &argument.name {
        Some(name) => named(&format!("{}:", name.text), [expr(&argument.value)]),
        None => expr(&argument.value),
    }
}

/// A colour in linear light, to five digits.
fn color([r, g, b]: [f64; 3]) -> String {
    format!("rgb({r:.5},{g:.5},{b:.5})")
}
