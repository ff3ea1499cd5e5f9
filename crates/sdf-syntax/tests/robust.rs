//! What no file may do: make the parser panic, overflow the stack, or take long.

use sdf_syntax::token::TOKEN_LIMIT;
use sdf_syntax::tree::{ExprKind, ItemKind};
use sdf_syntax::{Code, DIAGNOSTIC_LIMIT, Diagnostic, FILE_LIMIT, FileId, decode, dump, parse};
use std::time::{Duration, Instant};

/// Parses, checks what holds for every text, and returns the diagnostics.
fn check(text: &str) -> Vec<Diagnostic> {
    let begin = Instant::now();
    let (file, diagnostics) = parse(FileId(3), text);
    let took = begin.elapsed();
    assert!(took < Duration::from_secs(10), "took {took:?} for {} bytes", text.len());
    assert!(diagnostics.is_sorted_by_key(|d| d.span.start));
    assert!(diagnostics.len() <= DIAGNOSTIC_LIMIT + 1);
    for d in &diagnostics {
        for span in d.related.iter().map(|r| r.span).chain([d.span]) {
            assert_eq!(span.file, FileId(3));
            assert!(text.get(span.start as usize..span.end as usize).is_some(), "{d:?}");
        }
        assert!(d.message.len() < 200, "{}", d.message);
    }
    if text.len() < 10_000 && diagnostics.is_empty() {
        assert!(!dump::tree(&file).contains("ERROR"));
    }
    diagnostics
}

fn codes(text: &str) -> Vec<Code> {
    check(text).iter().map(|d| d.code).collect()
}

#[test]
fn a_million_brackets() {
    for bracket in ["(", "[", "{", "(-", "[|x| ", "{ let a = {"] {
        assert_eq!(codes(&format!("let a = {}", bracket.repeat(1_000_000))), [Code::E009], "{bracket}");
    }
    for bracket in [")", "]", "}"] {
        assert_eq!(codes(&format!("let a = 1 {}", bracket.repeat(1_000_000))), [Code::E006], "{bracket}");
    }
    let balanced = format!("let a = {}1{}", "(".repeat(500_000), ")".repeat(500_000));
    assert_eq!(codes(&balanced), [Code::E009]);
    let crossed = format!("let a = {}1{}", "(".repeat(500_000), "]".repeat(500_000));
    assert_eq!(codes(&crossed), [Code::E009]);
    let empty = format!("let a = [{}]", "(1),".repeat(500_000));
    assert_eq!(codes(&empty), []);
}

/// The deepest that is allowed, in all ways to nest, on the small stack of a test's thread.
#[test]
fn the_deepest_nesting_fits_the_stack() {
    let nest = |open: &str, close: &str, n: usize| format!("let a = {}1{}", open.repeat(n), close.repeat(n));
    for (open, close, n) in [
        ("(", ")", 256),
        ("[", "]", 256),
        ("{", "}", 256),
        ("f(", ")", 256),
        ("field { ", " }", 256),
        ("material { a: ", " }", 256),
        ("x[", "]", 256),
        ("(a: ", ")", 256),
        ("if a { ", " } else { 1 }", 256),
        ("for i in [", "] { i }", 128),
        ("-", "", 256),
        ("|x| ", "", 256),
        ("-(", ")", 128),
        ("-(|x| ", ")", 85),
        ("1 + (2 < 3 && ", ")", 256),
    ] {
        assert_eq!(codes(&nest(open, close, n)), [], "{open}");
        assert_eq!(codes(&nest(open, close, 2 * n + 1)), [Code::E009], "{open}");
    }
    let condition = |n| format!("let a = {}b {}", "if ".repeat(n), "{ 1 } else { 2 } ".repeat(n));
    assert_eq!(codes(&condition(200)), []);
    assert_eq!(codes(&condition(300)), [Code::E009]);
}

#[test]
fn long_and_flat() {
    assert_eq!(codes(&format!("let a = 1{}", " + 1".repeat(100_000))), []);
    assert_eq!(codes(&format!("let a = 1{}", " - -1 * 2 < 3".repeat(2))), [Code::E007]);
    assert_eq!(codes(&format!("let a = s{}", ".at(1, 2, 3)".repeat(100_000))), []);
    assert_eq!(codes(&format!("let a = {}", "if a { 1 } else ".repeat(10_000)))[0], Code::E009);
    assert_eq!(codes(&format!("let a = {} {{ 2 }}", "if a { 1 } else ".repeat(200))), []);
    assert_eq!(codes(&format!("let a = {}1", "if a { 1 } else { 2 } + ".repeat(10_000))), []);
    assert_eq!(codes(&"let a = 1\n".repeat(100_000)), []);
    assert_eq!(codes(&format!("scene {{ {} }}", "sphere(1).at(1, 2, 3), ".repeat(100_000))), []);
}

