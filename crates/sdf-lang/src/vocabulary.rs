//! The words of the language, for editors and for the files that list them: [`vocabulary`].

use crate::builtin;
use crate::contract::ATTRIBUTES;
use crate::library;
use crate::settings::BLOCKS;
use crate::surface::Column;
use std::collections::BTreeSet;

/// The words that every file can use, reserved words apart. All lists are sorted but that of the blocks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Vocabulary {
    /// The functions of the standard library, which are written in the language.
    pub library: Vec<&'static str>,
    /// The functions that are built in.
    pub built_in: Vec<&'static str>,
    /// The constants and inputs.
    pub constants: Vec<&'static str>,
    /// The attributes, without their `@`.
    pub attributes: Vec<&'static str>,
    /// The blocks of settings with their fields, in the order of the language's page.
    pub blocks: Vec<(&'static str, Vec<&'static str>)>,
}

/// The words that every file can use.
pub fn vocabulary() -> Vocabulary {
    let library: BTreeSet<&str> = library::std().public_names().collect();
    let built_in: BTreeSet<&str> = builtin::all().iter().map(|function| function.name).collect();
    let mut constants = builtin::CONSTANTS.to_vec();
    let mut attributes = ATTRIBUTES.to_vec();
    constants.sort_unstable();
    attributes.sort_unstable();
    let mut blocks: Vec<(&str, Vec<&str>)> =
        BLOCKS.iter().map(|(block, fields)| (*block, fields.to_vec())).collect();
    blocks.push(("material", Column::ALL.iter().map(|column| column.name()).collect()));
    Vocabulary {
        library: library.into_iter().collect(),
        built_in: built_in.into_iter().collect(),
        constants,
        attributes,
        blocks,
    }
}
