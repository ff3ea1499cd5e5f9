//! The scenes in `examples/`, how their pictures are compared, and that each has its place on the page.

use sdf_emit::Target;
use sdf_lang::Options;
use sdf_render::Picture;
use sdf_tests::agreement::{TOLERANCE, compare};
use sdf_tests::drawing::{SIZE, buffers, frame_at, on_cpu, shader};
use sdf_tests::scenes::{Buffers, all_examples, examples, folder};

/// An example and its picture by the interpreter, with its buffers.
fn one() -> (Picture, Buffers) {
    let all = examples();
    let example = all.iter().find(|e| e.name == "carved").expect("the example `carved`");
    let frame = frame_at(0.0);
    (on_cpu(&shader(example), &frame), buffers(example, &frame))
}

#[test]
fn a_picture_that_is_moved_by_a_pixel_does_not_agree() {
    let (picture, buffers) = one();
    assert_eq!(compare(&picture, &picture, &buffers).complaint(), None);
    let mut moved = picture.clone();
    moved.rgba.rotate_left(4);
    let complaint = compare(&picture, &moved, &buffers).complaint().expect("a complaint");
    assert!(complaint.contains("pixels differ"), "{complaint}");
}

#[test]
fn a_single_pixel_off_the_edges_is_a_defect() {
    let (picture, buffers) = one();
    let pixels = (0..SIZE[1] as usize).flat_map(|row| (0..SIZE[0] as usize).map(move |column| (column, row)));
    let smooth = |&(column, row): &(usize, usize)| {
        buffers.pixels[row * buffers.width + column].depth > 0.0 && !buffers.is_near_edge(column, row)
    };
    let (column, row) = pixels.clone().find(smooth).expect("a pixel inside a surface");
    let (edge_column, edge_row) =
        pixels.clone().find(|(x, y)| buffers.is_near_edge(*x, *y)).expect("an edge");
    let changed = |column: usize, row: usize, by: u8| {
        let mut changed = picture.clone();
        let channel = &mut changed.rgba[4 * (row * buffers.width + column)];
        *channel = if *channel > 127 { *channel - by } else { *channel + by };
        compare(&picture, &changed, &buffers)
    };
    assert_eq!(changed(column, row, TOLERANCE).complaint(), None);
    assert_eq!(changed(edge_column, edge_row, 100).complaint(), None);
    let complaint = changed(column, row, TOLERANCE + 1).complaint().expect("a complaint");
    assert!(complaint.contains(&format!("column {column}, row {row}:")), "{complaint}");
}

/// The probe is for the interpreter alone: with it the texts are what they are without.
#[test]
fn a_probe_is_not_in_the_text() {
    for example in examples() {
        let text = |probe| {
            let options = Options { probe, ..Options::default() };
            let compiled = sdfc::compile(&example.name, &example.text, &options, &mut sdfc::Clock::default());
            compiled.output.expect("a shader").1.text(Target::Wgsl).expect("a text")
        };
        let (with, without) = (text(true), text(false));
        assert!(!with.contains("probe"), "{}", example.name);
        assert_eq!(with, without, "{}", example.name);
    }
}

#[test]
fn every_example_has_its_picture_and_its_place() {
    let page = std::fs::read_to_string(folder().join("README.md")).expect("the page of the examples");
    for example in all_examples() {
        for file in [format!("{}.sdf", example.name), format!("{}.png", example.name)] {
            assert!(folder().join(&file).is_file(), "examples/{file} is missing");
            assert!(page.contains(&format!("({file})")), "examples/README.md does not show {file}");
        }
    }
}
