//! What a scene may call for besides light: shading of its own, parallel rays, sampled normals; and that what is zero is not
//! called for.

use sdf_lang::Options;
use sdf_render::Frame;
use sdf_render::certify::{Certifier, Functions, Picture, Report, interpreted};
use sdf_tests::light::vector::dot;
use sdf_tests::light::{Vector, View};
use sdf_tests::scenes::{Buffers, Seen, all_examples, scene};
use sdfc::Target;

const VIEW: View = View { eye: [3.0, 1.5, 4.0], target: [0.0, 0.5, 0.0], fov: 50.0, size: [80, 45] };

/// A scene with a floor that reaches the horizon.
const BARE: &str = "light key { direction: (1, 2, 3), intensity: 0.4, shadow: hard }
ambient { color: 0.05 }
scene { plane().paint(#a05020), sphere(0.8).at(0, 0.8, 0).paint(#206090), box(0.3).at(1.3, 0.3, 0.4) }";

fn light(text: &str) -> Vec<Vector> {
    VIEW.light(text, &Options::default())
}

/// What the pixels of a scene with a camera of its own show.
fn seen(text: &str) -> Vec<Seen> {
    let options = Options { attack: Some(0), probe: true, ..Options::default() };
    Buffers::of(&scene(text, text, &options), &Frame::new(VIEW.size[0], VIEW.size[1])).pixels
}

/// A scene whose shading is the renderer's model, written out.
const WRITTEN_OUT: &str = "fn shade(s) {
  let lit = for light in s.lights {
    let visible = shadow(light);
    let half_vector = normalize(light.direction + s.to_eye);
    let shine = s.specular * pow(max(dot(s.n, half_vector), 0), s.shininess);
    light.color * visible * (s.color * max(dot(s.n, light.direction), 0) + shine)
  };
  s.color * s.ambient * occlusion() + sum(lit) + s.emission
}";

#[test]
fn shading_of_ones_own_may_be_the_renderers() {
    let scene = "light key { direction: (1, 2, 3), intensity: 0.4, shadow: soft(8) }
        light lamp { position: (-2, 2, 1), color: #ff8030, intensity: 0.3, shadow: hard }
        light off { direction: (0, 1, 0), intensity: 0, shadow: hard }
        ambient { color: 0.2, occlusion: 0.7, radius: 0.8 }
        material warm { color: #206090, specular: 0.6, shininess: 20, emission: (0.05, 0, 0.02) }
        rim { color: 0.1 } fog { density: 0.05 }
        scene { plane().paint(#a05020), sphere(0.8).at(0, 0.8, 0).paint(warm), box(0.3).at(1.3, 0.3, 0.4) }";
    let most_apart = |shade: &str| {
        let (found, wanted) = (light(&format!("{scene} {shade}")), light(scene));
        let apart =
            found.iter().zip(&wanted).map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max));
        apart.fold(0.0, f64::max)
    };
    // Its sums are made in another order.
    assert!(most_apart(WRITTEN_OUT) < 1e-4, "{}", most_apart(WRITTEN_OUT));
    assert!(most_apart(&WRITTEN_OUT.replace("occlusion()", "1")) > 0.02);
}

#[test]
fn shading_of_ones_own_mirrors_as_materials_do() {
    let scene = |material: &str, rest: &str| {
        light(&format!(
            "light key {{ direction: (1, 2, 3), intensity: 0.6 }} {rest}
            scene {{ plane().paint(#a05020), sphere(0.8).at(0, 0.8, 0).paint(material {{ color: 0.5, {material} }}),
              box(0.3).at(1.3, 0.3, 0.4).paint(material {{ color: 0.5, reflect: 0.3 }}) }}"
        ))
    };
    let own = WRITTEN_OUT.replace(
        "s.color * s.ambient * occlusion() + sum(lit) + s.emission",
        "mix(s.color * s.ambient + sum(lit), reflection(), s.reflect)",
    );
    // The first bounce is the same; at the last one the one sees the surface without its mirror, the other the sky's light in it.
    let (found, wanted) = (scene("reflect: 0.4", &own), scene("reflect: 0.4", "render { bounces: 16 }"));
    let far_apart =
        found.iter().zip(&wanted).filter(|(a, b)| (0..3).any(|k| (a[k] - b[k]).abs() > 0.01)).count();
    assert!(far_apart * 50 < found.len(), "{far_apart} of {}", found.len());
    let bare = scene("reflect: 0", "");
    let mirrored =
        bare.iter().zip(&wanted).filter(|(a, b)| (0..3).any(|k| (a[k] - b[k]).abs() > 0.01)).count();
    assert!(mirrored * 20 > found.len(), "{mirrored} of {}", found.len());
}

/// What the pixels of a scene show, judged by the certifier.
fn judged(text: &str) -> Report {
    let options = Options { attack: Some(0), probe: true, certificate: true, ..Options::default() };
    let scene = scene(text, text, &options);
    let frame = Frame::new(96, 54);
    let (certificate, probe) = (scene.certificate.expect("asked for"), scene.probe.expect("asked for"));
    let functions = Functions { map: scene.map, ray: certificate.ray, step: certificate.step };
    let found = interpreted(&scene.program, probe, &frame);
    let picture = Picture { width: 96, found: &found, steps: 1 };
    Certifier::new(&scene.program, functions, &frame).judge_picture(&picture, |_| {})
}

#[test]
fn parallel_rays_meet_what_they_must() {
    let scene = |camera: &str| {
        format!(
            "camera {{ eye: (6, 5, 8), target: (0.2, 0.8, 0), fov: 24deg, {camera} projection: orthographic }}
            scene {{ plane(), sphere(0.8).at(0, 0.8, 0), (box(0.4) - sphere(0.45)).at(1.5, 0.4, 0.6), smin(sphere(0.3), torus(0.4, 0.1), k: 0.2).at(-1.4, 0.3, 0.5) }}"
        )
    };
    for camera in ["", "up: (1, 1, 0),", "orbit: true,"] {
        let report = judged(&scene(camera));
        assert!(report.is_right() && report.out_of_steps.count == 0, "{camera}: {report:?}");
        assert_eq!(report.wrong_normals.count, 0, "{camera}: {report:?}");
        assert!(report.ambiguous.count * 200 <= report.pixels, "{camera}: {report:?}");
    }
}

/// The height of the picture is twice the distance from eye to target times the tangent of half the field of view, and what is
/// farther away is not smaller.
#[test]
fn parallel_rays_keep_sizes() {
    let seen = |z: f64| {
        let text = format!(
            "camera {{ eye: (0, 0, 10), target: 0, fov: 2 * atan(0.2), projection: orthographic }}
            scene {{ box((1, 0.5, 1)).at(0.5, 0, {z}) }}"
        );
        seen(&text)
    };
    for z in [0.0, -50.0] {
        let seen = seen(z);
        let width = VIEW.size[0] as usize;
        let found: Vec<(usize, usize)> =
            (0..seen.len()).filter(|i| seen[*i].depth >= 0.0).map(|i| (i % width, i / width)).collect();
        let range = |values: Vec<usize>| (*values.iter().min().unwrap(), *values.iter().max().unwrap());
        // 45 rows for a height of 4: of the box, from -0.5 to 0.5, 11; and from x = -0.5 to 1.5 of the columns.
        assert_eq!(range(found.iter().map(|p| p.0).collect()), (34, 56), "columns at {z}");
        assert_eq!(range(found.iter().map(|p| p.1).collect()), (17, 27), "rows at {z}");
        let depth = 10.0 - z as f32 - 1.0;
        assert!(found.iter().all(|(x, y)| (seen[y * width + x].depth - depth).abs() < 0.02), "depth at {z}");
    }
}

#[test]
fn sampled_normals_are_those_of_the_surface() {
    let with =
        |normals: &str| VIEW.seen(&format!("render {{ normals: {normals} }} {BARE}"), &Options::default());
    let exact = with("exact");
    for (normals, most) in [("central", 0.1), ("tetrahedron", 3.0)] {
        let angles: Vec<f64> = with(normals)
            .iter()
            .zip(&exact)
            .filter(|(_, exact)| exact.depth >= 0.0)
            .map(|(a, b)| {
                dot(a.normal.map(f64::from), b.normal.map(f64::from)).clamp(-1.0, 1.0).acos().to_degrees()
            })
            .collect();
        let far = angles.iter().filter(|angle| **angle > most).count();
        // At the edges of the box they are those of both sides.
        assert!(
            far * 25 < angles.len(),
            "{normals}: {far} of {} are off by more than {most} degrees",
            angles.len()
        );
        assert!(angles.iter().any(|angle| *angle > 1e-5), "{normals} are exact ones");
    }
}

/// Text behind the first `{` of each block of a kind.
fn added(text: &str, block: &str, fields: &str) -> String {
    let mut out = String::new();
    for line in text.split_inclusive('\n') {
        match line.find('{') {
            Some(at)
                if line.trim_start().starts_with(block)
                    && !line[at..].contains(fields.split(':').next().unwrap_or(fields)) =>
            {
                out += &format!("{} {fields}, {}", &line[..=at], &line[at + 1..]);
            }
            _ => out += line,
        }
    }
    out
}

/// Uses of each effect that are statically zero, added to a file.
fn zero_uses(text: &str) -> Vec<(&'static str, String)> {
    let has = |block: &str| text.lines().any(|line| line.trim_start().starts_with(block));
    let mut uses = vec![
        (
            "materials that nothing wears",
            format!("{text}\nmaterial zz {{ reflect: 1, transmit: 0.5, glow: 1, emission: 2 }}\n"),
        ),
        (
            "shapes that the scene does not have",
            format!("{text}\nlet zz = sphere(time).paint(material {{ glow: 1 }})\n"),
        ),
        ("glow", added(text, "material", "glow: 0, glow_radius: 2")),
        ("reflection", added(text, "material", "reflect: 0 * 3")),
        ("transmission", added(text, "material", "transmit: 0, ior: 1.2")),
        ("emission", added(text, "material", "emission: #000")),
    ];
    // A file without lights has a sun, which goes if there is any other.
    if has("light") {
        uses.push((
            "a light",
            format!(
                "{text}\nlight zz {{ position: (1, 2, 3), color: time, intensity: 0, shadow: soft(4) }}\n"
            ),
        ));
        uses.push((
            "a black light",
            format!("{text}\nlight zz {{ direction: (1, 2, 3), color: #000, shadow: hard }}\n"),
        ));
    }
    for (block, fields) in [
        ("fog", "density: 0"),
        ("fog", "density: 0, color: #f00"),
        ("rim", "color: #000, power: 5"),
        ("ambient", "occlusion: 0"),
        ("ambient", "occlusion: 0, radius: 3"),
        ("render", "antialias: 1"),
        ("render", "bounces: 7"),
        ("render", "tonemap: none"),
        ("camera", "orbit: 1 > 2"),
    ] {
        let with =
            if has(block) { added(text, block, fields) } else { format!("{text}\n{block} {{ {fields} }}\n") };
        // An example may use it.
        uses.push((block, with));
    }
    uses
}

#[test]
fn what_is_zero_leaves_no_trace() {
    let texts = |text: &str| -> Vec<String> {
        let compiled = sdfc::compile(
            "scene.sdf",
            text,
            &Options { attack: Some(0), ..Options::default() },
            &mut sdfc::Clock::default(),
        );
        let said: Vec<&String> = compiled.diagnostics.iter().map(|d| &d.message).collect();
        let (_, shader) = compiled.output.as_ref().unwrap_or_else(|| panic!("{text}: {said:?}"));
        let no_comments = |text: String| {
            text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
        };
        [Target::Wgsl, Target::Shadertoy, Target::GlslEs]
            .map(|target| no_comments(shader.text(target).expect("a text")))
            .to_vec()
    };
    let mut compared = 0;
    for example in all_examples() {
        let plain = texts(&example.text);
        for (what, text) in zero_uses(&example.text) {
            if text == example.text {
                continue;
            }
            compared += 1;
            assert!(texts(&text) == plain, "{what}, which is zero, changes {}:\n{text}", example.name);
        }
    }
    println!("{compared} texts");
    assert!(compared > 120, "{compared}");
    // What is not zero does.
    let text = &all_examples()[0].text;
    assert!(texts(&format!("{text}\nfog {{ density: 1e-3 }}\n")) != texts(text));
}
