//! Where each uniform lies in the uniform block: the rules of std140, which are also WGSL's.

use sdf_ir::{Constant, Program, Role, Type};

/// A member of the uniform block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformField {
    /// The uniform, an index into [`Program::uniforms`]; `None` for the resolution that the wrapper wants
    /// although the program does not.
    pub uniform: Option<usize>,
    /// Its type. A bool is a 32-bit integer in the block: 0 or 1.
    pub ty: Type,
    /// Where it begins, in bytes.
    pub offset: usize,
}

/// The uniform block of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct UniformLayout {
    /// The members, in the order of the program. The resolution comes last where the program has none.
    pub fields: Vec<UniformField>,
    /// The size in bytes, a multiple of 16.
    pub size: usize,
}

impl UniformLayout {
    /// The block of a program.
    pub fn of(program: &Program) -> UniformLayout {
        let mut members: Vec<(Option<usize>, Type)> = (0..)
            .zip(&program.uniforms)
            .filter(|(_, u)| u.role != Role::Setting)
            .map(|(i, u)| (Some(i), u.ty))
            .collect();
        if !program.uniforms.iter().any(|u| u.role == Role::Resolution) {
            members.push((None, Type::Vec2));
        }
        let mut end = 0;
        let fields = members
            .into_iter()
            .map(|(uniform, ty)| {
                let (size, align) = match ty {
                    Type::Bool | Type::Float => (4, 4),
                    Type::Vec2 => (8, 8),
                    Type::Vec3 => (12, 16),
                };
                let offset = usize::next_multiple_of(end, align);
                end = offset + size;
                UniformField { uniform, ty, offset }
            })
            .collect();
        UniformLayout { fields, size: end.next_multiple_of(16) }
    }

    /// The bytes of the block. `values` are those of the program's uniforms, in its order; `resolution` is the
    /// picture's width and height, for where the program has no uniform of that role.
    pub fn bytes(&self, resolution: [u32; 2], values: &[Constant]) -> Vec<u8> {
        let mut bytes = vec![0; self.size];
        for field in &self.fields {
            let value = match field.uniform {
                Some(i) => values[i],
                None => Constant::Vec2(resolution.map(f64::from)),
            };
            let words: Vec<u32> = match value {
                Constant::Bool(b) => vec![u32::from(b)],
                numbers => numbers.components().iter().map(|x| (*x as f32).to_bits()).collect(),
            };
            for (i, word) in words.iter().take(field.ty.size()).enumerate() {
                bytes[field.offset + 4 * i..][..4].copy_from_slice(&word.to_le_bytes());
            }
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::UniformLayout;
    use sdf_ir::{Constant, Program, Role, Type, Uniform};

    fn uniform(name: &str, ty: Type, role: Role) -> Uniform {
        Uniform { name: name.into(), ty, role, default: Constant::Float(0.0) }
    }

    #[test]
    fn std140() {
        let param = Role::Param { range: None, color: false };
        let program = Program {
            uniforms: vec![
                uniform("a", Type::Float, param),
                uniform("c", Type::Vec3, param),
                uniform("on", Type::Bool, param),
                uniform("mouse", Type::Vec2, Role::Mouse),
            ],
            ..Program::default()
        };
        let layout = UniformLayout::of(&program);
        let offsets: Vec<usize> = layout.fields.iter().map(|f| f.offset).collect();
        assert_eq!((offsets, layout.size), (vec![0, 16, 28, 32, 40], 48));
        let values = [
            Constant::Float(0.5),
            Constant::Vec3([1.0, 2.0, 3.0]),
            Constant::Bool(true),
            Constant::Vec2([0.25, 0.75]),
        ];
        let bytes = layout.bytes([640, 360], &values);
        let words: Vec<u32> = bytes.chunks(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect();
        let f = f32::to_bits;
        let expected = [f(0.5), 0, 0, 0, f(1.0), f(2.0), f(3.0), 1, f(0.25), f(0.75), f(640.0), f(360.0)];
        assert_eq!(words, expected);
    }
}
