//! The cloud of Ouster's driver: an image of a row a laser, the highest first, whose columns are directions, not times.
//! It is stamped with the beginning of the scan. Each return has a cloud of its own.

use super::{CloudForm, Scan};
use crate::rig::ouster::OusterHead;
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
use belvedere_bridge::Encoding;
use belvedere_sensors::scanner::presets::Preset;

const POINT_STEP: usize = 48;

pub(super) struct OusterCloud {
    head: OusterHead,
    /// How far each row is shifted to the right.
    shifts: Vec<usize>,
}

impl OusterCloud {
    pub(super) fn of(preset: &Preset) -> Self {
        let head = OusterHead::of(preset);
        let columns = head.columns as i32;
        let shifts = head.shifts().map(|shift| shift.rem_euclid(columns) as usize).collect();
        Self { head, shifts }
    }
}

impl CloudForm for OusterCloud {
    fn encoding(&self) -> Encoding {
        Encoding::OusterPoint
    }

    fn streams(&self, returns: usize) -> usize {
        returns
    }

    fn write(&self, scan: &Scan<'_>, stream: usize, outlet: &Outlet) -> Option<Frame> {
        let found = scan.found;
        let rows = self.shifts.len();
        let columns = scan.firings / rows;
        let mut frame = outlet.loan(scan.firings * POINT_STEP)?;
        let header = frame.header_mut();
        header.set_packed(columns as u32, rows as u32);
        header.stamp_ns = scan.begin_ns();
        let rows_of_points = frame.payload_mut().chunks_exact_mut(POINT_STEP * columns);
        for ((row, &shift), points) in self.shifts.iter().enumerate().zip(rows_of_points) {
            for (at, place) in points.chunks_exact_mut(POINT_STEP).enumerate() {
                let firing = (at + columns - shift) % columns * rows + row;
                let echo = firing * scan.returns + stream;
                let is_point = scan.is_point(echo);
                let point = if is_point { found.points[echo] } else { [f32::NAN; 3] };
                let intensity = found.intensities[echo];
                let time_ns = (scan.time_s(firing) * 1e9).round() as u32;
                let range = if is_point { self.head.told(found.ranges[echo], 1.0) } else { 0 };
                let mut bytes = [0; POINT_STEP];
                bytes[..12].copy_from_slice(bytemuck::bytes_of(&point.map(f32::to_le_bytes)));
                bytes[16..20].copy_from_slice(&intensity.to_le_bytes());
                bytes[20..24].copy_from_slice(&time_ns.to_le_bytes());
                bytes[24..26].copy_from_slice(&u16::from(intensity.round() as u8).to_le_bytes());
                bytes[26..28].copy_from_slice(&(row as u16).to_le_bytes());
                bytes[32..36].copy_from_slice(&range.to_le_bytes());
                place.copy_from_slice(&bytes);
            }
        }
        Some(frame)
    }
}
