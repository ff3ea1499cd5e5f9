//! Other marches: functions that stand in for those of the same name in the compiler's files.

use std::ops::Range;
use std::path::{Path, PathBuf};

/// The march of the compiler as it is.
pub const PRODUCT: &str = "product";

/// A march.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variant {
    /// What it is called: see [`Variant::named`].
    pub name: String,
    /// The compiler's files that differ, as [`sdf_lang::Options::replaced`] takes them.
    pub replaced: Vec<(String, String)>,
    /// How near to a surface a hit is, in pixels, where the scene's own setting is not meant.
    pub tolerance: Option<String>,
}

impl Variant {
    /// The march of this name: [`PRODUCT`], or names of files in `tests/march/`, joined by `+`. A number in brackets
    /// behind a name stands for `VALUE` in the file, and one behind `@` at the end is the tolerance in pixels:
    /// `relaxation(1.2)+unrefined@0.05`.
    ///
    /// An error says what no such march is.
    pub fn named(name: &str) -> Result<Variant, String> {
        let (patches, tolerance) = match name.split_once('@') {
            Some((patches, tolerance)) => (patches, Some(number(tolerance)?)),
            None => (name, None),
        };
        let mut files = Files::default();
        for patch in patches.split('+').filter(|patch| *patch != PRODUCT) {
            let (stem, value) = match patch.strip_suffix(')').and_then(|patch| patch.split_once('(')) {
                Some((stem, value)) => (stem, Some(number(value)?)),
                None => (patch, None),
            };
            let path = folder().join(format!("{stem}.sdf"));
            let text =
                std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            if text.contains("VALUE") != value.is_some() {
                let wants = if value.is_some() { "no value" } else { "a value, as in" };
                return Err(format!("`{stem}` takes {wants} `{stem}(1.2)`"));
            }
            files.patch(&text.replace("VALUE", value.as_deref().unwrap_or_default()))?;
        }
        Ok(Variant { name: name.into(), replaced: files.changed, tolerance })
    }

    /// The same march, with the functions of another file of `tests/march/` as well.
    pub fn with(&self, patch: &str) -> Result<Variant, String> {
        let (patches, tolerance) =
            self.name.split_once('@').map_or((&*self.name, None), |(p, t)| (p, Some(t)));
        let tolerance = tolerance.map_or(String::new(), |t| format!("@{t}"));
        Variant::named(&format!("{patches}+{patch}{tolerance}"))
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("march")
}

/// A number as it is written, if it is one.
fn number(text: &str) -> Result<String, String> {
    text.parse::<f64>().map(|_| text.to_owned()).map_err(|_| format!("`{text}` is no number"))
}

/// The compiler's files, with what has been changed in them.
#[derive(Debug, Default)]
struct Files {
    changed: Vec<(String, String)>,
}

impl Files {
    /// Puts each function of a text where the compiler has the one of its name. There must be exactly one, so that no
    /// patch outlives what it was made for.
    fn patch(&mut self, text: &str) -> Result<(), String> {
        for (name, range) in functions(text) {
            let mut places: Vec<(String, String, Range<usize>)> = Vec::new();
            for (file, original) in sdf_lang::compiler_files() {
                let changed = self.changed.iter().find(|(changed, _)| changed == file);
                let now = changed.map_or(original, |(_, text)| text);
                let found = functions(now).into_iter().filter(|(found, _)| *found == name);
                places.extend(found.map(|(_, at)| (file.to_owned(), now.to_owned(), at)));
            }
            let [(file, mut now, at)] = <[_; 1]>::try_from(places)
                .map_err(|found| format!("the compiler has {} functions `{name}`", found.len()))?;
            now.replace_range(at, &text[range]);
            self.changed.retain(|(changed, _)| *changed != file);
            self.changed.push((file, now));
        }
        Ok(())
    }
}

/// The functions of a file with their places: from the line of `fn` to the next that is no part of it.
fn functions(text: &str) -> Vec<(&str, Range<usize>)> {
    let mut found: Vec<(&str, Range<usize>)> = Vec::new();
    let mut start = 0;
    let mut is_open = false;
    for line in text.split_inclusive('\n') {
        let end = start + line.len();
        if let Some(rest) = line.strip_prefix("fn ") {
            found.push((rest.split('(').next().unwrap_or_default(), start..end));
            is_open = true;
        } else if line.starts_with(['/', '@']) {
            is_open = false;
        } else if is_open && let Some((_, range)) = found.last_mut() {
            range.end = end;
        }
        start = end;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_a_march() {
        let files = std::fs::read_dir(folder()).expect("the folder of the marches");
        let paths = files.map(|file| file.expect("a file").path());
        for path in paths.filter(|path| path.extension().is_some_and(|ending| ending == "sdf")) {
            let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let has_value = std::fs::read_to_string(&path).expect("a text").contains("VALUE");
            let name = if has_value { format!("{stem}(1)") } else { stem };
            let variant = Variant::named(&name).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(!variant.replaced.is_empty(), "{name}");
            let options = sdf_lang::Options { replaced: variant.replaced, ..sdf_lang::Options::default() };
            let compilation =
                sdf_lang::compile(&name, "scene { sphere(1), box(1).twist(1).at(3, 0, 0) }", &options);
            assert!(!compilation.has_errors(), "{name}: {:?}", compilation.diagnostics);
        }
    }

    #[test]
    fn functions_replace_those_of_their_names_alone() {
        let mut files = Files::default();
        files.patch("// Other.\nfn rounding_at(ray, t) =\n  1\n").unwrap();
        let [(file, text)] = &files.changed[..] else { panic!("one file: {:?}", files.changed) };
        assert_eq!(file, "pixel.sdf");
        assert!(text.contains("fn rounding_at(ray, t) =\n  1\n/// sRGB"), "{text}");
        let before = sdf_lang::compiler_files().find(|(name, _)| name == file).unwrap().1;
        assert_eq!(functions(before).len(), functions(text).len());
    }

    #[test]
    fn what_is_no_march_is_an_error() {
        for (name, said) in [
            ("nothing", "nothing.sdf"),
            ("basic(2)", "`basic` takes no value"),
            ("global", "`global` takes a value"),
            ("global(x)", "`x` is no number"),
            ("basic@much", "`much` is no number"),
        ] {
            let error = Variant::named(name).unwrap_err();
            assert!(error.contains(said), "{name}: {error}");
        }
        let error = Files::default().patch("fn no_such_function() = 1").unwrap_err();
        assert!(error.contains("0 functions `no_such_function`"), "{error}");
    }
}
