//! What is proved of shapes: for every value of the params, and at every time.

use crate::scene::Field;
use sdf_lang::{Basis, Class, Fact, Options};

/// The row of a scene's facts with this name.
fn fact(text: &str, name: &str) -> Fact {
    let options = Options { facts: true, ..Options::default() };
    let compilation = sdf_lang::compile("scene.sdf", text, &options);
    assert!(!compilation.has_errors(), "{:#?}\nin\n{text}", compilation.diagnostics);
    let facts = compilation.scene.unwrap().facts;
    facts.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("no `{name}` in {facts:#?}")).clone()
}

const INF: f64 = f64::INFINITY;

/// Checks boxes: each may be larger by a little, never smaller.
fn check_boxes(rows: &[(&str, &str, [f64; 3], [f64; 3])]) {
    for (text, name, lo, hi) in rows {
        let found = fact(text, name).extent;
        for i in 0..3 {
            let room = 0.02 * (hi[i] - lo[i]).min(10.0) + 1e-9;
            let close = |found: f64, wanted: f64, out: f64| {
                found == wanted || (-1e-9..=room).contains(&((found - wanted) * out))
            };
            let fits = close(found.lo[i], lo[i], -1.0) && close(found.hi[i], hi[i], 1.0);
            assert!(fits, "{text}: axis {i} of {found:?}, not {lo:?} to {hi:?}");
        }
    }
}

#[test]
fn boxes_hold_for_all_params_and_times() {
    let diagonal = 1.09f64.sqrt();
    check_boxes(&[
        ("scene { box(1, 2, 3).at(5, 0, 0) }", "at", [4.0, -2.0, -3.0], [6.0, 2.0, 3.0]),
        ("param r = 1 in 0.5..2 scene { sphere(r) }", "sphere", [-2.0; 3], [2.0; 3]),
        ("scene { sphere(1).at(sin(time), 0, 0) }", "at", [-2.0, -1.0, -1.0], [2.0, 1.0, 1.0]),
        ("scene { sphere(1).at(time, 0, 0) }", "at", [-1.0, -1.0, -1.0], [INF, 1.0, 1.0]),
        (
            "scene { box(1, 0.2, 0.3).rotate_y(time) }",
            "rotate_y",
            [-diagonal, -0.2, -diagonal],
            [diagonal, 0.2, diagonal],
        ),
        ("scene { box(1, 2, 3).rotate_x(90deg) }", "rotate_x", [-1.0, -3.0, -2.0], [1.0, 3.0, 2.0]),
        ("scene { smin(sphere(1), sphere(1).at(1, 0, 0), k: 0.4) }", "smin", [-1.1; 3], [2.1, 1.1, 1.1]),
        ("scene { sphere(0.2).at(0.1, 0, 0).repeat(x: 1) }", "repeat", [-INF, -0.2, -0.2], [INF, 0.2, 0.2]),
        ("scene { plane().at(0, -1, 0) }", "at", [-INF, -INF, -INF], [INF, -1.0, INF]),
        ("scene { plane((0, 0, -2), 3) }", "plane", [-INF, -INF, 3.0], [INF, INF, INF]),
        ("scene { sphere(1) - box(5) }", "difference", [-1.0; 3], [1.0; 3]),
        ("scene { sphere(2) & box(1, 3, 3) }", "intersection", [-1.0, -2.0, -2.0], [1.0, 2.0, 2.0]),
        ("scene { sphere(1).at(2, 0, 0).mirror(x) }", "mirror", [-3.0, -1.0, -1.0], [3.0, 1.0, 1.0]),
        ("scene { box(1).shell(0.2).scale((2, 1, 1)) }", "scale", [-2.2, -1.1, -1.1], [2.2, 1.1, 1.1]),
    ]);
}

#[test]
fn boxes_of_formulas_are_found() {
    let ball = "let ball = field { length(p - (3, -1, 2)) - 0.5 } scene { ball }";
    let bump = "let bump = field { length(p) - 1 - 0.2 * sqrt(1 + p.x * p.x) } scene { bump }";
    let own =
        "fn spin(s: shape, rate) = field { s(rotate(p, y, rate * p.y)) } scene { box(0.3, 1, 0.4).spin(2) }";
    for (text, name, lo, hi) in [
        (ball, "ball", [2.5, -1.5, 1.5], [3.5, -0.5, 2.5]),
        (bump, "bump", [-1.28, -1.21, -1.21], [1.28, 1.21, 1.21]),
        (own, "spin", [-0.5, -1.0, -0.5], [0.5, 1.0, 0.5]),
        ("let rod = field { length(p.xz) - 1 } scene { rod }", "rod", [-1.0, -INF, -1.0], [1.0, INF, 1.0]),
    ] {
        let found = fact(text, name);
        assert_eq!(found.basis, Basis::Derived);
        for i in 0..3 {
            let room = |x: f64| if x.is_finite() { 0.35 } else { 0.0 };
            assert!(
                found.extent.lo[i] <= lo[i] && found.extent.lo[i] + room(lo[i]) >= lo[i],
                "{text}: {found:?}"
            );
            assert!(
                found.extent.hi[i] >= hi[i] && found.extent.hi[i] - room(hi[i]) <= hi[i],
                "{text}: {found:?}"
            );
        }
    }
    // It has no end, whatever it looks like near the origin.
    let slanting = "let slab = field { abs(p.y - 1e-5 * p.x) - 1 } scene { slab }";
    assert!(fact(slanting, "slab").extent.hi[1] > 1e6);
}

