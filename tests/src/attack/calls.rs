//! Calls of a function like one that is given: with other numbers in the places of its literals.

use super::forms::Form;
use super::points::{Random, seed};
use super::subject::{Kind, Refusal, Subject, kind_of};
use std::ops::Range;

/// How many calls of each example are tried, itself included.
const WANTED: usize = 6;
/// With fewer than these a form counts as not tried.
const ENOUGH: usize = 5;
/// How many of them are degenerate at most: with a zero, or with two numbers that are equal.
const DEGENERATE: usize = 2;
/// How many random calls are looked at, to keep as many as are wanted.
const TRIES: usize = 80;

/// A number that stands in a call.
#[derive(Debug, Clone, PartialEq)]
struct Literal {
    place: Range<usize>,
    value: f64,
    /// A count, which has no fraction.
    is_whole: bool,
}

/// The literals of an expression. What is a colour, or the end of a name, is none.
fn literals(text: &str) -> Vec<Literal> {
    let bytes = text.as_bytes();
    let is = |i: usize, what: fn(&u8) -> bool| bytes.get(i).is_some_and(what);
    let skip = |mut i: usize, what: fn(&u8) -> bool| {
        while is(i, what) {
            i += 1;
        }
        i
    };
    let is_word: fn(&u8) -> bool = |b| b.is_ascii_alphanumeric() || *b == b'_';
    let mut found = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        let start = i;
        if bytes[i] == b'#' || bytes[i].is_ascii_alphabetic() || bytes[i] == b'_' {
            i = skip(i + 1, is_word);
        } else if bytes[i].is_ascii_digit()
            || bytes[i] == b'.' && is(i + 1, u8::is_ascii_digit) && (i == 0 || bytes[i - 1] != b'.')
        {
            i = skip(i, u8::is_ascii_digit);
            if is(i, |b| *b == b'.') && is(i + 1, u8::is_ascii_digit) {
                i = skip(i + 1, u8::is_ascii_digit);
            }
            if is(i, |b| *b == b'e') {
                i = skip(i + 1, |b| b.is_ascii_digit() || *b == b'-');
            }
            let value: f64 = text[start..i].parse().expect("digits");
            let has_unit = is(i, u8::is_ascii_alphabetic);
            let is_whole = !has_unit && text[start..i].bytes().all(|b| b.is_ascii_digit());
            found.push(Literal { place: start..i, value, is_whole });
        } else {
            i += 1;
        }
    }
    found
}

/// The text with other numbers in place of some literals.
fn replaced(text: &str, literals: &[Literal], values: &[Option<f64>]) -> String {
    let mut text = text.to_string();
    for (literal, value) in literals.iter().zip(values).rev() {
        if let Some(value) = value {
            let size = format!("{}", value.abs());
            let number = if *value < 0.0 { format!("(-{size})") } else { size };
            text.replace_range(literal.place.clone(), &number);
        }
    }
    text
}

/// A number with no more digits than one writes.
fn written(x: f64) -> f64 {
    let scale = 10f64.powi(4 - x.abs().max(1e-9).log10().ceil() as i32);
    (x * scale).round() / scale
}

/// Another number for a literal, or the same.
fn another(literal: &Literal, all: &[Literal], random: &mut Random) -> Option<f64> {
    let chance = random.unit();
    if literal.is_whole {
        let n = literal.value;
        let choices = [n, n, n - 1.0, n + 1.0, n + 2.0, 2.0, 1.0, (2.0 * n).min(12.0)];
        return Some(choices[random.below(choices.len())].max(0.0));
    }
    match chance {
        x if x < 0.15 => None,
        x if x < 0.20 => Some(0.0),
        x if x < 0.25 => Some(all[random.below(all.len())].value),
        x if x < 0.35 => Some(written(-literal.value * 3f64.powf(random.within(-1.0, 1.0)))),
        _ => Some(written(literal.value * 3f64.powf(random.within(-1.0, 1.0)))),
    }
}

/// The text with a zero in one place, or with the number of one place in another.
fn degenerate(text: &str, literals: &[Literal]) -> Vec<String> {
    let mut out = Vec::new();
    for (i, literal) in literals.iter().enumerate() {
        let others = literals.iter().map(|other| other.value).filter(|x| *x != literal.value);
        for value in [0.0].into_iter().chain(others) {
            if literal.is_whole && value.fract() != 0.0 {
                continue;
            }
            let mut values = vec![None; literals.len()];
            values[i] = Some(value);
            out.push(replaced(text, literals, &values));
        }
    }
    out
}

