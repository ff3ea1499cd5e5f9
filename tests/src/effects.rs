//! The page of the effects, `grammar/effects.md`, and its pictures: one scene without each of them and with it.

use crate::scenes::{folder, legalised, scene};
use sdf_lang::{Options, compiler_files};
use sdf_render::{Frame, Picture, cpu};
use std::path::PathBuf;

/// Width and height of a picture, in pixels.
pub const SIZE: [u32; 2] = [320, 180];

/// An effect as the page shows it.
#[derive(Debug, Clone, Copy)]
pub struct Shown {
    /// Its title, and, in lower case and with `_` between the words, the name of its pictures.
    pub title: &'static str,
    /// The file of the renderer whose opening comment says what it is, what calls for it and what it costs.
    pub file: &'static str,
    /// The items of the scene without it, in place of those of [`BASE`] that begin with the same words.
    pub without: &'static [&'static str],
    /// Those of the scene with it.
    pub with: &'static [&'static str],
}

/// The items of the scene of the pictures; a material of its ball and a light that casts no shadow call for nothing.
pub const BASE: [&str; 8] = [
    "camera { eye: (2.4, 1.7, 4.6), target: (0, 0.55, 0), fov: 32deg }",
    "light sun { direction: (3, 4, 2) }",
    "ambient { color: 0.25 }",
    "sky { color: #b8cde0 }",
    "material ball { color: #3878c8, specular: 0.5 }",
    "material tiles { color: checker(p.xz, #d9d4c8, #8b8f94, 0.5), specular: 0 }",
    "render { antialias: 3 }",
    "scene {
  plane().paint(tiles),
  sphere(0.7).at(-0.2, 0.7, 0).paint(ball),
  round_box((0.3, 0.45, 0.3), 0.05).at(1.15, 0.45, 0.1).paint(#c8503a),
  torus(0.3, 0.1).at(-1.3, 0.1, 0.9).paint(#d8a038),
}",
];

/// The effects in the order of the page.
pub const SHOWN: [Shown; 16] = [
    Shown {
        title: "Several lights",
        file: "light.sdf",
        without: &[],
        with: &["light lamp { position: (-2, 1.6, 1.5), color: #ff7a30, intensity: 0.9 }"],
    },
    Shown {
        title: "Hard shadow",
        file: "hard_shadow.sdf",
        without: &[],
        with: &["light sun { direction: (3, 4, 2), shadow: hard }"],
    },
    Shown {
        title: "Soft shadow",
        file: "soft_shadow.sdf",
        without: &[],
        with: &["light sun { direction: (3, 4, 2), shadow: soft(8) }"],
    },
    Shown {
        title: "Occlusion",
        file: "occlusion.sdf",
        without: &["ambient { color: 0.6 }"],
        with: &["ambient { color: 0.6, occlusion: 1, radius: 0.8 }"],
    },
    Shown {
        title: "Glow",
        file: "glow.sdf",
        without: &["light sun { direction: (3, 4, 2), intensity: 0.3 }", "sky { color: #10151c }"],
        with: &[
            "light sun { direction: (3, 4, 2), intensity: 0.3 }",
            "sky { color: #10151c }",
            "material ball { color: #3878c8, specular: 0.5, glow: #30b0ff, glow_radius: 0.5 }",
        ],
    },
    Shown {
        title: "Emission",
        file: "pixel.sdf",
        without: &["light sun { direction: (3, 4, 2), intensity: 0.3 }"],
        with: &[
            "light sun { direction: (3, 4, 2), intensity: 0.3 }",
            "material ball { color: #3878c8, specular: 0.5, emission: (0.1, 0.4, 0.9) * (0.5 + 0.5 * sin(30 * p.y)) }",
        ],
    },
    Shown {
        title: "Rim light",
        file: "rim.sdf",
        without: &["light sun { direction: (3, 4, 2), intensity: 0.5 }"],
        with: &["light sun { direction: (3, 4, 2), intensity: 0.5 }", "rim { color: #ffe0b0, power: 2.5 }"],
    },
    Shown { title: "Fog", file: "fog.sdf", without: &[], with: &["fog { density: 0.12 }"] },
    Shown {
        title: "Reflection",
        file: "reflect.sdf",
        without: &[],
        with: &[
            "material ball { color: #3878c8, specular: 0.5, reflect: 0.75 }",
            "material tiles { color: checker(p.xz, #d9d4c8, #8b8f94, 0.5), specular: 0, reflect: 0.2 }",
        ],
    },
    Shown {
        title: "Transmission",
        file: "transmit.sdf",
        without: &[],
        with: &["material ball { color: #3878c8, specular: 0.5, transmit: 0.9, ior: 1.5 }"],
    },
    Shown {
        title: "Sky",
        file: "pixel.sdf",
        without: &[],
        with: &["sky { horizon: #f2d3b0, zenith: #3f6fae }"],
    },
    Shown {
        title: "Tone mapping",
        file: "tonemap.sdf",
        without: &["light sun { direction: (3, 4, 2), intensity: 4 }"],
        with: &["light sun { direction: (3, 4, 2), intensity: 4 }", "render { antialias: 3, tonemap: aces }"],
    },
    Shown {
        title: "Antialiasing",
        file: "antialias.sdf",
        without: &["render { antialias: 1 }"],
        with: &["render { antialias: 4 }"],
    },
    Shown {
        title: "Orthographic camera",
        file: "camera.sdf",
        without: &[],
        with: &[
            "camera { eye: (2.4, 1.7, 4.6), target: (0, 0.55, 0), fov: 32deg, projection: orthographic }",
        ],
    },
    Shown {
        title: "Sampled normals",
        file: "normals.sdf",
        without: &[],
        with: &["render { antialias: 3, normals: central }"],
    },
    Shown {
        title: "Shading of one's own",
        file: "shade.sdf",
        without: &[],
        with: &[
            "light sun { direction: (3, 4, 2), shadow: hard }",
            "fn shade(s) {
  let lit = max(dot(s.n, sun.direction), 0) * shadow(sun);
  let outline = if dot(s.n, s.to_eye) < 0.3 { 0.2 } else { 1 };
  s.color * (0.35 + 0.65 * floor(lit * 3 + 0.5) / 3) * outline
}",
        ],
    },
];

