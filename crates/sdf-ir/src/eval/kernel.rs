//! Straight code on a block of lanes.
//!
//! Every instruction is one loop over the lanes, written so that the compiler makes vector code of it; with AVX2,
//! where the machine has it, the same loops are compiled a second time. Both give the same bits: no operation is
//! fused or approximated.

use super::tape::{Instruction, Operand, Register};
use crate::number::Number;
use crate::program::{Binary, Unary};

/// How many points run at a time.
pub(crate) const LANES: usize = 256;

/// A register: a number for each lane.
pub(crate) type Lanes<N> = [N; LANES];

/// The lanes that are computed are a multiple of this, so that no loop has a rest.
const STRIDE: usize = 32;

/// Whether this machine has AVX2.
pub(crate) fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        std::arch::is_x86_feature_detected!("avx2")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}

/// Runs straight code for the first `count` lanes; the others may hold anything afterwards. `avx2` must only be
/// set where [`has_avx2`] says so.
pub(crate) fn run<N: Number>(
    avx2: bool,
    code: &[Instruction],
    frame: &mut [Lanes<N>],
    scalars: &[N],
    count: usize,
) {
    #[cfg(target_arch = "x86_64")]
    if avx2 {
        assert!(has_avx2());
        // SAFETY: the machine has AVX2, as was just asked.
        return unsafe { run_avx2(code, frame, scalars, count) };
    }
    let _ = avx2;
    run_everywhere(code, frame, scalars, count);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<N: Number>(code: &[Instruction], frame: &mut [Lanes<N>], scalars: &[N], count: usize) {
    run_everywhere(code, frame, scalars, count);
}

#[inline(always)]
fn run_everywhere<N: Number>(code: &[Instruction], frame: &mut [Lanes<N>], scalars: &[N], count: usize) {
    let count = count.next_multiple_of(STRIDE);
    assert!(count <= LANES);
    for instruction in code {
        step(*instruction, frame, scalars, count);
    }
}

/// The registers that an instruction does not write.
struct Others<'f, N> {
    before: &'f [Lanes<N>],
    after: &'f [Lanes<N>],
    scalars: &'f [N],
    count: usize,
}

/// What an instruction reads.
enum Source<'f, N> {
    Lanes(&'f [N]),
    Scalar(N),
}

impl<'f, N: Number> Others<'f, N> {
    #[inline(always)]
    fn register(&self, register: Register) -> &'f [N] {
        let (index, out) = (register as usize, self.before.len());
        // An instruction never reads the register that it writes, so index is not out.
        let lanes = if index < out { &self.before[index] } else { &self.after[index - out - 1] };
        &lanes[..self.count]
    }

    #[inline(always)]
    fn operand(&self, operand: Operand) -> Source<'f, N> {
        match operand {
            Operand::Register(register) => Source::Lanes(self.register(register)),
            Operand::Scalar(index) => Source::Scalar(self.scalars[index as usize]),
        }
    }
}

/// The lanes of the register that is written, and what can be read beside it.
#[inline(always)]
fn split<'f, N>(
    frame: &'f mut [Lanes<N>],
    out: Register,
    scalars: &'f [N],
    count: usize,
) -> (&'f mut [N], Others<'f, N>) {
    let (before, rest) = frame.split_at_mut(out as usize);
    let (out, after) = rest.split_first_mut().expect("the frame has this register");
    (&mut out[..count], Others { before, after, scalars, count })
}

