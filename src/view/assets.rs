//! [`Assets`]: files that robots' descriptions refer to, for clients that cannot read this machine's files. Each file
//! gets a name for clients, and only files with such names are read. The same holds for textures that a Collada file
//! refers to.

use crate::description::mesh::find_texture;
use crate::description::xml::{Element, Node};
use percent_encoding::percent_decode_str;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Largest file that is sent, in bytes.
const LARGEST: u64 = 64 << 20;
/// The prefix of all names. The package does not exist, so clients request its files from this server.
const PACKAGE: &str = "package://belvedere";

/// File extensions of pictures.
const PICTURES: [&str; 8] = ["png", "jpg", "jpeg", "tga", "bmp", "gif", "tif", "tiff"];

/// End of the list of pictures in a Collada file.
const PICTURES_END: &str = "</library_images>";

/// The files and their names for clients.
#[derive(Debug, Default)]
pub(super) struct Assets {
    files: BTreeMap<String, PathBuf>,
    /// Names of the files in descriptions.
    names: HashMap<PathBuf, String>,
}

impl Assets {
    /// Replaces the paths of files in a plain URDF by names with which clients can request them.
    pub(super) fn rename(&mut self, urdf: &str) -> String {
        match Element::parse(urdf, Path::new("robot_description")) {
            Ok(mut robot) => {
                self.rename_in(&mut robot);
                robot.to_string()
            }
            // This does not happen, because the text was made from elements.
            Err(_) => urdf.to_owned(),
        }
    }

    fn rename_in(&mut self, element: &mut Element) {
        if matches!(element.name.as_str(), "mesh" | "texture") {
            for (_, value) in element.attributes.iter_mut().filter(|(name, _)| name == "filename") {
                if let Some(path) = value.strip_prefix("file://")
                    && let Ok(path) = percent_decode_str(path).decode_utf8()
                {
                    *value = self.name(Path::new(&*path));
                }
            }
        }
        for child in &mut element.children {
            if let Node::Element(child) = child {
                self.rename_in(child);
            }
        }
    }

    /// Returns the name of a file, which keeps the file's extension because clients recognize the format by it.
    fn name(&mut self, path: &Path) -> String {
        if let Some(name) = self.names.get(path) {
            return name.clone();
        }
        let name = format!("{PACKAGE}/{}/{}", self.names.len(), plain_name(path));
        self.names.insert(path.to_owned(), name.clone());
        self.files.insert(name.clone(), path.to_owned());
        name
    }

    /// Returns the file with this name.
    pub(super) fn path(&self, name: &str) -> Option<PathBuf> {
        self.files.get(name).cloned()
    }

    /// Replaces the paths of pictures in a Collada file, the asset `name`, by names below its own, and returns the new
    /// file. Paths that are not found or are not pictures stay unchanged.
    pub(super) fn rename_pictures(&mut self, name: &str, path: &Path, collada: Vec<u8>) -> Vec<u8> {
        let (Some((base, _)), Some(folder)) = (name.rsplit_once('/'), path.parent()) else { return collada };
        let collada = match String::from_utf8(collada) {
            Ok(text) => text,
            Err(error) => return error.into_bytes(),
        };
        let begin = collada.find("<library_images").unwrap_or(collada.len());
        let end = collada[begin..].find(PICTURES_END).map_or(begin, |at| begin + at + PICTURES_END.len());
        let mut renamed = collada[..begin].to_owned();
        for (index, piece) in collada[begin..end].split_inclusive('>').enumerate() {
            // The text before a tag, and the tag.
            let (text, mark) = piece.split_at(piece.find('<').unwrap_or(piece.len()));
            if let Some(picture) = picture(text.trim(), folder) {
                let own = format!("{index}/{}", plain_name(&picture));
                self.files.insert(format!("{base}/{own}"), picture);
                renamed += &own;
            } else {
                renamed += text;
            }
            renamed += mark;
        }
        (renamed + &collada[end..]).into_bytes()
    }
}

/// Returns the file's name, without characters that have a meaning in a URL or in XML.
fn plain_name(path: &Path) -> String {
    let file =
        path.file_name().map(|name| name.to_string_lossy().replace(['%', '?', '#', ' ', '&', '<', '>'], "_"));
    file.unwrap_or_default()
}

/// Finds a picture by its path in a Collada file in `folder`.
fn picture(named: &str, folder: &Path) -> Option<PathBuf> {
    let named = percent_decode_str(named.trim_start_matches("file://")).decode_utf8().ok()?;
    let path = find_texture(&named, folder)?;
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    PICTURES.contains(&ending.as_str()).then_some(path)
}

/// Returns true for a Collada file.
pub(super) fn is_collada(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("dae"))
}

/// Reads a file for a client.
///
/// # Errors
/// A message with the reason.
pub(super) fn read(path: &Path, name: &str) -> Result<Vec<u8>, String> {
    // The message does not reveal the path on this machine.
    let failed = |error: std::io::Error| format!("'{name}' cannot be read: {}", error.kind());
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(LARGEST + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LARGEST {
        return Err(format!("'{name}' is larger than {} MiB", LARGEST >> 20));
    }
    Ok(bytes)
}

/// Returns the response to a Foxglove client that requested a file.
pub(super) fn response(request: u32, file: Result<Vec<u8>, String>) -> Vec<u8> {
    const FETCH_ASSET_RESPONSE: u8 = 4;
    let (status, error, bytes) = match file {
        Ok(bytes) => (0, String::new(), bytes),
        Err(error) => (1, error, Vec::new()),
    };
    let mut message = vec![FETCH_ASSET_RESPONSE];
    message.extend_from_slice(&request.to_le_bytes());
    message.push(status);
    message.extend_from_slice(&(error.len() as u32).to_le_bytes());
    message.extend_from_slice(error.as_bytes());
    message.extend_from_slice(&bytes);
    message
}
