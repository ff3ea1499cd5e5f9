//! What a walk over a function wants to know beforehand: which nodes count, where arguments go, and what lies beside
//! the nodes.

use super::idiom::{self, Idiom};
use super::rotation::{Angle, Axis};
use super::seam;
use crate::copy::{live, mark_live};
use crate::program::{Function, Node, RegionId, Rotation, Ternary, Type, Value};
use rustc_hash::FxHashMap;

/// What a walk over a function wants to know beforehand.
pub(crate) struct Plan {
    /// For each region the nodes to evaluate.
    bodies: Vec<Vec<Value>>,
    /// For each region the nodes that stand for its arguments.
    arguments: Vec<Vec<(u16, Value)>>,
    /// For each node where in `beside` more is known of it, if anything.
    index: Vec<u32>,
    beside: Vec<Beside>,
}

/// What is known of a node besides its operation.
#[derive(Default)]
struct Beside {
    rotation: Option<Rotation>,
    pair: Option<(Value, usize)>,
    seams: Option<Vec<[Value; 2]>>,
    idiom: Option<Idiom>,
}

const NOTHING: u32 = u32::MAX;

impl Plan {
    /// That of a finished function.
    pub fn new(function: &Function) -> Plan {
        let pairs = pairs(function);
        let mut idioms: Vec<Option<Idiom>> =
            (0..function.node_count()).map(|i| idiom::idiom(function, Value(i as u32))).collect();
        let live = live_with_rotations(function, &pairs, &idioms);
        let mut plan = Plan {
            bodies: Vec::new(),
            arguments: vec![Vec::new(); function.region_count()],
            index: vec![NOTHING; function.node_count()],
            beside: Vec::new(),
        };
        for i in 0..function.region_count() {
            let body = &function.region(RegionId(i as u32)).body;
            plan.bodies.push(body.iter().copied().filter(|v| live[v.0 as usize]).collect());
        }
        for i in 0..function.node_count() {
            let value = Value(i as u32);
            if let Node::Argument(region, index) = function.node(value) {
                plan.arguments[region.0 as usize].push((index, value));
            }
        }
        let mut is_there = vec![false; function.node_count()];
        for (i, there) in is_there.iter_mut().enumerate() {
            *there = match function.node(Value(i as u32)) {
                Node::Float(_) | Node::Bool(_) | Node::Uniform(_) | Node::Global(_) => true,
                Node::Argument(region, _) => region == RegionId::ROOT,
                _ => false,
            };
        }
        put_vectors_early(function, &mut plan.bodies[0], &is_there);
        plan.look_beside(function, RegionId::ROOT, &pairs, &mut idioms, &mut is_there);
        plan
    }

    /// That of a function that is still being built, as far as it is: every node counts.
    pub fn growing() -> Plan {
        Plan { bodies: Vec::new(), arguments: Vec::new(), index: Vec::new(), beside: Vec::new() }
    }

    /// Takes in what has been added to the function since.
    pub fn grow(&mut self, function: &Function) {
        self.bodies.clear();
        self.arguments = vec![Vec::new(); function.region_count()];
        for i in 0..function.region_count() {
            self.bodies.push(function.region(RegionId(i as u32)).body.clone());
        }
        for i in 0..function.node_count() {
            if let Node::Argument(region, index) = function.node(Value(i as u32)) {
                self.arguments[region.0 as usize].push((index, Value(i as u32)));
            }
        }
        self.index.resize(function.node_count(), NOTHING);
    }

    /// The nodes of a region to evaluate, in order.
    pub fn body(&self, region: RegionId) -> &[Value] {
        &self.bodies[region.0 as usize]
    }

    /// The indices of a region's arguments that are read, and the nodes that stand for them.
    pub fn arguments(&self, region: RegionId) -> &[(u16, Value)] {
        &self.arguments[region.0 as usize]
    }

    /// The rotation that the value is the image of.
    pub fn rotation(&self, value: Value) -> Option<&Rotation> {
        self.at(value)?.rotation.as_ref()
    }

