//! Every public function of the library under attack: random and degenerate calls of each, against what its contract
//! says, and against what its shape is by definition.

use rayon::prelude::*;
use sdf_ir::Program;
use sdf_ir::eval::{Machine, Tape};
use sdf_lang::Class;
use sdf_tests::attack::calls::{Calls, calls_of, doubtful};
use sdf_tests::attack::definitions::Definitions;
use sdf_tests::attack::forms::{Form, forms};
use sdf_tests::attack::measures::{
    class_name, dents, excess, filled, not_finite, points_round, projection, rounded, size, steepest,
    steepest_pair, surface,
};
use sdf_tests::attack::points::{Points, Random, along, at, columns, exceeds, seed};
use sdf_tests::attack::search::{Found, Solid, distance_to_curve};
use sdf_tests::attack::subject::{Kind, Refusal, Sampled, Subject, kind_of};
use sdf_tests::fields::entry;
use std::collections::BTreeSet;
use std::fmt::Write;

/// At how many points an example is tried, and a call like it.
const POINTS: [usize; 2] = [100_000, 25_000];
/// For how many points the distance is searched for: of an example, and of a call like it.
const SEARCHES: [usize; 2] = [200, 20];
/// How far a projected point may lie from the surface, as a share of the size.
const PROJECTED: f64 = 1e-4;
/// The largest share of points beside which the gradient jumps.
const LEFT_OUT: f64 = 0.02;
/// How far a distance may lie from the one that was searched for, as a share of the size.
const SEARCHED: f64 = 2e-5;
/// How near to the surface a point may be for its side not to matter, as a share of the size: no flatter are the
/// flattest ellipsoids.
const SHARP: f64 = 2e-6;
/// How much longer than the shape the box of a primitive may be.
const TIGHT_BOX: f64 = 1.10;
/// The primitives whose boxes are larger, and why.
const LOOSE_BOXES: [(&str, &str); 1] =
    [("mandelbulb", "no more is proved of the set than that what leaves a ball never comes back")];
/// How much larger than the steepest pair a constant may be, where the field is a primitive or moved rigidly.
const TIGHT_SLOPE: f64 = 1.25;
/// The functions that move shapes rigidly, or put them together.
const RIGID: [&str; 11] = [
    "at",
    "rotate",
    "rotate_x",
    "rotate_y",
    "rotate_z",
    "mirror",
    "union",
    "repeat",
    "repeat_polar",
    "flip",
    "orient",
];

/// What was measured of one call.
#[derive(Debug, Default)]
struct Row {
    function: String,
    call: String,
    class: &'static str,
    left_out: f64,
    projected: f64,
    searched: Option<f64>,
    slope: f64,
    steepest: f64,
    excess: f64,
    complaints: Vec<String>,
}

impl Row {
    fn complain(&mut self, what: String) {
        self.complaints.push(format!("{}: {what}", self.call));
    }
}

/// What is attacked: a call, and what it is by definition.
struct Attack<'a> {
    form: &'a Form,
    subject: &'a Subject,
    /// By inequalities, where there is such a definition.
    solid: Option<Program>,
    /// By the points that it consists of.
    curve: Option<Program>,
    points: usize,
    searches: usize,
    is_example: bool,
}

