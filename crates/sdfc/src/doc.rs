//! `sdfc doc smin`: what the library's doc comments say, for people at a terminal.

use crate::arguments::{DocArguments, MessageArguments};
use crate::failure::Failure;
use crate::output::print;
use crate::terminal::{GREEN, RESET};
use anstream::ColorChoice;
use anstream::adapter::strip_str;
use sdf_lang::{Entry, Form, glossary, reference};
use sdf_syntax::did_you_mean;
use std::io;

/// How many characters a line has at most, where words can be broken.
const WIDTH: usize = 100;

/// Prints what words mean, or a list of all.
pub fn run(arguments: &DocArguments, messages: &MessageArguments) -> Result<(), Failure> {
    let chapters = chapters();
    let pages = match &arguments.names[..] {
        [] => vec![list(&chapters)],
        names => names.iter().map(|name| page(&chapters, name)).collect::<Result<_, _>>()?,
    };
    let text = pages.join("\n");
    match messages.color_on(&io::stdout()) {
        ColorChoice::Never => print(strip_str(&text).to_string().as_bytes()),
        _ => print(text.as_bytes()),
    }
}

/// All words with what they have in common: those of the library, then those that are built in.
fn chapters() -> Vec<(String, Vec<Entry>)> {
    let sections = reference().into_iter().map(|section| (section.introduction, section.entries));
    let groups = glossary().into_iter().map(|group| (format!("{}.", group.title), group.entries));
    sections.chain(groups).collect()
}

/// Every word with the first sentence about it.
fn list(chapters: &[(String, Vec<Entry>)]) -> String {
    let width = chapters.iter().flat_map(|(_, entries)| entries).map(|entry| entry.name.len()).max();
    let width = width.unwrap_or(0);
    let mut out = String::new();
    for (title, entries) in chapters {
        out += &format!("{title}\n");
        for Entry { name, forms } in entries {
            let summary = forms.iter().map(|form| &form.summary).find(|summary| !summary.is_empty());
            let summary = summary.map_or("", |summary| summary);
            out += &hanging(&format!("  {GREEN}{name:<width$}{RESET}  "), width + 4, summary);
        }
        out.push('\n');
    }
    out + "`sdfc doc NAME` tells more.\n"
}

/// What there is to say of a name: the library may have functions of it, and the compiler others.
fn page(chapters: &[(String, Vec<Entry>)], name: &str) -> Result<String, Failure> {
    let wanted = name.trim_start_matches('@');
    let entries = || chapters.iter().flat_map(|(_, entries)| entries);
    let found: Vec<String> = entries()
        .filter(|entry| entry.name == wanted)
        .flat_map(|entry| entry.forms.iter().map(form))
        .collect();
    if found.is_empty() {
        let help = match did_you_mean(wanted, entries().map(|entry| &*entry.name)) {
            Some(similar) => format!("did you mean `{similar}`? `sdfc doc` lists all"),
            None => "`sdfc doc` lists all".to_string(),
        };
        return Err(Failure::call(format!("the language has no word `{name}`")).help(help));
    }
    Ok(found.join("\n"))
}

/// The page of a function: how it is called, what it makes, and all that is known of it.
fn form(form: &Form) -> String {
    let mut out = hanging(&format!("{GREEN}{}{RESET}", form.signature), 0, "");
    out += &hanging("  ", 2, &form.summary);
    for paragraph in &form.text {
        out += &hanging("  ", 2, paragraph);
    }
    let meanings: Vec<(String, &str)> =
        form.meanings().into_iter().map(|(names, meaning)| (names.join(", "), meaning)).collect();
    let width = meanings.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (i, (name, meaning)) in meanings.iter().enumerate() {
        out += if i == 0 { "\n" } else { "" };
        out += &hanging(&format!("  {GREEN}{name:<width$}{RESET}  "), width + 4, meaning);
    }
    let rows = form.promises.iter().map(|promise| ("Contract", promise));
    let rows = rows.chain(form.requirements.iter().map(|requirement| ("Requires", requirement)));
    let rows = rows.chain(form.source.iter().map(|source| ("From", source)));
    let rows = rows.chain(form.examples.iter().map(|example| ("Example", example)));
    let mut before = "";
    for (head, text) in rows {
        out += if before.is_empty() { "\n" } else { "" };
        out += &hanging(&format!("  {:<8}  ", if head == before { "" } else { head }), 12, text);
        before = head;
    }
    out
}

/// A text behind a heading, broken between words, its further lines set in by `indent`.
pub fn hanging(heading: &str, indent: usize, text: &str) -> String {
    let mut out = heading.to_string();
    let mut column = indent;
    for (i, word) in text.split(' ').enumerate() {
        let length = word.chars().count();
        if i > 0 && column + 1 + length > WIDTH {
            out += &format!("\n{}", " ".repeat(indent));
            column = indent;
        } else if i > 0 {
            out.push(' ');
            column += 1;
        }
        out += word;
        column += length;
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words() {
        let text = "word ".repeat(40);
        let lines = hanging("  head  ", 8, text.trim_end());
        assert!(lines.lines().count() == 3 && lines.lines().all(|line| line.len() <= WIDTH), "{lines}");
        assert!(lines.lines().skip(1).all(|line| line.starts_with("        word")), "{lines}");
        assert_eq!(hanging("  ", 2, "short"), "  short\n");
    }
}
