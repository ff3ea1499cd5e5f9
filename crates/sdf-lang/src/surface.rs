//! What a surface looks like: materials, and how a field mixes those of the shapes that it samples.
//!
//! At a point of a surface a field mixes the materials of its samples by share, |∂field/∂distance| of each. The
//! shares come from the field's own formula, differentiated: `min` and `max` pick one, blends mix with their own
//! weights. An unpainted tool, whose share is negative, is left out, so that a carved face shows the carved body.

use crate::context::Op;
use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::ranges::{AT_LEAST_ONE, NOT_NEGATIVE, POSITIVE, Range, SHARE};
use crate::scene::parts_of_union;
use crate::signs::Signs;
use crate::value::{Env, Material, Number, Repr, Shape, ShapeKind, Value};
use sdf_ir::{Binary, Builder, Constant, Node, Ternary, Type, Unary};
use sdf_syntax::Span;
use sdf_syntax::tree::{Block, Record};
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

/// A property of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Column {
    Color,
    Specular,
    Shininess,
    Emission,
    Glow,
    GlowRadius,
    Reflect,
    Transmit,
    Ior,
    /// 1 where a material is not the same everywhere: no user's word, but what antialiasing asks for.
    Pattern,
}

impl Column {
    /// What a material can say.
    pub const ALL: [Column; 9] = [
        Column::Color,
        Column::Specular,
        Column::Shininess,
        Column::Emission,
        Column::Glow,
        Column::GlowRadius,
        Column::Reflect,
        Column::Transmit,
        Column::Ior,
    ];

    /// What decides about light that comes from the surface, and about rays that go on from it.
    pub const OF_SURFACE: [Column; 7] = [
        Column::Color,
        Column::Specular,
        Column::Shininess,
        Column::Emission,
        Column::Reflect,
        Column::Transmit,
        Column::Ior,
    ];

    /// What decides about the glow round it.
    pub const OF_GLOW: [Column; 2] = [Column::Glow, Column::GlowRadius];

    pub fn name(self) -> &'static str {
        match self {
            Column::Color => "color",
            Column::Specular => "specular",
            Column::Shininess => "shininess",
            Column::Emission => "emission",
            Column::Glow => "glow",
            Column::GlowRadius => "glow_radius",
            Column::Reflect => "reflect",
            Column::Transmit => "transmit",
            Column::Ior => "ior",
            Column::Pattern => "pattern",
        }
    }

    /// The value where a material does not say.
    pub fn default(self) -> Constant {
        match self {
            Column::Color => Constant::Vec3([0.8; 3]),
            Column::Specular => Constant::Float(0.2),
            Column::Shininess => Constant::Float(32.0),
            Column::Emission | Column::Glow => Constant::Vec3([0.0; 3]),
            Column::GlowRadius => Constant::Float(0.25),
            Column::Reflect | Column::Transmit | Column::Pattern => Constant::Float(0.0),
            Column::Ior => Constant::Float(1.5),
        }
    }

    /// The values that it may have, if not all.
    fn range(self) -> Option<Range> {
        match self {
            Column::Specular => Some(NOT_NEGATIVE),
            Column::Shininess | Column::GlowRadius => Some(POSITIVE),
            Column::Reflect | Column::Transmit => Some(SHARE),
            Column::Ior => Some(AT_LEAST_ONE),
            Column::Color | Column::Emission | Column::Glow | Column::Pattern => None,
        }
    }
}

/// A distance that a field took while its materials are looked up.
#[derive(Debug)]
pub(crate) struct Sample<'t> {
    shape: Rc<Shape<'t>>,
    point: Number,
    /// The distance, outside the field's own formula.
    outside: sdf_ir::Value,
    distance: Number,
    /// What stands for it in the formula.
    stand_in: sdf_ir::Value,
}

/// The materials at a point, mixed.
enum Mix {
    /// Nothing there is painted.
    Bare,
    /// The sum of the painted parts' properties, each times its weight, and the weight of the bare part. All
    /// weights together are 1.
    Painted { columns: Vec<Number>, bare: Number },
}

