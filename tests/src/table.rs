//! Tables that a test writes and the repository keeps.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What begins the line that tells versions, which differ between machines.
const VERSIONS: &str = "Last written with ";

/// A table with what is said above it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Table {
    /// The heading.
    pub title: String,
    /// What the cells mean, in Markdown.
    pub about: String,
    /// What was run, with versions.
    pub versions: Vec<String>,
    /// The heads of the columns.
    pub columns: Vec<String>,
    /// The cells of each row.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The table as Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let mut text = format!("# {}\n\n{}\n\n", self.title, self.about);
        writeln!(text, "{VERSIONS}{}.\n", self.versions.join("; ")).expect("a string grows");
        text += &line(&self.columns);
        text += &line(&vec!["---".to_owned(); self.columns.len()]);
        text + &self.rows.iter().map(|row| line(row)).collect::<String>()
    }

    /// Writes the file of this name in `tests/tables/`.
    pub fn write(&self, name: &str) {
        let path = folder().join(name);
        std::fs::write(&path, self.markdown()).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }

    /// Compares the table with the file of this name in `tests/tables/`, versions apart; what is wrong, if anything.
    /// Where the environment has `UPDATE_TABLES`, the file is written instead.
    pub fn check(&self, name: &str) -> Option<String> {
        let path = folder().join(name);
        let text = self.markdown();
        if std::env::var_os("UPDATE_TABLES").is_some() {
            self.write(name);
            return None;
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        let lines = |text: &str| -> Vec<String> {
            text.lines().filter(|line| !line.starts_with(VERSIONS)).map(str::to_owned).collect()
        };
        let (kept, found) = (lines(&kept), lines(&text));
        let missing = |from: &[String], of: &[String], sign: char| -> String {
            of.iter().filter(|line| !from.contains(line)).map(|line| format!("{sign} {line}\n")).collect()
        };
        (kept != found).then(|| {
            format!(
                "tests/tables/{name} is not what this run says; run it again with UPDATE_TABLES=1 to write it:\n{}{}",
                missing(&found, &kept, '-'),
                missing(&kept, &found, '+')
            )
        })
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tables")
}
