//! Whole fields: every function of the standard library and every example, on the interpreter in `f32` and `f64`, on
//! the software driver, and their gradients by three ways.

use sdf_emit::KernelLanguage;
use sdf_ir::Program;
use sdf_lang::reference;
use sdf_tests::adapter::adapter;
use sdf_tests::fields::{
    Field, Spread, by_duals, entry, in_f32, nasty_points, on_hardware, points, run, spread, wide,
};
use sdf_tests::library::calls;
use sdf_tests::run::{Kernel, on_device};
use sdf_tests::scenes::examples;
use std::collections::BTreeSet;
use std::fmt::Write;

/// How many points each field is computed at on the driver.
const COUNT: usize = 1 << 16;
/// How many units the driver and the interpreter may lie apart; see [`Spread`].
const DRIVER: f64 = 4.0;
/// The largest share of points at creases and jumps, where less can be said.
const STEEP: f64 = 0.004;

#[test]
fn every_function_of_the_library_is_called() {
    let functions: BTreeSet<String> = calls().into_iter().map(|call| call.function).collect();
    let entries = reference().into_iter().flat_map(|section| section.entries).map(|entry| entry.name);
    let missing: Vec<String> =
        entries.filter(|name| name != "nothing" && !functions.contains(name)).collect();
    assert!(missing.is_empty(), "without a call: {missing:?}");
    assert!(functions.len() > 40, "the library was not found");
}

/// All fields: those of the library's functions and of the examples.
fn fields() -> Vec<(String, Field)> {
    let calls = calls().into_iter().map(|call| call.as_shape());
    let calls = calls.map(|shape| (shape.clone(), Field::of_expression(&shape)));
    let examples =
        examples().into_iter().map(|e| (format!("examples/{}", e.name), Field::of(&e.name, &e.text)));
    calls.chain(examples).collect()
}

/// The driver against the `f32` lanes, for one program.
fn on_driver(program: &Program, language: KernelLanguage, points: &[Vec<f32>]) -> Spread {
    let hardware = on_hardware(program);
    let expected = wide(&run::<f32>(&hardware, points));
    let words = on_device(adapter(), &hardware, entry(&hardware), language, points);
    let found: Vec<Vec<f64>> =
        words.iter().map(|column| column.iter().map(|w| f64::from(f32::from_bits(*w))).collect()).collect();
    spread(points, &expected, &found, DRIVER, |near| run::<f64>(program, near))
}

/// Notes a comparison in a table, and what is wrong with it.
fn note(name: &str, what: &str, spread: &Spread, table: &mut String, complaints: &mut String) {
    let Spread { points, unequal, worst, steep, wrong } = spread;
    let share = 100.0 * *unequal as f64 / *points as f64;
    let short: String = name.chars().take(60).collect();
    writeln!(
        table,
        "{short:<60} {what:<9} {points:>6} {share:>8.3}% {worst:>7.1} {steep:>6} {:>6}",
        wrong.len()
    )
    .expect("a string grows");
    if !wrong.is_empty() {
        let some = wrong.iter().take(3).map(|w| format!("    {w}\n")).collect::<String>();
        *complaints += &format!("{name}, {what}: {} wrong\n{some}", wrong.len());
    }
    if *steep as f64 > *points as f64 * STEEP {
        *complaints += &format!("{name}, {what}: {steep} of {points} points are at creases or jumps\n");
    }
}

const HEAD: &str = "field                                                        what      points  unequal   units  steep  wrong\n";

#[test]
fn the_driver_computes_what_the_lanes_compute() {
    let (mut table, mut complaints) = (String::from(HEAD), String::new());
    let points = points(COUNT);
    for (name, field) in fields() {
        for (what, program) in [("distance", &field.distance), ("gradient", &field.gradient)] {
            note(
                &name,
                what,
                &on_driver(program, KernelLanguage::Wgsl, &points),
                &mut table,
                &mut complaints,
            );
        }
    }
    keep("fields_on_driver.txt", &table);
    assert!(complaints.is_empty(), "{complaints}");
}

/// Creases pass through such points by nature, so only that all is finite and the distances agree is asked.
#[test]
fn nothing_is_infinite_at_nasty_points() {
    let (mut table, mut complaints) = (String::from(HEAD), String::new());
    let points = nasty_points();
    for (name, field) in fields() {
        for (what, language) in [("distance", KernelLanguage::Wgsl), ("in GLSL", KernelLanguage::Glsl450)] {
            let spread = Spread { steep: 0, ..on_driver(&field.distance, language, &points) };
            note(&name, what, &spread, &mut table, &mut complaints);
        }
        let hardware = on_hardware(&field.gradient);
        let words = on_device(adapter(), &hardware, entry(&hardware), KernelLanguage::Wgsl, &points);
        let lanes = run::<f32>(&hardware, &points);
        let wrong = |i: &usize| {
            lanes.iter().any(|c| !c[*i].is_finite())
                || words.iter().any(|c| !f32::from_bits(c[*i]).is_finite())
        };
        if let Some(i) = (0..points[0].len()).find(wrong) {
            let point: Vec<f32> = points.iter().map(|c| c[i]).collect();
            complaints += &format!("{name}: the gradient at {point:?} is not finite\n");
        }
    }
    keep("fields_at_nasty_points.txt", &table);
    assert!(complaints.is_empty(), "{complaints}");
}

