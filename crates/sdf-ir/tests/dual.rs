//! Duals against central differences, for every operation.

use sdf_ir::eval::{Machine, Tape};
use sdf_ir::number::{Dual, Number};
use sdf_ir::{Binary, Builder, Constant, Parameter, Program, RegionId, Ternary, Type, Unary, Value};

/// Ordinary points, away from creases and jumps of what is tested, inside the domains of asin and acos and outside.
const POINTS: [[f64; 3]; 6] = [
    [0.31, 0.52, 0.73],
    [-0.42, 0.23, -0.64],
    [0.85, -0.36, 0.17],
    [-0.74, -0.93, -0.28],
    [2.35, 1.41, -3.17],
    [-5.13, 4.27, 1.83],
];

/// A function of a point, whose derivative the duals and the differences must agree on.
fn check(name: &str, write: impl FnOnce(&mut Builder, Value) -> Value) {
    let mut b = Builder::new("f", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: false }]);
    let p = b.argument(RegionId::ROOT, 0);
    let result = write(&mut b, p);
    let mut program = Program::default();
    let entry = program.add(b.finish(vec![(result, "".into())]));
    let tape = Tape::compile(&program, entry);
    let mut duals = Machine::<Dual<f64>>::new(&tape);
    let mut numbers = Machine::<f64>::new(&tape);
    for point in POINTS {
        let variables: [Dual<f64>; 3] = std::array::from_fn(|i| Dual::variable(point[i], i));
        let outputs = duals.run_one(&variables);
        let values = numbers.run_one(&point);
        for (k, output) in outputs.iter().enumerate() {
            assert_eq!(output.value, values[k], "{name} at {point:?}");
            for i in 0..3 {
                const STEP: f64 = 1e-6;
                let mut at = |step: f64| {
                    let mut moved = point;
                    moved[i] += step;
                    numbers.run_one(&moved)[k]
                };
                let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                let slope = output.slope[i];
                let error = (slope - difference).abs() / (1.0 + slope.abs());
                assert!(error < 1e-6, "{name} at {point:?}, by {i}: {slope} is not {difference}");
            }
        }
    }
}

/// A vec3 with other numbers than p, all of them moving with all of p.
fn other(b: &mut Builder, p: Value) -> Value {
    let turned: Vec<Value> = [1, 2, 0].iter().map(|i| b.component(p, *i)).collect();
    let turned = b.compose(&turned);
    let factor = b.constant(Constant::Vec3([0.7, -1.3, 0.9]));
    let scaled = b.mul(turned, factor);
    let part = b.float(0.21);
    let part = b.mul(p, part);
    b.add(scaled, part)
}

/// The first component of a vector, where an operation wants a number.
fn first(b: &mut Builder, v: Value) -> Value {
    b.component(v, 0)
}

/// 0.1 and more, smooth: for operations on positive numbers.
fn positive(b: &mut Builder, v: Value) -> Value {
    let square = b.mul(v, v);
    let least = b.constant(Constant::Vec3([0.1; 3]));
    b.add(square, least)
}

#[test]
fn unary_operations() {
    for op in Unary::ALL {
        check(&format!("{op:?}"), |b, p| {
            let v = other(b, p);
            match op {
                // A number as far as slopes are concerned: none.
                Unary::Not => {
                    let (x, y) = (first(b, p), first(b, v));
                    let less = b.binary(Binary::Less, x, y);
                    b.unary(op, less)
                }
                Unary::Mantissa | Unary::Exponent => {
                    let v = positive(b, v);
                    b.unary(op, v)
                }
                Unary::ReduceAngle => {
                    let x = first(b, v);
                    b.unary(op, x)
                }
                // Jumps everywhere: only the slope 0 of what does not move can be compared.
                Unary::Hash => {
                    let v = b.unary(Unary::Floor, v);
                    b.unary(op, v)
                }
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
                | Unary::Length
                | Unary::Normalize
                | Unary::PowerOfTwo => b.unary(op, v),
            }
        });
    }
}

#[test]
fn binary_operations() {
    for op in Binary::ALL {
        check(&format!("{op:?}"), |b, p| {
            let v = other(b, p);
            match op {
                Binary::Add
                | Binary::Subtract
                | Binary::Multiply
                | Binary::Divide
                | Binary::Modulo
                | Binary::Min
                | Binary::Max
                | Binary::Atan2
                | Binary::Dot
                | Binary::Cross => b.binary(op, v, p),
                Binary::Power => {
                    let base = positive(b, p);
                    b.binary(op, base, v)
                }
                Binary::Less | Binary::LessEqual | Binary::Equal => {
                    let (x, y) = (first(b, p), first(b, v));
                    b.binary(op, x, y)
                }
                Binary::And | Binary::Or => {
                    let (x, y) = (first(b, p), first(b, v));
                    let (less, equal) = (b.binary(Binary::Less, x, y), b.binary(Binary::Equal, x, y));
                    b.binary(op, less, equal)
                }
            }
        });
    }
}

#[test]
fn ternary_operations() {
    for op in Ternary::ALL {
        check(&format!("{op:?}"), |b, p| {
            let v = other(b, p);
            let (x, y) = (first(b, p), first(b, v));
            match op {
                Ternary::Select => {
                    let less = b.binary(Binary::Less, x, y);
                    b.ternary(op, less, p, v)
                }
                Ternary::Mix => b.ternary(op, p, v, y),
            }
        });
    }
}

/// The powers of a negative number, and of zero, have the slopes of the polynomials that they are.
#[test]
fn powers_of_no_positive_number() {
    let power =
        |x: f64, y: f64| Dual::binary(Binary::Power, Dual::variable(x, 0), Dual::constant(y)).slope[0];
    assert_eq!(power(-2.0, 3.0), 12.0);
    assert_eq!(power(-2.0, 2.0), -4.0);
    assert_eq!(power(0.0, 1.0), 1.0);
    assert_eq!(power(0.0, 2.0), 0.0);
}

/// Where something saturates, is clamped or has a pole, it is flat, and nothing is infinite.
#[test]
fn slopes_are_finite_everywhere() {
    for x in [0.0f64, -0.0, 1.0, -1.0, 2.0, 1e-300, -1e30, 1e5] {
        for op in Unary::ALL {
            let scalar = !matches!(
                op,
                Unary::Not
                    | Unary::Length
                    | Unary::Normalize
                    | Unary::Hash
                    | Unary::ReduceAngle
                    | Unary::Mantissa
            );
            if scalar {
                let slope = Dual::unary(op, Dual::variable(x, 0)).slope[0];
                assert!(slope.is_finite() || op == Unary::PowerOfTwo, "{op:?} at {x}: {slope}");
            }
        }
        let mut direction = [Dual::constant(0.0); 2];
        let v = [Dual::variable(x, 0), Dual::variable(0.0, 1)];
        Dual::normalize(&v, &mut direction);
        let length = Dual::length(&v);
        assert!(direction.iter().chain([&length]).all(|d| d.slope.iter().all(|s| s.is_finite())), "{x}");
    }
}
