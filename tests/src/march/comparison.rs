//! Several marches through one scene.

use crate::march::clock::{Clock, Times, race};
use crate::march::{Errors, Rays, Subject, Truth, Variant};
use crate::scenes::Example;
use sdf_render::Frame;

/// A march that meets surfaces as exactly as the compiler's does: its tolerance is chosen.
pub const EQUALLY_EXACT: &str = "@equal";

/// What a march costs for a picture of a scene, and how exact it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Count {
    /// What the march is called.
    pub march: String,
    /// What its rays meet.
    pub rays: Rays,
    /// How far off that is.
    pub errors: Errors,
}

/// How long a picture takes with a march.
#[derive(Debug, Clone, PartialEq)]
pub struct Lap {
    /// What the march is called.
    pub march: String,
    /// The times of the whole picture.
    pub whole: Times,
    /// The times of the march alone: the picture is the depth.
    pub alone: Times,
}

/// Counts what marches do, by the interpreter. Where the name of one ends in [`EQUALLY_EXACT`], its tolerance is the
/// largest one of two digits with which the mean square of its errors is not above that of the first march.
pub fn count(example: &Example, marches: &[&str], frame: &Frame) -> Result<Vec<Count>, String> {
    let truth = Truth::of(example, frame)?;
    let count = |name: &str| -> Result<Count, String> {
        let subject = Subject::new(example, &Variant::named(name)?.with("depth")?)?;
        let rays = Rays::of::<f32>(&subject, frame, [0.0; 2]);
        let errors = rays.errors(&truth);
        Ok(Count { march: name.to_owned(), rays, errors })
    };
    let mut counts: Vec<Count> = Vec::new();
    for name in marches {
        counts.push(match name.strip_suffix(EQUALLY_EXACT) {
            Some(patches) => equally_exact(patches, counts.first().map_or(0.0, |c| c.errors.rms), &count)?,
            None => count(name)?,
        });
    }
    Ok(counts)
}

/// The march whose tolerance is the largest that is as exact as is wanted.
fn equally_exact(
    patches: &str,
    rms: f64,
    count: &dyn Fn(&str) -> Result<Count, String>,
) -> Result<Count, String> {
    /// Steps between tolerances: an eighth of a power of ten.
    const STEPS: f64 = 8.0;
    // Powers of ten that hold between them all that makes sense, in pixels.
    let (mut exact, mut coarse) = (-4.0 * STEPS, STEPS);
    let at = |step: f64| {
        let tolerance = 10f64.powf(step / STEPS);
        let digits = (1.0 - tolerance.log10().floor()).max(0.0) as usize;
        count(&format!("{patches}@{tolerance:.digits$}"))
    };
    let mut best = at(exact)?;
    while coarse - exact > 1.0 {
        let middle = ((exact + coarse) / 2.0).floor();
        let tried = at(middle)?;
        if tried.errors.rms <= rms {
            (exact, best) = (middle, tried);
        } else {
            coarse = middle;
        }
    }
    Ok(best)
}

/// Times marches on the device, by the clock that suits it; ratios are to the first.
pub fn time(example: &Example, marches: &[&str], frame: &Frame, rounds: usize) -> Result<Vec<Lap>, String> {
    let contestants: Vec<(&Example, &str)> = marches.iter().map(|march| (example, *march)).collect();
    time_all(&contestants, frame, rounds)
}

/// Times scenes, each with a march; ratios are to the first.
pub fn time_all(contestants: &[(&Example, &str)], frame: &Frame, rounds: usize) -> Result<Vec<Lap>, String> {
    let race = |is_alone: bool| -> Result<Vec<Times>, String> {
        let subject = |(example, march): &(&Example, &str)| {
            let march = Variant::named(march)?;
            Subject::new(example, &if is_alone { march.with("depth")? } else { march })
        };
        let subjects = contestants.iter().map(subject).collect::<Result<Vec<Subject>, String>>()?;
        Ok(race(&subjects, frame, Clock::of_adapter(), rounds))
    };
    let laps = contestants.iter().zip(race(false)?).zip(race(true)?);
    Ok(laps.map(|(((_, march), whole), alone)| Lap { march: (*march).to_owned(), whole, alone }).collect())
}
