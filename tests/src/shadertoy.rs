//! What Shadertoy puts before the code of an Image tab, as of 2026.

/// Every name that the site declares there, with its type, and the `main` that calls `mainImage`; the code follows
/// as it is. Channels without an input are `sampler2D`s. The site overwrites alpha.
pub const PRELUDE: &str = "#version 300 es
precision highp float;
precision highp int;
precision mediump sampler3D;
#define HW_PERFORMANCE 1
uniform vec3 iResolution;
uniform float iTime;
uniform float iChannelTime[4];
uniform vec4 iMouse;
uniform vec4 iDate;
uniform float iSampleRate;
uniform vec3 iChannelResolution[4];
uniform int iFrame;
uniform float iTimeDelta;
uniform float iFrameRate;
uniform sampler2D iChannel0;
uniform struct { sampler2D sampler; vec3 size; float time; int loaded; } iCh0;
uniform sampler2D iChannel1;
uniform struct { sampler2D sampler; vec3 size; float time; int loaded; } iCh1;
uniform sampler2D iChannel2;
uniform struct { sampler2D sampler; vec3 size; float time; int loaded; } iCh2;
uniform sampler2D iChannel3;
uniform struct { sampler2D sampler; vec3 size; float time; int loaded; } iCh3;
void mainImage(out vec4 c, in vec2 f);
void st_assert(bool cond);
void st_assert(bool cond, int v);
out vec4 shadertoy_out_color;
void st_assert(bool cond, int v) {
    vec4 lowered = vec4(equal(ivec4(0, 1, 2, 3), ivec4(v)));
    if (!cond) shadertoy_out_color -= 2.0 * lowered;
}
void st_assert(bool cond) { st_assert(cond, 0); }
void main(void) {
    shadertoy_out_color = vec4(1.0);
    vec4 color = vec4(1e20);
    mainImage(color, gl_FragCoord.xy);
    shadertoy_out_color = vec4(color.xyz, 1.0);
}
";
