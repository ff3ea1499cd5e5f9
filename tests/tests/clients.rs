//! Every scene in `examples/` on every client that a user may have: each takes its text and draws the interpreter's
//! picture. What came of it stands in `tests/tables/clients.md`.
//!
//! Where the environment's `ADAPTER` names a device, that is the only client, and its table has its name in its own.

use sdf_render::{Frame, Picture};
use sdf_tests::adapter::{self, adapter};
use sdf_tests::agreement::{TOLERANCE, compare};
use sdf_tests::canvas::Canvas;
use sdf_tests::chromium::Browser;
use sdf_tests::drawing::{SIZE, TIMES, Verdict, buffers, frames, on_cpu, on_device, shader};
use sdf_tests::scenes::{Buffers, Example, all_examples};
use sdf_tests::table::Table;
use sdf_tests::{glslang, pages, shadertoy, swiftshader};
use sdfc::{Language, Shader, Target};
use std::thread;

/// The program that draws in a process of its own.
const DRAW: &str = env!("CARGO_BIN_EXE_draw");

/// What a client makes of an example.
struct Cell {
    client: String,
    /// What the table says.
    text: String,
    /// What is wrong, if anything.
    complaint: Option<String>,
}

/// An example with the pictures that it should be.
struct Case {
    example: Example,
    shader: Shader,
    frames: Vec<Frame>,
    expected: Vec<Picture>,
    buffers: Vec<Buffers>,
}

impl Case {
    fn of(example: Example) -> Case {
        let shader = shader(&example);
        assert_eq!(sdf_ir::verify(&shader.program), Ok(()), "{}", example.name);
        let frames = frames(&shader);
        let expected = frames.iter().map(|frame| on_cpu(&shader, frame)).collect();
        let buffers: Vec<Buffers> = frames.iter().map(|frame| buffers(&example, frame)).collect();
        for seen in &buffers {
            assert!(seen.pixels.iter().any(|pixel| pixel.depth > 0.0), "{} shows nothing", example.name);
        }
        Case { example, shader, frames, expected, buffers }
    }

    fn text(&self, target: Target) -> String {
        self.shader.text(target).unwrap_or_else(|diagnostic| diagnostic.message)
    }

    /// What all clients make of it: those that are not the device are asked where there is a browser.
    fn cells(&self, browser: Option<(&Browser, &Canvas)>) -> Vec<Cell> {
        let mut verdicts = match browser {
            None => self.on_adapter(),
            Some((browser, canvas)) => thread::scope(|scope| {
                let device = scope.spawn(|| self.on_adapter());
                let swift = scope.spawn(|| self.on_swiftshader());
                let chromium = self.in_browser(browser, canvas);
                let mut all = device.join().expect("the device");
                all.extend(swift.join().expect("SwiftShader"));
                all.extend(chromium);
                all
            }),
        };
        // Both languages on one device are compared with each other, too.
        let between = self.drawn("both languages", &verdicts[1].1, &verdicts[0].1.pictures).complaint;
        let said = &mut verdicts[1].1.complaint;
        *said = said.take().or(between);
        let mut cells = if browser.is_some() { self.accepted() } else { Vec::new() };
        cells.extend(verdicts.iter().map(|(name, verdict)| self.drawn(name, verdict, &self.expected)));
        cells
    }

    /// What the device makes of it, in both languages.
    fn on_adapter(&self) -> Vec<(String, Verdict)> {
        let draw = |language| on_device(&self.shader, &self.frames, &adapter().name().name, language);
        let name = adapter::title();
        vec![(format!("{name}, WGSL"), draw(Language::Wgsl)), (format!("{name}, GLSL"), draw(Language::Glsl))]
    }

    fn on_swiftshader(&self) -> Vec<(String, Verdict)> {
        let draw = |language| swiftshader::draw(DRAW, &self.example, &self.frames, language);
        vec![
            ("SwiftShader, WGSL".into(), draw(Language::Wgsl)),
            ("SwiftShader, GLSL".into(), draw(Language::Glsl)),
        ]
    }

