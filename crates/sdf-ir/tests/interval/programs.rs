//! Random functions of a point with calls, branches and loops: values lie in their bounds, and no pair of points is
//! steeper than the slope says.

use crate::answers::rotate;
use crate::random::Random;
use sdf_ir::eval::{Machine, Tape, point};
use sdf_ir::interval::{Bounds, Interval, Sloped, Walker};
use sdf_ir::{
    Binary, Builder, Constant, Function, FunctionId, Parameter, Program, Role, Ternary, Type, Unary, Uniform,
    Value,
};

/// A random function in the making.
struct Grow {
    b: Builder,
    random: Random,
    floats: Vec<Value>,
    vec2s: Vec<Value>,
    vec3s: Vec<Value>,
    bools: Vec<Value>,
    callee: Option<FunctionId>,
    /// Whether operations that jump may be used.
    jumps: bool,
}

impl Grow {
    fn recent(&mut self, ty: Type) -> Value {
        let list = match ty {
            Type::Bool => &self.bools,
            Type::Float => &self.floats,
            Type::Vec2 => &self.vec2s,
            Type::Vec3 => &self.vec3s,
        };
        let n = list.len();
        let i = if self.random.below(2) == 0 {
            n - 1 - self.random.below(n.min(4))
        } else {
            self.random.below(n)
        };
        list[i]
    }

    fn float(&mut self) -> Value {
        if self.random.below(5) == 0 {
            let x = self.random.of(&[0.0, 1.0, -1.0, 0.5, 2.0, -3.0, 0.3, 0.1]);
            return self.b.float(x);
        }
        self.recent(Type::Float)
    }

    fn keep(&mut self, value: Value) {
        match self.b.ty(value) {
            Type::Bool => self.bools.push(value),
            Type::Float => self.floats.push(value),
            Type::Vec2 => self.vec2s.push(value),
            Type::Vec3 => self.vec3s.push(value),
        }
    }

    fn numeric(&mut self) -> Type {
        self.random.of(&[Type::Float, Type::Float, Type::Vec2, Type::Vec3, Type::Vec3])
    }

    fn operand(&mut self, ty: Type) -> Value {
        if ty == Type::Float { self.float() } else { self.recent(ty) }
    }

    fn step(&mut self, nesting: usize) {
        let ty = self.numeric();
        let made = match self.random.below(if nesting == 0 { 17 } else { 20 }) {
            0..=2 => {
                let (x, y) = (self.operand(ty), self.operand(ty));
                let op = self.random.of(&[Binary::Add, Binary::Subtract, Binary::Multiply]);
                self.b.binary(op, x, y)
            }
            3 | 4 => {
                let (x, y) = (self.operand(ty), self.operand(ty));
                let op = self.random.of(&[Binary::Min, Binary::Max]);
                self.b.binary(op, x, y)
            }
            5 => {
                let (x, y) = (self.operand(ty), self.float());
                let op = self.random.of(&[Binary::Add, Binary::Multiply, Binary::Divide]);
                self.b.binary(op, x, y)
            }
            6 | 7 => {
                let x = self.operand(ty);
                let op = self.smooth_or_any_unary();
                self.b.unary(op, x)
            }
            8 => {
                let x = self.operand(ty);
                match (ty.is_vector(), self.random.below(2)) {
                    (true, 0) => self.b.unary(Unary::Length, x),
                    (true, _) => self.b.unary(Unary::Normalize, x),
                    _ => self.b.unary(Unary::Abs, x),
                }
            }
            9 => {
                let ty = self.random.of(&[Type::Vec2, Type::Vec3]);
                let (x, y) = (self.operand(ty), self.operand(ty));
                self.b.binary(Binary::Dot, x, y)
            }
            10 => {
                let (x, y) = (self.operand(Type::Vec3), self.operand(Type::Vec3));
                self.b.binary(Binary::Cross, x, y)
            }
            11 => {
                let v = self.operand(Type::Vec3);
                let parts = [self.random.below(3), self.random.below(3)].map(|i| self.b.component(v, i));
                self.b.compose(&parts)
            }
            12 => {
                let parts = [self.float(), self.float(), self.float()];
                let n = 2 + self.random.below(2);
                self.b.compose(&parts[..n])
            }
            13 => {
                let (a, b) = (self.operand(ty), self.operand(ty));
                let t = if self.random.below(2) == 0 { self.operand(ty) } else { self.float() };
                self.b.ternary(Ternary::Mix, a, b, t)
            }
            14 => {
                let (x, y) = (self.float(), self.float());
                let op = self.random.of(&[Binary::Less, Binary::LessEqual]);
                self.b.binary(op, x, y)
            }
            15 => {
                let (c, x, y) = (self.recent(Type::Bool), self.operand(ty), self.operand(ty));
                self.b.select(c, x, y)
            }
            16 => self.rotation(),
            17 => return self.call(),
            18 => return self.branch(nesting - 1),
            _ => return self.repeat(nesting - 1),
        };
        self.keep(made);
    }

