//! Prints a function.

use crate::EmitError;
use crate::bits;
use crate::dialect::Dialect;
use crate::expression::{Expression, Level};
use crate::names::Names;
use crate::plan::{Part, Plan, parts};
use crate::symbols::Symbols;
use rustc_hash::FxHashMap;
use sdf_ir::program::Loop;
use sdf_ir::{Binary, Function, FunctionId, List, Node, Program, RegionId, Ternary, Type, Unary, Value};
use std::cell::Cell;
use std::fmt::Write;
use std::rc::Rc;

/// What every function of a shader is printed with.
pub(crate) struct Context<'a> {
    /// The whole program.
    pub program: &'a Program,
    /// The language.
    pub dialect: &'a Dialect,
    /// The names that are shared.
    pub symbols: &'a Symbols,
}

impl Context<'_> {
    /// The text of a function, its result's structure before it.
    pub fn function(&self, id: FunctionId, plan: &Plan) -> Result<String, EmitError> {
        let function = self.program.function(id);
        let mut printer = Printer {
            context: self,
            function,
            plan,
            scope: self.symbols.taken.inside(),
            names: FxHashMap::default(),
            variables: FxHashMap::default(),
            arguments: FxHashMap::default(),
            source_names: Rc::new(argument_names(function)),
            id,
            out: String::new(),
            parts: Vec::new(),
            part_count: Rc::default(),
            indent: 0,
        };
        printer.function(id)?;
        printer.parts.push(printer.out);
        Ok(printer.parts.join("\n"))
    }
}

/// The names that the source has for arguments of regions and for parts of tuples.
fn argument_names(function: &Function) -> FxHashMap<Node, String> {
    let values = (0..function.node_count()).map(|i| Value(i as u32));
    let named = values.filter_map(|v| Some((function.node(v), function.name_of(v)?.to_string())));
    named.filter(|(node, _)| matches!(node, Node::Argument(..) | Node::Result(..))).collect()
}

/// Prints one function, or a part of a long one.
pub(crate) struct Printer<'a> {
    pub context: &'a Context<'a>,
    pub id: FunctionId,
    pub function: &'a Function,
    pub plan: &'a Plan,
    pub scope: Names<'a>,
    /// The names of values.
    pub names: FxHashMap<Value, String>,
    /// The variables that an `If` or a `Loop` leaves its results in.
    pub variables: FxHashMap<Value, Vec<String>>,
    /// How arguments of regions are written.
    pub arguments: FxHashMap<(RegionId, u16), Expression>,
    source_names: Rc<FxHashMap<Node, String>>,
    /// The function's text so far.
    pub out: String,
    /// The functions that were cut out of it.
    pub parts: Vec<String>,
    /// How many functions were cut out of the whole one so far.
    pub part_count: Rc<Cell<usize>>,
    pub indent: usize,
}

// ---- statements

impl<'a> Printer<'a> {
    pub fn line(&mut self, text: &str) {
        let indent = 4 * self.indent;
        writeln!(self.out, "{:indent$}{text}", "").expect("writing to a string cannot fail");
    }

    fn function(&mut self, id: FunctionId) -> Result<(), EmitError> {
        let Context { dialect, symbols, program } = *self.context;
        let structure = symbols.structures[id.0 as usize].as_ref();
        if let Some(structure) = structure {
            self.line(&format!("struct {} {{", structure.name));
            let (member_end, end) = dialect.structure;
            for (ty, field) in self.function.result_types().iter().zip(&structure.fields) {
                self.line(&format!("    {}{member_end}", (dialect.declare)(dialect.ty(*ty), field)));
            }
            self.line(end);
            self.line("");
        }
        let line = self.function.line.map(|line| format!("line {line} of the scene"));
        for text in line.as_deref().into_iter().chain(self.function.doc.as_deref()) {
            for row in wrapped(text) {
                self.line(&crate::comment(&row));
            }
        }
        let mut parameters = Vec::new();
        for (i, parameter) in self.function.parameters.iter().enumerate() {
            let name = self.scope.give(&parameter.name, fallback(Some(parameter.ty)));
            parameters.push((dialect.declare)(dialect.ty(parameter.ty), &name));
            self.arguments.insert((RegionId::ROOT, i as u16), Expression::atom(name));
        }
        let is_frame = program.frame == Some(id);
        let types = self.function.result_types();
        let result = match structure {
            _ if is_frame => None,
            Some(structure) => Some(structure.name.as_str()),
            None => types.first().map(|ty| dialect.ty(*ty)),
        };
        let head = (dialect.function)(&symbols.functions[id.0 as usize], &parameters.join(", "), result);
        self.line(&format!("{head} {{"));
        self.indent += 1;
        let results = self.region(RegionId::ROOT)?;
        if is_frame {
            for (global, result) in symbols.globals.iter().zip(&results) {
                self.line(&format!("{global} = {};", result.text));
            }
        } else {
            let result = match (structure, results.as_slice()) {
                (Some(structure), parts) => Expression::call(&structure.name, parts).text,
                (None, [result]) => result.text.clone(),
                (None, _) => return Err(EmitError::NoResult { function: self.function.name.to_string() }),
            };
            self.line(&format!("return {result};"));
        }
        self.indent -= 1;
        self.line("}");
        Ok(())
    }

