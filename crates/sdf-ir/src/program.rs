//! The program as data.
//!
//! A [`Program`] is a list of functions, callees before callers. A [`Function`] owns nodes; a [`Value`] names one
//! of them. Nodes are hash-consed by the [`Builder`](crate::Builder), small and `Copy`. Straight-line code is the
//! `body` of a [`Region`]; `If` and `Loop` are nodes that own further regions, which take and yield values, so
//! that nothing is ever assigned to. Constants, arguments, uniforms and globals stand in no body: they are
//! available everywhere in their function.

use crate::constant::Constant;
use crate::interval::{Angle, Axis};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// The types of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Type {
    /// A truth value.
    Bool,
    /// A number.
    Float,
    /// Two numbers.
    Vec2,
    /// Three numbers.
    Vec3,
}

impl Type {
    /// How many scalars it holds.
    pub fn size(self) -> usize {
        match self {
            Type::Bool | Type::Float => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
        }
    }

    /// The type of `size` numbers, 1 to 3.
    pub fn of_size(size: usize) -> Type {
        match size {
            1 => Type::Float,
            2 => Type::Vec2,
            3 => Type::Vec3,
            _ => panic!("no type has {size} components"),
        }
    }

    /// Whether it is `Vec2` or `Vec3`.
    pub fn is_vector(self) -> bool {
        self.size() > 1
    }
}

/// A node of a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Value(pub u32);

/// A function of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FunctionId(pub u32);

/// A region of a function; `RegionId(0)` is the function's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RegionId(pub u32);

impl RegionId {
    /// The region whose arguments are the function's parameters and whose results are the function's.
    pub const ROOT: RegionId = RegionId(0);
}

/// A list of values: a range in the function's table of lists. Equal lists of a function are the same range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct List {
    /// The first.
    pub start: u32,
    /// How many.
    pub len: u32,
}

/// An operation on one value. Component by component on vectors where nothing else is said.
/// Every one is total (finite for finite arguments) in the meaning of the language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unary {
    /// `-a`
    Negate,
    /// `!a` of a bool
    Not,
    /// `|a|`
    Abs,
    /// -1, 0 or 1
    Sign,
    /// The largest whole number that is not above.
    Floor,
    /// The smallest whole number that is not below.
    Ceil,
    /// The nearest whole number, the even one of two.
    Round,
    /// Towards zero.
    Trunc,
    /// The square root of `max(a, 0)`.
    Sqrt,
    /// Of an angle in radians.
    Sin,
    /// Of an angle in radians.
    Cos,
    /// Of an angle in radians; saturates.
    Tan,
    /// In radians, of the argument clamped to -1..1.
    Asin,
    /// In radians, of the argument clamped to -1..1.
    Acos,
    /// In radians.
    Atan,
    /// e to the power; saturates.
    Exp,
    /// 2 to the power; saturates.
    Exp2,
    /// Natural, of the argument or the smallest normal number.
    Log,
    /// To base 2, of the argument or the smallest normal number.
    Log2,
    /// Hyperbolic tangent.
    Tanh,
    /// Vector to float: its Euclidean length; saturates.
    Length,
    /// Vector to vector of length one; zero stays zero.
    Normalize,
    /// Float or vector to float in `[0, 1)`, from the bits of the components as `f32`.
    Hash,
    /// 2 to the power of a whole number from -126 to 127, from its bits. Basic: what `Exp2` is made from.
    PowerOfTwo,
    /// The exponent of a positive normal number, a whole number, from its bits. Basic.
    Exponent,
    /// The mantissa of a positive normal number, in `[1, 2)`, from its bits. Basic.
    Mantissa,
    /// Float to vec2 `(r, q)`: an angle is `r + q·π/2` and whole turns, `|r| ≤ π/4`, q one of 0, 1, 2, 3. Basic:
    /// what `Sin` and `Cos` are made from; exact integer arithmetic, so that no compiler can reassociate it.
    ReduceAngle,
}

impl Unary {
    /// All of them.
    pub const ALL: [Unary; 27] = [
        Unary::Negate,
        Unary::Not,
        Unary::Abs,
        Unary::Sign,
        Unary::Floor,
        Unary::Ceil,
        Unary::Round,
        Unary::Trunc,
        Unary::Sqrt,
        Unary::Sin,
        Unary::Cos,
        Unary::Tan,
        Unary::Asin,
        Unary::Acos,
        Unary::Atan,
        Unary::Exp,
        Unary::Exp2,
        Unary::Log,
        Unary::Log2,
        Unary::Tanh,
        Unary::Length,
        Unary::Normalize,
        Unary::Hash,
        Unary::PowerOfTwo,
        Unary::Exponent,
        Unary::Mantissa,
        Unary::ReduceAngle,
    ];
}

