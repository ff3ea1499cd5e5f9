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

/// What the language calls a setting of other tools, as a hint; `None` for a name that is not known from elsewhere.
pub fn foreign_setting(block: &str, name: &str) -> Option<&'static str> {
    let plain = name.replace('_', "").to_lowercase();
    Some(match (block, plain.as_str()) {
        ("camera", "position" | "pos" | "from" | "origin" | "location") => "the camera's place is `eye`",
        ("camera", "lookat" | "look" | "to" | "center" | "focus" | "at") => "what it looks at is `target`",
        ("camera", "angle" | "zoom" | "fieldofview" | "focallength") => "the angle of view is `fov`",
        ("camera", "rotate" | "orbiting" | "mouse") => "`orbit: true` lets the mouse turn it",
        ("light", "dir") => "write `direction`, towards the light",
        ("light", "pos" | "location") => "write `position`",
        ("light", "brightness" | "strength" | "power" | "energy") => "its strength is `intensity`",
        ("light", "shadows" | "softness" | "castshadow" | "castshadows") => {
            "write `shadow: hard` or `shadow: soft(8)`"
        }
        ("ambient", "ao" | "ambientocclusion") => "write `occlusion: 1`",
        ("sky" | "fog" | "rim" | "ambient", "background" | "colour") => "write `color`",
        ("rim", "strength" | "intensity") => "its strength is its `color`",
        ("material", "albedo" | "diffuse" | "basecolor" | "rgb") => "the colour is `color`",
        ("material", "roughness" | "gloss" | "glossiness" | "smoothness") => {
            "how sharp its highlight is says `shininess`: 8 is rough, 200 polished"
        }
        ("material", "metallic" | "metalness" | "metal") => {
            "write `specular` for highlights, `reflect` for mirrors"
        }
        ("material", "emissive" | "emit") => "light of its own is `emission`",
        ("material", "mirror" | "reflectivity" | "reflectance") => "write `reflect`",
        ("material", "opacity" | "alpha" | "transparency" | "transparent") => "write `transmit`",
        ("render", "maxsteps" | "iterations" | "marchsteps") => "write `steps`",
        ("render", "epsilon" | "eps" | "precision" | "threshold") => "write `tolerance`, in pixels",
        ("render", "maxdist" | "maxdistance" | "distance") => "write `far`",
        ("render", "aa" | "samples" | "msaa") => "write `antialias`",
        ("render", "reflections" | "maxbounces" | "depth") => "write `bounces`",
        _ => return None,
    })
}
