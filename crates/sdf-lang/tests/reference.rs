//! The library's doc comments are whole, and a scene makes nothing of the library ready but what it uses.

use sdf_lang::{Form, Kind, Options, compile, kind_of, parsed_functions, reference};
use sdf_syntax::tree::TypeKind;

/// What the doc comment of a form lacks.
fn lacks(form: &Form) -> Vec<String> {
    let mut lacks = Vec::new();
    if form.summary.is_empty() {
        lacks.push("what it makes".to_string());
    } else if !form.summary.ends_with('.') {
        lacks.push("a full stop behind its first sentence".into());
    }
    for parameter in form.parameters.iter().filter(|parameter| parameter.meaning.is_none()) {
        lacks.push(format!("a line for `{}`", parameter.name));
    }
    if form.source.is_none() {
        lacks.push("`From:`".into());
    }
    if form.examples.is_empty() {
        lacks.push("`Example:`".into());
    }
    for example in &form.examples {
        match kind_of(example) {
            // What becomes of a function that is handed in, the compiler finds out at each call.
            Ok(Kind::Shape | Kind::Shape2) => {
                let takes_function = form.parameters.iter().any(|p| p.ty == Some(TypeKind::Fn));
                if form.promises.is_empty() && form.has_field && !takes_function {
                    lacks.push("a contract".into());
                }
            }
            Ok(_) => {}
            Err(found) => lacks.push(format!("an example that compiles: `{example}`: {found:?}")),
        }
    }
    lacks
}

#[test]
fn every_function_of_the_library_is_explained() {
    let mut found = String::new();
    let mut count = 0;
    for section in reference() {
        assert!(!section.title.is_empty(), "{} has no title", section.file);
        for entry in &section.entries {
            for form in &entry.forms {
                count += 1;
                let lacks = lacks(form);
                if !lacks.is_empty() {
                    found += &format!(
                        "{}:{} `{}` lacks {}\n",
                        section.file,
                        form.line,
                        form.signature,
                        lacks.join(", ")
                    );
                }
                // An operator may be called by its symbol.
                let name = &entry.name;
                let is_called =
                    |example: &String| example.contains(&format!("{name}(")) || name == "complement";
                if !form.examples.iter().all(is_called) {
                    found += &format!("{}:{}: an example does not call `{name}`\n", section.file, form.line);
                }
            }
        }
    }
    assert!(count > 40, "the library was not found");
    assert!(found.is_empty(), "doc comments are incomplete:\n{found}");
}

/// What is said of a parameter that does not exist is a mistake in the comment.
#[test]
fn comments_speak_of_parameters_that_are_there() {
    for section in reference() {
        for form in section.entries.iter().flat_map(|entry| &entry.forms) {
            for text in form.text.iter().chain([&form.summary]) {
                assert!(!text.contains("- `") && !text.contains("From:"), "{}: {text}", form.signature);
            }
        }
    }
}

/// The other tests of this file read the whole library, so this one asks in a process of its own.
#[test]
fn a_scene_makes_ready_what_it_uses() {
    const ASKED: &str = "SDF_COUNT_FUNCTIONS";
    if std::env::var_os(ASKED).is_some() {
        let compilation = compile("", "scene { sphere(1) }", &Options::default());
        assert!(compilation.scene.is_some());
        println!("parsed: {}.", parsed_functions());
        return;
    }
    let me = std::env::current_exe().expect("a test is a program");
    let output = std::process::Command::new(me)
        .args(["--exact", "a_scene_makes_ready_what_it_uses", "--nocapture"])
        .env(ASKED, "1")
        .output()
        .expect("the test runs");
    let text = String::from_utf8_lossy(&output.stdout);
    let count = text.split("parsed: ").nth(1).and_then(|rest| rest.split('.').next());
    let count: usize = count.and_then(|count| count.parse().ok()).unwrap_or_else(|| panic!("{text}"));
    assert!((1..=6).contains(&count), "{count} functions of the library were parsed");
}
