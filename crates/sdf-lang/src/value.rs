//! What an expression can be while a scene is elaborated: numbers (known or not yet), shapes, materials, lists,
//! records and functions.

use rustc_hash::FxHashMap;
use sdf_ir::{Constant, Type};
use sdf_syntax::Span;
use sdf_syntax::tree::{Binding, Block, Dimension, Expr, Function, Lambda, Record};
use std::rc::Rc;
use std::sync::Arc;

/// A bool, float or vector: known at compile time, known once per frame, or a node of a function.
#[derive(Debug, Clone)]
pub(crate) struct Number {
    /// Where it comes from.
    pub repr: Repr,
    /// Its type.
    pub ty: Type,
    /// What tells it from the other numbers that a function takes from outside.
    pub key: u64,
    /// The name that the source gives it.
    pub name: Option<Arc<str>>,
}

/// Where a number comes from.
#[derive(Debug, Clone)]
pub(crate) enum Repr {
    /// Known now.
    Static(Constant),
    /// Known once per frame: a node of the frame function.
    Frame(sdf_ir::Value),
    /// A node of the function that is open at this depth.
    Local(u32, sdf_ir::Value),
    /// A number of the function open at this depth, as the functions inside see it: where they need it, it
    /// becomes a parameter; what they compute from such numbers alone is computed by the caller.
    Outer(u32, Rc<Number>),
}

impl Number {
    /// A number known now.
    pub fn constant(c: Constant) -> Number {
        Number { ty: c.ty(), key: 0, name: None, repr: Repr::Static(c) }
    }

    /// A float known now.
    pub fn float(x: f64) -> Number {
        Number::constant(Constant::Float(x))
    }

    /// Its value, where that is known now, also when a function sees it as a parameter.
    pub fn known(&self) -> Option<Constant> {
        match &self.repr {
            Repr::Static(c) => Some(*c),
            Repr::Outer(_, inner) => inner.known(),
            Repr::Frame(_) | Repr::Local(..) => None,
        }
    }

    /// Whether both are the same value of the same open function.
    pub fn is_same(&self, other: &Number) -> bool {
        match (&self.repr, &other.repr) {
            (Repr::Local(depth, value), Repr::Local(other_depth, other)) => {
                depth == other_depth && value == other
            }
            _ => false,
        }
    }

    /// Whether it depends on the arguments of an open function.
    pub fn is_local(&self) -> bool {
        match &self.repr {
            Repr::Static(_) | Repr::Frame(_) => false,
            Repr::Local(..) => true,
            Repr::Outer(_, inner) => inner.is_local(),
        }
    }

    /// The number, with a name if it has none.
    pub fn named(mut self, name: &Arc<str>) -> Number {
        self.name.get_or_insert_with(|| name.clone());
        self
    }
}

