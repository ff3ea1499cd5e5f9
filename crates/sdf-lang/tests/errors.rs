//! Scenes with mistakes, and what is said of them. A fixture is a scene, the line `// expect`, and the diagnostics
//! as comments. Files that it imports stand after lines `// file NAME`. `UPDATE_FIXTURES=1 cargo test` writes the expectations anew.

use sdf_lang::{Compilation, Imports, Options, Texts, compile};
use sdf_syntax::{Code, Diagnostic};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const MARK: &str = "// expect\n";

/// The fixtures, in the order of their names: those in `errors` make no scene, those in `warnings` do.
fn fixtures() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let entries =
        |name: &str| std::fs::read_dir(folder.join(name)).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = entries("errors").chain(entries("warnings")).collect();
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

fn compiled(source: &str) -> Compilation {
    let mut parts = source.split("// file ");
    let root = parts.next().unwrap_or_default();
    let files = parts.filter_map(|part| part.split_once('\n'));
    let texts = Texts(files.map(|(name, text)| (name.to_string(), text.to_string())).collect());
    compile("fixture", root, &Options { imports: Imports::from(Arc::new(texts)), ..Options::default() })
}

/// Diagnostics as a fixture shows them: code, line and column, the text at that place, message, and the rest.
fn describe(compilation: &Compilation) -> String {
    let mut out = String::new();
    for d in &compilation.diagnostics {
        let source = compilation.sources.get(d.span.file).unwrap();
        let (line, column) = compilation.sources.line_column(d.span.file, d.span.start);
        let there: String =
            source.text[d.span.start as usize..d.span.end as usize].chars().take(30).collect();
        let file = if source.name == "fixture" { String::new() } else { format!("{}:", source.name) };
        writeln!(out, "{} {file}{line}:{column} {there:?} {}", d.code, d.message).unwrap();
        if !d.label.is_empty() {
            writeln!(out, "  label: {}", d.label).unwrap();
        }
        for related in &d.related {
            let (line, column) = compilation.sources.line_column(related.span.file, related.span.start);
            let file = &compilation.sources.get(related.span.file).unwrap().name;
            let file = if file == "fixture" { String::new() } else { format!("{file}:") };
            writeln!(out, "  at {file}{line}:{column}: {}", related.text).unwrap();
        }
        if let Some(help) = &d.help {
            writeln!(out, "  help: {help}").unwrap();
        }
    }
    out
}

#[test]
fn errors() {
    let mut failed = Vec::new();
    for path in fixtures() {
        let text = std::fs::read_to_string(&path).unwrap();
        let (source, expected) = text.split_once(MARK).unwrap_or((&text, ""));
        let compilation = compiled(source);
        let actual: String = describe(&compilation)
            .lines()
            .map(|line| format!("// {line}").trim_end().to_string() + "\n")
            .collect();
        if actual != expected && std::env::var_os("UPDATE_FIXTURES").is_some() {
            std::fs::write(&path, format!("{source}{MARK}{actual}")).unwrap();
        } else if actual != expected {
            failed.push(format!("{}\n--- expected\n{expected}--- actual\n{actual}", path.display()));
        }
        let has_scene = path.parent().unwrap().ends_with("warnings");
        assert_eq!(compilation.scene.is_some(), has_scene, "{}", path.display());
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// A message begins with a small letter or what it quotes, and has no full stop.
#[test]
fn messages_have_one_manner() {
    let check = |d: &Diagnostic, text: &str| {
        let begins_well = text.chars().next().is_none_or(|c| !c.is_uppercase());
        assert!(begins_well && !text.ends_with('.'), "{}: {text:?}", d.code);
    };
    for path in fixtures() {
        let text = std::fs::read_to_string(path).unwrap();
        for d in compiled(text.split(MARK).next().unwrap_or_default()).diagnostics {
            check(&d, &d.message);
            check(&d, &d.label);
            check(&d, d.help.as_deref().unwrap_or_default());
            d.related.iter().for_each(|related| check(&d, &related.text));
        }
    }
}

#[test]
fn every_code_has_a_fixture() {
    let mut seen = BTreeSet::new();
    for path in fixtures() {
        let text = std::fs::read_to_string(path).unwrap();
        seen.extend(compiled(text.split(MARK).next().unwrap_or_default()).diagnostics.iter().map(|d| d.code));
    }
    // The codes of the text have theirs where the text is read.
    let of_the_text = |code: Code| code.as_str() < "E020" || code == Code::E023;
    // Values of params, shaders, costs, drawings and certificates need a command, whose own tests have them.
    let of_the_command = [Code::E065, Code::E070, Code::W001, Code::W005, Code::W006];
    let ours = Code::ALL.iter().filter(|code| !of_the_text(**code) && !of_the_command.contains(code));
    let missing: Vec<_> = ours.filter(|code| !seen.contains(code)).collect();
    assert!(missing.is_empty(), "without a fixture: {missing:?}");
}
