//! What lights, shadows, occlusion and glow make of a picture, against their definitions in `f64`; and naive twins, which the
//! definitions must tell from the compiler's own.
//!
//! Shadows' edges and creases are judged like all else, but for hits that have not the normal of the place next to them.

use rayon::prelude::*;
use sdf_lang::Options;
use sdf_render::Frame;
use sdf_tests::hard::{Certified, Fixture};
use sdf_tests::light::vector::{difference, dot, minus, plus, scaled, times, unit};
use sdf_tests::light::{Field, Light, Place, Vector, View, definition, twin};
use sdf_tests::scenes::{Buffers, Seen, scene};

/// How far rays go where a scene says nothing.
const FAR: f64 = 100.0;
/// Below this cosine the light of a surface says too little about its shadow.
const FACING: f64 = 0.02;

const VIEW: View = View { eye: [3.0, 2.5, 4.0], target: [0.1, 0.4, 0.0], fov: 40.0, size: [96, 54] };

/// How far numbers are from what they must be.
#[derive(Debug)]
struct Errors(Vec<f64>);

impl Errors {
    fn share_above(&self, limit: f64) -> f64 {
        self.0.iter().filter(|error| **error > limit).count() as f64 / self.0.len() as f64
    }

    fn worst(&self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }
}

/// A scene of one light with a soft shadow.
struct Soft {
    name: &'static str,
    light: Light,
    k: f64,
    shapes: &'static str,
}

/// Distances that are exact, with and without a floor; bounds; a field that is steep; a lamp between walls; a sun so low that
/// the floor itself is in the penumbra; a penumbra that is narrow.
const SOFT: [Soft; 7] = [
    Soft {
        name: "exact",
        light: Light::Sun([2.0, 3.0, 1.0]),
        k: 8.0,
        shapes: "plane(), sphere(0.5).at(-0.7, 0.5, 0.2), box((0.3, 0.6, 0.2)).rotate_y(0.4).at(0.5, 0.6, -0.3),
                 torus(0.4, 0.1).rotate_x(0.5).at(0.9, 0.6, 0.9)",
    },
    Soft {
        name: "on a table",
        light: Light::Sun([2.0, 2.0, 1.0]),
        k: 6.0,
        shapes: "box((1.5, 0.1, 1.2)).at(0, -0.1, 0), sphere(0.5).at(-0.7, 0.5, 0.2),
                 capsule((0.5, 0, 0.3), (0.7, 0.9, -0.4), 0.12), box((0.1, 0.8, 0.6)).at(-0.2, 0.8, -0.6)",
    },
    Soft {
        name: "bounds",
        light: Light::Sun([3.0, 5.0, 2.5]),
        k: 12.0,
        shapes: "((sphere(1) & box(0.77)) - (cylinder(0.44, 2) | cylinder(0.44, 2).rotate_x(90deg))).at(-0.3, 0.77, 0.1),
                 round_box((0.3, 0.4, 0.3), 0.05).sdiff(sphere(0.3).at(0.25, 0.3, 0.3), k: 0.06).at(1, 0.4, 0.9), plane()",
    },
    Soft {
        name: "steep",
        light: Light::Sun([2.0, 2.5, 2.0]),
        k: 10.0,
        shapes: "plane(), box((0.4, 0.8, 0.25)).twist(2.5).at(0.2, 0.8, 0), ellipsoid((0.5, 0.2, 0.3)).at(-0.9, 0.3, 0.4)",
    },
    Soft {
        name: "a lamp",
        light: Light::Lamp([0.6, 1.9, 0.5]),
        k: 8.0,
        shapes: "plane(), box_frame((0.4, 0.4, 0.4), 0.1).rotate_y(0.3).at(0.2, 0.5, 0),
                 (box(0.35) - sphere(0.42)).at(-0.9, 0.36, 0.6), plane((1, 0, 0.2), 2)",
    },
    Soft {
        name: "low",
        light: Light::Sun([3.0, 0.6, 1.0]),
        k: 4.0,
        shapes: "plane(), sphere(0.5).at(-0.7, 0.5, 0.2), cylinder(0.2, 0.5).at(0.5, 0.5, -0.3),
                 round_box((0.2, 0.1, 0.4), 0.05).at(0.9, 0.1, 0.7)",
    },
    Soft {
        name: "narrow",
        light: Light::Sun([-1.0, 2.5, 2.0]),
        k: 32.0,
        shapes: "plane(), sphere(0.4).at(-0.7, 0.5, 0.2) | box(0.3).at(0.4, 0.3, 0.1),
                 helix(0.4, 0.5, 0.06).at(0.9, 0.6, -0.5) & box((0.6, 0.5, 0.6)).at(0.9, 0.6, -0.5)",
    },
];