fn attacked(attack: &Attack) -> Row {
    let subject = attack.subject;
    let mut row = Row { function: attack.form.name.clone(), call: subject.call.clone(), ..Row::default() };
    for complaint in [not_finite(subject), rounded(subject)].into_iter().flatten() {
        row.complain(complaint);
    }
    let Some(fact) = &subject.fact else { return row };
    if subject.is_nothing {
        if subject.kind.is_shape() && !fact.extent.is_empty() {
            row.complain(format!("it is nothing and has the box {:?}", fact.extent));
        }
        return row;
    }
    row.class = class_name(fact);
    row.slope = fact.slope.min(fact.slope_everywhere);
    let points = points_round(subject, attack.points);
    let sampled = subject.sample(&points);
    let (steepest_pair, violations) = steepest_pair(subject, &points, &sampled.distance);
    row.steepest = steepest_pair;
    if violations > 0 {
        row.complain(format!(
            "{violations} pairs are steeper than {}; the steepest has {steepest_pair}",
            row.slope
        ));
    }
    if fact.class != Class::Steep {
        let steepest = steepest(&sampled);
        if exceeds(steepest, 1.0 + 1e-9) {
            row.complain(format!("there is a gradient of {steepest}"));
        }
    }
    let is_tight = attack.form.is_primitive && subject.kind.is_shape() || RIGID.contains(&&*attack.form.name);
    if attack.is_example && is_tight && steepest_pair > 0.0 && row.slope > TIGHT_SLOPE * steepest_pair {
        row.complain(format!("the constant {} is far above the steepest pair, {steepest_pair}", row.slope));
    }
    if !subject.kind.is_shape() {
        return row;
    }
    if fact.is_convex
        && let Some(complaint) = dents(subject, &points, &sampled.distance)
    {
        row.complain(complaint);
    }
    if attack.is_example && attack.form.is_convex && !fact.is_convex {
        row.complain("it is said to be convex, and its example is not found to be".into());
    }
    let filled = filled(subject, &points, &sampled.distance);
    if filled.outside.0 > 0 {
        let (count, p) = filled.outside;
        row.complain(format!("{count} points of it, such as {p:?}, lie outside of {:?}", fact.extent));
    }
    row.excess = excess(fact, &filled.found, subject.kind.axes());
    // Of what is only a bound, ends may not have been found where it is thin.
    let is_loose = LOOSE_BOXES.iter().any(|(name, _)| *name == attack.form.name);
    let is_measured = (fact.class == Class::Exact || attack.is_example) && !is_loose;
    if attack.form.is_primitive && is_measured && exceeds(row.excess, TIGHT_BOX) {
        row.complain(format!(
            "its box {:?} is {:.3} times as long as {:?}",
            fact.extent, row.excess, filled.found
        ));
    }
    if fact.class == Class::Exact {
        let projection = projection(subject, &points, &sampled);
        row.left_out = projection.left_out as f64 / projection.tried.max(1) as f64;
        row.projected = projection.worst.0;
        if exceeds(row.projected, PROJECTED) {
            let (share, p) = projection.worst;
            row.complain(format!(
                "from {p:?} the gradient does not lead to the surface, by {share:.2e} of the size"
            ));
        }
        if row.left_out > LEFT_OUT {
            row.complain(format!("beside {:.2} % of the points the gradient jumps", 100.0 * row.left_out));
        }
    }
    if let Some(solid) = &attack.solid
        && let Some(complaint) = other_sign(subject, solid, &points, &sampled)
    {
        row.complain(complaint);
    }
    if fact.class == Class::Exact {
        search(attack, &mut row);
    }
    row
}

/// The numbers that a program of a point gives, in `f64`.
fn values(program: &Program, points: &Points) -> Vec<f64> {
    let tape = Tape::compile(program, entry(program));
    let mut out = vec![0.0; points[0].len()];
    Machine::<f64>::new(&tape).run(&[&points[0], &points[1], &points[2]], &mut [&mut out]);
    out
}

/// Where the field's sign is not that of the definition: at the points, and close to the surface on both sides of it.
fn other_sign(subject: &Subject, solid: &Program, points: &Points, sampled: &Sampled) -> Option<String> {
    let size = size(subject.fact());
    let mut random = Random::new(seed(&subject.call) ^ 0x516);
    let few = points.each_ref().map(|column| column.iter().copied().step_by(4).collect::<Vec<f64>>());
    let beside = surface(subject, &few).into_iter().map(|p| {
        along(p, random.direction(subject.kind.axes()), size * 10f64.powf(random.within(-6.0, -3.0)))
    });
    let beside = columns(beside);
    let differs = |points: &Points, distances: &[f64]| {
        let other = values(solid, points);
        let wrong = |i: &usize| {
            let (d, g) = (distances[*i], other[*i]);
            // At numbers that are this large a length may be off by so much.
            let lost = SHARP * size + 1e-13 * at(points, *i).iter().map(|x| x.abs()).sum::<f64>();
            d > lost && g <= 0.0 || d < -lost && g > 0.0
        };
        let all: Vec<usize> = (0..distances.len()).filter(wrong).collect();
        let worst = all.iter().copied().max_by(|a, b| distances[*a].abs().total_cmp(&distances[*b].abs()))?;
        let (p, d, g) = (at(points, worst), distances[worst], other[worst]);
        Some(format!(
            "at {} of {} points, as {p:?}, the field is {d:.3e} and the definition {g:.3e}",
            all.len(),
            distances.len()
        ))
    };
    differs(points, &sampled.distance).or_else(|| differs(&beside, &subject.distances(&beside)))
}

