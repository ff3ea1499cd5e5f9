//! Scenes that must look alike do: moved with their cameras, scaled with them, in another order, mirrored, wrapped in what
//! changes nothing.

use sdf_lang::Options;
use sdf_render::{Frame, Picture, cpu};
use sdf_tests::adapter::adapter;
use sdf_tests::rewriting::{looking_far, moved, reversed, scaled, wrapped};
use sdf_tests::scenes::{Buffers, Example, examples, scene};
use sdfc::{Clock, Compiled, Device, Language};

const WIDTH: u32 = 160;
const HEIGHT: u32 = 90;
/// Far enough that the coordinates of 32 bits are 1/16 apart.
const FAR_AWAY: &str = "(1000000, -1000000, 1000000)";

fn frame() -> Frame {
    Frame { time: 1.7, ..Frame::new(WIDTH, HEIGHT) }
}

fn options() -> Options {
    Options { attack: Some(0), probe: true, ..Options::default() }
}

/// The picture of a text by the interpreter.
fn by_interpreter(text: &str) -> Picture {
    let scene = scene("relation", text, &options());
    cpu::render(&sdf_ir::legalise(&scene.program), &frame())
}

/// The picture of a text by the device.
fn by_driver(text: &str) -> Picture {
    let compiled: Compiled = sdfc::compile("relation", text, &options(), &mut Clock::default());
    let (_, shader) = compiled.output.unwrap_or_else(|| panic!("{:?}\n{text}", compiled.diagnostics));
    let device = Device::Named(adapter().name().name.clone());
    let drawing = shader.draw(&frame(), &device, Language::Wgsl, &|_| {}, &mut Clock::default());
    drawing.unwrap_or_else(|error| panic!("{error}")).picture
}

/// What draws, and how.
type Draw = fn(&str) -> Picture;
const BOTH: [(&str, Draw); 2] = [("the interpreter", by_interpreter), ("the device", by_driver)];

/// How many pixels differ by more than `tolerance` of 255 in a channel.
fn differing(a: &Picture, b: &Picture, tolerance: u8) -> usize {
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4));
    pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > tolerance)).count()
}

/// 0.1 % of the pixels.
const FEW: usize = (WIDTH * HEIGHT) as usize / 1000;

#[test]
fn a_scene_far_away_looks_as_near_by() {
    for Example { name, text } in examples() {
        let far = moved(&text, FAR_AWAY);
        for (what, draw) in BOTH {
            let found = differing(&draw(&text), &draw(&far), 1);
            assert!(found <= FEW, "{name}, {what}: {found} pixels differ");
        }
    }
}

/// The naive twin: a camera that looks at something far beyond the scene is not far from the origin beside that, so the
/// coordinates are those of the file. Near the origin it sees what it saw, far away it does not.
#[test]
fn coordinates_as_in_the_file_are_too_coarse_far_away() {
    for Example { name, text } in examples().into_iter().filter(|example| example.text.contains("camera")) {
        let (near, far) = (looking_far(&text), looking_far(&moved(&text, FAR_AWAY)));
        for (what, draw) in BOTH {
            let picture = draw(&text);
            let found = differing(&picture, &draw(&near), 1);
            assert!(found <= FEW, "{name}, {what}: {found} pixels differ near by");
            let found = differing(&picture, &draw(&far), 1);
            assert!(found > 20 * FEW, "{name}, {what}: only {found} pixels differ far away");
        }
    }
}

/// A scene far away takes the steps that it takes near by, of hardly more operations: those of a shape at the origin,
/// which is no longer there.
#[test]
fn a_scene_far_away_costs_no_more() {
    for Example { name, text } in examples() {
        let [near, far] = [text.clone(), moved(&text, FAR_AWAY)].map(|text| {
            let compiled = sdfc::compile(&name, &text, &options(), &mut Clock::default());
            let (scene, shader) = compiled.output.expect("a scene");
            let steps: f32 = Buffers::of(&scene, &frame()).pixels.iter().map(|pixel| pixel.steps).sum();
            (steps, shader.cost.map)
        });
        println!("{name}: {} and {} steps of {} and {} operations", near.0, far.0, near.1, far.1);
        assert!((far.0 - near.0).abs() <= 0.01 * near.0, "{name}: {} and {} steps", near.0, far.0);
        assert!(far.1 as f64 <= 1.1 * near.1 as f64 + 8.0, "{name}: {} and {} operations", near.1, far.1);
    }
}