/// The mix of the nearest one of several shapes, and its distance.
struct Nearest {
    size: Number,
    columns: Vec<Number>,
    bare: Number,
}

/// A sample with its material and its share of the field.
struct Part {
    mix: Mix,
    share: Number,
    distance: Number,
    /// Whether it can only carve.
    is_tool: bool,
}

impl<'t> Elaborator<'t> {
    /// `surface(s, p, n)`: a record of the properties of the material at a point of the surface, those of `asked`.
    pub fn surface(
        &mut self,
        asked: &[Column],
        shape: &Rc<Shape<'t>>,
        point: &Number,
        normal: &Number,
        span: Span,
    ) -> Eval<Value<'t>> {
        if self.contexts.depth() == 0 {
            return self.report(errors::not_static(span, "whether there is a surface here"));
        }
        self.find_columns(shape, point, normal, span)?;
        self.columns.retain(|c| asked.contains(c));
        let name: Arc<str> = Arc::from("surface");
        self.contexts.open(&name, None);
        let doc = "What the material at a point of the surface is like.";
        self.contexts.describe(Some(Arc::from(doc)));
        let p = self.contexts.parameter(&Arc::from("p"), point, true);
        let n = self.contexts.parameter(&Arc::from("n"), normal, false);
        let found = self.asking(|this| {
            let record = this.surface_record(asked, shape, &p, &n, span)?;
            this.flatten(&record, span)
        });
        match found {
            Ok(((record, numbers), is_asked)) => {
                if is_asked && self.calls_a_field() {
                    self.contexts.builder().set_evaluation(true);
                }
                Ok(self.close_with(&name, &record, numbers))
            }
            Err(reported) => {
                self.contexts.discard();
                Err(reported)
            }
        }
    }

    /// The record of the properties in use, the others being their defaults.
    pub fn surface_record(
        &mut self,
        asked: &[Column],
        shape: &Rc<Shape<'t>>,
        point: &Number,
        normal: &Number,
        span: Span,
    ) -> Eval<Value<'t>> {
        let mix = self.mix(shape, point, normal, span)?;
        let bare_weight = match &mix {
            Mix::Bare => Number::float(1.0),
            Mix::Painted { bare, .. } => bare.clone(),
        };
        let columns: Vec<Column> = self.columns.iter().copied().collect();
        let mut fields = Vec::new();
        for column in asked.iter().copied() {
            let default = Number::constant(column.default());
            let value = match (&mix, columns.iter().position(|c| *c == column)) {
                (Mix::Painted { columns, .. }, Some(i)) => {
                    let bare = self.times(&default, &bare_weight);
                    self.contexts.apply(Op::Binary(Binary::Add), &[columns[i].clone(), bare])
                }
                _ => default,
            };
            let name: Arc<str> = Arc::from(column.name());
            fields.push((name.clone(), Value::Number(value.named(&name))));
        }
        Ok(Value::record(fields))
    }

    /// The properties that differ from their defaults somewhere on a shape's surface.
    pub fn columns_of(&mut self, shape: &Rc<Shape<'t>>) -> Eval<BTreeSet<Column>> {
        if !shape.painted {
            return Ok(BTreeSet::new());
        }
        self.contexts.open(&Arc::from("columns"), None);
        let point = self.contexts.entry_parameter("p", Type::Vec3);
        let found = self.find_columns(shape, &point, &point, Span::default());
        self.contexts.discard();
        found.map(|()| std::mem::take(&mut self.columns))
    }

    /// Notes which properties of the shape's materials differ from their defaults; the others cost nothing.
    pub fn find_columns(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        normal: &Number,
        span: Span,
    ) -> Eval<()> {
        self.columns.clear();
        self.column_causes.clear();
        self.finding_columns = true;
        self.contexts.open(&Arc::from("columns"), None);
        let p = self.contexts.parameter(&Arc::from("p"), point, true);
        let n = self.contexts.parameter(&Arc::from("n"), normal, false);
        let found = self.mix(shape, &p, &n, span);
        self.contexts.discard();
        self.finding_columns = false;
        found.map(|_| ())
    }

    fn mix(&mut self, shape: &Rc<Shape<'t>>, point: &Number, normal: &Number, span: Span) -> Eval<Mix> {
        if !shape.painted {
            return Ok(Mix::Bare);
        }
        if let parts @ [_, _, ..] = &parts_of_union(shape)[..] {
            return self.mix_of_union(parts, point, normal, span);
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } => self.mix(inner, point, normal, span),
            ShapeKind::Painted { shape: inner, material } => {
                let columns = self.properties(material, inner, point, normal, span)?;
                match self.mix(inner, point, normal, span)? {
                    Mix::Bare => Ok(Mix::Painted { columns, bare: Number::float(0.0) }),
                    Mix::Painted { columns: under, bare } => {
                        let columns = self.add_weighted(&under, &columns, &bare);
                        Ok(Mix::Painted { columns, bare: Number::float(0.0) })
                    }
                }
            }
            ShapeKind::Union { shapes } => self.mix_of_union(&shapes.clone(), point, normal, span),
            ShapeKind::Choice { condition, then, otherwise } => {
                let (condition, then, otherwise) = (condition.clone(), then.clone(), otherwise.clone());
                self.mix_samples(point, normal, span, move |this, p| {
                    this.chosen_distance(&condition, [&then, &otherwise], p, span)
                })
            }
            ShapeKind::Field { block, env, .. } => {
                let (block, env): (&'t Block, Env<'t>) = (block, env.clone());
                self.mix_samples(point, normal, span, move |this, p| this.field_value(block, &env, p))
            }
        }
    }

    /// The value of a formula, and the distances that it samples.
    fn noting_samples<T>(&mut self, formula: impl FnOnce(&mut Self) -> T) -> (T, Vec<Sample<'t>>) {
        let saved = self.samples.replace(Vec::new());
        let result = formula(self);
        (result, std::mem::replace(&mut self.samples, saved).unwrap_or_default())
    }

    /// A formula in a function that is left open, with what it samples.
    fn open_formula(
        &mut self,
        name: &str,
        formula: impl FnOnce(&mut Self) -> Eval<Number>,
    ) -> Eval<(sdf_ir::Value, Vec<Sample<'t>>)> {
        self.contexts.open(&Arc::from(name), None);
        match self.noting_samples(formula) {
            (Ok(n), samples) => Ok((self.contexts.value(&n), samples)),
            (Err(reported), _) => {
                self.contexts.discard();
                Err(reported)
            }
        }
    }

    /// What a formula samples: each shape, where, and the distance found there.
    pub fn samples_of(
        &mut self,
        formula: impl FnOnce(&mut Self) -> Eval<Number>,
    ) -> Eval<Vec<(Rc<Shape<'t>>, Number, Number)>> {
        self.contexts.open(&Arc::from("samples"), None);
        let (result, samples) = self.noting_samples(formula);
        self.contexts.discard();
        result.map(|_| samples.into_iter().map(|s| (s.shape, s.point, s.distance)).collect())
    }

    /// The shape that a formula is, elsewhere: where it gives nothing but one distance that it samples.
    pub fn only_sample(
        &mut self,
        formula: impl FnOnce(&mut Self) -> Eval<Number>,
    ) -> Eval<Option<(Rc<Shape<'t>>, Number)>> {
        let (result, samples) = self.open_formula("sample", formula)?;
        self.contexts.discard();
        Ok(match <[Sample; 1]>::try_from(samples) {
            Ok([only]) if only.stand_in == result => Some((only.shape, only.point)),
            _ => None,
        })
    }

    /// A field's formula as a function of what it uses, and the nodes that the innermost function passes for it; and
    /// what it samples: each shape, where, and what stands for the distance in the formula.
    #[expect(clippy::type_complexity, reason = "each part has one meaning, which the sentence above says")]
    pub fn formula_of_samples(
        &mut self,
        block: &'t Block,
        env: &Env<'t>,
        point: &Number,
    ) -> Eval<(sdf_ir::Function, Vec<sdf_ir::Value>, Vec<(Rc<Shape<'t>>, Number, sdf_ir::Value)>)> {
        let (result, samples) = self.open_formula("formula", |this| this.field_value(block, env, point))?;
        let (function, arguments) = self.contexts.finish_apart(vec![result]);
        Ok((function, arguments, samples.into_iter().map(|s| (s.shape, s.point, s.stand_in)).collect()))
    }

    /// The mix of the materials of what a formula samples.
    fn mix_samples(
        &mut self,
        point: &Number,
        normal: &Number,
        span: Span,
        formula: impl FnOnce(&mut Self, &Number) -> Eval<Number>,
    ) -> Eval<Mix> {
        let takes_apart = std::mem::replace(&mut self.facts.takes_apart, false);
        let opened = self.open_formula("shares", |this| formula(this, point));
        self.facts.takes_apart = takes_apart;
        let (result, samples) = opened?;
        if let [only] = &samples[..] {
            self.contexts.discard();
            return self.mix(&only.shape, &only.point, normal, span);
        }
        if !is_straight(self.contexts.builder()) {
            self.contexts.discard();
            return self.report(errors::no_shares(span));
        }
        let stand_ins: Vec<_> = samples.iter().map(|s| s.stand_in).collect();
        let builder = self.contexts.builder();
        let adjoints = sdf_ir::adjoint::adjoints(builder, result, &stand_ins);
        let zero = builder.float(0.0);
        let shares: Vec<_> = adjoints.into_iter().map(|a| a.unwrap_or(zero)).collect();
        let mut signs = Signs::default();
        let tools: Vec<bool> = shares
            .iter()
            .map(|share| signs.of(builder, *share).never_positive && !is_zero(builder, *share))
            .collect();
        let (function, arguments) = self.contexts.finish_apart(shares);
        let depth = self.contexts.depth();
        let shares = self.contexts.builder().inline(&function, &arguments);
        let mut parts = Vec::new();
        // The unpainted tools are left out before anything is computed for them.
        for ((sample, share), is_tool) in samples.iter().zip(shares).zip(tools) {
            if is_tool && !sample.shape.painted {
                continue;
            }
            let share = self.contexts.local(depth, share, Type::Float);
            let mix = self.mix(&sample.shape, &sample.point, normal, span)?;
            parts.push(Part { mix, share, distance: sample.distance.clone(), is_tool });
        }
        Ok(self.blend(parts))
    }

    /// The parts together, by share.
    fn blend(&mut self, mut parts: Vec<Part>) -> Mix {
        if parts.iter().all(|p| matches!(p.mix, Mix::Bare)) {
            return Mix::Bare;
        }
        if parts.len() == 1 {
            return parts.remove(0).mix;
        }
        let count = self.columns.len();
        let mut total = Number::float(0.0);
        let mut bare_sum = Number::float(0.0);
        let mut sums: Vec<Number> =
            self.columns.iter().map(|c| Number::constant(zero_of(c.default()))).collect();
        for part in &parts {
            let positive =
                self.contexts.apply(Op::Binary(Binary::Max), &[part.share.clone(), Number::float(0.0)]);
            match &part.mix {
                Mix::Bare => {
                    total = self.plus(&total, &positive);
                    bare_sum = self.plus(&bare_sum, &positive);
                }
                Mix::Painted { columns, bare } => {
                    let weight =
                        self.contexts.apply(Op::Unary(Unary::Abs), std::slice::from_ref(&part.share));
                    for (sum, column) in sums.iter_mut().zip(columns).take(count) {
                        let weighted = self.times(column, &weight);
                        *sum = self.plus(sum, &weighted);
                    }
                    let painted = self.minus(&Number::float(1.0), bare);
                    let painted = self.times(&weight, &painted);
                    let bare_part = self.times(&positive, bare);
                    let both = self.plus(&painted, &bare_part);
                    total = self.plus(&total, &both);
                    bare_sum = self.plus(&bare_sum, &bare_part);
                }
            }
        }
        if total.known() == Some(Constant::Float(1.0)) {
            return Mix::Painted { columns: sums, bare: bare_sum };
        }
        let nearest = self.nearest(&parts);
        let none = self.contexts.apply(Op::Binary(Binary::LessEqual), &[total.clone(), Number::float(0.0)]);
        let (near_columns, near_bare) = match nearest {
            Mix::Bare => (
                self.columns.iter().map(|c| Number::constant(zero_of(c.default()))).collect(),
                Number::float(1.0),
            ),
            Mix::Painted { columns, bare } => (columns, bare),
        };
        let columns = sums
            .into_iter()
            .zip::<Vec<Number>>(near_columns)
            .map(|(sum, near)| {
                let mean = self.contexts.apply(Op::Binary(Binary::Divide), &[sum, total.clone()]);
                self.contexts.apply(Op::Ternary(Ternary::Select), &[none.clone(), near, mean])
            })
            .collect();
        let bare = self.contexts.apply(Op::Binary(Binary::Divide), &[bare_sum, total]);
        let bare = self.contexts.apply(Op::Ternary(Ternary::Select), &[none, near_bare, bare]);
        Mix::Painted { columns, bare }
    }

    /// The part whose distance is nearest to zero; a tool only where there is nothing else, since what an unpainted
    /// tool has carved, which is where no other part has a share, shows the carved body.
    fn nearest(&mut self, parts: &[Part]) -> Mix {
        let mut best: Option<Nearest> = None;
        let only_tools = parts.iter().all(|p| p.is_tool);
        let mut signs = Signs::default();
        for part in parts.iter().filter(|p| only_tools || !p.is_tool) {
            let mut size = self.contexts.apply(Op::Unary(Unary::Abs), std::slice::from_ref(&part.distance));
            let share = self.contexts.value(&part.share);
            if !only_tools && !signs.of(self.contexts.builder(), share).never_negative {
                let zero = Number::float(0.0);
                let carves = self.contexts.apply(Op::Binary(Binary::Less), &[part.share.clone(), zero]);
                let far = Number::float(crate::NOTHING);
                size = self.contexts.apply(Op::Ternary(Ternary::Select), &[carves, far, size]);
            }
            let mix = match &part.mix {
                Mix::Bare => Mix::Bare,
                Mix::Painted { columns, bare } => {
                    Mix::Painted { columns: columns.clone(), bare: bare.clone() }
                }
            };
            best = Some(self.keep_nearer(best, size, mix));
        }
        match best {
            None => Mix::Bare,
            Some(Nearest { columns, bare, .. }) => Mix::Painted { columns, bare },
        }
    }

    /// The nearer one of two mixes; of those that are as near the first.
    fn keep_nearer(&mut self, best: Option<Nearest>, size: Number, mix: Mix) -> Nearest {
        let (columns, bare) = match mix {
            Mix::Bare => {
                let zeros = self.columns.iter().map(|c| Number::constant(zero_of(c.default())));
                (zeros.collect(), Number::float(1.0))
            }
            Mix::Painted { columns, bare } => (columns, bare),
        };
        let Some(best) = best else { return Nearest { size, columns, bare } };
        let keep = self.contexts.apply(Op::Binary(Binary::LessEqual), &[best.size.clone(), size.clone()]);
        let mut choose =
            |a: Number, b: Number| self.contexts.apply(Op::Ternary(Ternary::Select), &[keep.clone(), a, b]);
        let columns = best.columns.into_iter().zip(columns).map(|(a, b)| choose(a, b)).collect();
        let bare = choose(best.bare, bare);
        Nearest { size: choose(best.size, size), columns, bare }
    }

    /// The mix of a union: that of the nearest shape, as the shares of `min` say.
    fn mix_of_union(
        &mut self,
        shapes: &[Rc<Shape<'t>>],
        point: &Number,
        normal: &Number,
        span: Span,
    ) -> Eval<Mix> {
        let mut best = None;
        for shape in shapes {
            let distance = self.sample(shape, point, span)?;
            let mix = self.mix(shape, point, normal, span)?;
            best = Some(self.keep_nearer(best, distance, mix));
        }
        Ok(best.map_or(Mix::Bare, |Nearest { columns, bare, .. }| Mix::Painted { columns, bare }))
    }

    /// The properties of a material at a point of a painted shape, one for each column in use.
    fn properties(
        &mut self,
        material: &Rc<Material<'t>>,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        normal: &Number,
        span: Span,
    ) -> Eval<Vec<Number>> {
        let mut values: Vec<(Column, Number)> = Vec::new();
        match &**material {
            Material::Color(color) => {
                self.note_property(Column::Color, color, None);
                values.push((Column::Color, color.clone()));
            }
            Material::Record { record, env } => {
                let env = self.material_env(record, env, shape, point, normal, span)?;
                let mut failed = None;
                for field in &record.fields {
                    match self.property(field, &env) {
                        Ok((column, value)) => {
                            self.note_property(column, &value, Some(field.value.span));
                            values.push((column, value));
                        }
                        Err(reported) => failed = Some(reported),
                    }
                }
                if let Some(reported) = failed {
                    return Err(reported);
                }
            }
        }
        for (amount, manner) in [(Column::Transmit, Column::Ior), (Column::Glow, Column::GlowRadius)] {
            let own = values.iter().find(|(column, _)| *column == amount);
            if own.is_none_or(|(_, value)| value.known() == Some(amount.default())) {
                // How something is done that is not.
                values.retain(|(column, _)| *column != manner);
            }
        }
        if values.iter().any(|(_, value)| value.is_local()) {
            let pattern = Number::float(1.0);
            self.note_property(Column::Pattern, &pattern, None);
            values.push((Column::Pattern, pattern));
        }
        let columns: Vec<Column> = self.columns.iter().copied().collect();
        Ok(columns
            .into_iter()
            .map(|c| {
                let own = values.iter().find(|(v, _)| *v == c).map(|(_, n)| n.clone());
                own.unwrap_or(Number::constant(c.default()))
            })
            .collect())
    }

    /// Notes a property of a material that may differ from its default, while these are being looked for.
    fn note_property(&mut self, column: Column, value: &Number, span: Option<Span>) {
        let is_zero = |c: Constant| c.components().iter().all(|x| *x == 0.0);
        let differs = match is_zero(column.default()) {
            true => self.finding_columns && self.may_be_nonzero(value),
            false => value.known() != Some(column.default()),
        };
        if self.finding_columns && differs && !self.unseen_columns.contains(&column) {
            self.columns.insert(column);
            self.note_column(column, value, span);
        }
    }

    /// Finds what is wrong in a material, painted or not.
    pub fn check_material(&mut self, material: &Material<'t>) -> Eval<()> {
        let Material::Record { record, env } = material else { return Ok(()) };
        self.contexts.open(&Arc::from("material"), None);
        let point = self.contexts.entry_parameter("p", Type::Vec3);
        let normal = self.contexts.entry_parameter("n", Type::Vec3);
        let env = env.bind(Arc::from("p"), Value::Number(point)).bind(Arc::from("n"), Value::Number(normal));
        let mut seen: Vec<&sdf_syntax::tree::Name> = Vec::new();
        let mut done = Ok(());
        for field in &record.fields {
            if let Some(first) = seen.iter().find(|name| name.text == field.name.text) {
                done = self.report(errors::setting_twice(&field.name, first.span));
                continue;
            }
            seen.push(&field.name);
            done = self.property(field, &env).map(|_| ()).and(done);
        }
        self.contexts.discard();
        done
    }

    fn property(&mut self, field: &'t sdf_syntax::tree::Field, env: &Env<'t>) -> Eval<(Column, Number)> {
        let all: Vec<&str> = Column::ALL.iter().map(|c| c.name()).collect();
        let Some(column) = Column::ALL.into_iter().find(|c| c.name() == &*field.name.text) else {
            let similar = sdf_syntax::did_you_mean(&field.name.text, all.iter().copied());
            return self.report(errors::unknown_setting(&field.name, "material", similar, &all));
        };
        let value = self.eval(&field.value, env)?;
        let number = self.as_typed(value, column.default().ty(), field.value.span)?;
        if let Some(range) = column.range() {
            self.check_range(&number, field.value.span, &format!("`{}`", column.name()), range)?;
        }
        Ok((column, number))
    }

    /// The variables of a material: `p` and `n` in the frame in which the painted shape is sampled.
    fn material_env(
        &mut self,
        record: &'t Record,
        env: &Env<'t>,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        normal: &Number,
        span: Span,
    ) -> Eval<Env<'t>> {
        let mut out = env.bind(Arc::from("p"), Value::Number(point.clone()));
        if record.fields.iter().any(|f| crate::value::mentions(&f.value, "n")) {
            // The normal of the painted shape itself, in its own frame; the scene's where it has none.
            let own = match self.gradient(shape, point, span)? {
                Value::Record(r) => match r.get("gradient") {
                    Some(Value::Number(g)) => g.clone(),
                    _ => normal.clone(),
                },
                _ => normal.clone(),
            };
            let own = self.unary(Unary::Normalize, &own, span)?;
            out = out.bind(Arc::from("n"), Value::Number(own));
        }
        Ok(out)
    }

    /// Notes a sample and gives what stands for it in the formula of the field that took it.
    pub fn note_sample(
        &mut self,
        samples: &mut Vec<Sample<'t>>,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        distance: Number,
    ) -> Number {
        let depth = self.contexts.depth();
        if matches!(&distance.repr, Repr::Local(d, _) if *d == depth) {
            // Its point depends on another sample of the same field: it has no material of its own.
            return distance;
        }
        let outside = self.contexts.import(&distance, depth - 1);
        if let Some(same) = samples.iter().find(|s| s.outside == outside && Rc::ptr_eq(&s.shape, shape)) {
            return self.contexts.local(depth, same.stand_in, Type::Float);
        }
        let at_caller = self.contexts.local(depth - 1, outside, Type::Float);
        let stand_in = self.contexts.stand_in(outside);
        samples.push(Sample {
            shape: shape.clone(),
            point: point.clone(),
            outside,
            distance: at_caller,
            stand_in,
        });
        self.contexts.local(depth, stand_in, Type::Float)
    }

    fn times(&mut self, a: &Number, b: &Number) -> Number {
        self.contexts.apply(Op::Binary(Binary::Multiply), &[a.clone(), b.clone()])
    }

    fn plus(&mut self, a: &Number, b: &Number) -> Number {
        self.contexts.apply(Op::Binary(Binary::Add), &[a.clone(), b.clone()])
    }

    fn minus(&mut self, a: &Number, b: &Number) -> Number {
        self.contexts.apply(Op::Binary(Binary::Subtract), &[a.clone(), b.clone()])
    }

    fn add_weighted(&mut self, base: &[Number], added: &[Number], weight: &Number) -> Vec<Number> {
        base.iter()
            .zip(added)
            .map(|(b, a)| {
                let part = self.times(a, weight);
                self.plus(b, &part)
            })
            .collect()
    }
}

fn zero_of(c: Constant) -> Constant {
    Constant::from_components(&vec![0.0; c.ty().size()])
}

/// Whether a formula has no branches, loops or calls in it.
fn is_straight(builder: &Builder) -> bool {
    let function = builder.function();
    function
        .root()
        .body
        .iter()
        .all(|v| !matches!(function.node(*v), Node::Call(..) | Node::If(..) | Node::Loop(_)))
}

fn is_zero(builder: &Builder, v: sdf_ir::Value) -> bool {
    builder.constant_of(v) == Some(Constant::Float(0.0))
}
