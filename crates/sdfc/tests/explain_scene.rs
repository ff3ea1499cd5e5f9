//! `sdfc explain scene.sdf`: what it says of a scene is so.
//!
//! The pages in `fixtures/explain` are what people read; `UPDATE_FIXTURES=1 cargo test` writes them anew.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// The status, standard output and standard error of `sdfc explain`, in a folder.
fn run(folder: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sdfc"));
    let output = command.current_dir(folder).arg("explain").args(words).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// What is printed of a scene, about which nothing is wrong.
#[track_caller]
fn explain(folder: &Path, words: &[&str]) -> String {
    let (status, out, err) = run(folder, words);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    out
}

/// A scene in a folder of its own.
struct Scene(TempDir);

impl Scene {
    fn new(text: &str) -> Scene {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("scene.sdf"), text).unwrap();
        Scene(folder)
    }

    /// What is said of it as data, with these arguments beside those that make it quick.
    #[track_caller]
    fn json(&self, words: &[&str]) -> Value {
        let quick = ["scene.sdf", "--json", "--no-time", "--size", "24x16"];
        let text = explain(self.0.path(), &[&quick[..], words].concat());
        assert_eq!(text.lines().count(), 1, "an object is a line");
        serde_json::from_str(&text).unwrap()
    }
}

fn effects(json: &Value) -> &Vec<Value> {
    json["effects"].as_array().unwrap()
}

/// An effect that is in.
#[track_caller]
fn priced<'j>(json: &'j Value, name: &str) -> &'j Value {
    let found = effects(json).iter().find(|e| e["name"] == name && e["in"] == true);
    found.unwrap_or_else(|| panic!("no {name}: {json}"))
}

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<PathBuf> = files.filter(|p| p.extension().is_some_and(|e| e == "sdf")).collect();
    scenes.sort();
    scenes
}

/// The figures of a page are those of the data.
fn check_page(page: &str, json: &Value) {
    assert!(page.lines().all(|line| line.chars().count() <= 100), "a line is too long:\n{page}");
    assert!(page.lines().all(|line| line.trim_end() == line), "spaces at the end of a line:\n{page}");
    let words = |line: &str| line.split_whitespace().map(String::from).collect::<Vec<String>>();
    let flat = words(page).join(" ");
    let contains = |text: &str| assert!(flat.contains(&words(text).join(" ")), "no {text:?} in\n{page}");
    let of = |v: &Value| {
        format!("{:.1} times in the mean, and {} times at most", v["mean"].as_f64().unwrap(), v["most"])
    };
    contains(&of(&json["evaluations"]));
    for effect in effects(json) {
        let name = match effect["subject"].as_str() {
            Some(subject) => {
                let count = effect["count"].as_u64().filter(|count| *count > 1);
                let count = count.map_or(String::new(), |count| format!("{count} "));
                format!("{} of {count}`{subject}`", effect["name"].as_str().unwrap())
            }
            None => effect["name"].as_str().unwrap().to_string(),
        };
        let place = match &effect["place"] {
            Value::Null => String::new(),
            place => format!("{}:{}: ", place["file"].as_str().unwrap(), place["line"]),
        };
        let mut reason = format!("{place}{}", effect["reason"].as_str().unwrap());
        if let Value::Object(set) = &effect["removed_by"] {
            let word = |name: &str| set[name].as_str().unwrap();
            reason += &format!("; `--set {}={}` removes it", word("name"), word("value"));
        }
        match &effect["price"]["evaluations"] {
            Value::Null if effect["in"] == true => contains(&format!("{name} - - {reason}")),
            Value::Null => contains(&format!("{name} {reason}")),
            price => {
                let (mean, most) = (price["mean"].as_f64().unwrap(), &price["most"]);
                let saved = if mean <= -0.05 { "saves " } else { "" };
                contains(&format!("{name} {saved}{:.1} {most} {reason}", mean.abs()));
            }
        }
    }
    let shapes = json["shapes"].as_array().unwrap();
    for shape in shapes.iter().filter(|_| shapes.len() <= 40) {
        let class = shape["class"].as_str().unwrap();
        let line =
            |l: &&str| l.trim_start().starts_with(shape["name"].as_str().unwrap()) && l.contains(class);
        let share = format!(" {:.0} %", shape["share"].as_f64().unwrap() * 100.0);
        let cost = format!(" {} ", shape["operations"]);
        let place = shape["line"].as_u64().map_or(String::new(), |line| format!(":{line}"));
        let is_told = |l: &str| l.contains(&cost) && l.contains(&share) && l.ends_with(&place);
        assert!(page.lines().filter(line).any(is_told), "no {shape} in\n{page}");
    }
}

