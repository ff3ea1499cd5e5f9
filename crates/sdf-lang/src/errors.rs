//! The diagnostics of meaning: one function each. The message says what is wrong, the help what to do.

use crate::facts::Broken;
use crate::import::{DEPTH_LIMIT, Refusal};
use sdf_syntax::tree::Name;
use sdf_syntax::{Code, Diagnostic, Span};

/// What a name that nothing defines was perhaps meant to be, and what is said of it.
pub(crate) fn unknown_name(
    span: Span,
    name: &str,
    foreign: Option<&str>,
    similar: Option<&str>,
) -> Diagnostic {
    let d = Diagnostic::new(Code::E020, span, format!("nothing is called `{name}`")).label("not found");
    match (foreign, similar) {
        (Some(ours), _) => d.help(ours.to_string()),
        (None, Some(s)) => d.help(format!("did you mean `{s}`?")),
        (None, None) => d,
    }
}

pub(crate) fn no_point(span: Span, name: &str) -> Diagnostic {
    Diagnostic::new(Code::E050, span, format!("there is no point `{name}` here"))
        .label("only a field, a material or a sky has one")
        .help(format!(
            "write `field {{ … {name} … }}` for a shape, `material {{ color: … {name} … }}` for a surface"
        ))
}

pub(crate) fn defined_twice(name: &Name, first: Span) -> Diagnostic {
    Diagnostic::new(Code::E021, name.span, format!("`{}` is defined twice", name.text))
        .label("here again")
        .related(first, "first defined here")
        .help("give one of them another name")
}

pub(crate) fn cycle(span: Span, path: &[String], places: &[Span]) -> Diagnostic {
    let mut d =
        Diagnostic::new(Code::E022, span, format!("`{}` needs itself: {}", path[0], path.join(" → ")))
            .label("to know this, it must be known");
    for (name, place) in path.iter().skip(1).zip(places.iter().skip(1)) {
        if *name != path[0] {
            d = d.related(*place, format!("`{name}` is defined here"));
        }
    }
    d.help("break the circle")
}

/// How many characters of a path a message quotes.
const LONGEST_PATH: usize = 100;

pub(crate) fn import_refused(span: Span, path: &str, refusal: &Refusal) -> Diagnostic {
    // The name stands at the place; a very long one would hide what is said of it.
    let shown: String = path.chars().take(LONGEST_PATH).collect();
    let more = if shown.len() < path.len() { "…" } else { "" };
    let d = Diagnostic::new(Code::E024, span, format!("cannot import `{shown}{more}`: {}", refusal.message));
    match &refusal.help {
        Some(help) => d.help(help.clone()),
        None => d,
    }
}

pub(crate) fn imports_without_files(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E024, span, "this scene is not compiled from a folder, so it can import nothing")
        .help("put everything into one file")
}

/// `path` are the names of the files, the first one once more at the end.
pub(crate) fn import_circle(span: Span, path: &[&str]) -> Diagnostic {
    Diagnostic::new(Code::E022, span, format!("`{}` imports itself: {}", path[0], path.join(" → ")))
        .label("closes the circle")
        .help("move what both need into a file of its own")
}

pub(crate) fn imports_too_deep(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E009, span, format!("files import each other more than {DEPTH_LIMIT} deep"))
        .label("too deep from here on")
}

pub(crate) fn too_many_imports(span: Span, limit: &str) -> Diagnostic {
    Diagnostic::new(Code::E009, span, format!("the scene imports more than {limit}"))
        .label("reached the limit here")
}

/// A name that another file defines, which this one does not import: imports are not passed on.
pub(crate) fn not_imported_here(span: Span, name: &str, place: Span) -> Diagnostic {
    Diagnostic::new(Code::E020, span, format!("nothing is called `{name}` in this file"))
        .label("not found")
        .related(place, "defined in this file, which is not imported there")
        .help("import that file as well: what a file imports is not passed on")
}

pub(crate) fn import_clash(span: Span, name: &str, first: Span, second: Span) -> Diagnostic {
    Diagnostic::new(Code::E025, span, format!("two imported files define `{name}`"))
        .label("which one is meant?")
        .related(first, "one is here")
        .related(second, "the other is here")
        .help("rename one of them, or define your own, which hides both")
}

