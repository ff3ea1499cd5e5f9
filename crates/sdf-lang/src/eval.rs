//! Elaboration: evaluating expressions to [values](crate::value), which leaves code behind where a value is not
//! known yet.

use crate::context::{Contexts, Op};
use crate::errors;
use crate::names::Names;
use crate::value::{Callable, Candidate, Env, Module, Number, Origin, Shape, ShapeKind, Thunk, Value};
use rustc_hash::FxHashMap;
use sdf_ir::{Binary, Constant, FunctionId, Node, Type, Unary};
use sdf_syntax::tree::{Binding, Block, Dimension, Expr, ExprKind, Function, Postfix, PostfixKind};
use sdf_syntax::{Diagnostic, Sources, Span};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::rc::Rc;
use std::sync::Arc;

/// A diagnostic has been reported; there is no value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reported;

/// A value, or a diagnostic has been reported.
pub(crate) type Eval<T> = Result<T, Reported>;

/// How deep calls of functions may nest inside calls of the same functions.
const RECURSION_LIMIT: u32 = 256;
/// How many expressions a loop may take besides what is allowed anyway; a longer one may be an expansion.
const LONGEST_LOOP: usize = 1_000_000;
/// How deep calls of any functions may nest.
const CALL_LIMIT: u32 = 1024;
/// How many elements a loop or list may have.
pub(crate) const LOOP_LIMIT: usize = 65_536;
/// How many nodes a program may have.
const NODE_LIMIT: usize = 1_000_000;
/// How many nodes may be made for each that a program may have: a scene is gone over for its map, its materials, its
/// frame and its camera, and much of what is made for materials is looked at only once.
const PASSES: usize = 16;

/// The state of an item while it is needed.
#[derive(Debug, Clone)]
pub(crate) enum Memo<'t> {
    Running,
    Done(Eval<Value<'t>>),
}

/// The elaborator of one file.
pub(crate) struct Elaborator<'t> {
    pub sources: &'t Sources,
    pub names: &'t Names<'t>,
    pub contexts: Contexts,
    pub diagnostics: Vec<Diagnostic>,
    /// The values of items, by module and name.
    pub items: HashMap<(Module, Arc<str>), Memo<'t>>,
    /// The items whose values are being found, from the outermost.
    pub pending: Vec<(Module, Arc<str>, Span)>,
    /// The functions of named shapes that depend on nothing but the point, by the place of their `let`.
    pub shape_functions: HashMap<*const (), FunctionId>,
    /// Where the renderer's coordinates are zero, if that is not the origin.
    pub origin: Option<glam::DVec3>,
    /// Functions whose result is no number, which cannot become functions of the program.
    pub not_outlined: HashSet<*const Function>,
    /// The functions whose bodies are being evaluated.
    pub origins: Vec<Origin<'t>>,
    /// The distances that a field samples, while its materials are looked up.
    pub samples: Option<Vec<crate::surface::Sample<'t>>>,
    /// The gradients made so far.
    pub gradients: sdf_ir::gradient::Gradients,
    /// What `--set` gives to params.
    pub overrides: HashMap<String, crate::Override>,
    /// Which fields of materials were seen to be other than their default.
    pub columns: BTreeSet<crate::surface::Column>,
    /// Whether they are being looked for.
    pub finding_columns: bool,
    /// What calls for properties of the materials that are being looked at.
    pub column_causes: Vec<(crate::surface::Column, crate::causes::Cause)>,
    /// The same of each painted part of the scene, with its name.
    pub parts_called: Vec<(String, Vec<(crate::surface::Column, crate::causes::Cause)>)>,
    /// The properties of materials that count as not being there, because their effects are left out.
    pub unseen_columns: BTreeSet<crate::surface::Column>,
    /// Where the user's files first read inputs such as `time`.
    pub inputs_read: HashMap<String, Span>,
    /// The shapes of the scene block, for the camera that frames them.
    pub scene_parts: Vec<Rc<Shape<'t>>>,
    /// How often each function is being evaluated, by its place in memory.
    pub active: FxHashMap<*const (), u32>,
    /// How many calls that is together.
    pub calls: u32,
    /// Whether a field, or what lies on a surface, is being evaluated.
    pub is_asking: bool,
    /// Whether what is evaluated is inside a loop of `iterate`.
    pub in_loop: bool,
    /// Whether rays go on from what reflects or transmits.
    pub bounces: bool,
    /// What trades accuracy for time.
    pub accuracy: crate::Accuracy,
    /// The preset that it is of, if one was given.
    pub quality: Option<crate::Quality>,
    /// The names of the lights in the order of the source, and whether each ever shines: those that do are the renderer's.
    pub light_names: Vec<(Arc<str>, bool)>,
    /// Whether what is evaluated is inside a `for`.
    pub in_for: bool,
    /// The expressions evaluated so far.
    pub work: usize,
    /// How many may be.
    pub work_limit: usize,
    /// Whether calls and rounds that take as much as an earlier one are only counted.
    pub is_trial: bool,
    /// How many expressions were counted and not evaluated.
    pub skipped: u64,
    /// Which parameters decide nothing, once that was asked.
    pub inert: Option<crate::lookahead::Inert>,
    /// What calls gave.
    pub memos: crate::memo::Memos<'t>,
    /// How large shapes are.
    pub sizes: crate::expansion::Sizes<'t>,
    /// How far rays have to go in a scene that the camera frames by itself.
    pub framed: Option<f64>,
    /// What of the user's files is being evaluated.
    pub place: Span,
    /// The function that the user's files have called, and that is being carried out.
    pub called: Option<&'t str>,
    /// What was proved of shapes so far.
    pub facts: crate::facts::Facts<'t>,
    /// Whether the limit on work was reached.
    pub exhausted: bool,
}

