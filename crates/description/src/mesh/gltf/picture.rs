//! Pictures inside a glTF file. Each has a path of its own, so that it can be used like a picture in a file.

use super::accessor::Accessors;
use super::container::Container;
use crate::mesh::part::Unreadable;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

/// The separator between the name of the file and the number of the picture.
const MARK: &str = "#image";

/// Returns the name of a picture inside a file.
pub(in crate::mesh) fn name(file: &Path, image: u64) -> PathBuf {
    let mut name = OsString::from(file);
    name.push(format!("{MARK}{image}"));
    name.into()
}

/// Splits a name into the file and the number of the picture.
fn parts(name: &Path) -> Option<(&Path, u64)> {
    let (file, image) = name.to_str()?.rsplit_once(MARK)?;
    let file = Path::new(file);
    let extension = file.extension()?;
    let is_gltf = ["gltf", "glb"].iter().any(|known| extension.eq_ignore_ascii_case(known));
    image.parse().ok().filter(|_| is_gltf).map(|image| (file, image))
}

/// Returns true if a path names a picture inside a file.
pub(crate) fn is_embedded(name: &Path) -> bool {
    parts(name).is_some()
}

/// Reads the file of a picture, which may be inside of another.
///
/// # Errors
/// The file, or the picture inside it, cannot be read.
pub(crate) fn read(name: &Path) -> io::Result<Vec<u8>> {
    match parts(name) {
        Some((file, image)) if !name.exists() => {
            extract(&crate::file::read(file)?, file, image).map_err(io::Error::other)
        }
        _ => crate::file::read(name),
    }
}

fn extract(bytes: &[u8], file: &Path, image: u64) -> Result<Vec<u8>, String> {
    let container = Container::open(bytes, file).map_err(|Unreadable { what, .. }| what)?;
    bytes_of(&container, image)
}

/// Returns the file of a picture that is inside an opened glTF file or named by it.
///
/// # Errors
/// A message about what is wrong.
pub(super) fn bytes_of(container: &Container<'_>, image: u64) -> Result<Vec<u8>, String> {
    let image = container.entry("images", &image.into())?;
    match image["uri"].as_str() {
        Some(uri) => container.bytes(uri),
        None => Accessors::new(container).view_bytes(&image["bufferView"]),
    }
}
