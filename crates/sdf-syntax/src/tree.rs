//! The tree of a `.sdf` file: what the parser makes and the checker reads.
//!
//! Chains of operators and of postfix operations are lists and not nested nodes, so that the depth of a tree
//! is bounded by the nesting that the source shows (which the parser limits), never by its length.

use crate::span::Span;
use std::sync::Arc;

/// A name as written, with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Name {
    /// The identifier.
    pub text: Arc<str>,
    /// Where it stands.
    pub span: Span,
}

/// A whole file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct File {
    /// The items, in the order of the source.
    pub items: Vec<Item>,
}

/// One item with what stands before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// The `///` lines before it, joined by line breaks, without the slashes and one space.
    pub docs: String,
    /// The attributes before it.
    pub attributes: Vec<Attribute>,
    /// The item.
    pub kind: ItemKind,
    /// From its keyword to its end.
    pub span: Span,
}

/// `@name(arguments)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    /// `exact`, `bound`, `lipschitz`, `bounds`, `convex` or `requires`; the parser takes any name.
    pub name: Name,
    /// What stands in the parentheses.
    pub arguments: Vec<AttributeArgument>,
    /// The whole attribute.
    pub span: Span,
}

/// One argument of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum AttributeArgument {
    /// An expression.
    Expr(Expr),
    /// A string, as the message of `@requires`.
    Text(String, Span),
}

/// The kinds of items.
#[derive(Debug, Clone, PartialEq)]
pub enum ItemKind {
    /// `import "path"`.
    Import {
        /// The path as written.
        path: String,
        /// The place of the string.
        span: Span,
    },
    /// `param name = default in low..high`.
    Param {
        /// Its name.
        name: Name,
        /// The default.
        default: Expr,
        /// The range, where one is written.
        range: Option<(Expr, Expr)>,
    },
    /// `let name = value`.
    Let(Binding),
    /// `fn name(parameters) = body`.
    Fn(Arc<Function>),
    /// `material name { … }`.
    Material(Name, Record),
    /// `light name { … }`.
    Light(Name, Record),
    /// `camera { … }` and its like.
    Settings(SettingsKind, Record),
    /// `scene { … }`.
    Scene(Scene),
}

/// The blocks of settings that have no name of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SettingsKind {
    /// `camera`
    Camera,
    /// `ambient`
    Ambient,
    /// `sky`
    Sky,
    /// `fog`
    Fog,
    /// `rim`
    Rim,
    /// `render`
    Render,
}

/// `let name = value`, in a file, a block or a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    /// The name.
    pub name: Name,
    /// The value.
    pub value: Expr,
}

/// A named function.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// The name.
    pub name: Name,
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// The body: an expression, or a block as an expression.
    pub body: Expr,
}

/// A parameter of a function or lambda.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The name.
    pub name: Name,
    /// `name...`: takes any number of arguments, as a list.
    pub variadic: bool,
    /// `name: type`.
    pub ty: Option<TypeName>,
    /// `name = default`.
    pub default: Option<Expr>,
}

/// A type as a parameter states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TypeName {
    /// Which.
    pub kind: TypeKind,
    /// Where it stands.
    pub span: Span,
}

/// The types that a parameter can state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TypeKind {
    /// `float`
    Float,
    /// `vec2`
    Vec2,
    /// `vec3`
    Vec3,
    /// `bool`
    Bool,
    /// `shape`
    Shape,
    /// `shape2`
    Shape2,
    /// `material`
    Material,
    /// `list`
    List,
    /// `fn`
    Fn,
}

impl TypeKind {
    /// All of them.
    pub const ALL: [TypeKind; 9] = [
        TypeKind::Float,
        TypeKind::Vec2,
        TypeKind::Vec3,
        TypeKind::Bool,
        TypeKind::Shape,
        TypeKind::Shape2,
        TypeKind::Material,
        TypeKind::List,
        TypeKind::Fn,
    ];

    /// The type as written.
    pub fn word(self) -> &'static str {
        match self {
            TypeKind::Float => "float",
            TypeKind::Vec2 => "vec2",
            TypeKind::Vec3 => "vec3",
            TypeKind::Bool => "bool",
            TypeKind::Shape => "shape",
            TypeKind::Shape2 => "shape2",
            TypeKind::Material => "material",
            TypeKind::List => "list",
            TypeKind::Fn => "fn",
        }
    }
}

/// `scene { let … shapes }`.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The `let`s that open it.
    pub bindings: Vec<Binding>,
    /// The shapes.
    pub shapes: Vec<Expr>,
    /// The whole block.
    pub span: Span,
}

