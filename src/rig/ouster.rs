//! An Ouster's head in its maker's terms: what metadata say of it, and what clouds and packets have of its ranges.

use super::whole::nearest_below;
use belvedere_sensors::scanner::presets::Preset;
use belvedere_sensors::scanner::{Columns, Laser, Pattern};

/// A head.
#[derive(Debug, Clone)]
pub(super) struct OusterHead {
    /// Down from the highest beam.
    pub(super) lasers: &'static [Laser],
    /// Columns of a frame.
    pub(super) columns: u32,
    /// From the axis to where beams start, in metres: ranges are from the axis.
    beam_origin_m: f64,
}

impl OusterHead {
    /// Of a preset; of those of other makers it has no lasers.
    pub(super) fn of(preset: &Preset) -> Self {
        let Pattern::Spinning(head) = preset.pattern else {
            return Self { lasers: &[], columns: 0, beam_origin_m: 0.0 };
        };
        let columns = if let Columns::Turn { per_turn, .. } = head.columns { per_turn } else { 0 };
        let beam_origin_m = head.lasers.first().map_or(0.0, |laser| laser.origin_m[0]);
        Self { lasers: head.lasers, columns, beam_origin_m }
    }

    /// A range from where a beam started as it is told, from the axis, in steps of so many millimetres; 0 if there is none,
    /// or it takes more than so many bits.
    #[inline]
    pub(super) fn told(&self, range_m: f32, step_mm: f64, bits: u32) -> u32 {
        let limit = (1_u64 << bits) as f64 - 0.5;
        nearest_below((f64::from(range_m) + self.beam_origin_m) * (1000.0 / step_mm), limit)
    }

    pub(super) fn beam_origin_mm(&self) -> f64 {
        self.beam_origin_m * 1000.0
    }

    /// Of each laser clockwise from where the head looks, in degrees.
    pub(super) fn azimuths_deg(&self) -> impl Iterator<Item = f64> {
        self.lasers.iter().map(|laser| -laser.azimuth_rad.to_degrees())
    }

    /// By how many columns each laser looks ahead of the head.
    pub(super) fn shifts(&self) -> impl Iterator<Item = i32> {
        let columns = f64::from(self.columns);
        self.azimuths_deg().map(move |azimuth| (azimuth * columns / 360.0).round() as i32)
    }
}
