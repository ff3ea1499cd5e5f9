//! Names that every target accepts: ASCII, no reserved word of any language, each given once per scope.

use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::LazyLock;

/// The longest name that is taken over from the source.
const LONGEST: usize = 48;

/// The keywords, predeclared types and built-in functions of the three languages, and what the wrappers define.
const RESERVED: [&str; 4] = [
    include_str!("reserved/wgsl.txt"),
    include_str!("reserved/glsl.txt"),
    include_str!("reserved/hlsl.txt"),
    include_str!("reserved/wrapper.txt"),
];

/// All reserved words in lower case, since HLSL knows some in any case.
static RESERVED_WORDS: LazyLock<FxHashSet<String>> = LazyLock::new(|| {
    RESERVED.iter().flat_map(|list| list.split_whitespace()).map(str::to_lowercase).collect()
});

/// Whether some target gives the word a meaning of its own.
pub(crate) fn is_reserved(word: &str) -> bool {
    RESERVED_WORDS.contains(&word.to_lowercase())
}

/// The names given so far, in a scope and in the one round it.
#[derive(Debug, Default)]
pub(crate) struct Names<'a> {
    outer: Option<&'a Names<'a>>,
    taken: FxHashSet<String>,
    /// The first number that may be free behind each name that was wanted.
    next: FxHashMap<String, usize>,
}

impl Names<'_> {
    /// A scope inside this one, in which nothing has been given yet.
    pub fn inside(&self) -> Names<'_> {
        Names { outer: Some(self), ..Names::default() }
    }

    fn is_taken(&self, name: &str) -> bool {
        self.taken.contains(name) || self.outer.is_some_and(|outer| outer.is_taken(name))
    }

    fn next_number(&self, base: &str) -> usize {
        let outer = || self.outer.map_or(0, |outer| outer.next_number(base));
        self.next.get(base).copied().unwrap_or_else(outer)
    }

    /// A name like `wanted`, or like `fallback` where nothing of it is left, that is free; from now on it is taken.
    pub fn give(&mut self, wanted: &str, fallback: &str) -> String {
        let base = Some(clean(wanted)).filter(|name| !name.is_empty()).unwrap_or_else(|| fallback.to_owned());
        let mut number = self.next_number(&base);
        let name = loop {
            let name = if number == 0 { base.clone() } else { format!("{base}_{number}") };
            number += 1;
            if !is_reserved(&name) && !self.is_taken(&name) {
                break name;
            }
        };
        self.taken.insert(name.clone());
        self.next.insert(base, number);
        name
    }
}

/// What of a name is safe: ASCII letters, digits and single underscores, a letter first. It may be empty.
fn clean(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        let c = if c.is_ascii_alphanumeric() { c } else { '_' };
        if c == '_' && (out.is_empty() || out.ends_with('_')) {
            continue;
        }
        if c.is_ascii_digit() && out.is_empty() {
            out.push('n');
        }
        out.push(c);
    }
    out.truncate(LONGEST);
    let out = out.trim_end_matches('_');
    let lower = out.to_lowercase();
    match ["gl_", "webgl_"].into_iter().find(|prefix| lower.starts_with(prefix)) {
        Some(prefix) => clean(&out[prefix.len()..]),
        None => out.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Names, RESERVED, clean, is_reserved};

    #[test]
    fn cleaning() {
        let cases = [
            ("pillar", "pillar"),
            ("__a__b__", "a_b"),
            ("gl_FragCoord", "FragCoord"),
            ("webgl_gl_x", "x"),
            ("größe", "gr_e"),
            ("2d", "n2d"),
            ("日本", ""),
            ("_", ""),
            ("a*/ b", "a_b"),
        ];
        for (name, safe) in cases {
            assert_eq!(clean(name), safe, "{name}");
        }
    }

    #[test]
    fn no_reserved_word_is_given() {
        for word in RESERVED.iter().flat_map(|list| list.split_whitespace()) {
            let name = Names::default().give(word, "value");
            assert!(
                !is_reserved(&name) && !name.contains("__") && !name.starts_with("gl_"),
                "{word} became {name}"
            );
        }
    }

    #[test]
    fn the_lists_hold_what_naga_reserves() {
        for word in naga::keywords::wgsl::RESERVED.iter().chain(naga::keywords::wgsl::BUILTIN_IDENTIFIERS) {
            assert!(is_reserved(word), "{word} is missing in reserved/wgsl.txt");
        }
        for word in [
            "highp",
            "roundEven",
            "texture2D",
            "saturate",
            "frac",
            "float3x3",
            "Technique",
            "bitcast",
            "ZERO",
        ] {
            assert!(is_reserved(word), "{word} is missing");
        }
    }

    #[test]
    fn names_are_unique() {
        let mut names = Names::default();
        let given: Vec<String> =
            ["a", "a", "a_1", "", "ü", "float"].iter().map(|n| names.give(n, "v")).collect();
        assert_eq!(given, ["a", "a_1", "a_1_1", "v", "v_1", "float_1"]);
        let mut inside = names.inside();
        assert_eq!(["a", "b", "b"].map(|n| inside.give(n, "v")), ["a_2", "b", "b_1"]);
        assert_eq!(names.inside().give("b", "v"), "b");
    }
}
