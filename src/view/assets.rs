//! Files that robots' descriptions name, for clients that cannot read this machine's: a client is given a name for each, and
//! for no other name is a file read. So it is with the pictures that a Collada file names in turn.

use crate::description::mesh::find_texture;
use crate::description::xml::{Element, Node};
use percent_encoding::percent_decode_str;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Largest file that is sent, bytes.
const LARGEST: u64 = 64 << 20;
/// The package that there is none of, which clients ask us for.
const PACKAGE: &str = "package://belvedere";

/// What a picture's file ends with.
const PICTURES: [&str; 8] = ["png", "jpg", "jpeg", "tga", "bmp", "gif", "tif", "tiff"];

/// Where the list of a Collada file's pictures ends.
const PICTURES_END: &str = "</library_images>";

/// The files, and the names that clients have for them.
#[derive(Debug, Default)]
pub(super) struct Assets {
    files: BTreeMap<String, PathBuf>,
    /// Of what descriptions name.
    names: HashMap<PathBuf, String>,
}

impl Assets {
    /// Gives the files of a plain URDF names by which clients can ask for them, instead of those on this machine.
    pub(super) fn rename(&mut self, urdf: &str) -> String {
        match Element::parse(urdf, Path::new("robot_description")) {
            Ok(mut robot) => {
                self.rename_in(&mut robot);
                robot.to_string()
            }
            // It was made from elements.
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

    /// A file has one name. It ends as the file's does, since by that clients know what is in it.
    fn name(&mut self, path: &Path) -> String {
        if let Some(name) = self.names.get(path) {
            return name.clone();
        }
        let name = format!("{PACKAGE}/{}/{}", self.names.len(), plain_name(path));
        self.names.insert(path.to_owned(), name.clone());
        self.files.insert(name.clone(), path.to_owned());
        name
    }

    /// The file with this name.
    pub(super) fn path(&self, name: &str) -> Option<PathBuf> {
        self.files.get(name).cloned()
    }

    /// Gives the pictures that a Collada file names, the asset `name`, names below its own, and puts those into the file.
    /// What is not found, or is no picture, stays as it is.
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
            // What stands before a mark, and the mark.
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

/// The file's own name, without what has a meaning in a URL or in XML.
fn plain_name(path: &Path) -> String {
    let file =
        path.file_name().map(|name| name.to_string_lossy().replace(['%', '?', '#', ' ', '&', '<', '>'], "_"));
    file.unwrap_or_default()
}

/// The picture that a Collada file in `folder` calls so.
fn picture(named: &str, folder: &Path) -> Option<PathBuf> {
    let named = percent_decode_str(named.trim_start_matches("file://")).decode_utf8().ok()?;
    let path = find_texture(&named, folder)?;
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    PICTURES.contains(&ending.as_str()).then_some(path)
}

/// Whether it is a Collada file.
pub(super) fn is_collada(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("dae"))
}

/// Reads a file for a client.
///
/// # Errors
/// In words.
pub(super) fn read(path: &Path, name: &str) -> Result<Vec<u8>, String> {
    // Where it is on this machine is nobody's business.
    let failed = |error: std::io::Error| format!("'{name}' cannot be read: {}", error.kind());
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(LARGEST + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LARGEST {
        return Err(format!("'{name}' is larger than {} MiB", LARGEST >> 20));
    }
    Ok(bytes)
}

/// The answer to a client of Foxglove's protocol who asked for a file.
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