pub(crate) fn wrong_type(span: Span, expected: &str, found: &str) -> Diagnostic {
    let d = Diagnostic::new(Code::E030, span, format!("this is {found}, not {expected}"))
        .label(format!("expected {expected}"));
    match (expected, found) {
        ("a shape", "a function") => d.help("call it, or write a shape by its distance: `field { … p … }`"),
        ("a shape", _) if found.starts_with("a list") => d.help("`union(list)` makes one shape of several"),
        _ => d,
    }
}

pub(crate) fn mixed_list(span: Span, first: &str, other: &str) -> Diagnostic {
    Diagnostic::new(
        Code::E030,
        span,
        format!("a list has elements of one type, and this has {first} and {other}"),
    )
    .label(format!("expected {first}"))
    .help("values that belong together are a record: `(size: 1, shape: s)`")
}

pub(crate) fn operator(span: Span, op: &str, left: &str, right: &str, help: Option<&str>) -> Diagnostic {
    let d = Diagnostic::new(Code::E031, span, format!("`{op}` does not take {left} and {right}"));
    match help {
        Some(h) => d.help(h),
        None => d,
    }
}

pub(crate) fn prefix_operator(span: Span, op: &str, operand: &str, help: Option<&str>) -> Diagnostic {
    let d = Diagnostic::new(Code::E031, span, format!("`{op}` does not take {operand}"));
    match help {
        Some(h) => d.help(h),
        None => d,
    }
}

pub(crate) fn not_callable(span: Span, found: &str) -> Diagnostic {
    Diagnostic::new(Code::E032, span, format!("{found} cannot be called")).label("not a function or shape")
}

/// No function of this name takes these arguments; `why` says what hinders the only or the nearest one.
pub(crate) fn no_fit(span: Span, name: &str, given: &str, why: &str, signatures: &[String]) -> Diagnostic {
    let message = match given {
        "no arguments" => format!("`{name}` cannot be called without arguments"),
        given => format!("`{name}` does not take {given}"),
    };
    let d = Diagnostic::new(Code::E032, span, message).label(why.to_string());
    match signatures {
        [] => d,
        [one] => d.help(format!("it is called as `{one}`")),
        many => d.help(format!("it is called as {}", join_or(many))),
    }
}

fn join_or(items: &[String]) -> String {
    let quoted: Vec<String> = items.iter().map(|i| format!("`{i}`")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.join(""),
    }
}

pub(crate) fn ambiguous(span: Span, name: &str, signatures: &[String]) -> Diagnostic {
    Diagnostic::new(Code::E033, span, format!("this call of `{name}` fits {}", signatures.join(" and ")))
        .label("which one is meant?")
        .help("write an argument so that it fits only one, for example a vector instead of a float")
}

pub(crate) fn no_member(span: Span, name: &str, of: &str, help: Option<String>) -> Diagnostic {
    let d = Diagnostic::new(Code::E034, span, format!("{of} has no `{name}`"));
    match help {
        Some(h) => d.help(h),
        None => d,
    }
}

pub(crate) fn index_out_of_range(span: Span, index: f64, len: usize) -> Diagnostic {
    Diagnostic::new(Code::E035, span, format!("there is no element {index}")).label(match len {
        0 => "there are none".to_string(),
        1 => "only 0 is there".to_string(),
        _ => format!("0 to {} are there", len - 1),
    })
}

pub(crate) fn not_static(span: Span, what: &str) -> Diagnostic {
    Diagnostic::new(Code::E040, span, format!("{what} must be known when the scene is compiled"))
        .label("depends on `time`, `mouse`, a param or a point")
        .help("use a constant here, or freeze the param with `--set`")
}

pub(crate) fn shape_depends_on_point(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E040, span, "which shape it is must not depend on anything that changes")
        .label("this condition is not static")
        .help("choose between numbers inside a `field`, or blend the shapes")
}

pub(crate) fn not_finite(span: Span, what: &str) -> Diagnostic {
    Diagnostic::new(Code::E041, span, format!("{what} is too large"))
        .label("not a finite number")
        .help("numbers go up to 3.4e38")
}

