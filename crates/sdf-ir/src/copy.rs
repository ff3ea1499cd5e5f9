//! Copying the live nodes of a function into a builder.
//!
//! Inlining a call, rebuilding a function and moving it to another program are one walk: every node is made anew
//! through the builder, so constants that arrive with the arguments fold on the way, and what nothing reads stays
//! behind. `Links` says what the references to the rest of the program become.

use crate::build::Builder;
use crate::interval::{Angle, Axis};
use crate::program::{Function, FunctionId, Limit, Loop, Node, Program, RegionId, Rotation, Type, Value};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// What the references of a copied function to its program become. As it stands, they stay the same.
pub(crate) trait Links {
    /// The index of this uniform.
    fn uniform(&self, index: u16) -> u16 {
        index
    }

    /// The index of this global.
    fn global(&self, index: u16) -> u16 {
        index
    }

    /// What an operation becomes. `node` is the one that is copied, `operands` are what its operands became.
    fn operation(&self, builder: &mut Builder, node: Node, operands: &[Value]) -> Value {
        operation(builder, node, operands)
    }

    /// The results of a call with these arguments.
    fn call(
        &self,
        builder: &mut Builder,
        callee: FunctionId,
        results: &[Type],
        arguments: &[Value],
    ) -> Vec<Value> {
        builder.call(callee, results, arguments)
    }
}

/// Every reference stays the same.
pub(crate) struct SameProgram;

impl Links for SameProgram {}

impl Builder {
    /// Copies the body of a function of the same program into the open region, with these arguments in the place
    /// of its parameters, and returns its results.
    pub fn inline(&mut self, callee: &Function, arguments: &[Value]) -> Vec<Value> {
        inline(self, callee, arguments, &SameProgram)
    }
}

/// The function made anew: without its dead nodes, and with whatever the rules now see.
pub fn rebuild(function: &Function) -> Function {
    let mut builder = Builder::new(function.name.clone(), function.parameters.clone());
    builder.set_line(function.line);
    builder.set_doc(function.doc.clone());
    builder.set_lipschitz(function.lipschitz());
    builder.set_evaluation(function.is_evaluation());
    let arguments: Vec<Value> =
        (0..function.parameters.len()).map(|i| builder.argument(RegionId::ROOT, i as u16)).collect();
    let results = inline_whole(&mut builder, function, &arguments, &SameProgram);
    builder.finish(results.into_iter().zip(function.result_names.iter().cloned()).collect())
}

/// The function with all that it calls, as one function without calls.
pub fn written_out(program: &Program, function: &Function) -> Function {
    let mut builder = Builder::new(function.name.clone(), function.parameters.clone());
    let arguments: Vec<Value> =
        (0..function.parameters.len()).map(|i| builder.argument(RegionId::ROOT, i as u16)).collect();
    let results = inline_whole(&mut builder, function, &arguments, &WrittenOut(program));
    builder.finish(results.into_iter().zip(function.result_names.iter().cloned()).collect())
}

/// Calls become what they call, and operations stay as they are: what a rule made of two functions together could be less
/// to the point, over regions, than each by itself.
struct WrittenOut<'p>(&'p Program);

impl Links for WrittenOut<'_> {
    fn operation(&self, builder: &mut Builder, node: Node, operands: &[Value]) -> Value {
        builder.plain(match (node, operands) {
            (Node::Unary(op, _), &[a]) => Node::Unary(op, a),
            (Node::Binary(op, ..), &[a, b]) => Node::Binary(op, a, b),
            (Node::Ternary(op, ..), &[a, b, c]) => Node::Ternary(op, a, b, c),
            (Node::Compose2(..), &[x, y]) => Node::Compose2(x, y),
            (Node::Compose3(..), &[x, y, z]) => Node::Compose3(x, y, z),
            (Node::Component(_, index), &[a]) => Node::Component(a, index),
            _ => unreachable!("{node:?} is no operation on {} values", operands.len()),
        })
    }

    fn call(&self, builder: &mut Builder, callee: FunctionId, _: &[Type], arguments: &[Value]) -> Vec<Value> {
        inline_whole(builder, self.0.function(callee), arguments, self)
    }
}

