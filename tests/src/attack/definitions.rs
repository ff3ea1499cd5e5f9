//! What the library's shapes are, said a second time: in `tests/solids.sdf` by inequalities, as fields of which the
//! sign alone means something, and in `tests/curves.sdf` by the points that they consist of, as the distance of a
//! point to the one that has given parameters. A function there is called as the library's of the same name is.

use super::forms::Form;
use super::subject::Kind;
use sdf_ir::Program;
use sdf_lang::{Options, Scene};
use sdf_syntax::tree::ItemKind;
use sdf_syntax::{FileId, Severity};
use std::collections::BTreeMap;

/// A file of definitions.
#[derive(Debug)]
pub struct Definitions {
    /// The items that the library has no function for: they belong to every definition.
    helpers: String,
    /// Those that stand for a function of the library, by its name.
    own: BTreeMap<String, String>,
}

impl Definitions {
    /// Those by inequalities.
    pub fn solids(forms: &[Form]) -> Definitions {
        Definitions::of_text(include_str!("../../solids.sdf"), forms)
    }

    /// Those by points.
    pub fn curves(forms: &[Form]) -> Definitions {
        Definitions::of_text(include_str!("../../curves.sdf"), forms)
    }

    fn of_text(text: &str, forms: &[Form]) -> Definitions {
        let (tree, diagnostics) = sdf_syntax::parse(FileId(0), text);
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
        let mut definitions = Definitions { helpers: String::new(), own: BTreeMap::new() };
        for item in &tree.items {
            let text = &text[item.span.start as usize..item.span.end as usize];
            match &item.kind {
                ItemKind::Fn(function) if forms.iter().any(|form| form.name == *function.name.text) => {
                    let own = definitions.own.entry(function.name.text.to_string()).or_default();
                    // Nobody asks how steep it is, and where it ends.
                    *own += &format!("@lipschitz(1) @bounds(-1e20, 1e20) {text}\n");
                }
                _ => definitions.helpers += &format!("{text}\n"),
            }
        }
        definitions
    }

    /// Whether there is one for a function of this name.
    pub fn has(&self, name: &str) -> bool {
        self.own.contains_key(name)
    }

    /// The names of the functions that have one.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.own.keys().map(String::as_str)
    }

    /// What a call of the function of this name means by its definition; the shapes among its arguments are the
    /// library's.
    pub fn program(&self, name: &str, call: &str, kind: Kind) -> Result<Program, String> {
        let scene = self.scene(&[name], call, kind, &Options { attack: Some(0), ..Options::default() })?;
        let program = Program { entry: scene.map, ..scene.program };
        Ok(sdf_ir::simplify(&program, &[]).0)
    }

    /// The scene of a call in which the functions of these names are meant by their definitions.
    pub fn scene(&self, names: &[&str], call: &str, kind: Kind, options: &Options) -> Result<Scene, String> {
        let mut text = self.helpers.clone();
        for name in names {
            text += self.own.get(*name).ok_or_else(|| format!("{name} has no definition"))?;
        }
        text += &kind.scene("", call);
        let compilation = sdf_lang::compile(call, &text, options);
        compilation.scene.ok_or_else(|| {
            let errors = compilation.diagnostics.iter().filter(|d| d.severity() == Severity::Error);
            let said: Vec<String> = errors.map(|d| format!("{}: {}", d.code, d.message)).collect();
            format!("the definition of {call}: {}", said.join("; "))
        })
    }
}
