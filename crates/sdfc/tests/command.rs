//! The command as its users meet it: what it prints, writes and returns.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const SCENE: &str = "param spin = 1 in 0..4\nscene { sphere(0.5).at(spin, 0.2, 0), box(0.4) }\n";

/// A folder with some files in it.
struct Folder(TempDir);

/// What a run of the command came to.
struct Run {
    code: Option<i32>,
    out: Vec<u8>,
    err: String,
}

impl Folder {
    fn new(files: &[(&str, &[u8])]) -> Folder {
        let folder = TempDir::new().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        Folder(folder)
    }

    fn with_scene() -> Folder {
        Folder::new(&[("scene.sdf", SCENE.as_bytes())])
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of all files.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// `sdfc` in the folder, without arguments.
    fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sdfc"));
        command.current_dir(self.0.path()).env_remove("RUST_BACKTRACE");
        command
    }

    /// Runs `sdfc` in the folder; the arguments are words.
    fn run(&self, arguments: &str) -> Run {
        self.run_with(arguments, b"")
    }

    /// [`Folder::run`] with this on standard input.
    fn run_with(&self, arguments: &str, input: &[u8]) -> Run {
        let mut child = self
            .command()
            .args(arguments.split_whitespace())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // A command that does not read its input closes it.
        let _ = child.stdin.take().unwrap().write_all(input);
        let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
        Run { code: status.code(), out: stdout, err: String::from_utf8(stderr).unwrap() }
    }
}

impl Run {
    /// It went well, and said nothing.
    #[track_caller]
    fn succeeds(self) -> Run {
        assert_eq!((self.code, self.err.as_str()), (Some(0), ""));
        self
    }

    /// It failed with this code, said each of these words in this order, and printed nothing.
    #[track_caller]
    fn fails(self, code: i32, words: &[&str]) -> Run {
        assert_eq!(self.code, Some(code), "{}", self.err);
        let mut rest = self.err.as_str();
        for word in words {
            let at = rest.find(word).unwrap_or_else(|| panic!("no {word:?} in {}", self.err));
            rest = &rest[at + word.len()..];
        }
        assert!(self.err.len() < 50_000, "{} bytes of messages", self.err.len());
        assert!(self.out.is_empty());
        self
    }

    fn text(&self) -> &str {
        std::str::from_utf8(&self.out).unwrap()
    }
}

/// A scene with this text is refused with this code and these words, and nothing is written.
#[track_caller]
fn refused(scene: &[u8], code: i32, words: &[&str]) {
    let folder = Folder::new(&[("scene.sdf", scene)]);
    folder.run("scene.sdf -o out.wgsl").fails(code, words);
    folder.run("render scene.sdf -o out.png --device cpu --size 4x4").fails(code, words);
    folder.run("check scene.sdf").fails(code, words);
    assert_eq!(folder.names(), ["scene.sdf"]);
}

/// A call is refused with these words, and nothing is written.
#[track_caller]
fn refused_call(arguments: &str, words: &[&str]) {
    let folder = Folder::with_scene();
    folder.run(arguments).fails(2, words);
    assert_eq!(folder.names(), ["scene.sdf"]);
}

#[test]
fn an_empty_file_has_no_scene() {
    refused(b"", 1, &["[E060] error: there is no scene", "in scene.sdf", "help", "scene { sphere(1) }"]);
    refused(b"// nothing\n", 1, &["[E060] error: there is no scene"]);
    refused(b"\xef\xbb\xbf", 1, &["[E060] error: there is no scene"]);
}

