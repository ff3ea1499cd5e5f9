//! `sdfc explain E020` and `sdfc explain scene.sdf`

mod explanation;
mod page;
mod scene;

pub use explanation::Set;

use crate::arguments::{ExplainArguments, MessageArguments};
use crate::failure::Failure;
use crate::output::print;
use crate::terminal::Terminal;
use sdf_syntax::{Code, did_you_mean};
use std::path::Path;

/// Prints what codes mean, or what there is to say of a scene.
pub fn run(
    arguments: &ExplainArguments,
    messages: &MessageArguments,
    terminal: &Terminal,
) -> Result<(), Failure> {
    match &arguments.subjects[..] {
        [path] if is_scene(path) => scene::run(Path::new(path), arguments, messages, terminal),
        words if words.iter().any(|word| is_scene(word)) => {
            Err(Failure::call("`explain` takes codes or one scene").help("ask for each by itself"))
        }
        words => {
            let codes = words.iter().map(|word| code(word)).collect::<Result<Vec<Code>, Failure>>()?;
            if arguments.json {
                return Err(Failure::call("only what is said of a scene can be had as JSON")
                    .help("leave `--json` out, or name a scene"));
            }
            let pages: Vec<String> = codes.into_iter().map(page).collect();
            print(pages.join("\n").as_bytes())
        }
    }
}

/// Whether a word names a file. A code is a code, also where a file has its name.
fn is_scene(word: &str) -> bool {
    let is_code = Code::ALL.iter().any(|code| code.as_str().eq_ignore_ascii_case(word));
    !is_code && (word == "-" || word.contains(['.', '/', '\\']) || Path::new(word).exists())
}

/// The code that a word names, in any case.
fn code(word: &str) -> Result<Code, Failure> {
    let wanted = word.to_uppercase();
    let names = || Code::ALL.iter().map(|code| code.as_str());
    if let Some(code) = Code::ALL.iter().find(|code| code.as_str() == wanted) {
        return Ok(*code);
    }
    let first_and_last = |letter: char| {
        let mut of_letter = names().filter(|name| name.starts_with(letter));
        let first = of_letter.next().unwrap_or_default();
        match of_letter.next_back() {
            Some(last) => format!("{first} to {last}"),
            None => first.to_string(),
        }
    };
    let codes = format!("codes are {} and {}", first_and_last('E'), first_and_last('W'));
    let help = match did_you_mean(&wanted, names()) {
        Some(similar) => format!("did you mean {similar}? {codes}"),
        None => format!("{codes}; a scene is named by its file, such as scene.sdf"),
    };
    Err(Failure::call(format!("there is no code {word}")).help(help))
}

/// The explanation of a code as a page: examples are set in, and their fences left out.
fn page(code: Code) -> String {
    let mut out = format!("{code}: {}\n\n", code.title());
    let mut in_example = false;
    for line in code.explanation().lines() {
        if line.starts_with("```") {
            in_example = !in_example;
        } else if in_example && !line.is_empty() {
            out += &format!("    {line}\n");
        } else {
            out += &format!("{line}\n");
        }
    }
    out
}
