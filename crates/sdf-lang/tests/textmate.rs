//! The grammar for editors, `grammar/sdf.tmLanguage.json`, against the real lexer and parser: what is a keyword,
//! number, colour, string, comment, attribute or type has that class, and nothing else has it. Its lists of words
//! come from the compiler: `UPDATE_FIXTURES=1 cargo test` writes them anew.

use regex::Regex;
use sdf_lang::vocabulary;
use sdf_syntax::outline::ITEM_WORDS;
use sdf_syntax::token::{Token, lex};
use sdf_syntax::tree::{
    AttributeArgument, Block, Expr, ExprKind, ItemKind, Parameter, PostfixKind, TypeKind,
};
use sdf_syntax::{FileId, parse};
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

// ---- The lists of words

const NAME: &str = "[A-Za-z_][A-Za-z0-9_]*";

/// The rules that have lists of words in them, as the compiler has them.
fn rules_with_words() -> Vec<(&'static str, String)> {
    let words = vocabulary();
    let functions: BTreeSet<&str> = words.library.iter().chain(&words.built_in).copied().collect();
    let functions = functions.into_iter().collect::<Vec<_>>().join("|");
    let plain_blocks: Vec<&str> = ITEM_WORDS.into_iter().filter(|word| *word != "light").collect();
    let types =
        TypeKind::ALL.map(TypeKind::word).into_iter().filter(|word| *word != "fn").collect::<Vec<_>>();
    let items = ITEM_WORDS.join("|");
    vec![
        ("settings_after_condition", format!(r"\b(if|in)([ \t]+)({items})([ \t]*)(\{{)")),
        (
            "typed_parameter",
            format!(
                r"({NAME})([ \t]*(?:\.\.\.)?[ \t]*)(:)([ \t]*)(?:(fn)|({}))([ \t]*)([,)=|]|$)",
                types.join("|")
            ),
        ),
        ("block", format!(r"\b({})([ \t]*)(\{{)", plain_blocks.join("|"))),
        ("call", format!(r"\b(?:({functions})|({NAME}))([ \t]*)(\()")),
        ("method", format!(r"(\.)([ \t]*)(?:({functions})|({NAME}))([ \t]*)(\()")),
        ("constant", format!(r"\b(?:{})\b", words.constants.join("|"))),
    ]
}

#[test]
fn the_words_are_those_of_the_compiler() {
    let path = root().join("grammar/sdf.tmLanguage.json");
    let found = std::fs::read_to_string(&path).unwrap();
    let grammar: Value = serde_json::from_str(&found).unwrap();
    let mut expected = found.clone();
    for (rule, pattern) in rules_with_words() {
        let old = serde_json::to_string(&grammar["repository"][rule]["match"]).unwrap();
        let start = expected.find(&format!("\"{rule}\": {{")).unwrap_or_else(|| panic!("no rule `{rule}`"));
        let place = start + expected[start..].find(&old).unwrap();
        expected.replace_range(place..place + old.len(), &serde_json::to_string(&pattern).unwrap());
    }
    if std::env::var_os("UPDATE_FIXTURES").is_some() {
        std::fs::write(&path, &expected).unwrap();
    } else {
        assert_eq!(found, expected, "run `UPDATE_FIXTURES=1 cargo test -p sdf-lang --test textmate`");
    }
}

// ---- A reader of such grammars, as far as this one needs it

/// A rule: one match with classes for its groups (0 is the whole), or what stands between two marks.
enum Rule {
    Match { pattern: Regex, classes: HashMap<usize, String> },
    Nested { begin: Regex, end: Regex, class: String },
}

struct Grammar {
    rules: Vec<Rule>,
}

