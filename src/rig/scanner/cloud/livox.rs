//! The cloud of Livox's drivers: x, y, z, intensity, tag, line, timestamp. Its timestamp is the beginning of the scan.

use super::{CloudForm, Places, Scan};
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
use crate::rig::whole::rounded;
use belvedere_bridge::Encoding;
use belvedere_sensors::scanner::Intensity;

const POINT_STEP: usize = 26;
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
        let mut frame = outlet.loan(count * POINT_STEP)?;
        let header = frame.header_mut();
        header.set_packed(count as u32, 1);
        header.stamp_ns = scan.begin_ns();
        let begin_ns = header.stamp_ns as f64;
        let mut places = Places::of(frame.payload_mut());
        for (time_s, laser, points, intensities) in scan.firings() {
            let time_ns = begin_ns + rounded(time_s * 1e9);
            for (number, (point, intensity)) in points.iter().zip(intensities).enumerate() {
                let Some(place) = places.next::<POINT_STEP>() else { return Some(frame) };
                place[..12].copy_from_slice(bytemuck::bytes_of(&point.map(f32::to_le_bytes)));
                place[12..16].copy_from_slice(&self.livox_intensity(*intensity).to_le_bytes());
                place[16] = (number.min(3) << RETURN_BIT) as u8;
                place[17] = laser as u8;
                place[18..].copy_from_slice(&time_ns.to_le_bytes());
                places.keep::<POINT_STEP>(scan.is_point(point, *intensity));
            }
        }
        Some(frame)
    }
}
