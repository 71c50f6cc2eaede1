//! Roughness and metalness.

/// How a surface of microscopic facets reflects the light of lamps, with the metalness and roughness of glTF and of
/// SDF's `<pbr>`.
///
/// With base colour c = [`MaterialConfig::diffuse`](super::MaterialConfig::diffuse) · texture, normal n, and the directions l to the lamp, v to the
/// sensor and h halfway between them, a lamp adds n·l · (diffuse light · (1 − metalness) · c · B + specular light ·
/// [`Pbr::highlights`] · F · D · G):
///
/// - F = f + (1 − f)(1 − v·h)⁵ after Schlick, with f = 0.04 + (c − 0.04) · metalness.
/// - D · G = α² / (α² + (1 − α²)(1 − (n·h)²))² / (2 (n·l √(α² + (1 − α²)(n·v)²) + n·v √(α² + (1 − α²)(n·l)²))): facets
///   of Trowbridge and Reitz (GGX) with the height-correlated shadowing of Smith, for α = max(roughness², 0.001).
/// - B = (1 − max F)(1 − 0.338 · roughness)(1 + b (1 − n·l)⁵)(1 + b (1 − n·v)⁵) after Disney, as normalised by Lagarde
///   and de Rousiers, with b = roughness · (0.5 + 2 (v·h)²) − 1.
///
/// Roughness and metalness are multiplied by [`MaterialConfig::pbr_map`](super::MaterialConfig::pbr_map). Ambient light
/// is reflected as by any other material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pbr {
    /// 0 for a mirror-like surface, 1 for a dull one. The default is 1.
    pub roughness: f32,
    /// 0 for plastics, wood, stone and so on; 1 for metals, which reflect the light of lamps only in highlights of
    /// their own colour. The default is 0.
    pub metalness: f32,
    /// Factor of the highlights. The default is 1 for each colour.
    pub highlights: [f32; 3],
}

impl Default for Pbr {
    /// A dull surface without metal.
    fn default() -> Self {
        Self { roughness: 1.0, metalness: 0.0, highlights: [1.0; 3] }
    }
}
