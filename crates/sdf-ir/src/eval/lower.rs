//! Function to body: scalars, small callees written in, nested blocks.
//!
//! Registers are virtual here, one for each scalar that is computed; [`allocate`](super::allocate) packs them.

use super::allocate::allocate;
use super::tape::{
    Block, BlockId, Body, Call, If, Instruction, Loop, Operand, Register, Step, Tape, scalar_count,
};
use crate::program::{Binary, Function, FunctionId, Node, Program, RegionId, Ternary, Unary, Value};
use rustc_hash::FxHashMap;

/// A callee of at most so many operations, its own callees included, is written into its caller.
const INLINE_LIMIT: usize = 256;

/// The tape of a function.
pub(crate) fn compile(program: &Program, function: FunctionId, counting: bool) -> Tape {
    let globals = scalar_count(program.uniforms.iter().map(|u| u.ty));
    let constants_start = globals + scalar_count(program.globals.iter().map(|g| g.ty));
    let tape = Tape {
        bodies: Vec::new(),
        entry: 0,
        frame: None,
        uniforms: program.uniforms.clone(),
        globals,
        constants_start,
        constants: Vec::new(),
        functions: program.functions.len(),
        counting,
    };
    let mut compiler = Compiler {
        program,
        tape,
        counting,
        constants: FxHashMap::default(),
        bodies: FxHashMap::default(),
        sizes: expanded_sizes(program),
    };
    let frame = program.frame.map(|frame| compiler.body(frame));
    let entry = compiler.body(function);
    Tape { entry, frame, ..compiler.tape }
}

/// How many operations each function has, those of its callees included.
fn expanded_sizes(program: &Program) -> Vec<usize> {
    let mut sizes: Vec<usize> = Vec::new();
    for function in &program.functions {
        let mut size = 0usize;
        for region in (0..function.region_count()).map(|r| function.region(RegionId(r as u32))) {
            for value in &region.body {
                size = size.saturating_add(match function.node(*value) {
                    Node::Call(callee, _) => sizes[callee.0 as usize],
                    _ => 1,
                });
            }
        }
        sizes.push(size);
    }
    sizes
}

struct Compiler<'p> {
    program: &'p Program,
    tape: Tape,
    counting: bool,
    /// The scalar of each constant, by its bits.
    constants: FxHashMap<u64, u32>,
    /// The bodies that are there already.
    bodies: FxHashMap<FunctionId, usize>,
    sizes: Vec<usize>,
}

impl Compiler<'_> {
    fn body(&mut self, id: FunctionId) -> usize {
        if let Some(body) = self.bodies.get(&id) {
            return *body;
        }
        let function = self.program.function(id);
        let inputs = scalar_count(function.parameters.iter().map(|p| p.ty));
        let body = Body {
            function: id,
            is_evaluation: function.is_evaluation(),
            code: Vec::new(),
            blocks: vec![Block::default()],
            root: 0,
            inputs,
            outputs: Vec::new(),
            registers: 0,
            depth: 0,
        };
        let mut lowering = Lowering {
            next_register: inputs as u32,
            current: 0,
            straight: 0,
            evaluates: false,
            body,
            compiler: self,
        };
        let registers: Vec<Operand> = (0..inputs as u32).map(Operand::Register).collect();
        let outputs = lowering.function(id, &registers);
        lowering.flush();
        lowering.body.outputs = outputs;
        let mut body = lowering.body;
        allocate(&mut body, &self.tape.bodies);
        self.tape.bodies.push(body);
        let index = self.tape.bodies.len() - 1;
        self.bodies.insert(id, index);
        index
    }

    fn constant(&mut self, x: f64) -> Operand {
        let next = (self.tape.constants_start + self.tape.constants.len()) as u32;
        let constants = &mut self.tape.constants;
        Operand::Scalar(*self.constants.entry(x.to_bits()).or_insert_with(|| {
            constants.push(x);
            next
        }))
    }
}

/// The values of one function, or of one that is written into another.
struct Values<'p> {
    function: &'p Function,
    /// The scalars of each value of a region's body so far.
    scalars: Vec<Option<Vec<Operand>>>,
    /// The scalars of each region's arguments, one after the other.
    arguments: FxHashMap<RegionId, Vec<Operand>>,
}

struct Lowering<'c, 'p> {
    compiler: &'c mut Compiler<'p>,
    body: Body,
    next_register: Register,
    /// The block that steps are added to.
    current: BlockId,
    /// Where its straight code that is not yet a step begins.
    straight: usize,
    /// Whether what is written in is inside of an evaluation that was written in too.
    evaluates: bool,
}

