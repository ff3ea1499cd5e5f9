//! The tape against the walk over single points, and against itself: sizes of blocks, vector instructions.

use sdf_ir::eval::{Machine, Tape, point, run_parallel};
use sdf_ir::number::Number;
use sdf_ir::{
    Binary, Builder, Constant, Function, FunctionId, Global, Parameter, Program, Role, Ternary, Type, Unary,
    Uniform, Value,
};

fn parameter(name: &str, ty: Type) -> Parameter {
    Parameter { name: name.into(), ty, point: false }
}

/// A function of these parameters, whose arguments `write` gets.
fn function(
    name: &str,
    types: &[Type],
    write: impl FnOnce(&mut Builder, &[Value]) -> Vec<Value>,
) -> Function {
    let mut b = Builder::new(name, Vec::new());
    let arguments: Vec<Value> = types.iter().map(|ty| b.add_parameter(parameter("a", *ty))).collect();
    let results = write(&mut b, &arguments);
    b.finish(results.into_iter().map(|v| (v, "".into())).collect())
}

/// A program of one function.
fn single(types: &[Type], write: impl FnOnce(&mut Builder, &[Value]) -> Vec<Value>) -> Program {
    let mut program = Program::default();
    program.entry = Some(program.add(function("f", types, write)));
    program
}

