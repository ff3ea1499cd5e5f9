//! Virtual registers to few: a linear scan over the life of each.
//!
//! Every instruction and step has a position, in the order of the text. A register lives from its first position
//! to its last, and, when it is used in a loop that began after its first, to the end of that loop. Two that live
//! at one position are different, so that no instruction writes what it reads.

use super::tape::{Block, BlockId, Body, Operand, Register, Step};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// Packs the registers of a body, and fills in what it needs in all and what its nested blocks capture.
/// `callees` are the bodies that it may call.
pub(crate) fn allocate(body: &mut Body, callees: &[Body]) {
    let lives = lives(body);
    let packed = pack(body.inputs, &lives);
    body.registers = packed.iter().map(|r| *r as usize + 1).max().unwrap_or(0).max(body.inputs);
    rename(body, &packed);
    body.depth = body.registers + depth(body, body.root, callees);
}

/// The first and the last position of a register.
#[derive(Debug, Clone, Copy)]
struct Life {
    first: usize,
    last: usize,
}

struct Walk {
    position: usize,
    lives: Vec<Option<Life>>,
    /// The positions at which the loops round the present one begin.
    loops: Vec<usize>,
    /// For each open loop, the registers from before it that are used in it.
    held: Vec<Vec<Register>>,
    /// For each open block, the registers used in it and where it begins.
    used: Vec<(usize, BTreeSet<Register>)>,
}

fn lives(body: &mut Body) -> Vec<Option<Life>> {
    let mut walk =
        Walk { position: 0, lives: Vec::new(), loops: Vec::new(), held: Vec::new(), used: Vec::new() };
    for input in 0..body.inputs as u32 {
        walk.touch(input);
    }
    let mut blocks = std::mem::take(&mut body.blocks);
    walk.block(body, &mut blocks, body.root);
    body.blocks = blocks;
    walk.position += 1;
    for output in &body.outputs {
        walk.read(*output);
    }
    walk.lives
}

impl Walk {
    /// Notes that a register is written or read here.
    fn touch(&mut self, register: Register) {
        let index = register as usize;
        if index >= self.lives.len() {
            self.lives.resize(index + 1, None);
        }
        let life = self.lives[index].get_or_insert(Life { first: self.position, last: self.position });
        life.last = self.position;
        for (start, held) in self.loops.iter().zip(&mut self.held) {
            if life.first < *start {
                held.push(register);
                break;
            }
        }
    }

    fn read(&mut self, operand: Operand) {
        if let Operand::Register(register) = operand {
            self.read_register(register);
        }
    }

    fn read_register(&mut self, register: Register) {
        self.touch(register);
        for (_, used) in &mut self.used {
            used.insert(register);
        }
    }

    fn block(&mut self, body: &mut Body, blocks: &mut [Block], id: BlockId) {
        let mut steps = std::mem::take(&mut blocks[id].steps);
        for step in &mut steps {
            self.step(body, blocks, step);
        }
        blocks[id].steps = steps;
    }

    fn step(&mut self, body: &mut Body, blocks: &mut [Block], step: &mut Step) {
        self.position += 1;
        match step {
            Step::Run { start, end } => {
                for i in *start..*end {
                    self.position += 1;
                    body.code[i].reads(|r| self.read_register(*r));
                    body.code[i].writes().iter().for_each(|r| self.touch(*r));
                }
            }
            Step::Count { .. } => {}
            Step::Call(call) => {
                call.arguments.iter().for_each(|a| self.read(*a));
                call.results.iter().for_each(|r| self.touch(*r));
            }
            Step::If(branch) => {
                self.read(branch.condition);
                branch.then_captures = self.nested(|walk| walk.block(body, blocks, branch.then));
                branch.otherwise_captures = self.nested(|walk| walk.block(body, blocks, branch.otherwise));
                branch.results.iter().for_each(|r| self.touch(*r));
            }
            Step::Loop(repeat) => {
                self.loops.push(self.position);
                self.held.push(Vec::new());
                let captures = self.nested(|walk| {
                    walk.touch(repeat.index);
                    repeat.state.iter().for_each(|r| walk.touch(*r));
                    walk.block(body, blocks, repeat.until);
                    walk.position += 1;
                    walk.read(repeat.stop);
                    walk.block(body, blocks, repeat.next);
                    walk.position += 1;
                    walk.touch(repeat.index);
                });
                self.loops.pop();
                for register in self.held.pop().expect("the loop's own") {
                    self.touch(register);
                }
                repeat.captures = captures.into_iter().filter(|r| !repeat.state.contains(r)).collect();
            }
        }
    }

