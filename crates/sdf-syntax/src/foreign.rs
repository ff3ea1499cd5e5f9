//! Names of other languages and tools, each with what to write instead. They are plain names to the parser; the
//! checker asks here when it knows no definition.

/// What the language calls a function, constant or type of GLSL, Shadertoy, HLSL or another tool for distance
/// fields, as a hint; `None` for a name that is not known from elsewhere.
pub fn foreign_name(name: &str) -> Option<&'static str> {
    Some(match name {
        "mod" | "fmod" => "write the floor modulo as `a % b`",
        "iTime" | "u_time" | "iGlobalTime" | "uTime" => "the seconds are `time`",
        "iMouse" | "u_mouse" | "uMouse" => "the mouse is `mouse`, from (0, 0) to (1, 1)",
        "iResolution" | "u_resolution" | "iFrame" | "iTimeDelta" | "fragCoord" | "gl_FragCoord" => {
            "a scene does not depend on the picture; the camera is set in `camera { … }`"
        }
        "vec2" | "float2" => "write a vector as `(x, y)`",
        "vec3" | "float3" => "write a vector as `(x, y, z)`",
        "vec4" | "float4" | "mat2" | "mat3" | "mat4" => {
            "the types are float, vec2 and vec3; turn with `rotate`"
        }
        "float" | "int" | "uint" | "double" | "f32" => "every number is a float: leave the conversion out",
        "lerp" => "the function is `mix(a, b, t)`",
        "saturate" => "write `clamp(a, 0, 1)`",
        "frac" => "the function is `fract(a)`",
        "atan2" => "the function is `atan(y, x)`",
        "rsqrt" | "inversesqrt" => "write `1 / sqrt(a)`",
        "radians" => "write an angle with its unit, `45deg`, or multiply by `1deg`",
        "degrees" => "divide by `1deg`",
        "ceiling" => "the function is `ceil(a)`",
        "sqr" | "square" => "write `a * a`",
        "magnitude" | "norm" => "the function is `length(a)`",
        "PI" | "M_PI" => "the constant is `pi`",
        "TAU" | "TWO_PI" => "the constant is `tau`",
        "opUnion" | "sdUnion" => "write the union as `a | b`",
        "opIntersection" | "opIntersect" | "intersect" => "write the intersection as `a & b`",
        "opSubtraction" | "opSubtract" | "opDifference" | "subtract" => "write the difference as `a - b`",
        "opSmoothUnion" | "smoothUnion" | "smooth_union" | "opSmin" | "sminPoly" => {
            "write `smin(a, b, k: 0.1)`"
        }
        "opSmoothIntersection" | "smoothIntersection" | "smooth_intersection" => "write `smax(a, b, k: 0.1)`",
        "opSmoothSubtraction" | "smoothSubtraction" | "smoothDifference" | "smooth_difference" => {
            "write `sdiff(a, b, k: 0.1)`"
        }
        "translate" | "move" | "opTranslate" => "move a shape with `s.at(x, y, z)`",
        "opRound" => "write `s.round(r)`",
        "opOnion" | "onion" => "write `s.shell(thickness)`",
        "opRep" | "opRepeat" | "opRepetition" => "write `s.repeat(x: 1, z: 1)`",
        "opTwist" => "write `s.twist(rate)`",
        "opExtrusion" => "write `s.extrude(h)`",
        "opRevolution" => "write `s.revolve(offset)`",
        "sdSphere" => "write `sphere(r)`",
        "sdBox" | "cube" => "write `box(half)`; the half-extents are a float or a vector",
        "sdTorus" => "write `torus(major, minor)`",
        "sdPlane" => "write `plane()`",
        "sdCylinder" | "sdCappedCylinder" => "write `cylinder(r, h)`",
        "sdCapsule" => "write `capsule(a, b, r)`",
        "texture" | "texture2D" => "there are no textures; colour with `checker`, `stripes` or `noise`",
        _ => return None,
    })
}
