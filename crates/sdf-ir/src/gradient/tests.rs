//! Derivatives against central differences, and what the code of typical gradients looks like.

use super::{Gradients, gradient};
use crate::build::Builder;
use crate::constant::Constant;
use crate::program::{
    Binary, Function, FunctionId, Parameter, Program, RegionId, Ternary, Type, Unary, Value,
};
use crate::reference::evaluate;

fn field(make: impl FnOnce(&mut Builder, Value) -> Value) -> (Program, FunctionId) {
    let mut program = Program::default();
    let mut b = Builder::new("field", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
    let p = b.argument(RegionId::ROOT, 0);
    let d = make(&mut b, p);
    let id = program.add(b.finish(vec![(d, "".into())]));
    (program, id)
}

#[test]
fn the_gradient_of_a_ball_is_the_direction() {
    let (mut program, id) = field(|b, p| {
        let length = b.unary(Unary::Length, p);
        let r = b.float(1.5);
        b.sub(length, r)
    });
    let g = gradient(&mut program, id);
    assert_eq!(crate::verify(&program), Ok(()));
    insta::assert_snapshot!(program.function(g));
}

#[test]
fn the_gradient_of_a_box_stays_small() {
    let (mut program, id) = field(|b, p| {
        let half = b.constant(Constant::Vec3([1.0, 2.0, 3.0]));
        let (corner, zero) = (b.unary(Unary::Abs, p), b.float(0.0));
        let q = b.sub(corner, half);
        let zeros = b.splat(zero, Type::Vec3);
        let outside = b.max(q, zeros);
        let outside = b.unary(Unary::Length, outside);
        let [x, y, z] = [0, 1, 2].map(|i| b.component(q, i));
        let inside = b.max(y, z);
        let inside = b.max(x, inside);
        let inside = b.min(inside, zero);
        b.add(outside, inside)
    });
    let g = gradient(&mut program, id);
    assert_eq!(crate::verify(&program), Ok(()));
    insta::assert_snapshot!(program.function(g));
}

/// Fails where the gradient yields other values than the function, or other derivatives than differences tell.
fn check(program: &mut Program, id: FunctionId, points: &[[f64; 3]]) {
    let g = gradient(program, id);
    assert_eq!(crate::verify(program), Ok(()));
    let (f, g_text) = (program.function(id).to_string(), program.function(g).to_string());
    let components =
        |results: &[Constant]| -> Vec<f64> { results.iter().flat_map(|c| c.components().to_vec()).collect() };
    for point in points {
        let at = |p: [f64; 3]| components(&evaluate(program, id, &[Constant::Vec3(p)]));
        let here = at(*point);
        let results = evaluate(program, g, &[Constant::Vec3(*point)]);
        let values = program.function(id).result_types().len();
        assert_eq!(components(&results[..values]), here);
        let derivatives = &results[values..];
        assert_eq!(derivatives.len(), here.len());
        for axis in 0..3 {
            let h = 1e-5;
            let [mut left, mut right] = [*point; 2];
            left[axis] -= h;
            right[axis] += h;
            let (left, right) = (at(left), at(right));
            for (i, derivative) in derivatives.iter().enumerate() {
                let expected = (right[i] - left[i]) / (2.0 * h);
                let found = derivative.components()[axis];
                let close = (found - expected).abs() <= 1e-6 * (1.0 + expected.abs());
                assert!(close, "result {i} by {axis} at {point:?}: {found}, not {expected}\n{f}\n{g_text}");
            }
        }
    }
}

const POINTS: [[f64; 3]; 6] = [
    [0.31, -0.42, 0.57],
    [-0.63, 0.24, 0.11],
    [0.72, 0.69, -0.38],
    [-0.17, -0.83, -0.29],
    [0.05, 0.93, 0.61],
    [0.88, -0.07, -0.91],
];

/// Two vectors that move in every component, away from kinks and inside every domain: in 0.05..0.95.
fn operands(b: &mut Builder, p: Value) -> [Value; 2] {
    let square = b.mul(p, p);
    let [x, y, z] = [0, 1, 2].map(|i| b.component(square, i));
    let (quarter, third, least) = (b.float(0.25), b.float(0.3), b.float(0.07));
    let turned = b.compose(&[y, z, x]);
    let (left, right) = (b.mul(square, third), b.mul(turned, quarter));
    let both = b.add(left, right);
    let u = b.add(both, least);
    let twice = b.mul(turned, third);
    let v = b.add(twice, quarter);
    [u, v]
}

fn alone(make: impl FnOnce(&mut Builder, Value, Value) -> Value) {
    let (mut program, id) = field(|b, p| {
        let [u, v] = operands(b, p);
        make(b, u, v)
    });
    check(&mut program, id, &POINTS);
}

#[test]
fn every_operation_on_one_value_has_its_derivative() {
    use Unary::*;
    for op in [
        Negate,
        Not,
        Abs,
        Sign,
        Floor,
        Ceil,
        Round,
        Trunc,
        Sqrt,
        Sin,
        Cos,
        Tan,
        Asin,
        Acos,
        Atan,
        Exp,
        Exp2,
        Log,
        Log2,
        Tanh,
        Length,
        Normalize,
        Hash,
        PowerOfTwo,
        Exponent,
        Mantissa,
        ReduceAngle,
    ] {
        match op {
            // It takes and yields no number.
            Not => {}
            // They are not smooth where their argument moves: flat by definition.
            Hash | PowerOfTwo => is_flat(op),
            Negate | Abs | Sign | Floor | Ceil | Round | Trunc | Sqrt | Sin | Cos | Tan | Asin | Acos
            | Atan | Exp | Exp2 | Log | Log2 | Tanh | Length | Normalize => {
                alone(|b, u, _| b.unary(op, u));
                if !matches!(op, Sqrt | Asin | Acos | Log | Log2 | Round) {
                    // Also below zero.
                    alone(|b, u, _| {
                        let negative = b.neg(u);
                        b.unary(op, negative)
                    });
                }
            }
            Exponent | Mantissa => alone(|b, u, _| {
                let one = b.float(1.0);
                let above = b.add(u, one);
                b.unary(op, above)
            }),
            ReduceAngle => alone(|b, u, _| {
                let (x, two) = (b.component(u, 0), b.float(2.0));
                let angle = b.add(x, two);
                b.unary(op, angle)
            }),
        }
    }
}

fn is_flat(op: Unary) {
    let (mut program, id) = field(|b, p| b.unary(op, p));
    let g = gradient(&mut program, id);
    let results = evaluate(&program, g, &[Constant::Vec3([0.25, 0.5, 0.75])]);
    assert!(results[1..].iter().all(|c| *c == Constant::Vec3([0.0; 3])), "{op:?}");
}

#[test]
fn every_operation_on_two_values_has_its_derivative() {
    use Binary::*;
    for op in [
        Add, Subtract, Multiply, Divide, Modulo, Min, Max, Power, Atan2, Dot, Cross, Less, LessEqual, Equal,
        And, Or,
    ] {
        match op {
            Add | Subtract | Multiply | Divide => {
                alone(|b, u, v| b.binary(op, u, v));
                alone(|b, u, _| b.binary(op, u, u));
                alone(|b, u, v| {
                    let x = b.component(u, 0);
                    b.binary(op, x, v)
                });
                alone(|b, u, v| {
                    let x = b.component(u, 1);
                    b.binary(op, v, x)
                });
            }
            Min | Max | Modulo | Power | Atan2 | Dot | Cross => {
                alone(|b, u, v| b.binary(op, u, v));
                alone(|b, u, v| b.binary(op, v, u));
                alone(|b, u, _| b.binary(op, u, u));
            }
            // Their results are bools; a choice by them follows the arm.
            Less | LessEqual | Equal => alone(|b, u, v| {
                let (x, y) = (b.component(u, 0), b.component(v, 0));
                let condition = b.binary(op, x, y);
                b.select(condition, u, v)
            }),
            And | Or => alone(|b, u, v| {
                let [x, y, z] = [0, 1, 2].map(|i| b.component(u, i));
                let (first, second) = (b.binary(Less, x, y), b.binary(Less, y, z));
                let condition = b.binary(op, first, second);
                b.select(condition, u, v)
            }),
        }
    }
}

#[test]
fn every_operation_on_three_values_has_its_derivative() {
    for op in [Ternary::Select, Ternary::Mix] {
        match op {
            Ternary::Select => alone(|b, u, v| {
                let (x, y) = (b.component(u, 2), b.component(v, 1));
                let condition = b.binary(Binary::Less, x, y);
                b.ternary(op, condition, u, v)
            }),
            Ternary::Mix => {
                alone(|b, u, v| b.ternary(op, u, v, u));
                alone(|b, u, v| {
                    let t = b.component(v, 0);
                    b.ternary(op, u, v, t)
                });
            }
        }
    }
}

/// `(sin(length(p·k)), p·k)`, which is active in one or both parameters.
fn callee() -> Function {
    let point = Parameter { name: "p".into(), ty: Type::Vec3, point: true };
    let factor = Parameter { name: "k".into(), ty: Type::Float, point: false };
    let mut b = Builder::new("callee", vec![point, factor]);
    let (p, k) = (b.argument(RegionId::ROOT, 0), b.argument(RegionId::ROOT, 1));
    let q = b.mul(p, k);
    let length = b.unary(Unary::Length, q);
    let sine = b.unary(Unary::Sin, length);
    b.finish(vec![(sine, "s".into()), (q, "q".into())])
}

#[test]
fn calls_branches_and_loops_carry_derivatives() {
    let mut program = Program::default();
    let callee = program.add(callee());
    let mut b = Builder::new("field", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
    let p = b.argument(RegionId::ROOT, 0);
    let (two, x) = (b.float(2.0), b.component(p, 0));
    let fixed = b.call(callee, &[Type::Float, Type::Vec3], &[p, two]);
    let moving = b.call(callee, &[Type::Float, Type::Vec3], &[fixed[1], x]);
    let constant = b.constant(Constant::Vec3([1.0, 2.0, 3.0]));
    let still = b.call(callee, &[Type::Float, Type::Vec3], &[constant, two]);
    let condition = b.binary(Binary::Less, fixed[0], moving[0]);
    let then = b.open_region(&[]);
    let square = b.mul(moving[1], x);
    b.close_region(vec![square, two]);
    let otherwise = b.open_region(&[]);
    let sine = b.unary(Unary::Sin, fixed[1]);
    b.close_region(vec![sine, x]);
    let branched = b.branch(condition, then, otherwise);
    // The second state moves only after the first round, the third never.
    let until = b.open_region(&[Type::Vec3, Type::Float, Type::Float]);
    let (sum, limit) = (b.argument(until, 1), b.float(3.0));
    let stop = b.binary(Binary::Less, limit, sum);
    b.close_region(vec![stop]);
    let next = b.open_region(&[Type::Float, Type::Vec3, Type::Float, Type::Float]);
    let [round, v, sum, step] = [0, 1, 2, 3].map(|i| b.argument(next, i));
    let tangled = b.unary(Unary::Cos, v);
    let length = b.unary(Unary::Length, v);
    let by_round = b.mul(length, round);
    let more = b.add(sum, by_round);
    let longer = b.mul(step, two);
    b.close_region(vec![tangled, more, longer]);
    let last = b.repeat(5, &[branched[0], still[0], two], until, next);
    let product = b.mul(last[1], branched[1]);
    let results = [last[0], product, last[2], moving[0]];
    let id = program.add(b.finish(results.map(|r| (r, "".into())).to_vec()));
    check(&mut program, id, &POINTS);
}

#[test]
fn what_was_made_is_not_made_again() {
    let mut program = Program::default();
    let callee = program.add(callee());
    let mut gradients = Gradients::default();
    let first = gradients.of(&mut program, callee);
    let count = program.functions.len();
    assert_eq!(gradients.of(&mut program, callee), first);
    assert_eq!(program.functions.len(), count);
}

#[test]
fn derivatives_are_finite_and_one_sided_at_kinks() {
    let at = |make: fn(&mut Builder, Value) -> Value, point: [f64; 3]| {
        let (mut program, id) = field(make);
        let g = gradient(&mut program, id);
        evaluate(&program, g, &[Constant::Vec3(point)])[1]
    };
    assert_eq!(at(|b, p| b.unary(Unary::Length, p), [0.0; 3]), Constant::Vec3([0.0; 3]));
    let abs = |b: &mut Builder, p: Value| {
        let x = b.component(p, 0);
        b.unary(Unary::Abs, x)
    };
    assert_eq!(at(abs, [0.0; 3]), Constant::Vec3([1.0, 0.0, 0.0]));
    let tie = |b: &mut Builder, p: Value| {
        let (x, y) = (b.component(p, 0), b.component(p, 1));
        b.max(x, y)
    };
    assert_eq!(at(tie, [0.5, 0.5, 0.0]), Constant::Vec3([1.0, 0.0, 0.0]));
    let root = |b: &mut Builder, p: Value| {
        let x = b.component(p, 0);
        b.unary(Unary::Sqrt, x)
    };
    assert_eq!(at(root, [0.0; 3]), Constant::Vec3([0.0; 3]));
    assert_eq!(at(root, [-1.0; 3]), Constant::Vec3([0.0; 3]));
}