/// Valid calls.
#[derive(Debug)]
pub struct Calls {
    /// What they give.
    pub kind: Kind,
    /// The calls, compiled; the first is the example.
    pub subjects: Vec<Subject>,
    /// How many more were refused by what a function requires.
    pub refused: usize,
    /// What is wrong: calls that are neither valid nor refused as they should be, or too few of them.
    pub complaints: Vec<String>,
}

/// Valid calls like an example of a form.
pub fn calls_of(form: &Form, example: &str) -> Result<Calls, String> {
    let kind = kind_of(example)?;
    let first = Subject::new(example, kind).map_err(|refusal| format!("{example}: {refusal:?}"))?;
    let mut calls = Calls { kind, subjects: vec![first], refused: 0, complaints: Vec::new() };
    let literals = literals(example);
    if literals.is_empty() {
        return Ok(calls);
    }
    let mut random = Random::new(seed(example));
    let try_one = |calls: &mut Calls, call: String| {
        if calls.subjects.iter().any(|s| s.call == call) {
            return false;
        }
        match Subject::new(&call, kind) {
            Ok(subject) => {
                calls.subjects.push(subject);
                return true;
            }
            Err(Refusal::Required(_) | Refusal::TooLarge) => calls.refused += 1,
            Err(Refusal::Steep) => calls.complaints.push(format!("{call}: no slope is known")),
            Err(Refusal::Mistake(said)) => calls.complaints.push(format!("{call}: {said}")),
        }
        false
    };
    let mut candidates = degenerate(example, &literals);
    let mut found = 0;
    for _ in 0..12 {
        if candidates.is_empty() || found == DEGENERATE {
            break;
        }
        let call = candidates.swap_remove(random.below(candidates.len()));
        found += usize::from(try_one(&mut calls, call));
    }
    for _ in 0..TRIES {
        if calls.subjects.len() >= WANTED {
            break;
        }
        let values: Vec<Option<f64>> = literals.iter().map(|l| another(l, &literals, &mut random)).collect();
        try_one(&mut calls, replaced(example, &literals, &values));
    }
    if calls.subjects.len() < ENOUGH {
        let (kept, refused) = (calls.subjects.len(), calls.refused);
        calls.complaints.push(format!("{}: {kept} calls were kept and {refused} refused", form.name));
    }
    Ok(calls)
}

/// The text without one of the elements of a list or one of the arguments of a call, in all ways.
fn shortened(text: &str) -> Vec<String> {
    let (mut open, mut commas) = (Vec::new(), Vec::new());
    let mut elements: Vec<Range<usize>> = Vec::new();
    for (i, b) in text.bytes().enumerate() {
        match b {
            b'(' | b'[' => {
                open.push(i);
                commas.push(vec![i]);
            }
            b',' => {
                if let Some(commas) = commas.last_mut() {
                    commas.push(i);
                }
            }
            b')' | b']' => {
                open.pop();
                if let Some(mut ends) = commas.pop() {
                    ends.push(i);
                    let first = ends[0];
                    elements.extend(ends.windows(2).map(|pair| match pair {
                        // A first element goes with the comma behind it, others with the one before.
                        [a, b] if *a == first && text.as_bytes()[*b] == b',' => a + 1..b + 1,
                        [a, b] if *a == first => a + 1..*b,
                        [a, b] => *a..*b,
                        _ => unreachable!("windows of two"),
                    }));
                }
            }
            _ => {}
        }
    }
    let without = |range: Range<usize>| format!("{}{}", &text[..range.start], &text[range.end..]);
    elements.into_iter().filter(|range| !range.is_empty()).map(without).collect()
}

/// Where the lists of arguments and the vectors of a text are, without their brackets, those inside others first.
fn groups(text: &str) -> Vec<Range<usize>> {
    let mut open = Vec::new();
    let mut groups = Vec::new();
    for (i, b) in text.bytes().enumerate() {
        match b {
            b'(' => open.push(i + 1),
            b')' => groups.extend(open.pop().map(|start| start..i)),
            _ => {}
        }
    }
    groups
}

/// What stands for a parameter that an example leaves out, so that it may be refused.
const WORTHLESS: [&str; 7] = ["-1.5", "0", "(0, 0, 0)", "(0, 0)", "(-1.5, 0.5, 0)", "(0.5, 0)", "|x| 2 * x"];

/// Shapes without an end along all axes, or along one.
const ENDLESS: [&str; 5] = [
    "plane((0.3, 1.1, 0.2))",
    "half_plane((0.3, 1.1))",
    "rect((0.2, 1e19))",
    "infinite_cylinder(0.3)",
    "rect((0.2, 0.3)).extrude(1e19)",
];