/// [`Builder::inline`], between programs.
pub(crate) fn inline(
    builder: &mut Builder,
    callee: &Function,
    arguments: &[Value],
    links: &dyn Links,
) -> Vec<Value> {
    assert_eq!(
        arguments.len(),
        callee.parameters.len(),
        "{} is given other arguments than it takes",
        callee.name
    );
    let mut copy = Copy::new(callee, arguments, links);
    copy.region(builder, RegionId::ROOT)
}

/// [`inline`] of a function that nothing is added to: rotations stay with it even if a vector has come apart into
/// components. Then it is put together behind all else, where no rule will find it.
pub(crate) fn inline_whole(
    builder: &mut Builder,
    source: &Function,
    arguments: &[Value],
    links: &dyn Links,
) -> Vec<Value> {
    let mut copy = Copy::new(source, arguments, links);
    let results = copy.region(builder, RegionId::ROOT);
    // What stands in a branch or a loop cannot be seen from here.
    let mut is_seen = vec![false; source.node_count()];
    if !source.rotations().is_empty() {
        source.root().body.iter().for_each(|v| is_seen[v.0 as usize] = true);
    }
    for rotation in source.rotations() {
        let known =
            [rotation.image, rotation.vector].map(|v| copy.copied_or_put_together(builder, v, &is_seen));
        if let [Some(image), Some(vector)] = known {
            copy.carry(builder, rotation, image, vector);
        }
    }
    results
}

/// Which nodes the results depend on. Nothing has side effects, so all others are dead.
pub(crate) fn live(function: &Function) -> Vec<bool> {
    let mut live = vec![false; function.node_count()];
    mark_live(function, &mut live, function.root().results.clone());
    live
}

/// Marks these values and all that they depend on.
pub(crate) fn mark_live(function: &Function, live: &mut [bool], mut open: Vec<Value>) {
    while let Some(value) = open.pop() {
        if std::mem::replace(&mut live[value.0 as usize], true) {
            continue;
        }
        function.operands(value, |operand| open.push(operand));
        for region in function.owned_regions(value) {
            open.extend(&function.region(region).results);
        }
    }
}

pub(crate) struct Copy<'a> {
    source: &'a Function,
    links: &'a dyn Links,
    live: Vec<bool>,
    /// What stands for the arguments of each region that is being copied.
    arguments: FxHashMap<RegionId, Vec<Value>>,
    /// What stands for each node copied so far.
    copied: Vec<Copied>,
    /// The names of the state of loops.
    argument_names: FxHashMap<(RegionId, u16), &'a Arc<str>>,
}

/// What stands for a node.
#[derive(Clone)]
enum Copied {
    /// It has not been copied.
    Nothing,
    /// A value.
    One(Value),
    /// The parts of a tuple.
    Parts(Vec<Value>),
}

impl Copied {
    fn part(&self, index: usize) -> Value {
        match self {
            Copied::One(value) if index == 0 => *value,
            Copied::Parts(parts) => parts[index],
            _ => panic!("a node is copied before it is read"),
        }
    }
}

/// The names that the source gives to arguments of regions.
fn argument_names(source: &Function) -> FxHashMap<(RegionId, u16), &Arc<str>> {
    (0..source.node_count() as u32)
        .filter_map(|i| match (source.node(Value(i)), source.name_of(Value(i))) {
            (Node::Argument(region, index), Some(name)) => Some(((region, index), name)),
            _ => None,
        })
        .collect()
}

