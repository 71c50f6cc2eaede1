//! Generates the wire format in C.

use std::fmt::Write as _;

use belvedere_bridge::{Encoding, FrameHeader, schema};

use crate::names::{c_type, part_of, parts, plain, point_lines, snake};

/// The block of a header, which is an array of words in Rust.
const BLOCK: &str = "\
// The block that is specific to the kind.
typedef union bv_block {
    // images, depth images, clouds
    struct bv_intrinsics intrinsics;
    // scans
    struct bv_scan_geometry scan;
    uint64_t raw[26];
} bv_block;
";

pub(crate) fn layout() -> String {
    let mut text = format!(
        "
// First field of every frame header: \"BLVD\" in memory order.
#define BV_MAGIC {}

// Version of the layout in this file.
#define BV_SCHEMA {}

// Flag: a plane of intensities of the same shape follows the ranges, at row_stride * height.
#define BV_HAS_INTENSITIES {}

// Flag: the frame comes from a recording.
#define BV_REPLAYED {}
",
        FrameHeader::MAGIC,
        FrameHeader::SCHEMA,
        FrameHeader::HAS_INTENSITIES,
        FrameHeader::REPLAYED
    );
    for numbers in schema::ENUMS {
        text += &enumeration(numbers);
    }
    // The header contains one of the two block structs, which must be declared before it.
    let (headers, others): (Vec<&schema::Struct>, Vec<&schema::Struct>) =
        schema::structs().partition(|layout| layout.name == "FrameHeader");
    let (blocks, payloads): (Vec<&schema::Struct>, Vec<&schema::Struct>) =
        others.into_iter().partition(|layout| ["Intrinsics", "ScanGeometry"].contains(&layout.name));
    for layout in blocks {
        text += &structure(layout);
    }
    let _ = write!(text, "\n{BLOCK}");
    for layout in headers.iter().chain(&payloads) {
        text += &structure(layout);
    }
    text += &list("every struct and its size in bytes", "STRUCTS(X)", schema::structs(), |layout| {
        vec![layout.size.to_string()]
    });
    let of_streams = payloads.iter().copied().filter(|layout| !layout.kinds.is_empty());
    text += &list(
        "every struct that streams carry, and the kind of these streams",
        "PAYLOADS(X)",
        of_streams,
        |layout| layout.kinds.iter().map(|&kind| constant("bv_kind", kind_name(kind))).collect(),
    );
    text += &points();
    text.trim_end().to_owned()
}

/// Generates macros that apply another one to all layouts of points, and to all their fields.
fn points() -> String {
    let mut text = "\n// Applies X to every encoding of points: the constant, the size of a point in bytes, and whether a \
                    cloud of one\n// row has no NaN coordinates.\n#define BV_POINTS(X)"
        .to_owned();
    let points = || Encoding::ALL.iter().filter_map(|&encoding| Some((encoding, encoding.point()?)));
    let constant = |encoding: Encoding| constant("bv_encoding", &format!("{encoding:?}"));
    for (encoding, point) in points() {
        let _ = write!(text, " \\\n    X({}, {}, {})", constant(encoding), point.size, point.row_is_dense);
    }
    text += "\n\n// Applies X to every field of points: the constant of the encoding, name, offset in bytes, and type by its \
             name in\n// sensor_msgs/PointField.\n#define BV_POINT_FIELDS(X)";
    for (encoding, point) in points() {
        for field in point.fields {
            let (name, of) = (field.name, field.number.ros_constant());
            let _ = write!(text, " \\\n    X({}, \"{name}\", {}, {of})", constant(encoding), field.offset);
        }
    }
    text + "\n"
}

/// Converts a name in Rust to C.
fn word(name: &str) -> String {
    let is_known =
        |name: &str| part_of(name).is_some() || schema::ENUMS.iter().any(|numbers| numbers.name == name);
    let is_constant = |name: &str| ["MAGIC", "SCHEMA", "HAS_INTENSITIES", "REPLAYED"].contains(&name);
    match name.rsplit_once("::").unwrap_or(("", name)) {
        (_, constant) if is_constant(constant) => format!("BV_{constant}"),
        ("", name) if is_known(name) => c_type(name),
        (owner, field) if is_known(owner) => format!("{}.{field}", c_type(owner)),
        _ => name.to_owned(),
    }
}

fn comment(indent: &str, doc: &[&str]) -> String {
    plain(doc, word)
        .iter()
        .fold(String::new(), |text, line| format!("{text}{}\n", format!("{indent}// {line}").trim_end()))
}

fn enumeration(numbers: &schema::Enum) -> String {
    let name = c_type(numbers.name);
    let mut text = format!("\n{}", comment("", numbers.doc));
    let _ = writeln!(
        text,
        "enum {name}\n#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L\n  : uint16_t\n#endif\n {{"
    );
    for value in numbers.values {
        let constant = constant(&name, value.name);
        text += &comment("    ", value.doc);
        for line in point_lines(value) {
            let _ = writeln!(text, "    // {line}");
        }
        let _ = writeln!(text, "    {constant} = {},", value.number);
    }
    let _ = writeln!(
        text,
        "}};\n#ifndef __cplusplus\n#if __STDC_VERSION__ >= 202311L\ntypedef enum {name} {name};\n#else\ntypedef uint16_t \
         {name};\n#endif\n#endif"
    );
    text
}

fn structure(layout: &schema::Struct) -> String {
    let name = c_type(layout.name);
    let mut text = format!("\n{}typedef struct {name} {{\n", comment("", layout.doc));
    for field in layout.fields {
        let (element, lengths) = parts(field.type_name);
        let is_block = (layout.name, field.name) == ("FrameHeader", "block");
        let (element, lengths) = match element.as_str() {
            _ if is_block => ("union bv_block".to_owned(), Vec::new()),
            "Text" => ("char".to_owned(), lengths),
            "f32" => ("float".to_owned(), lengths),
            "f64" => ("double".to_owned(), lengths),
            name if part_of(name).is_some() => (format!("struct {}", c_type(name)), lengths),
            name => (format!("{}int{}_t", if name.starts_with('u') { "u" } else { "" }, &name[1..]), lengths),
        };
        let lengths = lengths.iter().fold(String::new(), |text, length| format!("{text}[{length}]"));
        let _ = writeln!(text, "{}    {element} {}{lengths};", comment("    ", field.doc), field.name);
    }
    let _ = writeln!(text, "}} {name};");
    text
}

fn constant(enumeration: &str, value: &str) -> String {
    format!("{enumeration}_{}", snake(value)).to_uppercase()
}

fn kind_name(number: u16) -> &'static str {
    let kinds = schema::ENUMS.iter().find(|numbers| numbers.name == "Kind").unwrap();
    kinds.values.iter().find(|kind| kind.number == number).unwrap().name
}

/// Generates a macro that applies another one to all structs, with each of their `values`.
fn list<'a>(
    what: &str,
    name: &str,
    structs: impl Iterator<Item = &'a schema::Struct>,
    values: impl Fn(&schema::Struct) -> Vec<String>,
) -> String {
    let mut text = format!("\n// Applies X to {what}.\n#define BV_{name}");
    for layout in structs {
        for value in values(layout) {
            let _ = write!(text, " \\\n    X({}, {value})", c_type(layout.name));
        }
    }
    text + "\n"
}
