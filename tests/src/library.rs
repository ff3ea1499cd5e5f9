//! The functions of the standard library, and calls of each: those that their doc comments give as examples.

use sdf_lang::{Kind, kind_of, reference};

/// A call of a function of the library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// The function's name.
    pub function: String,
    /// The call, as the doc comment has it. It may depend on `p`.
    pub expression: String,
    /// What the call gives.
    pub kind: Kind,
    /// Whether the function makes something of shapes or of functions.
    pub is_operator: bool,
}

impl Call {
    /// Whether the function makes a shape of numbers alone.
    pub fn is_primitive(&self) -> bool {
        self.is_of_a_shape() && !self.is_operator
    }

    /// Whether the call gives a shape, of space or of the plane.
    pub fn is_of_a_shape(&self) -> bool {
        matches!(self.kind, Kind::Shape | Kind::Shape2)
    }

    /// An expression that is a shape of space, in which all is computed that the call gives or a part of it.
    pub fn as_shape(&self) -> String {
        let call = &self.expression;
        match self.kind {
            Kind::Shape => call.clone(),
            Kind::Shape2 => format!("field {{ ({call})(p.xy) }}"),
            Kind::Float => format!("field {{ {call} }}"),
            Kind::Vec2 | Kind::Vec3 => format!("field {{ ({call}).y }}"),
            kind => panic!("{call} is no shape and no number, but a {kind:?}"),
        }
    }
}

/// The examples of the library, in its order, but that of `nothing`: it has no field to look at.
pub fn calls() -> Vec<Call> {
    let mut calls = Vec::new();
    for entry in reference().iter().flat_map(|section| &section.entries).filter(|e| e.name != "nothing") {
        for form in &entry.forms {
            for expression in &form.examples {
                calls.push(call(&entry.name, expression, form.is_operator()));
            }
        }
        if entry.forms.iter().all(|form| form.examples.is_empty()) {
            let old = CALLS.iter().filter(|(name, _)| *name == entry.name).flat_map(|(_, calls)| *calls);
            let bare = |old: &&'static str| -> &'static str {
                old.strip_prefix("field { ").and_then(|old| old.strip_suffix(" }")).unwrap_or(old)
            };
            calls.extend(
                old.map(|old| {
                    call(&entry.name, bare(old), entry.forms.iter().any(|form| form.is_operator()))
                }),
            );
        }
    }
    calls
}

fn call(function: &str, expression: &str, is_operator: bool) -> Call {
    let kind = kind_of(expression).unwrap_or_else(|found| panic!("{expression}: {found:#?}"));
    Call { function: function.into(), expression: expression.into(), kind, is_operator }
}