pub(crate) fn division_by_zero(span: Span, op: &str) -> Diagnostic {
    Diagnostic::new(Code::E042, span, format!("the right side of `{op}` is 0")).label("division by zero")
}

pub(crate) fn out_of_range(span: Span, what: &str, expected: &str) -> Diagnostic {
    Diagnostic::new(Code::E043, span, format!("{what} is out of range")).label(format!("expected {expected}"))
}

/// `when` says for which values of params.
pub(crate) fn may_leave_range(span: Span, what: &str, expected: &str, when: &str) -> Diagnostic {
    Diagnostic::new(Code::W002, span, format!("{what} is out of range when {when}"))
        .label(format!("expected {expected}"))
        .help("narrow the range of the param, or bound the value with `clamp`, `min` or `max`")
}

pub(crate) fn degrees(span: Span, number: f64) -> Diagnostic {
    Diagnostic::new(Code::W003, span, format!("an angle of {number} radians is more than a turn"))
        .label("radians, for it has no unit")
        .help(format!("did you mean `{number}deg`? If not, write `{number}rad`"))
}

pub(crate) fn too_long(span: Span, what: &str, limit: u64) -> Diagnostic {
    Diagnostic::new(Code::E044, span, format!("{what} is longer than the limit of {limit}")).label("here")
}

pub(crate) fn too_large(span: Span, what: &str, limit: usize) -> Diagnostic {
    Diagnostic::new(Code::E045, span, format!("the scene needs more than {limit} {what}"))
        .label("reached the limit here")
        .help("use `repeat` for copies, with a period not far below their width, or fewer shapes")
}

/// A shape that is small as it is shared, and too large as it is written out.
pub(crate) fn expands_too_far(span: Span, operations: u64, limit: u64) -> Diagnostic {
    let count = match operations {
        u64::MAX => "too many to count".to_string(),
        count => count.to_string(),
    };
    Diagnostic::new(Code::E045, span, format!("the scene needs more than {limit} operations at each point"))
        .label(format!("this alone needs {count}: what is sampled twice counts twice"))
        .help("use `repeat` or `mirror` for copies, or end the doubling earlier")
}

/// What expands to more than can be evaluated.
pub(crate) fn takes_too_much(span: Span, count: u64) -> Diagnostic {
    let count = match count {
        u64::MAX => "too many to count".to_string(),
        count => count.to_string(),
    };
    Diagnostic::new(Code::E045, span, "the scene needs more than 1000000 operations")
        .label(format!("this expands to {count} expressions"))
        .help("use `repeat` or `mirror` for copies, or end the recursion or the loops earlier")
}

pub(crate) fn not_a_distance(span: Span, found: &str) -> Diagnostic {
    Diagnostic::new(Code::E051, span, format!("a field must give a float, and this gives {found}"))
        .label("expected the distance to the surface")
}

pub(crate) fn no_shares(span: Span) -> Diagnostic {
    Diagnostic::new(
        Code::E054,
        span,
        "the materials of a field cannot be mixed that samples shapes in a loop or branch",
    )
    .label("a painted shape is sampled inside `iterate` or an `if`")
    .help("paint the whole field instead")
}

pub(crate) fn no_scene(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E060, span, "there is no scene in this file")
        .help("add one, for example `scene { sphere(1) }`; a file without one can only be imported by others")
}

pub(crate) fn block_twice(span: Span, what: &str, first: Span) -> Diagnostic {
    Diagnostic::new(Code::E061, span, format!("there are two `{what}` blocks"))
        .label("here again")
        .related(first, "the first is here")
        .help("merge them into one")
}

pub(crate) fn unknown_setting(name: &Name, block: &str, similar: Option<&str>, all: &[&str]) -> Diagnostic {
    let d = Diagnostic::new(Code::E062, name.span, format!("`{block}` has no `{}`", name.text));
    let d = d.label("not a setting");
    match (sdf_syntax::foreign_setting(block, &name.text), similar) {
        (_, Some(s)) => d.help(format!("did you mean `{s}`?")),
        (Some(ours), None) => d.help(ours),
        (None, None) => d.help(format!("it has {}", all.join(", "))),
    }
}

