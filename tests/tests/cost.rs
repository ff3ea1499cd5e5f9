//! Whether measuring a scene against the truth tells good from bad: what is known to be worse must come out worse, and the truth must
//! be what the language says. Pictures are small, and times are taken of two settings alone.

use sdf_lang::{Accuracy, Correction, Normals, Options, Quality};
use sdf_render::Frame;
use sdf_tests::light::vector::{difference, dot, plus, times, unit};
use sdf_tests::light::{Field, Light, Vector, View, definition};
use sdf_tests::scenes::{GALLERY, all_examples};
use sdfc::tradeoff::{Errors, Knob, NEAR, Row, Session, Setting, Stopwatch, Subject, Tradeoffs};
use sdfc::{Clock, Device};
use std::time::Duration;

/// How far rays go where a scene says nothing.
const FAR: f64 = 100.0;
/// Below this cosine the light of a surface says too little about its shadow.
const FACING: f64 = 0.05;

const VIEW: View = View { eye: [3.0, 2.5, 4.0], target: [0.1, 0.4, 0.0], fov: 40.0, size: [48, 27] };

/// A scene measured with these accuracies, and no times taken.
fn measured(text: &str, options: &Options, size: [u32; 2], accuracies: &[Accuracy]) -> Tradeoffs {
    timed(text, options, size, accuracies, None)
}

fn timed(
    text: &str,
    options: &Options,
    [width, height]: [u32; 2],
    accuracies: &[Accuracy],
    budget: Option<Duration>,
) -> Tradeoffs {
    let named = |(i, accuracy): (usize, &Accuracy)| Setting {
        name: format!("{i}"),
        knob: Knob::Preset,
        accuracy: *accuracy,
        preset: None,
        is_own: i == 0,
    };
    let settings: Vec<Setting> = accuracies.iter().enumerate().map(named).collect();
    let frame = Frame::new(width, height);
    let stopwatch =
        budget.map(|budget| Stopwatch { device: &Device::Cpu, frame: &frame, budget, enough: None });
    let subject = Subject { name: "cost", text, options };
    let session = Session::new(subject, frame.clone(), NEAR);
    let made = session.measure(&settings, stopwatch.as_ref(), &|_| {}, &mut Clock::default());
    let made = made.unwrap_or_else(|error| panic!("{error:?}\n{text}"));
    assert!(made.rows.iter().all(|row| !row.is_again), "each is another program");
    made
}

fn errors_of(text: &str, options: &Options, accuracies: &[Accuracy]) -> Vec<Errors> {
    let made = measured(text, options, VIEW.size, accuracies);
    made.rows.iter().map(|row| row.errors).collect()
}

/// One of the renderer's files with a part of it replaced, which must be there.
fn broken(file: &str, original: &str, from: &str, to: &str) -> Options {
    assert!(original.contains(from), "{file} has no `{from}`");
    Options { replaced: vec![(file.to_owned(), original.replace(from, to))], ..Options::default() }
}

const TRUTH: &str = include_str!("../../crates/sdf-lang/runtime/truth.sdf");
const PIXEL: &str = include_str!("../../crates/sdf-lang/runtime/pixel.sdf");

/// How many pixels show what is not there, or do not show what is.
fn wrong(errors: &Errors) -> usize {
    errors.false_hits + errors.false_misses
}