#[test]
fn huge_tokens() {
    for token in ["a", "1", "#", "1.", "é", "/", "=", "|"] {
        let text = format!("let a = {}", token.repeat(1_000_000));
        assert!(!check(&text).is_empty(), "{token}");
    }
    assert_eq!(codes(&format!("let {} = 1", "a".repeat(1_000_000))), [Code::E009]);
    assert_eq!(codes(&format!("import \"{}\"", "a".repeat(1_000_000))), [Code::E009]);
    assert_eq!(codes(&format!("/*{}", "/*".repeat(500_000))), [Code::E005]);
    assert_eq!(codes(&format!("let {} = 1", "a".repeat(TOKEN_LIMIT))), []);
}

#[test]
fn more_mistakes_than_anyone_reads() {
    let diagnostics = check(&format!("let a = [{}]", ", ".repeat(10_000)));
    assert_eq!(diagnostics.len(), DIAGNOSTIC_LIMIT + 1);
    assert_eq!(diagnostics[DIAGNOSTIC_LIMIT].code, Code::E009);
    check(&"let a = \n".repeat(10_000));
    check(&"$ 1 ".repeat(10_000));
}

/// A mistake deep inside is recovered from once, not once for each level.
#[test]
fn recovery_is_not_exponential() {
    let text = format!("let a = {}1 2{}", "f(k: (".repeat(100), "))".repeat(100));
    assert_eq!(codes(&text), [Code::E007]);
    let text = format!("let a = {}1 2{}", "{ let x = [".repeat(100), "] x }".repeat(100));
    assert_eq!(codes(&text), [Code::E007]);
}

#[test]
fn bytes_that_are_no_text() {
    let file = FileId::default();
    let error = decode(file, b"let a = 1\xff").unwrap_err();
    assert_eq!((error.code, error.span.start), (Code::E001, 9));
    assert_eq!(error.message, "the file is not UTF-8: byte 9 fits no character");
    assert_eq!(decode(file, b"\xef\xbb\xbflet").as_deref(), Ok("let"));
    assert_eq!(decode(file, &vec![b' '; FILE_LIMIT]).map(|text| text.len()), Ok(FILE_LIMIT));
    assert_eq!(decode(file, &vec![b' '; FILE_LIMIT + 1]).unwrap_err().code, Code::E009);
    assert_eq!(codes(&" ".repeat(FILE_LIMIT)), []);
    assert_eq!(codes(&" ".repeat(FILE_LIMIT + 1)), [Code::E009]);
    check("\0\u{1}\u{7f}\u{202e}abc\u{0}");
    check("\u{feff}\u{feff}let a = 1");
}

/// Texts from a small generator of random numbers: pieces of the language in any order.
#[test]
fn token_soup() {
    let pieces: Vec<&str> = "import param let fn if else for in true false field field2 material light camera scene \
        rim a b p return 1 .5 1. 1e999 45deg #fff #12 \"s\" \"open // /* */ /// ( ) [ ] { } ( ) { } , ; : . .. ... \
        = + - * / % ! & | && || < <= > >= == != @ ? § \n \n \r\n"
        .split(' ')
        .collect();
    let mut state = 1u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for round in 0..5_000 {
        let mut text = String::new();
        for _ in 0..random(60) {
            text.push_str(pieces[random(pieces.len())]);
            text.push_str([" ", "", "\n"][random(3)]);
        }
        let first = check(&text);
        assert_eq!(first, check(&text), "round {round}");
    }
}

/// Every prefix of a file, and every file with one byte left out, as an editor sees it while one types.
#[test]
fn half_typed_files() {
    let text = include_str!("fixtures/trees/example.sdf");
    for end in 0..text.len() {
        check(&text[..end]);
        check(&format!("{}{}", &text[..end], &text[end + 1..]));
    }
}

/// A name that no parser gave up on keeps its value as far as it could be read.
#[test]
fn a_broken_item_keeps_its_name() {
    let (file, _) = parse(FileId::default(), "let a = ]\nlet b = (((\nfn c(");
    let names: Vec<_> = file
        .items
        .iter()
        .map(|item| match &item.kind {
            ItemKind::Let(binding) => (&*binding.name.text, binding.value.kind == ExprKind::Error),
            ItemKind::Fn(function) => (&*function.name.text, function.body.kind == ExprKind::Error),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(names, [("a", true), ("b", true), ("c", true)]);
}
