//! What of a function counts in a region: where one side of a minimum is certainly the lesser one, nothing of the other
//! side need be evaluated there, nor in any part of the region (Matthew Keeter, "Massively Parallel Rendering of
//! Complex Closed-Form Implicit Surfaces", 2020).
//!
//! Of a field whose sign alone is asked for still more can go: a side of the outermost minima that is certainly positive
//! makes no zero and no negative number, however small it is beside the others.

use super::domain::Domain;
use super::plan::Plan;
use super::walk::Frame;
use crate::program::{Binary, Function, Node, RegionId, Ternary, Type, Unary, Value};

/// The nodes of a function's body to evaluate in a region.
#[derive(Debug, Clone, PartialEq)]
pub struct Shortened {
    steps: Vec<Step>,
}

/// How a node gets its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// By its operation.
    Evaluate(Value),
    /// It is that of another node.
    Copy { to: Value, from: Value },
}

/// A shortened function with fewer than this share of the steps is worth keeping.
const WORTH: f64 = 0.9;

impl Shortened {
    pub(super) fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// How many nodes are evaluated.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether nothing is.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }
}

/// What each node of a function's body reads, and for which nodes only the sign counts.
pub(super) struct Reads {
    /// Where in `list` what a node reads begins; one more than there are nodes.
    starts: Vec<u32>,
    list: Vec<Value>,
    is_sign: Vec<bool>,
    body: Vec<Step>,
}

impl Reads {
    pub fn new(function: &Function, plan: &Plan) -> Reads {
        let body = plan.body(RegionId::ROOT);
        let mut by_node = vec![Vec::new(); function.node_count()];
        for value in body {
            add_reads(function, plan, *value, &mut by_node[value.0 as usize]);
        }
        let mut readers = vec![0u32; function.node_count()];
        for value in by_node.iter().flatten().chain(&function.root().results) {
            readers[value.0 as usize] += 1;
        }
        let mut starts = vec![0];
        for reads in &by_node {
            starts.push(starts[starts.len() - 1] + reads.len() as u32);
        }
        Reads {
            is_sign: signs(function, &readers),
            list: by_node.concat(),
            starts,
            body: body.iter().map(|value| Step::Evaluate(*value)).collect(),
        }
    }

    fn of(&self, value: Value) -> &[Value] {
        &self.list[self.starts[value.0 as usize] as usize..self.starts[value.0 as usize + 1] as usize]
    }

    /// What counts in the region that the values of a frame are of, if that is much less than what counted `before` in a
    /// region round it. The sign of the result is the function's in all the region; its value is so only where no zero
    /// parts them.
    pub fn shorten<D: Domain>(
        &self,
        function: &Function,
        frame: &Frame<D>,
        before: Option<&Shortened>,
    ) -> Option<Shortened> {
        let before = before.map_or(&self.body[..], |shortened| &shortened.steps);
        let mut is_live = vec![false; function.node_count()];
        function.root().results.iter().for_each(|value| is_live[value.0 as usize] = true);
        let mut steps = Vec::with_capacity(before.len());
        for step in before.iter().rev() {
            let (Step::Evaluate(value) | Step::Copy { to: value, .. }) = *step;
            if !is_live[value.0 as usize] {
                continue;
            }
            let step = match *step {
                Step::Evaluate(_) => match self.chosen(function, frame, value) {
                    Some(from) => Step::Copy { to: value, from },
                    None => *step,
                },
                copy => copy,
            };
            match step {
                Step::Evaluate(value) => {
                    self.of(value).iter().for_each(|read| is_live[read.0 as usize] = true);
                }
                Step::Copy { from, .. } => is_live[from.0 as usize] = true,
            }
            steps.push(step);
        }
        steps.reverse();
        ((steps.len() as f64) < WORTH * before.len() as f64).then_some(Shortened { steps })
    }

    /// The operand that stands for a node.
    fn chosen<D: Domain>(&self, function: &Function, frame: &Frame<D>, value: Value) -> Option<Value> {
        let at = |v: Value| frame.values[v.0 as usize].bounds();
        let (a, b, is_min) = match function.node(value) {
            Node::Binary(Binary::Min, a, b) => (a, b, true),
            Node::Binary(Binary::Max, a, b) => (a, b, false),
            Node::Ternary(Ternary::Select, condition, a, b) => {
                return at(condition).decided().map(|is_true| if is_true { a } else { b });
            }
            _ => return None,
        };
        if function.type_of(value) != Some(Type::Float) {
            return None;
        }
        let (x, y) = if is_min { (at(a).number(), at(b).number()) } else { (at(b).number(), at(a).number()) };
        let is_sign = self.is_sign[value.0 as usize];
        // A positive side of a minimum, a negative one of a maximum.
        let is_needless =
            |v: Value| is_sign && if is_min { at(v).number().lo > 0.0 } else { at(v).number().hi < 0.0 };
        if x.hi <= y.lo || is_needless(b) {
            Some(a)
        } else if y.hi <= x.lo || is_needless(a) {
            Some(b)
        } else {
            None
        }
    }
}

/// All that the evaluation of a node reads: its operands, what lies beside it, and what the regions that it owns read.
fn add_reads(function: &Function, plan: &Plan, value: Value, reads: &mut Vec<Value>) {
    function.operands(value, |operand| reads.push(operand));
    match function.node(value) {
        // The walk takes this for a length, of what the dot product is of.
        Node::Unary(Unary::Sqrt, a) => {
            if let Node::Binary(Binary::Dot, x, _) = function.node(a) {
                reads.push(x);
            }
        }
        // What lies along the axis of a rotation stays.
        Node::Binary(Binary::Dot, a, _) => reads.extend(plan.rotation(a).map(|turn| turn.vector)),
        _ => {}
    }
    plan.add_beside(value, reads);
    for region in function.owned_regions(value) {
        for inner in plan.body(region) {
            add_reads(function, plan, *inner, reads);
        }
        reads.extend(&function.region(region).results);
    }
}

/// For which nodes of a function with one result only the sign counts: those that the result is the least or the
/// greatest of, and that nothing else reads.
fn signs(function: &Function, readers: &[u32]) -> Vec<bool> {
    let mut is_sign = vec![false; readers.len()];
    let [result] = function.root().results[..] else { return is_sign };
    let mut open = vec![result];
    while let Some(value) = open.pop() {
        if readers[value.0 as usize] != 1 {
            continue;
        }
        is_sign[value.0 as usize] = true;
        match function.node(value) {
            Node::Binary(Binary::Min | Binary::Max, a, b) => open.extend([a, b]),
            Node::Unary(Unary::Negate, a) => open.push(a),
            _ => {}
        }
    }
    is_sign
}
