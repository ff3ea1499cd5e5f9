//! Functions of a user's file are as good as the library's: what they promise is used, and tried.

use sdf_lang::Options;
use sdf_syntax::{Code, Diagnostic};

const ROSETTE: &str = include_str!("../../examples/rosette.sdf");
/// How many points `sdfc check` tries.
const POINTS: usize = 100_000;

fn checked(text: &str) -> Vec<Diagnostic> {
    let options = Options { attack: Some(POINTS), ..Options::default() };
    sdf_lang::compile("rosette.sdf", text, &options).diagnostics
}

/// The rosette with something else in place of a part of it.
fn with(part: &str, other: &str) -> String {
    assert_eq!(ROSETTE.matches(part).count(), 1, "`{part}`");
    ROSETTE.replace(part, other)
}

#[test]
fn true_promises_hold() {
    assert_eq!(checked(ROSETTE), []);
}

/// A primitive that is not the distance, one that leaves its box, a blend and an operator that are steeper than they say:
/// each is named with a point or two.
#[test]
fn false_promises_are_caught_with_a_point() {
    let cases = [
        (
            "{ length(q - (r, 0)) } else { length((q.x, q.y + off)) - ball }",
            "{ 0.97 * length(q - (r, 0)) } else { 0.97 * (length((q.x, q.y + off)) - ball) }",
            "@exact",
            "at (",
        ),
        (
            "@bounds(-(r, thickness / 2, r)",
            "@bounds(-(r, thickness / 3, r)",
            "@bounds(-(r, thickness / 3",
            "(",
        ),
        (
            "@lipschitz(sqrt(2) * max(slope(a), slope(b)))",
            "@lipschitz(0.9)",
            "@lipschitz(0.9)",
            "the slope of this field is",
        ),
        (
            "slope(s) * shear(rate * (length(p.xz) + abs(d)))",
            "slope(s) * 1.2",
            "@lipschitz(slope(s) * 1.2",
            "the slope of this field is",
        ),
    ];
    for (part, other, promise, point) in cases {
        let text = with(part, other);
        let found = checked(&text);
        // What is made of a shape with a false promise may break its own.
        let is_it = |d: &&Diagnostic| {
            d.code == Code::E053
                && text[d.span.start as usize..].starts_with(promise)
                && d.message.contains(point)
        };
        assert_eq!(found.iter().filter(is_it).count(), 1, "{other}: {found:#?}");
    }
}

/// Without its promise the blend's slope is found, the swirl's too; a jump has none, and the message says what to do.
#[test]
fn what_has_no_bound_says_how_to_state_one() {
    let without = |text: &str, name: &str| {
        let lines: Vec<&str> = text.lines().filter(|line| !line.contains(name)).collect();
        lines.join("\n")
    };
    assert_eq!(checked(&without(ROSETTE, "@lipschitz(sqrt(2)")), []);
    let jump = with("rotate(p, y, rate * length(p.xz))", "rotate(p, y, rate * floor(3 * p.x))");
    let found = checked(&without(&jump, "@lipschitz(slope(s)"));
    let refused: Vec<&Diagnostic> = found.iter().filter(|d| d.code == Code::E052).collect();
    assert!(!refused.is_empty(), "{found:#?}");
    assert!(refused[0].help.as_ref().is_some_and(|help| help.contains("@lipschitz(")), "{refused:#?}");
}
