//! The hard cases of which not the pictures matter but the values of fields, or what is said of a mistake. Each has its
//! naive twin, which must fail. `tests/tables/hard_cases.md` lists them.

use sdf_emit::{KernelLanguage, Target, emit_kernel, validate};
use sdf_ir::Program;
use sdf_lang::Options;
use sdf_tests::adapter::{self, adapter};
use sdf_tests::fields::{entry, on_hardware, run, wide};
use sdf_tests::hard::twin::Twin;
use sdf_tests::numbers::word;
use sdf_tests::run::Kernel;
use sdf_tests::scenes::scene;
use sdf_tests::swiftshader;

/// The program that computes in a process of its own.
const COMPUTE: &str = env!("CARGO_BIN_EXE_compute");

/// The distance to a scene, with the files of a twin in place of the compiler's, or without.
fn distance(text: &str, twin: Option<&str>) -> Program {
    let replaced = twin.map_or(Vec::new(), |name| Twin::named(name).replaced);
    let scene = scene("values", text, &Options { attack: Some(0), replaced, ..Options::default() });
    let map = scene.map.expect("a field");
    sdf_ir::simplify(&Program { entry: Some(map), ..scene.program }, &[]).0
}

/// The distance as hardware computes it, at these points.
fn in_f32(program: &Program, points: &[Vec<f32>]) -> Vec<f64> {
    wide(&run::<f32>(&on_hardware(program), points)).remove(0)
}

fn in_f64(program: &Program, points: &[Vec<f32>]) -> Vec<f64> {
    run::<f64>(program, &wide(points)).remove(0)
}

/// Numbers from -1 to 1, the same on every run.
fn unit(n: usize) -> f64 {
    f64::from(word(n as u64)) / f64::from(u32::MAX) * 2.0 - 1.0
}

