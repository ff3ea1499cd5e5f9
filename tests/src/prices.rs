//! What effects cost: four examples without any, with each alone and with all.
//!
//! [`Priced::of`] makes the scenes by text from an example, [`counted`] counts their evaluations, and [`timed`] times them.

use crate::adapter;
use crate::march::comparison::{count, time};
use crate::scenes::{Example, examples};
use crate::table::Table;
use sdf_lang::Options;
use sdfc::{Clock, Device, Evaluations, Frame, Lap, Shader, compile, race};
use std::time::Duration;

/// The examples: each has lights, ambient light and two materials, a line each.
pub const EXAMPLES: [&str; 4] = ["blend", "carved", "cheese", "logo"];
/// The file of the table of prices, by its name without the ending.
pub const PRICES: &str = "effects";
/// That of the march of bare scenes beside those of others.
pub const BARE: &str = "bare";

/// An effect, and how a file without it becomes one with it.
struct Change {
    name: &'static str,
    /// Whether its price is its own: rays that go on, and more rays for each pixel, pay for all other effects once more.
    adds: bool,
    make: fn(&mut Vec<String>),
}

const CHANGES: [Change; 12] = [
    Change {
        name: "soft shadow",
        adds: true,
        make: |lines| with_field(lines, "light", 0, "shadow: soft(8)"),
    },
    Change {
        name: "second light, hard shadow",
        adds: true,
        make: |lines| {
            lines.push("light second { direction: (-2, 4, 1), intensity: 0.4, shadow: hard }".into())
        },
    },
    Change { name: "occlusion", adds: true, make: |lines| with_field(lines, "ambient", 0, "occlusion: 1") },
    Change { name: "glow", adds: true, make: |lines| with_field(lines, "material", 1, "glow: 0.1") },
    Change { name: "emission", adds: true, make: |lines| with_field(lines, "material", 1, "emission: 0.1") },
    Change { name: "rim light", adds: true, make: |lines| lines.push("rim { color: 0.2 }".into()) },
    Change { name: "fog", adds: true, make: |lines| lines.push("fog { density: 0.03 }".into()) },
    Change { name: "tone mapping", adds: true, make: |lines| with_setting(lines, "tonemap: aces") },
    Change {
        name: "reflection",
        adds: false,
        make: |lines| with_field(lines, "material", 1, "reflect: 0.4"),
    },
    Change {
        name: "transmission",
        adds: false,
        make: |lines| with_field(lines, "material", 1, "transmit: 0.8"),
    },
    Change { name: "antialiasing, 2 a side", adds: false, make: |lines| with_setting(lines, "antialias: 2") },
    Change { name: "antialiasing, 4 a side", adds: false, make: |lines| with_setting(lines, "antialias: 4") },
];

/// Puts a field behind the others of a block that is one line: the `index`-th of its kind.
fn with_field(lines: &mut [String], block: &str, index: usize, field: &str) {
    let line = lines.iter_mut().filter(|line| line.starts_with(block)).nth(index);
    let line =
        line.unwrap_or_else(|| panic!("there are fewer than {} lines that begin with `{block}`", index + 1));
    let end = line.rfind('}').expect("a block on one line");
    line.truncate(end);
    *line = format!("{}, {field} }}", line.trim_end());
}

fn with_setting(lines: &mut Vec<String>, setting: &str) {
    if lines.iter().any(|line| line.starts_with("render")) {
        with_field(lines, "render", 0, setting);
    } else {
        lines.push(format!("render {{ {setting} }}"));
    }
}

/// A line without a field, which ends with a `,` or the block.
fn without_field(line: &str, field: &str) -> String {
    let Some(begin) = line.find(&format!(", {field}:")) else { return line.to_owned() };
    let mut depth = 0;
    let end = line[begin + 1..].find(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth == 0 && [',', '}'].contains(&c)
    });
    let end = begin + 1 + end.expect("a field ends");
    format!(
        "{}{}",
        &line[..begin],
        if line[end..].starts_with('}') { format!(" {}", &line[end..]) } else { line[end..].into() }
    )
}

