//! The library's page, `grammar/library.md`, and its pictures: both are made from the doc comments.

use crate::fields::run;
use crate::numbers::word;
use crate::scenes::{folder, legalised, scene};
use sdf_ir::region::Extent;
use sdf_lang::{Entry, Form, Group, Kind, Options, Section, glossary, kind_of, reference};
use sdf_render::{Frame, Picture};
use sdf_syntax::FileId;
use sdf_syntax::token::{Token, lex};
use std::fmt::Write;
use std::path::PathBuf;

/// The side of a picture, in pixels.
pub const SIDE: u32 = 128;
/// How many points of a pixel are drawn along each of its sides.
const POINTS: u32 = 2;

/// Where the page lies.
pub fn page_path() -> PathBuf {
    folder().join("../grammar/library.md")
}

/// Where the picture of a function lies.
pub fn picture_path(name: &str) -> PathBuf {
    folder().join(format!("../grammar/library/{name}.png"))
}

/// The page.
pub fn page() -> String {
    let (sections, groups) = (reference(), glossary());
    let mut out = String::from(
        "# The library\n\n\
         What the doc comments of [`std/`](../crates/sdf-lang/std) say; a test keeps this page and its pictures as they are there.\n\
         `sdfc doc NAME` prints an entry at the terminal. A parameter without a type is a float; `= v` is what it is if nothing\n\
         is given. Sizes are half-extents or radii and outer sizes; angles are in radians, and `45deg` is written for them.\n\n\
         [![The shapes of the library on one floor](../examples/gallery.png)](../examples/gallery.sdf)\n\n",
    );
    for section in &sections {
        let links: Vec<String> =
            section.entries.iter().map(|entry| format!("[{0}](#{0})", entry.name)).collect();
        writeln!(out, "* **{}**: {}", section.title, links.join(" · ")).expect("a string grows");
    }
    let words = groups.iter().map(|group| group.title);
    let words: Vec<String> = words.map(|title| format!("[{title}](#{})", anchor(title))).collect();
    writeln!(out, "* **Built in**: {}", words.join(" · ")).expect("a string grows");
    sections.iter().for_each(|section| out += &chapter(section));
    groups.iter().for_each(|group| out += &table(group));
    out
}

