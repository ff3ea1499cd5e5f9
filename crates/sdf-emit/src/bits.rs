//! The operations on the bits of floats: one text a language, which mirrors `sdf_ir::bits` line by line. Each is a
//! function of floats; one of vectors calls it for every component.

use crate::dialect::Dialect;
use sdf_ir::{Type, Unary};

/// The texts of one language.
pub(crate) struct Texts {
    power_of_two: &'static str,
    exponent: &'static str,
    mantissa: &'static str,
    reduce_angle: &'static str,
    /// One word into the hash; the functions that callers use are made from it.
    hash_word: &'static str,
}

/// The names that the texts define, vectors' apart.
pub(crate) const NAMES: [&str; 6] =
    ["power_of_two", "exponent", "mantissa", "reduce_angle", "hash_word", "hash"];

/// The name of the function that computes the operation, if it is one on bits.
pub(crate) fn name(op: Unary, ty: Type) -> Option<String> {
    let name = match op {
        Unary::PowerOfTwo => "power_of_two",
        Unary::Exponent => "exponent",
        Unary::Mantissa => "mantissa",
        Unary::ReduceAngle => "reduce_angle",
        Unary::Hash => "hash",
        _ => return None,
    };
    Some(match ty {
        Type::Bool | Type::Float => name.to_owned(),
        Type::Vec2 => format!("{name}_vec2"),
        Type::Vec3 => format!("{name}_vec3"),
    })
}

/// The functions for these operations, each with what it needs, in a fixed order. Sorted and without repetition.
pub(crate) fn functions(dialect: &Dialect, used: &[(Unary, Type)]) -> Vec<String> {
    let texts = dialect.bits;
    let mut out = Vec::new();
    for op in [Unary::PowerOfTwo, Unary::Exponent, Unary::Mantissa, Unary::ReduceAngle, Unary::Hash] {
        let types = || used.iter().filter(move |(o, _)| *o == op).map(|(_, ty)| *ty);
        if types().next().is_none() {
            continue;
        }
        out.push(match op {
            Unary::PowerOfTwo => texts.power_of_two.to_owned(),
            Unary::Exponent => texts.exponent.to_owned(),
            Unary::Mantissa => texts.mantissa.to_owned(),
            Unary::ReduceAngle => texts.reduce_angle.to_owned(),
            _ => texts.hash_word.to_owned(),
        });
        for ty in types() {
            if op == Unary::Hash {
                out.push(hash(dialect, ty));
            } else if ty.is_vector() {
                out.push(component_by_component(dialect, op, ty));
            }
        }
    }
    out
}

const COMPONENTS: [&str; 3] = ["v.x", "v.y", "v.z"];

fn component_by_component(dialect: &Dialect, op: Unary, ty: Type) -> String {
    let scalar = name(op, Type::Float).expect("an operation on bits");
    let calls: Vec<String> = COMPONENTS[..ty.size()].iter().map(|c| format!("{scalar}({c})")).collect();
    let head = head(dialect, op, ty, ty);
    format!("{head} {{\n    return {}({});\n}}\n", dialect.ty(ty), calls.join(", "))
}

fn hash(dialect: &Dialect, ty: Type) -> String {
    let components = if ty.is_vector() { &COMPONENTS[..ty.size()] } else { &["v"] };
    let word = components.iter().fold("0u".to_owned(), |word, c| format!("hash_word({word}, {c})"));
    let head = head(dialect, Unary::Hash, ty, Type::Float);
    format!("{head} {{\n    return {}({word} >> 8u) * 5.9604645e-8;\n}}\n", dialect.float)
}

fn head(dialect: &Dialect, op: Unary, ty: Type, result: Type) -> String {
    let name = name(op, ty).expect("an operation on bits");
    (dialect.function)(&name, &(dialect.declare)(dialect.ty(ty), "v"), Some(dialect.ty(result)))
}