#[test]
fn pages_say_what_the_data_says() {
    for path in examples() {
        let (folder, name) = (path.parent().unwrap(), path.file_name().unwrap().to_str().unwrap());
        let words = [name, "--no-time", "--size", "32x18"];
        let page = explain(folder, &words);
        let json: Value =
            serde_json::from_str(&explain(folder, &[&words[..], &["--json"]].concat())).unwrap();
        check_page(&page, &json);
        // Nothing that is printed depends on the machine.
        assert_eq!(page, explain(folder, &words), "{name}");
    }
}

#[test]
fn pages_are_these() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/explain");
    for name in ["everything", "colonnade"] {
        let scene = format!("{name}.sdf");
        let found = explain(&fixtures, &[&scene, "--no-time", "--size", "64x36", "--time", "1"]);
        let path = fixtures.join(format!("{name}.txt"));
        if std::env::var_os("UPDATE_FIXTURES").is_some() {
            fs::write(&path, &found).unwrap();
        }
        let expected = fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(found, expected, "run `UPDATE_FIXTURES=1 cargo test -p sdfc --test explain_scene`");
    }
}

/// Every line that says what removes an effect is carried out.
#[test]
fn what_is_said_to_remove_an_effect_removes_it() {
    let everything = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/explain/everything.sdf");
    let scene = Scene::new(&fs::read_to_string(everything).unwrap());
    let json = scene.json(&[]);
    let mut removed = Vec::new();
    for effect in effects(&json) {
        let Value::Object(set) = &effect["removed_by"] else { continue };
        let set = format!("{}={}", set["name"].as_str().unwrap(), set["value"].as_str().unwrap());
        let without = scene.json(&["--set", &set]);
        let is_same = |e: &&Value| e["name"] == effect["name"] && e["subject"] == effect["subject"];
        let left = effects(&without).iter().filter(is_same).filter(|e| e["in"] == true).count();
        assert_eq!(left, 0, "{set} leaves {effect}");
        assert_eq!(without["set"][0]["name"], effect["removed_by"]["name"]);
        removed.push(format!("{} {set}", effect["name"].as_str().unwrap()));
    }
    assert_eq!(
        removed,
        [
            "soft shadow power=0",
            "hard shadow night=true",
            "occlusion shade=0",
            "glow shine=0",
            "glow shine=0",
            "reflection polish=0",
            "transmission polish=0",
            "rim light edge=#000000",
            "fog haze=0",
            "emission shine=0",
        ]
    );
    assert!(scene.json(&["--set", "shine=0"])["effects"].to_string().contains("no shape of the scene glows"));
}

/// The camera looks straight down at a floor that fills the picture, and which is met by a division: nothing is marched to.
const FLOOR: &str = "camera { eye: (0, 5, 0), target: (0, 0, 0), up: (0, 0, -1), fov: 30deg }
    scene { plane() }\n";

