//! Large scenes: many shapes, long chains, and what is too much.

use crate::scene::{Field, compile, findings};
use std::time::{Duration, Instant};

const MANY: usize = 10_000;

fn ball(i: usize) -> String {
    format!("sphere(0.2).at({}, {}, {})", i % 100, i / 100, i % 7)
}

/// Ten thousand shapes in each way of writing them down.
#[test]
fn many_shapes() {
    let balls: Vec<String> = (0..MANY).map(ball).collect();
    let scenes = [
        balls.join(", "),
        balls.join(" | "),
        "for i in 0..10000 { sphere(0.2).at(i % 100, floor(i / 100), i % 7) }".to_string(),
        "union(for i in 0..10000 { sphere(0.2).at(i % 100, floor(i / 100), i % 7) })".to_string(),
    ];
    for shapes in scenes {
        let field = Field::of_shape("camera { eye: (0, 0, -9) }", &shapes);
        let start = &shapes[..40];
        for i in [0, 1, 4711, MANY - 1] {
            let center = [i % 100, i / 100, i % 7].map(|x| x as f64);
            assert!((field.at(center) + 0.2).abs() < 1e-12, "ball {i} of {start}");
        }
        assert!((field.at([-3.0, 0.0, 0.0]) - 2.8).abs() < 1e-12, "outside of {start}");
    }
}

/// Ten thousand moves, one after the other: nothing overflows and little is lost.
#[test]
fn long_chains_of_moves() {
    let links: String = (0..MANY / 2).map(|_| ".at(1, 0, 0).rotate(y, 1deg)").collect();
    let field = Field::of_shape("camera { eye: (0, 0, -9) }", &format!("box(1, 2, 3){links}"));
    // A point of the box goes the same way: it stays on the surface.
    let (mut x, mut z) = (1.0f64, 0.5f64);
    let (sine, cosine) = 1f64.to_radians().sin_cos();
    for _ in 0..MANY / 2 {
        x += 1.0;
        (x, z) = (cosine * x + sine * z, cosine * z - sine * x);
    }
    let d = field.at([x, 0.25, z]);
    assert!(d.abs() < 1e-7, "the distance at ({x}, {z}) is {d}");
}

#[test]
fn too_much_is_an_error() {
    let rows = [
        ("let a = for i in 0..70000 { i }", "E044: this range is longer than the limit of 65536"),
        ("let a = iterate(70000, 0, |i, s| s)", "E043: the number of rounds is out of range"),
        ("fn f(n) = f(n + 1) let a = f(0)", "E044: the recursion of `f` is longer than the limit of 256"),
        ("fn f(n) = g(n) fn g(n) = f(n) let a = f(0)", "E044: the recursion of `"),
        ("let f = |g| g(g) let a = f(f)", "E044: the recursion of this function"),
        (
            "let a = sum(for i in 0..60000 { sum(for j in 0..60000 { i * j }) })",
            "E045: the scene needs more than 1000000 operations",
        ),
    ];
    for (text, start) in rows {
        let found = findings(&format!("{text} scene {{ sphere(1) }}"));
        assert!(found.len() == 1 && found[0].starts_with(start), "{text}: {found:#?}");
    }
}

/// A shape that doubles with each line has few functions and no end of operations: it is refused, and at once.
#[test]
fn expansions_are_counted_without_being_expanded() {
    let lines = |n: usize| -> String {
        (0..n).map(|i| format!("let s{} = s{i} | s{i}.at(1, 0, {i})\n", i + 1)).collect()
    };
    let text = |n: usize| format!("let s0 = sphere(1)\n{}scene {{ s{n} }}", lines(n));
    assert_eq!(findings(&text(10)), [""; 0]);
    let found = findings(&text(40));
    assert!(
        found.len() == 1
            && found[0].starts_with("E045: the scene needs more than 1000000 operations at each"),
        "{found:#?}"
    );
}

/// `inner` inside of thirty of these, each written with the number of its nest.
fn nest(open: impl Fn(usize) -> String, inner: &str, close: &str) -> String {
    let opened: String = (0..30).map(open).collect();
    format!("{opened}{inner}{}", close.repeat(30))
}