pub(crate) static GLSL: Texts = Texts {
    power_of_two: "\
// 2 to the power of a whole number from -126 to 127.
float power_of_two(float x) {
    return uintBitsToFloat(uint(int(x) + 127) << 23u);
}
",
    exponent: "\
// The exponent of a positive normal number.
float exponent(float x) {
    return float(int(floatBitsToUint(x) >> 23u) - 127);
}
",
    mantissa: "\
// The mantissa of a positive normal number, at least 1 and below 2.
float mantissa(float x) {
    return uintBitsToFloat((floatBitsToUint(x) & 0x007fffffu) | 0x3f800000u);
}
",
    reduce_angle: "\
// The angle as (r, q): r + q * pi / 2 and whole turns, r at most pi / 4 either way, q one of 0, 1, 2, 3.
vec2 reduce_angle(float x) {
    float a = min(abs(x), 2147483648.0);
    float hi = floor(a);
    float lo = (a - hi) * 16777216.0;
    uint turn = uint(hi) * 683565275u + uint(hi * 0.5764316) + uint(lo) * 40u + uint(lo * 0.74366546);
    uint quarter = (turn + 0x20000000u) >> 30u;
    int rest = int(turn - (quarter << 30u));
    float r = (float(rest >> 5) * 32.0 + float(rest & 31)) * 1.4629181e-9;
    if (a < 0.7853982) {
        return vec2(x, 0.0);
    }
    if (x < 0.0) {
        return vec2(-r, float((4u - quarter) & 3u));
    }
    return vec2(r, float(quarter));
}
",
    hash_word: "\
// One word into a hash of well mixed bits (PCG; Jarzynski, Olano 2020). -0 counts as 0.
uint hash_word(uint h, float x) {
    uint w = floatBitsToUint(x);
    uint s = (h ^ (w == 0x80000000u ? 0u : w)) * 747796405u + 2891336453u;
    uint t = ((s >> ((s >> 28u) + 4u)) ^ s) * 277803737u;
    return (t >> 22u) ^ t;
}
",
};

pub(crate) static WGSL: Texts = Texts {
    power_of_two: "\
// 2 to the power of a whole number from -126 to 127.
fn power_of_two(x: f32) -> f32 {
    return bitcast<f32>(u32(i32(x) + 127) << 23u);
}
",
    exponent: "\
// The exponent of a positive normal number.
fn exponent(x: f32) -> f32 {
    return f32(i32(bitcast<u32>(x) >> 23u) - 127);
}
",
    mantissa: "\
// The mantissa of a positive normal number, at least 1 and below 2.
fn mantissa(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) & 0x007fffffu) | 0x3f800000u);
}
",
    reduce_angle: "\
// The angle as (r, q): r + q * pi / 2 and whole turns, r at most pi / 4 either way, q one of 0, 1, 2, 3.
fn reduce_angle(x: f32) -> vec2f {
    let a = min(abs(x), 2147483648.0);
    let hi = floor(a);
    let lo = (a - hi) * 16777216.0;
    let turn = u32(hi) * 683565275u + u32(hi * 0.5764316) + u32(lo) * 40u + u32(lo * 0.74366546);
    let quarter = (turn + 0x20000000u) >> 30u;
    let rest = i32(turn - (quarter << 30u));
    let r = (f32(rest >> 5u) * 32.0 + f32(rest & 31)) * 1.4629181e-9;
    if (a < 0.7853982) {
        return vec2f(x, 0.0);
    }
    if (x < 0.0) {
        return vec2f(-r, f32((4u - quarter) & 3u));
    }
    return vec2f(r, f32(quarter));
}
",
    hash_word: "\
// One word into a hash of well mixed bits (PCG; Jarzynski, Olano 2020). -0 counts as 0.
fn hash_word(h: u32, x: f32) -> u32 {
    let w = bitcast<u32>(x);
    let s = (h ^ select(w, 0u, w == 0x80000000u)) * 747796405u + 2891336453u;
    let t = ((s >> ((s >> 28u) + 4u)) ^ s) * 277803737u;
    return (t >> 22u) ^ t;
}
",
};
