//! The files that are part of the compiler: the standard library and the renderer, both in the language itself.

use sdf_syntax::tree::File;
use sdf_syntax::{FileId, Sources};
use std::sync::OnceLock;

/// The standard library, in the order of its reference page.
const STD: &[(&str, &str)] = &[
    ("<std/balls.sdf>", include_str!("../std/balls.sdf")),
    ("<std/boxes.sdf>", include_str!("../std/boxes.sdf")),
    ("<std/polyhedra.sdf>", include_str!("../std/polyhedra.sdf")),
    ("<std/turned.sdf>", include_str!("../std/turned.sdf")),
    ("<std/curves.sdf>", include_str!("../std/curves.sdf")),
    ("<std/fractals.sdf>", include_str!("../std/fractals.sdf")),
    ("<std/plane.sdf>", include_str!("../std/plane.sdf")),
    ("<std/combine.sdf>", include_str!("../std/combine.sdf")),
    ("<std/operate.sdf>", include_str!("../std/operate.sdf")),
    ("<std/color.sdf>", include_str!("../std/color.sdf")),
];

/// The renderer: one file an effect.
const RUNTIME: &[(&str, &str)] = &[
    ("<runtime/pixel.sdf>", include_str!("../runtime/pixel.sdf")),
    ("<runtime/camera.sdf>", include_str!("../runtime/camera.sdf")),
    ("<runtime/march.sdf>", include_str!("../runtime/march.sdf")),
    ("<runtime/light.sdf>", include_str!("../runtime/light.sdf")),
    ("<runtime/glow.sdf>", include_str!("../runtime/glow.sdf")),
    ("<runtime/probe.sdf>", include_str!("../runtime/probe.sdf")),
    ("<runtime/query.sdf>", include_str!("../runtime/query.sdf")),
];

/// The trees of the files that are part of the compiler.
pub(crate) struct Library {
    pub std: Vec<File>,
    pub runtime: Vec<File>,
}

/// The library, parsed once a process.
pub(crate) fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let parse = |files: &[(&str, &str)], first: usize| -> Vec<File> {
            files
                .iter()
                .enumerate()
                .map(|(i, (name, text))| {
                    let (file, diagnostics) = sdf_syntax::parse(FileId((first + i) as u16), text);
                    assert!(diagnostics.is_empty(), "{name} is not well formed: {diagnostics:?}");
                    file
                })
                .collect()
        };
        Library { std: parse(STD, 1), runtime: parse(RUNTIME, 1 + STD.len()) }
    })
}

/// Whether a file is part of the compiler.
pub(crate) fn is_ours(file: FileId) -> bool {
    (1..=STD.len() + RUNTIME.len()).contains(&usize::from(file.0))
}

/// The user's file as file 0, and after it the files of the compiler.
pub(crate) fn sources(name: &str, text: &str) -> Sources {
    let mut sources = Sources::default();
    sources.add(name, text);
    for (name, text) in STD.iter().chain(RUNTIME) {
        sources.add(*name, *text);
    }
    sources
}
