//! Each basic operation alone, on a device and on the interpreter's `f32` lanes: the same bits.

use sdf_emit::{EmitError, KernelLanguage, emit_kernel};
use sdf_ir::{Binary, Builder, Parameter, Program, Ternary, Type, Unary, Value};
use sdf_tests::adapter::adapter;
use sdf_tests::numbers::{columns, number, word};
use sdf_tests::run::{on_device, on_lanes};

const COUNT: usize = 1 << 20;

/// An operation of any arity.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Operation {
    Unary(Unary),
    Binary(Binary),
    Ternary(Ternary),
}

/// Lists of the types of arguments.
type Lists = &'static [&'static [Type]];

/// What an operation is tried on.
struct Case {
    /// The types of its arguments, each list a case of its own.
    types: Lists,
    /// The numbers that it takes.
    number: fn(u64) -> f32,
}

const ANY: fn(u64) -> f32 = number;
const FLOAT: Lists = &[&[Type::Float], &[Type::Vec2], &[Type::Vec3]];
const VECTOR: Lists = &[&[Type::Vec2], &[Type::Vec3]];
const PAIR: Lists = &[&[Type::Float; 2], &[Type::Vec2; 2], &[Type::Vec3; 2]];
const MIXED: Lists = &[
    &[Type::Float; 2],
    &[Type::Vec2; 2],
    &[Type::Vec3; 2],
    &[Type::Vec3, Type::Float],
    &[Type::Float, Type::Vec2],
];

/// How each operation is tried; `None` for those that legalising replaces. A new one has to be put somewhere.
fn case(operation: Operation) -> Option<Case> {
    let (types, number): (Lists, fn(u64) -> f32) = match operation {
        Operation::Unary(op) => match op {
            Unary::Negate | Unary::Abs | Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round => {
                (FLOAT, ANY)
            }
            Unary::Trunc | Unary::Sqrt => (FLOAT, ANY),
            Unary::Not => (&[&[Type::Bool]], ANY),
            Unary::Length => (VECTOR, ANY),
            Unary::Hash => (FLOAT, ANY),
            Unary::PowerOfTwo => (FLOAT, |n| (word(n) % 254) as f32 - 126.0),
            Unary::Exponent | Unary::Mantissa => (FLOAT, |n| number(n).abs().max(f32::MIN_POSITIVE)),
            Unary::ReduceAngle => (&[&[Type::Float]], ANY),
            Unary::Sin | Unary::Cos | Unary::Tan | Unary::Asin | Unary::Acos | Unary::Atan => return None,
            Unary::Exp | Unary::Exp2 | Unary::Log | Unary::Log2 | Unary::Tanh | Unary::Normalize => {
                return None;
            }
        },
        Operation::Binary(op) => match op {
            Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => (MIXED, ANY),
            Binary::Min | Binary::Max => (PAIR, ANY),
            Binary::Dot => (&[&[Type::Vec2; 2], &[Type::Vec3; 2]], ANY),
            Binary::Cross => (&[&[Type::Vec3; 2]], ANY),
            Binary::Less | Binary::LessEqual => (&[&[Type::Float; 2]], ANY),
            Binary::Equal => (&[&[Type::Float; 2], &[Type::Bool; 2]], ANY),
            Binary::And | Binary::Or => (&[&[Type::Bool; 2]], ANY),
            Binary::Modulo | Binary::Power | Binary::Atan2 => return None,
        },
        Operation::Ternary(op) => match op {
            Ternary::Select => {
                (&[&[Type::Bool, Type::Float, Type::Float], &[Type::Bool, Type::Vec3, Type::Vec3]], ANY)
            }
            Ternary::Mix => {
                (&[&[Type::Float; 3], &[Type::Vec3; 3], &[Type::Vec2, Type::Vec2, Type::Float]], ANY)
            }
        },
    };
    Some(Case { types, number })
}

fn all() -> impl Iterator<Item = Operation> {
    let unary = Unary::ALL.into_iter().map(Operation::Unary);
    let binary = Binary::ALL.into_iter().map(Operation::Binary);
    unary.chain(binary).chain(Ternary::ALL.into_iter().map(Operation::Ternary))
}

/// The function that computes the operation of its parameters and nothing else.
fn program(operation: Operation, types: &[Type]) -> Program {
    let mut b = Builder::new("operation", Vec::new());
    let parameter = |ty: &Type| Parameter { name: "a".into(), ty: *ty, point: false };
    let a: Vec<Value> = types.iter().map(|ty| b.add_parameter(parameter(ty))).collect();
    let result = match operation {
        Operation::Unary(op) => b.unary(op, a[0]),
        Operation::Binary(op) => b.binary(op, a[0], a[1]),
        Operation::Ternary(op) => b.ternary(op, a[0], a[1], a[2]),
    };
    let mut program = Program::default();
    program.entry = Some(program.add(b.finish(vec![(result, "".into())])));
    program
}

/// Whether two results are the same: the same bits, or neither is a number.
fn same(a: u32, b: u32) -> bool {
    a == b || (f32::from_bits(a).is_nan() && f32::from_bits(b).is_nan())
}

/// Where the device and the lanes differ, in words; empty where they agree.
fn differences(
    operation: Operation,
    types: &[Type],
    number: fn(u64) -> f32,
    language: KernelLanguage,
) -> String {
    let program = program(operation, types);
    let function = program.entry.expect("an entry");
    let arguments = columns(types, COUNT, number);
    let expected = on_lanes(&program, function, &arguments);
    let found = on_device(adapter(), &program, function, language, &arguments);
    let mut wrong = 0;
    let mut examples = String::new();
    for i in 0..COUNT {
        if expected.iter().zip(&found).any(|(e, f)| !same(e[i], f[i])) {
            wrong += 1;
            if wrong <= 4 {
                let a: Vec<f32> = arguments.iter().map(|c| c[i]).collect();
                let row = |rows: &[Vec<u32>]| rows.iter().map(|c| f32::from_bits(c[i])).collect::<Vec<f32>>();
                examples +=
                    &format!("\n    {a:?}: {:?} on lanes, {:?} on the device", row(&expected), row(&found));
            }
        }
    }
    if wrong == 0 {
        examples
    } else {
        format!("{operation:?} of {types:?} in {language:?}: {wrong} of {COUNT}{examples}\n")
    }
}

fn check(language: KernelLanguage) {
    let mut report = String::new();
    for operation in all() {
        if let Some(case) = case(operation) {
            for types in case.types {
                report += &differences(operation, types, case.number, language);
            }
        }
    }
    assert!(report.is_empty(), "the device differs from the lanes:\n{report}");
}

#[test]
fn wgsl_computes_what_the_lanes_compute() {
    check(KernelLanguage::Wgsl);
}

#[test]
fn glsl_computes_what_the_lanes_compute() {
    check(KernelLanguage::Glsl450);
}

#[test]
fn what_has_no_case_is_no_basic_operation() {
    for operation in all().filter(|operation| case(*operation).is_none()) {
        let types = match operation {
            Operation::Unary(Unary::Normalize) => &[Type::Vec3][..],
            Operation::Unary(_) => &[Type::Float],
            _ => &[Type::Float; 2],
        };
        let program = program(operation, types);
        let result = emit_kernel(&program, program.entry.expect("an entry"), KernelLanguage::Wgsl);
        assert!(matches!(result, Err(EmitError::NotBasic { .. })), "{operation:?}: {result:?}");
    }
}
