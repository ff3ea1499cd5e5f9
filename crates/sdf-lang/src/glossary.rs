//! What the words of the language are that are not written in it, a sentence each: built-in functions, constants,
//! attributes and blocks of settings. For those who read about them; a test compares the lists with what there is.

use crate::accuracy::{Accuracy, Quality};
use crate::builtin;
use crate::call::{Slot, SlotKind};
use crate::reference::{Entry, Form, Parameter};
use crate::settings::default_of;
use crate::vocabulary::vocabulary;
use sdf_syntax::tree::TypeKind;

/// Words that have something in common.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// What that is, in a few words.
    pub title: &'static str,
    /// The words.
    pub entries: Vec<Entry>,
}

/// The built-in functions, in the order in which one would explain them.
const FUNCTIONS: &[(&str, &[(&str, &str)])] = &[
    (
        "Built-in functions of numbers",
        &[
            ("abs", "The size without the sign."),
            ("sign", "-1, 0 or 1, as the number is below, at or above 0."),
            ("floor", "The next whole number below."),
            ("ceil", "The next whole number above."),
            ("round", "The nearest whole number, of two the even one."),
            ("trunc", "The whole part, without what stands behind the point."),
            ("fract", "What lies above the next whole number below: `x - floor(x)`."),
            ("min", "The smallest of any number of arguments, or of a list; of vectors in each component."),
            ("max", "The largest of any number of arguments, or of a list; of vectors in each component."),
            ("sum", "The sum of any number of arguments, or of a list."),
            ("clamp", "The nearest value from `low` to `high`: `min(max(x, low), high)`."),
            ("mix", "From `a` where `t` is 0 to `b` where it is 1, and on in both directions."),
            ("step", "0 below the edge, and 1 from it on."),
            ("smoothstep", "From 0 at `low` to 1 at `high`, level at both; with equal edges a step."),
            ("sqrt", "The square root; 0 of what is negative."),
            (
                "pow",
                "`x` to the power of `y`; where `x` is negative, of its size, with the sign of an odd whole power.",
            ),
            ("exp", "e to the power of `x`; no more than the largest float."),
            ("exp2", "2 to the power of `x`; no more than the largest float."),
            ("log", "The natural logarithm; of 0 and less that of the smallest normal float."),
            ("log2", "The logarithm to base 2; of 0 and less that of the smallest normal float."),
            ("sin", "The sine of an angle in radians."),
            ("cos", "The cosine of an angle in radians."),
            ("tan", "The tangent of an angle in radians; no larger than the largest float."),
            ("asin", "The angle from -90deg to 90deg with this sine; `x` is clamped to -1..1."),
            ("acos", "The angle from 0 to 180deg with this cosine; `x` is clamped to -1..1."),
            (
                "atan",
                "The angle with this tangent; of two numbers, the angle of the point (x, y), in all four quarters.",
            ),
            ("tanh", "The hyperbolic tangent, from -1 to 1."),
            ("hash", "A number from 0 to below 1 that the bits of the argument decide, as if at random."),
        ],
    ),
    (
        "Built-in functions of vectors",
        &[
            ("length", "The length of a vector."),
            ("distance", "How far two points lie apart."),
            ("dot", "The sum of the products of the components."),
            ("cross", "The vector at right angles to both, right-handed."),
            ("normalize", "The vector of length 1 in the same direction; of the zero vector itself."),
            ("reflect", "The direction `v` thrown back by a plane of unit normal `n`."),
            (
                "refract",
                "The direction `v` behind a surface of unit normal `n`, `eta` being the ratio of the indices; 0 where all is thrown back.",
            ),
            (
                "rotated",
                "The vector `image`, and the promise that it is `v` turned by `angle` about `axis`, for the proofs of slopes.",
            ),
        ],
    ),
    (
        "Lists and loops",
        &[
            ("len", "How many elements a list has."),
            ("map", "The list of what a function gives for each element."),
            ("fold", "What is left of a list when a function has joined `first` with each element in turn."),
            (
                "iterate",
                "The loop that runs in the shader: at most `n` rounds from a state, `next` being given the round and the state, until `until` holds.",
            ),
        ],
    ),
    (
        "What shapes look like, and what is proved of them",
        &[
            ("paint", "The shape in a material, or in a colour; what is painted inside of it keeps its own."),
            (
                "outlined",
                "The shape, as a function of its own in the shader: for what samples it at several points.",
            ),
            (
                "gradient",
                "The distance at a point and its exact gradient, as a record `(distance, gradient)`.",
            ),
            (
                "lo",
                "The corner of a shape's box with the smallest coordinates; with a level, of the box of the points where the field is at most that.",
            ),
            (
                "hi",
                "The corner of a shape's box with the largest coordinates; with a level, of the box of the points where the field is at most that.",
            ),
            ("reach", "How far from an axis through the origin a shape extends."),
            ("slope", "How steep a shape, or a function of a point, is at most."),
            ("most", "The largest that a number may be, whatever the params and the time are."),
            ("turned", "The box of a shape turned by an angle, or by any, as a record `(lo, hi)`."),
            ("reflected", "The box of the mirror image of a shape, as a record `(lo, hi)`."),
            (
                "is_even",
                "Whether a shape is certainly the same on both sides of the plane across a coordinate axis at a place.",
            ),
            (
                "any_cell",
                "A vector that may be any from `first` to `last`, as the cell of a repetition is, to ask about.",
            ),
            ("mirrored", "The box of what `mirror` makes of a shape, as a record `(lo, hi)`."),
        ],
    ),
    (
        "For renderers",
        &[
            (
                "approach",
                "The distance at a point and how far a ray may step from it, as a record `(distance, stride)`.",
            ),
            ("stride", "How far a ray may step from a point: the distance over the slope."),
            (
                "surface",
                "The properties of the material that a surface with the normal `n` has at a point, those of glow apart, as a record.",
            ),
            ("surrounding", "The glow round a shape at a point, as a record `(glow, glow_radius)`."),
            ("seams", "How many of the surfaces that a shape is made of lie within `width` of a point."),
            (
                "patterned",
                "How much of the material at a point is not the same everywhere on its shape, as a record `(pattern)`.",
            ),
            ("properties", "All properties of the material at a point, as a record."),
        ],
    ),
];

