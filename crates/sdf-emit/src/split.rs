//! Long functions are printed as several: compilers of shaders take more than linear time in a function's length.
//!
//! A run of statements becomes a function of what it needs, which returns what is needed after it.

use crate::EmitError;
use crate::expression::Expression;
use crate::function::{Printer, fallback};
use rustc_hash::{FxHashMap, FxHashSet};
use sdf_ir::{Node, RegionId, Value};

/// How many statements a function has at most.
const FUNCTION: usize = 512;
/// How many a region inside a function has at most, so that whatever holds it can be cut between such regions.
const REGION: usize = 128;
/// How many statements a part is made to have, and how many parts a function at most; more are cut again.
const PART: usize = 400;
const PARTS: usize = 64;

/// Something that has a text from outside of a run of statements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Item {
    /// A value with a name.
    Value(Value),
    /// A variable that an `If` or a `Loop` leaves a part of its results in.
    Variable(Value, u16),
    /// An argument of a region.
    Argument(RegionId, u16),
}

impl Printer<'_> {
    /// Prints the statements of a region, in functions of their own where they are too many.
    pub fn statements(&mut self, region: RegionId) -> Result<(), EmitError> {
        let plan = self.plan;
        let values: Vec<Value> = plan.order(region).iter().copied().filter(|v| plan.is_named(*v)).collect();
        let results = self.function.region(region).results.clone();
        let limit = if region == RegionId::ROOT { FUNCTION } else { REGION };
        let needed = self.needs(&[], &results);
        self.run(&values, &needed, limit - results.len().min(REGION / 2))
    }

    fn run(&mut self, values: &[Value], needed: &[Item], limit: usize) -> Result<(), EmitError> {
        let total: usize = values.iter().map(|v| self.weight(*v)).sum();
        if total <= limit || values.len() == 1 {
            return values.iter().try_for_each(|v| self.statement(*v));
        }
        let most = PART.max(total.div_ceil(PARTS));
        let mut parts: Vec<&[Value]> = Vec::new();
        let mut rest = values;
        while !rest.is_empty() {
            let mut sum = 0;
            let fits = |v: &&Value| {
                sum += self.weight(**v);
                sum <= most
            };
            let (part, after) = rest.split_at(rest.iter().take_while(fits).count().max(1));
            parts.push(part);
            rest = after;
        }
        let yields = self.yields(&parts, needed);
        parts.into_iter().zip(yields).try_for_each(|(part, yields)| self.part(part, &yields))
    }

    /// What each of these parts defines that is needed after it, in the order of the first use.
    fn yields(&self, parts: &[&[Value]], needed: &[Item]) -> Vec<Vec<Item>> {
        let all = || parts.iter().enumerate().flat_map(|(i, part)| part.iter().map(move |v| (i, *v)));
        let part_of: FxHashMap<Value, usize> = all().map(|(i, v)| (v, i)).collect();
        let mut yields = vec![Vec::new(); parts.len()];
        let mut seen = FxHashSet::default();
        let mut use_after = |i: usize, item: Item| {
            if let Item::Value(v) | Item::Variable(v, _) = item
                && let Some(defined) = part_of.get(&v)
                && *defined < i
                && seen.insert(item)
            {
                yields[*defined].push(item);
            }
        };
        let mut needs = Needs::of(self);
        for (i, v) in all() {
            needs.statements(&[v]);
            needs.items.drain(..).for_each(|item| use_after(i, item));
            needs.values.clear();
            needs.regions.clear();
        }
        needed.iter().for_each(|item| use_after(parts.len(), *item));
        yields
    }

    /// How many statements a value takes, when the regions inside it are cut.
    fn weight(&self, v: Value) -> usize {
        let regions = self.function.owned_regions(v).into_iter();
        let inner =
            |r| self.plan.order(r).iter().filter(|v| self.plan.is_named(**v)).map(|v| self.weight(*v)).sum();
        let yields = |r| self.function.region(r).results.len();
        let own = 1 + self.function.types_of(v).len();
        own + regions.map(|r| REGION.min(inner(r)) + yields(r)).sum::<usize>()
    }

    /// What these statements and uses need from outside, in the order of the first use.
    fn needs(&self, statements: &[Value], uses: &[Value]) -> Vec<Item> {
        let mut needs = Needs::of(self);
        needs.statements(statements);
        uses.iter().for_each(|v| needs.use_of(*v));
        let mut seen = FxHashSet::default();
        needs.items.retain(|item| seen.insert(*item));
        needs.items
    }

    /// Prints statements as a function before this one, and a call of it here.
    fn part(&mut self, statements: &[Value], yields: &[Item]) -> Result<(), EmitError> {
        let dialect = self.context.dialect;
        let function = self.context.symbols.functions[self.id.0 as usize].clone();
        self.part_count.set(self.part_count.get() + 1);
        let name = self.scope.give(&format!("{function}_part_{}", self.part_count.get()), "part");
        let takes = self.needs(statements, &[]);
        let mut inner = self.part_printer();
        let (mut parameters, mut arguments) = (Vec::new(), Vec::new());
        for item in takes {
            let argument = self.text(item);
            // The last member of `r.t` is its name in the part.
            let wanted = argument.text.rsplit('.').next().unwrap_or_default().replace(['(', ')'], "_");
            let parameter = inner.scope.give(&wanted, fallback(None));
            parameters.push((dialect.declare)(&self.type_name(item), &parameter));
            inner.rename(item, parameter);
            arguments.push(argument);
        }
        let types: Vec<String> = yields.iter().map(|item| self.type_name(*item)).collect();
        let single = types.len() == 1;
        let result = if single { types[0].clone() } else { self.scope.give(&format!("{name}_results"), "r") };
        inner.line(&format!("{} {{", (dialect.function)(&name, &parameters.join(", "), Some(&result))));
        inner.indent += 1;
        inner.run(statements, yields, FUNCTION)?;
        let results: Vec<Expression> = yields.iter().map(|item| inner.text(*item)).collect();
        let returned =
            if single { results[0].text.clone() } else { Expression::call(&result, &results).text };
        inner.line(&format!("return {returned};"));
        inner.indent -= 1;
        inner.line("}");
        let Printer { out, parts, .. } = inner;
        self.parts.extend(parts);
        let call = Expression::call(&name, &arguments).text;
        if single {
            let local = self.scope.give(&results[0].text, fallback(None));
            self.line(&(dialect.bind)(&result, &local, &call));
            self.rename(yields[0], local);
            self.parts.push(out);
            return Ok(());
        }
        let local = self.scope.give("r", "r");
        self.line(&(dialect.bind)(&result, &local, &call));
        let (member_end, end) = dialect.structure;
        let mut structure = format!("struct {result} {{\n");
        for (i, (item, ty)) in yields.iter().zip(&types).enumerate() {
            structure += &format!("    {}{member_end}\n", (dialect.declare)(ty, &format!("part_{i}")));
            self.rename(*item, format!("{local}.part_{i}"));
        }
        self.parts.push(format!("{structure}{end}\n\n{out}"));
        Ok(())
    }

    /// How an item is written here.
    fn text(&self, item: Item) -> Expression {
        match item {
            Item::Value(v) => Expression::atom(self.names[&v].as_str()),
            Item::Variable(v, i) => Expression::atom(self.variables[&v][i as usize].as_str()),
            Item::Argument(region, i) => self.arguments[&(region, i)].clone(),
        }
    }

    /// From now on an item is written so.
    fn rename(&mut self, item: Item, text: String) {
        match item {
            Item::Value(v) => drop(self.names.insert(v, text)),
            Item::Variable(v, i) => {
                let parts = self.function.types_of(v).len();
                self.variables.entry(v).or_insert_with(|| vec![String::new(); parts])[i as usize] = text;
            }
            Item::Argument(region, i) => drop(self.arguments.insert((region, i), Expression::atom(text))),
        }
    }

    fn type_name(&self, item: Item) -> String {
        let dialect = self.context.dialect;
        match item {
            Item::Value(v) => self.type_of_named(v).to_owned(),
            Item::Variable(v, i) => dialect.ty(self.function.types_of(v)[i as usize]).to_owned(),
            Item::Argument(region, i) => {
                dialect.ty(self.function.region(region).arguments[i as usize]).to_owned()
            }
        }
    }
}

