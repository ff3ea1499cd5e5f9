//! The moments of a scene at which it is tried: as it is, with each param over its range, and at several times.

use sdf_ir::{Constant, Program, Role, Uniform};
use sdfc::Frame;

/// Where in its range a param is tried, both ends included.
const SHARES: [f64; 5] = [0.0, 0.17, 0.5, 0.83, 1.0];
/// When a scene that asks for the time is tried besides at 0, in seconds.
const TIMES: [f64; 7] = [0.5, 1.3, 2.9, 7.1, 31.0, 1000.0, 10_000.0];
/// Which colours a param that is one has, in linear light.
const COLORS: [[f64; 3]; 3] = [[0.0; 3], [1.0; 3], [0.8, 0.2, 0.05]];

/// A moment of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// What is other than in the scene as it is, as `size = 2`; empty where nothing is.
    pub name: String,
    /// The time and the values of params.
    pub frame: Frame,
}

/// The moments of a program's scene, the first as it is; pictures have this size.
pub fn moments(program: &Program, (width, height): (u32, u32)) -> Vec<Moment> {
    let still = Frame::new(width, height);
    let mut all = vec![Moment { name: String::new(), frame: still.clone() }];
    for uniform in &program.uniforms {
        if uniform.role == Role::Time {
            all.extend(TIMES.map(|time| Moment {
                name: format!("time = {time}"),
                frame: Frame { time, ..still.clone() },
            }));
        }
        for value in values(uniform) {
            let mut frame = still.clone();
            frame.params.insert(uniform.name.to_string(), value);
            all.push(Moment { name: format!("{} = {}", uniform.name, written(value)), frame });
        }
    }
    all
}

/// The values that a param is tried with, its default apart.
fn values(uniform: &Uniform) -> Vec<Constant> {
    let Role::Param { range, color } = &uniform.role else { return Vec::new() };
    let mut values = match (range, uniform.default) {
        (Some((lo, hi)), _) => SHARES.map(|share| Constant::Float(lo * (1.0 - share) + hi * share)).to_vec(),
        (None, Constant::Bool(default)) => vec![Constant::Bool(!default)],
        (None, Constant::Vec3(_)) if *color => COLORS.map(Constant::Vec3).to_vec(),
        _ => Vec::new(),
    };
    values.retain(|value| *value != uniform.default);
    values
}

/// A value as it is written in a scene, to three digits.
fn written(value: Constant) -> String {
    let number = |x: &f64| {
        let text = format!("{x:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    };
    match value {
        Constant::Bool(x) => x.to_string(),
        Constant::Float(x) => number(&x),
        _ => format!("({})", value.components().iter().map(number).collect::<Vec<_>>().join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_param_is_tried_over_its_range_and_the_time_at_eight() {
        let text = "
            param size = 0.5 in 0..1
            param open = true
            param paint = #fff
            scene { sphere(size).paint(paint).at(time, if open { 1 } else { 0 }, 0) }";
        let scene = sdf_lang::compile("a.sdf", text, &sdfc::Options::default()).scene.unwrap();
        let names: Vec<String> =
            moments(&scene.program, (4, 2)).into_iter().map(|moment| moment.name).collect();
        for name in
            ["", "size = 0", "size = 0.17", "size = 1", "open = false", "time = 10000", "paint = (0, 0, 0)"]
        {
            assert_eq!(names.iter().filter(|other| *other == name).count(), 1, "{name} in {names:?}");
        }
        assert_eq!(names.iter().filter(|name| name.starts_with("time")).count(), TIMES.len());
        assert_eq!(names.iter().filter(|name| name.starts_with("size")).count(), SHARES.len() - 1);
        assert!(!names.iter().any(|name| name == "paint = (1, 1, 1)"), "{names:?}");
    }
}
