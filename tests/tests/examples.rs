//! Every scene in `examples/`: all targets take its text, and the interpreter, WGSL and GLSL draw the same picture.

use sdf_ir::Role;
use sdf_lang::Options;
use sdf_render::{Frame, Picture};
use sdf_tests::agreement::{Agreement, TOLERANCE, compare};
use sdf_tests::glslang;
use sdf_tests::scenes::{Buffers, Example, examples, folder, scene};
use sdfc::{Clock, Device, Language, Shader, Target};
use std::fmt::Write;

const SIZE: [u32; 2] = [320, 180];
/// When animated scenes are drawn; the others are drawn at the first of these.
const TIMES: [f64; 2] = [0.0, 1.7];

fn shader(example: &Example) -> Shader {
    let compiled = sdfc::compile(&example.name, &example.text, &Options::default(), &mut Clock::default());
    let said: Vec<&String> = compiled.diagnostics.iter().map(|d| &d.message).collect();
    compiled.output.unwrap_or_else(|| panic!("{}: {said:?}", example.name)).1
}

fn draw(shader: &Shader, frame: &Frame, device: &Device, language: Language) -> Picture {
    let drawing = shader.draw(frame, device, language, &|_| {}, &mut Clock::default());
    drawing.unwrap_or_else(|error| panic!("{error}")).picture
}

fn frame_at(time: f64) -> Frame {
    Frame { time, ..Frame::new(SIZE[0], SIZE[1]) }
}

/// The buffers of a scene, from a compilation of its own: what is drawn has no probe.
fn buffers(example: &Example, frame: &Frame) -> Buffers {
    let options = Options { probe: true, ..Options::default() };
    Buffers::of(&scene(&example.name, &example.text, &options), frame)
}

/// The interpreter's picture, and those of both languages on the software driver.
fn pictures(shader: &Shader, frame: &Frame) -> [Picture; 3] {
    let lavapipe = Device::Named("llvmpipe".into());
    [
        draw(shader, frame, &Device::Cpu, Language::Wgsl),
        draw(shader, frame, &lavapipe, Language::Wgsl),
        draw(shader, frame, &lavapipe, Language::Glsl),
    ]
}

/// What a target has against an example, if anything: naga's word on all, and the reference compiler's on `.frag`.
fn refusal(shader: &Shader, target: Target) -> Option<String> {
    match shader.text(target) {
        Err(diagnostic) => Some(diagnostic.message),
        Ok(text) if target == Target::GlslEs => glslang::complaint(&text),
        Ok(_) => None,
    }
}

/// One row of the table.
fn row(table: &mut String, example: &Example, what: &str, outcome: &str) {
    writeln!(table, "{:<12} {what:<24} {outcome}", example.name).expect("a string grows");
}

#[test]
fn all_targets_take_every_example_and_draw_it_alike() {
    let (mut table, mut complaints) = (String::new(), String::new());
    for example in examples() {
        let shader = shader(&example);
        assert_eq!(sdf_ir::verify(&shader.program), Ok(()), "{}", example.name);
        for target in Target::ALL {
            let refusal = refusal(&shader, target);
            let outcome = if refusal.is_none() { "accepted" } else { "refused" };
            row(&mut table, &example, &format!("{target:?}"), outcome);
            complaints += &refusal.map_or(String::new(), |r| format!("{}, {target:?}: {r}\n", example.name));
        }
        let animated = shader.program.uniforms.iter().any(|u| u.role == Role::Time);
        for time in TIMES.into_iter().take(if animated { 2 } else { 1 }) {
            let frame = frame_at(time);
            let buffers = buffers(&example, &frame);
            assert!(buffers.pixels.iter().any(|seen| seen.depth > 0.0), "{} shows nothing", example.name);
            let [cpu, wgsl, glsl] = pictures(&shader, &frame);
            let pairs =
                [("cpu, wgsl", &cpu, &wgsl), ("cpu, glsl", &cpu, &glsl), ("wgsl, glsl", &wgsl, &glsl)];
            for (pair, expected, found) in pairs {
                let agreement = compare(expected, found, &buffers);
                let Agreement { pixels, differing, largest, ref unexplained } = agreement;
                let share = 100.0 * differing as f64 / pixels as f64;
                let outcome = format!(
                    "{differing} pixels differ ({share:.3} %), {} off edges; largest difference {largest}",
                    unexplained.len()
                );
                row(&mut table, &example, &format!("{pair} at {time} s"), &outcome);
                if let Some(complaint) = agreement.complaint() {
                    complaints += &format!("{} at {time}, {pair}:\n{complaint}\n", example.name);
                }
            }
        }
    }
    keep("examples.txt", &table);
    assert!(complaints.is_empty(), "{complaints}");
}

/// Prints a table, and leaves it in the folder of what was built.
fn keep(name: &str, table: &str) {
    println!("{table}");
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, table).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// An example and its picture by the interpreter, with its buffers.
fn one() -> (Picture, Buffers) {
    let all = examples();
    let example = all.iter().find(|e| e.name == "carved").expect("the example `carved`");
    let frame = frame_at(0.0);
    (draw(&shader(example), &frame, &Device::Cpu, Language::Wgsl), buffers(example, &frame))
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
            let program = sdf_ir::legalise(&scene(&example.name, &example.text, &options).program);
            sdf_emit::emit(&program, Target::Wgsl, &sdf_emit::Header::default()).expect("a text")
        };
        let (with, without) = (text(true), text(false));
        assert!(!with.contains("probe"), "{}", example.name);
        assert_eq!(with, without, "{}", example.name);
    }
}

#[test]
fn every_example_has_its_picture_and_its_place() {
    let page = std::fs::read_to_string(folder().join("README.md")).expect("the page of the examples");
    for example in examples() {
        for file in [format!("{}.sdf", example.name), format!("{}.png", example.name)] {
            assert!(folder().join(&file).is_file(), "examples/{file} is missing");
            assert!(page.contains(&format!("({file})")), "examples/README.md does not show {file}");
        }
    }
}
