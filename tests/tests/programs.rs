//! Random programs, printed, compiled by the driver and run: the text means what the program means.
//!
//! All numbers are whole and small, so that every order of computing gives the same bits: what is tested is the
//! printer (precedence, names, regions, structures, cutting), not the driver's rounding.

use sdf_emit::{KernelLanguage, emit_kernel};
use sdf_ir::{Binary, Builder, FunctionId, Parameter, Program, Ternary, Type, Unary, Value};
use sdf_tests::adapter::adapter;
use sdf_tests::numbers::{columns, word};
use sdf_tests::run::{on_device, on_lanes};

/// Arguments are whole numbers up to this.
const LARGEST: f64 = 4.0;
/// No value is larger; sums of a few are exact.
const BOUND: f64 = 1e5;

/// A random program in the making.
struct Grow {
    b: Builder,
    seed: u64,
    /// Numbers to choose from, each with its largest magnitude.
    floats: Vec<(Value, f64)>,
    vectors: Vec<(Value, f64)>,
    bools: Vec<Value>,
    /// A function of a float and a vec3 with a float, a bool and a vec3 as results.
    callee: Option<FunctionId>,
}

impl Grow {
    fn random(&mut self, below: usize) -> usize {
        self.seed += 1;
        word(self.seed) as usize % below
    }

    fn float(&mut self) -> (Value, f64) {
        if self.random(6) == 0 {
            let x = self.random(9) as f64 - 4.0;
            return (self.b.float(x), x.abs());
        }
        // Recent values more often, so that expressions nest.
        let (recent, any) = (self.random(4.min(self.floats.len())), self.random(self.floats.len()));
        let i = if self.random(2) == 0 { self.floats.len() - 1 - recent } else { any };
        self.floats[i]
    }

    fn vector(&mut self) -> (Value, f64) {
        let i = self.random(self.vectors.len());
        self.vectors[i]
    }

    fn bool(&mut self) -> Value {
        let i = self.random(self.bools.len());
        self.bools[i]
    }

    /// Adds a value that is made from those that are there.
    fn step(&mut self, nesting: usize) {
        match self.random(if nesting == 0 { 14 } else { 16 }) {
            0..=4 => {
                let ((a, m), (c, n)) = (self.float(), self.float());
                let (a, bound) = self.arithmetic(a, m, c, n);
                self.floats.push((a, bound));
            }
            5 => {
                let ((a, m), (c, n)) = (self.vector(), self.vector());
                let (a, bound) = self.arithmetic(a, m, c, n);
                self.vectors.push((a, bound));
            }
            6 => {
                let ((a, m), (c, n)) = (self.vector(), self.float());
                let op = [Binary::Add, Binary::Subtract][self.random(2)];
                let a = if self.random(2) == 0 { self.b.binary(op, a, c) } else { self.b.binary(op, c, a) };
                self.vectors.push((a, m + n));
            }
            7 => {
                let (a, m) = self.float();
                let op = [Unary::Negate, Unary::Abs, Unary::Floor, Unary::Round][self.random(4)];
                let a = self.b.unary(op, a);
                self.floats.push((a, m));
            }
            8 => {
                let ((a, _), (c, _)) = (self.float(), self.float());
                let op = [Binary::Less, Binary::LessEqual, Binary::Equal][self.random(3)];
                let a = self.b.binary(op, a, c);
                self.bools.push(a);
            }
            9 => {
                let (a, c) = (self.bool(), self.bool());
                let op = [Binary::And, Binary::Or, Binary::Equal][self.random(3)];
                let a = self.b.binary(op, a, c);
                let a = if self.random(3) == 0 { self.b.unary(Unary::Not, a) } else { a };
                self.bools.push(a);
            }
            10 => {
                let (c, (x, m), (y, n)) = (self.bool(), self.float(), self.float());
                let a = self.b.ternary(Ternary::Select, c, x, y);
                self.floats.push((a, m.max(n)));
            }
            11 => {
                let parts = [0; 3].map(|_| {
                    if self.random(2) == 0 {
                        let (v, m) = self.vector();
                        let i = self.random(3);
                        (self.b.component(v, i), m)
                    } else {
                        self.float()
                    }
                });
                let a = self.b.compose(&parts.map(|(v, _)| v));
                self.vectors.push((a, parts.iter().fold(0.0, |m, (_, n)| n.max(m))));
            }
            12 => {
                let ((a, m), (c, n)) = (self.vector(), self.vector());
                if 3.0 * m * n < BOUND {
                    let a = self.b.binary(Binary::Dot, a, c);
                    self.floats.push((a, 3.0 * m * n));
                }
            }
            13 => self.call(),
            14 => self.branch(nesting - 1),
            _ => self.repeat(nesting - 1),
        }
    }

    fn arithmetic(&mut self, a: Value, m: f64, c: Value, n: f64) -> (Value, f64) {
        let (op, bound) = match self.random(6) {
            0 | 1 if m * n < BOUND => (Binary::Multiply, m * n),
            2 => (Binary::Min, m.max(n)),
            3 => (Binary::Max, m.max(n)),
            4 => (Binary::Add, m + n),
            _ => (Binary::Subtract, m + n),
        };
        if bound < BOUND { (self.b.binary(op, a, c), bound) } else { (a, m) }
    }

    fn call(&mut self) {
        let Some(callee) = self.callee else { return };
        let ((x, m), (v, n)) = (self.float(), self.vector());
        if m > LARGEST || n > LARGEST {
            return;
        }
        let results = self.b.call(callee, &[Type::Float, Type::Bool, Type::Vec3], &[x, v]);
        self.floats.push((results[0], BOUND));
        self.bools.push(results[1]);
        self.vectors.push((results[2], BOUND));
    }

