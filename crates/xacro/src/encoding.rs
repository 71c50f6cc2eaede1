//! The encodings of text files. UTF-8 is read; the error for a text in UTF-16 or UTF-32 names the command that converts it.

use super::shell::quoted;
use std::path::Path;

/// The reason why a file is not read as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotRead {
    /// What is wrong with it.
    pub what: String,
    /// What the user can do.
    pub remedy: String,
}

/// An encoding whose characters have two or four bytes each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wide {
    /// UTF-16, little endian.
    Utf16Le,
    /// UTF-16, big endian.
    Utf16Be,
    /// UTF-32, little endian.
    Utf32Le,
    /// UTF-32, big endian.
    Utf32Be,
}

impl Wide {
    /// Returns the encoding of a text by its byte-order mark, or by its first character, if that is one of ASCII.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        // Those of four bytes come first, because their marks and characters begin as those of two do.
        match *bytes {
            [0xff, 0xfe, 0, 0, ..] | [1..0x80, 0, 0, 0, ..] => Some(Self::Utf32Le),
            [0, 0, 0xfe, 0xff, ..] | [0, 0, 0, 1..0x80, ..] => Some(Self::Utf32Be),
            [0xff, 0xfe, ..] | [1..0x80, 0, ..] => Some(Self::Utf16Le),
            [0xfe, 0xff, ..] | [0, 1..0x80, ..] => Some(Self::Utf16Be),
            _ => None,
        }
    }

    /// Returns its name, as iconv has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Utf16Le => "UTF-16LE",
            Self::Utf16Be => "UTF-16BE",
            Self::Utf32Le => "UTF-32LE",
            Self::Utf32Be => "UTF-32BE",
        }
    }

    /// Decodes a text in this encoding, without its mark. What is no character becomes U+FFFD.
    pub fn decode(self, bytes: &[u8]) -> String {
        let pairs = || bytes.chunks_exact(2).map(|pair| [pair[0], pair[1]]);
        let fours = || bytes.chunks_exact(4).map(|four| [four[0], four[1], four[2], four[3]]);
        let character = |code: u32| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER);
        let text = match self {
            Self::Utf16Le => String::from_utf16_lossy(&pairs().map(u16::from_le_bytes).collect::<Vec<_>>()),
            Self::Utf16Be => String::from_utf16_lossy(&pairs().map(u16::from_be_bytes).collect::<Vec<_>>()),
            Self::Utf32Le => fours().map(u32::from_le_bytes).map(character).collect(),
            Self::Utf32Be => fours().map(u32::from_be_bytes).map(character).collect(),
        };
        text.trim_start_matches('\u{feff}').to_owned()
    }

    /// Returns the error about a file in this encoding, with the command that converts it.
    pub fn error(self, path: &Path) -> NotRead {
        let name = self.name();
        let [file, copy] =
            [path.as_os_str().to_owned(), [path.as_os_str(), "-utf-8".as_ref()].into_iter().collect()];
        NotRead {
            what: format!("its text is in {name}, and UTF-8 is read"),
            remedy: format!("convert it: iconv -f {name} -t UTF-8 {} > {}", quoted(file), quoted(copy)),
        }
    }
}

/// Returns the text of a file's `bytes`, in UTF-8.
///
/// # Errors
/// If they are in another encoding.
pub fn utf_8(bytes: Vec<u8>, path: &Path) -> Result<String, NotRead> {
    if let Some(wide) = Wide::of(&bytes) {
        return Err(wide.error(path));
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.split(|byte| *byte == b'\n').count();
        NotRead { what: format!("line {line} is not UTF-8 text"), remedy: "save it as UTF-8".into() }
    })
}

/// Returns the text of a file's `bytes`, in UTF-8 or ISO 8859-1.
///
/// # Errors
/// If they are in another encoding, or are no text.
pub fn utf_8_or_latin_1(bytes: Vec<u8>, path: &Path) -> Result<String, NotRead> {
    if let Some(wide) = Wide::of(&bytes) {
        return Err(wide.error(path));
    }
    String::from_utf8(bytes).or_else(|error| {
        let bytes = error.into_bytes();
        if bytes.contains(&0) {
            return Err(NotRead { what: "not UTF-8 text".into(), remedy: "save it as UTF-8".into() });
        }
        // Old files are ISO 8859-1, mostly in their comments. Its bytes are the first 256 characters of Unicode.
        Ok(bytes.into_iter().map(char::from).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_known_by_their_mark_or_first_character() {
        let path = Path::new("it's.yaml");
        for (bytes, name) in [
            (&b"\xff\xfea\0"[..], "UTF-16LE"),
            (b"\xfe\xff\0a", "UTF-16BE"),
            (b"#\0\xe4\0", "UTF-16LE"),
            (b"\0#\0\xe4", "UTF-16BE"),
            (b"\xff\xfe\0\0a\0\0\0", "UTF-32LE"),
            (b"\0\0\xfe\xff\0\0\0a", "UTF-32BE"),
            (b"a\0\0\0", "UTF-32LE"),
            (b"\0\0\0a", "UTF-32BE"),
        ] {
            for read in [utf_8, utf_8_or_latin_1] {
                let NotRead { what, remedy } = read(bytes.to_vec(), path).unwrap_err();
                assert_eq!(what, format!("its text is in {name}, and UTF-8 is read"));
                let command = format!(r"iconv -f {name} -t UTF-8 'it'\''s.yaml' > 'it'\''s.yaml-utf-8'");
                assert_eq!(remedy, format!("convert it: {command}"));
            }
            let first = Wide::of(bytes).map(|wide| wide.decode(bytes)).unwrap_or_default();
            assert!(["a", "#ä"].contains(&&*first), "{first}");
        }
        for text in ["", "a", "ä", "a: 1\n", "\u{feff}a"] {
            assert_eq!(utf_8(text.into(), path).unwrap(), text);
        }
        assert_eq!(utf_8(b"a\nb\xe4".to_vec(), path).unwrap_err().what, "line 2 is not UTF-8 text");
        assert_eq!(utf_8_or_latin_1(b"b\xe4".to_vec(), path).unwrap(), "bä");
        assert_eq!(utf_8_or_latin_1(b"bb\xe4\0".to_vec(), path).unwrap_err().what, "not UTF-8 text");
    }
}
