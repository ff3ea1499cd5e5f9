//! `effects` measures what the effects cost and writes `tests/tables/effects.md` and `bare.md`; where the environment's `ADAPTER`
//! names a device, that device is measured, and the tables have its name in theirs.
//!
//! `--size 640x360` sets the size of the pictures, `--seconds 40` how long those of an example are timed, `--rounds 31` how often
//! marches are.

use sdf_render::Frame;
use sdf_tests::{adapter, prices};
use std::time::Duration;

fn main() {
    if let Err(error) = run(std::env::args().skip(1)) {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn run(mut arguments: impl Iterator<Item = String>) -> Result<(), String> {
    let (mut size, mut seconds, mut rounds) = ((640, 360), 40, 31);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or(format!("{argument} takes a value"))?;
        let number = |text: &str| text.parse().map_err(|_| format!("`{text}` is no whole number"));
        match &*argument {
            "--size" => {
                let (width, height) =
                    value.split_once('x').ok_or(format!("`{value}` is no size; one is 640x360"))?;
                size = (number(width)?, number(height)?);
            }
            "--seconds" => seconds = number(&value)?,
            "--rounds" => rounds = number(&value)? as usize,
            _ => return Err(format!("what is `{argument}`? there are --size, --seconds and --rounds")),
        }
    }
    let frame = Frame::new(size.0, size.1);
    let budget = Duration::from_secs(u64::from(seconds));
    prices::table(&frame, budget)?.write(&adapter::table(prices::PRICES));
    prices::bare_table(&frame, rounds)?.write(&adapter::table(prices::BARE));
    Ok(())
}