impl Grammar {
    fn read() -> Grammar {
        let text = std::fs::read_to_string(root().join("grammar/sdf.tmLanguage.json")).unwrap();
        let grammar: Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&grammar["scopeName"], &grammar["fileTypes"][0]), (&"source.sdf".into(), &"sdf".into()));
        let names: Vec<&str> = grammar["patterns"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| &p["include"].as_str().unwrap()[1..])
            .collect();
        let all: Vec<&str> = grammar["repository"].as_object().unwrap().keys().map(String::as_str).collect();
        let unused: Vec<_> = all.iter().filter(|name| !names.contains(name)).collect();
        assert!(unused.is_empty(), "rules that nothing includes: {unused:?}");
        let rules = names.iter().map(|name| Grammar::rule(name, &grammar["repository"][name])).collect();
        Grammar { rules }
    }

    fn rule(name: &str, rule: &Value) -> Rule {
        let regex =
            |key: &str| Regex::new(rule[key].as_str().unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let class = rule["name"].as_str().map(str::to_string);
        if rule["begin"].is_string() {
            assert_eq!(
                rule["patterns"][0]["include"],
                format!("#{name}"),
                "only what nests in itself is read here"
            );
            return Rule::Nested { begin: regex("begin"), end: regex("end"), class: class.unwrap() };
        }
        let captures = rule["captures"].as_object().into_iter().flatten();
        let groups =
            captures.map(|(group, c)| (group.parse().unwrap(), c["name"].as_str().unwrap().to_string()));
        Rule::Match {
            pattern: regex("match"),
            classes: class.map(|c| (0, c)).into_iter().chain(groups).collect(),
        }
    }

    /// The class of each byte of a text. As in editors, lines are read one by one; at each place the rule whose
    /// match begins first wins, the first of the list where several do.
    fn classes<'g>(&'g self, text: &str) -> Vec<&'g str> {
        let mut out = vec![""; text.len()];
        let mut nested: Option<(&Rule, usize)> = None;
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let content = line.trim_end_matches(['\n', '\r']);
            let mut at = 0;
            while at <= content.len() {
                let range = match nested {
                    Some((rule @ Rule::Nested { begin, end, class }, depth)) => {
                        let opens = begin.find_at(content, at).map(|m| m.range());
                        let closes = end.find_at(content, at).map(|m| m.range());
                        let (range, depth) = match (opens, closes) {
                            (Some(o), Some(c)) if o.start < c.start => (at..o.end, depth + 1),
                            (_, Some(c)) => (at..c.end, depth - 1),
                            (Some(o), None) => (at..o.end, depth + 1),
                            (None, None) => (at..content.len() + 1, depth),
                        };
                        nested = (depth > 0).then_some((rule, depth));
                        out[start + at..start + range.end.min(content.len())].fill(class);
                        range
                    }
                    _ => {
                        let Some((rule, range)) = self.next(content, at) else { break };
                        match rule {
                            Rule::Nested { class, .. } => {
                                out[start + range.start..start + range.end].fill(class);
                                nested = Some((rule, 1));
                            }
                            Rule::Match { pattern, classes } => {
                                let found = pattern.captures_at(content, range.start).unwrap();
                                let mut groups: Vec<_> = classes.iter().collect();
                                groups.sort();
                                for (group, class) in groups {
                                    if let Some(m) = found.get(*group) {
                                        out[start + m.start()..start + m.end()].fill(class);
                                    }
                                }
                            }
                        }
                        range
                    }
                };
                assert!(range.end > at, "a match of nothing in {content:?}");
                at = range.end;
            }
            start += line.len();
        }
        out
    }

    fn next(&self, line: &str, at: usize) -> Option<(&Rule, std::ops::Range<usize>)> {
        let found = self.rules.iter().filter_map(|rule| {
            let pattern = match rule {
                Rule::Match { pattern, .. } => pattern,
                Rule::Nested { begin, .. } => begin,
            };
            pattern.find_at(line, at).map(|m| (rule, m.range()))
        });
        found.min_by_key(|(_, range)| range.start)
    }
}

// ---- What the compiler says

/// The places that only a parser can tell: words that begin items or materials, and types.
#[derive(Default)]
struct Places {
    items: BTreeSet<u32>,
    types: BTreeSet<u32>,
}

impl Places {
    fn of(text: &str) -> Places {
        let (file, diagnostics) = parse(FileId::default(), text);
        assert_eq!(diagnostics, []);
        let mut places = Places::default();
        for item in &file.items {
            for argument in item.attributes.iter().flat_map(|attribute| &attribute.arguments) {
                if let AttributeArgument::Expr(expr) = argument {
                    places.expr(expr);
                }
            }
            match &item.kind {
                ItemKind::Import { .. } => {}
                ItemKind::Param { default, range, .. } => {
                    places.expr(default);
                    range.iter().for_each(|(low, high)| [low, high].into_iter().for_each(|e| places.expr(e)));
                }
                ItemKind::Let(binding) => places.expr(&binding.value),
                ItemKind::Fn(function) => {
                    places.parameters(&function.parameters);
                    places.expr(&function.body);
                }
                ItemKind::Scene(scene) => {
                    places.items.insert(item.span.start);
                    scene.bindings.iter().for_each(|b| places.expr(&b.value));
                    scene.shapes.iter().for_each(|e| places.expr(e));
                }
                ItemKind::Material(_, record)
                | ItemKind::Light(_, record)
                | ItemKind::Settings(_, record) => {
                    places.items.insert(item.span.start);
                    record.fields.iter().for_each(|f| places.expr(&f.value));
                }
            }
        }
        places
    }

