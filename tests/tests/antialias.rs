//! Antialiasing: against the mean of 256 rays a pixel, and the way that leaves rays out against all of them.

use sdf_ir::FunctionId;
use sdf_ir::eval::{Counts, Tape, run_parallel};
use sdf_lang::Options;
use sdf_render::Frame;
use sdf_tests::light::View;
use sdf_tests::light::vector::{Vector, difference, plus, times};
use sdf_tests::scenes::{Example, coordinates, examples, legalised, scene};

/// The colours of a picture, sRGB from 0 to 1, and what was counted.
fn drawn(example: &Example, options: &Options, size: [u32; 2]) -> (Vec<[f32; 3]>, u64) {
    let options = Options { attack: Some(0), ..options.clone() };
    let made = scene(&example.name, &example.text, &options);
    let program = legalised(&made.program, made.program.entry.expect("a pixel"));
    let frame = Frame::new(size[0], size[1]);
    let [x, y] = coordinates(&frame);
    let tape = Tape::compile_counting(&program, program.entry.expect("a pixel"));
    let mut outputs = vec![vec![0.0f32; x.len()]; 3];
    let mut slices: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    let counts: Counts = run_parallel(&tape, &frame.uniforms(&program), &[&x, &y], &mut slices);
    let rays = program.functions.iter().position(|f| &*f.name == "ray_through").expect("rays from the eye");
    let colors = (0..x.len()).map(|i| [0, 1, 2].map(|k| outputs[k][i])).collect();
    (colors, counts.calls_of(FunctionId(rays as u32)))
}

fn smoothed(example: &Example, samples: u32) -> Example {
    let bare = example.text.replace("antialias: 2, ", "");
    assert!(!bare.contains("antialias"), "{} is antialiased in another way", example.name);
    let setting = format!("antialias: {samples}");
    let text = match bare.split_once("render    {") {
        Some((before, after)) => format!("{before}render {{ {setting}, {after}"),
        None => format!("{bare}\nrender {{ {setting} }}"),
    };
    Example { name: example.name.clone(), text }
}

/// Files of the renderer with which every pixel takes all its rays.
fn in_full() -> Options {
    replaced("antialias.sdf", "< 3 / 255", "< 0")
}

fn replaced(file: &str, from: &str, to: &str) -> Options {
    let text = sdf_lang::compiler_files().find(|(name, _)| *name == file).expect("a file").1;
    assert!(text.contains(from), "{file} has no {from}");
    Options { replaced: vec![(file.to_owned(), text.replace(from, to))], ..Options::default() }
}

/// How many pixels differ by more than two steps of 255, and by how many steps at most.
fn beyond_two_steps(a: &[[f32; 3]], b: &[[f32; 3]]) -> (usize, f32) {
    let apart = a.iter().zip(b).map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs() * 255.0).fold(0.0, f32::max));
    apart.fold((0, 0.0), |(count, most), d| (count + usize::from(d > 2.0), most.max(d)))
}

/// Pixels whose way out differs from the whole, of an example with 16 rays a pixel, and how many rays are taken of how many.
fn left_out(example: &Example, options: &Options) -> (usize, f32, u64, u64) {
    let size = [64, 36];
    let example = smoothed(example, 4);
    let (found, rays) = drawn(&example, options, size);
    let (wanted, all) = drawn(&example, &in_full(), size);
    let (wrong, most) = beyond_two_steps(&found, &wanted);
    (wrong, most, rays, all)
}

#[test]
fn rays_that_are_left_out_would_not_change_the_picture() {
    let (mut few, mut many) = (0, 0);
    for example in examples().into_iter().chain(wires()) {
        let (wrong, most, rays, all) = left_out(&example, &Options::default());
        println!("{}: {rays} of {all} rays, at most {most:.2}/255 apart", example.name);
        assert!(
            wrong == 0,
            "{}: {wrong} pixels are more than 2/255 apart, {most:.2}/255 at most",
            example.name
        );
        (few, many) = (few + rays, many + all);
    }
    println!("{few} of {many}");
    assert!(few * 5 < many * 4, "{few} of {many} rays are taken");
}