    /// What is read in there and was written before.
    fn nested(&mut self, walk: impl FnOnce(&mut Walk)) -> Vec<Register> {
        self.position += 1;
        self.used.push((self.position, BTreeSet::new()));
        walk(self);
        let (start, used) = self.used.pop().expect("this block's own");
        let before = |r: &Register| self.lives[*r as usize].is_some_and(|life| life.first < start);
        used.into_iter().filter(before).collect()
    }
}

/// The new name of each register. Arguments keep theirs.
fn pack(inputs: usize, lives: &[Option<Life>]) -> Vec<Register> {
    let mut order: Vec<(Life, usize)> =
        lives.iter().enumerate().filter_map(|(i, life)| Some(((*life)?, i))).collect();
    order.sort_by_key(|(life, i)| (life.first, *i));
    let mut packed = vec![0; lives.len()];
    let mut free: Vec<Register> = Vec::new();
    let mut ends: BinaryHeap<Reverse<(usize, Register)>> = BinaryHeap::new();
    let mut next = inputs as Register;
    for (life, register) in order {
        while let Some(Reverse((end, freed))) = ends.peek().copied() {
            if end >= life.first {
                break;
            }
            ends.pop();
            free.push(freed);
        }
        packed[register] = if register < inputs {
            register as Register
        } else {
            free.pop().unwrap_or_else(|| {
                next += 1;
                next - 1
            })
        };
        ends.push(Reverse((life.last, packed[register])));
    }
    packed
}

fn rename(body: &mut Body, packed: &[Register]) {
    let new = |r: &mut Register| *r = packed[*r as usize];
    let operand = |o: &mut Operand| {
        if let Operand::Register(r) = o {
            new(r);
        }
    };
    for instruction in &mut body.code {
        instruction.reads(new);
        instruction.writes().iter_mut().for_each(new);
    }
    body.outputs.iter_mut().for_each(operand);
    for step in body.blocks.iter_mut().flat_map(|b| &mut b.steps) {
        match step {
            Step::Run { .. } | Step::Count { .. } => {}
            Step::Call(call) => {
                call.arguments.iter_mut().for_each(operand);
                call.results.iter_mut().for_each(new);
            }
            Step::If(branch) => {
                operand(&mut branch.condition);
                branch.then_captures.iter_mut().for_each(new);
                branch.otherwise_captures.iter_mut().for_each(new);
                branch.results.iter_mut().for_each(new);
            }
            Step::Loop(repeat) => {
                new(&mut repeat.index);
                operand(&mut repeat.stop);
                repeat.captures.iter_mut().for_each(new);
                repeat.state.iter_mut().for_each(new);
            }
        }
    }
}

/// How many registers a block needs beyond those of its body.
fn depth(body: &Body, block: BlockId, callees: &[Body]) -> usize {
    let nested = |block: BlockId| body.registers + depth(body, block, callees);
    let step = |step: &Step| match step {
        Step::Run { .. } | Step::Count { .. } => 0,
        Step::If(branch) => nested(branch.then).max(nested(branch.otherwise)),
        Step::Loop(repeat) => nested(repeat.until).max(nested(repeat.next)),
        Step::Call(call) => callees[call.body].depth,
    };
    body.blocks[block].steps.iter().map(step).max().unwrap_or(0)
}
