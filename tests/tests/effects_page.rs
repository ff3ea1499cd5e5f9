//! The page of the effects and its pictures are what the files of the renderer say, and what scenes with and without each
//! effect look like. `UPDATE_FIXTURES=1 cargo test` makes them anew.

use sdf_tests::effects::{SHOWN, page, page_path, picture_path};
use sdf_tests::pictures::{read, write};
use std::collections::BTreeSet;
use std::fs;

fn updates() -> bool {
    std::env::var_os("UPDATE_FIXTURES").is_some()
}

#[test]
fn the_page_says_what_the_renderer_says() {
    let expected = page();
    if updates() {
        fs::write(page_path(), &expected).expect("the page can be written");
    }
    let found = fs::read_to_string(page_path()).expect("grammar/effects.md is there");
    assert!(found == expected, "run `UPDATE_FIXTURES=1 cargo test --workspace --test effects_page`");
}

/// All the pictures together, in bytes.
const ALL_PICTURES: u64 = 2_500_000;

#[test]
fn the_pictures_show_the_effects() {
    let (mut wrong, mut names, mut bytes) = (Vec::new(), BTreeSet::new(), 0);
    for shown in SHOWN {
        let [without, with] = shown.drawn();
        // Exact normals and sampled ones look alike.
        assert!(without != with || shown.title == "Sampled normals", "{} changes nothing", shown.title);
        for (picture, name) in [without, with].iter().zip(shown.pictures()) {
            let path = picture_path(&name);
            if updates() {
                write(&path, picture);
            }
            // The interpreter computes the same bits everywhere.
            if read(&path).as_ref() != Some(picture) {
                wrong.push(name.clone());
            }
            bytes += fs::metadata(&path).map_or(0, |file| file.len());
            names.insert(name);
        }
    }
    assert!(
        wrong.is_empty(),
        "not as drawn: {wrong:?}; `UPDATE_FIXTURES=1 cargo test --workspace --test effects_page` draws them"
    );
    let folder = fs::read_dir(picture_path("any").parent().expect("a folder")).expect("the folder");
    let found: BTreeSet<String> =
        folder.map(|file| file.expect("a file").file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(found, names, "a picture is of no effect");
    assert!(bytes <= ALL_PICTURES, "the pictures have {bytes} bytes");
}
