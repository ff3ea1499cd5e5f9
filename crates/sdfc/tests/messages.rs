//! The formats of messages: what programs read is what people see.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// What a run of the command came to.
struct Run {
    code: Option<i32>,
    out: String,
    err: String,
}

fn run(folder: &Path, arguments: &[&str]) -> Run {
    let output =
        Command::new(env!("CARGO_BIN_EXE_sdfc")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

fn folder(scene: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.sdf"), scene).unwrap();
    folder
}

/// The scenes with mistakes that the crates below are tested with.
fn fixtures() -> Vec<PathBuf> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut paths = Vec::new();
    for folder in ["sdf-lang/tests/fixtures/errors", "sdf-syntax/tests/fixtures/errors"] {
        let entries = fs::read_dir(crates.join(folder)).unwrap();
        paths
            .extend(entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "sdf")));
    }
    paths.sort();
    assert!(paths.len() > 20);
    paths
}

/// The messages of a run, each a line.
fn messages(run: &Run) -> Vec<Value> {
    run.err.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("{line}"))).collect()
}

/// Where the bytes `0..byte` of a text end, counted as people count.
fn line_and_column(text: &str, byte: usize) -> (u64, u64) {
    let before = &text[..byte];
    let line = before.rsplit('\n').next().unwrap();
    (before.matches('\n').count() as u64 + 1, line.chars().count() as u64 + 1)
}

/// A place in a message, checked against the text: its file, its first line and column, and what stands there.
fn place<'a>(place: &Value, text: &'a str) -> (String, u64, u64, &'a str) {
    let number = |end: &str, what: &str| place[end][what].as_u64().unwrap();
    let bytes = [number("start", "byte") as usize, number("end", "byte") as usize];
    for (end, byte) in ["start", "end"].into_iter().zip(bytes) {
        assert_eq!((number(end, "line"), number(end, "column")), line_and_column(text, byte), "{place}");
    }
    assert!(place["label"].is_string());
    let file = place["file"].as_str().unwrap().to_string();
    (file, number("start", "line"), number("start", "column"), &text[bytes[0]..bytes[1]])
}

#[test]
fn every_fixture_reads_the_same_in_each_format() {
    for fixture in fixtures() {
        let text = fs::read_to_string(&fixture).unwrap();
        if fixture.ends_with("no_scene.sdf") {
            // `check` takes it for a file that others import.
            continue;
        }
        let folder = folder(&text);
        let [human, short, json] = ["human", "short", "json"]
            .map(|format| run(folder.path(), &["check", "scene.sdf", "--message-format", format]));
        assert_eq!((human.code, short.code, json.code), (Some(1), Some(1), Some(1)), "{}", fixture.display());
        let messages = messages(&json);
        assert_eq!(messages.len(), short.err.lines().count(), "{}", fixture.display());
        let mut rest = human.err.as_str();
        for (message, line) in messages.iter().zip(short.err.lines()) {
            let (file, row, column, _) = place(&message["span"], &text);
            let (severity, code) = (message["severity"].as_str().unwrap(), message["code"].as_str().unwrap());
            let said = message["message"].as_str().unwrap();
            let help = message["help"].as_str().map_or(String::new(), |help| format!(" (help: {help})"));
            let whole = format!("{file}:{row}:{column}: {severity}[{code}]: {said}{help}");
            // What is too long for a line is cut.
            let is_cut = line.strip_suffix('…').is_some_and(|begin| whole.starts_with(begin));
            assert!(line == whole || is_cut, "{line}");
            message["related"].as_array().unwrap().iter().for_each(|related| drop(place(related, &text)));
            // People see the same, in the same order, at the same line.
            for part in [format!("[{code}] {severity}: {said}"), format!("scene.sdf:{row}:")] {
                let nowhere = message["span"]["end"]["byte"] == 0;
                let part =
                    if nowhere && part.starts_with("scene.sdf") { "in scene.sdf".into() } else { part };
                let at = rest.find(&part).unwrap_or_else(|| panic!("no {part:?} in {}", human.err));
                rest = &rest[at..];
            }
        }
        assert_eq!(human.err.matches("for more, try: sdfc explain ").count(), 1);
        assert!(!short.err.contains("explain") && !json.err.contains("explain"));
    }
}

