//! Chromium without a window, driven by the DevTools protocol over a pair of pipes.
//!
//! `Browser::start → open → Page::evaluate, mouse, screenshot`. The browser draws in software, by SwiftShader, so that
//! every machine has WebGL2 and WebGPU. Whatever goes wrong ends the test with what the browser wrote.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use sdf_render::Picture;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;
use tempfile::TempDir;

/// How long an answer may take: the longest is a picture of a scene on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// Both graphics interfaces in software, nothing that calls home, and colours as they are.
const FLAGS: [&str; 16] = [
    "--headless",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--enable-features=Vulkan",
    "--disable-gpu-watchdog",
    "--force-color-profile=srgb",
    "--hide-scrollbars",
    "--mute-audio",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];

/// A browser that runs.
pub struct Browser {
    process: Child,
    connection: RefCell<Connection>,
    /// Its profile, and what it writes to its standard error.
    folder: TempDir,
}

/// The two ends of the pipes.
struct Connection {
    /// Commands; nothing once the browser was told to go.
    commands: Option<ChildStdin>,
    messages: Receiver<Value>,
    /// What was told and not asked for, oldest first.
    events: VecDeque<Value>,
    last: u64,
}

impl Browser {
    /// Starts Chromium: the program that the environment's `CHROMIUM` names, else `chromium`.
    pub fn start() -> Browser {
        let folder = tempfile::tempdir().expect("a folder for the browser's profile");
        let log = File::create(folder.path().join("log")).expect("a file for what the browser writes");
        let program = std::env::var("CHROMIUM").unwrap_or_else(|_| "chromium".into());
        // The browser reads commands from descriptor 3 and writes to descriptor 4.
        let mut process = Command::new("sh")
            .args(["-c", r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >&2"#, &program, "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .args(FLAGS)
            .arg("about:blank")
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .expect("a shell");
        let (sender, messages) = channel();
        let output = process.stdout.take().expect("a pipe");
        std::thread::spawn(move || forward(output, &sender));
        let commands = process.stdin.take();
        let connection = Connection { commands, messages, events: VecDeque::new(), last: 0 };
        Browser { process, connection: RefCell::new(connection), folder }
    }

    /// Its name and version.
    pub fn version(&self) -> String {
        text(&self.call(None, "Browser.getVersion", json!({}))["product"])
    }

    /// A new empty page of `width` by `height` pixels.
    pub fn page(&self, width: u32, height: u32) -> Page<'_> {
        let target = self.call(None, "Target.createTarget", json!({ "url": "about:blank" }));
        let target = text(&target["targetId"]);
        let attach = json!({ "targetId": target, "flatten": true });
        let session = text(&self.call(None, "Target.attachToTarget", attach)["sessionId"]);
        let page = Page { browser: self, target, session };
        for domain in ["Page", "Runtime"] {
            page.call(&format!("{domain}.enable"), json!({}));
        }
        let screen = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        page.call("Emulation.setDeviceMetricsOverride", screen);
        page
    }

    /// Carries out a command, of a page's session if one is given.
    fn call(&self, session: Option<&str>, method: &str, parameters: Value) -> Value {
        match self.attempt(session, method, parameters) {
            Ok(result) => result,
            Err(why) => self.fail(&format!("{method}: {why}")),
        }
    }

    fn attempt(&self, session: Option<&str>, method: &str, parameters: Value) -> Result<Value, String> {
        let connection = &mut *self.connection.borrow_mut();
        connection.last += 1;
        let id = connection.last;
        let mut command = json!({ "id": id, "method": method, "params": parameters });
        if let Some(session) = session {
            command["sessionId"] = session.into();
        }
        let line = command.to_string() + "\0";
        let commands = connection.commands.as_mut().ok_or("the browser was told to go")?;
        commands.write_all(line.as_bytes()).map_err(|error| error.to_string())?;
        loop {
            let mut message = connection.receive()?;
            if message["id"] == id {
                return match message.get("error") {
                    Some(error) => Err(text(&error["message"])),
                    None => Ok(message["result"].take()),
                };
            }
            connection.events.push_back(message);
        }
    }

    /// The next message of this name that a session was told.
    fn event(&self, session: &str, name: &str) -> Value {
        let connection = &mut *self.connection.borrow_mut();
        loop {
            let is_it = |message: &Value| message["sessionId"] == session && message["method"] == name;
            if let Some(place) = connection.events.iter().position(is_it) {
                return connection.events.remove(place).expect("a message")["params"].take();
            }
            match connection.receive() {
                Ok(message) => connection.events.push_back(message),
                Err(why) => self.fail(&format!("{name}: {why}")),
            }
        }
    }

    fn fail(&self, why: &str) -> ! {
        let log = std::fs::read_to_string(self.folder.path().join("log")).unwrap_or_default();
        let lines: Vec<&str> = log.lines().collect();
        let end = lines[lines.len().saturating_sub(15)..].join("\n");
        panic!("this test needs Chromium, which failed (Debian: chromium): {why}\nit wrote:\n{end}")
    }
}

impl Connection {
    fn receive(&self) -> Result<Value, String> {
        self.messages.recv_timeout(PATIENCE).map_err(|error| match error {
            RecvTimeoutError::Timeout => format!("no answer within {} s", PATIENCE.as_secs()),
            RecvTimeoutError::Disconnected => "the browser is gone".into(),
        })
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It leaves when its pipe does; not to leave a process behind matters more than how.
        self.connection.borrow_mut().commands = None;
        for _ in 0..50 {
            if matches!(self.process.try_wait(), Ok(Some(_))) {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Passes on what the browser says: JSON, each piece ended by a zero.
fn forward(output: ChildStdout, to: &Sender<Value>) {
    let mut output = BufReader::new(output);
    let mut bytes = Vec::new();
    while output.read_until(0, &mut bytes).is_ok_and(|count| count > 0) && bytes.pop() == Some(0) {
        let message = serde_json::from_slice(&bytes).expect("JSON from the browser");
        if to.send(message).is_err() {
            return;
        }
        bytes.clear();
    }
    // The pipe is emptied so that the browser can leave.
    let _ = output.read_to_end(&mut bytes);
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_else(|| panic!("{value} is no text")).to_owned()
}

/// A page of a browser.
pub struct Page<'a> {
    browser: &'a Browser,
    target: String,
    session: String,
}

impl Drop for Page<'_> {
    fn drop(&mut self) {
        // A browser that is gone has no pages either.
        let _ = self.browser.attempt(None, "Target.closeTarget", json!({ "targetId": self.target }));
    }
}

/// What a mouse does, at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mouse {
    /// It comes, with the left button as it is.
    Moves,
    /// The left button goes down, for the first or a further time in a row.
    Presses(u32),
    /// It goes up.
    Releases(u32),
}

impl Page<'_> {
    /// Carries out a command of the protocol.
    pub fn call(&self, method: &str, parameters: Value) -> Value {
        self.browser.call(Some(&self.session), method, parameters)
    }

