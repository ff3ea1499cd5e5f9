//! Every evaluator on every operation, with nasty arguments: numbers come out, and the lanes compute what constants do.

use crate::operations::Operation;
use crate::random::{NASTY, Random};
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::interval::{Bounds, Sloped, slopes};
use sdf_ir::number::{Dual, LARGEST, SMALLEST_NORMAL};
use sdf_ir::{Binary, Constant, Program, Ternary, Type, Unary, legalise};

/// Nasty arguments that the operation takes: within what the language promises where it is not guarded, and whole or
/// positive where bits are looked at.
fn argument(operation: Operation, ty: Type, random: &mut Random) -> Constant {
    if ty == Type::Bool {
        return Constant::Bool(random.below(2) == 0);
    }
    let most = match operation {
        Operation::Binary(
            Binary::Dot | Binary::Cross | Binary::Multiply | Binary::Add | Binary::Subtract,
        )
        | Operation::Ternary(Ternary::Mix) => 1e18,
        _ => LARGEST,
    };
    let parts: Vec<f64> = (0..ty.size())
        .map(|_| {
            let x = f64::from(random.of(&NASTY) as f32).clamp(-most, most);
            match operation {
                Operation::Unary(Unary::PowerOfTwo) => x.round().clamp(-126.0, 127.0),
                Operation::Unary(Unary::Exponent | Unary::Mantissa) => {
                    x.abs().clamp(SMALLEST_NORMAL, LARGEST)
                }
                _ => x,
            }
        })
        .collect();
    Constant::from_components(&parts)
}

fn numbers(c: Constant) -> Vec<f64> {
    match c {
        Constant::Bool(x) => vec![f64::from(x)],
        _ => c.components().to_vec(),
    }
}

#[test]
fn every_evaluator_yields_numbers() {
    for operation in Operation::all() {
        let mut random = Random(7);
        for types in operation.signatures() {
            let mut program = Program::default();
            let id = program.add(operation.function(&types));
            program.entry = Some(id);
            let basic = legalise(&program);
            let (plain, hardware) =
                (Tape::compile(&program, id), Tape::compile(&basic, basic.entry.expect("an entry")));
            let mut in_f64 = Machine::<f64>::new(&plain);
            let mut in_f32 = Machine::<f32>::new(&hardware);
            let mut in_duals = Machine::<Dual<f64>>::new(&plain);
            for _ in 0..2000 {
                let arguments: Vec<Constant> =
                    types.iter().map(|ty| argument(operation, *ty, &mut random)).collect();
                let inputs: Vec<f64> = arguments.iter().flat_map(|c| numbers(*c)).collect();
                let expected = numbers(operation.of(&arguments));
                let say = |what: &str, found: &dyn std::fmt::Debug| {
                    format!("{operation:?} of {arguments:?} is {expected:?}, {what}: {found:?}")
                };
                assert!(expected.iter().all(|x| x.is_finite()), "{}", say("meant", &expected));
                let found = in_f64.run_one(&inputs);
                assert_eq!(found, expected, "{}", say("f64 lanes", &found));
                let singles: Vec<f32> = inputs.iter().map(|x| *x as f32).collect();
                let found = in_f32.run_one(&singles);
                assert!(found.iter().all(|x| x.is_finite()), "{}", say("f32 lanes", &found));
                let duals: Vec<Dual<f64>> =
                    inputs.iter().enumerate().map(|(i, x)| Dual::variable(*x, i % 3)).collect();
                let found = in_duals.run_one(&duals);
                let is_number = |d: &Dual<f64>| d.value.is_finite() && d.slope.iter().all(|s| !s.is_nan());
                assert!(found.iter().all(is_number), "{}", say("duals", &found));
                let values: Vec<f64> = found.iter().map(|d| d.value).collect();
                assert_eq!(values, expected, "{}", say("duals", &found));
                let regions: Vec<Sloped> =
                    arguments.iter().map(|c| Sloped::within(Bounds::constant(*c), 1.0)).collect();
                let found = slopes(&program, program.function(id), &regions, &[], &[])[0];
                assert!(found.bounds.contains(operation.of(&arguments)), "{}", say("intervals", &found));
                assert!(!found.norm().is_nan(), "{}", say("duals over intervals", &found));
            }
        }
    }
}