#[test]
fn steps_without_correction_are_worse_the_more_a_box_is_twisted() {
    let mut before = Vec::new();
    for twist in [2.0, 4.0, 8.0] {
        let text = VIEW.block()
            + &format!(
                "light key {{ direction: (2, 3, 1) }} scene {{ box((0.5, 1, 0.15)).twist({twist}).at(0, 0.5, 0) }}"
            );
        let bare = Accuracy { correction: Correction::Factor(1.0), ..Accuracy::default() };
        let made = measured(&text, &Options::default(), [64, 36], &[Accuracy::default(), bare]);
        let errors: Vec<Errors> = made.rows.iter().map(|row| row.errors).collect();
        println!("twist {twist}: {:?}\n  {:?}", errors[0], errors[1]);
        assert_eq!(wrong(&errors[0]), 0, "twist {twist}: {:?}", errors[0]);
        before.push(errors[1]);
    }
    let grows = |a: &Errors, b: &Errors| wrong(a) < wrong(b) && a.depth[1] < b.depth[1] && a.rms < b.rms;
    assert!(before[0].rms > 1.0 && wrong(&before[0]) > 0, "{before:?}");
    assert!(before.windows(2).all(|pair| grows(&pair[0], &pair[1])), "{before:?}");
}

/// A field that is steeper than is promised is stepped through: also by the truth, which the certifier then corrects.
#[test]
fn a_false_promise_shows() {
    let errors = [0.5, 2.0, 6.0].map(|slope| {
        let text = VIEW.block()
            + &format!(
                "@lipschitz(1) let steep = field {{ {slope} * (length(p) - 0.8 + 0.1 * sin(9 * p.y)) }}
                 light key {{ direction: (2, 3, 1) }} scene {{ steep.at(0, 0.4, 0) }}"
            );
        errors_of(&text, &Options::default(), &[Accuracy::default()])[0]
    });
    for errors in &errors {
        println!("{errors:?}");
        assert_eq!(errors.undecided, 0, "{errors:?}");
    }
    assert_eq!(wrong(&errors[0]), 0, "{:?}", errors[0]);
    assert!(wrong(&errors[1]) > 5 && wrong(&errors[2]) > wrong(&errors[1]), "{errors:?}");
}

#[test]
fn normals_are_worse_the_farther_apart_their_samples_are() {
    let text = VIEW.block()
        + "light key { direction: (2, 3, 1) }
           scene { torus(0.6, 0.2).rotate_x(0.6).at(0, 0.6, 0), sphere(0.3).at(-0.9, 0.4, 0.6) }";
    let original = "max(footprint(scene, ray, t) * 0.5 / render.tolerance, 64 * rounding_at(ray, t))";
    let central = Accuracy { normals: Normals::Central, ..Quality::Exact.accuracy() };
    let errors = [1e-3, 1e-2, 1e-1].map(|h| {
        let options = broken("pixel.sdf", PIXEL, original, &format!("{h}"));
        errors_of(&text, &options, &[central])[0]
    });
    for errors in &errors {
        println!("{errors:?}");
    }
    // The error of differences grows with the square of what they are taken over; below that is rounding.
    let median = errors.map(|errors| errors.normal[0]);
    assert!(median[1] > 2.0 * median[0] && median[2] > 30.0 * median[1], "{median:?}");
    assert!(errors.windows(2).all(|pair| pair[0].normal[1] < pair[1].normal[1]), "{errors:?}");
}

#[test]
fn a_coarser_tolerance_is_farther_off() {
    let text = VIEW.block()
        + "light key { direction: (2, 3, 1), shadow: hard }
           scene { plane(), box(0.4).rotate_y(0.4).at(0.3, 0.4, 0), sphere(0.5).at(-0.9, 0.5, 0.3) }";
    let with = |tolerance: f64| Accuracy { tolerance, ..Accuracy::default() };
    let errors = errors_of(&text, &Options::default(), &[with(0.1), with(1.0), with(10.0)]);
    for (errors, tolerance) in errors.iter().zip([0.1, 1.0, 10.0]) {
        println!("{errors:?}");
        assert!(errors.depth[2] <= tolerance, "a hit is as near as is said: {errors:?}");
    }
    let grows = |a: &Errors, b: &Errors| a.depth[1] * 3.0 < b.depth[1] && a.rms < b.rms;
    assert!(errors.windows(2).all(|pair| grows(&pair[0], &pair[1])), "{errors:?}");
}