/// Wires that are thinner than the grid of a pixel's rays, before a floor of tiles that are smaller than a pixel far away; and
/// before a plain one, on which they throw shadows.
fn wires() -> [Example; 2] {
    let scene = |floor: &str, name: &str| {
        Example {
        name: name.into(),
        text: format!(
            "camera {{ eye: (0, 0.6, 3), target: (0, 0.5, 0), fov: 60deg }}
            material tiles {{ color: checker(p.xz, 0.9, 0.1, 0.2) }}
            light sun {{ direction: (1, 3, 2), shadow: hard }}
            scene {{
              {floor},
              for i in 0..7 {{ segment_cylinder((-2, 0.3 + 0.21 * i, 0), (2, 0.4 + 0.23 * i, 0.3), 0.006).paint(#c03020) }},
            }}"
        ),
    }
    };
    [scene("plane().paint(tiles)", "wires"), scene("plane()", "shadows of wires")]
}

#[test]
fn what_tells_where_all_rays_are_needed_is_needed() {
    for (file, from, to) in [
        ("march.sdf", "(skims || s.skims)", "false"),
        ("hard_shadow.sdf", "met.passed", "false"),
        ("antialias.sdf", "patterned(map, place, normal).pattern > 0", "false"),
        ("antialias.sdf", "seams(map, place, offset / scene.render.tolerance) >= 2", "false"),
        ("antialias.sdf", "< 3 / 255", "< 30 / 255"),
    ] {
        let wrong = |example: Example| left_out(&example, &replaced(file, from, to)).0;
        let die = examples().into_iter().filter(|e| e.name == "die");
        let wrong: usize = wires().into_iter().chain(die).map(wrong).sum();
        assert!(wrong > 0, "{from} → {to}: no pixel is more than 2/255 apart");
    }
}

#[test]
fn pixels_are_the_mean_of_their_parts() {
    const VIEW: View = View { eye: [3.0, 1.6, 4.0], target: [0.0, 0.5, 0.0], fov: 40.0, size: [48, 27] };
    const TEXT: &str = "light sun { direction: (1, 3, 2), shadow: hard }
        sky { horizon: 0.9, zenith: (0.1, 0.2, 0.5) }
        scene { plane().paint(#806040), sphere(0.7).at(-0.5, 0.7, 0).paint(#3070c0), box(0.4).at(0.9, 0.4, 0.3).paint(#f0f0f0) }";
    // Each pixel's 256 parts are pixels of a picture of 16 times its size.
    let with = |settings: &str| format!("render {{ {settings} }} {TEXT}");
    let parts =
        View { size: [48 * 16, 27 * 16], ..VIEW }.light(&with("tolerance: 0.16"), &Options::default());
    let mean = |x: usize, y: usize| -> Vector {
        let parts =
            (0..256).map(|i| parts[(y * 16 + i / 16) * 48 * 16 + x * 16 + i % 16].map(|c| c.clamp(0.0, 1.0)));
        times(parts.fold([0.0; 3], plus), 1.0 / 256.0)
    };
    let apart = |samples: u32| -> (f64, f64) {
        let found = VIEW.light(&with(&format!("tolerance: 0.01, antialias: {samples}")), &Options::default());
        let apart: Vec<f64> = (0..48 * 27).map(|i| difference(found[i], mean(i % 48, i / 48))).collect();
        let squares: f64 = apart.iter().map(|d| d * d).sum();
        ((squares / apart.len() as f64).sqrt(), apart.into_iter().fold(0.0, f64::max))
    };
    let errors = [1, 2, 4, 8].map(apart);
    println!("rms and largest difference from 256 rays with 1, 4, 16 and 64: {errors:.4?}");
    // The grid tells the place of an edge through a pixel to half its spacing, and the parts to half of theirs; the light on both
    // sides differs by 1 at most.
    for (samples, (_, most)) in [1.0, 2.0, 4.0, 8.0].into_iter().zip(errors) {
        assert!(most < 0.5 / samples + 0.5 / 16.0, "{samples} a side: {most}");
    }
    assert!(errors[0].0 > 3.0 * errors[3].0, "one ray is nearly as good as 64");
}
