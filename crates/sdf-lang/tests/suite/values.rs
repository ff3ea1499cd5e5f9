//! What expressions are worth: known when the scene is compiled, once per frame, or at a point, alike.

use crate::scene::{Field, compile, findings, scene_set};

/// How the variables `a`, `b` and `c` of an expression come by their values.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    /// They are constants.
    Static,
    /// They are params.
    Frame,
    /// They are params that are set.
    Set,
    /// They are the components of the point.
    Point,
}

const WAYS: [Known; 4] = [Known::Static, Known::Frame, Known::Set, Known::Point];

/// One row of a table: an expression, what a, b and c are, and the components of its value.
type Row = (&'static str, [f64; 3], &'static [f64]);

/// The value of a float expression after some items.
fn value(items: &str, expr: &str, given: [f64; 3], known: Known) -> f64 {
    try_value(items, expr, given, known).unwrap_or_else(|findings| panic!("{expr} ({known:?}): {findings:?}"))
}

/// The same, or what is said against it.
fn try_value(items: &str, expr: &str, given: [f64; 3], known: Known) -> Result<f64, Vec<String>> {
    let written = given.map(|x| x.to_string());
    let [a, b, c] = &written;
    let (set, point) = match known {
        Known::Static | Known::Frame => (Vec::new(), [0.0; 3]),
        Known::Set => (vec![("a", a.as_str()), ("b", b.as_str()), ("c", c.as_str())], [0.0; 3]),
        Known::Point => (Vec::new(), given),
    };
    let range = "in -1e9..1e9";
    let (variables, bindings) = match known {
        Known::Static => (format!("let a = {a} let b = {b} let c = {c}"), ""),
        Known::Frame => (format!("param a = {a} {range} param b = {b} {range} param c = {c} {range}"), ""),
        Known::Set => (format!("param a = 0 {range} param b = 0 {range} param c = 0 {range}"), ""),
        Known::Point => (String::new(), "let a = p.x; let b = p.y; let c = p.z;"),
    };
    // The `if` makes a field of what does not depend on the point.
    let field = format!("field {{ {bindings} if p.x > 1e15 {{ 77.125 }} else {{ {expr} }} }}");
    let text = format!("{items}\n{variables}\n@lipschitz(1)\nlet tested = {field}\nscene {{ tested }}");
    let compilation = compile(&text, &set);
    let said = compilation.diagnostics.iter().map(|d| format!("{}: {}", d.code, d.message)).collect();
    compilation.scene.map(|scene| Field::of_scene(scene, &text).at(point)).ok_or(said)
}