/// Compares distances with those that are searched for.
fn search(attack: &Attack, row: &mut Row) {
    if attack.solid.is_none() && attack.curve.is_none() {
        return;
    }
    let subject = attack.subject;
    if !attack.form.is_primitive {
        return;
    }
    let size = size(subject.fact());
    let tolerance = 1e-5 * size;
    let all = points_round(subject, attack.searches * 5);
    let sampled = subject.sample(&all);
    let outside = (0..all[0].len()).filter(|i| sampled.distance[*i] > 1e-3 * size);
    let solid = attack.solid.as_ref().map(|program| Solid::new(program, subject.kind.axes()));
    let (mut worst, mut gave_up, mut tried) = (0.0f64, 0, 0);
    let mut complaint = None;
    for i in outside.step_by(3).take(attack.searches) {
        let (p, d) = (at(&all, i), sampled.distance[i]);
        let found: Found = match (&attack.curve, &solid) {
            (Some(curve), _) => distance_to_curve(curve, p, tolerance),
            (None, Some(solid)) => {
                let g = at(&sampled.gradient, i);
                let guesses = [0.0, 0.25, 0.5, 1.0].map(|t| along(p, g, -d - t * tolerance));
                solid.distance(p, d + size, &guesses, tolerance)
            }
            (None, None) => unreachable!("there is a definition"),
        };
        tried += 1;
        // What it has found by then is true all the same.
        gave_up += usize::from(found.at_most - found.at_least > 1.5 * tolerance);
        let error = (d - found.at_most).max(found.at_least - d).max(0.0) / size;
        if error > worst {
            worst = error;
            complaint = Some(format!(
                "at {p:?} the field is {d}, the distance {} to {}",
                found.at_least, found.at_most
            ));
        }
    }
    row.searched = Some(worst);
    if worst > SEARCHED {
        row.complain(complaint.expect("there was a worst"));
    }
    if attack.is_example && gave_up * 20 > tried {
        row.complain(format!("{gave_up} of {tried} searches gave up"));
    }
}

/// All forms and the calls of each.
fn all_calls(forms: &[Form]) -> Vec<(&Form, Result<Vec<Calls>, String>)> {
    forms
        .par_iter()
        .map(|form| (form, form.examples.iter().map(|example| calls_of(form, example)).collect()))
        .collect()
}

#[test]
fn every_contract_holds() {
    // `ATTACK=sphere cargo test --test attack` attacks one function alone.
    let only = std::env::var("ATTACK").ok();
    let mut forms = forms();
    let (solids, curves) = (Definitions::solids(&forms), Definitions::curves(&forms));
    let mut complaints = Vec::new();
    forms.retain(|form| only.as_ref().is_none_or(|name| form.name == *name));
    let all = all_calls(&forms);
    let mut subjects = Vec::new();
    for (form, calls) in &all {
        if form.examples.is_empty() {
            complaints.push(format!("{} has no example", form.signature));
        }
        match calls {
            Ok(calls) => {
                for calls in calls {
                    complaints.extend(calls.complaints.iter().cloned());
                    subjects
                        .extend(calls.subjects.iter().enumerate().map(|(i, subject)| (*form, i, subject)));
                }
            }
            Err(complaint) => complaints.push(complaint.clone()),
        }
    }
    let rows: Vec<Row> = subjects
        .par_iter()
        .map(|(form, i, subject)| {
            let mut said = Vec::new();
            let mut definition = |definitions: &Definitions, kind| {
                let has = definitions.has(&form.name);
                has.then(|| definitions.program(&form.name, &subject.call, kind))
                    .and_then(|program| program.map_err(|error| said.push(error)).ok())
            };
            let is_shape = subject.kind.is_shape() && !subject.is_nothing;
            let (solid, curve) = match is_shape {
                true => (definition(&solids, subject.kind), definition(&curves, Kind::Solid)),
                false => (None, None),
            };
            let is_exact = subject.fact.as_ref().is_some_and(|fact| fact.class == Class::Exact);
            if is_shape && is_exact && solid.is_none() && curve.is_none() {
                said.push(format!("{} has no definition", form.name));
            }
            let is_example = *i == 0;
            let [points, searches] = [POINTS, SEARCHES].map(|counts| counts[usize::from(!is_example)]);
            let mut row = attacked(&Attack { form, subject, solid, curve, points, searches, is_example });
            row.complaints.extend(said);
            row
        })
        .collect();
    let mut table = format!(
        "{:<14} {:<70} {:<6} {:>8} {:>9} {:>9} {:>7} {:>8} {:>6}\n",
        "function", "call", "class", "left out", "projected", "searched", "slope", "steepest", "box"
    );
    for row in &rows {
        let short: String = row.call.chars().take(70).collect();
        let searched = row.searched.map_or("-".into(), |x| format!("{x:.1e}"));
        writeln!(
            table,
            "{:<14} {short:<70} {:<6} {:>7.3}% {:>9.1e} {searched:>9} {:>7.3} {:>8.4} {:>6.3}",
            row.function,
            row.class,
            100.0 * row.left_out,
            row.projected,
            row.slope,
            row.steepest,
            row.excess
        )
        .expect("a string grows");
        complaints.extend(row.complaints.iter().cloned());
    }
    keep("attack.txt", &table);
    complaints.dedup();
    assert!(complaints.is_empty(), "{} complaints:\n{}", complaints.len(), complaints.join("\n"));
}

