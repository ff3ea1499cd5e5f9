//! Naive twins: a case with a guard taken out. A twin is a folder of `tests/hard/naive/`; each file in it holds functions
//! that stand in for those of the same name and parameters in the compiler's file of the same name, their attributes
//! included. What it adds besides is added.

use crate::run::Kernel;
use sdf_lang::compiler_files;
use std::path::PathBuf;

/// A twin by the name that a fixture gives it: a folder, or `product` where nothing stands in. Then, behind commas, what else
/// is left out: `uniform` where the param that the case freezes is a uniform, so that nothing is folded; `unguarded` where
/// the operations are the interpreter's own, without what makes them total; `bare sines` where the sine and the cosine are
/// those of the driver.
#[derive(Debug, Clone)]
pub struct Twin {
    /// The texts that stand in for the compiler's files, by their names.
    pub replaced: Vec<(String, String)>,
    /// Whether what the case freezes is frozen.
    pub frozen: bool,
    /// Whether operations are made total.
    pub guarded: bool,
    /// What becomes of a shader before a driver takes it.
    pub shader: fn(Kernel) -> Kernel,
}

impl Twin {
    /// The twin of this name.
    pub fn named(name: &str) -> Twin {
        let mut parts = name.split(", ");
        let folder = parts.next().unwrap_or_default();
        let replaced = if folder == "product" { Vec::new() } else { replaced(folder) };
        let mut twin = Twin { replaced, frozen: true, guarded: true, shader: |kernel| kernel };
        for part in parts {
            match part {
                "uniform" => twin.frozen = false,
                "unguarded" => twin.guarded = false,
                "bare sines" => twin.shader = with_bare_sines,
                _ => panic!("`{name}`: what is `{part}`?"),
            }
        }
        twin
    }
}

/// A shader in WGSL that asks the driver for the sine and the cosine, whatever the angle.
fn with_bare_sines(kernel: Kernel) -> Kernel {
    let bare = kernel.clone().with_bare("sine_cosine", "vec2f(sin({0}), cos({0}))");
    assert_ne!(bare, kernel, "a shader in WGSL that turns something");
    bare
}

/// The files of a twin's folder, put into the compiler's.
fn replaced(twin: &str) -> Vec<(String, String)> {
    let folder: PathBuf = super::fixture::folder().join("naive").join(twin);
    let files = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let file = |path: PathBuf| {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a text");
        let original = compiler_files().find(|(file, _)| *file == name);
        let (_, original) =
            original.unwrap_or_else(|| panic!("{twin}: no file of the compiler is called {name}"));
        (name, put_in(twin, original, &text))
    };
    files.map(|entry| file(entry.expect("a file").path())).collect()
}

/// A text with functions of another in the place of its own.
fn put_in(twin: &str, original: &str, naive: &str) -> String {
    let mut items = items(original);
    let mut found = false;
    for (signature, text) in self::items(naive) {
        match items.iter_mut().find(|(other, _)| *other == signature) {
            Some(item) => {
                let docs = item.1.split_inclusive('\n').filter(|line| line.starts_with("///"));
                item.1 = docs.collect::<String>() + &text;
                found = true;
            }
            None => items.push((signature, text)),
        }
    }
    assert!(found, "{twin} replaces nothing");
    items.into_iter().map(|(_, text)| text).collect()
}

/// The functions of a text by their names and parameters, each from its comments and attributes to the last of its lines.
/// All lines of a function but the first begin with a space or a closing bracket.
fn items(text: &str) -> Vec<(String, String)> {
    let mut items: Vec<(String, String)> = Vec::new();
    let mut is_heading = false;
    for line in text.split_inclusive('\n') {
        let function = line.strip_prefix("fn ");
        if !is_heading && (function.is_some() || line.starts_with(['@', '/'])) {
            items.push((String::new(), String::new()));
            is_heading = true;
        }
        let Some(item) = items.last_mut() else { continue };
        item.1.push_str(line);
        if let Some(function) = function {
            item.0 = signature(function).to_owned();
            is_heading = false;
        }
    }
    items
}

/// A function's name and parameters: all up to the bracket that closes the first one.
fn signature(function: &str) -> &str {
    let mut depth = 0;
    let end = function.find(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ')' && depth == 0
    });
    end.map_or(function, |end| &function[..end])
}
