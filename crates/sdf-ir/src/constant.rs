//! Values known at compile time, and what each operation makes of them, in `f64`.

use crate::number::Number;
use crate::program::{Binary, Ternary, Type, Unary};

/// A value known at compile time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Constant {
    /// A truth value.
    Bool(bool),
    /// A number.
    Float(f64),
    /// Two numbers.
    Vec2([f64; 2]),
    /// Three numbers.
    Vec3([f64; 3]),
}

impl Constant {
    /// Its type.
    pub fn ty(&self) -> Type {
        match self {
            Constant::Bool(_) => Type::Bool,
            Constant::Float(_) => Type::Float,
            Constant::Vec2(_) => Type::Vec2,
            Constant::Vec3(_) => Type::Vec3,
        }
    }

    /// Its numbers; none for a bool.
    pub fn components(&self) -> &[f64] {
        match self {
            Constant::Bool(_) => &[],
            Constant::Float(x) => std::slice::from_ref(x),
            Constant::Vec2(v) => v,
            Constant::Vec3(v) => v,
        }
    }

    /// The float or vector of one to three numbers.
    pub fn from_components(c: &[f64]) -> Constant {
        match *c {
            [x] => Constant::Float(x),
            [x, y] => Constant::Vec2([x, y]),
            [x, y, z] => Constant::Vec3([x, y, z]),
            _ => panic!("no constant has {} components", c.len()),
        }
    }

    /// Whether every number is finite as an `f32`.
    pub fn is_finite(&self) -> bool {
        self.components().iter().all(|x| (*x as f32).is_finite())
    }

    /// Component `i`, with a float standing for a vector of equal components.
    fn at(&self, i: usize) -> f64 {
        let c = self.components();
        c[if c.len() == 1 { 0 } else { i }]
    }

    fn bool(&self) -> bool {
        matches!(self, Constant::Bool(true))
    }

    /// What the operation makes of it. The argument's type must be one that the operation takes.
    pub fn unary(op: Unary, a: Constant) -> Constant {
        let c = a.components();
        match op {
            Unary::Not => Constant::Bool(!a.bool()),
            Unary::Length => Constant::Float(f64::length(c)),
            Unary::Normalize => {
                let mut out = [0.0; 3];
                f64::normalize(c, &mut out[..c.len()]);
                Constant::from_components(&out[..c.len()])
            }
            Unary::Hash => Constant::Float(f64::hash(c)),
            Unary::ReduceAngle => Constant::Vec2(c[0].reduce_angle()),
            _ => Constant::map(c.len(), |i| f64::unary(op, c[i])),
        }
    }

    /// What the operation makes of both. The arguments' types must be ones that the operation takes.
    pub fn binary(op: Binary, a: Constant, b: Constant) -> Constant {
        let n = a.components().len().max(b.components().len());
        match op {
            Binary::Dot => Constant::Float(f64::dot(a.components(), b.components())),
            Binary::Cross => {
                let (Constant::Vec3(a), Constant::Vec3(b)) = (a, b) else { panic!("cross wants two vec3") };
                Constant::Vec3(f64::cross(a, b))
            }
            Binary::Less => Constant::Bool(a.at(0) < b.at(0)),
            Binary::LessEqual => Constant::Bool(a.at(0) <= b.at(0)),
            Binary::Equal => Constant::Bool(a == b),
            Binary::And => Constant::Bool(a.bool() && b.bool()),
            Binary::Or => Constant::Bool(a.bool() || b.bool()),
            _ => Constant::map(n, |i| f64::binary(op, a.at(i), b.at(i))),
        }
    }

    /// What the operation makes of the three. The arguments' types must be ones that the operation takes.
    pub fn ternary(op: Ternary, a: Constant, b: Constant, c: Constant) -> Constant {
        match op {
            Ternary::Select => {
                if a.bool() {
                    b
                } else {
                    c
                }
            }
            Ternary::Mix => Constant::map(a.components().len(), |i| {
                let t = c.at(i);
                a.at(i) * (1.0 - t) + b.at(i) * t
            }),
        }
    }

    fn map(n: usize, f: impl Fn(usize) -> f64) -> Constant {
        let mut out = [0.0; 3];
        for (i, x) in out.iter_mut().enumerate().take(n) {
            *x = f(i);
        }
        Constant::from_components(&out[..n])
    }
}