    fn parameters(&mut self, parameters: &[Parameter]) {
        for parameter in parameters {
            self.types.extend(parameter.ty.map(|ty| ty.span.start));
            parameter.default.iter().for_each(|e| self.expr(e));
        }
    }

    fn block(&mut self, block: &Block) {
        block.bindings.iter().for_each(|b| self.expr(&b.value));
        self.expr(&block.result);
    }

    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Material(record) => {
                self.items.insert(expr.span.start);
                record.fields.iter().for_each(|f| self.expr(&f.value));
            }
            ExprKind::Record(record) => record.fields.iter().for_each(|f| self.expr(&f.value)),
            ExprKind::Tuple(items) | ExprKind::List(items) => items.iter().for_each(|e| self.expr(e)),
            ExprKind::Block(block) | ExprKind::Shape(_, block) => self.block(block),
            ExprKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.block(then);
                self.block(otherwise);
            }
            ExprKind::For { list, body, .. } => {
                self.expr(list);
                self.block(body);
            }
            ExprKind::Lambda(lambda) => {
                self.parameters(&lambda.parameters);
                self.expr(&lambda.body);
            }
            ExprKind::Unary(_, operand) => self.expr(operand),
            ExprKind::Chain { first, rest } => {
                self.expr(first);
                rest.iter().for_each(|(_, _, e)| self.expr(e));
            }
            ExprKind::Postfix { base, operations } => {
                self.expr(base);
                for operation in operations {
                    match &operation.kind {
                        PostfixKind::Call(arguments) | PostfixKind::Method(_, arguments) => {
                            arguments.iter().for_each(|a| self.expr(&a.value));
                        }
                        PostfixKind::Index(index) => self.expr(index),
                        PostfixKind::Member(_) => {}
                    }
                }
            }
            ExprKind::Number(_)
            | ExprKind::Color(_)
            | ExprKind::Bool(_)
            | ExprKind::Name(_)
            | ExprKind::Error => {}
        }
    }
}

/// The class that a token must have; for names that are nothing in particular, all that they may have.
fn expected(token: Token, previous: Option<Token>, start: u32, places: &Places) -> Vec<&'static str> {
    if places.types.contains(&start) {
        return vec![if token == Token::Fn { "storage.type.fn.sdf" } else { "support.type.sdf" }];
    }
    if places.items.contains(&start) {
        return vec!["keyword.other.item.sdf"];
    }
    match token {
        Token::Import => vec!["keyword.control.import.sdf"],
        Token::Param | Token::Let | Token::Fn => vec!["storage.type.sdf"],
        Token::If | Token::Else | Token::For | Token::In => vec!["keyword.control.sdf"],
        Token::True | Token::False => vec!["constant.language.sdf"],
        Token::Field | Token::Field2 => vec!["storage.type.shape.sdf"],
        Token::Number(_) => vec!["constant.numeric.sdf"],
        Token::Color(_) => vec!["constant.other.color.sdf"],
        Token::Text(_) => vec!["string.quoted.double.sdf"],
        Token::At => vec!["entity.other.attribute-name.sdf"],
        Token::Name(_) if previous == Some(Token::At) => vec!["entity.other.attribute-name.sdf"],
        Token::Name(_) => vec![
            "variable.other.sdf",
            "variable.other.member.sdf",
            "variable.parameter.sdf",
            "entity.name.function.sdf",
            "entity.name.function.call.sdf",
            "entity.name.type.sdf",
            "support.function.sdf",
            "support.constant.sdf",
        ],
        _ => vec!["keyword.operator.sdf", "punctuation.sdf", "punctuation.section.sdf", ""],
    }
}

