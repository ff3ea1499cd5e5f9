//! Imported files on disk: which file a path means, and that it stays within the folders that are allowed.

use sdf_lang::{Imports, Loader, Location, Refusal};
use sdf_syntax::FILE_LIMIT;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Follows the imports of a scene within its folder and others that are allowed.
#[derive(Debug)]
pub struct FileLoader {
    /// The scene's file, if it is one.
    root: Option<Location>,
    /// The folder of the scene, canonical.
    folder: PathBuf,
    /// All folders in which an imported file may be, canonical, that of the scene first.
    allowed: Vec<PathBuf>,
    /// The folder of the scene as messages show it; empty for the current one.
    shown: String,
}

impl FileLoader {
    /// The loader for a scene, which may be `-` for standard input, and the folders that `--include` allows. An
    /// error says which folder is not there.
    pub fn new(scene: &Path, include: &[PathBuf]) -> Result<FileLoader, (PathBuf, io::Error)> {
        // Standard input and pipes import from where the command runs.
        let is_file = scene.as_os_str() != "-" && scene.metadata().is_ok_and(|m| m.is_file());
        let named = if is_file { scene.parent().unwrap_or(Path::new("")) } else { Path::new("") };
        let here = if named.as_os_str().is_empty() { Path::new(".") } else { named };
        let canonical = |path: &Path| path.canonicalize().map_err(|error| (path.to_path_buf(), error));
        let mut root = None;
        let mut folder = canonical(here)?;
        if is_file {
            let file = canonical(scene)?;
            // A link to a scene imports from where the scene is.
            folder = file.parent().unwrap_or(&folder).to_path_buf();
            let key = file.to_string_lossy().into_owned();
            root = Some(Location { key, name: scene.display().to_string() });
        }
        let mut allowed = vec![folder.clone()];
        for path in include {
            let path = canonical(path)?;
            if !path.is_dir() {
                return Err((path, io::Error::from(io::ErrorKind::NotADirectory)));
            }
            allowed.push(path);
        }
        Ok(FileLoader { root, folder, allowed, shown: named.display().to_string() })
    }

    /// The loader as an option of the compiler.
    pub fn imports(self) -> Imports {
        Imports::from(Arc::new(self))
    }

    fn allows(&self, path: &Path) -> bool {
        self.allowed.iter().any(|folder| path.starts_with(folder))
    }
}

impl Loader for FileLoader {
    fn root(&self) -> Option<Location> {
        self.root.clone()
    }

    fn find(&self, path: &str, importer: Option<&Location>) -> Result<Location, Refusal> {
        if path.is_empty() {
            return Err(refusal("the path is empty", Some("name a file: `import \"file.sdf\"`")));
        }
        if path.contains('\\') {
            return Err(refusal("the path has a `\\`", Some("separate folders with `/`, on every system")));
        }
        if path.contains(|c: char| c.is_control()) {
            return Err(refusal("the path has a character that no path has", None));
        }
        let relative = Path::new(path);
        if relative.components().any(|c| matches!(c, Component::RootDir | Component::Prefix(_))) {
            return Err(refusal("the path is absolute", Some("write it relative to the importing file")));
        }
        let importer = importer.filter(|file| Some(*file) != self.root.as_ref());
        let folder = importer.and_then(|file| Path::new(&file.key).parent()).unwrap_or(&self.folder);
        // Whether a file is there is not even looked at outside of what is allowed.
        let wanted = plain(&folder.join(relative));
        if !self.allows(&wanted) {
            return Err(outside());
        }
        let file = wanted.canonicalize().map_err(|error| match similar_file(&wanted) {
            Some(name) if error.kind() == io::ErrorKind::NotFound => {
                refusal("there is no such file", Some(&format!("did you mean `{name}`?")))
            }
            _ => unreadable(&error),
        })?;
        if !self.allows(&file) {
            return Err(outside());
        }
        let metadata = fs::metadata(&file).map_err(|error| unreadable(&error))?;
        if !metadata.is_file() {
            let what = if metadata.is_dir() { "it is a folder" } else { "it is no plain file" };
            return Err(refusal(what, Some("name a file: `import \"folder/file.sdf\"`")));
        }
        let shown = match importer {
            Some(file) => Path::new(&file.name).parent().unwrap_or(Path::new("")).to_path_buf(),
            None => PathBuf::from(&self.shown),
        };
        let Some(key) = file.to_str() else {
            return Err(refusal("its path is not UTF-8", Some("rename the file or its folder")));
        };
        Ok(Location { key: key.to_string(), name: plain(&shown.join(relative)).display().to_string() })
    }

    fn read(&self, file: &Location) -> Result<Vec<u8>, Refusal> {
        let mut bytes = Vec::new();
        // One byte more than a file may have tells that it has too many.
        let opened = File::open(&file.key).map_err(|error| unreadable(&error))?;
        opened.take(FILE_LIMIT as u64 + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
        Ok(bytes)
    }
}

/// The path without `.`, and without `..` where a folder stands before it.
fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            Component::ParentDir if out.has_root() => {}
            other => out.push(other),
        }
    }
    out
}

/// A file that is there, in the folder of one that is not, and whose name is like it.
pub fn similar_file(path: &Path) -> Option<String> {
    /// More files than this are not looked through for a hint.
    const MOST: usize = 10_000;
    let wanted = path.file_stem()?.to_str()?;
    let extension = path.extension();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).ok()?.take(MOST);
    let names: Vec<String> = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    let alike = names.iter().map(Path::new).filter(|name| name.extension() == extension);
    let stem = sdf_syntax::did_you_mean(wanted, alike.filter_map(|name| name.file_stem()?.to_str()))?;
    Some(Path::new(stem).with_extension(extension.unwrap_or_default()).display().to_string())
}

fn outside() -> Refusal {
    refusal(
        "it is not in the scene's folder",
        Some("move it there, or allow its folder with `--include FOLDER`"),
    )
}

fn unreadable(error: &io::Error) -> Refusal {
    match error.kind() {
        io::ErrorKind::NotFound => {
            refusal("there is no such file", Some("the path is relative to the file that imports it"))
        }
        _ => refusal(&crate::reason(error), None),
    }
}

fn refusal(message: &str, help: Option<&str>) -> Refusal {
    Refusal { message: message.to_string(), help: help.map(str::to_string) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_paths() {
        let rows = [
            ("a/./b", "a/b"),
            ("a/../b", "b"),
            ("/a/../../b", "/b"),
            ("../a", "../a"),
            ("a/../../b", "../b"),
            ("../../a", "../../a"),
        ];
        for (path, expected) in rows {
            assert_eq!(plain(Path::new(path)), Path::new(expected), "{path}");
        }
    }
}
