//! The cloud of Velodyne's driver: x, y, z, intensity, ring, time. Its timestamp is the end of the scan.

use super::{CloudForm, Places, Scan};
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
use belvedere_bridge::Encoding;
use belvedere_bridge::point::XyzIrtPoint;

pub(super) struct VelodyneCloud {
    /// The rank of each laser, counted from the lowest.
    rings: Vec<u16>,
    /// Number of firings in a row: those of a column of lasers, or of a row of pixels.
    in_row: usize,
}

impl VelodyneCloud {
    /// Creates the layout for lasers with these elevations.
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
        if scan.layout.is_organized { self.write_all(scan, outlet) } else { self.write_shown(scan, outlet) }
    }
}

/// Returns a point as bytes.
#[inline]
fn bytes([x, y, z]: [f32; 3], intensity: f32, ring: u16, before_s: f64) -> [u8; XyzIrtPoint::SIZE] {
    XyzIrtPoint { x, y, z, intensity, ring, time: before_s as f32 }.to_bytes()
}

impl VelodyneCloud {
    /// Writes only the included returns, those of a firing next to each other.
    fn write_shown(&self, scan: &Scan<'_>, outlet: &Outlet) -> Option<Frame> {
        let count = scan.points();
        let mut frame = outlet.loan(count * XyzIrtPoint::SIZE)?;
        let header = frame.header_mut();
        header.set_packed(count as u32, 1);
        header.stamp_ns = scan.stamp_ns;
        let end_s = scan.taken_s.unwrap_or(0.0);
        let mut places = Places::of(frame.payload_mut());
        for (time_s, laser, points, intensities) in scan.firings() {
            let ring = self.rings[laser as usize];
            for (point, intensity) in points.iter().zip(intensities) {
                let Some(place) = places.next() else { return Some(frame) };
                *place = bytes(*point, *intensity, ring, time_s - end_s);
                places.keep::<{ XyzIrtPoint::SIZE }>(scan.is_point(point, *intensity));
            }
        }
        Some(frame)
    }

    /// Writes all returns: a row of first returns, then a row of second ones.
    fn write_all(&self, scan: &Scan<'_>, outlet: &Outlet) -> Option<Frame> {
        let Scan { found, firings, returns, .. } = *scan;
        let in_row = self.in_row;
        let mut frame = outlet.loan(firings * returns * XyzIrtPoint::SIZE)?;
        let header = frame.header_mut();
        header.set_packed(in_row as u32, (firings * returns / in_row) as u32);
        header.stamp_ns = scan.stamp_ns;
        let end_s = scan.taken_s.unwrap_or(0.0);
        let rows = frame.payload_mut().chunks_exact_mut(in_row * XyzIrtPoint::SIZE);
        for (number, row) in rows.enumerate() {
            let (first, number) = (number / returns * in_row, number % returns);
            for (place, firing) in row.as_chunks_mut().0.iter_mut().zip(first..) {
                let echo = firing * returns + number;
                let (point, intensity) = (found.points[echo], found.intensities[echo]);
                let point = if scan.is_point(&point, intensity) { point } else { [f32::NAN; 3] };
                let ring = self.rings[found.lasers[firing] as usize];
                *place = bytes(point, intensity, ring, scan.time_s(firing) - end_s);
            }
        }
        Some(frame)
    }
}
