//! The named constants on top of a text: one that is changed there is as if the scene said so.

use sdfc::{Accuracy, Clock, Options, Target, compile};
use std::path::Path;

/// The text of a scene with this accuracy, without its comments, in which numbers are told.
fn text(name: &str, source: &str, accuracy: Accuracy, target: Target) -> String {
    let options = Options { accuracy: Some(accuracy), ..Options::default() };
    let compiled = compile(name, source, &options, &mut Clock::default());
    let (_, shader) = compiled.output.unwrap_or_else(|| panic!("{name}: {:?}", compiled.diagnostics));
    let text = shader.text(target).unwrap();
    text.lines().filter(|line| !line.trim_start().starts_with("//")).map(|line| format!("{line}\n")).collect()
}

/// The text with another value for one of the constants on its top, and whether it has that.
fn changed(text: &str, name: &str, value: f64, target: Target) -> (String, bool) {
    let head = match target {
        Target::Wgsl => format!("const {name}: f32 = "),
        _ => format!("const float {name} = "),
    };
    let Some(start) = text.find(&head).map(|start| start + head.len()) else {
        return (text.to_string(), false);
    };
    let end = start + text[start..].find(';').unwrap();
    (format!("{}{:?}{}", &text[..start], value as f32, &text[end..]), true)
}

/// Every example with other constants is the text of the example with those settings, to the byte: no number that is made of
/// one of them stands anywhere else.
#[test]
fn a_constant_that_is_changed_is_a_setting() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let other = Accuracy {
        tolerance: 0.3,
        steps: 100,
        shadow_accuracy: 0.04,
        occlusion_samples: 9,
        ..Accuracy::default()
    };
    let values = [
        ("TOLERANCE", other.tolerance),
        ("STEPS", other.steps.into()),
        ("SHADOW_ACCURACY", other.shadow_accuracy),
        ("OCCLUSION_SAMPLES", other.occlusion_samples.into()),
    ];
    let mut met = [0; 4];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "sdf") {
            continue;
        }
        let (name, source) = (path.display().to_string(), std::fs::read_to_string(&path).unwrap());
        for target in [Target::Shadertoy, Target::Wgsl] {
            let mut edited = text(&name, &source, Accuracy::default(), target);
            for ((constant, value), met) in values.iter().zip(&mut met) {
                let is_there;
                (edited, is_there) = changed(&edited, constant, *value, target);
                *met += usize::from(is_there);
            }
            let wanted = text(&name, &source, other, target);
            let pairs = edited.lines().zip(wanted.lines());
            let differing = pairs.filter(|(edited, wanted)| edited != wanted).collect::<Vec<_>>();
            assert!(edited == wanted, "{name} for {target:?}: {differing:#?}");
        }
    }
    assert!(met.iter().all(|count| *count > 0), "constants that no example has: {met:?}");
}
