//! Images of roughness and metalness as one image.

use crate::image_file;
use crate::model::pbr_maps::{METALNESS, ROUGHNESS};
use crate::model::{Channel, PbrMaps};
use image::imageops::{self, FilterType};
use image::{ImageError, Rgba, RgbaImage};
use std::path::Path;

/// Returns both maps as one image, with the roughness in green and the metalness in blue. If their sizes differ, the one
/// with fewer texels gets the size of the other. Where there is no map, or its file is `unusable`, the values are 1.
/// `None` if there is no map at all.
pub fn picture(maps: &PbrMaps, mut unusable: impl FnMut(&Path, &ImageError)) -> Option<RgbaImage> {
    let mut pictures = Vec::new();
    for path in maps.paths() {
        match image_file::open(path) {
            Ok(picture) => pictures.push((path, picture.into_rgba8())),
            Err(error) => unusable(path, &error),
        }
    }
    // Not the greater width and height: of a wide and a tall image, that would be more than memory can hold.
    let sizes = pictures.iter().map(|(_, picture)| picture.dimensions());
    let (width, height) = sizes.max_by_key(|(width, height)| u64::from(*width) * u64::from(*height))?;
    let mut both = RgbaImage::from_pixel(width, height, Rgba([u8::MAX; 4]));
    for (map, into) in [(&maps.roughness, ROUGHNESS), (&maps.metalness, METALNESS)] {
        let Some(Channel { path, channel }) = map else { continue };
        let Some((_, picture)) = pictures.iter().find(|(own, _)| *own == path) else { continue };
        let resized;
        let picture = if picture.dimensions() == (width, height) {
            picture
        } else {
            resized = imageops::resize(picture, width, height, FilterType::Triangle);
            &resized
        };
        for (texel, from) in both.pixels_mut().zip(picture.pixels()) {
            texel.0[into] = from.0[*channel];
        }
    }
    Some(both)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// The image, and the names of unusable files.
    fn made(maps: &PbrMaps) -> (Option<RgbaImage>, Vec<PathBuf>) {
        let mut unusable = Vec::new();
        let picture = picture(maps, |path, _| unusable.push(path.to_path_buf()));
        (picture, unusable)
    }

    #[test]
    fn two_maps_become_one() {
        let picture = |maps: &PbrMaps| made(maps).0.unwrap();
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, width, color: [u8; 3]| {
            let path = folder.path().join(name);
            image::RgbImage::from_pixel(width, 2, image::Rgb(color)).save(&path).unwrap();
            path
        };
        let (rough, metal) = (write("r.png", 2, [7, 1, 2]), write("m.png", 4, [9, 3, 4]));
        let red = |path: &PathBuf| Some(Channel { path: path.clone(), channel: 0 });
        let both = PbrMaps { roughness: red(&rough), metalness: red(&metal) };
        assert_eq!(picture(&both), RgbaImage::from_pixel(4, 2, Rgba([255, 7, 9, 255])));
        assert_eq!((both.paths().count(), both.is_one_file()), (2, None));
        let one = PbrMaps { metalness: None, ..both };
        assert_eq!(picture(&one), RgbaImage::from_pixel(2, 2, Rgba([255, 7, 255, 255])));
        let gltf = PbrMaps::of_gltf(&rough);
        assert_eq!(picture(&gltf), RgbaImage::from_pixel(2, 2, Rgba([255, 1, 2, 255])));
        assert_eq!((gltf.paths().count(), gltf.is_one_file()), (1, Some(&*rough)));
        assert_eq!(made(&PbrMaps::default()), (None, vec![]));
        let gone = PathBuf::from("gone.png");
        assert_eq!(made(&PbrMaps::of_gltf(&gone)), (None, vec![gone.clone()]));
        // The other map is used nevertheless.
        let half = PbrMaps { roughness: red(&gone), metalness: red(&metal) };
        let expected = RgbaImage::from_pixel(4, 2, Rgba([255, 255, 9, 255]));
        assert_eq!(made(&half), (Some(expected), vec![gone]));
    }

    #[test]
    fn a_wide_and_a_tall_map_take_no_more_memory_than_both() {
        let folder = tempfile::tempdir().unwrap();
        let [wide, tall] = [[40_000, 1], [1, 30_000]].map(|[width, height]| {
            let path = folder.path().join(format!("{width}.png"));
            image::GrayImage::from_pixel(width, height, image::Luma([9])).save(&path).unwrap();
            Some(Channel { path, channel: 0 })
        });
        let (picture, _) = made(&PbrMaps { roughness: wide, metalness: tall });
        assert_eq!(picture.unwrap(), RgbaImage::from_pixel(40_000, 1, Rgba([255, 9, 9, 255])));
    }
}
