//! Legal programs in `f32` against what the language means, in `f64`: accuracy where it is promised, and a finite
//! number everywhere.

use sdf_ir::eval::{Machine, Tape};
use sdf_ir::number::Number;
use sdf_ir::total::{is_basic, legalise};
use sdf_ir::{
    Binary, Builder, Constant, Function, Node, Parameter, Program, RegionId, Type, Unary, Value, rebuild,
    verify,
};

fn parameter(name: &str, ty: Type, point: bool) -> Parameter {
    Parameter { name: name.into(), ty, point }
}

fn program(parameters: Vec<Parameter>, write: impl FnOnce(&mut Builder, &[Value]) -> Value) -> Program {
    let count = parameters.len() as u16;
    let mut b = Builder::new("f", parameters);
    let arguments: Vec<Value> = (0..count).map(|i| b.argument(RegionId::ROOT, i)).collect();
    let result = write(&mut b, &arguments);
    let mut program = Program::default();
    program.entry = Some(program.add(b.finish(vec![(result, "".into())])));
    program
}

/// The scalars of the results of the legal program, in `f32`, one column each.
fn run(program: &Program, inputs: &[&[f32]]) -> Vec<Vec<f32>> {
    let legal = legalise(program);
    verify(&legal).expect("a legal program is well formed");
    for function in &legal.functions {
        assert!(nodes(function).iter().all(|node| is_basic(*node)), "{} is not legal", function.name);
    }
    let tape = Tape::compile(&legal, legal.entry.expect("an entry"));
    let mut outputs = vec![vec![0.0; inputs[0].len()]; tape.output_count()];
    let mut machine = Machine::<f32>::new(&tape);
    machine.run(inputs, &mut outputs.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
    outputs
}

fn nodes(function: &Function) -> Vec<Node> {
    let regions = (0..function.region_count()).map(|i| function.region(RegionId(i as u32)));
    regions.flat_map(|r| r.body.iter().map(|v| function.node(*v))).collect()
}

/// Also where nothing needs a guard, a vector is normalised by operations that are the same everywhere.
#[test]
fn a_vector_that_is_never_short_is_normalised_by_basic_operations() {
    let write = |b: &mut Builder, v: &[Value]| {
        let (x, three) = (b.component(v[0], 0), b.float(3.0));
        let x = b.unary(Unary::Tanh, x);
        let long = b.compose(&[x, three, three]);
        b.unary(Unary::Normalize, long)
    };
    let found = run(&program(vec![parameter("v", Type::Vec3, false)], write), &[&[0.0], &[0.0], &[0.0]]);
    assert_eq!(found[0], [0.0]);
    assert!((found[1][0] - 0.5f32.sqrt()).abs() < 1e-7);
}

/// The length of a vector whose squares are as good as nothing: right in a program of tiny things, and the naive twin, the
/// same program without the word, is far off.
#[test]
fn tiny_vectors_have_lengths_in_tiny_programs() {
    let write = |b: &mut Builder, v: &[Value]| b.unary(Unary::Length, v[0]);
    let mut program = program(vec![parameter("v", Type::Vec3, true)], write);
    let sizes = [1e-18f32, 1e-20, 1e-23, 1e-30];
    let sides = [2.0, 3.0, 6.0].map(|side| sizes.map(|size| side * size));
    let columns: Vec<&[f32]> = sides.iter().map(<[f32; 4]>::as_slice).collect();
    let worst = |program: &Program| {
        let found = run(program, &columns).remove(0);
        found.iter().zip(sizes).map(|(length, size)| (length / (7.0 * size) - 1.0).abs()).fold(0.0, f32::max)
    };
    assert!(worst(&program) > 0.9, "{}", worst(&program));
    program.is_tiny = true;
    assert!(worst(&program) < 1e-6, "{}", worst(&program));
}

/// The edges of domains and of the range of numbers, with their neighbours, of both signs.
fn edges() -> Vec<f32> {
    let mut edges =
        vec![0.0f32, f32::from_bits(1), f32::MIN_POSITIVE, 1e-30, 1e-7, 0.25, 0.5, 0.625, 1.0, 2.0, 3.0];
    edges.extend([4.0, 10.0, 87.33654, 87.336_55, 88.722_83, 88.722_84, 104.0, 126.0, 127.0, 128.0, 150.0]);
    edges.extend([1e5, 131072.0, 8388608.0, 16777216.0, 2147483648.0, 4294967296.0, 1e18, 1e19, 1e30, 1e37]);
    edges.extend([1.7e38, f32::MAX]);
    edges.extend((1..64).map(|i| (f64::from(i) * std::f64::consts::FRAC_PI_4) as f32));
    let mut all = Vec::new();
    for x in edges {
        for x in [x, x.next_up(), x.next_down()] {
            if x.is_finite() {
                all.extend([x, -x]);
            }
        }
    }
    all
}

/// Every exponent with 128 mantissas, of both signs, denormal numbers included, and the edges.
fn all_sizes() -> Vec<f32> {
    let mut all = edges();
    for exponent in 0..255u32 {
        for step in 0..128u32 {
            let x = f32::from_bits(exponent << 23 | step << 16 | ((step * 7919) & 0xffff));
            all.extend([x, -x]);
        }
    }
    all
}

/// Many numbers from `lo` to `hi`, and the edges between.
fn dense(lo: f64, hi: f64) -> Vec<f32> {
    let mut all: Vec<f32> =
        (0..=200_000).map(|i| (lo + (hi - lo) * f64::from(i) / 200_000.0) as f32).collect();
    all.extend(edges().into_iter().filter(|x| (lo..=hi).contains(&f64::from(*x))));
    all
}

/// How an error is measured: absolutely, or in proportion to the result.
#[derive(Clone, Copy)]
enum Error {
    Absolute(f64),
    Relative(f64),
}

fn is_denormal(x: f32) -> bool {
    x != 0.0 && x.abs() < f32::MIN_POSITIVE
}

fn measure(
    name: &str,
    bound: Error,
    arguments: &dyn Fn(usize) -> String,
    got: &[f32],
    wanted: &dyn Fn(usize) -> f64,
) {
    let (mut worst, mut at) = (0.0f64, 0);
    for (i, got) in got.iter().enumerate() {
        let wanted = wanted(i);
        let difference = (f64::from(*got) - wanted).abs();
        let error = match bound {
            Error::Absolute(_) => difference,
            // Results below the normal numbers may be flushed.
            Error::Relative(_) if wanted.abs() < 1.18e-38 && difference < 1.18e-38 => 0.0,
            Error::Relative(_) => difference / wanted.abs(),
        };
        if error > worst || error.is_nan() {
            (worst, at) = (error, i);
        }
    }
    let (Error::Absolute(limit) | Error::Relative(limit)) = bound;
    let kind = if matches!(bound, Error::Absolute(_)) { "absolute" } else { "relative" };
    println!("{name:12} {kind} error {worst:.2e} at {}", arguments(at));
    assert!(worst <= limit, "{name}: {worst:e} > {limit:e} at {}", arguments(at));
}

fn check_unary(op: Unary, lo: f64, hi: f64, bound: Error) {
    let program = program(vec![parameter("x", Type::Float, false)], |b, v| b.unary(op, v[0]));
    let all = all_sizes();
    assert!(all.len() >= 1 << 16);
    for (x, y) in all.iter().zip(&run(&program, &[&all])[0]) {
        assert!(y.to_bits() & 0x7f80_0000 != 0x7f80_0000, "{op:?} of {x:e} is {y}");
    }
    let x: Vec<f32> = dense(lo, hi).into_iter().filter(|x| !is_denormal(*x)).collect();
    let y = &run(&program, &[&x])[0];
    measure(&format!("{op:?}"), bound, &|i| format!("{:e}", x[i]), y, &|i| f64::unary(op, f64::from(x[i])));
}

#[test]
fn functions_of_one_number() {
    check_unary(Unary::Sin, -1e5, 1e5, Error::Absolute(1.2e-7));
    check_unary(Unary::Cos, -1e5, 1e5, Error::Absolute(1.2e-7));
    check_unary(Unary::Sin, -4.0, 4.0, Error::Absolute(1.2e-7));
    check_unary(Unary::Sin, -0.78, 0.78, Error::Relative(1.2e-7));
    check_unary(Unary::Tan, -1.57, 1.57, Error::Relative(2e-5));
    check_unary(Unary::Tan, -0.78, 0.78, Error::Relative(3e-7));
    check_unary(Unary::Asin, -2.0, 2.0, Error::Relative(3e-7));
    check_unary(Unary::Acos, -2.0, 2.0, Error::Absolute(3e-7));
    check_unary(Unary::Atan, -20.0, 20.0, Error::Relative(2e-7));
    check_unary(Unary::Atan, -1e38, 1e38, Error::Relative(2e-7));
    check_unary(Unary::Exp, -87.3, 88.7, Error::Relative(4e-7));
    check_unary(Unary::Exp2, -126.0, 127.9999, Error::Relative(3e-7));
    check_unary(Unary::Log, 1e-38, 1e38, Error::Relative(3e-7));
    check_unary(Unary::Log, 0.5, 2.0, Error::Relative(3e-7));
    check_unary(Unary::Log2, 1e-38, 100.0, Error::Relative(3e-7));
    check_unary(Unary::Log2, 0.5, 2.0, Error::Relative(4e-7));
    check_unary(Unary::Tanh, -12.0, 12.0, Error::Relative(3e-7));
    check_unary(Unary::Sqrt, -1.0, 1e6, Error::Relative(6e-8));
}

/// Where nothing but the end of the range is right.
#[test]
fn ends_of_functions_of_one_number() {
    let at = |op: Unary, x: f32| {
        let program = program(vec![parameter("x", Type::Float, false)], |b, v| b.unary(op, v[0]));
        run(&program, &[&[x]])[0][0]
    };
    for op in [Unary::Exp, Unary::Exp2] {
        assert!(at(op, f32::MAX) > 3.402e38);
        assert_eq!(at(op, -f32::MAX), 0.0);
        assert_eq!(at(op, 0.0), 1.0);
    }
    assert_eq!(at(Unary::Tanh, f32::MAX), 1.0);
    assert_eq!(at(Unary::Tanh, -f32::MAX), -1.0);
    assert_eq!(at(Unary::Log, -1.0), at(Unary::Log, f32::MIN_POSITIVE));
    assert_eq!(at(Unary::Log, 1.0), 0.0);
    assert_eq!(at(Unary::Sqrt, -1.0), 0.0);
    assert_eq!(at(Unary::Asin, 7.0), at(Unary::Asin, 1.0));
    assert_eq!(at(Unary::Acos, 1.0), 0.0);
    assert_eq!(at(Unary::Sin, 0.0), 0.0);
    assert_eq!(at(Unary::Cos, 0.0), 1.0);
}

fn check_binary(op: Binary, pairs: &[(f32, f32)], bound: Error, accurate: impl Fn(f32, f32) -> bool) {
    let parameters = vec![parameter("x", Type::Float, false), parameter("y", Type::Float, false)];
    let program = program(parameters, |b, v| b.binary(op, v[0], v[1]));
    let (x, y): (Vec<f32>, Vec<f32>) = pairs.iter().copied().unzip();
    let z = &run(&program, &[&x, &y])[0];
    for i in 0..x.len() {
        assert!(z[i].to_bits() & 0x7f80_0000 != 0x7f80_0000, "{op:?} of {:e}, {:e} is {}", x[i], y[i], z[i]);
    }
    let fit: Vec<usize> = (0..x.len())
        .filter(|i| !is_denormal(x[*i]) && !is_denormal(y[*i]) && accurate(x[*i], y[*i]))
        .collect();
    let got: Vec<f32> = fit.iter().map(|i| z[*i]).collect();
    let wanted = |i: usize| f64::binary(op, f64::from(x[fit[i]]), f64::from(y[fit[i]]));
    measure(&format!("{op:?}"), bound, &|i| format!("{:e}, {:e}", x[fit[i]], y[fit[i]]), &got, &wanted);
}

/// Pairs of edges and of numbers of all sizes, and ordinary ones.
fn pairs() -> Vec<(f32, f32)> {
    let edges = edges();
    let mut pairs: Vec<(f32, f32)> = edges.iter().flat_map(|x| edges.iter().map(|y| (*x, *y))).collect();
    let all = all_sizes();
    pairs.extend(all.iter().zip(all.iter().skip(7919).chain(&all)).map(|(x, y)| (*x, *y)));
    for i in 0..200_000u32 {
        let (a, b) = (i.wrapping_mul(2_654_435_769), i.wrapping_mul(1_640_531_527).rotate_left(9));
        pairs.push(((a as f32 / 4.3e9 - 0.5) * 20.0, (b as f32 / 4.3e9 - 0.5) * 20.0));
    }
    pairs
}

#[test]
fn functions_of_two_numbers() {
    let pairs = pairs();
    let always = |_: f32, _: f32| true;
    check_binary(Binary::Divide, &pairs, Error::Relative(3e-7), always);
    // The sign of a zero is none: a half turn is π from both sides.
    check_binary(Binary::Atan2, &pairs, Error::Absolute(4e-7), |y, _| y.to_bits() != 0x8000_0000);
    let small = |x: f32, y: f32| x.abs() < 100.0 && y.abs() > 1e-2 && y.abs() < 100.0;
    // Where the quotient is next to a whole number, rounding decides between 0 and y.
    let inside = |x: f32, y: f32| {
        let quotient = f64::from(x) / f64::from(y);
        (quotient - quotient.round()).abs() > 1e-3
    };
    check_binary(Binary::Modulo, &pairs, Error::Absolute(1e-5), |x, y| small(x, y) && inside(x, y));
    let moderate = |x: f32, y: f32| {
        let size = f64::from(x.abs()).log2() * f64::from(y);
        size.abs() < 30.0 || x == 0.0
    };
    check_binary(Binary::Power, &pairs, Error::Relative(2e-6), moderate);
    let whole = |x: f32, y: f32| moderate(x, y) && y.fract() == 0.0 && y.abs() <= 16.0;
    check_binary(Binary::Power, &pairs, Error::Relative(1.3e-6), whole);
}

#[test]
fn ends_of_functions_of_two_numbers() {
    let at = |op: Binary, x: f32, y: f32| {
        let parameters = vec![parameter("x", Type::Float, false), parameter("y", Type::Float, false)];
        run(&program(parameters, |b, v| b.binary(op, v[0], v[1])), &[&[x], &[y]])[0][0]
    };
    assert_eq!(at(Binary::Divide, 0.0, 0.0), 0.0);
    assert_eq!(at(Binary::Divide, 2.0, 0.0), f32::MAX);
    assert_eq!(at(Binary::Divide, -2.0, -0.0), -f32::MAX);
    assert_eq!(at(Binary::Divide, 1e30, -1e-30), -f32::MAX);
    assert_eq!(at(Binary::Divide, f32::MAX, 2.0), f32::MAX / 2.0);
    assert_eq!(at(Binary::Modulo, 5.0, 0.0), 0.0);
    assert_eq!(at(Binary::Modulo, -1.0, 3.0), 2.0);
    assert_eq!(at(Binary::Modulo, 1.0, -3.0), -2.0);
    assert_eq!(at(Binary::Atan2, 0.0, 0.0), 0.0);
    assert_eq!(at(Binary::Power, -2.0, 3.0), -8.0);
    assert_eq!(at(Binary::Power, -2.0, 2.0), 4.0);
    assert_eq!(at(Binary::Power, 0.0, 0.0), 1.0);
    assert_eq!(at(Binary::Power, 0.0, -1.0), f32::MAX);
    assert_eq!(at(Binary::Power, -3.0, f32::MAX), f32::MAX);
    assert_eq!(at(Binary::Power, 0.5, f32::MAX), 0.0);
}

#[test]
fn vectors_of_all_sizes() {
    let sizes: Vec<f32> = all_sizes();
    let shift =
        |k: usize| -> Vec<f32> { (0..sizes.len()).map(|i| sizes[(i * (2 * k + 1)) % sizes.len()]).collect() };
    let near =
        |k: usize| -> Vec<f32> { (0..sizes.len()).map(|i| sizes[i] * (1.0 - 0.3 * k as f32)).collect() };
    for columns in [[shift(0), shift(1), shift(2)], [near(0), near(1), near(2)]] {
        let columns =
            columns.map(|c| c.into_iter().map(|x| if x.is_finite() { x } else { 1.0 }).collect::<Vec<_>>());
        for ty in [Type::Vec2, Type::Vec3] {
            let n = ty.size();
            let inputs: Vec<&[f32]> = columns[..n].iter().map(Vec::as_slice).collect();
            let vector = |i: usize| columns[..n].iter().map(|c| f64::from(c[i])).collect::<Vec<f64>>();
            let normal = |i: &usize| columns[..n].iter().all(|c| !is_denormal(c[*i]));
            let fit: Vec<usize> = (0..sizes.len()).filter(normal).collect();
            let length = program(vec![parameter("v", ty, false)], |b, v| b.unary(Unary::Length, v[0]));
            let got = &run(&length, &inputs)[0];
            assert!(got.iter().all(|x| x.is_finite()));
            let fitting: Vec<f32> = fit.iter().map(|i| got[*i]).collect();
            measure(
                "Length",
                Error::Relative(1.1e-6),
                &|i| format!("{:?}", vector(fit[i])),
                &fitting,
                &|i| f64::length(&vector(fit[i])),
            );
            let normalize = program(vec![parameter("v", ty, false)], |b, v| b.unary(Unary::Normalize, v[0]));
            let got = run(&normalize, &inputs);
            assert!(got.iter().flatten().all(|x| x.is_finite()));
            for (k, got) in got.iter().enumerate() {
                let fitting: Vec<f32> = fit.iter().map(|i| got[*i]).collect();
                measure(
                    "Normalize",
                    Error::Absolute(3e-7),
                    &|i| format!("{:?}", vector(fit[i])),
                    &fitting,
                    &|i| {
                        let v = Constant::from_components(&vector(fit[i]));
                        Constant::unary(Unary::Normalize, v).components()[k]
                    },
                );
            }
        }
    }
}

/// How many functions the legal program has beside its own, and whether it holds this operation.
fn helpers(program: &Program) -> usize {
    legalise(program).functions.len() - program.functions.len()
}

/// A legal program has no nodes that nothing reads; otherwise this one must be as it was.
fn assert_unchanged(program: &Program) {
    assert_eq!(legalise(program).functions, [rebuild(&program.functions[0])]);
}

#[test]
fn guards_only_where_they_are_needed() {
    let point = || vec![parameter("p", Type::Vec3, true)];
    let sphere = program(point(), |b, v| {
        let center = b.constant(Constant::Vec3([1.0, 2.0, 3.0]));
        let moved = b.sub(v[0], center);
        let length = b.unary(Unary::Length, moved);
        let one = b.float(1.0);
        b.sub(length, one)
    });
    assert_unchanged(&sphere);
    let any = || vec![parameter("x", Type::Float, false)];
    let unguarded = [
        program(any(), |b, v| {
            let three = b.float(3.0);
            b.div(v[0], three)
        }),
        program(any(), |b, v| {
            let square = b.mul(v[0], v[0]);
            b.unary(Unary::Sqrt, square)
        }),
        program(point(), |b, v| {
            let dot = b.binary(Binary::Dot, v[0], v[0]);
            b.unary(Unary::Sqrt, dot)
        }),
        program(any(), |b, v| {
            let (square, one) = (b.mul(v[0], v[0]), b.float(1.0));
            let below = b.add(square, one);
            b.div(v[0], below)
        }),
    ];
    for program in &unguarded {
        assert_unchanged(program);
    }
    let guarded = [
        program(any(), |b, v| b.div(v[0], v[0])),
        program(vec![parameter("v", Type::Vec3, false)], |b, v| b.unary(Unary::Length, v[0])),
        program(point(), |b, v| b.unary(Unary::Normalize, v[0])),
        program(point(), |b, v| {
            let factor = b.float(1e15);
            let far = b.mul(v[0], factor);
            b.unary(Unary::Length, far)
        }),
    ];
    for program in guarded {
        assert_eq!(helpers(&program), 1);
    }
    let root = program(any(), |b, v| b.unary(Unary::Sqrt, v[0]));
    let legal = legalise(&root);
    assert_eq!(nodes(&legal.functions[0]).len(), 2, "a maximum and a root");
}

/// The smaller of `length(p / s)` for two divisors, by two calls.
fn two_calls(divisors: [f64; 2]) -> Program {
    let mut program = Program::default();
    let mut b =
        Builder::new("scaled", vec![parameter("p", Type::Vec3, false), parameter("s", Type::Float, false)]);
    let (p, s) = (b.argument(RegionId::ROOT, 0), b.argument(RegionId::ROOT, 1));
    let small = b.div(p, s);
    let length = b.unary(Unary::Length, small);
    let scaled = program.add(b.finish(vec![(length, "".into())]));
    let mut b = Builder::new("entry", vec![parameter("p", Type::Vec3, true)]);
    let p = b.argument(RegionId::ROOT, 0);
    let [first, second] = divisors.map(|divisor| {
        let divisor = b.float(divisor);
        b.call(scaled, &[Type::Float], &[p, divisor])[0]
    });
    let least = b.min(first, second);
    program.entry = Some(program.add(b.finish(vec![(least, "".into())])));
    program
}

#[test]
fn what_all_callers_pass_is_known() {
    assert_eq!(helpers(&two_calls([2.0, 3.0])), 0);
    // A divisor of 0 from either: both the quotient and the length are guarded.
    assert_eq!(helpers(&two_calls([2.0, 0.0])), 2);
    assert_eq!(helpers(&two_calls([0.0, 2.0])), 2);
}

#[test]
fn helpers_are_added_once_and_sine_and_cosine_share_one() {
    let program = program(vec![parameter("v", Type::Vec3, false)], |b, v| {
        let (sine, cosine) = (b.unary(Unary::Sin, v[0]), b.unary(Unary::Cos, v[0]));
        let tangent = b.unary(Unary::Tan, v[0]);
        let sum = b.add(sine, cosine);
        let sum = b.div(sum, v[0]);
        b.add(sum, tangent)
    });
    let legal = legalise(&program);
    let names: Vec<&str> = legal.functions.iter().map(|f| &*f.name).collect();
    assert_eq!(names, ["sine_cosine", "safe_divide", "tangent", "f"]);
    let calls = nodes(&legal.functions[3]).iter().filter(|n| matches!(n, Node::Call(..))).count();
    assert_eq!(calls, 9, "three each");
}
