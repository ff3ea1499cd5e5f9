//! Programs as text, for people who look into the compiler, and for snapshots. One node a line.

use crate::program::{Binary, Function, Loop, Node, Program, RegionId, Ternary, Type, Unary, Value};
use std::fmt::{self, Display, Formatter};

impl Display for Type {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Type::Bool => "bool",
            Type::Float => "float",
            Type::Vec2 => "vec2",
            Type::Vec3 => "vec3",
        })
    }
}

impl Display for Program {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (index, uniform) in self.uniforms.iter().enumerate() {
            writeln!(f, "uniform u{index} {}: {} = {:?}", uniform.name, uniform.ty, uniform.default)?;
        }
        for (index, global) in self.globals.iter().enumerate() {
            writeln!(f, "global g{index} {}: {}", global.name, global.ty)?;
        }
        for (role, id) in [("frame", self.frame), ("entry", self.entry)] {
            if let Some(id) = id {
                writeln!(f, "{role} f{}", id.0)?;
            }
        }
        for (index, function) in self.functions.iter().enumerate() {
            write!(f, "\nf{index}: {function}")?;
        }
        Ok(())
    }
}

impl Display for Function {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let parameters = self.parameters.iter().map(|p| {
            let point = if p.point { " point" } else { "" };
            format!("{}: {}{point}", p.name, p.ty)
        });
        let results = self
            .result_types()
            .into_iter()
            .zip(&self.result_names)
            .map(|(ty, name)| if name.is_empty() { ty.to_string() } else { format!("{name}: {ty}") });
        writeln!(f, "fn {}({}) -> {}", self.name, join(parameters), join(results))?;
        self.write_region(f, RegionId::ROOT, 1)
    }
}

impl Function {
    fn write_region(&self, f: &mut Formatter<'_>, id: RegionId, depth: usize) -> fmt::Result {
        let region = self.region(id);
        for value in &region.body {
            write!(f, "{:1$}", "", 2 * depth)?;
            self.write_node(f, *value, depth)?;
        }
        writeln!(f, "{:1$}yield {2}", "", 2 * depth, self.shown(&region.results))
    }

    fn write_node(&self, f: &mut Formatter<'_>, value: Value, depth: usize) -> fmt::Result {
        match self.type_of(value) {
            Some(ty) => write!(f, "{}: {ty} = ", self.show(value))?,
            None => write!(f, "{} = ", self.show(value))?,
        }
        match self.node(value) {
            Node::If(condition, then, otherwise) => {
                writeln!(f, "if {}", self.show(condition))?;
                self.write_region(f, then, depth + 1)?;
                writeln!(f, "{:1$}else", "", 2 * depth)?;
                self.write_region(f, otherwise, depth + 1)
            }
            Node::Loop(Loop { count, limit, initial, until, next }) => {
                let setting =
                    limit.map_or_else(String::new, |limit| format!(" ({} u{})", limit.times, limit.uniform));
                writeln!(f, "at most {count}{setting} rounds from {}", self.shown(self.list(initial)))?;
                writeln!(f, "{:1$}until {2}", "", 2 * depth, self.header(until))?;
                self.write_region(f, until, depth + 1)?;
                writeln!(f, "{:1$}next {2}", "", 2 * depth, self.header(next))?;
                self.write_region(f, next, depth + 1)
            }
            node => writeln!(f, "{}", self.operation(node)),
        }
    }

