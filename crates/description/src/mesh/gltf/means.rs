//! Means of the metallic-roughness maps of a glTF that are not laid over the surface as its texture is.

use super::container::Container;
use super::picture;
use serde_json::Value;
use std::collections::HashMap;
use std::io::Cursor;

/// The mean roughness and metalness of the pictures that were read, by their numbers, so that each is decoded once.
pub(super) type Means = HashMap<u64, [f32; 2]>;

/// Returns the mean roughness and metalness of a map; 1 and 1 without a map, or if it cannot be read.
///
/// # Errors
/// A message about the texture.
pub(super) fn roughness_and_metalness(
    container: &Container<'_>,
    map: &Value,
    means: &mut Means,
) -> Result<[f32; 2], String> {
    if map.is_null() {
        return Ok([1.0; 2]);
    }
    let texture = container.entry("textures", &map["index"])?;
    let Some(image) = texture["source"].as_u64() else { return Ok([1.0; 2]) };
    Ok(*means.entry(image).or_insert_with(|| mean(container, image).unwrap_or([1.0; 2])))
}

/// Returns the means of green, the roughness, and blue, the metalness.
fn mean(container: &Container<'_>, image: u64) -> Option<[f32; 2]> {
    let bytes = picture::bytes_of(container, image).ok()?;
    let reader = image::ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    let picture = reader.decode().ok()?.into_rgb8();
    let mut sums = [0_u64; 2];
    for pixel in picture.pixels() {
        let [_, roughness, metalness] = pixel.0;
        sums = [sums[0] + u64::from(roughness), sums[1] + u64::from(metalness)];
    }
    let most = 255.0 * picture.pixels().len() as f64;
    Some(sums.map(|sum| (sum as f64 / most) as f32))
}
