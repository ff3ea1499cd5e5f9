//! Large scenes: many shapes, long chains, and what is too much.

use crate::scene::{Field, findings};

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
