//! The public functions of the library, from its texts.

use sdf_lang::reference;

/// One form of a public function: a name may have several.
#[derive(Debug, Clone, PartialEq)]
pub struct Form {
    /// Its name.
    pub name: String,
    /// How it is called, as written.
    pub signature: String,
    /// The names of its parameters.
    pub parameters: Vec<String>,
    /// Whether it makes what it makes from numbers alone, and not from shapes or functions.
    pub is_primitive: bool,
    /// Whether it says that what it makes is convex, of convex shapes at least.
    pub is_convex: bool,
    /// What its `@requires` say.
    pub requirements: Vec<String>,
    /// The calls in its doc comment.
    pub examples: Vec<String>,
}

/// All public functions, in the order of the library.
pub fn forms() -> Vec<Form> {
    let mut forms = Vec::new();
    for entry in reference().into_iter().flat_map(|section| section.entries) {
        // A form without a doc comment is there for the library alone.
        for form in entry.forms.into_iter().filter(|form| !form.summary.is_empty()) {
            forms.push(Form {
                name: entry.name.clone(),
                is_primitive: !form.is_operator(),
                is_convex: form.promises.iter().any(|promise| promise.starts_with("convex")),
                signature: form.signature,
                parameters: form.parameters.into_iter().map(|p| p.name).collect(),
                requirements: form.requirements,
                examples: form.examples,
            });
        }
    }
    forms
}
