//! The grammar file is what the parser's functions say about themselves, it is complete, and it is true: a reader
//! of its notation accepts every right text that there is, and uses all of its parts for that.

use sdf_syntax::outline::outline;
use sdf_syntax::token::{Token, lex};
use sdf_syntax::{FileId, parse};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

// ---- The file

/// The productions: doc comments of the form ``/// `name = …` `` in the parser, in its order, without repetition.
fn productions(parser: &str) -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = Vec::new();
    for line in parser.lines() {
        let Some(text) = line.trim().strip_prefix("/// `").and_then(|rest| rest.strip_suffix('`')) else {
            continue;
        };
        let Some((name, body)) = text.split_once(" = ") else { continue };
        if !out.iter().any(|(n, _)| n == name) {
            out.push((name.to_string(), body.to_string()));
        }
    }
    out
}

fn parser_productions() -> Vec<(String, String)> {
    productions(&std::fs::read_to_string(root().join("crates/sdf-syntax/src/parser.rs")).expect("the parser"))
}

#[test]
fn the_grammar_file_is_fresh() {
    let mut expected = String::from(
        "(* The grammar of .sdf files, from the comments above the parser's functions.\n   \
         `x,*` is any number of x between commas, with an optional comma behind the last.\n   \
         How tightly operators bind stands in the language's page. *)\n\nfile = item* ;\n",
    );
    for (name, body) in parser_productions() {
        expected.push_str(&format!("{name} = {body} ;\n"));
    }
    let path = root().join("grammar/sdf.ebnf");
    if std::env::var_os("UPDATE_FIXTURES").is_some() {
        std::fs::write(&path, &expected).expect("grammar/sdf.ebnf can be written");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(found, expected, "run `UPDATE_FIXTURES=1 cargo test -p sdf-syntax --test grammar`");
}

// ---- A reader of its notation

/// A part of the grammar. Each has a number, by which it is known whether a text has used it.
#[derive(Debug)]
struct Part {
    number: usize,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    /// A token with this text.
    Text(String),
    /// A token of a class, or another production.
    Name(String),
    Sequence(Vec<Part>),
    Choice(Vec<Part>),
    Optional(Box<Part>),
    Many(Box<Part>),
    /// Any number, with commas between.
    List(Box<Part>),
}

/// Reads one production.
struct Reader<'a> {
    rest: &'a str,
    /// What each part says, by its number.
    parts: &'a mut Vec<String>,
    production: &'a str,
}

impl Reader<'_> {
    fn part(&mut self, from: &str, kind: Kind) -> Part {
        let text = &from[..from.len() - self.rest.len()];
        self.parts.push(format!("`{}` of `{}`", text.trim(), self.production));
        Part { number: self.parts.len() - 1, kind }
    }

    fn eat(&mut self, symbol: &str) -> bool {
        self.rest = self.rest.trim_start();
        let rest = self.rest.strip_prefix(symbol);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn choice(&mut self) -> Part {
        let from = self.rest.to_string();
        let mut parts = vec![self.sequence()];
        while self.eat("|") {
            parts.push(self.sequence());
        }
        if parts.len() == 1 { parts.remove(0) } else { self.part(&from, Kind::Choice(parts)) }
    }

    fn sequence(&mut self) -> Part {
        let from = self.rest.to_string();
        let mut parts = Vec::new();
        while !self.rest.trim_start().is_empty() && !self.rest.trim_start().starts_with(['|', ')']) {
            parts.push(self.repeated());
        }
        self.part(&from, Kind::Sequence(parts))
    }

    fn repeated(&mut self) -> Part {
        let from = self.rest.to_string();
        let one = self.one();
        let kind: fn(Box<Part>) -> Kind = match () {
            () if self.rest.starts_with(",*") => Kind::List,
            () if self.rest.starts_with('*') => Kind::Many,
            () if self.rest.starts_with('?') => Kind::Optional,
            () => return one,
        };
        self.eat(",");
        let _ = self.eat("*") || self.eat("?");
        self.part(&from, kind(Box::new(one)))
    }

    fn one(&mut self) -> Part {
        let from = self.rest.to_string();
        if self.eat("(") {
            let inner = self.choice();
            assert!(self.eat(")"), "`)` expected before `{}` in `{}`", self.rest, self.production);
            return inner;
        }
        if self.eat("\"") {
            let (text, rest) = self.rest.split_once('"').expect("a closing quote");
            self.rest = rest;
            return self.part(&from, Kind::Text(text.to_string()));
        }
        let end = self.rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(self.rest.len());
        assert!(end > 0, "`{}` cannot be read in `{}`", self.rest, self.production);
        let name = self.rest[..end].to_string();
        self.rest = &self.rest[end..];
        self.part(&from, Kind::Name(name))
    }
}