    /// The vec3 that a vec2 is those components of that are not component `i`, and i.
    pub fn pair(&self, value: Value) -> Option<(Value, usize)> {
        self.at(value)?.pair
    }

    /// The pairs of values which are equal where a choice changes sides, if both sides agree there.
    pub fn seams(&self, value: Value) -> Option<&[[Value; 2]]> {
        self.at(value)?.seams.as_deref()
    }

    /// What makes a sum less steep than its terms.
    pub fn idiom(&self, value: Value) -> Option<&Idiom> {
        self.at(value)?.idiom.as_ref()
    }

    /// Adds the values that are read beside the operands of a node.
    pub fn add_beside(&self, value: Value, reads: &mut Vec<Value>) {
        let Some(Beside { rotation, pair, seams, idiom }) = self.at(value) else { return };
        if let Some(Rotation { vector, axis, angle, .. }) = rotation {
            reads.push(*vector);
            reads.extend(axis.and_then(|axis| if let Axis::Of(axis) = axis { Some(axis) } else { None }));
            reads.extend(if let Angle::Of(angle) = angle { Some(*angle) } else { None });
        }
        reads.extend(pair.map(|(whole, _)| whole));
        reads.extend(seams.iter().flatten().flatten());
        match idiom {
            None => {}
            Some(Idiom::Corner { vector, parts }) => reads.extend(vector.iter().chain(parts)),
            Some(Idiom::Linear { vector, .. }) => reads.push(*vector),
            Some(Idiom::Blend(blend)) => {
                reads.extend([blend.a, blend.b, blend.apart, blend.bulge]);
                reads.extend(blend.way.iter().chain(&blend.others));
            }
        }
    }

    fn at(&self, value: Value) -> Option<&Beside> {
        self.beside.get(self.index[value.0 as usize] as usize)
    }

    /// Finds what is known of the nodes of a region. `is_there` says what has been evaluated before a node.
    fn look_beside(
        &mut self,
        function: &Function,
        region: RegionId,
        pairs: &FxHashMap<Value, (Value, usize)>,
        idioms: &mut [Option<Idiom>],
        is_there: &mut [bool],
    ) {
        let arguments: Vec<Value> = self.arguments[region.0 as usize].iter().map(|(_, v)| *v).collect();
        for argument in &arguments {
            is_there[argument.0 as usize] = true;
        }
        let body = self.bodies[region.0 as usize].clone();
        for value in &body {
            for owned in function.owned_regions(*value) {
                self.look_beside(function, owned, pairs, idioms, is_there);
            }
            let beside = Beside {
                rotation: function.rotation_of(*value).and_then(|it| as_far_as_there(it, is_there)),
                pair: pairs.get(value).copied().filter(|(whole, _)| is_there[whole.0 as usize]),
                seams: match function.node(*value) {
                    Node::Ternary(Ternary::Select, ..) | Node::If(..) => seam::seams(function, *value),
                    _ => None,
                },
                idiom: idioms[value.0 as usize]
                    .take()
                    .filter(|it| !matches!(it, Idiom::Linear { vector, .. } if !is_there[vector.0 as usize])),
            };
            let Beside { rotation, pair, seams, idiom } = &beside;
            if rotation.is_some() || pair.is_some() || seams.is_some() || idiom.is_some() {
                self.index[value.0 as usize] = self.beside.len() as u32;
                self.beside.push(beside);
            }
            is_there[value.0 as usize] = true;
        }
        if region != RegionId::ROOT {
            for value in body.iter().chain(&arguments) {
                is_there[value.0 as usize] = false;
            }
        }
    }
}