/// A field that takes one of some words.
pub(crate) fn wrong_word(span: Span, name: &str, similar: Option<&str>, words: &[&str]) -> Diagnostic {
    let d = Diagnostic::new(Code::E063, span, format!("`{name}` does not take this value"));
    match similar {
        Some(word) => d.help(format!("did you mean `{word}`?")),
        None => d.help(format!("write one of {}", words.join(", "))),
    }
}

pub(crate) fn setting_twice(name: &Name, first: Span) -> Diagnostic {
    Diagnostic::new(Code::E061, name.span, format!("`{}` is set twice", name.text))
        .label("here again")
        .related(first, "first set here")
}

pub(crate) fn wrong_setting(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::new(Code::E063, span, message).help(help)
}

pub(crate) fn bad_override(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::new(Code::E065, span, message).help(help)
}

/// Whether a diagnostic is about values of the wrong type.
pub(crate) fn is_of_types(code: Code) -> bool {
    matches!(code, Code::E030 | Code::E031 | Code::E032 | Code::E033 | Code::E034 | Code::E051)
}

/// Arguments that fit a function of the library, and with which something inside of it does not work.
pub(crate) fn wrong_inside(span: Span, name: &str) -> Diagnostic {
    Diagnostic::new(Code::E032, span, format!("`{name}` does not take these arguments"))
        .label("one of them, or what it gives, is not what is needed")
        .help(format!("`sdfc doc {name}` says what each of them must be"))
}

/// What the author of a function or value requires does not hold.
pub(crate) fn requirement(span: Span, message: &str, stated: Span) -> Diagnostic {
    required_by(Diagnostic::new(Code::E043, span, message).label("refused here"), stated)
}

/// Shows where something is required, if that is in a file of the user; the library's messages say it all.
fn required_by(diagnostic: Diagnostic, stated: Span) -> Diagnostic {
    match crate::library::is_ours(stated.file) {
        true => diagnostic,
        false => diagnostic.related(stated, "required here"),
    }
}

/// What is required does not hold for some values of params, which `when` names.
pub(crate) fn breakable_requirement(span: Span, message: &str, stated: Span, when: &str) -> Diagnostic {
    required_by(Diagnostic::new(Code::W002, span, message).label(format!("not so when {when}")), stated)
        .help("narrow the range of the param, or bound the value with `clamp`, `min` or `max`")
}

pub(crate) fn unknown_attribute(name: &Name, similar: Option<&str>, all: &[&str]) -> Diagnostic {
    let d = Diagnostic::new(Code::E020, name.span, format!("there is no attribute `@{}`", name.text));
    match similar {
        Some(s) => d.label("not found").help(format!("did you mean `@{s}`?")),
        None => d.label("not found").help(format!("the attributes are @{}", all.join(", @"))),
    }
}

/// How many times steeper than promised looks like a jump: between points that are 1e-4 apart any jump is very steep.
const JUMP: f64 = 50.0;

/// A promise that does not hold, at the attribute that makes it.
pub(crate) fn broken_promise(span: Span, broken: &Broken) -> Diagnostic {
    let point = |p: &[f64; 3]| format!("({}, {}, {})", short(p[0]), short(p[1]), short(p[2]));
    let (message, help) = match broken {
        Broken::Slope { a, b, slope, promised } => (
            // Points that are as near as to read alike are one place.
            match point(a) == point(b) {
                true => format!("the slope of this field is {} at {}", short(*slope), point(a)),
                false => format!(
                    "the slope of this field is {} between {} and {}",
                    short(*slope),
                    point(a),
                    point(b)
                ),
            } + &format!(", not at most {}", short(*promised)),
            if *slope > JUMP * promised.max(1.0) {
                "it seems to jump there, and no slope is enough for that: write it without the jump"
                    .to_string()
            } else {
                let enough = short((slope * 11.0).ceil() / 10.0);
                format!("state what it is at most, for example `@lipschitz({enough})`")
            },
        ),
        Broken::Bounds { at } => (
            format!("the shape has a point outside of this box, at {}", point(at)),
            "state a larger box, or none: it is found then".to_string(),
        ),
        Broken::Exact { at, distance, left } => (
            format!(
                "this field is not the distance: at {} it is {}, and {} where the surface should be",
                point(at),
                short(*distance),
                short(*left)
            ),
            "state `@bound` if it is never more than the distance".to_string(),
        ),
        Broken::Convex { a, b, between } => (
            format!(
                "this shape is not convex: it holds {} and {}, but not {} between them",
                point(a),
                point(b),
                point(between)
            ),
            "leave `@convex` out".to_string(),
        ),
    };
    Diagnostic::new(Code::E053, span, message).label("does not hold").help(help)
}