impl Soft {
    fn text(&self, shadow: &str) -> String {
        format!("light key {{ {}, shadow: {shadow} }} scene {{ {} }}", self.light.setting(), self.shapes)
    }

    fn soft_text(&self) -> String {
        self.text(&format!("soft({})", self.k))
    }

    /// Where light may arrive, with the cosine there and the part of the light that does by its definition.
    fn wanted(&self) -> Vec<(Place, f64, f64)> {
        let soft = self.soft_text();
        let seen = VIEW.seen(&soft, &Options::default());
        let facing = |at: &Place| dot(seen[at.pixel].normal.map(f64::from), self.light.from(at.place, FAR).0);
        let mut places = VIEW.places(&soft, &seen);
        places.retain(|at| facing(at) > FACING);
        let field = Field::of(&soft);
        let chunks = places.par_chunks(256).map(|chunk| {
            let at: Vec<Vector> = chunk.iter().map(|at| at.place).collect();
            let wanted = definition::soft_shadows(&mut field.probe(), &at, self.light, FAR, self.k);
            chunk.iter().zip(wanted).map(|(at, wanted)| (*at, facing(at), wanted)).collect::<Vec<_>>()
        });
        chunks.flatten().collect()
    }

    /// How far the part of the light that arrives is from what is wanted, and how many evaluations of the solids each of these
    /// pixels takes for it.
    fn errors(&self, wanted: &[(Place, f64, f64)], options: &Options) -> (Errors, f64) {
        let (seen, evaluations) = VIEW.seen_and_counted(&self.soft_text(), options);
        let (_, without) = VIEW.seen_and_counted(&self.text("none"), options);
        let error = |(at, facing, wanted): &(Place, f64, f64)| {
            (f64::from(seen[at.pixel].light[0]) / facing - wanted).abs()
        };
        let price = (evaluations - without) as f64 / wanted.len() as f64;
        (Errors(wanted.iter().map(error).collect()), price)
    }
}

/// How far a soft shadow may be from its definition at one pixel of a thousand, and at any.
const SOFT_NEAR: f64 = 0.02;
const SOFT_FAR: f64 = 0.1;
/// How many evaluations it may take.
const SOFT_PRICE: f64 = 13.0;

impl Errors {
    fn are_of_a_soft_shadow(&self) -> bool {
        self.share_above(SOFT_NEAR) <= 1e-3 && self.worst() <= SOFT_FAR
    }
}