/// All of these are counted by hand.
#[test]
fn figures_are_those_that_are_counted_by_hand() {
    let figures = |items: &str, name: &str| {
        let json = Scene::new(&format!("{FLOOR}{items}")).json(&[]);
        let price = priced(&json, name)["price"]["evaluations"].clone();
        let whole = json["evaluations"].clone();
        [&whole["mean"], &whole["most"], &price["mean"], &price["most"]].map(|n| n.as_f64().unwrap())
    };
    let dim = "light sun { direction: (0, 1, 0) }\n";
    // One normal, the place on the surface, and six above it.
    let occluded = figures(&format!("{dim} ambient {{ occlusion: 1 }}"), "occlusion");
    assert_eq!(occluded, [8.0, 8.0, 7.0, 7.0]);
    // Differences along three axes, in the place of one gradient.
    let sampled = figures(&format!("{dim} render {{ normals: central }}"), "sampled normals");
    assert_eq!(sampled, [6.0, 6.0, 5.0, 5.0]);
    // Fog, rims and curves look at no distance.
    assert_eq!(figures(&format!("{dim} fog {{ density: 1 }}"), "fog"), [1.0, 1.0, 0.0, 0.0]);
    assert_eq!(figures(&format!("{dim} rim {{ color: 1 }}"), "rim light"), [1.0, 1.0, 0.0, 0.0]);
    // Out of the picture there is something that could throw a shadow. A ray to the sun looks once whether it is there where
    // the ray has no part of its box, and could look 256 times more.
    let beside = |shadow: &str| {
        let items = format!(
            "camera {{ eye: (0, 5, 0), target: (0, 0, 0), up: (0, 0, -1), fov: 30deg }}
            scene {{ plane(), torus(1, 0.3).at(20, 0.5, 0) }}
            light sun {{ direction: (0, 1, 0), shadow: {shadow} }}"
        );
        let json = Scene::new(&items).json(&[]);
        let name = if shadow == "hard" { "hard shadow" } else { "soft shadow" };
        let price = &priced(&json, name)["price"]["evaluations"];
        (price["mean"].as_f64().unwrap(), price["most"].as_u64().unwrap())
    };
    assert_eq!(beside("hard"), (1.0, 1 + 256));
    // A soft one begins at the place on the surface. Straight up from a floor the torus is never nearer than the 8th part of the way,
    // so none of that is marched; and could be, 256 times.
    assert_eq!(beside("soft(8)"), (1.0, 1 + 256));
    // The glow of a half space is known from where the eye is, before anything is drawn.
    let glow = "let lamp = plane().at(0, -1, 0).paint(material { glow: 1, glow_radius: 12 })";
    let json = Scene::new(&format!(
        "camera {{ eye: (0, 5, 0), target: (0, 0, 0), up: (0, 0, -1), fov: 1deg }} {dim} {glow} scene {{ lamp, plane() }}"
    ))
    .json(&[]);
    let price = &priced(&json, "glow")["price"]["evaluations"];
    assert_eq!((price["mean"].as_f64(), price["most"].as_i64()), (Some(0.0), Some(0)));
}

#[test]
fn what_is_left_of_a_scene_is_that_of_a_plain_one() {
    let (light, plain) =
        ("light sun { direction: (1, 2, 3), shadow: soft(8) }", "light sun { direction: (1, 2, 3) }");
    let text = "scene { box(1).at(0, 1, 0), plane() }\n";
    let whole =
        Scene::new(&format!("{text}{light} ambient {{ occlusion: 1 }} fog {{ density: 1 }}")).json(&[]);
    let plain = Scene::new(&format!("{text}{plain}")).json(&[]);
    assert_eq!(whole["rest"]["evaluations"], plain["evaluations"]);
    assert_eq!(plain["rest"]["evaluations"], plain["evaluations"]);
    // Each is by itself what the whole has more, but for the place on the surface, which shadow and occlusion share.
    let more = |name: &str| priced(&whole, name)["price"]["evaluations"]["most"].as_i64().unwrap();
    let most = |json: &Value| json["evaluations"]["most"].as_i64().unwrap();
    assert_eq!(most(&plain) + more("soft shadow") + more("occlusion") + more("fog") + 1, most(&whole));
}

