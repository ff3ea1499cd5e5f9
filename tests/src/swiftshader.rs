//! SwiftShader as a Vulkan driver. Vulkan's loader reads which drivers there are when a process starts, so it is
//! another process that draws.

use crate::drawing::{SIZE, Verdict};
use crate::run::Kernel;
use crate::scenes::Example;
use sdf_emit::KernelLanguage;
use sdf_render::{Frame, Picture};
use sdfc::Language;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

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
    let mut command = command(program);
    command.arg(if language == Language::Wgsl { "wgsl" } else { "glsl" });
    command.args(frames.iter().map(|frame| frame.time.to_string()));
    let output = piped(&mut command, example.text.as_bytes());
    let output = output.unwrap_or_else(|error| panic!("{program}: {error}"));
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

/// The words that a compute shader leaves on SwiftShader, by the program `compute`, which lies at `program`; or what is
/// said against it.
pub fn compute(program: &str, kernel: &Kernel) -> Result<Vec<u32>, String> {
    let language = if kernel.language == KernelLanguage::Wgsl { "wgsl" } else { "glsl" };
    let numbers = [kernel.text.len(), kernel.invocations, kernel.width].map(|n| n.to_string());
    let words = kernel.input.iter().flat_map(|word| word.to_le_bytes());
    let input: Vec<u8> = kernel.text.bytes().chain(words).collect();
    let mut command = command(program);
    command.arg(language).args(numbers);
    let output = piped(&mut command, &input).map_err(|error| format!("{program}: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
    Ok(output.stdout.chunks_exact(4).map(word).collect())
}

/// What a command makes of an input.
fn piped(command: &mut Command, input: &[u8]) -> std::io::Result<Output> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn()?;
    child.stdin.take().expect("a pipe").write_all(input)?;
    child.wait_with_output()
}

/// The program, where Vulkan has SwiftShader and nothing else.
fn command(program: &str) -> Command {
    let driver = driver();
    let mut command = Command::new(program);
    command.arg("swiftshader").env("VK_DRIVER_FILES", &driver).env("VK_ICD_FILENAMES", &driver);
    command.env("NODEVICE_SELECT", "1");
    command
}