    /// Has a script run before any of a page's own.
    pub fn before_all(&self, script: &str) {
        self.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": script }));
    }

    /// Opens a file, until it is loaded.
    pub fn open(&self, file: &Path) {
        let file = file.canonicalize().unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let went = self.call("Page.navigate", json!({ "url": format!("file://{}", file.display()) }));
        assert_eq!(went.get("errorText"), None, "{}", file.display());
        self.browser.event(&self.session, "Page.loadEventFired");
    }

    /// The value of an expression; a promise is waited for. An exception is the error.
    pub fn evaluate(&self, expression: &str) -> Result<Value, String> {
        let options = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut answer = self.call("Runtime.evaluate", options);
        match answer.get("exceptionDetails") {
            Some(details) => Err(exception(details)),
            None => Ok(answer["result"]["value"].take()),
        }
    }

    /// The exceptions so far that no script caught.
    pub fn exceptions(&self) -> Vec<String> {
        let connection = self.browser.connection.borrow();
        let thrown = connection
            .events
            .iter()
            .filter(|e| e["sessionId"] == self.session && e["method"] == "Runtime.exceptionThrown");
        thrown.map(|event| exception(&event["params"]["exceptionDetails"])).collect()
    }

    /// What a user does with the mouse, `x` and `y` from the top left.
    pub fn mouse(&self, does: Mouse, x: f64, y: f64, held: bool) {
        let (kind, count) = match does {
            Mouse::Moves => ("mouseMoved", 0),
            Mouse::Presses(count) => ("mousePressed", count),
            Mouse::Releases(count) => ("mouseReleased", count),
        };
        let button = if held || does != Mouse::Moves { "left" } else { "none" };
        let buttons = u32::from(held || matches!(does, Mouse::Presses(_)));
        let event = json!({
            "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": count,
        });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// A drag with the left button from one place to another, in steps.
    pub fn drag(&self, from: [f64; 2], to: [f64; 2]) {
        const STEPS: u32 = 5;
        self.mouse(Mouse::Moves, from[0], from[1], false);
        self.mouse(Mouse::Presses(1), from[0], from[1], true);
        for step in 1..=STEPS {
            let part = f64::from(step) / f64::from(STEPS);
            let [x, y] = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
            self.mouse(Mouse::Moves, x, y, true);
        }
        self.mouse(Mouse::Releases(1), to[0], to[1], false);
    }

    /// A double click.
    pub fn double_click(&self, x: f64, y: f64) {
        self.mouse(Mouse::Moves, x, y, false);
        for count in 1..=2 {
            self.mouse(Mouse::Presses(count), x, y, true);
            self.mouse(Mouse::Releases(count), x, y, false);
        }
    }

    /// A key goes down and up. `key` is what a script is told: a character, or a name such as `Home`.
    pub fn press(&self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            let mut event = json!({ "type": kind, "key": key });
            if kind == "keyDown" && key.chars().count() == 1 {
                event["text"] = key.into();
            }
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// The wheel is turned down by so many pixels.
    pub fn wheel(&self, x: f64, y: f64, down: f64) {
        let event = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": down });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// What a user sees.
    pub fn screenshot(&self) -> Picture {
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        let mut decoder = png::Decoder::new(Cursor::new(decode(&answer["data"])));
        decoder.set_transformations(png::Transformations::ALPHA | png::Transformations::STRIP_16);
        let mut reader = decoder.read_info().expect("a PNG");
        let mut rgba = vec![0; reader.output_buffer_size().expect("a size that fits")];
        let info = reader.next_frame(&mut rgba).expect("a picture");
        Picture { width: info.width, height: info.height, rgba }
    }
}

/// The bytes of a text in base 64.
pub fn decode(value: &Value) -> Vec<u8> {
    BASE64.decode(text(value)).unwrap_or_else(|error| panic!("base 64: {error}"))
}

/// The bytes as a text in base 64.
pub fn encode(bytes: &[u8]) -> String {
    BASE64.encode(bytes)
}

fn exception(details: &Value) -> String {
    let described = details["exception"]["description"].as_str();
    described.or(details["text"].as_str()).unwrap_or("an exception").to_owned()
}
