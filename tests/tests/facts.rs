//! What is proved of fields, against the fields: no pair of points is steeper than the Lipschitz constant, and no point
//! of a shape lies outside of its box; and how much larger than needed both are. That is of whole scenes, and of what a
//! user makes a field of: areas and numbers of the library. What the library says of its solids is under attack in
//! `attack.rs`.

use sdf_ir::eval::{Machine, Tape};
use sdf_ir::region::Extent;
use sdf_ir::{Constant, Program, Role};
use sdf_lang::{Fact, Kind, Options};
use sdf_syntax::{Code, Diagnostic};
use sdf_tests::library::{Call, calls};
use sdf_tests::numbers::word;
use sdf_tests::scenes::{Example, examples, scene};
use std::fmt::Write;

/// How many pairs are tried for each field.
const PAIRS: usize = 1_000_000;
/// The distances of the pairs.
const DISTANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// How much larger than the steepest pair a constant may be, where the field is a primitive or moved rigidly.
const TIGHT_SLOPE: f64 = 1.25;
/// How much larger than the shape the box of a primitive may be.
const TIGHT_BOX: f64 = 1.10;

/// The functions that move shapes rigidly, or put them together.
const RIGID: &[&str] = &["at", "rotate", "rotate_x", "rotate_y", "rotate_z", "mirror", "union", "repeat"];

/// A field with what is proved of it.
struct Subject {
    name: String,
    fact: Fact,
    program: Program,
    tape: Tape,
}

impl Subject {
    fn new(name: &str, text: &str, row: &str) -> Subject {
        let options = Options { facts: true, attack: Some(0), ..Options::default() };
        let scene = scene(name, text, &options);
        let fact = scene.facts.iter().find(|fact| fact.name == row);
        let fact = fact.unwrap_or_else(|| panic!("{name}: no row `{row}`")).clone();
        let mut program = scene.program.clone();
        program.entry = scene.map;
        let (program, _) = sdf_ir::simplify(&program, &[]);
        let tape = Tape::compile(&program, program.entry.expect("a field"));
        Subject { name: name.into(), fact, program, tape }
    }

    fn of_call(call: &str) -> Subject {
        Subject::new(call, &format!("let subject = {call}\nscene {{ subject }}\n"), "subject")
    }

    fn of_example(example: &Example) -> Subject {
        Subject::new(&format!("examples/{}", example.name), &example.text, "union")
    }

    fn distances(&self, points: &Points, frame: usize) -> Vec<f64> {
        let mut out = vec![0.0; points[0].len()];
        let mut machine = Machine::<f64>::new(&self.tape);
        machine.set_uniforms(&self.uniforms(frame));
        machine.run(&[&points[0], &points[1], &points[2]], &mut [&mut out]);
        out
    }

    /// Values of the uniforms: the defaults, then any.
    fn uniforms(&self, frame: usize) -> Vec<Constant> {
        let value = |(i, uniform): (usize, &sdf_ir::Uniform)| {
            let any = unit(900_000_000 + (frame * 50 + i) as u64);
            match uniform.role {
                _ if frame == 0 => uniform.default,
                Role::Setting | Role::Resolution | Role::Orbit { .. } => uniform.default,
                Role::Time => Constant::Float(any * 30.0),
                Role::Mouse => Constant::Vec2([any, 1.0 - any]),
                Role::Param { range: Some((lo, hi)), .. } => Constant::Float(lo + (hi - lo) * any),
                Role::Param { .. } => uniform.default,
            }
        };
        self.program.uniforms.iter().enumerate().map(value).collect()
    }

    /// How many frames are tried: one of a field that never changes.
    fn frames(&self) -> usize {
        if self.program.uniforms.is_empty() { 1 } else { 8 }
    }
}

/// A column for each coordinate.
type Points = [Vec<f64>; 3];

fn unit(n: u64) -> f64 {
    f64::from(word(n)) / f64::from(u32::MAX)
}