/// Where the grammar and the compiler differ on a text.
fn differences(grammar: &Grammar, text: &str) -> Vec<String> {
    let classes = grammar.classes(text);
    let places = Places::of(text);
    let tokens = lex(FileId::default(), text).tokens;
    let words = vocabulary();
    let mut out = Vec::new();
    let mut end = 0;
    for (i, (token, span)) in tokens.iter().enumerate() {
        out.extend(between(text, &classes, end, span.start as usize));
        end = span.end as usize;
        let range = span.start as usize..end;
        let written = &text[range.clone()];
        let previous = i.checked_sub(1).map(|p| tokens[p].0);
        let allowed = expected(*token, previous, span.start, &places);
        let found = &classes[range];
        // Of `material: material` only a parser knows whether the second is a type or a value.
        let is_either = found[0] == "support.type.sdf"
            && i >= 2
            && previous == Some(Token::Colon)
            && tokens[i - 2].0 == *token;
        if is_either {
            continue;
        }
        if found.iter().any(|c| *c != found[0]) || !allowed.contains(&found[0]) {
            out.push(format!("`{written}` at {} is {found:?}, not {allowed:?}", span.start));
        }
        // A word has a class of the library's only where the library has it, and always where it is called.
        let is_function = words.built_in.contains(&written) || words.library.contains(&written);
        let is_called = tokens.get(i + 1).is_some_and(|(next, _)| *next == Token::OpenParen);
        let is_defined = previous == Some(Token::Fn);
        if let Token::Name(_) = token {
            let is_support = found[0] == "support.function.sdf";
            if is_support != (is_function && is_called && !is_defined) {
                out.push(format!("`{written}` at {} is {}", span.start, found[0]));
            }
            if found[0] == "support.constant.sdf" && !words.constants.contains(&written) {
                out.push(format!("`{written}` at {} is no constant", span.start));
            }
        }
    }
    out.extend(between(text, &classes, end, text.len()));
    out
}

/// Between two tokens there are spaces and comments.
fn between(text: &str, classes: &[&str], start: usize, end: usize) -> Vec<String> {
    let bytes = text.as_bytes()[start..end].iter().zip(&classes[start..end]);
    let wrong = bytes.enumerate().filter(|(_, (byte, class))| {
        let is_space = byte.is_ascii_whitespace() || matches!(byte, 0xef | 0xbb | 0xbf);
        !(class.starts_with("comment.") || is_space && class.is_empty())
    });
    let places: Vec<usize> = wrong.map(|(i, _)| start + i).collect();
    match places.first() {
        Some(first) => vec![format!("at {first} there is no comment but {:?}", &text[*first..end])],
        None => Vec::new(),
    }
}

#[test]
fn the_grammar_says_what_the_compiler_says() {
    let grammar = Grammar::read();
    let folders = [
        "examples",
        "crates/sdf-lang/std",
        "crates/sdf-lang/runtime",
        "crates/sdf-syntax/tests/fixtures/trees",
        "crates/sdf-lang/tests/fixtures/warnings",
    ];
    let mut wrong = Vec::new();
    let mut count = 0;
    for folder in folders {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|e| e != "sdf") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let source = text.split("// expect\n").next().unwrap();
            count += 1;
            wrong.extend(
                differences(&grammar, source).into_iter().map(|d| format!("{}: {d}", path.display())),
            );
        }
    }
    assert!(count > 20, "only {count} files");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_is_easily_taken_for_something_else() {
    let grammar = Grammar::read();
    for text in [
        "let a = 0..8 let b = [1.5, .5, 1e-3, 1_000, 45deg, 0.25turn, 2rad, 3E+2][1]",
        "let a = 1.max(2) let b2 = a.x let c_3 = b2.max(1).min(2)",
        "let a = #fff let b = #0A1b2C",
        "let rim = 1 let scene_1 = rim let light = |camera| camera let letter = 1 let fog = 2",
        "let a = if rim { 1 } else { 2 } let b = for i in scene { i } let rim = true let scene = [1]",
        "fn f(s: shape, t...: shape2, u: fn, v: vec3 = 1, w: material, x: list) = |a: float, b: fn| a",
        "let m = material { color: material } let n = (color: material { color: 1 }, shape: 2) let material = 1",
        "/* a /* nested */ \"b\" */ let a = 1 // let 1 \"c\" #fff\n/// let a\n//// not a doc\nlet b = 2 /**/",
        "/* over\nlines /* and\n*/ more\n*/ let a = 1 /* b */ let c = 2",
        "@exact @lipschitz(2) @ requires(1 > 0, \"a // b /* c\")\nfn f(a) = 1 // d",
        "import \"a.sdf\" import \"let.sdf\"; scene { sphere(1) } camera { fov: 1 }light l { direction: 1 }",
        "let inside = 1 let informal = inside let field3 = field2 { 1 } let fieldx = field { 1 }",
        "let a = x.rotate let b = |v| v.round(1) let c = at let d = |at| at",
    ] {
        assert_eq!(differences(&grammar, text), [""; 0], "in {text}");
    }
}