impl<'p> Lowering<'_, 'p> {
    fn function(&mut self, id: FunctionId, arguments: &[Operand]) -> Vec<Operand> {
        let function = self.compiler.program.function(id);
        let mut values = Values {
            function,
            scalars: vec![None; function.node_count()],
            arguments: FxHashMap::from_iter([(RegionId::ROOT, arguments.to_vec())]),
        };
        self.region(&mut values, RegionId::ROOT)
    }

    /// Writes the code of a region and returns the scalars of its results.
    fn region(&mut self, values: &mut Values<'p>, region: RegionId) -> Vec<Operand> {
        let region = values.function.region(region);
        for value in &region.body {
            let scalars = self.node(values, *value);
            values.scalars[value.0 as usize] = Some(scalars);
        }
        region.results.iter().flat_map(|v| self.value(values, *v)).collect()
    }

    /// The scalars of a value: a leaf, or one whose code has been written.
    fn value(&mut self, values: &Values<'p>, value: Value) -> Vec<Operand> {
        let program = self.compiler.program;
        let scalars = |start: usize, size: usize| {
            (start..start + size).map(|i| Operand::Scalar(i as u32)).collect::<Vec<_>>()
        };
        match values.function.node(value) {
            Node::Float(bits) => vec![self.compiler.constant(f64::from_bits(bits))],
            Node::Bool(b) => vec![self.compiler.constant(f64::from(b))],
            Node::Argument(region, index) => {
                let types = &values.function.region(region).arguments;
                let index = index as usize;
                let start = scalar_count(types[..index].iter().copied());
                values.arguments[&region][start..start + types[index].size()].to_vec()
            }
            Node::Uniform(index) => {
                let before = &program.uniforms[..index as usize];
                let start = scalar_count(before.iter().map(|u| u.ty));
                scalars(start, program.uniforms[index as usize].ty.size())
            }
            Node::Global(index) => {
                let before = &program.globals[..index as usize];
                let start = self.compiler.tape.globals + scalar_count(before.iter().map(|g| g.ty));
                scalars(start, program.globals[index as usize].ty.size())
            }
            _ => values.scalars[value.0 as usize].clone().expect("a value is computed before it is used"),
        }
    }

    /// Writes the code of a node and returns its scalars; a tuple's are those of its parts.
    fn node(&mut self, values: &mut Values<'p>, value: Value) -> Vec<Operand> {
        let function = values.function;
        match function.node(value) {
            Node::Unary(op, a) => {
                let a = self.value(values, a);
                self.unary(op, &a)
            }
            Node::Binary(op, a, b) => {
                let (a, b) = (self.value(values, a), self.value(values, b));
                self.binary(op, &a, &b)
            }
            Node::Ternary(op, a, b, c) => {
                let (a, b, c) = (self.value(values, a), self.value(values, b), self.value(values, c));
                self.ternary(op, &a, &b, &c)
            }
            Node::Compose2(x, y) => [x, y].into_iter().flat_map(|v| self.value(values, v)).collect(),
            Node::Compose3(x, y, z) => [x, y, z].into_iter().flat_map(|v| self.value(values, v)).collect(),
            Node::Component(a, index) => vec![self.value(values, a)[index as usize]],
            Node::Call(callee, list) => {
                let arguments: Vec<Operand> =
                    function.list(list).iter().flat_map(|v| self.value(values, *v)).collect();
                self.call(callee, &arguments)
            }
            Node::If(condition, then, otherwise) => self.branch(values, condition, then, otherwise),
            Node::Loop(repeat) => self.repeat(values, repeat),
            Node::Result(tuple, index) => {
                let types = self.tuple_types(function, tuple);
                let index = index as usize;
                let start = scalar_count(types[..index].iter().copied());
                self.value(values, tuple)[start..start + types[index].size()].to_vec()
            }
            Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_) => {
                self.value(values, value)
            }
        }
    }

    fn tuple_types(&self, function: &Function, tuple: Value) -> Vec<crate::Type> {
        let of = |values: &[Value]| {
            values.iter().map(|v| function.type_of(*v).expect("a part is no tuple")).collect::<Vec<_>>()
        };
        match function.node(tuple) {
            Node::Call(callee, _) => self.compiler.program.function(callee).result_types(),
            Node::If(_, then, _) => of(&function.region(then).results),
            Node::Loop(repeat) => of(function.list(repeat.initial)),
            node => unreachable!("{node:?} is no tuple"),
        }
    }

    // ---- operations

    fn unary(&mut self, op: Unary, a: &[Operand]) -> Vec<Operand> {
        match (op, a) {
            (Unary::Length, _) => {
                let out = self.register();
                let a = self.registers(a);
                self.push(match *a {
                    [x, y] => Instruction::Length2 { out, a: [x, y] },
                    [x, y, z] => Instruction::Length3 { out, a: [x, y, z] },
                    _ => Instruction::Unary { op: Unary::Abs, out, a: a[0] },
                });
                vec![Operand::Register(out)]
            }
            (Unary::Normalize, _) => {
                let a = self.registers(a);
                let out: Vec<Register> = a.iter().map(|_| self.register()).collect();
                self.push(match (&*a, &*out) {
                    (&[x, y], &[u, v]) => Instruction::Normalize2 { out: [u, v], a: [x, y] },
                    (&[x, y, z], &[u, v, w]) => Instruction::Normalize3 { out: [u, v, w], a: [x, y, z] },
                    _ => Instruction::Unary { op: Unary::Sign, out: out[0], a: a[0] },
                });
                out.into_iter().map(Operand::Register).collect()
            }
            (Unary::Hash, _) => {
                let registers = self.registers(a);
                let out = self.register();
                let at = |i: usize| registers[i.min(registers.len() - 1)];
                self.push(Instruction::Hash { out, a: [at(0), at(1), at(2)], size: registers.len() });
                vec![Operand::Register(out)]
            }
            (Unary::ReduceAngle, _) => {
                let a = self.registers(a)[0];
                let out = [self.register(), self.register()];
                self.push(Instruction::ReduceAngle { out, a });
                out.map(Operand::Register).to_vec()
            }
            _ => {
                let a = self.registers(a);
                a.into_iter().map(|a| self.write(|out| Instruction::Unary { op, out, a })).collect()
            }
        }
    }

    fn binary(&mut self, op: Binary, a: &[Operand], b: &[Operand]) -> Vec<Operand> {
        match op {
            Binary::Dot => {
                let (a, b) = (self.registers(a), self.registers(b));
                let dot = self.write(|out| match (&*a, &*b) {
                    (&[x, y], &[u, v]) => Instruction::Dot2 { out, a: [x, y], b: [u, v] },
                    (&[x, y, z], &[u, v, w]) => Instruction::Dot3 { out, a: [x, y, z], b: [u, v, w] },
                    _ => {
                        let (a, b) = (Operand::Register(a[0]), Operand::Register(b[0]));
                        Instruction::Binary { op: Binary::Multiply, out, a, b }
                    }
                });
                vec![dot]
            }
            Binary::Cross => {
                let mut part = |i: usize, j: usize| {
                    let left = self.binary(Binary::Multiply, &a[i..=i], &b[j..=j]);
                    let right = self.binary(Binary::Multiply, &a[j..=j], &b[i..=i]);
                    self.binary(Binary::Subtract, &left, &right)[0]
                };
                vec![part(1, 2), part(2, 0), part(0, 1)]
            }
            _ => (0..a.len().max(b.len()))
                .map(|i| {
                    let (a, b) = (component(a, i), component(b, i));
                    self.write(|out| Instruction::Binary { op, out, a, b })
                })
                .collect(),
        }
    }

    fn ternary(&mut self, op: Ternary, a: &[Operand], b: &[Operand], c: &[Operand]) -> Vec<Operand> {
        match op {
            Ternary::Select => {
                let condition = self.registers(a)[0];
                (0..b.len())
                    .map(|i| self.write(|out| Instruction::Select { out, condition, a: b[i], b: c[i] }))
                    .collect()
            }
            Ternary::Mix => {
                let a = self.registers(a);
                (0..a.len())
                    .map(|i| {
                        let t = component(c, i);
                        self.write(|out| Instruction::Mix { out, a: a[i], b: b[i], t })
                    })
                    .collect()
            }
        }
    }

    // ---- structure

    fn call(&mut self, callee: FunctionId, arguments: &[Operand]) -> Vec<Operand> {
        if self.compiler.sizes[callee.0 as usize] <= INLINE_LIMIT {
            let outer = self.evaluates;
            self.evaluates |= self.compiler.program.function(callee).is_evaluation();
            if self.compiler.counting {
                // What is small enough to be written in calls nothing that is not, so this is all that counts in it.
                self.step(Step::Count { function: callee, is_evaluation: self.evaluates && !outer });
            }
            let results = self.function(callee, arguments);
            self.evaluates = outer;
            return results;
        }
        let body = self.compiler.body(callee);
        let count = self.compiler.tape.bodies[body].outputs.len();
        let results: Vec<Register> = (0..count).map(|_| self.register()).collect();
        self.step(Step::Call(Call { body, arguments: arguments.to_vec(), results: results.clone() }));
        results.into_iter().map(Operand::Register).collect()
    }

    fn branch(
        &mut self,
        values: &mut Values<'p>,
        condition: Value,
        then: RegionId,
        otherwise: RegionId,
    ) -> Vec<Operand> {
        let condition = self.value(values, condition)[0];
        let types = values.function.region(then).results.iter();
        let count = scalar_count(types.map(|v| values.function.type_of(*v).expect("a result is no tuple")));
        let results: Vec<Register> = (0..count).map(|_| self.register()).collect();
        let mut side = |region: RegionId| {
            self.block(|this| {
                let yielded = this.region(values, region);
                for (out, a) in results.iter().zip(yielded) {
                    this.push(Instruction::Copy { out: *out, a });
                }
            })
        };
        let (then, otherwise) = (side(then), side(otherwise));
        self.step(Step::If(If {
            condition,
            then,
            otherwise,
            then_captures: Vec::new(),
            otherwise_captures: Vec::new(),
            results: results.clone(),
        }));
        results.into_iter().map(Operand::Register).collect()
    }

    fn repeat(&mut self, values: &mut Values<'p>, node: crate::program::Loop) -> Vec<Operand> {
        let function = values.function;
        let initial: Vec<Operand> =
            function.list(node.initial).iter().flat_map(|v| self.value(values, *v)).collect();
        let state: Vec<Operand> =
            initial.into_iter().map(|a| self.write(|out| Instruction::Copy { out, a })).collect();
        let index = self.register();
        values.arguments.insert(node.until, state.clone());
        let mut with_index = vec![Operand::Register(index)];
        with_index.extend(&state);
        values.arguments.insert(node.next, with_index);

        let mut stop = Operand::Scalar(0);
        let until = self.block(|this| stop = this.region(values, node.until)[0]);
        let state_registers: Vec<Register> = self.registers(&state);
        let next = self.block(|this| {
            let yielded = this.region(values, node.next);
            this.move_state(&state_registers, yielded);
        });
        self.step(Step::Loop(Loop {
            count: node.count,
            index,
            until,
            stop,
            next,
            captures: Vec::new(),
            state: state_registers,
        }));
        state
    }

    /// Writes all of `yielded` to the state at once: what is itself a part of the state goes through a copy.
    fn move_state(&mut self, state: &[Register], mut yielded: Vec<Operand>) {
        for (register, a) in state.iter().zip(&mut yielded) {
            let moved = matches!(a, Operand::Register(r) if r != register && state.contains(r));
            if moved {
                *a = self.write(|out| Instruction::Copy { out, a: *a });
            }
        }
        for (out, a) in state.iter().zip(yielded) {
            if a != Operand::Register(*out) {
                self.push(Instruction::Copy { out: *out, a });
            }
        }
    }

    /// A new block with what `write` writes.
    fn block(&mut self, write: impl FnOnce(&mut Self)) -> BlockId {
        self.flush();
        let outer = self.current;
        self.body.blocks.push(Block::default());
        self.current = self.body.blocks.len() - 1;
        write(self);
        self.flush();
        std::mem::replace(&mut self.current, outer)
    }

    // ---- code

    fn register(&mut self) -> Register {
        self.next_register += 1;
        self.next_register - 1
    }

    /// The same numbers, all in registers.
    fn registers(&mut self, operands: &[Operand]) -> Vec<Register> {
        let mut registers = Vec::with_capacity(operands.len());
        for operand in operands {
            registers.push(match *operand {
                Operand::Register(r) => r,
                Operand::Scalar(_) => {
                    let out = self.register();
                    self.push(Instruction::Copy { out, a: *operand });
                    out
                }
            });
        }
        registers
    }

    fn write(&mut self, instruction: impl FnOnce(Register) -> Instruction) -> Operand {
        let out = self.register();
        self.push(instruction(out));
        Operand::Register(out)
    }

    fn push(&mut self, instruction: Instruction) {
        self.body.code.push(instruction);
    }

    fn step(&mut self, step: Step) {
        self.flush();
        self.body.blocks[self.current].steps.push(step);
    }

    /// Makes a step of the straight code since the last one.
    fn flush(&mut self) {
        let end = self.body.code.len();
        if self.straight < end {
            self.body.blocks[self.current].steps.push(Step::Run { start: self.straight, end });
        }
        self.straight = end;
    }
}

/// Component `i`, with a float standing for a vector of equal components.
fn component(scalars: &[Operand], i: usize) -> Operand {
    scalars[if scalars.len() == 1 { 0 } else { i }]
}