/// A step of 0.3 of the distance takes 1 / 0.3 = 3.3 as many steps in the open. Near a surface it takes more, for the distance
/// falls by 0.3 with each, and not at once; and evaluations that are no steps, of normals and of the first sample, stay as many.
/// The times of small pictures are also those of all that is no evaluation.
#[test]
fn a_blanket_factor_costs_its_steps() {
    let text = VIEW.block()
        + "light key { direction: (2, 3, 1) } ambient { color: 0.2 }
           scene { box(0.4).rotate_y(0.4).at(0.3, 0.4, 0), sphere(0.5).at(-0.9, 0.5, 0.3), torus(1.2, 0.1) }";
    let plain = Accuracy { relax: false, ..Accuracy::default() };
    let small = Accuracy { correction: Correction::Factor(0.3), ..plain };
    let made = timed(&text, &Options::default(), [128, 72], &[plain, small], Some(Duration::from_secs(2)));
    for row in &made.rows {
        println!("{} {} {:?} {:?}", row.evaluations, row.steps, row.time, row.errors);
    }
    let [plain, small] = &made.rows[..] else { unreachable!("two are asked for") };
    let (evaluations, steps) = (small.evaluations / plain.evaluations, small.steps / plain.steps);
    assert!((2.0..3.3).contains(&evaluations), "{evaluations}");
    assert!((3.0..4.5).contains(&steps), "{steps}");
    let time = small.time.expect("there is time for two").ratio[1];
    assert!(
        time > 1.2 && time < 1.5 * evaluations,
        "{time} times as long for {evaluations} times the evaluations"
    );
    // Hits of smaller steps are no nearer, and what is off for other reasons stays off.
    assert!(small.errors.depth[1] > 0.8 * plain.errors.depth[1], "{:?}", small.errors);
    assert!(small.errors.rms > 0.8 * plain.errors.rms, "{:?}", small.errors);
}

/// The gallery is too large a scene for a picture of the same size, and for intervals: it is taken for true as it is computed.
#[test]
fn examples_are_exact_and_decided() {
    for example in all_examples() {
        let is_gallery = example.name == GALLERY;
        let size = if is_gallery { [32, 18] } else { [64, 36] };
        let made = measured(&example.text, &Options::default(), size, &[Quality::Exact.accuracy()]);
        let Row { errors, .. } = &made.rows[0];
        println!("{}: {errors:?}", example.name);
        assert_eq!((errors.false_hits, errors.false_misses), (0, 0), "{}: {errors:?}", example.name);
        assert!(errors.undecided <= made.truth.pixels() / 200, "{}: {errors:?}", example.name);
        assert_eq!(made.truth.is_proved, !is_gallery, "{}", example.name);
    }
}

#[test]
fn measuring_twice_gives_the_same() {
    let text = VIEW.block()
        + "light key { direction: (2, 3, 1), shadow: soft(8) } scene { plane(), sphere(0.5).at(0, 0.4, 0).twist(1) }";
    let of = || {
        let settings =
            [Accuracy::default(), Accuracy { antialias: 2, tolerance: 1.0, ..Accuracy::default() }];
        let made = measured(&text, &Options::default(), [48, 27], &settings);
        format!("{:?}", (&made.truth.colors, &made.truth.depths, &made.truth.decided, &made.rows))
    };
    assert_eq!(of(), of());
}

/// A place of the surface that the truth shows.
struct Place {
    place: Vector,
    normal: Vector,
    /// The colour's red, in linear light.
    red: f64,
}

