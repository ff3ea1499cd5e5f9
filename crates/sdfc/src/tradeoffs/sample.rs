//! What a small scene is measured to be, with figures of one's own, for tests.

use sdf_lang::{Accuracy, Quality};
use sdfc::tradeoff::{NEAR, Point, Row, Session, Subject, Time, Timing, Tradeoffs, frontier, settings};
use sdfc::{Clock, Frame, Options};
use std::time::Duration;

/// A scene whose own setting and presets have these times in milliseconds and these errors.
pub fn measured(figures: &[(f64, f64)]) -> Tradeoffs {
    let mut measured = untimed();
    let all = settings(Accuracy::default(), 1.0).into_iter().filter(|s| s.is_own || s.preset.is_some());
    let row = measured.rows[0].clone();
    let on_frontier =
        frontier(&figures.iter().map(|(time, error)| Some(point(*time, *error))).collect::<Vec<_>>());
    let rows = figures.iter().zip(all).zip(on_frontier).map(|(((time, error), setting), on_frontier)| {
        let milliseconds = |t: f64| Duration::from_secs_f64(t / 1e3);
        let (median, spread) = (milliseconds(*time), milliseconds(time / 10.0));
        let mut row = Row { setting, on_frontier, ..row.clone() };
        row.time = Some(Time { median, spread, wall: median, ratio: [1.0; 3], to_previous: [1.0; 3] });
        row.errors.rms = *error;
        row
    });
    measured.rows = rows.collect();
    let [device, clock] = ["a device", "a clock"];
    measured.timing = Some(Timing { device: device.into(), fallback: None, clock, size: (8, 4), rounds: 5 });
    measured
}

/// All presets, of which one is the scene's own setting.
pub fn presets() -> Tradeoffs {
    assert_eq!(Accuracy::default(), Quality::Balanced.accuracy());
    measured(&[(2.0, 1.0), (1.0, 4.0), (2.0, 1.0), (4.0, 0.3), (7.0, 0.1)])
}

/// A scene with its own setting alone, of which no time was taken.
pub fn untimed() -> Tradeoffs {
    let options = Options::default();
    let subject = Subject { name: "a.sdf", text: "scene { sphere(1) }", options: &options };
    let own = &settings(Accuracy::default(), 1.0)[..1];
    let session = Session::new(subject, Frame::new(8, 4), NEAR);
    session.measure(own, None, &|_| {}, &mut Clock::default()).expect("the scene has no mistakes")
}

fn point(time: f64, error: f64) -> Point {
    Point { time: [time, 0.0], error, evaluations: 1.0 }
}
