//! Whether a function of a point is affine, told from its operations: a constant vector times the point, and a constant.

use crate::knowledge::{Knowledge, Search};
use crate::program::{Binary, Function, Node, Program, Ternary, Unary, Value};

/// How many operations are looked at, calls expanded.
const MOST: usize = 2_000;

/// How a value depends on the point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Degree {
    /// Not at all.
    Constant,
    /// As an affine function; of a vector, each component.
    Affine,
    /// In another way, or it is not known in which.
    Other,
}

use Degree::{Affine, Constant, Other};

/// Whether the first result of a function of a point is an affine function of it that is not constant: the field of a half
/// space. If it says no, it may be one nevertheless.
pub fn is_affine(program: &Program, function: &Function) -> bool {
    let mut search = Search::new(program, Degrees, MOST);
    search.function(function, &[Affine]).is_some_and(|results| results[0] == Affine)
}

struct Degrees;

impl Knowledge for Degrees {
    type Known = Degree;
    const UNKNOWN: Degree = Other;
    const CONSTANT: Degree = Constant;

    fn operation(&self, function: &Function, value: Value, at: &dyn Fn(Value) -> Degree) -> Degree {
        // What depends on values in no way that is known, unless all are constant.
        let any = |values: &[Value]| {
            if values.iter().all(|v| at(*v) == Constant) { Constant } else { Other }
        };
        match function.node(value) {
            Node::Unary(Unary::Negate, a) | Node::Component(a, _) => at(a),
            Node::Unary(_, a) => any(&[a]),
            Node::Binary(Binary::Add | Binary::Subtract, a, b) => at(a).max(at(b)),
            Node::Binary(Binary::Multiply | Binary::Dot | Binary::Cross, a, b) => match (at(a), at(b)) {
                (Constant, other) | (other, Constant) => other,
                _ => Other,
            },
            Node::Binary(Binary::Divide, a, b) if at(b) == Constant => at(a),
            Node::Binary(_, a, b) => any(&[a, b]),
            Node::Ternary(Ternary::Select, condition, a, b) if at(condition) == Constant => at(a).max(at(b)),
            Node::Ternary(Ternary::Mix, a, b, t) if at(t) == Constant => at(a).max(at(b)),
            Node::Ternary(_, a, b, c) => any(&[a, b, c]),
            Node::Compose2(x, y) => at(x).max(at(y)),
            Node::Compose3(x, y, z) => at(x).max(at(y)).max(at(z)),
            _ => Other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Builder;
    use crate::constant;
    use crate::program::{Parameter, RegionId, Type};

    fn affine(make: impl FnOnce(&mut Builder, Value) -> Value) -> bool {
        let point = Parameter { name: "p".into(), ty: Type::Vec3, point: true };
        let mut b = Builder::new("field", vec![point]);
        let p = b.argument(RegionId::ROOT, 0);
        let d = make(&mut b, p);
        is_affine(&Program::default(), &b.finish(vec![(d, "".into())]))
    }

    #[test]
    fn a_half_space_is_affine_and_its_shell_is_not() {
        let plane = |b: &mut Builder, p: Value| {
            let n = b.constant(constant::Constant::Vec3([0.6, 0.0, 0.8]));
            let (dot, offset) = (b.binary(Binary::Dot, n, p), b.float(0.3));
            b.add(dot, offset)
        };
        assert!(affine(plane));
        assert!(!affine(|b, p| {
            let d = plane(b, p);
            b.unary(Unary::Abs, d)
        }));
    }

    #[test]
    fn products_lengths_and_constants_are_not() {
        assert!(!affine(|b, p| b.binary(Binary::Dot, p, p)));
        assert!(!affine(|b, p| b.unary(Unary::Length, p)));
        assert!(!affine(|b, _| b.float(1.0)));
        assert!(!affine(|b, p| {
            let (x, y) = (b.component(p, 0), b.component(p, 1));
            b.mul(x, y)
        }));
        assert!(affine(|b, p| {
            let (x, y) = (b.component(p, 0), b.component(p, 1));
            let two = b.float(2.0);
            let double = b.mul(two, x);
            b.sub(double, y)
        }));
    }
}
