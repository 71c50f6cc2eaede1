//! Images of roughness and metalness. `<pbr>` has one for each, with the values in red; glTF has one for both.

use std::path::{Path, PathBuf};

/// Channels of an image of both, as in glTF: green and blue.
pub(crate) const ROUGHNESS: usize = 1;
pub(crate) const METALNESS: usize = 2;

/// A channel of an image file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Channel {
    /// The image file.
    pub path: PathBuf,
    /// Red, green, blue or alpha, 0 to 3.
    pub channel: usize,
}

/// Images of roughness and metalness, by whose values from 0 to 1 those of a material are multiplied. All are laid over
/// the surface as its texture is.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct PbrMaps {
    /// The roughness.
    pub roughness: Option<Channel>,
    /// The metalness.
    pub metalness: Option<Channel>,
}

impl PbrMaps {
    /// Creates the maps of a glTF file, where one image has the roughness in green and the metalness in blue.
    pub fn of_gltf(path: &Path) -> Self {
        let of = |channel| Some(Channel { path: path.to_path_buf(), channel });
        Self { roughness: of(ROUGHNESS), metalness: of(METALNESS) }
    }

    /// Returns the image files; none twice.
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        let [first, second] =
            [&self.roughness, &self.metalness].map(|channel| channel.as_ref().map(|channel| &channel.path));
        first.into_iter().chain(second.filter(|path| first != Some(*path)))
    }

    /// Returns the file that has the roughness in green and the metalness in blue already.
    pub fn is_one_file(&self) -> Option<&Path> {
        let (roughness, metalness) = (self.roughness.as_ref()?, self.metalness.as_ref()?);
        let is_of_gltf = roughness.channel == ROUGHNESS && metalness.channel == METALNESS;
        (is_of_gltf && roughness.path == metalness.path).then_some(&*roughness.path)
    }
}