/// Calls of a function that may well not be valid, those with one change first.
pub fn doubtful(form: &Form, example: &str) -> Vec<String> {
    let literals = literals(example);
    let mut calls = Vec::new();
    for (i, literal) in literals.iter().enumerate() {
        let x = literal.value;
        let whole = [0.0, -1.0, 1.0, 2.0, 1000.0, 0.5];
        let real = [-x, 0.0, x * 1000.0, -1e6, x * 1e-3, 3.3 * x, 0.3 * x];
        let choices: &[f64] = if literal.is_whole { &whole } else { &real };
        for choice in choices {
            let mut values = vec![None; literals.len()];
            values[i] = Some(written(*choice));
            calls.push(replaced(example, &literals, &values));
        }
    }
    // A vector of zeros, or the same as another.
    let groups = groups(example);
    let is_vector = |group: &&Range<usize>| {
        let text = &example[(*group).clone()];
        text.contains(',') && !text.contains(|c: char| c.is_ascii_alphabetic())
    };
    let vectors: Vec<&Range<usize>> = groups.iter().filter(is_vector).collect();
    let with = |group: &Range<usize>, new: &str| {
        format!("{}{new}{}", &example[..group.start], &example[group.end..])
    };
    for vector in &vectors {
        let zeros: Vec<&str> = example[(*vector).clone()].split(',').map(|_| "0").collect();
        calls.push(with(vector, &zeros.join(", ")));
        calls.extend(vectors.iter().map(|other| with(vector, &example[(*other).clone()])));
    }
    // A shape without an end in the place of a call, and a function that jumps in the place of another.
    for group in &groups {
        let name = example[..group.start - 1]
            .rfind(|c: char| !(c.is_alphanumeric() || c == '_'))
            .map_or(0, |i| i + 1);
        if name < group.start - 1 {
            let whole = name..group.end + 1;
            calls.extend(ENDLESS.iter().map(|shape| with(&whole, shape)));
        }
    }
    if let Some(bar) = example.rfind('|') {
        let end = groups.iter().map(|g| g.end).filter(|end| *end > bar).max().unwrap_or(example.len());
        calls.extend(["floor(3 * v.x)", "x * x"].map(|body| with(&(bar + 1..end), body)));
        let comma = example[bar..].rfind(',').map_or(end, |i| bar + i);
        calls.push(with(&(bar + 1..comma), " floor(3 * v.x)"));
    }
    // A parameter that is left out.
    if let Some(end) = example.rfind(')') {
        for parameter in &form.parameters {
            calls.extend(WORTHLESS.map(|value| with(&(end..end), &format!(", {parameter}: {value}"))));
        }
        let more = &|extra: &str| with(&(end..end), extra);
        for shape in ENDLESS {
            let changed: Vec<String> = groups
                .iter()
                .filter_map(|group| {
                    let name = example[..group.start - 1]
                        .rfind(|c: char| !(c.is_alphanumeric() || c == '_'))
                        .map_or(0, |i| i + 1);
                    (name < group.start - 1 && group.end < end).then(|| name..group.end + 1)
                })
                .flat_map(|whole| {
                    let parameters = form.parameters.iter();
                    parameters.map(move |p| {
                        let extra = more(&format!(", {p}: 1.5"));
                        format!("{}{shape}{}", &extra[..whole.start], &extra[whole.end..])
                    })
                })
                .collect();
            calls.extend(changed);
        }
    }
    let short = shortened(example);
    calls.extend(short.iter().flat_map(|text| shortened(text)).take(200));
    calls.extend(short);
    let mut random = Random::new(seed(example) ^ 0x5eed);
    calls.extend((0..100).map(|_| {
        let change = |literal: &Literal| match random.below(8) {
            0 | 1 => Some(0.0),
            2 => Some(-literal.value),
            3 => Some(literal.value * 100.0),
            4 => Some(written(literal.value * 0.01)),
            _ => None,
        };
        let values: Vec<Option<f64>> = literals.iter().map(change).collect();
        replaced(example, &literals, &values)
    }));
    calls
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_numbers_and_nothing_else() {
        let text = "cross2(0.52, 8, p.x2, #334455).rotate(40deg, -.5e-3) + v[0..3]";
        let found: Vec<(f64, bool)> = literals(text).iter().map(|l| (l.value, l.is_whole)).collect();
        let expected = [(0.52, false), (8.0, true), (40.0, false), (0.0005, false), (0.0, true), (3.0, true)];
        assert_eq!(found, expected);
    }

    #[test]
    fn texts_are_shortened_by_one_element() {
        assert_eq!(shortened("f(a, (b, c))"), ["f(a, ( c))", "f(a, (b))", "f( (b, c))", "f(a)"]);
    }
}
