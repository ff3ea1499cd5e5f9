//! Which derivatives of which values may differ from zero: what a loop has to carry, before its body is seen.

use crate::copy::live;
use crate::program::{Binary, Function, Loop, Node, RegionId, Unary, Value};
use rustc_hash::FxHashMap;

/// For each component of a value or of a tuple's parts and each active parameter, whether the derivative may
/// differ from zero. Components move alike.
pub(super) struct Activity {
    tuples: FxHashMap<Value, Vec<Vec<bool>>>,
}

impl Activity {
    /// The activity of a function by these of its parameters.
    pub(super) fn new(function: &Function, active: &[usize]) -> Activity {
        if function.region_count() == 1 {
            return Activity { tuples: FxHashMap::default() };
        }
        let mut search = Search {
            function,
            active,
            live: live(function),
            moves: FxHashMap::default(),
            arguments: FxHashMap::default(),
        };
        search.region(RegionId::ROOT);
        let mut tuples = FxHashMap::default();
        for (value, parts) in search.moves {
            if matches!(function.node(value), Node::If(..) | Node::Loop(_)) {
                let types = function.types_of(value);
                let by_component =
                    parts.iter().zip(types).flat_map(|(part, ty)| vec![part.clone(); ty.size()]);
                tuples.insert(value, by_component.collect());
            }
        }
        Activity { tuples }
    }

    /// That of a branch or loop, by component of its results.
    pub(super) fn of_tuple(&self, value: Value) -> &[Vec<bool>] {
        &self.tuples[&value]
    }
}

struct Search<'a> {
    function: &'a Function,
    active: &'a [usize],
    live: Vec<bool>,
    /// By part of each node.
    moves: FxHashMap<Value, Vec<Vec<bool>>>,
    /// By argument of each region that is open.
    arguments: FxHashMap<RegionId, Vec<Vec<bool>>>,
}

impl Search<'_> {
    fn region(&mut self, region: RegionId) -> Vec<Vec<bool>> {
        let function = self.function;
        let region = function.region(region);
        for value in region.body.iter().filter(|v| self.live[v.0 as usize]).copied().collect::<Vec<_>>() {
            let moves = self.node(value);
            self.moves.insert(value, moves);
        }
        region.results.iter().map(|result| self.of(*result)).collect()
    }

    fn node(&mut self, value: Value) -> Vec<Vec<bool>> {
        let function = self.function;
        match function.node(value) {
            Node::If(_, then, otherwise) => {
                let (then, otherwise) = (self.region(then), self.region(otherwise));
                then.into_iter().zip(otherwise).map(|(a, b)| either(a, &b)).collect()
            }
            Node::Loop(it) => self.repeat(it),
            Node::Result(tuple, index) => vec![self.moves[&tuple][index as usize].clone()],
            // What a comparison yields, and what only jumps, is flat.
            Node::Unary(
                Unary::Not
                | Unary::Sign
                | Unary::Floor
                | Unary::Ceil
                | Unary::Round
                | Unary::Trunc
                | Unary::Hash,
                _,
            )
            | Node::Unary(Unary::PowerOfTwo | Unary::Exponent, _)
            | Node::Binary(Binary::Less | Binary::LessEqual | Binary::Equal | Binary::And | Binary::Or, ..) =>
            {
                vec![self.flat()]
            }
            _ => {
                let mut moves = self.flat();
                function
                    .operands(value, |operand| moves = either(std::mem::take(&mut moves), &self.of(operand)));
                vec![moves; function.types_of(value).len()]
            }
        }
    }

    /// What moves in the state after any number of rounds: grows until it stays.
    fn repeat(&mut self, it: Loop) -> Vec<Vec<bool>> {
        let function = self.function;
        let mut state: Vec<Vec<bool>> = function.list(it.initial).iter().map(|v| self.of(*v)).collect();
        loop {
            let mut arguments = vec![self.flat()];
            arguments.extend(state.iter().cloned());
            self.arguments.insert(it.next, arguments);
            let next = self.region(it.next);
            let grown: Vec<Vec<bool>> = state.iter().zip(&next).map(|(a, b)| either(a.clone(), b)).collect();
            if grown == state {
                return state;
            }
            state = grown;
        }
    }

    fn of(&self, value: Value) -> Vec<bool> {
        match self.function.node(value) {
            Node::Float(_) | Node::Bool(_) | Node::Uniform(_) | Node::Global(_) => self.flat(),
            Node::Argument(RegionId::ROOT, index) => {
                self.active.iter().map(|parameter| *parameter == index as usize).collect()
            }
            Node::Argument(region, index) => self.arguments[&region][index as usize].clone(),
            _ => self.moves[&value][0].clone(),
        }
    }

    fn flat(&self) -> Vec<bool> {
        vec![false; self.active.len()]
    }
}

fn either(mut a: Vec<bool>, b: &[bool]) -> Vec<bool> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a |= *b);
    a
}