struct Grammar {
    productions: BTreeMap<String, Part>,
    parts: Vec<String>,
}

impl Grammar {
    fn read() -> Grammar {
        let mut parts = Vec::new();
        let mut all = BTreeMap::new();
        for (name, body) in parser_productions() {
            let mut reader = Reader { rest: &body, parts: &mut parts, production: &name };
            let part = reader.choice();
            assert_eq!(reader.rest, "", "in `{name}`");
            all.insert(name, part);
        }
        Grammar { productions: all, parts }
    }
}

/// The classes of tokens that the grammar does not spell out.
const CLASSES: [&str; 4] = ["ID", "NUMBER", "COLOUR", "STRING"];

fn is_of_class(token: Token, class: &str) -> bool {
    match token {
        Token::Name(_) => class == "ID",
        Token::Number(_) => class == "NUMBER",
        Token::Color(_) => class == "COLOUR",
        Token::Text(_) => class == "STRING",
        _ => false,
    }
}

fn is_written(token: Token, text: &str) -> bool {
    match token {
        Token::Name(name) => name == text,
        other => other.symbol() == text,
    }
}

/// The reading of some tokens: where each production can end that begins at a place.
struct Reading<'g, 't> {
    grammar: &'g Grammar,
    tokens: &'t [Token<'t>],
    known: HashMap<(String, usize), Rc<BTreeSet<usize>>>,
    used: BTreeSet<usize>,
}

impl Reading<'_, '_> {
    fn production(&mut self, name: &str, at: usize) -> Rc<BTreeSet<usize>> {
        if let Some(ends) = self.known.get(&(name.to_string(), at)) {
            return ends.clone();
        }
        let grammar = self.grammar;
        let part = grammar.productions.get(name).unwrap_or_else(|| panic!("no production `{name}`"));
        let ends = Rc::new(self.part(part, at));
        self.known.insert((name.to_string(), at), ends.clone());
        ends
    }

    fn part(&mut self, part: &Part, at: usize) -> BTreeSet<usize> {
        let token = self.tokens.get(at).copied();
        let ends = match &part.kind {
            Kind::Text(text) => token.filter(|t| is_written(*t, text)).map(|_| at + 1).into_iter().collect(),
            Kind::Name(name) if CLASSES.contains(&name.as_str()) => {
                token.filter(|t| is_of_class(*t, name)).map(|_| at + 1).into_iter().collect()
            }
            Kind::Name(name) => self.production(name, at).iter().copied().collect(),
            Kind::Sequence(parts) => {
                parts.iter().fold(BTreeSet::from([at]), |starts, part| self.reached_from_all(part, &starts))
            }
            Kind::Choice(parts) => parts.iter().flat_map(|part| self.part(part, at)).collect(),
            Kind::Optional(part) => self.part(part, at).into_iter().chain([at]).collect(),
            Kind::Many(part) => self.many(part, at),
            Kind::List(part) => self.list(part, at),
        };
        // What may be absent is used where it is there.
        let is_used = match part.kind {
            Kind::Optional(_) | Kind::Many(_) | Kind::List(_) => ends.len() > 1,
            _ => !ends.is_empty(),
        };
        if is_used {
            self.used.insert(part.number);
        }
        ends
    }

    fn reached_from_all(&mut self, part: &Part, starts: &BTreeSet<usize>) -> BTreeSet<usize> {
        starts.iter().flat_map(|start| self.part(part, *start)).collect()
    }

    fn many(&mut self, part: &Part, at: usize) -> BTreeSet<usize> {
        let mut all = BTreeSet::from([at]);
        let mut last = all.clone();
        while !last.is_empty() {
            last = self.reached_from_all(part, &last).difference(&all).copied().collect();
            all.extend(&last);
        }
        all
    }