/// The twins: shadows of the samples alone, as a sphere tracer takes them; and those from before the surface.
#[test]
fn soft_shadows_are_their_definition() {
    let samples_alone = twin(
        "soft_shadow.sdf",
        &[("let darkest = softness * slope * between.d / between.t;", "let darkest = light;")],
    );
    let lifted = twin(
        "soft_shadow.sdf",
        &[("past_solids(scene, foot.place,", "past_solids(scene, foot.place + direction * offset,")],
    );
    let twins = [("samples alone", samples_alone), ("lifted", lifted)];
    let mut wrong = [0; 2];
    for case in SOFT {
        let wanted = case.wanted();
        assert!(wanted.len() > 900, "{}: {} pixels", case.name, wanted.len());
        let (errors, price) = case.errors(&wanted, &Options::default());
        let (share, worst) = (errors.share_above(SOFT_NEAR), errors.worst());
        println!("{}: {share:.5} above {SOFT_NEAR}, {worst:.3} at most, {price:.2} evaluations", case.name);
        assert!(errors.are_of_a_soft_shadow(), "{}: {share} above {SOFT_NEAR}, {worst} at most", case.name);
        assert!(price <= SOFT_PRICE, "{}: {price} evaluations", case.name);
        for ((_, options), wrong) in twins.iter().zip(&mut wrong) {
            *wrong += usize::from(!case.errors(&wanted, options).0.are_of_a_soft_shadow());
        }
    }
    for ((name, _), wrong) in twins.iter().zip(wrong) {
        println!("{name}: {wrong} scenes are wrong");
        assert!(wrong >= 3, "{name}: {wrong} scenes are wrong");
    }
}

/// The errors of the occlusion in scenes with creases, a ceiling and what is near by.
fn occlusion_errors(options: &Options) -> Vec<(&'static str, Errors)> {
    let scenes = [
        (
            "creases",
            1.0,
            0.5,
            "plane() | box((0.5, 0.4, 0.3)).rotate_y(0.4).at(0.3, 0.4, 0) | sphere(0.5).at(-0.9, 0.45, 0.3)",
        ),
        (
            "a ceiling",
            0.7,
            0.8,
            "plane() | box((0.8, 0.05, 0.6)).at(0.1, 0.6, 0.2) | cylinder(0.1, 0.3).at(-0.6, 0.3, 0.5)",
        ),
        (
            "bounds",
            1.0,
            0.4,
            "smin(plane(), box(0.3).rotate_y(0.5).at(0.5, 0.3, 0.3), k: 0.2) | (box(0.4) - sphere(0.5)).at(-0.6, 0.4, 0.4)",
        ),
    ];
    let errors = scenes.map(|(name, occlusion, radius, shapes)| {
        let text = format!(
            "light dark {{ direction: (1, 2, 3), intensity: 0 }}
             ambient {{ color: 0.9, occlusion: {occlusion}, radius: {radius} }}
             scene {{ ({shapes}).paint(material {{ color: 1, specular: 0 }}) }}"
        );
        let seen = VIEW.seen(&text, &Options::default());
        let light = VIEW.light(&text, options);
        let field = Field::of(&text);
        let places = VIEW.places(&text, &seen);
        let errors = places.par_iter().map_init(
            || field.probe(),
            |probe, at| {
                let wanted = definition::occlusion(probe, at.place, at.normal, occlusion, radius);
                (light[at.pixel][0] / 0.9 - wanted).abs()
            },
        );
        (name, Errors(errors.collect()))
    });
    errors.into()
}

/// How far occlusion may be from its definition.
const OCCLUSION_NEAR: f64 = 0.01;

#[test]
fn occlusion_is_its_definition() {
    for (name, errors) in occlusion_errors(&Options::default()) {
        println!("{name}: {} pixels, {:.4} at most", errors.0.len(), errors.worst());
        assert!(errors.0.len() > 2000, "{name}: {} pixels", errors.0.len());
        assert!(errors.worst() <= OCCLUSION_NEAR, "{name}: {}", errors.worst());
    }
    // One sample; from where rays to lights start.
    let single = twin(
        "occlusion.sdf",
        &[
            ("let samples = count - 1 + rest;", "let samples = 1;"),
            ("iterate(count,", "iterate(1,"),
            ("i + 1 < count", "i < 1"),
        ],
    );
    let lifted = twin(
        "pixel.sdf",
        &[("occlusion(scene.map, at.foot,", "occlusion(scene.map, (place: at.place + at.lifted),")],
    );
    for (name, options) in [("single", single), ("lifted", lifted)] {
        let wrong = |(_, errors): &(&str, Errors)| errors.share_above(OCCLUSION_NEAR) > 1e-2;
        assert!(occlusion_errors(&options).iter().any(wrong), "{name}");
    }
}