/// Thirty definitions, each three times the one before.
fn definitions(first: &str, next: impl Fn(usize) -> String) -> String {
    first.to_string() + &(0..30).map(next).collect::<String>()
}

/// Expansions of 3^30 or 2^30 in all ways of writing them are refused, with the code of the limit, before a second is
/// over in a build for development.
#[test]
fn nested_expansions_are_refused_at_once() {
    let union = |name: &str| format!("{name} | {name} | {name}");
    let texts = [
        // The same arguments.
        format!("fn f(n) = if n == 0 {{ sphere(1) }} else {{ {} }} scene {{ f(30) }}", union("f(n - 1)")),
        "fn f(n) = if n == 0 { sphere(1) } else { smin(f(n-1).at(1, 0, 0), f(n-1).rotate_y(time), f(n-1), k: 0.1) }
         scene { f(30) }"
            .into(),
        definitions("fn f0() = sphere(1)\n", |i| {
            format!("fn f{}() = {}\n", i + 1, union(&format!("f{i}()")))
        }) + "scene { f30() }",
        // What is shared.
        definitions("let a0 = sphere(1)\n", |i| format!("let a{} = a{i} | a{i}.at(1, 0, {i})\n", i + 1))
            + "scene { a30 }",
        "fn t() {".to_string()
            + &definitions("let a0 = sphere(1);", |i| format!("let a{} = a{i} | a{i}.at(1, 0, 0);", i + 1))
            + "a30 } scene { t() }",
        definitions("let l0 = [sphere(1)]\n", |i| format!("let l{} = [l{i}, l{i}, l{i}]\n", i + 1))
            + "scene { l30 }",
        "fn h(s: shape, n) = if n == 0 { s } else { h(field { s(p) + s(p + 1) + s(p - 1) }, n - 1) }
         scene { h(sphere(1), 30) }"
            .into(),
        definitions("let a0 = sphere(1)\n", |i| format!("let a{} = a{i} | a{i}.at(1, 0, {i})\n", i + 1))
            + "let d = a30((0, 0, 0)) scene { sphere(d) }",
        // Loops that run in the shader.
        format!(
            "scene {{ field {{ {} }} }}",
            nest(|i| format!("iterate(3, 0, |i{i}, s{i}| s{i} + "), "p.x", ")")
        ),
    ];
    for text in texts {
        let begin = Instant::now();
        let found = findings(&text);
        let time = begin.elapsed();
        assert!(found.len() == 1 && found[0].starts_with("E045: "), "{text}: {found:#?}");
        assert!(time < Duration::from_secs(1), "{text}: {time:?}");
    }
}

/// Where every call has other arguments, and every round another number, they are counted as well; inside of a field
/// the limit on work ends it.
#[test]
fn expansions_of_different_calls_are_refused_at_once() {
    let texts = [
        "fn f(n, a) = if n == 0 { sphere(1).at(a, 0, 0) } else { f(n-1, 3*a) | f(n-1, 3*a+1) | f(n-1, 3*a+2) }
         scene { f(30, 0) }"
            .to_string(),
        "fn g(n, a) = if n == 0 { a } else { g(n-1, a) + g(n-1, a+1) + g(n-1, a+2) }
         scene { field { length(p) - g(30, p.x) } }"
            .into(),
        "fn thrice(s, q) = s(q) + s(q + 1) + s(q - 1)
         fn h(s: shape, n) = if n == 0 { s } else { h(field { thrice(s, p) }, n - 1) }
         scene { h(sphere(1), 30) }"
            .into(),
        format!("scene {{ {} }}", nest(|i| format!("for i{i} in 0..3 {{"), "sphere(1)", "}")),
        format!(
            "scene {{ {} }}",
            nest(|i| format!("fold(0..3, nothing(), |a{i}, b{i}| a{i} | "), "sphere(1)", ")")
        ),
    ];
    for text in texts {
        let begin = Instant::now();
        let found = findings(&text);
        let time = begin.elapsed();
        assert!(found.len() == 1 && found[0].starts_with("E045: "), "{text}: {found:#?}");
        assert!(time < Duration::from_secs(2), "{text}: {time:?}");
    }
}

