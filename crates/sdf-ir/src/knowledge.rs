//! What is told of the values of a function of a point from their operations alone, node by node and through calls.

use crate::program::{Function, FunctionId, Node, Program, RegionId, Value};

/// What is known of values, and how operations hand it on.
pub(crate) trait Knowledge {
    /// What is known of a value.
    type Known: Copy;
    /// Nothing.
    const UNKNOWN: Self::Known;
    /// Of what does not depend on the point.
    const CONSTANT: Self::Known;

    /// What is known of the result of an operation on values, of each of which `at` is known.
    fn operation(&self, function: &Function, value: Value, at: &dyn Fn(Value) -> Self::Known) -> Self::Known;
}

/// A walk through a function and what it calls.
pub(crate) struct Search<'p, K> {
    program: &'p Program,
    knowledge: K,
    /// How many operations may still be looked at, calls expanded.
    left: usize,
}

impl<'p, K: Knowledge> Search<'p, K> {
    /// For functions that call those of a program, of at most so many operations.
    pub fn new(program: &'p Program, knowledge: K, most: usize) -> Search<'p, K> {
        Search { program, knowledge, left: most }
    }

    /// What is known of a function's results; nothing if there is too much to look at.
    pub fn function(&mut self, function: &Function, arguments: &[K::Known]) -> Option<Vec<K::Known>> {
        // Of a tuple there is one entry for each of its parts.
        let mut known: Vec<Vec<K::Known>> = Vec::with_capacity(function.node_count());
        for index in 0..function.node_count() {
            self.left = self.left.checked_sub(1)?;
            let parts = self.node(function, Value(index as u32), arguments, &known)?;
            known.push(parts);
        }
        Some(function.root().results.iter().map(|v| known[v.0 as usize][0]).collect())
    }

    fn node(
        &mut self,
        function: &Function,
        value: Value,
        arguments: &[K::Known],
        known: &[Vec<K::Known>],
    ) -> Option<Vec<K::Known>> {
        let at = |v: Value| known.get(v.0 as usize).map_or(K::UNKNOWN, |parts| parts[0]);
        Some(vec![match function.node(value) {
            Node::Float(_) | Node::Bool(_) | Node::Uniform(_) | Node::Global(_) => K::CONSTANT,
            Node::Argument(RegionId::ROOT, i) => arguments[usize::from(i)],
            Node::Call(id, list) => {
                let arguments: Vec<K::Known> = function.list(list).iter().map(|v| at(*v)).collect();
                return self.call(id, &arguments);
            }
            Node::Result(tuple, i) => {
                known[tuple.0 as usize].get(usize::from(i)).copied().unwrap_or(K::UNKNOWN)
            }
            // What happens in branches and loops is not looked at.
            Node::Argument(..) | Node::If(..) | Node::Loop(_) => K::UNKNOWN,
            _ => self.knowledge.operation(function, value, &at),
        }])
    }

    fn call(&mut self, id: FunctionId, arguments: &[K::Known]) -> Option<Vec<K::Known>> {
        let program = self.program;
        self.function(program.function(id), arguments)
    }
}
