//! Effects of a Collada file: colours, pictures, and transparency.

use super::numbers::list;
use super::{Document, Outcome, wrong};
use crate::mesh::look::Look;
use crate::model::Material;
use crate::xml::Element;
use belvedere_sensors::scene::TextureAlpha;
use std::path::PathBuf;

impl Document<'_> {
    pub(super) fn effect(&self, effect: &Element) -> Outcome<Option<Material>> {
        let Some(profile) = effect.child("profile_COMMON") else { return Ok(None) };
        let Some(shading) = profile.child("technique").and_then(|technique| {
            ["phong", "lambert", "blinn", "constant"].iter().find_map(|name| technique.child(name))
        }) else {
            return Ok(None);
        };
        let color = |name: &str| -> Outcome<Option<[f32; 3]>> {
            match shading.child(name).and_then(|part| part.child("color")) {
                Some(element) => rgba(element).map(|[r, g, b, _]| Some([r, g, b])),
                None => Ok(None),
            }
        };
        let shininess = shading.child("shininess").map(float).transpose()?.flatten();
        let (alpha, texture_alpha) = opacity(shading)?;
        let texture = shading.child("diffuse").and_then(|diffuse| diffuse.child("texture"));
        let picture = texture
            .and_then(|texture| texture.attribute("texture"))
            .and_then(|sampler| self.picture(profile, sampler));
        let (diffuse, emissive, specular) = (color("diffuse")?, color("emission")?, color("specular")?);
        let look = Look { diffuse, emissive, specular, shininess, alpha, texture_alpha, texture: picture };
        Ok(look.material())
    }

    /// Returns the file of a texture: sampler → surface → image (1.4), sampler → image (1.5), or the image itself.
    fn picture(&self, profile: &Element, sampler: &str) -> Option<PathBuf> {
        let parameter = |sid: &str| {
            profile.elements_named("newparam").find(|parameter| parameter.attribute("sid") == Some(sid))
        };
        let mut id = sampler;
        let source;
        if let Some(sampler) = parameter(sampler).and_then(|parameter| parameter.child("sampler2D")) {
            if let Some(image) = sampler.child("instance_image") {
                id = image.attribute("url")?.trim_start_matches('#');
            } else {
                let surface = parameter(&sampler.child("source")?.text())?.child("surface")?;
                source = surface.child("init_from")?.text();
                id = &source;
            }
        }
        let init = self.by_id.get(id)?.child("init_from")?;
        let file = init.child("ref").unwrap_or(init).text();
        let file = file.trim_start_matches("file://").replace('\\', "/").replace("%20", " ");
        (!file.is_empty()).then(|| file.into())
    }
}

/// Returns the colour of an element's text; opaque without an alpha.
fn rgba(element: &Element) -> Outcome<[f32; 4]> {
    match list::<f32>(element)?[..] {
        [r, g, b, ref rest @ ..] if [r, g, b].iter().chain(rest).all(|value| value.is_finite()) => {
            Ok([r, g, b, rest.first().copied().unwrap_or(1.0)])
        }
        _ => wrong(element, "a colour needs three finite numbers"),
    }
}

/// Returns the number in an element's `<float>`, if there is one.
fn float(element: &Element) -> Outcome<Option<f32>> {
    let Some(float) = element.child("float") else { return Ok(None) };
    match list::<f32>(float)?[..] {
        [value] if value.is_finite() => Ok(Some(value)),
        _ => wrong(float, format!("<{}> needs one finite number", element.name)),
    }
}

/// Returns the opacity of a surface. Exporters disagree on the meaning of `<transparency>` alone, so it only counts
/// together with a `<transparent>` that gives its meaning, as in Gazebo. If that has a picture, the picture's alpha
/// cuts out.
fn opacity(shading: &Element) -> Outcome<(Option<f32>, TextureAlpha)> {
    let transparent = shading.child("transparent");
    let Some((transparent, mode)) = transparent.and_then(|it| Some((it, it.attribute("opaque")?))) else {
        return Ok((None, TextureAlpha::Ignored));
    };
    if transparent.child("texture").is_some() {
        return Ok((None, TextureAlpha::CutOut { least: 0.5 }));
    }
    let share = shading.child("transparency").map(float).transpose()?.flatten().unwrap_or(1.0);
    let [r, g, b, a] = transparent.child("color").map(rgba).transpose()?.unwrap_or([1.0; 4]);
    let luminance = 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
    let alpha = match mode {
        "A_ONE" => a * share,
        "A_ZERO" => 1.0 - a * share,
        "RGB_ONE" => luminance * share,
        "RGB_ZERO" => 1.0 - luminance * share,
        _ => {
            return wrong(
                transparent,
                format!("opaque='{mode}' is none of A_ONE, A_ZERO, RGB_ONE, RGB_ZERO"),
            );
        }
    };
    Ok((Some(alpha), TextureAlpha::Ignored))
}
