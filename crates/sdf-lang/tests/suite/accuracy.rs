//! What trades accuracy for time: presets, settings beside them, and what is varied to be measured.

use crate::scene::{compile, scene};
use sdf_ir::eval::{Tape, run_parallel};
use sdf_ir::number::Number;
use sdf_ir::{Constant, Role};
use sdf_lang::{Accuracy, Coordinates, Correction, Normals, Options, Quality, Scene};
use std::path::Path;

/// A scene compiled with options that leave promises untried.
fn with(text: &str, options: Options) -> Scene {
    let compilation = sdf_lang::compile("scene.sdf", text, &Options { attack: Some(0), ..options });
    let scene = compilation.scene.unwrap_or_else(|| panic!("{:#?}\nin\n{text}", compilation.diagnostics));
    assert_eq!(sdf_ir::verify(&scene.program), Ok(()), "in\n{text}");
    scene
}

fn with_accuracy(text: &str, accuracy: Accuracy) -> Scene {
    with(text, Options { accuracy: Some(accuracy), ..Options::default() })
}

/// The accuracy of a scene with this block `render`.
fn accuracy_of(render: &str) -> Accuracy {
    scene(&format!("{render} scene {{ sphere(1) }}")).accuracy
}

/// An accuracy of which no field is that of a preset.
fn odd() -> Accuracy {
    Accuracy {
        tolerance: 0.7,
        steps: 77,
        relax: false,
        normals: Normals::Central,
        shadow_accuracy: 0.033,
        occlusion_samples: 7,
        antialias: 3,
        ..Accuracy::default()
    }
}

/// All examples, by their names.
fn examples() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|extension| extension == "sdf"));
    let mut all: Vec<(String, String)> = scenes
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(path).unwrap())
        })
        .collect();
    all.sort();
    assert!(all.len() > 5, "{} examples", all.len());
    all
}

#[test]
fn each_preset_is_at_least_as_accurate_as_the_one_before() {
    let rank = |normals| Normals::ALL.iter().position(|kind| *kind == normals);
    for pair in Quality::ALL.windows(2) {
        let [coarse, fine] = [pair[0].accuracy(), pair[1].accuracy()];
        let holds = [
            fine.tolerance <= coarse.tolerance,
            fine.steps >= coarse.steps,
            // The first is the gradient itself.
            (rank(fine.normals) == Some(0)) >= (rank(coarse.normals) == Some(0)),
            fine.shadow_accuracy <= coarse.shadow_accuracy,
            fine.occlusion_samples >= coarse.occlusion_samples,
            fine.antialias >= coarse.antialias,
            fine != coarse,
            (fine.correction, fine.coordinates) == (Correction::Derived, Coordinates::Chosen),
        ];
        assert_eq!(holds, [true; 8], "{coarse:?} {fine:?}");
    }
    assert_eq!(Quality::Balanced.accuracy(), Accuracy::default());
    assert_eq!(accuracy_of(""), Accuracy::default());
}

#[test]
fn a_preset_sets_what_the_file_does_not() {
    for quality in Quality::ALL {
        let word = quality.word();
        assert_eq!(accuracy_of(&format!("render {{ quality: {word} }}")), quality.accuracy(), "{word}");
        let all = odd();
        for (i, (name, value)) in all.fields().into_iter().enumerate() {
            let before = accuracy_of(&format!("render {{ {name}: {value}, quality: {word} }}"));
            let behind = accuracy_of(&format!("render {{ quality: {word}, {name}: {value} }}"));
            assert_eq!(before, behind, "{name} with {word}");
            for (k, field) in before.fields().into_iter().enumerate() {
                let wanted = if k == i { all } else { quality.accuracy() };
                assert_eq!(field, wanted.fields()[k], "{name} with {word}");
            }
        }
    }
}

#[test]
fn a_preset_from_outside_stands_for_that_of_the_file() {
    let given = |quality| Options { quality: Some(quality), ..Options::default() };
    let text = "render { quality: draft, steps: 77 } scene { sphere(1) }";
    let fine = with(text, given(Quality::Fine));
    assert_eq!(fine.accuracy, Accuracy { steps: 77, ..Quality::Fine.accuracy() });
    assert_eq!(with("scene { sphere(1) }", given(Quality::Draft)).accuracy, Quality::Draft.accuracy());
    let all = Options { accuracy: Some(odd()), ..given(Quality::Fine) };
    assert_eq!(with(text, all).accuracy, odd());
    let settings = |scene: &Scene| scene.summary.settings[0].clone();
    assert_eq!((settings(&fine), settings(&scene(text))), ("quality fine".into(), "quality draft".into()));
    assert!(settings(&with_accuracy(text, odd())).starts_with("tolerance"));
}

#[test]
fn a_word_that_is_no_preset_is_one_mistake() {
    let compilation = compile("render { quality: finest, steps: 9 } scene { sphere(1) }", &[]);
    assert_eq!(compilation.diagnostics.len(), 1, "{:?}", compilation.diagnostics);
}

#[test]
fn an_accuracy_reads_as_the_block_that_says_so() {
    let presets = Quality::ALL.map(Quality::accuracy);
    let tiny = Accuracy { tolerance: 0.0001, shadow_accuracy: 0.0001, ..odd() };
    let tetrahedron = Accuracy { normals: Normals::Tetrahedron, ..odd() };
    for accuracy in presets.into_iter().chain([odd(), tiny, tetrahedron]) {
        assert_eq!(accuracy_of(&accuracy.to_string()), accuracy, "{accuracy}");
    }
}