    /// Runs `steps` inside an open region, and forgets what they made.
    fn inside<T>(&mut self, steps: usize, nesting: usize, yielded: impl FnOnce(&mut Grow) -> T) -> T {
        let kept = (self.floats.len(), self.vectors.len(), self.bools.len());
        for _ in 0..steps {
            self.step(nesting);
        }
        let yielded = yielded(self);
        self.floats.truncate(kept.0);
        self.vectors.truncate(kept.1);
        self.bools.truncate(kept.2);
        yielded
    }

    fn branch(&mut self, nesting: usize) {
        let condition = self.bool();
        let [(then, m), (otherwise, n)] = [0, 1].map(|_| {
            self.b.open_region(&[]);
            let ((x, m), (v, n)) = self.inside(8, nesting, |g| (g.float(), g.vector()));
            (self.b.close_region(vec![x, v]), m.max(n))
        });
        let results = self.b.branch(condition, then, otherwise);
        self.floats.push((results[0], m.max(n)));
        self.vectors.push((results[1], m.max(n)));
    }

    /// Three numbers go round: each is assigned from others, so that the order of assigning matters.
    fn repeat(&mut self, nesting: usize) {
        let initial = [0; 3].map(|_| self.float());
        let bound = initial.iter().fold(0.0f64, |m, (_, n)| m.max(*n));
        let count = 1 + self.random(4) as u32;
        let bound = (bound + 1.0) * f64::from(3u32.pow(count));
        if bound > BOUND {
            return;
        }
        let states = [Type::Float; 3];
        let until = self.b.open_region(&states);
        let limit = self.b.float(7.0);
        let i = self.random(3) as u16;
        let state = self.b.argument(until, i);
        let stop = self.b.binary(Binary::Less, limit, state);
        self.b.close_region(vec![stop]);
        let next = self.b.open_region(&[Type::Float; 4]);
        let [round, x, y, z] = [0, 1, 2, 3].map(|i| self.b.argument(next, i));
        let results = self.inside(4, nesting, |g| {
            let (a, c) = (g.b.add(y, z), g.b.sub(x, round));
            let all = [[a, x, c], [y, z, x], [z, c, y], [x, a, y]];
            all[g.random(4)]
        });
        self.b.close_region(results.to_vec());
        let initial = initial.map(|(v, _)| v);
        for v in self.b.repeat(count, &initial, until, next) {
            self.floats.push((v, bound));
        }
    }

    /// A function of a float and a vec3 that returns a float, a bool and a vec3.
    fn function(seed: u64, steps: usize, callee: Option<FunctionId>) -> sdf_ir::Function {
        let mut b = Builder::new(format!("f_{seed}"), Vec::new());
        let parameter = |name: &str, ty| Parameter { name: name.into(), ty, point: false };
        let x = b.add_parameter(parameter("x", Type::Float));
        let v = b.add_parameter(parameter("v", Type::Vec3));
        let yes = b.binary(Binary::Less, x, x);
        let mut grow = Grow {
            b,
            seed: seed << 32,
            floats: vec![(x, LARGEST)],
            vectors: vec![(v, LARGEST)],
            bools: vec![yes],
            callee,
        };
        for _ in 0..steps {
            grow.step(2);
        }
        // Everything counts, so that nothing is dead.
        let mut sum = grow.b.float(0.0);
        for (v, _) in grow.floats.clone().into_iter().filter(|(_, m)| *m < BOUND) {
            let folded = grow.b.min(sum, v);
            sum = grow.b.sub(folded, v);
            sum = grow.b.max(sum, folded);
        }
        let (last, (v, _)) = (*grow.bools.last().expect("one"), *grow.vectors.last().expect("one"));
        grow.b.finish(vec![(sum, "sum".into()), (last, "last".into()), (v, "v".into())])
    }
}

/// A program of two functions, and the one that calls the other.
fn program(seed: u64, steps: usize) -> (Program, FunctionId) {
    let mut program = Program::default();
    let callee = program.add(Grow::function(2 * seed + 1, 6, None));
    let function = program.add(Grow::function(2 * seed + 2, steps, Some(callee)));
    (program, function)
}

fn check(seed: u64, steps: usize) {
    let (program, function) = program(seed, steps);
    let whole = |n| (word(n) % 9) as f32 - LARGEST as f32;
    let arguments = columns(&[Type::Float, Type::Vec3], 4096, whole);
    let expected = on_lanes(&program, function, &arguments);
    for language in [KernelLanguage::Wgsl, KernelLanguage::Glsl450] {
        let found = on_device(adapter(), &program, function, language, &arguments);
        for (column, (e, f)) in expected.iter().zip(&found).enumerate() {
            // The sign of zero depends on the order of adding.
            let same = |a: u32, b: u32| a == b || f32::from_bits(a) == f32::from_bits(b);
            let wrong = (0..e.len()).find(|i| !same(e[*i], f[*i]));
            assert_eq!(wrong, None, "seed {seed}, result {column} in {language:?}");
        }
    }
}

#[test]
fn short_programs() {
    (0..60).for_each(|seed| check(seed, 25));
}

/// Long enough to be cut into several functions.
#[test]
fn long_programs() {
    for seed in 1000..1003 {
        let (program, function) = program(seed, 2500);
        let text = emit_kernel(&program, function, KernelLanguage::Wgsl).unwrap();
        assert!(text.contains("_part_2"), "seed {seed} is too short");
        check(seed, 2500);
    }
}