/// One instruction.
#[inline(always)]
fn step<N: Number>(instruction: Instruction, frame: &mut [Lanes<N>], scalars: &[N], count: usize) {
    match instruction {
        Instruction::Copy { out, a } => {
            let (out, others) = split(frame, out, scalars, count);
            match others.operand(a) {
                Source::Lanes(a) => out.copy_from_slice(a),
                Source::Scalar(a) => out.fill(a),
            }
        }
        Instruction::Unary { op, out, a } => {
            let (out, others) = split(frame, out, scalars, count);
            unary(op, out, others.register(a));
        }
        Instruction::Binary { op, out, a, b } => {
            let (out, others) = split(frame, out, scalars, count);
            binary(op, out, others.operand(a), others.operand(b));
        }
        Instruction::Select { out, condition, a, b } => {
            let (out, others) = split(frame, out, scalars, count);
            let condition = others.register(condition);
            zip3(
                out,
                condition,
                others.operand(a),
                others.operand(b),
                |c, a, b| if is_true(c) { a } else { b },
            );
        }
        Instruction::Mix { out, a, b, t } => {
            let (out, others) = split(frame, out, scalars, count);
            zip3(out, others.register(a), others.operand(b), others.operand(t), N::mix);
        }
        Instruction::Dot2 { out, a, b } => {
            let (out, others) = split(frame, out, scalars, count);
            let (a, b) = (a.map(|r| others.register(r)), b.map(|r| others.register(r)));
            for i in 0..count {
                out[i] = N::dot(&[a[0][i], a[1][i]], &[b[0][i], b[1][i]]);
            }
        }
        Instruction::Dot3 { out, a, b } => {
            let (out, others) = split(frame, out, scalars, count);
            let (a, b) = (a.map(|r| others.register(r)), b.map(|r| others.register(r)));
            for i in 0..count {
                out[i] = N::dot(&[a[0][i], a[1][i], a[2][i]], &[b[0][i], b[1][i], b[2][i]]);
            }
        }
        Instruction::Length2 { out, a } => {
            let (out, others) = split(frame, out, scalars, count);
            let a = a.map(|r| others.register(r));
            for i in 0..count {
                out[i] = N::length(&[a[0][i], a[1][i]]);
            }
        }
        Instruction::Length3 { out, a } => {
            let (out, others) = split(frame, out, scalars, count);
            let a = a.map(|r| others.register(r));
            for i in 0..count {
                out[i] = N::length(&[a[0][i], a[1][i], a[2][i]]);
            }
        }
        Instruction::Normalize2 { out, a } => many(frame, out, a, count, |a| {
            let mut out = a;
            N::normalize(&a, &mut out);
            out
        }),
        Instruction::Normalize3 { out, a } => many(frame, out, a, count, |a| {
            let mut out = a;
            N::normalize(&a, &mut out);
            out
        }),
        Instruction::Hash { out, a, size: 1 } => many(frame, [out], [a[0]], count, |a| [N::hash(&a)]),
        Instruction::Hash { out, a, size: 2 } => many(frame, [out], [a[0], a[1]], count, |a| [N::hash(&a)]),
        Instruction::Hash { out, a, .. } => many(frame, [out], a, count, |a| [N::hash(&a)]),
        Instruction::ReduceAngle { out, a } => many(frame, out, [a], count, |[a]| a.reduce_angle()),
    }
}

/// Several registers from several, a stride at a time.
#[inline(always)]
fn many<N: Number, const OUT: usize, const IN: usize>(
    frame: &mut [Lanes<N>],
    out: [Register; OUT],
    a: [Register; IN],
    count: usize,
    f: impl Fn([N; IN]) -> [N; OUT],
) {
    for start in (0..count).step_by(STRIDE) {
        let inputs: [[N; STRIDE]; IN] =
            a.map(|r| frame[r as usize][start..start + STRIDE].try_into().expect("a stride"));
        let mut outputs = [[N::from_f64(0.0); STRIDE]; OUT];
        for i in 0..STRIDE {
            let results = f(std::array::from_fn(|k| inputs[k][i]));
            for k in 0..OUT {
                outputs[k][i] = results[k];
            }
        }
        for (r, lanes) in out.iter().zip(&outputs) {
            frame[*r as usize][start..start + STRIDE].copy_from_slice(lanes);
        }
    }
}

#[inline(always)]
fn is_true<N: Number>(a: N) -> bool {
    !N::equal(a, N::from_f64(0.0))
}

