//! Calls: which function is meant, which argument is which parameter, and what the call gives.

use crate::context::{Contexts, Op};
use crate::errors;
use crate::eval::{Elaborator, Eval, Reported};
use crate::evaluations::is_of_renderer;
use crate::library;
use crate::outline;
use crate::value::{Callable, Candidate, Env, Module, Number, Origin, Shape, ShapeKind, Thunk, Value};
use sdf_ir::Type;
use sdf_syntax::Span;
use sdf_syntax::tree::{Argument, Dimension, ExprKind, Function, Lambda, Name, Parameter, TypeKind};
use std::rc::Rc;
use std::sync::Arc;

/// How many expressions a function of the program counts for, which costs as much time as them.
const CALL_WORK: usize = 16;

/// The arguments of a call, evaluated.
pub(crate) struct Given<'t> {
    /// What stands before the `.` of a method.
    pub receiver: Option<Value<'t>>,
    pub positional: Vec<Value<'t>>,
    pub named: Vec<(&'t Name, Value<'t>)>,
}

impl<'t> Given<'t> {
    pub fn positional(values: Vec<Value<'t>>) -> Given<'t> {
        Given { receiver: None, positional: values, named: Vec::new() }
    }

    pub fn describe(&self) -> String {
        let mut parts: Vec<String> =
            self.receiver.iter().chain(&self.positional).map(Value::describe).collect();
        parts.extend(self.named.iter().map(|(n, v)| format!("`{}`: {}", n.text, v.describe())));
        match &parts[..] {
            [] => "no arguments".into(),
            [one] => one.clone(),
            [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
        }
    }
}

/// How a call fits a function: what each parameter takes (`None`: its default), and how many were widened.
pub(crate) struct Fit<'t> {
    pub arguments: Vec<Option<Value<'t>>>,
    pub widened: u32,
}

/// A parameter of a written or built-in function, as far as calls see it.
pub(crate) struct Slot<'a> {
    pub name: &'a str,
    pub kind: SlotKind,
    pub variadic: bool,
    pub optional: bool,
}

/// What a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SlotKind {
    /// Anything.
    Any,
    /// A stated type.
    Type(TypeKind),
    /// A float or vector.
    Numeric,
    /// A vec2 or vec3.
    Vector,
}

