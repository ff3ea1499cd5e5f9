//! Which material a point of a surface has: `surface(shape, p, n)` is asked as a field of its own.

use crate::scene::{Field, Point};

const ITEMS: &str = "
    camera { eye: (0, 0, 60) }
    material red   { color: (1, 0, 0), specular: 0.9 }
    material green { color: (0, 1, 0), emission: (0, 0, 2) }
    material blue  { color: (0, 0, 1) }
    material place { color: p }
    material facing { color: n }
    fn glossy(c) = material { color: c, shininess: 77 }
    let a = sphere(1)
    let b = sphere(1).at(1, 0, 0)
    let tool = box(0.6).at(0, 1, 0)";

/// The default of `color`.
const BARE: Point = [0.8; 3];
const RED: Point = [1.0, 0.0, 0.0];
const GREEN: Point = [0.0, 1.0, 0.0];
const BLUE: Point = [0.0, 0.0, 1.0];

/// A property, as an expression of the record `m`, at a point of a shape.
fn property(shape: &str, what: &str, at: Point) -> f64 {
    Field::of_values(ITEMS, &format!("let m = surface({shape}, p, (0, 1, 0)); {what}")).at(at)
}

fn color(shape: &str, at: Point) -> Point {
    ["m.color.x", "m.color.y", "m.color.z"].map(|what| property(shape, what, at))
}

