//! The JSON of a glTF, and its binary data: in the same file, beside it, or in `data:` URIs.

use crate::mesh::part::Unreadable;
use percent_encoding::percent_decode_str;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The first bytes of a GLB.
const MAGIC: &[u8] = b"glTF";
/// Extensions that a file may require, because they are supported or do not affect the shape.
const KNOWN: [&str; 5] = [
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_lights_punctual",
    "KHR_materials_pbrSpecularGlossiness",
];

/// A file, split into its parts.
pub(super) struct Container<'a> {
    pub(super) json: Value,
    /// The binary chunk of a GLB.
    binary: Option<&'a [u8]>,
    pub(super) path: &'a Path,
}

impl<'a> Container<'a> {
    /// Splits a file into its JSON and its binary chunk.
    ///
    /// # Errors
    /// The file is broken, of another version, or requires an extension that is not read.
    pub(super) fn open(bytes: &'a [u8], path: &'a Path) -> Result<Self, Unreadable> {
        let is_binary = bytes.starts_with(MAGIC);
        let (json, binary) = if is_binary { chunks(bytes)? } else { (bytes, None) };
        let json: Value = serde_json::from_slice(json).map_err(|error| {
            let line = (!is_binary).then(|| u32::try_from(error.line()).unwrap_or_default());
            Unreadable { line, what: format!("its JSON is broken: {error}") }
        })?;
        let version = json["asset"]["version"].as_str().unwrap_or("unknown");
        if !version.starts_with("2.") {
            return Err(format!("it is glTF of version {version}: export it as glTF 2.0").into());
        }
        for required in json["extensionsRequired"].as_array().into_iter().flatten() {
            let name = required.as_str().unwrap_or_default();
            if !KNOWN.contains(&name) {
                return Err(unsupported(name).into());
            }
        }
        Ok(Self { json, binary, path })
    }

    /// Returns an entry of a list of the file.
    ///
    /// # Errors
    /// The list has no entry of that number.
    pub(super) fn entry(&self, list: &str, index: &Value) -> Result<&Value, String> {
        let found = index.as_u64().and_then(|index| self.json[list].get(usize::try_from(index).ok()?));
        found.ok_or_else(|| format!("there is no entry {index} in {list}"))
    }

    /// Returns the bytes of a buffer.
    ///
    /// # Errors
    /// The file that it names cannot be read, or it names none.
    pub(super) fn buffer(&self, index: &Value) -> Result<std::borrow::Cow<'a, [u8]>, String> {
        let buffer = self.entry("buffers", index)?;
        match buffer["uri"].as_str() {
            Some(uri) => Ok(self.bytes(uri)?.into()),
            None => match self.binary {
                Some(binary) if index.as_u64() == Some(0) => Ok(binary.into()),
                _ => Err(format!("buffer {index} has neither a uri nor bytes in the file")),
            },
        }
    }

    /// Returns the path of the file that a relative URI names.
    pub(super) fn beside(&self, uri: &str) -> PathBuf {
        let name = percent_decode_str(uri).decode_utf8_lossy();
        self.path.parent().unwrap_or(Path::new("")).join(&*name)
    }

    /// Returns the bytes that a URI contains or names.
    ///
    /// # Errors
    /// The URI is broken or remote, or its file cannot be read.
    pub(super) fn bytes(&self, uri: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, text) = data.split_once(',').ok_or("a data: URI has no comma")?;
            return if kind.ends_with(";base64") {
                base64(text).ok_or_else(|| "a data: URI is not base64".into())
            } else {
                Ok(percent_decode_str(text).collect())
            };
        }
        if uri.contains("://") {
            return Err(format!("{uri} is remote, and files are not fetched: download it"));
        }
        let path = self.beside(uri);
        crate::file::read(&path).map_err(|error| format!("{}: {error}", path.display()))
    }
}

/// Returns the message about an extension that a file needs and that is not read, with its remedy.
pub(super) fn unsupported(extension: &str) -> String {
    let remedy = match extension {
        "KHR_draco_mesh_compression" => "export it without Draco compression",
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => "export it without meshopt compression",
        "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" => {
            "export it with PNG or JPEG pictures"
        }
        "EXT_mesh_gpu_instancing" => "export each instance as a node",
        _ => "export it without",
    };
    format!("it needs the extension {extension}, which is not read: {remedy}")
}

/// Returns the JSON and the binary chunk of a GLB.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Unreadable> {
    let word =
        |at: usize| bytes.get(at..).and_then(<[u8]>::first_chunk).map(|word| u32::from_le_bytes(*word));
    match word(4) {
        Some(2) => {}
        Some(version) => return Err(format!("it is GLB of version {version}: export it as glTF 2.0").into()),
        None => return Err("the file ends within its header".into()),
    }
    let mut at = 12;
    let (mut json, mut binary) = (None, None);
    while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
        let begin = at + 8;
        let Some(chunk) = bytes.get(begin..).and_then(|rest| rest.get(..length as usize)) else {
            let there = bytes.len() - begin;
            return Err(format!("a chunk declares {length} bytes, and has {there}").into());
        };
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at = begin + chunk.len();
    }
    Ok((json.ok_or_else(|| Unreadable::from("it has no JSON"))?, binary))
}

/// Decodes base64 of either alphabet.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0_u32, 0);
    for letter in text.trim_end_matches('=').bytes() {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::base64;

    /// The examples of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_its_standard() {
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(text).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(base64("Zg=g"), None);
    }
}
