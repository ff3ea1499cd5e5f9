//! Every rule against the plain meaning: an expression is built twice, with the rules and without, and both are
//! evaluated in `f64`. What the rules leave must compute the same and take no more operations.

use crate::build::Builder;
use crate::constant::Constant;
use crate::copy::live;
use crate::cost::operations_of_node;
use crate::program::{Binary, Function, Node, Parameter, RegionId, Ternary, Type, Unary, Value};
use crate::reference::evaluate_alone;

const PARAMETERS: [Type; 6] = [Type::Float, Type::Float, Type::Vec2, Type::Vec3, Type::Vec3, Type::Bool];

#[derive(Debug, Clone)]
enum Expression {
    Parameter(usize),
    Constant(Constant),
    Unary(Unary, Box<Expression>),
    Binary(Binary, Box<Expression>, Box<Expression>),
    Ternary(Ternary, Box<Expression>, Box<Expression>, Box<Expression>),
    Compose(Vec<Expression>),
    Component(Box<Expression>, usize),
}

impl Expression {
    /// The value of the expression, with the rules or as it stands.
    fn build(&self, b: &mut Builder, rules: bool) -> Value {
        match self {
            Expression::Parameter(index) => b.argument(RegionId::ROOT, *index as u16),
            Expression::Constant(c) => b.constant(*c),
            Expression::Unary(op, a) => {
                let a = a.build(b, rules);
                let ty = match op {
                    Unary::Length => Type::Float,
                    _ => b.ty(a),
                };
                if rules { b.unary(*op, a) } else { b.push(Node::Unary(*op, a), Some(ty)) }
            }
            Expression::Binary(op, x, y) => {
                let (x, y) = (x.build(b, rules), y.build(b, rules));
                let ty = match op {
                    Binary::Dot => Type::Float,
                    Binary::Less | Binary::LessEqual | Binary::Equal => Type::Bool,
                    _ => b.ty(x).max(b.ty(y)),
                };
                if rules { b.binary(*op, x, y) } else { b.push(Node::Binary(*op, x, y), Some(ty)) }
            }
            Expression::Ternary(op, x, y, z) => {
                let (x, y, z) = (x.build(b, rules), y.build(b, rules), z.build(b, rules));
                let ty = b.ty(y);
                if rules { b.ternary(*op, x, y, z) } else { b.push(Node::Ternary(*op, x, y, z), Some(ty)) }
            }
            Expression::Compose(parts) => {
                let parts: Vec<Value> = parts.iter().map(|part| part.build(b, rules)).collect();
                match parts[..] {
                    _ if rules => b.compose(&parts),
                    [x, y] => b.push(Node::Compose2(x, y), Some(Type::Vec2)),
                    [x, y, z] => b.push(Node::Compose3(x, y, z), Some(Type::Vec3)),
                    _ => unreachable!("vectors have two or three components"),
                }
            }
            Expression::Component(a, index) => {
                let a = a.build(b, rules);
                if rules {
                    b.component(a, *index)
                } else {
                    b.push(Node::Component(a, *index as u8), Some(Type::Float))
                }
            }
        }
    }

    fn function(&self, rules: bool) -> Function {
        let parameters = PARAMETERS.iter().enumerate().map(|(i, ty)| Parameter {
            name: format!("a{i}").into(),
            ty: *ty,
            point: false,
        });
        let mut b = Builder::new("expression", parameters.collect());
        let result = self.build(&mut b, rules);
        b.finish(vec![(result, "".into())])
    }
}

/// The only result of a function, and its largest intermediate value.
fn evaluate(function: &Function, arguments: &[Constant]) -> (Constant, f64) {
    let (results, largest) = evaluate_alone(function, arguments);
    let largest = arguments.iter().flat_map(|c| c.components()).fold(largest, |m, x| m.max(x.abs()));
    (results[0], largest)
}

fn operations(function: &Function) -> u64 {
    let live = live(function);
    let values = (0..function.node_count() as u32).map(Value);
    values.filter(|v| live[v.0 as usize]).map(|v| operations_of_node(function, v)).sum()
}

