//! `sdfc query scene.sdf x,y,z…`

use crate::arguments::QueryArguments;
use crate::compile::shader;
use crate::failure::Failure;
use crate::input;
use crate::output::print;
use crate::terminal::Terminal;
use rayon::prelude::*;
use sdfc::{Clock, Constant, Field, Frame, Options, Property, Sample};
use std::fmt::Write;
use std::io::{self, Read};

/// A point of space.
type Point = [f64; 3];

/// Prints the distance, the gradient and the material at points.
pub fn run(arguments: &QueryArguments, terminal: &Terminal) -> Result<(), Failure> {
    let from_input = arguments.points.iter().any(|point| point == "-");
    if from_input && input::is_dash(&arguments.scene) {
        return Err(Failure::call("the scene and the points cannot both come from standard input")
            .help("name the scene's file"));
    }
    let mut clock = Clock::default();
    let points = clock.time("read the points", || points(&arguments.points))?;
    let source = clock.time("read", || input::read(&arguments.scene, terminal))?;
    let options = Options { query: true, ..arguments.set.options(&arguments.scene)? };
    let compiled = sdfc::compile(&source.name, &source.text, &options, &mut clock);
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    shader(&compiled, terminal)?;
    let mut field = Field::new(&compiled).expect("a scene without mistakes has a field");
    field.set(&Frame { time: arguments.time, ..Frame::new(1, 1) });
    let samples = clock.time("evaluate", || field.sample(&points));
    if samples.iter().any(|sample| sample.distance == f64::INFINITY) {
        terminal.note("there is nothing in this scene: every point is infinitely far from it");
    }
    clock.time("write", || write(&points, &samples, arguments.json))?;
    if arguments.timings {
        terminal.timings(&clock);
    }
    Ok(())
}

/// The points that were named, those of standard input in the place of `-`.
fn points(named: &[String]) -> Result<Vec<Point>, Failure> {
    let mut points = Vec::new();
    for text in named {
        if text == "-" {
            points.extend(points_of_input()?);
        } else {
            let text = text.trim();
            points.push(point(text).ok_or_else(|| not_a_point(&format!("`{text}`")))?);
        }
    }
    Ok(points)
}

/// A point a line; a `#` begins a comment.
fn points_of_input() -> Result<Vec<Point>, Failure> {
    let cannot = |why: &str| Failure::call(format!("cannot read the points from standard input: {why}"));
    let mut bytes = Vec::new();
    io::stdin().lock().read_to_end(&mut bytes).map_err(|error| cannot(&sdfc::reason(&error)))?;
    let text = String::from_utf8(bytes).map_err(|_| cannot("it is no UTF-8 text"))?;
    let mut points = Vec::new();
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if !line.is_empty() {
            let what = || not_a_point(&format!("line {} of standard input, `{line}`,", i + 1));
            points.push(point(line).ok_or_else(what)?);
        }
    }
    Ok(points)
}

fn not_a_point(what: &str) -> Failure {
    Failure::call(format!("{what} is not a point"))
        .help("write three finite numbers with commas between them, such as 1,0.5,-2")
}

/// Three finite numbers, with commas or spaces between them.
fn point(text: &str) -> Option<Point> {
    let mut numbers = [0.0; 3];
    let mut parts: Vec<&str> = text.split(',').map(str::trim).collect();
    if parts.len() == 1 {
        parts = text.split_whitespace().collect();
    }
    if parts.len() != 3 {
        return None;
    }
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = part.parse().ok().filter(|x: &f64| x.is_finite())?;
    }
    Some(numbers)
}

/// Prints a line for each point. The lines are made by all cores, some at a time.
fn write(points: &[Point], samples: &[Sample], as_json: bool) -> Result<(), Failure> {
    /// How many lines one task makes, and how many are printed at once.
    const LINES: usize = 1024;
    const PRINTED: usize = 64 * LINES;

    let table = Table::of(samples);
    if let (false, Some(first)) = (as_json, samples.first()) {
        print(table.heads(first).as_bytes())?;
    }
    for (points, samples) in points.chunks(PRINTED).zip(samples.chunks(PRINTED)) {
        let parts = points.par_chunks(LINES).zip(samples.par_chunks(LINES));
        let lines = |(points, samples): (&[Point], &[Sample])| {
            let mut out = String::new();
            for (point, sample) in points.iter().zip(samples) {
                if as_json { json(&mut out, point, sample) } else { table.row(&mut out, point, sample) }
            }
            out
        };
        let parts: Vec<String> = parts.map(lines).collect();
        print(parts.concat().as_bytes())?;
    }
    Ok(())
}

