//! What was measured, as data: `--json` writes it as it is, and `--csv` writes its settings.

use crate::explain::Set;
use sdf_lang::{Accuracy, Coordinates, Correction};
use sdfc::tradeoff::{Bounds, Knob, Row, Timing, Tradeoffs};
use sdfc::{Options, Quality};
use serde::Serialize;
use serde_json::Value;

/// All that was measured of a scene.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The scene's file, as it was given.
    pub scene: String,
    /// The size of the pictures, in pixels.
    pub size: (u32, u32),
    /// Their time, in seconds.
    pub time: f64,
    /// The preset that was given beside the file.
    pub quality: Option<&'static str>,
    /// The params that are frozen.
    pub set: Vec<Set>,
    /// How times were taken, if they were.
    pub timing: Option<Timing>,
    /// What is known of the truth.
    pub truth: Truth,
    /// The name of the setting that the bounds choose, if there are any and one satisfies them.
    pub chosen: Option<String>,
    /// Each setting with what it costs and how far off it is, that first which times are compared with.
    pub settings: Vec<Measured>,
}

/// How many pixels a picture has; whether what they truly show is proved, or else only computed; and of how many it is not
/// known: they count as nobody's errors.
#[derive(Debug, Serialize)]
pub struct Truth {
    pub pixels: usize,
    pub proved: bool,
    pub undecided: usize,
}

/// A setting, measured. What the errors are [`Errors`](sdfc::tradeoff::Errors) says.
#[derive(Debug, Serialize)]
pub struct Measured {
    pub name: String,
    /// What it changes in the scene's own setting.
    pub knob: &'static str,
    pub preset: Option<&'static str>,
    /// Whether it is what the scene has by itself.
    pub own: bool,
    /// The time of a picture in the median; null if there was no time to take it.
    pub time_ms: Option<f64>,
    /// How far the quartiles of the times are apart.
    pub time_spread_ms: Option<f64>,
    pub evals_per_pixel: f64,
    pub steps_per_pixel: f64,
    pub out_of_steps: usize,
    pub false_hits: usize,
    pub false_misses: usize,
    pub depth_px_median: f64,
    pub depth_px_999: f64,
    pub depth_px_max: f64,
    /// What 99 % of the normals are less than off.
    pub normal_deg: f64,
    pub normal_deg_median: f64,
    pub normal_deg_max: f64,
    pub flicker: usize,
    pub rms: f64,
    pub visible: f64,
    pub aliasing: f64,
    pub on_frontier: bool,
    pub settings: Settings,
}

/// All of a setting, in the words of a scene.
#[derive(Debug, Serialize)]
pub struct Settings {
    pub tolerance: f64,
    pub steps: u32,
    pub relax: bool,
    pub normals: &'static str,
    pub shadow_accuracy: f64,
    pub occlusion_samples: u32,
    pub antialias: u32,
    /// `derived`, or the one factor of all steps, which no scene can ask for.
    pub correction: String,
    /// `chosen`, or `world` or `camera`, which no scene can ask for.
    pub coordinates: &'static str,
}

/// The columns of CSV: the keys of a setting as JSON, with those of its settings in their place.
const COLUMNS: [&str; 31] = [
    "name",
    "knob",
    "preset",
    "own",
    "time_ms",
    "time_spread_ms",
    "evals_per_pixel",
    "steps_per_pixel",
    "out_of_steps",
    "false_hits",
    "false_misses",
    "depth_px_median",
    "depth_px_999",
    "depth_px_max",
    "normal_deg",
    "normal_deg_median",
    "normal_deg_max",
    "flicker",
    "rms",
    "visible",
    "aliasing",
    "on_frontier",
    "tolerance",
    "steps",
    "relax",
    "normals",
    "shadow_accuracy",
    "occlusion_samples",
    "antialias",
    "correction",
    "coordinates",
];

impl Report {
    /// Of a scene that was measured.
    pub fn of(scene: &str, time: f64, options: &Options, bounds: &Bounds, measured: &Tradeoffs) -> Report {
        let chosen = if *bounds == Bounds::default() { None } else { bounds.choose(measured) };
        Report {
            scene: scene.to_string(),
            size: measured.size,
            time,
            quality: options.quality.map(Quality::word),
            set: options.set.iter().cloned().map(|(name, value)| Set { name, value }).collect(),
            timing: measured.timing.clone(),
            truth: Truth {
                pixels: measured.truth.pixels(),
                proved: measured.truth.is_proved,
                undecided: measured.truth.undecided(),
            },
            chosen: chosen.map(|place| measured.rows[place].setting.name.clone()),
            settings: measured.rows.iter().map(Measured::of).collect(),
        }
    }

    /// As one object of JSON, on a line.
    pub fn json(&self) -> String {
        let text = serde_json::to_string(self).expect("keys are strings, and nothing of it can fail");
        text + "\n"
    }

    /// The settings as CSV (RFC 4180, with plain ends of lines): a line of names, then a line each. What is null is empty.
    pub fn csv(&self) -> String {
        let mut out = COLUMNS.join(",") + "\n";
        for setting in &self.settings {
            let value = serde_json::to_value(setting).expect("keys are strings, and nothing of it can fail");
            let cells = COLUMNS.map(|column| cell(value.get(column).unwrap_or(&value["settings"][column])));
            out += &(cells.join(",") + "\n");
        }
        out
    }
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => quoted(text),
        other => other.to_string(),
    }
}