/// The naive twin: the driver's own division, length and direction are not finite at these points. The library seldom leaves
/// it at that: what it divides by is mostly kept above 0 by itself.
#[test]
fn bare_operations_are_infinite_at_nasty_points() {
    const BARE: [(&str, &str, &str); 4] = [
        ("field { 1 / p.x }", "safe_divide", "{0} / {1}"),
        ("field { length(1000 * p) }", "safe_length_3", "length({0})"),
        ("field { length(1000 * p.xy) }", "safe_length_2", "length({0})"),
        ("field { normalize(p).x }", "safe_normalize_3", "normalize({0})"),
    ];
    let points = nasty_points();
    let is_finite = |kernel: &Kernel| {
        kernel.on_device(adapter()).iter().flatten().all(|word| f32::from_bits(*word).is_finite())
    };
    for (shape, function, expression) in BARE {
        let hardware = on_hardware(&Field::of_expression(shape).distance);
        let kernel = Kernel::of(&hardware, entry(&hardware), KernelLanguage::Wgsl, &[], &points);
        assert!(is_finite(&kernel), "{shape}");
        assert!(!is_finite(&kernel.with_bare(function, expression)), "{shape}: {function} guards nothing");
    }
}

#[test]
fn the_lanes_compute_what_the_language_means() {
    let (mut table, mut complaints) = (String::from(HEAD), String::new());
    let points = points(1 << 14);
    for (name, field) in fields() {
        note(&name, "distance", &in_f32(&field.distance, &points), &mut table, &mut complaints);
    }
    keep("fields_in_f32.txt", &table);
    assert!(complaints.is_empty(), "{complaints}");
}

/// The largest share of points that lie too near a crease for differences.
const LEFT_OUT: f64 = 0.01;
/// The step of the differences.
const STEP: f64 = 1e-5;

/// What is wrong with a gradient, by dual numbers and by differences, and how many points were left out.
fn gradient_complaint(field: &Field, points: &[Vec<f64>]) -> (usize, Option<String>) {
    let found = run::<f64>(&field.gradient, points);
    let duals = by_duals(&field.distance, points);
    let moved = |axis: usize, by: f64| {
        let mut points = points.to_vec();
        points[axis].iter_mut().for_each(|x| *x += by);
        run::<f64>(&field.distance, &points).remove(0)
    };
    let mut left_out = vec![false; points[0].len()];
    let mut complaint = None;
    for axis in 0..3 {
        let (before, after) = (moved(axis, -STEP), moved(axis, STEP));
        for i in 0..left_out.len() {
            let (here, gradient, dual) = (found[0][i], found[1 + axis][i], duals[axis][i]);
            let forward = (after[i] - here) / STEP;
            let backward = (here - before[i]) / STEP;
            let size = 1.0 + gradient.abs();
            let crease = (forward - backward).abs() > 1e-3 * size;
            left_out[i] |= crease;
            let central = (forward + backward) / 2.0;
            let agrees = (gradient - dual).abs() <= 1e-9 * size;
            if !agrees || !crease && (gradient - central).abs() > 1e-4 * size {
                let point: Vec<f64> = points.iter().map(|c| c[i]).collect();
                complaint.get_or_insert_with(|| {
                    format!(
                        "at {point:?} by axis {axis}: {gradient}, {dual} by duals, {central} by differences"
                    )
                });
            }
        }
    }
    (left_out.iter().filter(|out| **out).count(), complaint)
}

#[test]
fn gradients_are_those_of_duals_and_differences() {
    let mut table = String::from("field                                                        left out\n");
    let mut complaints = String::new();
    let points = wide(&points(1 << 13));
    for (name, field) in fields() {
        let (left_out, complaint) = gradient_complaint(&field, &points);
        let short: String = name.chars().take(60).collect();
        let share = left_out as f64 / points[0].len() as f64;
        writeln!(table, "{short:<60} {:>7.3}%", 100.0 * share).expect("a string grows");
        if share > LEFT_OUT {
            complaints += &format!("{name}: {left_out} points lie near creases\n");
        }
        if let Some(complaint) = complaint {
            complaints += &format!("{name} {complaint}\n");
        }
    }
    keep("gradients.txt", &table);
    assert!(complaints.is_empty(), "{complaints}");
}

/// The measures can fail: another radius, and the gradient of another shape.
#[test]
fn other_fields_are_told_apart() {
    let (here, there) = (Field::of_expression("sphere(0.7)"), Field::of_expression("sphere(0.70001)"));
    let points = points(1 << 10);
    let results = |field: &Field| run::<f64>(&field.distance, &wide(&points));
    let spread =
        spread(&points, &results(&here), &results(&there), DRIVER, |near| run::<f64>(&here.distance, near));
    assert_eq!(spread.wrong.len(), 1 << 10);
    let mixed = Field { gradient: Field::of_expression("sphere(0.7).at(0, 0.01, 0)").gradient, ..here };
    assert!(gradient_complaint(&mixed, &wide(&points)).1.is_some());
}

/// Prints a table, and leaves it in the folder of what was built.
fn keep(name: &str, table: &str) {
    println!("{table}");
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, table).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}