/// Calls of the functions whose doc comments have no examples yet.
const CALLS: &[(&str, &[&str])] = &[
    // shapes.sdf
    ("sphere", &["sphere(0.7)"]),
    ("box", &["box((0.5, 0.8, 0.3))"]),
    ("round_box", &["round_box((0.5, 0.8, 0.3), 0.1)"]),
    ("torus", &["torus(1, 0.3)"]),
    ("plane_end", &["field { plane_end(1, 0, p.x) }"]),
    ("plane_hi", &["field { p.y - plane_hi((0, 1, 0), 0.3).y }"]),
    ("plane", &["plane()", "plane((1, 2, -0.5), 0.3)"]),
    ("cylinder", &["cylinder(0.6, 1.2)"]),
    ("capsule", &["capsule((-0.5, 0.1, 0.3), (0.9, 1.2, -0.4), 0.25)"]),
    ("cone", &["cone(0.8, 1.1)"]),
    ("ellipsoid", &["ellipsoid((0.5, 1.1, 0.8))"]),
    ("octahedron", &["octahedron(1.2)"]),
    ("nothing", &["nothing() | sphere(0.5).at(0.2, 0.1, 0.4)"]),
    // plane.sdf
    ("circle", &["field { circle(0.7)(p.xy) }"]),
    ("rect", &["field { rect((0.5, 0.9))(p.xy) }"]),
    ("polygon", &["field { polygon([(-1, -0.5), (1.2, -0.7), (0.3, 0.2), (0.4, 1.1)])(p.xy) }"]),
    ("extrude", &["rect((0.5, 0.9)).at(0.3, 0.1).extrude(0.4)"]),
    ("revolve", &["rect((0.3, 0.5)).at(0.1, 0.2).revolve(0.9)"]),
    // combine.sdf
    (
        "union",
        &[
            "union(sphere(0.5), box((0.5, 0.3, 0.4)).at(0.6, 0.2, -0.1))",
            "field { union(circle(0.6), rect((0.5, 0.3)).at(0.6, 0.2))(p.xy) }",
        ],
    ),
    (
        "intersection",
        &[
            "intersection(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1))",
            "field { intersection(circle(0.9), rect((0.5, 0.3)).at(0.6, 0.2))(p.xy) }",
        ],
    ),
    (
        "difference",
        &[
            "difference(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1), sphere(0.3).at(0, 0.8, 0.1))",
            "field { difference(circle(0.9), rect((0.5, 0.3)).at(0.6, 0.2))(p.xy) }",
        ],
    ),
    ("complement", &["!sphere(0.8).at(0.1, 0.2, 0.3)", "field { (!circle(0.8).at(0.1, 0.2))(p.xy) }"]),
    (
        "xor",
        &[
            "xor(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1))",
            "field { xor(circle(0.9), rect((0.5, 0.3)).at(0.6, 0.2))(p.xy) }",
        ],
    ),
    (
        "smin",
        &[
            "smin(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.9, 0.2, -0.1), sphere(0.4).at(0, 1, 0.2), k: 0.3)",
            "smin(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.9, 0.2, -0.1), k: 0)",
            "field { smin(circle(0.9), rect((0.5, 0.3)).at(0.9, 0.2), k: 0.4)(p.xy) }",
            "field { smin(p.x, p.y * 0.5 + 0.2, 0.3) }",
        ],
    ),
    (
        "smax",
        &[
            "smax(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1), k: 0.3)",
            "field { smax(circle(0.9), rect((0.5, 0.3)).at(0.9, 0.2), k: 0.4)(p.xy) }",
            "field { smax(p.x, p.y * 0.5 + 0.2, 0.3) }",
        ],
    ),
    ("bulge", &["field { p.x - bulge(3, 0.2 + 0.1 * p.y) }"]),
    ("blend", &["field { blend(p.x, p.y * 0.5 + 0.2, 0.5, 0.5) }"]),
    (
        "sdiff",
        &[
            "sdiff(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1), k: 0.3)",
            "field { sdiff(circle(0.9), rect((0.5, 0.3)).at(0.9, 0.2), k: 0.4)(p.xy) }",
        ],
    ),
    // operate.sdf
    (
        "round",
        &["box((0.5, 0.8, 0.3)).at(0.1, 0.2, 0).round(0.2)", "field { rect((0.5, 0.8)).round(0.2)(p.xy) }"],
    ),
    (
        "shell",
        &["box((0.5, 0.8, 0.3)).at(0.1, 0.2, 0).shell(0.2)", "field { rect((0.5, 0.8)).shell(0.2)(p.xy) }"],
    ),
    ("elongate", &["sphere(0.5).at(0.1, 0, 0.2).elongate((0.3, 0.6, 0))"]),
    ("displace", &["sphere(1).at(0.1, 0, 0.2).displace(|p| 0.1 * sin(3 * p.x) * sin(4 * p.y))"]),
    ("at", &["sphere(1).at(0.1, 0.7, -0.2)", "field { circle(1).at(0.1, 0.7)(p.xy) }"]),
    (
        "rotate",
        &[
            "box((0.5, 0.3, 0.4)).at(0.3, 0.2, -0.1).rotate((1, 2, 3), 40deg)",
            "field { rect((0.5, 0.3)).at(0.3, 0.2).rotate(40deg)(p.xy) }",
            "field { rotate(p, (1, 2, 3), p.x).y }",
            "field { rotate(p.xy, p.z).y }",
        ],
    ),
    ("turn", &["field { turn(p, (0, 0.6, 0.8), 0.6, 0.8).z }"]),
    ("rotate_x", &["box((0.5, 0.3, 0.4)).at(0.3, 0.2, -0.1).rotate_x(40deg)"]),
    ("rotate_y", &["box((0.5, 0.3, 0.4)).at(0.3, 0.2, -0.1).rotate_y(40deg)"]),
    ("rotate_z", &["box((0.5, 0.3, 0.4)).at(0.3, 0.2, -0.1).rotate_z(40deg)"]),
    (
        "scale",
        &[
            "box((0.5, 0.3, 0.4)).at(0.3, 0.2, -0.1).scale(1.7)",
            "box((0.5, 0.3, 0.4)).at(0.3, 0.2, -0.1).scale((1.7, 0.6, 1.1))",
            "field { rect((0.5, 0.3)).at(0.3, 0.2).scale(1.7)(p.xy) }",
        ],
    ),
    (
        "mirror",
        &[
            "box((0.5, 0.3, 0.4)).at(0.3, 0.2, -0.1).mirror((1, 2, 0), 0.1)",
            "field { rect((0.5, 0.3)).at(0.3, 0.2).mirror((1, 2), 0.1)(p.xy) }",
        ],
    ),
    ("from_axis", &["field { from_axis(p, (1, 2, 0)) - 0.6 }"]),
    ("twist_slope", &["field { twist_slope(1.3, length(p.xz)) - 1.2 }"]),
    ("twist", &["box((0.5, 0.9, 0.2)).at(0.3, 0.2, -0.1).twist(1.1)"]),
    (
        "copies_end",
        &["field { p.x - copies_end(1, 0.5, 0.7) }", "field { p.x - copies_end(false, 0.5, 0.7) }"],
    ),
    ("cells", &["field { sum(cells(p.x, 1.5)) + p.y }", "field { sum(cells(p.x, false)) + p.y }"]),
    (
        "repeat",
        &[
            "box((0.2, 0.3, 0.1)).at(0.1, 0.2, -0.1).repeat(x: 1.3, z: 0.9)",
            "field { rect((0.2, 0.3)).at(0.1, 0.1).repeat(x: 1.3, y: 1.1)(p.xy) }",
        ],
    ),
    // color.sdf
    ("checker", &["field { checker(p.xz, (0.1, 0.2, 0.3), (0.9, 0.7, 0.4), 0.7).y }"]),
    ("stripes", &["field { stripes(p.x, (0.1, 0.2, 0.3), (0.9, 0.7, 0.4), 0.7).y }"]),
    ("gradient", &["field { gradient(p.x, (0.1, 0.2, 0.3), (0.9, 0.7, 0.4)).y }"]),
    ("fade", &["field { fade(fract(p.x)) }", "field { fade(fract(p.xy)).y }", "field { fade(fract(p)).z }"]),
    (
        "corner",
        &["field { corner(2, p.x) }", "field { corner((1, 2), p.xy) }", "field { corner((1, 2, 3), p) }"],
    ),
    ("noise", &["field { noise(p.x) }", "field { noise(p.xy) }", "field { noise(p) }"]),
];