fn quoted(text: &str) -> String {
    match text.contains(['"', ',', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_string(),
    }
}

impl Measured {
    fn of(row: &Row) -> Measured {
        let errors = &row.errors;
        let [depth_px_median, depth_px_999, depth_px_max] = errors.depth;
        let [normal_deg_median, normal_deg, normal_deg_max] = errors.normal;
        Measured {
            name: row.setting.name.clone(),
            knob: knob(row.setting.knob),
            preset: row.setting.preset.map(|quality| quality.word()),
            own: row.setting.is_own,
            time_ms: row.time.map(|time| time.median.as_secs_f64() * 1e3),
            time_spread_ms: row.time.map(|time| time.spread.as_secs_f64() * 1e3),
            evals_per_pixel: row.evaluations,
            steps_per_pixel: row.steps,
            out_of_steps: errors.out_of_steps,
            false_hits: errors.false_hits,
            false_misses: errors.false_misses,
            depth_px_median,
            depth_px_999,
            depth_px_max,
            normal_deg,
            normal_deg_median,
            normal_deg_max,
            flicker: errors.flicker,
            rms: errors.rms,
            visible: errors.visible,
            aliasing: errors.aliasing,
            on_frontier: row.on_frontier,
            settings: Settings::of(&row.setting.accuracy),
        }
    }
}

impl Settings {
    fn of(accuracy: &Accuracy) -> Settings {
        Settings {
            tolerance: accuracy.tolerance,
            steps: accuracy.steps,
            relax: accuracy.relax,
            normals: accuracy.normals.word(),
            shadow_accuracy: accuracy.shadow_accuracy,
            occlusion_samples: accuracy.occlusion_samples,
            antialias: accuracy.antialias,
            correction: match accuracy.correction {
                Correction::Derived => "derived".into(),
                Correction::Factor(factor) => factor.to_string(),
            },
            coordinates: match accuracy.coordinates {
                Coordinates::Chosen => "chosen",
                Coordinates::World => "world",
                Coordinates::Camera => "camera",
            },
        }
    }
}

fn knob(knob: Knob) -> &'static str {
    match knob {
        Knob::Preset => "preset",
        Knob::Tolerance => "tolerance",
        Knob::Steps => "steps",
        Knob::Relaxation => "relaxation",
        Knob::Normals => "normals",
        Knob::Shadows => "shadows",
        Knob::Occlusion => "occlusion",
        Knob::Antialiasing => "antialiasing",
        Knob::Correction => "correction",
        Knob::Coordinates => "coordinates",
    }
}

#[cfg(test)]
mod tests {
    use super::{Report, quoted};
    use crate::tradeoffs::sample::{measured, untimed};
    use sdfc::Options;
    use sdfc::tradeoff::Bounds;
    use serde_json::Value;

    /// The keys of a setting, those of its settings in their place.
    fn keys(setting: &Value) -> Vec<String> {
        let own = setting.as_object().unwrap().iter().filter(|(_, value)| !value.is_object());
        let nested = setting["settings"].as_object().unwrap().iter();
        own.chain(nested).map(|(key, _)| key.clone()).collect()
    }

    #[test]
    fn columns_are_the_keys_of_json() {
        let report = Report::of(
            "a.sdf",
            0.5,
            &Options::default(),
            &Bounds::default(),
            &measured(&[(2.0, 1.0), (1.0, 4.0)]),
        );
        let json: Value = serde_json::from_str(&report.json()).unwrap();
        let csv = report.csv();
        let mut lines = csv.lines();
        let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
        let mut sorted = columns.clone();
        sorted.sort_unstable();
        let mut expected = keys(&json["settings"][0]);
        expected.sort_unstable();
        assert_eq!(sorted, expected);
        for (line, setting) in lines.zip(json["settings"].as_array().unwrap()) {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), columns.len(), "{line}");
            for (column, cell) in columns.iter().zip(cells) {
                let value = setting.get(column).unwrap_or(&setting["settings"][column]);
                let text = value.as_str().map_or_else(|| value.to_string(), str::to_string);
                assert_eq!(cell, if text == "null" { "" } else { &text }, "{column}");
            }
        }
        assert_eq!(csv.lines().count(), 3);
    }

    #[test]
    fn json_has_what_was_measured() {
        let measured = measured(&[(2.0, 1.5), (1.0, 4.0)]);
        let json: Value = serde_json::from_str(
            &Report::of("a.sdf", 0.5, &Options::default(), &Bounds::default(), &measured).json(),
        )
        .unwrap();
        let pixels = measured.truth.pixels();
        assert_eq!((&json["scene"], &json["time"]), (&"a.sdf".into(), &0.5.into()));
        assert_eq!((&json["size"], &json["truth"]["pixels"]), (&serde_json::json!([8, 4]), &pixels.into()));
        assert_eq!(json["timing"]["device"], "a device");
        let own = &json["settings"][0];
        assert_eq!((&own["own"], &own["preset"]), (&true.into(), &Value::Null));
        assert_eq!((&own["time_ms"], &own["time_spread_ms"]), (&2.0.into(), &0.2.into()));
        assert_eq!((&own["rms"], &own["settings"]["correction"]), (&1.5.into(), &"derived".into()));
        assert_eq!(json["settings"][1]["preset"], "draft");
    }

    #[test]
    fn where_there_is_no_time_nothing_stands() {
        let report = Report::of("a.sdf", 0.0, &Options::default(), &Bounds::default(), &untimed());
        let json: Value = serde_json::from_str(&report.json()).unwrap();
        assert_eq!((&json["timing"], &json["settings"][0]["time_ms"]), (&Value::Null, &Value::Null));
        let csv = report.csv();
        assert!(csv.lines().nth(1).unwrap().starts_with("as it is,preset,,true,,,"), "{csv}");
    }

    #[test]
    fn texts_stay_in_their_cells() {
        assert_eq!(quoted("tolerance 0.3"), "tolerance 0.3");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