impl<'a> Copy<'a> {
    /// A walk that has copied nothing yet.
    pub(crate) fn new(source: &'a Function, arguments: &[Value], links: &'a dyn Links) -> Copy<'a> {
        Copy {
            source,
            links,
            live: live(source),
            arguments: FxHashMap::from_iter([(RegionId::ROOT, arguments.to_vec())]),
            copied: vec![Copied::Nothing; source.node_count()],
            argument_names: argument_names(source),
        }
    }

    /// Whether anything depends on the node.
    pub(crate) fn is_live(&self, value: Value) -> bool {
        self.live[value.0 as usize]
    }

    /// What stands for the arguments of a region that is copied next.
    pub(crate) fn enter(&mut self, region: RegionId, arguments: Vec<Value>) {
        self.arguments.insert(region, arguments);
    }

    /// What a node has become that was copied elsewhere.
    pub(crate) fn set(&mut self, builder: &mut Builder, value: Value, copied: Vec<Value>) {
        match copied[..] {
            [it] => self.set_one(builder, value, it),
            _ => self.copied[value.0 as usize] = Copied::Parts(copied),
        }
    }

    fn set_one(&mut self, builder: &mut Builder, value: Value, copied: Value) {
        if let Some(name) = self.source.name_of(value)
            && !is_leaf(builder.node(copied))
        {
            builder.name(copied, name);
        }
        self.copied[value.0 as usize] = Copied::One(copied);
    }

    /// Copies the body of a region into the open one and returns its results.
    pub(crate) fn region(&mut self, builder: &mut Builder, region: RegionId) -> Vec<Value> {
        let source = self.source;
        let region = source.region(region);
        for value in &region.body {
            if self.live[value.0 as usize] {
                self.node(builder, *value);
            }
        }
        self.values(builder, &region.results)
    }

    /// Copies a node of a body, and the regions that it owns.
    pub(crate) fn node(&mut self, builder: &mut Builder, value: Value) {
        let source = self.source;
        let copied = match source.node(value) {
            Node::If(condition, then, otherwise) => self.branch(builder, condition, then, otherwise),
            Node::Loop(it) => self.repeat(builder, it),
            Node::Call(callee, list) => {
                let results = source.types_of(value);
                let arguments = self.values(builder, source.list(list));
                self.links.call(builder, callee, &results, &arguments)
            }
            Node::Result(tuple, index) => {
                let part = self.copied[tuple.0 as usize].part(index as usize);
                return self.set_one(builder, value, part);
            }
            node => {
                let mut operands = [value; 3];
                let mut count = 0;
                source.operands(value, |operand| {
                    operands[count] = self.value(builder, operand);
                    count += 1;
                });
                let operation = self.links.operation(builder, node, &operands[..count]);
                self.set_one(builder, value, operation);
                return self.carry_rotation(builder, value);
            }
        };
        self.set(builder, value, copied);
    }

    /// Says of a copied node that it is a vector turned, where the source says so and the vector has been copied.
    fn carry_rotation(&self, builder: &mut Builder, value: Value) {
        let Some(rotation) = self.source.rotation_of(value) else { return };
        let Copied::One(image) = self.copied[value.0 as usize] else { return };
        if let Some(vector) = self.copied_or_leaf(builder, rotation.vector) {
            self.carry(builder, rotation, image, vector);
        }
    }

    /// Notes a rotation of the source on what its image and its vector have become.
    fn carry(&self, builder: &mut Builder, rotation: &Rotation, image: Value, vector: Value) {
        let axis = rotation.axis.and_then(|axis| match axis {
            Axis::Fixed(_) => Some(axis),
            Axis::Of(axis) => self.copied_or_leaf(builder, axis).map(Axis::Of),
        });
        let angle = match rotation.angle {
            Angle::Of(angle) => self.copied_or_leaf(builder, angle).map_or(Angle::Unknown, Angle::Of),
            angle => angle,
        };
        builder.mark_rotation(Rotation { image, vector, axis, angle });
    }

    /// What stands for a vector, or one of what stands for its parts, if these can be seen.
    fn copied_or_put_together(&self, builder: &mut Builder, value: Value, is_seen: &[bool]) -> Option<Value> {
        if let Some(copied) = self.copied_or_leaf(builder, value) {
            return Some(copied);
        }
        let is_seen = |v: Value| match self.source.node(v) {
            Node::Argument(region, _) => region == RegionId::ROOT,
            node => is_seen[v.0 as usize] || is_leaf(node),
        };
        if !is_seen(value) || !matches!(self.source.node(value), Node::Compose2(..) | Node::Compose3(..)) {
            return None;
        }
        let mut parts = Vec::with_capacity(3);
        self.source.operands(value, |part| parts.push(part));
        let parts: Option<Vec<Value>> =
            parts.into_iter().map(|part| self.copied_or_leaf(builder, part)).collect();
        parts.map(|parts| builder.compose(&parts))
    }

    /// What stands for a value, if it is a leaf or has been copied.
    fn copied_or_leaf(&self, builder: &mut Builder, value: Value) -> Option<Value> {
        match (self.source.node(value), &self.copied[value.0 as usize]) {
            (_, Copied::One(copied)) => Some(*copied),
            (Node::Argument(region, index), _) => Some(*self.arguments.get(&region)?.get(index as usize)?),
            (node, _) => is_leaf(node).then(|| self.value(builder, value)),
        }
    }

    fn branch(
        &mut self,
        builder: &mut Builder,
        condition: Value,
        then: RegionId,
        otherwise: RegionId,
    ) -> Vec<Value> {
        let condition = self.value(builder, condition);
        let [then, otherwise] = [then, otherwise].map(|region| {
            builder.open_region(&[]);
            let results = self.region(builder, region);
            builder.close_region(results)
        });
        builder.branch(condition, then, otherwise)
    }

    fn repeat(&mut self, builder: &mut Builder, it: Loop) -> Vec<Value> {
        let source = self.source;
        let initial = self.values(builder, source.list(it.initial));
        let [until, next] = [it.until, it.next].map(|region| {
            let types = &source.region(region).arguments;
            let open = builder.open_region(types);
            let arguments: Vec<Value> = (0..types.len()).map(|i| builder.argument(open, i as u16)).collect();
            for (i, argument) in arguments.iter().enumerate() {
                if let Some(name) = self.argument_names.get(&(region, i as u16)) {
                    builder.name(*argument, name);
                }
            }
            self.enter(region, arguments);
            let results = self.region(builder, region);
            builder.close_region(results)
        });
        builder.repeat_to(self.rounds(it), &initial, until, next)
    }

    /// How many rounds a loop has where it is copied to.
    pub(crate) fn rounds(&self, it: Loop) -> (u32, Option<Limit>) {
        let limit = it.limit.map(|limit| Limit { uniform: self.links.uniform(limit.uniform), ..limit });
        (it.count, limit)
    }

    pub(crate) fn values(&self, builder: &mut Builder, values: &[Value]) -> Vec<Value> {
        values.iter().map(|value| self.value(builder, *value)).collect()
    }

    /// What stands for a value that is no tuple.
    pub(crate) fn value(&self, builder: &mut Builder, value: Value) -> Value {
        let ty = || self.source.type_of(value).expect("a tuple is read by `Result` alone");
        match self.source.node(value) {
            Node::Float(bits) => builder.float(f64::from_bits(bits)),
            Node::Bool(it) => builder.bool(it),
            Node::Argument(region, index) => self.arguments[&region][index as usize],
            Node::Uniform(index) => builder.uniform(self.links.uniform(index), ty()),
            Node::Global(index) => builder.global(self.links.global(index), ty()),
            _ => self.copied[value.0 as usize].part(0),
        }
    }
}

