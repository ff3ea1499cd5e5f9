//! Artefacts to files and standard output: whole, or not at all.

use crate::failure::Failure;
use crate::input::is_dash;
use sdfc::reason;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Where an artefact goes.
pub enum Output {
    /// Standard output.
    Standard,
    /// A file, by its own path and not that of a link to it.
    File(PathBuf),
}

impl Output {
    /// Looks at a path before any work is done, so that a wrong one is told at once. `scene` is what must not be
    /// overwritten.
    pub fn prepare(path: &Path, scene: &Path) -> Result<Output, Failure> {
        if is_dash(path) {
            return Ok(Output::Standard);
        }
        let cannot = |why: &str| Failure::call(format!("cannot write {}: {why}", path.display()));
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(cannot("it is a folder")),
            Ok(found) if found.is_file() && found.permissions().readonly() => {
                return Err(cannot("it is read-only"));
            }
            Ok(_) => {}
            Err(_) => {
                let folder = folder(path);
                if !folder.is_dir() {
                    return Err(cannot(&format!("there is no folder {}", folder.display())));
                }
            }
        }
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if fs::canonicalize(scene).is_ok_and(|scene| scene == path) {
            return Err(cannot("it is the scene itself"));
        }
        Ok(Output::File(path))
    }

    /// Writes the artefact.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        match self {
            Output::Standard => print(bytes),
            Output::File(path) => write_file(path, bytes).map_err(|error| {
                Failure::call(format!("cannot write {}: {}", path.display(), reason(&error)))
            }),
        }
    }
}

/// The lines of a table, of which all have as many cells: the first column begins at the left, the others end at the right.
pub fn aligned(lines: &[Vec<String>]) -> Vec<String> {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |cells: &Vec<String>| {
        let mut out = format!("{:<width$}", cells[0], width = widths[0]);
        for (cell, width) in cells.iter().zip(&widths).skip(1) {
            out.push_str(&format!("  {cell:>width$}"));
        }
        out + "\n"
    };
    lines.iter().map(line).collect()
}

/// Prints an artefact. That the reader has seen enough is no failure.
pub fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::call(format!("cannot write to standard output: {}", reason(&error))))
        }
        _ => Ok(()),
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes beside the file and renames, so that the file is never half. What is no plain file, a pipe for example,
/// is written as it is.
fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let present = fs::metadata(path).ok();
    if present.as_ref().is_some_and(|found| !found.is_file()) {
        return fs::OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".sdfc-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What any new file gets; the system takes off what the user does not want.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder(path))?;
    file.write_all(bytes)?;
    if let Some(found) = present {
        file.as_file().set_permissions(found.permissions())?;
    }
    file.persist(path)?;
    Ok(())
}