    /// A printer for a part of this function, which knows no values but those that it is told.
    pub fn part_printer(&self) -> Printer<'a> {
        Printer {
            context: self.context,
            id: self.id,
            function: self.function,
            plan: self.plan,
            scope: self.context.symbols.taken.inside(),
            names: FxHashMap::default(),
            variables: FxHashMap::default(),
            arguments: FxHashMap::default(),
            source_names: self.source_names.clone(),
            out: String::new(),
            parts: Vec::new(),
            part_count: self.part_count.clone(),
            indent: 0,
        }
    }

    /// Prints what a region computes, and returns what it yields.
    fn region(&mut self, region: RegionId) -> Result<Vec<Expression>, EmitError> {
        self.statements(region)?;
        self.function.region(region).results.iter().map(|v| self.use_of(*v)).collect()
    }

    pub fn statement(&mut self, v: Value) -> Result<(), EmitError> {
        match self.function.node(v) {
            Node::If(condition, then, otherwise) => self.branch(v, condition, then, otherwise),
            Node::Loop(l) => self.repeat(v, l),
            _ => {
                let value = self.expression(v)?;
                let name = self.function.name_of(v).map_or("", |name| name);
                let name = self.scope.give(name, fallback(self.function.type_of(v)));
                let ty = self.type_of_named(v);
                self.line(&(self.context.dialect.bind)(ty, &name, &value.text));
                self.names.insert(v, name);
                Ok(())
            }
        }
    }

    fn branch(
        &mut self,
        v: Value,
        condition: Value,
        then: RegionId,
        otherwise: RegionId,
    ) -> Result<(), EmitError> {
        let condition = self.use_of(condition)?;
        let results = &self.function.region(then).results;
        let types: Vec<Type> = results.iter().map(|v| self.type_of(*v)).collect();
        let variables = self.declare_variables(v, &types, &[], &[]);
        self.line(&format!("if ({}) {{", condition.text));
        self.block(then, &variables)?;
        self.line("} else {");
        self.block(otherwise, &variables)?;
        self.line("}");
        self.bind_variables(v, variables);
        Ok(())
    }

    /// Prints a region that leaves its results in variables.
    fn block(&mut self, region: RegionId, variables: &[String]) -> Result<(), EmitError> {
        self.indent += 1;
        let results = self.region(region)?;
        for (variable, result) in variables.iter().zip(&results) {
            self.line(&format!("{variable} = {};", result.text));
        }
        self.indent -= 1;
        Ok(())
    }

    fn repeat(&mut self, v: Value, l: Loop) -> Result<(), EmitError> {
        let initial = self.uses(l.initial)?;
        let types: Vec<Type> = self.function.list(l.initial).iter().map(|v| self.type_of(*v)).collect();
        let states: Vec<Node> = (0..types.len()).map(|i| Node::Argument(l.next, i as u16 + 1)).collect();
        let variables = self.declare_variables(v, &types, &states, &initial);
        let counter = self.scope.give("i", "i");
        let round = Expression::call(self.context.dialect.float, &[Expression::atom(counter.as_str())]);
        self.arguments.insert((l.next, 0), round);
        for (i, variable) in variables.iter().enumerate() {
            let state = Expression::atom(variable.as_str());
            self.arguments.insert((l.until, i as u16), state.clone());
            self.arguments.insert((l.next, i as u16 + 1), state);
        }
        let count = self.rounds(l);
        self.line(&format!("{} {{", (self.context.dialect.counted)(&counter, &count)));
        self.indent += 1;
        let until = self.region(l.until)?;
        match self.function.node(self.function.region(l.until).results[0]) {
            Node::Bool(false) => {}
            _ => {
                self.line(&format!("if ({}) {{", until[0].text));
                self.line("    break;");
                self.line("}");
            }
        }
        let next = self.region(l.next)?;
        self.assign_together(l.next, &variables, &types, next);
        self.indent -= 1;
        self.line("}");
        self.bind_variables(v, variables);
        Ok(())
    }

    /// How many rounds a loop has: a number, or a setting, so often.
    fn rounds(&self, l: Loop) -> String {
        let Some(limit) = l.limit else { return l.count.to_string() };
        let setting = &self.context.symbols.uniforms[limit.uniform as usize];
        let rounds = match limit.times {
            1 => setting.clone(),
            times => Expression::infix(&Expression::number(times as f32), "*", setting, Level::Product),
        };
        Expression::call(self.context.dialect.int, &[rounds]).text
    }

    /// Gives every state variable its next value, as if all at once: a variable is assigned when no value that is
    /// still to be assigned needs it, and where each is needed by another, one value is put aside first.
    fn assign_together(
        &mut self,
        next: RegionId,
        variables: &[String],
        types: &[Type],
        values: Vec<Expression>,
    ) {
        let results = &self.function.region(next).results;
        let unchanged = |i: usize| self.function.node(results[i]) == Node::Argument(next, i as u16 + 1);
        let mut pending: Vec<(usize, Expression, Vec<usize>)> = values
            .into_iter()
            .enumerate()
            .filter(|(i, _)| !unchanged(*i))
            .map(|(i, value)| (i, value, self.states_in(next, results[i])))
            .collect();
        while !pending.is_empty() {
            let needed_elsewhere =
                |i: usize| pending.iter().any(|(j, _, needs)| *j != i && needs.contains(&i));
            match (0..pending.len()).find(|k| !needed_elsewhere(pending[*k].0)) {
                Some(k) => {
                    let (i, value, _) = pending.remove(k);
                    self.line(&format!("{} = {};", variables[i], value.text));
                }
                None => {
                    let (i, value, needs) = &mut pending[0];
                    let name = self.scope.give(&format!("next_{}", variables[*i]), "next");
                    needs.clear();
                    let text = std::mem::replace(value, Expression::atom(name.as_str())).text;
                    let ty = self.context.dialect.ty(types[*i]);
                    self.line(&(self.context.dialect.bind)(ty, &name, &text));
                }
            }
        }
    }

    /// The state variables that stand in the text of a value.
    fn states_in(&self, next: RegionId, value: Value) -> Vec<usize> {
        let mut states = Vec::new();
        let mut stack = vec![value];
        while let Some(v) = stack.pop() {
            match self.function.node(v) {
                Node::Argument(region, i) if region == next && i > 0 => states.push(i as usize - 1),
                _ if self.names.contains_key(&v) || self.variables.contains_key(&v) => {}
                _ => self.function.operands(v, |o| stack.push(o)),
            }
        }
        states
    }

    /// Declares the variables for the results of an `If` or a `Loop`. Each is named after its part of the tuple,
    /// or after its state.
    fn declare_variables(
        &mut self,
        v: Value,
        types: &[Type],
        states: &[Node],
        initial: &[Expression],
    ) -> Vec<String> {
        let single = self.function.name_of(v).map(|name| name.to_string());
        let mut variables = Vec::new();
        for (i, ty) in types.iter().enumerate() {
            let part = self.source_names.get(&Node::Result(v, i as u16));
            let state = states.get(i).and_then(|state| self.source_names.get(state));
            let name = single.as_ref().filter(|_| types.len() == 1).or(state).or(part);
            let name = self.scope.give(name.map_or("", |name| name), fallback(Some(*ty)));
            let value = initial.get(i).map(|value| value.text.as_str());
            self.line(&(self.context.dialect.variable)(self.context.dialect.ty(*ty), &name, value));
            variables.push(name);
        }
        variables
    }

    fn bind_variables(&mut self, v: Value, variables: Vec<String>) {
        if let ([variable], Some(_)) = (variables.as_slice(), self.function.type_of(v)) {
            self.names.insert(v, variable.clone());
        }
        self.variables.insert(v, variables);
    }
}