/// What is large and not too large is not refused: a look ahead counts it, and then it is evaluated.
#[test]
fn a_look_ahead_refuses_nothing_else() {
    let texts = [
        "fn row(a, b) = if b - a < 2 { sphere(0.1).at(a, 0, 0) } else { let m = floor((a + b) / 2); row(a, m) | row(m, b) }
         scene { row(0, 5000) }",
        "let area = sum(for i in 0..100 { sum(for j in 0..100 { sin(i) * cos(j) + i * j }) }) scene { sphere(area * 1e-9) }",
        // Only one of the calls goes deep, whatever the first was like.
        "fn f(n, deep) = if n == 0 { 1 } else { if deep > 0 { f(n - 1, deep) + f(n - 1, deep - 1) } else { 1 } }
         scene { sphere(f(200, 2) * 1e-6) }",
        "fn f(n, a) = if n == 0 { a } else { max(f(n - 1, a), f(n - 1, a + 1)) } scene { sphere(f(14, 1)) }",
    ];
    for text in texts {
        assert_eq!(findings(text), [""; 0], "{text}");
    }
    // The numbers are those of the evaluation, not of the look ahead.
    let field = Field::of_shape(
        "fn f(n, a) = if n == 0 { a } else { f(n - 1, a) + f(n - 1, a + 1) }",
        "sphere(f(14, 1) * 1e-6)",
    );
    assert!((field.at([1.0, 0.0, 0.0]) - (1.0 - 8.0 * 16384.0 * 1e-6)).abs() < 1e-9);
}

/// A call with the same arguments is carried out once, so these take as many calls as they are deep.
#[test]
fn equal_calls_are_carried_out_once() {
    let texts: [fn(u32) -> String; 5] = [
        |n| {
            format!(
                "fn fib(n) = if n < 2 {{ n }} else {{ fib(n - 1) + fib(n - 2) }} fn ball(n) = sphere(fib(n) * 1e-9)
                 scene {{ ball({n}) }}"
            )
        },
        |n| {
            format!(
                "fn g(n) = if n == 0 {{ x }} else {{ g(n - 1) + g(n - 1) + g(n - 1) }} scene {{ sphere(g({n}).x) }}"
            )
        },
        |n| {
            format!(
                "fn g(n, a) = if n == 0 {{ a }} else {{ g(n - 1, a) + g(n - 1, a) }}
                 scene {{ field {{ length(p) - 1e-19 * g({n}, p.x) }} }}"
            )
        },
        |n| {
            format!(
                "let f = |g, n| if n == 0 {{ 1 }} else {{ g(g, n - 1) * g(g, n - 1) }} scene {{ sphere(f(f, {n})) }}"
            )
        },
        |n| {
            let records = (0..n).map(|i| format!("let r{} = (a: r{i}, b: r{i})\n", i + 1));
            format!("let r0 = 1\n{}fn one(r) = 1 scene {{ sphere(one(r{n})) }}", records.collect::<String>())
        },
    ];
    for text in texts {
        let [half, whole] = [20, 40].map(|n| {
            let compilation = compile(&text(n), &[]);
            assert!(compilation.diagnostics.is_empty(), "{}: {:#?}", text(n), compilation.diagnostics);
            compilation.work
        });
        assert!(whole <= 3 * half, "{}: {half} and {whole}", text(40));
        assert!(whole < 20_000, "{}: {whole}", text(40));
    }
}

/// What a call says is wrong is said once, however often it is made; calls that are wrong at other places are others.
#[test]
fn equal_calls_are_wrong_once() {
    let found = findings(
        "fn f(n) = if n == 0 { sphere((1, 2)) } else { f(n - 1) | f(n - 1) | f(n - 1) }
         scene { f(30) }",
    );
    assert!(found.len() == 1 && found[0].starts_with("E032: `sphere` does not take a vec2"), "{found:#?}");
    let found = findings("scene { sphere(true), sphere(true) }");
    assert_eq!(found.len(), 2, "{found:#?}");
}