/// The scenes of an example.
#[derive(Debug, Clone)]
pub struct Priced {
    /// The example's name.
    pub name: String,
    /// What each scene has, and its text: nothing; each effect alone; all that add; and all at once, as amounts that are zero and
    /// that the compiler does not know.
    pub scenes: Vec<(&'static str, String)>,
}

/// The names of the scenes without any effect, with all, and with all that do nothing.
pub const NONE: &str = "none";
/// See [`NONE`].
pub const ALL: &str = "all of these";
/// See [`NONE`].
pub const IDLE: &str = "all always on, and idle";

impl Priced {
    /// The scenes of one of [`EXAMPLES`].
    pub fn of(name: &str) -> Priced {
        let example =
            examples().into_iter().find(|e| e.name == name).unwrap_or_else(|| panic!("no example {name}"));
        let fields = ["shadow", "occlusion", "radius", "glow", "emission"];
        let bare: Vec<String> = example
            .text
            .lines()
            .map(|line| {
                let is_setting = ["light", "ambient", "material"].iter().any(|block| line.starts_with(block));
                if is_setting {
                    fields.iter().fold(line.to_owned(), |line, field| without_field(&line, field))
                } else {
                    line.into()
                }
            })
            .collect();
        let made = |changes: &mut dyn Iterator<Item = &Change>| {
            let mut lines = bare.clone();
            changes.for_each(|change| (change.make)(&mut lines));
            lines.join("\n")
        };
        let mut scenes = vec![(NONE, bare.join("\n"))];
        scenes.extend(CHANGES.iter().filter(|c| c.adds).map(|c| (c.name, made(&mut std::iter::once(c)))));
        scenes.push((ALL, made(&mut CHANGES.iter().filter(|c| c.adds))));
        scenes.extend(CHANGES.iter().filter(|c| !c.adds).map(|c| (c.name, made(&mut std::iter::once(c)))));
        let mut idle = bare.clone();
        idle.push("param none = 0 in 0..1".into());
        with_field(&mut idle, "light", 0, "shadow: soft(8)");
        idle.push("light second { direction: (-2, 4, 1), intensity: none, shadow: hard }".into());
        with_field(&mut idle, "ambient", 0, "occlusion: none");
        for field in ["glow: none", "emission: none", "reflect: none", "transmit: none"] {
            with_field(&mut idle, "material", 1, field);
        }
        idle.push("rim { color: none }".into());
        idle.push("fog { density: none }".into());
        with_setting(&mut idle, "tonemap: aces");
        scenes.push((IDLE, idle.join("\n")));
        Priced { name: name.to_owned(), scenes }
    }

