//! What effects cost in evaluations of the field, counted by the interpreter; `bin/effects.rs` times them.

use sdf_render::Frame;
use sdf_tests::prices::{ALL, EXAMPLES, IDLE, NONE, Priced, beyond_the_sum, counted};

#[test]
fn effects_together_cost_what_each_does() {
    for name in EXAMPLES {
        let priced = Priced::of(name);
        let shaders = priced.shaders();
        let means: Vec<f64> = counted(&shaders, &Frame::new(96, 54)).iter().map(|e| e.mean).collect();
        let mean = |wanted: &str| {
            means[priced.scenes.iter().position(|(what, _)| *what == wanted).expect("a scene")]
        };
        let beyond = beyond_the_sum(&priced.scenes, &means);
        println!(
            "{name}: {:.1} alone, {:.1} with all, {beyond:+.3} beyond the sum, {:.1} idle",
            mean(NONE),
            mean(ALL),
            mean(IDLE)
        );
        // The place on the surface is looked for once, by all that need it.
        assert!(beyond.abs() < 0.1, "{name}: {beyond}");
        // What is not called for costs nothing: idle effects cost nearly what those do that are seen.
        assert!(mean(IDLE) > 0.7 * mean(ALL), "{name}: {} idle, {} with all", mean(IDLE), mean(ALL));
    }
}