/// Checks rows with their variables known in some ways.
fn check_in(ways: &[Known], items: &str, rows: &[Row]) {
    let mut wrong = Vec::new();
    for (expr, given, expected) in rows {
        for (i, expected) in expected.iter().enumerate() {
            let one = component(expr, i);
            for known in ways {
                let found = try_value(items, &one, *given, *known);
                let close = |x: &f64| (x - expected).abs() <= 1e-12 * expected.abs().max(1.0);
                if !found.as_ref().is_ok_and(close) {
                    wrong.push(format!("{one} with {given:?} ({known:?}) is {found:?} and not {expected}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What gives component `i` of an expression; a row of a vector begins with `vec:`.
fn component(expr: &str, i: usize) -> String {
    match expr.strip_prefix("vec:") {
        Some(vector) => format!("({vector})[{i}]"),
        None => format!("({expr})"),
    }
}

fn check(items: &str, rows: &[Row]) {
    check_in(&WAYS, items, rows);
}

/// A value that is the same however its variables are known, whatever it is.
fn alike(items: &str, expr: &str, given: [f64; 3]) -> f64 {
    let found: Vec<f64> = WAYS.iter().map(|known| value(items, expr, given, *known)).collect();
    assert!(found.iter().all(|x| x.to_bits() == found[0].to_bits()), "{expr} with {given:?}: {found:?}");
    found[0]
}

#[test]
fn operators_and_their_precedence() {
    check(
        "",
        &[
            ("a + b * c", [2.0, 3.0, 4.0], &[14.0]),
            ("(a + b) * c", [2.0, 3.0, 4.0], &[20.0]),
            ("a - b - c", [2.0, 3.0, 4.0], &[-5.0]),
            ("a / b / c", [12.0, 3.0, 2.0], &[2.0]),
            ("a - b + c", [2.0, 3.0, 4.0], &[3.0]),
            ("a * b % c", [5.0, 3.0, 4.0], &[3.0]),
            ("a % b * c", [5.0, 3.0, 4.0], &[8.0]),
            ("-a % b", [7.0, 3.0, 0.0], &[2.0]),
            ("a % b", [7.0, -3.0, 0.0], &[-2.0]),
            ("a % b", [-7.5, 2.0, 0.0], &[0.5]),
            ("-a.max(b)", [1.0, 2.0, 0.0], &[-2.0]),
            ("-a * -b", [2.0, 3.0, 0.0], &[6.0]),
            ("--a", [2.0, 0.0, 0.0], &[2.0]),
            ("if a < b && b < c { 1 } else { 0 }", [1.0, 2.0, 3.0], &[1.0]),
            ("if a > b || b < c && a > c { 1 } else { 0 }", [1.0, 2.0, 3.0], &[0.0]),
            ("if a > b && b < c || a < c { 1 } else { 0 }", [1.0, 2.0, 3.0], &[1.0]),
            ("if !(a < b) { 1 } else { 0 }", [1.0, 2.0, 3.0], &[0.0]),
            ("if !(a < b) == false { 1 } else { 0 }", [1.0, 2.0, 3.0], &[1.0]),
            ("if a + 1 == b { 1 } else { 0 }", [1.0, 2.0, 3.0], &[1.0]),
            ("if a != b { 1 } else { 0 }", [1.0, 1.0, 3.0], &[0.0]),
            ("if a >= b { 1 } else { 0 }", [1.0, 1.0, 3.0], &[1.0]),
            ("if a <= b { 1 } else { 0 }", [1.5, 1.0, 3.0], &[0.0]),
            ("if a > b { 1 } else { 0 }", [1.0, 1.0, 3.0], &[0.0]),
            ("vec:(a, b) + c", [1.0, 2.0, 3.0], &[4.0, 5.0]),
            ("vec:c - (a, b, a)", [1.0, 2.0, 3.0], &[2.0, 1.0, 2.0]),
            ("vec:(a, b) * (b, c)", [1.0, 2.0, 3.0], &[2.0, 6.0]),
            ("vec:(a, b, c) / 2", [1.0, 2.0, 3.0], &[0.5, 1.0, 1.5]),
            ("vec:6 / (a, b, c)", [1.0, 2.0, 3.0], &[6.0, 3.0, 2.0]),
            ("vec:(a, b, c) % 2", [-1.0, 2.5, 3.0], &[1.0, 0.5, 1.0]),
            ("vec:-(a, b)", [1.0, 2.0, 3.0], &[-1.0, -2.0]),
            ("if (a, b) == (a, b) && (a, b, c) != (a, b, a) { 1 } else { 0 }", [1.0, 2.0, 3.0], &[1.0]),
            ("if (a, b) == (b, a) || (a, b, c) != (a, b, c) { 1 } else { 0 }", [1.0, 2.0, 3.0], &[0.0]),
            ("if (a, a) == a && b != (a, b) && #f00 == #ff0000 { 1 } else { 0 }", [1.0, 2.0, 3.0], &[1.0]),
        ],
    );
}

#[test]
fn vectors_swizzles_units_and_colours() {
    check(
        "",
        &[
            ("vec:((a, b), c)", [1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]),
            ("vec:(a, (b, c))", [1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]),
            ("vec:(a, b, c).zyx", [1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]),
            ("vec:(a, b, c).xz", [1.0, 2.0, 3.0], &[1.0, 3.0]),
            ("vec:(a, b).yyx", [1.0, 2.0, 3.0], &[2.0, 2.0, 1.0]),
            ("(a, b, c).b + (a, b, c).g * 10", [1.0, 2.0, 3.0], &[23.0]),
            ("(a, b, c)[1]", [1.0, 2.0, 3.0], &[2.0]),
            ("(a)", [1.0, 2.0, 3.0], &[1.0]),
            ("180deg + a", [0.0; 3], &[std::f64::consts::PI]),
            ("0.25turn + a", [0.0; 3], &[std::f64::consts::FRAC_PI_2]),
            ("2rad + a", [0.0; 3], &[2.0]),
            ("1_000 + .5 + 1e-3 + a", [0.0; 3], &[1000.501]),
            ("vec:#fff + a", [0.0; 3], &[1.0, 1.0, 1.0]),
            ("vec:#ff8000 + a", [0.0; 3], &[1.0, 0.215_860_500_113_899_26, 0.0]),
            ("pi + tau + a", [0.0; 3], &[3.0 * std::f64::consts::PI]),
            ("vec:x + 2 * y + 3 * z + a", [0.0; 3], &[1.0, 2.0, 3.0]),
            ("dot((a, b, c), y)", [1.0, 2.0, 3.0], &[2.0]),
        ],
    );
}

#[test]
fn lists_records_blocks_and_functions() {
    let items = "
        fn twice(v) = 2 * v
        fn apply(f, v) = f(v)
        fn adder(n) = |v| v + n
        fn total(numbers...) = sum(numbers)
        fn weighted(numbers..., by) = sum(numbers) * by
        fn tail(first, second = first * 2, third = first + second) = first * 100 + second * 10 + third
        fn pick(v: float) = 1
        fn pick(v: vec2) = 2
        fn pick(v: vec3) = 3
        fn pick(v: bool) = 4
        fn pick(v: list) = 5
        fn pick(v: fn) = 6
        fn wide(v: vec3) = v.x + v.y * 10 + v.z * 100
        fn spot(v: vec3, w: vec2, k = 0.5) = wide(v) + 1000 * w.x + 10000 * w.y + k
        fn factorial(n) = if n <= 1 { 1 } else { n * factorial(n - 1) }
        fn depth(n) = if n == 1 { 1 } else { 1 + depth(n - 1) }
        fn longest() = length(depth(256) * x)
        let square = |v| v * v
        let offset = 100
        fn shadowed(offset) = offset + { let offset = offset * 2; offset }
        let late = early + 1
        let early = 4
        fn even(n) = if n == 0 { true } else { odd(n - 1) }
        fn odd(n) = if n == 0 { false } else { even(n - 1) }
    ";
    check(
        items,
        &[
            ("[a, b, c][2]", [1.0, 2.0, 3.0], &[3.0]),
            ("len([a, b, c]) + len([]) * a", [1.0, 2.0, 3.0], &[3.0]),
            ("sum(0..5) + a", [0.0; 3], &[10.0]),
            ("len(3..3) + len(3..1) + a", [0.0; 3], &[0.0]),
            ("(2..5)[1] * a", [2.0, 0.0, 0.0], &[6.0]),
            ("sum(for i in 0..4 { i * a })", [2.0, 0.0, 0.0], &[12.0]),
            ("sum(for v in [a, b] { for w in [c, a] { v * w }[1] })", [2.0, 3.0, 5.0], &[10.0]),
            ("sum(map([a, b, c], |v| v * v))", [1.0, 2.0, 3.0], &[14.0]),
            ("sum([a, b, c].map(square))", [1.0, 2.0, 3.0], &[14.0]),
            ("fold([a, b, c], 0, |acc, v| acc * 10 + v)", [1.0, 2.0, 3.0], &[123.0]),
            ("vec:fold([a, b, c], (0, 0), |acc, v| acc + (v, 1))", [1.0, 2.0, 3.0], &[6.0, 3.0]),
            ("(t: a, r: b).r", [1.0, 2.0, 3.0], &[2.0]),
            ("{ let s = (t: a, inner: (r: b)); s.inner.r + s.t }", [1.0, 2.0, 3.0], &[3.0]),
            ("{ let v = a; let v = v + 1; v * 2 }", [1.0, 2.0, 3.0], &[4.0]),
            ("{ let x = a; x + y.y }", [5.0, 2.0, 3.0], &[6.0]),
            ("{ let f = |v, w = v * 2| v + w; f(a) + f(a, w: b) }", [1.0, 2.0, 3.0], &[6.0]),
            ("{ let n = a; let f = |v| v + n; let n = 100; f(b) }", [1.0, 2.0, 3.0], &[3.0]),
            ("apply(twice, a) + apply(|v| v + b, c)", [1.0, 2.0, 3.0], &[7.0]),
            ("adder(a)(b)", [1.0, 2.0, 3.0], &[3.0]),
            ("(f: adder(a)).f(b)", [1.0, 2.0, 3.0], &[3.0]),
            ("a.twice() + a.square()", [3.0, 0.0, 0.0], &[15.0]),
            ("a.twice().twice()", [3.0, 0.0, 0.0], &[12.0]),
            ("total() + total(a) + total(a, b, c) + total([a, b], c)", [1.0, 2.0, 3.0], &[13.0]),
            ("weighted(a, [b, c], by: 2)", [1.0, 2.0, 3.0], &[12.0]),
            ("a.weighted(b, by: 2)", [1.0, 2.0, 3.0], &[6.0]),
            ("tail(a)", [1.0, 2.0, 3.0], &[123.0]),
            ("tail(a, b)", [1.0, 3.0, 3.0], &[134.0]),
            ("tail(third: a, first: b)", [7.0, 1.0, 3.0], &[127.0]),
            (
                "pick(a) * 100000 + pick((a, b)) * 10000 + pick((a, b, c)) * 1000",
                [1.0, 2.0, 3.0],
                &[123_000.0],
            ),
            ("pick(a < b) * 100 + pick([a, b]) * 10 + pick(twice)", [1.0, 2.0, 3.0], &[456.0]),
            ("wide(a)", [2.0, 0.0, 0.0], &[222.0]),
            ("wide(a, b, c)", [1.0, 2.0, 3.0], &[321.0]),
            ("wide((a, b, c))", [1.0, 2.0, 3.0], &[321.0]),
            ("(a, b, c).wide()", [1.0, 2.0, 3.0], &[321.0]),
            ("spot((a, b, c), (a, b))", [1.0, 2.0, 3.0], &[21_321.5]),
            ("spot(a, b, c, a, b)", [1.0, 2.0, 3.0], &[21_321.5]),
            ("spot(a, b, c, a, b, 0.25)", [1.0, 2.0, 3.0], &[21_321.25]),
            ("spot(a, b)", [1.0, 2.0, 3.0], &[22_111.5]),
            ("spot(a, (a, b))", [1.0, 2.0, 3.0], &[21_111.5]),
            ("(a, b, c).spot(a, b, 0.25)", [1.0, 2.0, 3.0], &[21_321.25]),
            ("spot(v: (a, b, c), w: a)", [1.0, 2.0, 3.0], &[11_321.5]),
            ("factorial(5) + a", [0.0; 3], &[120.0]),
            ("depth(256) + a", [0.0; 3], &[256.0]),
            ("longest() + a", [0.0; 3], &[256.0]),
            ("shadowed(a) + offset", [1.0, 0.0, 0.0], &[103.0]),
            ("late + a", [0.0; 3], &[5.0]),
            ("if even(10) && !odd(4) { a } else { b }", [1.0, 2.0, 3.0], &[1.0]),
            ("if len([]) > 0 && [][0] > 1 { a } else { b }", [1.0, 2.0, 3.0], &[2.0]),
            ("if len([]) == 0 || 1 / len([]) > 1 { a } else { b }", [1.0, 2.0, 3.0], &[1.0]),
        ],
    );
}

#[test]
fn choices_take_one_side() {
    let items = "
        fn heavy(v) { let w = v * 2; w + 1 }
        fn one(v) = (r: heavy(v), s: 2 * v)
        fn other(v) = (s: 10 * v, r: heavy(v) * 100)
        let ball = sphere(1)
    ";
    check(
        items,
        &[
            ("if a < b { a } else { b }", [1.0, 2.0, 0.0], &[1.0]),
            ("if a < b { a } else if a < c { b } else { c }", [2.0, 1.0, 5.0], &[1.0]),
            ("vec:(0, 0) + if a < b { (a, b) } else { c }", [2.0, 1.0, 5.0], &[5.0, 5.0]),
            ("vec:(0, 0) + if a < b { c } else { (a, b) }", [1.0, 2.0, 5.0], &[5.0, 5.0]),
            ("vec:(0, 0) + if a < b { heavy(c) } else { (a, b) }", [1.0, 2.0, 5.0], &[11.0, 11.0]),
            ("vec:(0, 0) + if a < b { heavy(c) } else { (a, b) }", [2.0, 1.0, 5.0], &[2.0, 1.0]),
            ("vec:(0, 0) + if a < b { (a, b) } else { heavy(c) }", [2.0, 1.0, 5.0], &[11.0, 11.0]),
            ("if a < b { (r: a, s: b) } else { (s: a, r: c) }.r", [2.0, 1.0, 5.0], &[5.0]),
            ("if a < b { one(a) } else { other(a) }.r", [2.0, 1.0, 5.0], &[500.0]),
            ("if a < b { one(a) } else { other(a) }.s", [2.0, 1.0, 5.0], &[20.0]),
            ("if a < b { one(a) } else { other(a) }.r", [2.0, 3.0, 5.0], &[5.0]),
            ("if a < b { [a, b] } else { [b, c] }[1]", [2.0, 1.0, 5.0], &[5.0]),
            ("if a < b { [heavy(a), b] } else { [b, heavy(c)] }[1]", [2.0, 1.0, 5.0], &[11.0]),
            ("if a < b { ball(a, 0, 0) } else { ball(0, c, 0) }", [2.0, 1.0, 5.0], &[4.0]),
            ("if a < b { ball(a, 0, 0) } else { ball(0, c, 0) }", [2.0, 3.0, 5.0], &[1.0]),
        ],
    );
}

#[test]
fn loops_with_states_of_every_kind() {
    let items = "
        fn doubled(s) { let t = s * 2; t }
        let ball = sphere(1)
    ";
    check(
        items,
        &[
            ("iterate(5, a, |i, s| s + i)", [1.0, 2.0, 0.0], &[11.0]),
            ("iterate(0, a, |i, s| s + i)", [1.0, 2.0, 0.0], &[1.0]),
            ("vec:iterate(3, (a, b), |i, s| (s.y, s.x + i))", [1.0, 2.0, 0.0], &[3.0, 3.0]),
            (
                "iterate(10, (t: a, n: 0), |i, s| (n: s.n + 1, t: s.t * 2), until: |s| s.t > b).n",
                [1.0, 20.0, 0.0],
                &[5.0],
            ),
            (
                "iterate(10, (t: a, n: 0), |i, s| (n: s.n + 1, t: s.t * 2), until: |s| s.t > b).t",
                [1.0, 20.0, 0.0],
                &[32.0],
            ),
            ("iterate(10, a, |i, s| s * 2, until: |s| s > b)", [30.0, 20.0, 0.0], &[30.0]),
            ("iterate(4, a, |i, s| doubled(s))", [1.0, 20.0, 0.0], &[16.0]),
            ("iterate(3, a, |i, s| iterate(2, s, |j, t| t + i * 10 + j))", [1.0, 20.0, 0.0], &[64.0]),
            ("iterate(3, a, |i, s| s + ball(s, 0, 0))", [2.0, 20.0, 0.0], &[9.0]),
            (
                "iterate(4, (t: a, hit: false), |i, s| (t: s.t + 1, hit: s.t > b), until: |s| s.hit).t",
                [1.0, 2.0, 0.0],
                &[4.0],
            ),
            ("len(for i in 0..iterate(3, 1, |i, s| s * 2) { i }) + a", [0.0; 3], &[8.0]),
        ],
    );
}

#[test]
fn what_a_file_defines_hides_the_library() {
    let rows: &[(&str, Row)] = &[
        ("fn max(u, v) = 7", ("max(a, b) + a.max(b)", [1.0, 2.0, 3.0], &[14.0])),
        ("let pi = 3", ("pi + a", [1.0, 2.0, 3.0], &[4.0])),
        ("let time = 3", ("time + a", [1.0, 2.0, 3.0], &[4.0])),
        // The library's own code does not see the file's items.
        ("fn length(v) = 100 fn min(v) = 100 fn max(v) = 100", ("box(1)(a, b, c)", [3.0, 0.0, 0.0], &[2.0])),
        (
            "fn rotate(v, w) = 100",
            ("sphere(1).at(2, 0, 0).rotate_y(90deg)(a, b, c)", [0.0, 0.0, -2.0], &[-1.0]),
        ),
        // A number hides no method.
        ("let round = 0.25", ("box(1).round(round)(a, b, c)", [3.0, 0.0, 0.0], &[1.75])),
        ("", ("{ let round = 0.25; box(1).round(round)(a, b, c) }", [3.0, 0.0, 0.0], &[1.75])),
        ("", ("{ let max = |u, v| 7; max(a, b) + a.max(b) }", [1.0, 2.0, 3.0], &[14.0])),
        ("let rim = 2 let light = 3", ("rim * light + a", [1.0, 2.0, 3.0], &[7.0])),
    ];
    rows.iter().for_each(|(items, row)| check(items, &[*row]));
}

#[test]
fn numeric_functions() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LN_2, PI};
    check(
        "",
        &[
            ("abs(a) + sign(a) * 10 + sign(b) * 100 + sign(c) * 1000", [-3.0, 0.0, 2.0], &[993.0]),
            ("floor(a) + ceil(a) * 10 + trunc(a) * 100", [-1.5, 0.0, 0.0], &[-112.0]),
            ("round(a) + round(b) * 10 + round(c) * 100", [0.5, 1.5, -2.5], &[-180.0]),
            ("fract(a)", [-1.25, 0.0, 0.0], &[0.75]),
            (
                "min(a, b, c) + max(a, b, c) * 10 + min([a, b]) * 100 + max(a) * 1000",
                [3.0, 1.0, 2.0],
                &[3131.0],
            ),
            ("vec:min((a, b), c)", [3.0, 1.0, 2.0], &[2.0, 1.0]),
            ("vec:max(c, (a, b))", [3.0, 1.0, 2.0], &[3.0, 2.0]),
            ("clamp(a, b, c)", [5.0, 1.0, 2.0], &[2.0]),
            ("clamp(a, b, c)", [1.5, 2.0, 1.0], &[1.0]),
            ("vec:clamp((a, b, c), 0, 1)", [-5.0, 0.5, 2.0], &[0.0, 0.5, 1.0]),
            ("mix(a, b, c)", [1.0, 3.0, 0.25], &[1.5]),
            ("vec:mix((a, b), (b, c), 0.5)", [1.0, 3.0, 5.0], &[2.0, 4.0]),
            ("vec:mix(a, b, (c, 1))", [1.0, 3.0, 0.5], &[2.0, 3.0]),
            ("step(a, b) * 10 + step(b, a) + step(a, a) * 100", [1.0, 2.0, 0.0], &[110.0]),
            ("smoothstep(a, b, c)", [0.0, 2.0, 0.5], &[0.156_25]),
            ("smoothstep(a, b, c)", [0.0, 2.0, 5.0], &[1.0]),
            ("smoothstep(a, b, c)", [0.0, 2.0, -5.0], &[0.0]),
            ("smoothstep(a, b, c)", [2.0, 0.0, 0.5], &[0.843_75]),
            ("smoothstep(a, b, c)", [1.0, 1.0, 0.5], &[0.0]),
            ("smoothstep(a, b, c)", [1.0, 1.0, 1.5], &[1.0]),
            ("sqrt(a) + sqrt(b)", [4.0, -4.0, 0.0], &[2.0]),
            ("pow(a, b)", [2.0, 10.0, 0.0], &[1024.0]),
            ("pow(a, b) + pow(a, c) * 100", [-2.0, 3.0, 2.0], &[392.0]),
            ("pow(a, b)", [-4.0, 0.5, 2.0], &[2.0]),
            ("exp(a) + exp2(b)", [0.0, 3.0, 0.0], &[9.0]),
            ("log(a) + log2(b)", [2.0, 8.0, 0.0], &[LN_2 + 3.0]),
            ("exp(a)", [1000.0, 0.0, 0.0], &[f32::MAX as f64]),
            ("log2(a)", [-1.0, 0.0, 0.0], &[-126.0]),
            ("sin(a) + cos(b) * 10", [FRAC_PI_2, PI, 0.0], &[-9.0]),
            ("tan(a)", [FRAC_PI_4, 0.0, 0.0], &[1.0]),
            ("asin(a) + acos(b)", [2.0, -2.0, 0.0], &[FRAC_PI_2 + PI]),
            ("atan(a)", [1.0, 0.0, 0.0], &[FRAC_PI_4]),
            ("atan(a, b) + atan(c, c)", [1.0, -1.0, 0.0], &[3.0 * FRAC_PI_4]),
            ("tanh(a)", [0.5, 0.0, 0.0], &[0.462_117_157_260_009_76]),
            ("length((a, b)) + distance((a, b), (a, c))", [3.0, 4.0, 6.0], &[7.0]),
            ("dot((a, b, c), (c, b, a))", [1.0, 2.0, 3.0], &[10.0]),
            ("vec:cross((a, b, c), x)", [1.0, 2.0, 3.0], &[0.0, 3.0, -2.0]),
            ("vec:normalize((a, b, c))", [3.0, 0.0, 4.0], &[0.6, 0.0, 0.8]),
            ("vec:normalize((a, b, c))", [0.0; 3], &[0.0, 0.0, 0.0]),
            ("vec:reflect((a, b, c), y)", [1.0, -2.0, 3.0], &[1.0, 2.0, 3.0]),
            ("vec:refract((a, b, c), y, 1)", [0.6, -0.8, 0.0], &[0.6, -0.8, 0.0]),
            ("vec:refract((a, b, c), y, 2)", [0.8, -0.6, 0.0], &[0.0, 0.0, 0.0]),
            ("sum(a, b, c) + sum([a]) + sum()", [1.0, 2.0, 3.0], &[7.0]),
            ("vec:sum((a, b), (b, c))", [1.0, 2.0, 3.0], &[3.0, 5.0]),
            ("vec:rotate((a, b, c), z, 90deg)", [1.0, 2.0, 3.0], &[-2.0, 1.0, 3.0]),
            ("vec:rotate((a, b, c), (0, 2, 0), 90deg)", [1.0, 2.0, 3.0], &[3.0, 2.0, -1.0]),
            ("vec:rotate((a, b), 90deg)", [1.0, 2.0, 3.0], &[-2.0, 1.0]),
            ("smin(a, b, k: c)", [1.0, 1.5, 1.0], &[1.0 - 0.0625]),
            ("smax(a, b, k: c)", [1.0, 1.5, 1.0], &[1.5 + 0.0625]),
            ("smin(a, b, k: c)", [1.0, 1.5, 0.0], &[1.0]),
            ("smin(a, b, k: c)", [1.0, 1.5, 0.25], &[1.0]),
        ],
    );
}

/// Where both sides are static this is an error; see `limits`.
#[test]
fn division_is_total() {
    const LARGEST: f64 = f32::MAX as f64;
    let rows: [Row; 4] = [
        ("a / b", [2.0, 0.0, 0.0], &[LARGEST]),
        ("a / b", [-2.0, 0.0, 0.0], &[-LARGEST]),
        ("a / b + c", [0.0, 0.0, 0.0], &[0.0]),
        ("a % b", [3.0, 0.0, 0.0], &[0.0]),
    ];
    check_in(&[Known::Frame, Known::Point], "", &rows);
    for known in [Known::Frame, Known::Point] {
        for expr in ["pow(a, -1)", "log(a)", "tan(90deg + a)", "normalize((a, a))[0]", "exp(1e9 + a)"] {
            let found = value("", expr, [0.0; 3], known);
            assert!(found.is_finite() && found.abs() <= LARGEST, "{expr} is {found}");
        }
    }
}

#[test]
fn hashes_are_the_same_bits_in_every_way() {
    let mut seen = Vec::new();
    for i in -40..40 {
        let given = [f64::from(i) * 0.37, f64::from(i * i), -3.0];
        for expr in ["hash(a)", "hash((a, b))", "hash((a, b, c))"] {
            let h = alike("", expr, given);
            assert!((0.0..1.0).contains(&h), "{expr} of {given:?} is {h}");
            seen.push(h);
        }
    }
    let mean = seen.iter().sum::<f64>() / seen.len() as f64;
    assert!((mean - 0.5).abs() < 0.1, "the mean of {} hashes is {mean}", seen.len());
    seen.sort_by(f64::total_cmp);
    seen.dedup();
    assert!(seen.len() > 230, "only {} different hashes", seen.len());
    assert_eq!(alike("", "hash(a)", [-0.0, 0.0, 0.0]), alike("", "hash(a)", [0.0; 3]), "zero is one number");
}

#[test]
fn noise_is_bounded_continuous_and_alike() {
    for expr in ["noise(a)", "noise((a, b))", "noise((a, b, c))"] {
        for i in 0..12 {
            let at = f64::from(i) * 0.61 - 3.0;
            alike("", expr, [at, at * 0.7 + 0.1, -at]);
        }
        let field = Field::of_values("", &format!("let a = p.x; let b = p.y; let c = p.z; {expr}"));
        let line = |i: usize| {
            let t = i as f64 * 1e-3 - 4.0;
            [t, 0.3 + t * 0.7, -0.2 - t]
        };
        let values = field.distances(&(0..8000).map(line).collect::<Vec<_>>());
        let (low, high) =
            (values.iter().copied().fold(1.0, f64::min), values.iter().copied().fold(-1.0, f64::max));
        assert!(low >= -1.0 && high <= 1.0, "{expr} goes from {low} to {high}");
        assert!(high - low > 0.5, "{expr} only goes from {low} to {high}");
        let jump = values.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        assert!(jump < 0.02, "{expr} jumps by {jump}");
    }
}

#[test]
fn inputs_have_their_defaults_and_can_be_set() {
    let text = "param on = true param tint = #ff0000 param k = 2 in 0..4
        scene { field { length(p) + (if on { 10 } else { 20 }) + tint.r * 100 + tint.g * 500 + k * 1000 } }";
    let at = |set: &[(&str, &str)]| Field::of_scene(scene_set(text, set), text).at([0.0; 3]);
    assert_eq!(at(&[]), 2110.0);
    assert_eq!(at(&[("on", "false")]), 2120.0);
    assert_eq!(at(&[("tint", "#00ff00")]), 2510.0);
    assert_eq!(at(&[("k", "4")]), 4110.0);
    assert_eq!(at(&[("k", "0"), ("on", "false"), ("tint", "#000")]), 20.0);
    let inputs = "scene { field { length(p) + time + mouse.x * 10 + mouse.y * 100 } }";
    assert_eq!(Field::of(inputs).at([0.0; 3]), 55.0);
}

/// The renderer asks for the distance at the eye, which is known: that is no place for mistakes.
#[test]
fn what_is_wrong_at_the_eye_only_is_no_mistake() {
    let camera = "camera { eye: (0, 0, 5) }";
    assert_eq!(Field::of_values(camera, "1 / p.x").at([2.0, 0.0, 0.0]), 0.5);
    assert_eq!(Field::of_values(camera, "length(p) + (1, 2, 3)[0] % p.y").at([0.0, 4.0, 0.0]), 5.0);
    assert_eq!(Field::of_values(camera, "(if p.x < 1 { 0 } else { (p.x, 2) })[0]").at([2.0, 0.0, 0.0]), 2.0);
}

/// Values of the frame that are first needed inside a loop or a branch are still there outside.
#[test]
fn items_do_not_depend_on_where_they_are_first_needed() {
    let text = "
        fn scaled(v) { let w = v * rate; w }
        let inside = if time > 1 { scaled(3) } else { scaled(2) }
        let loop_inside = iterate(3, time, |i, s| s + slow)
        let rate = cos(time)
        let slow = cos(time * 2)
        scene { field { length(p) + inside + loop_inside * 10 + rate * 100 + slow * 1000 } }";
    assert_eq!(Field::of(text).at([0.0; 3]), 2.0 + 30.0 + 100.0 + 1000.0);
    let gradients = "
        let ball = sphere(1 + time)
        let away = gradient(ball, (time + 3, 0, 0))
        scene { field { length(p) + away.distance + away.gradient.x * 10 } }";
    assert_eq!(Field::of(gradients).at([0.0; 3]), 12.0);
}

#[test]
fn mistakes_in_values_are_found() {
    let rows = [
        ("let a = 1 / 0", "E042"),
        ("let a = 1 % 0", "E042"),
        ("let a = 1e30 * 1e30", "E041"),
        ("let a = [1, 2][2]", "E035"),
        ("let a = [1, 2][-1]", "E035"),
        ("let a = [1, 2][time]", "E040"),
        ("let a = 0..time", "E040"),
        ("let a = 0..70000", "E044"),
        ("let a = iterate(time, 0, |i, s| s)", "E040"),
        ("fn f(n) = f(n + 1) let a = f(0)", "E044"),
        ("fn f(n) = if n == 0 { 0 } else { f(n - 1) } let a = f(256)", "E044"),
        ("let a = b let b = c + 1 let c = a", "E022"),
        ("let a = a", "E022"),
        ("let a = (1, 2, 3, 4)", "E030"),
        ("let a = (1, 2).z", "E034"),
        ("let a = (1, 2) + (1, 2, 3)", "E031"),
        ("let a = sphere(1) + sphere(2)", "E031"),
        ("let a = sphere(1) - 0.1", "E031"),
        ("let a = sphere(1) - circle(1)", "E031"),
        ("let a = cube(1)", "E020"),
        ("let a = sphere()", "E032"),
        ("let a = sphere(1, 2)", "E032"),
        ("let a = sphere(1, r: 2)", "E032"),
        ("let a = sphere(radius: 2)", "E032"),
        ("fn f(v: vec2) = 2 fn f(v: vec3) = 3 let a = f(1)", "E033"),
        ("let a = if time > 1 { [1] } else { [1, 2] }", "E040"),
        ("let a = if time > 1 { sphere(1) } else { 2 }", "E040"),
        ("let a = 1 let a = 2", "E021"),
        ("let a = p", "E050"),
        ("param a = 3 in 0..2", "E043"),
        ("param a = 3", "E063"),
        ("param a = time in 0..2", "E040"),
    ];
    for (text, code) in rows {
        let found = findings(&format!("{text}\nscene {{ sphere(1) }}"));
        assert_eq!(found.len(), 1, "{text}: {found:#?}");
        assert!(found[0].starts_with(code), "{text}: {found:#?} and not {code}");
    }
    let chosen = findings("scene { field { (if p.x > 0 { sphere(1) } else { box(1) })(p) } }");
    assert!(chosen.len() == 1 && chosen[0].starts_with("E040"), "{chosen:#?}");
    let path = &findings("let a = b let b = c + 1 let c = a scene { sphere(1) }")[0];
    assert!(path.contains("a → b → c → a"), "{path}");
}
