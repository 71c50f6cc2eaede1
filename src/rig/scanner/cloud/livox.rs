//! The cloud of Livox's drivers: x, y, z, intensity, tag, line, timestamp. Its timestamp is the beginning of the scan.

use super::{CloudForm, Places, Scan};
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
use belvedere_bridge::Encoding;
use belvedere_bridge::point::LivoxPoint;
use belvedere_sensors::scanner::Intensity;
use lidar_packets::whole::rounded;

/// The number of a return is in bits 4 and 5 of the tag.
const RETURN_BIT: usize = 4;

pub(super) struct LivoxCloud {
    /// Whether intensities are calibrated.
    is_reflectivity: bool,
}

impl LivoxCloud {
    pub(super) fn of(intensity: Intensity) -> Self {
        Self { is_reflectivity: intensity == Intensity::Reflectivity }
    }

    /// Converts an intensity to Livox's scale. Calibrated intensities are up to 150 for diffuse surfaces and up to 255
    /// for retroreflectors.
    fn livox_intensity(&self, intensity: f32) -> f32 {
        match intensity {
            _ if !self.is_reflectivity => intensity,
            diffuse if diffuse <= 100.0 => 1.5 * diffuse,
            retro => 150.0 + (retro - 100.0) * (105.0 / 155.0),
        }
    }
}

impl CloudForm for LivoxCloud {
    fn encoding(&self) -> Encoding {
        Encoding::LivoxPoint
    }

    fn write(&self, scan: &Scan<'_>, _: usize, outlet: &Outlet) -> Option<Frame> {
        let count = scan.points();
        let mut frame = outlet.loan(count * LivoxPoint::SIZE)?;
        let header = frame.header_mut();
        header.set_packed(count as u32, 1);
        header.stamp_ns = scan.begin_ns();
        let begin_ns = header.stamp_ns as f64;
        let mut places = Places::of(frame.payload_mut());
        for (time_s, laser, points, intensities) in scan.firings() {
            let time_ns = begin_ns + rounded(time_s * 1e9);
            for (number, (point, intensity)) in points.iter().zip(intensities).enumerate() {
                let Some(place) = places.next() else { return Some(frame) };
                let [x, y, z] = *point;
                let written = LivoxPoint {
                    x,
                    y,
                    z,
                    intensity: self.livox_intensity(*intensity),
                    tag: (number.min(3) << RETURN_BIT) as u8,
                    line: laser as u8,
                    timestamp: time_ns,
                };
                *place = written.to_bytes();
                places.keep::<{ LivoxPoint::SIZE }>(scan.is_point(point, *intensity));
            }
        }
        Some(frame)
    }
}
