//! The cloud of Livox's drivers: x, y, z, intensity, tag, line, timestamp. It is stamped with the beginning of the scan.

use super::{CloudForm, Scan};
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
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

    /// An intensity as Livox tells it: calibrated up to 150 of diffuse surfaces, up to 255 of retroreflectors.
    fn told(&self, intensity: f32) -> f32 {
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
        let Scan { found, firings, returns, .. } = *scan;
        let shown = || (0..firings * returns).filter(|&echo| scan.is_point(echo));
        let count = shown().count();
        let mut frame = outlet.loan(count * POINT_STEP)?;
        let header = frame.header_mut();
        header.set_packed(count as u32, 1);
        header.stamp_ns = scan.begin_ns();
        for (place, echo) in frame.payload_mut().chunks_exact_mut(POINT_STEP).zip(shown()) {
            let (firing, number) = (echo / returns, echo % returns);
            let time_ns = scan.begin_ns() as f64 + (scan.time_s(firing) * 1e9).round();
            place[..12].copy_from_slice(bytemuck::bytes_of(&found.points[echo].map(f32::to_le_bytes)));
            place[12..16].copy_from_slice(&self.told(found.intensities[echo]).to_le_bytes());
            place[16] = (number.min(3) << RETURN_BIT) as u8;
            place[17] = found.lasers[firing] as u8;
            place[18..].copy_from_slice(&time_ns.to_le_bytes());
        }
        Some(frame)
    }
}
