//! Scenes that import files: which folders the command reads from.

use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// A folder with files in it, their folders made.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, content) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }
    folder
}

/// What `sdfc check` returns and says, run in a folder.
fn check(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut run = Command::new(env!("CARGO_BIN_EXE_sdfc"));
    let output = run.arg("check").args(arguments).current_dir(folder).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[track_caller]
fn passes(folder: &Path, arguments: &[&str]) {
    assert_eq!(check(folder, arguments), (Some(0), "1 scene checked: nothing is wrong\n".to_string()));
}

#[track_caller]
fn refuses(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    let (found, said) = check(folder, arguments);
    assert_eq!(found, Some(code), "{said}");
    for word in words {
        assert!(said.contains(word), "`{word}` in {said}");
    }
}

const BALL: &str = "fn ball(r) = sphere(r)\n";

fn scene(path: &str) -> String {
    format!("import \"{path}\"\nscene {{ ball(1) }}\n")
}

#[test]
fn paths_are_relative_to_the_importing_file() {
    let folder = folder(&[
        ("scene.sdf", &scene("lib/a.sdf")),
        ("lib/a.sdf", "import \"../b.sdf\" import \"deep/c.sdf\" fn ball(r) = b(r) | c(r)"),
        ("b.sdf", "fn b(r) = sphere(r)"),
        ("lib/deep/c.sdf", "import \"../../b.sdf\" fn c(r) = b(2 * r)"),
    ]);
    passes(folder.path(), &["scene.sdf"]);
    passes(&folder.path().join("lib"), &["../scene.sdf"]);
    let absolute = folder.path().join("scene.sdf");
    passes(Path::new("/"), &[absolute.to_str().unwrap()]);
}

#[test]
fn messages_name_the_file_as_the_caller_would() {
    let folder = folder(&[
        ("in/scene.sdf", &scene("lib/a.sdf")),
        ("in/lib/a.sdf", "fn ball(r) = spere(r)\n"),
        ("in/lib/circle.sdf", "import \"../lib/circle.sdf\""),
    ]);
    refuses(folder.path(), &["in/scene.sdf"], 1, &["in/lib/a.sdf:1:14", "fn ball(r) = spere(r)", "`sphere`"]);
    let circle = ["in/lib/circle.sdf → in/lib/circle.sdf"];
    refuses(folder.path(), &["in/lib/circle.sdf"], 1, &circle);
}

#[test]
fn nothing_outside_of_the_scenes_folder_is_read() {
    let folder = folder(&[
        ("in/scene.sdf", &scene("../out/a.sdf")),
        ("in/absent.sdf", &scene("../out/absent.sdf")),
        ("in/over.sdf", &scene("../in/../out/a.sdf")),
        ("in/lib/link.sdf", &scene("linked.sdf")),
        ("in/folder.sdf", &scene("lib")),
        ("in/missing.sdf", &scene("lib/missing.sdf")),
        ("out/a.sdf", BALL),
    ]);
    let here = folder.path().join("in");
    let absolute = folder.path().join("in/lib/link.sdf");
    fs::write(here.join("absolute.sdf"), scene(absolute.to_str().unwrap())).unwrap();
    let outside = ["E024", "it is not in the scene's folder", "--include"];
    refuses(&here, &["scene.sdf"], 1, &outside);
    refuses(&here, &["over.sdf"], 1, &outside);
    // Whether a file is there is not told.
    refuses(&here, &["absent.sdf"], 1, &outside);
    refuses(&here, &["absolute.sdf"], 1, &["E024", "the path is absolute", "relative"]);
    refuses(&here, &["folder.sdf"], 1, &["E024", "it is a folder"]);
    refuses(&here, &["missing.sdf"], 1, &["E024", "there is no such file"]);

    passes(&here, &["scene.sdf", "--include", "../out"]);
    passes(folder.path(), &["in/scene.sdf", "--include", "out"]);
    passes(folder.path(), &["in/scene.sdf", "--include", "in/lib", "--include", "."]);
    refuses(&here, &["scene.sdf", "--include", "lib"], 1, &outside);
    refuses(&here, &["scene.sdf", "--include", "nowhere"], 2, &["cannot import from nowhere"]);
    refuses(&here, &["scene.sdf", "--include", "scene.sdf"], 2, &["cannot import from", "directory"]);
}

#[cfg(unix)]
#[test]
fn links_do_not_lead_outside() {
    use std::os::unix::fs::symlink;
    let folder =
        folder(&[("in/file.sdf", &scene("file_link.sdf")), ("in/dir.sdf", &scene("dir_link/a.sdf"))]);
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/a.sdf"), BALL).unwrap();
    symlink("../out/a.sdf", folder.path().join("in/file_link.sdf")).unwrap();
    symlink("../out", folder.path().join("in/dir_link")).unwrap();
    let here = folder.path().join("in");
    for scene in ["file.sdf", "dir.sdf"] {
        refuses(&here, &[scene], 1, &["E024", "it is not in the scene's folder"]);
        passes(&here, &[scene, "--include", "../out"]);
    }
    // A link within the folder is the file that it leads to.
    let twice = "import \"file_link.sdf\" import \"other_link.sdf\" scene { ball(1) }";
    fs::write(here.join("twice.sdf"), twice).unwrap();
    symlink("file_link.sdf", here.join("other_link.sdf")).unwrap();
    passes(&here, &["twice.sdf", "--include", "../out"]);
}

#[cfg(unix)]
#[test]
fn what_is_no_plain_file_is_not_opened() {
    let folder = folder(&[("scene.sdf", &scene("pipe.sdf"))]);
    let made = Command::new("mkfifo").arg(folder.path().join("pipe.sdf")).status().unwrap();
    assert!(made.success());
    refuses(folder.path(), &["scene.sdf"], 1, &["E024", "it is no plain file"]);
}

#[test]
fn a_scene_from_standard_input_imports_from_where_the_command_runs() {
    let folder =
        folder(&[("lib/a.sdf", BALL), ("input", &scene("lib/a.sdf")), ("wrong", &scene("../a.sdf"))]);
    for (input, code) in [("input", 0), ("wrong", 1)] {
        let mut run = Command::new(env!("CARGO_BIN_EXE_sdfc"));
        run.args(["check", "-"]).stdin(fs::File::open(folder.path().join(input)).unwrap());
        let output = run.current_dir(folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn an_imported_file_that_is_no_text_is_told() {
    let folder = folder(&[("scene.sdf", &scene("a.sdf"))]);
    fs::write(folder.path().join("a.sdf"), b"let a = \xff").unwrap();
    refuses(folder.path(), &["scene.sdf"], 1, &["E001", "a.sdf", "byte 8"]);
}

/// A file that has no scene of its own is right if all that it has is for others; the same file cannot be drawn.
#[test]
fn a_file_for_import_can_be_checked() {
    let folder = folder(&[
        ("lib.sdf", "fn ball(r) = sphere(r)\nparam k = 1 in 0..2\nmaterial m { color: 1 }\n"),
        ("wrong.sdf", "fn ball(r) = spere(r)\n"),
        ("empty.sdf", "// nothing\n"),
        ("half.sdf", "camera { fov: 1 }\nfn ball(r) = sphere(r)\n"),
    ]);
    let (code, said) = check(folder.path(), &["lib.sdf"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("note: lib.sdf has no scene") && said.contains("nothing is wrong"), "{said}");
    refuses(
        folder.path(),
        &["wrong.sdf"],
        1,
        &["E020", "did you mean `sphere`?", "1 scene checked: 1 error"],
    );
    for name in ["empty.sdf", "half.sdf"] {
        refuses(folder.path(), &[name], 1, &["E060", "imported by others"]);
    }
    let mut run = Command::new(env!("CARGO_BIN_EXE_sdfc"));
    let output = run.args(["lib.sdf", "--target", "wgsl"]).current_dir(folder.path()).output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
}

/// Names that the command takes have suggestions like those of the language.
#[test]
fn mistyped_names_have_suggestions() {
    let folder = folder(&[
        ("scene.sdf", "scene { sphere(1) }"),
        ("uses.sdf", &scene("libary.sdf")),
        ("library.sdf", BALL),
    ]);
    let rows = [
        ("scene.sdf -o a.glls", "did you mean .glsl?"),
        ("scene.sdf -o a.wgls", "did you mean .wgsl?"),
        ("scene.sdf --target wgls", "a similar value exists: 'wgsl'"),
        ("scene.sdf --emit tokns", "a similar value exists: 'tokens'"),
        ("rendr scene.sdf -o a.png", "did you mean `render`?"),
        ("chekc scene.sdf", "did you mean `check`?"),
        ("render scene.sdf -o a.png --devise cpu", "a similar argument exists: '--device'"),
        ("check scne.sdf", "did you mean scene.sdf?"),
        ("check uses.sdf", "did you mean `library.sdf`?"),
        ("check scene.sdf --set k=1", "this file has no params"),
    ];
    for (arguments, expected) in rows {
        let mut run = Command::new(env!("CARGO_BIN_EXE_sdfc"));
        let output = run.args(arguments.split(' ')).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(1 | 2)), "{arguments}: {said}");
        assert!(said.contains(expected), "{arguments}: {said}");
    }
}
