//! Every operation on nasty intervals: what `f64` computes for numbers of them lies inside.

use crate::random::Random;
use sdf_ir::interval::{Bounds, Sloped, Walker};
use sdf_ir::{
    Binary, Builder, Constant, Function, Parameter, Program, RegionId, Ternary, Type, Unary, Value,
};

use Type::{Bool, Float, Vec2, Vec3};

/// An operation of any arity.
#[derive(Debug, Clone, Copy)]
pub enum Operation {
    Unary(Unary),
    Binary(Binary),
    Ternary(Ternary),
}

impl Operation {
    pub fn all() -> Vec<Operation> {
        let unary = Unary::ALL.map(Operation::Unary);
        let binary = Binary::ALL.map(Operation::Binary);
        unary.into_iter().chain(binary).chain(Ternary::ALL.map(Operation::Ternary)).collect()
    }

    /// The types that it takes.
    pub fn signatures(self) -> Vec<Vec<Type>> {
        let each = |n: usize| [Float, Vec2, Vec3].map(|ty| vec![ty; n]).to_vec();
        match self {
            Operation::Unary(op) => match op {
                Unary::Not => vec![vec![Bool]],
                Unary::Length | Unary::Normalize => vec![vec![Vec2], vec![Vec3]],
                Unary::ReduceAngle => vec![vec![Float]],
                _ => each(1),
            },
            Operation::Binary(op) => match op {
                Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => {
                    let mixed = [[Float, Vec2], [Vec2, Float], [Float, Vec3], [Vec3, Float]];
                    each(2).into_iter().chain(mixed.map(|types| types.to_vec())).collect()
                }
                Binary::Dot => vec![vec![Vec2; 2], vec![Vec3; 2]],
                Binary::Cross => vec![vec![Vec3; 2]],
                Binary::Less | Binary::LessEqual => vec![vec![Float; 2]],
                Binary::Equal => vec![vec![Float; 2], vec![Bool; 2]],
                Binary::And | Binary::Or => vec![vec![Bool; 2]],
                _ => each(2),
            },
            Operation::Ternary(Ternary::Select) => {
                [Bool, Float, Vec2, Vec3].map(|ty| vec![Bool, ty, ty]).to_vec()
            }
            Operation::Ternary(Ternary::Mix) => {
                each(3).into_iter().chain([Vec2, Vec3].map(|ty| vec![ty, ty, Float])).collect()
            }
        }
    }

    pub fn of(self, x: &[Constant]) -> Constant {
        match self {
            Operation::Unary(op) => Constant::unary(op, x[0]),
            Operation::Binary(op) => Constant::binary(op, x[0], x[1]),
            Operation::Ternary(op) => Constant::ternary(op, x[0], x[1], x[2]),
        }
    }

    pub fn build(self, b: &mut Builder, x: &[Value]) -> Value {
        match self {
            Operation::Unary(op) => b.unary(op, x[0]),
            Operation::Binary(op) => b.binary(op, x[0], x[1]),
            Operation::Ternary(op) => b.ternary(op, x[0], x[1], x[2]),
        }
    }

    /// A function that is this operation on its parameters.
    pub fn function(self, types: &[Type]) -> Function {
        let parameter = |ty: &Type| Parameter { name: "a".into(), ty: *ty, point: false };
        let mut b = Builder::new("operation", types.iter().map(parameter).collect());
        let x: Vec<Value> = (0..types.len()).map(|i| b.argument(RegionId::ROOT, i as u16)).collect();
        let result = self.build(&mut b, &x);
        b.finish(vec![(result, "".into())])
    }
}

/// Whether these are plain numbers: what the language makes no promise about is left out.
fn is_number(c: Constant) -> bool {
    c.components().iter().all(|x| !x.is_nan())
}

#[test]
fn what_f64_computes_lies_inside() {
    const SAMPLES: usize = 1 << 20;
    const PER_REGION: usize = 32;
    let program = Program::default();
    for operation in Operation::all() {
        let mut random = Random(1);
        let signatures = operation.signatures();
        for types in &signatures {
            let function = operation.function(types);
            let mut walker = Walker::<Bounds>::new(&program, &function, &[], &[]);
            for _ in 0..SAMPLES / PER_REGION / signatures.len() {
                let arguments: Vec<Bounds> =
                    types.iter().map(|ty| random.bounds(*ty, Random::interval)).collect();
                let bounds = walker.run(&arguments)[0];
                for _ in 0..PER_REGION {
                    let values: Vec<Constant> = arguments.iter().map(|x| random.value(x)).collect();
                    let result = operation.of(&values);
                    assert!(
                        !is_number(result) || bounds.contains(result),
                        "{operation:?} of {values:?} is {result:?}, which is not in\n{bounds:?} of\n{arguments:?}"
                    );
                }
            }
        }
    }
}

/// No end of anything is NaN, whatever goes in.
#[test]
fn slopes_of_nasty_regions_are_numbers() {
    let program = Program::default();
    for operation in Operation::all() {
        let mut random = Random(2);
        for types in operation.signatures() {
            let function = operation.function(&types);
            let mut walker = Walker::<Sloped>::new(&program, &function, &[], &[]);
            for _ in 0..3000 {
                let arguments: Vec<Sloped> = types
                    .iter()
                    .map(|ty| {
                        let bounds = random.bounds(*ty, Random::interval);
                        match random.below(3) {
                            0 => Sloped::steady(bounds),
                            1 => Sloped::within(bounds, random.of(&[1.0, 1e-300, 1e300, f64::INFINITY])),
                            _ => Sloped::point(bounds),
                        }
                    })
                    .collect();
                let result = walker.run(&arguments)[0];
                let is_right = |lo: f64, hi: f64| lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY;
                for i in 0..result.bounds.size() {
                    let part = result.bounds.part(i);
                    assert!(is_right(part.lo, part.hi), "{operation:?}: {result:?} of {arguments:?}");
                    for x in result.slopes.gradient(i) {
                        assert!(is_right(x.lo, x.hi), "{operation:?}: {result:?} of {arguments:?}");
                    }
                    assert!(result.slopes.norm_of(i) >= 0.0);
                }
                assert!(result.norm() >= 0.0, "{operation:?}: {result:?} of {arguments:?}");
            }
        }
    }
}
