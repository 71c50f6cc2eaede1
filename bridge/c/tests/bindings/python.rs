//! Generates the wire format in Python, for numpy.

use std::fmt::Write as _;

use belvedere_bridge::{FrameHeader, Kind, point::Number, schema};

use crate::names::{part_of, parts, plain, point_lines, snake};

pub(crate) fn layout() -> String {
    let mut text = format!(
        "\
\"\"\"The wire format as numpy types. Generated from bridge/src/wire by bridge/c/tests/bindings; do not edit.\"\"\"

# fmt: off
from __future__ import annotations

from enum import IntEnum

import numpy as np

MAGIC = {}
SCHEMA = {}
HEADER_LEN = {}
#: Flag: a plane of intensities follows the ranges.
HAS_INTENSITIES = {}
#: Flag: the frame comes from a recording.
REPLAYED = {}
#: Name of the user header, which iceoryx2 compares.
HEADER_TYPE_NAME = \"belvedere.FrameHeader.v{}\"
",
        FrameHeader::MAGIC,
        FrameHeader::SCHEMA,
        size_of::<FrameHeader>(),
        FrameHeader::HAS_INTENSITIES,
        FrameHeader::REPLAYED,
        FrameHeader::SCHEMA,
    );
    for numbers in schema::ENUMS {
        let doc = documentation(numbers.doc).join(" ");
        let (summary, rest) = doc.split_once(". ").unwrap_or((doc.trim_end_matches('.'), ""));
        let _ = write!(text, "\n\nclass {}(IntEnum):\n    \"\"\"{summary}.", numbers.name);
        for (number, line) in wrapped(rest).iter().enumerate() {
            let _ = write!(text, "{}    {line}", if number == 0 { "\n\n" } else { "\n" });
        }
        text += if rest.is_empty() { "\"\"\"\n\n" } else { "\n\n    \"\"\"\n\n" };
        for value in numbers.values {
            for line in documentation(value.doc).into_iter().chain(point_lines(value)) {
                let _ = writeln!(text, "    #: {line}");
            }
            let _ = writeln!(text, "    {} = {}", member(value), value.number);
        }
    }
    // Parts come before the structs that contain them: the header's blocks, and structs that no kind carries.
    let (unkeyed, whole): (Vec<&schema::Struct>, Vec<&schema::Struct>) =
        schema::structs().partition(|layout| layout.kinds.is_empty());
    text += "\n";
    for layout in unkeyed {
        let name = if layout.name == "FrameHeader" { "header".to_owned() } else { snake(layout.name) };
        let _ = write!(text, "\n{} = {}\n", name.to_uppercase(), dtype(layout));
    }
    text += "\n#: The structs of payloads, by kind.\nSTRUCTS: dict[Kind, np.dtype[np.void]] = {\n";
    for layout in &whole {
        let kind = |number: u16| member_of_kind(Kind::from_wire(number).unwrap());
        let _ =
            writeln!(text, "    Kind.{}: {},", kind(layout.kinds[0]), dtype(layout).replace('\n', "\n    "));
    }
    text += "}\n";
    for layout in &whole {
        for &other in &layout.kinds[1..] {
            let [first, other] =
                [layout.kinds[0], other].map(|number| member_of_kind(Kind::from_wire(number).unwrap()));
            let _ = writeln!(text, "STRUCTS[Kind.{other}] = STRUCTS[Kind.{first}]");
        }
    }
    text += "\n#: The type of one element.\nELEMENTS: dict[Encoding, np.dtype[np.generic]] = {\n";
    let encodings = schema::ENUMS.iter().find(|numbers| numbers.name == "Encoding").unwrap();
    for value in encodings.values {
        if let Some(point) = value.point {
            let _ = writeln!(text, "    Encoding.{}: np.dtype({}),", member(value), point_dtype(point));
        }
        if value.element.is_empty() {
            continue;
        }
        let (element, lengths) = parts(value.element);
        let element = match lengths[..] {
            [] => scalar(&element),
            [length] => format!("({}, {length})", scalar(&element)),
            _ => panic!("an element of more than one direction"),
        };
        let _ = writeln!(text, "    Encoding.{}: np.dtype({element}),", member(value));
    }
    text + "}\n"
}

fn documentation(doc: &[&str]) -> Vec<String> {
    plain(doc, |name| name.rsplit("::").next().unwrap_or(name).to_owned())
}

/// Wraps text to at most 100 characters a line.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = Vec::<String>::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < 100 => line.extend([" ", word]),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Returns the name of a member, which must begin with a letter: 32fc1 becomes `F32C1`.
fn member(value: &schema::Value) -> String {
    let name =
        if value.text.starts_with(|letter: char| letter.is_ascii_digit()) { value.name } else { value.text };
    name.to_uppercase()
}

fn member_of_kind(kind: Kind) -> String {
    kind.as_str().to_uppercase()
}

fn scalar(element: &str) -> String {
    let size = element[1..].parse::<usize>().unwrap() / 8;
    format!("\"{}{}{size}\"", if size == 1 { "" } else { "<" }, &element[..1])
}

fn point_dtype(point: &schema::PointLayout) -> String {
    let list = |text: fn(&schema::PointField) -> String| {
        point.fields.iter().map(text).collect::<Vec<_>>().join(", ")
    };
    let format = |field: &schema::PointField| {
        let format = match field.number {
            Number::U8 => "u1",
            Number::U16 => "<u2",
            // A colour as a whole number, so that its parts can be shifted out.
            Number::U32 | Number::Colour => "<u4",
            Number::F32 => "<f4",
            Number::F64 => "<f8",
        };
        format!("\"{format}\"")
    };
    format!(
        "\
{{
        \"names\": [{}],
        \"formats\": [{}],
        \"offsets\": [{}],
        \"itemsize\": {},
    }}",
        list(|field| format!("\"{}\"", field.name)),
        list(format),
        list(|field| field.offset.to_string()),
        point.size,
    )
}

fn dtype(layout: &schema::Struct) -> String {
    let mut text = "np.dtype(\n    [\n".to_owned();
    for field in layout.fields {
        let (element, mut lengths) = parts(field.type_name);
        let element = match element.as_str() {
            _ if (layout.name, field.name) == ("FrameHeader", "block") => {
                lengths.clear();
                "\"V208\"".to_owned()
            }
            "Text" => format!("\"S{}\"", lengths.pop().unwrap()),
            name if part_of(name).is_some() => snake(name).to_uppercase(),
            name => scalar(name),
        };
        let shape = if field.shape.is_empty() { &lengths[..] } else { field.shape };
        let shape = match shape {
            [] => String::new(),
            [length] => format!(", {length}"),
            lengths => format!(", ({})", lengths.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
        };
        let _ = writeln!(text, "        (\"{}\", {element}{shape}),", field.name);
    }
    text + "    ]\n)"
}