#[test]
fn slopes_come_from_contracts_or_from_the_formula() {
    let twist = |r: f64| (3.0 * r + (9.0 * r * r + 4.0).sqrt()) / 2.0;
    for (text, name, class, least, most) in [
        ("scene { sphere(1).round(0.1) }", "round", Class::Exact, 1.0, 1.0),
        ("scene { smin(sphere(1), box(1), k: 0.1) }", "smin", Class::Bound, 1.0, 1.0),
        ("scene { box(0.3, 1, 0.4).twist(3) }", "twist", Class::Steep, twist(0.5), twist(0.85)),
        (
            "fn own(s: shape) = field { s(rotate(p, y, 3 * p.y)) } scene { own(box(0.3, 1, 0.4)) }",
            "own",
            Class::Steep,
            twist(0.5),
            twist(1.0),
        ),
        (
            "fn turn(s: shape) = field { s(rotate(p, y, time)) } scene { turn(box(1)) }",
            "turn",
            Class::Bound,
            1.0,
            1.0,
        ),
        ("fn wide(s: shape) = field { s(p * 2) / 2 } scene { wide(box(1)) }", "wide", Class::Bound, 1.0, 1.0),
        ("let waves = field { p.y - 0.5 * sin(p.x) } scene { waves }", "waves", Class::Steep, 1.118, 1.2),
        ("scene { sphere(1).displace(|p| 0.1 * sin(5 * p.x)) }", "displace", Class::Steep, 1.49, 1.51),
        ("scene { sphere(1).displace(|p| 0.1 * noise(p)) }", "displace", Class::Steep, 1.1, 1.47),
    ] {
        let found = fact(text, name);
        assert_eq!(found.class, class, "{text}");
        assert!((least..=most * (1.0 + 1e-9)).contains(&found.slope), "{text}: {}", found.slope);
    }
}

#[test]
fn facts_can_be_asked_for() {
    let stands = "fn stand(s: shape) = s.at(0, -lo(s).y, 0)";
    check_boxes(&[(
        &format!("{stands} scene {{ stand(sphere(1)) }}"),
        "stand",
        [-1.0, 0.0, -1.0],
        [1.0, 2.0, 1.0],
    )]);
    let at = |expr: &str| {
        Field::of_values("let b = box(3, 1, 4).at(1, 0, 0)", &format!("length(p) + {expr}")).at([0.0; 3])
    };
    assert_eq!(at("lo(b).x + hi(b).x * 10"), 38.0);
    assert_eq!(at("hi(b, 0.5).y"), 1.5);
    assert!((at("reach(b, y)") - 32f64.sqrt()).abs() < 1e-12);
    assert_eq!(at("slope(b)"), 1.0);
    assert!((3.0..3.2).contains(&at("slope(|p| sin(3 * p.x))")));
}

#[test]
fn facts_tell_what_a_shape_depends_on() {
    let text = "param k = 1 in 0..2\nlet a = sphere(1).at(k, 0, 0)\nscene { a, sphere(1).at(time, mouse.x, 0), box(1) }";
    let depends = |name: &str| fact(text, name).depends_on;
    assert_eq!(depends("a"), ["k"]);
    assert_eq!(depends("at"), ["mouse", "time"]);
    assert!(depends("box").is_empty());
    assert_eq!(fact(text, "a").line, Some(2));
}

#[test]
fn convex_shapes_are_known_behind_operators() {
    let stone = "@convex @bound fn stone(r) = field { max(length(p), abs(p.y) + 0.2 * r) - r }";
    let rows = [
        ("scene { sphere(1).at(0, 1, 0) }", "at", true),
        ("scene { torus(1, 0.3).at(0, 1, 0) }", "at", false),
        ("scene { box(1).round(0.2).rotate_x(1) }", "rotate_x", true),
        ("scene { sphere(1) & box(0.8) }", "intersection", true),
        ("scene { sphere(1) & torus(1, 0.3) }", "intersection", false),
        ("scene { sphere(1) - box(0.5) }", "difference", false),
        ("scene { ngon(5, 1).extrude(0.5) }", "extrude", true),
        ("scene { star(5, 1, 0.5).extrude(0.5) }", "extrude", false),
        ("scene { box(1).elongate((0.1, 0, 0)) }", "elongate", false),
        ("param r = true scene { if r { sphere(1) } else { box(1) } }", "if", true),
        ("param r = true scene { if r { sphere(1) } else { torus(1, 0.3) } }", "if", false),
        ("let slope = field { dot(p, (0.6, 0.8, 0)) - 1 } scene { slope }", "slope", true),
        ("fn ball(r) = field { length(p) - r } scene { ball(1) }", "ball", false),
        ("@convex fn ball(r) = field { length(p) - r } scene { ball(1) }", "ball", true),
        // The promise is about the solid: of its field further out nothing is known unless that is the distance.
        ("@convex fn ball(r) = field { length(p) - r } scene { ball(1).round(0.1) }", "round", false),
        ("@convex @exact fn ball(r) = field { length(p) - r } scene { ball(1).round(0.1) }", "round", true),
    ];
    for (text, name, expected) in rows {
        assert_eq!(fact(text, name).is_convex, expected, "{text}");
    }
    assert!(fact(&format!("{stone} scene {{ stone(1) }}"), "stone").is_convex);
}