    fn in_browser(&self, browser: &Browser, canvas: &Canvas) -> Vec<(String, Verdict)> {
        let Case { example, shader, frames, .. } = self;
        vec![
            ("Chromium, Shadertoy".into(), canvas.shadertoy(&self.text(Target::Shadertoy), frames)),
            ("Chromium, WebGL2".into(), canvas.webgl(shader, &self.text(Target::GlslEs), frames)),
            ("Chromium, WebGPU".into(), canvas.webgpu(shader, &self.text(Target::Wgsl), frames)),
            ("Chromium, page".into(), pages::draw(browser, example, frames)),
        ]
    }

    /// What compilers of texts make of it.
    fn accepted(&self) -> Vec<Cell> {
        let refused = Target::ALL.iter().find_map(|target| self.shader.text(*target).err());
        vec![accepted("naga", refused.map(|d| d.message)), accepted("glslang", self.glslang())]
    }

    /// What the reference compiler has against the text for WebGL2 and that for Shadertoy.
    fn glslang(&self) -> Option<String> {
        let shadertoy = shadertoy::PRELUDE.to_owned() + &self.text(Target::Shadertoy);
        glslang::complaint(&self.text(Target::GlslEs)).or_else(|| glslang::complaint(&shadertoy))
    }

    fn drawn(&self, client: &str, verdict: &Verdict, expected: &[Picture]) -> Cell {
        let mut complaints: Vec<String> = verdict.complaint.iter().cloned().collect();
        if verdict.pictures.len() != expected.len() {
            complaints.push("it drew nothing".into());
            return Cell {
                client: client.into(),
                text: "**refused**".into(),
                complaint: Some(complaints.join("\n")),
            };
        }
        let (mut differing, mut largest) = (0, 0);
        for (i, found) in verdict.pictures.iter().enumerate() {
            let agreement = compare(&expected[i], found, &self.buffers[i]);
            differing += agreement.differing;
            largest = largest.max(agreement.largest);
            let at = |complaint| format!("at {} s: {complaint}", self.frames[i].time);
            complaints.extend(agreement.complaint().map(at));
        }
        let complaint = (!complaints.is_empty()).then(|| complaints.join("\n"));
        let numbers = format!("{differing} / {largest}");
        let text = if complaint.is_none() { numbers } else { format!("**{numbers}**") };
        Cell { client: client.into(), text, complaint }
    }
}

fn accepted(client: &str, complaint: Option<String>) -> Cell {
    let text = if complaint.is_none() { "yes" } else { "**no**" };
    Cell { client: client.into(), text: text.into(), complaint }
}

#[test]
fn every_client_takes_every_example_and_draws_it_alike() {
    let browser = (!adapter::is_chosen()).then(Browser::start);
    let canvas = browser.as_ref().map(Canvas::new);
    let (mut table, mut complaints) = (about(browser.as_ref()), String::new());
    for example in all_examples() {
        let case = Case::of(example);
        let cells = case.cells(browser.as_ref().zip(canvas.as_ref()));
        let heads = ["example"].into_iter().chain(cells.iter().map(|cell| &*cell.client));
        table.columns = heads.map(str::to_owned).collect();
        let name = case.example.name.clone();
        table.rows.push([name.clone()].into_iter().chain(cells.iter().map(|c| c.text.clone())).collect());
        let wrong = cells.iter().filter_map(|cell| Some((&cell.client, cell.complaint.as_ref()?)));
        complaints.extend(wrong.map(|(client, said)| format!("{name}, {client}: {said}\n")));
    }
    println!("{}", table.markdown());
    let stale = table.check(&adapter::table("clients"));
    assert!(complaints.is_empty(), "{complaints}");
    assert_eq!(stale, None);
}

/// The table without its rows.
fn about(browser: Option<&Browser>) -> Table {
    let [width, height] = SIZE;
    let [first, second] = TIMES;
    let others = browser.map(|browser| [swiftshader::version(DRAW), browser.version(), glslang::version()]);
    let left_out = match browser {
        Some(_) => String::new(),
        None => format!("Here {}, chosen by `ADAPTER`, is the only client.\n", adapter::title()),
    };
    let about = format!(
        "{left_out}Every scene in `examples/` on every client; `tests/tests/clients.rs` writes this. naga, glslang and Chromium's \
         compilers say\nwhat they have against a text, warnings included: `yes` means nothing. The pictures, of \
         {width}×{height} pixels at {first} s and, if the\nscene moves, at {second} s, are compared with the \
         interpreter's: `a / b` means that `a` pixels differ by more than {TOLERANCE} of 255 in\na channel, and that \
         the largest difference is `b`.\nThe shader of a page lets its user turn the camera; it rounds \
         in other places than the one that the interpreter ran."
    );
    Table {
        title: "Clients".into(),
        about,
        versions: [adapter::version()].into_iter().chain(others.into_iter().flatten()).collect(),
        ..Table::default()
    }
}

