//! Operators against what they are said to do, written out: on shapes that have no symmetry and stand off centre.

use crate::scene::{Field, Point, length, points, scene};

/// Two lumps and a box, all different: nothing that turns or mirrors it leaves it alone.
const LUMP: &str = "
    let lump = sphere(0.3).at(0.4, 0.1, -0.2) | box(0.1, 0.3, 0.2).at(-0.2, 0.3, 0.1) | sphere(0.15).at(0.1, -0.5, 0.4)
    let other = box(0.35, 0.2, 0.25).at(0.2, 0.3, 0.15)
    let third = sphere(0.4).at(-0.25, 0.1, -0.1)
    let flat = rect(0.2, 0.4).at(0.3, 0.1)
    let disc = circle(0.3).at(-0.2, 0.25)";

fn box_distance(p: Point, half: Point) -> f64 {
    let q: Point = std::array::from_fn(|i| p[i].abs() - half[i]);
    length(q.map(|x| x.max(0.0))) + q[0].max(q[1]).max(q[2]).min(0.0)
}

fn minus(p: Point, q: Point) -> Point {
    std::array::from_fn(|i| p[i] - q[i])
}

/// The field of `lump`, by itself.
fn lump(p: Point) -> f64 {
    let a = length(minus(p, [0.4, 0.1, -0.2])) - 0.3;
    let b = box_distance(minus(p, [-0.2, 0.3, 0.1]), [0.1, 0.3, 0.2]);
    let c = length(minus(p, [0.1, -0.5, 0.4])) - 0.15;
    a.min(b).min(c)
}

fn other(p: Point) -> f64 {
    box_distance(minus(p, [0.2, 0.3, 0.15]), [0.35, 0.2, 0.25])
}

fn third(p: Point) -> f64 {
    length(minus(p, [-0.25, 0.1, -0.1])) - 0.4
}

fn flat([x, y]: [f64; 2]) -> f64 {
    let q = [(x - 0.3).abs() - 0.2, (y - 0.1).abs() - 0.4];
    q[0].max(0.0).hypot(q[1].max(0.0)) + q[0].max(q[1]).min(0.0)
}

fn disc([x, y]: [f64; 2]) -> f64 {
    (x + 0.2).hypot(y - 0.25) - 0.3
}

/// Turned from the first of two coordinates towards the second.
fn turned(a: f64, b: f64, angle: f64) -> (f64, f64) {
    (a * angle.cos() - b * angle.sin(), a * angle.sin() + b * angle.cos())
}

/// The product of the unit quaternions of a turn with a vector: turns without the formula of the library.
fn about(p: Point, axis: Point, angle: f64) -> Point {
    let (s, w) = ((angle / 2.0).sin() / length(axis), (angle / 2.0).cos());
    let u = axis.map(|x| x * s);
    let cross = |a: Point, b: Point| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let t = cross(u, p).map(|x| 2.0 * x);
    let v = cross(u, t);
    std::array::from_fn(|i| p[i] + w * t[i] + v[i])
}

fn smin(a: f64, b: f64, k: f64) -> f64 {
    let h = (1.0 - (a - b).abs() / k).max(0.0);
    a.min(b) - k * h * h / 4.0
}

fn smax(a: f64, b: f64, k: f64) -> f64 {
    -smin(-a, -b, k)
}

