//! `sdfc explain E020`

use crate::arguments::ExplainArguments;
use crate::failure::Failure;
use crate::output::print;
use sdf_syntax::{Code, did_you_mean};

/// Prints what codes mean.
pub fn run(arguments: &ExplainArguments) -> Result<(), Failure> {
    let codes = arguments.codes.iter().map(|word| code(word)).collect::<Result<Vec<Code>, Failure>>()?;
    let pages: Vec<String> = codes.into_iter().map(page).collect();
    print(pages.join("\n").as_bytes())
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
        None => codes,
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