/// A shape, a point, and its colour there.
fn check(rows: &[(&str, Point, Point)]) {
    let mut wrong = Vec::new();
    for (shape, at, expected) in rows {
        let found = color(shape, *at);
        if (0..3).any(|i| (found[i] - expected[i]).abs() > 1e-9) {
            wrong.push(format!("{shape} at {at:?} is {found:?} and not {expected:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

const LEFT: Point = [-1.0, 0.0, 0.0];
const RIGHT: Point = [2.0, 0.0, 0.0];
const TOP: Point = [0.0, 1.0, 0.0];

#[test]
fn paint_is_the_innermost() {
    check(&[
        ("a", LEFT, BARE),
        ("a.paint(red)", LEFT, RED),
        ("a.paint(red).paint(green)", LEFT, RED),
        ("(a.paint(red) | b).paint(green)", LEFT, RED),
        ("(a.paint(red) | b).paint(green)", RIGHT, GREEN),
        ("(a.paint(red) | b)", RIGHT, BARE),
        ("a.paint(#0f0)", LEFT, GREEN),
        ("a.paint((0, 0, 1))", LEFT, BLUE),
        ("a.paint(0.25)", LEFT, [0.25; 3]),
        ("a.paint(glossy(#00f))", LEFT, BLUE),
        ("a.paint(material { color: (0, 1, 0) })", LEFT, GREEN),
        ("a.paint(material { specular: 1 })", LEFT, BARE),
        ("(a.paint(red).round(0.1) | b.paint(green)).paint(blue)", LEFT, RED),
    ]);
}

#[test]
fn unions_and_cuts_pick_one() {
    check(&[
        ("a.paint(red) | b.paint(green)", LEFT, RED),
        ("a.paint(red) | b.paint(green)", RIGHT, GREEN),
        ("b.paint(green) | a.paint(red)", LEFT, RED),
        // A tie takes the first in the source.
        ("a.paint(red) | a.paint(green)", LEFT, RED),
        ("a.paint(green) | a.paint(red)", LEFT, GREEN),
        ("a.paint(green) & a.paint(red)", LEFT, GREEN),
        ("a.paint(red) & b.paint(green)", [0.0; 3], GREEN),
        ("a.paint(red) & b.paint(green)", [1.0, 0.0, 0.0], RED),
        // What is carved shows the carved body, unless the tool is painted.
        ("a.paint(red) - tool", [0.0, 0.4, 0.0], RED),
        ("a.paint(red) - tool.paint(green)", [0.0, 0.4, 0.0], GREEN),
        ("a.paint(red) - tool.paint(green)", LEFT, RED),
        ("a - tool.paint(green)", [0.0, 0.4, 0.0], GREEN),
        ("a - tool.paint(green)", LEFT, BARE),
        ("(a.paint(red) | b.paint(green)) - tool", [0.0, 0.4, 0.0], RED),
        ("difference(a.paint(red), b, tool.paint(green))", [0.0, 0.4, 0.0], GREEN),
        ("difference(a.paint(red), b, tool.paint(green))", [0.0; 3], RED),
        ("!a.paint(red)", LEFT, RED),
        ("union([a.paint(red), b.paint(green), tool])", RIGHT, GREEN),
        ("xor(a.paint(red), b.paint(green))", LEFT, RED),
    ]);
}

#[test]
fn blends_mix_with_their_weights() {
    // Halfway both are alike; where they differ by d, the farther one's weight is (1 - d/k)/2.
    let at = |x: f64| -> Point { [x, 0.9, 0.0] };
    let distance = |p: Point, x: f64| ((p[0] - x).powi(2) + p[1] * p[1]).sqrt() - 1.0;
    for x in [0.5, 0.45, 0.3, 0.62, -0.5] {
        let p = at(x);
        let (d, e) = (distance(p, 0.0), distance(p, 1.0));
        let h = (1.0 - (d - e).abs() / 0.5f64).max(0.0) / 2.0;
        let first = if d <= e { 1.0 - h } else { h };
        check(&[
            ("smin(a.paint(red), b.paint(green), k: 0.5)", p, [first, 1.0 - first, 0.0]),
            (
                "smin(a.paint(red), b, k: 0.5)",
                p,
                [first + 0.8 * (1.0 - first), 0.8 * (1.0 - first), 0.8 * (1.0 - first)],
            ),
            ("smin(a.paint(red), b, k: 0.5).paint(blue)", p, [first, 0.0, 1.0 - first]),
        ]);
    }
    // The blend of an unpainted tool leaves no trace.
    check(&[("sdiff(a.paint(red), tool, k: 0.3)", [0.1, 0.4, 0.0], RED)]);
    check(&[("smin(a.paint(red), a.paint(green), k: 0.5)", LEFT, [0.5, 0.5, 0.0])]);
}

#[test]
fn materials_live_in_the_frame_of_what_is_painted() {
    check(&[
        ("a.paint(place)", [0.1, 0.2, 0.3], [0.1, 0.2, 0.3]),
        ("a.paint(place).at(1, 2, 3)", [1.1, 2.2, 3.3], [0.1, 0.2, 0.3]),
        ("a.at(1, 2, 3).paint(place)", [1.1, 2.2, 3.3], [1.1, 2.2, 3.3]),
        ("a.paint(place).rotate_z(90deg)", [0.1, 0.2, 0.3], [0.2, -0.1, 0.3]),
        ("a.paint(place).scale(2)", [0.2, 0.4, 0.6], [0.1, 0.2, 0.3]),
        ("sphere(0.5).paint(place).repeat(x: 2)", [4.1, 0.2, 0.3], [0.1, 0.2, 0.3]),
        ("sphere(0.5).paint(place).repeat(x: 2)", [-3.9, 0.2, 0.3], [0.1, 0.2, 0.3]),
        ("a.paint(place).mirror(x)", [-0.1, 0.2, 0.3], [0.1, 0.2, 0.3]),
        ("a.paint(facing)", [0.0, 2.0, 0.0], [0.0, 1.0, 0.0]),
        ("a.paint(facing).rotate_z(90deg)", [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]),
        ("a.paint(facing).at(0, 0, 5)", [0.0, 2.0, 5.0], [0.0, 1.0, 0.0]),
        ("a.paint(facing).repeat(x: 3)", [3.0, 2.0, 0.0], [0.0, 1.0, 0.0]),
        (
            "(a.paint(place).at(1, 0, 0) | b.paint(red).at(5, 0, 0)).rotate_y(180deg)",
            [-1.5, 0.0, 0.0],
            [0.5, 0.0, 0.0],
        ),
    ]);
}

#[test]
fn properties_have_their_defaults() {
    let rows = [
        ("a", "m.specular * 100 + m.shininess", 52.0),
        ("a.paint(red)", "m.specular", 0.9),
        ("a.paint(green)", "m.emission.z + m.specular", 2.2),
        ("a.paint(glossy(1))", "m.shininess", 77.0),
        ("a.paint(red) | b.paint(green)", "m.emission.z", 0.0),
        ("a.paint(red) | b.paint(green)", "m.specular", 0.9),
        ("a", "m.emission.x + m.color.y", 0.8),
        ("a", "surrounding(a, p, y).glow.y + surrounding(a, p, y).glow_radius", 0.25),
        ("a", "surrounding(a.paint(material { glow: (0, 2, 0) }), p, y).glow.y", 2.0),
    ];
    for (shape, what, expected) in rows {
        let found = property(shape, what, LEFT);
        assert!((found - expected).abs() < 1e-12, "{what} of {shape} is {found} and not {expected}");
    }
    assert_eq!(color("a.paint(red)", TOP), RED);
}