impl<'t> Elaborator<'t> {
    /// An elaborator that has not done anything yet.
    pub fn new(sources: &'t Sources, names: &'t Names<'t>, diagnostics: Vec<Diagnostic>) -> Elaborator<'t> {
        Elaborator {
            sources,
            names,
            contexts: Contexts::new(),
            diagnostics,
            items: HashMap::new(),
            pending: Vec::new(),
            shape_functions: HashMap::new(),
            origin: None,
            not_outlined: HashSet::new(),
            origins: Vec::new(),
            samples: None,
            gradients: sdf_ir::gradient::Gradients::default(),
            overrides: HashMap::new(),
            columns: BTreeSet::new(),
            finding_columns: false,
            column_causes: Vec::new(),
            parts_called: Vec::new(),
            unseen_columns: BTreeSet::new(),
            inputs_read: HashMap::new(),
            scene_parts: Vec::new(),
            active: FxHashMap::default(),
            calls: 0,
            work: 0,
            work_limit: 0,
            is_asking: false,
            in_loop: false,
            bounces: false,
            accuracy: crate::Accuracy::default(),
            quality: None,
            light_names: Vec::new(),
            in_for: false,
            is_trial: false,
            skipped: 0,
            inert: None,
            memos: crate::memo::Memos::default(),
            sizes: crate::expansion::Sizes::default(),
            place: Span::default(),
            framed: None,
            facts: crate::facts::Facts::new(),
            called: None,
            exhausted: false,
        }
    }

    pub fn report<T>(&mut self, mut diagnostic: Diagnostic) -> Eval<T> {
        if crate::library::is_ours(diagnostic.span.file) {
            // What is wrong inside the library was caused by what the user's file asked of it.
            diagnostic = match self.called {
                Some(name) if errors::is_of_types(diagnostic.code) => errors::wrong_inside(self.place, name),
                _ => Diagnostic { span: self.place, related: Vec::new(), ..diagnostic },
            };
        }
        self.diagnostics.push(diagnostic);
        Err(Reported)
    }

    /// Says something that is no error.
    pub fn warn(&mut self, warning: Diagnostic) {
        let _: Eval<()> = self.report(warning);
    }

    /// The line of the root file that a place is in; none for other files.
    pub fn line(&self, span: Span) -> Option<u32> {
        (span.file == crate::USER_FILE).then(|| self.sources.line(span.file, span.start) as u32)
    }

    /// Counts one piece of work, and refuses to do too much of it.
    pub fn count(&mut self, span: Span) -> Eval<()> {
        if !crate::library::is_ours(span.file) {
            self.place = span;
        }
        self.work += 1;
        if self.work <= self.work_limit && self.contexts.nodes <= PASSES * NODE_LIMIT {
            return Ok(());
        }
        // It is said once; whatever is evaluated from now on is given up at once.
        if !self.exhausted {
            self.exhausted = true;
            self.diagnostics.push(errors::too_large(self.place, "operations", NODE_LIMIT));
        }
        Err(Reported)
    }

    /// Begins a call of the function at a place in memory; refuses a recursion that is too deep.
    pub fn enter(&mut self, function: *const (), span: Span, name: Option<&str>) -> Eval<()> {
        *self.active.entry(function).or_insert(0) += 1;
        self.calls += 1;
        let recursion = self.calls - self.active.len() as u32;
        if recursion < RECURSION_LIMIT && self.calls <= CALL_LIMIT {
            return Ok(());
        }
        self.leave(function);
        let what = name.map_or_else(|| "this function".to_string(), |name| format!("`{name}`"));
        self.report(
            errors::too_long(span, &format!("the recursion of {what}"), u64::from(RECURSION_LIMIT))
                .help("a recursive function needs an `if` with a static condition that ends it"),
        )
    }

    /// Ends a call that was begun.
    pub fn leave(&mut self, function: *const ()) {
        self.calls -= 1;
        match self.active.get_mut(&function) {
            Some(count) if *count > 1 => *count -= 1,
            _ => {
                self.active.remove(&function);
            }
        }
    }

    /// Carries out a round of a loop. What the rounds take of a loop that stands in no other is known beforehand, from
    /// the first of them, and allowed.
    pub fn round<T>(&mut self, index: usize, count: usize, f: impl FnOnce(&mut Self) -> Eval<T>) -> Eval<T> {
        let before = self.spent();
        let was_in_for = std::mem::replace(&mut self.in_for, true);
        let result = f(self);
        self.in_for = was_in_for;
        if index == 0 && !was_in_for {
            let round = (self.spent() - before) as usize;
            self.work_limit += round.saturating_mul(count - 1).min(LONGEST_LOOP);
        }
        result
    }

    /// Runs `f` as if no call had been begun: a shape is made from as many others as there are, and what is asked of
    /// one is asked of those, which is no recursion of the user's.
    pub fn calling_anew<T>(&mut self, f: impl FnOnce(&mut Self) -> T) -> T {
        let (active, calls) = (std::mem::take(&mut self.active), std::mem::take(&mut self.calls));
        let result = f(self);
        (self.active, self.calls) = (active, calls);
        result
    }

    // ---- expressions

    /// The value of an expression.
    pub fn eval(&mut self, expr: &'t Expr, env: &Env<'t>) -> Eval<Value<'t>> {
        self.count(expr.span)?;
        match &expr.kind {
            ExprKind::Number(x) => Ok(Value::float(*x)),
            ExprKind::Color(c) => Ok(Value::Number(Number::constant(Constant::Vec3(*c)))),
            ExprKind::Bool(b) => Ok(Value::bool(*b)),
            ExprKind::Name(name) => self.lookup(name, env, expr.span),
            ExprKind::Tuple(items) => self.tuple(items, env, expr.span),
            ExprKind::Record(record) => {
                let fields: Vec<_> =
                    record.fields.iter().map(|f| (f.name.text.clone(), self.eval(&f.value, env))).collect();
                let fields = fields.into_iter().map(|(n, v)| v.map(|v| (n, v))).collect::<Eval<_>>()?;
                Ok(Value::record(fields))
            }
            ExprKind::List(items) => {
                let values = self.eval_all(items, env)?;
                self.list(values, |i| items[i].span)
            }
            ExprKind::Block(block) => self.block(block, env),
            ExprKind::Shape(dimension, block) => Ok(self.field(*dimension, block, env)),
            ExprKind::Material(record) => {
                Ok(Value::Material(Rc::new(crate::value::Material::Record { record, env: env.clone() })))
            }
            ExprKind::If { condition, then, otherwise } => self.choice(condition, then, otherwise, env),
            ExprKind::For { name, list, body } => {
                let items = self.eval(list, env)?;
                let items = self.as_list(items, list.span)?;
                let count = items.len();
                let mut out = Vec::with_capacity(count);
                let is_alike = self.is_trial && count > 1 && self.is_inert_in(&name.text, body);
                for item in items {
                    let inner = env.bind(name.text.clone(), item);
                    let before = self.spent();
                    let value = self.round(out.len(), count, |this| this.block(body, &inner))?;
                    out.push(value);
                    if is_alike {
                        let rest = count - 1;
                        self.skip(self.spent() - before, rest as u64);
                        out.resize(rest + 1, out[0].clone());
                        break;
                    }
                }
                self.list(out, |_| body.result.span)
            }
            ExprKind::Lambda(lambda) => {
                Ok(Value::Function(Rc::new(Callable::Lambda { lambda, env: env.clone() })))
            }
            ExprKind::Unary(op, operand) => {
                let value = self.eval(operand, env)?;
                self.prefix(*op, value, expr.span)
            }
            ExprKind::Chain { first, rest } => self.chain(first, rest, env),
            ExprKind::Postfix { base, operations } => self.postfix(base, operations, env),
            ExprKind::Error => Err(Reported),
        }
    }

