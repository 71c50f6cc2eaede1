//! Conversion of Rust's types and documentation for other languages.

use belvedere_bridge::{MAX_DISTORTION, point::Number, schema};

/// Converts `CameraInfo` to `camera_info`, `XyzRgbF32` to `xyz_rgb_f32`.
pub(crate) fn snake(name: &str) -> String {
    let mut snake = String::new();
    let mut before = ' ';
    for letter in name.chars() {
        if letter.is_uppercase() && before.is_lowercase() {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
        before = letter;
    }
    snake
}

pub(crate) fn c_type(name: &str) -> String {
    format!("bv_{}", snake(name))
}

/// Returns the element type of a field and the lengths of its array dimensions, the outermost first. A text is an array
/// of the type `Text`.
pub(crate) fn parts(type_name: &str) -> (String, Vec<usize>) {
    let name: String = type_name.chars().filter(|letter| !letter.is_whitespace()).collect();
    if let Some(length) = name.strip_prefix("Text<").and_then(|rest| rest.strip_suffix('>')) {
        return ("Text".to_owned(), vec![length.parse().unwrap()]);
    }
    let Some((element, length)) =
        name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')?.rsplit_once(';'))
    else {
        return (name, Vec::new());
    };
    let length = if length == "MAX_DISTORTION" { MAX_DISTORTION } else { length.parse().unwrap() };
    let (element, mut lengths) = parts(element);
    lengths.insert(0, length);
    (element, lengths)
}

/// Returns the struct with this name.
pub(crate) fn part_of(name: &str) -> Option<&'static schema::Struct> {
    schema::structs().find(|layout| layout.name == name)
}

pub(crate) fn size(type_name: &str) -> usize {
    let (element, lengths) = parts(type_name);
    let element = match element.as_str() {
        "Text" => 1,
        name => part_of(name).map_or_else(|| name[1..].parse::<usize>().unwrap() / 8, |layout| layout.size),
    };
    lengths.iter().product::<usize>() * element
}

/// Documents the fields of a point; nothing for other encodings.
pub(crate) fn point_lines(value: &schema::Value) -> Vec<String> {
    let Some(point) = value.point else { return Vec::new() };
    let line = |field: &schema::PointField| {
        let of = match field.number {
            Number::U8 => "u8",
            Number::U16 => "u16",
            Number::U32 => "u32",
            Number::F32 => "f32",
            Number::F64 => "f64",
            Number::Colour => "u8[4]",
        };
        let doc = plain(field.doc, str::to_owned).join(" ");
        format!("- {} at {}, {of}: {doc}", field.name, field.offset)
    };
    let heading = format!("Its {} bytes:", point.size);
    std::iter::once(heading).chain(point.fields.iter().map(line)).collect()
}

/// Removes Rust's markup from documentation. `word` converts the name in `` `name` `` and `` [`name`](path) ``.
pub(crate) fn plain(doc: &[&str], word: impl Fn(&str) -> String) -> Vec<String> {
    let text = doc.iter().map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n");
    let mut plain = String::new();
    let mut rest = text.as_str();
    while let Some((before, marked)) = rest.split_once('`') {
        let (name, after) = marked.split_once('`').unwrap();
        plain += before.strip_suffix('[').unwrap_or(before);
        plain += &word(name);
        rest = after;
        if before.ends_with('[') {
            let after = after.strip_prefix(']').unwrap();
            let target = after.strip_prefix('(').and_then(|path| path.split_once(')'));
            rest = target.map_or(after, |(_, after)| after);
        }
    }
    plain += rest;
    plain.replace('\\', "").lines().map(str::to_owned).collect()
}
