//! The reference compiler of GLSL, a program of its own, which also reads HLSL, and the validator of SPIR-V.

use std::path::Path;
use std::process::Command;

/// What it has against a whole fragment shader, if anything.
pub fn complaint(text: &str) -> Option<String> {
    let folder = tempfile::tempdir().expect("a folder for the shader");
    let path = folder.path().join("shader.frag");
    std::fs::write(&path, text).expect("a place for the shader");
    run("glslangValidator", &[], Some(&path)).err()
}

/// What it makes of a stage (`vert` or `frag`) of a text in HLSL: SPIR-V.
pub fn spir_v_of_hlsl(text: &str, stage: &str, entry: &str) -> Result<Vec<u8>, String> {
    let folder = tempfile::tempdir().expect("a folder for the shader");
    let [path, out] = ["shader.hlsl", "shader.spv"].map(|name| folder.path().join(name));
    std::fs::write(&path, text).expect("a place for the shader");
    let out_name = out.to_string_lossy();
    run("glslangValidator", &["-D", "-V", "-S", stage, "-e", entry, "-o", &out_name], Some(&path))?;
    Ok(std::fs::read(&out).expect("a module"))
}

/// What the validator has against a module of SPIR-V for Vulkan 1.0, if anything.
pub fn complaint_about_spir_v(bytes: &[u8]) -> Option<String> {
    let folder = tempfile::tempdir().expect("a folder for the shader");
    let path = folder.path().join("shader.spv");
    std::fs::write(&path, bytes).expect("a place for the shader");
    run("spirv-val", &["--target-env", "vulkan1.0"], Some(&path)).err()
}

/// The name and version of the reference compiler.
pub fn version() -> String {
    let said = run("glslangValidator", &["--version"], None).unwrap_or_default();
    let version = said.lines().find_map(|line| line.strip_prefix("Glslang Version: "));
    format!("glslang {}", version.unwrap_or("of no version"))
}

/// Runs a program, on a file if one is given. What it said is the error if it failed.
fn run(program: &str, arguments: &[&str], path: Option<&Path>) -> Result<String, String> {
    let output = Command::new(program).args(arguments).args(path).output();
    let output = output.unwrap_or_else(|error| {
        panic!("this test needs {program} (Debian: glslang-tools, spirv-tools): {error}")
    });
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    if output.status.success() { Ok(said.concat()) } else { Err(said.concat()) }
}
