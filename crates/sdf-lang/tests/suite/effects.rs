//! What calls for effects, and that what is left out is as if nothing called for it.

use sdf_lang::{Effect, Options, Scene, compile};

/// A scene with these items, without mistakes.
fn scene(items: &str, options: &Options) -> Scene {
    let compilation = compile("effects.sdf", items, options);
    let messages: Vec<_> = compilation.diagnostics.iter().map(|d| &*d.message).collect();
    compilation.scene.unwrap_or_else(|| panic!("{items}: {messages:?}"))
}

fn effects(items: &str) -> Vec<Effect> {
    scene(items, &Options::default()).effects
}

/// The only effect of a name that is about this light or shape.
#[track_caller]
fn one<'e>(effects: &'e [Effect], name: &str, subject: Option<&str>) -> &'e Effect {
    let found: Vec<&Effect> =
        effects.iter().filter(|e| e.name == name && e.subject.as_deref() == subject).collect();
    match found[..] {
        [one] => one,
        _ => panic!("{name} of {subject:?}: {effects:#?}"),
    }
}

/// Two scenes that differ in one effect: with it, and without it.
struct Pair {
    name: &'static str,
    subject: Option<&'static str>,
    with: &'static str,
    without: &'static str,
    /// Why it is in, and why not.
    reasons: [&'static str; 2],
}

const SUN: &str = "camera { eye: (4, 3, 5) } light sun { direction: (1, 2, 3)";

fn pairs() -> Vec<Pair> {
    let pair = |name, subject, with, without, reasons| Pair { name, subject, with, without, reasons };
    vec![
        pair(
            "relaxation",
            None,
            "scene { box(1) } render { relax: auto }",
            "scene { box(1) } render { relax: none }",
            ["`relax` is `auto`", "`relax` is `none`"],
        ),
        pair(
            "soft shadow",
            Some("sun"),
            "scene { box(1) } light sun { direction: (1, 2, 3), shadow: soft(8) }",
            "scene { box(1) } light sun { direction: (1, 2, 3) }",
            ["`shadow` is `soft`", "no light casts a soft shadow"],
        ),
        pair(
            "hard shadow",
            Some("b"),
            "scene { torus(1, 0.3) } light a { position: (1, 2, 3), shadow: hard } light b { position: (3, 2, 1), shadow: hard }",
            "scene { torus(1, 0.3) } light a { position: (1, 2, 3), shadow: hard } light b { position: (3, 2, 1) }",
            ["`shadow` is `hard`", ""],
        ),
        pair(
            "occlusion",
            None,
            "scene { box(1) } ambient { occlusion: 0.5 }",
            "scene { box(1) }",
            ["`occlusion` is 0.5", "`occlusion` is 0 by default"],
        ),
        pair(
            "glow",
            Some("b"),
            "let a = box(1).paint(material { glow: #fff }) let b = sphere(1).paint(material { glow: (2, 1, 0) }) scene { a, b.at(3, 0, 0) }",
            "let a = box(1).paint(material { glow: #fff }) let b = sphere(1).paint(material { color: 0.8 }) scene { a, b.at(3, 0, 0) }",
            ["`glow` is (2, 1, 0)", ""],
        ),
        pair(
            "rim light",
            None,
            "scene { box(1) } rim { color: 0.5 }",
            "scene { box(1) } rim { power: 3 }",
            ["`color` is (0.5, 0.5, 0.5)", "`color` is 0 by default"],
        ),
        pair(
            "fog",
            None,
            "scene { box(1) } fog { density: 0.25, color: #fff }",
            "scene { box(1) } fog { density: 0, color: #fff }",
            ["`density` is 0.25", "`density` is 0"],
        ),
        pair(
            "tone mapping",
            None,
            "scene { box(1) } render { tonemap: aces }",
            "scene { box(1) }",
            ["`tonemap` is `aces`", "`tonemap` is `none` by default"],
        ),
        pair(
            "reflection",
            None,
            "scene { box(1).paint(material { color: #f00, reflect: 0.5 }) }",
            "scene { box(1).paint(material { color: #f00 }) }",
            ["`reflect` is 0.5", "no shape of the scene reflects"],
        ),
        pair(
            "transmission",
            None,
            "scene { box(1).paint(material { color: #f00, transmit: 0.5 }), sphere(1).at(3, 0, 0) }",
            "scene { box(1).paint(material { color: #f00 }), sphere(1).at(3, 0, 0) }",
            ["`transmit` is 0.5", "no shape of the scene lets light through"],
        ),
        pair(
            "antialiasing",
            None,
            "scene { box(1).paint(material { color: checker(p.xz, #fff, #000) }) } render { antialias: 3 } sky { color: p }",
            "scene { box(1).paint(material { color: checker(p.xz, #fff, #000) }) } sky { color: p }",
            ["`antialias` is more than 1", "`antialias` is 1 by default"],
        ),
        pair(
            "own shading",
            None,
            "scene { box(1) } fn shade(s) = s.color",
            "scene { box(1) } light a { direction: (1, 2, 3) }",
            ["the file has a `fn shade(surface)`", "the file has no `fn shade(surface)`"],
        ),
        pair(
            "sampled normals",
            None,
            "scene { box(1) } render { normals: central }",
            "scene { box(1) } render { normals: exact }",
            ["`normals` is not `exact`", "`normals` is `exact`"],
        ),
        pair(
            "parallel rays",
            None,
            "scene { box(1) } camera { eye: (3, 4, 5), projection: orthographic }",
            "scene { box(1) } camera { eye: (3, 4, 5) }",
            ["`projection` is `orthographic`", "`projection` is `perspective` by default"],
        ),
        pair(
            "emission",
            None,
            "scene { box(1).paint(material { color: #f00, emission: (1, 2, 3) }) }",
            "scene { box(1).paint(material { color: #f00 }) }",
            ["`emission` is (1, 2, 3)", "no surface of the scene gives light by itself"],
        ),
        pair(
            "orbit",
            None,
            "scene { box(1) } camera { eye: (3, 4, 5), orbit: true }",
            "scene { box(1) } camera { eye: (3, 4, 5) }",
            ["`orbit` may be true", "`orbit` is false by default"],
        ),
        pair(
            "step correction",
            None,
            "scene { box(1).twist(2) }",
            "scene { box(1).rotate_y(2) }",
            ["the slope of `twist` may be 4.6166 in its box, and more outside", "the scene is steep nowhere"],
        ),
        pair(
            "time",
            None,
            "scene { box(1).at(0, time, 0) } camera { eye: (3, 4, 5), target: (0, 0, 0) }",
            "scene { box(1) } camera { eye: (3, 4, 5), target: (0, 0, 0) }",
            ["`time` is read", "nothing reads `time`"],
        ),
        pair(
            "mouse",
            None,
            "scene { box(1).at(0, mouse.y, 0) } camera { eye: (3, 4, 5), target: (0, 0, 0) }",
            "scene { box(1) } camera { eye: (3, 4, 5), target: (0, 0, 0) } let unused = mouse",
            ["`mouse` is read", "nothing that is drawn depends on `mouse`"],
        ),
    ]
}

#[test]
fn each_effect_tells_why_it_is_in_or_out() {
    for Pair { name, subject, with, without, reasons: [why, why_not] } in pairs() {
        let (with, without) = (effects(with), effects(without));
        let found = one(&with, name, subject);
        assert_eq!((found.is_in, found.reason.as_str()), (true, why), "{name}");
        let found = without.iter().find(|e| e.name == name && !e.is_in);
        assert_eq!(found.map_or("", |e| &e.reason), why_not, "{name}");
        assert!(
            !without.iter().any(|e| e.name == name && e.is_in && e.subject.as_deref() == subject),
            "{name}"
        );
    }
}

#[test]
fn every_effect_has_a_pair() {
    let mut names: Vec<&str> = effects("scene { box(1) }").iter().map(|e| e.name).collect();
    names.dedup();
    for name in names {
        assert!(pairs().iter().any(|pair| pair.name == name), "{name} has no pair");
    }
}

#[test]
fn what_is_left_out_is_as_if_nothing_called_for_it() {
    for Pair { name, subject, with, without, .. } in pairs() {
        let whole = scene(with, &Options::default());
        let place = whole.effects.iter().position(|e| e.name == name && e.subject.as_deref() == subject);
        let effect = &whole.effects[place.unwrap()];
        let left_out = Options { left_out: place.into_iter().collect(), ..Options::default() };
        let left = scene(with, &left_out);
        // The list is that of the whole scene.
        assert_eq!(left.effects, whole.effects, "{name}");
        if !effect.can_be_left_out {
            assert!(matches!(name, "time" | "mouse" | "parallel rays"), "{name}");
            assert_eq!(left.program, whole.program, "{name}");
            continue;
        }
        assert_ne!(left.program, whole.program, "{name}");
        let without = scene(without, &Options::default());
        if name != "own shading" {
            assert_eq!(left.summary.effects, without.summary.effects, "{name}");
        }
        // A steep shape is another one than one that is not, and the light that own shading does not ask for is another.
        if !matches!(name, "step correction" | "own shading") {
            assert_eq!(left.program.to_string(), without.program.to_string(), "{name}");
        }
    }
}

#[test]
fn without_step_correction_steps_are_as_long_as_fields_read() {
    let text =
        "scene { box(1).twist(2), plane().at(0, -2, 0) } light a { direction: (1, 2, 3), shadow: soft(8) }";
    let whole = scene(text, &Options::default());
    let place = whole.effects.iter().position(|e| e.name == "step correction" && e.is_in).unwrap();
    let left = scene(text, &Options { left_out: vec![place], ..Options::default() });
    let has_stride = |scene: &Scene| scene.program.functions.iter().any(|f| f.name.ends_with("_stride"));
    assert!(has_stride(&whole) && !has_stride(&left));
}

#[test]
fn what_one_line_calls_for_is_one_effect() {
    let text = "param k = 1 in 0..2
        scene { for i in 0..4 { sphere(0.3).at(i, 0, 0).paint(material { glow: k * i * (1, 1, 1) }) }, box(1) }";
    let whole = scene(text, &Options::default());
    let glow = one(&whole.effects, "glow", Some("sphere"));
    // The first of them is dark.
    assert_eq!((glow.count, glow.reason.as_str()), (3, "`glow` depends on `k` and may reach 6"));
    assert_eq!(glow.removed_by, Some(("k".into(), "0".into())));
    let place = whole.effects.iter().position(|e| e.name == "glow").unwrap();
    let left = scene(text, &Options { left_out: vec![place], ..Options::default() });
    assert!(left.program.function_named("glow").is_none() && whole.program.function_named("glow").is_some());
}

#[test]
fn several_are_left_out_together() {
    let text =
        "let a = box(1).paint(material { glow: #fff }) let b = sphere(1).paint(material { glow: #f00 })
        let c = torus(1, 0.5).paint(material { glow: #0f0 }) scene { a, b.at(3, 0, 0), c.at(0, 3, 0) }";
    let whole = scene(text, &Options::default());
    let glows: Vec<usize> = (0..whole.effects.len()).filter(|i| whole.effects[*i].name == "glow").collect();
    let left = scene(text, &Options { left_out: glows[..2].to_vec(), ..Options::default() });
    let only =
        "let a = box(1).paint(material { color: 0.8 }) let b = sphere(1).paint(material { color: 0.8 })
        let c = torus(1, 0.5).paint(material { glow: #0f0 }) scene { a, b.at(3, 0, 0), c.at(0, 3, 0) }";
    assert_eq!(left.program.to_string(), scene(only, &Options::default()).program.to_string());
    assert_eq!(left.summary.effects, ["relaxation", "soft shadow", "glow"]);
}

/// For each param the place of what depends on it, and what `--set` takes it out.
#[test]
fn params_tell_how_far_a_value_may_go_and_what_removes_it() {
    let text = "param haze = 0.1 in 0..2 param night = 0.5 in 0.25..1 param on = true param tint = #fff
        param k = 1 in 0..3 param m = 1 in -1..2
        fog { density: 2 * haze }
        ambient { occlusion: night }
        rim { color: tint * 0.5 }
        light sun { direction: (1, 2, 3), intensity: if on { k } else { 0 }, shadow: hard }
        let lamp = sphere(1).paint(material { glow: k * (1, 0.5, 0.25) * m, emission: max(p.y, 0) * haze })
        scene { lamp, torus(1, 0.3).at(3, 0, 0) }";
    let effects = effects(text);
    let told = |name, subject| {
        let e = one(&effects, name, subject);
        let set = e.removed_by.as_ref().map(|(name, value)| format!("{name}={value}"));
        (e.is_in, e.reason.as_str(), e.range, set.unwrap_or_default())
    };
    assert_eq!(
        told("fog", None),
        (true, "`density` depends on `haze` and may reach 4", Some([0.0, 4.0]), "haze=0".into())
    );
    let reason = "`occlusion` depends on `night` and may reach 1";
    assert_eq!(told("occlusion", None), (true, reason, Some([0.25, 1.0]), String::new()));
    let reason = "`color` depends on `tint` and may reach 0.5";
    assert_eq!(told("rim light", None), (true, reason, Some([0.0, 0.5]), "tint=#000000".into()));
    let (is_in, _, range, set) = told("hard shadow", Some("sun"));
    assert_eq!((is_in, range, set.as_str()), (true, Some([0.0, 3.0]), "on=false"));
    let reason = "`glow` depends on `k` and `m` and may reach 6";
    assert_eq!(told("glow", Some("lamp")), (true, reason, Some([-3.0, 6.0]), "k=0".into()));
    let (is_in, reason, _, set) = told("emission", None);
    assert_eq!((is_in, reason, set.as_str()), (true, "`emission` depends on `haze`", "haze=0"));
}

#[test]
fn what_is_always_zero_calls_for_nothing() {
    let text = "param k = -1 in -2..0
        fog { density: max(k, 0) }
        ambient { occlusion: max(-time, 0) }
        rim { color: max(k, 0) * (1, 2, 3) }
        light sun { direction: (1, 2, 3), intensity: max(k, 0), shadow: hard }
        light moon { direction: (1, 2, -3) }
        scene { sphere(1).paint(material { glow: max(k, 0), emission: max(k - abs(p.x), 0) }) }";
    let made = scene(text, &Options::default());
    assert_eq!(made.summary.effects, ["relaxation"]);
    let reason = |name, subject| one(&made.effects, name, subject).reason.clone();
    assert_eq!(reason("fog", None), "`density` is always 0");
    assert_eq!(reason("occlusion", None), "`occlusion` is always 0");
    assert_eq!(reason("rim light", None), "`color` is always 0");
    assert_eq!(reason("glow", None), "no shape of the scene glows");
    assert_eq!(reason("emission", None), "no surface of the scene gives light by itself");
    assert_eq!(reason("hard shadow", Some("sun")), "it gives no light: its `intensity` or its `color` is 0");
    assert!(!made.program.uniforms.iter().any(|u| &*u.name == "k" || &*u.name == "time"), "{}", made.program);
}

#[test]
fn what_is_not_asked_for_has_its_reason() {
    let reason = |text: &str, name, subject| {
        let made = effects(text);
        let effect = one(&made, name, subject);
        assert!(!effect.is_in, "{name}");
        effect.reason.clone()
    };
    let hard = "light a { direction: (1, 2, 3), shadow: hard } scene { box(1) } camera { eye: (4, 4, 4) }";
    assert_eq!(reason(hard, "hard shadow", Some("a")), "nothing can fall into it");
    let own =
        "fn shade(s) = s.color light a { direction: (1, 2, 3), shadow: soft(4) } scene { torus(1, 0.3) }";
    let not_called = "the scene's own shading does not call for it";
    assert_eq!(reason(own, "soft shadow", Some("a")), not_called);
    assert_eq!(reason(own, "occlusion", None), not_called);
    assert_eq!(reason(own, "reflection", None), not_called);
    let asked = effects("fn shade(s) = s.color * occlusion() + reflection() scene { torus(1, 0.3) }");
    assert!(one(&asked, "occlusion", None).is_in && one(&asked, "reflection", None).is_in);
    let none = "scene { box(1).paint(material { reflect: 1 }) } render { bounces: 0 }";
    assert_eq!(reason(none, "reflection", None), "`bounces` is 0");
}

#[test]
fn a_color_may_be_brighter_than_white() {
    let made = effects("param c = (2, 0, 0) scene { box(1) } rim { color: max(c - 1, 0) }");
    assert!(one(&made, "rim light", None).is_in);
    let made = effects("param c = #fff scene { box(1) } rim { color: max(c - 1, 0) }");
    assert_eq!(one(&made, "rim light", None).reason, "`color` is always 0");
}

#[test]
fn a_shape_of_several_materials_glows_until_all_are_dark() {
    let text = |second: &str| {
        format!(
            "param a = 1 in 0..1 param b = 1 in 0..1
            fn glowing(g) = material {{ glow: g * (1, 1, 1) }}
            scene {{ smin(box(1).paint(glowing(a)), sphere(1.2).paint(glowing({second})), k: 0.1) }}"
        )
    };
    assert_eq!(one(&effects(&text("b")), "glow", Some("smin")).removed_by, None);
    let removed_by = one(&effects(&text("b * a")), "glow", Some("smin")).removed_by.clone();
    assert_eq!(removed_by, Some(("a".into(), "0".into())));
}

#[test]
fn an_empty_scene_has_the_effects_of_its_sky() {
    let made = scene(
        "scene { } fog { density: 0.1, color: #fff } render { tonemap: aces } ambient { occlusion: 1 }",
        &Options::default(),
    );
    assert!(one(&made.effects, "fog", None).is_in && one(&made.effects, "tone mapping", None).is_in);
    for name in ["relaxation", "step correction", "soft shadow", "occlusion", "glow", "emission"] {
        assert_eq!(one(&made.effects, name, None).reason, "there is nothing in the scene", "{name}");
    }
}

#[test]
fn places_are_those_of_the_settings() {
    let text = format!(
        "scene {{ box(1).twist(1).at(0, time, 0) }} {SUN}, shadow: soft(4) }} fog {{ density: 0.5 }}"
    );
    let made = effects(&text);
    let written = |name, subject| {
        let span = one(&made, name, subject).span.unwrap();
        &text[span.start as usize..span.end as usize]
    };
    assert_eq!(written("soft shadow", Some("sun")), "soft(4)");
    assert_eq!(written("fog", None), "0.5");
    assert_eq!(written("time", None), "time");
    assert_eq!(written("step correction", None), "box(1).twist(1)");
    assert!(one(&made, "step correction", None).reason.starts_with("the slope of `twist` may be "));
}
