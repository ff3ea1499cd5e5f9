//! Rays whose steps are relaxed meet what rays with plain steps meet.

use sdf_lang::Options;
use sdf_render::{Frame, Picture, cpu};
use sdf_tests::hard::twin::Twin;
use sdf_tests::scenes::scene;

const SIZE: (u32, u32) = (160, 90);

fn picture(render: &str, text: &str) -> Picture {
    picture_by(render, text, "product")
}

/// The picture that a naive twin draws.
fn picture_by(render: &str, text: &str, twin: &str) -> Picture {
    let options = Options { attack: Some(0), replaced: Twin::named(twin).replaced, ..Options::default() };
    let scene = scene(text, &format!("render {{ {render} }} {text}"), &options);
    cpu::render(&sdf_ir::legalise(&scene.program), &Frame::new(SIZE.0, SIZE.1))
}

/// How many pixels differ visibly.
fn differing(a: &Picture, b: &Picture) -> usize {
    let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
    pixels.filter(|(x, y)| (0..3).any(|i| a.pixel(*x, *y)[i].abs_diff(b.pixel(*x, *y)[i]) > 3)).count()
}

const SCENES: [&str; 5] = [
    "scene { sphere(1) }",
    "camera { eye: (0, 9, 40), target: (0, 0, 0), fov: 8deg } scene { sphere(1), plane().at(0, -1, 0) }",
    "camera { eye: (3, 2, 4) } scene { box(0.6).twist(2).at(1, 0, 0), torus(1, 0.2).at(-1, 0.4, 0), plane().at(0, -1, 0) }",
    "camera { eye: (3, 2, 4) } scene { sphere(0.3).repeat(x: 1, z: 1.2, count: 3), plane().at(0, -0.3, 0) }",
    "camera { eye: (0.2, 0.1, 0.3), target: (1, 0.2, 0.5) } scene { box(2) - sphere(1.8) }",
];

/// The naive twin takes steps 1.8 times as long as the distance, and never one back.
#[test]
fn relaxed_steps_see_what_plain_steps_see() {
    // At silhouettes and horizons a ray meets what it passes within the tolerance, or does not.
    let few = (SIZE.0 * SIZE.1) as usize / 200;
    let mut misled = 0;
    for text in SCENES {
        let plain = picture("relax: none", text);
        let found = differing(&picture("relax: auto", text), &plain);
        assert!(found <= few, "{text}: {found} pixels differ");
        misled +=
            usize::from(differing(&picture_by("relax: auto", text, "unchecked_relaxation"), &plain) > few);
    }
    assert!(misled >= 3, "the twin shows {misled} scenes wrong");
}

/// The measure can fail: rays with too few steps do not get as far.
#[test]
fn other_pictures_are_told_apart() {
    let (relaxed, short) = (picture("relax: auto", SCENES[2]), picture("relax: none, steps: 12", SCENES[2]));
    assert!(differing(&relaxed, &short) > 200);
}
