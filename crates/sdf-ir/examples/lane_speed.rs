//! How fast the machine is, on one core: `cargo run --release -p sdf-ir --example lane_speed`.
//!
//! Counts one operation for each instruction and lane, a length or a dot product being one.

use sdf_ir::eval::{Machine, Tape};
use sdf_ir::number::{Dual, Number};
use sdf_ir::{
    Binary, Builder, Constant, Function, Parameter, Program, RegionId, Type, Unary, Value, legalise,
};
use std::hint::black_box;
use std::time::Instant;

const POINTS: usize = 1 << 16;

fn main() {
    let straight = program(blended_boxes);
    measure::<f32>("blended boxes, f32", &straight, true);
    measure::<f32>("blended boxes, f32, no AVX2", &straight, false);
    measure::<f64>("blended boxes, f64", &straight, true);
    measure::<Dual<f32>>("blended boxes, duals of f32", &straight, true);
    let march = marched(&straight);
    measure_rounds("march of 64 rounds", &march);
}

/// A smooth union of eight rounded boxes at different places: straight code.
fn blended_boxes(b: &mut Builder, p: Value) -> Value {
    let mut field = b.float(100.0);
    for i in 0..8 {
        let center = b.constant(Constant::Vec3([f64::from(i) * 0.7 - 2.5, f64::from(i % 3) * 0.5, 0.1]));
        let q = b.sub(p, center);
        let q = b.unary(Unary::Abs, q);
        let half = b.constant(Constant::Vec3([0.3, 0.2, 0.4]));
        let q = b.sub(q, half);
        let zero = b.constant(Constant::Vec3([0.0; 3]));
        let outside = b.max(q, zero);
        let outside = b.unary(Unary::Length, outside);
        let parts = b.components(q);
        let inside = b.max(parts[1], parts[2]);
        let inside = b.max(parts[0], inside);
        let nothing = b.float(0.0);
        let inside = b.min(inside, nothing);
        let distance = b.add(outside, inside);
        field = smooth_min(b, field, distance, 0.1);
    }
    field
}

fn smooth_min(b: &mut Builder, x: Value, y: Value, width: f64) -> Value {
    let gap = b.sub(x, y);
    let gap = b.unary(Unary::Abs, gap);
    let inverse = b.float(1.0 / width);
    let gap = b.mul(gap, inverse);
    let one = b.float(1.0);
    let rest = b.sub(one, gap);
    let zero = b.float(0.0);
    let rest = b.max(rest, zero);
    let square = b.mul(rest, rest);
    let quarter = b.float(width * 0.25);
    let blend = b.mul(square, quarter);
    let least = b.min(x, y);
    b.sub(least, blend)
}

fn program(write: impl FnOnce(&mut Builder, Value) -> Value) -> Program {
    let mut b = Builder::new("field", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
    let p = b.argument(RegionId::ROOT, 0);
    let field = write(&mut b, p);
    let mut program = Program::default();
    program.entry = Some(program.add(b.finish(vec![(field, "".into())])));
    legalise(&program)
}

/// Sphere tracing along z from each point.
fn marched(program: &Program) -> Program {
    let mut program = program.clone();
    let field = program.entry.expect("a field");
    let mut b = Builder::new("march", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
    let p = b.argument(RegionId::ROOT, 0);
    let direction = b.constant(Constant::Vec3([0.0, 0.0, 1.0]));
    let until = b.open_region(&[Type::Float, Type::Float]);
    let (t, d) = (b.argument(until, 0), b.argument(until, 1));
    let (near, far) = (b.float(1e-3), b.float(20.0));
    let hit = b.binary(Binary::Less, d, near);
    let missed = b.binary(Binary::Less, far, t);
    let stop = b.binary(Binary::Or, hit, missed);
    b.close_region(vec![stop]);
    let next = b.open_region(&[Type::Float, Type::Float, Type::Float]);
    let t = b.argument(next, 1);
    let way = b.mul(direction, t);
    let at = b.add(p, way);
    let d = b.call(field, &[Type::Float], &[at])[0];
    let t = b.add(t, d);
    b.close_region(vec![t, d]);
    let (zero, one) = (b.float(0.0), b.float(1.0));
    let t = b.repeat(64, &[zero, one], until, next)[0];
    let march: Function = b.finish(vec![(t, "".into())]);
    program.entry = Some(program.add(march));
    program
}

fn points<N: Number>() -> Vec<Vec<N>> {
    let coordinate = |i: usize, k: usize| {
        let (x, y) = (i % 256, i / 256);
        [x as f64 / 128.0 * 3.0 - 3.0, y as f64 / 128.0 * 2.0 - 2.0, -3.0][k]
    };
    (0..3).map(|k| (0..POINTS).map(|i| N::from_f64(coordinate(i, k))).collect()).collect()
}

fn measure<N: Number>(name: &str, program: &Program, avx2: bool) {
    let tape = Tape::compile(program, program.entry.expect("an entry"));
    let seconds = best::<N>(&tape, avx2, |_| {});
    let speed = tape.instruction_count() as f64 * POINTS as f64 / seconds;
    println!(
        "{name:32} {:6.2} G operations/s, {:7.1} M points/s ({} instructions, {} registers)",
        speed / 1e9,
        POINTS as f64 / seconds / 1e6,
        tape.instruction_count(),
        tape.register_count()
    );
}

fn measure_rounds(name: &str, program: &Program) {
    let tape = Tape::compile(program, program.entry.expect("an entry"));
    let mut rounds = 0;
    let seconds = best::<f32>(&tape, true, |counted| rounds = counted);
    println!(
        "{name:32} {:6.2} G operations/s, {:7.1} M rounds/s ({:.1} rounds a point)",
        rounds as f64 * tape.instruction_count() as f64 / seconds / 1e9,
        rounds as f64 / seconds / 1e6,
        rounds as f64 / POINTS as f64
    );
}

/// The shortest of ten runs over all points, in seconds.
fn best<N: Number>(tape: &Tape, avx2: bool, mut rounds: impl FnMut(u64)) -> f64 {
    let points = points::<N>();
    let inputs: Vec<&[N]> = points.iter().map(Vec::as_slice).collect();
    let mut output = vec![N::from_f64(0.0); POINTS];
    let mut machine = Machine::<N>::new(tape);
    machine.allow_avx2(avx2);
    let mut best = f64::INFINITY;
    for _ in 0..10 {
        let before = machine.counts().rounds;
        let start = Instant::now();
        machine.run(&inputs, &mut [&mut output]);
        black_box(&output);
        best = best.min(start.elapsed().as_secs_f64());
        rounds(machine.counts().rounds - before);
    }
    best
}
