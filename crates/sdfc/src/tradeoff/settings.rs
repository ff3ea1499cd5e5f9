//! Which settings a scene is measured with.

use sdf_lang::{Accuracy, Coordinates, Correction, Normals, Quality};

/// By how many pixels the camera is moved to see what flickers: 0.01, in no direction of the grid.
pub(super) const MOVE: [f64; 2] = [0.008, 0.006];

/// What a setting changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Knob {
    /// All at once: a preset, or what stands between two of them.
    Preset,
    /// How near to a surface a hit is.
    Tolerance,
    /// How many steps rays are given.
    Steps,
    /// Whether steps are relaxed.
    Relaxation,
    /// From what normals are found.
    Normals,
    /// How finely soft shadows are sampled.
    Shadows,
    /// How many samples occlusion has.
    Occlusion,
    /// How many rays a pixel has.
    Antialiasing,
    /// How steps are kept from passing through surfaces.
    Correction,
    /// What coordinates are relative to.
    Coordinates,
}

/// A setting that is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// What it is called, such as `tolerance 0.3`.
    pub name: String,
    /// What it changes in the scene's own setting.
    pub knob: Knob,
    /// All of it.
    pub accuracy: Accuracy,
    /// The preset that it is, if it is one.
    pub preset: Option<Quality>,
    /// Whether it is what the scene has by itself.
    pub is_own: bool,
}

impl Setting {
    /// Whether a scene can ask for it, and has as many rays a pixel then as with another one.
    pub fn is_like(&self, other: &Setting) -> bool {
        let Accuracy { correction, coordinates, antialias, .. } = self.accuracy;
        correction == Correction::Derived
            && coordinates == Coordinates::Chosen
            && antialias == other.accuracy.antialias
    }

    fn new(knob: Knob, name: impl Into<String>, accuracy: Accuracy) -> Setting {
        Setting { name: name.into(), knob, accuracy, preset: None, is_own: false }
    }
}

/// The settings among which one is chosen for a scene, its own first: the presets, and between two of them the coarser one with
/// the tolerance of the other. All have as many rays a pixel as the scene's own.
pub fn candidates(own: Accuracy) -> Vec<Setting> {
    let mut all = vec![Setting { is_own: true, ..Setting::new(Knob::Preset, "as it is", own) }];
    let with_rays = |accuracy: Accuracy| Accuracy { antialias: own.antialias, ..accuracy };
    let mut before: Option<Quality> = None;
    for quality in Quality::ALL {
        let accuracy = with_rays(quality.accuracy());
        if let Some(before) = before {
            let between = Accuracy { tolerance: accuracy.tolerance, ..with_rays(before.accuracy()) };
            let name = format!("{}, tolerance {}", before.word(), accuracy.tolerance);
            all.push(Setting::new(Knob::Preset, name, between));
        }
        all.push(Setting { preset: Some(quality), ..Setting::new(Knob::Preset, quality.word(), accuracy) });
        before = Some(quality);
    }
    all
}

/// The settings that a scene is measured with, its own first: those among which one is chosen, then one change of its own at a
/// time. `slope` is that of its field. Some may mean the same program.
pub fn settings(own: Accuracy, slope: f64) -> Vec<Setting> {
    let mut all = candidates(own);
    let mut change = |knob, name: String, accuracy| all.push(Setting::new(knob, name, accuracy));
    for tolerance in [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01] {
        change(Knob::Tolerance, format!("tolerance {tolerance}"), Accuracy { tolerance, ..own });
    }
    for steps in [64, 128, 256, 512] {
        change(Knob::Steps, format!("steps {steps}"), Accuracy { steps, ..own });
    }
    for relax in [true, false] {
        let word = if relax { "auto" } else { "none" };
        change(Knob::Relaxation, format!("relax {word}"), Accuracy { relax, ..own });
    }
    for normals in Normals::ALL {
        change(Knob::Normals, format!("normals {}", normals.word()), Accuracy { normals, ..own });
    }
    for shadow_accuracy in [0.06, 0.015, 0.004] {
        let accuracy = Accuracy { shadow_accuracy, ..own };
        change(Knob::Shadows, format!("shadow_accuracy {shadow_accuracy}"), accuracy);
    }
    for occlusion_samples in [3, 6, 12] {
        let accuracy = Accuracy { occlusion_samples, ..own };
        change(Knob::Occlusion, format!("occlusion_samples {occlusion_samples}"), accuracy);
    }
    for antialias in [1, 2, 4] {
        change(Knob::Antialiasing, format!("antialias {antialias}"), Accuracy { antialias, ..own });
    }
    let mut corrections = vec![("step correction derived", Correction::Derived)];
    if slope.is_finite() && slope > 1.0 {
        corrections.push(("one safe factor", Correction::Factor(1.0 / slope)));
        corrections.push(("factor 1", Correction::Factor(1.0)));
    }
    corrections.push(("factor 0.3", Correction::Factor(0.3)));
    for (name, correction) in corrections {
        change(Knob::Correction, name.into(), Accuracy { correction, ..own });
    }
    for (name, coordinates) in
        [("coordinates of the world", Coordinates::World), ("coordinates of the camera", Coordinates::Camera)]
    {
        change(Knob::Coordinates, name.into(), Accuracy { coordinates, ..own });
    }
    all
}

