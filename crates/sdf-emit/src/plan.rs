//! Which values of a function get a name in the text, and in which order.
//!
//! A value gets a name when it is used twice, when it is used in another region than its own, and when the
//! expression round it would become too deep, too long or too wide. Each value stands just before its first use.

use sdf_ir::{Binary, Function, Node, RegionId, Value};

/// How deep expressions may be nested.
const DEEPEST: u32 = 8;
/// How many operands a chain `a + b + …` may have.
const LONGEST: u32 = 16;
/// About how many characters an expression may have.
const WIDEST: u32 = 96;
/// How many nodes a region may have before they stand in the order in which they were made.
const LONG: usize = 256;

/// How the text of a function is laid out.
pub(crate) struct Plan {
    /// For each region the nodes that are needed, in the order of the text.
    order: Vec<Vec<Value>>,
    named: Vec<bool>,
}

impl Plan {
    /// The plan of a function.
    pub fn of(function: &Function) -> Plan {
        let mut home = vec![None; function.node_count()];
        for r in 0..function.region_count() {
            let region = RegionId(r as u32);
            for v in &function.region(region).body {
                home[v.0 as usize] = Some(region);
            }
        }
        let mut schedule = Schedule {
            function,
            home,
            visited: vec![false; function.node_count()],
            reached: vec![false; function.region_count()],
            order: vec![Vec::new(); function.region_count()],
            captures: vec![Vec::new(); function.region_count()],
        };
        schedule.region(RegionId::ROOT);
        let named = schedule.must_be_named();
        let Schedule { home, order, .. } = schedule;
        let mut measure = Measure { function, named, home, size: vec![Size::LEAF; function.node_count()] };
        measure.region(&order, RegionId::ROOT);
        Plan { named: measure.named, order }
    }

    /// The nodes of a region that are needed, in the order of the text.
    pub fn order(&self, region: RegionId) -> &[Value] {
        &self.order[region.0 as usize]
    }

    /// Whether the value is computed by a statement of its own.
    pub fn is_named(&self, value: Value) -> bool {
        self.named[value.0 as usize]
    }
}

/// A piece of the vector that a `Compose` makes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Part {
    /// A float.
    Float(Value),
    /// Components of a vector: `p.xz`.
    Swizzle(Value, Vec<u8>),
}

/// The pieces of a `Compose` in the text: neighbours from one vector are one piece, and equal components are
/// written once.
pub(crate) fn parts(function: &Function, components: &[Value]) -> Vec<Part> {
    if components.iter().all(|c| *c == components[0]) {
        return vec![Part::Float(components[0])];
    }
    let mut parts = Vec::new();
    for c in components {
        match (function.node(*c), parts.last_mut()) {
            (Node::Component(a, i), Some(Part::Swizzle(b, indices))) if a == *b => indices.push(i),
            (Node::Component(a, i), _) => parts.push(Part::Swizzle(a, vec![i])),
            _ => parts.push(Part::Float(*c)),
        }
    }
    parts
}

/// The values whose text stands in the text of this one.
fn occurrences(function: &Function, value: Value) -> Vec<Value> {
    let composed = |components: &[Value]| {
        let value = |part| match part {
            Part::Float(v) | Part::Swizzle(v, _) => v,
        };
        parts(function, components).into_iter().map(value).collect()
    };
    match function.node(value) {
        Node::Compose2(x, y) => composed(&[x, y]),
        Node::Compose3(x, y, z) => composed(&[x, y, z]),
        _ => {
            let mut all = Vec::new();
            function.operands(value, |v| all.push(v));
            all
        }
    }
}

/// The value whose text has to be written to name this one: a component's vector, a result's tuple.
fn carrier(function: &Function, mut value: Value) -> Value {
    while let Node::Component(a, _) | Node::Result(a, _) = function.node(value) {
        value = a;
    }
    value
}

/// Puts the nodes of each region in the order of their first use, and leaves out what nothing uses.
struct Schedule<'a> {
    function: &'a Function,
    home: Vec<Option<RegionId>>,
    visited: Vec<bool>,
    reached: Vec<bool>,
    order: Vec<Vec<Value>>,
    /// For each region the values of the regions round it that it uses.
    captures: Vec<Vec<Value>>,
}

