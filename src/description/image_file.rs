//! Pictures in files.

use image::{DynamicImage, ImageReader, ImageResult};
use std::path::Path;

/// Reads a picture, of whatever kind its bytes are: names lie, as that of a `wood.png` which is a JPEG. What has
/// nothing to be known by, as TGA, is what it is called.
pub(crate) fn open(path: &Path) -> ImageResult<DynamicImage> {
    ImageReader::open(path)?.with_guessed_format()?.decode()
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
}