/// The operation of this node, on these operands.
pub(crate) fn operation(builder: &mut Builder, node: Node, operands: &[Value]) -> Value {
    match (node, operands) {
        (Node::Unary(op, _), &[a]) => builder.unary(op, a),
        (Node::Binary(op, ..), &[a, b]) => builder.binary(op, a, b),
        (Node::Ternary(op, ..), &[a, b, c]) => builder.ternary(op, a, b, c),
        (Node::Compose2(..) | Node::Compose3(..), parts) => builder.compose(parts),
        (Node::Component(_, index), &[a]) => builder.component(a, index as usize),
        _ => unreachable!("{node:?} is no operation on {} values", operands.len()),
    }
}

/// Whether the node stands in no body. A leaf has a name of its own, or is a constant and needs none.
fn is_leaf(node: Node) -> bool {
    matches!(node, Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_))
}

#[cfg(test)]
mod tests {
    use super::rebuild;
    use crate::build::Builder;
    use crate::constant::Constant;
    use crate::program::{Binary, Function, Node, Parameter, RegionId, Type, Unary, Value};

    fn float(name: &str) -> Parameter {
        Parameter { name: name.into(), ty: Type::Float, point: false }
    }

    /// `iterate(3, x, |s| s + k, until: |s| s > 10)`, then its sign chooses between `k` and a product.
    fn looping() -> Function {
        let mut b = Builder::new("looping", vec![float("x"), float("k")]);
        let [x, k] = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
        let until = b.open_region(&[Type::Float]);
        let state = b.argument(until, 0);
        let limit = b.float(10.0);
        let over = b.binary(Binary::Less, limit, state);
        b.close_region(vec![over]);
        let next = b.open_region(&[Type::Float, Type::Float]);
        let state = b.argument(next, 1);
        let more = b.add(state, k);
        b.close_region(vec![more]);
        let last = b.repeat(3, &[x], until, next)[0];
        b.name(last, &"last".into());
        let zero = b.float(0.0);
        let negative = b.binary(Binary::Less, last, zero);
        let then = b.open_region(&[]);
        let sine = b.unary(Unary::Sin, last);
        b.close_region(vec![k, sine]);
        let otherwise = b.open_region(&[]);
        let product = b.mul(last, k);
        b.close_region(vec![product, last]);
        let parts = b.branch(negative, then, otherwise);
        let dead = b.unary(Unary::Tanh, k);
        b.name(dead, &"dead".into());
        b.finish(vec![(parts[0], "a".into()), (parts[1], "b".into())])
    }

