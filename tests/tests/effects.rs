//! What effects add to a picture, against their definitions in f64: from the distances and normals that the probe tells of the
//! bare scene, and its colours.

use sdf_lang::Options;
use sdf_tests::light::vector::{difference, dot, mixed, plus, times};
use sdf_tests::light::{Vector, View};
use sdf_tests::scenes::Seen;

const VIEW: View = View { eye: [3.0, 1.5, 4.0], target: [0.0, 0.5, 0.0], fov: 50.0, size: [80, 45] };
/// How far a colour may be from its definition, in linear light: what f32 and the sRGB code do.
const NEAR: f64 = 2e-3;

/// A scene whose colours all lie well below 1, with a sky and a floor that reaches the horizon.
const BARE: &str = "light key { direction: (1, 2, 3), intensity: 0.4, shadow: hard }
ambient { color: 0.05 }
sky { horizon: (0.3, 0.25, 0.2), zenith: (0.02, 0.05, 0.2) }
scene { plane().paint(#a05020), sphere(0.8).at(0, 0.8, 0).paint(#206090), box(0.3).at(1.3, 0.3, 0.4) }";

/// Compares a scene, [`BARE`] and some items, with what each pixel must be: from its light without them, what is seen there,
/// and the ray's direction. Returns at how many pixels they differ, and by how much at most.
fn compared(items: &str, wanted: impl Fn(Vector, &Seen, Vector) -> Vector) -> f64 {
    let options = Options::default();
    let (bare, seen, directions) = (VIEW.light(BARE, &options), VIEW.seen(BARE, &options), VIEW.directions());
    let found = VIEW.light(&format!("{items}\n{BARE}"), &options);
    let errors = (0..bare.len()).map(|i| {
        let wanted = wanted(bare[i], &seen[i], directions[i]).map(|x| x.clamp(0.0, 1.0));
        difference(wanted, found[i])
    });
    errors.fold(0.0, f64::max)
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
            plus(bare, times([0.3, 0.4, 0.1], share))
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
            "{items} ambient {{ color: 0 }} light l {{ direction: (1, 0, 0), intensity: 0 }}
             scene {{ box(4).at(0, 0, -4).paint(material {{ color: 0, specular: 0, emission: {x} }}) }}"
        );
        let view = View { eye: [0.0, 0.0, 3.0], target: [0.0; 3], ..VIEW };
        view.light(&text, &Options::default())[40]
    };
    for x in [0.0, 0.5, 1.0, 2.0, 8.0, 1e3] {
        let [found, ..] = lamp("render { tonemap: aces }", x);
        assert!((found - curve(x).clamp(0.0, 1.0)).abs() < NEAR, "{x}: {found}");
        let [found, ..] = lamp("", x);
        assert!((found - x.min(1.0)).abs() < NEAR, "{x}: {found}");
    }
}
