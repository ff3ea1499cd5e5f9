//! What a scene's field says at points is what the scene's own functions compute.

use sdf_ir::Constant;
use sdf_ir::eval::{Tape, run_parallel};
use sdf_lang::Options;
use sdf_tests::scenes::examples;
use sdfc::{Clock, Compiled, Field, Frame, Target};

fn compiled(name: &str, text: &str) -> Compiled {
    let options = Options { query: true, ..Options::default() };
    let compiled = sdfc::compile(name, text, &options, &mut Clock::default());
    assert!(compiled.output.is_some(), "{name}: {:?}", compiled.diagnostics);
    compiled
}

/// Points round the origin, the same at each run.
fn points(count: u32) -> Vec<[f64; 3]> {
    let part =
        |i: u32, k: u32| f64::from(i.wrapping_mul(k).rotate_left(7).wrapping_mul(k) >> 8) / 2f64.powi(24);
    let point = |i: u32| [2_654_435_761, 2_246_822_519, 3_266_489_917].map(|k| 6.0 * part(i + 1, k) - 3.0);
    (0..count).map(point).collect()
}

/// Distances are those of the map, gradients those of finite differences, wherever the field is smooth.
#[test]
fn a_field_is_the_map_of_its_scene() {
    for example in examples() {
        let compiled = compiled(&example.name, &example.text);
        let (scene, _) = compiled.output.as_ref().expect("a scene");
        let mut field = Field::new(&compiled).expect("a field");
        let frame = Frame { time: 0.8, ..Frame::new(1, 1) };
        field.set(&frame);
        let points = points(2000);
        let distances = field.distance(&points);
        let tape = Tape::compile(&scene.program, scene.map.expect("a map"));
        let inputs = [0, 1, 2].map(|k| points.iter().map(|p| p[k]).collect::<Vec<f64>>());
        let mut expected = vec![0.0; points.len()];
        let uniforms = frame.uniforms(&scene.program);
        run_parallel(&tape, &uniforms, &inputs.each_ref().map(Vec::as_slice), &mut [&mut expected]);
        let samples = field.sample(&points);
        let gradients = field.gradient(&points);
        let mut smooth = 0;
        for (i, p) in points.iter().enumerate() {
            let tolerance = 1e-12 * (1.0 + expected[i].abs());
            assert!((distances[i] - expected[i]).abs() <= tolerance, "{}: {p:?}", example.name);
            assert!((samples[i].distance - expected[i]).abs() <= tolerance, "{}: {p:?}", example.name);
            assert!(samples[i].gradient == gradients[i], "{}: {p:?}", example.name);
            smooth += usize::from(has_this_gradient(&field, *p, gradients[i]));
        }
        assert!(smooth * 100 > points.len() * 97, "{}: {smooth} of {}", example.name, points.len());
    }
}

/// Whether finite differences give this gradient, which they do not where the field has an edge.
fn has_this_gradient(field: &Field, p: [f64; 3], gradient: [f64; 3]) -> bool {
    let h = 1e-6;
    (0..3).all(|k| {
        let [mut above, mut below] = [p, p];
        above[k] += h;
        below[k] -= h;
        let d = field.distance(&[above, below]);
        ((d[0] - d[1]) / (2.0 * h) - gradient[k]).abs() < 1e-5
    })
}

#[test]
fn materials_are_those_of_the_surface() {
    let text = "
        param shine = 12 in 1..50
        fn dull(c) = material { color: c, specular: 0, emission: (0, 0.5, 1) }
        scene {
            smin(sphere(1).paint(dull((1, 0, 0))), sphere(1).at(1.5, 0, 0).paint(dull((0, 0, 1))), k: 1),
            box(1).at(0, 10, 0).paint(material { color: abs(n), shininess: shine, glow: (1, 2, 3), glow_radius: 2 }),
        }";
    let mut field = Field::new(&compiled("materials", text)).expect("a field");
    let mut frame = Frame::new(1, 1);
    frame.params.insert("shine".into(), Constant::Float(40.0));
    field.set(&frame);
    let [left, middle, top] = &field.sample(&[[-1.2, 0.0, 0.0], [0.75, 1.0, 0.0], [0.0, 12.0, 0.5]])[..]
    else {
        panic!("a sample for each point")
    };
    assert_eq!((left.material.color, left.material.specular), ([1.0, 0.0, 0.0], 0.0));
    assert_eq!(left.material.emission, [0.0, 0.5, 1.0]);
    // Half way between two balls, half of each.
    let [red, green, blue] = middle.material.color;
    assert!((red - 0.5).abs() < 1e-9 && green == 0.0 && (blue - 0.5).abs() < 1e-9, "{middle:?}");
    assert_eq!((top.distance, top.gradient, top.material.color), (1.0, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]));
    assert_eq!((top.material.shininess, top.material.specular), (40.0, 0.2));
    assert_eq!((top.material.glow, top.material.glow_radius), ([1.0, 2.0, 3.0], 2.0));
    assert_eq!((top.material.reflect, top.material.transmit, top.material.ior), (0.0, 0.0, 1.5));
}

#[test]
fn a_scene_that_is_nothing_has_a_field() {
    let field = Field::new(&compiled("nothing", "scene { }")).expect("a field");
    assert_eq!(field.distance(&[[0.0; 3], [1e6; 3]]), [f64::INFINITY; 2]);
    assert_eq!(field.gradient(&[[0.0; 3]]), [[0.0; 3]]);
    let inside = Field::new(&compiled("all", "scene { !nothing() }")).expect("a field");
    assert_eq!(inside.distance(&[[0.0; 3]]), [f64::NEG_INFINITY]);
}

#[test]
fn who_did_not_ask_or_has_mistakes_has_no_field() {
    let compile = |text: &str, options: &Options| sdfc::compile("a", text, options, &mut Clock::default());
    let asking = Options { query: true, ..Options::default() };
    assert!(Field::new(&compile("scene { sphere(1) }", &Options::default())).is_none());
    assert!(Field::new(&compile("scene { spere(1) }", &asking)).is_none());
}

/// What is asked of a scene is in no text of it.
#[test]
fn no_text_has_a_trace_of_questions() {
    for example in examples() {
        let text = |query: bool| {
            let options = Options { query, ..Options::default() };
            let compiled = sdfc::compile(&example.name, &example.text, &options, &mut sdfc::Clock::default());
            compiled.output.expect("a shader").1.text(Target::Wgsl).expect("a text")
        };
        let (with, without) = (text(true), text(false));
        assert!(!with.contains("query"), "{}", example.name);
        assert_eq!(with, without, "{}", example.name);
    }
}