/// Any value.
#[derive(Debug, Clone)]
pub(crate) enum Value<'t> {
    Number(Number),
    Shape(Rc<Shape<'t>>),
    Material(Rc<Material<'t>>),
    List(Rc<List<'t>>),
    Record(Rc<Fields<'t>>),
    Function(Rc<Callable<'t>>),
}

/// What the values inside a value mean for a field that captures it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Traits {
    /// There are shapes or functions inside: a field that captures it is an operator, not a primitive.
    pub shapes: bool,
    /// There is a painted shape inside.
    pub painted: bool,
    /// There is a shape inside whose slope may be above 1.
    pub steep: bool,
    /// There is a number of an open function inside, in records alone.
    pub local: bool,
}

impl Traits {
    pub fn join(self, other: Traits) -> Traits {
        Traits {
            shapes: self.shapes || other.shapes,
            painted: self.painted || other.painted,
            steep: self.steep || other.steep,
            local: self.local || other.local,
        }
    }
}

/// A list with what its elements mean.
#[derive(Debug)]
pub(crate) struct List<'t> {
    pub items: Vec<Value<'t>>,
    pub traits: Traits,
}

/// A record with what its fields mean.
#[derive(Debug)]
pub(crate) struct Fields<'t> {
    pub fields: Vec<(Arc<str>, Value<'t>)>,
    pub traits: Traits,
}

impl<'t> Fields<'t> {
    pub fn get(&self, name: &str) -> Option<&Value<'t>> {
        self.fields.iter().find(|(n, _)| &**n == name).map(|(_, v)| v)
    }
}

impl<'t> Value<'t> {
    pub fn float(x: f64) -> Value<'t> {
        Value::Number(Number::float(x))
    }

    /// Whether it is known to be true.
    pub fn is_true(&self) -> bool {
        matches!(self, Value::Number(n) if n.known() == Some(Constant::Bool(true)))
    }

    pub fn bool(x: bool) -> Value<'t> {
        Value::Number(Number::constant(Constant::Bool(x)))
    }

    pub fn list(items: Vec<Value<'t>>) -> Value<'t> {
        let traits = items.iter().fold(Traits::default(), |t, v| t.join(v.traits()));
        Value::List(Rc::new(List { items, traits }))
    }

    pub fn record(fields: Vec<(Arc<str>, Value<'t>)>) -> Value<'t> {
        let traits = fields.iter().fold(Traits::default(), |t, (_, v)| t.join(v.traits()));
        Value::Record(Rc::new(Fields { fields, traits }))
    }

    pub fn traits(&self) -> Traits {
        match self {
            Value::Number(n) => Traits { local: n.is_local(), ..Traits::default() },
            Value::Material(_) => Traits::default(),
            Value::Shape(s) => Traits { shapes: true, painted: s.painted, steep: s.steep, local: false },
            Value::List(l) => Traits { local: false, ..l.traits },
            Value::Record(r) => r.traits,
            Value::Function(f) => match &**f {
                Callable::Lambda { env, .. } => Traits { shapes: true, local: false, ..env.traits() },
                Callable::Overloads(..) | Callable::Native(_) => Traits { shapes: true, ..Traits::default() },
            },
        }
    }

    /// What it is, for a message.
    pub fn describe(&self) -> String {
        match self {
            Value::Number(n) => describe_type(n.ty).into(),
            Value::Shape(s) if s.dimension == Dimension::Three => "a shape".into(),
            Value::Shape(_) => "a 2D shape".into(),
            Value::Material(_) => "a material".into(),
            Value::List(l) => format!("a list of {}", l.items.len()),
            Value::Record(_) => "a record".into(),
            Value::Function(_) => "a function".into(),
        }
    }
}

/// A type of numbers, for a message.
pub(crate) fn describe_type(ty: Type) -> &'static str {
    match ty {
        Type::Bool => "a bool",
        Type::Float => "a float",
        Type::Vec2 => "a vec2",
        Type::Vec3 => "a vec3",
    }
}

/// A function from a point to a distance.
#[derive(Debug)]
pub(crate) struct Shape<'t> {
    pub dimension: Dimension,
    pub kind: ShapeKind<'t>,
    /// Whether it, or a shape inside, is painted.
    pub painted: bool,
    /// Whether its slope, or that of a shape inside, may be above 1: no contract says that it is not.
    pub steep: bool,
    /// What of the user's file it comes from.
    pub place: Span,
}

/// How a shape is given.
#[derive(Debug)]
pub(crate) enum ShapeKind<'t> {
    /// `field { … }` with the variables round it.
    Field { block: &'t Block, env: Env<'t>, origin: Option<Origin<'t>> },
    /// A shape that the user named, by a `let` or a function: it stays a function of that name.
    Named { name: Arc<str>, span: Span, thunk: Thunk<'t>, inner: Rc<Shape<'t>> },
    /// A shape with a material.
    Painted { shape: Rc<Shape<'t>>, material: Rc<Material<'t>> },
    /// One of two shapes, by a condition that holds for a whole frame or not.
    Choice { condition: Number, then: Rc<Shape<'t>>, otherwise: Rc<Shape<'t>> },
    /// The union of shapes as the scene's own field. Kept apart from `field` so that its parts can be listed.
    Union { shapes: Vec<Rc<Shape<'t>>> },
}

/// The function in whose body a field stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Origin<'t> {
    pub function: &'t Function,
    pub module: Module,
}

/// How to make a named shape once more, with its numbers seen from inside its function.
#[derive(Debug, Clone)]
pub(crate) enum Thunk<'t> {
    /// A `let` of the file or the scene, told apart by its place in memory.
    Let(&'t Binding),
    /// A call of a user's function.
    Call { function: &'t Function, module: Module, arguments: Vec<(Arc<str>, Value<'t>)> },
    /// A shape that is what it is, and what its function does.
    Fixed(&'static str),
}

/// What a surface looks like, as a function of a point.
#[derive(Debug)]
pub(crate) enum Material<'t> {
    /// `material { … }` with the variables round it.
    Record { record: &'t Record, env: Env<'t> },
    /// A colour that stands for a material.
    Color(Number),
}

/// What can be called.
pub(crate) enum Callable<'t> {
    /// `|a| body` with the variables round it.
    Lambda { lambda: &'t Lambda, env: Env<'t> },
    /// All functions of one name in one layer.
    Overloads(Arc<str>, Vec<Candidate<'t>>),
    /// Something of the compiler's own that the renderer calls.
    Native(Rc<Native<'t>>),
}

/// A function of the compiler that the renderer calls, such as the sky.
pub(crate) type Native<'t> = dyn Fn(&mut crate::eval::Elaborator<'t>, crate::call::Given<'t>, Span) -> crate::eval::Eval<Value<'t>>
    + 't;

impl std::fmt::Debug for Callable<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Callable::Lambda { .. } => f.write_str("lambda"),
            Callable::Overloads(name, _) => f.write_str(name),
            Callable::Native(_) => f.write_str("native"),
        }
    }
}