/// Points of a box; along an axis without an end, of a part of it.
fn scattered(within: &Extent, count: usize, seed: u64) -> Points {
    std::array::from_fn(|axis| {
        let (lo, hi) = (within.lo[axis].max(-8.0), within.hi[axis].min(8.0));
        let (lo, hi) = if lo < hi { (lo, hi) } else { (-2.0, 2.0) };
        let x = |i: usize| lo + (hi - lo) * unit(seed * 1_000_000_007 + (i * 3 + axis) as u64);
        (0..count).map(x).collect()
    })
}

/// Points at a distance from others, in any direction.
fn moved(points: &Points, distance: f64, seed: u64) -> Points {
    let mut out = points.clone();
    for i in 0..points[0].len() {
        let n = seed * 1_000_003 + 3 * i as u64;
        let direction: [f64; 3] = std::array::from_fn(|axis| unit(n + axis as u64) * 2.0 - 1.0);
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-6);
        for (column, part) in out.iter_mut().zip(direction) {
            column[i] += part / length * distance;
        }
    }
    out
}

fn at(points: &Points, i: usize) -> [f64; 3] {
    std::array::from_fn(|axis| points[axis][i])
}

/// The room round a box in which a slope holds as well, or less.
fn near(extent: &Extent) -> Extent {
    let size = extent.size().into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max);
    extent.grown((size * 0.04).max(5e-4))
}

fn holds(extent: &Extent, p: [f64; 3]) -> bool {
    (0..3).all(|i| extent.lo[i] <= p[i] && p[i] <= extent.hi[i])
}

