//! Wavefront OBJ and its `.mtl`, made ready for the crate `mesh-loader`: that passes over indented lines, refuses the mesh
//! for a bad number in a material, and looks for pictures beside the `.mtl` alone.

use super::find_texture;
use std::io;
use std::path::Path;

/// Reads a file that an OBJ is made of.
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let bytes = std::fs::read(path)?;
    let is_material = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mtl"));
    if is_material {
        let folder = path.parent().unwrap_or(Path::new(""));
        return Ok(material_lines(&String::from_utf8_lossy(&bytes), folder).into_bytes());
    }
    Ok(bytes.split_inclusive(|byte| *byte == b'\n').flat_map(<[u8]>::trim_ascii_start).copied().collect())
}

/// What of a `.mtl` is drawn, a line each.
fn material_lines(text: &str, folder: &Path) -> String {
    let mut lines = String::with_capacity(text.len());
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let are_numbers = || {
            let mut words = rest.split_whitespace();
            !rest.is_empty() && words.all(|word| word.parse::<f32>().is_ok_and(f32::is_finite))
        };
        match keyword {
            "map_Kd" => {
                let found = find_texture(rest, folder);
                // Options stand before the name.
                let found = found.or_else(|| find_texture(rest.rsplit(char::is_whitespace).next()?, folder));
                let found = found.and_then(|path| std::path::absolute(path).ok());
                if let Some(path) = found {
                    lines.extend(["map_Kd ", &path.to_string_lossy(), "\n"]);
                }
            }
            "newmtl" => lines.extend(["newmtl ", rest, "\n"]),
            "Kd" | "Ke" | "Ks" | "Ns" | "d" | "Tr" if are_numbers() => {
                lines.extend([keyword, " ", rest, "\n"]);
            }
            _ => {}
        }
    }
    lines
}