impl Schedule<'_> {
    fn region(&mut self, region: RegionId) {
        enum Step {
            Enter(Value),
            Leave(Value),
        }
        self.reached[region.0 as usize] = true;
        let function = self.function;
        let results = &function.region(region).results;
        let mut stack: Vec<Step> = results.iter().rev().map(|v| Step::Enter(*v)).collect();
        while let Some(step) = stack.pop() {
            match step {
                Step::Leave(v) => self.order[region.0 as usize].push(v),
                Step::Enter(v) => match self.home[v.0 as usize] {
                    None => {}
                    Some(home) if home != region => {
                        let captures = &mut self.captures[region.0 as usize];
                        if !captures.contains(&v) {
                            captures.push(v);
                        }
                    }
                    Some(_) if self.visited[v.0 as usize] => {}
                    Some(_) => {
                        self.visited[v.0 as usize] = true;
                        let mut needs = Vec::new();
                        function.operands(v, |o| needs.push(o));
                        for owned in function.owned_regions(v) {
                            self.region(owned);
                            needs.extend(&self.captures[owned.0 as usize]);
                        }
                        stack.push(Step::Leave(v));
                        stack.extend(needs.into_iter().rev().map(Step::Enter));
                    }
                },
            }
        }
        let order = &mut self.order[region.0 as usize];
        if order.len() > LONG {
            // Several results of a long body, each with a chain through all of it, would stand one behind the
            // other, and everything between them would live from the first to the last. Nodes are made after
            // what they use, so the order in which they were made works too.
            order.sort_unstable();
        }
    }

    /// The values that need a name whatever the expressions round them look like.
    fn must_be_named(&self) -> Vec<bool> {
        let function = self.function;
        let mut uses = vec![0u32; function.node_count()];
        let mut named = vec![false; function.node_count()];
        for (r, body) in self.order.iter().enumerate().filter(|(r, _)| self.reached[*r]) {
            let region = RegionId(r as u32);
            let results = function.region(region).results.iter().copied();
            let is_carried =
                |v: &&Value| !matches!(function.node(**v), Node::Component(..) | Node::Result(..));
            let texts = body.iter().filter(is_carried).flat_map(|v| occurrences(function, *v));
            for v in texts.chain(results) {
                let v = carrier(function, v);
                let home = self.home[v.0 as usize];
                uses[v.0 as usize] += 1;
                if home.is_some() && (uses[v.0 as usize] > 1 || home != Some(region)) {
                    named[v.0 as usize] = true;
                }
            }
            for v in body {
                named[v.0 as usize] |= matches!(function.node(*v), Node::If(..) | Node::Loop(_));
            }
        }
        named
    }
}

/// How large the expression of a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Size {
    depth: u32,
    chain: u32,
    width: u32,
}

impl Size {
    const LEAF: Size = Size { depth: 0, chain: 1, width: 5 };
}

/// Names what would make an expression too large.
struct Measure<'a> {
    function: &'a Function,
    home: Vec<Option<RegionId>>,
    named: Vec<bool>,
    size: Vec<Size>,
}

/// From how many operands on each gets a name.
const MANY: usize = 64;

impl Measure<'_> {
    fn region(&mut self, order: &[Vec<Value>], region: RegionId) {
        for &v in &order[region.0 as usize] {
            for owned in self.function.owned_regions(v) {
                self.region(order, owned);
            }
            self.size[v.0 as usize] = match self.function.node(v) {
                Node::Component(a, _) | Node::Result(a, _) => {
                    Size { width: self.of(a).width + 2, ..self.of(a) }
                }
                _ => self.expression(v),
            };
        }
    }

    /// The size of a value's text where it is used.
    fn of(&self, value: Value) -> Size {
        match self.function.node(value) {
            _ if self.named[value.0 as usize] => Size::LEAF,
            Node::Component(a, _) | Node::Result(a, _) => self.of(a),
            _ => self.size[value.0 as usize],
        }
    }

    /// The size of an operation's text, after naming as many operands as needed.
    fn expression(&mut self, value: Value) -> Size {
        let operands = occurrences(self.function, value);
        if operands.len() > MANY {
            // A call that passes on hundreds of numbers: looking for the largest again and again would take the square
            // of their number.
            for operand in operands.iter().map(|v| carrier(self.function, *v)) {
                self.named[operand.0 as usize] |= self.home[operand.0 as usize].is_some();
            }
        }
        loop {
            let size = self.combine(value, &operands);
            let key: fn(Size) -> u32 = match size {
                Size { depth, .. } if depth > DEEPEST => |s| s.depth,
                Size { chain, .. } if chain > LONGEST => |s| s.chain,
                Size { width, .. } if width > WIDEST => |s| s.width,
                _ => return size,
            };
            let inline = operands.iter().map(|v| carrier(self.function, *v));
            let inline = inline.filter(|v| self.home[v.0 as usize].is_some() && !self.named[v.0 as usize]);
            // The first of the largest, so that the text does not depend on anything else.
            let Some(largest) = inline.rev().max_by_key(|v| key(self.of(*v))) else { return size };
            self.named[largest.0 as usize] = true;
        }
    }

    fn combine(&self, value: Value, operands: &[Value]) -> Size {
        let sizes = operands.iter().map(|v| self.of(*v));
        let deepest = sizes.clone().map(|s| s.depth).max().unwrap_or(0);
        let widths: u32 = sizes.map(|s| s.width + 2).sum();
        let mut size = Size { depth: deepest + 1, chain: 1, width: widths + self.own_width(value) };
        if let Some((left, right)) = self.chain(value) {
            size.chain = self.of(left).chain + 1;
            size.depth = self.of(left).depth.max(self.of(right).depth + 1);
        }
        size
    }

    /// The operands of an operation that goes on with the chain of its left operand.
    fn chain(&self, value: Value) -> Option<(Value, Value)> {
        let Node::Binary(op, left, right) = self.function.node(value) else { return None };
        let Node::Binary(inner, ..) = self.function.node(left) else { return None };
        let goes_on =
            !self.named[left.0 as usize] && chain_of(op).is_some() && chain_of(op) == chain_of(inner);
        goes_on.then_some((left, right))
    }

    fn own_width(&self, value: Value) -> u32 {
        match self.function.node(value) {
            Node::Binary(op, ..) if chain_of(op).is_some() => 1,
            Node::Call(..) => 10,
            _ => 5,
        }
    }
}

/// The kind of chain that an operation forms, if any.
fn chain_of(op: Binary) -> Option<u8> {
    match op {
        Binary::Add | Binary::Subtract => Some(0),
        Binary::Multiply | Binary::Divide => Some(1),
        Binary::And => Some(2),
        Binary::Or => Some(3),
        _ => None,
    }
}
