//! Materials of Wavefront OBJ: `.mtl`.

use crate::mesh::look::{Look, find_texture};
use std::path::Path;

/// Reads the materials of a library in `folder`. Unknown or broken properties of a material are ignored.
pub(super) fn parse(text: &str, folder: &Path) -> Vec<(String, Look)> {
    let mut materials: Vec<(String, Look)> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if keyword == "newmtl" {
            materials.push((rest.to_owned(), Look::default()));
            continue;
        }
        let Some((_, look)) = materials.last_mut() else { continue };
        match keyword {
            "Kd" if look.texture.is_none() => look.diffuse = color(rest).or(look.diffuse),
            "Ke" => look.emissive = color(rest).or(look.emissive),
            "Ks" => look.specular = color(rest).or(look.specular),
            "Ns" => look.shininess = number(rest).or(look.shininess),
            "d" => look.alpha = number(rest).or(look.alpha),
            "Tr" => look.alpha = number(rest).map(|share| 1.0 - share).or(look.alpha),
            "map_Kd" => {
                // Names may contain spaces; options come before the name.
                let last = rest.rsplit(char::is_whitespace).next().unwrap_or(rest);
                let found = find_texture(rest, folder).or_else(|| find_texture(last, folder));
                let named = if rest.starts_with('-') { last } else { rest };
                look.texture = Some(found.unwrap_or_else(|| named.into())).filter(|_| !rest.is_empty());
                // A picture is shown in its own colours.
                look.diffuse = Some([1.0; 3]);
            }
            _ => {}
        }
    }
    materials
}

/// Reads a colour; a single number is used for all three channels.
fn color(rest: &str) -> Option<[f32; 3]> {
    let numbers: Option<Vec<f32>> = rest.split_whitespace().map(number).collect();
    match numbers?[..] {
        [grey] => Some([grey; 3]),
        [red, green, blue, ..] => Some([red, green, blue]),
        _ => None,
    }
}

fn number(word: &str) -> Option<f32> {
    word.parse().ok().filter(|number: &f32| number.is_finite())
}
