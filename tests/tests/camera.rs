//! Cameras that are turned about their target, by the pointer and from outside.

use sdf_ir::Role;
use sdf_lang::{Options, Scene};
use sdf_render::{Frame, Picture, cpu};
use sdf_tests::agreement::compare;
use sdf_tests::scenes::{Buffers, examples, scene};
use std::f64::consts::FRAC_PI_2;

const WIDTH: u32 = 160;
const HEIGHT: u32 = 90;

/// Nothing in it looks alike from two sides.
const SHAPES: &str = "light sun { direction: (1, 3, 2) } scene {
    box(0.5, 0.8, 0.3).at(0.3, 0, 0).paint(#f80), sphere(0.4).at(-0.8, 0.2, 0.6).paint(#08f),
    box(4, 0.1, 3).at(0, -1, 0).paint(material { color: checker(p.xz, #333, #ccc) }) }";

fn draw(scene: &Scene, frame: &Frame) -> Picture {
    cpu::render(&sdf_ir::legalise(&scene.program), frame)
}

/// A scene with this camera, and what its pixels show.
fn plain(camera: &str) -> (Picture, Buffers) {
    let options = Options { probe: true, ..Options::default() };
    let scene = scene(camera, &format!("camera {{ {camera} }} {SHAPES}"), &options);
    let frame = Frame::new(WIDTH, HEIGHT);
    (draw(&scene, &frame), Buffers::of(&scene, &frame))
}

/// A scene with this camera, which can be turned from outside.
fn turnable(camera: &str) -> Scene {
    let options = Options { orbit: true, ..Options::default() };
    scene(camera, &format!("camera {{ {camera} }} {SHAPES}"), &options)
}

/// The camera turned like this sees what another camera sees.
#[track_caller]
fn sees(camera: &str, orbit: [f64; 3], other: &str) {
    let picture = draw(&turnable(camera), &Frame { orbit, ..Frame::new(WIDTH, HEIGHT) });
    let (expected, buffers) = plain(other);
    assert_eq!(compare(&expected, &picture, &buffers).complaint(), None, "{camera}, {orbit:?}, {other}");
}

#[test]
fn a_camera_that_is_not_turned_draws_every_example_as_it_is() {
    for example in examples() {
        let frame = Frame { time: 0.7, ..Frame::new(WIDTH, HEIGHT) };
        let probe = scene(&example.name, &example.text, &Options { probe: true, ..Options::default() });
        let turnable = scene(&example.name, &example.text, &Options { orbit: true, ..Options::default() });
        let has_orbit = |scene: &Scene| {
            scene.program.uniforms.iter().any(|uniform| matches!(uniform.role, Role::Orbit { .. }))
        };
        assert!(has_orbit(&turnable) && !has_orbit(&probe), "{}", example.name);
        let agreement =
            compare(&draw(&probe, &frame), &draw(&turnable, &frame), &Buffers::of(&probe, &frame));
        assert_eq!(agreement.complaint(), None, "{}", example.name);
    }
}

#[test]
fn a_turned_camera_sees_what_one_sees_that_stands_there() {
    let front = "eye: (0, 1, 5), target: (0, 0, 1)";
    sees(front, [FRAC_PI_2, 0.0, 1.0], "eye: (4, 1, 1), target: (0, 0, 1)");
    sees(front, [-FRAC_PI_2, 0.0, 0.5], "eye: (-2, 0.5, 1), target: (0, 0, 1)");
    // From the height of 0 by 30 degrees.
    let level = "eye: (0, 0, 4), target: (0, 0, 0)";
    sees(level, [0.0, 30f64.to_radians(), 1.0], "eye: (0, 2, 3.4641016), target: (0, 0, 0)");
    sees(level, [0.0, -10f64.to_radians(), 1.0], "eye: (0, -0.694593, 3.9392310), target: (0, 0, 0)");
    // About an axis of its own.
    sees(
        "eye: (0, 0, 4), target: (0, 0, 0), up: (1, 0, 0)",
        [FRAC_PI_2, 0.0, 1.0],
        "eye: (0, -4, 0), target: (0, 0, 0), up: (1, 0, 0)",
    );
}

#[test]
fn a_camera_does_not_go_over_the_pole() {
    let level = "eye: (0, 0, 4), target: (0, 0, 0)";
    let steepest = 89f64.to_radians();
    let top = format!("eye: (0, {}, {}), target: (0, 0, 0)", 4.0 * steepest.sin(), 4.0 * steepest.cos());
    sees(level, [0.0, 2.5, 1.0], &top);
    // One that stands there already may be turned on the spot.
    sees("eye: (0, 4, 0), target: (0, 0, 0)", [0.0, 0.3, 1.0], "eye: (0, 4, 0), target: (0, 0, 0)");
    sees(
        "eye: (0, 4, 0), target: (0, 0, 0)",
        [FRAC_PI_2, 0.0, 1.0],
        "eye: (0, 4, 0), target: (0, 0, 0), up: (-1, 0, 0)",
    );
}

#[test]
fn a_page_knows_how_far_its_camera_can_be_tilted() {
    let tilt = |camera: &str| {
        let scene = turnable(camera);
        let mut roles = scene.program.uniforms.iter().map(|uniform| uniform.role);
        let tilt = roles.find_map(|role| if let Role::Orbit { tilt } = role { Some(tilt) } else { None });
        let (low, high) = tilt.expect("a camera that can be turned");
        (low.to_degrees().round(), high.to_degrees().round())
    };
    assert_eq!(tilt("eye: (0, 0, 4)"), (-89.0, 89.0));
    assert_eq!(tilt("eye: (0, 4, 4)"), (-134.0, 44.0));
    assert_eq!(tilt("eye: (0, 4, 0)"), (-179.0, 0.0));
    assert_eq!(tilt("eye: (0, sin(time), 4)"), (-180.0, 180.0));
}

#[test]
fn who_steps_back_still_sees_the_scene() {
    let camera = "eye: (0, 0, 4), target: (0, 0, 0)";
    let scene = turnable(&format!("{camera} }} render {{ far: 8"));
    let frame = Frame { orbit: [0.0, 0.0, 20.0], ..Frame::new(WIDTH, HEIGHT) };
    let picture = draw(&scene, &frame);
    assert_ne!(picture.pixel(WIDTH / 2, HEIGHT / 2), picture.pixel(0, 0));
}

/// `camera { orbit: true }`: the pointer in the middle changes nothing, the picture's width is a full turn.
#[test]
fn the_pointer_turns_a_camera_that_orbits() {
    let camera = "eye: (0, 0, 4), target: (0, 0, 0)";
    let orbiting =
        scene("orbit", &format!("camera {{ {camera}, orbit: true }} {SHAPES}"), &Options::default());
    for (mouse, other) in [
        ([0.5, 0.5], camera),
        ([0.25, 0.5], "eye: (4, 0, 0), target: (0, 0, 0)"),
        ([1.0, 0.5], "eye: (0, 0, -4), target: (0, 0, 0)"),
        ([0.5, 1.0 / 3.0], "eye: (0, 2, 3.4641016), target: (0, 0, 0)"),
    ] {
        let picture = draw(&orbiting, &Frame { mouse, ..Frame::new(WIDTH, HEIGHT) });
        let (expected, buffers) = plain(other);
        assert_eq!(compare(&expected, &picture, &buffers).complaint(), None, "{mouse:?}");
    }
    // A switch that is off leaves the camera alone.
    let text = format!("param on = false camera {{ {camera}, orbit: on }} {SHAPES}");
    let picture = draw(
        &scene("switch", &text, &Options::default()),
        &Frame { mouse: [0.1, 0.9], ..Frame::new(WIDTH, HEIGHT) },
    );
    let (expected, buffers) = plain(camera);
    assert_eq!(compare(&expected, &picture, &buffers).complaint(), None);
}
