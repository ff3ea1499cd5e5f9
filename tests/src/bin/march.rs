//! `march SCENE.sdf [MARCH…]` measures marches with a scene: see `sdf_tests::march::Variant` for what they are called.
//! Without names, those of a basic table. Ratios are to the first one.
//!
//! `--size 640x360` sets the size of the picture, `--rounds 31` how often each is drawn (0: nothing is timed),
//! `--interpreter` times the interpreter too.

use sdf_render::Frame;
use sdf_tests::march::clock::{Engine, Times, race};
use sdf_tests::march::{Rays, Subject, Variant};
use sdf_tests::scenes::Example;
use std::path::Path;

/// What is measured where nothing is said.
const TABLE: [&str; 9] = [
    "product",
    "basic",
    "basic+unrefined@0.01",
    "relaxation(1.2)",
    "relaxation(1.6)",
    "product@0.001",
    "product+unrefined",
    "product@0.5",
    "product+unrefined@0.5",
];

fn main() {
    if let Err(error) = run(std::env::args().skip(1).collect()) {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn run(arguments: Vec<String>) -> Result<(), String> {
    let (mut size, mut rounds, mut interpreter, mut names) = ((640, 360), 31, false, Vec::new());
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} takes a value"));
        match &*argument {
            "--size" => size = parse_size(&value()?)?,
            "--rounds" => rounds = value()?.parse().map_err(|error| format!("--rounds: {error}"))?,
            "--interpreter" => interpreter = true,
            _ => names.push(argument),
        }
    }
    let mut names = names.into_iter();
    let scene = names.next().ok_or("usage: march SCENE.sdf [MARCH…]")?;
    let mut names: Vec<String> = names.collect();
    if names.is_empty() {
        names = TABLE.map(str::to_owned).to_vec();
    }
    let text = std::fs::read_to_string(&scene).map_err(|error| format!("{scene}: {error}"))?;
    let name = Path::new(&scene).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let frame = Frame::new(size.0, size.1);
    measure(&Example { name, text }, &names, &frame, rounds, interpreter)
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides.ok_or(format!("`{text}` is no size; one is 640x360"))
}

fn measure(
    example: &Example,
    names: &[String],
    frame: &Frame,
    rounds: usize,
    interpreter: bool,
) -> Result<(), String> {
    let marches = names.iter().map(|name| Variant::named(name)).collect::<Result<Vec<_>, _>>()?;
    let alone = |march: &Variant| Subject::new(example, &march.with("depth")?);
    let whole = marches.iter().map(|march| Subject::new(example, march)).collect::<Result<Vec<_>, _>>()?;
    let alone_all = marches.iter().map(alone).collect::<Result<Vec<_>, _>>()?;
    let truth = Rays::of::<f64>(&alone(&Variant::named("exact")?)?, frame);
    println!(
        "{}: {} by {} pixels, {} rays lost by the exact march",
        example.name,
        frame.width,
        frame.height,
        truth.lost().len()
    );
    println!(
        "{:32} {:>7} {:>7} {:>5} {:>6} {:>9} {:>9}",
        "march", "steps", "evals", "lost", "wrong", "rms", "largest"
    );
    for (name, subject) in names.iter().zip(&alone_all) {
        let rays = Rays::of::<f32>(subject, frame);
        let errors = rays.errors(&truth);
        println!(
            "{name:32} {:7.2} {:7.2} {:5} {:6} {:9.2e} {:9.2e}",
            rays.steps(),
            rays.evaluations(),
            rays.lost().len(),
            errors.wrong,
            errors.rms,
            errors.largest
        );
        if !rays.lost().is_empty() {
            let place = |i: &usize| format!("({}, {})", i % frame.width as usize, i / frame.width as usize);
            let places: Vec<String> = rays.lost().iter().take(4).map(place).collect();
            println!("    lost, from the top left: {}", places.join(", "));
        }
    }
    if rounds == 0 {
        return Ok(());
    }
    let mut engines = vec![
        ("lavapipe, whole picture", Engine::Lavapipe, &whole),
        ("lavapipe, march alone", Engine::Lavapipe, &alone_all),
    ];
    if interpreter {
        engines.push(("interpreter, whole picture", Engine::Interpreter, &whole));
    }
    for (what, engine, subjects) in engines {
        println!(
            "\n{what}, medians of {rounds}\n{:32} {:>9} {:>7} {:>9} {:>7}",
            "march", "wall ms", "ratio", "cpu ms", "ratio"
        );
        for (name, times) in names.iter().zip(race(subjects, frame, engine, rounds)) {
            let Times { wall, processors, wall_ratio, processors_ratio } = times;
            let [wall, processors] = [wall, processors].map(|time| time.as_secs_f64() * 1e3);
            println!("{name:32} {wall:9.2} {wall_ratio:7.3} {processors:9.2} {processors_ratio:7.3}");
        }
    }
    Ok(())
}
