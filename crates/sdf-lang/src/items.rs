//! The values of items: found when they are first needed, each once; a circle is an error that shows its path.

use crate::contract::Contract;
use crate::errors;
use crate::eval::{Elaborator, Eval, Memo, Reported, name_shape};
use crate::names::{Item, Meaning};
use crate::value::{Callable, Env, Material, Module, Number, Thunk, Value};
use sdf_ir::{Constant, Role, Type, Uniform};
use sdf_syntax::Span;
use sdf_syntax::tree::{Expr, Name};
use std::rc::Rc;
use std::sync::Arc;

impl<'t> Elaborator<'t> {
    /// What a name means where no variable has it.
    pub fn global(&mut self, name: &Arc<str>, module: Module, span: Span) -> Eval<Value<'t>> {
        match self.names.meaning(name, module) {
            Meaning::Value(owner, item) => return self.item(owner, name, item, span),
            Meaning::Functions(functions) => {
                return Ok(Value::Function(Rc::new(Callable::Overloads(name.clone(), functions))));
            }
            Meaning::Clash(clash) => return self.report(clash.diagnostic(name, span)),
            Meaning::Nothing => {}
        }
        if let Some(value) = self.constant(name) {
            self.note_input(name, module, span);
            return Ok(value);
        }
        let diagnostic = self.names.unknown(name, span, module, &[]);
        self.report_unknown(diagnostic, module)
    }

    fn constant(&mut self, name: &str) -> Option<Value<'t>> {
        let axis = |v| Some(Value::Number(Number::constant(Constant::Vec3(v))));
        match name {
            "pi" => Some(Value::float(std::f64::consts::PI)),
            "tau" => Some(Value::float(std::f64::consts::TAU)),
            "x" => axis([1.0, 0.0, 0.0]),
            "y" => axis([0.0, 1.0, 0.0]),
            "z" => axis([0.0, 0.0, 1.0]),
            "time" => Some(Value::Number(self.input("time", Type::Float, Role::Time))),
            "mouse" => Some(Value::Number(self.input("mouse", Type::Vec2, Role::Mouse))),
            _ => None,
        }
    }

    /// A uniform that is no param.
    pub fn input(&mut self, name: &str, ty: Type, role: Role) -> Number {
        let default = match role {
            Role::Mouse => Constant::Vec2([0.5, 0.5]),
            Role::Orbit { .. } => Constant::Vec3([0.0, 0.0, 1.0]),
            _ if ty == Type::Vec2 => Constant::Vec2([1.0, 1.0]),
            _ => Constant::Float(0.0),
        };
        self.contexts.uniform(Uniform { name: Arc::from(name), ty, role, default })
    }

    fn item(&mut self, module: Module, name: &Arc<str>, item: Item<'t>, span: Span) -> Eval<Value<'t>> {
        let key = (module, name.clone());
        match self.items.get(&key) {
            Some(Memo::Done(value)) => return value.clone(),
            Some(Memo::Running) => return self.report_cycle(module, name, span),
            None => {}
        }
        let place = item.span();
        self.items.insert(key.clone(), Memo::Running);
        self.pending.push((module, name.clone(), place));
        // An item is evaluated by itself, whatever needed it.
        let samples = self.samples.take();
        let origins = std::mem::take(&mut self.origins);
        let regions = self.contexts.leave_frame_regions();
        let value = self.item_value(module, item);
        self.contexts.return_to_frame_regions(regions);
        self.origins = origins;
        self.samples = samples;
        self.pending.pop();
        // One that was given up may be tried again with more patience.
        match self.exhausted {
            true => self.items.remove(&key),
            false => self.items.insert(key, Memo::Done(value.clone())),
        };
        value
    }

    fn report_cycle(&mut self, module: Module, name: &Arc<str>, span: Span) -> Eval<Value<'t>> {
        let start = self.pending.iter().position(|(m, n, _)| *m == module && n == name).unwrap_or(0);
        let mut path: Vec<String> = self.pending[start..].iter().map(|(_, n, _)| n.to_string()).collect();
        let mut places: Vec<Span> = self.pending[start..].iter().map(|(_, _, s)| *s).collect();
        path.push(name.to_string());
        places.push(span);
        self.report(errors::cycle(places[0], &path, &places))
    }

    fn item_value(&mut self, module: Module, item: Item<'t>) -> Eval<Value<'t>> {
        let env = Env::new(module);
        match item {
            Item::Let(binding) => {
                let value = self.eval_ahead(&binding.value, &env)?;
                let own = env.bind(binding.name.text.clone(), value.clone());
                let names = self.names;
                let contract = names.contract_of_let(binding).map(|(_, contract)| contract);
                self.require(contract, &own, binding.name.span)?;
                Ok(match value {
                    Value::Number(n) => Value::Number(n.named(&binding.name.text)),
                    value if module.is_user() => {
                        name_shape(value, &binding.name.text, binding.name.span, Thunk::Let(binding))
                    }
                    value => value,
                })
            }
            Item::Param { name, default, range } => self.param(name, default, range, &env).map(Value::Number),
            Item::Material(_, record) => Ok(Value::Material(Rc::new(Material::Record { record, env }))),
        }
    }

    /// Checks what an item requires, as far as it is known now; `span` is what asks for it.
    pub fn require(&mut self, contract: Option<&'t Contract<'t>>, env: &Env<'t>, span: Span) -> Eval<()> {
        for requirement in contract.iter().flat_map(|contract| &contract.requirements) {
            let value = self.eval(requirement.condition, env)?;
            let holds = self.as_typed(value, Type::Bool, requirement.condition.span)?;
            if holds.known() == Some(Constant::Bool(false)) {
                return self.report(errors::requirement(span, requirement.message, requirement.span));
            }
            if let Some(when) = self.when(&holds, |c| *c == Constant::Bool(false)) {
                self.warn(errors::breakable_requirement(span, requirement.message, requirement.span, &when));
            }
        }
        Ok(())
    }

    /// A param: a uniform of the name that it has outside the file, or the value that `--set` froze it to.
    fn param(
        &mut self,
        name: &'t Name,
        default: &'t Expr,
        range: Option<&'t (Expr, Expr)>,
        env: &Env<'t>,
    ) -> Eval<Number> {
        let value = self.eval(default, env)?;
        let number = self.as_number(value, default.span)?;
        let Some(constant) = number.known() else {
            return self.report(errors::not_static(default.span, "the default of a param"));
        };
        let range = match (range, constant) {
            (Some((low, high)), Constant::Float(x)) => {
                let low_value = self.static_float(low, env, "the range of a param");
                let high_value = self.static_float(high, env, "the range of a param");
                let (low_value, high_value) = (low_value?, high_value?);
                if low_value > high_value {
                    return self.report(errors::out_of_range(
                        low.span.to(high.span),
                        "the order of this range",
                        "the lower end first",
                    ));
                }
                if x < low_value || x > high_value {
                    return self.report(errors::out_of_range(
                        default.span,
                        &format!("the default of `{}`", name.text),
                        &format!("{low_value} to {high_value}"),
                    ));
                }
                Some((low_value, high_value))
            }
            (None, Constant::Float(_)) => {
                return self.report(
                    errors::wrong_setting(
                        name.span,
                        format!("the param `{}` has no range", name.text),
                        format!("write for example `param {} = {} in 0..1`", name.text, display(constant)),
                    )
                    .label("a float needs one"),
                );
            }
            (Some((low, high)), _) => {
                return self.report(errors::wrong_setting(
                    low.span.to(high.span),
                    "only a float has a range",
                    "leave the range out",
                ));
            }
            (None, Constant::Vec2(_)) => {
                return self.report(errors::wrong_type(
                    default.span,
                    "a float, a bool or a colour",
                    "a vec2",
                ));
            }
            (None, _) => None,
        };
        let color = matches!(constant, Constant::Vec3(_));
        let role = Role::Param { range, color };
        if let Some(text) = self.overrides.get(&*self.names.name_to_set(env.module, name)) {
            let text = text.clone();
            return self.frozen(name, &text, constant, range);
        }
        Ok(self.contexts.uniform(Uniform {
            name: self.names.param_name(env.module, name),
            ty: constant.ty(),
            role,
            default: constant,
        }))
    }

    /// The value that `--set` gives a param.
    fn frozen(
        &mut self,
        name: &Name,
        text: &str,
        default: Constant,
        range: Option<(f64, f64)>,
    ) -> Eval<Number> {
        let constant = match default {
            Constant::Bool(_) => text.parse().ok().map(Constant::Bool),
            Constant::Float(_) => {
                text.parse().ok().filter(|x: &f64| (*x as f32).is_finite()).map(Constant::Float)
            }
            _ => crate::parse_color(text).map(Constant::Vec3),
        };
        let what = match default {
            Constant::Bool(_) => "`true` or `false`".to_string(),
            Constant::Float(_) => {
                range.map_or("a number".into(), |(a, b)| format!("a number from {a} to {b}"))
            }
            _ => "a colour such as `#ff8800`".into(),
        };
        let fits = match (constant, range) {
            (Some(Constant::Float(x)), Some((low, high))) => x >= low && x <= high,
            (c, _) => c.is_some(),
        };
        if !fits {
            return self.report(
                errors::bad_override(
                    name.span,
                    format!("`{}` cannot be set to `{text}`", name.text),
                    format!("give it {what}"),
                )
                .label("the param is here"),
            );
        }
        Ok(Number::constant(constant.expect("checked above")).named(&name.text))
    }

    /// A float that is known now.
    pub fn static_float(&mut self, expr: &'t Expr, env: &Env<'t>, what: &str) -> Eval<f64> {
        let value = self.eval(expr, env)?;
        let n = self.as_typed(value, Type::Float, expr.span)?;
        match n.known() {
            Some(Constant::Float(x)) => Ok(x),
            _ => self.report(errors::not_static(expr.span, what)),
        }
    }

    /// Evaluates every `let`, param and material of the user's files, so that mistakes in those that nothing uses
    /// are found too.
    pub fn evaluate_all_items(&mut self) {
        for (module, items) in self.names.user_modules() {
            for (name, item) in &items.order {
                let value = self.item(module, &name.text, *item, name.span);
                if let Ok(Value::Material(material)) = value {
                    let _: Result<_, Reported> = self.check_material(&material);
                }
            }
        }
    }
}

fn display(c: Constant) -> String {
    match c {
        Constant::Float(x) => format!("{x}"),
        other => format!("{other:?}"),
    }
}
