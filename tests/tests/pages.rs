//! Pages in a browser, used as their users use them: by mouse, wheel and keys. What the page says that it draws, the
//! interpreter draws too.

use sdf_ir::{Constant, Role};
use sdf_tests::chromium::{Browser, Mouse};
use sdf_tests::pages::Shown;
use sdf_tests::scenes::{Example, examples};

const WINDOW: [u32; 2] = [960, 540];
const PICTURE: [u32; 2] = [160, 90];

/// A scene with a param of each kind, that moves and follows the pointer.
const SCENE: &str = "
param width = 0.5 in 0.2..1
param round = true
param paint = #ff8800
camera { eye: (0, 1, 4), target: (0, 0, 0) }
light sun { direction: (1, 3, 2) }
scene {
  if round { sphere(width) } else { box(width) }.paint(paint),
  box(0.2).at(1, sin(time), 0).paint(#08f),
  sphere(0.2).at(mouse.x - 2, mouse.y, 0),
}
";

fn scene() -> Example {
    Example { name: "page".into(), text: SCENE.into() }
}

#[track_caller]
fn agrees(shown: &Shown, what: &str) {
    assert_eq!(shown.agreement().complaint(), None, "{what}, {:?}", shown.frame());
}

/// The middle of an element, or another part of its width.
fn place(shown: &Shown, element: &str, part: f64) -> [f64; 2] {
    let find = format!(
        "(() => {{ const e = document.querySelector('{element}'); e.scrollIntoView(); const box = \
         e.getBoundingClientRect(); return [box.x + {part} * box.width, box.y + box.height / 2]; }})()"
    );
    let found = shown.evaluate(&find);
    [0, 1].map(|axis| found[axis].as_f64().expect("a place"))
}

fn click(shown: &Shown, [x, y]: [f64; 2]) {
    shown.page.mouse(Mouse::Moves, x, y, false);
    shown.page.mouse(Mouse::Presses(1), x, y, true);
    shown.page.mouse(Mouse::Releases(1), x, y, false);
}

#[test]
fn every_example_can_be_turned_and_its_sliders_moved() {
    let browser = Browser::start();
    for example in examples() {
        let name = &example.name;
        let shown = Shown::open(&browser, &example, WINDOW);
        shown.still(PICTURE, 1.7);
        let plain = shown.pixels();
        shown.page.drag([300.0, 300.0], [420.0, 340.0]);
        assert_ne!(shown.frame().orbit, [0.0, 0.0, 1.0], "{name} was not turned");
        assert_ne!(shown.pixels(), plain, "{name}");
        agrees(&shown, name);
        shown.page.double_click(300.0, 300.0);
        assert_eq!(shown.frame().orbit, [0.0, 0.0, 1.0], "{name} was not turned back");
        assert_eq!(shown.pixels(), plain, "{name}");
        for uniform in &shown.shader.program.uniforms {
            let Role::Param { range: Some((low, high)), .. } = uniform.role else { continue };
            let slider = format!("#param-{}", uniform.name);
            shown.page.drag(place(&shown, &slider, 0.5), place(&shown, &slider, 0.9));
            let Constant::Float(value) = shown.frame().params[&*uniform.name] else { panic!("{slider}") };
            let part = (value - low) / (high - low);
            assert!((0.8..=1.0).contains(&part), "{name}, {slider} stands at {value}");
            assert_ne!(shown.pixels(), plain, "{name}, {slider}");
            agrees(&shown, &format!("{name}, {slider}"));
        }
        assert_eq!(shown.error(), None, "{name}");
    }
}

#[test]
fn each_kind_of_param_changes_the_picture() {
    let browser = Browser::start();
    let shown = Shown::open(&browser, &scene(), WINDOW);
    shown.still(PICTURE, 0.5);
    let plain = shown.pixels();
    agrees(&shown, "at first");
    // By a click, and by a script that picks a colour as a user would.
    click(&shown, place(&shown, "#param-round", 0.5));
    assert_eq!(shown.frame().params["round"], Constant::Bool(false));
    agrees(&shown, "a box");
    let box_ = shown.pixels();
    assert_ne!(box_, plain);
    shown.evaluate(
        "(() => { const input = document.getElementById('param-paint'); input.value = '#2040e0';
            input.dispatchEvent(new Event('input')); })()",
    );
    assert_ne!(shown.pixels(), box_);
    agrees(&shown, "a blue box");
    // By the keys of a slider that has the focus.
    shown.evaluate("document.getElementById('param-width').focus()");
    let before = shown.frame().params["width"];
    shown.page.press("ArrowRight");
    let after = shown.frame();
    assert!(after.params["width"].components() > before.components(), "{before:?} {after:?}");
    assert_eq!(after.orbit, [0.0, 0.0, 1.0]);
    agrees(&shown, "a larger box");
    click(&shown, place(&shown, "#defaults", 0.5));
    shown.evaluate("sdfc.mouse(0.5, 0.5)");
    assert_eq!(shown.pixels(), plain);
}

