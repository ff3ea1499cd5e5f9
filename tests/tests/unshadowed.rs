//! Shadows that nothing can fall into are left out, and those that something may fall into are not: texts beside those of
//! the same scenes without shadows, and pictures beside those of the same fields of which nothing is known.

use sdf_emit::Target;
use sdf_lang::Options;
use sdf_render::{Frame, Picture, cpu};
use sdf_tests::attack::points::Random;
use sdf_tests::scenes::scene;
use sdfc::Clock;

const SIZE: [u32; 2] = [128, 72];
/// 0.1 % of the pixels.
const FEW: usize = (SIZE[0] * SIZE[1]) as usize / 1000;
const MATTE: &str = "material matte { specular: 0 }";

/// A ring out of sight, below all and behind the eye, because of which nothing is known of a scene.
const RING: &str = "torus(0.1, 0.03).at(0, -40, 60)";

/// A scene with what its lights cast for `SHADOW`, and nothing more for `REST`.
fn known(template: &str, shadow: &str) -> String {
    template.replace("SHADOW", shadow).replace("REST", "")
}

/// The same scene, but it is not known what its shadows fall on.
fn unknown(template: &str, shadow: &str) -> String {
    template.replace("SHADOW", shadow).replace("REST", RING)
}

/// The texts of a scene for two targets.
fn texts(text: &str) -> [String; 2] {
    let compiled = sdfc::compile("scene", text, &Options::default(), &mut Clock::default());
    let (_, shader) = compiled.output.unwrap_or_else(|| panic!("{:?}\n{text}", compiled.diagnostics));
    [Target::Wgsl, Target::GlslEs].map(|target| shader.text(target).expect("a valid text"))
}

fn casts(text: &str) -> bool {
    let options = Options { attack: Some(0), ..Options::default() };
    scene("scene", text, &options).summary.effects.iter().any(|effect| effect.ends_with("shadow"))
}

fn picture(text: &str) -> Picture {
    let options = Options { attack: Some(0), ..Options::default() };
    cpu::render(&sdf_ir::legalise(&scene("scene", text, &options).program), &Frame::new(SIZE[0], SIZE[1]))
}

/// At how many pixels two pictures differ by more than `tolerance` of 255 in a channel.
fn differing(a: &Picture, b: &Picture, tolerance: u8) -> usize {
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4));
    pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > tolerance)).count()
}

const CAMERA: &str = "camera { eye: (0, 1, 9), target: (0, 0.5, 0) }";
const FRONT: &str = "light sun { direction: (0.3, 0.5, 1), shadow: SHADOW }";

