//! Files that robots' descriptions name, for clients that cannot read this machine's: a client is given a name for each, and
//! for no other name is a file read.

use crate::description::xml::{Element, Node};
use percent_encoding::percent_decode_str;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Largest file that is sent, bytes.
const LARGEST: u64 = 64 << 20;
/// The package that there is none of, which clients ask us for.
const PACKAGE: &str = "package://belvedere";

/// The files, by the names that clients have for them.
#[derive(Debug, Default)]
pub(super) struct Assets(BTreeMap<String, PathBuf>);

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
        if let Some((name, _)) = self.0.iter().find(|(_, known)| *known == path) {
            return name.clone();
        }
        let file = path.file_name().map(|name| name.to_string_lossy().replace(['%', '?', '#', ' '], "_"));
        let name = format!("{PACKAGE}/{}/{}", self.0.len(), file.unwrap_or_default());
        self.0.insert(name.clone(), path.to_owned());
        name
    }

    /// The file with this name.
    pub(super) fn path(&self, name: &str) -> Option<PathBuf> {
        self.0.get(name).cloned()
    }
}

/// Reads a file for a client.
///
/// # Errors
/// In words.
pub(super) fn read(path: Option<PathBuf>, name: &str) -> Result<Vec<u8>, String> {
    let path = path.ok_or_else(|| format!("no robot's description names '{name}'"))?;
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