impl<'t> Elaborator<'t> {
    /// The values of arguments; all are evaluated, so that all mistakes in them are found.
    fn given(
        &mut self,
        receiver: Option<Value<'t>>,
        arguments: &'t [Argument],
        env: &Env<'t>,
    ) -> Eval<Given<'t>> {
        let mut given = Given { receiver, positional: Vec::new(), named: Vec::new() };
        let mut failed = false;
        for argument in arguments {
            match (self.eval(&argument.value, env), &argument.name) {
                (Ok(value), None) => given.positional.push(value),
                (Ok(value), Some(name)) => given.named.push((name, value)),
                (Err(Reported), _) => failed = true,
            }
        }
        if failed { Err(Reported) } else { Ok(given) }
    }

    /// `name(arguments)` where no variable has that name.
    pub fn call_by_name(
        &mut self,
        name: &Arc<str>,
        name_span: Span,
        arguments: &'t [Argument],
        env: &Env<'t>,
        span: Span,
    ) -> Eval<Value<'t>> {
        let candidates = self.overloads(name, env.module, name_span)?;
        if candidates.is_empty() {
            let callee = self.global(name, env.module, name_span);
            let given = self.given(None, arguments, env);
            return self.apply_value(callee?, given?, span);
        }
        let given = self.given(None, arguments, env)?;
        self.call_overloads(name, &candidates, given, span)
    }

    /// A call of a value.
    pub fn call_value(
        &mut self,
        callee: Value<'t>,
        arguments: &'t [Argument],
        env: &Env<'t>,
        span: Span,
    ) -> Eval<Value<'t>> {
        let given = self.given(None, arguments, env)?;
        self.apply_value(callee, given, span)
    }

    /// `receiver.name(arguments)`.
    pub fn method(
        &mut self,
        receiver: Value<'t>,
        name: &'t Name,
        arguments: &'t [Argument],
        env: &Env<'t>,
        span: Span,
    ) -> Eval<Value<'t>> {
        if let Value::Record(record) = &receiver
            && let Some(field) = record.get(&name.text)
        {
            let field = field.clone();
            return self.call_value(field, arguments, env, span);
        }
        if let Some(local @ (Value::Function(_) | Value::Shape(_))) = env.get(&name.text) {
            let local = local.clone();
            let given = self.given(Some(receiver), arguments, env)?;
            return self.apply_value(local, given, span);
        }
        if self.names.is_value(&name.text, env.module) {
            let item = self.global(&name.text, env.module, name.span)?;
            if matches!(item, Value::Function(_) | Value::Shape(_)) {
                let given = self.given(Some(receiver), arguments, env)?;
                return self.apply_value(item, given, span);
            }
        }
        let candidates = self.methods(&name.text, env.module, name.span)?;
        if candidates.is_empty() {
            let _ = self.given(None, arguments, env);
            return self.unknown_method(&receiver, name, env.module);
        }
        let given = self.given(Some(receiver), arguments, env)?;
        self.call_overloads(&name.text, &candidates, given, span)
    }

    fn unknown_method(&mut self, receiver: &Value<'t>, name: &Name, module: Module) -> Eval<Value<'t>> {
        if let Value::Record(record) = receiver {
            let fields = record.fields.iter().map(|(field, _)| &**field);
            if let Some(similar) = sdf_syntax::did_you_mean(&name.text, fields) {
                let help = format!("did you mean `{similar}`?");
                return self.report(errors::no_member(name.span, &name.text, "this record", Some(help)));
            }
        }
        let diagnostic = self.names.unknown_function(&name.text, name.span, module);
        self.report_unknown(diagnostic, module)
    }

    /// A call with arguments that are values already.
    pub fn apply_value(&mut self, callee: Value<'t>, given: Given<'t>, span: Span) -> Eval<Value<'t>> {
        match callee {
            Value::Shape(shape) => {
                // Inside a function the scene as a whole has been allowed already.
                if self.contexts.depth() == 0 {
                    self.check_size(&Value::Shape(shape.clone()), span)?;
                }
                let point = self.point_argument(&shape, given, span)?;
                if is_of_renderer(&shape) {
                    return self.sample(&shape, &point, span).map(Value::Number);
                }
                let (distance, asked) = self.asking(|this| this.sample(&shape, &point, span))?;
                if asked {
                    self.count_evaluation(&distance, &point);
                }
                Ok(Value::Number(distance))
            }
            Value::Function(callable) => match &*callable {
                Callable::Lambda { lambda, env } => self.call_lambda(lambda, env, given, span),
                Callable::Overloads(name, candidates) => self.call_overloads(name, candidates, given, span),
                Callable::Native(run) => run(self, given, span),
            },
            other => {
                let found = other.describe();
                self.report(errors::not_callable(span, &found))
            }
        }
    }

    /// A call of a function value with positional arguments.
    pub fn call_function(
        &mut self,
        callee: &Value<'t>,
        arguments: Vec<Value<'t>>,
        span: Span,
    ) -> Eval<Value<'t>> {
        self.apply_value(callee.clone(), Given::positional(arguments), span)
    }

    /// A call of the library's function for an operator on shapes.
    pub fn call_named(&mut self, name: &str, arguments: Vec<Value<'t>>, span: Span) -> Eval<Value<'t>> {
        let candidates = self.overloads(name, Module::Library, span)?;
        self.call_overloads(&Arc::from(name), &candidates, Given::positional(arguments), span)
    }

    /// The point at which a shape is called.
    fn point_argument(
        &mut self,
        shape: &crate::value::Shape<'t>,
        given: Given<'t>,
        span: Span,
    ) -> Eval<Number> {
        let (ty, kind) = match shape.dimension {
            Dimension::Three => (Type::Vec3, TypeKind::Vec3),
            Dimension::Two => (Type::Vec2, TypeKind::Vec2),
        };
        let slot = [Slot { name: "p", kind: SlotKind::Type(kind), variadic: false, optional: false }];
        let signature = format!("shape(p: {})", if ty == Type::Vec3 { "vec3" } else { "vec2" });
        match fit(&mut self.contexts, &slot, &given) {
            Ok(fit) => match fit.arguments.into_iter().next().flatten() {
                Some(Value::Number(n)) => self.widen(&n, ty, span),
                _ => self.report(errors::no_fit(span, "shape", &given.describe(), "", &[signature])),
            },
            Err(why) => self.report(errors::no_fit(span, "shape", &given.describe(), &why, &[signature])),
        }
    }

    /// The one function of several that a call means.
    fn call_overloads(
        &mut self,
        name: &Arc<str>,
        candidates: &[Candidate<'t>],
        given: Given<'t>,
        span: Span,
    ) -> Eval<Value<'t>> {
        let mut fits = Vec::new();
        let mut reasons = Vec::new();
        for candidate in candidates {
            let slots = slots(candidate);
            match fit(&mut self.contexts, &slots, &given) {
                Ok(f) => fits.push((*candidate, f)),
                Err(why) => reasons.push(why),
            }
        }
        let best = fits.iter().map(|(_, f)| f.widened).min();
        let exact = fits.iter().filter(|(_, f)| f.widened == 0).count();
        let chosen = match (fits.len(), exact) {
            (0, _) => {
                let signatures: Vec<String> = candidates.iter().map(|c| signature(name, &slots(c))).collect();
                let named =
                    reasons.iter().find(|why| why.contains("is named") || why.contains("did you mean"));
                let named = named.cloned();
                let why = named
                    .unwrap_or_else(|| if reasons.len() == 1 { reasons.remove(0) } else { String::new() });
                return self.report(errors::no_fit(span, name, &given.describe(), &why, &signatures));
            }
            (1, _) => 0,
            (_, 1) => fits.iter().position(|(_, f)| Some(f.widened) == best).expect("one is exact"),
            _ => {
                let signatures: Vec<String> =
                    fits.iter().map(|(c, _)| format!("`{}`", signature(name, &slots(c)))).collect();
                return self.report(errors::ambiguous(span, name, &signatures));
            }
        };
        let (candidate, fit) = fits.swap_remove(chosen);
        self.call_candidate(candidate, fit, span)
    }

    fn call_candidate(&mut self, candidate: Candidate<'t>, fit: Fit<'t>, span: Span) -> Eval<Value<'t>> {
        match candidate {
            Candidate::BuiltIn(b) => (b.run)(self, &fit.arguments, span),
            Candidate::Written(function, module) => {
                let called = self.called;
                if !crate::library::is_ours(span.file) {
                    // Its arguments have been evaluated: what happens from now on comes from the whole call.
                    self.place = span;
                    self.called = Some(&function.name.text);
                }
                let value = self
                    .complete(function, module, fit.arguments, span)
                    .and_then(|arguments| self.call_written(function, module, arguments, span));
                self.called = called;
                value
            }
        }
    }

    /// Widens arguments to the parameters' types and fills in defaults, which may use earlier parameters.
    fn complete(
        &mut self,
        function: &'t Function,
        module: Module,
        arguments: Vec<Option<Value<'t>>>,
        span: Span,
    ) -> Eval<Vec<(Arc<str>, Value<'t>)>> {
        let mut env = Env::new(module);
        let mut out = Vec::new();
        for (parameter, argument) in function.parameters.iter().zip(arguments) {
            let value = match (argument, &parameter.default) {
                (Some(value), _) => value,
                (None, Some(default)) => self.eval(default, &env)?,
                (None, None) => Value::list(Vec::new()),
            };
            let value = self.adapt(value, parameter)?;
            let name = parameter.name.text.clone();
            env = env.bind(name.clone(), value.clone());
            out.push((name, value));
        }
        let names = self.names;
        self.require(names.contract_of(function, module), &env, span)?;
        Ok(out)
    }

    /// A float where a vector is stated becomes one; a colour where a material is stated becomes one.
    fn adapt(&mut self, value: Value<'t>, parameter: &'t Parameter) -> Eval<Value<'t>> {
        match (parameter.ty.map(|t| t.kind), &value) {
            (Some(TypeKind::Vec2), Value::Number(n)) => {
                self.widen(n, Type::Vec2, parameter.name.span).map(Value::Number)
            }
            (Some(TypeKind::Vec3), Value::Number(n)) => {
                self.widen(n, Type::Vec3, parameter.name.span).map(Value::Number)
            }
            (Some(TypeKind::Material), Value::Number(n)) => {
                let color = self.widen(n, Type::Vec3, parameter.name.span)?;
                Ok(Value::Material(Rc::new(crate::value::Material::Color(color))))
            }
            _ => Ok(value),
        }
    }

    /// A call of a function that is written in the language.
    fn call_written(
        &mut self,
        function: &'t Function,
        module: Module,
        arguments: Vec<(Arc<str>, Value<'t>)>,
        span: Span,
    ) -> Eval<Value<'t>> {
        let place = std::ptr::from_ref(function).cast::<()>();
        if !module.is_user() {
            // The library's are called with new arguments each time, but for what is asked of a function.
            if !asks_of_functions(&arguments) {
                return self.call_afresh(function, module, &arguments, span);
            }
            let inert = |this: &mut Self| this.inert_parameters(function);
            return self.once(place, None, &arguments, inert, |this| {
                this.call_afresh(function, module, &arguments, span)
            });
        }
        if let Some(shape) = self.known_shape(place, &arguments)
            && let ShapeKind::Named { name, span, inner, .. } = &shape.kind
        {
            let thunk = Thunk::Call { function, module, arguments };
            let kind = ShapeKind::Named { name: name.clone(), span: *span, thunk, inner: inner.clone() };
            return Ok(Value::Shape(Rc::new(Shape { kind, ..*shape })));
        }
        let inert = |this: &mut Self| this.inert_parameters(function);
        self.once(place, None, &arguments, inert, |this| {
            let value = this.call_afresh(function, module, &arguments, span)?;
            let thunk = Thunk::Call { function, module, arguments: arguments.clone() };
            Ok(crate::eval::name_shape(value, &function.name.text, function.name.span, thunk))
        })
    }

    /// A call that is carried out whether or not it was before.
    pub fn call_afresh(
        &mut self,
        function: &'t Function,
        module: Module,
        arguments: &[(Arc<str>, Value<'t>)],
        span: Span,
    ) -> Eval<Value<'t>> {
        let place = std::ptr::from_ref(function).cast::<()>();
        self.enter(place, span, Some(&function.name.text))?;
        let outlined = match self.is_outlined(function, module, arguments) {
            true => self.call_outlined(function, module, arguments),
            false => None,
        };
        let result = outlined.unwrap_or_else(|| self.evaluate_body(function, module, arguments));
        self.leave(place);
        result
    }

    /// The value of a function's body with these arguments.
    pub fn evaluate_body(
        &mut self,
        function: &'t Function,
        module: Module,
        arguments: &[(Arc<str>, Value<'t>)],
    ) -> Eval<Value<'t>> {
        let mut env = Env::new(module);
        for (name, value) in arguments {
            env = env.bind(name.clone(), value.clone());
        }
        self.origins.push(Origin { function, module });
        let result = self.eval(&function.body, &env);
        self.origins.pop();
        result
    }

    fn is_outlined(
        &self,
        function: &'t Function,
        module: Module,
        arguments: &[(Arc<str>, Value<'t>)],
    ) -> bool {
        // A formula whose samples are being found must be seen whole; where it is only bounded, what samples nothing
        // may stay a function, for the sake of what that promises.
        let samples_nothing = || !arguments.iter().any(|(_, v)| v.traits().shapes);
        (self.samples.is_none() || (self.facts.takes_apart && samples_nothing()))
            && outline::stays_a_function(function, module)
            && !self.not_outlined.contains(&std::ptr::from_ref(function))
            && arguments.iter().any(|(_, v)| outline::has_local_number(v))
    }

    /// The call as a call of a function of the program, or `None` where the result is no number.
    fn call_outlined(
        &mut self,
        function: &'t Function,
        module: Module,
        arguments: &[(Arc<str>, Value<'t>)],
    ) -> Option<Eval<Value<'t>>> {
        self.work += CALL_WORK;
        let line = self.line(function.name.span);
        self.contexts.open(&function.name.text, line);
        self.contexts.describe(self.names.summary_of(function, module));
        let inside: Vec<_> =
            arguments.iter().map(|(name, v)| (name.clone(), self.seen_from_inside(name, v))).collect();
        let errors_before = self.diagnostics.len();
        let promised = self.promised_slope(function, module, &inside);
        self.contexts.builder().set_lipschitz(promised);
        let value = match self.evaluate_body(function, module, &inside) {
            Ok(value) => value,
            Err(Reported) => {
                self.contexts.discard();
                return Some(Err(Reported));
            }
        };
        let Ok((template, numbers)) = self.flatten(&value, function.name.span) else {
            // The result is a shape, a list or a function: such a function only exists at compile time.
            self.diagnostics.truncate(errors_before);
            self.contexts.discard();
            self.not_outlined.insert(std::ptr::from_ref(function));
            return None;
        };
        Some(Ok(self.close_with(&function.name.text, &template, numbers)))
    }

    /// Closes the innermost function with the numbers of a value as its results, and gives the call's value.
    /// What does not depend on the function's arguments stays outside it.
    pub fn close_with(&mut self, name: &Arc<str>, template: &Value<'t>, numbers: Vec<Number>) -> Value<'t> {
        let depth = self.contexts.depth();
        let inside = |n: &Number| matches!(&n.repr, crate::value::Repr::Local(d, _) if *d == depth);
        let results: Vec<(Number, Arc<str>)> = numbers
            .iter()
            .filter(|n| inside(n))
            .map(|n| (n.clone(), n.name.clone().unwrap_or_else(|| name.clone())))
            .collect();
        let kinds: Vec<bool> = numbers.iter().map(inside).collect();
        let mut from_call = if results.is_empty() {
            self.contexts.discard();
            Vec::new()
        } else {
            self.contexts.close(&results)
        }
        .into_iter();
        let all: Vec<Number> =
            numbers
                .into_iter()
                .zip(kinds)
                .map(|(n, is_result)| {
                    if is_result { from_call.next().expect("a result each") } else { self.contexts.settle(n) }
                })
                .collect();
        crate::eval::rebuild(template, &mut all.into_iter())
    }

    /// How a function that was just opened sees an argument: numbers as parameters, the rest as it is.
    pub fn seen_from_inside(&mut self, name: &Arc<str>, value: &Value<'t>) -> Value<'t> {
        match value {
            Value::Number(n) => {
                let key = crate::context::hash(&("parameter", &**name));
                Value::Number(self.contexts.seen_from_inside(name, n, key))
            }
            Value::Record(r) if outline::has_local_number(value) => {
                let fields = r.fields.iter().map(|(n, v)| (n.clone(), self.seen_from_inside(n, v))).collect();
                Value::record(fields)
            }
            other => other.clone(),
        }
    }

    fn call_lambda(
        &mut self,
        lambda: &'t Lambda,
        env: &Env<'t>,
        given: Given<'t>,
        span: Span,
    ) -> Eval<Value<'t>> {
        let slots: Vec<Slot<'_>> = lambda.parameters.iter().map(|p| slot(p, false)).collect();
        let fit = match fit(&mut self.contexts, &slots, &given) {
            Ok(fit) => fit,
            Err(why) => {
                let signature = signature("", &slots);
                return self.report(errors::no_fit(
                    span,
                    "this function",
                    &given.describe(),
                    &why,
                    &[signature],
                ));
            }
        };
        let mut inner = env.clone();
        let mut arguments = Vec::new();
        for (parameter, argument) in lambda.parameters.iter().zip(fit.arguments) {
            let value = match (argument, &parameter.default) {
                (Some(value), _) => value,
                (None, Some(default)) => self.eval(default, &inner)?,
                (None, None) => Value::list(Vec::new()),
            };
            let value = self.adapt(value, parameter)?;
            inner = inner.bind(parameter.name.text.clone(), value.clone());
            arguments.push((parameter.name.text.clone(), value));
        }
        let place = std::ptr::from_ref(lambda).cast::<()>();
        let run = |this: &mut Self| {
            this.enter(place, span, None)?;
            let result = this.eval(&lambda.body, &inner);
            this.leave(place);
            result
        };
        // The library's are called with new arguments each time.
        let inert = |this: &mut Self| this.inert_of_lambda(lambda);
        if env.module.is_user() { self.once(place, Some(env), &arguments, inert, run) } else { run(self) }
    }
}

/// Whether the arguments are functions, and numbers that are known now.
fn asks_of_functions(arguments: &[(Arc<str>, Value<'_>)]) -> bool {
    let is_function = |value: &Value<'_>| matches!(value, Value::Function(_));
    let is_known = |value: &Value<'_>| matches!(value, Value::Number(n) if n.known().is_some());
    arguments.iter().any(|(_, v)| is_function(v))
        && arguments.iter().all(|(_, v)| is_function(v) || is_known(v))
}

/// The parameters of a function.
fn slots<'a>(candidate: &Candidate<'a>) -> Vec<Slot<'a>> {
    match candidate {
        Candidate::Written(function, module) => {
            let is_of_page = *module == Module::Library && library::std().is_public(&function.name.text);
            function.parameters.iter().map(|p| slot(p, is_of_page)).collect()
        }
        Candidate::BuiltIn(b) => b.slots(),
    }
}

/// A written parameter. One without a type takes anything, but in what the library has for all it is a float.
fn slot(parameter: &Parameter, is_of_page: bool) -> Slot<'_> {
    let kind = match (&parameter.ty, is_of_page) {
        (Some(ty), _) => SlotKind::Type(ty.kind),
        (None, true) if parameter.default.as_ref().is_none_or(|d| matches!(d.kind, ExprKind::Number(_))) => {
            SlotKind::Type(TypeKind::Float)
        }
        (None, _) => SlotKind::Any,
    };
    Slot {
        name: &parameter.name.text,
        kind,
        variadic: parameter.variadic,
        optional: parameter.default.is_some(),
    }
}

/// A function's head, as messages show it.
pub(crate) fn signature(name: &str, slots: &[Slot<'_>]) -> String {
    let parts: Vec<String> = slots
        .iter()
        .map(|s| {
            let dots = if s.variadic { "..." } else { "" };
            let optional = if s.optional { " = …" } else { "" };
            match s.kind {
                SlotKind::Type(kind) if kind != TypeKind::Float => {
                    format!("{}{dots}: {}{optional}", s.name, kind.word())
                }
                _ => format!("{}{dots}{optional}", s.name),
            }
        })
        .collect();
    format!("{name}({})", parts.join(", "))
}

/// How arguments fit parameters, or why they do not. Where vectors may be given as rows of components, that
/// reading is tried first.
fn fit<'t>(contexts: &mut Contexts, slots: &[Slot<'_>], given: &Given<'t>) -> Result<Fit<'t>, String> {
    let has_vector = slots
        .iter()
        .any(|s| matches!(s.kind, SlotKind::Type(TypeKind::Vec2 | TypeKind::Vec3)) && !s.variadic);
    if has_vector
        && let Some(rows) = gather_rows(contexts, slots, given)
        && let Ok(fit) = fit_plain(slots, &rows, &given.named)
    {
        return Ok(fit);
    }
    let positional: Vec<Value<'t>> = given.receiver.iter().chain(&given.positional).cloned().collect();
    fit_plain(slots, &positional, &given.named)
}

/// The positional arguments with the components of each vector parameter gathered to one vector.
fn gather_rows<'t>(contexts: &mut Contexts, slots: &[Slot<'_>], given: &Given<'t>) -> Option<Vec<Value<'t>>> {
    let mut out: Vec<Value<'t>> = given.receiver.iter().cloned().collect();
    let mut rest = given.positional.iter();
    let mut gathered = false;
    for slot in &slots[out.len().min(slots.len())..] {
        let size = match slot.kind {
            SlotKind::Type(TypeKind::Vec2) if !slot.variadic => 2,
            SlotKind::Type(TypeKind::Vec3) if !slot.variadic => 3,
            _ => {
                out.extend(rest.next().cloned());
                continue;
            }
        };
        if rest.len() == 0 {
            break;
        }
        let mut parts = Vec::new();
        for _ in 0..size {
            match rest.next() {
                Some(Value::Number(n)) if n.ty == Type::Float => parts.push(n.clone()),
                _ => return None,
            }
        }
        gathered = true;
        out.push(Value::Number(contexts.apply(Op::Compose, &parts)));
    }
    out.extend(rest.cloned());
    gathered.then_some(out)
}

fn fit_plain<'t>(
    slots: &[Slot<'_>],
    positional: &[Value<'t>],
    named: &[(&'t Name, Value<'t>)],
) -> Result<Fit<'t>, String> {
    let mut arguments: Vec<Option<Value<'t>>> = vec![None; slots.len()];
    let mut widened = 0;
    let mut next = 0;
    let mut rest = positional.iter().peekable();
    while next < slots.len() && rest.peek().is_some() {
        let slot = &slots[next];
        if slot.variadic {
            let items: Vec<Value<'t>> = rest
                .by_ref()
                .flat_map(|v| match v {
                    Value::List(l) => l.items.clone(),
                    other => vec![other.clone()],
                })
                .collect();
            for item in &items {
                widened += takes(slot, item)
                    .map_err(|why| named_instead(&slots[next + 1..], named).unwrap_or(why))?;
            }
            widened += nothing_is_solid(slot, &items);
            arguments[next] = Some(Value::list(items));
        } else if let Some(value) = rest.next() {
            widened += takes(slot, value)?;
            arguments[next] = Some(value.clone());
        }
        next += 1;
    }
    if rest.peek().is_some() {
        let most = slots.len();
        return Err(format!(
            "takes {most} argument{}, {} given",
            if most == 1 { "" } else { "s" },
            positional.len()
        ));
    }
    for (name, value) in named {
        let Some(i) = slots.iter().position(|s| s.name == &*name.text) else {
            let names = slots.iter().map(|s| s.name);
            return Err(match sdf_syntax::did_you_mean(&name.text, names) {
                Some(s) => format!("has no parameter `{}`; did you mean `{s}`?", name.text),
                None => format!("has no parameter `{}`", name.text),
            });
        };
        if arguments[i].is_some() {
            return Err(format!("`{}` is given twice", name.text));
        }
        widened += takes(&slots[i], value)?;
        arguments[i] = Some(value.clone());
    }
    for (slot, argument) in slots.iter().zip(&mut arguments) {
        if argument.is_none() && slot.variadic {
            widened += nothing_is_solid(slot, &[]);
            *argument = Some(Value::list(Vec::new()));
        } else if argument.is_none() && !slot.optional {
            return Err(match slots.iter().any(|s| s.variadic) {
                true => format!("`{0}` is named: write `{0}: …`", slot.name),
                false => format!("`{}` is missing", slot.name),
            });
        }
    }
    Ok(Fit { arguments, widened })
}

/// `union()` of nothing is a solid: the plane's reading counts as the farther one.
fn nothing_is_solid(slot: &Slot<'_>, items: &[Value<'_>]) -> u32 {
    u32::from(items.is_empty() && slot.kind == SlotKind::Type(TypeKind::Shape2))
}

/// What is to be said if a parameter behind a variadic one is missing: it can only be given by its name.
fn named_instead(after: &[Slot<'_>], named: &[(&Name, Value<'_>)]) -> Option<String> {
    let missing = after.iter().find(|s| !s.optional && named.iter().all(|(n, _)| &*n.text != s.name))?;
    Some(format!("`{0}` is named: write `{0}: …`", missing.name))
}

/// Whether a parameter takes a value: 0 as it is, 1 widened.
fn takes(slot: &Slot<'_>, value: &Value<'_>) -> Result<u32, String> {
    let number = |want: Type| match value {
        Value::Number(n) if n.ty == want => Some(0),
        Value::Number(n) if n.ty == Type::Float && want.is_vector() => Some(1),
        _ => None,
    };
    let (fits, expected) = match slot.kind {
        SlotKind::Any => (Some(0), ""),
        SlotKind::Numeric => {
            (matches!(value, Value::Number(n) if n.ty != Type::Bool).then_some(0), "a float or vector")
        }
        SlotKind::Vector => (matches!(value, Value::Number(n) if n.ty.is_vector()).then_some(0), "a vector"),
        SlotKind::Type(TypeKind::Float) => (number(Type::Float), "a float"),
        SlotKind::Type(TypeKind::Vec2) => (number(Type::Vec2), "a vec2"),
        SlotKind::Type(TypeKind::Vec3) => (number(Type::Vec3), "a vec3"),
        SlotKind::Type(TypeKind::Bool) => (number(Type::Bool), "a bool"),
        SlotKind::Type(TypeKind::Shape) => {
            (matches!(value, Value::Shape(s) if s.dimension == Dimension::Three).then_some(0), "a shape")
        }
        SlotKind::Type(TypeKind::Shape2) => {
            (matches!(value, Value::Shape(s) if s.dimension == Dimension::Two).then_some(0), "a 2D shape")
        }
        SlotKind::Type(TypeKind::Material) => (
            match value {
                Value::Material(_) => Some(0),
                Value::Number(n) if matches!(n.ty, Type::Float | Type::Vec3) => Some(1),
                _ => None,
            },
            "a material or colour",
        ),
        SlotKind::Type(TypeKind::List) => (matches!(value, Value::List(_)).then_some(0), "a list"),
        SlotKind::Type(TypeKind::Fn) => (
            match value {
                Value::Function(_) => Some(0),
                Value::Shape(_) => Some(1),
                _ => None,
            },
            "a function",
        ),
    };
    fits.ok_or_else(|| {
        let hint = match (expected, value) {
            ("a shape" | "a 2D shape", Value::List(l))
                if matches!(l.items.first(), Some(Value::Shape(_))) =>
            {
                "; `union(list)` makes one shape of several"
            }
            _ => "",
        };
        format!("`{}` must be {expected}, not {}{hint}", slot.name, value.describe())
    })
}
