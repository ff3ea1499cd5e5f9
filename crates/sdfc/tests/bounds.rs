//! `--max-error` and `--max-time`, and the walk to the exact setting, as users call them.

use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// A scene whose silhouettes and shadows tell settings apart.
const SCENE: &str = "light key { direction: (2, 3, 1), shadow: soft(8) } ambient { occlusion: 0.8 }
scene { smin(sphere(0.5), box(0.4).at(0.5, 0, 0), k: 0.2), plane().at(0, -0.6, 0) }\n";

/// The status, standard output and standard error of `sdfc` in a folder that has the scene.
fn run(folder: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    fs::write(folder.join("scene.sdf"), SCENE).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_sdfc")).current_dir(folder).args(words).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// The block that was chosen, as it was told.
fn block(told: &str) -> &str {
    told.lines().map(str::trim).find(|line| line.starts_with("render {")).unwrap_or_else(|| panic!("{told}"))
}

/// The lines of a text without comments, which tell what was measured.
fn code(text: &str) -> Vec<&str> {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim_end());
    lines.filter(|line| !line.is_empty()).collect()
}

#[test]
fn a_bound_of_the_error_chooses_what_the_scene_can_say_itself() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    let bound = ["scene.sdf", "-o", "a.wgsl", "--max-error", "0.05px", "--size", "48x27", "--device", "cpu"];
    let (status, _, err) = run(folder.path(), &[&bound[..], &["--budget", "2"]].concat());
    assert_eq!(status, Some(0), "{err}");
    assert!(err.contains("chosen: `") && err.contains(" on CPU"), "{err}");
    let tolerance = block(&err).split("tolerance: ").nth(1).and_then(|rest| rest.split(',').next()).unwrap();
    assert!(
        tolerance.parse::<f64>().unwrap() < 0.5,
        "with the tolerance of `draft` hits are farther off: {err}"
    );
    fs::write(path("b.sdf"), format!("{}\n{SCENE}", block(&err))).unwrap();
    let (status, _, err) = run(folder.path(), &["b.sdf", "-o", "b.wgsl"]);
    assert_eq!(status, Some(0), "{err}");
    let [a, b] = ["a.wgsl", "b.wgsl"].map(|name| fs::read_to_string(path(name)).unwrap());
    assert!(code(&a) == code(&b), "the block says what was chosen");
    // What other values cost stands below the constants, and how that was measured at the head.
    let mut lines = a.lines().skip_while(|line| !line.starts_with("const TOLERANCE"));
    let below = lines.nth(1).unwrap();
    assert!(
        below.starts_with("//   with ") && below.contains(" instead: ") && below.contains(" % "),
        "{below}"
    );
    assert!(
        a.contains("// Below constants: what other values cost and buy. Times are of 48x27 on CPU, "),
        "{a}"
    );
    assert!(!b.contains(" instead: "));
}

#[test]
fn a_bound_that_nothing_satisfies_is_said() {
    let folder = TempDir::new().unwrap();
    let render =
        ["render", "scene.sdf", "-o", "a.png", "--size", "32x18", "--device", "cpu", "--budget", "1"];
    let (status, out, err) = run(folder.path(), &[&render[..], &["--max-time", "1us"]].concat());
    assert_eq!((status, out.as_str()), (Some(2), ""), "{err}");
    let (status, out, err) = run(folder.path(), &[&render[..], &["--max-time", "0.001ms"]].concat());
    assert_eq!((status, out.as_str()), (Some(2), ""), "{err}");
    assert!(err.contains("no setting satisfies the bounds; the closest is `"), "{err}");
    assert!(!folder.path().join("a.png").exists());
    let (status, _, err) = run(folder.path(), &[&render[..], &["--max-time", "1000s"]].concat());
    assert_eq!(status, Some(0), "{err}");
    assert!(block(&err).contains("tolerance: 0.0"), "the most exact is taken: {err}");
}

#[test]
fn what_is_about_bounds_wants_one() {
    let folder = TempDir::new().unwrap();
    for words in [
        &["scene.sdf", "-o", "a.wgsl", "--budget", "3"][..],
        &["scene.sdf", "-o", "a.wgsl", "--size", "32x18"],
        &["render", "scene.sdf", "-o", "a.png", "--budget", "3"],
    ] {
        let (status, _, err) = run(folder.path(), words);
        assert_eq!(status, Some(2), "{words:?}: {err}");
        assert!(err.contains("add `--max-error 0.5px` or `--max-time 16ms`"), "{err}");
    }
    let (status, _, err) = run(folder.path(), &["cost", "scene.sdf", "--no-time", "--max-time", "16ms"]);
    assert_eq!(status, Some(2), "{err}");
}

#[test]
fn a_walk_ends_at_the_exact_setting() {
    let folder = TempDir::new().unwrap();
    let words = ["cost", "scene.sdf", "--why", "--no-time", "--size", "32x18"];
    let (status, out, err) = run(folder.path(), &words);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    let steps: Vec<&str> = out.lines().filter(|line| line.contains(" % evaluations")).collect();
    assert!(steps.iter().any(|step| step.trim_start().starts_with("tolerance 0.01 ")), "{out}");
    assert!(steps.last().unwrap().trim_start().starts_with("together"), "{out}");
    let bounded = [&words[..], &["--max-error", "1px"]].concat();
    let (status, out, err) = run(folder.path(), &bounded);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    assert!(out.contains("From `draft` to `exact`"), "what needs the fewest evaluations is chosen: {out}");
}

#[test]
fn the_truth_may_be_looked_at_in_another_size() {
    let folder = TempDir::new().unwrap();
    let words = ["cost", "scene.sdf", "--no-time", "--size", "320x180", "--compare", "20x10"];
    let (status, out, err) = run(folder.path(), &words);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    assert!(
        out.starts_with("scene.sdf: errors are of 20x10 pixels; the truth of all pixels is proved."),
        "{out}"
    );
    let (_, again, _) = run(folder.path(), &words);
    assert_eq!(out, again, "without times the figures are the same each time");
}
