//! [`Moments`]: the moments of a camera's frame: one, or those of a rolling shutter's rows and of motion blur.
//!
//! A frame's timestamp is the time at which its last row is read. Rows are read one after the other during the readout
//! time. A row shows the moment at which it is read, or with motion blur the mean of several moments of its exposure,
//! which ends then. So all moments are at or before the timestamp, and physics' history provides the poses.

use super::RigContext;
use super::mount::Mount;
use crate::description::model::CameraDevice;
use belvedere_sensors::{Capture, Moment, Pose, Shutter, Slice};
use std::ops::Range;

/// Number of rows that share a moment: the smallest number into which lens tables can be divided.
const ROWS: u32 = 4;

/// The rows of a frame with their moments, in the order of [`Shutter::Slices`].
#[derive(Debug, Default)]
pub(super) struct Moments {
    lines: Vec<Range<u32>>,
    world_from_sensor: Vec<Pose>,
    /// For each moment, the poses of all instances of the scene.
    world_from_instance: Vec<Pose>,
}

impl Moments {
    /// Fills in the moments of a frame with this number of rows at the context's timestamp; none without a device that
    /// has several moments.
    pub(super) fn fill(
        &mut self,
        device: Option<&CameraDevice>,
        height: usize,
        context: &RigContext<'_>,
        mount: &Mount,
    ) {
        self.lines.clear();
        self.world_from_sensor.clear();
        self.world_from_instance.clear();
        let Some(device) = device else { return };
        let height = height as u32;
        let rows = if device.readout_time_s > 0.0 { ROWS } else { height };
        for first in (0..height).step_by(rows as usize) {
            let lines = first..(first + rows).min(height);
            // The moment of the middle of these rows; an image of one row is read at its timestamp.
            let middle = 0.5 * f64::from(lines.start + lines.end - 1);
            let rows_to_come = f64::from(height - 1) - middle;
            let read_before_s = device.readout_time_s * rows_to_come / f64::from((height - 1).max(1));
            for share in shares(device.motion_blur_samples) {
                let before_s = read_before_s + device.config.exposure.time_s * share;
                let time_ns = context.stamp_ns.saturating_sub((before_s * 1e9).round() as u64);
                self.lines.push(lines.clone());
                self.world_from_sensor.push(mount.pose_at(context.physics, time_ns));
                context.scene.poses_at(context.physics, time_ns, &mut self.world_from_instance);
            }
        }
    }

    /// Returns the first moment of each row, at which its ground truth is computed.
    pub(super) fn of_truth(shutter: &Shutter<'_>) -> Self {
        let mut moments = Self::default();
        let mut add = |lines: Range<u32>, at: &Moment<'_>| {
            moments.lines.push(lines);
            moments.world_from_sensor.push(at.world_from_sensor);
            moments.world_from_instance.extend_from_slice(at.world_from_instance);
        };
        match shutter {
            // The rows of a single moment are not used.
            Shutter::Global(moment) => add(0..1, moment),
            // Cameras do not use this shutter.
            Shutter::Moving(_) => {}
            Shutter::Slices(slices) => {
                let mut end = 0;
                for Slice { lines, at } in *slices {
                    if lines.start >= end {
                        add(lines.clone(), at);
                        end = lines.end;
                    }
                }
            }
        }
        moments
    }

    /// Returns the moments as slices for [`shutter`].
    pub(super) fn slices(&self) -> Vec<Slice<'_>> {
        let instances = self.world_from_instance.len() / self.lines.len().max(1);
        let slice = |(index, lines): (usize, &Range<u32>)| Slice {
            lines: lines.clone(),
            at: Moment {
                world_from_sensor: self.world_from_sensor[index],
                world_from_instance: &self.world_from_instance[index * instances..][..instances],
            },
        };
        self.lines.iter().enumerate().map(slice).collect()
    }
}

/// Returns the shutter of these slices, if there are any. A single slice covers all rows.
pub(super) fn shutter<'a>(slices: &'a [Slice<'a>]) -> Option<Shutter<'a>> {
    match slices {
        [] => None,
        [Slice { at, .. }] => Some(Shutter::Global(*at)),
        _ => Some(Shutter::Slices(slices)),
    }
}

/// Returns the capture of a frame `at` its moments, with optical flow back to the moments `before`, if there are any.
pub(super) fn capture<'a>(frame: u64, at: Shutter<'a>, before: &'a [Slice<'a>]) -> Capture<'a> {
    let capture = Capture::new(frame, at);
    shutter(before).map_or(capture, |before| capture.before(before))
}

/// Returns how long before a row's readout each of its moments is, as shares of the exposure: the middles of equal
/// parts. The middle of the exposure comes first, because ground truth uses the first moment.
fn shares(samples: u32) -> impl Iterator<Item = f64> {
    let middle = samples / 2;
    (0..samples).map(move |number| {
        let sample = (number + middle) % samples;
        if samples == 1 { 0.0 } else { (f64::from(sample) + 0.5) / f64::from(samples) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exposure_is_divided_into_equal_parts_at_their_middles() {
        let of = |samples| shares(samples).collect::<Vec<_>>();
        assert_eq!((of(1), of(2), of(3)), (vec![0.0], vec![0.75, 0.25], vec![0.5, 5.0 / 6.0, 1.0 / 6.0]));
    }
}