/// A setting, and those that have another value of one constant that emitted texts name, a coarser one and a finer one: each with
/// the name of that constant and its value.
pub fn neighbours(setting: &Setting) -> Vec<(Setting, Option<(&'static str, String)>)> {
    let now = setting.accuracy;
    let mut all = vec![(setting.clone(), None)];
    let mut change = |knob, name: &'static str, value: String, accuracy| {
        let changed = Setting::new(knob, format!("{name} {value}"), accuracy);
        all.push((changed, Some((name, value))));
    };
    // To two digits, as people write them.
    let rounded = |x: f64| format!("{x:.1e}").parse::<f64>().unwrap_or(x);
    for factor in [4.0, 0.25] {
        let tolerance = rounded((now.tolerance * factor).clamp(1e-4, 100.0));
        change(Knob::Tolerance, "tolerance", tolerance.to_string(), Accuracy { tolerance, ..now });
        let steps = (f64::from(now.steps) / factor).clamp(1.0, 4096.0) as u32;
        change(Knob::Steps, "steps", steps.to_string(), Accuracy { steps, ..now });
        let shadow_accuracy = rounded((now.shadow_accuracy * factor).clamp(1e-4, 1.0));
        let accuracy = Accuracy { shadow_accuracy, ..now };
        change(Knob::Shadows, "shadow_accuracy", shadow_accuracy.to_string(), accuracy);
        let occlusion_samples = (f64::from(now.occlusion_samples) / factor.sqrt()).clamp(1.0, 256.0) as u32;
        let accuracy = Accuracy { occlusion_samples, ..now };
        change(Knob::Occlusion, "occlusion_samples", occlusion_samples.to_string(), accuracy);
    }
    all.retain(|(other, changed)| changed.is_none() || other.accuracy != now);
    all
}

/// What is changed, and how it is taken over from another setting.
type Change = (Knob, fn(&mut Accuracy, Accuracy));

/// The way from one setting to another, a change at a time: each with what was changed last. Both ends are in it.
pub fn walk(from: &Setting, to: &Setting) -> Vec<Setting> {
    let end = to.accuracy;
    let changes: [Change; 9] = [
        (Knob::Correction, |a, b| a.correction = b.correction),
        (Knob::Relaxation, |a, b| a.relax = b.relax),
        (Knob::Normals, |a, b| a.normals = b.normals),
        (Knob::Tolerance, |a, b| a.tolerance = b.tolerance),
        (Knob::Steps, |a, b| a.steps = b.steps),
        (Knob::Shadows, |a, b| a.shadow_accuracy = b.shadow_accuracy),
        (Knob::Occlusion, |a, b| a.occlusion_samples = b.occlusion_samples),
        (Knob::Antialiasing, |a, b| a.antialias = b.antialias),
        (Knob::Coordinates, |a, b| a.coordinates = b.coordinates),
    ];
    let mut way = vec![from.clone()];
    let mut now = from.accuracy;
    for (knob, change) in changes {
        let before = now;
        change(&mut now, end);
        if now != before {
            way.push(Setting::new(knob, changed(&now, &before), now));
        }
    }
    way
}

/// What of a setting is other than in one before, as a scene says it.
fn changed(now: &Accuracy, before: &Accuracy) -> String {
    let fields: Vec<String> =
        now.fields_beside(before).into_iter().map(|(name, value)| format!("{name} {value}")).collect();
    if fields.is_empty() { "what no scene can ask for is left".into() } else { fields.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_changes_one_thing_at_a_time_and_ends_where_it_should() {
        let exact = Quality::Exact.accuracy();
        let from = Setting::new(
            Knob::Preset,
            "as it is",
            Accuracy { relax: false, normals: Normals::Central, antialias: 2, ..Quality::Draft.accuracy() },
        );
        let to = Setting::new(Knob::Preset, "exact", Accuracy { antialias: 2, ..exact });
        let way = walk(&from, &to);
        assert_eq!(way[0], from);
        assert_eq!(way.last().map(|setting| setting.accuracy), Some(to.accuracy));
        let mut knobs: Vec<Knob> = way[1..].iter().map(|setting| setting.knob).collect();
        assert!(knobs.contains(&Knob::Relaxation) && knobs.contains(&Knob::Normals), "{knobs:?}");
        knobs.dedup();
        assert_eq!(knobs.len(), way.len() - 1, "each is changed once");
        assert_eq!(walk(&to, &to), [to]);
    }

    #[test]
    fn candidates_keep_the_rays_of_the_scene() {
        let own = Accuracy { antialias: 3, tolerance: 0.7, ..Accuracy::default() };
        let all = candidates(own);
        assert!(all[0].is_own && all[0].accuracy == own);
        assert!(all.iter().all(|setting| setting.accuracy.antialias == 3));
        assert_eq!(all.iter().filter(|setting| setting.preset.is_some()).count(), 4);
    }

    #[test]
    fn where_nothing_is_steep_there_is_no_factor_to_find() {
        let names = |slope| -> Vec<String> {
            settings(Accuracy::default(), slope).into_iter().map(|setting| setting.name).collect()
        };
        let is_there = |slope, name: &str| names(slope).iter().any(|other| other == name);
        assert!(is_there(2.0, "one safe factor") && is_there(2.0, "factor 1") && is_there(2.0, "factor 0.3"));
        assert!(!is_there(1.0, "one safe factor") && is_there(1.0, "factor 0.3"));
        assert!(!is_there(f64::INFINITY, "one safe factor"));
    }
}
