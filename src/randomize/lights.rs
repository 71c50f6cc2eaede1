//! Lamps drawn at random.

use super::{Draws, Limits, Thing};
use belvedere_sensors::scene::Light;
use glam::DVec3;

/// Between what limits lamps are drawn, each by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightRanges {
    /// Factor of its light, 0 or more.
    pub intensity: Limits,
    /// Factor of each of red, green and blue beside that, 0 or more, each by itself.
    pub color: Limits,
    /// By how much a directional lamp or a spot is turned to any side, in radians.
    pub tilt: Limits,
    /// By how much a point of light or a spot is moved along each axis of the world, in metres.
    pub offset_m: Limits,
}

impl Default for LightRanges {
    /// As it is.
    fn default() -> Self {
        Self { intensity: [1.0; 2], color: [1.0; 2], tilt: [0.0; 2], offset_m: [0.0; 2] }
    }
}

/// What was drawn for a lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnLight {
    /// Factor of its light.
    pub intensity: f64,
    /// Factor of each of red, green and blue beside that.
    pub color: [f64; 3],
    /// By how much it is turned, in radians.
    pub tilt: f64,
    /// To which side, in radians.
    pub side: f64,
    /// By how much it is moved, in metres along the axes of the world.
    pub offset_m: DVec3,
}

impl LightRanges {
    /// What is drawn for the lamp of this index.
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
    /// A lamp as it was drawn. Its highlights follow its light.
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
