//! Shapes at points: which of them are functions of the program, and their gradients.

use crate::context::Op;
use crate::errors;
use crate::eval::{Elaborator, Eval, Reported, name_shape};
use crate::facts::shapes_in;
use crate::value::{Env, Module, Number, Origin, Repr, Shape, ShapeKind, Thunk, Value};
use sdf_ir::Type;
use sdf_syntax::Span;
use sdf_syntax::tree::{Block, Dimension};
use std::rc::Rc;
use std::sync::Arc;

/// How many shapes that have a name in the source stay functions of it. A reader looks at no more, and validators take
/// time by the square of the number of functions.
const MOST_NAMED: usize = 1500;

impl<'t> Elaborator<'t> {
    /// The distance from a point to a shape. While the materials of the field round it are looked up, the
    /// sample is noted down.
    pub fn sample(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        let Some(mut samples) = self.samples.take() else {
            return self.distance(shape, point, span);
        };
        let distance = self.outside_formula(point, |this| this.distance(shape, point, span));
        let result = distance.map(|d| self.note_sample(&mut samples, shape, point, d));
        self.samples = Some(samples);
        result
    }

    /// Runs `f` in the function round the formula whose shares are being found, where the point allows it.
    fn outside_formula<T>(&mut self, point: &Number, f: impl FnOnce(&mut Self) -> T) -> T {
        if self.contexts.is_innermost(point) {
            return f(self);
        }
        let formula = self.contexts.set_aside();
        let result = f(self);
        self.contexts.take_up(formula);
        result
    }

    /// The distance from a point to a shape, which nothing notes down.
    pub fn plain_distance(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        self.distance(shape, point, span)
    }

    /// The distance from a point to a shape.
    fn distance(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        match &shape.kind {
            ShapeKind::Painted { shape, .. } => self.distance(shape, point, span),
            ShapeKind::Union { shapes } => self.union_distance(shapes, point, span),
            ShapeKind::Choice { condition, then, otherwise } => {
                self.chosen_distance(condition, [then, otherwise], point, span)
            }
            ShapeKind::Named { inner, .. } if !point.is_local() => {
                let errors_before = self.diagnostics.len();
                let distance = self.distance(inner, point, span);
                if distance.is_ok() || !self.is_rendering() {
                    return distance;
                }
                // The renderer asked at a point that is known, as the eye is: what is wrong only there, a
                // division by zero for example, is no mistake of the scene.
                self.diagnostics.truncate(errors_before);
                let point = self.as_local(point);
                self.distance(shape, &point, span)
            }
            ShapeKind::Named { thunk: Thunk::Let(_) | Thunk::Call { .. }, inner, .. }
                if self.is_remote(inner)? =>
            {
                self.distance(inner, point, span)
            }
            ShapeKind::Named { name, span: place, thunk, inner } => {
                self.named_distance(name, *place, thunk, inner, point, span)
            }
            ShapeKind::Field { block, env, origin } => match origin {
                Some(origin) if point.is_local() && !env.traits().shapes && !self.is_remote(shape)? => {
                    self.primitive_distance(block, env, origin, point)
                }
                _ => self.field_value(block, env, point),
            },
        }
    }

