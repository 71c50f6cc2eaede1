//! STL: triangles, in text or binary form.

use super::part::{Part, Unreadable, text};
use crate::diagnostics::{Diagnostics, Source};
use std::path::Path;

/// The number of bytes before the number of triangles.
const HEADER: usize = 80;
/// The number of bytes of a triangle: a normal, three corners, and two unused bytes.
const TRIANGLE: usize = 50;

/// Reads a file; each solid of a text becomes a part.
pub(super) fn parse(
    bytes: &[u8],
    path: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Part>, Unreadable> {
    let count = bytes.get(HEADER..).and_then(<[u8]>::first_chunk).map(|count| u32::from_le_bytes(*count));
    let length = |count: u32| HEADER as u64 + 4 + TRIANGLE as u64 * u64::from(count);
    // Some binary headers begin with the word that identifies text.
    let fits = count.is_some_and(|count| length(count) == bytes.len() as u64);
    let words = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let begins = words.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let is_text = begins && !bytes.iter().take(1000).any(|byte| *byte == 0);
    if is_text && !fits {
        return solids(&text(bytes), path, diagnostics);
    }
    let Some(count) = count else {
        let form =
            format!("text that begins with 'solid', or {HEADER} bytes and the number of its triangles");
        return Err(format!("an STL is {form}, and this is {} other bytes", bytes.len()).into());
    };
    let triangles = &bytes[HEADER + 4..];
    let there = triangles.len() / TRIANGLE;
    if length(count) > bytes.len() as u64 {
        return Err(format!("it declares {count} triangles, and has {there}").into());
    }
    if !fits {
        let more = bytes.len() as u64 - length(count);
        let what = if there == count as usize {
            format!(
                "the mesh {} has {more} bytes after its {count} triangles: they are left out",
                path.display()
            )
        } else {
            format!(
                "the mesh {} declares {count} triangles, and has bytes for {there}: the others are left out",
                path.display()
            )
        };
        diagnostics.warning(&Source::new(path, 0), what, "export it again");
    }
    let mut part = Part::default();
    for triangle in triangles.chunks_exact(TRIANGLE).take(count as usize) {
        let (numbers, _) = triangle.as_chunks::<4>();
        let number = |at: usize| f32::from_le_bytes(numbers[at]);
        push(&mut part, [3, 6, 9].map(|at| [number(at), number(at + 1), number(at + 2)]));
    }
    Ok(vec![part])
}

fn push(part: &mut Part, corners: [[f32; 3]; 3]) {
    let first = part.positions.len() as u32;
    part.positions.extend(corners);
    part.triangles.push([first, first + 1, first + 2]);
}

/// Reads text. Only the words `vertex` and `endloop` are needed.
fn solids(text: &str, path: &Path, diagnostics: &mut Diagnostics) -> Result<Vec<Part>, Unreadable> {
    let mut parts: Vec<Part> = Vec::new();
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut is_open = false;
    let mut last = 1;
    for (number, line) in (1..).zip(text.lines()) {
        let wrong = |what: String| Unreadable::at(number, what);
        let line = line.trim();
        let (word, name) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if word.eq_ignore_ascii_case("solid") {
            is_open = true;
            // Some programs write a whole solid into one line.
            let name = name.split(" facet ").next().unwrap_or_default().trim().into();
            parts.push(Part { name, ..Part::default() });
            if !line.contains(" facet ") {
                continue;
            }
        }
        if word.eq_ignore_ascii_case("endsolid") {
            is_open = false;
            continue;
        }
        let mut words = line.split_ascii_whitespace();
        while let Some(word) = words.next() {
            if word.eq_ignore_ascii_case("vertex") {
                let mut corner = [0.0; 3];
                for place in &mut corner {
                    let word = words.next().ok_or_else(|| wrong("a vertex needs three numbers".into()))?;
                    *place = word.parse().map_err(|_| wrong(format!("'{word}' is not a number")))?;
                }
                corners.push(corner);
            } else if word.eq_ignore_ascii_case("endloop") {
                let Ok(triangle) = corners[..].try_into() else {
                    return Err(wrong(format!("a facet has {} corners, and needs 3", corners.len())));
                };
                let Some(part) = parts.last_mut() else { return Err(wrong("there is no solid".into())) };
                push(part, triangle);
                corners.clear();
            } else if word.eq_ignore_ascii_case("endsolid") {
                is_open = false;
                break;
            }
        }
        last = number;
    }
    if !corners.is_empty() {
        return Err(Unreadable::at(last, "the file ends within a facet"));
    }
    if is_open {
        let what = format!("the mesh {} ends without endsolid: some of it may be missing", path.display());
        diagnostics.warning(&Source::new(path, last), what, "export it again");
    }
    Ok(parts)
}