    /// The scenes as shaders.
    pub fn shaders(&self) -> Vec<Shader> {
        let shader = |(what, text): &(&str, String)| {
            let compiled = compile(
                &self.name,
                text,
                &Options { attack: Some(0), ..Options::default() },
                &mut Clock::default(),
            );
            let said: Vec<&String> = compiled.diagnostics.iter().map(|d| &d.message).collect();
            compiled.output.unwrap_or_else(|| panic!("{}, {what}: {said:?}\n{text}", self.name)).1
        };
        self.scenes.iter().map(shader).collect()
    }
}

/// The evaluations of a pixel, of each scene.
pub fn counted(shaders: &[Shader], frame: &Frame) -> Vec<Evaluations> {
    shaders.iter().map(|shader| shader.evaluations(frame, |_| {})).collect()
}

/// The times of the scenes beside each other.
pub fn timed(shaders: &[Shader], frame: &Frame, budget: Duration) -> Result<Vec<Lap>, String> {
    let shaders: Vec<&Shader> = shaders.iter().collect();
    let device = Device::Named(adapter::adapter().name().name.clone());
    let race = race(&shaders, frame, &device, budget, &|_| {}).map_err(|error| error.to_string())?;
    race.laps.into_iter().map(|lap| lap.ok_or("the time was too short for all".to_owned())).collect()
}

/// By how much all effects together cost more than the sum of what each costs alone, as a share of it.
pub fn beyond_the_sum(scenes: &[(&'static str, String)], costs: &[f64]) -> f64 {
    let cost = |wanted: &str| costs[scenes.iter().position(|(name, _)| *name == wanted).expect("a scene")];
    let alone = CHANGES.iter().filter(|c| c.adds).map(|c| cost(c.name) - cost(NONE)).sum::<f64>();
    (cost(ALL) - cost(NONE)) / alone - 1.0
}

/// The table of prices; each scene's pictures are timed for so long.
pub fn table(frame: &Frame, budget: Duration) -> Result<Table, String> {
    let mut rows = Vec::new();
    for name in EXAMPLES {
        let priced = Priced::of(name);
        let shaders = priced.shaders();
        let (evaluations, laps) = (counted(&shaders, frame), timed(&shaders, frame, budget)?);
        let ratios: Vec<f64> = laps.iter().map(|lap| lap.ratio[1]).collect();
        for (((what, _), evaluations), lap) in priced.scenes.iter().zip(&evaluations).zip(&laps) {
            let [low, ratio, high] = lap.ratio;
            rows.push(vec![
                name.to_owned(),
                (*what).to_owned(),
                format!("{:.1}", evaluations.mean),
                format!("{:.2}", lap.time.as_secs_f64() * 1e3),
                format!("{ratio:.2} ({low:.2} to {high:.2})"),
                format!("{:+.2}", ratio - 1.0),
            ]);
        }
        let means: Vec<f64> = evaluations.iter().map(|e| e.mean).collect();
        rows.push(vec![
            name.to_owned(),
            "all, beyond the sum".into(),
            format!("{:+.1} %", 100.0 * beyond_the_sum(&priced.scenes, &means)),
            String::new(),
            String::new(),
            format!("{:+.1} %", 100.0 * beyond_the_sum(&priced.scenes, &ratios)),
        ]);
    }
    Ok(Table {
        title: "The prices of the effects".into(),
        about: format!(
            "What effects cost for a picture of {}×{} pixels on {}; `effects` in `tests/src/bin/` writes this.

Each example without any effect, with each of them alone, with all that have a price of their own, with those that make rays pay for
all others once more, and, to compare, as it were if nothing were left out: all amounts are zero, and the shader does not know.
Evaluations are those of the field, for a pixel in the mean. Times are those of all processors together for one picture; they take
turns, and ratios are to the scene without effects in the same round: the median, and the quartiles.",
            frame.width,
            frame.height,
            adapter::title()
        ),
        versions: vec![adapter::version(), adapter::processor()],
        columns: ["scene", "effect", "evaluations", "ms", "of the bare scene", "price"].map(String::from).to_vec(),
        rows,
    })
}

/// The marches that bare scenes are compared with: basic, relaxed, and as in the textbook, which ends where it is near.
const MARCHES: [&str; 4] = ["product", "basic@equal", "relaxation(1.2)@equal", "basic+unrefined@equal"];

/// The table of bare scenes with the compiler's march and with others as exact.
pub fn bare_table(frame: &Frame, rounds: usize) -> Result<Table, String> {
    let mut rows = Vec::new();
    for name in EXAMPLES {
        let example = Example { name: name.into(), text: Priced::of(name).scenes[0].1.clone() };
        let counts = count(&example, &MARCHES, frame)?;
        let marches: Vec<&str> = counts.iter().map(|count| &*count.march).collect();
        let laps = time(&example, &marches, frame, rounds)?;
        let fastest = laps[1..].iter().map(|lap| lap.whole.ratio).fold(f64::INFINITY, f64::min);
        for (count, lap) in counts.iter().zip(&laps) {
            rows.push(vec![
                name.to_owned(),
                lap.march.clone(),
                format!("{:.1e}", count.errors.rms),
                format!("{:.2}", lap.whole.time.as_secs_f64() * 1e3),
                format!("{:.2}", lap.whole.ratio),
                if lap.march == MARCHES[0] { format!("{:.2}", 1.0 / fastest) } else { String::new() },
            ]);
        }
    }
    let heads = ["scene", "march", "rms", "ms", "of the product", "product, of the fastest other"];
    Ok(Table {
        title: "Scenes without effects".into(),
        about: format!(
            "How long pictures of {}×{} pixels take on {} that call for nothing but the march, a normal and lights; `effects` in
`tests/src/bin/` writes this. `march.md` says what the marches are called. Each is given the largest tolerance with which its
depths are as exact as those of the product. Times are those of whole pictures, in the median of {rounds}; the marches take turns.",
            frame.width,
            frame.height,
            adapter::title()
        ),
        versions: vec![adapter::version(), adapter::processor()],
        columns: heads.map(String::from).to_vec(),
        rows,
    })
}
