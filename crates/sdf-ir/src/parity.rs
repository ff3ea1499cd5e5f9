//! Whether a function of a point is the same on both sides of a plane, told from its operations: each component of each value
//! is even or odd in the distance from the plane, or neither is known.

use crate::knowledge::{Knowledge, Search};
use crate::program::{Binary, Function, Node, Program, Ternary, Unary, Value};

/// How many operations are looked at, calls expanded.
const MOST: usize = 20_000;
/// How far a sum of constants may be from zero by rounding, as a share of what was added up.
const ROUNDING: f64 = 1e-12;

/// How a number changes if the point is mirrored.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Parity {
    /// Not at all.
    Even,
    /// It is an odd number, which changes its sign, and this constant.
    Odd(f64),
    /// That is not known.
    Neither,
}

use Parity::{Even, Neither, Odd};

/// Whether the first result of a function of a point is the same at `middle + d` as at `middle - d` along an axis. If it says
/// no, it may be so nevertheless.
pub fn is_even(program: &Program, function: &Function, axis: usize, middle: f64) -> bool {
    let mut search = Search::new(program, Parities { scale: middle.abs().max(1.0) }, MOST);
    let mut point = [Even; 3];
    point[axis] = Odd(middle);
    search.function(function, &[point]).is_some_and(|results| results[0][0] == Even)
}

struct Parities {
    /// The size of the constants that are added up.
    scale: f64,
}

type Parts = [Parity; 3];

impl Knowledge for Parities {
    type Known = Parts;
    const UNKNOWN: Parts = [Neither; 3];
    const CONSTANT: Parts = [Even; 3];

    fn operation(&self, function: &Function, value: Value, at: &dyn Fn(Value) -> Parts) -> Parts {
        let size = |v: Value| function.type_of(v).map_or(1, |ty| ty.size());
        match function.node(value) {
            Node::Unary(op, a) => self.unary(op, &at(a)[..size(a)]),
            Node::Binary(op @ (Binary::Dot | Binary::Cross), a, b) => self.product(op, at(a), at(b), size(a)),
            Node::Binary(op, a, b) => {
                // A float goes with each component of a vector.
                let (n, m) = (size(a), size(b));
                let part = |v: Value, n: usize, i: usize| at(v)[if n == 1 { 0 } else { i }];
                let constant =
                    |v: Value, n: usize, i: usize| constant(function, v, if n == 1 { 0 } else { i });
                let mut out = [Neither; 3];
                for (i, out) in out.iter_mut().enumerate().take(n.max(m)) {
                    let (x, y) = (part(a, n, i), part(b, m, i));
                    *out = self.binary(op, x, y, constant(a, n, i), constant(b, m, i));
                }
                out
            }
            Node::Ternary(op, a, b, c) => {
                let decides = if op == Ternary::Select { at(a) } else { at(c) };
                let (x, y) = if op == Ternary::Select { (at(b), at(c)) } else { (at(a), at(b)) };
                let part = |i: usize| match decides
                    [if size(value) > 1 && op == Ternary::Mix && size(c) > 1 { i } else { 0 }]
                {
                    Even => self.alike(x[i], y[i]),
                    _ => Neither,
                };
                std::array::from_fn(|i| if i < size(value) { part(i) } else { Even })
            }
            Node::Compose2(x, y) => [at(x)[0], at(y)[0], Even],
            Node::Compose3(x, y, z) => [at(x)[0], at(y)[0], at(z)[0]],
            Node::Component(a, i) => [at(a)[usize::from(i)], Even, Even],
            _ => [Neither; 3],
        }
    }
}

impl Parities {
    /// Whether what was added up is nothing but rounding.
    fn is_zero(&self, shift: f64) -> bool {
        shift.abs() <= ROUNDING * self.scale
    }

    fn is_odd(&self, parity: Parity) -> bool {
        matches!(parity, Odd(shift) if self.is_zero(shift))
    }

    fn alike(&self, x: Parity, y: Parity) -> Parity {
        match (x, y) {
            (Even, Even) => Even,
            (Odd(a), Odd(b)) if self.is_zero(a - b) => Odd(a),
            _ => Neither,
        }
    }

    fn unary(&self, op: Unary, a: &[Parity]) -> Parts {
        let plain = |x: &Parity| *x == Even || self.is_odd(*x);
        let mut out = [Even; 3];
        match op {
            Unary::Length | Unary::Normalize if !a.iter().all(plain) => out = [Neither; 3],
            Unary::Length => {}
            Unary::Normalize => out[..a.len()].copy_from_slice(a),
            Unary::Hash => out = if a.iter().all(|x| *x == Even) { out } else { [Neither; 3] },
            _ => {
                for (out, x) in out.iter_mut().zip(a) {
                    *out = match (op, *x) {
                        (_, Even) => Even,
                        (Unary::Negate, Odd(shift)) => Odd(-shift),
                        (_, x) if !self.is_odd(x) => Neither,
                        (Unary::Abs | Unary::Cos, _) => Even,
                        (
                            Unary::Sign
                            | Unary::Sin
                            | Unary::Tan
                            | Unary::Asin
                            | Unary::Atan
                            | Unary::Tanh
                            | Unary::Trunc
                            | Unary::Round,
                            _,
                        ) => Odd(0.0),
                        _ => Neither,
                    };
                }
            }
        }
        out
    }

