//! The tables of the march that the repository keeps.

use crate::adapter;
use crate::march::clock::Clock;
use crate::march::comparison::{Count, Lap, count, time, time_all};
use crate::march::variant::PRODUCT;
use crate::rewriting::moved;
use crate::scenes::{Example, examples, gallery};
use crate::table::Table;
use sdf_render::Frame;
use std::path::Path;

/// The marches that all scenes are drawn with: the compiler's first.
pub const MARCHES: [&str; 5] =
    ["product", "basic", "basic+unrefined+unproved@equal", "relaxation(1.2)", "relaxation(1.6)"];

/// More of them, for the scene `smooth`.
const MORE: [&str; 6] = [
    "basic@0.001",
    "product@0.001",
    "product+unrefined+unproved",
    "product+unproved",
    "product@0.5",
    "basic+unrefined+unproved@0.1",
];

/// The slope of the field of the scene `column`: what is proved of it, as `--emit facts` tells.
pub const PROVED: f64 = 10.2;
/// The largest gradient on the surface of the column: no smaller number is the slope of its field. Its faces are
/// 0.3 from the axis and as far on each side, so a turn by 13 radians a unit shears them by 3.9.
pub const LEAST: f64 = 4.03;

/// The marches of the scene `column`: the compiler's, and one factor for all, as it is proved, at least, and as it is
/// usual.
pub const FACTORS: [&str; 5] =
    ["product", "global(0.098)", "global(0.248)", "global(0.3)", "basic+global(0.098)"];

/// The file of the table of counts.
pub const COUNTS: &str = "march.md";
/// The table of times, by its name without the ending: [`adapter::table`] is its file.
pub const TIMES: &str = "march_times";

/// Where scenes are moved to, so far that the coordinates of 32 bits are 1/16 apart.
const FAR_AWAY: &str = "(1000000, -1000000, 1000000)";

/// A scene of `tests/march/scenes/`.
pub fn scene(name: &str) -> Example {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("march/scenes/{name}.sdf"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Example { name: name.into(), text }
}

/// The scenes, each with its marches.
fn scenes() -> Vec<(Example, Vec<&'static str>)> {
    // Marches are given tolerances of their own by a block `render`, which one example has already, for rays that go on.
    let examples = examples().into_iter().filter(|example| !example.text.contains("\nrender "));
    let mut scenes: Vec<_> = examples.map(|example| (example, MARCHES.to_vec())).collect();
    scenes.push((scene("smooth"), [&MARCHES[..], &MORE].concat()));
    scenes.push((scene("column"), FACTORS.to_vec()));
    scenes
}

/// Of each scene what its marches do.
pub type Counts = Vec<(String, Vec<Count>)>;

/// What all marches do in all scenes, counted by the interpreter.
pub fn counts(frame: &Frame) -> Result<(Table, Counts), String> {
    let heads = ["scene", "march", "steps", "evaluations", "lost", "wrong", "beside", "rms", "largest"];
    let about = format!(
        "What marches do for a picture of {}×{} pixels; `tests/tests/march.rs` writes this.

`product` is the compiler's march; the others have functions of `tests/march/` in place of its own: `basic` takes steps of
the distance over the slope, `relaxation(ω)` those of Keinert et al.; `unrefined` ends where it is near and is not led on to
the surface; `unproved` takes whatever it is near to for a surface, also where the field is a bound; `global(f)` multiplies all
distances by one factor. A number behind `@` is the tolerance in pixels, else it is that of the scene; of `basic+unrefined+unproved` it
is chosen so that the mean square of the errors is that of the product or just below it.

Steps, and evaluations of the field, are those of the ray from the eye, for a pixel in the mean. Lost rays ran out of steps.
Wrong ones meet what is nearer or farther away than all that the rays a fifth of a pixel round them meet; those beside meet
what is between, at silhouettes. Errors are those of the others' depths, as shares of the depths, from a march in 64 bits to
1e-10.",
        frame.width, frame.height
    );
    let mut table = Table {
        title: "The march, counted".into(),
        about,
        versions: vec!["the interpreter".into()],
        columns: heads.map(str::to_owned).to_vec(),
        rows: Vec::new(),
    };
    let mut all = Vec::new();
    for (example, marches) in scenes() {
        let counts = count(&example, &marches, frame)?;
        table.rows.extend(counts.iter().map(|count| count_row(&example.name, count)));
        all.push((example.name, counts));
    }
    Ok((table, all))
}

fn count_row(scene: &str, Count { march, rays, errors }: &Count) -> Vec<String> {
    vec![
        scene.to_owned(),
        march.clone(),
        format!("{:.2}", rays.steps()),
        format!("{:.2}", rays.evaluations()),
        rays.lost().len().to_string(),
        errors.wrong.to_string(),
        errors.beside.to_string(),
        format!("{:.1e}", errors.rms),
        format!("{:.1e}", errors.largest),
    ]
}

/// How long all scenes take with their marches, on the device. `keep` is given the table after each scene.
pub fn times(frame: &Frame, rounds: usize, keep: &dyn Fn(&Table)) -> Result<(), String> {
    let heads = ["scene", "march", "whole, ms", "of the product", "march alone, ms", "of the product"];
    let about = format!(
        "How long marches take for a picture of {}×{} pixels on {}; `march --table` in `tests/src/bin/` writes this.

`march.md` says what the marches are called. `product, moved` is the compiler's march where the scene and its camera stand at
{FAR_AWAY}. Times are those of {}, in the median of {rounds};
the marches take turns, and ratios are the median of those within a round. The march alone draws the depth, so that nothing
is shaded.",
        frame.width,
        frame.height,
        adapter::title(),
        Clock::of_adapter().title(),
    );
    let mut table = Table {
        title: "The march, timed".into(),
        about,
        versions: vec![adapter::version(), adapter::processor()],
        columns: heads.map(str::to_owned).to_vec(),
        rows: Vec::new(),
    };
    // Tolerances are found in a small picture.
    let small = Frame::new(160, 90);
    let gallery = (gallery(), MARCHES.to_vec());
    for (example, marches) in scenes().into_iter().chain([gallery]) {
        let counts = count(&example, &marches, &small)?;
        let marches: Vec<&str> = counts.iter().map(|count| &*count.march).collect();
        let laps = time(&example, &marches, frame, rounds)?;
        table.rows.extend(laps.iter().map(|lap| time_row(&example.name, lap)));
        table.rows.push(time_row(&example.name, &far_away(&example, frame, rounds)?));
        keep(&table);
    }
    Ok(())
}

/// The times of a scene that is far away, with the compiler's march; ratios are to those of the scene where it is.
fn far_away(example: &Example, frame: &Frame, rounds: usize) -> Result<Lap, String> {
    let far = Example { name: example.name.clone(), text: moved(&example.text, FAR_AWAY) };
    let mut laps = time_all(&[(example, PRODUCT), (&far, PRODUCT)], frame, rounds)?;
    let lap = laps.pop().expect("the times of both");
    Ok(Lap { march: format!("{PRODUCT}, moved"), ..lap })
}

fn time_row(scene: &str, Lap { march, whole, alone }: &Lap) -> Vec<String> {
    let mut row = vec![scene.to_owned(), march.clone()];
    for times in [whole, alone] {
        row.push(format!("{:.2}", times.time.as_secs_f64() * 1e3));
        row.push(format!("{:.2}", times.ratio));
    }
    row
}
