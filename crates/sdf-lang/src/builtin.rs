//! The functions that are not written in the language: arithmetic, and what reaches into the compiler.

use crate::call::{Slot, SlotKind};
use crate::context::Op;
use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::surface::Column;
use crate::value::{Callable, Number, Repr, Shape, ShapeKind, Value};
use sdf_ir::{Binary, Constant, Ternary, Type, Unary};
use sdf_syntax::Span;
use sdf_syntax::tree::TypeKind;
use std::rc::Rc;

/// What a built-in function does with its arguments, which fit its parameters.
pub(crate) type Run = for<'t> fn(&mut Elaborator<'t>, &[Option<Value<'t>>], Span) -> Eval<Value<'t>>;

/// A built-in function.
pub(crate) struct BuiltIn {
    pub name: &'static str,
    parameters: &'static [(&'static str, SlotKind)],
    /// Whether the last parameter takes any number of arguments.
    variadic: bool,
    /// How many of the last parameters may be left out.
    optional: usize,
    pub run: Run,
}

impl std::fmt::Debug for BuiltIn {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl BuiltIn {
    pub fn slots(&self) -> Vec<Slot<'static>> {
        let n = self.parameters.len();
        self.parameters
            .iter()
            .enumerate()
            .map(|(i, (name, kind))| Slot {
                name,
                kind: *kind,
                variadic: self.variadic && i + 1 == n,
                optional: i + self.optional >= n,
            })
            .collect()
    }
}

/// The names of the constants that every file sees.
pub(crate) const CONSTANTS: [&str; 7] = ["pi", "tau", "x", "y", "z", "time", "mouse"];

/// All built-in functions.
pub(crate) fn all() -> &'static [BuiltIn] {
    FUNCTIONS
}

/// Whether a call of this name is plain arithmetic, so that computing it for nothing costs little.
pub(crate) fn is_cheap(name: &str) -> bool {
    FUNCTIONS.iter().any(|b| b.name == name && !matches!(b.parameters, [(_, SlotKind::Type(_)), ..]))
}

const NUMERIC: SlotKind = SlotKind::Numeric;
const VECTOR: SlotKind = SlotKind::Vector;
const FLOAT: SlotKind = SlotKind::Type(TypeKind::Float);
const VEC3: SlotKind = SlotKind::Type(TypeKind::Vec3);
const LIST: SlotKind = SlotKind::Type(TypeKind::List);
const FN: SlotKind = SlotKind::Type(TypeKind::Fn);
const SHAPE: SlotKind = SlotKind::Type(TypeKind::Shape);
const SHAPE2: SlotKind = SlotKind::Type(TypeKind::Shape2);
const VEC2: SlotKind = SlotKind::Type(TypeKind::Vec2);

/// A function of one number that is one operation.
macro_rules! unary {
    ($name:literal, $op:ident) => {
        unary!($name, $op, NUMERIC)
    };
    ($name:literal, $op:ident, $kind:expr) => {
        BuiltIn {
            name: $name,
            parameters: &[("x", $kind)],
            variadic: false,
            optional: 0,
            run: |e, a, span| {
                let x = number(a, 0);
                e.unary(Unary::$op, &x, span).map(Value::Number)
            },
        }
    };
}

/// A function of two numbers that is one operation.
macro_rules! binary {
    ($name:literal, $op:ident, $a:literal, $b:literal, $kind:expr) => {
        BuiltIn {
            name: $name,
            parameters: &[($a, $kind), ($b, $kind)],
            variadic: false,
            optional: 0,
            run: |e, a, span| {
                let (x, y) = (number(a, 0), number(a, 1));
                let (x, y) = e.same_type(&x, &y, span)?;
                e.binary(Binary::$op, &x, &y, span).map(Value::Number)
            },
        }
    };
}

const fn function(name: &'static str, parameters: &'static [(&'static str, SlotKind)], run: Run) -> BuiltIn {
    BuiltIn { name, parameters, variadic: false, optional: 0, run }
}

/// A function whose last argument may be left out.
const fn with_default(
    name: &'static str,
    parameters: &'static [(&'static str, SlotKind)],
    run: Run,
) -> BuiltIn {
    BuiltIn { name, parameters, variadic: false, optional: 1, run }
}