    fn binary(&self, op: Binary, x: Parity, y: Parity, c: Option<f64>, d: Option<f64>) -> Parity {
        match (op, x, y) {
            (_, Even, Even) => Even,
            (Binary::Add, Odd(a), Odd(b)) => Odd(a + b),
            (Binary::Subtract, Odd(a), Odd(b)) => Odd(a - b),
            (Binary::Add, Odd(a), Even) => d.map_or(Neither, |d| Odd(a + d)),
            (Binary::Add, Even, Odd(b)) => c.map_or(Neither, |c| Odd(b + c)),
            (Binary::Subtract, Odd(a), Even) => d.map_or(Neither, |d| Odd(a - d)),
            (Binary::Subtract, Even, Odd(b)) => c.map_or(Neither, |c| Odd(c - b)),
            (Binary::Multiply, Even, Odd(b)) if c.is_some() => Odd(b * c.unwrap_or(0.0)),
            (Binary::Multiply, Odd(a), Even) if d.is_some() => Odd(a * d.unwrap_or(0.0)),
            (Binary::Multiply | Binary::Divide, x, y) => match (self.is_odd(x), self.is_odd(y)) {
                (true, true) => Even,
                (true, false) if y == Even => Odd(0.0),
                (false, true) if x == Even => Odd(0.0),
                _ => Neither,
            },
            // The angle of the point (x, y).
            (Binary::Atan2, y, Even) if self.is_odd(y) => Odd(0.0),
            _ => Neither,
        }
    }

    fn product(&self, op: Binary, a: Parts, b: Parts, size: usize) -> Parts {
        let times = |i: usize, j: usize| self.binary(Binary::Multiply, a[i], b[j], None, None);
        let sum = |x: Parity, y: Parity| self.binary(Binary::Add, x, y, None, None);
        if op == Binary::Dot {
            let products = (1..size).map(|i| times(i, i));
            return [products.fold(times(0, 0), sum), Even, Even];
        }
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sum(times(j, k), times(k, j))
        })
    }
}

/// A component of a value, if it is a constant.
fn constant(function: &Function, value: Value, i: usize) -> Option<f64> {
    match function.node(value) {
        Node::Float(bits) => Some(f64::from_bits(bits)),
        Node::Compose2(x, y) => constant(function, *[x, y].get(i)?, 0),
        Node::Compose3(x, y, z) => constant(function, *[x, y, z].get(i)?, 0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Builder;
    use crate::constant::Constant;
    use crate::program::{Parameter, RegionId, Type};

    fn field(make: impl FnOnce(&mut Builder, Value) -> Value) -> Function {
        let point = Parameter { name: "p".into(), ty: Type::Vec3, point: true };
        let mut b = Builder::new("field", vec![point]);
        let p = b.argument(RegionId::ROOT, 0);
        let d = make(&mut b, p);
        b.finish(vec![(d, "".into())])
    }

    fn evens(function: &Function, middle: [f64; 3]) -> [bool; 3] {
        let program = Program::default();
        std::array::from_fn(|axis| is_even(&program, function, axis, middle[axis]))
    }

    #[test]
    fn a_moved_ball_is_even_about_its_middle() {
        let ball = field(|b, p| {
            let c = b.constant(Constant::Vec3([0.3, -0.7, 0.0]));
            let q = b.sub(p, c);
            b.unary(Unary::Length, q)
        });
        assert_eq!(evens(&ball, [0.3, -0.7, 0.0]), [true; 3]);
        assert_eq!(evens(&ball, [0.0; 3]), [false, false, true]);
    }

    #[test]
    fn a_slanting_plane_is_even_along_none_of_its_axes() {
        let plane = field(|b, p| {
            let n = b.constant(Constant::Vec3([0.6, 0.0, 0.8]));
            b.binary(Binary::Dot, n, p)
        });
        assert_eq!(evens(&plane, [0.0; 3]), [false, true, false]);
    }

    #[test]
    fn products_of_odd_numbers_are_even() {
        let saddle = field(|b, p| {
            let (x, y) = (b.component(p, 0), b.component(p, 1));
            let (product, square) = (b.mul(x, y), b.mul(x, x));
            let size = b.unary(Unary::Abs, product);
            b.sub(size, square)
        });
        assert_eq!(evens(&saddle, [0.0; 3]), [true; 3]);
    }
}