    #[test]
    fn rebuilding_leaves_the_dead_behind_and_changes_nothing_else() {
        let before = looping();
        let after = rebuild(&before);
        assert!(before.root().body.len() == after.root().body.len() + 1);
        assert!(!after.nodes.contains(&Node::Unary(Unary::Tanh, Value(1))));
        assert_eq!(rebuild(&after), after);
        assert!((0..after.node_count()).any(|i| after.names[i].as_deref() == Some("last")));
    }

    #[test]
    fn what_arrives_with_the_arguments_folds() {
        let mut b = Builder::new("square", vec![float("x")]);
        let x = b.argument(RegionId::ROOT, 0);
        let square = b.mul(x, x);
        let square = b.finish(vec![(square, "".into())]);
        let mut b = Builder::new("caller", vec![]);
        let three = b.float(3.0);
        let nine = b.inline(&square, &[three])[0];
        assert_eq!(b.constant_of(nine), Some(Constant::Float(9.0)));
    }

    #[test]
    fn the_parameters_become_the_arguments() {
        let callee = looping();
        let mut b = Builder::new("twice", vec![float("x"), float("k")]);
        let arguments = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
        let x = b.unary(Unary::Floor, arguments[0]);
        let results = b.inline(&callee, &[x, arguments[1]]);
        let copy = b.finish(results.into_iter().map(|r| (r, "".into())).collect());
        assert_eq!(copy.root().body[0], x);
        assert_eq!(copy.root().body.len(), 1 + rebuild(&callee).root().body.len());
    }
}