/// The usual ways of writing many shapes, as a scene of this many.
fn ways(n: usize) -> Vec<(&'static str, String)> {
    let balls = || (0..n).map(ball);
    let joined = |separator: &str| balls().collect::<Vec<_>>().join(separator);
    let per_ball = |line: &dyn Fn(usize) -> String| (0..n).map(line).collect::<String>();
    let scene = |entries: String| format!("camera {{ eye: (0, 0, -9) }} scene {{ {entries} }}");
    vec![
        ("entries", scene(joined(", "))),
        ("a chain", scene(joined(" | "))),
        ("a list", scene(format!("for i in 0..{n} {{ sphere(0.2).at(i, 0, 0) }}"))),
        ("a fold", scene(format!("fold(0..{n}, nothing(), |a, i| a | sphere(0.2).at(i, 0, 0))"))),
        ("a blend", scene(format!("smin({}, k: 0.1)", joined(", ")))),
        (
            "a recursion",
            "fn tree(a, b) = if b - a < 1.5 { sphere(0.2).at(a, 0, 0) } else {
               let m = floor((a + b) / 2); tree(a, m) | tree(m, b) }"
                .to_string()
                + &scene(format!("tree(0, {n})")),
        ),
        (
            "modifiers",
            scene(per_ball(&|i| {
                format!("box(0.2).at({i}, 0, 0).rotate((1, 2, 3), {i}deg).paint(#{:06x}),", i % 0xffffff)
            })),
        ),
        (
            "lets",
            per_ball(&|i| format!("let s{i} = {}\n", ball(i))) + &scene(per_ball(&|i| format!("s{i},"))),
        ),
        (
            "lets of the scene",
            scene(per_ball(&|i| format!("let s{i} = {};", ball(i))) + &per_ball(&|i| format!("s{i},"))),
        ),
        (
            "functions",
            per_ball(&|i| format!("fn s{i}(r) = sphere(r).at({i}, 0, 0)\n"))
                + &scene(per_ball(&|i| format!("s{i}(0.2),"))),
        ),
        (
            "materials",
            per_ball(&|i| format!("material m{i} {{ color: {} }}\n", (i % 97) as f64 / 97.0))
                + &scene(per_ball(&|i| format!("{}.paint(m{i}),", ball(i)))),
        ),
    ]
}

/// A long loop inside of a field is what it is.
#[test]
fn a_long_loop_in_a_field_is_no_expansion() {
    let field = "min(for i in 0..20000 { length(p - (hash(i), hash(i + 0.5), hash(i + 0.25)) * 50) - 0.2 })";
    let scene = crate::scene::scene(&format!("camera {{ eye: (99, 0, 0) }} scene {{ field {{ {field} }} }}"));
    assert!(sdf_ir::cost::operations(&scene.program, scene.map.unwrap()) > 200_000);
    let fold = "fold(0..3000, 1e9, |a, i| min(a, length(p - (i, 0, 0)) - 0.3))";
    crate::scene::scene(&format!("camera {{ eye: (99, 0, 0) }} scene {{ field {{ {fold} }} }}"));
}

/// The slope of a line through points: the exponent of a power, where these are logarithms.
fn slope(points: &[(f64, f64)]) -> f64 {
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2))
}

/// What is evaluated and what comes of it grow with the number of shapes, whatever way they are written. Times are
/// measured by `cargo bench`.
#[test]
fn work_grows_with_the_number_of_shapes() {
    let sizes = [64, 128, 256, 512, 1024];
    for way in 0..ways(1).len() {
        let (mut work, mut nodes) = (Vec::new(), Vec::new());
        let mut name = "";
        for n in sizes {
            let (this, text) = ways(n).swap_remove(way);
            name = this;
            let compilation = compile(&text, &[]);
            let scene = compilation.scene.unwrap_or_else(|| panic!("{name}: {:?}", compilation.diagnostics));
            let made: usize = scene.program.functions.iter().map(|f| f.node_count()).sum();
            work.push(((n as f64).ln(), (compilation.work as f64).ln()));
            nodes.push(((n as f64).ln(), (made as f64).ln()));
        }
        assert!(slope(&work) < 1.1, "{name}: the work grows as n^{:.2}", slope(&work));
        assert!(slope(&nodes) < 1.1, "{name}: the nodes grow as n^{:.2}", slope(&nodes));
    }
}