    fn list(&mut self, part: &Part, at: usize) -> BTreeSet<usize> {
        let mut all = BTreeSet::from([at]);
        let mut last = self.part(part, at);
        while !last.is_empty() {
            let commas: BTreeSet<usize> = last
                .iter()
                .filter(|end| self.tokens.get(**end) == Some(&Token::Comma))
                .map(|end| end + 1)
                .collect();
            all.extend(&last);
            all.extend(&commas);
            last = self.reached_from_all(part, &commas).difference(&all).copied().collect();
        }
        all
    }
}

/// What of the grammar the items of a text use; a text that is right for the parser must be right for the grammar.
fn parts_used(grammar: &Grammar, name: &str, text: &str) -> BTreeSet<usize> {
    let (_, diagnostics) = parse(FileId::default(), text);
    assert_eq!(diagnostics, [], "{name}");
    let lexed = lex(FileId::default(), text);
    let outlined = outline(text, FileId::default(), &lexed.tokens, false);
    let mut used = BTreeSet::new();
    for piece in outlined.items {
        let slice = &outlined.tokens[piece.tokens];
        let tokens: Vec<Token> = slice.iter().map(|(token, _)| *token).collect();
        let mut reading = Reading { grammar, tokens: &tokens, known: HashMap::new(), used: BTreeSet::new() };
        let ends = reading.production("item", 0);
        let place = slice[0].1.start as usize;
        let reached = ends.iter().max().map(|end| slice.get(*end).map_or(text.len(), |t| t.1.start as usize));
        assert!(ends.contains(&tokens.len()), "{name}: {:?}", &text[place..reached.unwrap_or(place)]);
        used.extend(reading.used);
    }
    used
}

fn texts(folders: &[&str]) -> Vec<(String, String)> {
    let mut out = Vec::new();
    for folder in folders {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "sdf") {
                let text = std::fs::read_to_string(&path).unwrap();
                let source = text.split("// expect\n").next().unwrap().to_string();
                out.push((path.display().to_string(), source));
            }
        }
    }
    assert!(!out.is_empty());
    out
}

/// Every right text is right by the grammar.
#[test]
fn the_grammar_takes_what_the_parser_takes() {
    let grammar = Grammar::read();
    for (name, text) in texts(&["examples", "crates/sdf-lang/std", "crates/sdf-lang/runtime"]) {
        parts_used(&grammar, &name, &text);
    }
}

/// The fixtures whose trees are compared use every production, and every alternative in it.
#[test]
fn every_part_of_the_grammar_has_a_fixture() {
    let grammar = Grammar::read();
    let mut used = BTreeSet::new();
    for (name, text) in texts(&["crates/sdf-syntax/tests/fixtures/trees"]) {
        used.extend(parts_used(&grammar, &name, &text));
    }
    let missing: Vec<&String> =
        grammar.parts.iter().enumerate().filter(|(i, _)| !used.contains(i)).map(|(_, part)| part).collect();
    assert!(missing.is_empty(), "without a fixture: {missing:#?}");
}

/// What the parser refuses, the grammar refuses.
#[test]
fn the_grammar_refuses_what_the_parser_refuses() {
    let grammar = Grammar::read();
    for text in [
        "let a = 1 +",
        "let a = (1, b: 2",
        "let = 1",
        "fn f(a b) = a",
        "param a = 1 in 0",
        "scene { let a = 1; ; }",
        "let a = if b { 1 }",
        "let a = {}",
        "light { a: 1 }",
        "material m (a: 1)",
        "let a = f(, )",
        "@exact",
        "let a = |b c| d",
        "let a = b.1",
        "import a",
        "let a = for b { c }",
        "fn f(a: number) = 1",
        "let a = ()",
    ] {
        let lexed = lex(FileId::default(), text);
        let tokens: Vec<Token> = lexed.tokens.iter().map(|(token, _)| *token).collect();
        let mut reading =
            Reading { grammar: &grammar, tokens: &tokens, known: HashMap::new(), used: BTreeSet::new() };
        let accepted = reading.production("item", 0).contains(&tokens.len());
        assert!(!parse(FileId::default(), text).1.is_empty(), "the parser takes {text}");
        assert!(!accepted, "the grammar takes {text}");
    }
}
