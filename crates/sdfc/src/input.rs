//! Scenes from files and standard input.

use crate::failure::Failure;
use crate::terminal::Terminal;
use sdf_lang::USER_FILE;
use sdf_syntax::{FILE_LIMIT, Sources};
use sdfc::{reason, similar_file};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// A scene as text.
pub struct Scene {
    /// What messages call it.
    pub name: String,
    /// The text.
    pub text: String,
}

/// Whether a path stands for standard input or output.
pub fn is_dash(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads a scene; a file that is no text is told on the terminal.
pub fn read(path: &Path, terminal: &Terminal) -> Result<Scene, Failure> {
    let name = if is_dash(path) { "<stdin>".to_string() } else { path.display().to_string() };
    let bytes = bytes(path).map_err(|error| {
        let failure = Failure::call(format!("cannot read {name}: {}", reason(&error)));
        match error.kind() {
            io::ErrorKind::NotFound => match similar_file(path) {
                Some(name) => failure.help(format!("did you mean {name}?")),
                None => failure.help("is the path right?"),
            },
            io::ErrorKind::IsADirectory => failure.help("name a file in it"),
            _ => failure,
        }
    })?;
    match sdf_syntax::decode(USER_FILE, &bytes) {
        Ok(text) => Ok(Scene { name, text }),
        Err(diagnostic) => {
            let mut sources = Sources::default();
            sources.add(name, "");
            terminal.diagnostics(&sources, &[diagnostic]);
            Err(Failure::Scene)
        }
    }
}

/// At most one byte more than a file may have, which is enough to know that it has too many.
fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let limit = FILE_LIMIT as u64 + 1;
    if is_dash(path) {
        io::stdin().lock().take(limit).read_to_end(&mut bytes)?;
    } else {
        File::open(path)?.take(limit).read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}