#[inline(always)]
fn map<N: Number>(out: &mut [N], a: &[N], f: impl Fn(N) -> N) {
    for (o, a) in out.iter_mut().zip(a) {
        *o = f(*a);
    }
}

#[inline(always)]
fn zip<N: Number>(out: &mut [N], a: Source<N>, b: Source<N>, f: impl Fn(N, N) -> N) {
    match (a, b) {
        (Source::Lanes(a), Source::Lanes(b)) => {
            for ((o, a), b) in out.iter_mut().zip(a).zip(b) {
                *o = f(*a, *b);
            }
        }
        (Source::Lanes(a), Source::Scalar(b)) => map(out, a, |a| f(a, b)),
        (Source::Scalar(a), Source::Lanes(b)) => map(out, b, |b| f(a, b)),
        (Source::Scalar(a), Source::Scalar(b)) => out.fill(f(a, b)),
    }
}

#[inline(always)]
fn zip3<N: Number>(out: &mut [N], a: &[N], b: Source<N>, c: Source<N>, f: impl Fn(N, N, N) -> N) {
    match (b, c) {
        (Source::Lanes(b), Source::Lanes(c)) => {
            for (((o, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
                *o = f(*a, *b, *c);
            }
        }
        (Source::Lanes(b), c) => {
            let Source::Scalar(c) = c else { unreachable!("lanes were matched above") };
            zip(out, Source::Lanes(a), Source::Lanes(b), |a, b| f(a, b, c));
        }
        (Source::Scalar(b), c) => zip(out, Source::Lanes(a), c, |a, c| f(a, b, c)),
    }
}

/// An operation with its name known when this is compiled, so that its loop holds no choice.
macro_rules! each_name {
    ($op:expr, $kind:ident, [$($name:ident)*], $call:ident) => {
        match $op {
            $($kind::$name => $call!($name),)*
        }
    };
}

#[inline(always)]
fn unary<N: Number>(op: Unary, out: &mut [N], a: &[N]) {
    macro_rules! call {
        (Not) => {
            map(out, a, |a| N::from_bool(!is_true(a)))
        };
        (Length) => {
            unreachable!("has an instruction of its own")
        };
        (Normalize) => {
            unreachable!("has an instruction of its own")
        };
        (Hash) => {
            unreachable!("has an instruction of its own")
        };
        (ReduceAngle) => {
            unreachable!("has an instruction of its own")
        };
        ($name:ident) => {
            map(out, a, |a| N::unary(Unary::$name, a))
        };
    }
    each_name!(op, Unary, [
        Negate Not Abs Sign Floor Ceil Round Trunc Sqrt Sin Cos Tan Asin Acos Atan Exp Exp2 Log Log2 Tanh
        Length Normalize Hash PowerOfTwo Exponent Mantissa ReduceAngle
    ], call)
}

#[inline(always)]
fn binary<N: Number>(op: Binary, out: &mut [N], a: Source<N>, b: Source<N>) {
    macro_rules! call {
        (Less) => {
            zip(out, a, b, |a, b| N::from_bool(N::less(a, b)))
        };
        (LessEqual) => {
            zip(out, a, b, |a, b| N::from_bool(N::less_equal(a, b)))
        };
        (Equal) => {
            zip(out, a, b, |a, b| N::from_bool(N::equal(a, b)))
        };
        (And) => {
            zip(out, a, b, |a, b| N::from_bool(is_true(a) & is_true(b)))
        };
        (Or) => {
            zip(out, a, b, |a, b| N::from_bool(is_true(a) | is_true(b)))
        };
        (Dot) => {
            unreachable!("has an instruction of its own")
        };
        (Cross) => {
            unreachable!("is written as products")
        };
        ($name:ident) => {
            zip(out, a, b, |a, b| N::binary(Binary::$name, a, b))
        };
    }
    each_name!(op, Binary, [
        Add Subtract Multiply Divide Modulo Min Max Power Atan2 Dot Cross Less LessEqual Equal And Or
    ], call)
}
