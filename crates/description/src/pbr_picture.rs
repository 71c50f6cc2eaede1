//! Images of roughness and metalness as one image.

use crate::image_file;
use crate::model::pbr_maps::{METALNESS, ROUGHNESS};
use crate::model::{Channel, PbrMaps};
use image::imageops::{self, FilterType};
use image::{ImageError, Rgba, RgbaImage};
use std::path::PathBuf;

/// Returns both maps as one image, with the roughness in green and the metalness in blue. Where one is missing, its
/// values are 1. If their sizes differ, both get the greater width and height. `None` if there is no map.
///
/// # Errors
/// The file that cannot be read, and why.
pub fn picture(maps: &PbrMaps) -> Result<Option<RgbaImage>, (PathBuf, ImageError)> {
    let open = |channel: &Option<Channel>| {
        let Some(Channel { path, channel }) = channel else { return Ok(None) };
        let picture = image_file::open(path).map_err(|error| (path.clone(), error))?.into_rgba8();
        Ok(Some((picture, *channel)))
    };
    let (roughness, metalness) = (open(&maps.roughness)?, open(&maps.metalness)?);
    let sizes = [&roughness, &metalness].into_iter().flatten().map(|(picture, _)| picture.dimensions());
    let Some((width, height)) = sizes.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1))) else { return Ok(None) };
    let mut both = RgbaImage::from_pixel(width, height, Rgba([u8::MAX; 4]));
    for (map, into) in [(roughness, ROUGHNESS), (metalness, METALNESS)] {
        let Some((mut picture, channel)) = map else { continue };
        if picture.dimensions() != (width, height) {
            picture = imageops::resize(&picture, width, height, FilterType::Triangle);
        }
        for (texel, from) in both.pixels_mut().zip(picture.pixels()) {
            texel.0[into] = from.0[channel];
        }
    }
    Ok(Some(both))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn two_maps_become_one() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, width, color: [u8; 3]| {
            let path = folder.path().join(name);
            image::RgbImage::from_pixel(width, 2, image::Rgb(color)).save(&path).unwrap();
            path
        };
        let (rough, metal) = (write("r.png", 2, [7, 1, 2]), write("m.png", 4, [9, 3, 4]));
        let red = |path: &PathBuf| Some(Channel { path: path.clone(), channel: 0 });
        let both = PbrMaps { roughness: red(&rough), metalness: red(&metal) };
        assert_eq!(picture(&both).unwrap().unwrap(), RgbaImage::from_pixel(4, 2, Rgba([255, 7, 9, 255])));
        assert_eq!((both.paths().count(), both.is_one_file()), (2, None));
        let one = PbrMaps { metalness: None, ..both };
        assert_eq!(picture(&one).unwrap().unwrap(), RgbaImage::from_pixel(2, 2, Rgba([255, 7, 255, 255])));
        let gltf = PbrMaps::of_gltf(&rough);
        assert_eq!(picture(&gltf).unwrap().unwrap(), RgbaImage::from_pixel(2, 2, Rgba([255, 1, 2, 255])));
        assert_eq!((gltf.paths().count(), gltf.is_one_file()), (1, Some(&*rough)));
        assert_eq!(picture(&PbrMaps::default()).unwrap(), None);
        let gone = PbrMaps::of_gltf(Path::new("gone.png"));
        assert_eq!(picture(&gone).unwrap_err().0, Path::new("gone.png"));
    }
}
