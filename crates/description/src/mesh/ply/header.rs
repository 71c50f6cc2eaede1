//! The header of a PLY file: the elements that follow, and their properties.

use crate::mesh::part::Unreadable;

/// The encoding of the numbers after the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Returns its size in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A number of an element, or a list with the type of its length.
pub(super) struct Property {
    pub(super) name: String,
    pub(super) number: Number,
    pub(super) length: Option<Number>,
}

/// A table of the file.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Returns the index of the first property with one of these names.
    pub(super) fn place(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| names.contains(&property.name.as_str()))
    }
}

/// The content of a header.
pub(super) struct Header {
    pub(super) form: Form,
    pub(super) elements: Vec<Element>,
    /// The picture in a `comment TextureFile`, a convention of `MeshLab`.
    pub(super) texture: Option<String>,
    /// The size of the header in bytes.
    pub(super) bytes: usize,
    /// The size of the header in lines.
    pub(super) lines: u32,
}

/// Reads the header of a file.
pub(super) fn read(file: &[u8]) -> Result<Header, Unreadable> {
    let mut form = None;
    let mut header = Header { form: Form::Text, elements: Vec::new(), texture: None, bytes: 0, lines: 0 };
    loop {
        let rest = &file[header.bytes..];
        let number = header.lines + 1;
        let wrong = |what: String| Unreadable::at(number, what);
        let Some(length) = rest.iter().position(|byte| *byte == b'\n') else {
            return Err(wrong("the header has no end_header".into()));
        };
        let line = String::from_utf8_lossy(&rest[..length]);
        header.bytes += length + 1;
        header.lines = number;
        let words: Vec<&str> = line.split_whitespace().collect();
        if number == 1 && words != ["ply"] {
            return Err(wrong("the file does not begin with 'ply'".into()));
        }
        match words[..] {
            ["format", name, _] => {
                form = Some(match name {
                    "ascii" => Form::Text,
                    "binary_little_endian" => Form::LittleEndian,
                    "binary_big_endian" => Form::BigEndian,
                    _ => return Err(wrong(format!("the format is '{name}'"))),
                });
            }
            ["comment", "TextureFile", ..] => {
                header.texture = line.trim().split_once("TextureFile").map(|(_, name)| name.trim().into());
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| wrong(format!("'{count}' is not a number")))?;
                header.elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            ["property", ref property @ ..] => {
                let number = |name: &str| {
                    Number::named(name).ok_or_else(|| wrong(format!("'{name}' is not a type of numbers")))
                };
                let property = match *property {
                    ["list", length, item, name] => {
                        Property { name: name.into(), number: number(item)?, length: Some(number(length)?) }
                    }
                    [item, name] => Property { name: name.into(), number: number(item)?, length: None },
                    _ => return Err(wrong(format!("'{}' is not understood", line.trim()))),
                };
                match header.elements.last_mut() {
                    Some(element) => element.properties.push(property),
                    None => return Err(wrong("a property has no element".into())),
                }
            }
            ["end_header"] => break,
            _ => {}
        }
    }
    header.form = form.ok_or_else(|| Unreadable::from("the header has no format"))?;
    Ok(header)
}
