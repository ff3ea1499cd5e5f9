//! The reference compiler of GLSL, a program of its own.

use std::process::Command;

/// What it has against a whole fragment shader, if anything.
pub fn complaint(text: &str) -> Option<String> {
    let folder = tempfile::tempdir().expect("a folder for the shader");
    let path = folder.path().join("shader.frag");
    std::fs::write(&path, text).expect("a place for the shader");
    let output = Command::new("glslangValidator").arg(&path).output();
    let output = output
        .unwrap_or_else(|error| panic!("this test needs glslangValidator (Debian: glslang-tools): {error}"));
    (!output.status.success()).then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}