/// A simple generator of numbers: the n-th is the same on every run.
fn noise(n: usize) -> f64 {
    let mut h = (n as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ (h >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((h ^ (h >> 29)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Scalars for an argument of each type, as points: some nasty, most ordinary.
fn columns<N: Number>(types: &[Type], points: usize) -> Vec<Vec<N>> {
    let nasty = [0.0, -0.0, 1.0, -1.0, 0.5, 1.5, 2.5, 1e-30, 3e5];
    let mut columns = Vec::new();
    for ty in types {
        for _ in 0..ty.size() {
            let k = columns.len();
            let number = |i: usize| {
                let n = i * 7 + k * 100_003;
                if *ty == Type::Bool {
                    N::from_bool(noise(n) < 0.5)
                } else if i.is_multiple_of(5) {
                    N::from_f64(nasty[(i / 5 + k) % nasty.len()])
                } else {
                    N::from_f64((noise(n) * 8.0 - 4.0) as f32 as f64)
                }
            };
            columns.push((0..points).map(number).collect());
        }
    }
    columns
}

fn run<N: Number>(tape: &Tape, columns: &[Vec<N>], points: usize, avx2: bool) -> Vec<Vec<N>> {
    let mut machine = Machine::<N>::new(tape);
    machine.allow_avx2(avx2);
    let mut outputs = vec![vec![N::from_f64(0.0); points]; tape.output_count()];
    let inputs: Vec<&[N]> = columns.iter().map(Vec::as_slice).collect();
    machine.run(&inputs, &mut outputs.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
    outputs
}

fn constants(types: &[Type], columns: &[Vec<f64>], i: usize) -> Vec<Constant> {
    let mut next = columns.iter().map(|c| c[i]);
    let constant = |ty: &Type| match ty {
        Type::Bool => Constant::Bool(next.next().unwrap() != 0.0),
        _ => Constant::from_components(&next.by_ref().take(ty.size()).collect::<Vec<_>>()),
    };
    types.iter().map(constant).collect()
}

fn scalars(constants: &[Constant]) -> Vec<f64> {
    let of = |c: &Constant| match c {
        Constant::Bool(b) => vec![f64::from(*b)],
        c => c.components().to_vec(),
    };
    constants.iter().flat_map(of).collect()
}

/// The tape must say for each point what the walk says, to the bit, in `f64`; and the same with and without
/// vector instructions, in `f32`.
fn check(name: &str, program: &Program, points: usize) {
    let entry = program.entry.expect("an entry");
    let types: Vec<Type> = program.function(entry).parameters.iter().map(|p| p.ty).collect();
    let tape = Tape::compile(program, entry);
    let inputs = columns::<f64>(&types, points);
    let outputs = run(&tape, &inputs, points, true);
    let defaults: Vec<Constant> = program.uniforms.iter().map(|u| u.default).collect();
    for i in 0..points {
        let arguments = constants(&types, &inputs, i);
        let wanted: Vec<u64> =
            scalars(&point(program, entry, &arguments, &defaults)).iter().map(|x| x.to_bits()).collect();
        let got: Vec<u64> = outputs.iter().map(|o| o[i].to_bits()).collect();
        assert_eq!(got, wanted, "{name} at {arguments:?}");
    }
    let inputs = columns::<f32>(&types, points);
    let bits = |outputs: Vec<Vec<f32>>| -> Vec<Vec<u32>> {
        let column = |c: Vec<f32>| c.into_iter().map(|x| if x.is_nan() { !0 } else { x.to_bits() }).collect();
        outputs.into_iter().map(column).collect()
    };
    let (with, without) = (run(&tape, &inputs, points, true), run(&tape, &inputs, points, false));
    assert_eq!(bits(with), bits(without), "{name}, with and without AVX2");
}

const FLOATS: [Type; 3] = [Type::Float, Type::Vec2, Type::Vec3];

/// The types that an operation takes. A new operation does not compile here until it has a line.
fn unary_types(op: Unary) -> &'static [Type] {
    match op {
        Unary::Not => &[Type::Bool],
        Unary::Length | Unary::Normalize | Unary::Hash => &FLOATS,
        Unary::ReduceAngle => &[Type::Float],
        Unary::Negate
        | Unary::Abs
        | Unary::Sign
        | Unary::Floor
        | Unary::Ceil
        | Unary::Round
        | Unary::Trunc
        | Unary::Sqrt
        | Unary::Sin
        | Unary::Cos
        | Unary::Tan
        | Unary::Asin
        | Unary::Acos
        | Unary::Atan
        | Unary::Exp
        | Unary::Exp2
        | Unary::Log
        | Unary::Log2
        | Unary::Tanh
        | Unary::PowerOfTwo
        | Unary::Exponent
        | Unary::Mantissa => &FLOATS,
    }
}

/// The pairs of types that an operation takes.
fn binary_types(op: Binary) -> Vec<(Type, Type)> {
    match op {
        Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => vec![
            (Type::Float, Type::Float),
            (Type::Vec2, Type::Vec2),
            (Type::Vec3, Type::Vec3),
            (Type::Float, Type::Vec3),
            (Type::Vec2, Type::Float),
        ],
        Binary::Modulo | Binary::Min | Binary::Max | Binary::Power | Binary::Atan2 => {
            FLOATS.iter().map(|ty| (*ty, *ty)).collect()
        }
        Binary::Dot => vec![(Type::Vec2, Type::Vec2), (Type::Vec3, Type::Vec3)],
        Binary::Cross => vec![(Type::Vec3, Type::Vec3)],
        Binary::Less | Binary::LessEqual => vec![(Type::Float, Type::Float)],
        Binary::Equal => vec![(Type::Float, Type::Float), (Type::Bool, Type::Bool)],
        Binary::And | Binary::Or => vec![(Type::Bool, Type::Bool)],
    }
}

/// Whether an operation works on the bits of a number of a kind that not every number is.
fn wants_whole_or_positive(op: Unary) -> bool {
    matches!(op, Unary::PowerOfTwo | Unary::Exponent | Unary::Mantissa)
}

#[test]
fn every_unary_operation() {
    for op in Unary::ALL {
        for ty in unary_types(op) {
            let program = single(&[*ty], |b, a| {
                let mut a = a[0];
                if wants_whole_or_positive(op) {
                    a = b.unary(Unary::Abs, a);
                    let one = b.float(1.0);
                    let one = b.splat(one, *ty);
                    a = b.max(a, one);
                    a = b.unary(Unary::Floor, a);
                    let most = b.float(100.0);
                    let most = b.splat(most, *ty);
                    a = b.min(a, most);
                }
                vec![b.unary(op, a)]
            });
            check(&format!("{op:?} of {ty:?}"), &program, 257);
        }
    }
}

#[test]
fn every_binary_operation() {
    for op in Binary::ALL {
        for (a, c) in binary_types(op) {
            let program = single(&[a, c], |b, v| vec![b.binary(op, v[0], v[1])]);
            check(&format!("{op:?} of {a:?} and {c:?}"), &program, 257);
            if a == Type::Float && c == Type::Float {
                let program = single(&[a], |b, v| {
                    let c = b.float(1.5);
                    let (left, right) = (b.binary(op, c, v[0]), b.binary(op, v[0], c));
                    vec![left, right, b.binary(op, v[0], v[0])]
                });
                check(&format!("{op:?} with a constant"), &program, 257);
            }
        }
    }
}

#[test]
fn every_ternary_operation() {
    for op in Ternary::ALL {
        for ty in FLOATS {
            let types = match op {
                Ternary::Select => [Type::Bool, ty, ty],
                Ternary::Mix => [ty, ty, Type::Float],
            };
            let program = single(&types, |b, v| vec![b.ternary(op, v[0], v[1], v[2])]);
            check(&format!("{op:?} of {ty:?}"), &program, 257);
        }
    }
    for constant in 0..3 {
        let program = single(&[Type::Float; 3], |b, v| {
            let mut v = v.to_vec();
            v[constant] = b.float(0.25);
            let zero = b.float(0.0);
            let condition = b.binary(Binary::Less, v[0], zero);
            vec![b.ternary(Ternary::Mix, v[0], v[1], v[2]), b.select(condition, v[1], v[2])]
        });
        check("mix and select with a constant", &program, 257);
    }
}

/// `if a < b { (a·b, a) } else { (b - a, if b < 1 { a + 1 } else { b }) }`
fn nested_branches() -> Program {
    single(&[Type::Float, Type::Vec2], |b, v| {
        let (a, y) = (v[0], b.component(v[1], 1));
        let one = b.float(1.0);
        let condition = b.binary(Binary::Less, a, y);
        let then = b.open_region(&[]);
        let product = b.mul(a, v[1]);
        b.close_region(vec![product, a]);
        let otherwise = b.open_region(&[]);
        let difference = b.sub(v[1], a);
        let inner = b.binary(Binary::Less, y, one);
        let first = b.open_region(&[]);
        let sum = b.add(a, one);
        b.close_region(vec![sum]);
        let second = b.open_region(&[]);
        b.close_region(vec![y]);
        let inner = b.branch(inner, first, second)[0];
        b.close_region(vec![difference, inner]);
        let mut results = b.branch(condition, then, otherwise);
        results.push(b.mul(a, a));
        results
    })
}

/// Up to `count` rounds of `(x, y, z) → (y + i, z, y)`, which passes parts of the state round, with a branch inside and
/// another loop in that; ends where x exceeds a limit that differs from lane to lane.
fn nested_loops(count: u32) -> Program {
    single(&[Type::Float, Type::Float], |b, v| {
        let limit = b.mul(v[1], v[1]);
        let z = b.mul(v[0], v[1]);
        let (x, y) = (v[0], v[1]);
        let until = b.open_region(&[Type::Float; 3]);
        let x0 = b.argument(until, 0);
        let stop = b.binary(Binary::Less, limit, x0);
        b.close_region(vec![stop]);
        let next = b.open_region(&[Type::Float; 4]);
        let (i, x1, y1) = (b.argument(next, 0), b.argument(next, 1), b.argument(next, 2));
        let z1 = b.argument(next, 3);
        let odd = b.binary(Binary::Less, x1, y1);
        let then = b.open_region(&[]);
        let inner_until = b.open_region(&[Type::Float]);
        let s = b.argument(inner_until, 0);
        let big = b.binary(Binary::Less, x1, s);
        b.close_region(vec![big]);
        let inner_next = b.open_region(&[Type::Float, Type::Float]);
        let (j, s) = (b.argument(inner_next, 0), b.argument(inner_next, 1));
        let s = b.add(s, j);
        b.close_region(vec![s]);
        let inner = b.repeat(5, &[i], inner_until, inner_next)[0];
        let inner = b.add(inner, limit);
        b.close_region(vec![inner]);
        let otherwise = b.open_region(&[]);
        b.close_region(vec![i]);
        let added = b.branch(odd, then, otherwise)[0];
        let sum = b.add(y1, added);
        b.close_region(vec![sum, z1, y1]);
        let mut results = b.repeat(count, &[x, y, z], until, next);
        results.push(limit);
        results
    })
}

/// Uniforms, a global made of them, a callee large enough to stay one and a small one with two results.
fn calls_and_globals() -> Program {
    let uniform = |name: &str, default: Constant| Uniform {
        name: name.into(),
        ty: default.ty(),
        role: Role::Param { range: None, color: false },
        default,
    };
    let mut program = Program {
        uniforms: vec![uniform("k", Constant::Float(0.75)), uniform("on", Constant::Bool(true))],
        globals: vec![Global { name: "g".into(), ty: Type::Vec2 }],
        ..Program::default()
    };
    program.frame = Some(program.add(function("frame", &[], |b, _| {
        let k = b.uniform(0, Type::Float);
        let sine = b.unary(Unary::Sin, k);
        vec![b.compose(&[k, sine])]
    })));
    let small = program.add(function("small", &[Type::Vec2], |b, v| {
        let length = b.unary(Unary::Length, v[0]);
        vec![length, b.neg(v[0])]
    }));
    let large = program.add(function("large", &[Type::Float, Type::Float], |b, v| {
        let (mut x, y) = (v[0], v[1]);
        for _ in 0..200 {
            x = b.mul(x, y);
            x = b.unary(Unary::Sin, x);
        }
        vec![x, y]
    }));
    program.entry = Some(program.add(function("entry", &[Type::Vec2], |b, v| {
        let g = b.global(0, Type::Vec2);
        let on = b.uniform(1, Type::Bool);
        let moved = b.add(v[0], g);
        let parts = b.call(small, &[Type::Float, Type::Vec2], &[moved]);
        let x = b.component(v[0], 0);
        let then = b.open_region(&[]);
        let called = b.call(large, &[Type::Float, Type::Float], &[parts[0], x]);
        b.close_region(vec![called[0]]);
        let otherwise = b.open_region(&[]);
        b.close_region(vec![x]);
        let chosen = b.branch(on, then, otherwise)[0];
        let zero = b.float(0.0);
        let below = b.binary(Binary::Less, x, zero);
        let then = b.open_region(&[]);
        let constant = b.float(2.0);
        let again = b.call(large, &[Type::Float, Type::Float], &[x, constant]);
        b.close_region(again);
        let otherwise = b.open_region(&[]);
        b.close_region(vec![chosen, zero]);
        let mut results = b.branch(below, then, otherwise);
        results.extend([chosen, parts[1], g]);
        results
    })));
    program
}

#[test]
fn lanes_that_part_and_meet() {
    for points in [0, 1, 31, 32, 33, 255, 256, 257, 600] {
        check("branches", &nested_branches(), points);
        for count in [1, 3, 6, 9, 40] {
            check("loops", &nested_loops(count), points);
        }
        check("calls", &calls_and_globals(), points);
    }
}

#[test]
fn all_cores_say_what_one_says_and_count_the_same() {
    let program = nested_loops(40);
    let tape = Tape::compile(&program, program.entry.unwrap());
    let points = 40_000;
    let inputs = columns::<f32>(&[Type::Float, Type::Float], points);
    let wanted = run(&tape, &inputs, points, true);
    let slices: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
    let mut outputs = vec![vec![0.0; points]; 4];
    let counts =
        run_parallel(&tape, &[], &slices, &mut outputs.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
    assert_eq!(outputs, wanted);
    let mut machine = Machine::<f32>::new(&tape);
    machine.run(&slices, &mut outputs.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
    assert_eq!(&counts, machine.counts());
}

#[test]
fn calls_are_counted() {
    let program = calls_and_globals();
    let tape = Tape::compile_counting(&program, program.entry.unwrap());
    let mut machine = Machine::<f64>::new(&tape);
    let x: Vec<f64> = (0..300).map(|i| if i < 100 { -1.0 } else { 1.0 }).collect();
    let mut outputs = vec![vec![0.0; 300]; tape.output_count()];
    machine.run(&[&x, &x], &mut outputs.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
    let calls = |name: &str| machine.counts().calls_of(program.function_named(name).unwrap());
    // `small` and `large` once for every point, and `large` again for those below zero.
    assert_eq!((calls("small"), calls("large")), (300, 400));
}

/// Steps 1 at a time to `x` at most, by an evaluation that calls another one each round, and asks one more at the end.
/// `operations` is how large they are: some are written into their callers.
fn stepping(operations: usize) -> Program {
    let mut program = Program::default();
    let busy = |b: &mut Builder, mut x: Value| {
        for _ in 0..operations {
            x = b.unary(Unary::Sin, x);
        }
        x
    };
    let inner = program.add(function("inner", &[Type::Float], |b, v| vec![busy(b, v[0])]));
    let outer = program.add(function("outer", &[Type::Float], |b, v| {
        let inside = b.call(inner, &[Type::Float], &[v[0]])[0];
        vec![b.add(inside, v[0])]
    }));
    for id in [inner, outer] {
        program.functions[id.0 as usize].mark_evaluation();
    }
    // It is none itself, and what is written into it is not inside of one.
    let step = program.add(function("step", &[Type::Float], |b, v| {
        let distance = b.call(outer, &[Type::Float], &[v[0]])[0];
        let (zero, one) = (b.float(0.0), b.float(1.0));
        let nothing = b.mul(distance, zero);
        let next = b.add(v[0], one);
        vec![b.add(next, nothing)]
    }));
    program.entry = Some(program.add(function("entry", &[Type::Float], |b, v| {
        let until = b.open_region(&[Type::Float]);
        let at = b.argument(until, 0);
        let stop = b.binary(Binary::LessEqual, v[0], at);
        b.close_region(vec![stop]);
        let next = b.open_region(&[Type::Float, Type::Float]);
        let at = b.argument(next, 1);
        let moved = b.call(step, &[Type::Float], &[at]);
        b.close_region(moved);
        let zero = b.float(0.0);
        let last = b.repeat(1000, &[zero], until, next)[0];
        let more = b.call(inner, &[Type::Float], &[last])[0];
        vec![b.add(last, more)]
    })));
    program
}

#[test]
fn evaluations_are_counted_of_lanes_that_run() {
    for operations in [1, 1000] {
        let program = stepping(operations);
        let tape = Tape::compile_counting(&program, program.entry.unwrap());
        let x: Vec<f64> = (0..600).map(|i| f64::from(i % 7)).collect();
        let mut machine = Machine::<f64>::new(&tape);
        machine.run(&[&x], &mut [&mut vec![0.0; 600]]);
        let rounds: u64 = x.iter().map(|x| *x as u64).sum();
        let counts = machine.counts();
        assert_eq!((counts.rounds, counts.evaluations), (rounds, rounds + 600));
        let calls = |name: &str| counts.calls_of(program.function_named(name).unwrap());
        assert_eq!((calls("inner"), calls("outer"), calls("step")), (rounds + 600, rounds, rounds));
        // What it is at most is counted without running it.
        assert_eq!(sdf_ir::cost::evaluations(&program, program.entry.unwrap()), 1000 + 1);
    }
}

#[test]
fn uniforms_reach_the_frame() {
    let program = calls_and_globals();
    let entry: FunctionId = program.entry.unwrap();
    let tape = Tape::compile(&program, entry);
    let mut machine = Machine::<f64>::new(&tape);
    for (k, on) in [(0.5, false), (2.0, true)] {
        let uniforms = [Constant::Float(k), Constant::Bool(on)];
        machine.set_uniforms(&uniforms);
        let wanted = scalars(&point(&program, entry, &[Constant::Vec2([0.3, 0.4])], &uniforms));
        assert_eq!(machine.run_one(&[0.3, 0.4]), wanted);
    }
}
