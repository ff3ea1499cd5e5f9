//! Scenes as pages, opened in a browser.

use crate::agreement::{Agreement, compare};
use crate::chromium::{Browser, Page, decode};
use crate::drawing::{SIZE, Verdict, buffers, on_cpu, turnable};
use crate::scenes::Example;
use sdf_ir::Constant;
use sdf_render::{Frame, Picture};
use sdfc::{Format, Shader};
use serde_json::Value;
use tempfile::TempDir;

/// A scene that a page shows.
pub struct Shown<'a> {
    /// The page.
    pub page: Page<'a>,
    /// What it draws.
    pub shader: Shader,
    example: Example,
    /// Where its file lies.
    _folder: TempDir,
}

impl Shown<'_> {
    /// Opens an example as a page in a window of this size, and waits until the shader is there.
    pub fn open<'a>(browser: &'a Browser, example: &Example, window: [u32; 2]) -> Shown<'a> {
        let shown = Shown::open_changed(browser, example, window, |html| html, "");
        assert_eq!(shown.error(), None, "{}", example.name);
        shown
    }

    /// [`Shown::open`] where the file is changed, and a script runs before those of the page; it waits for nothing.
    pub fn open_changed<'a>(
        browser: &'a Browser,
        example: &Example,
        [width, height]: [u32; 2],
        change: impl Fn(String) -> String,
        script: &str,
    ) -> Shown<'a> {
        let shader = turnable(example);
        let file = shader.file(Format::Page).unwrap_or_else(|d| panic!("{}: {}", example.name, d.message));
        let folder = tempfile::tempdir().expect("a folder for the page");
        let path = folder.path().join("scene.html");
        std::fs::write(&path, change(String::from_utf8(file).expect("a text")))
            .expect("a place for the page");
        let page = browser.page(width, height);
        page.before_all(script);
        page.open(&path);
        Shown { page, shader, example: example.clone(), _folder: folder }
    }

    /// The value of an expression, which must have one.
    pub fn evaluate(&self, expression: &str) -> Value {
        self.page.evaluate(expression).unwrap_or_else(|error| panic!("{}: {error}", self.example.name))
    }

    /// What the page says that is wrong, once the shader is there or will never be: the error that it shows, why the
    /// promise `ready` was broken, or what no script caught.
    pub fn error(&self) -> Option<String> {
        let settled = self.page.evaluate("sdfc.ready.then(() => null)").err();
        let shown = self.evaluate(
            "(document.querySelector('#error:not([hidden])')?.innerText ?? '') + \
             (document.querySelector('#status:not([hidden])')?.innerText ?? '')",
        );
        let shown = shown.as_str().expect("a text").to_owned();
        let mut said = vec![shown, settled.unwrap_or_default(), self.page.exceptions().join("\n")];
        said.retain(|text| !text.is_empty());
        (!said.is_empty()).then(|| said.join("\n"))
    }

    /// Fixes the size of the picture and the time.
    pub fn still(&self, [width, height]: [u32; 2], time: f64) {
        self.evaluate(&format!("sdfc.size({width}, {height}); sdfc.time({time})"));
    }

    /// What the page says that it draws.
    pub fn frame(&self) -> Frame {
        // A picture fixes the size.
        let state = self.evaluate("sdfc.draw(), sdfc.state()");
        let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
        let constant = |value: &Value| match value {
            Value::Bool(on) => Constant::Bool(*on),
            Value::Array(channels) => Constant::Vec3([0, 1, 2].map(|i| number(&channels[i]))),
            value => Constant::Float(number(value)),
        };
        let params = state["params"].as_object().expect("params").iter();
        Frame {
            width: number(&state["width"]) as u32,
            height: number(&state["height"]) as u32,
            time: number(&state["time"]),
            mouse: ["x", "y"].map(|axis| number(&state["mouse"][axis])),
            orbit: ["turn", "tilt", "zoom"].map(|name| number(&state["orbit"][name])),
            params: params.map(|(name, value)| (name.clone(), constant(value))).collect(),
        }
    }

    /// The picture, by the page's own way to hand it out.
    pub fn pixels(&self) -> Picture {
        let answer = self.evaluate(
            "(() => { const pixels = sdfc.pixels(); const { width, height } = sdfc.state();
                return { width, height, rgba: btoa(Array.from(pixels, c => String.fromCharCode(c)).join('')) }; })()",
        );
        let side = |name: &str| answer[name].as_u64().expect("a length") as u32;
        Picture { width: side("width"), height: side("height"), rgba: decode(&answer["rgba"]) }
    }

    /// The picture on the screen, without the controls; the window must be as large as the picture.
    pub fn seen(&self) -> Picture {
        self.evaluate(
            "(document.getElementById('panel').hidden = true, sdfc.draw(),
              new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(0)))))",
        );
        self.page.screenshot()
    }

    /// How the picture agrees with the interpreter's of what the page says that it draws.
    pub fn agreement(&self) -> Agreement {
        let frame = self.frame();
        compare(&on_cpu(&self.shader, &frame), &self.pixels(), &buffers(&self.example, &frame))
    }
}

/// What a browser makes of an example as a page: what is on the screen.
pub fn draw(browser: &Browser, example: &Example, frames: &[Frame]) -> Verdict {
    let shown = Shown::open_changed(browser, example, SIZE, |html| html, "");
    if let Some(error) = shown.error() {
        return Verdict { complaint: Some(error), pictures: Vec::new() };
    }
    let picture = |frame: &Frame| {
        shown.still(SIZE, frame.time);
        shown.seen()
    };
    Verdict { pictures: frames.iter().map(picture).collect(), complaint: shown.error() }
}
