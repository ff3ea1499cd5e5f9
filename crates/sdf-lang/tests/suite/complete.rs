//! Nothing of the language is without a test: every built-in function, constant, setting and attribute has a row.

use crate::scene::{compile, compile_with, described};
use sdf_ir::Constant;
use sdf_lang::vocabulary;
use std::collections::BTreeSet;

/// The names of rows, against those that the language has; a name may have several rows.
#[track_caller]
fn covers<'a>(rows: impl IntoIterator<Item = String>, all: impl IntoIterator<Item = &'a str>) {
    let rows: BTreeSet<String> = rows.into_iter().collect();
    let all: BTreeSet<String> = all.into_iter().map(str::to_string).collect();
    let missing: Vec<_> = all.difference(&rows).collect();
    let spare: Vec<_> = rows.difference(&all).collect();
    assert!(
        missing.is_empty() && spare.is_empty(),
        "without a row: {missing:?}; not of the language: {spare:?}"
    );
}

/// The value of a float expression that depends on the point of a field, `a b c` being its coordinates.
fn value(expr: &str, [a, b, c]: [f64; 3]) -> f64 {
    let text = format!(
        "let ball = sphere(1) let red = ball.paint(#ff0000)
        @lipschitz(1) let probe = field {{
            let a = p.x; let b = p.y; let c = p.z; if a > 1e15 {{ 77.125 }} else {{ {expr} }}
        }}
        scene {{ probe }}"
    );
    let compilation = compile(&text, &[]);
    let scene =
        compilation.scene.as_ref().unwrap_or_else(|| panic!("{expr}: {:#?}", described(&compilation)));
    let uniforms: Vec<Constant> = scene.program.uniforms.iter().map(|u| u.default).collect();
    let point = Constant::Vec3([a, b, c]);
    sdf_ir::eval::point(&scene.program, scene.map.unwrap(), &[point], &uniforms)[0].components()[0]
}