/// A number with as many digits as a reader wants.
pub(crate) fn short(x: f64) -> String {
    let rounded = format!("{x:.4}");
    let rounded = rounded.trim_end_matches('0').trim_end_matches('.');
    if rounded == "0" && x != 0.0 || rounded == "-0" { format!("{x:.1e}") } else { rounded.to_string() }
}

/// Steps so short that rays may not arrive.
pub(crate) fn very_steep(span: Span, slope: f64) -> Diagnostic {
    let message =
        format!("this field may be as steep as {}, so that rays take very small steps", short(slope));
    Diagnostic::new(Code::W004, span, message)
        .label("rays may run out of steps on their way to it")
        .help("state its slope if you know that it is less, for example `@lipschitz(2)`, or raise `steps`")
}

/// A scene that no ray reaches. The place is where rays end, or the scene.
pub(crate) fn beyond_far(span: Span, distance: f64, far: f64) -> Diagnostic {
    let message = format!("the whole scene is farther from the eye than {}, where rays end", short(far));
    Diagnostic::new(Code::W007, span, message)
        .label(format!("nothing is nearer than {}", short(distance)))
        .help("let rays go farther with `render { far: … }`, or move the camera's `eye` nearer")
}

/// Neither a box nor a slope: a ray could not know how far it may step.
pub(crate) fn no_slope(span: Span, is_bounded: bool) -> Diagnostic {
    let why = match is_bounded {
        true => "it may jump, or change without bound, somewhere in its box",
        false => "it has no end, and may jump or change without bound somewhere",
    };
    Diagnostic::new(Code::E052, span, "how steep this field is cannot be bounded")
        .label(why)
        .help(match is_bounded {
            true => "state it before the `fn` or `let`: `@lipschitz(2)` if the field is nowhere steeper than 2",
            false => {
                "state before the `fn` or `let` what it fills, `@bounds((-1, -1, -1), (1, 1, 1))`, or how steep it \
                 is, `@lipschitz(2)`"
            }
        })
}

pub(crate) fn misplaced_attribute(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E063, span, "an attribute stands before a `fn` or a `let`")
        .label("before something else")
        .help("remove it")
}

/// An attribute with other arguments than it takes.
pub(crate) fn wrong_attribute(span: Span, name: &str) -> Diagnostic {
    let (takes, help) = match name {
        "lipschitz" => ("one number", "state the largest slope of the field, for example `@lipschitz(2)`"),
        "bounds" => (
            "the two corners of a box",
            "write for example `@bounds((-1, -1, -1), (1, 1, 1))`; `lo(s)` and `hi(s)` are those of a shape",
        ),
        "requires" => (
            "a condition and a message",
            "write for example `@requires(r > 0, \"the radius must be positive\")`",
        ),
        _ => ("nothing", "remove the parentheses"),
    };
    Diagnostic::new(Code::E032, span, format!("`@{name}` takes {takes}")).help(help)
}

/// `@exact` and `@bound` are two answers to one question.
pub(crate) fn attribute_twice(span: Span, name: &str, first: Span) -> Diagnostic {
    let message = match name {
        "exact" | "bound" => "`@exact` and `@bound` are stated once, and one of them".to_string(),
        _ => format!("`@{name}` is stated twice"),
    };
    Diagnostic::new(Code::E061, span, message)
        .label("here again")
        .related(first, "first stated here")
        .help("keep one of them")
}