/// Every number in it that is a length is written as a multiple of `u`, and what has a side as a multiple of `m`.
const LENGTHS: &str = "
camera    { eye: u * (m * 1.5, 2, 4), target: u * (0, 0.25, 0), fov: 40deg }
light sun { direction: (m * 2, 3, 1), shadow: soft(8) }
light bulb { position: u * (m * -2, 1.5, 2), intensity: 0.5, shadow: hard }
ambient   { occlusion: 0.8, radius: u * 0.5 }
render    { far: u * 100 }
scene {
  plane().at(0, u * -0.75, 0).paint(material { color: checker((m * p.x, p.z) / u, #ccc, #444, 0.5) }),
  smin(sphere(u * 0.5).at(u * (m * 0.75, 0, 0)), torus(u * 0.75, u * 0.125).rotate_x(30deg), k: u * 0.25),
  (box(u * (0.3, 0.5, 0.2)) - cylinder(u * 0.15, u * 2)).at(u * (m * -1.25, 0, -0.5)).rotate_y(m * 20deg),
  capsule(u * (m * -0.5, -0.5, 1), u * (m * 0.5, 0.25, 1.25), u * 0.1).round(u * 0.05),
  sphere(u * 0.2).repeat(x: u * 0.8, count: 3).at(0, u * -0.5, u * -1.5),
  box(u * (0.15, 0.6, 0.15)).twist(m * 3 / u).at(u * (m * 1.5, 0, -1)),
}";

fn with_lengths(unit: u32, side: i32) -> String {
    format!("let u = {unit}\nlet m = {side}\n{LENGTHS}")
}

/// Whether the steps of a scene's rays are shorter than its distances somewhere.
fn is_steep(text: &str) -> bool {
    scene("relation", text, &options()).summary.effects.contains(&"step correction")
}

#[test]
fn a_scene_of_another_size_is_the_same_to_the_bit() {
    let mut pairs: Vec<(String, String, String)> =
        examples().into_iter().map(|e| (e.name, scaled(&e.text, 1024), e.text)).collect();
    pairs.push(("lengths".into(), with_lengths(1024, 1), with_lengths(1, 1)));
    let mut complaints = String::new();
    for (name, large, text) in pairs {
        // What is scaled is no longer what it was: where steps are corrected, those to it are found in another way, and at
        // silhouettes a ray meets what it passes within the tolerance, or does not.
        let is_rewritten = name != "lengths" && is_steep(&text);
        let (tolerance, most) = if is_rewritten { (1, 5 * FEW) } else { (0, 0) };
        for (what, draw) in BOTH {
            // A driver may fuse a product and a sum where the text of the other scene has a factor between them: it gets a
            // factor in both, and the pictures are as many times apart.
            let found = if what == "the device" && name != "lengths" {
                differing(&draw(&scaled(&text, 2)), &draw(&scaled(&text, 2048)), tolerance)
            } else {
                differing(&draw(&text), &draw(&large), tolerance)
            };
            if found > most {
                complaints += &format!("{name}, {what}: {found} pixels differ\n");
            }
        }
        let [small, large] =
            [&text, &large].map(|text| Buffers::of(&scene(&name, text, &options()), &frame()).pixels);
        let differ = small.iter().zip(&large).filter(|(small, large)| {
            let depth = if small.depth < 0.0 { small.depth } else { small.depth * 1024.0 };
            (depth, small.normal, small.steps) != (large.depth, large.normal, large.steps)
        });
        let found = differ.count();
        if found > 0 && !is_rewritten {
            complaints += &format!("{name}: {found} depths, normals or numbers of steps differ\n");
        }
    }
    assert!(complaints.is_empty(), "{complaints}");
}

#[test]
fn a_mirrored_scene_is_the_mirror_image() {
    for (what, draw) in BOTH {
        let (left, right) = (draw(&with_lengths(1, 1)), draw(&with_lengths(1, -1)));
        let mirrored: Vec<u8> = right
            .rgba
            .chunks(4 * WIDTH as usize)
            .flat_map(|row| row.chunks(4).rev().flatten().copied().collect::<Vec<u8>>())
            .collect();
        let found = differing(&left, &Picture { rgba: mirrored, ..right.clone() }, 1);
        assert!(found <= FEW, "{what}: {found} pixels differ");
        assert!(differing(&left, &right, 1) > 100 * FEW, "{what}: the scene is its own mirror image");
    }
}

#[test]
fn the_order_of_shapes_does_not_matter() {
    for Example { name, text } in examples() {
        for (what, draw) in BOTH {
            let found = differing(&draw(&text), &draw(&reversed(&text)), 1);
            assert!(found <= FEW, "{name}, {what}: {found} pixels differ");
        }
    }
}

#[test]
fn what_changes_nothing_leaves_no_trace() {
    for Example { name, text } in examples() {
        for (what, draw) in BOTH {
            let found = differing(&draw(&text), &draw(&wrapped(&text)), 0);
            assert_eq!(found, 0, "{name}, {what}: pixels that differ");
        }
    }
}