/// Finds what statements need from outside.
struct Needs<'p, 'a> {
    printer: &'p Printer<'a>,
    /// The named values and the regions that are printed with the statements.
    values: FxHashSet<Value>,
    regions: FxHashSet<RegionId>,
    items: Vec<Item>,
}

impl<'p, 'a> Needs<'p, 'a> {
    fn of(printer: &'p Printer<'a>) -> Needs<'p, 'a> {
        Needs { printer, values: FxHashSet::default(), regions: FxHashSet::default(), items: Vec::new() }
    }

    fn statements(&mut self, statements: &[Value]) {
        self.values.extend(statements);
        statements.iter().for_each(|v| self.text_of(*v));
    }

    /// The text of a value where it is used.
    fn use_of(&mut self, v: Value) {
        let printer = self.printer;
        match printer.function.node(v) {
            Node::Argument(region, i) if !self.regions.contains(&region) => {
                self.items.push(Item::Argument(region, i));
            }
            Node::Result(tuple, i) if printer.function.owned_regions(tuple).len() == 2 => {
                if !self.values.contains(&tuple) {
                    self.items.push(Item::Variable(tuple, i));
                }
            }
            _ if self.values.contains(&v) => {}
            _ if printer.plan.is_named(v) => self.items.push(Item::Value(v)),
            _ => self.text_of(v),
        }
    }

    /// The text that computes a value.
    fn text_of(&mut self, v: Value) {
        let printer = self.printer;
        printer.function.operands(v, |operand| self.use_of(operand));
        for region in printer.function.owned_regions(v) {
            self.regions.insert(region);
            let named = printer.plan.order(region).iter().copied().filter(|v| printer.plan.is_named(*v));
            self.statements(&named.collect::<Vec<_>>());
            printer.function.region(region).results.iter().for_each(|v| self.use_of(*v));
        }
    }
}
