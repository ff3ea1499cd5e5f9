//! `compute DEVICE wgsl|glsl BYTES INVOCATIONS WIDTH < text and words > words`: what a compute shader of that many bytes,
//! followed by the words of its arguments, leaves on a device: `WIDTH` words for each invocation. Words are little-endian.
//! `compute DEVICE` prints what the device and its driver are called.

use sdf_emit::KernelLanguage;
use sdf_render::gpu::{DevicePreference, Gpu};
use sdf_tests::run::{Kernel, version_of};
use std::io::{Read, Write};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [device] = arguments.as_slice() {
        return print!("{}", version_of(device));
    }
    let [device, language, bytes, invocations, width] = arguments.as_slice() else {
        panic!("usage: compute DEVICE wgsl|glsl BYTES INVOCATIONS WIDTH < text and words > words");
    };
    let language = match language.as_str() {
        "wgsl" => KernelLanguage::Wgsl,
        "glsl" => KernelLanguage::Glsl450,
        other => panic!("`{other}` is no language"),
    };
    let number = |text: &String| text.parse().unwrap_or_else(|_| panic!("`{text}` is no number"));
    let mut input = Vec::new();
    std::io::stdin().read_to_end(&mut input).expect("a shader and its words");
    let words = input.split_off(number(bytes));
    let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
    let kernel = Kernel {
        language,
        text: String::from_utf8(input).expect("a text"),
        input: words.chunks_exact(4).map(word).collect(),
        invocations: number(invocations),
        width: number(width),
    };
    let gpu = Gpu::new(&DevicePreference::Named(device.clone())).unwrap_or_else(|error| panic!("{error}"));
    let words = kernel.words_on(&gpu).unwrap_or_else(|error| panic!("{error}"));
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    std::io::stdout().write_all(&bytes).expect("somebody who listens");
}