/// Scenes in which no shadow can fall on anything, and what is in them besides the camera.
fn free() -> Vec<(&'static str, String)> {
    let rows = [
        ("one ball", format!("{FRONT} scene {{ sphere(1), REST }}")),
        (
            "side by side, lit from the front",
            format!("{FRONT} scene {{ sphere(0.9).at(-1.5, 0, 0), sphere(0.9).at(1.5, 0, 0), REST }}"),
        ),
        (
            "behind operators and paint",
            format!(
                "{FRONT} scene {{
                    box((0.5, 0.8, 0.3)).round(0.1).rotate((1, 2, 3), 40deg).at(-2.5, 0, 0).paint(#cc4422),
                    ngon(5, 0.6).round(0.05).extrude(0.4).scale(1.2).at(0, 0, 0).paint(#22cc44),
                    (cone(0.8, 0.9) & sphere(0.8)).shear((0.2, 0.1)).scale((1, 1.1, 0.9)).at(2.6, 0, 0),
                    REST }}"
            ),
        ),
        (
            "a lamp between two balls",
            format!(
                "{MATTE} light lamp {{ position: (0, 0.3, 0.2), shadow: SHADOW }}
                 scene {{ sphere(1).at(-2, 0, 0).paint(matte), sphere(1).at(2, 0, 0).paint(matte), REST }}"
            ),
        ),
        (
            "a lamp under a ball, above a floor",
            format!(
                "{MATTE} light lamp {{ position: (0.5, 0.5, 1), shadow: SHADOW }}
                 scene {{ plane(y, 1).paint(matte), sphere(0.8).at(0, 2, 0).paint(matte), REST }}"
            ),
        ),
        (
            "a floor and a wall, lit from before both",
            "light sun { direction: (1, 2, 1.5), shadow: SHADOW } scene { plane(y, 1), plane(x, 3), REST }"
                .to_string(),
        ),
        (
            "a ball of any size and a light from anywhere, as the file changes them",
            format!(
                "{MATTE} param r = 1 in 0.5..1.5
                 light sun {{ direction: (cos(time), 0.4, sin(time)), shadow: SHADOW }}
                 scene {{ sphere(r).paint(matte), REST }}"
            ),
        ),
        (
            "a light that swings past balls side by side",
            format!(
                "{MATTE} param u = 0 in -0.5..0.5 light sun {{ direction: (u, 1, 0.1 * u), shadow: SHADOW }}
                 scene {{ for z in [-1.5, 1.5] {{ sphere(0.8).at(u, 0, z).paint(matte) }}, REST }}"
            ),
        ),
        (
            "a light that turns across a row of balls",
            format!(
                "{MATTE} light sun {{ direction: (0, cos(time), sin(time)), shadow: SHADOW }}
                 scene {{ for x in [-1.5, 1.5] {{ sphere(0.8).at(x, 0, 0).paint(matte) }}, REST }}"
            ),
        ),
        (
            "a lamp that swings between balls",
            format!(
                "{MATTE} param u = 0 in -0.5..0.5 light lamp {{ position: (u, 3, u), shadow: SHADOW }}
                 scene {{ for z in [-2, 2] {{ box((1, 0.8, 0.6)).at(u, 0, z).paint(matte) }}, REST }}"
            ),
        ),
        (
            "one of two shapes",
            format!(
                "param round = true {FRONT} scene {{ if round {{ sphere(1) }} else {{ box(0.8) }}, REST }}"
            ),
        ),
        (
            "a shape that the file promises to be convex",
            format!(
                "{FRONT} @convex @bound fn stone(r) = field {{ max(length(p), abs(p.y) + 0.2 * r) - r }}
                 scene {{ stone(1.2), REST }}"
            ),
        ),
    ];
    rows.map(|(name, text)| (name, format!("{CAMERA} ambient {{ color: 0.05 }} {text}"))).to_vec()
}

/// Scenes in which a shadow may fall on something, or nobody knows better.
fn shadowed() -> Vec<(&'static str, String)> {
    let rows = [
        ("a box on a floor", format!("{CAMERA} {FRONT} scene {{ plane(), box(0.5).at(0, 0.5, 0) }}")),
        (
            "one ball behind the other",
            format!("{CAMERA} {FRONT} scene {{ sphere(0.9).at(0, 0, -2), sphere(0.9).at(0.9, 1, 2) }}"),
        ),
        ("a carved ball", format!("{CAMERA} {FRONT} scene {{ sphere(1) - box(0.6).at(0, 0, 1) }}")),
        ("a ring", format!("{CAMERA} {FRONT} scene {{ torus(1, 0.3) }}")),
        (
            "a ball between a lamp and another",
            format!(
                "{CAMERA} light lamp {{ position: (-6, 0, 0), shadow: SHADOW }}
                 scene {{ sphere(1).at(-2, 0, 0), sphere(1).at(2, 0, 0) }}"
            ),
        ),
        (
            "a ball above a floor that is lit from below",
            format!(
                "{CAMERA} light sun {{ direction: (0.3, -1, 0.5), shadow: SHADOW }}
                 scene {{ plane(), sphere(1).at(0, 2, 0) }}"
            ),
        ),
        (
            "a ball above a lamp behind a wall",
            format!(
                "{CAMERA} light lamp {{ position: (-4, 0, 0), shadow: SHADOW }} scene {{ plane(x, 3), sphere(1) }}"
            ),
        ),
        (
            "a lamp above a ball above a floor",
            format!(
                "{CAMERA} light lamp {{ position: (0, 5, 0), shadow: SHADOW }}
                 scene {{ plane(y, 1), sphere(1).at(0, 1, 0) }}"
            ),
        ),
        (
            "seen from inside of a ball",
            format!("camera {{ eye: (0, 0, 1), target: 0 }} {FRONT} scene {{ sphere(4) }}"),
        ),
        (
            "seen from inside of a hollow",
            format!("camera {{ eye: (0, 0, 1), target: 0 }} {FRONT} scene {{ sphere(4) - sphere(3) }}"),
        ),
        (
            "a camera that may come inside",
            format!("camera {{ eye: (0, 1, 9), target: 0, orbit: true }} {FRONT} scene {{ sphere(1) }}"),
        ),
        (
            "a light that turns round two balls",
            format!(
                "{CAMERA} light sun {{ direction: (cos(time), 0.4, sin(time)), shadow: SHADOW }}
                 scene {{ sphere(0.9).at(-1.5, 0, 0), sphere(0.9).at(1.5, 0, 0) }}"
            ),
        ),
        (
            "a ball that wanders before another",
            format!(
                "param u = 0 in 0..3 {CAMERA} {FRONT} scene {{ sphere(0.9).at(u - 1.5, 0, 2), sphere(0.9).at(1.5, 0, 0) }}"
            ),
        ),
        (
            "a field that nobody promises to be convex",
            format!("{CAMERA} {FRONT} @bound fn ball() = field {{ length(p) - 1 }} scene {{ ball() }}"),
        ),
        (
            "more parts than are compared",
            format!("{CAMERA} {FRONT} scene {{ for i in 0..65 {{ sphere(0.01).at(i * 0.05, 0, 0) }} }}"),
        ),
        (
            "a soft shadow on a ball",
            format!("{CAMERA} light sun {{ direction: (1, 2, 3), shadow: soft(64) }} scene {{ sphere(1) }}")
                .replace("soft(64)", "SHADOW"),
        ),
    ];
    rows.to_vec()
}