/// One of the functions of a name.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Candidate<'t> {
    /// Written in the language.
    Written(&'t Function, Module),
    /// Built in.
    BuiltIn(&'static crate::builtin::BuiltIn),
}

/// Whose names a piece of source sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Module {
    /// The standard library: itself and the built-ins.
    Library,
    /// The renderer: itself and the library.
    Runtime,
    /// A file of the user's: itself, what it imports, and the library. The root file has number 0.
    User(u16),
}

impl Module {
    /// The file that is compiled.
    pub const ROOT: Module = Module::User(0);

    /// Whether it is a file of the user's.
    pub fn is_user(self) -> bool {
        matches!(self, Module::User(_))
    }
}

/// The variables round an expression: a chain from the innermost outwards, then a module's items.
#[derive(Debug, Clone)]
pub(crate) struct Env<'t> {
    pub module: Module,
    scope: Option<Rc<Scope<'t>>>,
}

#[derive(Debug)]
struct Scope<'t> {
    name: Arc<str>,
    value: Value<'t>,
    parent: Option<Rc<Scope<'t>>>,
    traits: Traits,
    /// How many variables there are, this one included.
    depth: usize,
    chunk: Option<Chunk<'t>>,
}

/// A variable and those behind it, looked up at once: ten thousand variables would make a long walk.
#[derive(Debug)]
struct Chunk<'t> {
    values: FxHashMap<Arc<str>, Value<'t>>,
    /// What follows behind them.
    parent: Option<Rc<Scope<'t>>>,
}

/// How many variables a chunk has.
const CHUNK: usize = 64;

impl<'t> Chunk<'t> {
    /// The variable and those behind it, up to the next chunk.
    fn new(name: &Arc<str>, value: &Value<'t>, parent: &Option<Rc<Scope<'t>>>) -> Chunk<'t> {
        let mut values = FxHashMap::from_iter([(name.clone(), value.clone())]);
        let mut rest = parent;
        while let Some(scope) = rest.as_ref().filter(|scope| scope.chunk.is_none()) {
            values.entry(scope.name.clone()).or_insert_with(|| scope.value.clone());
            rest = &scope.parent;
        }
        Chunk { values, parent: rest.clone() }
    }
}

impl<'t> Env<'t> {
    /// Nothing but a module's items.
    pub fn new(module: Module) -> Env<'t> {
        Env { module, scope: None }
    }

    /// With one more variable, the innermost.
    pub fn bind(&self, name: Arc<str>, value: Value<'t>) -> Env<'t> {
        let traits = self.traits().join(value.traits());
        let parent = self.scope.clone();
        let depth = parent.as_ref().map_or(0, |scope| scope.depth) + 1;
        let chunk = depth.is_multiple_of(CHUNK).then(|| Chunk::new(&name, &value, &parent));
        Env { module: self.module, scope: Some(Rc::new(Scope { name, value, parent, traits, depth, chunk })) }
    }

    /// The same variables with what becomes of their values.
    pub fn map(&self, change: impl Fn(&Arc<str>, Value<'t>) -> Value<'t>) -> Env<'t> {
        self.variables().into_iter().fold(Env::new(self.module), |env, (name, value)| {
            let value = change(&name, value);
            env.bind(name, value)
        })
    }

    /// The innermost variable, by its place in memory, which tells the variables from others.
    pub fn place(&self) -> *const () {
        self.scope.as_ref().map_or(std::ptr::null(), |scope| Rc::as_ptr(scope).cast())
    }

    /// The innermost variable of this name.
    pub fn get(&self, name: &str) -> Option<&Value<'t>> {
        let mut scope = self.scope.as_deref();
        while let Some(s) = scope {
            if &*s.name == name {
                return Some(&s.value);
            }
            scope = match &s.chunk {
                Some(chunk) => match chunk.values.get(name) {
                    Some(value) => return Some(value),
                    None => chunk.parent.as_deref(),
                },
                None => s.parent.as_deref(),
            };
        }
        None
    }

    /// What all its variables mean together.
    pub fn traits(&self) -> Traits {
        self.scope.as_ref().map_or(Traits::default(), |s| s.traits)
    }

    /// The variables, from the outermost.
    pub fn variables(&self) -> Vec<(Arc<str>, Value<'t>)> {
        let mut out = Vec::new();
        let mut scope = self.scope.as_deref();
        while let Some(s) = scope {
            out.push((s.name.clone(), s.value.clone()));
            scope = s.parent.as_deref();
        }
        out.reverse();
        out
    }
}

/// Whether an expression uses a name, so that what costs something can be left out.
pub(crate) fn mentions(expr: &Expr, name: &str) -> bool {
    crate::walk::any_name(expr, &mut |n| n == name)
}
