//! Image files.

use crate::mesh::gltf::picture;
use image::{DynamicImage, ImageFormat, ImageReader, ImageResult};
use std::io::{self, Cursor};
use std::path::Path;

/// Reads the bytes of an image file. An image inside a glTF file has its own path, `robot.glb#image0`.
///
/// # Errors
/// The file cannot be read, or contains no such image.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    picture::read(path)
}

/// Reads an image. Its format is recognised by its content, since files such as a `wood.png` that is a JPEG exist; only
/// a format without a signature, such as TGA, is recognised by the file's extension.
///
/// # Errors
/// The file cannot be read or decoded.
pub fn open(path: &Path) -> ImageResult<DynamicImage> {
    let mut reader = ImageReader::new(Cursor::new(read(path)?));
    if let Ok(format) = ImageFormat::from_path(path) {
        reader.set_format(format);
    }
    reader.with_guessed_format()?.decode()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageFormat, RgbImage};

    #[test]
    fn a_picture_is_what_its_bytes_are() {
        let folder = tempfile::tempdir().unwrap();
        let picture = RgbImage::from_pixel(3, 2, image::Rgb([200, 100, 50]));
        for (name, format) in
            [("wood.png", ImageFormat::Jpeg), ("wood.jpg", ImageFormat::Png), ("wood.tga", ImageFormat::Tga)]
        {
            let path = folder.path().join(name);
            picture.save_with_format(&path, format).unwrap();
            assert_eq!(open(&path).unwrap().into_rgb8().dimensions(), (3, 2), "{name}");
        }
        assert!(open(&folder.path().join("none.png")).is_err());
    }
    /// Half of the 16-bit range becomes half of the 8-bit range.
    #[test]
    fn pictures_of_16_bits_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep.png");
        image::ImageBuffer::from_pixel(3, 2, image::Rgb([0x8080_u16, 0xffff, 0])).save(&path).unwrap();
        assert_eq!(open(&path).unwrap().into_rgba8().get_pixel(2, 1).0, [0x80, 0xff, 0, 0xff]);
    }
}