/// Fails where the rules change what the expression computes by more than `tolerance` of the largest
/// intermediate value, or make it dearer.
fn check(expression: &Expression, points: &[Vec<Constant>], tolerance: f64) {
    let (plain, simplified) = (expression.function(false), expression.function(true));
    for point in points {
        let ((expected, a), (found, b)) = (evaluate(&plain, point), evaluate(&simplified, point));
        let close = match (expected, found) {
            (Constant::Bool(x), Constant::Bool(y)) => x == y,
            (x, y) => {
                let pairs = x.components().iter().zip(y.components());
                x.ty() == y.ty()
                    && pairs.into_iter().all(|(x, y)| (x - y).abs() <= tolerance * a.max(b) || x == y)
            }
        };
        assert!(close, "{expression:?}\nat {point:?}\n{expected:?} became {found:?}\n{plain}\n{simplified}");
    }
    let (before, after) = (operations(&plain), operations(&simplified));
    assert!(after <= before, "{before} operations became {after}:\n{plain}\n{simplified}");
}

/// A small generator of numbers, so that every run tests the same.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % n
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    fn constant(&mut self, ty: Type, numbers: &[f64]) -> Constant {
        match ty {
            Type::Bool => Constant::Bool(self.below(2) == 0),
            _ => {
                let parts: Vec<f64> = (0..ty.size()).map(|_| self.of(numbers)).collect();
                Constant::from_components(&parts)
            }
        }
    }

    fn points(&mut self, count: usize, numbers: &[f64]) -> Vec<Vec<Constant>> {
        (0..count).map(|_| PARAMETERS.iter().map(|ty| self.constant(*ty, numbers)).collect()).collect()
    }

    /// An expression of operations that are exact on small whole numbers and halves.
    fn expression(&mut self, ty: Type, depth: usize) -> Expression {
        if depth == 0 || self.below(8) == 0 {
            return self.leaf(ty);
        }
        let depth = depth - 1;
        let boxed = |r: &mut Random, ty: Type| Box::new(r.expression(ty, depth));
        match (ty, self.below(10)) {
            (Type::Bool, 0) => Expression::Unary(Unary::Not, boxed(self, Type::Bool)),
            (Type::Bool, 1..4) => {
                let op = self.of(&[Binary::And, Binary::Or, Binary::Equal]);
                Expression::Binary(op, boxed(self, Type::Bool), boxed(self, Type::Bool))
            }
            (Type::Bool, _) => {
                let op = self.of(&[Binary::Less, Binary::LessEqual, Binary::Equal]);
                Expression::Binary(op, boxed(self, Type::Float), boxed(self, Type::Float))
            }
            (_, 0) => {
                let op = self.of(&[Unary::Negate, Unary::Abs, Unary::Floor, Unary::Sign, Unary::Round]);
                Expression::Unary(op, boxed(self, ty))
            }
            (_, 1) => Expression::Unary(Unary::Negate, boxed(self, ty)),
            (_, 2) => {
                let condition = boxed(self, Type::Bool);
                Expression::Ternary(Ternary::Select, condition, boxed(self, ty), boxed(self, ty))
            }
            (_, 3) => {
                let t = if self.below(2) == 0 { ty } else { Type::Float };
                Expression::Ternary(Ternary::Mix, boxed(self, ty), boxed(self, ty), boxed(self, t))
            }
            (Type::Float, 4) => {
                let vector = self.of(&[Type::Vec2, Type::Vec3]);
                Expression::Binary(Binary::Dot, boxed(self, vector), boxed(self, vector))
            }
            (Type::Float, 5) => {
                let vector = self.of(&[Type::Vec2, Type::Vec3]);
                let index = self.below(vector.size());
                Expression::Component(boxed(self, vector), index)
            }
            (Type::Vec2 | Type::Vec3, 4) => {
                Expression::Compose((0..ty.size()).map(|_| self.expression(Type::Float, depth)).collect())
            }
            (Type::Vec3, 5) => Expression::Binary(Binary::Cross, boxed(self, ty), boxed(self, ty)),
            (_, 6) => {
                let op = self.of(&[Binary::Min, Binary::Max]);
                Expression::Binary(op, boxed(self, ty), boxed(self, ty))
            }
            _ => {
                let op = self.of(&[Binary::Add, Binary::Subtract, Binary::Multiply]);
                let (left, right) = self.of(&[(ty, ty), (ty, Type::Float), (Type::Float, ty)]);
                Expression::Binary(op, boxed(self, left), boxed(self, right))
            }
        }
    }

    fn leaf(&mut self, ty: Type) -> Expression {
        if self.below(2) == 0 {
            return Expression::Constant(self.constant(ty, &[0.0, 0.0, 1.0, -1.0, 2.0, 0.5, -3.0]));
        }
        let fitting: Vec<usize> = (0..PARAMETERS.len()).filter(|i| PARAMETERS[*i] == ty).collect();
        Expression::Parameter(self.of(&fitting))
    }
}