    fn smooth_or_any_unary(&mut self) -> Unary {
        let smooth =
            [Unary::Negate, Unary::Abs, Unary::Sin, Unary::Cos, Unary::Atan, Unary::Tanh, Unary::Sqrt];
        let others = [
            Unary::Floor,
            Unary::Ceil,
            Unary::Round,
            Unary::Trunc,
            Unary::Sign,
            Unary::Exp,
            Unary::Exp2,
            Unary::Log,
            Unary::Log2,
            Unary::Asin,
            Unary::Acos,
            Unary::Tan,
            Unary::Hash,
        ];
        if self.jumps && self.random.below(3) == 0 {
            self.random.of(&others)
        } else {
            self.random.of(&smooth)
        }
    }

    /// A vec3 turned about some axis, coordinate axes more often.
    fn rotation(&mut self) -> Value {
        let (v, angle) = (self.operand(Type::Vec3), self.float());
        let axis = self.random.of(&[[0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -1.0], [1.0, 2.0, -0.5]]);
        let axis = self.b.constant(Constant::Vec3(axis));
        rotate(&mut self.b, v, axis, angle)
    }

    fn call(&mut self) {
        let Some(callee) = self.callee else { return };
        let (v, x) = (self.operand(Type::Vec3), self.float());
        let results = self.b.call(callee, &[Type::Float, Type::Vec3], &[v, x]);
        results.into_iter().for_each(|v| self.keep(v));
    }

    fn inside(&mut self, steps: usize, nesting: usize) -> (Value, Value) {
        let kept = (self.floats.len(), self.vec2s.len(), self.vec3s.len(), self.bools.len());
        for _ in 0..steps {
            self.step(nesting);
        }
        let yielded = (self.float(), self.recent(Type::Vec3));
        self.floats.truncate(kept.0);
        self.vec2s.truncate(kept.1);
        self.vec3s.truncate(kept.2);
        self.bools.truncate(kept.3);
        yielded
    }

    fn branch(&mut self, nesting: usize) {
        let condition = self.recent(Type::Bool);
        let [then, otherwise] = [0, 1].map(|_| {
            self.b.open_region(&[]);
            let (x, v) = self.inside(5, nesting);
            self.b.close_region(vec![x, v])
        });
        for v in self.b.branch(condition, then, otherwise) {
            self.keep(v);
        }
    }

    fn repeat(&mut self, nesting: usize) {
        let initial = [self.float(), self.recent(Type::Vec3)];
        let types = [Type::Float, Type::Vec3];
        let until = self.b.open_region(&types);
        let state = self.b.argument(until, 0);
        let limit = self.float();
        let stop = self.b.binary(Binary::Less, limit, state);
        self.b.close_region(vec![stop]);
        let next = self.b.open_region(&[Type::Float, Type::Float, Type::Vec3]);
        let [round, x, v] = [0, 1, 2].map(|i| self.b.argument(next, i));
        let kept = (self.floats.len(), self.vec3s.len());
        self.floats.extend([round, x]);
        self.vec3s.push(v);
        let (x, v) = self.inside(4, nesting);
        self.floats.truncate(kept.0);
        self.vec3s.truncate(kept.1);
        self.b.close_region(vec![x, v]);
        let count = 1 + self.random.below(4) as u32;
        for v in self.b.repeat(count, &initial, until, next) {
            self.keep(v);
        }
    }

    /// A function of a point and a number, and of a uniform.
    fn function(seed: u64, steps: usize, callee: Option<FunctionId>, jumps: bool) -> Function {
        let mut b = Builder::new("f", Vec::new());
        let p = b.add_parameter(Parameter { name: "p".into(), ty: Type::Vec3, point: true });
        let x = b.add_parameter(Parameter { name: "x".into(), ty: Type::Float, point: false });
        let u = b.uniform(0, Type::Float);
        let parts = b.components(p);
        let pair = b.compose(&parts[..2]);
        let less = b.binary(Binary::Less, parts[0], x);
        let mut floats = parts;
        floats.extend([x, u]);
        let random = Random(seed);
        let mut grow =
            Grow { b, random, floats, vec2s: vec![pair], vec3s: vec![p], bools: vec![less], callee, jumps };
        for _ in 0..steps {
            grow.step(2);
        }
        let (x, v) = (grow.recent(Type::Float), grow.recent(Type::Vec3));
        grow.b.finish(vec![(x, "x".into()), (v, "v".into())])
    }
}

fn program(seed: u64, steps: usize, jumps: bool) -> (Program, FunctionId) {
    let mut program = Program {
        uniforms: vec![Uniform {
            name: "u".into(),
            ty: Type::Float,
            role: Role::Time,
            default: Constant::Float(0.0),
        }],
        ..Program::default()
    };
    let callee = program.add(Grow::function(2 * seed + 1, 8, None, jumps));
    let function = program.add(Grow::function(2 * seed + 2, steps, Some(callee), jumps));
    assert_eq!(sdf_ir::verify(&program), Ok(()));
    (program, function)
}

fn is_sane(c: &Constant) -> bool {
    c.components().iter().all(|x| x.abs() < 1e100)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum: f64, (x, y)| sum.hypot(x - y))
}

