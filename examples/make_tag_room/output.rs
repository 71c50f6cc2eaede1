//! Writes generated files, or compares them with the existing ones.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::path::{Path, PathBuf};

/// A file of the room.
pub(crate) struct Generated {
    /// Relative to `models/`.
    pub(crate) path: PathBuf,
    /// Its content.
    pub(crate) content: Content,
}

/// Text, or pixels of a PNG file.
pub(crate) enum Content {
    Text(String),
    Gray { width: u32, height: u32, pixels: Vec<u8> },
    Rgb { width: u32, height: u32, pixels: Vec<u8> },
}

impl Content {
    /// Writes the file and the folders above it.
    pub(crate) fn write(&self, file: &Path) -> Result<(), String> {
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
        }
        let bytes = match self {
            Self::Text(text) => text.clone().into_bytes(),
            Self::Gray { width, height, pixels } => png(pixels, *width, *height, ExtendedColorType::L8)?,
            Self::Rgb { width, height, pixels } => png(pixels, *width, *height, ExtendedColorType::Rgb8)?,
        };
        std::fs::write(file, bytes).map_err(|error| error.to_string())
    }

    /// Compares text by bytes and images by pixels, because another version of the PNG encoder may compress them differently.
    pub(crate) fn compare(&self, file: &Path) -> Result<(), String> {
        let same = match self {
            Self::Text(text) => std::fs::read_to_string(file).map_err(|error| error.to_string())? == *text,
            Self::Gray { width, height, pixels } => {
                let image = image::open(file).map_err(|error| error.to_string())?;
                let image = image.into_luma8();
                image.dimensions() == (*width, *height) && image.as_raw() == pixels
            }
            Self::Rgb { width, height, pixels } => {
                let image = image::open(file).map_err(|error| error.to_string())?;
                let image = image.into_rgb8();
                image.dimensions() == (*width, *height) && image.as_raw() == pixels
            }
        };
        if same {
            Ok(())
        } else {
            Err("differs from what the generator makes; run it without --check".into())
        }
    }
}

fn png(pixels: &[u8], width: u32, height: u32, color: ExtendedColorType) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive)
        .write_image(pixels, width, height, color)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}
