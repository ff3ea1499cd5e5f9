//! Rays are clipped to the box of the scene: nothing of a picture is cut off by it.

use sdf_lang::Options;
use sdf_render::{Frame, Picture, cpu};
use sdf_tests::scenes::scene;

const SIZE: (u32, u32) = (160, 90);
/// Far beyond all that is drawn on both sides, and without an end upwards and downwards: with it nothing is clipped. Its
/// distances are exact, so that hits are judged alike.
const WITHOUT_END: &str =
    "infinite_cylinder(1).at(1000000, 0, 1000000), infinite_cylinder(1).at(-1000000, 0, -1000000)";

/// The picture of a scene's shapes after its other items.
fn picture(items: &str, shapes: &str, time: f64) -> Picture {
    let options = Options { attack: Some(0), ..Options::default() };
    let scene = scene(shapes, &format!("{items}\nscene {{ {shapes} }}"), &options);
    let frame = Frame { time, ..Frame::new(SIZE.0, SIZE.1) };
    cpu::render(&sdf_ir::legalise(&scene.program), &frame)
}

/// How many pixels differ visibly between a scene and the same without clipping.
fn cut(items: &str, shapes: &str, time: f64) -> usize {
    let (clipped, whole) =
        (picture(items, shapes, time), picture(items, &format!("{shapes}, {WITHOUT_END}"), time));
    let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
    pixels
        .filter(|(x, y)| {
            let (a, b) = (clipped.pixel(*x, *y), whole.pixel(*x, *y));
            (0..3).any(|i| a[i].abs_diff(b[i]) > 2)
        })
        .count()
}

#[test]
fn clipping_cuts_nothing_off() {
    // What is far away is smaller than a pixel, and each ray meets something else of it.
    let sun = "light sun { direction: (2, 3, 1), shadow: hard } render { far: 80 }";
    let shapes = "plane().at(0, -1, 0), box(0.5).at(1, 0, 0).rotate_y(0.4), torus(1, 0.2).at(-1, 0.4, 0)";
    let cameras = [
        "eye: (3, 2, 5)",
        "eye: (0, 0.3, 0), target: (1, 0, 0.2)",
        "eye: (0, 60, 0.001)",
        "eye: (9, 0, 0), target: (0, 0, 0)",
        "eye: (0, 20, 60), target: (0, 0, 0), fov: 5deg",
        "eye: (-4, 5, -3), target: (-4, 0, -3), up: z",
    ];
    let scenes = [
        (shapes, 0.0),
        ("box(0.5).at(1, 0, 0), torus(1, 0.2).at(-1, 0.4, 0)", 0.0),
        ("plane().at(0, -1, 0)", 0.0),
        ("sphere(6).at(1, 0, 0).repeat(x: 25, z: 25), plane().at(0, -1, 0)", 0.0),
        ("box(0.4).twist(2).at(sin(time), 0, 0.2 * time)", 3.0),
        ("box(0.4).twist(2).at(sin(time), 0, 0.2 * time)", 20.0),
        ("sphere(0.5).paint(material { glow: (1, 0.5, 0) }), box(0.2).at(1, 0, 1)", 0.0),
    ];
    for camera in cameras {
        for (shapes, time) in scenes {
            let found = cut(&format!("camera {{ {camera} }} {sun}"), shapes, time);
            // At silhouettes and horizons a ray meets what it passes within the tolerance, or does not.
            let most = (SIZE.0 * SIZE.1) as usize / 200;
            assert!(found <= most, "{camera}: {shapes} at {time} s: {found} pixels differ");
        }
    }
}

/// The measure can fail: where a box is promised that is too small, the ball is cut.
#[test]
fn a_box_that_is_too_small_is_seen() {
    let items = "camera { eye: (3, 2, 5) } @bounds((-1, -1, -1), (1, 0.3, 1)) let ball = sphere(1)";
    assert!(cut(items, "ball", 0.0) > 200);
}