/// What a heading is called where it is linked to.
fn anchor(title: &str) -> String {
    let kept = title.chars().filter(|c| c.is_alphanumeric() || [' ', '-'].contains(c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

fn chapter(section: &Section) -> String {
    let mut out = format!("\n## {}\n\n", section.title);
    if section.introduction.trim_end_matches('.') != section.title {
        out += &format!("{}\n\n", section.introduction);
    }
    out += &format!("([`std/{0}`](../crates/sdf-lang/std/{0}))\n", section.file);
    for entry in &section.entries {
        let name = &entry.name;
        out += &format!(
            "\n### {name}\n\n<img src=\"library/{name}.png\" width=\"{SIDE}\" height=\"{SIDE}\" align=\"right\" alt=\"{name}\">\n"
        );
        entry.forms.iter().for_each(|form| out += &article(form));
        out += "\n<br clear=\"both\">\n";
    }
    out
}

/// What is said of one form.
fn article(form: &Form) -> String {
    let mut out = format!("\n```\n{}\n```\n\n{}\n", form.signature, form.summary);
    form.text.iter().for_each(|paragraph| out += &format!("\n{paragraph}\n"));
    let mut items: Vec<String> = Vec::new();
    for (names, meaning) in form.meanings() {
        items.push(format!("`{}`: {meaning}", names.join("`, `")));
    }
    if !form.promises.is_empty() {
        items.push(format!("*Contract*: {}", form.promises.join("; ")));
    }
    if !form.requirements.is_empty() {
        items.push(format!("*Requires*: {}", form.requirements.join("; ")));
    }
    items.extend(form.source.iter().map(|source| format!("*From*: {source}")));
    items.extend(form.examples.iter().map(|example| format!("*Example*: `{example}`")));
    out += "\n";
    items.iter().for_each(|item| out += &format!("* {item}\n"));
    out
}

/// Words that are built in.
fn table(group: &Group) -> String {
    let mut out = format!("\n## {}\n\n| | |\n|---|---|\n", group.title);
    for form in group.entries.iter().flat_map(|entry| &entry.forms) {
        let cell = |text: &str| text.replace('|', "\\|");
        writeln!(out, "| `{}` | {} |", cell(&form.signature), cell(&form.summary)).expect("a string grows");
    }
    out
}

/// The picture of a function: the first of its examples that is a shape of space, else one of the plane, else numbers.
pub fn picture(entry: &Entry) -> Picture {
    let text = picture_scene(entry);
    let program = scene(&entry.name, &text, &Options { attack: Some(0), ..Options::default() }).program;
    let program = legalised(&program, program.entry.expect("a pixel"));
    let side = SIDE * POINTS;
    smaller(&sdf_render::cpu::render(&program, &Frame::new(side, side)))
}

/// A picture whose pixels are the means of the points that were drawn of them.
fn smaller(drawn: &Picture) -> Picture {
    let mut rgba = Vec::new();
    for row in 0..SIDE {
        for column in 0..SIDE {
            let offsets = (0..POINTS * POINTS).map(|i| (i % POINTS, i / POINTS));
            let points = offsets.map(|(x, y)| drawn.pixel(column * POINTS + x, row * POINTS + y));
            let sums =
                points.fold([0u32; 4], |sums, point| std::array::from_fn(|i| sums[i] + u32::from(point[i])));
            rgba.extend(sums.map(|sum| ((sum + POINTS * POINTS / 2) / (POINTS * POINTS)) as u8));
        }
    }
    Picture { width: SIDE, height: SIDE, rgba }
}

/// What a function is shown as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum View {
    /// A solid, on a floor.
    Solid,
    /// An area, made solid.
    Area,
    /// A curve over the x axis, on a wall.
    Curve,
    /// Numbers at the points of a cube, as colours.
    Numbers,
    /// Colours at the points of a cube.
    Colors,
}

/// The source of a function's picture.
pub fn picture_scene(entry: &Entry) -> String {
    let examples: Vec<(&str, Kind)> = entry
        .forms
        .iter()
        .flat_map(|form| &form.examples)
        .map(|example| (&**example, kind_of(example).unwrap_or_else(|found| panic!("{example}: {found:#?}"))))
        .collect();
    let of_kind = |kind: Kind| examples.iter().find(|(_, k)| *k == kind);
    let first = of_kind(Kind::Shape).or(of_kind(Kind::Shape2)).or(examples.first());
    let (example, kind) = *first.unwrap_or_else(|| panic!("`{}` has no example", entry.name));
    let view = match kind {
        Kind::Shape => View::Solid,
        Kind::Shape2 => View::Area,
        Kind::Float if asks_for_x_alone(example) => View::Curve,
        Kind::Float => View::Numbers,
        Kind::Vec2 | Kind::Vec3 => View::Colors,
        kind => panic!("{example} cannot be drawn: it is a {kind:?}"),
    };
    let color = match view {
        View::Solid if entry.forms.iter().any(Form::is_operator) => "#d9822b",
        View::Solid => "#4f83cc",
        _ => "#3f9c7a",
    };
    match view {
        View::Solid => {
            on_floor(example, &format!("material {{ color: {color}, specular: 0.15 }}"), [1.0, 0.75, 1.5])
        }
        View::Area => on_floor(
            &format!("({example}).extrude(0.12)"),
            &format!("material {{ color: {color}, specular: 0.15 }}"),
            [0.45, 0.5, 1.6],
        ),
        View::Curve => {
            let ink = format!(
                "{{ let v = {example}; let line = if abs(p.y) < 0.012 || abs(p.x) < 0.012 {{ 0.5 }} else {{ 1 }};
                   (if p.y < v {{ {color} }} else {{ #f4f1ea }}) * line }}"
            );
            on_floor("box((1.5, 1.5, 0.05))", &format!("material {{ color: {ink} }}"), [0.2, 0.52, 1.6])
        }
        View::Numbers => {
            let ink = format!(
                "{{ let v = {example}; let t = clamp(v, -1, 1);
                   let ramp = if t < 0 {{ mix(#f4f1ea, #23689b, -t) }} else {{ mix(#f4f1ea, #c8553d, t) }};
                   ramp * (if abs(fract(v * 4 + 0.5) - 0.5) < 0.06 {{ 0.6 }} else {{ 1 }}) }}"
            );
            on_floor("box(1.5)", &format!("material {{ color: {ink} }}"), [1.0, 0.9, 1.5])
        }
        View::Colors => {
            let ink = if kind == Kind::Vec2 { format!("({example}, 0.5)") } else { example.to_string() };
            on_floor("box(1.5)", &format!("material {{ color: {ink} }}"), [1.0, 0.9, 1.5])
        }
    }
}

/// Whether an expression depends on the point's first coordinate and on nothing else of it.
fn asks_for_x_alone(expression: &str) -> bool {
    let tokens: Vec<Token> = lex(FileId(0), expression).tokens.into_iter().map(|(token, _)| token).collect();
    let points = (0..tokens.len()).filter(|i| tokens[*i] == Token::Name("p"));
    points.clone().count() > 0
        && points.into_iter().all(|i| tokens[i + 1..].starts_with(&[Token::Dot, Token::Name("x")]))
}

/// Where a shape without an end is cut off.
const END: f64 = 1.5;
/// Half of the angle that a picture shows, in degrees.
const HALF_VIEW: f64 = 14.0;
/// The part of a picture that the shape fills.
const FILLED: f64 = 0.84;

/// A scene of one shape, on a floor, seen from a direction. What has no end is cut off; what has none anywhere is also cut
/// open at the front.
fn on_floor(shape: &str, material: &str, direction: [f64; 3]) -> String {
    let text = format!("let subject = {shape}\nscene {{ subject }}\n");
    let options = Options { facts: true, attack: Some(0), ..Options::default() };
    let compilation = sdf_lang::compile("subject", &text, &options);
    let extent = match &compilation.scene {
        Some(scene) => scene.facts.iter().find(|fact| fact.name == "subject").expect("a row").extent,
        None => panic!("{shape}: {:#?}", compilation.diagnostics),
    };
    let is_open = extent.lo.iter().chain(&extent.hi).all(|end| end.is_infinite());
    let is_cut = !extent.is_empty() && extent.lo.iter().chain(&extent.hi).any(|end| end.is_infinite());
    let mut cut = if extent.is_empty() { Extent { lo: [-1.0; 3], hi: [1.0; 3] } } else { extent };
    for axis in 0..3 {
        // A side that has an end decides where the other is cut.
        let (lo, hi) = (cut.lo[axis], cut.hi[axis]);
        cut.lo[axis] = if lo.is_finite() { lo } else { hi.min(END) - 2.0 * END };
        cut.hi[axis] = if hi.is_finite() { hi } else { cut.lo[axis].max(-END) + 2.0 * END };
    }
    if is_open {
        cut.hi[2] = 0.0;
    }
    let centre: [f64; 3] = std::array::from_fn(|i| (cut.lo[i] + cut.hi[i]) / 2.0);
    let half: [f64; 3] = std::array::from_fn(|i| (cut.hi[i] - cut.lo[i]) / 2.0);
    let vector = |v: [f64; 3]| format!("({:.4}, {:.4}, {:.4})", v[0], v[1], v[2]);
    let clip =
        if is_cut { format!(" & box({}).at({})", vector(half), vector(centre)) } else { String::new() };
    let sampled = sampled(&format!("({shape}){clip}"), &cut);
    let size = half.into_iter().fold(0.0, f64::max);
    // What has no inside is shown with a little thickness: from the edge nothing of it would be seen.
    let is_thin = !extent.is_empty() && sampled.iter().all(|(_, distance)| *distance > 0.0);
    let rounding = if is_thin { 0.015 * size } else { 0.0 };
    let shown =
        if is_thin { format!("(subject{clip}).round({rounding:.4})") } else { format!("subject{clip}") };
    let filled = sampled.iter().filter(|(_, distance)| *distance <= 0.02 * size);
    let mut points: Vec<[f64; 3]> = filled.map(|(point, _)| *point).collect();
    if points.is_empty() {
        points = vec![cut.lo, cut.hi];
    }
    let (eye, target) = stand(&points, centre, direction);
    let floor = cut.lo[1] - rounding - 0.002 * half[1];
    format!(
        "camera {{ eye: {eye}, target: {target}, fov: {fov}deg }}
light key {{ direction: (1.2, 3, 2.2), color: #fff4e4, intensity: 0.85, shadow: soft(10) }}
ambient {{ color: 0.42, occlusion: 0.7 }}
render {{ tolerance: 0.5 }}
sky {{ color: #e8e4dc }}
let subject = {shape}
let shown = {shown}
scene {{ shown.paint({material}), plane().at(0, {floor:.4}, 0).paint(#cfcac0) }}
",
        eye = vector(eye),
        target = vector(target),
        fov = 2.0 * HALF_VIEW,
    )
}

/// How many points of a box are looked at.
const SAMPLES: usize = 1 << 15;

/// Points of a box, and the distances of a shape there.
fn sampled(shape: &str, within: &Extent) -> Vec<([f64; 3], f64)> {
    let any = |i: usize, axis: usize| f64::from(word((3 * i + axis) as u64)) / f64::from(u32::MAX);
    let column = |axis: usize| -> Vec<f64> {
        (0..SAMPLES).map(|i| within.lo[axis] + (within.hi[axis] - within.lo[axis]) * any(i, axis)).collect()
    };
    let columns: Vec<Vec<f64>> = (0..3).map(column).collect();
    let options = Options { attack: Some(0), ..Options::default() };
    let scene = scene("shape", &format!("let subject = {shape}\nscene {{ subject }}\n"), &options);
    let distances = match scene.map {
        Some(map) => run::<f64>(&legalised(&scene.program, map), &columns).remove(0),
        None => vec![f64::INFINITY; SAMPLES],
    };
    let point = |i: usize| std::array::from_fn(|axis| columns[axis][i]);
    distances.into_iter().enumerate().map(|(i, distance)| (point(i), distance)).collect()
}

/// Where the eye is to stand, and where it is to look, so that points just fit into the picture.
fn stand(points: &[[f64; 3]], centre: [f64; 3], direction: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let unit = |a: [f64; 3]| a.map(|x| x / dot(a, a).sqrt());
    let along = |from: [f64; 3], by: f64, way: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| from[i] + by * way[i])
    };
    let back = unit(direction);
    let right = unit([back[2], 0.0, -back[0]]);
    let up = [
        back[1] * right[2] - back[2] * right[1],
        back[2] * right[0] - back[0] * right[2],
        back[0] * right[1] - back[1] * right[0],
    ];
    let middle = |way: [f64; 3]| {
        let places = points.iter().map(|point| dot(*point, way));
        let (lo, hi) = places.fold((f64::MAX, f64::MIN), |(lo, hi), x| (lo.min(x), hi.max(x)));
        (lo + hi) / 2.0 - dot(centre, way)
    };
    let target = along(along(centre, middle(right), right), middle(up), up);
    let slope = HALF_VIEW.to_radians().tan() * FILLED;
    let distances = points.iter().map(|point| {
        let offset: [f64; 3] = std::array::from_fn(|i| point[i] - target[i]);
        dot(offset, back) + dot(offset, right).abs().max(dot(offset, up).abs()) / slope
    });
    (along(target, distances.fold(0.1, f64::max), back), target)
}
