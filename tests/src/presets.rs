//! The presets of `quality`, derived: many settings measured on all examples, and those chosen that lie on the frontier of time and
//! error of them all.
//!
//! The typical way is `grid → Study::of(example) → … → derived → table`; `bin/presets.rs` does all of it.

use crate::adapter;
use crate::scenes::Example;
use crate::table::Table;
use sdf_lang::{Accuracy, Normals, Quality};
use sdfc::tradeoff::{Knob, NEAR, Session, Setting, Stopwatch, Subject, compared};
use sdfc::{Clock, Device, Frame, Options};
use std::time::Duration;

/// Some drivers take minutes for all shaders of a large scene.
const HOUR: Duration = Duration::from_secs(3600);
/// The file of the table that says what was derived, and from what.
pub const TABLE: &str = "presets";
/// What others are varied from, and what their times are compared with.
const PLAIN: Accuracy = Accuracy {
    tolerance: 0.1,
    steps: 256,
    relax: true,
    normals: Normals::Exact,
    shadow_accuracy: 0.015,
    occlusion_samples: 6,
    antialias: 1,
    correction: sdf_lang::Correction::Derived,
    coordinates: sdf_lang::Coordinates::Chosen,
};

/// A setting of the grid, by what is varied.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// All of it.
    pub accuracy: Accuracy,
    /// For each example: its time as a multiple of the first one's, and its errors.
    pub measured: Vec<Point>,
}

/// A setting on an example.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The time of a picture, as a multiple of the first setting's.
    pub time: f64,
    /// To the true colours, in sRGB codes of 255.
    pub rms: f64,
    /// False hits and false misses.
    pub wrong: usize,
    /// Rays that ran out of steps.
    pub lost: usize,
    /// How far hits are off at most, in pixels.
    pub depth: f64,
}

/// How a candidate stands beside the others, over all examples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// The time, as a multiple of the first setting's: the geometric mean.
    pub time: f64,
    /// The error: the geometric mean.
    pub rms: f64,
    /// The time as a multiple of that of the fastest setting with no larger error: the geometric mean.
    pub over_frontier: f64,
    /// The same on the example where it is most.
    pub worst: f64,
    /// False hits and false misses of all examples.
    pub wrong: usize,
    /// Rays of all examples that ran out of steps.
    pub lost: usize,
    /// How far hits are off at most.
    pub depth: f64,
}

/// All settings that are measured, the one that times are compared with first.
pub fn grid() -> Vec<Accuracy> {
    let mut all = vec![PLAIN];
    for tolerance in [1.0, 0.5, 0.2, 0.1, 0.03, 0.01] {
        for (shadow_accuracy, occlusion_samples) in [(0.06, 3), (0.03, 4), (0.015, 6)] {
            all.push(Accuracy { tolerance, shadow_accuracy, occlusion_samples, ..PLAIN });
        }
    }
    all.push(Accuracy { relax: false, ..PLAIN });
    all.extend([Normals::Tetrahedron, Normals::Central].map(|normals| Accuracy { normals, ..PLAIN }));
    for (tolerance, steps, shadow_accuracy, occlusion_samples) in [
        (0.1, 128, 0.015, 6),
        (0.1, 512, 0.015, 6),
        (0.03, 512, 0.015, 6),
        (0.03, 512, 0.008, 8),
        (0.01, 1024, 0.015, 6),
        (0.01, 1024, 0.008, 8),
        (0.01, 1024, 0.004, 12),
    ] {
        all.push(Accuracy { tolerance, steps, shadow_accuracy, occlusion_samples, ..PLAIN });
    }
    let mut seen: Vec<Accuracy> = Vec::new();
    all.retain(|accuracy| {
        let is_new = !seen.contains(accuracy);
        seen.push(*accuracy);
        is_new
    });
    all
}

/// The settings, measured on examples one after the other.
#[derive(Debug, Clone)]
pub struct Study {
    /// The examples.
    pub examples: Vec<String>,
    /// The size of the picture of each that was compared with the truth, and its undecided pixels.
    pub compared: Vec<(u32, u32, usize)>,
    /// The settings, each with a point for each example.
    pub candidates: Vec<Candidate>,
}

impl Study {
    /// Of no example yet.
    pub fn new(settings: Vec<Accuracy>) -> Study {
        let candidate = |accuracy| Candidate { accuracy, measured: Vec::new() };
        Study {
            examples: Vec::new(),
            compared: Vec::new(),
            candidates: settings.into_iter().map(candidate).collect(),
        }
    }

