//! Pictures in pages: what a setting makes of a scene, what is true, and how far both are apart.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use sdf_render::Picture;

/// The colour of pixels of which the truth is not proved, beside differences that are grey.
const UNDECIDED: [u8; 4] = [230, 159, 0, 255];
/// Which share of the pixels is shown with a difference that is not cut off.
const SHOWN: f64 = 0.999;
/// The most that a difference is multiplied by.
const MOST: u32 = 4096;

/// A difference as a picture.
#[derive(Debug, PartialEq)]
pub struct Difference {
    pub picture: Picture,
    /// What it is multiplied by; nothing where there is none to show.
    pub factor: Option<u32>,
}

/// A picture of colours in sRGB from 0 to 1.
pub fn picture((width, height): (u32, u32), colors: &[[f32; 3]]) -> Picture {
    let byte = |x: f32| (x * 255.0).round().clamp(0.0, 255.0) as u8;
    let rgba = colors.iter().flat_map(|[r, g, b]| [byte(*r), byte(*g), byte(*b), 255]);
    Picture { width, height, rgba: rgba.collect() }
}

/// The largest difference of a channel of each pixel, from black to white, multiplied by a power of two so that it is seen.
pub fn difference(size: (u32, u32), colors: &[[f32; 3]], truth: &[[f32; 3]], decided: &[bool]) -> Difference {
    let apart = |(a, b): (&[f32; 3], &[f32; 3])| {
        (0..3).map(|k| f64::from((a[k] - b[k]).abs())).fold(0.0, f64::max) * 255.0
    };
    let apart: Vec<f64> = colors.iter().zip(truth).map(apart).collect();
    let factor = factor(apart.iter().zip(decided).filter(|(_, is)| **is).map(|(x, _)| *x).collect());
    let pixel = |(apart, is_decided): (&f64, &bool)| match is_decided {
        true => {
            let grey = (apart * f64::from(factor.unwrap_or(1))).round().min(255.0) as u8;
            [grey, grey, grey, 255]
        }
        false => UNDECIDED,
    };
    let rgba = apart.iter().zip(decided).flat_map(pixel).collect();
    Difference { picture: Picture { width: size.0, height: size.1, rgba }, factor }
}

fn factor(mut apart: Vec<f64>) -> Option<u32> {
    apart.sort_by(f64::total_cmp);
    let last = apart.last().copied().filter(|most| *most > 0.0)?;
    let shown = apart[((apart.len() - 1) as f64 * SHOWN) as usize];
    let shown = if shown > 0.0 { shown } else { last };
    let fits = |factor: &u32| f64::from(*factor) * shown <= 255.0;
    let powers = std::iter::successors(Some(MOST), |factor| Some(factor / 2));
    Some(powers.take_while(|factor| *factor > 1).find(fits).unwrap_or(1))
}

/// The address of a picture that holds all of it.
pub fn address(picture: &Picture) -> String {
    let mut png = Vec::new();
    picture.write_png(&mut png, &[]).expect("a picture of a renderer can be encoded");
    format!("data:image/png;base64,{}", BASE64.encode(png))
}

#[cfg(test)]
mod tests {
    use super::{UNDECIDED, address, difference, picture};
    use base64::Engine as _;
    use base64::engine::general_purpose::STANDARD as BASE64;

    #[test]
    fn differences_are_grey_and_as_bright_as_can_be() {
        let truth = [[0.5; 3]; 3];
        let colors = [[0.5, 0.5 + 10.0 / 255.0, 0.5], [0.5, 0.5, 0.5 - 2.0 / 255.0], [0.9; 3]];
        let difference = difference((3, 1), &colors, &truth, &[true, true, false]);
        // Of two pixels the smaller difference is what 99.9 % are below.
        assert_eq!(difference.factor, Some(64));
        assert_eq!(difference.picture.pixel(0, 0), [255; 4]);
        assert_eq!(difference.picture.pixel(1, 0), [128, 128, 128, 255]);
        assert_eq!(difference.picture.pixel(2, 0), UNDECIDED);
    }

    #[test]
    fn where_nothing_differs_nothing_is_multiplied() {
        let equal = difference((2, 1), &[[0.3; 3]; 2], &[[0.3; 3]; 2], &[true, true]);
        assert_eq!((equal.factor, equal.picture.pixel(1, 0)), (None, [0, 0, 0, 255]));
        let unknown = difference((1, 1), &[[0.3; 3]], &[[0.4; 3]], &[false]);
        assert_eq!((unknown.factor, unknown.picture.pixel(0, 0)), (None, UNDECIDED));
        let large = difference((1, 1), &[[1.0; 3]], &[[0.0; 3]], &[true]);
        assert_eq!(large.factor, Some(1));
    }

    #[test]
    fn an_address_holds_the_picture() {
        let picture = picture((2, 1), &[[1.0, 0.0, 0.5], [0.0, 1.0, 2.0]]);
        assert_eq!(picture.rgba, [255, 0, 128, 255, 0, 255, 255, 255]);
        let address = address(&picture);
        let bytes = BASE64.decode(address.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut back).unwrap();
        assert_eq!(back, picture.rgba);
    }
}
