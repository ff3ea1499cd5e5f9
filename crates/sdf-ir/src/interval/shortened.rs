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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Builder;
    use crate::interval::{Bounds, Sloped, Walker};
    use crate::program::{Parameter, Program};
    use std::rc::Rc;

    fn ball(b: &mut Builder, p: Value, x: f64, r: f64) -> Value {
        let (center, r) = (b.constant(crate::Constant::Vec3([x, 0.0, 0.0])), b.float(r));
        let offset = b.sub(p, center);
        let length = b.unary(Unary::Length, offset);
        b.sub(length, r)
    }

    /// Two balls that are blended, the part of a third that is above y = 0, and the left one of two more.
    fn scene() -> Function {
        let parameters = vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }];
        let mut b = Builder::new("scene", parameters);
        let p = b.argument(RegionId::ROOT, 0);
        let (first, second) = (ball(&mut b, p, -4.0, 1.0), ball(&mut b, p, -2.0, 0.8));
        let (width, zero, quarter) = (b.float(0.5), b.float(0.0), b.float(0.5));
        let apart = b.sub(first, second);
        let apart = b.unary(Unary::Abs, apart);
        let near = b.sub(width, apart);
        let near = b.max(near, zero);
        let bulge = b.mul(near, near);
        let bulge = b.mul(bulge, quarter);
        let least = b.min(first, second);
        let blended = b.sub(least, bulge);
        let y = b.component(p, 1);
        let below = b.unary(Unary::Negate, y);
        let third = ball(&mut b, p, 1.0, 1.0);
        let above = b.max(third, below);
        let x = b.component(p, 0);
        let border = b.float(5.0);
        let is_left = b.binary(Binary::Less, x, border);
        let (left, right) = (ball(&mut b, p, 4.0, 0.7), ball(&mut b, p, 6.0, 0.7));
        let chosen = b.select(is_left, left, right);
        let rest = b.min(above, chosen);
        let all = b.min(blended, rest);
        b.finish(vec![(all, "distance".into())])
    }

    /// Numbers from -1 to 1, one after the other (Donald Knuth, MMIX).
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    #[test]
    fn what_is_left_has_the_sign_of_the_whole_in_the_region() {
        let (program, function) = (Program::default(), scene());
        let whole_length = Plan::new(&function).body(RegionId::ROOT).len();
        let mut walker = Walker::<Bounds>::new(&program, &function, &[], &[]);
        let mut slopes = Walker::<Sloped>::new(&program, &function, &[], &[]);
        let mut number = numbers();
        let (mut shortened_count, mut shortest) = (0, whole_length);
        for i in 0..400 {
            let middle = [number() * 7.0, number() * 1.5, number() * 1.5];
            let half = number().abs() * if i % 2 == 0 { 0.3 } else { 2.0 };
            let part = |share: f64, at: [f64; 3]| {
                let lo = std::array::from_fn(|i| middle[i] + half * (at[i] - share).max(-1.0));
                let hi = std::array::from_fn(|i| middle[i] + half * (at[i] + share).min(1.0));
                Bounds::between(lo, hi)
            };
            walker.run(&[part(1.0, [0.0; 3])]);
            let Some(shortened) = walker.shorten() else { continue };
            let shortened = Rc::new(shortened);
            shortened_count += 1;
            shortest = shortest.min(shortened.len());
            for _ in 0..20 {
                let at = [number(), number(), number()];
                let (point, piece) = (part(0.0, at), part(0.2, at));
                let whole = walker.run(&[point])[0].number();
                let steep = slopes.run(&[Sloped::point(piece)])[0].slopes.norm();
                walker.stay_within(Some(shortened.clone()));
                slopes.stay_within(Some(shortened.clone()));
                let short = walker.run(&[point])[0].number();
                let of_piece = walker.run(&[piece])[0].number();
                assert!((whole.lo > 0.0) == (short.lo > 0.0) && (whole.hi < 0.0) == (short.hi < 0.0));
                assert!(of_piece.lo <= short.lo && short.hi <= of_piece.hi);
                assert!(slopes.run(&[Sloped::point(piece)])[0].slopes.norm() <= steep.max(1.0) + 1e-12);
                walker.stay_within(None);
                slopes.stay_within(None);
            }
        }
        assert!(shortened_count > 200 && 2 * shortest < whole_length, "{shortened_count} {shortest}");
    }
}