const fn variadic(name: &'static str, parameters: &'static [(&'static str, SlotKind)], run: Run) -> BuiltIn {
    BuiltIn { name, parameters, variadic: true, optional: 0, run }
}

static FUNCTIONS: &[BuiltIn] = &[
    unary!("abs", Abs),
    unary!("sign", Sign),
    unary!("floor", Floor),
    unary!("ceil", Ceil),
    unary!("round", Round),
    unary!("trunc", Trunc),
    unary!("sqrt", Sqrt),
    unary!("exp", Exp),
    unary!("exp2", Exp2),
    unary!("log", Log),
    unary!("log2", Log2),
    unary!("sin", Sin),
    unary!("cos", Cos),
    unary!("tan", Tan),
    unary!("asin", Asin),
    unary!("acos", Acos),
    unary!("atan", Atan),
    unary!("tanh", Tanh),
    unary!("length", Length, VECTOR),
    unary!("normalize", Normalize, VECTOR),
    unary!("hash", Hash),
    binary!("atan", Atan2, "y", "x", NUMERIC),
    binary!("pow", Power, "x", "y", NUMERIC),
    binary!("dot", Dot, "a", "b", VECTOR),
    binary!("cross", Cross, "a", "b", VEC3),
    function("fract", &[("x", NUMERIC)], |e, a, span| {
        let x = number(a, 0);
        let whole = e.unary(Unary::Floor, &x, span)?;
        e.binary(Binary::Subtract, &x, &whole, span).map(Value::Number)
    }),
    variadic("min", &[("values", NUMERIC)], |e, a, span| reduce(e, a, Binary::Min, span)),
    variadic("max", &[("values", NUMERIC)], |e, a, span| reduce(e, a, Binary::Max, span)),
    variadic("sum", &[("values", NUMERIC)], |e, a, span| reduce(e, a, Binary::Add, span)),
    function("clamp", &[("x", NUMERIC), ("low", NUMERIC), ("high", NUMERIC)], |e, a, span| {
        let low = e.binary(Binary::Max, &number(a, 0), &number(a, 1), span)?;
        e.binary(Binary::Min, &low, &number(a, 2), span).map(Value::Number)
    }),
    function("mix", &[("a", NUMERIC), ("b", NUMERIC), ("t", NUMERIC)], |e, a, span| {
        let t = number(a, 2);
        let (x, y) = e.same_type(&number(a, 0), &number(a, 1), span)?;
        let ty = if t.ty == Type::Float { x.ty } else { x.ty.max(t.ty) };
        let (x, y) = (e.widen(&x, ty, span)?, e.widen(&y, ty, span)?);
        let mixed = e.contexts.apply(Op::Ternary(Ternary::Mix), &[x, y, t]);
        e.finite(mixed, span).map(Value::Number)
    }),
    function("step", &[("edge", NUMERIC), ("x", NUMERIC)], |e, a, span| {
        let (edge, x) = e.same_type(&number(a, 0), &number(a, 1), span)?;
        e.by_component(&[edge, x], |e, c| {
            let below = e.binary(Binary::Less, &c[1], &c[0], span)?;
            Ok(e.contexts
                .apply(Op::Ternary(Ternary::Select), &[below, Number::float(0.0), Number::float(1.0)]))
        })
    }),
    function("smoothstep", &[("low", NUMERIC), ("high", NUMERIC), ("x", NUMERIC)], |e, a, span| {
        let (low, high) = e.same_type(&number(a, 0), &number(a, 1), span)?;
        let (low, x) = e.same_type(&low, &number(a, 2), span)?;
        let high = e.widen(&high, low.ty, span)?;
        e.by_component(&[low, high, x], |e, c| smoothstep(e, c, span))
    }),
    function("distance", &[("a", VECTOR), ("b", VECTOR)], |e, a, span| {
        let between = e.binary(Binary::Subtract, &number(a, 0), &number(a, 1), span)?;
        e.unary(Unary::Length, &between, span).map(Value::Number)
    }),
    function("reflect", &[("v", VECTOR), ("n", VECTOR)], |e, a, span| {
        let (v, n) = (number(a, 0), number(a, 1));
        let along = e.binary(Binary::Dot, &v, &n, span)?;
        let twice = e.binary(Binary::Multiply, &along, &Number::float(2.0), span)?;
        let back = e.binary(Binary::Multiply, &n, &twice, span)?;
        e.binary(Binary::Subtract, &v, &back, span).map(Value::Number)
    }),
    BuiltIn {
        name: "rotated",
        parameters: &[("image", VECTOR), ("v", VECTOR), ("angle", FLOAT), ("axis", VEC3)],
        variadic: false,
        optional: 1,
        run: |e, a, _| {
            let (image, v, angle) = (number(a, 0), number(a, 1), number(a, 2));
            let axis = a[3].is_some().then(|| number(a, 3));
            e.contexts.mark_rotation(&image, &v, axis.as_ref(), &angle);
            Ok(Value::Number(image))
        },
    },
    function("refract", &[("v", VECTOR), ("n", VECTOR), ("eta", FLOAT)], refract),
    function("len", &[("list", LIST)], |_, a, _| match &a[0] {
        Some(Value::List(l)) => Ok(Value::float(l.items.len() as f64)),
        _ => unreachable!("fits"),
    }),
    function("map", &[("list", LIST), ("f", FN)], |e, a, span| {
        let (Some(Value::List(list)), Some(f)) = (&a[0], &a[1]) else { unreachable!("fits") };
        let rounds = list.items.iter().enumerate();
        let items: Eval<Vec<_>> = rounds
            .map(|(i, v)| e.round(i, list.items.len(), |e| e.call_function(f, vec![v.clone()], span)))
            .collect();
        Ok(Value::list(items?))
    }),
    function("fold", &[("list", LIST), ("first", SlotKind::Any), ("f", FN)], |e, a, span| {
        let (Some(Value::List(list)), Some(first), Some(f)) = (&a[0], &a[1], &a[2]) else {
            unreachable!("fits")
        };
        list.items.iter().enumerate().try_fold(first.clone(), |acc, (i, v)| {
            e.round(i, list.items.len(), |e| e.call_function(f, vec![acc, v.clone()], span))
        })
    }),
    with_default(
        "iterate",
        &[("n", FLOAT), ("first", SlotKind::Any), ("next", FN), ("until", FN)],
        |e, a, span| e.iterate(a, span),
    ),
    function("paint", &[("s", SHAPE), ("m", SlotKind::Type(TypeKind::Material))], |e, a, span| {
        let (Some(Value::Shape(shape)), Some(material)) = (&a[0], &a[1]) else { unreachable!("fits") };
        let material = match material {
            Value::Material(m) => m.clone(),
            Value::Number(n) => Rc::new(crate::value::Material::Color(e.widen(n, Type::Vec3, span)?)),
            _ => unreachable!("fits"),
        };
        let kind = ShapeKind::Painted { shape: shape.clone(), material };
        Ok(Value::Shape(Rc::new(Shape {
            dimension: shape.dimension,
            kind,
            painted: true,
            steep: shape.steep,
            place: shape.place,
        })))
    }),
    function("outlined", &[("s", SHAPE)], |e, a, _| {
        let Some(Value::Shape(shape)) = &a[0] else { unreachable!("fits") };
        Ok(e.outlined(&shape.clone()))
    }),
    function("gradient", &[("s", SHAPE), ("p", VEC3)], |e, a, span| {
        let Some(Value::Shape(shape)) = &a[0] else { unreachable!("fits") };
        let point = e.widen(&number(a, 1), Type::Vec3, span)?;
        e.gradient(shape, &point, span)
    }),
    function("approach", &[("s", SHAPE), ("p", VEC3)], |e, a, span| {
        let Some(Value::Shape(shape)) = &a[0] else { unreachable!("fits") };
        let point = e.widen(&number(a, 1), Type::Vec3, span)?;
        e.approach(shape, &point, span)
    }),
    function("stride", &[("s", SHAPE), ("p", VEC3)], |e, a, span| {
        let Some(Value::Shape(shape)) = &a[0] else { unreachable!("fits") };
        let point = e.widen(&number(a, 1), Type::Vec3, span)?;
        e.stride(shape, &point, span).map(Value::Number)
    }),
    with_default("lo", &[("s", SHAPE), ("level", FLOAT)], |e, a, span| {
        e.corner_of(a, span, |extent| extent.lo)
    }),
    with_default("lo", &[("s", SHAPE2), ("level", FLOAT)], |e, a, span| {
        e.corner_of(a, span, |extent| extent.lo)
    }),
    with_default("hi", &[("s", SHAPE), ("level", FLOAT)], |e, a, span| {
        e.corner_of(a, span, |extent| extent.hi)
    }),
    with_default("hi", &[("s", SHAPE2), ("level", FLOAT)], |e, a, span| {
        e.corner_of(a, span, |extent| extent.hi)
    }),
    function("reach", &[("s", SHAPE), ("axis", VEC3)], |e, a, span| e.reach_of(a, span)),
    function("slope", &[("f", SlotKind::Any)], |e, a, span| e.slope_value(a, span)),
    function("most", &[("x", FLOAT)], |e, a, span| e.most_of(a, span)),
    function("any_cell", &[("first", VEC3), ("last", VEC3)], |e, a, span| e.any_cell(a, span)),
    function("is_even", &[("s", SHAPE), ("axis", VEC3), ("middle", FLOAT)], |e, a, span| {
        e.is_even_about(a, span)
    }),
    function("is_even", &[("s", SHAPE2), ("axis", VEC3), ("middle", FLOAT)], |e, a, span| {
        e.is_even_about(a, span)
    }),
    with_default("turned", &[("s", SHAPE), ("axis", VEC3), ("angle", FLOAT)], |e, a, span| {
        e.turned_box(a, span)
    }),
    with_default("turned", &[("s", SHAPE2), ("angle", FLOAT)], |e, a, span| e.turned_box_in_plane(a, span)),
    function("mirrored", &[("s", SHAPE), ("axis", VEC3), ("offset", FLOAT)], |e, a, span| {
        e.mirrored_box(a, Type::Vec3, span)
    }),
    function("mirrored", &[("s", SHAPE2), ("axis", VEC2), ("offset", FLOAT)], |e, a, span| {
        e.mirrored_box(a, Type::Vec2, span)
    }),
    function("reflected", &[("s", SHAPE), ("axis", VEC3)], |e, a, span| e.reflected_box(a, Type::Vec3, span)),
    function("reflected", &[("s", SHAPE2), ("axis", VEC2)], |e, a, span| {
        e.reflected_box(a, Type::Vec2, span)
    }),
    function("surface", &[("s", SHAPE), ("p", VEC3), ("n", VEC3)], |e, a, span| {
        surface(e, &Column::OF_SURFACE, a, span)
    }),
    function("patterned", &[("s", SHAPE), ("p", VEC3), ("n", VEC3)], |e, a, span| {
        surface(e, &[Column::Pattern], a, span)
    }),
    function("seams", &[("s", SHAPE), ("p", VEC3), ("width", FLOAT)], |e, a, span| {
        let (Some(Value::Shape(shape)), point, width) = (&a[0], number(a, 1), number(a, 2)) else {
            unreachable!("fits")
        };
        e.seams(shape, &point, &width, span)
    }),
    function("surrounding", &[("s", SHAPE), ("p", VEC3), ("n", VEC3)], |e, a, span| {
        surface(e, &Column::OF_GLOW, a, span)
    }),
    function("properties", &[("s", SHAPE), ("p", VEC3), ("n", VEC3)], |e, a, span| {
        surface(e, &Column::ALL, a, span)
    }),
];

/// Whether a lambda uses a number that is not known yet.
fn mentions_dynamic(function: &Value<'_>) -> bool {
    let Value::Function(callable) = function else { return false };
    let Callable::Lambda { lambda, env } = &**callable else { return false };
    crate::walk::any_name(
        &lambda.body,
        &mut |name| matches!(env.get(name), Some(Value::Number(n)) if n.known().is_none()),
    )
}

/// The properties of a shape's material at a point where the normal is known.
fn surface<'t>(
    e: &mut Elaborator<'t>,
    asked: &[Column],
    arguments: &[Option<Value<'t>>],
    span: Span,
) -> Eval<Value<'t>> {
    let Some(Value::Shape(shape)) = &arguments[0] else { unreachable!("fits") };
    let point = e.widen(&number(arguments, 1), Type::Vec3, span)?;
    let normal = e.widen(&number(arguments, 2), Type::Vec3, span)?;
    e.surface(asked, shape, &point, &normal, span)
}

/// The number that the argument at `index` is.
pub(crate) fn number(arguments: &[Option<Value<'_>>], index: usize) -> Number {
    match &arguments[index] {
        Some(Value::Number(n)) => n.clone(),
        _ => unreachable!("the parameter takes numbers"),
    }
}

fn reduce<'t>(
    e: &mut Elaborator<'t>,
    arguments: &[Option<Value<'t>>],
    op: Binary,
    span: Span,
) -> Eval<Value<'t>> {
    let Some(Value::List(list)) = &arguments[0] else { unreachable!("a variadic parameter is a list") };
    let mut numbers = list.items.iter().map(|v| match v {
        Value::Number(n) => n.clone(),
        _ => unreachable!("the parameter takes numbers"),
    });
    let first = match (numbers.next(), op) {
        (Some(first), _) => first,
        (None, Binary::Add) => Number::float(0.0),
        (None, Binary::Min) => Number::float(sdf_ir::number::LARGEST),
        (None, _) => Number::float(-sdf_ir::number::LARGEST),
    };
    numbers.try_fold(first, |acc, n| e.binary(op, &acc, &n, span)).map(Value::Number)
}

/// `t*t*(3 - 2*t)` of where x lies between the edges; with equal edges a step.
fn smoothstep<'t>(e: &mut Elaborator<'t>, c: &[Number], span: Span) -> Eval<Number> {
    let (low, high, x) = (&c[0], &c[1], &c[2]);
    if let (Some(a), Some(b)) = (low.known(), high.known())
        && a == b
    {
        let below = e.binary(Binary::Less, x, low, span)?;
        return Ok(e
            .contexts
            .apply(Op::Ternary(Ternary::Select), &[below, Number::float(0.0), Number::float(1.0)]));
    }
    let from = e.binary(Binary::Subtract, x, low, span)?;
    let width = e.binary(Binary::Subtract, high, low, span)?;
    let t = e.binary(Binary::Divide, &from, &width, span)?;
    let t = e.binary(Binary::Max, &t, &Number::float(0.0), span)?;
    let t = e.binary(Binary::Min, &t, &Number::float(1.0), span)?;
    let twice = e.binary(Binary::Multiply, &t, &Number::float(2.0), span)?;
    let slope = e.binary(Binary::Subtract, &Number::float(3.0), &twice, span)?;
    let square = e.binary(Binary::Multiply, &t, &t, span)?;
    e.binary(Binary::Multiply, &square, &slope, span)
}