#[test]
fn exact_operations_stay_exact() {
    let mut random = Random(1);
    for _ in 0..40_000 {
        let ty = random.of(&[Type::Bool, Type::Float, Type::Float, Type::Vec2, Type::Vec3, Type::Vec3]);
        let depth = 1 + random.below(4);
        let expression = random.expression(ty, depth);
        let points = random.points(4, &[0.0, -0.0, 1.0, -1.0, 2.0, -2.0, 0.5, 3.0]);
        check(&expression, &points, 0.0);
    }
}

/// All pairs of operations, the inner one on either side, on numbers that are extreme but do not overflow.
#[test]
fn pairs_of_operations_keep_their_meaning_on_nasty_numbers() {
    let mut random = Random(2);
    let numbers = [0.0, -0.0, 1.0, -1.0, 2.0, 0.25, -0.3, 1e-30, -1e-12, 3e-5, 7e8, -1e9];
    let binary = [Binary::Add, Binary::Subtract, Binary::Multiply, Binary::Divide, Binary::Min, Binary::Max];
    let unary = [Unary::Negate, Unary::Abs, Unary::Sqrt, Unary::Floor, Unary::Sign, Unary::Tanh];
    for ty in [Type::Float, Type::Vec2, Type::Vec3] {
        for outer in binary {
            for inner in binary {
                for _ in 0..60 {
                    let [x, y, z] = [0; 3].map(|_| Box::new(nasty_leaf(&mut random, ty, &numbers)));
                    let points = random.points(8, &numbers);
                    let inside = Expression::Binary(inner, x.clone(), y.clone());
                    let left = Expression::Binary(outer, Box::new(inside.clone()), z.clone());
                    let right = Expression::Binary(outer, z.clone(), Box::new(inside));
                    check(&left, &points, 1e-15);
                    check(&right, &points, 1e-15);
                    for op in unary {
                        let of_left = Box::new(Expression::Unary(op, x.clone()));
                        let of_right = Box::new(Expression::Unary(op, y.clone()));
                        check(&Expression::Binary(outer, of_left.clone(), z.clone()), &points, 1e-15);
                        check(&Expression::Binary(outer, z.clone(), of_left.clone()), &points, 1e-15);
                        check(&Expression::Binary(outer, of_left, of_right), &points, 1e-15);
                        // A jump or a root would magnify the rounding of a reassociated sum.
                        if matches!(op, Unary::Negate | Unary::Abs | Unary::Tanh) {
                            check(&Expression::Unary(op, Box::new(left.clone())), &points, 1e-15);
                        }
                    }
                }
            }
        }
    }
}

fn nasty_leaf(random: &mut Random, ty: Type, numbers: &[f64]) -> Expression {
    if random.below(2) == 0 {
        return Expression::Constant(random.constant(ty, numbers));
    }
    let fitting: Vec<usize> = (0..PARAMETERS.len()).filter(|i| PARAMETERS[*i] == ty).collect();
    Expression::Parameter(random.of(&fitting))
}