/// An operation on two values. Component by component on vectors where nothing else is said; `Add`, `Subtract`,
/// `Multiply` and `Divide` also take a vector and a float, in any order; all others want equal types.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Binary {
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a * b`
    Multiply,
    /// `a / b`; saturates, `0 / 0` is 0
    Divide,
    /// `a - b*floor(a/b)`; `a % 0` is 0
    Modulo,
    /// The smaller.
    Min,
    /// The larger.
    Max,
    /// `|a|` to the power of b, with the sign of an odd whole power; saturates.
    Power,
    /// The angle of the point (b, a), in -π..π; 0 at the origin.
    Atan2,
    /// Vectors to float.
    Dot,
    /// Two vec3 to a vec3.
    Cross,
    /// Floats to bool.
    Less,
    /// Floats to bool.
    LessEqual,
    /// Floats, or bools, to bool.
    Equal,
    /// Of bools.
    And,
    /// Of bools.
    Or,
}

impl Binary {
    /// All of them.
    pub const ALL: [Binary; 16] = [
        Binary::Add,
        Binary::Subtract,
        Binary::Multiply,
        Binary::Divide,
        Binary::Modulo,
        Binary::Min,
        Binary::Max,
        Binary::Power,
        Binary::Atan2,
        Binary::Dot,
        Binary::Cross,
        Binary::Less,
        Binary::LessEqual,
        Binary::Equal,
        Binary::And,
        Binary::Or,
    ];
}

/// An operation on three values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Ternary {
    /// `if a then b else c`: a is a bool, b and c have one type. Both are computed.
    Select,
    /// `a*(1-c) + b*c`: a and b have one type, c is that or a float.
    Mix,
}

impl Ternary {
    /// All of them.
    pub const ALL: [Ternary; 2] = [Ternary::Select, Ternary::Mix];
}

/// One node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Node {
    /// A number, as the bits of an `f64`; rounded to the number system that evaluates it.
    Float(u64),
    /// A truth value.
    Bool(bool),
    /// An argument of a region: a parameter of the function for the root, a state value in a loop.
    Argument(RegionId, u16),
    /// A uniform of the program: an index into [`Program::uniforms`].
    Uniform(u16),
    /// A value of the frame: an index into [`Program::globals`].
    Global(u16),
    /// An operation on one value.
    Unary(Unary, Value),
    /// An operation on two values.
    Binary(Binary, Value, Value),
    /// An operation on three values.
    Ternary(Ternary, Value, Value, Value),
    /// A vec2 of two floats.
    Compose2(Value, Value),
    /// A vec3 of three floats.
    Compose3(Value, Value, Value),
    /// A component of a vector, from 0.
    Component(Value, u8),
    /// A call. One result: the value itself; several: a tuple, read by `Result`.
    Call(FunctionId, List),
    /// The results of the first region if the value holds, else those of the second. The regions take nothing.
    If(Value, RegionId, RegionId),
    /// A loop; see [`Loop`].
    Loop(Loop),
    /// A part of the tuple that a call, an `If` or a `Loop` with several results yields, from 0.
    Result(Value, u16),
}

/// At most `count` rounds from the state `initial`. Before round i the region `until`, whose arguments are the
/// state, tells by its single bool result whether to stop; the region `next`, whose arguments are i (a float)
/// and the state, yields the state after the round. The loop yields the last state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Loop {
    /// The largest number of rounds.
    pub count: u32,
    /// The setting that the number is made of, if it is.
    pub limit: Option<Limit>,
    /// The state before the first round.
    pub initial: List,
    /// Whether to stop.
    pub until: RegionId,
    /// One round.
    pub next: RegionId,
}

/// A setting as the number of rounds of a loop: texts write the setting's name and not the number, for a reader to change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Limit {
    /// The uniform, of the role [`Setting`](Role::Setting), whose default is a whole number.
    pub uniform: u16,
    /// How many times as many rounds.
    pub times: u32,
}

/// Straight-line code that takes and yields values.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Region {
    /// The types of its arguments.
    pub arguments: Vec<Type>,
    /// The nodes to evaluate, in an order that works.
    pub body: Vec<Value>,
    /// What it yields.
    pub results: Vec<Value>,
}

/// A parameter of a function.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Parameter {
    /// The name that the source suggests; printers make it safe and unique.
    pub name: Arc<str>,
    /// Its type.
    pub ty: Type,
    /// Whether it is a point of space: then its components are promised to be at most 1e18.
    pub point: bool,
}

/// A function.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Function {
    /// The name that the source suggests; printers make it safe and unique.
    pub name: Arc<str>,
    /// The line of the root file that it comes from, where there is one.
    pub line: Option<u32>,
    /// What it is, in a sentence that may stand in an output: never a user's text.
    pub doc: Option<Arc<str>>,
    /// The parameters: the arguments of the root region.
    pub parameters: Vec<Parameter>,
    /// The names of the results, as long as the results of the root region; empty names are allowed.
    pub result_names: Vec<Arc<str>>,
    pub(crate) nodes: Vec<Node>,
    /// `None` for tuples.
    pub(crate) types: Vec<Option<Type>>,
    pub(crate) names: Vec<Option<Arc<str>>>,
    pub(crate) regions: Vec<Region>,
    pub(crate) lists: Vec<Value>,
    /// The bits of the promised Lipschitz constant.
    pub(crate) lipschitz: Option<u64>,
    pub(crate) rotations: Rotations,
    pub(crate) evaluation: Evaluation,
}

/// Whether a call of a function is an evaluation of a field, for those who count them. It says nothing of what is
/// computed, so functions that differ in it alone are equal.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Evaluation(pub bool);

impl PartialEq for Evaluation {
    fn eq(&self, _: &Evaluation) -> bool {
        true
    }
}

impl Eq for Evaluation {}

impl Hash for Evaluation {
    fn hash<H: Hasher>(&self, _: &mut H) {}
}

/// That a value is another vector turned: what the dots that compute it no longer say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// What comes out.
    pub image: Value,
    /// What is turned: a vec2 or vec3.
    pub vector: Value,
    /// The axis of a vec3, of any length but zero; `None` where it is not known, and for a vec2.
    pub axis: Option<Axis<Value>>,
    /// The angle in radians.
    pub angle: Angle<Value>,
}

/// The rotations of a function, in the order of their images. They say nothing that the nodes do not, so functions
/// that differ in them alone are equal.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rotations(pub Vec<Rotation>);

impl PartialEq for Rotations {
    fn eq(&self, _: &Rotations) -> bool {
        true
    }
}

impl Eq for Rotations {}

impl Hash for Rotations {
    fn hash<H: Hasher>(&self, _: &mut H) {}
}

impl Function {
    /// The Lipschitz constant that is promised for the results: between two calls they change by at most this times
    /// the distance of the arguments that are points (of all arguments, where none is a point), while the other
    /// arguments are the same.
    pub fn lipschitz(&self) -> Option<f64> {
        self.lipschitz.map(f64::from_bits)
    }

    /// Whether a call of it counts as an evaluation of a field; see [`cost`](crate::cost).
    pub fn is_evaluation(&self) -> bool {
        self.evaluation.0
    }

    /// Lets calls of it count as evaluations of a field.
    pub fn mark_evaluation(&mut self) {
        self.evaluation.0 = true;
    }

    /// Which values are other values turned, in the order of the images.
    pub fn rotations(&self) -> &[Rotation] {
        &self.rotations.0
    }

    /// The rotation that the value is the image of.
    pub fn rotation_of(&self, image: Value) -> Option<&Rotation> {
        let rotations = self.rotations();
        rotations.binary_search_by_key(&image, |rotation| rotation.image).ok().map(|i| &rotations[i])
    }

    /// The node that a value names.
    pub fn node(&self, value: Value) -> Node {
        self.nodes[value.0 as usize]
    }

    /// The type of a value, or `None` for a tuple.
    pub fn type_of(&self, value: Value) -> Option<Type> {
        self.types[value.0 as usize]
    }

    /// The types of what a node yields: its own, or those of the parts of a tuple. The builder makes all of a
    /// tuple's `Result`s at once, directly behind it.
    pub fn types_of(&self, value: Value) -> Vec<Type> {
        match self.type_of(value) {
            Some(ty) => vec![ty],
            None => (value.0 + 1..self.nodes.len() as u32)
                .map(Value)
                .take_while(|part| matches!(self.node(*part), Node::Result(tuple, _) if tuple == value))
                .map(|part| self.type_of(part).expect("a part of a tuple is no tuple"))
                .collect(),
        }
    }

    /// The name that the source gives a value.
    pub fn name_of(&self, value: Value) -> Option<&Arc<str>> {
        self.names[value.0 as usize].as_ref()
    }

    /// A region.
    pub fn region(&self, region: RegionId) -> &Region {
        &self.regions[region.0 as usize]
    }

    /// The function's own region.
    pub fn root(&self) -> &Region {
        &self.regions[0]
    }

    /// How many regions there are.
    pub fn region_count(&self) -> usize {
        self.regions.len()
    }

    /// How many nodes there are, dead ones included.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The values of a list.
    pub fn list(&self, list: List) -> &[Value] {
        &self.lists[list.start as usize..(list.start + list.len) as usize]
    }

    /// The types of the results.
    pub fn result_types(&self) -> Vec<Type> {
        self.root().results.iter().map(|v| self.type_of(*v).expect("a result is no tuple")).collect()
    }

    /// Calls `visit` with each value that the node uses directly (not with those of the regions that it owns).
    pub fn operands(&self, value: Value, mut visit: impl FnMut(Value)) {
        match self.node(value) {
            Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_) => {}
            Node::Unary(_, a) | Node::Component(a, _) | Node::Result(a, _) | Node::If(a, ..) => visit(a),
            Node::Binary(_, a, b) | Node::Compose2(a, b) => {
                visit(a);
                visit(b);
            }
            Node::Ternary(_, a, b, c) | Node::Compose3(a, b, c) => {
                visit(a);
                visit(b);
                visit(c);
            }
            Node::Call(_, list) | Node::Loop(Loop { initial: list, .. }) => {
                self.list(list).iter().copied().for_each(visit);
            }
        }
    }

    /// The regions that a node owns.
    pub fn owned_regions(&self, value: Value) -> Vec<RegionId> {
        match self.node(value) {
            Node::If(_, a, b) => vec![a, b],
            Node::Loop(Loop { until, next, .. }) => vec![until, next],
            _ => Vec::new(),
        }
    }
}

/// What a uniform is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// Seconds, at least 0. A float.
    Time,
    /// The pointer, 0..1 from the bottom left. A vec2.
    Mouse,
    /// The picture's width and height in pixels. A vec2.
    Resolution,
    /// How the camera is turned about its target: the angles round `up` and towards it, in radians, and the factor of
    /// its distance. A vec3.
    Orbit {
        /// The range of the second angle: up to the poles, where it is known how far they are.
        tilt: (f64, f64),
    },
    /// A setting that decides about accuracy: a named constant in every text, which a reader may change. Its value
    /// is always the default.
    Setting,
    /// A param of the scene, with the ends of its range where it has one.
    Param {
        /// The range of a float, both ends included.
        range: Option<(f64, f64)>,
        /// Whether a vec3 is a colour.
        color: bool,
    },
}

/// A value that is set from outside before a picture is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Uniform {
    /// Its name in the source; printers make it safe.
    pub name: Arc<str>,
    /// Its type.
    pub ty: Type,
    /// What it is for.
    pub role: Role,
    /// Its value where nothing is said.
    pub default: Constant,
}

/// A value that is computed once per frame, from uniforms.
#[derive(Debug, Clone, PartialEq)]
pub struct Global {
    /// The name that the source suggests; printers make it safe and unique.
    pub name: Arc<str>,
    /// Its type.
    pub ty: Type,
}

/// A whole program.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// What is set from outside.
    pub uniforms: Vec<Uniform>,
    /// What `frame` computes: its results, in order.
    pub globals: Vec<Global>,
    /// The function without parameters whose results are the globals. `None` where there are none.
    pub frame: Option<FunctionId>,
    /// The functions, callees before callers.
    pub functions: Vec<Function>,
    /// The function that everything else is there for.
    pub entry: Option<FunctionId>,
    /// Whether all that it measures is so small that hardware takes the squares for zero.
    pub is_tiny: bool,
}

impl Program {
    /// A function.
    pub fn function(&self, id: FunctionId) -> &Function {
        &self.functions[id.0 as usize]
    }

    /// The first function with this name.
    pub fn function_named(&self, name: &str) -> Option<FunctionId> {
        self.functions.iter().position(|f| &*f.name == name).map(|i| FunctionId(i as u32))
    }

    /// The same program in which no function promises a Lipschitz constant: what is proved of it rests on its formulas
    /// alone.
    pub fn without_promises(mut self) -> Program {
        self.functions.iter_mut().for_each(|function| function.lipschitz = None);
        self
    }

    /// Adds a function, which may call those that are there already.
    pub fn add(&mut self, function: Function) -> FunctionId {
        self.functions.push(function);
        FunctionId((self.functions.len() - 1) as u32)
    }
}
