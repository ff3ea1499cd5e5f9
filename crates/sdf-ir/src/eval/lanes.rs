//! The machine that runs a tape on blocks of points.
//!
//! Where lanes part, those of each side are gathered into a frame of their own above the present one, with the
//! same registers, and the results are scattered back; where they agree, nothing moves.

use super::kernel::{self, LANES, Lanes};
use super::tape::{BlockId, Body, Call, If, Loop, Operand, Register, Step, Tape};
use crate::constant::Constant;
use crate::number::Number;
use crate::program::FunctionId;
use rayon::prelude::*;

/// What a machine has done so far.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Counts {
    /// For each function of the program, how many points ran it; the entry apart, and only where the tape was
    /// made by [`Tape::compile_counting`].
    pub calls: Vec<u64>,
    /// How many rounds of loops points ran.
    pub rounds: u64,
    /// How often points evaluated fields, as [`cost`](crate::cost) counts them; only where the tape was made by
    /// [`Tape::compile_counting`].
    pub evaluations: u64,
}

impl Counts {
    /// How many points ran a function.
    pub fn calls_of(&self, function: FunctionId) -> u64 {
        self.calls[function.0 as usize]
    }

    /// Adds those of another machine.
    pub fn add(&mut self, other: &Counts) {
        self.calls.resize(self.calls.len().max(other.calls.len()), 0);
        for (sum, calls) in self.calls.iter_mut().zip(&other.calls) {
            *sum += calls;
        }
        self.rounds += other.rounds;
        self.evaluations += other.evaluations;
    }
}

/// Runs a tape in one number system.
pub struct Machine<'t, N> {
    tape: &'t Tape,
    /// The components of the uniforms, those of the globals, the constants.
    scalars: Vec<N>,
    registers: Vec<Lanes<N>>,
    counts: Counts,
    /// How many of the bodies that are running are evaluations.
    evaluating: u32,
    avx2: bool,
}

/// Some lanes of a block, by their place in it.
struct Indices {
    lanes: [u16; LANES],
    count: usize,
}

impl Indices {
    /// Those of the first `count` lanes for which `keep` holds.
    fn which(count: usize, keep: impl Fn(usize) -> bool) -> Indices {
        let mut indices = Indices { lanes: [0; LANES], count: 0 };
        for lane in 0..count {
            indices.lanes[indices.count] = lane as u16;
            indices.count += usize::from(keep(lane));
        }
        indices
    }

    fn iter(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.lanes[..self.count].iter().map(|i| usize::from(*i)).enumerate()
    }
}

