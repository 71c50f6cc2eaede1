//! The moments of a camera's frame: one, or those of a rolling shutter's rows and of an exposure that blurs.
//!
//! A frame's stamp is the time at which its last row is read. Rows are read one after the other in the time of readout,
//! and what a row shows is that moment, or with motion blur the mean of some of its exposure, which ends then. So all
//! moments lie at or before the stamp, and physics remembers where everything was.

use super::RigContext;
use super::mount::Mount;
use crate::description::model::CameraDevice;
use belvedere_sensors::{Capture, Moment, Pose, Shutter, Slice};
use std::ops::Range;

/// Rows that share their moment: as few as the tables of lenses can be cut into.
const ROWS: u32 = 4;

/// The lines of a frame with their moments, in the order of [`Shutter::Slices`].
#[derive(Debug, Default)]
pub(super) struct Moments {
    lines: Vec<Range<u32>>,
    world_from_sensor: Vec<Pose>,
    /// As many of each moment as the scene has instances.
    world_from_instance: Vec<Pose>,
}

impl Moments {
    /// Those of a frame of so many rows that is stamped with the context's time; none without a device that has more than
    /// one.
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
            // Of the middle of these rows; a picture of one row is read at its stamp.
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

    /// The first moment of each line, by which its truth is told.
    pub(super) fn of_truth(shutter: &Shutter<'_>) -> Self {
        let mut moments = Self::default();
        let mut add = |lines: Range<u32>, at: &Moment<'_>| {
            moments.lines.push(lines);
            moments.world_from_sensor.push(at.world_from_sensor);
            moments.world_from_instance.extend_from_slice(at.world_from_instance);
        };
        match shutter {
            // The lines of a single moment are not looked at.
            Shutter::Global(moment) => add(0..1, moment),
            // A picture has none.
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

    /// As slices, of which [`shutter`] makes a shutter.
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

/// The shutter of slices, if there are any; one alone is of all lines.
pub(super) fn shutter<'a>(slices: &'a [Slice<'a>]) -> Option<Shutter<'a>> {
    match slices {
        [] => None,
        [Slice { at, .. }] => Some(Shutter::Global(*at)),
        _ => Some(Shutter::Slices(slices)),
    }
}

/// A frame to be taken `at` its moments, for the flow back to those `before`, if there are any.
pub(super) fn capture<'a>(frame: u64, at: Shutter<'a>, before: &'a [Slice<'a>]) -> Capture<'a> {
    let capture = Capture::new(frame, at);
    shutter(before).map_or(capture, |before| capture.before(before))
}

/// How long before a row is read each of its moments lies, as shares of the exposure: the middles of equal parts, that in
/// the middle of the exposure first, as truth is that of the first.
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
    fn an_exposure_is_cut_into_equal_parts_whose_middles_are_taken() {
        let of = |samples| shares(samples).collect::<Vec<_>>();
        assert_eq!((of(1), of(2), of(3)), (vec![0.0], vec![0.75, 0.25], vec![0.5, 5.0 / 6.0, 1.0 / 6.0]));
    }
}
