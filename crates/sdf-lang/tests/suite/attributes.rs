//! Attributes: what they require is checked where they are called, and none is passed over.

use crate::scene::findings;
use sdf_lang::Options;

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
    check("scene { polygon([(0, 0), (1, 0)]).extrude(1) }", &["E043: points must be three or more; "]);
    check("scene { polygon([]).extrude(1) }", &["E043: points must be three or more; "]);
    check("scene { polygon([(0, 0), (1, 0), (0, 1)]).extrude(1) }", &[]);
    check("scene { smin(k: 0.1) }", &["E043: shapes must hold one or more; "]);
    check("scene { smax([], k: 0.1) }", &["E043: shapes must hold one or more; "]);
    check(
        "scene { intersection() }",
        &["E043: shapes must hold one or more: the intersection of none is everything; "],
    );
    check(
        "scene { intersection([]) }",
        &["E043: shapes must hold one or more: the intersection of none is everything; "],
    );
}

#[test]
fn promises_that_hold_are_taken() {
    for promise in
        ["exact", "bound", "bounds((-1, -1, -1), (1, 1, 1))", "bounds(-1, 1)", "lipschitz(1)", "convex"]
    {
        check(&format!("@{promise} fn f() = sphere(1) scene {{ f() }}"), &[]);
        check(&format!("@{promise} let f = sphere(1) scene {{ f.at(0, 1, 0) }}"), &[]);
    }
    check(
        "@lipschitz(1.5 * slope(s)) fn wide(s: shape) = field { s(p * 1.5) } scene { wide(sphere(1)) }",
        &[],
    );
    // An operator makes convex shapes of such shapes alone.
    check("@convex fn same(s: shape) = field { s(p) } scene { same(torus(1, 0.3)), same(box(1)) }", &[]);
    check("@bounds(lo(s) - 1, hi(s) + 1) fn fat(s: shape) = s.round(1) scene { fat(box(1)) }", &[]);
}

/// The beginnings of the findings about a text.
fn begins(text: &str, expected: &[&str]) {
    let found = findings(text);
    let fits = found.iter().zip(expected).all(|(f, e)| f.starts_with(e)) && found.len() == expected.len();
    assert!(fits, "{found:#?} in {text}");
}

#[test]
fn promises_that_do_not_hold_are_mistakes() {
    begins(
        "@bound fn steep(r) = field { 3 * (length(p) - r) } scene { steep(1) }",
        &["E053: the slope of this field is 2.9"],
    );
    begins(
        "@exact let s = box(1).scale((1, 2, 1)) scene { s }",
        &["E053: this field is not the distance: at "],
    );
    begins(
        "@lipschitz(1.9) fn wide(s: shape) = field { s(p * 2) } scene { wide(sphere(1)) }",
        &["E053: the slope of this field is 1.99"],
    );
    begins(
        "@bounds(-1, (1, 0.5, 1)) let ball = sphere(1) scene { ball }",
        &["E053: the shape has a point outside of this box, at "],
    );
    begins(
        "@convex let ring = torus(1, 0.3) scene { ring }",
        &["E053: this shape is not convex: it holds ("],
    );
    // A sheet has no inside; points of it are found all the same.
    let fold = "quad((-1, 0, 0), (0, 1, 1), (1, 0, 0), (0, -1, 1))";
    begins(&format!("@convex let fold = {fold} scene {{ fold }}"), &["E053: this shape is not convex: "]);
    begins("param gap = 0 in 0..0.5 @convex fn f() = sphere(1) - plane(x, -1 + gap) scene { f() }", &[""; 0]);
    begins(
        "param gap = 0 in 0..0.5 @convex fn f() = box(1) - box((gap, 2, 0.5)).at(0, 0, 1) scene { f() }",
        &["E053: this shape is not convex: "],
    );
    // A param's whole range is tried.
    begins(
        "param r = 1 in 1..3 @bounds(-2, 2) fn f() = sphere(r) scene { f() }",
        &["E053: the shape has a point outside of this box, at "],
    );
    // A jump is no slope.
    let jump = "@lipschitz(2) let steps = field { length(p) - 1 + 0.3 * step(0, p.x) } scene { steps }";
    let found = findings(jump);
    assert!(found[0].ends_with("no slope is enough for that: write it without the jump"), "{found:?}");
    // What is promised of a function is not promised of the fields inside it.
    let inner = "fn f() { let inner = field { 3 * (length(p) - 1) }; inner.scale(2) } scene { f() }";
    begins(&format!("@bound {inner}"), &["E053: the slope of this field is 2.9"]);
    check(&format!("@lipschitz(3) {inner}"), &[]);
}

#[test]
fn what_has_neither_a_box_nor_a_slope_is_a_mistake() {
    let said = "E052: how steep this field is cannot be bounded; state before the `fn` or `let` what it fills, \
                `@bounds((-1, -1, -1), (1, 1, 1))`, or how steep it is, `@lipschitz(2)`";
    check("scene { field { floor(p.x) + p.y } }", &[said]);
    check("scene { field { p.x * p.y } }", &[said]);
    check("let ok = field { sin(p.x) + p.y } scene { ok }", &[]);
    // In its box this one is steep, and outside of it nothing is asked of it.
    check("scene { field { dot(p, p) - 1 } }", &[]);
    check("scene { smin(field { dot(p, p) - 1 }, sphere(1).at(1, 0, 0), k: 0.2) }", &[]);
}

#[test]
fn attributes_that_mean_nothing_are_mistakes() {
    check("@exat fn f() = 1", &["E020: there is no attribute `@exat`; did you mean `@exact`?"]);
    check(
        "@inline fn f() = 1",
        &[
            "E020: there is no attribute `@inline`; the attributes are @exact, @bound, @lipschitz, @bounds, @convex, @requires",
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

/// A contract sees the parameters; what the body names besides does not hide anything from it.
#[test]
fn names_of_the_body_are_not_those_of_the_contract() {
    let text = "
        @exact
        @bounds(lo(s) - r, hi(s) + r)
        fn grown(s: shape, r) {
            let lo = 7;
            let hi = lo;
            field { s(p) - r * (hi / lo) }
        }
        scene { grown(box(1), 0.5) }";
    let options = Options { facts: true, ..Options::default() };
    let compilation = sdf_lang::compile("names", text, &options);
    let scene = compilation.scene.unwrap_or_else(|| panic!("{:#?}", compilation.diagnostics));
    let grown = scene.facts.iter().find(|fact| fact.name == "grown").expect("its row");
    assert_eq!((grown.extent.lo, grown.extent.hi), ([-1.5; 3], [1.5; 3]));
}
