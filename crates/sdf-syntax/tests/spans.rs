//! Every node of the tree stands where its text stands.

use sdf_syntax::tree::{Block, Expr, ExprKind, ItemKind, PostfixKind, Record};
use sdf_syntax::{FileId, Span, parse};

/// The texts of an item's parts, outermost first, each item's own text before them.
fn check(source: &str, expected: &[&str]) {
    let (file, diagnostics) = parse(FileId::default(), source);
    assert_eq!(diagnostics, []);
    let mut found = Vec::new();
    for item in &file.items {
        let mut spans = vec![item.span];
        match &item.kind {
            ItemKind::Let(binding) => {
                spans.push(binding.name.span);
                expr(&binding.value, &mut spans);
            }
            ItemKind::Scene(scene) => {
                spans.push(scene.span);
                scene.shapes.iter().for_each(|shape| expr(shape, &mut spans));
            }
            ItemKind::Fn(function) => {
                spans.extend(function.parameters.iter().map(|p| p.name.span));
                spans.extend(function.parameters.iter().filter_map(|p| p.ty).map(|ty| ty.span));
                expr(&function.body, &mut spans);
            }
            other => panic!("{other:?}"),
        }
        found.extend(spans.iter().map(|span| &source[span.start as usize..span.end as usize]));
        found.extend(item.attributes.iter().map(|a| &source[a.span.start as usize..a.span.end as usize]));
    }
    assert_eq!(found, expected);
}

fn block(block: &Block, spans: &mut Vec<Span>) {
    for binding in &block.bindings {
        expr(&binding.value, spans);
    }
    expr(&block.result, spans);
}

fn record(record: &Record, spans: &mut Vec<Span>) {
    spans.push(record.span);
    for field in &record.fields {
        spans.push(field.name.span);
        expr(&field.value, spans);
    }
}

fn expr(e: &Expr, spans: &mut Vec<Span>) {
    spans.push(e.span);
    match &e.kind {
        ExprKind::Tuple(values) | ExprKind::List(values) => values.iter().for_each(|v| expr(v, spans)),
        ExprKind::Record(fields) | ExprKind::Material(fields) => record(fields, spans),
        ExprKind::Block(inner) | ExprKind::Shape(_, inner) => block(inner, spans),
        ExprKind::If { condition, then, otherwise } => {
            expr(condition, spans);
            block(then, spans);
            block(otherwise, spans);
        }
        ExprKind::For { name, list, body } => {
            spans.push(name.span);
            expr(list, spans);
            block(body, spans);
        }
        ExprKind::Lambda(lambda) => expr(&lambda.body, spans),
        ExprKind::Unary(_, operand) => expr(operand, spans),
        ExprKind::Chain { first, rest } => {
            expr(first, spans);
            for (_, operator, right) in rest {
                spans.push(*operator);
                expr(right, spans);
            }
        }
        ExprKind::Postfix { base, operations } => {
            expr(base, spans);
            for operation in operations {
                spans.push(operation.span);
                match &operation.kind {
                    PostfixKind::Call(arguments) => arguments.iter().for_each(|a| expr(&a.value, spans)),
                    PostfixKind::Method(name, arguments) => {
                        spans.push(name.span);
                        arguments.iter().for_each(|a| expr(&a.value, spans));
                    }
                    PostfixKind::Member(name) => spans.push(name.span),
                    PostfixKind::Index(index) => expr(index, spans),
                }
            }
        }
        ExprKind::Number(_)
        | ExprKind::Color(_)
        | ExprKind::Bool(_)
        | ExprKind::Name(_)
        | ExprKind::Error => {}
    }
}

#[test]
fn operators() {
    check(
        "let a = ( b + c ) * -d ;",
        &["let a = ( b + c ) * -d", "a", "( b + c ) * -d", "( b + c )", "b", "+", "c", "*", "-d", "d"],
    );
    check(
        "let a = b + c * d < e",
        &[
            "let a = b + c * d < e",
            "a",
            "b + c * d < e",
            "b + c * d",
            "b",
            "+",
            "c * d",
            "c",
            "*",
            "d",
            "<",
            "e",
        ],
    );
}

#[test]
fn operations() {
    check(
        "let a = f( b ).g(1, k: 2) [ 3 ] .x",
        &[
            "let a = f( b ).g(1, k: 2) [ 3 ] .x",
            "a",
            "f( b ).g(1, k: 2) [ 3 ] .x",
            "f",
            "( b )",
            "b",
            ".g(1, k: 2)",
            "g",
            "1",
            "2",
            "[ 3 ]",
            "3",
            ".x",
            "x",
        ],
    );
}

#[test]
fn operands() {
    check(
        "@exact @lipschitz(2)\nfn f(a: vec3, b) { let c = (x: 1); [c, |d| d] }",
        &[
            "fn f(a: vec3, b) { let c = (x: 1); [c, |d| d] }",
            "a",
            "b",
            "vec3",
            "{ let c = (x: 1); [c, |d| d] }",
            "(x: 1)",
            "(x: 1)",
            "x",
            "1",
            "[c, |d| d]",
            "c",
            "|d| d",
            "d",
            "@exact",
            "@lipschitz(2)",
        ],
    );
    check(
        "scene { if a { b } else if c { d } else { e }, for i in l { field { i } }, }",
        &[
            "scene { if a { b } else if c { d } else { e }, for i in l { field { i } }, }",
            "scene { if a { b } else if c { d } else { e }, for i in l { field { i } }, }",
            "if a { b } else if c { d } else { e }",
            "a",
            "b",
            "if c { d } else { e }",
            "c",
            "d",
            "e",
            "for i in l { field { i } }",
            "i",
            "l",
            "field { i }",
            "i",
        ],
    );
}
