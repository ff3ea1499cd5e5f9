//! Building a function: hash-consed nodes, folded and simplified as they are made.
//!
//! Every operation goes through the `rules` first, so a function is never worse than its text. A node
//! made inside an `If` or a `Loop` is shared there and in the regions inside; one made outside is shared by all.

use crate::constant::Constant;
use crate::hash::MixMap;
use crate::interval::Axis;
use crate::program::{
    Binary, Evaluation, Function, FunctionId, Limit, List, Loop, Node, Parameter, Region, RegionId, Rotation,
    Rotations, Ternary, Type, Unary, Value,
};
use crate::rules;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// A function under construction.
#[derive(Clone)]
pub struct Builder {
    function: Function,
    leaves: MixMap<Node, Value>,
    scopes: Vec<(RegionId, MixMap<Node, Value>)>,
    interned: FxHashMap<Vec<Value>, List>,
}

/// The regions that were open when they were [left](Builder::leave_regions), from the outermost.
pub struct OpenRegions(Vec<(RegionId, MixMap<Node, Value>)>);

impl Builder {
    /// A function with these parameters and nothing in it.
    pub fn new(name: impl Into<Arc<str>>, parameters: Vec<Parameter>) -> Builder {
        let root = Region { arguments: parameters.iter().map(|p| p.ty).collect(), ..Region::default() };
        let function = Function {
            name: name.into(),
            line: None,
            doc: None,
            parameters,
            result_names: Vec::new(),
            nodes: Vec::new(),
            types: Vec::new(),
            names: Vec::new(),
            regions: vec![root],
            lists: Vec::new(),
            lipschitz: None,
            rotations: Rotations::default(),
            evaluation: Evaluation::default(),
        };
        Builder {
            function,
            leaves: MixMap::default(),
            scopes: vec![(RegionId::ROOT, MixMap::default())],
            interned: FxHashMap::default(),
        }
    }

    /// The function so far.
    pub fn function(&self) -> &Function {
        &self.function
    }

    /// What the function is, in a sentence.
    pub fn set_doc(&mut self, doc: Option<Arc<str>>) {
        self.function.doc = doc;
    }

    /// The line of the source that the function comes from.
    pub fn set_line(&mut self, line: Option<u32>) {
        self.function.line = line;
    }

    /// Promises that between two calls the results change by at most this times the distance of the arguments that
    /// are points; see [`Function::lipschitz`].
    pub fn set_lipschitz(&mut self, lipschitz: Option<f64>) {
        self.function.lipschitz = lipschitz.map(f64::to_bits);
    }

    /// Says whether calls of the function count as evaluations of a field.
    pub fn set_evaluation(&mut self, evaluation: bool) {
        self.function.evaluation = Evaluation(evaluation);
    }

    /// Notes that `image` is `vector` turned about `axis` by `angle`: a fact beside the nodes, which keeps what the
    /// products that compute the image no longer show. The first note on an image stays.
    pub fn mark_rotation(&mut self, rotation: Rotation) {
        let Rotation { image, vector, .. } = rotation;
        // An axis that is a constant needs no node.
        let axis = rotation.axis.map(|axis| match axis {
            Axis::Of(value) => match self.constant_of(value) {
                Some(Constant::Vec3(axis)) => Axis::Fixed(axis),
                _ => axis,
            },
            Axis::Fixed(_) => axis,
        });
        assert!(
            self.ty(image).is_vector() && self.ty(image) == self.ty(vector),
            "a vector turns into its like"
        );
        let rotations = &mut self.function.rotations.0;
        if image != vector
            && let Err(place) = rotations.binary_search_by_key(&image, |rotation| rotation.image)
        {
            rotations.insert(place, Rotation { axis, ..rotation });
        }
    }

    /// Adds a parameter and returns it.
    pub fn add_parameter(&mut self, parameter: Parameter) -> Value {
        let index = self.function.parameters.len() as u16;
        self.function.regions[0].arguments.push(parameter.ty);
        self.function.parameters.push(parameter);
        self.argument(RegionId::ROOT, index)
    }