    /// Measures an example; pictures of a frame are timed in so many rounds.
    pub fn add(&mut self, example: &Example, frame: &Frame, rounds: usize) -> Result<(), String> {
        let options = Options { attack: Some(0), ..Options::default() };
        let mut clock = Clock::default();
        let compiled = sdfc::compile(&example.name, &example.text, &options, &mut clock);
        let (_, shader) = compiled.output.ok_or(format!("{} has mistakes", example.name))?;
        let settings = self.candidates.iter().map(|candidate| Setting {
            name: candidate.accuracy.to_string(),
            knob: Knob::Preset,
            accuracy: candidate.accuracy,
            preset: None,
            is_own: false,
        });
        let settings: Vec<Setting> = settings.collect();
        let subject = Subject { name: &example.name, text: &example.text, options: &options };
        let device = Device::Named(adapter::adapter().name().name.clone());
        let session = Session::new(subject, compared(&shader, frame), NEAR);
        let stopwatch = Stopwatch { device: &device, frame, budget: HOUR, enough: Some(rounds) };
        let measured = session
            .measure(&settings, Some(&stopwatch), &|_| {}, &mut clock)
            .map_err(|error| format!("{}: {error:?}", example.name))?;
        for (candidate, row) in self.candidates.iter_mut().zip(&measured.rows) {
            let time = row.time.ok_or(format!("{}: too little time for all settings", example.name))?;
            candidate.measured.push(Point {
                time: time.ratio[1],
                rms: row.errors.rms,
                wrong: row.errors.false_hits + row.errors.false_misses,
                lost: row.errors.out_of_steps,
                depth: row.errors.depth[2],
            });
        }
        self.examples.push(example.name.clone());
        self.compared.push((measured.size.0, measured.size.1, measured.truth.undecided()));
        Ok(())
    }

    /// How a candidate stands beside the others.
    pub fn standing(&self, candidate: &Candidate) -> Standing {
        let over = |example: usize| {
            let own = candidate.measured[example];
            let as_exact = self.candidates.iter().map(|c| c.measured[example]).filter(|p| p.rms <= own.rms);
            own.time / as_exact.map(|p| p.time).fold(own.time, f64::min)
        };
        let overs: Vec<f64> = (0..self.examples.len()).map(over).collect();
        let points = &candidate.measured;
        Standing {
            time: geometric_mean(points.iter().map(|p| p.time)),
            rms: geometric_mean(points.iter().map(|p| p.rms.max(LEAST_RMS))),
            over_frontier: geometric_mean(overs.iter().copied()),
            worst: overs.iter().copied().fold(1.0, f64::max),
            wrong: points.iter().map(|p| p.wrong).sum(),
            lost: points.iter().map(|p| p.lost).sum(),
            depth: points.iter().map(|p| p.depth).fold(0.0, f64::max),
        }
    }

    /// The presets: for each the place of its setting among the candidates. All lie near the frontier of every example.
    pub fn derived(&self) -> Result<[(Quality, usize); 4], String> {
        let standings: Vec<Standing> = self.candidates.iter().map(|c| self.standing(c)).collect();
        let near = |s: &Standing| s.over_frontier <= OVER && s.worst <= WORST;
        let least = |what: &str, fits: &dyn Fn(&Standing) -> bool, of: &dyn Fn(&Standing) -> [f64; 2]| {
            let all = standings.iter().enumerate().filter(|(_, s)| near(s) && fits(s));
            let best = all.min_by(|a, b| {
                let ([a, a_then], [b, b_then]) = (of(a.1), of(b.1));
                a.total_cmp(&b).then(a_then.total_cmp(&b_then))
            });
            best.map(|(place, _)| place).ok_or(format!("no setting can be `{what}`"))
        };
        let draft = least("draft", &|_| true, &|s| [s.time, s.rms])?;
        let balanced = least("balanced", &|s| s.wrong == 0 && s.rms <= HALF_A_CODE, &|s| [s.time, s.rms])?;
        let is_right = |s: &Standing| near(s) && s.wrong == 0;
        let fewest = standings.iter().filter(|s| is_right(s)).map(|s| s.lost).min().unwrap_or(0);
        let exact = least("exact", &|s| s.wrong == 0 && s.lost == fewest, &|s| [s.depth, s.rms])?;
        let middle = (standings[balanced].rms * standings[exact].rms).sqrt();
        let fine = least("fine", &|s| s.wrong == 0 && s.rms <= middle, &|s| [s.time, s.rms])?;
        Ok([
            (Quality::Draft, draft),
            (Quality::Balanced, balanced),
            (Quality::Fine, fine),
            (Quality::Exact, exact),
        ])
    }
}