/// The identities of operations that stand alone.
#[test]
fn the_rest_of_the_rules_keep_their_meaning() {
    let mut random = Random(3);
    let numbers = [0.0, 1.0, -1.0, 2.0, 0.25, -0.3, 1e-12, 3e5];
    for _ in 0..4_000 {
        let points = random.points(8, &numbers);
        for ty in [Type::Vec2, Type::Vec3] {
            let parts =
                (0..ty.size()).map(|_| nasty_leaf(&mut random, Type::Float, &[0.0, 1.0, 0.3])).collect();
            let vector = Box::new(Expression::Compose(parts));
            let other = Box::new(nasty_leaf(&mut random, ty, &[0.0, 1.0, 0.3, -2.0]));
            let negative = Box::new(Expression::Unary(Unary::Negate, other.clone()));
            for vector in [&vector, &other, &negative] {
                check(&Expression::Unary(Unary::Length, vector.clone()), &points, 1e-15);
                check(&Expression::Unary(Unary::Normalize, vector.clone()), &points, 1e-15);
                check(&Expression::Binary(Binary::Dot, vector.clone(), other.clone()), &points, 1e-15);
                check(&Expression::Binary(Binary::Modulo, other.clone(), vector.clone()), &points, 1e-15);
                if ty == Type::Vec3 {
                    check(&Expression::Binary(Binary::Cross, vector.clone(), other.clone()), &points, 1e-15);
                    check(&Expression::Binary(Binary::Cross, other.clone(), vector.clone()), &points, 1e-15);
                }
            }
            for exponent in [0.0, 1.0, 2.0, 0.5] {
                let exponent = Expression::Constant(Constant::from_components(&[exponent; 3][..ty.size()]));
                let power = Expression::Binary(Binary::Power, other.clone(), Box::new(exponent));
                check(&power, &points, 1e-15);
            }
        }
    }
}

/// Whole vectors are found again behind their components.
#[test]
fn an_operation_on_each_component_is_one_on_the_vector() {
    let v = || Expression::Parameter(3);
    let by_component = |make: &dyn Fn(Expression) -> Expression| {
        Expression::Compose((0..3).map(|i| make(Expression::Component(Box::new(v()), i))).collect())
    };
    let one = |op| move |part| Expression::Unary(op, Box::new(part));
    let two =
        |op, other: Expression| move |part| Expression::Binary(op, Box::new(part), Box::new(other.clone()));
    let points = Random(4).points(20, &[1.0, -2.0, 3.5, 0.0, 0.1]);
    let cases: [(&dyn Fn(Expression) -> Expression, usize); 5] = [
        (&|part| part, 0),
        (&one(Unary::Sin), 1),
        (&one(Unary::Negate), 1),
        (&two(Binary::Divide, Expression::Parameter(0)), 1),
        (&two(Binary::Min, Expression::Constant(Constant::Float(2.0))), 2),
    ];
    for (make, nodes) in cases {
        let expression = by_component(make);
        check(&expression, &points, 0.0);
        let function = expression.function(true);
        let live = live(&function);
        let left = function.root().body.iter().filter(|v| live[v.0 as usize]).count();
        assert_eq!(left, nodes, "{function}");
    }
}

fn three_rows(b: &mut Builder, rows: [[f64; 3]; 3], q: Value) -> Value {
    let parts = rows.map(|row| {
        let row = b.constant(Constant::Vec3(row));
        b.binary(Binary::Dot, row, q)
    });
    b.compose(&parts)
}

