//! A tape: a function made ready to run on blocks of points.
//!
//! Vectors are split into scalars, small callees are written into their callers, and every scalar that differs
//! from lane to lane has a register; those that do not (constants, uniforms, values of the frame) are operands
//! of their own kind. A truth value is the number 0 or 1. A [`Block`] is straight code between the nested blocks
//! of branches, loops and calls; nested blocks use the registers of the body that they stand in.

use crate::program::{Binary, FunctionId, Program, Type, Unary};

/// A number for each lane: an index into the registers of a body.
pub(crate) type Register = u32;

/// A block of a body.
pub(crate) type BlockId = usize;

/// Where an instruction takes a number from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Operand {
    /// One number for each lane.
    Register(Register),
    /// The same number for all lanes: an index into the scalars.
    Scalar(u32),
}

/// A step of straight code. The register that it writes is none of those that it reads.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Instruction {
    /// `out = a`
    Copy { out: Register, a: Operand },
    /// `out = op(a)`, component by component, or `Not`
    Unary { op: Unary, out: Register, a: Register },
    /// `out = op(a, b)`, component by component, comparisons and bools included
    Binary { op: Binary, out: Register, a: Operand, b: Operand },
    /// `out = if condition then a else b`
    Select { out: Register, condition: Register, a: Operand, b: Operand },
    /// `out = mix(a, b, t)`
    Mix { out: Register, a: Register, b: Operand, t: Operand },
    /// `out = dot(a, b)`
    Dot2 { out: Register, a: [Register; 2], b: [Register; 2] },
    /// `out = dot(a, b)`
    Dot3 { out: Register, a: [Register; 3], b: [Register; 3] },
    /// `out = length(a)`
    Length2 { out: Register, a: [Register; 2] },
    /// `out = length(a)`
    Length3 { out: Register, a: [Register; 3] },
    /// `out = normalize(a)`
    Normalize2 { out: [Register; 2], a: [Register; 2] },
    /// `out = normalize(a)`
    Normalize3 { out: [Register; 3], a: [Register; 3] },
    /// `out = hash(a)` of the first `size` registers
    Hash { out: Register, a: [Register; 3], size: usize },
    /// `out = reduce_angle(a)`
    ReduceAngle { out: [Register; 2], a: Register },
}

/// A part of a block.
#[derive(Debug, Clone)]
pub(crate) enum Step {
    /// These instructions of the body.
    Run { start: usize, end: usize },
    /// One of two blocks for each lane.
    If(If),
    /// A block, again and again.
    Loop(Loop),
    /// Another body.
    Call(Call),
    /// Counts the lanes of a function that was written into this one.
    Count {
        function: FunctionId,
        /// Whether it is an evaluation, and not inside of one that was written into this one too.
        is_evaluation: bool,
    },
}

/// A branch. Each block ends by writing `results`.
#[derive(Debug, Clone)]
pub(crate) struct If {
    pub condition: Operand,
    pub then: BlockId,
    pub otherwise: BlockId,
    /// What `then` reads that was written before.
    pub then_captures: Vec<Register>,
    /// What `otherwise` reads that was written before.
    pub otherwise_captures: Vec<Register>,
    pub results: Vec<Register>,
}

/// A loop. `state` is written before it; `next` ends by writing it anew.
#[derive(Debug, Clone)]
pub(crate) struct Loop {
    pub count: u32,
    /// Where the number of the round is expected.
    pub index: Register,
    pub until: BlockId,
    /// What `until` computes: whether to stop.
    pub stop: Operand,
    pub next: BlockId,
    /// What the blocks read that was written before, the state apart.
    pub captures: Vec<Register>,
    pub state: Vec<Register>,
}

/// A call of a body that was too large to be written into this one.
#[derive(Debug, Clone)]
pub(crate) struct Call {
    pub body: usize,
    pub arguments: Vec<Operand>,
    pub results: Vec<Register>,
}

/// Steps, in order.
#[derive(Debug, Clone, Default)]
pub(crate) struct Block {
    pub steps: Vec<Step>,
}

/// The code of a function.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub function: FunctionId,
    pub is_evaluation: bool,
    pub code: Vec<Instruction>,
    pub blocks: Vec<Block>,
    pub root: BlockId,
    /// The arguments are the first registers.
    pub inputs: usize,
    pub outputs: Vec<Operand>,
    /// How many registers it uses.
    pub registers: usize,
    /// How many it needs together with all that it may call or split off.
    pub depth: usize,
}