/// How far above the frontier a preset may lie, in the geometric mean of the examples and on the worst of them.
pub const OVER: f64 = 1.10;
/// The same on the worst of them.
pub const WORST: f64 = 1.3;
/// What colours of 8 bits cannot hold.
const HALF_A_CODE: f64 = 0.5;
/// Errors below this are nobody's: a thousandth of a code.
const LEAST_RMS: f64 = 1e-3;

fn geometric_mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let logarithms: Vec<f64> = numbers.map(f64::ln).collect();
    (logarithms.iter().sum::<f64>() / logarithms.len().max(1) as f64).exp()
}

/// What a table says of a setting, as [`named`] reads it back.
fn cells(accuracy: &Accuracy) -> Vec<String> {
    vec![
        accuracy.tolerance.to_string(),
        accuracy.steps.to_string(),
        if accuracy.relax { "auto" } else { "none" }.into(),
        accuracy.normals.word().into(),
        accuracy.shadow_accuracy.to_string(),
        accuracy.occlusion_samples.to_string(),
    ]
}

/// The preset of a row of the table, with the words of its settings, as the repository keeps it.
pub fn kept(text: &str) -> Vec<(String, Vec<String>)> {
    let rows = text.lines().filter(|line| line.starts_with("| `"));
    let row = |line: &str| {
        let cells: Vec<String> =
            line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
        (cells[0].trim_matches('`').to_owned(), cells[1..7].to_vec())
    };
    rows.map(row).collect()
}

/// The words of what a preset stands for, as the table has them.
pub fn named(quality: Quality) -> Vec<String> {
    cells(&quality.accuracy())
}

/// What was measured and derived, as a table: the presets first.
pub fn table(study: &Study, frame: &Frame) -> Result<Table, String> {
    let derived = study.derived()?;
    let heads = [
        "preset",
        "tolerance",
        "steps",
        "relax",
        "normals",
        "shadow_accuracy",
        "occlusion_samples",
        "time",
        "rms",
        "over the frontier",
        "worst",
        "false",
        "lost",
        "depth, px",
    ];
    let list: Vec<String> = study
        .examples
        .iter()
        .zip(&study.compared)
        .map(|(name, (w, h, undecided))| format!("{name} ({w}×{h}, {undecided} undecided)"))
        .collect();
    let about = format!(
        "Settings of accuracy, measured on all examples on {device}; `presets` in `tests/src/bin/` writes this, and a test compares
the presets of the compiler with it.

Times are of pictures of {w}×{h} pixels as multiples of that of the setting with a tolerance of 0.1, 256 steps, `shadow_accuracy`
0.015 and 6 samples of occlusion, in rounds that take turns; rms is to the true colours of the same rays, in codes of 255. Both
are geometric means over the examples. `over the frontier` is a setting's time over that of the fastest one with no larger
rms, in the geometric mean over the examples and on the worst. False hits and misses, and lost rays, are of all examples together;
depth is how far a hit is off at most. Compared with the truth were: {list}.

A preset lies at most {OVER} above the frontier in the mean and {WORST} on the worst example. Of those settings that do, `draft` is the fastest;
`balanced`, which is what a scene has that says nothing, is the fastest without a false hit or miss, and with an rms of at most half
a code, which is what 8 bits cannot hold;
`exact` has no false hit or miss either, the fewest lost rays and the least error of the depth, and of those as near the least rms; and `fine` is the fastest whose rms is no larger
than the geometric mean of the two.",
        device = adapter::title(),
        w = frame.width,
        h = frame.height,
        list = list.join(", "),
    );
    let row = |candidate: &Candidate, name: &str| {
        let s = study.standing(candidate);
        let mut row = vec![name.to_owned()];
        row.extend(cells(&candidate.accuracy));
        row.extend([
            format!("{:.3}", s.time),
            format!("{:.3}", s.rms),
            format!("{:.3}", s.over_frontier),
            format!("{:.3}", s.worst),
            s.wrong.to_string(),
            s.lost.to_string(),
            format!("{:.4}", s.depth),
        ]);
        row
    };
    let presets = derived
        .iter()
        .map(|(quality, place)| row(&study.candidates[*place], &format!("`{}`", quality.word())));
    let all = study.candidates.iter().map(|candidate| row(candidate, ""));
    Ok(Table {
        title: "The presets, and what they were chosen from".into(),
        about,
        versions: vec![adapter::version(), adapter::processor()],
        columns: heads.map(str::to_owned).to_vec(),
        rows: presets.chain(all).collect(),
    })
}
