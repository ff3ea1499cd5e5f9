//! `sdfc render --view`: the views show what the probe and another evaluation tell, on the CPU and on a graphics device,
//! and rays that run out of steps are counted whatever the scene's colours are.

use sdf_lang::{Options, Scene};
use sdf_render::image::quantise;
use sdf_render::{Drawn, Frame, Picture, cpu};
use sdf_tests::agreement::compare;
use sdf_tests::run::lavapipe;
use sdf_tests::scenes::{Buffers, Seen, legalised, scene};
use sdfc::{Clock, Compiled, Device, Drawing, Language, Measured, View, compile};

const SIZE: [u32; 2] = [160, 90];
const VIEWS: [View; 5] = [View::Depth, View::Normal, View::Steps, View::Error, View::Material];

/// Near and far, steep and empty places, colours that mix; the last has rays that run out of steps.
const SCENES: [&str; 4] = [
    "camera { eye: (3, 2, 4) } scene { box(0.6).twist(2).at(1, 0, 0).paint(#f80), torus(1, 0.2).at(-1, 0.4, 0).paint(#08f), \
     plane().at(0, -1, 0) }",
    "scene { smin(sphere(1).paint(#f00), box(0.7).at(1, 0.3, 0).paint(#0f0), k: 0.3) }",
    "camera { eye: (0.2, 0.1, 0.3), target: (1, 0.2, 0.5) } scene { box(2) - sphere(1.8) }",
    "camera { eye: (3, 2, 4) } render { steps: 14 } scene { box(0.6).twist(2), plane().at(0, -1, 0) }",
];
const OUT_OF_STEPS: usize = 3;

fn compiled(text: &str, view: Option<View>) -> Compiled {
    let compiled = compile("view", text, &Options { view, ..Options::default() }, &mut Clock::default());
    assert_eq!(compiled.diagnostics, [], "{text}");
    compiled
}

fn frame() -> Frame {
    Frame::new(SIZE[0], SIZE[1])
}

/// What the interpreter draws of a scene.
fn drawn(text: &str, view: View) -> Drawn {
    let (_, shader) = compiled(text, Some(view)).output.expect("a scene");
    cpu::render_with(&shader.program, &frame(), false, |_| {}).0
}

fn draw(text: &str, view: Option<View>, device: Device, language: Language) -> Drawing {
    let (_, shader) = compiled(text, view).output.expect("a scene");
    let drawing = shader.draw(&frame(), &device, language, &|_| {}, &mut Clock::default());
    drawing.unwrap_or_else(|error| panic!("{error}"))
}

fn probed(text: &str) -> Vec<Seen> {
    Buffers::of(&scene(text, text, &Options { probe: true, ..Options::default() }), &frame()).pixels
}

fn pixel(picture: &Picture, i: usize) -> [u8; 3] {
    [0, 1, 2].map(|k| picture.rgba[4 * i + k])
}

/// How light a colour looks: the luma of its channels.
fn lightness(color: [u8; 3]) -> f64 {
    let weights = [0.2126, 0.7152, 0.0722];
    color.iter().zip(weights).map(|(channel, weight)| f64::from(*channel) * weight).sum()
}

/// A pixel of each view, where the probe says what the ray does.
fn agrees(seen: &Seen, view: View, color: [u8; 3], measure: f32) -> bool {
    let is_nothing = measure == 0.0 && color == [0.05, 0.07, 0.2].map(quantise);
    match (seen.lost, seen.depth >= 0.0, view) {
        (true, ..) => measure == -1.0 && color == [255, 0, 255],
        (_, _, View::Steps) => measure == seen.steps,
        (_, false, _) => is_nothing,
        (_, true, View::Depth) => measure == seen.depth,
        (_, true, View::Normal) => measure == 1.0 && color == seen.normal.map(|x| quantise(0.5 + 0.5 * x)),
        (_, true, View::Material) => {
            let linear = color.map(|byte| sdf_syntax::token::linear_from_srgb(f64::from(byte) / 255.0));
            measure == 1.0 && linear.iter().zip(seen.color).all(|(a, b)| (a - f64::from(b)).abs() < 0.005)
        }
        (_, true, View::Error) => measure >= 0.0,
        (_, _, View::Picture) => unreachable!("it has no measure"),
    }
}

#[test]
fn views_show_what_the_probe_tells() {
    for (i, text) in SCENES.into_iter().enumerate() {
        let seen = probed(text);
        assert_eq!(seen.iter().any(|s| s.lost), i == OUT_OF_STEPS, "{text}");
        for view in VIEWS {
            let drawn = drawn(text, view);
            for (i, seen) in seen.iter().enumerate() {
                let (color, measure) = (pixel(&drawn.picture, i), drawn.beside[i]);
                assert!(
                    agrees(seen, view, color, measure),
                    "{text}, {view:?}, {i}: {seen:?}, {color:?}, {measure}"
                );
            }
        }
    }
}

/// Farther is darker, and more is lighter.
#[test]
fn colours_are_in_the_order_of_what_they_show() {
    for (view, sign) in [(View::Depth, -1.0), (View::Steps, 1.0), (View::Error, 1.0)] {
        let drawn = drawn(SCENES[0], view);
        let measured = drawn.beside.iter().enumerate().filter(|(_, measure)| **measure > 0.0);
        let mut shown: Vec<(f32, f64)> =
            measured.map(|(i, measure)| (*measure, sign * lightness(pixel(&drawn.picture, i)))).collect();
        shown.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(shown.windows(2).all(|pair| pair[1].1 >= pair[0].1 - 1.0), "{view:?}");
        let (first, last) = (shown[0].1, shown[shown.len() - 1].1);
        assert!(last - first > 40.0, "{view:?}: from {first} to {last}");
    }
}

