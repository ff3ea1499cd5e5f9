//! What the intervals say of fields that the language makes: as steep as they are known to be, and no steeper.

use sdf_ir::interval::{Bounds, Sloped, Walker, bounds_of_globals, bounds_of_uniform};
use sdf_lang::Options;

/// The slope of a shape's field over a box.
fn slope(shape: &str, lo: [f64; 3], hi: [f64; 3]) -> f64 {
    let text = format!("let subject = {shape}\nscene {{ subject }}\n");
    let scene = sdf_lang::compile("slope", &text, &Options::default()).scene.expect("a scene");
    let program = scene.program;
    let uniforms: Vec<Bounds> = program.uniforms.iter().map(bounds_of_uniform).collect();
    let globals = bounds_of_globals(&program, &uniforms);
    let map = program.function(scene.map.expect("a field"));
    let mut walker = Walker::<Sloped>::new(&program, map, &uniforms, &globals);
    walker.run(&[Sloped::point(Bounds::between(lo, hi))])[0].norm()
}

fn check(shape: &str, expected: f64) {
    let found = slope(shape, [-2.0; 3], [2.0; 3]);
    assert!(
        found > expected * (1.0 - 1e-9) && found < expected * (1.0 + 1e-9),
        "{shape}: {found} is not {expected}"
    );
}

/// The rotation is by an angle that changes from frame to frame, or along the axis; only the built-in `rotated` knows
/// then that lengths stay.
#[test]
fn a_rotation_is_as_steep_as_what_it_turns() {
    for shape in [
        "box((0.5, 0.8, 0.3)).at(0.3, 0.2, -0.1).rotate((1, 2, 3), 40deg)",
        "box((0.5, 0.8, 0.3)).at(0.3, 0.2, -0.1).rotate((1, 2, 3), time)",
        "box((0.5, 0.8, 0.3)).at(0.3, 0.2, -0.1).rotate_x(time).rotate_y(2 * time)",
        "rect((0.5, 0.8)).at(0.3, 0.2).rotate(time).extrude(0.4)",
        "infinite_in_y.twist(50)",
    ] {
        // A tube about the axis of its twist does not notice it.
        check(&shape.replace("infinite_in_y", "field { length(p.xz) - 0.4 }"), 1.0);
    }
}

/// (a + √(a² + 4)) / 2 for a = rate·r, where r is largest: at the corners of the region.
#[test]
fn a_twist_is_a_shear() {
    let a = 1.1 * 8f64.sqrt();
    check("box((0.5, 0.9, 0.2)).at(0.3, 0.2, -0.1).twist(1.1)", (a + (a * a + 4.0).sqrt()) / 2.0);
}

#[test]
fn what_is_put_together_is_as_steep_as_its_parts() {
    for shape in [
        "cylinder(0.6, 1.2)",
        "rect((0.3, 0.5)).at(0.1, 0.2).revolve(0.9)",
        "box(0.5).at(0.6, 0.2, -0.1) | sphere(0.5)",
        "smin(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.9, 0.2, -0.1), sphere(0.4).at(0, 1, 0.2), k: 0.3)",
        "smax(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1), k: 0.3)",
        "sdiff(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1), k: 0.3)",
        "xor(sphere(0.8), box((0.5, 0.3, 0.4)).at(0.4, 0.2, -0.1))",
        "box(0.5).shell(0.1).round(0.02).scale((1.7, 0.6, 1.1))",
    ] {
        check(shape, 1.0);
    }
}
