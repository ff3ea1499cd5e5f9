//! The grammar file is what the parser's functions say about themselves.

use std::path::Path;

/// The productions: doc comments of the form ``/// `name = …` `` in the parser, in its order, without repetition.
fn productions(parser: &str) -> String {
    let mut out = String::from(
        "(* The grammar of .sdf files, from the comments above the parser's functions.\n   \
         `x,*` is any number of x between commas, with an optional comma behind the last.\n   \
         How tightly operators bind stands in the language's page. *)\n\n",
    );
    let mut seen = Vec::new();
    for line in parser.lines() {
        let Some(text) = line.trim().strip_prefix("/// `").and_then(|rest| rest.strip_suffix('`')) else {
            continue;
        };
        let Some((name, _)) = text.split_once(" = ") else { continue };
        if !seen.contains(&name) {
            seen.push(name);
            out.push_str(&format!("{text} ;\n"));
        }
    }
    out
}

#[test]
fn the_grammar_file_is_fresh() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let parser = std::fs::read_to_string(root.join("src/parser.rs")).expect("the parser");
    let path = root.join("../../grammar/sdf.ebnf");
    let expected = productions(&parser);
    if std::env::var_os("UPDATE_FIXTURES").is_some() {
        std::fs::write(&path, &expected).expect("grammar/sdf.ebnf can be written");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(found, expected, "run `UPDATE_FIXTURES=1 cargo test -p sdf-syntax --test grammar`");
    for rule in ["item", "scene", "expr", "postfix", "if"] {
        assert!(expected.contains(&format!("\n{rule} = ")), "the production `{rule}` is missing");
    }
}
