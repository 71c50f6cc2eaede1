//! The cloud of Ouster's driver: an image with one row per laser, the highest first. Its columns are directions, not
//! times. Its timestamp is the beginning of the scan. Each return has a separate cloud.

use super::{CloudForm, Scan};
use crate::rig::ouster::head_of;
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
use belvedere_bridge::Encoding;
use belvedere_bridge::point::OusterPoint;
use belvedere_sensors::scanner::presets::Preset;
use lidar_packets::ouster::Head;
use lidar_packets::whole::{nearest, nearest_below};

/// Number of rows that are written together. The results are stored by columns, so a cache line contains several rows.
const TILE: usize = 8;

pub(super) struct OusterCloud {
    head: Head,
    /// The number of columns by which each row is shifted to the right.
    shifts: Vec<usize>,
}

impl OusterCloud {
    pub(super) fn of(preset: &Preset) -> Self {
        let head = head_of(preset);
        let columns = head.columns_per_frame as i32;
        let shifts = head.pixel_shifts().map(|shift| shift.rem_euclid(columns) as usize).collect();
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
        let mut frame = outlet.loan(scan.firings * OusterPoint::SIZE)?;
        let header = frame.header_mut();
        header.set_packed(columns as u32, rows as u32);
        header.stamp_ns = scan.begin_ns();
        let (all, _) = frame.payload_mut().as_chunks_mut::<{ OusterPoint::SIZE }>();
        for (tile, shifts) in self.shifts.chunks(TILE).enumerate() {
            let (first, points) = (tile * TILE, &mut all[tile * TILE * columns..]);
            for column in 0..columns {
                for (row, shift) in shifts.iter().enumerate() {
                    let firing = column * rows + first + row;
                    let echo = firing * scan.returns + stream;
                    let (point, intensity) = (found.points[echo], found.intensities[echo]);
                    let is_point = scan.is_point(&point, intensity);
                    let [x, y, z] = if is_point { point } else { [f32::NAN; 3] };
                    let written = OusterPoint {
                        x,
                        y,
                        z,
                        intensity,
                        t: nearest_below(scan.time_s(firing) * 1e9, f64::from(u32::MAX)),
                        reflectivity: nearest(intensity, 255.0) as u16,
                        ring: (first + row) as u16,
                        ambient: 0,
                        range: if is_point { self.head.steps(found.ranges[echo], 1.0, 32) } else { 0 },
                    };
                    // This laser faces where the head faces `shift` columns later.
                    let at = column + shift;
                    let at = if at < columns { at } else { at - columns };
                    points[row * columns + at] = written.to_bytes();
                }
            }
        }
        Some(frame)
    }
}
