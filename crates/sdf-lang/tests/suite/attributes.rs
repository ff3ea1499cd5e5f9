//! Attributes: what they require is checked where they are called, and none is passed over.

use crate::scene::findings;

/// Checks the findings about some items, with a scene of its own where they have none.
fn check(items: &str, expected: &[&str]) {
    let scene = if items.contains("scene {") { "" } else { "\nscene { sphere(1) }" };
    let found = findings(&format!("{items}{scene}"));
    assert_eq!(found, expected, "in {items}");
}

const THIN: &str = "@requires(r > 0, \"a thread needs a radius\")\nfn thread(r, h = 2) = cylinder(r, h)\n";

#[test]
fn requirements_are_checked_at_the_call() {
    let said = "E043: a thread needs a radius; ";
    check(&format!("{THIN}scene {{ thread(1) }}"), &[]);
    check(&format!("{THIN}scene {{ thread(0), thread(1), thread(-1) }}"), &[said, said]);
    check(&format!("{THIN}scene {{ 0.thread() }}"), &[said]);
    check(&format!("{THIN}scene {{ for i in 0..3 {{ thread(i - 1) }} }}"), &[said]);
    check(&format!("{THIN}param r = 1 in 0.1..2 scene {{ thread(r) }}"), &[]);
    let advice = "narrow the range of the param, or bound the value with `clamp`, `min` or `max`";
    let warned = format!("W002: a thread needs a radius; {advice}");
    check(&format!("{THIN}param r = 1 in 0..2 scene {{ thread(r), thread(r + 1) }}"), &[&warned]);
    check(
        "@requires(b > a, \"in order\") fn f(a, b = a + 1) = b scene { sphere(f(1)), sphere(f(1, 0.5)) }",
        &["E043: in order; "],
    );
    check(
        "@requires(n > 2, \"more\") @requires(n < 5, \"fewer\") fn f(n) = n let a = f(3) let b = f(1) let c = f(7)",
        &["E043: more; ", "E043: fewer; "],
    );
    check("@requires(limit > 3, \"too small\") let limit = 2", &["E043: too small; "]);
    check("@requires(limit > 1, \"too small\") let limit = 2", &[]);
}

#[test]
fn the_library_requires_what_its_shapes_need() {
    check(
        "scene { polygon([(0, 0), (1, 0)]).extrude(1) }",
        &["E043: a polygon needs three points or more; "],
    );
    check("scene { polygon([]).extrude(1) }", &["E043: a polygon needs three points or more; "]);
    check("scene { polygon([(0, 0), (1, 0), (0, 1)]).extrude(1) }", &[]);
    check("scene { smin(k: 0.1) }", &["E043: nothing to blend; "]);
    check("scene { smax([], k: 0.1) }", &["E043: nothing to blend; "]);
    check("scene { intersection() }", &["E043: the intersection of no shapes is everything; "]);
    check("scene { intersection([]) }", &["E043: the intersection of no shapes is everything; "]);
}

#[test]
fn promises_of_a_file_are_not_passed_over() {
    for promise in ["exact", "bound", "bounds((-1, -1, -1), (1, 1, 1))"] {
        let name = promise.split('(').next().unwrap();
        let said = format!("E064: the promise `@{name}` is not built yet; leave it out for now");
        check(&format!("@{promise} fn f() = sphere(1)"), &[&said]);
        check(&format!("@{promise} let f = sphere(1)"), &[&said]);
    }
}

#[test]
fn attributes_that_mean_nothing_are_mistakes() {
    check("@exat fn f() = 1", &["E020: there is no attribute `@exat`; did you mean `@exact`?"]);
    check(
        "@inline fn f() = 1",
        &[
            "E020: there is no attribute `@inline`; the attributes are @exact, @bound, @lipschitz, @bounds, @requires",
        ],
    );
    check(
        "@bound light sun { direction: y }",
        &["E063: an attribute stands before a `fn` or a `let`; remove it"],
    );
    let wrong = "E032: `@requires` takes a condition and a message; \
                 write for example `@requires(r > 0, \"the radius must be positive\")`";
    check("@requires(r > 0) fn f(r) = r", &[wrong]);
    check("@requires fn f(r) = r", &[wrong]);
    check("@requires(\"text\", r > 0) fn f(r) = r", &[wrong]);
    check("@requires(quantity > 0, \"text\") fn f(r) = r", &["E020: nothing is called `quantity`; "]);
    check("@requires(r, \"text\") fn f(r) = r let a = f(1)", &["E030: this is a float, not a bool; "]);
}
