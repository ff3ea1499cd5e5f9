//! Files of the pictures that the repository keeps.

use sdf_render::Picture;
use std::fs;
use std::io::BufWriter;
use std::path::Path;

/// Writes a picture as a PNG file, in a folder that is made.
pub fn write(path: &Path, picture: &Picture) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("the folder can be made");
    let file = BufWriter::new(fs::File::create(path).expect("the picture can be written"));
    let mut encoder = png::Encoder::new(file, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let rgb: Vec<u8> = picture.rgba.chunks(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let mut writer = encoder.write_header().expect("a head");
    writer.write_image_data(&rgb).expect("a picture");
    writer.finish().expect("an end");
}

/// Reads such a file, if there is one.
pub fn read(path: &Path) -> Option<Picture> {
    let file = std::io::BufReader::new(fs::File::open(path).ok()?);
    let mut reader = png::Decoder::new(file).read_info().ok()?;
    let mut rgb = vec![0; reader.output_buffer_size()?];
    let info = reader.next_frame(&mut rgb).ok()?;
    let rgba = rgb.chunks(3).flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255]).collect();
    (info.color_type == png::ColorType::Rgb).then_some(Picture {
        width: info.width,
        height: info.height,
        rgba,
    })
}