/// What the truth about a scene shows of its surface, but on edges, where the normal next to a place may be another one.
fn shown(text: &str, options: &Options) -> Vec<Place> {
    let made = measured(&(VIEW.block() + text), options, VIEW.size, &[Accuracy::default()]);
    let field = Field::of(text);
    let mut probe = field.probe();
    let directions = VIEW.directions();
    let truth = &made.truth;
    let hits = (0..truth.depths.len()).filter(|i| truth.depths[*i] >= 0.0);
    let places = hits.filter_map(|i| {
        let place = plus(VIEW.eye, times(directions[i], truth.depths[i]));
        let normal = unit(probe.gradient(place));
        let is_same = difference(normal, truth.normals[i]) < 1e-6;
        is_same.then_some(Place { place, normal, red: truth.colors[i][0] })
    });
    places.collect()
}

/// Where the truth about a scene of one light says that light may arrive: the place, and what arrives for each unit of the cosine.
fn lit(text: &str, light: Light, options: &Options) -> Vec<(Vector, f64)> {
    let arrives = shown(text, options).into_iter().filter_map(|at| {
        let facing = dot(at.normal, light.from(at.place, FAR).0);
        (facing > FACING).then_some((at.place, at.red / facing))
    });
    arrives.collect()
}

fn scene_of(light: Light, shadow: &str, shapes: &str) -> String {
    format!(
        "light key {{ {}, shadow: {shadow} }} ambient {{ color: 0 }}
         scene {{ ({shapes}).paint(material {{ color: 1, specular: 0 }}) }}",
        light.setting()
    )
}

/// The shapes that shadows are cast by: distances and bounds, a steep field, a floor.
const CASTERS: &str =
    "plane() | sphere(0.4).at(-0.7, 0.5, 0.2) | (box(0.35) - sphere(0.42)).at(0.4, 0.35, 0.1)
    | box((0.2, 0.5, 0.12)).twist(2).at(0.9, 0.5, -0.6)";

/// The most and how many in all are farther than `near` from what is wanted.
fn off(pairs: impl Iterator<Item = (f64, f64)>, near: f64) -> (f64, usize, usize) {
    let errors: Vec<f64> = pairs.map(|(found, wanted)| (found - wanted).abs()).collect();
    let above = errors.iter().filter(|error| **error > near).count();
    (errors.iter().copied().fold(0.0, f64::max), above, errors.len())
}

#[test]
fn soft_shadows_of_the_truth_are_their_definition() {
    let twin = broken("truth.sdf", TRUTH, "max(free, 0.004 * s.t)", "max(free, 2 * s.t)");
    for (light, k) in [(Light::Sun([2.0, 2.5, 1.0]), 8.0), (Light::Lamp([0.6, 1.9, 0.9]), 24.0)] {
        let text = scene_of(light, &format!("soft({k})"), CASTERS);
        let field = Field::of(&text);
        let of = |options: &Options| {
            let lit = lit(&text, light, options);
            let places: Vec<Vector> = lit.iter().map(|(place, _)| *place).collect();
            let wanted = definition::soft_shadows(&mut field.probe(), &places, light, FAR, k);
            off(lit.iter().map(|(_, found)| *found).zip(wanted), 0.005)
        };
        let (found, twin) = (of(&Options::default()), of(&twin));
        println!("soft {k}: {found:?}, twin {twin:?}");
        assert!(found.0 <= 0.005 && found.2 > 800, "soft {k}: {found:?}");
        assert!(twin.0 > 0.03, "the twin: {twin:?}");
    }
}

/// Whether a ray is free as far as `reach`, by steps that are a thousandth at least; none where it passes something closely.
fn is_free(
    field: &mut sdf_tests::light::field::Probe,
    place: Vector,
    way: Vector,
    reach: f64,
) -> Option<bool> {
    let mut t = 0.02;
    let mut least = f64::INFINITY;
    while t < reach {
        let d = field.at(plus(place, times(way, t)));
        if d < -2e-3 {
            return Some(false);
        }
        least = d.min(least);
        t += (d / 4.0).max(1e-3);
    }
    (least > 2e-3).then_some(true)
}