#[test]
fn a_shadow_that_nothing_can_fall_into_leaves_no_trace() {
    for (name, template) in free() {
        let [with, without] = ["hard", "none"].map(|shadow| texts(&known(&template, shadow)));
        assert!(with == without, "{name}: there is a trace of the shadow");
        let forced = unknown(&template, "hard");
        assert!(!casts(&known(&template, "hard")) && casts(&forced), "{name}");
        let found = differing(&picture(&forced), &picture(&unknown(&template, "none")), 1);
        assert_eq!(found, 0, "{name}: a shadow falls on something");
    }
}

#[test]
fn a_shadow_that_something_may_fall_into_stays() {
    for (name, template) in shadowed() {
        let shadow = if name.contains("soft") { "soft(64)" } else { "hard" };
        let [with, without] = [shadow, "none"].map(|shadow| texts(&known(&template, shadow)));
        assert!(casts(&known(&template, shadow)) && with != without, "{name}: the shadow is left out");
    }
}

/// A shadow ends highlights too. Where a light comes from behind, they would else reach round to what is turned away from it.
#[test]
fn a_highlight_ends_where_the_light_does() {
    let template = format!(
        "{CAMERA} material glossy {{ specular: 1, shininess: 8 }} ambient {{ color: 0.05 }}
         light sun {{ direction: (0.2, 0.6, -1), shadow: SHADOW }} scene {{ sphere(1.5).paint(glossy), REST }}"
    );
    let left_out = known(&template, "hard");
    assert!(!casts(&left_out));
    let forced = picture(&unknown(&template, "hard"));
    let found = differing(&picture(&left_out), &forced, 1);
    assert!(found <= FEW, "{found} pixels differ");
    let reaching = differing(&picture(&known(&template, "none")), &forced, 1);
    assert!(reaching > 10 * FEW, "only {reaching} pixels have a highlight that reaches too far");
}