const CONSTANTS: &[(&str, &str)] = &[
    ("pi", "Half a turn in radians."),
    ("tau", "A whole turn in radians."),
    ("x", "The unit vector (1, 0, 0)."),
    ("y", "The unit vector (0, 1, 0), which points up."),
    ("z", "The unit vector (0, 0, 1)."),
    ("time", "The seconds since the beginning, as a number that changes from frame to frame."),
    ("mouse", "The place of the mouse, from (0, 0) at the bottom left to (1, 1), at first in the middle."),
];

const ATTRIBUTES: &[(&str, &str)] = &[
    ("exact", "Promises that a field is the distance itself, everywhere outside."),
    ("bound", "Promises that a field is nowhere steeper than the distance, and so never more than it."),
    ("lipschitz", "Promises how steep a field is at most, as in `@lipschitz(2)`."),
    (
        "bounds",
        "Promises a box in which the shape lies, as in `@bounds((-1, -1, -1), (1, 1, 1))`; with `level` in it, a box of the points where the field is at most that.",
    ),
    (
        "convex",
        "Promises that a shape is convex: with any two points it holds what lies between them; an operator makes such a shape of such shapes.",
    ),
    ("requires", "Demands something of arguments, as in `@requires(r > 0, \"r must be above 0\")`."),
];

const RESERVED: &[(&str, &str, &str)] = &[
    ("import", "import \"file.sdf\"", "Brings the functions, values, params and materials of another file."),
    ("param", "param NAME = value in low..high", "A number that changes from outside: a slider, or `--set`."),
    ("let", "let NAME = value", "A name for a value, of the file or, with a `;` after it, of a block."),
    ("fn", "fn NAME(a, b: shape, c = 1) = value", "A function; its body is an expression or a block."),
    ("if", "if condition { a } else { b }", "One of two values."),
    (
        "else",
        "if condition { a } else { b }",
        "The value if the condition does not hold; it is never left out.",
    ),
    ("for", "for i in 0..8 { value }", "A list: a value for each item of another list."),
    ("in", "for i in list { value }", "What a `for` goes through, or the range of a param."),
    ("true", "true", "That something holds."),
    ("false", "false", "That something does not hold."),
    ("field", "field { distance }", "A shape, by the distance from a point `p` of space to it."),
    (
        "field2",
        "field2 { distance }",
        "A shape of the plane, by the distance from a point `p` of the plane to it.",
    ),
    ("scene", "scene { shape, shape }", "What is drawn: the union of its shapes."),
];

const BLOCKS: &[(&str, &str)] = &[
    ("camera", "Where the picture is taken from."),
    ("light", "A light, by its direction or its position; it has a name: `light sun { … }`."),
    ("ambient", "The light from all sides."),
    ("sky", "What is seen where there is nothing."),
    ("fog", "How what is far away fades."),
    ("rim", "Light round the outlines."),
    ("render", "How the picture is made."),
    ("material", "What a surface looks like; it has a name, or is an expression: `material { … }`."),
];