/// The settings that a scene's text has as constants.
fn constants(text: &str) -> Vec<String> {
    let is_setting = |uniform: &&sdf_ir::Uniform| uniform.role == Role::Setting;
    let mut names: Vec<String> =
        scene(text).program.uniforms.iter().filter(is_setting).map(|u| u.name.to_string()).collect();
    names.sort();
    names
}

#[test]
fn a_setting_is_a_constant_only_where_something_uses_it() {
    let light = |shadow: &str| format!("light a {{ direction: (1, 2, 3), shadow: {shadow} }} ");
    let ball = "scene { box(1) }";
    assert_eq!(constants("scene { }"), [""; 0]);
    assert_eq!(constants(&(light("none") + ball)), ["far", "steps", "tolerance"]);
    assert_eq!(constants(&(light("hard") + ball)), ["far", "steps", "tolerance"]);
    assert_eq!(constants(&(light("soft(8)") + ball)), ["far", "shadow_accuracy", "steps", "tolerance"]);
    let occluded = light("none") + "ambient { occlusion: 1 } " + ball;
    assert_eq!(constants(&occluded), ["far", "occlusion_samples", "steps", "tolerance"]);
}

#[test]
fn every_correction_and_all_coordinates_make_a_scene_of_each_example() {
    for (name, text) in examples() {
        let plain = Accuracy::default();
        let derived = with_accuracy(&text, plain);
        let half = with_accuracy(&text, Accuracy { correction: Correction::Factor(0.5), ..plain });
        assert_ne!(half.program.to_string(), derived.program.to_string(), "{name}");
        let place = derived.effects.iter().position(|effect| effect.name == "step correction");
        let uncorrected = Options {
            accuracy: Some(plain),
            left_out: place.into_iter().filter(|place| derived.effects[*place].is_in).collect(),
            ..Options::default()
        };
        let whole = with_accuracy(&text, Accuracy { correction: Correction::Factor(1.0), ..plain });
        assert_eq!(whole.program.to_string(), with(&text, uncorrected).program.to_string(), "{name}");
        let world = with_accuracy(&text, Accuracy { coordinates: Coordinates::World, ..plain });
        assert_eq!(world.origin, [0.0; 3], "{name}");
        with_accuracy(&text, Accuracy { coordinates: Coordinates::Camera, ..plain });
    }
}

/// How far away what a picture of 32x18 shows is, by numbers of this size.
fn depths<N: Number>(scene: &Scene) -> Vec<f64> {
    let probe = scene.probe.expect("it was asked for");
    let tape = Tape::compile(&scene.program, probe);
    let sized = |uniform: &sdf_ir::Uniform| match uniform.role {
        Role::Resolution => Constant::Vec2([32.0, 18.0]),
        _ => uniform.default,
    };
    let uniforms: Vec<Constant> = scene.program.uniforms.iter().map(sized).collect();
    let column = |at: &dyn Fn(usize) -> usize| -> Vec<N> {
        (0..32 * 18).map(|i| N::from_f64(at(i) as f64 + 0.5)).collect()
    };
    let (x, y) = (column(&|i| i % 32), column(&|i| i / 32));
    let mut columns = vec![vec![N::from_f64(0.0); x.len()]; tape.output_count()];
    let mut slices: Vec<&mut [N]> = columns.iter_mut().map(|column| &mut column[..]).collect();
    run_parallel(&tape, &uniforms, &[&x, &y], &mut slices);
    columns[0].iter().map(|depth| depth.to_f64()).collect()
}

/// The middle error of depths in `f32` of what both sizes of numbers show.
fn depth_error(text: &str, coordinates: Coordinates) -> f64 {
    let accuracy = Some(Accuracy { coordinates, ..Accuracy::default() });
    let scene = with(text, Options { accuracy, probe: true, ..Options::default() });
    let (single, double) = (depths::<f32>(&scene), depths::<f64>(&scene));
    let both = single.iter().zip(&double).filter(|(a, b)| **a > 0.0 && **b > 0.0);
    let mut errors: Vec<f64> = both.map(|(a, b)| (a - b).abs()).collect();
    assert!(errors.len() > 100, "{} pixels show something", errors.len());
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

#[test]
fn coordinates_from_the_origin_lose_digits_far_away() {
    let far = "camera { eye: (1000003, 2, 4), target: (1000000, 0, 0) }
        scene { sphere(1.5).at(1000000, 0, 0), box(0.4).at(1000000.5, 1.5, 0.5) }";
    let [world, chosen, camera] =
        [Coordinates::World, Coordinates::Chosen, Coordinates::Camera].map(|from| depth_error(far, from));
    println!("from the origin {world}, as chosen {chosen}, from the camera {camera}");
    assert!(world > 1e-3 && world > 100.0 * chosen.max(camera), "{world} {chosen} {camera}");
    // Near the origin there is nothing to choose.
    let near = "camera { eye: (3, 2, 4) } scene { sphere(1) }";
    let origin = |coordinates| with_accuracy(near, Accuracy { coordinates, ..Accuracy::default() }).origin;
    assert_eq!(origin(Coordinates::Chosen), [0.0; 3]);
    assert_eq!(origin(Coordinates::Camera), [3.0, 2.0, 4.0]);
}