/// A text that is wrong, and one that draws something else, are seen by each client of the browser.
#[test]
fn a_client_that_refuses_or_draws_something_else_is_seen() {
    let browser = Browser::start();
    let canvas = Canvas::new(&browser);
    let example = all_examples().into_iter().find(|e| e.name == "smallest").expect("the example `smallest`");
    let case = Case::of(example);
    let texts = [Target::Shadertoy, Target::GlslEs, Target::Wgsl].map(|target| case.text(target));
    let draw = |[shadertoy, glsl, wgsl]: [String; 3]| {
        [
            canvas.shadertoy(&shadertoy, &case.frames),
            canvas.webgl(&case.shader, &glsl, &case.frames),
            canvas.webgpu(&case.shader, &wgsl, &case.frames),
        ]
    };
    for verdict in draw(texts.clone().map(|text| text + "\n!")) {
        let cell = case.drawn("wrong", &verdict, &case.expected);
        assert_eq!(cell.text, "**refused**");
        assert!(verdict.complaint.is_some_and(|said| said.to_lowercase().contains("error")));
    }
    let darker = |text: String| {
        let line =
            text.lines().rfind(|line| line.contains(", 1.0)")).expect("the line that gives the colour");
        let changed = line.replace("), 1.0)", ") * 0.5, 1.0)");
        text.replace(line, &changed)
    };
    for verdict in draw(texts.map(darker)) {
        let cell = case.drawn("dark", &verdict, &case.expected);
        assert_eq!(verdict.complaint, None);
        assert!(cell.complaint.is_some_and(|said| said.contains("pixels differ")), "{}", cell.text);
    }
}

/// Shapes and params may be called what the surroundings of a shader are called, and what a browser reserves.
#[test]
fn names_of_the_surroundings_are_free() {
    const MORE: [&str; 12] = [
        "GL_ES",
        "GL_FRAGMENT_PRECISION_HIGH",
        "webgl_a",
        "_webgl_b",
        "gl_FragColor",
        "fragColor",
        "fragCoord",
        "vs_main",
        "fs_main",
        "uniforms",
        "main0",
        "ZERO",
    ];
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = shadertoy::PRELUDE
        .split(|c| !is_part(c))
        .filter(|w| w.starts_with(|c: char| c.is_ascii_alphabetic()));
    let mut names: Vec<&str> = words.chain(MORE).collect();
    names.sort_unstable();
    names.dedup();
    // What means something in the language of scenes cannot be a name there.
    let is_free = |name: &&str| {
        let text = format!("fn {name}(r) = sphere(r)\nscene {{ {name}(1) }}");
        sdfc::compile("name", &text, &sdfc::Options::default(), &mut sdfc::Clock::default()).output.is_some()
    };
    names.retain(is_free);
    for name in ["iCh0", "st_assert", "shadertoy_out_color", "iTime", "mainImage", "GL_ES", "webgl_a"] {
        assert!(names.contains(&name), "{name} is no name in {names:?}");
    }
    let mut text = String::from("camera { eye: (0, 0, 30) }\n");
    let mut entries = String::new();
    for (i, name) in names.iter().enumerate() {
        let (x, y) = (i % 8 * 2, i / 8 * 2);
        // No two are the same function, and none is one of the library's.
        text += &format!("fn {name}(r) = field {{ max(length(p) - r, p.y - 0.{i:03}) }}\n");
        entries += &format!("{name}(0.5).at({x} - 7, {y} - 7, 0),\n");
    }
    text += &format!("scene {{\n{entries}}}\n");
    let browser = Browser::start();
    let canvas = Canvas::new(&browser);
    let case = Case::of(Example { name: "names".into(), text });
    let shapes = case.text(Target::Shadertoy).matches("(vec3 p, float r) {").count();
    assert!(shapes >= names.len(), "{shapes} shapes of {}", names.len());
    for cell in case.cells(Some((&browser, &canvas))) {
        assert_eq!(cell.complaint, None, "{}", cell.client);
    }
}
