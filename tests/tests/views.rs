//! `sdfc render --view`: the views show what the probe and another evaluation tell, on the CPU and on a graphics device,
//! and rays that run out of steps are counted whatever the scene's colours are.

use sdf_ir::FunctionId;
use sdf_ir::eval::{Tape, run_parallel};
use sdf_lang::{Options, Scene, compiler_files};
use sdf_render::image::quantise;
use sdf_render::{Drawn, Frame, Picture, cpu};
use sdf_tests::adapter::adapter;
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
/// How many rays of the others may run out of steps: some that graze.
const GRAZING: usize = 10;

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
        let lost = seen.iter().filter(|s| s.lost).count();
        assert_eq!(lost > GRAZING, i == OUT_OF_STEPS, "{text}: {lost}");
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

/// The field and its gradient at places beside those that rays meet, by the interpreter of doubles: rays meet surfaces
/// so closely that errors would be rounding alone.
#[test]
fn errors_are_those_of_another_evaluation() {
    let text = compiler_files().find(|(name, _)| *name == "view.sdf").expect("the views").1;
    let (met, beside) = ("seen(ray, hit)", "seen(ray, (t: hit.t * 0.999))");
    assert_eq!(text.matches(met).count(), 1);
    let replaced = vec![("view.sdf".to_string(), text.replace(met, beside))];
    let mut compared = 0;
    for text in SCENES {
        let draw = |view| {
            let options = Options { view: Some(view), replaced: replaced.clone(), ..Options::default() };
            let program = sdf_ir::legalise(&scene(text, text, &options).program);
            cpu::render_with(&program, &frame(), false, |_| {}).0.beside
        };
        let depths = draw(View::Depth);
        let expected = errors_at(text, &depths);
        for (i, (error, expected)) in draw(View::Error).into_iter().zip(expected).enumerate() {
            if depths[i] > 0.0 && error > 0.05 {
                let difference = (f64::from(error) - expected).abs();
                assert!(difference <= 0.02 + 0.02 * expected, "{text}, {i}: {error}, {expected}");
                compared += 1;
            }
        }
    }
    assert!(compared > 5000, "{compared} pixels");
}

/// How far the places at these depths are from the surface, to first order and in tolerances.
fn errors_at(text: &str, depths: &[f32]) -> Vec<f64> {
    let options = Options { certificate: true, query: true, ..Options::default() };
    let scene = scene(text, text, &options);
    let (width, count) = (SIZE[0] as usize, depths.len());
    let x = (0..count).map(|i| (i % width) as f64 + 0.5).collect();
    let y = (0..count).map(|i| (count / width - 1 - i / width) as f64 + 0.5).collect();
    let rays = evaluate(&scene, scene.certificate.expect("asked for").ray, &[x, y]);
    let along = |axis: usize| -> Vec<f64> {
        (0..count).map(|i| rays[axis][i] + rays[3 + axis][i] * f64::from(depths[i])).collect()
    };
    let places = [0, 1, 2].map(along);
    let at = evaluate(&scene, scene.query.expect("asked for").gradient, &places);
    let slope = |i: usize| (1..4).map(|k| at[k][i] * at[k][i]).sum::<f64>().sqrt();
    (0..count)
        .map(|i| at[0][i].abs() / (slope(i) * (rays[7][i] + rays[8][i] * f64::from(depths[i]))))
        .collect()
}

fn evaluate(scene: &Scene, function: FunctionId, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let program = legalised(&scene.program, function);
    let tape = Tape::compile(&program, program.entry.expect("a function"));
    let mut results = vec![vec![0.0; columns[0].len()]; tape.output_count()];
    let inputs: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let mut outputs: Vec<&mut [f64]> = results.iter_mut().map(Vec::as_mut_slice).collect();
    run_parallel(&tape, &frame().uniforms(&program), &inputs, &mut outputs);
    results
}

#[test]
fn a_device_draws_and_measures_what_the_cpu_does() {
    let device = || Device::Named(adapter().name().name.clone());
    for text in [SCENES[0], SCENES[OUT_OF_STEPS]] {
        // How far a hit is from the surface is what rounding makes it, so its colours agree nowhere.
        for view in VIEWS.into_iter().chain([View::Picture]).filter(|view| *view != View::Error) {
            let expected = draw(text, Some(view), Device::Cpu, Language::Wgsl);
            for language in [Language::Wgsl, Language::Glsl, Language::SpirV] {
                let found = draw(text, Some(view), device(), language);
                // A ray may take a step more or less.
                let share = if view == View::Steps { 25 } else { 200 };
                let differing = differing(&expected.picture, &found.picture);
                assert!(
                    differing <= (SIZE[0] * SIZE[1]) as usize / share,
                    "{text}, {view:?}, {language:?}: {differing}"
                );
                measure_alike(expected.measured, found.measured);
            }
        }
    }
}

/// How many pixels differ by more than 2 of 255 in a channel.
fn differing(a: &Picture, b: &Picture) -> usize {
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4));
    pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2)).count()
}

fn measure_alike(expected: Option<Measured>, found: Option<Measured>) {
    let [expected, found] = [expected, found].map(|measured| measured.expect("a view"));
    assert_eq!(expected.rays, found.rays);
    assert!(expected.lost.abs_diff(found.lost) <= GRAZING + expected.lost / 100, "{expected:?}, {found:?}");
    assert_eq!(expected.range.is_some(), found.range.is_some());
    if let (Some((a, b)), Some((c, d))) = (expected.range, found.range) {
        assert!((a - c).abs() <= 0.05 * a && (b - d).abs() <= 0.05 * b, "{expected:?}, {found:?}");
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
        let warning = measured.warning(&compiled(text, None).tree);
        assert_eq!(warning.is_some(), lost > 0, "{text}");
    }
    let gpu = Device::Named(adapter().name().name.clone());
    let drawing = draw(MAGENTA, Some(View::Picture), gpu, Language::Wgsl);
    assert_eq!(drawing.measured.map(|measured| measured.lost), Some(0));
}
