//! `sdfc cost scene.sdf`: the files that it writes.

use roxmltree::Document;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The status, standard output and standard error of `sdfc cost` of a small scene, in a folder that has one.
fn run(folder: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    fs::write(folder.join("scene.sdf"), "scene { smin(sphere(0.5), box(0.4), k: 0.2) }\n").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sdfc"));
    command.current_dir(folder).args(["cost", "scene.sdf", "--size", "16x9"]).args(words);
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn figures_are_written_and_the_table_is_printed() {
    let folder = TempDir::new().unwrap();
    let words = ["--no-time", "--json", "cost.json", "--csv", "cost.csv"];
    let (status, out, err) = run(folder.path(), &words);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    let json: Value = serde_json::from_slice(&fs::read(folder.path().join("cost.json")).unwrap()).unwrap();
    let settings = json["settings"].as_array().unwrap();
    assert_eq!((&json["scene"], &json["timing"]), (&"scene.sdf".into(), &Value::Null));
    assert_eq!(json["truth"]["pixels"], 144);
    assert_eq!((&settings[0]["own"], &settings[0]["time_ms"]), (&true.into(), &Value::Null));
    let csv = fs::read_to_string(folder.path().join("cost.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + settings.len());
    for (setting, line) in settings.iter().zip(csv.lines().skip(1)) {
        let name = setting["name"].as_str().unwrap();
        let cell = if name.contains(',') { format!("\"{name}\",") } else { format!("{name},") };
        assert!(line.starts_with(&cell), "{line}");
        assert!(out.lines().any(|line| line.contains(&format!(" {name} "))), "no {name} in\n{out}");
    }
}

#[test]
fn standard_output_has_one_thing() {
    let folder = TempDir::new().unwrap();
    let (status, out, err) = run(folder.path(), &["--no-time", "--json", "-"]);
    assert_eq!((status, err.as_str(), out.lines().count()), (Some(0), "", 1));
    assert_eq!(serde_json::from_str::<Value>(&out).unwrap()["size"], serde_json::json!([16, 9]));
    let (status, out, _) = run(folder.path(), &["--no-time", "--csv", "-"]);
    assert_eq!(status, Some(0));
    assert!(out.starts_with("name,knob,preset,"), "{out}");
    let (status, out, err) = run(folder.path(), &["--no-time", "--csv", "-", "--json", "-"]);
    assert_eq!((status, out.as_str()), (Some(2), ""));
    assert!(err.contains("JSON and CSV cannot both go to standard output"), "{err}");
}

#[test]
fn plots_are_written() {
    for name in ["cost.svg", "cost.HTML"] {
        let folder = TempDir::new().unwrap();
        let words = ["--device", "cpu", "--budget", "0.5", "--plot", name];
        let (status, out, err) = run(folder.path(), &words);
        assert_eq!((status, err.as_str()), (Some(0), ""));
        assert!(out.contains("as it is"), "{out}");
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        let from = text.find("<svg").unwrap();
        let svg = &text[from..text.rfind("</svg>").unwrap() + 6];
        let document = Document::parse(svg).unwrap_or_else(|error| panic!("{error}"));
        let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).map(str::trim).collect();
        assert!(texts.contains(&"What accuracy costs: scene.sdf"), "{texts:?}");
        assert_eq!(text.contains("<table>"), name == "cost.HTML");
    }
}

#[test]
fn what_cannot_be_written_is_told_at_once() {
    let rows = [
        (
            &["--plot", "cost.png"][..],
            "cost.png is not the name of a .svg or .html file",
            "`--plot cost.svg`",
        ),
        (&["--plot", "-"], "- is not the name of a .svg or .html file", "`--plot cost.html`"),
        (&["--plot", "x/cost.svg"], "cannot write x/cost.svg: there is no folder x", ""),
        (&["--json", "scene.sdf"], "cannot write scene.sdf: it is the scene itself", ""),
        (&["--csv", "x/cost.csv"], "cannot write x/cost.csv: there is no folder x", ""),
        (
            &["--no-time", "--plot", "cost.svg"],
            "a plot without times cannot be drawn",
            "leave `--no-time` out",
        ),
    ];
    for (words, message, help) in rows {
        let folder = TempDir::new().unwrap();
        // Were it measured first, that would take an hour.
        let budget: &[&str] = if words.contains(&"--no-time") { &[] } else { &["--budget", "3600"] };
        let (status, out, err) = run(folder.path(), &[words, budget].concat());
        assert_eq!((status, out.as_str()), (Some(2), ""), "{words:?}");
        assert!(err.contains(message) && err.contains(help), "{words:?}: {err}");
        assert_eq!(names(folder.path()), ["scene.sdf"]);
    }
}
