//! What a scene can be drawn as besides its text's picture.

/// What a scene is drawn as. The program's entry then has a second result, which stands beside the colour of each pixel.
///
/// Of [`View::Picture`] it is `lost: bool`, whether the pixel's ray ran out of steps. Of the others it is `measure: float`:
/// -1 where the ray ran out of steps, 0 where there is nothing to measure, else what the view measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum View {
    /// The picture that the text draws.
    Picture,
    /// Grey by the distance from the eye, which is measured, in units of the scene.
    Depth,
    /// The surface's normal as a colour; 1 is measured.
    Normal,
    /// How many steps the ray took, as a colour and measured; where nothing is met, too.
    Steps,
    /// How far the place that was met is from the surface to first order, as a colour and measured, in tolerances.
    Error,
    /// The surface's colour without light; 1 is measured.
    Material,
}

impl View {
    /// The name of the function in `runtime/view.sdf` that draws it.
    pub(crate) fn entry(self) -> &'static str {
        match self {
            View::Picture => "view_picture",
            View::Depth => "view_depth",
            View::Normal => "view_normal",
            View::Steps => "view_steps",
            View::Error => "view_error",
            View::Material => "view_material",
        }
    }

    /// Whether lights, shadows and glow are part of it.
    pub(crate) fn is_lit(self) -> bool {
        self == View::Picture
    }
}
