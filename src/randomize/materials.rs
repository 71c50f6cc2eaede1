//! Random colours and textures of bodies.

use super::{Draws, Limits, Thing};
use belvedere_sensors::scene::Material;

/// Limits for random materials of bodies, each drawn independently.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialRanges {
    /// Colours that replace the body's own.
    pub colors: Colors,
    /// Rotation of the hue, in degrees.
    pub hue_deg: Limits,
    /// Factor of the saturation, 0 or more.
    pub saturation: Limits,
    /// Factor of the brightness (the largest of red, green and blue), 0 or more.
    pub brightness: Limits,
    /// Probability that the body keeps its textures, 0 to 1.
    pub textured: f64,
}

/// Colours that replace a body's own, with components from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub enum Colors {
    /// The body's own colour.
    Own,
    /// Between two colours, drawn independently for red, green and blue.
    Between([[f64; 3]; 2]),
    /// One of several, with equal probability.
    OneOf(Vec<[f64; 3]>),
}

impl Default for MaterialRanges {
    /// Leaves materials unchanged.
    fn default() -> Self {
        Self {
            colors: Colors::Own,
            hue_deg: [0.0; 2],
            saturation: [1.0; 2],
            brightness: [1.0; 2],
            textured: 1.0,
        }
    }
}

/// The values drawn for a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnMaterial {
    /// The colour that replaces its own.
    pub color: Option<[f64; 3]>,
    /// Rotation of the hue, in degrees.
    pub hue_deg: f64,
    /// Factor of the saturation.
    pub saturation: f64,
    /// Factor of the brightness.
    pub brightness: f64,
    /// True if it keeps its textures.
    pub is_textured: bool,
}

impl MaterialRanges {
    /// Draws the values for the body with this index.
    pub fn draw(&self, draws: &Draws, body: u32) -> DrawnMaterial {
        let thing = Thing::Body(body);
        let color =
            match &self.colors {
                Colors::Own => None,
                Colors::Between([low, high]) => Some([0, 1, 2].map(|channel: usize| {
                    draws.between([low[channel], high[channel]], thing, channel as u32)
                })),
                Colors::OneOf(colors) => {
                    colors.get((draws.share(thing, 0) * colors.len() as f64) as usize).copied()
                }
            };
        DrawnMaterial {
            color,
            hue_deg: draws.between(self.hue_deg, thing, 3),
            saturation: draws.between(self.saturation, thing, 4),
            brightness: draws.between(self.brightness, thing, 5),
            is_textured: draws.share(thing, 6) < self.textured,
        }
    }
}

impl DrawnMaterial {
    /// Applies the drawn values to a material.
    #[must_use]
    pub fn of(&self, material: &Material) -> Material {
        let material = if self.is_textured { *material } else { material.without_texture() };
        material.recoloured(|own| self.color_of(own))
    }

    /// Applies the drawn values to a colour with components from 0 to 1.
    fn color_of(&self, own: [f32; 3]) -> [f32; 3] {
        let color = self.color.map_or(own, |color| color.map(|part| part as f32));
        if self.hue_deg == 0.0 && self.saturation == 1.0 && self.brightness == 1.0 {
            return color;
        }
        let [hue_deg, saturation, value] = hsv(color.map(f64::from));
        let [saturation, value] = [saturation * self.saturation, value * self.brightness];
        rgb([hue_deg + self.hue_deg, saturation.min(1.0), value.min(1.0)]).map(|part| part as f32)
    }
}

/// Converts a colour to hue in degrees, saturation and value: A. R. Smith, "Color gamut transform pairs", 1978,
/// doi:10.1145/965139.807361.
fn hsv([red, green, blue]: [f64; 3]) -> [f64; 3] {
    let value = red.max(green).max(blue);
    let spread = value - red.min(green).min(blue);
    if spread <= 0.0 {
        return [0.0, 0.0, value];
    }
    let sixth = if value == red {
        (green - blue) / spread
    } else if value == green {
        2.0 + (blue - red) / spread
    } else {
        4.0 + (red - green) / spread
    };
    [60.0 * sixth, spread / value, value]
}

/// Converts hue in degrees, saturation and value to a colour.
fn rgb([hue_deg, saturation, value]: [f64; 3]) -> [f64; 3] {
    // Distance of the hue from each primary's, in sixths of the circle: up to one the primary is full, beyond two it is
    // zero.
    [0.0, 120.0, 240.0].map(|primary_deg: f64| {
        let turn = (hue_deg - primary_deg).rem_euclid(360.0);
        let sixths = turn.min(360.0 - turn) / 60.0;
        value * (1.0 - saturation * (sixths - 1.0).clamp(0.0, 1.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_go_round() {
        for color in [[0.2, 0.7, 0.4], [1.0, 0.0, 0.0], [0.3, 0.3, 0.9], [0.5; 3], [0.0; 3]] {
            let there_and_back = rgb(hsv(color));
            assert!((0..3).all(|part| (there_and_back[part] - color[part]).abs() < 1e-12), "{color:?}");
            let [hue_deg, saturation, value] = hsv(color);
            let next = rgb([hue_deg - 120.0, saturation, value]);
            assert!((0..3).all(|part| (next[part] - color[(part + 1) % 3]).abs() < 1e-12), "{color:?}");
        }
    }
}