/// `{ name: value, … }`, or `( name: value, … )` as a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// The fields, in the order of the source.
    pub fields: Vec<Field>,
    /// From bracket to bracket.
    pub span: Span,
}

/// `name: value`.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The name.
    pub name: Name,
    /// The value.
    pub value: Expr,
}

/// `{ let a = …; result }`. The `;` after a `let` is optional where the next begins with a keyword.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// The `let`s.
    pub bindings: Vec<Binding>,
    /// The value of the block.
    pub result: Expr,
}

/// An expression with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of expressions.
#[derive(Debug, Clone, PartialEq)]
pub enum ExprKind {
    /// A number; units are already applied (`180deg` is π).
    Number(f64),
    /// A colour, in linear light.
    Color([f64; 3]),
    /// `true` or `false`.
    Bool(bool),
    /// A name.
    Name(Arc<str>),
    /// `(a, b)` or longer; `(a)` only groups and `()` is an error.
    Tuple(Vec<Expr>),
    /// `(a: 1, b: 2)`.
    Record(Record),
    /// `[a, b]`.
    List(Vec<Expr>),
    /// `{ … }`.
    Block(Box<Block>),
    /// `field { … }` or `field2 { … }`.
    Shape(Dimension, Box<Block>),
    /// `material { … }` as an expression.
    Material(Record),
    /// `if c { … } else { … }`; an `else if` is an `If` as the only result of `otherwise`.
    If {
        /// The condition.
        condition: Box<Expr>,
        /// The value where it holds.
        then: Box<Block>,
        /// The value where it does not.
        otherwise: Box<Block>,
    },
    /// `for name in list { … }`.
    For {
        /// The name of the element.
        name: Name,
        /// The list.
        list: Box<Expr>,
        /// The value for each element.
        body: Box<Block>,
    },
    /// `|a, b| body`.
    Lambda(Arc<Lambda>),
    /// `-a`, `!a`.
    Unary(UnaryOp, Box<Expr>),
    /// `first op a op b …`: operators of one level of precedence, from left to right.
    Chain {
        /// The first operand.
        first: Box<Expr>,
        /// The operators with their places, and what stands to their right. Never empty.
        rest: Vec<(BinaryOp, Span, Expr)>,
    },
    /// `base.a(…).b[c](…)`: the operations from left to right. Never empty.
    Postfix {
        /// What the first is applied to.
        base: Box<Expr>,
        /// The operations.
        operations: Vec<Postfix>,
    },
    /// What could not be parsed; an error has been reported.
    Error,
}

/// `|parameters| body`.
#[derive(Debug, Clone, PartialEq)]
pub struct Lambda {
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// The body.
    pub body: Expr,
}

/// One postfix operation with its place (from its `(`, `.` or `[` to its end).
#[derive(Debug, Clone, PartialEq)]
pub struct Postfix {
    /// What it is.
    pub kind: PostfixKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of postfix operations.
#[derive(Debug, Clone, PartialEq)]
pub enum PostfixKind {
    /// `(arguments)`.
    Call(Vec<Argument>),
    /// `.name(arguments)`.
    Method(Name, Vec<Argument>),
    /// `.name`: a swizzle or a field of a record.
    Member(Name),
    /// `[index]`.
    Index(Expr),
}

/// An argument of a call.
#[derive(Debug, Clone, PartialEq)]
pub struct Argument {
    /// `name: value`.
    pub name: Option<Name>,
    /// The value.
    pub value: Expr,
}

/// The dimension of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// `field`: a solid.
    Three,
    /// `field2`: an area of the plane.
    Two,
}

/// Prefix operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    /// `-`
    Negate,
    /// `!`
    Not,
}

/// Infix operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `%`
    Modulo,
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `&`
    Intersection,
    /// `|`
    Union,
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
    /// `&&`
    And,
    /// `||`
    Or,
    /// `..`
    Range,
}

impl BinaryOp {
    /// The operator as written.
    pub fn symbol(self) -> &'static str {
        match self {
            BinaryOp::Multiply => "*",
            BinaryOp::Divide => "/",
            BinaryOp::Modulo => "%",
            BinaryOp::Add => "+",
            BinaryOp::Subtract => "-",
            BinaryOp::Intersection => "&",
            BinaryOp::Union => "|",
            BinaryOp::Less => "<",
            BinaryOp::LessEqual => "<=",
            BinaryOp::Greater => ">",
            BinaryOp::GreaterEqual => ">=",
            BinaryOp::Equal => "==",
            BinaryOp::NotEqual => "!=",
            BinaryOp::And => "&&",
            BinaryOp::Or => "||",
            BinaryOp::Range => "..",
        }
    }
}