/// The steepest pair of points of the field, both where its constant holds, and how many were steeper than it.
fn steepest_pair(subject: &Subject) -> (f64, usize) {
    let fact = &subject.fact;
    let is_everywhere = fact.slope_everywhere <= fact.slope;
    let wide = Extent { lo: [-4.0; 3], hi: [4.0; 3] };
    let region = if is_everywhere { wide } else { near(&fact.extent) };
    let count = PAIRS / DISTANCES.len() / subject.frames();
    let (mut steepest, mut violations) = (0.0f64, 0);
    for frame in 0..subject.frames() {
        let from = scattered(&region, count, frame as u64 + 1);
        let here = subject.distances(&from, frame);
        for (k, distance) in DISTANCES.into_iter().enumerate() {
            let to = moved(&from, distance, (frame * 8 + k) as u64 + 17);
            let there = subject.distances(&to, frame);
            for i in 0..count {
                let (a, b) = (at(&from, i), at(&to, i));
                if !is_everywhere && !holds(&region, b) {
                    continue;
                }
                let length = (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt();
                let slope = (here[i] - there[i]).abs() / length;
                steepest = steepest.max(slope);
                violations += usize::from(slope > fact.slope * (1.0 + 1e-9) + 1e-10);
            }
        }
    }
    (steepest, violations)
}

/// The box round the points of the shape that were found, and how many lie outside of its proved box.
fn filled(subject: &Subject) -> (Extent, usize) {
    let extent = subject.fact.extent;
    let size = extent.size().into_iter().filter(|x| x.is_finite()).fold(1.0, f64::max);
    let tried = Extent { lo: [-4.0; 3], hi: [4.0; 3] }.union(&extent.grown(0.5 * size));
    let (mut found, mut outside) = (Extent::NONE, 0);
    let count = PAIRS / subject.frames();
    for frame in 0..subject.frames() {
        let points = scattered(&tried, count, 77 + frame as u64);
        for (i, d) in subject.distances(&points, frame).into_iter().enumerate() {
            if d <= 0.0 {
                let p = at(&points, i);
                found = found.union(&Extent { lo: p, hi: p });
                outside += usize::from(!holds(&extent, p));
            }
        }
    }
    (found, outside)
}

/// How much longer a box is than what was found in it, along the axis where that is most.
fn excess(extent: &Extent, found: &Extent) -> f64 {
    let ratio = |i: usize| extent.size()[i] / found.size()[i];
    (0..3).filter(|i| extent.size()[*i].is_finite() && found.size()[*i] > 0.0).map(ratio).fold(0.0, f64::max)
}

#[test]
fn facts_hold_and_are_tight() {
    let mut table = String::from(
        "field                                                         slope  steepest  looseness  box/shape  violations  outside\n",
    );
    let mut complaints = String::new();
    // A function of numbers may be as steep as it likes: who makes a field of it says how steep.
    let is_field = |call: &Call| match call.kind {
        Kind::Shape => false,
        _ => call.is_of_a_shape() || refusal(&call.as_shape()).is_none(),
    };
    let calls = calls().into_iter().filter(is_field);
    let subjects = calls.map(|call| (Subject::of_call(&call.as_shape()), Some(call)));
    let examples = examples();
    let scenes = examples.iter().map(|example| (Subject::of_example(example), None));
    for (subject, call) in subjects.chain(scenes) {
        let is_primitive = call.as_ref().is_some_and(Call::is_primitive);
        let is_rigid = call.is_some_and(|call| call.is_of_a_shape() && RIGID.contains(&&*call.function));
        let (steepest, violations) = steepest_pair(&subject);
        let (found, outside) = filled(&subject);
        let (slope, excess) = (subject.fact.slope, excess(&subject.fact.extent, &found));
        // Of a field that is nowhere steep there is no pair to compare with.
        let looseness = if steepest > 0.0 { slope / steepest } else { 1.0 };
        let short: String = subject.name.chars().take(60).collect();
        writeln!(
            table,
            "{short:<60} {slope:>6.3} {steepest:>9.3} {looseness:>10.3} {excess:>10.3} {violations:>11} {outside:>8}"
        )
        .expect("a string grows");
        let mut complain = |what: String| complaints += &format!("{}: {what}\n", subject.name);
        if violations > 0 {
            complain(format!("{violations} pairs are steeper than {slope}; the steepest has {steepest}"));
        }
        if outside > 0 {
            complain(format!("{outside} points of the shape lie outside of {:?}", subject.fact.extent));
        }
        if (is_primitive || is_rigid) && looseness > TIGHT_SLOPE {
            complain(format!("the constant {slope} is {looseness:.3} times the steepest pair"));
        }
        if is_primitive && excess > TIGHT_BOX {
            complain(format!("the box is {excess:.3} times as long as the shape"));
        }
    }
    println!("{table}");
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("facts.txt");
    std::fs::write(&path, &table).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(complaints.is_empty(), "{complaints}");
}

/// What is said of a scene that is this shape, if its slope has no bound.
fn refusal(shape: &str) -> Option<Diagnostic> {
    let text = format!("let subject = {shape}\nscene {{ subject }}\n");
    let options = Options { attack: Some(0), ..Options::default() };
    let found = sdf_lang::compile("refused", &text, &options).diagnostics;
    found.into_iter().find(|diagnostic| diagnostic.code == Code::E052)
}

/// A field whose slope has no bound is refused, and the message says how to state one.
#[test]
fn fields_without_a_bound_are_refused() {
    let unbounded = [
        "field { rotate(p, (1, 2, 3), p.x).y }",
        "field { rotate(p.xy, p.z).y }",
        "field { fract(p.x) - 0.5 }",
        "field { p.x * p.y - 1 }",
        "sphere(0.4).displace(|p| hash(p))",
    ];
    for shape in unbounded {
        let found = refusal(shape).unwrap_or_else(|| panic!("{shape} is not refused"));
        assert!(found.help.as_ref().is_some_and(|help| help.contains("@lipschitz(")), "{shape}");
    }
}

/// The measures can fail: a constant and a box that are a little too small are caught.
#[test]
fn wrong_facts_are_caught() {
    let mut subject = Subject::of_call("cylinder(0.6, 1.2).at(0.3, 0.1, 0.2)");
    assert_eq!((steepest_pair(&subject).1, filled(&subject).1), (0, 0));
    subject.fact.slope = 0.999;
    subject.fact.slope_everywhere = 0.999;
    subject.fact.extent.hi[1] -= 0.01;
    assert!(steepest_pair(&subject).1 > 1000);
    assert!(filled(&subject).1 > 10);
}