/// An operator as written, and its field.
type Case = (&'static str, fn(Point) -> f64);

fn check(cases: &[Case]) {
    let points = points(400, 2.5);
    for (shape, expected) in cases {
        let field = Field::of_shape(LUMP, shape);
        for (p, d) in points.iter().zip(field.distances(&points)) {
            let expected = expected(*p);
            assert!((d - expected).abs() < 1e-9, "{shape} at {p:?} is {d} and not {expected}");
        }
    }
}

#[test]
fn places() {
    check(&[
        ("lump.at(0.5, -1, 0.25)", |p| lump(minus(p, [0.5, -1.0, 0.25]))),
        ("lump.at(1, 0, 0).at(0, 2, 0).at((0, 0, -3))", |p| lump(minus(p, [1.0, 2.0, -3.0]))),
        ("lump.rotate_z(90deg)", |[x, y, z]| lump([y, -x, z])),
        ("lump.rotate_x(90deg)", |[x, y, z]| lump([x, z, -y])),
        ("lump.rotate_y(90deg)", |[x, y, z]| lump([-z, y, x])),
        ("lump.rotate(y, 30deg)", |p| lump(about(p, [0.0, 1.0, 0.0], -30f64.to_radians()))),
        ("lump.rotate(1, 2, -0.5, 1.1)", |p| lump(about(p, [1.0, 2.0, -0.5], -1.1))),
        ("lump.rotate((0, 0, -3), 90deg)", |[x, y, z]| lump([-y, x, z])),
        ("lump.at(1, 0, 0).rotate_z(90deg)", |[x, y, z]| lump([y - 1.0, -x, z])),
        ("lump.rotate_z(90deg).at(1, 0, 0)", |[x, y, z]| lump([y, 1.0 - x, z])),
        ("lump.scale(2)", |p| 2.0 * lump(p.map(|x| x / 2.0))),
        ("lump.scale((2, 1, 0.5))", |[x, y, z]| 0.5 * lump([x / 2.0, y, z / 0.5])),
        ("flat.at(0.2, -0.3).rotate(90deg).extrude(9)", |[x, y, z]| {
            flat([y - 0.2, -x + 0.3]).max(z.abs() - 9.0)
        }),
        ("flat.scale(2).extrude(9)", |[x, y, z]| (2.0 * flat([x / 2.0, y / 2.0])).max(z.abs() - 9.0)),
    ]);
}

#[test]
fn distances() {
    check(&[
        ("lump.round(0.1)", |p| lump(p) - 0.1),
        ("lump.shell(0.1)", |p| lump(p).abs() - 0.05),
        ("lump.elongate(0.3, 0, 0.5)", |[x, y, z]| lump([x - x.clamp(-0.3, 0.3), y, z - z.clamp(-0.5, 0.5)])),
        ("lump.displace(|p| 0.1 * sin(3 * p.x) * p.y.cos())", |p| {
            lump(p) + 0.1 * (3.0 * p[0]).sin() * p[1].cos()
        }),
        ("lump.displace(|q| { let k = q.z; k * 0.1 })", |p| lump(p) + 0.1 * p[2]),
    ]);
}

#[test]
fn twists() {
    check(&[
        ("lump.twist(0.7)", |[x, y, z]| {
            let (z, x) = turned(z, x, 0.7 * y);
            lump([x, y, z])
        }),
        ("lump.twist(0.7, z)", |[x, y, z]| {
            let (x, y) = turned(x, y, 0.7 * z);
            lump([x, y, z])
        }),
        ("lump.twist(-1.3, axis: (2, 0, 0))", |[x, y, z]| {
            let (y, z) = turned(y, z, -1.3 * x);
            lump([x, y, z])
        }),
    ]);
}

#[test]
fn mirrors() {
    check(&[
        ("lump.mirror(x)", |[x, y, z]| lump([x.abs(), y, z])),
        ("lump.mirror(0, -2, 0)", |[x, y, z]| lump([x, -y.abs(), z])),
        ("lump.mirror(z, -0.3)", |[x, y, z]| lump([x, y, (z + 0.3).abs() - 0.3])),
        ("lump.mirror(x, offset: 0.25).at(0, 1, 0)", |[x, y, z]| lump([0.25 + (x - 0.25).abs(), y - 1.0, z])),
    ]);
}

/// Copies written out one by one: the content fits its cell, stands off centre, and is near its borders.
#[test]
fn repetitions_are_the_union_of_their_copies() {
    fn nearest(p: Point, period: Point, f: fn(Point) -> f64) -> f64 {
        let copies = |x: f64, s: f64| -> Vec<f64> {
            let middle = if s > 0.0 { (x / s).round() } else { 0.0 };
            (-3..=3).map(|i| x - s * (middle + f64::from(i))).collect()
        };
        let mut least = f64::MAX;
        for x in copies(p[0], period[0]) {
            for y in copies(p[1], period[1]) {
                for z in copies(p[2], period[2]) {
                    least = least.min(f([x, y, z]));
                }
            }
        }
        least
    }
    check(&[
        ("lump.repeat(x: 1.6)", |p| nearest(p, [1.6, 0.0, 0.0], lump)),
        ("lump.repeat(x: 1.6, z: 1.5)", |p| nearest(p, [1.6, 0.0, 1.5], lump)),
        ("lump.repeat(x: 1.6, y: 1.4, z: 1.5)", |p| nearest(p, [1.6, 1.4, 1.5], lump)),
        ("other.repeat(y: 1.0).rotate_z(90deg)", |[x, y, z]| nearest([y, -x, z], [0.0, 1.0, 0.0], other)),
        ("lump.at(0.05, 0, 0).repeat(x: 1.6).at(0.7, 0, 0)", |[x, y, z]| {
            nearest([x - 0.7, y, z], [1.6, 0.0, 0.0], |p| lump(minus(p, [0.05, 0.0, 0.0])))
        }),
    ]);
    let static_period = Field::of_shape(LUMP, "lump.repeat(x: 1.6, z: 1.5)");
    let changing = Field::of_shape(&format!("{LUMP} param s = 1.6 in 1..2"), "lump.repeat(x: s, z: s - 0.1)");
    for p in points(200, 4.0) {
        assert!((static_period.at(p) - changing.at(p)).abs() < 1e-9, "a period that changes, at {p:?}");
    }
    let plate = Field::of_shape(LUMP, "flat.repeat(x: 1.2).extrude(9)");
    for [x, y, z] in points(200, 3.0) {
        let expected = nearest([x, y, 0.0], [1.2, 0.0, 0.0], |[x, y, _]| flat([x, y]));
        assert!((plate.at([x, y, z]) - expected).abs() < 1e-9);
    }
}

#[test]
fn booleans() {
    check(&[
        ("lump | other", |p| lump(p).min(other(p))),
        ("lump | other | third", |p| lump(p).min(other(p)).min(third(p))),
        ("lump & other", |p| lump(p).max(other(p))),
        ("lump & other & third", |p| lump(p).max(other(p)).max(third(p))),
        ("lump - other", |p| lump(p).max(-other(p))),
        ("lump - other - third", |p| lump(p).max(-other(p)).max(-third(p))),
        ("lump - (other - third)", |p| lump(p).max(-(other(p).max(-third(p))))),
        ("lump | other & third", |p| lump(p).min(other(p).max(third(p)))),
        ("lump & other - third", |p| lump(p).max(other(p).max(-third(p)))),
        ("lump - other | third", |p| lump(p).max(-other(p)).min(third(p))),
        ("!lump", |p| -lump(p)),
        ("!lump & third", |p| third(p).max(-lump(p))),
        ("union(lump, other, third)", |p| lump(p).min(other(p)).min(third(p))),
        ("union([lump, other], third)", |p| lump(p).min(other(p)).min(third(p))),
        ("union(for i in 0..3 { lump.at(i, 0, 0) })", |[x, y, z]| {
            (0..3).map(|i| lump([x - f64::from(i), y, z])).fold(9e9, f64::min)
        }),
        ("for i in 0..3 { lump.at(i, 0, 0) }", |[x, y, z]| {
            (0..3).map(|i| lump([x - f64::from(i), y, z])).fold(9e9, f64::min)
        }),
        ("[[lump], [other, third]]", |p| lump(p).min(other(p)).min(third(p))),
        ("intersection(lump, other, third)", |p| lump(p).max(other(p)).max(third(p))),
        ("intersection(lump)", lump),
        ("difference(lump, other, third)", |p| lump(p).max(-other(p)).max(-third(p))),
        ("difference(lump)", lump),
        ("lump.difference([other, third])", |p| lump(p).max(-other(p)).max(-third(p))),
        ("xor(lump, other)", |p| (lump(p).max(-other(p))).min(other(p).max(-lump(p)))),
    ]);
}

#[test]
fn blends() {
    check(&[
        ("smin(lump, other, k: 0.4)", |p| smin(lump(p), other(p), 0.4)),
        ("smin(lump, other, third, k: 0.4)", |p| smin(smin(lump(p), other(p), 0.4), third(p), 0.4)),
        ("smin(third, other, lump, k: 0.4)", |p| smin(smin(third(p), other(p), 0.4), lump(p), 0.4)),
        ("smin([lump, other], k: 0.4)", |p| smin(lump(p), other(p), 0.4)),
        ("smin(lump, k: 0.4)", lump),
        ("lump.smin(other, k: 0)", |p| lump(p).min(other(p))),
        ("smax(lump, other, third, k: 0.3)", |p| smax(smax(lump(p), other(p), 0.3), third(p), 0.3)),
        ("smax(lump, other, k: 0)", |p| lump(p).max(other(p))),
        ("sdiff(lump, other, k: 0.3)", |p| smax(lump(p), -other(p), 0.3)),
        ("sdiff(lump, other, third, k: 0.3)", |p| smax(smax(lump(p), -other(p), 0.3), -third(p), 0.3)),
        ("sdiff(lump, other, k: 0)", |p| lump(p).max(-other(p))),
    ]);
    let frozen = Field::of_shape(LUMP, "smin(lump, other, third, k: 0.4)");
    let changing =
        Field::of_shape(&format!("{LUMP} param k = 0.4 in 0..1"), "smin(lump, other, third, k: k)");
    for p in points(200, 2.0) {
        assert!((frozen.at(p) - changing.at(p)).abs() < 1e-9, "a width that changes, at {p:?}");
    }
}

/// The same operators on areas of the plane, far from the faces of the plates.
#[test]
fn areas() {
    type Area = (&'static str, fn([f64; 2]) -> f64);
    let cases: &[Area] = &[
        ("flat | disc", |p| flat(p).min(disc(p))),
        ("flat & disc", |p| flat(p).max(disc(p))),
        ("flat - disc", |p| flat(p).max(-disc(p))),
        ("union(flat, disc)", |p| flat(p).min(disc(p))),
        ("!flat", |p| -flat(p)),
        ("xor(flat, disc)", |p| flat(p).min(disc(p)).max(-flat(p).max(disc(p)))),
        ("smin(flat, disc, k: 0.3)", |p| smin(flat(p), disc(p), 0.3)),
        ("smax(flat, disc, k: 0.3)", |p| smax(flat(p), disc(p), 0.3)),
        ("sdiff(flat, disc, k: 0.3)", |p| smax(flat(p), -disc(p), 0.3)),
        ("flat.round(0.1)", |p| flat(p) - 0.1),
        ("flat.shell(0.1)", |p| flat(p).abs() - 0.05),
        ("flat.mirror((1, 0), 0.1)", |[x, y]| flat([0.1 + (x - 0.1).abs(), y])),
        ("flat.mirror(0, 1)", |[x, y]| flat([x, y.abs()])),
        ("flat.at(0.5, -0.25)", |[x, y]| flat([x - 0.5, y + 0.25])),
        ("flat.rotate(90deg)", |[x, y]| flat([y, -x])),
        ("field2 { length(p) * p.x - 0.5 }", |[x, y]| x.hypot(y) * x - 0.5),
    ];
    for (area, expected) in cases {
        let field = Field::of_values(LUMP, &format!("({area})(p.xy)"));
        for p in points(200, 2.0) {
            let (d, expected) = (field.at(p), expected([p[0], p[1]]));
            assert!((d - expected).abs() < 1e-9, "{area} at {p:?} is {d} and not {expected}");
        }
    }
}

/// Which shape it is may change from frame to frame.
#[test]
fn shapes_chosen_by_a_param() {
    for (on, expected) in [("true", lump as fn(Point) -> f64), ("false", other)] {
        let field = Field::of_shape(&format!("{LUMP} param on = {on}"), "if on { lump } else { other }");
        for p in points(50, 2.0) {
            assert!((field.at(p) - expected(p)).abs() < 1e-9, "on is {on}, at {p:?}");
        }
    }
}

/// A user's operators are as good as the library's.
#[test]
fn operators_of_ones_own() {
    let items = format!(
        "{LUMP}
        fn hollow(s: shape, t) = field {{ abs(s(p)) - t }}
        fn row(s: shape, n, gap) = union(for i in 0..n {{ s.at(i * gap, 0, 0) }})
        fn pick(s: shape, which) = if which > 1 {{ s }} else {{ s.round(0.2) }}
        fn tower(s: shape, n) = if n == 0 {{ s }} else {{ s | tower(s, n - 1).at(0, 1, 0) }}
        fn bent(s: shape, f) = field {{ s(f(p)) }}"
    );
    let cases: &[Case] = &[
        ("lump.hollow(0.1)", |p| lump(p).abs() - 0.1),
        ("lump.row(3, 0.9)", |[x, y, z]| {
            (0..3).map(|i| lump([x - 0.9 * f64::from(i), y, z])).fold(9e9, f64::min)
        }),
        ("lump.pick(2)", lump),
        ("lump.pick(0)", |p| lump(p) - 0.2),
        ("lump.tower(2)", |[x, y, z]| (0..3).map(|i| lump([x, y - f64::from(i), z])).fold(9e9, f64::min)),
        ("lump.bent(|q| q.zxy * 2)", |[x, y, z]| lump([2.0 * z, 2.0 * x, 2.0 * y])),
        ("lump.hollow(0.2).hollow(0.1)", |p| ((lump(p).abs() - 0.2).abs()) - 0.1),
    ];
    for (shape, expected) in cases {
        let field = Field::of_shape(&items, shape);
        for p in points(100, 2.5) {
            let (d, expected) = (field.at(p), expected(p));
            assert!((d - expected).abs() < 1e-9, "{shape} at {p:?} is {d} and not {expected}");
        }
    }
    assert_eq!(scene(&format!("{items} scene {{ lump.row(3, 1), lump }}")).summary.shapes, 2);
}
