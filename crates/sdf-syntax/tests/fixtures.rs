//! Sources with what must come of them. A fixture is a source, the line `// expect`, and the expectation as
//! comments: the tree, or the diagnostics. `UPDATE_FIXTURES=1 cargo test` writes the expectations anew.

use sdf_syntax::{Code, Diagnostic, FileId, Source, Sources, dump, foreign_name, parse};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const MARK: &str = "// expect\n";

/// The fixtures of a folder, in the order of their names.
fn fixtures(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(folder);
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

/// Compares what `outcome` makes of each fixture's source with the fixture's expectation.
fn check(folder: &str, outcome: fn(&str) -> String) {
    let mut failed = Vec::new();
    for path in fixtures(folder) {
        let text = std::fs::read_to_string(&path).unwrap();
        let (source, expected) = text.split_once(MARK).unwrap_or((&text, ""));
        let actual: String =
            outcome(source).lines().map(|line| format!("// {line}").trim_end().to_string() + "\n").collect();
        if actual != expected && std::env::var_os("UPDATE_FIXTURES").is_some() {
            std::fs::write(&path, format!("{source}{MARK}{actual}")).unwrap();
        } else if actual != expected {
            failed.push(format!("{}\n--- expected\n{expected}--- actual\n{actual}", path.display()));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Diagnostics as a fixture shows them: code, line and column, the text at that place, message, and the rest.
fn describe(source: &str, diagnostics: &[Diagnostic]) -> String {
    let mut sources = Sources::default();
    let file = sources.add("fixture", source);
    let mut out = String::new();
    for d in diagnostics {
        let (line, column) = sources.line_column(file, d.span.start);
        let Source { text, .. } = sources.get(file).unwrap();
        let there: String = text[d.span.start as usize..d.span.end as usize].chars().take(30).collect();
        writeln!(out, "{} {line}:{column} {there:?} {}", d.code, d.message).unwrap();
        if !d.label.is_empty() {
            writeln!(out, "  label: {}", d.label).unwrap();
        }
        for related in &d.related {
            let (line, column) = sources.line_column(file, related.span.start);
            writeln!(out, "  at {line}:{column}: {}", related.text).unwrap();
        }
        if let Some(help) = &d.help {
            writeln!(out, "  help: {help}").unwrap();
        }
    }
    out
}

#[test]
fn trees() {
    check("trees", |source| {
        let (file, diagnostics) = parse(FileId::default(), source);
        describe(source, &diagnostics) + &dump::tree(&file)
    });
}

#[test]
fn tokens() {
    check("tokens", |source| dump::tokens(FileId::default(), source));
}

#[test]
fn errors() {
    check("errors", |source| describe(source, &parse(FileId::default(), source).1));
}

/// What stands in the tree where a mistake was.
#[test]
fn recovered() {
    check("recovered", |source| dump::tree(&parse(FileId::default(), source).0));
}

#[test]
fn every_code_has_a_fixture() {
    let mut seen = BTreeSet::from([Code::E001]);
    for path in fixtures("errors") {
        let text = std::fs::read_to_string(path).unwrap();
        let source = text.split(MARK).next().unwrap_or_default();
        seen.extend(parse(FileId::default(), source).1.iter().map(|d| d.code));
    }
    let ours = Code::ALL.iter().filter(|code| code.as_str() < "E020" || **code == Code::E023);
    assert_eq!(seen, ours.copied().collect());
}

/// A mistake in every line, and one message for each, in order.
#[test]
fn thirty_mistakes_make_thirty_messages() {
    let lines: Vec<String> = (0..30)
        .map(|i| match i % 6 {
            0 => format!("let a{i} = 1 + * 2\n"),
            1 => format!("fn f{i}(x, y z) = x\n"),
            2 => format!("let b{i} = c ? 1 : 2\n"),
            3 => format!("light l{i} {{ color 1 }}\n"),
            4 => format!("scene {{ sphere(, 1) }} // {i}\n"),
            _ => format!("let c{i} = (1, 2\n"),
        })
        .collect();
    let (file, diagnostics) = parse(FileId::default(), &lines.concat());
    assert_eq!(file.items.len(), 30);
    let mut end = 0;
    let mut lines = lines.iter();
    for d in &diagnostics {
        let start = end;
        end += lines.next().map_or(0, String::len);
        assert!((start..end).contains(&(d.span.start as usize)), "{d:?} not in {start}..{end}");
    }
    assert_eq!(diagnostics.len(), 30);
}

#[test]
fn names_of_other_languages_have_an_answer() {
    for name in
        "mod iTime iMouse iResolution vec2 vec3 vec4 float lerp saturate atan2 PI TAU opUnion".split(' ')
    {
        assert!(foreign_name(name).is_some(), "{name}");
    }
    for name in "mix fract sphere pi tau time mouse clamp".split(' ') {
        assert_eq!(foreign_name(name), None, "{name}");
    }
}