#[test]
fn binary_junk_is_no_text() {
    let junk: Vec<u8> = (0..4096_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    refused(&junk, 1, &["[E001] error: the file is not UTF-8: byte", "in scene.sdf", "save it as UTF-8"]);
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let folder = Folder::new(&[("scene.sdf", b"scene { \x1b[31msphere(1) \xc2\x9b \xe2\x80\xae }\r\n")]);
    let run = folder.run("check scene.sdf").fails(1, &["[E002]"]);
    assert!(!run.err.contains(|c: char| c.is_control() && c != '\n'), "{:?}", run.err);
    assert!(!run.err.contains('\u{202e}'), "{:?}", run.err);
}

#[test]
fn a_million_brackets_nest_too_deeply() {
    refused("(".repeat(1_000_000).as_bytes(), 1, &["[E009] error: nested more than 256 deep", "1:257"]);
    refused("}".repeat(1_000_000).as_bytes(), 1, &["[E006]"]);
}

#[test]
fn a_token_of_a_megabyte_is_too_long() {
    for letter in ["x", "1", "#", "\"", "-"] {
        let scene = format!("let a = {}\nscene {{ sphere(1) }}", letter.repeat(1 << 20));
        refused(scene.as_bytes(), 1, &["error: "]);
    }
    let word = format!("scene {{ sphere({}) }}", "x".repeat(1 << 20));
    refused(word.as_bytes(), 1, &["[E009] error: a word of 1048576 bytes", "at scene.sdf:1:16"]);
}

#[test]
fn a_number_has_32_bits() {
    refused(
        b"scene { sphere(1e999) }",
        1,
        &["[E003] error: the number is too large", "1:16", "1e999", "3.4e38"],
    );
    refused(b"let a = 1e30 * 1e30 scene { sphere(a) }", 1, &["[E041]"]);
}

#[test]
fn a_file_has_a_limit() {
    let large = vec![b' '; (8 << 20) + 1];
    refused(&large, 1, &["[E009] error: the file has more than 8388608 bytes"]);
}

#[test]
fn a_value_must_fit_its_param() {
    refused_call(
        "scene.sdf -o out.wgsl --set spin=9",
        &["[E065] error: `spin` cannot be set to `9`", "param spin = 1 in 0..4", "a number from 0 to 4"],
    );
    refused_call(
        "render scene.sdf -o out.png --set spin=fast",
        &["[E065] error: `spin` cannot be set to `fast`"],
    );
    refused_call("check scene.sdf --set spin=nan", &["[E065]", "1 error"]);
    refused_call(
        "scene.sdf -o out.wgsl --set sipn=1",
        &["[E065] error: there is no param `sipn`", "did you mean `spin`?"],
    );
    refused_call("scene.sdf -o out.wgsl --set spin", &["--set", "such as spin=3"]);
}

#[test]
fn an_output_must_be_writable() {
    refused_call(
        "scene.sdf -o no/such/out.wgsl",
        &["cannot write no/such/out.wgsl: there is no folder no/such"],
    );
    refused_call("render scene.sdf -o no/such/out.png", &["cannot write", "there is no folder no/such"]);
    refused_call("scene.sdf -o scene.sdf --target wgsl", &["cannot write scene.sdf: it is the scene itself"]);
    let folder = Folder::with_scene();
    fs::create_dir(folder.path("out.wgsl")).unwrap();
    folder.run("scene.sdf -o out.wgsl").fails(2, &["cannot write out.wgsl: it is a folder"]);
}

#[test]
fn a_file_that_is_read_only_stays() {
    let folder = Folder::with_scene();
    fs::write(folder.path("out.wgsl"), "precious").unwrap();
    let mut permissions = fs::metadata(folder.path("out.wgsl")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(folder.path("out.wgsl"), permissions).unwrap();
    folder.run("scene.sdf -o out.wgsl").fails(2, &["cannot write out.wgsl: it is read-only"]);
    assert_eq!(folder.read("out.wgsl"), b"precious");
}

#[test]
fn an_input_must_be_readable() {
    refused_call("none.sdf -o out.wgsl", &["cannot read none.sdf: no such file or directory"]);
    refused_call("render none.sdf -o out.png", &["cannot read none.sdf"]);
    refused_call("check none.sdf", &["cannot read none.sdf", "1 scene checked: 1 file not read"]);
    refused_call(". -o out.wgsl", &["cannot read .: is a directory"]);
}

#[test]
fn every_target_is_written_by_its_extension_and_printed_by_its_name() {
    let begins: [(&str, &[u8]); 7] = [
        ("glsl", b"// A scene of 2 shapes"),
        ("frag", b"#version 300 es\n"),
        ("wgsl", b"// A scene of 2 shapes"),
        ("html", b"<!doctype html>\n"),
        // The magic number and the version of SPIR-V, the lowest byte first.
        ("spv", &[0x03, 0x02, 0x23, 0x07, 0x00, 0x00, 0x01, 0x00]),
        ("metal", b"// A scene of 2 shapes"),
        ("hlsl", b"// A scene of 2 shapes"),
    ];
    for (name, begin) in begins {
        let folder = Folder::with_scene();
        folder.run(&format!("scene.sdf -o out.{name}")).succeeds();
        let file = folder.read(&format!("out.{name}"));
        assert!(file.starts_with(begin), "{name}");
        assert_eq!(folder.names(), [format!("out.{name}"), "scene.sdf".into()]);
        assert!(folder.run(&format!("scene.sdf --target {name}")).succeeds().out == file, "{name}");
    }
}

/// A page holds the text of its own program, its params, and the name of the scene's file as a text; it asks for
/// nothing from elsewhere.
#[test]
fn a_page_is_one_file() {
    let folder = Folder::new(&[("a<b>&'c\".d.sdf", SCENE.as_bytes())]);
    folder.run("a<b>&'c\".d.sdf -o out.html").succeeds();
    let page = String::from_utf8(folder.read("out.html")).unwrap();
    assert!(page.contains("<title>a&lt;b&gt;&amp;&#39;c&quot;.d</title>"), "{page}");
    let param = r#"{"name": "spin", "uniform": "u_spin", "kind": "float", "low": 0, "high": 4, "value": 1}"#;
    assert!(page.contains(param), "{page}");
    for word in ["http:", "https:", "//cdn", "src=", "@import", "url("] {
        assert!(!page.contains(word), "the page has {word}");
    }
    let program = page.split_once("x-shader/x-fragment\">").unwrap().1.split_once("</script>").unwrap().0;
    assert!(program.starts_with("#version 300 es\n") && program.contains("uniform vec3 u_orbit;"));
    // A param that is frozen has no slider.
    folder.run("a<b>&'c\".d.sdf -o out.html --set spin=2").succeeds();
    let page = String::from_utf8(folder.read("out.html")).unwrap();
    assert!(!page.contains("u_spin") && page.contains("\"list\": [\n\n]"), "{page}");
}

#[test]
fn the_target_must_be_known() {
    refused_call("scene.sdf -o out.txt", &["no target is called .txt", "--target"]);
    refused_call("scene.sdf -o out", &["out has no extension to tell the target by", "--target"]);
    refused_call(
        "scene.sdf -o out.png",
        &["a picture is drawn by `sdfc render`", "sdfc render scene.sdf -o out.png"],
    );
    refused_call("scene.sdf -o -", &["standard output does not tell which target", "--target"]);
    refused_call("scene.sdf", &["there is nothing to write", "-o scene.wgsl", "--target glsl"]);
    refused_call(
        "scene.sdf -o out.wgsl --target dxil",
        &["--target", "glsl, frag, wgsl, html, spv, metal, hlsl"],
    );
    refused_call(
        "render scene.sdf -o out.wgsl",
        &["out.wgsl is not the name of a .png file", "without `render`"],
    );
    refused_call("render scene.sdf -o out.gif", &["out.gif is not the name of a .png file", "-o scene.png"]);
}

#[test]
fn a_call_must_make_sense() {
    refused_call("", &["Usage"]);
    refused_call("--view depth", &["--view"]);
    refused_call("render scene.sdf", &["--output"]);
    refused_call("scene.sdf render scene.sdf -o out.png", &["stands behind it"]);
    for size in ["0x4", "4x", "4", "20000x4", "16384x16384", "-4x4"] {
        refused_call(&format!("render scene.sdf -o out.png --size={size}"), &["--size"]);
    }
    for time in ["-1", "nan", "inf", "later"] {
        refused_call(&format!("render scene.sdf -o out.png --time={time}"), &["--time"]);
    }
    refused_call("scene.sdf --target wgsl --emit ir", &["cannot both go to standard output"]);
    refused_call("scene.sdf --emit soup", &["soup", "tokens, ast, facts, ir, total, cost"]);
}

#[test]
fn help_and_version_are_asked_for() {
    let folder = Folder::new(&[]);
    assert!(folder.run("--help").succeeds().text().contains("Usage: sdfc"));
    assert_eq!(folder.run("--version").succeeds().text(), format!("sdfc {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn each_target_is_written() {
    let folder = Folder::with_scene();
    for (name, part) in
        [("a.glsl", "void mainImage("), ("a.frag", "#version 300 es"), ("a.wgsl", "fn fs_main(")]
    {
        let run = folder.run(&format!("scene.sdf -o {name}")).succeeds();
        assert!(run.out.is_empty());
        let text = String::from_utf8(folder.read(name)).unwrap();
        assert!(text.contains(part), "{text}");
        assert!(text.contains("A scene of 2 shapes, compiled by sdfc"), "{text}");
    }
    folder.run("scene.sdf -o A.WGSL").succeeds();
    assert_eq!(folder.read("A.WGSL"), folder.read("a.wgsl"));
    folder.run("scene.sdf -o a.txt --target frag").succeeds();
    assert_eq!(folder.read("a.txt"), folder.read("a.frag"));
    assert_eq!(folder.names(), ["A.WGSL", "a.frag", "a.glsl", "a.txt", "a.wgsl", "scene.sdf"]);
}

#[test]
fn a_dash_is_standard_input_and_output() {
    let folder = Folder::with_scene();
    folder.run("scene.sdf -o a.glsl").succeeds();
    let file = folder.read("a.glsl");
    assert_eq!(folder.run("scene.sdf --target glsl").succeeds().out, file);
    assert_eq!(folder.run("scene.sdf -o - --target glsl").succeeds().out, file);
    assert_eq!(folder.run_with("- --target glsl", SCENE.as_bytes()).succeeds().out, file);
    let picture = "--device cpu --size 8x8 -o";
    folder.run(&format!("render scene.sdf {picture} a.png")).succeeds();
    assert_eq!(
        folder.run_with(&format!("render - {picture} -"), SCENE.as_bytes()).succeeds().out,
        folder.read("a.png")
    );
    folder.run_with("- -o b.wgsl", b"scene { nowhere }").fails(1, &["<stdin>:1:9"]);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let folder = Folder::with_scene();
    for arguments in [
        "scene.sdf --target wgsl",
        "scene.sdf --target glsl",
        "scene.sdf --target frag",
        "scene.sdf --emit tokens,ast,ir,total,cost",
        "render scene.sdf -o - --device cpu --size 16x9",
    ] {
        let first = folder.run(arguments).succeeds().out;
        assert!(!first.is_empty());
        assert_eq!(folder.run(arguments).succeeds().out, first, "{arguments}");
    }
}

#[test]
fn a_param_that_is_set_is_a_constant() {
    let folder = Folder::with_scene();
    let free = folder.run("scene.sdf --target frag").succeeds();
    assert!(free.text().contains("u_spin"), "{}", free.text());
    let frozen = folder.run("scene.sdf --target frag --set spin=0.5").succeeds();
    assert!(!frozen.text().contains("spin"), "{}", frozen.text());
    let last = folder.run("scene.sdf --target frag --set spin=3 --set spin=0.5").succeeds();
    assert_eq!(last.out, frozen.out);
}

#[test]
fn stages_are_printed() {
    let folder = Folder::with_scene();
    let print =
        |stages: &str| folder.run(&format!("scene.sdf --emit {stages}")).succeeds().text().to_string();
    assert!(print("tokens").starts_with("0..5         param\n"), "{}", print("tokens"));
    assert!(print("ast").starts_with("(param spin 1 0 4)\n"), "{}", print("ast"));
    assert!(print("ir").starts_with("uniform u0 "), "{}", print("ir"));
    assert!(print("ir").contains("fn pixel(coordinate: vec2) -> "), "{}", print("ir"));
    assert!(print("total").contains("fn pixel(coordinate: vec2) -> "), "{}", print("total"));
    assert_ne!(print("ir"), print("total"));
    assert!(print("cost").starts_with("operations of one evaluation of the distance"), "{}", print("cost"));
    assert_eq!(print("tokens,cost"), format!("== tokens\n{}== cost\n{}", print("tokens"), print("cost")));
    assert_eq!(folder.names(), ["scene.sdf"]);
    let both = folder.run("scene.sdf --emit cost -o a.wgsl").succeeds();
    assert_eq!(both.text(), print("cost"));
    assert!(!folder.read("a.wgsl").is_empty());
}

#[test]
fn the_stages_before_a_mistake_are_printed() {
    let folder = Folder::new(&[("scene.sdf", b"scene { spheer(1) }")]);
    let run = folder.run("scene.sdf --emit ast,ir -o a.wgsl");
    assert_eq!((run.code, run.text()), (Some(1), "(scene (of spheer (call 1)))\n"));
    assert!(run.err.contains("did you mean `sphere`?"), "{}", run.err);
    assert_eq!(folder.names(), ["scene.sdf"]);
}

/// A picture from its file, and the texts in it.
fn decode(file: &[u8]) -> (u32, u32, Vec<u8>, Vec<(String, String)>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut rgba).unwrap();
    let info = reader.info();
    let texts = info.utf8_text.iter().map(|t| (t.keyword.clone(), t.get_text().unwrap())).collect();
    (info.width, info.height, rgba, texts)
}

#[test]
fn a_picture_is_drawn_on_the_cpu() {
    let folder = Folder::with_scene();
    let run =
        folder.run("render scene.sdf -o a.png --device cpu --size 32x18 --time 2 --set spin=0.5").succeeds();
    assert!(run.out.is_empty());
    let (width, height, rgba, texts) = decode(&folder.read("a.png"));
    assert_eq!((width, height, rgba.len()), (32, 18, 4 * 32 * 18));
    let colors: std::collections::BTreeSet<&[u8]> = rgba.chunks(4).collect();
    assert!(colors.len() > 10, "{} colours", colors.len());
    assert!(rgba.chunks(4).all(|pixel| pixel[3] == 255));
    let text = |keyword: &str| texts.iter().find(|(k, _)| k == keyword).map(|(_, text)| text.as_str());
    assert_eq!(text("Source"), Some(SCENE));
    assert_eq!(text("Settings"), Some("--size 32x18 --time 2 --set spin=0.5"));
    assert_eq!(text("Software"), Some(concat!("sdfc ", env!("CARGO_PKG_VERSION"))));
}

/// The preset stands for that of the file, and not for what the file sets besides; it is told where the picture and the text say
/// how they were made.
#[test]
fn a_preset_is_given_from_outside() {
    let scene = "render { quality: exact, steps: 77 } scene { sphere(0.5) }";
    let folder = Folder::new(&[("scene.sdf", scene.as_bytes())]);
    let head = |call: &str| {
        let run = folder.run(call).succeeds();
        run.text().lines().find(|line| line.contains("Settings: ")).expect("a line of settings").to_string()
    };
    let fine = head("scene.sdf --target wgsl --quality fine");
    assert!(fine.contains("Settings: quality fine, ") && fine.contains("steps 77, far 100"), "{fine}");
    let own = head("scene.sdf --target wgsl");
    assert!(own.contains("Settings: quality exact, ") && own != fine, "{own}");
    folder.run("render scene.sdf -o a.png --device cpu --size 8x4 --quality draft").succeeds();
    let (.., texts) = decode(&folder.read("a.png"));
    let settings = texts.iter().find(|(keyword, _)| keyword == "Settings").map(|(_, text)| text.as_str());
    assert_eq!(settings, Some("--size 8x4 --time 0 --quality draft"));
    folder
        .run("scene.sdf --target wgsl --quality finest")
        .fails(2, &["finest", "draft, balanced, fine, exact"]);
}

/// Rays that run out of steps are told, with the place that sets them, whatever is drawn; where warnings are denied,
/// nothing is written.
#[test]
fn rays_that_run_out_of_steps_are_told() {
    let folder = Folder::new(&[
        ("short.sdf", b"render { steps: 6 }\nscene { box(0.5).twist(2), plane().at(0, -1, 0) }"),
        ("scene.sdf", SCENE.as_bytes()),
    ]);
    for view in ["", "--view steps", "--view depth"] {
        let call =
            format!("render short.sdf -o a.png --device cpu --size 32x18 --message-format short {view}");
        let run = folder.run(&call);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert!(run.err.starts_with("short.sdf:1:17: warning[W005]: "), "{}", run.err);
        assert!(run.err.contains(" of 576 rays ran out of steps (") && run.err.contains("--view steps"));
    }
    let call = "render short.sdf -o b.png --device cpu --size 32x18 --deny warnings";
    folder.run(call).fails(1, &["W005", "there are warnings"]);
    assert_eq!(folder.names(), ["a.png", "scene.sdf", "short.sdf"]);
    folder.run("render scene.sdf -o b.png --device cpu --size 32x18").succeeds();
}

#[test]
fn a_time_below_0_is_refused_as_what_it_is() {
    let folder = Folder::with_scene();
    for call in [
        "render scene.sdf -o a.png --time -3",
        "query scene.sdf 0,0,0 --time -0.5",
        "render scene.sdf -o a.png --time=nan",
    ] {
        folder.run(call).fails(2, &["the time is a finite number of seconds, at least 0"]);
    }
}

#[test]
fn a_promise_is_tried_at_a_late_time() {
    let late = b"@lipschitz(1) @bounds((-1, -1, -1), (1, 1, 1))
        let ball = field { (length(p) - 1) * if time > 3500 { 8 } else { 1 } }
        scene { ball }";
    let folder = Folder::new(&[("late.sdf", late)]);
    let run = folder.run("check late.sdf");
    assert!(run.code == Some(1) && run.err.contains("E053"), "{}", run.err);
}

#[test]
fn a_scene_beyond_far_is_told_once() {
    let folder = Folder::new(&[("big.sdf", b"camera { eye: (0, 0, 3000) } scene { sphere(1000) }")]);
    for call in [
        "render big.sdf -o a.png --device cpu --size 8x4",
        "check big.sdf",
        "check --certify --size 8x4 big.sdf",
    ] {
        let run = folder.run(&format!("{call} --message-format short"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let warned = run.err.lines().filter(|line| line.starts_with("big.sdf:1:30: warning[W007]: ")).count();
        assert!(warned == 1 && run.err.contains("`render { far: … }`"), "{call}: {}", run.err);
    }
}

#[test]
fn views_are_drawn_with_a_legend() {
    let folder = Folder::with_scene();
    let legends = [
        ("depth", "white is near, black is far, dark blue is nothing; the nearest is at "),
        ("normal", "red, green and blue are x, y and z"),
        ("steps", "violet is no step"),
        ("error", "violet is 1/1000 of the tolerance"),
        ("material", "the surfaces' colours without light"),
    ];
    let mut pictures = std::collections::BTreeSet::new();
    for (view, legend) in legends {
        let run =
            folder.run(&format!("render scene.sdf -o {view}.png --device cpu --size 32x18 --view {view}"));
        assert_eq!((run.code, run.out.as_slice()), (Some(0), &b""[..]));
        assert!(
            run.err.starts_with(&format!("note: {legend}")) && run.err.lines().count() == 1,
            "{}",
            run.err
        );
        let (_, _, rgba, texts) = decode(&folder.read(&format!("{view}.png")));
        assert!(pictures.insert(rgba), "{view} is another view's picture");
        assert!(texts.iter().any(|(_, text)| *text == format!("--size 32x18 --time 0 --view {view}")));
    }
    refused_call("render scene.sdf -o a.png --view heat", &["heat", "depth, normal, steps, error, material"]);
    refused_call("scene.sdf -o a.wgsl --view steps", &["--view"]);
}

#[test]
fn any_machine_draws_a_picture() {
    let folder = Folder::with_scene();
    let run = folder.run("render scene.sdf -o a.png --size 16x9");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.err.is_empty() || run.err.starts_with("note: drawn on the CPU: "), "{}", run.err);
    assert!(run.err.lines().count() <= 1, "{}", run.err);
    assert_eq!(decode(&folder.read("a.png")).0, 16);
}

/// A second Vulkan driver, which Debian's Chromium carries; Vulkan's loader takes what the environment names.
#[test]
fn a_device_is_taken_by_its_name() {
    const DRIVER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";
    let driver = std::env::var("SWIFTSHADER_ICD").unwrap_or_else(|_| DRIVER.into());
    assert!(
        Path::new(&driver).is_file(),
        "this test needs SwiftShader (Debian: chromium): there is no {driver}"
    );
    let folder = Folder::with_scene();
    let draw = |device: &str| {
        let mut command = folder.command();
        command.args(["render", "scene.sdf", "-o", "-", "--size", "32x18", "--timings", "--device", device]);
        command.env("VK_DRIVER_FILES", &driver).env("VK_ICD_FILENAMES", &driver);
        let Output { status, stdout, stderr } = command.output().unwrap();
        let said = String::from_utf8(stderr).unwrap();
        assert_eq!(status.code(), Some(0), "{said}");
        (stdout, said)
    };
    let (expected, _) = draw("cpu");
    let (found, said) = draw("swiftshader");
    assert!(said.contains("drawn by SwiftShader"), "{said}");
    assert_eq!(found, expected);
}

#[test]
fn a_device_that_is_not_there_is_an_error() {
    let folder = Folder::with_scene();
    folder.run("render scene.sdf -o a.png --device no-such-device").fails(3, &["error: ", "--device cpu"]);
    assert_eq!(folder.names(), ["scene.sdf"]);
}

#[test]
fn scenes_are_checked_together() {
    let folder = Folder::new(&[
        ("good.sdf", b"scene { sphere(1) }"),
        ("bad.sdf", b"scene { spheer(1), cube(1) }"),
        ("param.sdf", b"param spin = 1 in 0..4 scene { sphere(spin) }"),
    ]);
    let good = folder.run("check good.sdf");
    assert_eq!((good.code, good.err.as_str()), (Some(0), "1 scene checked: nothing is wrong\n"));
    folder.run("check good.sdf bad.sdf").fails(1, &["spheer", "cube", "2 scenes checked: 2 errors"]);
    folder.run("check bad.sdf none.sdf good.sdf").fails(2, &["3 scenes checked: 2 errors, 1 file not read"]);
    folder.run("check param.sdf bad.sdf --set spin=9").fails(2, &["2 scenes checked: "]);
}

/// A promise that is false from half a minute on, later than promises are tried.
const LATE_LIE: &[u8] = b"
@lipschitz(1) @bounds((-1, -1, -1), (1, 1, 1))
let ball = field { (length(p) - 1) * if time > 30 && time < 3000 { 8 } else { 1 } }
scene { ball }";

#[test]
fn certified_scenes_have_a_row_for_each_moment() {
    let folder = Folder::new(&[
        ("good.sdf", b"param high = 0.5 in 0..1 scene { plane().at(0, high, 0) } camera { eye: (0, 5, 1) }"),
        ("late.sdf", LATE_LIE),
    ]);
    let good = folder.run("check --certify --size 6x4 good.sdf");
    assert_eq!((good.code, good.err.as_str()), (Some(0), "1 scene checked: nothing is wrong\n"));
    let table = String::from_utf8(good.out).unwrap();
    let rows: Vec<(&str, bool)> = table
        .lines()
        .map(|line| (line.split("  ").find(|cell| !cell.is_empty()).unwrap_or(""), line.contains(" 24/24 ")))
        .collect();
    let moments = ["as it is", "high = 0", "high = 0.17", "high = 0.83", "high = 1"];
    assert_eq!(rows[0], ("good.sdf", false), "{table}");
    assert_eq!(rows[1..], moments.map(|name| (name, true)), "{table}");

    let late = folder.run("check --certify --size 6x4 late.sdf");
    assert_eq!(late.code, Some(1));
    for words in
        ["late.sdf with time = 31: ", " unsafe steps at (0, 0)", "late.sdf with time = 1000: ", "1 error"]
    {
        assert!(late.err.contains(words), "{}", late.err);
    }
    let table = String::from_utf8(late.out).unwrap();
    assert!(table.lines().any(|line| line.starts_with("  time = 1000 ")), "{table}");
}

/// The eye stands on a surface: no number tells whether a ray begins inside or outside.
const ON_SURFACE: &[u8] = b"camera { eye: (0, 1, 0), target: (0, 1, -1) }\nscene { sphere(1) }";

#[test]
fn what_cannot_be_proved_is_told_in_all_formats() {
    let folder = Folder::new(&[
        ("on.sdf", ON_SURFACE),
        // One ray in many touches the ball.
        ("good.sdf", b"camera { eye: (0, 0, 5) } scene { sphere(1) }"),
        ("short.sdf", b"render { steps: 3 } scene { torus(1, 0.2) }"),
    ]);
    let check = |file: &str, format: &str| {
        folder.run(&format!("check --certify --size 16x9 {file} --message-format {format}"))
    };
    let human = check("on.sdf", "human");
    assert_eq!(human.code, Some(0), "{}", human.err);
    for words in ["[W006] warning", "144 of 144 pixels", "(100.00 %)", "(0, 0) (1, 0)", "Help: move the eye"]
    {
        assert!(human.err.contains(words), "{words}: {}", human.err);
    }
    assert!(human.err.contains("1 scene checked: 1 warning\n"), "{}", human.err);
    let short = check("on.sdf", "short").err;
    assert!(short.starts_with("on.sdf:2:1: warning[W006]: what 144 of 144 pixels show"), "{short}");
    let json: serde_json::Value = serde_json::from_str(&check("on.sdf", "json").err).unwrap();
    assert_eq!((&json["severity"], &json["code"]), (&"warning".into(), &"W006".into()));
    let denied = folder.run("check --certify --size 16x9 on.sdf --deny warnings");
    assert!(denied.code == Some(1) && denied.err.contains("there are warnings"), "{}", denied.err);

    assert_eq!(check("good.sdf", "human").err, "1 scene checked: nothing is wrong\n");
    let lost = check("short.sdf", "short");
    assert!(lost.code == Some(0) && lost.err.contains("short.sdf:1:17: warning[W005]: "), "{}", lost.err);
}

#[test]
fn certificates_are_for_programs_too() {
    let folder = Folder::new(&[("late.sdf", LATE_LIE)]);
    let run = folder.run("check --certify --size 6x4 late.sdf --message-format json");
    assert_eq!(run.code, Some(1));
    let lines: Vec<serde_json::Value> =
        String::from_utf8(run.out).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 8);
    for line in &lines {
        assert_eq!((&line["scene"], &line["pixels"]), (&"late.sdf".into(), &24.into()));
        let is_late = ["time = 31", "time = 1000"].contains(&line["moment"].as_str().unwrap());
        assert_eq!(line["unsafe_steps"]["count"].as_u64().unwrap() > 0, is_late, "{line}");
        assert_eq!(line["least_free_share"].as_f64().unwrap() < 0.5, is_late, "{line}");
    }
    folder.run("check --size 6x4 late.sdf").fails(2, &["--certify"]);
}

#[test]
fn timings_go_to_standard_error() {
    let folder = Folder::with_scene();
    let run = folder.run("scene.sdf --target wgsl --timings");
    assert_eq!(run.code, Some(0));
    for stage in ["read", "parse and elaborate", "legalise", "write and validate", "save", "total"] {
        assert!(run.err.lines().any(|line| line.starts_with(stage) && line.ends_with(" ms")), "{}", run.err);
    }
    assert_eq!(run.out, folder.run("scene.sdf --target wgsl").succeeds().out);
}

#[test]
fn messages_are_coloured_as_asked() {
    let folder = Folder::new(&[("bad.sdf", b"scene { spheer(1) }")]);
    assert!(folder.run("check bad.sdf --color always").err.contains("\x1b["));
    assert!(folder.run("--color always check bad.sdf").err.contains("\x1b["));
    assert!(!folder.run("check bad.sdf --color never").err.contains("\x1b["));
    assert!(!folder.run("check bad.sdf").err.contains("\x1b["));
}

#[test]
fn a_scene_that_costs_too_much_is_warned_about() {
    let folder = Folder::new(&[(
        "scene.sdf",
        b"camera { eye: (0, 0, 5) }\nfn f(x) = iterate(1000, x, |i, s| s * 0.5)\nscene { field { length(p) - 1 + f(p.x) } }",
    )]);
    let run = folder.run("scene.sdf -o a.wgsl");
    assert_eq!(run.code, Some(0), "{}", run.err);
    for part in ["[W001] warning: a pixel of this scene takes up to ", "scene.sdf:3:1", "Help: lower `steps`"]
    {
        assert!(run.err.contains(part), "{}", run.err);
    }
    let text = String::from_utf8(folder.read("a.wgsl")).unwrap();
    assert!(text.contains("// Warning: drivers are likely to give up above 60000 rounds.\n"), "{text}");
}

#[cfg(unix)]
#[test]
fn an_output_is_a_file_like_any_other() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
    let folder = Folder::with_scene();
    let mode = |name: &str| fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o777;
    fs::write(folder.path("usual"), "").unwrap();
    folder.run("scene.sdf -o new.wgsl").succeeds();
    assert_eq!(mode("new.wgsl"), mode("usual"));
    // One that is there keeps its permissions, and a link stays a link.
    fs::set_permissions(folder.path("usual"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink("usual", folder.path("link.wgsl")).unwrap();
    folder.run("scene.sdf -o link.wgsl").succeeds();
    assert!(fs::symlink_metadata(folder.path("link.wgsl")).unwrap().is_symlink());
    assert_eq!((mode("usual"), folder.read("usual")), (0o640, folder.read("new.wgsl")));
    // What is no file is written as it is.
    folder.run("scene.sdf -o /dev/null --target wgsl").succeeds();
    assert_eq!(fs::metadata("/dev/null").unwrap().mode() & 0o170_000, 0o020_000);
}

#[test]
fn a_file_is_replaced_only_by_a_whole_one() {
    let folder = Folder::with_scene();
    folder.run("scene.sdf -o a.wgsl").succeeds();
    let before = folder.read("a.wgsl");
    fs::write(folder.path("scene.sdf"), "scene { spheer(1) }").unwrap();
    folder.run("scene.sdf -o a.wgsl").fails(1, &["spheer"]);
    assert_eq!(folder.read("a.wgsl"), before);
    assert!(Path::new(&folder.path("a.wgsl")).exists());
    assert_eq!(folder.names(), ["a.wgsl", "scene.sdf"]);
}

const QUERIED: &str = "param size = 1 in 0..3
scene { sphere(size).paint(material { color: #fff, shininess: 5 }), box(1).at(0, time, 10).paint(#f00) }\n";

#[test]
fn points_are_told_their_distances() {
    let folder = Folder::new(&[("scene.sdf", QUERIED.as_bytes())]);
    let line = "{\"point\":[-1,-2,-2],\"distance\":2,\"gradient\":[-0.3333333333333333,-0.6666666666666666,\
                -0.6666666666666666],\"material\":{\"color\":[1,1,1],\"specular\":0.2,\"shininess\":5,\"emission\":[0,0,0],\
                \"glow\":[0,0,0],\"glow_radius\":0.25,\"reflect\":0,\"transmit\":0,\"ior\":1.5}}\n";
    assert_eq!(folder.run("query scene.sdf -1,-2,-2 --json").succeeds().text(), line);
    assert_eq!(folder.run("query --json scene.sdf -1,-2,-2 -1,-2,-2").succeeds().text(), line.repeat(2));
    // Of the material, the colour and what the scene sets.
    let table = folder.run("query scene.sdf -.5,0,0 0,3,10 --set size=2 --time 1").succeeds();
    let rows: Vec<Vec<&str>> = table.text().lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows[0], ["point", "distance", "gradient", "color", "shininess"]);
    let [zero, one] = ["0.000000", "1.000000"];
    assert_eq!(rows[1][..4], ["-0.500000", zero, zero, "-1.500000"]);
    assert_eq!(rows[1][4..], ["-1.000000", zero, zero, one, one, one, "5.000000"]);
    assert_eq!(rows[2][..4], [zero, "3.000000", "10.000000", one]);
    assert_eq!(rows[2][4..], [zero, one, zero, one, zero, zero, "32.000000"]);
    assert_eq!(rows.len(), 3);
    let widths: Vec<usize> = table.text().lines().map(str::len).collect();
    assert!(widths.iter().all(|width| *width == widths[0]), "{}", table.text());
}

#[test]
fn points_come_from_standard_input_too() {
    let folder = Folder::new(&[("scene.sdf", QUERIED.as_bytes())]);
    let input = b"# points\r\n2,0,0\n\n  0 -3\t0 # below\n";
    let read = folder.run_with("query scene.sdf 0,0,0 - --json", input).succeeds();
    let expected = folder.run("query scene.sdf 0,0,0 2,0,0 0,-3,0 --json").succeeds();
    assert_eq!(read.text(), expected.text());
    assert_eq!(read.text().lines().count(), 3);
    assert_eq!(folder.run_with("query scene.sdf -", b"# none\n").succeeds().text(), "");
    let many: String = (0..100_000).map(|i| format!("{i},0,0\n")).collect();
    let many = folder.run_with("query scene.sdf - --json", many.as_bytes()).succeeds();
    for (i, line) in many.text().lines().enumerate() {
        assert!(line.starts_with(&format!("{{\"point\":[{i},0,0],\"distance\":")), "{line}");
    }
    assert_eq!(many.text().lines().count(), 100_000);
}

#[test]
fn wrong_queries_are_explained() {
    let folder = Folder::new(&[("scene.sdf", QUERIED.as_bytes()), ("wrong.sdf", b"scene { spere(1) }")]);
    let fails = |arguments: &str, input: &[u8], code: i32, words: &[&str]| {
        folder.run_with(arguments, input).fails(code, words);
    };
    fails("query scene.sdf", b"", 2, &["required", "<POINT>"]);
    fails("query scene.sdf 1,2", b"", 2, &["`1,2` is not a point", "help", "1,0.5,-2"]);
    fails("query scene.sdf -1,2,nan", b"", 2, &["`-1,2,nan` is not a point"]);
    fails("query scene.sdf -", b"1,2,3\n\n1,2\n", 2, &["line 3 of standard input, `1,2`, is not a point"]);
    fails("query scene.sdf -", b"1,2,\xff", 2, &["standard input", "UTF-8"]);
    fails("query - -", b"1,2,3\n", 2, &["cannot both come from standard input"]);
    fails("query scene.sdf 0,0,0 --set speed=1", b"", 2, &["no param `speed`"]);
    fails("query scene.sdf 0,0,0 --jsn", b"", 2, &["--jsn"]);
    fails("query wrong.sdf 0,0,0", b"", 1, &["spere", "did you mean `sphere`?"]);
    fails("query none.sdf 0,0,0", b"", 2, &["cannot read none.sdf"]);
}

#[test]
fn a_scene_that_is_nothing_is_infinitely_far_away() {
    let folder = Folder::new(&[("scene.sdf", b"scene { }")]);
    let run = folder.run("query scene.sdf 1,2,3 --json");
    assert_eq!((run.code, run.err.contains("nothing in this scene")), (Some(0), true), "{}", run.err);
    assert!(run.text().starts_with(r#"{"point":[1,2,3],"distance":null,"gradient":[0,0,0],"material":{"#));
}
