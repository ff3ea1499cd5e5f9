//! `sdfc check --certify`: what the march finds, against what certainly is there.

use crate::failure::Failure;
use crate::moments::{Moment, moments};
use crate::output::{aligned, print};
use crate::progress::Progress;
use crate::terminal::Terminal;
use sdf_render::certify::{Certifier, Functions, Picture, Places, Report, interpreted};
use sdf_syntax::{Code, Diagnostic};
use sdfc::{Compiled, Measured, Scene, scene_word};
use serde::Serialize;

/// At how many points of each pixel's ray the march's step is tried.
const STEPS: usize = 1;

/// The share of a picture's pixels of which nothing may be proved without a word about it.
const AMBIGUOUS: f64 = 0.005;

/// What came of a scene.
pub struct Judgement {
    /// Whether nothing that was found certainly is wrong.
    pub is_right: bool,
    /// What is to be said of it besides.
    pub warnings: Vec<Diagnostic>,
}

/// Judges the pictures of a scene at all its moments, prints a row for each, and says what is wrong. The scene was
/// compiled with a probe and a certificate.
pub fn run(
    name: &str,
    compiled: &Compiled,
    scene: &Scene,
    size: (u32, u32),
    terminal: &Terminal,
) -> Result<Judgement, Failure> {
    let moments = moments(&scene.program, size);
    let progress = Progress::new("certifying");
    let mut rows = Vec::new();
    for (i, moment) in moments.iter().enumerate() {
        let show = |part: f64| progress.show((i as f64 + part) / moments.len() as f64);
        rows.push((moment, judge(scene, moment, show)));
    }
    progress.end();
    let text = if terminal.is_for_programs() {
        rows.iter().map(|(moment, report)| line(name, moment, report)).collect()
    } else {
        table(name, &rows)
    };
    print(text.as_bytes())?;
    for (moment, report) in rows.iter().filter(|(_, report)| !report.is_right()) {
        terminal.wrong(
            &failures(name, moment, report),
            "this is a mistake in sdfc, not in the scene, unless a promise of \
            the scene is false; please report it with the scene",
        );
    }
    Ok(Judgement {
        is_right: rows.iter().all(|(_, report)| report.is_right()),
        warnings: warnings(compiled, &rows),
    })
}

/// What is doubtful, each of the moment at which it is most.
fn warnings(compiled: &Compiled, rows: &[(&Moment, Report)]) -> Vec<Diagnostic> {
    let worst = |kind: fn(&Report) -> &Places| rows.iter().max_by_key(|(_, report)| kind(report).count);
    let ambiguous = worst(|report| &report.ambiguous)
        .filter(|(_, report)| report.ambiguous.count as f64 > AMBIGUOUS * report.pixels as f64)
        .map(|(moment, report)| ambiguous(compiled, moment, report));
    let lost = worst(|report| &report.out_of_steps).and_then(|(_, report)| {
        let measured = Measured { rays: report.pixels, lost: report.out_of_steps.count, range: None };
        measured.warning(&compiled.tree)
    });
    ambiguous.into_iter().chain(lost).collect()
}

fn ambiguous(compiled: &Compiled, moment: &Moment, report: &Report) -> Diagnostic {
    let Places { count, first } = &report.ambiguous;
    let share = 100.0 * *count as f64 / report.pixels as f64;
    let message = format!(
        "what {count} of {} pixels show cannot be proved ({share:.2} %){}: the field comes to zero there, or nearly so, \
        without changing its sign",
        report.pixels,
        with(moment)
    );
    Diagnostic::new(Code::W006, scene_word(&compiled.tree), message)
        .label(format!("ambiguous at {}", listed(*count, first)))
        .help(
            "move the eye, if it stands on a surface or looks along one; give a thickness to what has none; what \
            the march finds at other pixels is proved",
        )
}

fn judge(scene: &Scene, moment: &Moment, progress: impl Fn(f64) + Sync) -> Report {
    let (Some(certificate), Some(probe)) = (scene.certificate, scene.probe) else {
        unreachable!("the scene was compiled with a probe and a certificate")
    };
    let functions = Functions { map: scene.map, ray: certificate.ray, step: certificate.step };
    let certifier = Certifier::new(&scene.program, functions, &moment.frame);
    let found = interpreted(&scene.program, probe, &moment.frame);
    let picture = Picture { width: moment.frame.width as usize, found: &found, steps: STEPS };
    certifier.judge_picture(&picture, progress)
}

