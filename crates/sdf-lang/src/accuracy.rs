//! What trades accuracy for time: the settings of `render` that do, the presets of `quality`, and what is varied besides them
//! to be measured.

use std::fmt::{self, Display, Formatter};

/// What `relax` of a scene may be: for steps that are relaxed, and for those that are not.
pub(crate) const RELAX: [&str; 2] = ["auto", "none"];

/// All that trades accuracy for time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// How far from the true surface a hit may be, in pixels.
    pub tolerance: f64,
    /// How many steps a ray is given.
    pub steps: u32,
    /// Whether steps are relaxed: longer than is certain, and taken back where they were too long.
    pub relax: bool,
    /// From what normals are found.
    pub normals: Normals,
    /// How much darker a soft shadow may be between two samples of the way to a light.
    pub shadow_accuracy: f64,
    /// How many samples the occlusion of ambient light is summed up from.
    pub occlusion_samples: u32,
    /// How many rays a pixel has, along each side of a grid.
    pub antialias: u32,
    /// How steps are kept from passing through surfaces where fields are steep.
    pub correction: Correction,
    /// What coordinates are relative to.
    pub coordinates: Coordinates,
}

/// From what normals are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normals {
    /// The gradient, differentiated.
    Exact,
    /// Four samples at the corners of a tetrahedron.
    Tetrahedron,
    /// Differences of two samples along each axis.
    Central,
}

/// How steps are kept from passing through surfaces where fields are steep. Scenes are compiled with the first; the other is for
/// comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Correction {
    /// The distance over the slope that is proved, on the branch that needs it.
    Derived,
    /// Each step is this share of the distance, wherever it is and whatever is near; 1 corrects nothing.
    Factor(f64),
}

/// What coordinates are relative to. Scenes are compiled with the first; the others are for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinates {
    /// The camera's place if that is far from the origin, else the origin.
    Chosen,
    /// The origin.
    World,
    /// The camera's place.
    Camera,
}

/// A preset of `quality`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// The fastest, to try things out: edges may be a pixel off.
    Draft,
    /// What a scene has that says nothing.
    Balanced,
    /// Half as far off as what a scene has that says nothing, or less.
    Fine,
    /// The least error of all.
    Exact,
}

impl Normals {
    /// All, the first being what a scene has that says nothing.
    pub const ALL: [Normals; 3] = [Normals::Exact, Normals::Tetrahedron, Normals::Central];

    /// Its word in a scene.
    pub fn word(self) -> &'static str {
        match self {
            Normals::Exact => "exact",
            Normals::Tetrahedron => "tetrahedron",
            Normals::Central => "central",
        }
    }
}

impl Quality {
    /// All, from the coarsest on.
    pub const ALL: [Quality; 4] = [Quality::Draft, Quality::Balanced, Quality::Fine, Quality::Exact];

    /// Its word in a scene.
    pub fn word(self) -> &'static str {
        match self {
            Quality::Draft => "draft",
            Quality::Balanced => "balanced",
            Quality::Fine => "fine",
            Quality::Exact => "exact",
        }
    }

    /// What it stands for. The numbers are derived from measurements of all examples: `tests/tables/presets.md`.
    pub fn accuracy(self) -> Accuracy {
        let balanced = Accuracy {
            tolerance: 0.1,
            steps: 256,
            relax: true,
            normals: Normals::Exact,
            shadow_accuracy: 0.015,
            occlusion_samples: 6,
            antialias: 1,
            correction: Correction::Derived,
            coordinates: Coordinates::Chosen,
        };
        match self {
            Quality::Draft => {
                Accuracy { tolerance: 1.0, shadow_accuracy: 0.06, occlusion_samples: 3, ..balanced }
            }
            Quality::Balanced => balanced,
            Quality::Fine => Accuracy { tolerance: 0.01, ..balanced },
            Quality::Exact => Accuracy {
                tolerance: 0.01,
                steps: 1024,
                shadow_accuracy: 0.004,
                occlusion_samples: 12,
                ..balanced
            },
        }
    }
}

impl Default for Accuracy {
    /// What a scene has that says nothing.
    fn default() -> Accuracy {
        Quality::Balanced.accuracy()
    }
}

impl Accuracy {
    /// The fields of a block `render` that say so, with their values as written; what a scene cannot say is left out.
    pub fn fields(&self) -> [(&'static str, String); 7] {
        [
            ("tolerance", self.tolerance.to_string()),
            ("steps", self.steps.to_string()),
            ("normals", self.normals.word().into()),
            ("relax", RELAX[usize::from(!self.relax)].into()),
            ("shadow_accuracy", self.shadow_accuracy.to_string()),
            ("occlusion_samples", self.occlusion_samples.to_string()),
            ("antialias", self.antialias.to_string()),
        ]
    }

    /// Those of its fields that say something else than another's.
    pub fn fields_beside(&self, other: &Accuracy) -> Vec<(&'static str, String)> {
        let both = self.fields().into_iter().zip(other.fields());
        both.filter(|(own, other)| own != other).map(|(own, _)| own).collect()
    }
}

/// As the block of a scene that says so.
impl Display for Accuracy {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let fields = self.fields().map(|(name, value)| format!("{name}: {value}"));
        write!(f, "render {{ {} }}", fields.join(", "))
    }
}