/// Shapes that glow, each with its w; the first in red, the second in green.
struct Glow {
    name: &'static str,
    view: View,
    far: f64,
    parts: &'static [(&'static str, f64)],
    other: &'static str,
}

const GLOWS: [Glow; 8] = [
    Glow {
        name: "a wire behind a box",
        view: VIEW,
        far: FAR,
        parts: &[
            ("torus(0.8, 0.01).rotate_x(0.7).at(0, 0.9, 0.1)", 0.5),
            ("sphere(0.2).at(-1, 0.6, 0.2)", 0.25),
        ],
        other: "box(0.3).at(0.1, 0.4, 0.8) | plane()",
    },
    Glow {
        name: "from afar",
        view: View { eye: [30.0, 25.0, 40.0], fov: 4.0, ..VIEW },
        far: 1000.0,
        parts: &[
            ("capsule((-0.8, 0.2, 0.3), (0.9, 1.1, -0.4), 0.1)", 0.3),
            ("box((0.2, 0.5, 0.3)).rotate_y(0.4).at(1, 0.5, 0.6)", 0.1),
        ],
        other: "plane()",
    },
    Glow {
        name: "a narrow glow",
        view: VIEW,
        far: 1000.0,
        parts: &[
            ("sphere(0.5).at(-0.7, 0.5, 0.2)", 0.03),
            ("torus(0.5, 0.1).rotate_x(0.4).at(0.8, 0.6, 0.1)", 0.02),
        ],
        other: "plane()",
    },
    Glow {
        name: "from within",
        view: View { eye: [0.4, 0.9, 0.9], target: [0.1, 0.4, -0.3], fov: 60.0, ..VIEW },
        far: FAR,
        parts: &[
            ("sphere(0.4).at(-0.3, 0.6, 0.2)", 1.5),
            ("capsule((0.5, 0.2, 0.3), (0.9, 1.1, -0.4), 0.05)", 0.6),
        ],
        other: "plane()",
    },
    Glow {
        name: "columns",
        view: View { eye: [4.0, 2.5, 6.0], target: [0.0, 1.0, 0.0], fov: 45.0, ..VIEW },
        far: FAR,
        parts: &[("cylinder(0.2, 2).round(0.03).repeat(x: 3, z: 3)", 0.25)],
        other: "plane()",
    },
    Glow {
        name: "bounds",
        view: VIEW,
        far: FAR,
        parts: &[
            ("smin(sphere(0.4), box(0.3).at(0.5, 0.1, 0), k: 0.2).at(-0.4, 0.6, 0)", 0.3),
            ("(box(0.3) & sphere(0.4)).rotate_y(0.5).at(0.9, 0.5, 0.5)", 0.2),
        ],
        other: "plane()",
    },
    Glow {
        name: "steep",
        view: VIEW,
        far: FAR,
        parts: &[("box((0.4, 0.8, 0.25)).twist(2.5).at(0.2, 0.8, 0)", 0.3)],
        other: "plane()",
    },
    Glow {
        name: "a floor",
        view: View { eye: [3.0, 0.6, 4.0], ..VIEW },
        far: FAR,
        parts: &[("plane((0.1, 1, 0.05), 0.2)", 0.4)],
        other: "sphere(0.5).at(0, 0.6, 0)",
    },
];

/// The glow for each unit of the integral: all of it stays below the white.
const AMOUNT: f64 = 0.03;

