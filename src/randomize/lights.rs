//! Random lights.

use super::{Draws, Limits, Thing};
use belvedere_sensors::scene::Light;
use glam::DVec3;

/// Limits for random lights, each drawn independently.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightRanges {
    /// Factor of its light, 0 or more.
    pub intensity: Limits,
    /// Additional factor of red, green and blue, 0 or more, drawn independently.
    pub color: Limits,
    /// Angle by which a directional light or a spot is tilted in a random direction, in radians.
    pub tilt: Limits,
    /// Distance by which a point light or a spot is moved along each axis of the world, in metres.
    pub offset_m: Limits,
}

impl Default for LightRanges {
    /// Leaves lights unchanged.
    fn default() -> Self {
        Self { intensity: [1.0; 2], color: [1.0; 2], tilt: [0.0; 2], offset_m: [0.0; 2] }
    }
}

/// The values drawn for a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnLight {
    /// Factor of its light.
    pub intensity: f64,
    /// Additional factor of red, green and blue.
    pub color: [f64; 3],
    /// Tilt angle, in radians.
    pub tilt: f64,
    /// Direction of the tilt, in radians.
    pub side: f64,
    /// Offset along the axes of the world, in metres.
    pub offset_m: DVec3,
}

impl LightRanges {
    /// Draws the values for the light with this index.
    pub fn draw(&self, draws: &Draws, light: u32) -> DrawnLight {
        let thing = Thing::Light(light);
        let between = |limits, slot| draws.between(limits, thing, slot);
        DrawnLight {
            intensity: between(self.intensity, 0),
            color: [1, 2, 3].map(|slot| between(self.color, slot)),
            tilt: between(self.tilt, 4),
            side: between([0.0, std::f64::consts::TAU], 5),
            offset_m: DVec3::from_array([6, 7, 8].map(|slot| between(self.offset_m, slot))),
        }
    }
}

impl DrawnLight {
    /// Applies the drawn values to a light. Its highlights change with its colour.
    #[must_use]
    pub fn of(&self, light: &Light) -> Light {
        let mut drawn = light.times(self.color.map(|factor| (factor * self.intensity) as f32));
        if let Some(direction) = drawn.direction() {
            let along = DVec3::from_array(direction);
            let (one, other) = along.any_orthonormal_pair();
            let (sin, cos) = libm::sincos(self.side);
            let aside = one * cos + other * sin;
            let (sin, cos) = libm::sincos(self.tilt);
            if self.tilt != 0.0 {
                drawn = drawn.with_direction((along * cos + aside * sin).to_array());
            }
        }
        if let Some(position) = drawn.position() {
            drawn = drawn.with_vector((DVec3::from_array(position) + self.offset_m).to_array());
        }
        drawn
    }
}
