//! What effects add to a picture, against their definitions in f64: from the distances and normals that the probe tells of the
//! bare scene, and its colours.

use sdf_ir::eval::{Tape, run_parallel};
use sdf_lang::Options;
use sdf_render::Frame;
use sdf_tests::scenes::{Buffers, Seen, coordinates, legalised, scene};

type Vector = [f64; 3];

const FRAME: [u32; 2] = [80, 45];
/// How far a colour may be from its definition, in linear light: what f32 and the sRGB code do.
const NEAR: f64 = 2e-3;

/// A scene whose colours all lie well below 1, with a sky and a floor that reaches the horizon.
const BARE: &str = "camera { eye: (3, 1.5, 4), target: (0, 0.5, 0), fov: 50deg }
light key { direction: (1, 2, 3), intensity: 0.4, shadow: hard }
ambient { color: 0.05 }
sky { horizon: (0.3, 0.25, 0.2), zenith: (0.02, 0.05, 0.2) }
scene { plane().paint(#a05020), sphere(0.8).at(0, 0.8, 0).paint(#206090), box(0.3).at(1.3, 0.3, 0.4) }";

/// The light that leaves each pixel's surface or sky, as the interpreter draws it: the sRGB code taken back.
fn light(text: &str) -> Vec<Vector> {
    let made = scene("effects", text, &Options { attack: Some(0), ..Options::default() });
    let program = legalised(&made.program, made.program.entry.expect("a pixel"));
    let frame = Frame::new(FRAME[0], FRAME[1]);
    let [x, y] = coordinates(&frame);
    let tape = Tape::compile(&program, program.entry.expect("a pixel"));
    let mut outputs = vec![vec![0.0f32; x.len()]; 3];
    let mut slices: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    run_parallel(&tape, &frame.uniforms(&program), &[&x, &y], &mut slices);
    let decoded = |c: f32| {
        let c = f64::from(c);
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    (0..x.len()).map(|i| [0, 1, 2].map(|k| decoded(outputs[k][i]))).collect()
}

/// What the pixels of a scene show.
fn seen(text: &str) -> Vec<Seen> {
    let options = Options { attack: Some(0), probe: true, ..Options::default() };
    Buffers::of(&scene("effects", text, &options), &Frame::new(FRAME[0], FRAME[1])).pixels
}

/// The directions of the rays of [`BARE`], by its camera's definition.
fn directions() -> Vec<Vector> {
    let (eye, target, half) = ([3.0, 1.5, 4.0], [0.0, 0.5, 0.0], 25f64.to_radians().tan());
    let forward = unit([0, 1, 2].map(|k| target[k] - eye[k]));
    let right = unit(cross(forward, [0.0, 1.0, 0.0]));
    let up = cross(right, forward);
    let [x, y] = coordinates(&Frame::new(FRAME[0], FRAME[1]));
    let (width, height) = (f64::from(FRAME[0]), f64::from(FRAME[1]));
    let direction = |i: usize| {
        let u = (2.0 * f64::from(x[i]) - width) / height * half;
        let v = (2.0 * f64::from(y[i]) - height) / height * half;
        unit([0, 1, 2].map(|k| forward[k] + right[k] * u + up[k] * v))
    };
    (0..x.len()).map(direction).collect()
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Compares a scene, [`BARE`] and some items, with what each pixel must be: from its light without them, what is seen there,
/// and the ray's direction. Returns at how many pixels they differ, and by how much at most.
fn compared(items: &str, wanted: impl Fn(Vector, &Seen, Vector) -> Vector) -> f64 {
    let (bare, seen, directions) = (light(BARE), seen(BARE), directions());
    let found = light(&format!("{items}\n{BARE}"));
    let errors = (0..bare.len()).map(|i| {
        let wanted = wanted(bare[i], &seen[i], directions[i]).map(|x| x.clamp(0.0, 1.0));
        (0..3).map(|k| (wanted[k] - found[i][k]).abs()).fold(0.0, f64::max)
    });
    errors.fold(0.0, f64::max)
}

fn mixed(a: Vector, b: Vector, share: f64) -> Vector {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * share)
}

#[test]
fn fog_takes_light_by_the_way_through_it() {
    let far = 100.0;
    let sky = |d: Vector| mixed([0.3, 0.25, 0.2], [0.02, 0.05, 0.2], d[1].max(0.0));
    let of_sky = |density: f64| {
        move |bare: Vector, seen: &Seen, direction: Vector| match seen.depth {
            t if t < 0.0 => bare,
            t => mixed(bare, sky(direction), 1.0 - (-density * f64::from(t)).exp()),
        }
    };
    for density in [0.01, 0.15, 3.0] {
        let error = compared(&format!("fog {{ density: {density} }}"), of_sky(density));
        assert!(error < NEAR, "of the sky's colour, density {density}: {error}");
        let colored = |bare: Vector, seen: &Seen, _: Vector| {
            let t = if seen.depth < 0.0 { far } else { f64::from(seen.depth) };
            mixed(bare, [0.5, 0.1, 0.4], 1.0 - (-density * t).exp())
        };
        let error = compared(&format!("fog {{ density: {density}, color: (0.5, 0.1, 0.4) }}"), colored);
        assert!(error < NEAR, "of its own colour, density {density}: {error}");
    }
    // A definition with another density is not met.
    assert!(compared("fog { density: 0.15 }", of_sky(0.16)) > 2.0 * NEAR);
}

#[test]
fn rims_shine_where_surfaces_turn_away() {
    let rim = |power: f64| {
        move |bare: Vector, seen: &Seen, direction: Vector| {
            let cosine = -dot(seen.normal.map(f64::from), direction);
            let share = if seen.depth < 0.0 { 0.0 } else { (1.0 - cosine.clamp(0.0, 1.0)).powf(power) };
            [0, 1, 2].map(|k| bare[k] + [0.3, 0.4, 0.1][k] * share)
        }
    };
    for power in [0.5, 3.0, 8.0] {
        let error = compared(&format!("rim {{ color: (0.3, 0.4, 0.1), power: {power} }}"), rim(power));
        assert!(error < NEAR, "power {power}: {error}");
    }
    assert!(compared("rim { color: (0.3, 0.4, 0.1) }", rim(3.2)) > 2.0 * NEAR);
}

#[test]
fn tones_are_mapped_by_the_curve() {
    let curve = |x: f64| x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    let error = compared("render { tonemap: aces }", |bare, _, _| bare.map(curve));
    // The curve is three times as steep as a line.
    assert!(error < 3.0 * NEAR, "{error}");
    // Light above 1, which is clamped without the curve.
    let lamp = |items: &str, x: f64| {
        let text = format!(
            "{items} camera {{ eye: (0, 0, 3), target: 0 }} ambient {{ color: 0 }} light l {{ direction: (1, 0, 0), intensity: 0 }}
             scene {{ box(4).at(0, 0, -4).paint(material {{ color: 0, specular: 0, emission: {x} }}) }}"
        );
        light(&text)[40]
    };
    for x in [0.0, 0.5, 1.0, 2.0, 8.0, 1e3] {
        let [found, ..] = lamp("render { tonemap: aces }", x);
        assert!((found - curve(x).clamp(0.0, 1.0)).abs() < NEAR, "{x}: {found}");
        let [found, ..] = lamp("", x);
        assert!((found - x.min(1.0)).abs() < NEAR, "{x}: {found}");
    }
}