/// The field and its gradient at the places that the rays have met, by the interpreter of doubles.
#[test]
fn errors_are_those_of_another_evaluation() {
    let mut compared = 0;
    for text in SCENES {
        let options = Options { certificate: true, query: true, ..Options::default() };
        let scene = scene(text, text, &options);
        let (depths, errors) = (drawn(text, View::Depth).beside, drawn(text, View::Error).beside);
        for (i, (depth, error)) in depths.iter().zip(errors).enumerate() {
            // Below that, errors are the rounding of the place.
            if *depth > 0.0 && error > 0.05 {
                let expected = error_at(&scene, i, f64::from(*depth));
                let error = f64::from(error);
                assert!(
                    (error - expected).abs() <= 0.02 + 0.05 * expected,
                    "{text}, {i}: {error}, {expected}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 100, "{compared} pixels");
}

fn error_at(scene: &Scene, pixel: usize, depth: f64) -> f64 {
    let coordinate =
        [(pixel as u32 % SIZE[0]) as f64 + 0.5, (SIZE[1] - 1 - pixel as u32 / SIZE[0]) as f64 + 0.5];
    let [ray, gradient] =
        [scene.certificate.expect("asked for").ray, scene.query.expect("asked for").gradient];
    let ray = evaluate(scene, ray, &coordinate);
    let place: Vec<f64> = (0..3).map(|axis| ray[axis] + ray[3 + axis] * depth).collect();
    let at = evaluate(scene, gradient, &place);
    let slope = (at[1] * at[1] + at[2] * at[2] + at[3] * at[3]).sqrt();
    at[0].abs() / (slope * ray[7] * depth)
}

fn evaluate(scene: &Scene, function: sdf_ir::FunctionId, arguments: &[f64]) -> Vec<f64> {
    let program = legalised(&scene.program, function);
    let tape = sdf_ir::eval::Tape::compile(&program, program.entry.expect("a function"));
    let mut machine = sdf_ir::eval::Machine::<f64>::new(&tape);
    machine.set_uniforms(&frame().uniforms(&program));
    let columns: Vec<[f64; 1]> = arguments.iter().map(|x| [*x]).collect();
    let mut results = vec![[0.0]; tape.output_count()];
    machine.run(
        &columns.iter().map(|c| &c[..]).collect::<Vec<_>>(),
        &mut results.iter_mut().map(|r| &mut r[..]).collect::<Vec<_>>(),
    );
    results.into_iter().map(|[x]| x).collect()
}

#[test]
fn a_device_draws_and_measures_what_the_cpu_does() {
    let device = || Device::Named(lavapipe().name().name.clone());
    for text in [SCENES[0], SCENES[OUT_OF_STEPS]] {
        let buffers =
            Buffers::of(&scene(text, text, &Options { probe: true, ..Options::default() }), &frame());
        // How far a hit is from the surface is what rounding makes it, so its colours agree nowhere.
        for view in VIEWS.into_iter().chain([View::Picture]).filter(|view| *view != View::Error) {
            let expected = draw(text, Some(view), Device::Cpu, Language::Wgsl);
            for language in [Language::Wgsl, Language::Glsl, Language::SpirV] {
                let found = draw(text, Some(view), device(), language);
                let agreement = compare(&expected.picture, &found.picture, &buffers);
                let differing = agreement.differing;
                assert!(differing <= agreement.pixels / 200, "{text}, {view:?}, {language:?}: {differing}");
                measure_alike(expected.measured, found.measured);
            }
        }
    }
}

fn measure_alike(expected: Option<Measured>, found: Option<Measured>) {
    let [expected, found] = [expected, found].map(|measured| measured.expect("a view"));
    assert_eq!(expected.rays, found.rays);
    assert!(expected.lost.abs_diff(found.lost) <= expected.lost / 100, "{expected:?}, {found:?}");
    assert_eq!(expected.range.is_some(), found.range.is_some());
    if let (Some((a, b)), Some((c, d))) = (expected.range, found.range) {
        assert!((a - c).abs() <= 0.02 * a && (b - d).abs() <= 0.02 * b, "{expected:?}, {found:?}");
    }
}

/// The picture that is drawn with a count is the one that the text draws, and the count is the probe's; a magenta
/// surface is not counted.
#[test]
fn rays_that_ran_out_of_steps_are_counted() {
    const MAGENTA: &str =
        "sky { color: #f0f } scene { sphere(1).paint(material { color: #000, emission: #f0f }) }";
    for text in SCENES.into_iter().chain([MAGENTA, "scene { }"]) {
        let drawing = draw(text, Some(View::Picture), Device::Cpu, Language::Wgsl);
        let plain = draw(text, None, Device::Cpu, Language::Wgsl);
        assert_eq!((drawing.picture, plain.measured), (plain.picture, None), "{text}");
        let lost = probed(text).iter().filter(|seen| seen.lost).count();
        let measured = drawing.measured.expect("a count");
        assert_eq!((measured.rays, measured.lost), (160 * 90, lost), "{text}");
        assert_eq!(lost > 0, text == SCENES[OUT_OF_STEPS], "{text}");
        let warning = measured.warning(&compiled(text, None).tree);
        assert_eq!(warning.is_some(), lost > 0, "{text}");
    }
    let gpu = Device::Named(lavapipe().name().name.clone());
    let drawing = draw(MAGENTA, Some(View::Picture), gpu, Language::Wgsl);
    assert_eq!(drawing.measured.map(|measured| measured.lost), Some(0));
}
