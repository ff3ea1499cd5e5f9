//! Operators over shapes of which some are steep and some are not: only the steep ones are stepped over their slope, and
//! only near them.

use sdf_lang::Options;
use sdf_render::Frame;
use sdf_render::certify::{Certifier, Functions, Picture, Report, interpreted};
use sdf_tests::scenes::scene;

/// Twisted columns, bent ones and planes, which have no end, under operators.
const SCENES: [&str; 14] = [
    "union(box((0.3, 1, 0.3)).twist(2), plane().at(0, -1, 0)).scale(2)",
    "union(box((0.3, 1, 0.3)).twist(2).at(1, 0, 0), plane().at(0, -1, 0)).mirror((1, 0, 0))",
    "union(box((0.3, 1, 0.3)).twist(2), plane().at(0, -1, 0)).round(0.1)",
    "(box((0.3, 1, 0.3)).twist(2) | plane().at(0, -1, 0)).paint(#60c080).rotate_y(0.4)",
    "smin(box((0.3, 1, 0.3)).twist(2), plane().at(0, -1, 0), k: 0.3)",
    "smin(box((0.3, 1, 0.3)).twist(2), plane().at(0, -1, 0), k: 0.3).at(0, 0.2, 0).scale(1.5)",
    "smin(box((0.3, 1, 0.3)).bend(0.5), sphere(0.5).at(1.5, -0.5, 0), plane().at(0, -1, 0), k: 0.3, kind: cubic)",
    "plane() - box((0.3, 1, 0.3)).twist(2).at(0, 0.5, 0)",
    "smin(box((0.2, 0.5, 0.2)).twist(3) | plane(), sphere(0.5).at(1.5, 0.5, 1), k: 0.3)",
    "smin(smin(box((0.2, 0.5, 0.2)).twist(3).at(0, 0.4, 0), plane(), k: 0.2), sphere(0.5).at(1.5, 0.5, 1), k: 0.3)",
    "smin(box((200, 0.1, 200)), box((0.3, 1, 0.3)).twist(1).at(0, 0.4, 0), k: 0.3)",
    "smin(plane(), box((0.3, 1, 0.3)).twist(1), k: 0.5).round(0.1)",
    "(plane() | box((0.3, 1, 0.3)).twist(1)) - sphere(0.4).at(0.3, 0.4, 0.3)",
    "sdiff(plane(), box((0.3, 1, 0.3)).twist(2).at(0, 0.5, 0), k: 0.2)",
];
const SIZE: [u32; 2] = [48, 27];
const CAMERA: &str = "camera { eye: (3, 2, 5), target: (0, 0.3, 0) }";

/// A blend of a twisted column and a plane as a field by hand, with the slope of the column near each point as its own.
const BY_HAND: &str = "\
fn column(p) = { let c = cos(2 * p.y); let s = sin(2 * p.y); (c * p.x + s * p.z, p.y, c * p.z - s * p.x) }
@lipschitz(sqrt(1 + (2 * (length(p.xz) + abs(d))) * (2 * (length(p.xz) + abs(d)))) + 2 * (length(p.xz) + abs(d)))
fn blended() = field {
  let v = abs(column(p)) - (0.3, 1, 0.3);
  smin(min(max(v.x, v.y, v.z), 0) + length(max(v, 0)), p.y + 1, 0.3)
}";

fn judged(definitions: &str, shape: &str) -> Report {
    let text = format!("{CAMERA}\n{definitions}\nscene {{ {shape} }}");
    let scene = scene(shape, &text, &Options { probe: true, certificate: true, ..Options::default() });
    let frame = Frame::new(SIZE[0], SIZE[1]);
    let (certificate, probe) = (scene.certificate.expect("asked for"), scene.probe.expect("asked for"));
    let functions = Functions { map: scene.map, ray: certificate.ray, step: certificate.step };
    let found = interpreted(&scene.program, probe, &frame);
    let picture = Picture { width: SIZE[0] as usize, found: &found, steps: 1 };
    Certifier::new(&scene.program, functions, &frame).judge_picture(&picture, |_| {})
}

#[test]
fn steep_shapes_cost_where_they_are() {
    for shape in SCENES {
        let report = judged("", shape);
        println!(
            "{shape}: {} out of steps, {} undecided",
            report.out_of_steps.count, report.undecided_steps.count
        );
        assert!(report.is_right(), "{shape}: {report:?}");
        assert_eq!(report.wrong_normals.count, 0, "{shape}: {report:?}");
        assert!(report.ambiguous.count * 200 <= report.pixels, "{shape}: {report:?}");
        assert!(report.undecided_steps.count * 50 <= report.pixels, "{shape}: {report:?}");
        assert_eq!(report.out_of_steps.count, 0, "{shape}: {report:?}");
    }
}

/// The slope of a twist grows with the distance from its axis: stepped over it everywhere, rays do not get to the horizon.
#[test]
fn a_slope_that_counts_everywhere_runs_out_of_steps() {
    let report = judged(BY_HAND, "blended()");
    println!("by hand: {} out of steps", report.out_of_steps.count);
    assert!(report.out_of_steps.count * 10 > report.pixels, "{report:?}");
}