/// What a form requires that never refused a call, or refuses without a word of the parameter.
fn idle_requirements(form: &Form) -> Vec<String> {
    let mut waiting: BTreeSet<&str> = form.requirements.iter().map(String::as_str).collect();
    let mut complaints = Vec::new();
    for message in &form.requirements {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        if !message.split(|c| !is_word(c)).any(|word| form.parameters.iter().any(|p| p == word)) {
            complaints.push(format!("{}: \"{message}\" names no parameter", form.name));
        }
    }
    for example in &form.examples {
        if waiting.is_empty() {
            break;
        }
        let Ok(kind) = kind_of(example) else { continue };
        for call in doubtful(form, example) {
            if waiting.is_empty() {
                break;
            }
            if let Err(Refusal::Required(messages)) = Subject::new(&call, kind) {
                waiting.retain(|message| !messages.iter().any(|m| m.contains(message)));
            }
        }
    }
    complaints.extend(waiting.iter().map(|message| format!("{}: \"{message}\" refused nothing", form.name)));
    complaints
}

#[test]
fn what_is_required_refuses_calls() {
    let complaints: Vec<String> = forms().par_iter().flat_map(idle_requirements).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// A shape of a user's file under attack as if it were the library's `sphere(0.5)`.
fn impostor(items: &str) -> Row {
    let forms = forms();
    let form = forms.iter().find(|form| form.name == "sphere").expect("a sphere");
    let subject = Subject::with(items, "impostor()").unwrap_or_else(|refusal| panic!("{items}: {refusal:?}"));
    let solids = Definitions::solids(&forms);
    let solid = Some(solids.program("sphere", "sphere(0.5)", Kind::Solid).expect("a definition"));
    let curve = None;
    attacked(&Attack {
        form,
        subject: &subject,
        solid,
        curve,
        points: 20_000,
        searches: 20,
        is_example: true,
    })
}

/// Each measure can fail: of shapes that are a little wrong in one way each.
#[test]
fn impostors_are_caught() {
    let right = "@exact @convex @bounds(-0.5, 0.5) fn impostor() = field { length(p) - 0.5 }";
    let caught = impostor(right).complaints;
    assert!(caught.is_empty(), "{caught:?}");
    let wrong = [
        ("another radius", "length(p) - 0.501", "the definition"),
        ("another radius, by distances", "length(p) - 0.501", "the distance"),
        ("another place", "length(p - (0.0001, 0, 0)) - 0.5", "the definition"),
        ("a steep slope", "(length(p) - 0.5) * 1.001", "are steeper"),
        ("a steep gradient", "(length(p) - 0.5) * 1.001", "there is a gradient of 1.001"),
        ("a bound that claims to be exact", "(length(p) - 0.5) * 0.999", "does not lead to the surface"),
        ("a bound, by distances", "(length(p) - 0.5) * 0.999", "the distance"),
        ("a corner cut off", "max(length(p) - 0.5, p.x - 0.4)", "the definition"),
        ("the maximum of two", "max(abs(p.x), abs(p.y), abs(p.z)) - 0.5", "does not lead to the surface"),
        ("a jump", "if p.x * 0.0001 > 0.00003 { length(p) - 0.5 } else { length(p) - 0.499 }", "are steeper"),
        ("no number far away", "length(p) - 0.5 - p.x * p.x * p.x * 1e-36", "is not finite"),
        ("lost digits", "sqrt(max(dot(p, p) + 100000, 1) - 100000) - 0.5", "in f32 and in f64"),
    ];
    for (what, formula, said) in wrong {
        let items = format!("@exact @bounds(-0.501, 0.501) fn impostor() = field {{ {formula} }}");
        let caught = impostor(&items).complaints;
        assert!(caught.iter().any(|complaint| complaint.contains(said)), "{what}: {caught:?}");
    }
    let too_small = "@exact @bounds(-0.5, (0.5, 0.4995, 0.5)) fn impostor() = field { length(p) - 0.5 }";
    let too_large = "@exact @bounds(-0.5, (0.5, 0.65, 0.5)) fn impostor() = field { length(p) - 0.5 }";
    let too_slack = "@lipschitz(1.3) @bounds(-0.5, 0.5) fn impostor() = field { length(p) - 0.5 }";
    for (items, said) in [(too_small, "lie outside"), (too_large, "times as long"), (too_slack, "far above")]
    {
        let caught = impostor(items).complaints;
        assert!(caught.iter().any(|complaint| complaint.contains(said)), "{items}: {caught:?}");
    }
}

/// Prints a table, and leaves it in the folder of what was built.
fn keep(name: &str, table: &str) {
    println!("{table}");
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, table).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}