    /// A list of these values, which are all of one type; `place` tells where each stands.
    fn list(&mut self, values: Vec<Value<'t>>, place: impl Fn(usize) -> Span) -> Eval<Value<'t>> {
        let kind = |value: &Value<'t>| match value {
            Value::Number(n) => crate::value::describe_type(n.ty).to_string(),
            Value::List(_) => "a list".to_string(),
            other => other.describe(),
        };
        if let Some(first) = values.first().map(kind)
            && let Some(odd) = values.iter().position(|value| kind(value) != first)
        {
            let other = kind(&values[odd]);
            return self.report(errors::mixed_list(place(odd), &first, &other));
        }
        Ok(Value::list(values))
    }

    /// The values of several expressions; all are evaluated, so that all mistakes in them are found.
    pub fn eval_all(&mut self, items: &'t [Expr], env: &Env<'t>) -> Eval<Vec<Value<'t>>> {
        let values: Vec<_> = items.iter().map(|e| self.eval(e, env)).collect();
        values.into_iter().collect()
    }

    /// The value of a block.
    pub fn block(&mut self, block: &'t Block, env: &Env<'t>) -> Eval<Value<'t>> {
        let (env, failed) = self
            .bind_all(&block.bindings, env, |this, binding, value| this.give_name(value, &binding.name.text));
        if failed.is_empty() {
            return self.eval(&block.result, &env);
        }
        self.eval_unless_hopeless(&block.result, &env, &failed, Self::eval).and(Err(Reported))
    }

    /// The variables of bindings, each made of its value by `give_name`, and the names of those without a value. What
    /// mentions none of these is still evaluated, so that independent mistakes are all found.
    pub fn bind_all(
        &mut self,
        bindings: &'t [Binding],
        env: &Env<'t>,
        give_name: impl Fn(&mut Self, &'t Binding, Value<'t>) -> Value<'t>,
    ) -> (Env<'t>, Vec<&'t str>) {
        let mut env = env.clone();
        let mut failed: Vec<&str> = Vec::new();
        for binding in bindings {
            match self.eval_unless_hopeless(&binding.value, &env, &failed, Self::eval) {
                Ok(value) => {
                    let value = give_name(self, binding, value);
                    env = env.bind(binding.name.text.clone(), value);
                    failed.retain(|name| *name != &*binding.name.text);
                }
                Err(Reported) => failed.push(&binding.name.text),
            }
        }
        (env, failed)
    }

    /// The value of an expression, unless it mentions a name that has none.
    pub fn eval_unless_hopeless(
        &mut self,
        expr: &'t Expr,
        env: &Env<'t>,
        failed: &[&str],
        eval: impl FnOnce(&mut Self, &'t Expr, &Env<'t>) -> Eval<Value<'t>>,
    ) -> Eval<Value<'t>> {
        if !failed.is_empty() && crate::walk::any_name(expr, &mut |name| failed.contains(&name)) {
            return Err(Reported);
        }
        eval(self, expr, env)
    }

    /// Hands the name of a `let` on to the node that it names.
    fn give_name(&mut self, value: Value<'t>, name: &Arc<str>) -> Value<'t> {
        let Value::Number(number) = value else { return value };
        if let crate::value::Repr::Local(depth, node) = number.repr
            && depth == self.contexts.depth()
            && !matches!(self.contexts.builder().node(node), Node::Argument(..) | Node::Float(_))
        {
            self.contexts.builder().name(node, name);
        }
        Value::Number(Number { name: Some(name.clone()), ..number })
    }

    fn field(&mut self, dimension: Dimension, block: &'t Block, env: &Env<'t>) -> Value<'t> {
        let origin = self.origins.last().copied();
        let traits = env.traits();
        let contract = origin.and_then(|o| self.contract_of_field(o, block));
        let kind = ShapeKind::Field { block, env: env.clone(), origin };
        let steep = traits.steep || contract.is_none_or(|c| c.quality.is_none());
        Value::Shape(Rc::new(Shape { dimension, kind, painted: traits.painted, steep, place: self.place }))
    }

    fn tuple(&mut self, items: &'t [Expr], env: &Env<'t>, span: Span) -> Eval<Value<'t>> {
        let values = self.eval_all(items, env)?;
        let mut parts = Vec::new();
        for (value, item) in values.into_iter().zip(items) {
            let number = self.as_number(value, item.span)?;
            if number.ty == Type::Bool {
                return self.report(errors::wrong_type(item.span, "a float", "a bool"));
            }
            for i in 0..number.ty.size() {
                parts.push(self.component(&number, i));
            }
        }
        if !(2..=3).contains(&parts.len()) {
            return self.report(
                errors::wrong_type(span, "a vec2 or vec3", &format!("a tuple of {} numbers", parts.len()))
                    .help("vectors have two or three components; write a list with `[ ]`"),
            );
        }
        Ok(Value::Number(self.contexts.apply(Op::Compose, &parts)))
    }

    // ---- names

    fn lookup(&mut self, name: &Arc<str>, env: &Env<'t>, span: Span) -> Eval<Value<'t>> {
        if let Some(value) = env.get(name) {
            return Ok(value.clone());
        }
        self.global(name, env.module, span)
    }

    /// All functions that `name` can mean where no variable hides them.
    pub fn overloads(&mut self, name: &str, module: Module, span: Span) -> Eval<Vec<Candidate<'t>>> {
        self.names.functions(name, module).or_else(|clash| self.report(clash.diagnostic(name, span)))
    }

    /// All functions that `name` can mean behind a `.`.
    pub fn methods(&mut self, name: &str, module: Module, span: Span) -> Eval<Vec<Candidate<'t>>> {
        self.names.methods(name, module).or_else(|clash| self.report(clash.diagnostic(name, span)))
    }

    /// Reports a name that means nothing, unless it may come from a file that could not be imported.
    pub fn report_unknown<T>(&mut self, diagnostic: Diagnostic, module: Module) -> Eval<T> {
        if self.names.is_incomplete(module) { Err(Reported) } else { self.report(diagnostic) }
    }

    // ---- postfix operations

    fn postfix(&mut self, base: &'t Expr, operations: &'t [Postfix], env: &Env<'t>) -> Eval<Value<'t>> {
        let mut rest = operations.iter();
        let mut value = match (&base.kind, operations.first().map(|o| &o.kind)) {
            (ExprKind::Name(name), Some(PostfixKind::Call(arguments))) if env.get(name).is_none() => {
                rest.next();
                let span = base.span.to(operations[0].span);
                self.call_by_name(name, base.span, arguments, env, span)?
            }
            _ => self.eval(base, env)?,
        };
        for operation in rest {
            let span = base.span.to(operation.span);
            value = match &operation.kind {
                PostfixKind::Call(arguments) => self.call_value(value, arguments, env, span)?,
                PostfixKind::Method(name, arguments) => self.method(value, name, arguments, env, span)?,
                PostfixKind::Member(name) => self.member(value, &name.text, name.span)?,
                PostfixKind::Index(index) => {
                    let i = self.eval(index, env)?;
                    self.index(value, i, base.span, index.span)?
                }
            };
        }
        Ok(value)
    }

    fn member(&mut self, value: Value<'t>, name: &Arc<str>, span: Span) -> Eval<Value<'t>> {
        match &value {
            Value::Record(record) => match record.get(name) {
                Some(v) => Ok(v.clone()),
                None => {
                    let all: Vec<&str> = record.fields.iter().map(|(n, _)| &**n).collect();
                    let help = match sdf_syntax::did_you_mean(name, all.iter().copied()) {
                        Some(s) => format!("did you mean `{s}`?"),
                        None => format!("it has {}", all.join(", ")),
                    };
                    self.report(errors::no_member(span, name, "this record", Some(help)))
                }
            },
            Value::Number(n) if n.ty != Type::Bool => match swizzle(name, n.ty) {
                Some(indices) => {
                    let parts: Vec<Number> = indices.iter().map(|i| self.component(n, *i)).collect();
                    Ok(Value::Number(match &parts[..] {
                        [one] => one.clone(),
                        parts => self.contexts.apply(Op::Compose, parts),
                    }))
                }
                None => {
                    let found = value.describe();
                    let plain = name.to_lowercase();
                    let help = match n.ty {
                        _ if swizzle(&plain, n.ty).is_some() => format!("did you mean `.{plain}`?"),
                        Type::Vec3 if name.len() <= 3 && name.chars().all(|c| "xyzrgb".contains(c)) => {
                            "`.x .y .z` and `.r .g .b` do not mix".to_string()
                        }
                        Type::Float => "a float has no components".to_string(),
                        Type::Vec2 => {
                            "its components are `.x` and `.y`, in any order and number up to 3".into()
                        }
                        _ => "its components are `.x .y .z` or `.r .g .b`, in any order, up to 3".into(),
                    };
                    self.report(errors::no_member(span, name, &found, Some(help)))
                }
            },
            _ => {
                let found = value.describe();
                self.report(errors::no_member(
                    span,
                    name,
                    &found,
                    Some(format!("to call a function, write `.{name}(…)`")),
                ))
            }
        }
    }

    fn index(&mut self, value: Value<'t>, index: Value<'t>, span: Span, index_span: Span) -> Eval<Value<'t>> {
        let index = self.as_typed(index, Type::Float, index_span)?;
        let Some(Constant::Float(i)) = index.known() else {
            return self.report(errors::not_static(index_span, "an index"));
        };
        match &value {
            Value::List(list) => {
                if i < 0.0 || i.fract() != 0.0 || i as usize >= list.items.len() {
                    return self.report(errors::index_out_of_range(index_span, i, list.items.len()));
                }
                Ok(list.items[i as usize].clone())
            }
            Value::Number(n) if n.ty.is_vector() => {
                if i < 0.0 || i.fract() != 0.0 || i as usize >= n.ty.size() {
                    return self.report(errors::index_out_of_range(index_span, i, n.ty.size()));
                }
                Ok(Value::Number(self.component(n, i as usize)))
            }
            other => {
                let found = other.describe();
                self.report(errors::wrong_type(span, "a list or vector", &found))
            }
        }
    }

    // ---- what a value is

    /// The number that a value is.
    pub fn as_number(&mut self, value: Value<'t>, span: Span) -> Eval<Number> {
        match value {
            Value::Number(n) => Ok(n),
            other => {
                let found = other.describe();
                self.report(errors::wrong_type(span, "a number", &found))
            }
        }
    }

    /// The number of a type that a value is; floats are widened.
    pub fn as_typed(&mut self, value: Value<'t>, ty: Type, span: Span) -> Eval<Number> {
        match &value {
            Value::Number(n) => self.widen(n, ty, span),
            other => {
                let found = other.describe();
                self.report(errors::wrong_type(span, crate::value::describe_type(ty), &found))
            }
        }
    }

    /// The shape that a value is.
    pub fn as_shape(&mut self, value: Value<'t>, span: Span) -> Eval<Rc<Shape<'t>>> {
        match value {
            Value::Shape(s) => Ok(s),
            other => {
                let found = other.describe();
                self.report(errors::wrong_type(span, "a shape", &found))
            }
        }
    }

    /// The elements of a list.
    pub fn as_list(&mut self, value: Value<'t>, span: Span) -> Eval<Vec<Value<'t>>> {
        match value {
            Value::List(l) => Ok(l.items.clone()),
            other => {
                let found = other.describe();
                self.report(errors::wrong_type(span, "a list", &found))
            }
        }
    }

    /// A number of type `ty`, a float being widened to a vector.
    pub fn widen(&mut self, n: &Number, ty: Type, span: Span) -> Eval<Number> {
        if n.ty == ty {
            return Ok(n.clone());
        }
        if n.ty == Type::Float && ty.is_vector() {
            return Ok(self.contexts.apply(Op::Compose, &vec![n.clone(); ty.size()]));
        }
        self.report(errors::wrong_type(
            span,
            crate::value::describe_type(ty),
            crate::value::describe_type(n.ty),
        ))
    }

    // ---- numbers

    /// A component of a vector; a float is its own.
    pub fn component(&mut self, n: &Number, index: usize) -> Number {
        if n.ty.is_vector() {
            self.contexts.apply(Op::Component(index as u8), std::slice::from_ref(n))
        } else {
            n.clone()
        }
    }

    /// An operation on one number.
    pub fn unary(&mut self, op: Unary, a: &Number, span: Span) -> Eval<Number> {
        let result = self.contexts.apply(Op::Unary(op), std::slice::from_ref(a));
        self.finite(result, span)
    }

    /// An operation on two numbers; floats are widened where the operation wants equal types.
    pub fn binary(&mut self, op: Binary, a: &Number, b: &Number, span: Span) -> Eval<Number> {
        // The library's code means the total quotient: a size of 0 is no mistake of its own.
        if !crate::library::is_ours(span.file)
            && matches!(op, Binary::Divide | Binary::Modulo)
            && a.known().is_some()
            && b.known().is_some_and(|c| c.components().contains(&0.0))
        {
            let symbol = if op == Binary::Divide { "/" } else { "%" };
            return self.report(errors::division_by_zero(span, symbol));
        }
        let mixed = matches!(op, Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide);
        let ty = a.ty.max(b.ty);
        let (a, b) = if mixed || a.ty == b.ty {
            (a.clone(), b.clone())
        } else {
            (self.widen(a, ty, span)?, self.widen(b, ty, span)?)
        };
        let result = self.contexts.apply(Op::Binary(op), &[a, b]);
        self.finite(result, span)
    }

    /// A static result that is no number of the language is an error.
    pub fn finite(&mut self, n: Number, span: Span) -> Eval<Number> {
        match n.known() {
            Some(c) if !c.is_finite() => self.report(errors::not_finite(span, "this result")),
            _ => Ok(n),
        }
    }

    // ---- values as lists of numbers

    /// The numbers of a value and its form.
    pub fn flatten(&mut self, value: &Value<'t>, span: Span) -> Eval<(Value<'t>, Vec<Number>)> {
        let mut out = Vec::new();
        self.flatten_into(value, span, &mut out)?;
        Ok((value.clone(), out))
    }

    fn flatten_into(&mut self, value: &Value<'t>, span: Span, out: &mut Vec<Number>) -> Eval<()> {
        match value {
            Value::Number(n) => out.push(n.clone()),
            Value::Record(r) => {
                self.count(span)?;
                for (name, v) in &r.fields {
                    let first = out.len();
                    self.flatten_into(v, span, out)?;
                    if let [only] = &mut out[first..] {
                        only.name = Some(name.clone());
                    }
                }
            }
            Value::List(l) => {
                self.count(span)?;
                for v in &l.items {
                    self.flatten_into(v, span, out)?;
                }
            }
            other => {
                let found = other.describe();
                return self.report(errors::wrong_type(span, "a number, or a record of numbers", &found));
            }
        }
        Ok(())
    }

    /// A value of the same form as `template` made of nodes of the innermost function.
    pub fn unflatten(&mut self, template: &Value<'t>, nodes: &[sdf_ir::Value]) -> Eval<Value<'t>> {
        let depth = self.contexts.depth();
        let numbers: Vec<Number> = nodes
            .iter()
            .map(|v| {
                let ty = self.contexts.builder().ty(*v);
                self.contexts.local(depth, *v, ty)
            })
            .collect();
        Ok(rebuild(template, &mut numbers.into_iter()))
    }
}

/// The numbers in a value, in order; what is no number is passed over.
pub(crate) fn numbers_of(value: &Value<'_>) -> Vec<Number> {
    match value {
        Value::Number(n) => vec![n.clone()],
        Value::Record(r) => r.fields.iter().flat_map(|(_, v)| numbers_of(v)).collect(),
        Value::List(l) => l.items.iter().flat_map(numbers_of).collect(),
        Value::Shape(_) | Value::Material(_) | Value::Function(_) => Vec::new(),
    }
}

/// A value of the form of `template` with other numbers.
pub(crate) fn rebuild<'t>(template: &Value<'t>, numbers: &mut dyn Iterator<Item = Number>) -> Value<'t> {
    match template {
        Value::Number(old) => {
            let new = numbers.next().expect("as many numbers as the form has");
            Value::Number(match &old.name {
                Some(name) => new.named(name),
                None => new,
            })
        }
        Value::Record(r) => {
            Value::record(r.fields.iter().map(|(n, v)| (n.clone(), rebuild(v, numbers))).collect())
        }
        Value::List(l) => Value::list(l.items.iter().map(|v| rebuild(v, numbers)).collect()),
        other => other.clone(),
    }
}

/// The components that a swizzle names, or `None` where it is none.
fn swizzle(name: &str, ty: Type) -> Option<Vec<usize>> {
    if name.is_empty() || name.len() > 3 || !ty.is_vector() {
        return None;
    }
    ["xyz", "rgb"]
        .iter()
        .find_map(|set| name.chars().map(|c| set[..ty.size()].find(c)).collect::<Option<Vec<usize>>>())
}

/// Marks a shape as the user's own under a name, unless it has one already.
pub(crate) fn name_shape<'t>(value: Value<'t>, name: &Arc<str>, span: Span, thunk: Thunk<'t>) -> Value<'t> {
    match value {
        Value::Shape(shape) if !matches!(shape.kind, ShapeKind::Named { .. }) => {
            let (dimension, painted, steep, place) =
                (shape.dimension, shape.painted, shape.steep, shape.place);
            let kind = ShapeKind::Named { name: name.clone(), span, thunk, inner: shape };
            Value::Shape(Rc::new(Shape { dimension, kind, painted, steep, place }))
        }
        other => other,
    }
}
