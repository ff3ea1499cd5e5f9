//! `presets` derives the presets of `quality` from all examples and writes `tests/tables/presets.md`; where the environment's
//! `ADAPTER` names a device, that device is measured, and the table has its name in its own.
//!
//! `--size 160x90` sets the size of the pictures that are timed, `--rounds 21` in how many rounds.

use sdf_render::Frame;
use sdf_tests::presets::{Study, TABLE, grid, table};
use sdf_tests::{adapter, scenes};

fn main() {
    if let Err(error) = run(std::env::args().skip(1)) {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn run(mut arguments: impl Iterator<Item = String>) -> Result<(), String> {
    let (mut size, mut rounds) = ((160, 90), 21);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or(format!("{argument} takes a value"))?;
        let number = |text: &str| text.parse().map_err(|_| format!("`{text}` is no whole number"));
        match &*argument {
            "--size" => {
                let (width, height) =
                    value.split_once('x').ok_or(format!("`{value}` is no size; one is 320x180"))?;
                size = (number(width)?, number(height)?);
            }
            "--rounds" => rounds = number(&value)? as usize,
            _ => return Err(format!("what is `{argument}`? there are --size and --rounds")),
        }
    }
    let frame = Frame::new(size.0, size.1);
    let mut study = Study::new(grid());
    for example in scenes::all_examples() {
        eprintln!("{}", example.name);
        study.add(&example, &frame, rounds)?;
    }
    table(&study, &frame)?.write(&adapter::table(TABLE));
    Ok(())
}