impl Glow {
    fn text(&self, amount: f64) -> String {
        let part = |i: usize| {
            let (shape, w) = self.parts[i];
            let glow = if i == 0 { format!("({amount}, 0, 0)") } else { format!("(0, {amount}, 0)") };
            format!("{shape}.paint(material {{ color: 0, specular: 0, glow: {glow}, glow_radius: {w} }})")
        };
        let parts: Vec<String> = (0..self.parts.len()).map(part).collect();
        format!(
            "light dark {{ direction: (1, 2, 3), intensity: 0 }} ambient {{ color: 0 }} sky {{ color: 0 }}
             render {{ far: {} }}
             scene {{ {}, ({}).paint(material {{ color: 0, specular: 0 }}) }}",
            self.far,
            parts.join(", "),
            self.other
        )
    }

    /// The integral at each pixel, for each part.
    fn wanted(&self) -> Vec<Vec<f64>> {
        let seen = self.view.seen(&self.text(0.0), &Options::default());
        let directions = self.view.directions();
        let of_part = |(shape, w): &(&str, f64)| {
            let field = Field::of(&format!("scene {{ {shape} }}"));
            let pixels = (0..seen.len()).into_par_iter().map_init(
                || field.probe(),
                |probe, i| {
                    let limit = if seen[i].depth < 0.0 { self.far } else { f64::from(seen[i].depth) };
                    definition::glow(probe, self.view.eye, directions[i], limit, *w)
                },
            );
            pixels.collect()
        };
        self.parts.iter().map(of_part).collect()
    }

    /// How far the glow is from what is wanted where there is any, as shares of it, or of a tenth of the most in the picture.
    fn errors(&self, wanted: &[Vec<f64>], options: &Options) -> Errors {
        let light = self.view.light(&self.text(AMOUNT), options);
        let mut errors = Vec::new();
        for (channel, wanted) in wanted.iter().enumerate() {
            let most = wanted.iter().copied().fold(0.0, f64::max);
            let pairs = wanted.iter().zip(light.iter().map(|light| light[channel] / AMOUNT));
            let shining = pairs.filter(|(wanted, found)| wanted.max(*found) > 1e-4 * most);
            errors.extend(shining.map(|(wanted, found)| (found - wanted).abs() / wanted.max(0.1 * most)));
        }
        Errors(errors)
    }
}

/// How far a glow may be from its definition, as a share, but at a few pixels of a thousand.
const GLOW_NEAR: f64 = 0.01;

/// The twins: steps that are too long; slopes that are not looked at; rounds that are too few for what is far away.
#[test]
fn glow_is_its_definition() {
    let long = twin("glow.sdf", &[("0.125 * width, 0.25 * width", "width, width")]);
    let straight = twin("glow.sdf", &[("- between * bend - end", "")]);
    let short = twin("glow.sdf", &[("let rounds = 256;", "let rounds = 12;")]);
    let twins = [("long steps", long, 5), ("straight", straight, 4), ("few rounds", short, 2)];
    let mut wrong = [0; 3];
    for case in GLOWS {
        let wanted = case.wanted();
        let errors = case.errors(&wanted, &Options::default());
        let (share, worst) = (errors.share_above(GLOW_NEAR), errors.worst());
        println!(
            "{}: {} pixels, {share:.5} above {GLOW_NEAR}, {worst:.4} at most",
            case.name,
            errors.0.len()
        );
        assert!(errors.0.len() > 300, "{}: {} pixels", case.name, errors.0.len());
        assert!(share <= 2e-3 && worst <= 0.1, "{}: {share} above {GLOW_NEAR}, {worst}", case.name);
        for ((_, options, _), wrong) in twins.iter().zip(&mut wrong) {
            *wrong += usize::from(case.errors(&wanted, options).share_above(GLOW_NEAR) > 2e-3);
        }
    }
    for ((name, _, least), wrong) in twins.iter().zip(wrong) {
        println!("{name}: {wrong} scenes are wrong");
        assert!(wrong >= *least, "{name}: {wrong} scenes are wrong");
    }
}

/// Lights of the scenes of which hard shadows are certified.
const HARD: [Light; 4] = [
    Light::Sun([2.0, 3.0, 1.0]),
    Light::Sun([-3.0, 0.8, 2.0]),
    Light::Lamp([0.6, 1.9, 0.5]),
    Light::Lamp([-2.0, 3.0, 4.0]),
];

