//! Scenes of several files: which names a file sees, and what stands where.

use crate::scene::{Field, compile_with, described};
use sdf_ir::Constant;
use sdf_syntax::FILE_LIMIT;

/// The distance at the origin, which is 0 less the radius of what a scene shows.
fn value(text: &str, files: &[(&str, &str)]) -> f64 {
    let compilation = compile_with(text, files, &[]);
    assert!(compilation.diagnostics.is_empty(), "{:#?}\nin\n{text}", described(&compilation));
    -Field::of_scene(compilation.scene.unwrap(), text).at([0.0; 3])
}

/// What is said about a scene of several files, each by its beginning.
#[track_caller]
fn says(text: &str, files: &[(&str, &str)], starts: &[&str]) {
    let found = described(&compile_with(text, files, &[]));
    let fits = found.len() == starts.len() && found.iter().zip(starts).all(|(f, s)| f.starts_with(s));
    assert!(fits, "{found:#?}");
}

#[test]
fn functions_values_params_and_materials_come_over() {
    let parts = "
        fn ball(r) = sphere(r)
        let size = 3
        param k = 0.5 in 0..1
        material red { color: #ff0000 }
        scene { ignored } camera { ignored: 1 } light sun { ignored: 1 } render { far: ignored }";
    let text = "import \"parts.sdf\" scene { ball(size + k).paint(red) }";
    assert_eq!(value(text, &[("parts.sdf", parts)]), 3.5);
    assert_eq!(value("import \"parts.sdf\" scene { size.ball() }", &[("parts.sdf", parts)]), 3.0);
    let by_value = "import \"parts.sdf\" let f = ball scene { [1, 2].map(f) }";
    assert_eq!(value(by_value, &[("parts.sdf", parts)]), 2.0);
}

#[test]
fn own_names_hide_imported_ones_and_those_the_librarys() {
    let files = [("a.sdf", "fn size() = 2 fn sphere(r) = box(10 * r) let pi = 5 let y = 1")];
    assert_eq!(value("import \"a.sdf\" fn size() = 4 scene { circle(size()).extrude(9) }", &files), 4.0);
    assert_eq!(value("import \"a.sdf\" scene { sphere(1) }", &files), 10.0);
    assert_eq!(value("import \"a.sdf\" scene { 1.sphere() }", &files), 10.0);
    assert_eq!(value("import \"a.sdf\" scene { box(pi) }", &files), 5.0);
    assert_eq!(value("import \"a.sdf\" let pi = 6 scene { box(pi) }", &files), 6.0);
    assert_eq!(value("import \"a.sdf\" fn f(pi) = box(pi) scene { f(7) }", &files), 7.0);
    // A value that cannot be called hides no method.
    let value_of_a_name = [("b.sdf", "let round = 1")];
    assert_eq!(value("import \"b.sdf\" scene { box(round).round(1) }", &value_of_a_name), 2.0);
    // Own functions hide imported ones of their name, whatever they take.
    says(
        "import \"c.sdf\" fn f(a) = sphere(a) scene { f(1, 2) }",
        &[("c.sdf", "fn f(a, b) = sphere(a)")],
        &["E032: `f` does not take a float and a float"],
    );
}

#[test]
fn an_imported_function_sees_its_own_file() {
    let files = [
        ("a.sdf", "import \"lib/b.sdf\" fn outer() = inner() fn size() = 1 fn sphere(r) = nothing"),
        ("lib/b.sdf", "import \"c.sdf\" fn inner() = sphere(size()) fn size() = 2 * unit let unit = two"),
        ("lib/c.sdf", "let two = 2 fn size() = 9"),
    ];
    assert_eq!(value("import \"a.sdf\" fn size() = 8 let unit = 7 scene { outer() }", &files), 4.0);
    says(
        "import \"a.sdf\" scene { inner() }",
        &files,
        &["E020: nothing is called `inner` in this file; import that file as well"],
    );
}

#[test]
fn overloads_of_several_files_go_together() {
    let files = [("a.sdf", "fn f(a) = sphere(a)"), ("b.sdf", "fn f(a, b) = sphere(a * b)")];
    let text = "import \"a.sdf\" import \"b.sdf\" scene { f(1), f(2, 3) }";
    assert_eq!(value(text, &files), 6.0);
}

#[test]
fn a_file_is_one_however_it_is_reached() {
    let files = [
        ("a.sdf", "import \"lib/../c.sdf\" fn f() = k"),
        ("b.sdf", "import \"./c.sdf\" fn g() = k"),
        ("c.sdf", "param k = 1 in 0..9"),
    ];
    let text =
        "import \"a.sdf\" import \"b.sdf\" import \"c.sdf\" import \"c.sdf\" scene { sphere(f() + g() + k) }";
    let scene = compile_with(text, &files, &[]).scene.unwrap();
    let params: Vec<&str> = scene.program.uniforms.iter().map(|u| &*u.name).collect();
    assert_eq!(params.iter().filter(|name| **name == "k").count(), 1, "{params:?}");
    assert_eq!(value(text, &files), 3.0);
}

/// Params of one name in several files are several params; `--set` knows those of other files with their file's name.
#[test]
fn params_of_one_name_stay_apart() {
    let files = [
        ("lamp.sdf", "param k = 2 in 0..9 fn lamp() = k"),
        ("lib/lamp.sdf", "param k = 4 in 0..9 fn other() = k"),
    ];
    let text = "import \"lamp.sdf\" import \"lib/lamp.sdf\" param time = 8 in 0..9 param k = 1 in 0..9
        fn all() = k + lamp() + other() + time
        scene { sphere(all()) }"
        .replace("import \"lamp.sdf\" import", "import \"lib/lamp.sdf\" import")
        .replace("import \"lib/lamp.sdf\" param", "import \"lamp.sdf\" param");
    // Both files define `k`, which the root's hides.
    assert_eq!(value(&text, &files), 15.0);
    let scene = compile_with(&text, &files, &[]).scene.unwrap();
    let params: Vec<(&str, Constant)> = scene
        .program
        .uniforms
        .iter()
        .filter(|u| matches!(u.role, sdf_ir::Role::Param { .. }))
        .map(|u| (&*u.name, u.default))
        .collect();
    assert_eq!(params.len(), 4, "{params:?}");
    for param in [("k", 1.0), ("param_time", 8.0), ("lamp_k", 4.0), ("lamp_k_2", 2.0)] {
        assert!(params.contains(&(param.0, Constant::Float(param.1))), "{param:?} in {params:?}");
    }
    let set = [("k", "2"), ("time", "9"), ("lamp_k", "5"), ("lamp_k_2", "3")];
    let scene = compile_with(&text, &files, &set).scene.unwrap();
    assert_eq!(-Field::of_scene(scene, &text).at([0.0; 3]), 19.0);
    let wrong = described(&compile_with(&text, &files, &[("lampk", "1")]));
    assert_eq!(wrong, ["E065: there is no param `lampk` to set; did you mean `lamp_k`?"]);
}

/// The renderer's own uniforms and a param of one of their names are different things.
#[test]
fn a_param_may_have_the_name_of_an_input() {
    let settings = ["tolerance", "far", "steps", "shadow_accuracy", "occlusion_samples"];
    for name in ["time", "mouse", "orbit", "resolution"].into_iter().chain(settings) {
        let text = format!("param {name} = 2 in 0..9 scene {{ sphere({name}) }}");
        assert_eq!(value(&text, &[]), 2.0, "{name}");
    }
}

#[test]
fn chains_are_limited() {
    let chain = |n: usize| -> Vec<(String, String)> {
        (0..n)
            .map(|i| {
                let next = if i + 1 < n { format!("import \"f{}.sdf\"", i + 1) } else { String::new() };
                (format!("f{i}.sdf"), format!("{next} fn f{i}() = {i}"))
            })
            .collect()
    };
    let text = "import \"f0.sdf\" scene { sphere(f0() + 1) }";
    let files = chain(64);
    let files: Vec<(&str, &str)> = files.iter().map(|(a, b)| (&**a, &**b)).collect();
    assert_eq!(value(text, &files), 1.0);
    let files = chain(65);
    let files: Vec<(&str, &str)> = files.iter().map(|(a, b)| (&**a, &**b)).collect();
    says(text, &files, &["E009: files import each other more than 64 deep"]);

    let many: Vec<(String, String)> = (0..1025).map(|i| (format!("f{i}.sdf"), String::new())).collect();
    let files: Vec<(&str, &str)> = many.iter().map(|(a, b)| (&**a, &**b)).collect();
    let imports: String = files.iter().map(|(name, _)| format!("import \"{name}\"\n")).collect();
    let scene = "scene { sphere(1) }";
    says(&format!("{imports}{scene}"), &files, &["E009: the scene imports more than 1024 files"]);
    let imports = imports.replace("import \"f1024.sdf\"\n", "");
    says(&format!("{imports}{scene}"), &files, &[]);

    let large = "a".repeat(FILE_LIMIT + 1);
    says(
        "import \"a.sdf\" scene { sphere(1) }",
        &[("a.sdf", &large)],
        &["E009: the file has more than 8388608 bytes"],
    );
}

/// Mistakes in all files, each with its own place, once, however often a file is used.
#[test]
fn mistakes_stand_in_their_files() {
    let files = [
        ("a.sdf", "fn f(a: float) = sphere(a).att(1)\n/// Unused.\nlet bad = 1 / 0"),
        ("b.sdf", "import \"a.sdf\" let c = ]"),
    ];
    let text = "import \"a.sdf\" import \"b.sdf\"\nscene { f(1), f(1), f((1, 2)) }";
    let found = compile_with(text, &files, &[]);
    let places: Vec<(String, (usize, usize))> = found
        .diagnostics
        .iter()
        .map(|d| {
            let name = found.sources.get(d.span.file).unwrap().name.clone();
            (name, found.sources.line_column(d.span.file, d.span.start))
        })
        .collect();
    let expected = [("scene.sdf", (2, 21)), ("a.sdf", (1, 28)), ("a.sdf", (3, 11)), ("b.sdf", (1, 24))];
    assert_eq!(places, expected.map(|(name, place)| (name.to_string(), place)));
}

#[test]
fn without_a_folder_nothing_is_imported() {
    let options = sdf_lang::Options::default();
    let found = sdf_lang::compile("scene", "import \"a.sdf\" scene { sphere(1) }", &options);
    assert!(found.scene.is_none());
    assert_eq!(found.diagnostics.len(), 1);
    assert!(found.diagnostics[0].message.contains("not compiled from a folder"));
}
