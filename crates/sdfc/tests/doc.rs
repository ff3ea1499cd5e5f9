//! `sdfc doc`: every word of the language has a page, and the list has them all.

use sdf_lang::{glossary, reference};
use std::process::Command;

fn doc(words: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sdfc")).arg("doc").args(words).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// A text without its line breaks and without what sets lines in.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn every_word_has_a_page() {
    let sections = reference().into_iter().flat_map(|section| section.entries);
    let entries: Vec<_> = sections.chain(glossary().into_iter().flat_map(|group| group.entries)).collect();
    let names: Vec<&str> = entries.iter().map(|entry| &*entry.name).collect();
    let (status, out, err) = doc(&names);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    assert!(!out.contains('\x1b'), "colours where no terminal is");
    assert!(out.lines().all(|line| line.trim_end().len() == line.len()), "spaces at the end of lines");
    let out = flat(&out);
    let (_, list, _) = doc(&[]);
    let list = flat(&list);
    for entry in &entries {
        let first = &entry.forms[0];
        let row = format!("{} {}", entry.name, flat(&first.summary));
        assert!(list.contains(row.trim()), "the list has no `{row}`");
        for form in &entry.forms {
            let meanings = form.parameters.iter().filter_map(|parameter| parameter.meaning.as_ref());
            let parts = [&form.signature, &form.summary].into_iter().chain(&form.text).chain(meanings);
            let parts = parts.chain(&form.promises).chain(&form.requirements).chain(&form.source);
            for part in parts.chain(&form.examples) {
                assert!(out.contains(&flat(part)), "the page of `{}` lacks {part}", entry.name);
            }
        }
    }
}

#[test]
fn a_page_is_for_people() {
    let (status, out, _) = doc(&["sqrt"]);
    assert_eq!((status, out.as_str()), (Some(0), "sqrt(x)\n  The square root; 0 of what is negative.\n"));
    // The library blends shapes and rounds them, the compiler rounds numbers.
    let (_, round, _) = doc(&["round"]);
    assert!(round.starts_with("round(s: shape, r)\n") && round.contains("\nround(x)\n"), "{round}");
    let (_, sphere, _) = doc(&["sphere"]);
    assert!(sphere.contains("\n  Contract  exact: the distance itself, everywhere outside\n"), "{sphere}");
    assert_eq!(doc(&["@exact"]).1, doc(&["exact"]).1);
    let (_, both, _) = doc(&["sphere", "sqrt"]);
    assert_eq!(both, format!("{sphere}\n{out}"));
    let (_, colored, _) = doc(&["sqrt", "--color", "always"]);
    assert!(colored.starts_with("\x1b[32msqrt(x)\x1b[0m\n"), "{colored:?}");
}

#[test]
fn a_word_that_is_not_there_is_refused() {
    let (status, out, err) = doc(&["spheer"]);
    assert_eq!((status, out.as_str()), (Some(2), ""));
    assert!(err.starts_with("error: the language has no word `spheer`\n"), "{err}");
    assert!(err.contains("did you mean `sphere`? `sdfc doc` lists all"), "{err}");
    assert!(doc(&["xxxxxxxx"]).2.contains("help: `sdfc doc` lists all"));
}