const HARD_SCENES: [&str; 2] = [
    "plane() | sphere(0.5).at(-0.7, 0.5, 0.2) | box_frame((0.4, 0.4, 0.4), 0.06).rotate_y(0.3).at(0.5, 0.5, -0.2)",
    "smin(plane(), box(0.3).rotate_y(0.5).at(0.5, 0.3, 0.3), k: 0.2) | (box(0.4) - sphere(0.5)).at(-0.6, 0.4, 0.4)",
];

/// A scene with these lights, all with hard shadows; the colour of all surfaces is the vector to the first one.
fn hard_text(shapes: &str, lights: &[Light]) -> String {
    let towards = match lights[0] {
        Light::Sun([x, y, z]) => format!("({x}, {y}, {z}) * 200"),
        Light::Lamp([x, y, z]) => format!("({x}, {y}, {z}) - p"),
    };
    let light = |i: usize| format!("light number{i} {{ {}, shadow: hard }}\n", lights[i].setting());
    let lights: String = (0..lights.len()).map(light).collect();
    format!("{}{lights}scene {{ ({shapes}).paint(material {{ color: {towards} }}) }}", VIEW.block())
}

fn hard_options() -> Options {
    Options { attack: Some(0), probe: true, certificate: true, ..Options::default() }
}

/// One light after the other against the certified visibility, as in the hard cases; then all at once, which are their sum.
#[test]
fn hard_shadows_are_certified() {
    let frame = Frame::new(64, 36);
    for shapes in HARD_SCENES {
        let mut sum = vec![[0.0f32; 3]; (frame.width * frame.height) as usize];
        for light in HARD {
            let text = hard_text(shapes, &[light]);
            let made = scene("hard shadows", &text, &hard_options());
            let fixture = Fixture::of("hard shadows", format!("// shadows: exact\n\n{text}"));
            let seen = Buffers::of(&made, &frame);
            let mut certified = Certified::of(&made, &frame);
            let score = certified.score(&fixture, &seen);
            assert_eq!(score.lights, 0, "{shapes}, {light:?}: {score:?}");
            assert!(score.certified > score.pixels * 9 / 10, "{shapes}, {light:?}: {score:?}");
            // The measure can fail: with all lights turned about.
            let mut wrong = seen.clone();
            wrong
                .pixels
                .iter_mut()
                .for_each(|pixel| pixel.light = pixel.light.map(|x| if x > 0.0 { 0.0 } else { 1.0 }));
            assert!(certified.score(&fixture, &wrong).lights > 500, "{shapes}, {light:?}");
            for (sum, pixel) in sum.iter_mut().zip(&seen.pixels) {
                *sum = std::array::from_fn(|k| sum[k] + pixel.light[k]);
            }
        }
        let all = Buffers::of(&scene("hard shadows", &hard_text(shapes, &HARD), &hard_options()), &frame);
        let near = |(sum, pixel): (&[f32; 3], _)| {
            let Seen { light, .. } = pixel;
            (0..3).all(|k| (sum[k] - light[k]).abs() < 1e-5)
        };
        assert!(sum.iter().zip(all.pixels).all(near), "{shapes}: all lights are the sum of each");
    }
}

/// A material of the scene below.
struct Painted {
    color: Vector,
    specular: f64,
    shininess: f64,
    emission: Vector,
}

const PAINTED: [Painted; 3] = [
    Painted { color: [0.6, 0.3, 0.1], specular: 0.3, shininess: 12.0, emission: [0.0, 0.02, 0.05] },
    Painted { color: [0.1, 0.4, 0.5], specular: 0.6, shininess: 60.0, emission: [0.0; 3] },
    Painted { color: [0.3, 0.3, 0.35], specular: 0.0, shininess: 32.0, emission: [0.03, 0.0, 0.0] },
];

