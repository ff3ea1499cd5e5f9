//! `draw DEVICE wgsl|glsl TIME… < scene.sdf > pixels`: the pictures of a scene, four bytes a pixel, one after the other.
//! `draw DEVICE` prints what the device and its driver are called.

use sdf_tests::drawing::{frame_at, on_device, shader};
use sdf_tests::run::version_of;
use sdf_tests::scenes::Example;
use sdfc::Language;
use std::io::{Read, Write};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (device, language, times) = match arguments.as_slice() {
        [device] => return print!("{}", version_of(device)),
        [device, language, times @ ..] => (device, language, times),
        [] => panic!("usage: draw DEVICE [wgsl|glsl TIME…] < scene.sdf > pixels"),
    };
    let language = match language.as_str() {
        "wgsl" => Language::Wgsl,
        "glsl" => Language::Glsl,
        other => panic!("`{other}` is no language"),
    };
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).expect("a scene");
    let frames: Vec<_> = times.iter().map(|time| frame_at(time.parse().expect("seconds"))).collect();
    let shader = shader(&Example { name: "scene.sdf".into(), text });
    let verdict = on_device(&shader, &frames, device, language);
    if let Some(complaint) = verdict.complaint {
        eprintln!("{complaint}");
        std::process::exit(1);
    }
    for picture in verdict.pictures {
        std::io::stdout().write_all(&picture.rgba).expect("somebody who listens");
    }
}