#[test]
fn the_pointer_the_wheel_and_the_keys_are_followed() {
    let browser = Browser::start();
    let shown = Shown::open(&browser, &scene(), WINDOW);
    shown.still(PICTURE, 0.5);
    let plain = shown.pixels();
    shown.page.mouse(Mouse::Moves, 96.0, 54.0, false);
    assert_eq!(shown.frame().mouse, [0.1, 0.9]);
    assert_ne!(shown.pixels(), plain);
    agrees(&shown, "the pointer");
    shown.page.wheel(96.0, 54.0, 300.0);
    let [_, _, zoom] = shown.frame().orbit;
    assert!(zoom > 1.2, "{zoom}");
    agrees(&shown, "the wheel");
    shown.page.press("Home");
    assert_eq!(shown.frame().orbit, [0.0, 0.0, 1.0]);
    for key in ["ArrowLeft", "ArrowUp", "+"] {
        let before = shown.frame().orbit;
        shown.page.press(key);
        assert_ne!(shown.frame().orbit, before, "{key}");
        agrees(&shown, key);
    }
}

#[test]
fn time_passes_stands_still_and_begins_again() {
    let browser = Browser::start();
    let shown = Shown::open(&browser, &scene(), WINDOW);
    let runs = || shown.evaluate("sdfc.state().runs");
    let later = || {
        shown.evaluate(
            "new Promise(done => {
                const from = sdfc.state().time;
                const look = () => sdfc.state().time > from ? done(true) : requestAnimationFrame(look);
                look();
                setTimeout(() => done(false), 20000);
            })",
        )
    };
    assert_eq!((runs(), later()), (true.into(), true.into()));
    shown.page.press(" ");
    assert_eq!(runs(), false);
    let time = shown.frame().time;
    assert!(time > 0.0);
    shown.evaluate("sdfc.size(160, 90)");
    agrees(&shown, "at a time of its own");
    assert_eq!(shown.frame().time, time);
    shown.page.press("r");
    assert_eq!(shown.frame().time, 0.0);
    click(&shown, place(&shown, "#pause", 0.5));
    assert_eq!((runs(), later()), (true.into(), true.into()));
}

#[test]
fn a_browser_without_webgl2_is_told_so() {
    let browser = Browser::start();
    let none = "HTMLCanvasElement.prototype.getContext = () => null";
    let error = Shown::open_changed(&browser, &scene(), WINDOW, |html| html, none).error();
    assert!(error.as_ref().is_some_and(|said| said.contains("does not offer WebGL2")), "{error:?}");
}

#[test]
fn what_the_driver_says_of_a_shader_is_shown() {
    let browser = Browser::start();
    let spoil = |html: String| html.replace("void main() {\n", "void main() {\n    fragColor = 7;\n");
    let error = Shown::open_changed(&browser, &scene(), WINDOW, spoil, "").error();
    let said = error.expect("an error");
    assert!(said.contains("driver does not take this shader") && said.contains("ERROR: 0:"), "{said}");
}

#[test]
fn a_device_that_is_lost_comes_back() {
    let browser = Browser::start();
    let shown = Shown::open(&browser, &scene(), WINDOW);
    shown.still(PICTURE, 0.5);
    let plain = shown.pixels();
    shown.evaluate(
        "window.device = document.getElementById('picture').getContext('webgl2').getExtension('WEBGL_lose_context');
         new Promise(done => {
            document.getElementById('picture').addEventListener('webglcontextlost', () => setTimeout(done, 0));
            device.loseContext();
         })",
    );
    let error = shown.error();
    assert!(error.as_ref().is_some_and(|said| said.contains("device was lost")), "{error:?}");
    shown.evaluate(
        "new Promise(done => {
            const look = () => document.getElementById('error').hidden ? done(0) : setTimeout(look, 20);
            device.restoreContext();
            look();
         })",
    );
    assert_eq!(shown.error(), None);
    assert_eq!(shown.pixels(), plain);
}

/// All that a page needs is in its file.
#[test]
fn a_page_asks_for_nothing() {
    let browser = Browser::start();
    let shown = Shown::open(&browser, &scene(), WINDOW);
    assert_eq!(
        shown.evaluate("performance.getEntriesByType('resource').map(e => e.name)"),
        serde_json::json!([])
    );
}