    /// `outlined(s)`: the shape as a function of its own, for what samples it at several points. What is one primitive,
    /// moved perhaps, is that already, and so is what the user named.
    pub fn outlined(&mut self, shape: &Rc<Shape<'t>>) -> Value<'t> {
        if is_outlined(shape) {
            return Value::Shape(shape.clone());
        }
        let thunk = Thunk::Fixed("The distance from a point to the shape of which there are copies.");
        name_shape(Value::Shape(shape.clone()), &Arc::from("copy"), shape.place, thunk)
    }

    pub fn union_distance(&mut self, shapes: &[Rc<Shape<'t>>], point: &Number, span: Span) -> Eval<Number> {
        let mut nearest: Option<Number> = None;
        for shape in shapes {
            let d = self.sample(shape, point, span)?;
            nearest = Some(match nearest {
                None => d,
                Some(before) => self.binary(sdf_ir::Binary::Min, &before, &d, span)?,
            });
        }
        Ok(nearest.unwrap_or(Number::float(crate::NOTHING)))
    }

    pub fn chosen_distance(
        &mut self,
        condition: &Number,
        [then, otherwise]: [&Rc<Shape<'t>>; 2],
        point: &Number,
        span: Span,
    ) -> Eval<Number> {
        let a = self.sample(then, point, span)?;
        let b = self.sample(otherwise, point, span)?;
        Ok(self.contexts.apply(Op::Ternary(sdf_ir::Ternary::Select), &[condition.clone(), a, b]))
    }

    /// The value of a field's block, written into the caller.
    pub fn field_value(&mut self, block: &'t Block, env: &Env<'t>, point: &Number) -> Eval<Number> {
        let env = env.bind(Arc::from("p"), Value::Number(point.clone()));
        match self.block(block, &env)? {
            Value::Number(n) if n.ty == Type::Float => Ok(n),
            other => {
                let found = other.describe();
                self.report(errors::not_a_distance(block.result.span, &found))
            }
        }
    }

    /// A field that samples no other shape is a function of its point and of the numbers that it captures.
    fn primitive_distance(
        &mut self,
        block: &'t Block,
        env: &Env<'t>,
        origin: &Origin<'t>,
        point: &Number,
    ) -> Eval<Number> {
        let name = function_name(origin);
        let line = self.line(origin.function.name.span);
        self.contexts.open(&name, line);
        self.contexts.describe(self.names.summary_of(origin.function, origin.module));
        let inner_point = self.contexts.parameter(&Arc::from("p"), point, true);
        let mut inside = Env::new(env.module);
        for (name, value) in env.variables() {
            let value = self.seen_from_inside(&name, &value);
            inside = inside.bind(name, value);
        }
        let result = self.field_value(block, &inside, &inner_point);
        self.close_distance(result)
    }

    /// A shape that the user named is a function of that name.
    fn named_distance(
        &mut self,
        name: &Arc<str>,
        place: Span,
        thunk: &Thunk<'t>,
        inner: &Rc<Shape<'t>>,
        point: &Number,
        span: Span,
    ) -> Eval<Number> {
        let key = match thunk {
            Thunk::Let(binding) => Some(std::ptr::from_ref(*binding).cast::<()>()),
            Thunk::Fixed(_) => Some(Rc::as_ptr(inner).cast::<()>()),
            Thunk::Call { .. } => None,
        };
        let key = key.filter(|_| !self.contexts.frame_calls());
        if let Some(id) = key.and_then(|k| self.shape_functions.get(&k)) {
            let id = *id;
            let point = self.contexts.value(point);
            return Ok(self.contexts.call(id, &[Type::Float], &[point]).remove(0));
        }
        if matches!(thunk, Thunk::Let(_)) && self.shape_functions.len() >= MOST_NAMED {
            return self.distance(inner, point, span);
        }
        let line = self.line(place);
        self.contexts.open(name, line);
        if let Thunk::Fixed(what) = thunk {
            self.contexts.describe(Some(Arc::from(*what)));
        }
        let inner_point = self.contexts.parameter(&Arc::from("p"), point, true);
        let result =
            self.shape_from_inside(thunk, inner).and_then(|s| self.body_of_named(&s, &inner_point, span));
        let distance = self.close_distance(result)?;
        if let (Some(key), Some(id)) = (key, self.contexts.is_call_at(&distance, point)) {
            self.shape_functions.insert(key, id);
        }
        Ok(distance)
    }

    /// The shape once more, with the numbers of its call as its function sees them.
    fn shape_from_inside(&mut self, thunk: &Thunk<'t>, inner: &Rc<Shape<'t>>) -> Eval<Rc<Shape<'t>>> {
        let Thunk::Call { function, module, arguments } = thunk else { return Ok(inner.clone()) };
        let inside: Vec<_> =
            arguments.iter().map(|(name, v)| (name.clone(), self.seen_from_inside(name, v))).collect();
        let value = self.evaluate_body(function, *module, &inside)?;
        self.as_shape(value, function.name.span)
    }

    /// What stands in the function of a named shape: its field, without a second function for a primitive.
    fn body_of_named(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        match &shape.kind {
            ShapeKind::Field { block, env, origin: Some(origin) } if origin.module.is_user() => {
                self.field_value(block, env, point)
            }
            ShapeKind::Painted { shape, .. } => self.body_of_named(shape, point, span),
            _ => self.distance(shape, point, span),
        }
    }

    /// Closes the innermost function with a distance as its result. One that does not depend on the function's
    /// arguments needs no function.
    fn close_distance(&mut self, result: Eval<Number>) -> Eval<Number> {
        match result {
            Ok(n) => {
                let template = Value::Number(n.clone());
                let distance = match self.close_with(&Arc::from("distance"), &template, vec![n]) {
                    Value::Number(n) => Number { name: None, ..n },
                    _ => unreachable!("a number comes back as one"),
                };
                self.check_operations(&distance)?;
                Ok(distance)
            }
            Err(Reported) => {
                self.contexts.discard();
                Err(Reported)
            }
        }
    }

    /// `gradient(s, p)`: a record of the distance and its gradient.
    pub fn gradient(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Value<'t>> {
        if shape.dimension == Dimension::Two {
            return self.report(errors::wrong_type(span, "a shape", "a 2D shape"));
        }
        let in_frame = self.contexts.depth() == 0;
        if in_frame {
            self.contexts.set_frame_calls(true);
        }
        let result = self.asking(|this| this.gradient_here(shape, point, span));
        if in_frame {
            self.contexts.set_frame_calls(false);
        }
        let (found, asked) = result?;
        if asked
            && !self.is_plane_beside(shape)?
            && let Value::Record(record) = &found
            && let Some(Value::Number(distance)) = record.get("distance")
        {
            let point = self.as_local(point);
            self.count_evaluation(distance, &point);
        }
        Ok(found)
    }

    fn gradient_here(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Value<'t>> {
        let point = self.as_local(point);
        let distance = self.distance(shape, &point, span)?;
        let (id, arguments) = match self.contexts.call_of(&distance, &point) {
            Some(call) => call,
            None => {
                self.contexts.open(&Arc::from("field_value"), None);
                let inside = self.contexts.parameter(&Arc::from("p"), &point, true);
                match self.distance(shape, &inside, span) {
                    Ok(d) => {
                        let d = self.contexts.value(&d);
                        self.contexts.finish(vec![(d, Arc::from("distance"))])
                    }
                    Err(Reported) => {
                        self.contexts.discard();
                        return Err(Reported);
                    }
                }
            }
        };
        let gradient = self.gradients.of(&mut self.contexts.program, id);
        let results = self.contexts.call(gradient, &[Type::Float, Type::Vec3], &arguments);
        let names = ["distance", "gradient"];
        Ok(Value::record(
            names.into_iter().zip(results).map(|(n, v)| (Arc::from(n), Value::Number(v))).collect(),
        ))
    }

    /// Whether what is being evaluated is the renderer's, in a function of the program.
    pub fn is_rendering(&self) -> bool {
        self.contexts.depth() > 0 && self.origins.last().is_some_and(|o| o.module == Module::Runtime)
    }

    /// A point as a node of the innermost function.
    fn as_local(&mut self, point: &Number) -> Number {
        if point.is_local() || self.contexts.depth() == 0 {
            return point.clone();
        }
        let value = self.contexts.value(point);
        Number { repr: Repr::Local(self.contexts.depth(), value), ..point.clone() }
    }
}

fn is_outlined(shape: &Shape<'_>) -> bool {
    match &shape.kind {
        ShapeKind::Named { .. } => true,
        ShapeKind::Painted { shape, .. } => is_outlined(shape),
        ShapeKind::Choice { .. } => false,
        ShapeKind::Union { shapes } => matches!(&shapes[..], [one] if is_outlined(one)),
        ShapeKind::Field { env, origin, .. } => match &shapes_in(env)[..] {
            [] => origin.is_some(),
            [one] => origin.is_some_and(|o| !o.module.is_user()) && is_outlined(one),
            _ => false,
        },
    }
}

/// A primitive of the library is `sd_name`; one of the user keeps its name.
fn function_name(origin: &Origin<'_>) -> Arc<str> {
    match origin.module {
        Module::User(_) => origin.function.name.text.clone(),
        Module::Library | Module::Runtime => Arc::from(format!("sd_{}", origin.function.name.text)),
    }
}