#[test]
fn columns_count_characters_and_bytes_are_bytes() {
    let text = "// größe\nscene { /* é */ spheer(1) }\n";
    let folder = folder(text);
    let run = run(folder.path(), &["--message-format=json", "scene.sdf", "-o", "a.wgsl"]);
    let [message] = &messages(&run)[..] else { panic!("{}", run.err) };
    assert_eq!(place(&message["span"], text), ("scene.sdf".into(), 2, 17, "spheer"));
    assert_eq!((run.code, message["code"].as_str()), (Some(1), Some("E020")));
    assert_eq!(message["help"], "did you mean `sphere`?");
}

#[test]
fn failures_of_the_call_are_messages_too() {
    let folder = folder("scene { sphere(1) }");
    let rows: [&[&str]; 5] = [
        &["none.sdf", "-o", "a.wgsl"],
        &["scene.sdf", "-o", "a.txt"],
        &["scene.sdf", "--colour", "never"],
        &["render", "scene.sdf", "-o", "a.png", "--size", "0x0"],
        &["explain", "E999"],
    ];
    for row in rows {
        let json = run(folder.path(), &[row, &["--message-format", "json"]].concat());
        let [message] = &messages(&json)[..] else { panic!("{}", json.err) };
        assert_eq!((json.code, json.out.as_str()), (Some(2), ""), "{row:?}");
        assert_eq!(message["severity"], "error");
        assert!(message["code"].is_null() && message["span"].is_null(), "{message}");
        assert!(!message["message"].as_str().unwrap().contains('\n'), "{message}");
        let short = run(folder.path(), &[row, &["--message-format", "short"]].concat());
        let start = format!("sdfc: error: {}", message["message"].as_str().unwrap());
        assert!(short.err.starts_with(&start) && short.err.lines().count() == 1, "{}", short.err);
    }
}

#[test]
fn nothing_else_is_said_to_programs() {
    let folder = folder("scene { sphere(1) }");
    for format in ["short", "json"] {
        let run = run(folder.path(), &["check", "scene.sdf", "--message-format", format]);
        assert_eq!((run.code, run.err.as_str(), run.out.as_str()), (Some(0), "", ""));
    }
    let timed = run(folder.path(), &["check", "scene.sdf", "--message-format", "json", "--timings"]);
    let [message] = &messages(&timed)[..] else { panic!("{}", timed.err) };
    assert_eq!(message["timings"][0]["stage"], "read");
    assert!(message["timings"][0]["milliseconds"].as_f64().is_some());
}

const COSTLY: &str = "fn f(x) = iterate(1000, x, |i, s| s * 0.5)\nscene { field { length(p) - 1 + f(p.x) } }";

#[test]
fn warnings_can_be_denied() {
    let folder = folder(COSTLY);
    let rows: [&[&str]; 3] = [
        &["scene.sdf", "-o", "a.wgsl"],
        &["check", "scene.sdf"],
        &["render", "scene.sdf", "-o", "a.png", "--device", "cpu", "--size", "2x2"],
    ];
    for row in rows {
        let denied = run(folder.path(), &[row, &["--deny", "warnings"]].concat());
        assert_eq!(denied.code, Some(1), "{}", denied.err);
        assert!(denied.err.contains("[W001] warning") && denied.err.contains("error: there are warnings"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is written");
    }
    let allowed = run(folder.path(), rows[0]);
    assert_eq!(allowed.code, Some(0), "{}", allowed.err);
    assert!(folder.path().join("a.wgsl").exists());
}

/// 0 done, 1 the scene is wrong, 2 the call is wrong, 3 the device failed; 101 is a panic, whose code is Rust's own.
#[test]
fn the_exit_status_tells_what_is_wrong() {
    let folder = folder("scene { sphere(1) }");
    fs::write(folder.path().join("bad.sdf"), "scene { spheer(1) }").unwrap();
    let rows: [(i32, &[&str]); 6] = [
        (0, &["scene.sdf", "-o", "a.wgsl"]),
        (1, &["bad.sdf", "-o", "b.wgsl"]),
        (1, &["check", "scene.sdf", "bad.sdf"]),
        (2, &["none.sdf", "-o", "b.wgsl"]),
        (2, &["scene.sdf", "--no-such-option"]),
        (3, &["render", "scene.sdf", "-o", "b.png", "--device", "no-such-device"]),
    ];
    for (code, arguments) in rows {
        assert_eq!(run(folder.path(), arguments).code, Some(code), "{arguments:?}");
    }
}
