//! What differs between the two languages, as data for the one printer.

use crate::expression::{Expression, Level};
use sdf_ir::Type;

/// A language.
pub(crate) struct Dialect {
    /// The types in the order of [`Type`].
    types: [&'static str; 4],
    /// The rounding function that takes the even one of two.
    pub round: &'static str,
    /// The floating-point type, as a conversion.
    pub float: &'static str,
    /// `x` of type `ty` as a parameter, a member or a variable.
    pub declare: fn(ty: &str, x: &str) -> String,
    /// A value with a name.
    pub bind: fn(ty: &str, x: &str, value: &str) -> String,
    /// A variable of the function, with its first value.
    pub variable: fn(ty: &str, x: &str, value: Option<&str>) -> String,
    /// A variable of the program.
    pub global: fn(ty: &str, x: &str) -> String,
    /// The head of a function, up to its body.
    pub function: fn(name: &str, parameters: &str, result: Option<&str>) -> String,
    /// What ends a member of a structure, and what ends the structure.
    pub structure: (&'static str, &'static str),
    /// The head of a loop of `count` rounds.
    pub counted: fn(counter: &str, count: &str) -> String,
    /// A signed whole number, which also makes one of a float.
    pub int: &'static str,
    /// `a` of a type if `c` holds, else `b`; both languages may compute both.
    pub select: fn(ty: Type, c: &Expression, a: &Expression, b: &Expression) -> Expression,
    /// The bit-level helpers' texts.
    pub bits: &'static crate::bits::Texts,
}

impl Dialect {
    /// A type's name, which also makes values of it.
    pub fn ty(&self, ty: Type) -> &'static str {
        self.types[match ty {
            Type::Bool => 0,
            Type::Float => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
        }]
    }
}

/// GLSL, as 300 es and 450 both read it.
pub(crate) static GLSL: Dialect = Dialect {
    types: ["bool", "float", "vec2", "vec3"],
    round: "roundEven",
    float: "float",
    declare: |ty, x| format!("{ty} {x}"),
    bind: |ty, x, value| format!("{ty} {x} = {value};"),
    variable: |ty, x, value| match value {
        Some(value) => format!("{ty} {x} = {value};"),
        None => format!("{ty} {x};"),
    },
    global: |ty, x| format!("{ty} {x};"),
    function: |name, parameters, result| format!("{} {name}({parameters})", result.unwrap_or("void")),
    structure: (";", "};"),
    int: "int",
    counted: |i, count| format!("for (int {i} = ZERO; {i} < {count}; {i}++)"),
    // `c ? a : b` is a branch for some compilers, and many branches take SwiftShader, Chromium's driver where there is no
    // graphics device, minutes or more.
    select: |ty, c, a, b| {
        let every = |vector: &str| Expression::call(vector, std::slice::from_ref(c));
        let which = match ty {
            Type::Bool => {
                let [c, a, b] = [c, a, b].map(|x| x.at_least(Level::Or));
                return Expression { text: format!("{c} ? {a} : {b}"), level: Level::Conditional };
            }
            Type::Float => c.clone(),
            Type::Vec2 => every("bvec2"),
            Type::Vec3 => every("bvec3"),
        };
        Expression::call("mix", &[b.clone(), a.clone(), which])
    },
    bits: &crate::bits::GLSL,
};

/// WGSL.
pub(crate) static WGSL: Dialect = Dialect {
    types: ["bool", "f32", "vec2f", "vec3f"],
    round: "round",
    float: "f32",
    declare: |ty, x| format!("{x}: {ty}"),
    bind: |_, x, value| format!("let {x} = {value};"),
    variable: |ty, x, value| match value {
        Some(value) => format!("var {x} = {value};"),
        None => format!("var {x}: {ty};"),
    },
    global: |ty, x| format!("var<private> {x}: {ty};"),
    function: |name, parameters, result| match result {
        Some(result) => format!("fn {name}({parameters}) -> {result}"),
        None => format!("fn {name}({parameters})"),
    },
    structure: (",", "}"),
    int: "i32",
    counted: |i, count| format!("for (var {i} = 0; {i} < {count}; {i}++)"),
    select: |_, c, a, b| Expression::call("select", &[b.clone(), a.clone(), c.clone()]),
    bits: &crate::bits::WGSL,
};
