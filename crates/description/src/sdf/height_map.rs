//! `<heightmap>`: a terrain with the heights of an image, as in Gazebo. The image's top edge is +y. Its brightest pixel has
//! the height in `<size>`; a negative height turns the terrain upside down.

use super::{Loader, Scope};
use crate::image_file;
use crate::model::{Geometry, HeightMap, Heights, Material};
use crate::values::{child_number, child_text, numbers};
use crate::xml::Element;
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// Gazebo's default size of a texture, in metres.
const TILE_M: f64 = 10.0;

impl Loader<'_> {
    pub(super) fn height_map(&mut self, shape: &Element, scope: Scope<'_>) -> Option<Geometry> {
        let Some(uri) = child_text(shape, "uri") else {
            self.diagnostics.error(
                &shape.source,
                "<heightmap> has no <uri>",
                "name a picture whose brightness is the height",
            );
            return None;
        };
        let size = match shape.child("size") {
            None => [1.0; 3],
            Some(child) => numbers(&child.text(), "<size>", &child.source, self.diagnostics)?,
        };
        let [x, y, z] = size;
        if !(x > 0.0 && y > 0.0 && z != 0.0) {
            self.positive(shape, "size", [x, y, z.abs()]);
            return None;
        }
        let offset = match self.vector(shape, "pos") {
            None if shape.child("pos").is_some() => return None,
            offset => offset.unwrap_or(DVec3::ZERO),
        };
        let path = self.existing_file(shape, &uri, scope.folder, "height map")?;
        let key = (path.clone(), size.map(f64::to_bits));
        if !self.heights.contains_key(&key) {
            self.diagnostics.opened(&path);
            let read = read(&path, size);
            if let Err(why) = &read {
                self.missing(
                    &shape.source,
                    format!("the height map {} cannot be read: {why}", path.display()),
                    "write it as a PNG, with 16 bits for fine heights",
                );
            }
            self.heights.insert(key.clone(), read.ok().map(Arc::new));
        }
        let heights = self.heights[&key].clone()?;
        let material = self.ground(shape, [x, y], scope);
        Some(Geometry::HeightMap(HeightMap { heights, offset, material: material.map(Box::new) }))
    }

    /// Reads the first of its textures; Gazebo blends all of them by height.
    fn ground(&mut self, shape: &Element, size: [f64; 2], scope: Scope<'_>) -> Option<Material> {
        let mut textures = shape.elements_named("texture");
        let texture = textures.next()?;
        if let Some(more) = textures.next() {
            self.ignored(more, "only the first texture of a height map is drawn");
        }
        let diffuse = texture.child("diffuse")?;
        let picture = self.map(diffuse, texture, scope)?;
        let tile =
            child_number(texture, "size", self.diagnostics).filter(|tile| *tile > 0.0).unwrap_or(TILE_M);
        Some(Material {
            diffuse: [1.0; 3],
            ambient: [1.0; 3],
            texture: Some(picture),
            texture_repeat: size.map(|length| (length / tile) as f32),
            ..Material::default()
        })
    }
}

/// Reads the image. Its red channel is the height; in a grey image that is the brightness.
fn read(path: &Path, [x, y, z]: [f64; 3]) -> Result<Heights, String> {
    let picture = image_file::open(path).map_err(|error| error.to_string())?.into_rgb16();
    let grid = [picture.height(), picture.width()];
    if grid.iter().any(|count| *count < 2) {
        return Err("it needs two rows and two columns of pixels at least".into());
    }
    let most = picture.pixels().map(|pixel| pixel.0[0]).max().filter(|most| *most > 0).unwrap_or(u16::MAX);
    let height = |red: u16| {
        let red = if z < 0.0 { u16::MAX - red } else { red };
        (f64::from(red) * z.abs() / f64::from(most)) as f32
    };
    let metres = picture.pixels().map(|pixel| height(pixel.0[0])).collect();
    Ok(Heights { path: path.to_path_buf(), grid, size: [x, y], metres })
}