/// The names of the columns, and what each shows of a report.
type Column = (&'static str, fn(&Report) -> String);

const COLUMNS: [Column; 10] = [
    ("certified", |r| format!("{}/{}", r.certified, r.pixels)),
    ("false hits", |r| r.false_hits.count.to_string()),
    ("false misses", |r| r.false_misses.count.to_string()),
    ("ambiguous", |r| r.ambiguous.count.to_string()),
    ("out of steps", |r| r.out_of_steps.count.to_string()),
    ("depth off", |r| format!("{:.3}", r.largest_late)),
    ("normal off", |r| format!("{:.4}°", r.largest_turn)),
    ("unsafe steps", |r| format!("{}/{}", r.unsafe_steps.count, r.steps)),
    ("undecided", |r| r.undecided_steps.count.to_string()),
    ("least free", |r| format!("{:.2}", r.least_free_share)),
];

/// A row for each moment, under the name of the scene; depths are off by tolerances.
fn table(name: &str, rows: &[(&Moment, Report)]) -> String {
    let heads: Vec<String> =
        [name.to_string()].into_iter().chain(COLUMNS.map(|(head, _)| head.to_string())).collect();
    let cells = |(moment, report): &(&Moment, Report)| -> Vec<String> {
        let first =
            if moment.name.is_empty() { "  as it is".to_string() } else { format!("  {}", moment.name) };
        [first].into_iter().chain(COLUMNS.map(|(_, show)| show(report))).collect()
    };
    let lines: Vec<Vec<String>> = [heads].into_iter().chain(rows.iter().map(cells)).collect();
    aligned(&lines).concat()
}

/// What is wrong at a moment, with the first pixels of each kind, so that they can be looked at.
fn failures(name: &str, moment: &Moment, report: &Report) -> String {
    let kinds = [
        ("false hit", &report.false_hits),
        ("false miss", &report.false_misses),
        ("unsafe step", &report.unsafe_steps),
        ("pixel that is not finite", &report.not_finite),
    ];
    let said = kinds.into_iter().filter(|(_, places)| places.count > 0).map(|(kind, places)| {
        let plural = match (places.count, kind) {
            (1, _) => kind.to_string(),
            (_, "false miss") => "false misses".to_string(),
            (_, "pixel that is not finite") => "pixels that are not finite".to_string(),
            _ => format!("{kind}s"),
        };
        format!("{} {plural} at {}", places.count, listed(places.count, &places.first))
    });
    format!("{name}{}: {}", with(moment), said.collect::<Vec<_>>().join("; "))
}

/// The first of some pixels.
fn listed(count: usize, first: &[(usize, usize)]) -> String {
    let listed: Vec<String> = first.iter().map(|(x, y)| format!("({x}, {y})")).collect();
    listed.join(" ") + if count > first.len() { ", …" } else { "" }
}

/// What is other at a moment than in the scene as it is, as the end of a phrase.
fn with(moment: &Moment) -> String {
    if moment.name.is_empty() { String::new() } else { format!(" with {}", moment.name) }
}

/// A report for programs.
#[derive(Serialize)]
struct Line<'a> {
    scene: &'a str,
    moment: &'a str,
    pixels: usize,
    certified: usize,
    false_hits: Kind<'a>,
    false_misses: Kind<'a>,
    ambiguous: Kind<'a>,
    out_of_steps: Kind<'a>,
    not_finite: Kind<'a>,
    wrong_normals: Kind<'a>,
    depth_off: f64,
    normal_off: f64,
    steps: usize,
    least_free_share: f64,
    unsafe_steps: Kind<'a>,
    undecided_steps: Kind<'a>,
}

/// How many pixels there are of a kind, and the first, as columns and rows from the top left.
#[derive(Serialize)]
struct Kind<'a> {
    count: usize,
    first: &'a [(usize, usize)],
}

/// A line of JSON.
fn line(scene: &str, moment: &Moment, report: &Report) -> String {
    fn kind(places: &Places) -> Kind<'_> {
        Kind { count: places.count, first: &places.first }
    }
    let line = Line {
        scene,
        moment: &moment.name,
        pixels: report.pixels,
        certified: report.certified,
        false_hits: kind(&report.false_hits),
        false_misses: kind(&report.false_misses),
        ambiguous: kind(&report.ambiguous),
        out_of_steps: kind(&report.out_of_steps),
        not_finite: kind(&report.not_finite),
        wrong_normals: kind(&report.wrong_normals),
        depth_off: report.largest_late,
        normal_off: report.largest_turn,
        steps: report.steps,
        least_free_share: report.least_free_share,
        unsafe_steps: kind(&report.unsafe_steps),
        undecided_steps: kind(&report.undecided_steps),
    };
    serde_json::to_string(&line).unwrap_or_else(|error| unreachable!("numbers and strings: {error}")) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use sdfc::Frame;

    fn moment(name: &str) -> Moment {
        Moment { name: name.into(), frame: Frame::new(4, 2) }
    }

    #[test]
    fn failures_are_named_with_their_pixels() {
        let places = |count, first: &[(usize, usize)]| Places { count, first: first.to_vec() };
        let report = Report {
            false_hits: places(1, &[(3, 1)]),
            false_misses: places(9, &[(0, 0), (1, 0)]),
            ambiguous: places(1, &[(2, 0)]),
            ..Report::default()
        };
        assert_eq!(
            failures("a.sdf", &moment("size = 2"), &report),
            "a.sdf with size = 2: 1 false hit at (3, 1); 9 false misses at (0, 0) (1, 0), …"
        );
        assert!(!report.is_right());
    }

    #[test]
    fn columns_are_as_wide_as_what_stands_in_them() {
        let report =
            Report { pixels: 8, certified: 7, largest_late: 1.25, steps: 12_345_678, ..Report::default() };
        let (still, later) = (moment(""), moment("time = 10000"));
        let table = table("a.sdf", &[(&still, Report::default()), (&later, report)]);
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.chars().count() == lines[0].chars().count()), "{table}");
        assert!(lines[1].starts_with("  as it is ") && lines[2].starts_with("  time = 10000 "), "{table}");
        assert!(lines[2].contains("7/8") && lines[2].contains("1.250"), "{table}");
    }
}