#[test]
fn shapes_have_their_shares() {
    let json = Scene::new(
        "scene { sphere(1).repeat(x: 1.5, count: (4, 0, 0)), box(0.5).at(0, 3, 0).twist(1), plane().at(0, -1, 0) }",
    )
    .json(&[]);
    let shapes = json["shapes"].as_array().unwrap();
    let of = |name: &str| shapes.iter().find(|shape| shape["name"] == name).unwrap();
    let whole = shapes[0]["operations"].as_f64().unwrap();
    assert_eq!((&shapes[0]["share"], &shapes[0]["depth"]), (&1.0.into(), &0.into()));
    // Two balls are asked, whose operations count twice.
    assert_eq!(of("repeat")["copies"][0]["asked"], 3.0);
    assert_eq!(of("sphere")["share"], 3.0 * of("sphere")["operations"].as_f64().unwrap() / whole);
    assert_eq!(of("twist")["class"], "steep");
    assert_eq!(of("plane")["box"]["lo"], serde_json::json!([null, null, null]));
    assert_eq!(of("plane")["box"]["hi"][0], Value::Null);
}

#[test]
fn times_are_taken_on_the_cpu() {
    let scene = Scene::new("scene { box(1) } ambient { occlusion: 1 } param unused = 1 in 0..1");
    let words = ["scene.sdf", "--size", "32x18", "--device", "cpu", "--budget", "0.2"];
    let page = explain(scene.0.path(), &words);
    assert!(page.contains("ms on CPU, by "), "{page}");
    assert!(
        page.lines().find(|line| line.contains("occlusion ")).is_some_and(|line| line.ends_with(')')),
        "{page}"
    );
    let json: Value =
        serde_json::from_str(&explain(scene.0.path(), &[&words[..], &["--json"]].concat())).unwrap();
    assert!(json["timing"]["rounds"].as_u64() >= Some(3) && json["timing"]["device"] == "CPU", "{json}");
    let time = &priced(&json, "occlusion")["price"]["time"];
    let [from, share, to] = ["from", "share", "to"].map(|name| time[name].as_f64().unwrap());
    assert!(from <= share && share <= to && to < 1.0, "{time}");
    assert!(json["rest"]["time"]["share"].as_f64() > Some(0.0), "{json}");
}

#[test]
fn mistakes_are_told() {
    let scene = Scene::new("scene { spere(1) }");
    let folder = scene.0.path();
    fs::create_dir(folder.join("scenes")).unwrap();
    fs::write(folder.join("shader.wgsl"), "// none").unwrap();
    fs::write(folder.join("E999"), "scene { box(1) }").unwrap();
    let cases: [(&[&str], i32, &[&str]); 12] = [
        (&["scene.sdf"], 1, &["[E020] error: ", "spere"]),
        (&["sceen.sdf"], 2, &["error: cannot read sceen.sdf: no such file", "did you mean scene.sdf?"]),
        (&["scenes"], 2, &["error: cannot read scenes: is a directory", "name a file in it"]),
        (&["shader.wgsl"], 2, &["error: shader.wgsl is no scene", "the .sdf file that it was made from"]),
        (&["picture.PNG"], 2, &["error: picture.PNG is no scene"]),
        (&["E020", "scene.sdf"], 2, &["`explain` takes codes or one scene"]),
        (&["scene.sdf", "scene.sdf"], 2, &["`explain` takes codes or one scene"]),
        (&["E020", "--json"], 2, &["only what is said of a scene can be had as JSON"]),
        (&["E998"], 2, &["there is no code E998", "a scene is named by its file"]),
        (&["E999", "--set", "k=1"], 2, &["[E065]", "there is no param `k`"]),
        (&["scene.sdf", "--no-time", "--budget", "3"], 2, &["--budget", "--no-time"]),
        (&["E999", "--size", "8x4", "--device", "no such thing"], 3, &["no such thing", "--device cpu"]),
    ];
    for (words, code, said) in cases {
        let (status, out, err) = run(folder, words);
        assert_eq!((status, out.as_str()), (Some(code), ""), "{words:?}: {err}");
        for word in said {
            assert!(err.contains(word), "{words:?}: no {word:?} in {err}");
        }
    }
    // A file may be named as it likes, but for a code.
    assert!(explain(folder, &["E999", "--no-time", "--size", "4x4"]).starts_with("E999: 4x4 pixels"));
    fs::write(folder.join("E020"), "scene { box(1) }").unwrap();
    assert!(explain(folder, &["e020"]).starts_with("E020: "));
    assert!(explain(folder, &["./E020", "--no-time", "--size", "4x4"]).starts_with("./E020: 4x4 pixels"));
}
