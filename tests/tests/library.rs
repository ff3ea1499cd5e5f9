//! The library's page and its pictures are what the doc comments say. `UPDATE_FIXTURES=1 cargo test` makes them anew.

use sdf_lang::{Entry, reference};
use sdf_tests::library::calls;
use sdf_tests::pictures::{read, write};
use sdf_tests::reference::{page, page_path, picture, picture_path, picture_scene};
use sdf_tests::scenes::gallery;
use std::collections::BTreeSet;
use std::fs;

fn updates() -> bool {
    std::env::var_os("UPDATE_FIXTURES").is_some()
}

fn entries() -> Vec<Entry> {
    reference().into_iter().flat_map(|section| section.entries).collect()
}

#[test]
fn the_page_says_what_the_doc_comments_say() {
    let expected = page();
    if updates() {
        fs::write(page_path(), &expected).expect("the page can be written");
    }
    let found = fs::read_to_string(page_path()).expect("grammar/library.md is there");
    assert!(found == expected, "run `UPDATE_FIXTURES=1 cargo test --workspace --test library`");
}

/// The scene of the page's first picture shows every shape that is made of numbers alone; `nothing` cannot be seen.
#[test]
fn the_gallery_shows_every_primitive() {
    let text = gallery().text;
    let forms =
        |entry: &&Entry| calls().iter().any(|call| call.function == entry.name && call.is_primitive());
    let missing: Vec<String> = entries()
        .iter()
        .filter(forms)
        .map(|entry| entry.name.clone())
        .filter(|name| !text.contains(&format!("{name}(")))
        .collect();
    assert_eq!(missing, Vec::<String>::new());
}

/// All the pictures together, in bytes.
const ALL_PICTURES: u64 = 1_500_000;

#[test]
fn the_pictures_show_the_examples() {
    let mut wrong = Vec::new();
    let mut names = BTreeSet::new();
    let mut bytes = 0;
    for entry in entries() {
        let (drawn, path) = (picture(&entry), picture_path(&entry.name));
        if updates() {
            write(&path, &drawn);
        }
        // The interpreter computes the same bits everywhere.
        if read(&path).as_ref() != Some(&drawn) {
            wrong.push(entry.name.clone());
        }
        bytes += fs::metadata(&path).map_or(0, |file| file.len());
        names.insert(format!("{}.png", entry.name));
    }
    assert!(
        wrong.is_empty(),
        "not as drawn: {wrong:?}; `UPDATE_FIXTURES=1 cargo test --workspace --test library` draws them"
    );
    let folder = fs::read_dir(picture_path("any").parent().expect("a folder")).expect("the folder");
    let found: BTreeSet<String> =
        folder.map(|file| file.expect("a file").file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(found, names, "a picture is of no function");
    assert!(bytes <= ALL_PICTURES, "the pictures have {bytes} bytes");
}

/// A picture is that of its example, and another shape has another.
#[test]
fn pictures_tell_shapes_apart() {
    let entries = entries();
    let named = |name: &str| entries.iter().find(|entry| entry.name == name).expect("a function");
    assert!(picture_scene(named("sphere")).contains(&named("sphere").forms[0].examples[0]));
    assert_ne!(picture(named("sphere")), picture(named("box")));
}