/// What a value without a name is called.
pub(crate) fn fallback(ty: Option<Type>) -> &'static str {
    match ty {
        Some(Type::Bool) => "c",
        Some(Type::Float) => "f",
        Some(Type::Vec2 | Type::Vec3) => "v",
        None => "r",
    }
}

// ---- expressions

impl<'a> Printer<'a> {
    fn type_of(&self, v: Value) -> Type {
        self.function.type_of(v).expect("a value that is used is no tuple")
    }

    /// The name of a value's type, a structure's for a call with several results.
    pub fn type_of_named(&self, v: Value) -> &'a str {
        match (self.function.node(v), self.function.type_of(v)) {
            (_, Some(ty)) => self.context.dialect.ty(ty),
            (Node::Call(callee, _), None) => self.structure(callee).0,
            (node, None) => unreachable!("{node:?} has no name"),
        }
    }

    fn structure(&self, callee: FunctionId) -> (&'a str, &'a [String]) {
        let structure = self.context.symbols.structures[callee.0 as usize].as_ref();
        let structure = structure.expect("a function with several results");
        (&structure.name, &structure.fields)
    }

    /// How a value is written where it is used.
    fn use_of(&self, v: Value) -> Result<Expression, EmitError> {
        match self.names.get(&v) {
            Some(name) => Ok(Expression::atom(name.as_str())),
            None => self.expression(v),
        }
    }

    fn uses(&self, list: List) -> Result<Vec<Expression>, EmitError> {
        self.function.list(list).iter().map(|v| self.use_of(*v)).collect()
    }

    /// The text that computes a value.
    fn expression(&self, v: Value) -> Result<Expression, EmitError> {
        let Context { symbols, .. } = *self.context;
        Ok(match self.function.node(v) {
            Node::Float(bits) => number(f64::from_bits(bits))?,
            Node::Bool(b) => Expression::atom(b.to_string()),
            Node::Argument(region, i) => self.arguments[&(region, i)].clone(),
            Node::Uniform(i) => symbols.uniforms[i as usize].clone(),
            Node::Global(i) => Expression::atom(symbols.globals[i as usize].as_str()),
            Node::Unary(op, a) => self.unary(op, a)?,
            Node::Binary(op, a, b) => self.binary(op, a, b)?,
            Node::Ternary(op, a, b, c) => self.ternary(op, a, b, c)?,
            Node::Compose2(x, y) => self.compose(Type::Vec2, &[x, y])?,
            Node::Compose3(x, y, z) => self.compose(Type::Vec3, &[x, y, z])?,
            Node::Component(a, i) => self.swizzle(a, &[i])?,
            Node::Call(callee, list) => {
                Expression::call(&symbols.functions[callee.0 as usize], &self.uses(list)?)
            }
            Node::Result(tuple, i) => match self.function.node(tuple) {
                Node::Call(callee, _) => {
                    Expression::member(&self.use_of(tuple)?, &self.structure(callee).1[i as usize])
                }
                _ => Expression::atom(self.variables[&tuple][i as usize].as_str()),
            },
            Node::If(..) | Node::Loop(_) => unreachable!("it is a statement"),
        })
    }

    fn unary(&self, op: Unary, a: Value) -> Result<Expression, EmitError> {
        let operand = self.use_of(a)?;
        let function = match op {
            Unary::Negate => return Ok(Expression::prefix("-", &operand)),
            Unary::Not => return Ok(Expression::prefix("!", &operand)),
            Unary::Abs => "abs",
            Unary::Sign => "sign",
            Unary::Floor => "floor",
            Unary::Ceil => "ceil",
            Unary::Round => self.context.dialect.round,
            Unary::Trunc => "trunc",
            Unary::Sqrt => "sqrt",
            Unary::Length => "length",
            Unary::PowerOfTwo | Unary::Exponent | Unary::Mantissa | Unary::ReduceAngle | Unary::Hash => {
                &bits::name(op, self.type_of(a)).expect("an operation on bits")
            }
            Unary::Sin
            | Unary::Cos
            | Unary::Tan
            | Unary::Asin
            | Unary::Acos
            | Unary::Atan
            | Unary::Exp
            | Unary::Exp2
            | Unary::Log
            | Unary::Log2
            | Unary::Tanh
            | Unary::Normalize => return Err(EmitError::not_basic(self.function, op)),
        };
        Ok(Expression::call(function, &[operand]))
    }

    fn binary(&self, op: Binary, a: Value, b: Value) -> Result<Expression, EmitError> {
        let operands = [self.use_of(a)?, self.use_of(b)?];
        let [left, right] = &operands;
        let infix = |operator, level| Ok(Expression::infix(left, operator, right, level));
        match op {
            Binary::Add => self.sum("+", left, b, right),
            Binary::Subtract => self.sum("-", left, b, right),
            Binary::Multiply => infix("*", Level::Product),
            Binary::Divide => infix("/", Level::Product),
            Binary::Less => infix("<", Level::Comparison),
            Binary::LessEqual => infix("<=", Level::Comparison),
            Binary::Equal => infix("==", Level::Comparison),
            Binary::And => Ok(Expression::logical(left, "&&", right, Level::And)),
            Binary::Or => Ok(Expression::logical(left, "||", right, Level::Or)),
            Binary::Min => Ok(Expression::call("min", &operands)),
            Binary::Max => Ok(Expression::call("max", &operands)),
            Binary::Dot => Ok(Expression::call("dot", &operands)),
            Binary::Cross => Ok(Expression::call("cross", &operands)),
            Binary::Modulo | Binary::Power | Binary::Atan2 => Err(EmitError::not_basic(self.function, op)),
        }
    }

    /// `a + b` or `a - b`; what is added negated is subtracted, and the other way round, which is the same to the bit.
    fn sum(
        &self,
        operator: &str,
        left: &Expression,
        b: Value,
        right: &Expression,
    ) -> Result<Expression, EmitError> {
        let opposite = if operator == "+" { "-" } else { "+" };
        let negated = match self.function.node(b) {
            Node::Unary(Unary::Negate, b) if right.level == Level::Prefix => Some(self.use_of(b)?),
            Node::Float(bits) if right.level == Level::Prefix => Some(number(-f64::from_bits(bits))?),
            _ => None,
        };
        Ok(match negated {
            Some(right) => Expression::infix(left, opposite, &right, Level::Sum),
            None => Expression::infix(left, operator, right, Level::Sum),
        })
    }

    fn ternary(&self, op: Ternary, a: Value, b: Value, c: Value) -> Result<Expression, EmitError> {
        let ty = self.function.type_of(b).unwrap_or(Type::Float);
        let [a, b, c] = [self.use_of(a)?, self.use_of(b)?, self.use_of(c)?];
        Ok(match op {
            Ternary::Select => (self.context.dialect.select)(ty, &a, &b, &c),
            Ternary::Mix => Expression::call("mix", &[a, b, c]),
        })
    }

    fn compose(&self, ty: Type, components: &[Value]) -> Result<Expression, EmitError> {
        let mut texts = Vec::new();
        for part in parts(self.function, components) {
            match part {
                Part::Float(v) => texts.push(self.use_of(v)?),
                Part::Swizzle(v, indices) if indices.len() == components.len() => {
                    return self.swizzle(v, &indices);
                }
                Part::Swizzle(v, indices) => texts.push(self.swizzle(v, &indices)?),
            }
        }
        Ok(Expression::call(self.context.dialect.ty(ty), &texts))
    }

    fn swizzle(&self, v: Value, indices: &[u8]) -> Result<Expression, EmitError> {
        // All of a vector, in order.
        if indices.iter().copied().eq(0..self.type_of(v).size() as u8) {
            return self.use_of(v);
        }
        let members: String = indices.iter().map(|i| ['x', 'y', 'z'][*i as usize]).collect();
        Ok(Expression::member(&self.use_of(v)?, &members))
    }
}

fn number(x: f64) -> Result<Expression, EmitError> {
    let x = x as f32;
    if x.is_finite() { Ok(Expression::number(x)) } else { Err(EmitError::NotFinite) }
}

/// A sentence in rows of at most about 100 characters.
fn wrapped(text: &str) -> Vec<String> {
    let mut rows = vec![String::new()];
    for word in text.split_whitespace() {
        let row = rows.last_mut().expect("there is a row");
        if row.is_empty() {
            row.push_str(word);
        } else if row.len() + word.len() < 100 {
            row.push(' ');
            row.push_str(word);
        } else {
            rows.push(word.to_string());
        }
    }
    rows
}
