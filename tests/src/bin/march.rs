//! `march SCENE.sdf [MARCH…]` measures marches with a scene: see `sdf_tests::march::Variant` for what they are called.
//! Without names, those of the usual table. Ratios are to the first one.
//!
//! `--size 640x360` sets the size of the picture, `--rounds 31` how often each is drawn (0: nothing is timed).
//! `march --table` times all scenes and writes `tests/tables/march_times.md`; where the environment's `ADAPTER` names a
//! device, that device is timed, by its own clock, and the table has its name in its own.

use sdf_render::Frame;
use sdf_tests::adapter;
use sdf_tests::march::clock::Clock;
use sdf_tests::march::comparison::{Count, Lap, count, time};
use sdf_tests::march::tables;
use sdf_tests::scenes::Example;
use std::path::Path;

fn main() {
    if let Err(error) = run(std::env::args().skip(1).collect()) {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn run(arguments: Vec<String>) -> Result<(), String> {
    let (mut size, mut rounds, mut table, mut names) = ((640, 360), 31, false, Vec::new());
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} takes a value"));
        match &*argument {
            "--size" => size = parse_size(&value()?)?,
            "--rounds" => rounds = value()?.parse().map_err(|error| format!("--rounds: {error}"))?,
            "--table" => table = true,
            _ => names.push(argument),
        }
    }
    let frame = Frame::new(size.0, size.1);
    if table {
        let file = adapter::table(tables::TIMES);
        return tables::times(&frame, rounds, &|table| table.write(&file));
    }
    let mut names = names.iter().map(String::as_str);
    let path = names.next().ok_or("usage: march SCENE.sdf [MARCH…]")?;
    let mut marches: Vec<&str> = names.collect();
    if marches.is_empty() {
        marches = tables::MARCHES.to_vec();
    }
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    let name = Path::new(path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    measure(&Example { name, text }, &marches, &frame, rounds)
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides.ok_or(format!("`{text}` is no size; one is 640x360"))
}

fn measure(example: &Example, marches: &[&str], frame: &Frame, rounds: usize) -> Result<(), String> {
    println!("{}, {} by {} pixels", example.name, frame.width, frame.height);
    println!(
        "{:32} {:>7} {:>7} {:>5} {:>6} {:>6} {:>9} {:>9}",
        "march", "steps", "evals", "lost", "wrong", "beside", "rms", "largest"
    );
    let counts = count(example, marches, frame)?;
    for count in &counts {
        print_count(count, frame);
    }
    if rounds == 0 {
        return Ok(());
    }
    println!(
        "\n{}, medians of {rounds}; milliseconds of {}\n{:32} whole / ratio   march alone / ratio",
        adapter::title(),
        Clock::of_adapter().title(),
        "march"
    );
    let marches: Vec<&str> = counts.iter().map(|count| &*count.march).collect();
    for Lap { march, whole, alone } in time(example, &marches, frame, rounds)? {
        let [whole_ms, alone_ms] = [whole, alone].map(|times| times.time.as_secs_f64() * 1e3);
        let [whole, alone] = [whole.ratio, alone.ratio];
        println!("{march:32} {whole_ms:9.2} {whole:7.3} {alone_ms:9.2} {alone:7.3}");
    }
    Ok(())
}

fn print_count(Count { march, rays, errors }: &Count, frame: &Frame) {
    println!(
        "{march:32} {:7.2} {:7.2} {:5} {:6} {:6} {:9.2e} {:9.2e}",
        rays.steps(),
        rays.evaluations(),
        rays.lost().len(),
        errors.wrong,
        errors.beside,
        errors.rms,
        errors.largest
    );
    if !rays.lost().is_empty() {
        let place = |i: &usize| format!("({}, {})", i % frame.width as usize, i / frame.width as usize);
        let places: Vec<String> = rays.lost().iter().take(4).map(place).collect();
        println!("    lost, from the top left: {}", places.join(", "));
    }
}