/// Over half spaces a soft shadow is none where the light is so high that no ray has half spaces near by for long.
#[test]
fn a_soft_shadow_over_half_spaces_is_none_where_the_light_is_high() {
    let scene = |light: &str, parts: &str| {
        format!(
            "{CAMERA} param k = 8 in 0.1..9 light sun {{ {light}, shadow: SHADOW }}
             scene {{ {parts}, REST }}"
        )
    };
    let high = "direction: (1, 2, 1.5)";
    let [floor, corner] = ["plane(y, 1)", "plane(y, 1), plane(x, 3)"].map(|parts| scene(high, parts));
    for (template, shadow) in [(&floor, "soft(2)"), (&corner, "soft(4)"), (&corner, "soft(32)")] {
        let [with, without] = [shadow, "none"].map(|shadow| texts(&known(template, shadow)));
        assert!(with == without, "{shadow} leaves a trace in {template}");
        let [with, without] = [shadow, "none"].map(|shadow| picture(&unknown(template, shadow)));
        assert_eq!(differing(&with, &without, 1), 0, "{shadow} in {template}");
    }
    let low = scene("direction: (1, 0.05, 0)", "plane(y, 1)");
    let ball = scene(high, "plane(y, 1), sphere(1)");
    let lamp = scene("position: (0, 4, 1)", "plane(y, 1)");
    for (template, shadow) in [
        (&floor, "soft(0.9)"),
        (&floor, "soft(k)"),
        (&low, "soft(8)"),
        (&ball, "soft(8)"),
        (&lamp, "soft(8)"),
    ] {
        assert!(casts(&known(template, shadow)), "{shadow} is left out in {template}");
    }
    // A lower one is not none.
    let [with, without] = ["soft(8)", "none"].map(|shadow| picture(&known(&low, shadow)));
    assert!(differing(&with, &without, 1) > 10 * FEW);
}

/// A scene of a few convex shapes and a light, all anywhere.
fn random_scene(random: &mut Random) -> String {
    let vector = |random: &mut Random, reach: f64| {
        let [x, y, z] = [0; 3].map(|_| random.within(-reach, reach));
        format!("({x:.3}, {y:.3}, {z:.3})")
    };
    let shape = |random: &mut Random| {
        let [a, b, c] = [0; 3].map(|_| random.within(0.2, 0.9));
        let shape = match random.below(8) {
            0 => format!("sphere({a:.3})"),
            1 => format!("box(({a:.3}, {b:.3}, {c:.3}))"),
            2 => format!("ellipsoid(({a:.3}, {b:.3}, {c:.3}))"),
            3 => format!("cone({a:.3}, {b:.3})"),
            4 => format!("cylinder({a:.3}, {b:.3}).round(0.1)"),
            5 => format!("octahedron({a:.3}).scale((1, 1.2, 0.7))"),
            6 => format!("ngon(5, {a:.3}).extrude({b:.3})"),
            _ => format!("(box({a:.3}) & sphere({b:.3}).at(0.1, 0, 0))"),
        };
        let (axis, angle, place) = (vector(random, 1.0), random.within(-3.0, 3.0), vector(random, 2.2));
        format!("{shape}.rotate({axis}, {angle:.3}).at({place}).paint(matte), ")
    };
    let count = 1 + random.below(3);
    let mut parts: String = (0..count).map(|_| shape(random)).collect();
    if random.below(4) == 0 {
        parts += &format!("plane({}, {:.3}).paint(matte), ", vector(random, 1.0), random.within(2.5, 4.0));
    }
    let light = match random.below(2) {
        0 => format!("direction: {}", vector(random, 1.0)),
        _ => format!("position: {}", vector(random, 4.0)),
    };
    let [x, y, z] = random.direction(3).map(|x| x * 8.0);
    format!(
        "camera {{ eye: ({x:.3}, {y:.3}, {z:.3}) }} {MATTE} ambient {{ color: 0.05 }}
         light sun {{ {light}, shadow: SHADOW }} scene {{ {parts} REST }}"
    )
}

/// How many random scenes there are, and how many of them at least are known to have no shadow.
const SCENES: usize = 200;
const LEFT_OUT: usize = 20;

#[test]
fn what_is_left_out_of_random_scenes_has_no_shadow() {
    let mut random = Random::new(25);
    let (mut left_out, mut naive) = (0, 0);
    for _ in 0..SCENES {
        let template = random_scene(&mut random);
        let [forced, none] = ["hard", "none"].map(|shadow| picture(&unknown(&template, shadow)));
        let dark = differing(&forced, &none, 1);
        if casts(&known(&template, "hard")) {
            // All these scenes are of convex shapes; that alone proves nothing.
            naive += usize::from(dark > FEW);
            continue;
        }
        left_out += 1;
        assert_eq!(dark, 0, "a shadow falls on something in {template}");
    }
    assert!(left_out >= LEFT_OUT, "only {left_out} are left out");
    assert!(naive >= LEFT_OUT, "only {naive} scenes tell a shadow from none");
}
