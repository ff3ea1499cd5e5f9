//! The block `render`: what trades accuracy for time, and what is done with the picture.

use super::Block;
use crate::Options;
use crate::accuracy::{Accuracy, Correction, Normals, Quality, RELAX};
use crate::eval::{Elaborator, Eval};
use crate::ranges::Range;
use crate::value::Value;
use sdf_ir::{Constant, Role, Type, Uniform};
use sdf_syntax::tree::SettingsKind;
use std::sync::Arc;

/// Its fields, in the order of the language's page.
pub(super) const RENDER: &[&str] = &[
    "tolerance",
    "steps",
    "far",
    "normals",
    "relax",
    "shadow_accuracy",
    "occlusion_samples",
    "bounces",
    "antialias",
    "tonemap",
    "quality",
];

/// How far rays go where a file does not say, and how often they go on.
const DEFAULT_FAR: f64 = 100.0;
const DEFAULT_BOUNCES: f64 = 2.0;

/// What `tonemap` may be; the first is what it is where a file does not say.
const TONEMAPS: [&str; 2] = ["none", "aces"];

/// What a setting of a block is where a file does not say, as it is written, if that is a number or a word of `render`.
pub(crate) fn default_of(block: &str, name: &str) -> Option<String> {
    if block != "render" {
        return None;
    }
    Some(match name {
        "far" => DEFAULT_FAR.to_string(),
        "bounces" => DEFAULT_BOUNCES.to_string(),
        "tonemap" => TONEMAPS[0].into(),
        "quality" => Quality::Balanced.word().into(),
        _ => Accuracy::default().fields().into_iter().find(|(field, _)| *field == name)?.1,
    })
}

/// The values that its settings may have.
const TOLERANCE: Range = Range { accepts: |x| (1e-4..=100.0).contains(&x), words: "0.0001 to 100 pixels" };
const STEPS: Range = Range {
    accepts: |x| (1.0..=4096.0).contains(&x) && x.fract() == 0.0,
    words: "a whole number from 1 to 4096",
};
const FAR: Range = Range { accepts: |x| (1e-6..=1e18).contains(&x), words: "1e-6 to 1e18" };
const ANTIALIAS: Range =
    Range { accepts: |x| (1.0..=8.0).contains(&x) && x.fract() == 0.0, words: "a whole number from 1 to 8" };
const SHADOW_ACCURACY: Range = Range {
    accepts: |x| (1e-4..=1.0).contains(&x),
    words: "0.0001 to 1, the share of the light that may be missed",
};
const OCCLUSION_SAMPLES: Range = Range {
    accepts: |x| (1.0..=256.0).contains(&x) && x.fract() == 0.0,
    words: "a whole number from 1 to 256",
};
const BOUNCES: Range = Range {
    accepts: |x| (0.0..=16.0).contains(&x) && x.fract() == 0.0,
    words: "a whole number from 0 to 16",
};

impl<'t> Elaborator<'t> {
    /// A setting that the emitted text keeps as a constant with a name, for a reader to change.
    fn named_constant(&mut self, name: &str, value: f64) -> Value<'t> {
        let (name, default) = (Arc::from(name), Constant::Float(value));
        Value::Number(self.contexts.uniform(Uniform { name, ty: Type::Float, role: Role::Setting, default }))
    }

    pub(super) fn render_settings(&mut self, options: &Options) -> Eval<Value<'t>> {
        let block = self.settings_block(SettingsKind::Render, "render", RENDER);
        // All are looked at before the first mistake ends it, so that all mistakes are reported.
        let own = self.accuracy_settings(&block, options);
        // A camera that frames a large scene stands far away from it.
        let default_far = self.framed.map_or(DEFAULT_FAR, |reach| reach.max(DEFAULT_FAR));
        let far = self.static_setting(&block, "far", default_far, FAR);
        let tonemap = self.word_setting(&block, "tonemap", &TONEMAPS, TONEMAPS[0]);
        let bounces = self.static_setting(&block, "bounces", DEFAULT_BOUNCES, BOUNCES);
        let (own, far, tonemap, bounces) = (own?, far?, tonemap?, bounces?);
        self.bounces = bounces > 0.0;
        let accuracy = options.accuracy.unwrap_or(own);
        self.accuracy = accuracy;
        if options.accuracy.is_some() {
            self.quality = None;
        }
        let factor = match accuracy.correction {
            Correction::Derived => None,
            Correction::Factor(factor) => Some(factor),
        };
        Ok(Value::record(vec![
            (Arc::from("tolerance"), self.named_constant("tolerance", accuracy.tolerance)),
            (Arc::from("steps"), self.named_constant("steps", accuracy.steps.into())),
            (Arc::from("far"), self.named_constant("far", far)),
            (Arc::from("relax"), Value::bool(accuracy.relax)),
            (Arc::from("aces"), Value::bool(tonemap == "aces")),
            (Arc::from("central"), Value::bool(accuracy.normals == Normals::Central)),
            (Arc::from("tetrahedron"), Value::bool(accuracy.normals == Normals::Tetrahedron)),
            (Arc::from("shadow_accuracy"), self.named_constant("shadow_accuracy", accuracy.shadow_accuracy)),
            (
                Arc::from("occlusion_samples"),
                self.named_constant("occlusion_samples", accuracy.occlusion_samples.into()),
            ),
            (Arc::from("antialias"), Value::float(accuracy.antialias.into())),
            (Arc::from("bounces"), Value::float(bounces)),
            (Arc::from("scaled"), Value::bool(factor.is_some_and(|factor| factor != 1.0))),
            (Arc::from("factor"), Value::float(factor.unwrap_or(1.0))),
        ]))
    }

    /// What a block `render` says about accuracy: a preset, of which its other fields may change some.
    fn accuracy_settings(&mut self, block: &Block<'t>, options: &Options) -> Eval<Accuracy> {
        let qualities = Quality::ALL.map(Quality::word);
        let quality = self.word_setting(block, "quality", &qualities, Quality::Balanced.word());
        let own = quality.as_ref().ok().filter(|_| block.fields.contains_key("quality"));
        let own = own.and_then(|word| Quality::ALL.into_iter().find(|quality| quality.word() == *word));
        self.quality = options.quality.or(own);
        let default = self.quality.unwrap_or(Quality::Balanced).accuracy();
        let tolerance = self.static_setting(block, "tolerance", default.tolerance, TOLERANCE);
        let steps = self.static_setting(block, "steps", default.steps.into(), STEPS);
        let normals =
            self.word_setting(block, "normals", &Normals::ALL.map(Normals::word), default.normals.word());
        let relax = self.word_setting(block, "relax", &RELAX, RELAX[usize::from(!default.relax)]);
        let shadow_accuracy =
            self.static_setting(block, "shadow_accuracy", default.shadow_accuracy, SHADOW_ACCURACY);
        let samples = default.occlusion_samples.into();
        let occlusion_samples = self.static_setting(block, "occlusion_samples", samples, OCCLUSION_SAMPLES);
        let antialias = self.static_setting(block, "antialias", default.antialias.into(), ANTIALIAS);
        quality?;
        let normals = normals?;
        Ok(Accuracy {
            tolerance: tolerance?,
            steps: steps? as u32,
            relax: relax? == RELAX[0],
            normals: Normals::ALL.into_iter().find(|kind| kind.word() == normals).unwrap_or(default.normals),
            shadow_accuracy: shadow_accuracy?,
            occlusion_samples: occlusion_samples? as u32,
            antialias: antialias? as u32,
            ..default
        })
    }
}