/// GLSL's: zero on total reflection.
fn refract<'t>(e: &mut Elaborator<'t>, a: &[Option<Value<'t>>], span: Span) -> Eval<Value<'t>> {
    let (v, n, eta) = (number(a, 0), number(a, 1), number(a, 2));
    let cosine = e.binary(Binary::Dot, &n, &v, span)?;
    let square = e.binary(Binary::Multiply, &cosine, &cosine, span)?;
    let sine2 = e.binary(Binary::Subtract, &Number::float(1.0), &square, span)?;
    let eta2 = e.binary(Binary::Multiply, &eta, &eta, span)?;
    let scaled = e.binary(Binary::Multiply, &eta2, &sine2, span)?;
    let k = e.binary(Binary::Subtract, &Number::float(1.0), &scaled, span)?;
    let total = e.binary(Binary::Less, &k, &Number::float(0.0), span)?;
    let root = e.unary(Unary::Sqrt, &k, span)?;
    let along = e.binary(Binary::Multiply, &eta, &cosine, span)?;
    let along = e.binary(Binary::Add, &along, &root, span)?;
    let straight = e.binary(Binary::Multiply, &v, &eta, span)?;
    let bent = e.binary(Binary::Multiply, &n, &along, span)?;
    let out = e.binary(Binary::Subtract, &straight, &bent, span)?;
    let zero = e.widen(&Number::float(0.0), out.ty, span)?;
    Ok(Value::Number(e.contexts.apply(Op::Ternary(Ternary::Select), &[total, zero, out])))
}

impl<'t> Elaborator<'t> {
    /// Two numbers of one type, a float being widened.
    pub fn same_type(&mut self, a: &Number, b: &Number, span: Span) -> Eval<(Number, Number)> {
        let ty = a.ty.max(b.ty);
        Ok((self.widen(a, ty, span)?, self.widen(b, ty, span)?))
    }

    /// A function of floats on each component of vectors of one type.
    fn by_component(
        &mut self,
        vectors: &[Number],
        mut f: impl FnMut(&mut Self, &[Number]) -> Eval<Number>,
    ) -> Eval<Value<'t>> {
        let mut parts = Vec::new();
        for i in 0..vectors[0].ty.size() {
            let components: Vec<Number> = vectors.iter().map(|v| self.component(v, i)).collect();
            parts.push(f(self, &components)?);
        }
        Ok(Value::Number(match &parts[..] {
            [one] => one.clone(),
            parts => self.contexts.apply(Op::Compose, parts),
        }))
    }

    /// `iterate(n, first, |i, s| next, until: |s| condition)`: the loop that runs in the shader.
    fn iterate(&mut self, arguments: &[Option<Value<'t>>], span: Span) -> Eval<Value<'t>> {
        let (Some(first), Some(next)) = (&arguments[1], &arguments[2]) else { unreachable!("fits") };
        let Some((n, limit)) = self.contexts.rounds(&number(arguments, 0)) else {
            return self.report(errors::not_static(span, "the number of rounds"));
        };
        if n < 0.0 || n.fract() != 0.0 || n > 65_536.0 {
            return self.report(errors::out_of_range(
                span,
                "the number of rounds",
                "a whole number from 0 to 65536",
            ));
        }
        let (template, initial) = self.flatten(first, span)?;
        // Inside a loop that runs in the shader each trial would be made twice for each loop round it.
        let is_tried = !self.in_loop || !mentions_dynamic(next);
        if is_tried
            && limit.is_none()
            && initial.iter().all(|n| n.known().is_some())
            && let Some(last) = self.iterate_now(n as u32, &template, next, arguments[3].as_ref(), span)?
        {
            return Ok(last);
        }
        let values: Vec<_> = initial.iter().map(|n| self.contexts.value(n)).collect();
        let types: Vec<Type> = initial.iter().map(|n| n.ty).collect();

        let until_region = self.contexts.builder().open_region(&types);
        let state = self.region_state(&template, until_region, 0, &initial);
        let stop = match &arguments[3] {
            Some(until) => {
                self.call_function(until, vec![state], span).and_then(|v| self.as_typed(v, Type::Bool, span))
            }
            None => Ok(Number::constant(Constant::Bool(false))),
        };
        let stop_value = stop.as_ref().map(|n| self.contexts.value(n));
        self.contexts.builder().close_region(stop_value.into_iter().collect());

        let mut next_types = vec![Type::Float];
        next_types.extend(&types);
        let next_region = self.contexts.builder().open_region(&next_types);
        let round = self.region_argument(next_region, 0, Type::Float);
        let state = self.region_state(&template, next_region, 1, &initial);
        let was_in_loop = std::mem::replace(&mut self.in_loop, true);
        let after = self
            .call_function(next, vec![Value::Number(round), state], span)
            .and_then(|v| self.like(&template, &v, span));
        self.in_loop = was_in_loop;
        let after_values: Vec<_> = after.iter().flatten().map(|n| self.contexts.value(n)).collect();
        self.contexts.builder().close_region(after_values);
        stop?;
        after?;
        let results =
            self.contexts.builder().repeat_to((n as u32, limit), &values, until_region, next_region);
        self.unflatten(&template, &results)
    }

    /// The last state of a loop, where it is known now.
    fn iterate_now(
        &mut self,
        rounds: u32,
        first: &Value<'t>,
        next: &Value<'t>,
        until: Option<&Value<'t>>,
        span: Span,
    ) -> Eval<Option<Value<'t>>> {
        let mut state = first.clone();
        for round in 0..rounds {
            if let Some(until) = until {
                let stop = self.call_function(until, vec![state.clone()], span)?;
                match self.as_typed(stop, Type::Bool, span)?.known() {
                    Some(Constant::Bool(true)) => break,
                    Some(_) => {}
                    None => return Ok(None),
                }
            }
            let round = Value::float(f64::from(round));
            let was_in_loop = std::mem::replace(&mut self.in_loop, true);
            let after = self.call_function(next, vec![round, state], span);
            self.in_loop = was_in_loop;
            let after = after?;
            let numbers = self.like(first, &after, span)?;
            if numbers.iter().any(|n| n.known().is_none()) {
                return Ok(None);
            }
            state = crate::eval::rebuild(first, &mut numbers.into_iter());
        }
        Ok(Some(state))
    }

    fn region_argument(&mut self, region: sdf_ir::RegionId, index: usize, ty: Type) -> Number {
        let depth = self.contexts.depth();
        let value = self.contexts.builder().argument(region, index as u16);
        self.contexts.local(depth, value, ty)
    }

    fn region_state(
        &mut self,
        template: &Value<'t>,
        region: sdf_ir::RegionId,
        skip: usize,
        initial: &[Number],
    ) -> Value<'t> {
        let numbers: Vec<Number> = initial
            .iter()
            .enumerate()
            .map(|(i, before)| {
                let argument = self.region_argument(region, i + skip, before.ty);
                if let (Some(name), Repr::Local(_, node) | Repr::Frame(node)) = (&before.name, &argument.repr)
                {
                    self.contexts.builder().name(*node, name);
                }
                argument
            })
            .collect();
        crate::eval::rebuild(template, &mut numbers.into_iter())
    }

    /// The numbers of a value that must have the form and types of `template`.
    pub fn like(&mut self, template: &Value<'t>, value: &Value<'t>, span: Span) -> Eval<Vec<Number>> {
        match (template, value) {
            (Value::Number(t), Value::Number(n)) => Ok(vec![self.widen(n, t.ty, span)?]),
            (Value::Record(t), Value::Record(v)) => {
                let mut out = Vec::new();
                for (name, part) in &t.fields {
                    let Some(new) = v.get(name) else {
                        return self.report(errors::no_member(span, name, "the next state", None));
                    };
                    out.extend(self.like(part, new, span)?);
                }
                if let Some((name, _)) = v.fields.iter().find(|(name, _)| t.get(name).is_none()) {
                    return self.report(errors::no_member(span, name, "the first state", None));
                }
                Ok(out)
            }
            (Value::List(t), Value::List(v)) if t.items.len() == v.items.len() => {
                let mut out = Vec::new();
                for (part, new) in t.items.iter().zip(&v.items) {
                    out.extend(self.like(part, new, span)?);
                }
                Ok(out)
            }
            (t, v) => {
                let (expected, found) = (t.describe(), v.describe());
                self.report(errors::wrong_type(span, &expected, &found))
            }
        }
    }
}
