//! Pictures of 8 bits a channel, and PNG files.

use std::io::Write;

/// A picture: sRGB, opaque or with straight alpha, the first row at the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels from left to right.
    pub width: u32,
    /// Pixels from top to bottom.
    pub height: u32,
    /// Red, green, blue and alpha of each pixel, row by row.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// A picture that is opaque and black.
    pub fn black(width: u32, height: u32) -> Picture {
        Picture { width, height, rgba: [0, 0, 0, 255].repeat(width as usize * height as usize) }
    }

    /// Red, green, blue and alpha of the pixel in this column and this row, both from the top left.
    pub fn pixel(&self, column: u32, row: u32) -> [u8; 4] {
        assert!(column < self.width && row < self.height, "the pixel lies outside the picture");
        let start = (row as usize * self.width as usize + column as usize) * 4;
        std::array::from_fn(|i| self.rgba[start + i])
    }

    /// Writes a PNG file with these texts (a keyword of Latin-1 letters, any text). The same picture and texts give
    /// the same bytes.
    pub fn write_png(&self, to: impl Write, texts: &[(&str, &str)]) -> Result<(), png::EncodingError> {
        let mut encoder = png::Encoder::new(to, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        for (keyword, text) in texts {
            encoder.add_itxt_chunk((*keyword).to_string(), (*text).to_string())?;
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgba)?;
        writer.finish()
    }
}

/// A picture as it was drawn, with what its program yields beside the colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The colours; opaque.
    pub picture: Picture,
    /// A number for each pixel, row by row from the top, a bool as 0 or 1; none where the program yields colours alone.
    pub beside: Vec<f32>,
}

impl Drawn {
    /// What render targets of 8 bits a channel hold, with bools in the fourth channel.
    pub fn from_bytes(width: u32, height: u32, mut rgba: Vec<u8>) -> Drawn {
        let fourth = rgba.iter_mut().skip(3).step_by(4);
        let beside = fourth.map(|byte| f32::from(std::mem::replace(byte, 255) / 255)).collect();
        Drawn { picture: Picture { width, height, rgba }, beside }
    }

    /// What render targets of floats hold, with numbers in the fourth channel.
    pub fn from_floats(width: u32, height: u32, floats: &[f32]) -> Drawn {
        let pixels = floats.chunks_exact(4);
        let rgba =
            pixels.clone().flat_map(|p| [quantise(p[0]), quantise(p[1]), quantise(p[2]), 255]).collect();
        Drawn { picture: Picture { width, height, rgba }, beside: pixels.map(|p| p[3]).collect() }
    }
}

/// A channel in 0..1 as a render target of 8 bits stores it.
pub fn quantise(channel: f32) -> u8 {
    (channel.clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_rounded_and_clamped() {
        let cases = [
            (0.0, 0),
            (1.0, 255),
            (-3.0, 0),
            (7.0, 255),
            (0.5, 128),
            (127.4 / 255.0, 127),
            (127.6 / 255.0, 128),
        ];
        for (channel, byte) in cases {
            assert_eq!(quantise(channel), byte, "{channel}");
        }
    }

    #[test]
    fn a_file_holds_the_picture_and_its_texts() {
        let mut picture = Picture::black(3, 2);
        picture.rgba[4..8].copy_from_slice(&[10, 20, 30, 40]);
        assert_eq!(picture.pixel(1, 0), [10, 20, 30, 40]);
        assert_eq!(picture.pixel(2, 1), [0, 0, 0, 255]);
        let mut file = Vec::new();
        picture.write_png(&mut file, &[("Software", "a test, é")]).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let mut rgba = vec![0; picture.rgba.len()];
        reader.next_frame(&mut rgba).unwrap();
        assert_eq!(rgba, picture.rgba);
        let text = &reader.info().utf8_text[0];
        assert_eq!((text.keyword.as_str(), text.get_text().unwrap().as_str()), ("Software", "a test, é"));
    }
}