impl Shown {
    /// The names of its pictures: without it and with it.
    pub fn pictures(&self) -> [String; 2] {
        let name: String = self
            .title
            .to_lowercase()
            .chars()
            .filter(|c| *c != '\'')
            .map(|c| if c == ' ' { '_' } else { c })
            .collect();
        ["without", "with"].map(|which| format!("{name}_{which}.png"))
    }

    /// The scenes of its pictures.
    pub fn scenes(&self) -> [String; 2] {
        [self.without, self.with].map(|items| {
            let head = |item: &str| item.split('{').next().unwrap_or_default().trim().to_owned();
            let mut scene: Vec<&str> = Vec::new();
            for item in BASE {
                scene.push(items.iter().find(|own| head(own) == head(item)).unwrap_or(&item));
            }
            scene.extend(items.iter().filter(|own| !BASE.iter().any(|item| head(own) == head(item))));
            scene.join("\n")
        })
    }

    /// Its pictures, as the interpreter draws them.
    pub fn drawn(&self) -> [Picture; 2] {
        self.scenes().map(|text| {
            let program =
                scene(self.title, &text, &Options { attack: Some(0), ..Options::default() }).program;
            let program = legalised(&program, program.entry.expect("a pixel"));
            cpu::render(&program, &Frame::new(SIZE[0], SIZE[1]))
        })
    }
}

/// Where the page lies.
pub fn page_path() -> PathBuf {
    folder().join("../grammar/effects.md")
}

/// Where a picture of the page lies.
pub fn picture_path(name: &str) -> PathBuf {
    folder().join("../grammar/effects").join(name)
}

/// The page.
pub fn page() -> String {
    let mut out = String::from(
        "# The effects\n\n\
         What the files of the renderer ([`runtime/`](../crates/sdf-lang/runtime), written in the language itself) say of themselves, and\n\
         the scene at the end of this page without each effect and with it; a test keeps the page and its pictures so. What a scene\n\
         does not call for is not in its shader; `sdfc explain scene.sdf` says what is, why, and what it costs.\n",
    );
    for shown in SHOWN {
        let [without, with] = shown.pictures();
        out += &format!(
            "\n## {}\n\n{}\n\n([`runtime/{}`](../crates/sdf-lang/runtime/{}))\n\n```\n{}\n```\n\n\
             | without | with |\n|---|---|\n| ![without](effects/{without}) | ![with](effects/{with}) |\n",
            shown.title,
            opening(shown.file),
            shown.file,
            shown.file,
            shown.with.join("\n"),
        );
    }
    out + &format!("\n## The scene\n\n```\n{}\n```\n", BASE.join("\n"))
}

/// The comment that a file of the renderer opens with, its paragraphs each on a line.
fn opening(file: &str) -> String {
    let (_, text) =
        compiler_files().find(|(name, _)| *name == file).unwrap_or_else(|| panic!("no file {file}"));
    let lines = text.lines().take_while(|line| line.starts_with("//") && !line.starts_with("///"));
    let lines: Vec<&str> = lines.map(|line| line.trim_start_matches('/').trim()).collect();
    lines.split(|line| line.is_empty()).map(|lines| lines.join(" ")).collect::<Vec<_>>().join("\n\n")
}