/// An object on a line of its own. Infinite numbers are `null`, for which JSON has no other word.
fn json(out: &mut String, point: &Point, sample: &Sample) {
    fn number(out: &mut String, x: f64) {
        if x.is_finite() {
            put(out, format_args!("{x}"));
        } else {
            out.push_str("null");
        }
    }
    fn vector(out: &mut String, v: [f64; 3]) {
        for (i, x) in v.into_iter().enumerate() {
            out.push_str(if i == 0 { "[" } else { "," });
            number(out, x);
        }
        out.push(']');
    }
    out.push_str("{\"point\":");
    vector(out, *point);
    out.push_str(",\"distance\":");
    number(out, sample.distance);
    out.push_str(",\"gradient\":");
    vector(out, sample.gradient);
    for (i, (name, property)) in sample.material.properties().into_iter().enumerate() {
        let begin = if i == 0 { ",\"material\":{" } else { "," };
        put(out, format_args!("{begin}\"{name}\":"));
        match property {
            Property::Number(x) => number(out, x),
            Property::Color(c) => vector(out, c),
        }
    }
    out.push_str("}}\n");
}

/// Columns under their names. Of the material, the colour and what is not at its default everywhere.
struct Table {
    /// Which of the material's properties are shown.
    shown: Vec<bool>,
}

impl Table {
    fn of(samples: &[Sample]) -> Table {
        let differs = |i: usize, default: Constant| {
            samples.iter().any(|s| s.material.properties()[i].1.components() != default.components())
        };
        let defaults = sdf_lang::material_defaults().enumerate();
        Table { shown: defaults.map(|(i, (name, d))| name == "color" || differs(i, d)).collect() }
    }

    fn columns(&self, point: &Point, sample: &Sample) -> impl Iterator<Item = (&'static str, Property)> {
        let properties = sample.material.properties().into_iter().zip(&self.shown);
        let fields = [
            ("point", Property::Color(*point)),
            ("distance", Property::Number(sample.distance)),
            ("gradient", Property::Color(sample.gradient)),
        ];
        fields.into_iter().chain(properties.filter_map(|(property, shown)| shown.then_some(property)))
    }

    /// The names, each over the last of its numbers.
    fn heads(&self, first: &Sample) -> String {
        let mut out = String::new();
        for (name, property) in self.columns(&[0.0; 3], first) {
            let width = WIDTH * property.components().len();
            put(&mut out, format_args!("{name:>width$}"));
        }
        out + "\n"
    }

    fn row(&self, out: &mut String, point: &Point, sample: &Sample) {
        for (_, property) in self.columns(point, sample) {
            property.components().iter().for_each(|x| cell(out, *x));
        }
        out.push('\n');
    }
}

/// How wide a number's column is.
const WIDTH: usize = 13;

fn cell(out: &mut String, x: f64) {
    // Numbers that six decimals do not show well.
    if x != 0.0 && x.is_finite() && !(1e-4..1e5).contains(&x.abs()) {
        put(out, format_args!("{x:>WIDTH$.5e}"));
    } else {
        put(out, format_args!("{:>WIDTH$.6}", x + 0.0));
    }
}

fn put(out: &mut String, text: std::fmt::Arguments) {
    out.write_fmt(text).expect("writing to a string cannot fail");
}

#[cfg(test)]
mod tests {
    use super::point;

    #[test]
    fn points() {
        for text in ["1,-2.5,3e2", " 1, -2.5 ,3e2 ", "1 -2.5\t300", "+1,-2.5,300.0"] {
            assert_eq!(point(text), Some([1.0, -2.5, 300.0]), "{text}");
        }
        for wrong in
            ["", "1", "1,2", "1,2,3,4", "1,2,", "1,,2", "1 2", "1,2,x", "1,2,nan", "1,2,inf", "1,2,1e999"]
        {
            assert_eq!(point(wrong), None, "{wrong}");
        }
    }
}