/// Points within `reach` of the origin along each axis.
fn points(count: usize, reach: [f64; 3]) -> Vec<Vec<f32>> {
    let coordinate = |axis: usize, i: usize| (unit(3 * i + axis) * reach[axis]) as f32;
    (0..3).map(|axis| (0..count).map(|i| coordinate(axis, i)).collect()).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert!(a.iter().chain(b).all(|x| x.is_finite()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Whether both languages take the field, which naga reads.
fn is_taken(program: &Program) -> bool {
    let hardware = on_hardware(program);
    let taken = |language| emit_kernel(&hardware, entry(&hardware), language).is_ok();
    [KernelLanguage::Wgsl, KernelLanguage::Glsl450].into_iter().all(taken)
}

/// 10. The twin takes the powers of the distances themselves, which are nothing far away.
#[test]
fn a_thousand_blends_keep_their_digits() {
    let text = "scene { smin(for i in 0..1000 { sphere(0.2).at(4 * sin(i * 0.7), 0.003 * i - 1.5, 4 * cos(i * 0.7)) }, \
                k: 0.15, kind: exponential) }";
    let points = points(500, [30.0, 10.0, 30.0]);
    let chain = distance(text, None);
    let expected = in_f64(&chain, &points);
    let found = largest_difference(&in_f32(&chain, &points), &expected);
    assert!(found < 1e-4, "{found}");
    assert!(is_taken(&chain));
    let naive = in_f32(&distance(text, Some("plain_exponential")), &points);
    assert!(largest_difference(&naive, &expected) > 1e-1);
}

/// 16, 18. The twins are the functions without what they require.
#[test]
fn scales_and_periods_are_above_zero() {
    let said = |text: &str, twin: &str| -> Vec<String> {
        let replaced = if twin.is_empty() { Vec::new() } else { Twin::named(twin).replaced };
        let options = Options { attack: Some(0), replaced, ..Options::default() };
        let found = sdf_lang::compile("values", text, &options).diagnostics;
        found.into_iter().map(|d| format!("{}: {}", d.code, d.message)).collect()
    };
    for by in ["0", "-1", "(1, 0, 1)", "(1, -2, 1)"] {
        let text = format!("scene {{ sphere(1).scale({by}) }}");
        let axis = if by.starts_with('(') { " along each axis" } else { "" };
        let expected = format!("E043: by must be above 0{axis}");
        assert_eq!(said(&text, ""), std::slice::from_ref(&expected), "{by}");
        assert_ne!(said(&text, "unchecked"), [expected], "{by}");
    }
    for period in ["0", "-2"] {
        let text = format!("scene {{ sphere(1).repeat(x: {period}) }}");
        assert_eq!(said(&text, ""), ["E043: x must be above 0"], "{period}");
        assert_ne!(said(&text, "unchecked"), ["E043: x must be above 0"], "{period}");
    }
}

/// 19. The twin multiplies by the inverse of the period, as SwiftShader does where it is told to divide.
#[test]
fn the_floor_modulo_stays_in_its_period() {
    let field = |expression: &str| {
        distance(&format!("@lipschitz(1)\nlet f = field {{ {expression} }}\nscene {{ f }}"), None)
    };
    let modulo = field("p.x % 3");
    let naive = field("p.x - floor(p.x * 0.3333333432674408) * 3");
    // Multiples of 3 up to 1e7, and the numbers beside them.
    let near = |i: usize| {
        let x = (unit(i) * 3.3e6).round() as f32 * 3.0;
        [x, x.next_down(), x.next_up(), (unit(i) * 1e7) as f32]
    };
    let x: Vec<f32> = (0..20_000).flat_map(near).collect();
    let points = [x.clone(), vec![0.0; x.len()], vec![0.0; x.len()]];
    let hardware = on_hardware(&modulo);
    let mut found = vec![in_f32(&modulo, &points)];
    for language in [KernelLanguage::Wgsl, KernelLanguage::Glsl450] {
        let kernel = Kernel::of(&hardware, entry(&hardware), language, &[], &points);
        let mut drivers = vec![kernel.on_device(adapter())];
        if !adapter::is_chosen() {
            let words = swiftshader::compute(COMPUTE, &kernel).unwrap_or_else(|said| panic!("{said}"));
            drivers.push(kernel.columns(&words));
        }
        for words in drivers {
            found.push(words[0].iter().map(|bits| f64::from(f32::from_bits(*bits))).collect());
        }
    }
    let wrong = |values: &[f64]| {
        let expected = |x: &f32| f64::from(*x).rem_euclid(3.0);
        x.iter().zip(values).filter(|(x, found)| (expected(x) - **found).abs() > 1e-6).count()
    };
    assert_eq!(found.iter().map(|values| wrong(values)).collect::<Vec<_>>(), vec![0; found.len()]);
    assert!(wrong(&in_f32(&naive, &points)) > 1000);
}

/// 20. A thousand copies round an axis: near the axis, at the seam, and anywhere.
#[test]
fn a_thousand_copies_round_an_axis_are_those_written_out() {
    const SHAPE: &str =
        "(box((0.5, 0.06, 0.1)).rotate_y(0.3).at(0.6, 0, 0.1) | sphere(0.12).at(1.2, 0.1, 0))";
    let text = format!("scene {{ {SHAPE}.repeat_polar(1000) }}");
    let written = format!("scene {{ for i in 0..1000 {{ {SHAPE}.rotate_y(i * tau / 1000) }} }}");
    let mut points = points(300, [1.5, 0.5, 1.5]);
    for i in 0..100 {
        // Beside the axis, and along the seam behind it.
        let place = [
            [unit(i) * 1e-3, unit(i + 1), unit(i + 2) * 1e-3],
            [-unit(i).abs() * 2.0, 0.1, unit(i + 1) * 1e-6],
        ];
        let place = place[i % 2];
        points.iter_mut().zip(place).for_each(|(column, x)| column.push(x as f32));
    }
    let expected = in_f64(&distance(&written, None), &points);
    let copies = distance(&text, None);
    assert!(largest_difference(&in_f64(&copies, &points), &expected) < 1e-9);
    assert!(largest_difference(&in_f32(&copies, &points), &expected) < 4e-6);
    let naive = in_f64(&distance(&text, Some("own_sector")), &points);
    assert!(largest_difference(&naive, &expected) > 1e-3);
}

/// 24. The twin turns by an angle that is not known, so nothing is folded.
#[test]
fn ten_thousand_rotations_are_one() {
    let turned = |angle: &str| {
        format!(
            "{angle}\nscene {{ fold(0..10000, box((0.9, 0.2, 0.4)), |s, i| s.rotate((1, 2, 3), angle)) }}"
        )
    };
    let text = turned("let angle = 0.01");
    let once = "scene { box((0.9, 0.2, 0.4)).rotate((1, 2, 3), 100) }";
    let points = points(2000, [2.0; 3]);
    let expected = in_f64(&distance(once, None), &points);
    assert!(largest_difference(&in_f32(&distance(&text, None), &points), &expected) < 2e-6);
    let naive = drifting(&points);
    assert!(largest_difference(&naive, &expected) > 2e-5, "{}", largest_difference(&naive, &expected));
}

/// A box turned ten thousand times in `f32`, one rotation after the other.
fn drifting(points: &[Vec<f32>]) -> Vec<f64> {
    let once =
        distance("@lipschitz(1)\nlet x1 = field { rotate(p, (1, 2, 3), -0.01).x }\nscene { x1 }", None);
    let [y, z] = ["y", "z"].map(|axis| {
        distance(
            &format!("@lipschitz(1)\nlet f = field {{ rotate(p, (1, 2, 3), -0.01).{axis} }}\nscene {{ f }}"),
            None,
        )
    });
    let programs = [once, y, z].map(|program| on_hardware(&program));
    let mut turned = points.to_vec();
    for _ in 0..10_000 {
        turned = programs.each_ref().map(|program| run::<f32>(program, &turned).remove(0)).to_vec();
    }
    in_f64(&distance("scene { box((0.9, 0.2, 0.4)) }", None), &turned)
}

/// A module whose field is a union of balls in one expression.
fn one_expression(centres: &[[f64; 3]]) -> String {
    let ball = |[x, y, z]: &[f64; 3]| format!("length(p - vec3f({x:.6}, {y:.6}, {z:.6})) - 0.02");
    let union = centres.iter().fold("1e20".to_owned(), |union, c| format!("min({union}, {})", ball(c)));
    format!("fn map(p: vec3f) -> f32 {{ return {union}; }}")
}

/// 32. Not even 256 shapes are taken where they are written as one expression, the twin. A field of other places is told apart.
#[test]
fn a_union_of_twenty_thousand_is_taken() {
    let text = "scene { for i in 0..20000 { sphere(0.02).at(4 * sin(i * 0.7), 0.00015 * i - 1.5, 4 * cos(i * 0.7)) } }";
    let points = points(100, [5.0, 2.0, 5.0]);
    let union = distance(text, None);
    let centre = |i: u32| {
        let i = f64::from(i);
        [4.0 * (i * 0.7).sin(), 0.00015 * i - 1.5, 4.0 * (i * 0.7).cos()]
    };
    let centres: Vec<[f64; 3]> = (0..20_000).map(centre).collect();
    let nearest = |i: usize| {
        let to = |c: &[f64; 3]| {
            (0..3).map(|k| (f64::from(points[k][i]) - c[k]).powi(2)).sum::<f64>().sqrt() - 0.02
        };
        centres.iter().map(to).fold(f64::INFINITY, f64::min)
    };
    let expected: Vec<f64> = (0..100).map(nearest).collect();
    assert!(largest_difference(&in_f64(&union, &points), &expected) < 1e-9);
    assert!(largest_difference(&in_f32(&union, &points), &expected) < 4e-6);
    let other = distance(&text.replace("0.7", "0.7001"), None);
    assert!(largest_difference(&in_f64(&other, &points), &expected) > 1e-3);
    assert!(is_taken(&union));
    assert_eq!(validate(Target::Wgsl, &one_expression(&centres[..64])), Ok(()));
    let refused =
        validate(Target::Wgsl, &one_expression(&centres[..256])).expect_err("a text that is too deep");
    assert!(refused.message.contains("recursion"), "{refused}");
}