/// Moves what rotations speak of, where it is put together from components, to just behind these.
fn put_vectors_early(function: &Function, body: &mut Vec<Value>, is_there: &[bool]) {
    let is_meant = |v: &Value| {
        matches!(function.node(*v), Node::Compose2(..) | Node::Compose3(..))
            && function.rotations().iter().any(|it| it.image == *v || it.vector == *v)
    };
    if function.rotations().is_empty() {
        return;
    }
    let mut waiting: Vec<Value> = body.iter().copied().filter(is_meant).collect();
    let mut is_there = is_there.to_vec();
    let mut sorted = Vec::with_capacity(body.len());
    let mut rest = body.iter().copied().filter(|v| !waiting.contains(v)).collect::<Vec<_>>().into_iter();
    loop {
        while let Some(ready) = waiting.iter().position(|v| {
            let mut is_ready = true;
            function.operands(*v, |operand| is_ready &= is_there[operand.0 as usize]);
            is_ready
        }) {
            let value = waiting.remove(ready);
            is_there[value.0 as usize] = true;
            sorted.push(value);
        }
        let Some(value) = rest.next() else { break };
        is_there[value.0 as usize] = true;
        sorted.push(value);
    }
    debug_assert!(waiting.is_empty(), "a vector is made of what its region does not see");
    sorted.extend(waiting);
    *body = sorted;
}

/// The rotation, as far as it speaks of what has been evaluated.
fn as_far_as_there(it: &Rotation, is_there: &[bool]) -> Option<Rotation> {
    let there = |v: Value| is_there[v.0 as usize];
    there(it.vector).then(|| Rotation {
        axis: it
            .axis
            .filter(|axis| matches!(axis, Axis::Fixed(_)) || matches!(axis, Axis::Of(axis) if there(*axis))),
        angle: match it.angle {
            Angle::Of(angle) if !there(angle) => Angle::Unknown,
            angle => angle,
        },
        ..*it
    })
}

/// Which vec2s are two components of one vec3, and of which: of a vector, or of the image of a rotation that was
/// put together from its components.
fn pairs(function: &Function) -> FxHashMap<Value, (Value, usize)> {
    let mut images: FxHashMap<[Value; 2], (Value, usize)> = FxHashMap::default();
    for rotation in function.rotations() {
        if let Node::Compose3(x, y, z) = function.node(rotation.image) {
            let parts = [x, y, z];
            for i in 0..3 {
                let (u, v) = (parts[(i + 1) % 3], parts[(i + 2) % 3]);
                for pair in [[u, v], [v, u]] {
                    images.entry(pair).or_insert((rotation.image, i));
                }
            }
        }
    }
    let mut pairs = FxHashMap::default();
    for i in 0..function.node_count() {
        let value = Value(i as u32);
        let Node::Compose2(x, y) = function.node(value) else { continue };
        match (function.node(x), function.node(y)) {
            (Node::Component(v, i), Node::Component(w, j))
                if v == w && i != j && function.type_of(v) == Some(Type::Vec3) =>
            {
                pairs.insert(value, (v, 3 - usize::from(i) - usize::from(j)));
            }
            _ => {
                if let Some(pair) = images.get(&[x, y]) {
                    pairs.insert(value, *pair);
                }
            }
        }
    }
    pairs
}

/// What the results depend on, and what says more about that: the operands of rotations, and the images whose pairs
/// are read.
fn live_with_rotations(
    function: &Function,
    pairs: &FxHashMap<Value, (Value, usize)>,
    idioms: &[Option<Idiom>],
) -> Vec<bool> {
    let mut live = live(function);
    for i in (0..live.len()).rev() {
        if let (true, Some(Idiom::Linear { vector, .. })) = (live[i], &idioms[i]) {
            mark_live(function, &mut live, vec![*vector]);
        }
    }
    let mut in_order: Vec<(&Value, &(Value, usize))> = pairs.iter().collect();
    in_order.sort();
    for (pair, (whole, _)) in in_order {
        if live[pair.0 as usize] {
            mark_live(function, &mut live, vec![*whole]);
        }
    }
    // An image stands behind its vector, so that chains are found from their ends.
    for rotation in function.rotations().iter().rev() {
        if live[rotation.image.0 as usize] {
            mark_live(function, &mut live, vec![rotation.vector]);
            if let Some(Axis::Of(axis)) = rotation.axis {
                mark_live(function, &mut live, vec![axis]);
            }
            if let Angle::Of(angle) = rotation.angle {
                mark_live(function, &mut live, vec![angle]);
            }
        }
    }
    live
}