/// Built-in functions, in calls with what each parameter is there for, and the values.
const FUNCTIONS: &[(&str, &str, [f64; 3], f64)] = &[
    ("abs", "abs(a)", [-3.0, 0.0, 0.0], 3.0),
    ("sign", "sign(a) + sign(b) * 10 + sign(c) * 100", [-3.0, 0.0, 2.0], 99.0),
    ("floor", "floor(a)", [-1.5, 0.0, 0.0], -2.0),
    ("ceil", "ceil(a)", [-1.5, 0.0, 0.0], -1.0),
    ("round", "round(a) + round(b) * 10", [0.5, 1.5, 0.0], 20.0),
    ("trunc", "trunc(a)", [-1.5, 0.0, 0.0], -1.0),
    ("fract", "fract(a)", [-1.25, 0.0, 0.0], 0.75),
    ("min", "min(a, b, c) + min([b, c]) * 10", [3.0, 4.0, 2.0], 22.0),
    ("max", "max(a, b, c) + max([b, c]) * 10", [3.0, 1.0, 2.0], 23.0),
    ("sum", "sum(a, b, c) + sum([b, c]) * 10", [3.0, 1.0, 2.0], 36.0),
    ("clamp", "clamp(a, b, c)", [5.0, 1.0, 2.0], 2.0),
    ("mix", "mix(a, b, c)", [1.0, 3.0, 0.25], 1.5),
    ("step", "step(a, b) + step(b, a) * 10", [1.0, 2.0, 0.0], 1.0),
    ("smoothstep", "smoothstep(a, b, c)", [0.0, 2.0, 0.5], 0.156_25),
    ("sqrt", "sqrt(a)", [4.0, 0.0, 0.0], 2.0),
    ("pow", "pow(a, b)", [2.0, 10.0, 0.0], 1024.0),
    ("exp", "exp(a)", [1.0, 0.0, 0.0], std::f64::consts::E),
    ("exp2", "exp2(a)", [3.0, 0.0, 0.0], 8.0),
    ("log", "log(a)", [2.0, 0.0, 0.0], std::f64::consts::LN_2),
    ("log2", "log2(a)", [8.0, 0.0, 0.0], 3.0),
    ("sin", "sin(a)", [std::f64::consts::FRAC_PI_2, 0.0, 0.0], 1.0),
    ("cos", "cos(a)", [std::f64::consts::PI, 0.0, 0.0], -1.0),
    ("tan", "tan(a)", [std::f64::consts::FRAC_PI_4, 0.0, 0.0], 1.0),
    ("asin", "asin(a)", [1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2),
    ("acos", "acos(a)", [-1.0, 0.0, 0.0], std::f64::consts::PI),
    ("atan", "atan(a)", [1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_4),
    ("atan", "atan(a, b)", [1.0, -1.0, 0.0], 3.0 * std::f64::consts::FRAC_PI_4),
    ("tanh", "tanh(a)", [0.5, 0.0, 0.0], 0.462_117_157_260_009_76),
    ("length", "length((a, b)) + length((a, b, c))", [3.0, 4.0, 12.0], 18.0),
    ("distance", "distance((a, b), (b, a))", [0.0, 1.0, 0.0], std::f64::consts::SQRT_2),
    ("dot", "dot((a, b, c), (c, b, a))", [1.0, 2.0, 3.0], 10.0),
    ("cross", "cross((a, b, c), x).y", [1.0, 2.0, 3.0], 3.0),
    ("normalize", "normalize((a, b, c)).x", [3.0, 0.0, 4.0], 0.6),
    ("reflect", "reflect((a, b, c), y).y", [1.0, -2.0, 3.0], 2.0),
    ("refract", "refract((a, b, c), y, 1).x", [0.6, -0.8, 0.0], 0.6),
    (
        "hash",
        "(if hash(a) >= 0 && hash((a, b)) < 1 && hash((a, b, c)) < 1 { 1 } else { 0 })",
        [1.0, 2.0, 3.0],
        1.0,
    ),
    ("len", "len([a, b]) + len([])", [1.0, 2.0, 3.0], 2.0),
    ("map", "sum([a, b, c].map(|v| v * v))", [1.0, 2.0, 3.0], 14.0),
    ("fold", "fold([a, b, c], 0, |acc, v| acc * 10 + v)", [1.0, 2.0, 3.0], 123.0),
    ("iterate", "iterate(5, a, |i, s| s + i, until: |s| s > b)", [1.0, 3.0, 0.0], 4.0),
    ("rotated", "rotated((-b, a, c), (a, b, c), 90deg, z).x", [3.0, 4.0, 5.0], -4.0),
    ("paint", "ball.paint(#ff0000)(a, b, c)", [3.0, 0.0, 0.0], 2.0),
    ("outlined", "outlined(smin(ball, box(1), k: 0))(a, b, c)", [4.0, 0.0, 0.0], 3.0),
    (
        "gradient",
        "gradient(ball, (a, b, c)).gradient.y + gradient(ball, (a, b, c)).distance",
        [0.0, 3.0, 0.0],
        3.0,
    ),
    (
        "approach",
        "approach(ball, (a, b, c)).distance + approach(ball, (a, b, c)).stride * 10",
        [0.0, 3.0, 0.0],
        22.0,
    ),
    ("stride", "stride(ball, (a, b, c))", [0.0, 3.0, 0.0], 2.0),
    (
        "surface",
        "surface(red, (a, b, c), x).color.r + surface(red, (a, b, c), x).color.g",
        [1.0, 0.0, 0.0],
        1.0,
    ),
    ("properties", "properties(red, (a, b, c), x).ior", [1.0, 0.0, 0.0], 1.5),
    ("patterned", "patterned(red, (a, b, c), x).pattern", [1.0, 0.0, 0.0], 0.0),
    ("seams", "seams(red - sphere(0.95), (a, b, c), 0.2)", [1.0, 0.0, 0.0], 2.0),
    ("surrounding", "surrounding(red, (a, b, c), x).glow_radius", [1.0, 0.0, 0.0], 0.25),
];

#[test]
fn every_built_in_function_has_a_row() {
    let words = vocabulary();
    let rows = FUNCTIONS.iter().map(|(name, ..)| name.to_string());
    covers(rows, words.built_in.iter().copied().filter(|name| !OF_SHAPES.contains(name)));
    let mut wrong = Vec::new();
    for (name, expr, given, expected) in FUNCTIONS {
        assert!(expr.contains(&format!("{name}(")), "{expr} does not call {name}");
        let found = value(expr, *given);
        if (found - expected).abs() > 1e-12 * expected.abs().max(1.0) {
            wrong.push(format!("{expr} of {given:?} is {found} and not {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Built-in functions of what is proved about shapes, which have suites of their own.
const OF_SHAPES: [&str; 10] =
    ["lo", "hi", "reach", "slope", "most", "any_cell", "is_even", "turned", "mirrored", "reflected"];

#[test]
fn every_constant_has_a_row() {
    let rows = [
        ("pi", "pi", std::f64::consts::PI),
        ("tau", "tau", std::f64::consts::TAU),
        ("x", "x.x + x.y * 10 + x.z * 100", 1.0),
        ("y", "y.x + y.y * 10 + y.z * 100", 10.0),
        ("z", "z.x + z.y * 10 + z.z * 100", 100.0),
        ("time", "time", 0.0),
        ("mouse", "mouse.x + mouse.y * 10", 5.5),
    ];
    covers(rows.iter().map(|(name, ..)| name.to_string()), vocabulary().constants);
    for (_, expr, expected) in rows {
        assert_eq!(value(expr, [0.0; 3]), expected, "{expr}");
    }
}

/// What comes of a setting.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Outcome {
    /// The program becomes another.
    Changes,
    /// It sets what nothing calls for.
    Nothing,
}

/// A field of a block with a value that it can have, what comes of it, and a value that it cannot have with the
/// code of what is said then.
type Setting = (&'static str, &'static str, &'static str, Outcome, &'static str, &'static str);

const SETTINGS: &[Setting] = &[
    ("camera", "eye", "(1, 2, 3)", Outcome::Changes, "true", "E030"),
    ("camera", "target", "(1, 2, 3)", Outcome::Changes, "sphere(1)", "E030"),
    ("camera", "up", "(1, 1, 0)", Outcome::Changes, "(1, 2)", "E030"),
    ("camera", "fov", "60deg", Outcome::Changes, "60", "E043"),
    ("camera", "orbit", "true", Outcome::Changes, "1", "E030"),
    ("camera", "projection", "orthographic", Outcome::Changes, "isometric", "E063"),
    ("light", "direction", "(3, 1, 1)", Outcome::Changes, "0", "E063"),
    ("light", "position", "(3, 1, 1)", Outcome::Changes, "true", "E030"),
    ("light", "color", "#ff0000", Outcome::Changes, "(1, 2)", "E030"),
    ("light", "intensity", "2", Outcome::Changes, "(1, 2, 3)", "E030"),
    ("light", "shadow", "soft(8)", Outcome::Changes, "soft(-1)", "E043"),
    ("ambient", "color", "0.5", Outcome::Changes, "false", "E030"),
    ("ambient", "occlusion", "0.5", Outcome::Changes, "-1", "E043"),
    ("ambient", "radius", "0.25", Outcome::Changes, "0", "E043"),
    ("sky", "color", "p", Outcome::Changes, "p.x < 0", "E030"),
    ("sky", "horizon", "#ff0000", Outcome::Changes, "sphere(1)", "E030"),
    ("sky", "zenith", "#ff0000", Outcome::Changes, "(1, 2)", "E030"),
    ("fog", "color", "#ff0000", Outcome::Changes, "true", "E030"),
    ("fog", "density", "0.1", Outcome::Changes, "-0.1", "E043"),
    ("rim", "color", "#ff0000", Outcome::Changes, "true", "E030"),
    ("rim", "power", "2", Outcome::Changes, "0", "E043"),
    ("render", "tolerance", "0.5", Outcome::Changes, "0", "E043"),
    ("render", "steps", "64", Outcome::Changes, "64.5", "E043"),
    ("render", "far", "50", Outcome::Changes, "time", "E040"),
    ("render", "normals", "central", Outcome::Changes, "smooth", "E063"),
    ("render", "relax", "none", Outcome::Changes, "no", "E063"),
    ("render", "shadow_accuracy", "0.05", Outcome::Changes, "0", "E043"),
    ("render", "occlusion_samples", "8", Outcome::Changes, "0.5", "E043"),
    ("render", "bounces", "3", Outcome::Nothing, "17", "E043"),
    ("render", "antialias", "2", Outcome::Changes, "2.5", "E043"),
    ("render", "tonemap", "aces", Outcome::Changes, "filmic", "E063"),
    ("render", "quality", "draft", Outcome::Changes, "best", "E063"),
    ("material", "color", "p", Outcome::Changes, "(1, 2)", "E030"),
    ("material", "specular", "0.5", Outcome::Changes, "-0.5", "E043"),
    ("material", "shininess", "8", Outcome::Changes, "0", "E043"),
    ("material", "emission", "#ff0000", Outcome::Changes, "true", "E030"),
    ("material", "glow", "#ff0000", Outcome::Changes, "sphere(1)", "E030"),
    ("material", "glow_radius", "0.5", Outcome::Changes, "0", "E043"),
    ("material", "reflect", "0.5", Outcome::Changes, "2", "E043"),
    ("material", "transmit", "0.5", Outcome::Changes, "-1", "E043"),
    ("material", "ior", "1.3", Outcome::Changes, "0.5", "E043"),
];

/// A scene with one field of one block, and what that field needs beside it.
fn scene_with(block: &str, field: &str) -> String {
    let (name, beside) = match (block, field.split(':').next().unwrap()) {
        ("light", "direction" | "position") => ("l", ""),
        ("light", _) => ("l", "direction: (1, 2, 3),"),
        ("material", "glow_radius") => ("m", "glow: 1,"),
        ("material", "ior") => ("m", "transmit: 1,"),
        ("material", _) => ("m", ""),
        ("ambient", "radius") => ("", "occlusion: 1,"),
        ("fog", "color") => ("", "density: 0.1,"),
        ("rim", "power") => ("", "color: 1,"),
        ("sky", "horizon") => ("", "zenith: 1,"),
        ("sky", "zenith") => ("", "horizon: 1,"),
        _ => ("", ""),
    };
    // What calls for the settings of `render` stands in other blocks.
    let others = match field.split(':').next().unwrap() {
        "occlusion_samples" => "ambient { occlusion: 1 }",
        _ => "",
    };
    let paint = if block == "material" { ".paint(m)" } else { "" };
    format!("{block} {name} {{ {beside} {field} }} {others} scene {{ sphere(1){paint} }}")
}

#[test]
fn every_setting_has_a_row() {
    let words = vocabulary();
    let all: Vec<String> = words
        .blocks
        .iter()
        .flat_map(|(block, fields)| fields.iter().map(move |field| format!("{block}.{field}")))
        .collect();
    covers(SETTINGS.iter().map(|(b, f, ..)| format!("{b}.{f}")), all.iter().map(String::as_str));
    let program = |text: &str| compile(text, &[]).scene.map(|scene| scene.program.to_string());
    let mut wrong = Vec::new();
    for (block, field, good, outcome, bad, code) in SETTINGS {
        let plain = match *field {
            "direction" | "position" => scene_with(block, "direction: (1, 2, 3)"),
            "occlusion_samples" => scene_with(block, &format!("{field}: 6")),
            "horizon" | "zenith" => scene_with(block, &format!("{field}: 0")),
            _ => scene_with(block, ""),
        };
        let text = scene_with(block, &format!("{field}: {good}"));
        let found = described(&compile(&text, &[]));
        let plain = program(&plain).unwrap_or_else(|| panic!("{plain}"));
        let is_so = match outcome {
            Outcome::Changes => found.is_empty() && program(&text) != Some(plain),
            Outcome::Nothing => found.is_empty() && program(&text) == Some(plain),
        };
        if !is_so {
            wrong.push(format!("{text} is not {outcome:?}: {found:?}"));
        }
        let text = scene_with(block, &format!("{field}: {bad}"));
        let found = described(&compile(&text, &[]));
        if found.len() != 1 || !found[0].starts_with(code) {
            wrong.push(format!("{text} is not {code}: {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every attribute where it may stand, with other arguments than it takes, and where it may not stand.
#[test]
fn every_attribute_has_a_row() {
    let rows = [
        ("exact", "", "(1)"),
        ("bound", "", "(1)"),
        ("lipschitz", "(1)", "(1, 2)"),
        ("bounds", "(-1, 1)", "(1)"),
        ("convex", "", "(1)"),
        ("requires", "(true, \"a\")", "(true)"),
    ];
    covers(rows.iter().map(|(name, ..)| name.to_string()), vocabulary().attributes);
    for (name, right, wrong) in rows {
        let ball = "fn ball() = sphere(1) scene { ball() }";
        let found = described(&compile(&format!("@{name}{right} {ball}"), &[]));
        assert!(found.is_empty(), "{name}: {found:?}");
        let found = described(&compile(&format!("@{name}{wrong} {ball}"), &[]));
        assert!(found.len() == 1 && !found[0].contains("no attribute"), "{name}{wrong}: {found:?}");
        let found = described(&compile(&format!("@{name}{right} camera {{ fov: 1 }} {ball}"), &[]));
        assert!(found.len() == 1 && found[0].starts_with("E063"), "before a block: {found:?}");
    }
}

/// Thirty mistakes of all kinds, a line each, and thirty messages, in order.
#[test]
fn thirty_mistakes_make_thirty_messages() {
    let lines = [
        "let name = nowhere",
        "camera { tagret: 0, fov: 200deg }",
        "light a { direction: 1, shadow: sotf(1) }",
        "light b { position: (1, 2) }",
        "light a { direction: 2 }",
        "ambient { radius: 0 }",
        "sky { horizon: 1 }",
        "fog { density: -1 }",
        "rim { power: true }",
        "render { steps: 1.5 }",
        "render { far: 3 }",
        "material m { shinines: 1 }",
        "material n { color: sphere(1) }",
        "param k = 3 in 0..2",
        "param free = 3",
        "param k2 = time in 0..2",
        "let two = 1 let two = 2",
        "let sum = sphere(1) + sphere(2)",
        "let ratio = 1 / 0",
        "let huge = 1e30 * 1e30",
        "let part = [1, 2][2]",
        "let vector = (1, 2, 3, 4)",
        "let loop = loop + 1",
        "let end = 1 +",
        "let open = (1, 2",
        "let odd = 1 ? 2 : 3",
        "let sign = 5 – 3",
        "let unit = 5dge",
        "fn f(a) { return a }",
        "fn g(a: vec4) = a",
        "@exat fn h(a) = a",
        "float typed = 1;",
        "scene { shpere(1), box(), sphere(1).rotat(y, 1), sphere((1, 2, 3).q), circle(1) }",
    ];
    // Some lines have several mistakes.
    let counts = |line: &str| match line {
        _ if line.starts_with("camera") => 2,
        _ if line.starts_with("scene") => 5,
        _ => 1,
    };
    let compilation = compile_with(&lines.join("\n"), &[], &[]);
    let found: Vec<(usize, String)> = compilation
        .diagnostics
        .iter()
        .map(|d| (compilation.sources.line_column(d.span.file, d.span.start).0, d.message.clone()))
        .collect();
    assert!(found.is_sorted_by_key(|(line, _)| *line), "{found:#?}");
    for (i, line) in lines.iter().enumerate() {
        let here: Vec<_> = found.iter().filter(|(at, _)| *at == i + 1).collect();
        assert_eq!(here.len(), counts(line), "{line}: {here:#?}");
    }
}
