//! A page that draws shaders by WebGL2 and WebGPU and hands back their pixels.

use crate::chromium::{Browser, Page, decode, encode};
use crate::drawing::{SIZE, Verdict};
use crate::run::Kernel;
use sdf_emit::UniformLayout;
use sdf_ir::{Constant, Role};
use sdf_render::{Frame, Picture};
use sdfc::Shader;
use serde_json::{Value, json};

/// The page.
pub struct Canvas<'a> {
    page: Page<'a>,
    /// Its file.
    _folder: tempfile::TempDir,
}

impl Canvas<'_> {
    /// Opens the page.
    pub fn new(browser: &Browser) -> Canvas<'_> {
        let folder = tempfile::tempdir().expect("a folder for the page");
        let file = folder.path().join("canvas.html");
        let page =
            format!("<!doctype html><title>canvas</title><script>{}</script>", include_str!("canvas.js"));
        std::fs::write(&file, page).expect("a place for the page");
        let page = browser.page(SIZE[0], SIZE[1]);
        page.open(&file);
        Canvas { page, _folder: folder }
    }

    /// The text for Shadertoy, with the site's uniforms, before anybody has clicked.
    pub fn shadertoy(&self, text: &str, frames: &[Frame]) -> Verdict {
        let uniforms = |frame: &Frame| {
            let index = (frame.time * 60.0).round();
            json!([
                uniform("iResolution", "3f", &[f64::from(frame.width), f64::from(frame.height), 1.0]),
                uniform("iTime", "1f", &[frame.time]),
                uniform("iTimeDelta", "1f", &[1.0 / 60.0]),
                uniform("iFrameRate", "1f", &[60.0]),
                uniform("iFrame", "1i", &[index]),
                uniform("iMouse", "4f", &[0.0; 4]),
                uniform("iDate", "4f", &[2026.0, 11.0, 25.0, 43200.0]),
                uniform("iSampleRate", "1f", &[44100.0]),
            ])
        };
        let text = crate::shadertoy::PRELUDE.to_owned() + text;
        self.draw("drawWithWebgl", &text, frames.iter().map(uniforms).collect(), upside_down)
    }

    /// The text for WebGL2, with the values of its uniforms.
    pub fn webgl(&self, shader: &Shader, text: &str, frames: &[Frame]) -> Verdict {
        let names = declared(text);
        let uniforms = |frame: &Frame| {
            let values = frame.uniforms(&shader.program);
            let used = shader.program.uniforms.iter().zip(values).filter(|(u, _)| u.role != Role::Setting);
            let values: Vec<Constant> = used.map(|(_, value)| value).collect();
            assert_eq!(names.len(), values.len(), "a line for each uniform");
            names.iter().zip(values).map(|(name, value)| value_of(name, value)).collect()
        };
        self.draw("drawWithWebgl", text, frames.iter().map(uniforms).collect(), upside_down)
    }

    /// The text for WebGPU, with the uniform block.
    pub fn webgpu(&self, shader: &Shader, text: &str, frames: &[Frame]) -> Verdict {
        let layout = UniformLayout::of(&shader.program);
        let block = |frame: &Frame| {
            let values = frame.uniforms(&shader.program);
            encode(&layout.bytes([frame.width, frame.height], &values)).into()
        };
        self.draw("drawWithWebgpu", text, frames.iter().map(block).collect(), |rgba| rgba)
    }

    /// The words that a compute shader in WGSL leaves, or what is said against it.
    pub fn compute(&self, kernel: &Kernel) -> Result<Vec<u32>, String> {
        let bytes: Vec<u8> = kernel.input.iter().flat_map(|word| word.to_le_bytes()).collect();
        let (text, input) = (json!(kernel.text), json!(encode(&bytes)));
        let (invocations, words) = (kernel.invocations, kernel.invocations * kernel.width);
        let call = format!("computeWithWebgpu({text}, {input}, {invocations}, {words})");
        let result = self.page.evaluate(&call)?;
        let complaint = result["complaint"].as_str().expect("a text");
        if !complaint.is_empty() {
            return Err(complaint.to_owned());
        }
        let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
        Ok(decode(&result["words"]).chunks_exact(4).map(word).collect())
    }

    fn draw(&self, function: &str, text: &str, frames: Vec<Value>, turn: fn(Vec<u8>) -> Vec<u8>) -> Verdict {
        let [width, height] = SIZE;
        let call = format!("{function}({}, {}, {width}, {height})", json!(text), json!(frames));
        match self.page.evaluate(&call) {
            Err(exception) => Verdict { complaint: Some(exception), pictures: Vec::new() },
            Ok(result) => {
                let complaint = result["complaint"].as_str().expect("a text").trim_end_matches(['\n', '\0']);
                let pictures = result["pictures"].as_array().expect("pictures").iter();
                let picture = |pixels| Picture { width, height, rgba: turn(decode(pixels)) };
                Verdict {
                    complaint: (!complaint.is_empty()).then(|| complaint.to_owned()),
                    pictures: pictures.map(picture).collect(),
                }
            }
        }
    }
}

/// The names of the uniforms that a shader declares, in order.
fn declared(text: &str) -> Vec<&str> {
    let declarations = text.lines().filter_map(|line| line.strip_prefix("uniform ")?.split_once(';'));
    declarations.filter_map(|(declaration, _)| declaration.split(' ').next_back()).collect()
}

fn value_of(name: &str, value: Constant) -> Value {
    match value {
        Constant::Bool(b) => uniform(name, "1i", &[f64::from(u8::from(b))]),
        numbers => {
            let numbers = numbers.components();
            uniform(name, &format!("{}f", numbers.len()), numbers)
        }
    }
}

fn uniform(name: &str, kind: &str, values: &[f64]) -> Value {
    json!({ "name": name, "kind": kind, "values": values })
}

/// WebGL's rows begin at the bottom.
fn upside_down(rgba: Vec<u8>) -> Vec<u8> {
    rgba.chunks(4 * SIZE[0] as usize).rev().flatten().copied().collect()
}
