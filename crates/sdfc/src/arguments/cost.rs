//! `sdfc cost`, and the bounds of `--max-error` and `--max-time`.

use super::{HOUR, QualityArguments, SetArguments, budget, device, seconds, size};
use clap::Args;
use sdfc::Device;
use sdfc::tradeoff::Bounds;
use std::path::PathBuf;
use std::time::Duration;

/// `sdfc cost SCENE`
#[derive(Debug, Args)]
pub struct CostArguments {
    /// The scene; `-` reads standard input
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The size of the picture that is timed, in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "320x180", value_parser = size)]
    pub size: (u32, u32),
    /// The time in seconds, at least 0
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = seconds, allow_negative_numbers = true)]
    pub time: f64,
    /// What is timed: `auto`, `gpu`, `cpu`, or a part of a graphics device's name
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    pub device: Device,
    /// For about how long pictures are timed, in seconds; to find the truth and to compare with it comes on top
    #[arg(long, value_name = "SECONDS", default_value = "40", value_parser = budget, conflicts_with = "no_time", allow_negative_numbers = true)]
    pub budget: f64,
    /// Take no times: what is printed is then the same on every machine
    #[arg(long)]
    pub no_time: bool,
    /// The size of the picture that is compared with the truth, in pixels; by default that which is timed, or a smaller one of
    /// the same form if the scene would else take minutes
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    pub compare: Option<(u32, u32)>,
    /// Walk from the scene's own setting, or from that which satisfies the bounds, to the exact one, a setting at a time, and say
    /// what each step costs and buys
    #[arg(long)]
    pub why: bool,
    /// What a picture must satisfy.
    #[command(flatten)]
    pub bounds: BoundArguments,
    /// Write all that was measured as an object of JSON; `-` is standard output, which then has no table
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write a line of CSV for each setting; `-` is standard output, which then has no table
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Draw the errors against the times: a plot (.svg), or a page with the pictures of all settings (.html)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// The preset.
    #[command(flatten)]
    pub quality: QualityArguments,
    /// Values of params.
    #[command(flatten)]
    pub set: SetArguments,
    /// Print how long each stage took
    #[arg(long)]
    pub timings: bool,
}

/// What a picture must satisfy, so that its setting is chosen by measuring.
#[derive(Debug, Args, Default, PartialEq)]
pub struct BoundArguments {
    /// Look for the fastest setting with which no hit is farther from the true surface, such as 0.5px, by measuring
    #[arg(long, value_name = "PIXELS", value_parser = pixels, allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// Look for the most exact setting with which a picture takes no longer by the clock on the wall, such as 16ms, by measuring
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true)]
    pub max_time: Option<Duration>,
}

impl BoundArguments {
    /// The bounds.
    pub fn bounds(&self) -> Bounds {
        Bounds { error: self.max_error, time: self.max_time }
    }

    /// Whether there are any.
    pub fn are_any(&self) -> bool {
        self.bounds() != Bounds::default()
    }
}

/// A number of pixels above 0, with or without its unit.
fn pixels(text: &str) -> Result<f64, String> {
    let number = text.trim().strip_suffix("px").unwrap_or(text).trim();
    match number.parse::<f64>() {
        Ok(x) if (1e-4..=100.0).contains(&x) => Ok(x),
        Ok(_) => Err("an error is bounded by 0.0001 to 100 pixels".into()),
        Err(_) => Err("expected a number of pixels such as 0.5px".into()),
    }
}

/// A time with its unit, above 0.
fn duration(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let (number, unit) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (None, Some(number)) => (number, 1.0),
        (None, None) => return Err("expected a time with its unit, such as 16ms or 0.5s".into()),
    };
    match number.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x * unit <= HOUR => Ok(Duration::from_secs_f64(x * unit)),
        Ok(_) => Err("a time is more than 0 and at most an hour".into()),
        Err(_) => Err("expected a time such as 16ms or 0.5s".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_in_pixels() {
        assert_eq!([pixels("0.5px"), pixels("0.5"), pixels(" 2 px ")], [Ok(0.5), Ok(0.5), Ok(2.0)]);
        for wrong in ["", "px", "0px", "-1px", "nan", "101px", "1em", "half"] {
            assert!(pixels(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn durations_have_units() {
        let milliseconds = |x| Ok(Duration::from_millis(x));
        assert_eq!(
            [duration("16ms"), duration("0.5s"), duration(" 2 s ")],
            [16, 500, 2000].map(milliseconds)
        );
        for wrong in ["", "16", "ms", "0ms", "-1s", "inf s", "3601s", "16us", "1h"] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
    }
}