#[test]
fn values_lie_in_their_bounds() {
    let (mut decided, mut closer) = (0, 0);
    for seed in 0..400 {
        let (program, id) = program(seed, 14, true);
        let mut random = Random(seed);
        let mut duals_random = Random(seed + 1000);
        for _ in 0..6 {
            let p = random.bounds(Type::Vec3, Random::small);
            let (x, u) =
                (random.bounds(Type::Float, Random::small), random.bounds(Type::Float, Random::small));
            let mut walker = Walker::<Bounds>::new(&program, program.function(id), &[u], &[]);
            let bounds = walker.run(&[p, x]).to_vec();
            let by_cases = walker.run_by_cases(&[p, x], 5);
            closer += by_cases.iter().zip(&bounds).filter(|(a, b)| a != b).count();
            let mut walker = Walker::<Sloped>::new(&program, program.function(id), &[u], &[]);
            let sloped = walker.run(&[Sloped::point(p), Sloped::steady(x)]).to_vec();
            decided += usize::from(bounds[0].is_finite());
            for _ in 0..24 {
                let arguments = [p, x].map(|b| duals_random.value(&b));
                let results = point(&program, id, &arguments, &[random.value(&u)]);
                for (i, (bounds, sloped)) in bounds.iter().zip(&sloped).enumerate() {
                    let result = &results[i];
                    let inside = bounds.contains(*result)
                        && by_cases[i].contains(*result)
                        && sloped.bounds.contains(*result);
                    assert!(
                        inside || !is_sane(result),
                        "seed {seed}: {result:?} is not in\n{bounds:?}\n{:?}\n{sloped:?}\nat {arguments:?} of {p:?} {x:?}\n{}",
                        by_cases[i],
                        program.function(id)
                    );
                }
            }
        }
    }
    assert!(decided > 1000, "only {decided} bounds say anything");
    assert!(closer > 100, "only {closer} bounds are closer by cases");
}

#[test]
fn no_pair_of_points_is_steeper_than_the_slope() {
    let mut finite = 0;
    for seed in 0..600 {
        let (program, id) = program(seed, 12, seed % 3 == 0);
        let mut random = Random(seed);
        for _ in 0..5 {
            let p = random.bounds(Type::Vec3, Random::small);
            let (x, u) =
                (random.bounds(Type::Float, Random::small), random.bounds(Type::Float, Random::small));
            let mut walker = Walker::<Sloped>::new(&program, program.function(id), &[u], &[]);
            let sloped = walker.run(&[Sloped::point(p), Sloped::steady(x)]).to_vec();
            finite += sloped.iter().filter(|s| s.norm().is_finite() && s.norm() > 0.0).count();
            let (x, u) = (random.value(&x), random.value(&u));
            for _ in 0..24 {
                let [a, b] = [0, 1].map(|_| random.value(&p));
                // Close ones too.
                let b = if random.below(2) == 0 {
                    let near: Vec<f64> = (0..3)
                        .map(|i| {
                            let (x, y) = (a.components()[i], b.components()[i]);
                            x + (y - x) * 1e-4
                        })
                        .collect();
                    Constant::from_components(&near)
                } else {
                    b
                };
                let step = distance(a.components(), b.components());
                let [left, right] = [a, b].map(|p| point(&program, id, &[p, x], &[u]));
                for (i, sloped) in sloped.iter().enumerate() {
                    if step == 0.0 || !is_sane(&left[i]) || !is_sane(&right[i]) {
                        continue;
                    }
                    let change = distance(left[i].components(), right[i].components());
                    let size = left[i].components().iter().fold(1.0, |m: f64, x| m.max(x.abs()));
                    assert!(
                        change <= sloped.norm() * step * (1.0 + 1e-9) + 1e-9 * size,
                        "seed {seed}: from {a:?} to {b:?} result {i} changes by {change} over {step}\n{sloped:?}\n{x:?} {u:?}\n{}",
                        program.function(id)
                    );
                }
            }
        }
    }
    assert!(finite > 1500, "only {finite} slopes say anything");
}

/// The lanes in `f64` compute what the walk over a point computes.
#[test]
fn lanes_agree_with_the_point() {
    for seed in 0..150 {
        let (program, id) = program(seed, 14, true);
        let tape = Tape::compile(&program, id);
        let mut machine = Machine::<f64>::new(&tape);
        let mut random = Random(seed);
        let u = random.value(&Bounds::float(Interval::new(-4.0, 4.0)));
        machine.set_uniforms(&[u]);
        for _ in 0..8 {
            let [x, y, z, w] = [0; 4].map(|_| 8.0 * random.unit() - 4.0);
            let expected = point(&program, id, &[Constant::Vec3([x, y, z]), Constant::Float(w)], &[u]);
            let found = machine.run_one(&[x, y, z, w]);
            let expected: Vec<f64> = expected.iter().flat_map(|c| c.components().to_vec()).collect();
            let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
            assert!(
                expected.len() == found.len() && expected.iter().zip(&found).all(|(a, b)| same(*a, *b)),
                "seed {seed}: {expected:?} is not {found:?}"
            );
        }
    }
}
