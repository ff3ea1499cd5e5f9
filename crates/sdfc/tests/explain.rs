//! `sdfc explain`: each code has a text, whose examples are what it says.

use sdf_lang::{Imports, Texts};
use sdf_syntax::Code;
use sdfc::{Clock, Device, Frame, Language, Options, View, compile};
use std::process::Command;
use std::sync::Arc;

/// An example of an explanation.
struct Example {
    is_right: bool,
    options: Options,
    text: String,
}

/// The fenced examples of a text, in order.
fn examples(explanation: &str) -> Vec<Example> {
    let mut found = Vec::new();
    let mut lines = explanation.lines();
    while let Some(line) = lines.next() {
        let Some(head) = line.strip_prefix("```") else { continue };
        let words: Vec<&str> = head.split_whitespace().collect();
        assert!(words.len() >= 2 && words[0] == "sdf", "{line}");
        let set = words[2..].chunks(2).map(|pair| {
            assert_eq!(pair[0], "--set");
            let (name, value) = pair[1].split_once('=').unwrap();
            (name.to_string(), value.to_string())
        });
        // What the examples of imports import.
        let files =
            ["bricks.sdf", "stones.sdf"].map(|name| (name.to_string(), "fn wall(h) = box(h)".to_string()));
        let imports = Imports::from(Arc::new(Texts(files.into_iter().collect())));
        let options = Options { set: set.collect(), imports, ..Options::default() };
        let is_right = match words[1] {
            "right" => true,
            "wrong" => false,
            other => panic!("an example is right or wrong, not {other}"),
        };
        let text: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        found.push(Example { is_right, options, text: text.join("\n") });
    }
    found
}

/// The codes of what is said of a scene when it is compiled and, where that is the question, when it is drawn or
/// certified.
fn codes(example: &Example, asked: Code) -> Vec<Code> {
    if asked == Code::W006 {
        return certified(&example.text);
    }
    let options = Options { view: Some(View::Picture), ..example.options.clone() };
    let compiled = compile("example.sdf", &example.text, &options, &mut Clock::default());
    let drawn = compiled.output.as_ref().filter(|_| asked == Code::W005).and_then(|(_, shader)| {
        let frame = Frame::new(48, 27);
        let drawing = shader.draw(&frame, &Device::Cpu, Language::Wgsl, &|_| {}, &mut Clock::default());
        drawing.expect("the CPU draws").measured?.warning(&compiled.tree)
    });
    compiled.diagnostics.iter().chain(&drawn).map(|d| d.code).collect()
}

/// The codes of what `sdfc check --certify` says of a scene without mistakes.
fn certified(text: &str) -> Vec<Code> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("example.sdf");
    std::fs::write(&path, text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sdfc"));
    command.args(["check", "--certify", "--size", "16x9", "--message-format", "short"]).arg(path);
    let output = command.output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stderr).unwrap();
    Code::ALL.iter().copied().filter(|code| text.contains(&format!("[{code}]"))).collect()
}

/// These have no example in a text: bytes that are no text, texts that are too large to be shown, and mistakes of the
/// compiler. The command's tests give them.
const WITHOUT_EXAMPLE: [Code; 3] = [Code::E001, Code::E009, Code::E070];

#[test]
fn examples_are_what_they_say() {
    for code in Code::ALL {
        let examples = examples(code.explanation());
        assert!(code.explanation().len() > 100, "{code} is not explained");
        assert!(code.explanation().lines().all(|line| line.len() <= 130), "{code} has a long line");
        if WITHOUT_EXAMPLE.contains(code) {
            assert!(examples.is_empty(), "{code} has an example: take it from the list");
            continue;
        }
        assert!(examples.iter().any(|e| e.is_right) && examples.iter().any(|e| !e.is_right), "{code}");
        for example in examples {
            let expected = if example.is_right { vec![] } else { vec![*code] };
            assert_eq!(codes(&example, *code), expected, "{code}: {}", example.text);
        }
    }
}

fn explain(words: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sdfc")).arg("explain").args(words).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn explanations_are_printed() {
    for code in Code::ALL {
        let (status, out, err) = explain(&[code.as_str()]);
        assert_eq!((status, err.as_str()), (Some(0), ""), "{code}");
        assert!(out.starts_with(&format!("{code}: {}\n\n", code.title())) && !out.contains("```"), "{out}");
    }
    let (_, upper, _) = explain(&["E020"]);
    assert!(upper.contains("\n    scene { spheer(1) }\n"), "{upper}");
    assert_eq!(explain(&["e020"]), (Some(0), upper.clone(), String::new()));
    let (_, several, _) = explain(&["E020", "w001"]);
    assert!(several.starts_with(&upper) && several.contains("\nW001: "), "{several}");
}

#[test]
fn a_code_that_is_not_there_is_refused() {
    for (word, help) in [("E999", "codes are E001 to "), ("E2O", "codes are")] {
        let (status, out, err) = explain(&[word]);
        assert_eq!((status, out.as_str()), (Some(2), ""));
        assert!(err.starts_with(&format!("error: there is no code {word}\n")) && err.contains(help), "{err}");
    }
    assert!(explain(&["E0200"]).2.contains("did you mean E020?"));
    assert_eq!(explain(&[]).0, Some(2));
}