const LIGHTS: [(Light, Vector, f64); 3] = [
    (Light::Sun([2.0, 3.0, 1.0]), [0.9, 0.7, 0.5], 0.4),
    (Light::Lamp([-0.8, 1.7, 1.2]), [0.2, 0.4, 1.0], 0.5),
    (Light::Lamp([1.5, 0.3, 2.5]), [0.5, 1.0, 0.3], 0.3),
];

const AMBIENT: Vector = [0.05, 0.06, 0.08];

fn vector([x, y, z]: Vector) -> String {
    format!("({x}, {y}, {z})")
}

/// How far the light that leaves surfaces is from the formula of several lights, with Blinn's half vector.
fn formula_errors(options: &Options) -> Errors {
    let shapes = [
        "sphere(0.6).at(-0.7, 0.6, 0.2)",
        "box((0.4, 0.5, 0.3)).rotate_y(0.4).rotate_x(0.2).at(0.6, 0.6, 0)",
        "plane()",
    ];
    let part = |i: usize| {
        let Painted { color, specular, shininess, emission } = &PAINTED[i];
        let (color, emission) = (vector(*color), vector(*emission));
        format!(
            "{}.paint(material {{ color: {color}, specular: {specular}, shininess: {shininess}, emission: {emission} }})",
            shapes[i]
        )
    };
    let light = |i: usize| {
        let (light, color, intensity) = LIGHTS[i];
        format!(
            "light number{i} {{ {}, color: {}, intensity: {intensity} }}\n",
            light.setting(),
            vector(color)
        )
    };
    let [parts, lights] = [(0..3).map(part).collect::<Vec<String>>().join(", "), (0..3).map(light).collect()];
    let text =
        format!("{lights} ambient {{ color: {} }} sky {{ color: 0 }} scene {{ {parts} }}", vector(AMBIENT));
    let seen = VIEW.seen(&text, &Options::default());
    let found = VIEW.light(&text, options);
    let errors = VIEW.places(&text, &seen).into_iter().map(|at| {
        let color = seen[at.pixel].color.map(f64::from);
        let is_painted = |it: &&Painted| difference(it.color, color) < 1e-4;
        let Painted { color, specular, shininess, emission } =
            PAINTED.iter().find(is_painted).expect("one of the materials");
        let mut wanted = plus(scaled(*color, AMBIENT), *emission);
        for (light, light_color, intensity) in LIGHTS {
            let (way, _) = light.from(at.place, FAR);
            let half = unit(minus(way, at.direction));
            let diffuse = scaled(*color, times(light_color, dot(at.normal, way).max(0.0)));
            let shine = times(light_color, specular * dot(at.normal, half).max(0.0).powf(*shininess));
            wanted = plus(wanted, times(plus(diffuse, shine), intensity));
        }
        difference(wanted.map(|x| x.clamp(0.0, 1.0)), found[at.pixel])
    });
    Errors(errors.collect())
}

/// How far it may be, in linear light.
const FORMULA_NEAR: f64 = 1e-4;

#[test]
fn lights_add_up_by_the_formula() {
    let errors = formula_errors(&Options::default());
    println!("{} pixels, {:.7} at most", errors.0.len(), errors.worst());
    assert!(errors.0.len() > 4000 && errors.worst() < FORMULA_NEAR, "{}", errors.worst());
    // Phong's vector; places above the surface.
    let phong = twin(
        "light.sdf",
        &[
            ("normalize(to_light - direction)", "reflect(direction, at.normal)"),
            ("dot(at.normal, half_vector)", "dot(to_light, half_vector)"),
        ],
    );
    let lifted = twin(
        "light.sdf",
        &[("normalize(light.at - at.foot.place)", "normalize(light.at - at.place - at.lifted)")],
    );
    for (name, options) in [("Phong", phong), ("lifted", lifted)] {
        assert!(formula_errors(&options).worst() > 2.0 * FORMULA_NEAR, "{name}");
    }
}