    /// The function with these results. Every region that was opened must have been closed.
    pub fn finish(mut self, results: Vec<(Value, Arc<str>)>) -> Function {
        assert_eq!(self.scopes.len(), 1, "a region is still open");
        for (value, name) in results {
            self.function.regions[0].results.push(value);
            self.function.result_names.push(name);
        }
        self.function
    }

    /// The type of a value that is no tuple.
    pub fn ty(&self, value: Value) -> Type {
        self.function.type_of(value).expect("a tuple has no type")
    }

    /// The node of a value.
    pub fn node(&self, value: Value) -> Node {
        self.function.node(value)
    }

    /// Gives a value the name that the source has for it, unless it has one. Leaves keep theirs.
    pub fn name(&mut self, value: Value, name: &Arc<str>) {
        let slot = &mut self.function.names[value.0 as usize];
        if slot.is_none() {
            *slot = Some(name.clone());
        }
    }

    /// The constant that a value is, vectors of constants included.
    pub fn constant_of(&self, value: Value) -> Option<Constant> {
        let float = |v| match self.node(v) {
            Node::Float(bits) => Some(f64::from_bits(bits)),
            _ => None,
        };
        match self.node(value) {
            Node::Float(bits) => Some(Constant::Float(f64::from_bits(bits))),
            Node::Bool(b) => Some(Constant::Bool(b)),
            Node::Compose2(x, y) => Some(Constant::Vec2([float(x)?, float(y)?])),
            Node::Compose3(x, y, z) => Some(Constant::Vec3([float(x)?, float(y)?, float(z)?])),
            _ => None,
        }
    }

    /// The region that was opened last; the function's own where none is open.
    pub fn open_region_id(&self) -> RegionId {
        self.scopes.last().map_or(RegionId::ROOT, |(id, _)| *id)
    }

    /// Leaves all open regions for a while: what follows lands in the function's own region, before them.
    pub fn leave_regions(&mut self) -> OpenRegions {
        OpenRegions(self.scopes.split_off(1))
    }

    /// Goes on with the regions that were left.
    pub fn return_to(&mut self, regions: OpenRegions) {
        assert_eq!(self.scopes.len(), 1, "a region is still open");
        self.scopes.extend(regions.0);
    }

    // ---- leaves

    /// A number.
    pub fn float(&mut self, x: f64) -> Value {
        self.leaf(Node::Float(x.to_bits()), Type::Float)
    }

    /// A truth value.
    pub fn bool(&mut self, x: bool) -> Value {
        self.leaf(Node::Bool(x), Type::Bool)
    }

    /// A constant.
    pub fn constant(&mut self, c: Constant) -> Value {
        match c {
            Constant::Bool(b) => self.bool(b),
            Constant::Float(x) => self.float(x),
            Constant::Vec2(v) => {
                let parts = v.map(|x| self.float(x));
                self.compose(&parts)
            }
            Constant::Vec3(v) => {
                let parts = v.map(|x| self.float(x));
                self.compose(&parts)
            }
        }
    }

    /// An argument of an open region, or a parameter (`RegionId::ROOT`).
    pub fn argument(&mut self, region: RegionId, index: u16) -> Value {
        let ty = self.function.region(region).arguments[index as usize];
        self.leaf(Node::Argument(region, index), ty)
    }

    /// A uniform of the program.
    pub fn uniform(&mut self, index: u16, ty: Type) -> Value {
        self.leaf(Node::Uniform(index), ty)
    }

    /// A value of the frame.
    pub fn global(&mut self, index: u16, ty: Type) -> Value {
        self.leaf(Node::Global(index), ty)
    }

    fn leaf(&mut self, node: Node, ty: Type) -> Value {
        if let Some(v) = self.leaves.get(&node) {
            return *v;
        }
        let value = self.new_node(node, Some(ty));
        self.leaves.insert(node, value);
        value
    }

    // ---- operations

    /// An operation on one value.
    pub fn unary(&mut self, op: Unary, a: Value) -> Value {
        if let Some(v) = rules::unary(self, op, a) {
            return v;
        }
        self.plain(Node::Unary(op, a))
    }