/// The rows of a rotation about `axis`, by Rodrigues' formula.
fn rotation(axis: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let Constant::Vec3([x, y, z]) = Constant::unary(Unary::Normalize, Constant::Vec3(axis)) else {
        unreachable!()
    };
    let (s, c) = angle.sin_cos();
    let k = 1.0 - c;
    [
        [c + x * x * k, x * y * k - z * s, x * z * k + y * s],
        [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
        [z * x * k - y * s, z * y * k + x * s, c + z * z * k],
    ]
}

fn apply(rows: [[f64; 3]; 3], q: [f64; 3]) -> [f64; 3] {
    rows.map(|row| row.iter().zip(&q).map(|(a, b)| a * b).sum())
}

#[test]
fn ten_thousand_rotations_and_translations_are_one() {
    let point = Parameter { name: "p".into(), ty: Type::Vec3, point: true };
    let mut b = Builder::new("chain", vec![point]);
    let mut q = b.argument(RegionId::ROOT, 0);
    let start = [0.3, -1.2, 0.7];
    let (mut expected, mut farthest) = (start, 1.0f64);
    let axes = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 2.0, -0.5]];
    for link in 0..10_000 {
        let offset = [[0.25, 0.0, 0.0], [-0.5, 0.125, 1.0], [0.0, -0.25, 0.0]][link % 3];
        let rows = rotation(axes[link % 4], 0.1 + link as f64 * 0.37);
        q = three_rows(&mut b, rows, q);
        expected = apply(rows, expected);
        if link % 2 == 0 {
            let c = b.constant(Constant::Vec3(offset));
            q = b.sub(q, c);
            expected = std::array::from_fn(|i| expected[i] - offset[i]);
            farthest = expected.iter().fold(farthest, |m, x| m.max(x.abs()));
        }
    }
    let chain = crate::copy::rebuild(&b.finish(vec![(q, "".into())]));
    let (Constant::Vec3(found), _) = evaluate(&chain, &[Constant::Vec3(start)]) else { unreachable!() };
    for (x, y) in found.iter().zip(&expected) {
        assert!((x - y).abs() < 1e-12 * farthest, "{found:?} is not {expected:?}");
    }
    // The translation and its vector, the rows and their vectors, the whole.
    assert!(chain.root().body.len() <= 9, "{chain}");
}

#[test]
fn a_quarter_turn_moves_components() {
    let mut b = Builder::new("quarter", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
    let p = b.argument(RegionId::ROOT, 0);
    let turned = three_rows(&mut b, rotation([0.0, 1.0, 0.0], std::f64::consts::FRAC_PI_2), p);
    let function = crate::copy::rebuild(&b.finish(vec![(turned, "".into())]));
    assert_eq!(operations(&function), 1, "{function}");
}

#[test]
fn turns_of_the_plane_are_one() {
    let mut b = Builder::new("plane", vec![Parameter { name: "p".into(), ty: Type::Vec2, point: true }]);
    let mut q = b.argument(RegionId::ROOT, 0);
    let mut expected = [0.5, -2.0];
    for link in 0..100 {
        let (s, c) = (link as f64 * 0.7).sin_cos();
        let rows = [[c, s], [-s, c]];
        let parts = rows.map(|row| {
            let row = b.constant(Constant::Vec2(row));
            b.binary(Binary::Dot, row, q)
        });
        q = b.compose(&parts);
        expected = rows.map(|row| row[0] * expected[0] + row[1] * expected[1]);
        let c = b.float(0.25);
        q = b.add(q, c);
        expected = expected.map(|x| x + 0.25);
    }
    let chain = crate::copy::rebuild(&b.finish(vec![(q, "".into())]));
    let (Constant::Vec2(found), _) = evaluate(&chain, &[Constant::Vec2([0.5, -2.0])]) else { unreachable!() };
    assert!(found.iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-12), "{found:?} is not {expected:?}");
    assert!(operations(&chain) <= 2 + 6 + 2, "{chain}");
}

/// Two turns about axes at right angles leave entries that are zero but for rounding; whatever they are, folding ends.
#[test]
fn two_turns_about_any_axes_are_one() {
    let axes = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    for n in 0..10_000u32 {
        let (first, second) = (axes[n as usize % 3], axes[n as usize / 3 % 3]);
        let angles = [f64::from(n % 97) * 0.1 - 4.0, f64::from(n / 97) * std::f64::consts::TAU / 7.0];
        let mut b = Builder::new("turns", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
        let p = b.argument(RegionId::ROOT, 0);
        let rows = [rotation(first, angles[0]), rotation(second, angles[1])];
        let offset = b.constant(Constant::Vec3([0.9, 0.2, 0.1]));
        let q = three_rows(&mut b, rows[0], p);
        let q = b.sub(q, offset);
        let q = three_rows(&mut b, rows[1], q);
        let function = b.finish(vec![(q, "".into())]);
        let (Constant::Vec3(found), _) = evaluate(&function, &[Constant::Vec3([0.3, -1.2, 0.7])]) else {
            unreachable!()
        };
        let [x, y, z] = apply(rows[0], [0.3, -1.2, 0.7]);
        let expected = apply(rows[1], [x - 0.9, y - 0.2, z - 0.1]);
        assert!(found.iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-13), "{n}: {found:?}");
    }
}