/// What the fields of `render` are.
const RENDER: &[(&str, &str)] = &[
    ("tolerance", "How far from the true surface a hit may be, in pixels."),
    ("steps", "How many steps a ray is given; twice as many where it has to take more care."),
    ("far", "How far from the eye rays go, and farther where the camera frames a larger scene by itself."),
    (
        "normals",
        "From what normals are found: from the gradient itself, `exact`, or from differences of four samples, `tetrahedron`, or of six, `central`.",
    ),
    (
        "relax",
        "Whether steps may be longer than is certain, to be taken back where they were too long: `auto` or `none`.",
    ),
    (
        "shadow_accuracy",
        "How much darker a soft shadow may be between two samples of the way to a light, as a share of the light.",
    ),
    ("occlusion_samples", "How many samples the occlusion of ambient light is summed up from."),
    ("bounces", "How often a ray goes on by what mirrors it or lets it through."),
    (
        "antialias",
        "How many rays a pixel has along each side of a grid, where there is an edge or a pattern in it.",
    ),
    ("tonemap", "How light becomes a colour: clamped, `none`, or by the curve `aces`."),
    (
        "quality",
        "A preset that sets `tolerance`, `steps`, `normals`, `relax`, `shadow_accuracy`, `occlusion_samples` and `antialias`, unless the file sets them itself: `draft`, `balanced`, `fine` or `exact`.",
    ),
];

/// What each preset of `quality` stands for.
fn presets() -> Vec<String> {
    let listed = |quality: Quality| {
        let fields = quality.accuracy().fields_beside(&Accuracy::default());
        let fields: Vec<String> =
            fields.into_iter().map(|(name, value)| format!("{name}: {value}")).collect();
        match &fields[..] {
            [] => format!("`quality: {}` stands for what is so where a file does not say.", quality.word()),
            fields => format!(
                "`quality: {}` stands for `{}`, and else for the same.",
                quality.word(),
                fields.join(", ")
            ),
        }
    };
    Quality::ALL.map(listed).into()
}

/// What a scene's own shading is, and what it may call.
const SHADING: [(&str, &str, &str); 4] = [
    (
        "shade",
        "fn shade(surface) = color",
        "A function of the root file that stands in for the model of surface light. `surface` is a record `(p, n, to_eye, t, color, specular, shininess, emission, reflect, ambient, lights)`; each of `lights`, which are also known by their names, is a record `(direction, distance, color)`.",
    ),
    (
        "shadow",
        "shadow(light)",
        "In `shade`: how much of a light arrives, by its own kind of shadow; 1 where it casts none.",
    ),
    (
        "occlusion",
        "occlusion()",
        "In `shade`: how open the surroundings are, by the `occlusion` of the ambient light; by all of it where the file does not say.",
    ),
    (
        "reflection",
        "reflection()",
        "In `shade`: the light that a mirror would show here; that of the sky after the last bounce.",
    ),
];

/// The words that are built in, with what each of them is.
pub fn glossary() -> Vec<Group> {
    let named = |name: &str, forms: Vec<Form>| Entry { name: name.into(), forms };
    let word = |(name, summary): &(&str, &str), signature: String| {
        let summary = summary.to_string();
        named(name, vec![Form { signature, summary, ..Form::default() }])
    };
    let functions = FUNCTIONS.iter().map(|(title, words)| {
        let forms = |(name, summary): &(&str, &str)| {
            let functions = builtin::all().iter().filter(|function| function.name == *name);
            let form = |signature| Form { signature, summary: summary.to_string(), ..Form::default() };
            let mut signatures: Vec<String> =
                functions.map(|function| signature(name, &function.slots())).collect();
            signatures.dedup();
            named(name, signatures.into_iter().map(form).collect())
        };
        Group { title, entries: words.iter().map(forms).collect() }
    });
    let constants = CONSTANTS.iter().map(|row| word(row, row.0.to_string())).collect();
    let attributes = ATTRIBUTES.iter().map(|row| word(row, format!("@{}", row.0))).collect();
    let fields = vocabulary().blocks;
    let block = |row: &(&str, &str)| {
        let fields = fields.iter().find(|(block, _)| *block == row.0).map_or(&[][..], |(_, fields)| fields);
        let field = |name: &&str| match default_of(row.0, name) {
            Some(default) => format!("{name}: {default}"),
            None => name.to_string(),
        };
        let signature =
            format!("{} {{ {} }}", row.0, fields.iter().map(field).collect::<Vec<_>>().join(", "));
        let mut entry = word(row, signature);
        if row.0 == "render" {
            entry.forms[0].parameters =
                RENDER.iter().map(|(name, meaning)| explained(name, meaning)).collect();
            entry.forms[0].text = presets();
        }
        entry
    };
    let blocks = BLOCKS.iter().map(block).collect();
    let reserved =
        RESERVED.iter().map(|(name, form, summary)| word(&(name, summary), form.to_string())).collect();
    let shading =
        SHADING.iter().map(|(name, form, summary)| word(&(name, summary), form.to_string())).collect();
    functions
        .chain([
            Group { title: "Shading of one's own", entries: shading },
            Group { title: "Words", entries: reserved },
            Group { title: "Constants and inputs", entries: constants },
            Group { title: "Attributes", entries: attributes },
            Group { title: "Blocks of settings", entries: blocks },
        ])
        .collect()
}