    /// An operation on two values.
    pub fn binary(&mut self, op: Binary, a: Value, b: Value) -> Value {
        if let Some(v) = rules::binary(self, op, a, b) {
            return v;
        }
        self.plain(Node::Binary(op, a, b))
    }

    /// An operation on three values.
    pub fn ternary(&mut self, op: Ternary, a: Value, b: Value, c: Value) -> Value {
        if let Some(v) = rules::ternary(self, op, a, b, c) {
            return v;
        }
        self.plain(Node::Ternary(op, a, b, c))
    }

    /// An operation as it is, whatever a rule would make of it.
    pub(crate) fn plain(&mut self, operation: Node) -> Value {
        let ty = match operation {
            Node::Unary(op, a) => match op {
                Unary::Not => Type::Bool,
                Unary::Length | Unary::Hash => Type::Float,
                Unary::ReduceAngle => Type::Vec2,
                _ => self.ty(a),
            },
            Node::Binary(op, a, b) => match op {
                Binary::Dot => Type::Float,
                Binary::Less | Binary::LessEqual | Binary::Equal | Binary::And | Binary::Or => Type::Bool,
                _ => self.ty(a).max(self.ty(b)),
            },
            Node::Ternary(_, _, b, _) => self.ty(b),
            Node::Compose2(..) => Type::Vec2,
            Node::Compose3(..) => Type::Vec3,
            Node::Component(..) => Type::Float,
            _ => unreachable!("{operation:?} is no operation on values alone"),
        };
        self.push(operation, Some(ty))
    }

