//! Image files.

use crate::mesh::gltf::picture;
use image::error::DecodingError;
use image::{DynamicImage, ImageError, ImageFormat, ImageReader, ImageResult};
use std::error::Error as _;
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
/// The file cannot be read or decoded, or ends before the image does.
pub fn open(path: &Path) -> ImageResult<DynamicImage> {
    let bytes = read(path)?;
    if bytes.is_empty() {
        return Err(cut("the file is empty"));
    }
    let extension = ImageFormat::from_path(path).ok();
    let picture = decode(&bytes, extension).map_err(readable)?;
    if lacks_end(&bytes) {
        // The decoder fills what is missing with grey. Then other bytes at the end make another picture.
        let longer = [&bytes[..], &[0x5a; 4096]].concat();
        if decode(&longer, extension).ok().as_ref() != Some(&picture) {
            return Err(cut("the file ends before its picture does"));
        }
    }
    Ok(picture)
}

fn decode(bytes: &[u8], extension: Option<ImageFormat>) -> ImageResult<DynamicImage> {
    let mut reader = ImageReader::new(Cursor::new(bytes));
    if let Some(format) = extension {
        reader.set_format(format);
    }
    reader.with_guessed_format()?.decode()
}

fn cut(what: &str) -> ImageError {
    io::Error::new(io::ErrorKind::UnexpectedEof, what).into()
}

/// Returns true for a JPEG that has no marker of its end after its last scan. Some programs do not write the marker.
fn lacks_end(bytes: &[u8]) -> bool {
    const BEGIN_OF_SCAN: [u8; 2] = [0xff, 0xda];
    const END_OF_PICTURE: [u8; 2] = [0xff, 0xd9];
    if !matches!(image::guess_format(bytes), Ok(ImageFormat::Jpeg)) {
        return false;
    }
    let scan = bytes.windows(2).rposition(|pair| pair == BEGIN_OF_SCAN).unwrap_or_default();
    !bytes[scan..].windows(2).any(|pair| pair == END_OF_PICTURE)
}

/// Returns an error whose text is one line without the decoder's data structures.
fn readable(error: ImageError) -> ImageError {
    let ImageError::Decoding(inner) = &error else { return error };
    let Some(source) = inner.source() else { return error };
    let text = source.to_string();
    let text = text.split(" while decoding ChunkType").next().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    ImageError::Decoding(DecodingError::new(inner.format_hint(), text.trim_end_matches('.')))
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

    /// The decoder fills the missing part of a JPEG with grey, without an error.
    #[test]
    fn a_jpeg_that_is_cut_off_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cut.jpg");
        RgbImage::from_fn(64, 48, |x, y| image::Rgb([(x * y) as u8, x as u8 * 4, y as u8 * 5]))
            .save(&path)
            .unwrap();
        let whole = std::fs::read(&path).unwrap();
        let picture = open(&path).unwrap();
        // Without the marker of the end, nothing is missing; nor with bytes after it.
        for same in [whole[..whole.len() - 2].to_vec(), [&whole[..], b"more"].concat()] {
            std::fs::write(&path, same).unwrap();
            assert_eq!(open(&path).unwrap(), picture);
        }
        for len in [whole.len() / 2, whole.len() * 9 / 10] {
            std::fs::write(&path, &whole[..len]).unwrap();
            let error = open(&path).unwrap_err().to_string();
            assert_eq!(error, "the file ends before its picture does", "{len}");
        }
    }

    #[test]
    fn errors_are_one_readable_line() {
        let folder = tempfile::tempdir().unwrap();
        let error = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            open(&path).unwrap_err().to_string()
        };
        assert_eq!(error("empty.jpg", b""), "the file is empty");
        let said = error("short.jpg", b"\xff\xd8\xff\xe0");
        assert!(said.starts_with("Format error decoding Jpeg: ") && !said.contains('\n'), "{said:?}");
        let path = folder.path().join("p.png");
        RgbImage::from_fn(64, 48, |x, y| image::Rgb([(x * y) as u8, (x * x * y) as u8, (x * y * y) as u8]))
            .save(&path)
            .unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 255;
        let said = error("sum.png", &bytes);
        assert!(said.starts_with("Format error decoding Png: ") && !said.contains('{'), "{said}");
        let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
        assert_eq!(error("p.png", pointer), "it is a pointer of Git LFS, and not the file itself");
    }
}