    fn operation(&self, node: Node) -> String {
        let call = |name: &dyn fmt::Debug, operands: &[Value]| {
            format!("{}({})", format!("{name:?}").to_lowercase(), self.shown(operands))
        };
        match node {
            Node::Unary(Unary::Negate, a) => format!("-{}", self.show(a)),
            Node::Unary(Unary::Not, a) => format!("!{}", self.show(a)),
            Node::Unary(op, a) => call(&op, &[a]),
            Node::Binary(op, a, b) => match infix(op) {
                Some(sign) => format!("{} {sign} {}", self.show(a), self.show(b)),
                None => call(&op, &[a, b]),
            },
            Node::Ternary(Ternary::Select, c, a, b) => {
                format!("{} ? {} : {}", self.show(c), self.show(a), self.show(b))
            }
            Node::Ternary(op @ Ternary::Mix, a, b, c) => call(&op, &[a, b, c]),
            Node::Compose2(x, y) => format!("({})", self.shown(&[x, y])),
            Node::Compose3(x, y, z) => format!("({})", self.shown(&[x, y, z])),
            Node::Component(a, index) => format!("{}.{}", self.show(a), ["x", "y", "z"][index as usize]),
            Node::Call(callee, list) => format!("f{}({})", callee.0, self.shown(self.list(list))),
            Node::Result(tuple, index) => format!("{}[{index}]", self.show(tuple)),
            Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_) => {
                unreachable!("leaves stand in no body")
            }
            Node::If(..) | Node::Loop(_) => unreachable!("written with their regions"),
        }
    }

    /// The arguments of a region, as its nodes name them.
    fn header(&self, region: RegionId) -> String {
        let arguments = self.region(region).arguments.iter().enumerate();
        join(arguments.map(|(index, ty)| format!("r{}.{index}: {ty}", region.0)))
    }

    fn shown(&self, values: &[Value]) -> String {
        join(values.iter().map(|value| self.show(*value)))
    }

    /// What a value is called in the text.
    fn show(&self, value: Value) -> String {
        match self.node(value) {
            Node::Float(bits) => format!("{}", f64::from_bits(bits)),
            Node::Bool(it) => it.to_string(),
            Node::Argument(RegionId::ROOT, index) => self.parameters[index as usize].name.to_string(),
            Node::Argument(region, index) => format!("r{}.{index}", region.0),
            Node::Uniform(index) => format!("u{index}"),
            Node::Global(index) => format!("g{index}"),
            _ => format!("{}%{}", self.name_of(value).map_or("", |name| name), value.0),
        }
    }
}

fn infix(op: Binary) -> Option<&'static str> {
    Some(match op {
        Binary::Add => "+",
        Binary::Subtract => "-",
        Binary::Multiply => "*",
        Binary::Divide => "/",
        Binary::Modulo => "%",
        Binary::Less => "<",
        Binary::LessEqual => "<=",
        Binary::Equal => "==",
        Binary::And => "&&",
        Binary::Or => "||",
        Binary::Min | Binary::Max | Binary::Power | Binary::Atan2 | Binary::Dot | Binary::Cross => {
            return None;
        }
    })
}

fn join(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use crate::build::Builder;
    use crate::constant::Constant;
    use crate::program::{Binary, Global, Parameter, Program, RegionId, Role, Type, Unary, Uniform};

    #[test]
    fn a_program_reads_as_a_listing() {
        let mut program = Program {
            uniforms: vec![Uniform {
                name: "time".into(),
                ty: Type::Float,
                role: Role::Time,
                default: Constant::Float(0.0),
            }],
            globals: vec![Global { name: "turn".into(), ty: Type::Float }],
            ..Program::default()
        };
        let mut b = Builder::new("frame", vec![]);
        let time = b.uniform(0, Type::Float);
        let turn = b.unary(Unary::Sin, time);
        program.frame = Some(program.add(b.finish(vec![(turn, "turn".into())])));
        let point = Parameter { name: "p".into(), ty: Type::Vec3, point: true };
        let mut b = Builder::new("carved", vec![point]);
        let p = b.argument(RegionId::ROOT, 0);
        let half = b.constant(Constant::Vec3([1.0, 2.0, 3.5]));
        let q = b.sub(p, half);
        b.name(q, &"q".into());
        let (x, turn) = (b.component(q, 0), b.global(0, Type::Float));
        let left = b.binary(Binary::Less, x, turn);
        let then = b.open_region(&[]);
        let length = b.unary(Unary::Length, q);
        b.close_region(vec![length, x]);
        let otherwise = b.open_region(&[]);
        let largest = b.max(x, turn);
        b.close_region(vec![largest, turn]);
        let parts = b.branch(left, then, otherwise);
        let until = b.open_region(&[Type::Float]);
        let state = b.argument(until, 0);
        let small = b.binary(Binary::LessEqual, state, turn);
        b.close_region(vec![small]);
        let next = b.open_region(&[Type::Float, Type::Float]);
        let (round, state) = (b.argument(next, 0), b.argument(next, 1));
        let smaller = b.div(state, round);
        b.close_region(vec![smaller]);
        let last = b.repeat(8, &[parts[0]], until, next)[0];
        program.entry = Some(program.add(b.finish(vec![(last, "distance".into()), (parts[1], "".into())])));
        insta::assert_snapshot!(program);
    }
}
