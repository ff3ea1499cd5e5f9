//! SwiftShader as a Vulkan driver. Vulkan's loader reads which drivers there are when a process starts, so it is
//! another process that draws.

use crate::drawing::{SIZE, Verdict};
use crate::scenes::Example;
use sdf_render::{Frame, Picture};
use sdfc::Language;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Where Debian's `chromium-common` puts the driver's description.
const DRIVER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

/// The driver's description: what the environment's `SWIFTSHADER_ICD` names, else that of Debian's Chromium.
pub fn driver() -> String {
    let path = std::env::var("SWIFTSHADER_ICD").unwrap_or_else(|_| DRIVER.into());
    assert!(Path::new(&path).is_file(), "this test needs SwiftShader (Debian: chromium): there is no {path}");
    path
}

/// What the device and its driver call themselves, by the program `draw`.
pub fn version(program: &str) -> String {
    let output = command(program).output().unwrap_or_else(|error| panic!("{program}: {error}"));
    assert!(
        output.status.success(),
        "this test needs SwiftShader: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

/// What SwiftShader makes of an example, by the program `draw`, which lies at `program`.
pub fn draw(program: &str, example: &Example, frames: &[Frame], language: Language) -> Verdict {
    let [width, height] = SIZE;
    let mut child = command(program)
        .arg(if language == Language::Wgsl { "wgsl" } else { "glsl" })
        .args(frames.iter().map(|frame| frame.time.to_string()))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("{program}: {error}"));
    let mut input = child.stdin.take().expect("a pipe");
    input.write_all(example.text.as_bytes()).expect("a child that reads");
    drop(input);
    let output = child.wait_with_output().expect("a child that ends");
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        return Verdict { complaint: Some(said), pictures: Vec::new() };
    }
    let pictures = output.stdout.chunks((4 * width * height) as usize);
    Verdict {
        complaint: None,
        pictures: pictures.map(|rgba| Picture { width, height, rgba: rgba.to_vec() }).collect(),
    }
}

/// The program, where Vulkan has SwiftShader and nothing else.
fn command(program: &str) -> Command {
    let driver = driver();
    let mut command = Command::new(program);
    command.arg("swiftshader").env("VK_DRIVER_FILES", &driver).env("VK_ICD_FILENAMES", &driver);
    command.env("NODEVICE_SELECT", "1");
    command
}
