//! The cloud of Velodyne's driver: x, y, z, intensity, ring, time. It is stamped with the end of the scan.

use super::{CloudForm, Scan};
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
use belvedere_bridge::Encoding;

const POINT_STEP: usize = 22;

pub(super) struct VelodyneCloud {
    /// The rank of each laser, from the lowest up.
    rings: Vec<u16>,
    /// Firings of a row: those of a column of lasers, or of a row of pixels.
    in_row: usize,
}

impl VelodyneCloud {
    /// Of lasers that look up so much.
    pub(super) fn of(elevations: &[f64], in_row: usize) -> Self {
        let rank = |elevation: &f64| elevations.iter().filter(|other| *other < elevation).count() as u16;
        Self { rings: elevations.iter().map(rank).collect(), in_row }
    }
}

impl CloudForm for VelodyneCloud {
    fn encoding(&self) -> Encoding {
        Encoding::XyzIrtF32
    }

    fn write(&self, scan: &Scan<'_>, _: usize, outlet: &Outlet) -> Option<Frame> {
        let Scan { found, firings, returns, .. } = *scan;
        let (is_organized, in_row) = (scan.layout.is_organized, self.in_row);
        let echoes = firings * returns;
        let shown =
            if is_organized { echoes } else { (0..echoes).filter(|&echo| scan.is_point(echo)).count() };
        let mut frame = outlet.loan(shown * POINT_STEP)?;
        let header = frame.header_mut();
        if is_organized {
            header.set_packed(in_row as u32, (echoes / in_row) as u32);
        } else {
            header.set_packed(shown as u32, 1);
        }
        header.stamp_ns = scan.stamp_ns;
        let end_s = scan.taken_s.unwrap_or(0.0);
        let put = |place: &mut [u8; POINT_STEP], firing: usize, number: usize| {
            let echo = firing * returns + number;
            let is_point = scan.is_point(echo);
            if !is_point && !is_organized {
                return false;
            }
            let point = if is_point { found.points[echo] } else { [f32::NAN; 3] };
            let ring = self.rings[found.lasers[firing] as usize];
            place[..12].copy_from_slice(bytemuck::bytes_of(&point.map(f32::to_le_bytes)));
            place[12..16].copy_from_slice(&found.intensities[echo].to_le_bytes());
            place[16..18].copy_from_slice(&ring.to_le_bytes());
            place[18..].copy_from_slice(&((scan.time_s(firing) - end_s) as f32).to_le_bytes());
            true
        };
        let mut places = frame.payload_mut().as_chunks_mut().0.iter_mut();
        // An organized cloud has a row of first returns, then one of the second; another has those of a firing together.
        let rows = if is_organized { in_row } else { 1 };
        let mut next = places.next();
        for first in (0..firings).step_by(rows) {
            for number in 0..returns {
                for firing in first..firings.min(first + rows) {
                    let Some(place) = &mut next else { return Some(frame) };
                    if put(place, firing, number) {
                        next = places.next();
                    }
                }
            }
        }
        Some(frame)
    }
}
