//! The device that tests run shaders on: Mesa's software driver, unless the environment's `ADAPTER` names another.
//!
//! `ADAPTER=nvidia cargo test --release --workspace --test hard_cases` takes the first device whose name contains that, in
//! any case. Then no other driver and no browser is asked, and what is kept stands in tables that have the device's name in
//! theirs.

use sdf_render::gpu::{DevicePreference, Gpu};
use std::sync::OnceLock;

/// A part of the name that Mesa's software driver has.
const LAVAPIPE: &str = "llvmpipe";

/// What the environment asks for, if anything.
fn asked() -> Option<String> {
    std::env::var("ADAPTER").ok()
}

/// Whether the environment names the device.
pub fn is_chosen() -> bool {
    asked().is_some()
}

/// The device.
pub fn adapter() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| match asked() {
        Some(name) => Gpu::new(&DevicePreference::Named(name)).unwrap_or_else(|error| panic!("{error}")),
        None => Gpu::new(&DevicePreference::Named(LAVAPIPE.into())).unwrap_or_else(|error| {
            panic!("this test needs Mesa's software Vulkan driver (Debian: mesa-vulkan-drivers): {error}")
        }),
    })
}

/// What tables call the device.
pub fn title() -> &'static str {
    if is_chosen() { &adapter().name().name } else { "lavapipe" }
}

/// The device and its driver with their versions.
pub fn version() -> String {
    let name = adapter().name();
    if is_chosen() { format!("{}, {}", name.name, name.driver) } else { name.driver.clone() }
}

/// What a table is called: `name.md`, or `name_device.md` where the environment names the device.
pub fn table(name: &str) -> String {
    if is_chosen() { format!("{name}_{}.md", slug(title())) } else { format!("{name}.md") }
}

/// A name as part of a file's name: its letters and digits, in lower case, with `_` between words.
fn slug(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_").to_lowercase()
}

/// What the processor is called, and how many there are.
pub fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let count = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{count} processors, {}", name.map_or("of an unknown kind", |(_, name)| name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_a_device_is_part_of_a_files_name() {
        assert_eq!(slug("NVIDIA H100 80GB HBM3"), "nvidia_h100_80gb_hbm3");
        assert_eq!(slug("llvmpipe (LLVM 15.0.6, 256 bits)"), "llvmpipe_llvm_15_0_6_256_bits");
    }
}
