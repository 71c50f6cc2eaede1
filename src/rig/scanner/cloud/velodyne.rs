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
        let mut places = frame.payload_mut().chunks_exact_mut(POINT_STEP);
        for index in 0..echoes {
            // There is a row of first returns, then one of the second.
            let (row, place) = (index / in_row, index % in_row);
            let in_rows = (row / returns * in_row + place) * returns + row % returns;
            let echo = if is_organized { in_rows } else { index };
            let is_point = scan.is_point(echo);
            if !is_point && !is_organized {
                continue;
            }
            let Some(place) = places.next() else { break };
            let firing = echo / returns;
            let point = if is_point { found.points[echo] } else { [f32::NAN; 3] };
            let time_s = scan.time_s(firing) - scan.taken_s.unwrap_or(0.0);
            let ring = self.rings[found.lasers[firing] as usize];
            place[..12].copy_from_slice(bytemuck::bytes_of(&point.map(f32::to_le_bytes)));
            place[12..16].copy_from_slice(&found.intensities[echo].to_le_bytes());
            place[16..18].copy_from_slice(&ring.to_le_bytes());
            place[18..].copy_from_slice(&(time_s as f32).to_le_bytes());
        }
        Some(frame)
    }
}