#[test]
fn hard_shadows_of_the_truth_are_their_definition() {
    let twin = broken("truth.sdf", TRUTH, "s.t + max(s.at.stride,", "s.t + max(8 * s.at.stride,");
    let light = Light::Sun([2.0, 1.5, 1.0]);
    let text = scene_of(light, "hard", CASTERS);
    let field = Field::of(&text);
    let of = |options: &Options| {
        let mut probe = field.probe();
        let pairs = lit(&text, light, options).into_iter().filter_map(|(place, found)| {
            let (way, reach) = light.from(place, FAR);
            is_free(&mut probe, place, way, reach).map(|free| (found, f64::from(u8::from(free))))
        });
        off(pairs, 0.005)
    };
    let (found, twin) = (of(&Options::default()), of(&twin));
    println!("hard: {found:?}, twin {twin:?}");
    assert!(found.0 <= 1e-6 && found.2 > 800, "{found:?}");
    assert!(twin.1 > twin.2 / 50, "the twin: {twin:?}");
}

#[test]
fn occlusion_of_the_truth_is_its_definition() {
    let twin = broken("truth.sdf", TRUTH, "let samples = 256;", "let samples = 3;");
    let text = format!(
        "light dark {{ direction: (1, 2, 3), intensity: 0 }} ambient {{ color: 0.9, occlusion: 1, radius: 0.5 }}
         scene {{ ({CASTERS}).paint(material {{ color: 1, specular: 0 }}) }}"
    );
    let field = Field::of(&text);
    let of = |options: &Options| {
        let mut probe = field.probe();
        let pairs = shown(&text, options).into_iter().map(|at| {
            let wanted = definition::occlusion(&mut probe, at.place, at.normal, 1.0, 0.5);
            (at.red / 0.9, wanted)
        });
        off(pairs, 0.001)
    };
    let (found, twin) = (of(&Options::default()), of(&twin));
    println!("occlusion: {found:?}, twin {twin:?}");
    assert!(found.0 <= 1e-4 && found.2 > 800, "{found:?}");
    assert!(twin.1 > twin.2 / 50, "the twin: {twin:?}");
}

#[test]
fn glow_of_the_truth_is_its_definition() {
    const AMOUNT: f64 = 0.3;
    let twin = broken("truth.sdf", TRUTH, "width / 64)", "width)");
    let shape = "(torus(0.7, 0.03).rotate_x(0.7) | sphere(0.2).at(-0.5, 0.2, 0.4)).at(0, 0.6, 0)";
    let text = format!(
        "light dark {{ direction: (1, 2, 3), intensity: 0 }} ambient {{ color: 0 }} sky {{ color: 0 }}
         scene {{ {shape}.paint(material {{ color: 0, specular: 0, glow: {AMOUNT}, glow_radius: 0.3 }}),
         box(0.3).at(0.4, 0.3, 0.5).paint(material {{ color: 0, specular: 0 }}) }}"
    );
    let field = Field::of(&format!("scene {{ {shape} }}"));
    let directions = VIEW.directions();
    let of = |options: &Options| {
        let made = measured(&(VIEW.block() + &text), options, VIEW.size, &[Accuracy::default()]);
        let mut probe = field.probe();
        let pairs = (0..directions.len()).map(|i| {
            let depth = made.truth.depths[i];
            let limit = if depth < 0.0 { FAR } else { depth };
            let wanted = definition::glow(&mut probe, VIEW.eye, directions[i], limit, 0.3);
            (made.truth.colors[i][0] / AMOUNT, wanted.min(1.0 / AMOUNT))
        });
        off(pairs.collect::<Vec<_>>().into_iter(), 0.002)
    };
    let (found, twin) = (of(&Options::default()), of(&twin));
    println!("glow: {found:?}, twin {twin:?}");
    assert!(found.0 <= 1e-4 && found.2 > 800, "{found:?}");
    assert!(twin.1 > twin.2 / 50, "the twin: {twin:?}");
}
