//! The public functions of the library, from its texts.

use sdf_lang::Options;
use sdf_syntax::tree::{AttributeArgument, Function, ItemKind, TypeKind};

/// One form of a public function: a name may have several.
#[derive(Debug, Clone, PartialEq)]
pub struct Form {
    /// Its name.
    pub name: String,
    /// Which of the forms of its name it is, from 0.
    pub index: usize,
    /// The names of its parameters.
    pub parameters: Vec<String>,
    /// Whether it makes what it makes from numbers alone, and not from shapes or functions.
    pub is_primitive: bool,
    /// The names of its attributes.
    pub attributes: Vec<String>,
    /// What its `@requires` say.
    pub requirements: Vec<String>,
    /// The calls in its doc comment.
    pub examples: Vec<String>,
}

impl Form {
    /// Whether one of its attributes has this name.
    pub fn has(&self, attribute: &str) -> bool {
        self.attributes.iter().any(|a| a == attribute)
    }

    fn of(function: &Function, docs: &str, attributes: &[sdf_syntax::tree::Attribute]) -> Form {
        let takes = |kind| {
            function.parameters.iter().any(|p| p.ty.as_ref().is_some_and(|ty| ty.kind == kind))
        };
        let requirement = |attribute: &sdf_syntax::tree::Attribute| match &attribute.arguments[..] {
            [_, AttributeArgument::Text(message, _)] => Some(message.clone()),
            _ => None,
        };
        Form {
            name: function.name.text.to_string(),
            index: 0,
            parameters: function.parameters.iter().map(|p| p.name.text.to_string()).collect(),
            is_primitive: ![TypeKind::Shape, TypeKind::Shape2, TypeKind::Fn].into_iter().any(takes),
            attributes: attributes.iter().map(|a| a.name.text.to_string()).collect(),
            requirements: attributes.iter().filter_map(requirement).collect(),
            examples: docs.lines().filter_map(|line| line.strip_prefix("Example: ")).map(String::from).collect(),
        }
    }
}

/// All public functions: those with a doc comment, in the order of the library's files.
pub fn forms() -> Vec<Form> {
    let compilation = sdf_lang::compile("", "scene { sphere(1) }", &Options::default());
    let mut forms: Vec<Form> = Vec::new();
    for id in (0..).map(sdf_syntax::FileId) {
        let Some(source) = compilation.sources.get(id) else { break };
        if !source.name.starts_with("<std/") {
            continue;
        }
        let (tree, _) = sdf_syntax::parse(id, &source.text);
        for item in &tree.items {
            if let ItemKind::Fn(function) = &item.kind
                && !item.docs.is_empty()
            {
                let mut form = Form::of(function, &item.docs, &item.attributes);
                form.index = forms.iter().filter(|f| f.name == form.name).count();
                if form.examples.is_empty()
                    && let Some((_, calls)) = crate::library::CALLS.iter().find(|(name, _)| *name == form.name)
                    && let Some(call) = calls.get(form.index)
                {
                    form.examples.push((*call).to_string());
                }
                forms.push(form);
            }
        }
    }
    forms
}