/// A function of a program, made ready to run on blocks of points.
#[derive(Debug, Clone)]
pub struct Tape {
    /// The bodies, callees first.
    pub(crate) bodies: Vec<Body>,
    pub(crate) entry: usize,
    /// The body that computes the globals.
    pub(crate) frame: Option<usize>,
    /// The types of the uniforms, and their values where nothing is said; their components are the first scalars.
    pub(crate) uniforms: Vec<crate::Uniform>,
    /// Where the components of the globals stand among the scalars.
    pub(crate) globals: usize,
    /// Where the constants stand among the scalars.
    pub(crate) constants_start: usize,
    pub(crate) constants: Vec<f64>,
    /// How many functions the program has.
    pub(crate) functions: usize,
    /// Whether it counts what runs, so that lanes that have nothing to do must not run on.
    pub(crate) counting: bool,
}

impl Tape {
    /// The tape of a function of a program.
    pub fn compile(program: &Program, function: FunctionId) -> Tape {
        crate::eval::lower::compile(program, function, false)
    }

    /// The tape of a function that also counts how many lanes run each function; see
    /// [`Machine::counts`](crate::eval::Machine::counts).
    pub fn compile_counting(program: &Program, function: FunctionId) -> Tape {
        crate::eval::lower::compile(program, function, true)
    }

    /// How many scalars the function takes: the components of its parameters.
    pub fn input_count(&self) -> usize {
        self.bodies[self.entry].inputs
    }

    /// How many scalars it yields: the components of its results.
    pub fn output_count(&self) -> usize {
        self.bodies[self.entry].outputs.len()
    }

    /// How many registers a block of points needs, callees and nested blocks included.
    pub fn register_count(&self) -> usize {
        self.bodies[self.entry].depth
    }

    /// How many instructions there are, each standing for one operation on one scalar or small vector.
    pub fn instruction_count(&self) -> usize {
        self.bodies.iter().map(|b| b.code.len()).sum()
    }
}

/// How many scalars these types have together.
pub(crate) fn scalar_count(types: impl IntoIterator<Item = Type>) -> usize {
    types.into_iter().map(Type::size).sum()
}

impl Instruction {
    /// Calls `visit` with each register that it reads.
    pub(crate) fn reads(&mut self, mut visit: impl FnMut(&mut Register)) {
        let operand = |operand: &mut Operand, visit: &mut dyn FnMut(&mut Register)| {
            if let Operand::Register(r) = operand {
                visit(r);
            }
        };
        match self {
            Instruction::Copy { a, .. } => operand(a, &mut visit),
            Instruction::Unary { a, .. } | Instruction::ReduceAngle { a, .. } => visit(a),
            Instruction::Binary { a, b, .. } => {
                operand(a, &mut visit);
                operand(b, &mut visit);
            }
            Instruction::Select { condition, a, b, .. } => {
                visit(condition);
                operand(a, &mut visit);
                operand(b, &mut visit);
            }
            Instruction::Mix { a, b, t, .. } => {
                visit(a);
                operand(b, &mut visit);
                operand(t, &mut visit);
            }
            Instruction::Dot2 { a, b, .. } => a.iter_mut().chain(b).for_each(visit),
            Instruction::Dot3 { a, b, .. } => a.iter_mut().chain(b).for_each(visit),
            Instruction::Length2 { a, .. } | Instruction::Normalize2 { a, .. } => {
                a.iter_mut().for_each(visit);
            }
            Instruction::Length3 { a, .. } | Instruction::Normalize3 { a, .. } => {
                a.iter_mut().for_each(visit);
            }
            Instruction::Hash { a, size, .. } => a[..*size].iter_mut().for_each(visit),
        }
    }

    /// The registers that it writes.
    pub(crate) fn writes(&mut self) -> &mut [Register] {
        match self {
            Instruction::Copy { out, .. }
            | Instruction::Unary { out, .. }
            | Instruction::Binary { out, .. }
            | Instruction::Select { out, .. }
            | Instruction::Mix { out, .. }
            | Instruction::Dot2 { out, .. }
            | Instruction::Dot3 { out, .. }
            | Instruction::Length2 { out, .. }
            | Instruction::Length3 { out, .. }
            | Instruction::Hash { out, .. } => std::slice::from_mut(out),
            Instruction::Normalize2 { out, .. } | Instruction::ReduceAngle { out, .. } => out,
            Instruction::Normalize3 { out, .. } => out,
        }
    }
}
