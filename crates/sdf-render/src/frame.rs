//! What one picture of a program is drawn with.

use sdf_ir::{Constant, Program, Role};
use std::collections::BTreeMap;

/// The size of a picture, and the values of the uniforms.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Pixels from left to right.
    pub width: u32,
    /// Pixels from top to bottom.
    pub height: u32,
    /// Seconds, at least 0.
    pub time: f64,
    /// The pointer, 0..1 from the bottom left.
    pub mouse: [f64; 2],
    /// How the camera is turned about its target, in a program that allows it: the angles round `up` and towards
    /// it, in radians, and the factor of its distance.
    pub orbit: [f64; 3],
    /// Values of params by their names in the source; the others have their defaults.
    pub params: BTreeMap<String, Constant>,
}

impl Frame {
    /// A picture of this size at time 0, with the pointer in the middle, the camera as it is and every param at its default.
    pub fn new(width: u32, height: u32) -> Frame {
        Frame { width, height, time: 0.0, mouse: [0.5, 0.5], orbit: [0.0, 0.0, 1.0], params: BTreeMap::new() }
    }

    /// The value of each of the program's uniforms, in order. A param of another type than the program's is as
    /// good as none.
    pub fn uniforms(&self, program: &Program) -> Vec<Constant> {
        let value = |uniform: &sdf_ir::Uniform| match uniform.role {
            Role::Setting => uniform.default,
            Role::Time => Constant::Float(self.time),
            Role::Mouse => Constant::Vec2(self.mouse),
            Role::Orbit { .. } => Constant::Vec3(self.orbit),
            Role::Resolution => Constant::Vec2([f64::from(self.width), f64::from(self.height)]),
            Role::Param { .. } => {
                let set = self.params.get(&*uniform.name).filter(|value| value.ty() == uniform.ty);
                *set.unwrap_or(&uniform.default)
            }
        };
        program.uniforms.iter().map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sdf_ir::Uniform;

    #[test]
    fn each_role_has_its_value() {
        let uniform = |name: &str, role, default: Constant| Uniform {
            name: name.into(),
            ty: default.ty(),
            role,
            default,
        };
        let param = Role::Param { range: None, color: false };
        let program = Program {
            uniforms: vec![
                uniform("time", Role::Time, Constant::Float(0.0)),
                uniform("mouse", Role::Mouse, Constant::Vec2([0.5; 2])),
                uniform("size", Role::Resolution, Constant::Vec2([1.0; 2])),
                uniform("a", param, Constant::Float(1.0)),
                uniform("b", param, Constant::Bool(true)),
                uniform("c", param, Constant::Float(3.0)),
            ],
            ..Program::default()
        };
        let mut frame = Frame::new(4, 2);
        frame.time = 1.5;
        frame.params.insert("a".into(), Constant::Float(2.0));
        frame.params.insert("c".into(), Constant::Bool(false));
        let wanted = [
            Constant::Float(1.5),
            Constant::Vec2([0.5, 0.5]),
            Constant::Vec2([4.0, 2.0]),
            Constant::Float(2.0),
            Constant::Bool(true),
            Constant::Float(3.0),
        ];
        assert_eq!(frame.uniforms(&program), wanted);
    }
}