/// A field of a block, with what it means.
fn explained(name: &str, meaning: &str) -> Parameter {
    let (name, meaning) = (name.to_string(), Some(meaning.to_string()));
    Parameter { name, ty: None, variadic: false, default: None, meaning }
}

/// How a built-in function is called. A type is written where it is not numbers of any.
fn signature(name: &str, slots: &[Slot]) -> String {
    let slot = |slot: &Slot| {
        let ty = match slot.kind {
            SlotKind::Type(TypeKind::Float) | SlotKind::Numeric | SlotKind::Any | SlotKind::Vector => {
                String::new()
            }
            SlotKind::Type(ty) => format!(": {}", ty.word()),
        };
        let (variadic, optional) =
            (if slot.variadic { "..." } else { "" }, if slot.optional { "?" } else { "" });
        format!("{}{variadic}{optional}{ty}", slot.name)
    };
    format!("{name}({})", slots.iter().map(slot).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Every word has one sentence, and every sentence has a word.
    #[test]
    fn all_words_are_explained_once() {
        let words = vocabulary();
        let of =
            |rows: &[(&'static str, &str)]| -> Vec<&str> { rows.iter().map(|(name, _)| *name).collect() };
        let compare = |rows: Vec<&str>, there: Vec<&str>| {
            let (count, rows): (usize, BTreeSet<&str>) = (rows.len(), rows.into_iter().collect());
            assert_eq!(rows.len(), count, "a word stands twice");
            assert_eq!(rows, there.into_iter().collect::<BTreeSet<&str>>());
        };
        compare(FUNCTIONS.iter().flat_map(|(_, rows)| of(rows)).collect(), words.built_in);
        compare(of(CONSTANTS), words.constants);
        compare(of(ATTRIBUTES), words.attributes);
        let reserved = RESERVED.iter().map(|(name, ..)| *name).collect();
        compare(reserved, sdf_syntax::token::RESERVED.iter().copied().chain(["scene"]).collect());
        let shading = SHADING.iter().map(|(name, ..)| *name).collect();
        compare(shading, crate::shading::CALLS.into_iter().chain([crate::shading::SHADE]).collect());
        let render = words.blocks.iter().find(|(block, _)| *block == "render");
        compare(of(RENDER), render.expect("a block").1.clone());
        compare(of(BLOCKS), words.blocks.iter().map(|(block, _)| *block).collect());
        for entry in glossary().iter().flat_map(|group| &group.entries) {
            assert!(!entry.forms.is_empty(), "{}", entry.name);
            for form in &entry.forms {
                assert!(form.summary.ends_with('.') || form.summary.ends_with("`."), "{}", form.summary);
            }
        }
    }

    #[test]
    fn signatures_tell_types() {
        let signatures = |name: &str| -> Vec<String> {
            let groups = glossary();
            let mut entries = groups.iter().flat_map(|group| &group.entries);
            let entry = entries.find(|entry| entry.name == name).expect("a word");
            entry.forms.iter().map(|form| form.signature.clone()).collect()
        };
        assert_eq!(signatures("mix"), ["mix(a, b, t)"]);
        assert_eq!(signatures("atan"), ["atan(x)", "atan(y, x)"]);
        assert_eq!(signatures("min"), ["min(values...)"]);
        assert_eq!(signatures("iterate"), ["iterate(n, first, next: fn, until?: fn)"]);
        assert_eq!(signatures("lo"), ["lo(s: shape, level?)", "lo(s: shape2, level?)"]);
        assert_eq!(signatures("exact"), ["@exact"]);
        assert!(signatures("sky")[0].starts_with("sky { "));
        // With what settings are where a file does not say.
        let render = &signatures("render")[0];
        for setting in ["tolerance: 0.1,", "steps: 256,", "far: 100,", "relax: auto,", "tonemap: none,"] {
            assert!(render.contains(setting), "{render}");
        }
    }
}