    /// `a + b`
    pub fn add(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Add, a, b)
    }

    /// `a - b`
    pub fn sub(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Subtract, a, b)
    }

    /// `a * b`
    pub fn mul(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Multiply, a, b)
    }

    /// `a / b`
    pub fn div(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Divide, a, b)
    }

    /// `min(a, b)`
    pub fn min(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Min, a, b)
    }

    /// `max(a, b)`
    pub fn max(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Max, a, b)
    }

    /// `-a`
    pub fn neg(&mut self, a: Value) -> Value {
        self.unary(Unary::Negate, a)
    }

    /// `if c then a else b`
    pub fn select(&mut self, c: Value, a: Value, b: Value) -> Value {
        self.ternary(Ternary::Select, c, a, b)
    }

    /// The float or vector of one to three floats.
    pub fn compose(&mut self, parts: &[Value]) -> Value {
        if let Some(v) = rules::compose(self, parts) {
            return v;
        }
        match *parts {
            [x] => x,
            [x, y] => self.push(Node::Compose2(x, y), Some(Type::Vec2)),
            [x, y, z] => self.push(Node::Compose3(x, y, z), Some(Type::Vec3)),
            _ => panic!("no vector has {} components", parts.len()),
        }
    }

    /// The vector of `ty` whose components are all `a`, or `a` itself where it has that type.
    pub fn splat(&mut self, a: Value, ty: Type) -> Value {
        if self.ty(a) == ty {
            return a;
        }
        self.compose(&vec![a; ty.size()])
    }

    /// A component of a vector, from 0; a float is its own component.
    pub fn component(&mut self, a: Value, index: usize) -> Value {
        if !self.ty(a).is_vector() {
            return a;
        }
        match self.node(a) {
            // (x, y).x == x
            Node::Compose2(x, y) => [x, y][index],
            Node::Compose3(x, y, z) => [x, y, z][index],
            _ => self.push(Node::Component(a, index as u8), Some(Type::Float)),
        }
    }

    /// All components of a value.
    pub fn components(&mut self, a: Value) -> Vec<Value> {
        (0..self.ty(a).size()).map(|i| self.component(a, i)).collect()
    }

    /// A call of a function with results of these types.
    pub fn call(&mut self, callee: FunctionId, results: &[Type], arguments: &[Value]) -> Vec<Value> {
        let list = self.list(arguments);
        self.push_tuple(Node::Call(callee, list), results)
    }

    // ---- regions

    /// Opens a region; what is made from now on belongs to it, until it is closed.
    pub fn open_region(&mut self, arguments: &[Type]) -> RegionId {
        let id = RegionId(self.function.regions.len() as u32);
        self.function.regions.push(Region { arguments: arguments.to_vec(), ..Region::default() });
        self.scopes.push((id, MixMap::default()));
        id
    }

    /// Closes the region that was opened last.
    pub fn close_region(&mut self, results: Vec<Value>) -> RegionId {
        assert!(self.scopes.len() > 1, "no region is open");
        let (id, _) = self.scopes.pop().expect("there are two scopes at least, as was asserted");
        self.function.regions[id.0 as usize].results = results;
        id
    }

    /// `if condition` the results of the region `then`, else those of `otherwise`. Both must be closed.
    pub fn branch(&mut self, condition: Value, then: RegionId, otherwise: RegionId) -> Vec<Value> {
        // if true { a } else { b } == a
        if let Node::Bool(holds) = self.node(condition) {
            return self.splice(if holds { then } else { otherwise });
        }
        let [left, right] = [then, otherwise].map(|id| self.function.region(id).results.clone());
        // A result that is the same on both sides comes from outside of them.
        let differs: Vec<bool> = left.iter().zip(&right).map(|(a, b)| a != b).collect();
        let is_empty = |id| self.function.region(id).body.is_empty();
        // if c { a } else { b } == c ? a : b, where neither side has anything to compute
        if is_empty(then) && is_empty(otherwise) {
            return left.iter().zip(right).map(|(a, b)| self.select(condition, *a, b)).collect();
        }
        for (id, results) in [(then, &left), (otherwise, &right)] {
            let kept = results.iter().zip(&differs).filter(|(_, differs)| **differs).map(|(v, _)| *v);
            self.function.regions[id.0 as usize].results = kept.collect();
        }
        if !differs.contains(&true) {
            return left;
        }
        let types: Vec<Type> = self.function.region(then).results.iter().map(|v| self.ty(*v)).collect();
        let mut parts = self.push_tuple(Node::If(condition, then, otherwise), &types).into_iter();
        let result = |(value, differs)| {
            if differs { parts.next().expect("the branch has a result for each that differs") } else { value }
        };
        left.into_iter().zip(differs).map(result).collect()
    }

    /// Moves the body of a closed region without arguments into the open one.
    fn splice(&mut self, region: RegionId) -> Vec<Value> {
        let Region { body, results, .. } = std::mem::take(&mut self.function.regions[region.0 as usize]);
        let (open, table) = self.scopes.last_mut().expect("the root is always open");
        for value in &body {
            table.entry(self.function.nodes[value.0 as usize]).or_insert(*value);
        }
        self.function.regions[open.0 as usize].body.extend(body);
        results
    }

    /// A loop of so many rounds at most; see [`Loop`]. Both regions must be closed.
    pub fn repeat(&mut self, count: u32, initial: &[Value], until: RegionId, next: RegionId) -> Vec<Value> {
        self.repeat_to((count, None), initial, until, next)
    }

    /// The same, where the number may be made of a setting.
    pub fn repeat_to(
        &mut self,
        (count, limit): (u32, Option<Limit>),
        initial: &[Value],
        until: RegionId,
        next: RegionId,
    ) -> Vec<Value> {
        let types: Vec<Type> = initial.iter().map(|v| self.ty(*v)).collect();
        let initial = self.list(initial);
        self.push_tuple(Node::Loop(Loop { count, limit, initial, until, next }), &types)
    }

    // ---- nodes

    fn list(&mut self, values: &[Value]) -> List {
        if let Some(list) = self.interned.get(values) {
            return *list;
        }
        let list = List { start: self.function.lists.len() as u32, len: values.len() as u32 };
        self.function.lists.extend_from_slice(values);
        self.interned.insert(values.to_vec(), list);
        list
    }

    fn push_tuple(&mut self, node: Node, types: &[Type]) -> Vec<Value> {
        if let [ty] = *types {
            return vec![self.push(node, Some(ty))];
        }
        let tuple = self.push(node, None);
        types.iter().enumerate().map(|(i, ty)| self.push(Node::Result(tuple, i as u16), Some(*ty))).collect()
    }

    /// The node, shared with an equal one where that is in scope. Used by the rules, which have nothing left to do.
    pub(crate) fn push(&mut self, node: Node, ty: Option<Type>) -> Value {
        let (_, outer) = self.scopes.split_last().expect("the root is always open");
        if let Some(value) = outer.iter().rev().find_map(|(_, table)| table.get(&node)) {
            return *value;
        }
        let next = Value(self.function.nodes.len() as u32);
        let (region, table) = self.scopes.last_mut().expect("the root is always open");
        let value = *table.entry(node).or_insert(next);
        if value == next {
            self.function.regions[region.0 as usize].body.push(value);
            self.new_node(node, ty);
        }
        value
    }

    /// `y op x` where that is there already and the same as `x op y`. Bounds are not, since a tie takes the first.
    pub(crate) fn find_commuted(&self, op: Binary, x: Value, y: Value) -> Option<Value> {
        matches!(op, Binary::Add | Binary::Multiply).then(|| self.find(Node::Binary(op, y, x)))?
    }

    /// The vector of these parts where that is there already.
    pub(crate) fn find_composed(&self, parts: &[Value]) -> Option<Value> {
        match *parts {
            [x, y] => self.find(Node::Compose2(x, y)),
            [x, y, z] => self.find(Node::Compose3(x, y, z)),
            _ => None,
        }
    }

    fn find(&self, node: Node) -> Option<Value> {
        self.scopes.iter().rev().find_map(|(_, table)| table.get(&node)).copied()
    }

    fn new_node(&mut self, node: Node, ty: Option<Type>) -> Value {
        let value = Value(self.function.nodes.len() as u32);
        self.function.nodes.push(node);
        self.function.types.push(ty);
        self.function.names.push(None);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::Builder;
    use crate::program::{Node, Parameter, Program, RegionId, Type, Unary, Value};

    fn start() -> (Builder, [Value; 2]) {
        let float = |name: &str| Parameter { name: name.into(), ty: Type::Float, point: false };
        let condition = Parameter { name: "c".into(), ty: Type::Bool, point: false };
        let mut b = Builder::new("branches", vec![float("x"), condition]);
        let arguments = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
        (b, arguments)
    }

    fn finish(b: Builder, results: Vec<Value>) -> Program {
        let mut program = Program::default();
        program.add(b.finish(results.into_iter().map(|r| (r, "".into())).collect()));
        assert_eq!(crate::verify(&program), Ok(()));
        program
    }

    #[test]
    fn a_branch_that_is_decided_is_its_side() {
        let (mut b, [x, _]) = start();
        let then = b.open_region(&[]);
        let sine = b.unary(Unary::Sin, x);
        b.close_region(vec![sine]);
        let otherwise = b.open_region(&[]);
        let cosine = b.unary(Unary::Cos, x);
        b.close_region(vec![cosine]);
        let decided = b.bool(false);
        assert_eq!(b.branch(decided, then, otherwise), [cosine]);
        assert_eq!(b.unary(Unary::Cos, x), cosine);
        assert_eq!(finish(b, vec![cosine]).functions[0].root().body, [cosine]);
    }

    #[test]
    fn only_what_differs_is_branched() {
        let (mut b, [x, c]) = start();
        let then = b.open_region(&[]);
        let sine = b.unary(Unary::Sin, x);
        b.close_region(vec![x, sine]);
        let otherwise = b.open_region(&[]);
        b.close_region(vec![x, x]);
        let results = b.branch(c, then, otherwise);
        assert_eq!(results[0], x);
        assert_eq!(b.node(results[1]), Node::If(c, then, otherwise));
        finish(b, results);
    }

    #[test]
    fn sides_with_nothing_to_compute_are_a_choice() {
        let (mut b, [x, c]) = start();
        let one = b.float(1.0);
        let then = b.open_region(&[]);
        b.close_region(vec![x]);
        let otherwise = b.open_region(&[]);
        b.close_region(vec![one]);
        let results = b.branch(c, then, otherwise);
        assert_eq!(results, [b.select(c, x, one)]);
        finish(b, results);
    }
}