impl<'t, N: Number> Machine<'t, N> {
    /// A machine whose uniforms have their defaults.
    pub fn new(tape: &'t Tape) -> Machine<'t, N> {
        let zero = N::from_f64(0.0);
        let mut scalars = vec![zero; tape.constants_start];
        scalars.extend(tape.constants.iter().map(|x| N::from_f64(*x)));
        let depth = tape.bodies.iter().map(|b| b.depth).max().unwrap_or(0);
        let mut machine = Machine {
            tape,
            scalars,
            registers: vec![[zero; LANES]; depth],
            counts: Counts { calls: vec![0; tape.functions], ..Counts::default() },
            evaluating: 0,
            avx2: kernel::has_avx2(),
        };
        let defaults: Vec<Constant> = tape.uniforms.iter().map(|u| u.default).collect();
        machine.set_uniforms(&defaults);
        machine
    }

    /// Sets all uniforms, in the program's order, and computes the values of the frame from them.
    pub fn set_uniforms(&mut self, values: &[Constant]) {
        assert_eq!(values.len(), self.tape.uniforms.len(), "every uniform has a value");
        let mut next = 0;
        for (value, uniform) in values.iter().zip(&self.tape.uniforms) {
            assert_eq!(value.ty(), uniform.ty, "the type of `{}`", uniform.name);
            match value {
                Constant::Bool(b) => self.scalars[next] = N::from_bool(*b),
                _ => {
                    for (scalar, x) in self.scalars[next..].iter_mut().zip(value.components()) {
                        *scalar = N::from_f64(*x);
                    }
                }
            }
            next += uniform.ty.size();
        }
        if let Some(frame) = self.tape.frame {
            let body = &self.tape.bodies[frame];
            self.block(body, body.root, 0, 1);
            for (i, output) in body.outputs.iter().enumerate() {
                self.scalars[self.tape.globals + i] = match *output {
                    Operand::Register(r) => self.registers[r as usize][0],
                    Operand::Scalar(s) => self.scalars[s as usize],
                };
            }
        }
    }

    /// Allows or forbids the vector instructions of newer machines. The results are the same.
    pub fn allow_avx2(&mut self, allow: bool) {
        self.avx2 = allow && kernel::has_avx2();
    }

    /// What has been done so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Runs the function for as many points as the slices are long. There is a slice for each scalar component of
    /// the parameters and of the results; a truth value is 0 or 1.
    pub fn run(&mut self, inputs: &[&[N]], outputs: &mut [&mut [N]]) {
        assert_eq!(inputs.len(), self.tape.input_count(), "a slice for each input");
        assert_eq!(outputs.len(), self.tape.output_count(), "a slice for each output");
        let points = inputs.first().map(|i| i.len()).or(outputs.first().map(|o| o.len())).unwrap_or(0);
        assert!(inputs.iter().all(|i| i.len() == points) && outputs.iter().all(|o| o.len() == points));
        let body = &self.tape.bodies[self.tape.entry];
        for start in (0..points).step_by(LANES) {
            let count = LANES.min(points - start);
            for (register, input) in self.registers.iter_mut().zip(inputs) {
                register[..count].copy_from_slice(&input[start..start + count]);
            }
            self.block(body, body.root, 0, count);
            for (output, operand) in outputs.iter_mut().zip(&body.outputs) {
                let output = &mut output[start..start + count];
                match *operand {
                    Operand::Register(r) => output.copy_from_slice(&self.registers[r as usize][..count]),
                    Operand::Scalar(s) => output.fill(self.scalars[s as usize]),
                }
            }
        }
    }

    /// Runs the function for one point.
    pub fn run_one(&mut self, inputs: &[N]) -> Vec<N> {
        let mut outputs = vec![N::from_f64(0.0); self.tape.output_count()];
        let inputs: Vec<&[N]> = inputs.iter().map(std::slice::from_ref).collect();
        self.run(&inputs, &mut outputs.iter_mut().map(std::slice::from_mut).collect::<Vec<_>>());
        outputs
    }

    /// Runs a block for the first `count` lanes of the frame that begins at register `base`.
    fn block(&mut self, body: &'t Body, block: BlockId, base: usize, count: usize) {
        for step in &body.blocks[block].steps {
            match step {
                Step::Run { start, end } => {
                    let frame = &mut self.registers[base..base + body.registers];
                    kernel::run(self.avx2, &body.code[*start..*end], frame, &self.scalars, count);
                }
                Step::If(branch) => self.branch(body, branch, base, count),
                Step::Loop(repeat) => self.repeat(body, repeat, base, count),
                Step::Call(call) => self.call(body, call, base, count),
                Step::Count { function, is_evaluation } => self.count(*function, *is_evaluation, count),
            }
        }
    }

    fn count(&mut self, function: FunctionId, is_evaluation: bool, count: usize) {
        self.counts.calls[function.0 as usize] += count as u64;
        if is_evaluation && self.evaluating == 0 {
            self.counts.evaluations += count as u64;
        }
    }

    fn call(&mut self, body: &Body, call: &Call, base: usize, count: usize) {
        let callee = &self.tape.bodies[call.body];
        if self.tape.counting {
            self.count(callee.function, callee.is_evaluation, count);
        }
        let above = base + body.registers;
        for (i, argument) in call.arguments.iter().enumerate() {
            self.copy(base, *argument, above + i, count);
        }
        self.evaluating += u32::from(callee.is_evaluation);
        self.block(callee, callee.root, above, count);
        self.evaluating -= u32::from(callee.is_evaluation);
        for (result, output) in call.results.iter().zip(&callee.outputs) {
            self.copy(above, *output, base + *result as usize, count);
        }
    }

    /// Copies an operand of the frame at `base` to a register, by its place among all.
    fn copy(&mut self, base: usize, from: Operand, to: usize, count: usize) {
        match from {
            Operand::Register(r) => {
                let [from, to] =
                    self.registers.get_disjoint_mut([base + r as usize, to]).expect("frames do not overlap");
                to[..count].copy_from_slice(&from[..count]);
            }
            Operand::Scalar(s) => self.registers[to][..count].fill(self.scalars[s as usize]),
        }
    }

    fn branch(&mut self, body: &'t Body, branch: &'t If, base: usize, count: usize) {
        let register = match branch.condition {
            Operand::Register(r) => base + r as usize,
            Operand::Scalar(s) => {
                let side = if is_true(self.scalars[s as usize]) { branch.then } else { branch.otherwise };
                return self.block(body, side, base, count);
            }
        };
        let condition = &self.registers[register];
        let then = Indices::which(count, |lane| is_true(condition[lane]));
        if then.count == count {
            return self.block(body, branch.then, base, count);
        }
        if then.count == 0 {
            return self.block(body, branch.otherwise, base, count);
        }
        let otherwise = Indices::which(count, |lane| !is_true(condition[lane]));
        let above = base + body.registers;
        let sides = [
            (branch.then, &branch.then_captures, then),
            (branch.otherwise, &branch.otherwise_captures, otherwise),
        ];
        for (side, captures, lanes) in sides {
            for register in captures {
                self.gather(base, above, *register, &lanes);
            }
            self.block(body, side, above, lanes.count);
            for register in &branch.results {
                self.scatter(above, base, *register, lanes.iter());
            }
        }
    }

    /// Lanes stay in place as long as all go on; the first that stop keep their state there, and the others move
    /// to a frame above, from which the state of each is written back when it stops. Lanes that have stopped up
    /// there run on without effect until there are enough of them to be worth moving the others together; where what
    /// runs is counted, the others are moved at once.
    fn repeat(&mut self, body: &'t Body, repeat: &'t Loop, base: usize, count: usize) {
        let above = base + body.registers;
        let mut origin = Indices::which(count, |_| true);
        let mut stopped = [false; LANES];
        let mut running = count;
        let mut at = base;
        for round in 0..repeat.count {
            self.block(body, repeat.until, at, origin.count);
            let mut stop_now = [false; LANES];
            for (lane, stop) in stop_now[..origin.count].iter_mut().enumerate() {
                *stop = !stopped[lane] && self.is_true_at(at, repeat.stop, lane);
            }
            let stopping = stop_now.iter().filter(|s| **s).count();
            if stopping > 0 {
                running -= stopping;
                if at == above {
                    for register in &repeat.state {
                        self.scatter(
                            above,
                            base,
                            *register,
                            origin.iter().filter(|(lane, _)| stop_now[*lane]),
                        );
                    }
                }
                if running == 0 {
                    return;
                }
                stopped.iter_mut().zip(stop_now).for_each(|(stopped, now)| *stopped |= now);
                if at == base || self.tape.counting || running * 4 <= origin.count * 3 {
                    let kept = Indices::which(origin.count, |lane| !stopped[lane]);
                    for register in repeat.captures.iter().chain(&repeat.state) {
                        self.gather(at, above, *register, &kept);
                    }
                    for (lane, from) in kept.iter() {
                        origin.lanes[lane] = origin.lanes[from];
                    }
                    origin.count = kept.count;
                    stopped = [false; LANES];
                    at = above;
                }
            }
            self.counts.rounds += running as u64;
            self.registers[at + repeat.index as usize].fill(N::from_f64(f64::from(round)));
            self.block(body, repeat.next, at, origin.count);
        }
        if at == above {
            for register in &repeat.state {
                self.scatter(above, base, *register, origin.iter().filter(|(lane, _)| !stopped[*lane]));
            }
        }
    }

    fn is_true_at(&self, base: usize, operand: Operand, lane: usize) -> bool {
        is_true(match operand {
            Operand::Register(r) => self.registers[base + r as usize][lane],
            Operand::Scalar(s) => self.scalars[s as usize],
        })
    }

    /// Moves some lanes of a register of the frame `from` together, into the same register of the frame `to`.
    fn gather(&mut self, from: usize, to: usize, register: Register, lanes: &Indices) {
        let (from, to) = (from + register as usize, to + register as usize);
        if from == to {
            let lanes_of = &mut self.registers[to];
            lanes.iter().for_each(|(lane, source)| lanes_of[lane] = lanes_of[source]);
        } else {
            let (below, above) = self.registers.split_at_mut(to);
            let (source_lanes, target) = (&below[from], &mut above[0]);
            lanes.iter().for_each(|(lane, source)| target[lane] = source_lanes[source]);
        }
    }

    /// The way back: lane by lane, from the frame `above` to the places that the lanes have below.
    fn scatter(
        &mut self,
        above: usize,
        base: usize,
        register: Register,
        lanes: impl Iterator<Item = (usize, usize)>,
    ) {
        let (below, up) = self.registers.split_at_mut(above);
        let (source, target) = (&up[register as usize], &mut below[base + register as usize]);
        lanes.for_each(|(lane, place)| target[place] = source[lane]);
    }
}

fn is_true<N: Number>(a: N) -> bool {
    !N::equal(a, N::from_f64(0.0))
}

/// [`Machine::run`] on all cores, with these uniforms.
pub fn run_parallel<N: Number>(
    tape: &Tape,
    uniforms: &[Constant],
    inputs: &[&[N]],
    outputs: &mut [&mut [N]],
) -> Counts {
    /// Enough blocks that making a machine does not matter.
    const CHUNK: usize = 64 * LANES;
    let mut chunks: Vec<Vec<&mut [N]>> = Vec::new();
    for output in outputs {
        for (i, part) in output.chunks_mut(CHUNK).enumerate() {
            if i == chunks.len() {
                chunks.push(Vec::new());
            }
            chunks[i].push(part);
        }
    }
    let run = |(i, mut outputs): (usize, Vec<&mut [N]>)| {
        let mut machine = Machine::new(tape);
        machine.set_uniforms(uniforms);
        let end = |input: &&[N]| input.len().min((i + 1) * CHUNK);
        let inputs: Vec<&[N]> = inputs.iter().map(|input| &input[i * CHUNK..end(input)]).collect();
        machine.run(&inputs, &mut outputs);
        machine.counts
    };
    let sum = |mut a: Counts, b: Counts| {
        a.add(&b);
        a
    };
    chunks.into_par_iter().enumerate().map(run).reduce(Counts::default, sum)
}
