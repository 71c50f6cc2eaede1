//! The motion of the sensor and of the instances during a frame.

use crate::Pose;
use crate::moment::{Keyframe, Moment, Shutter};
use crate::scene::Scene;
use crate::trace::SenseError;
use crate::trace::placed::view::{View, ViewMemory, check_moment};

/// How far the last motion is extrapolated, in multiples of its duration from its start.
const MOST_SHARE: f64 = 2.0;

/// The motions of a frame: from each keyframe to the next, or none at a single moment.
#[derive(Clone, Copy)]
pub(super) enum Motions<'a> {
    Still(Moment<'a>),
    Between(&'a [Keyframe<'a>]),
}

impl<'a> Motions<'a> {
    pub(super) fn of(
        scene: &Scene<'_>,
        shutter: &Shutter<'a>,
        frame_time_s: f64,
    ) -> Result<Self, SenseError> {
        match *shutter {
            Shutter::Global(moment) => check_moment(scene, &moment).map(|()| Self::Still(moment)),
            Shutter::Slices(_) => Err(SenseError::Shutter {
                rule: "be one moment or keyframes: this sensor's rays have individual times",
            }),
            Shutter::Moving(keyframes) => {
                check_keyframes(scene, keyframes, frame_time_s)?;
                Ok(Self::Between(keyframes))
            }
        }
    }

    pub(super) fn count(&self) -> usize {
        match self {
            Self::Still(_) => 1,
            Self::Between(keyframes) => keyframes.len() - 1,
        }
    }

    /// Returns the motion to which a time belongs.
    pub(super) fn at(&self, time_s: f64) -> usize {
        let Self::Between(keyframes) = self else { return 0 };
        let begun = keyframes.partition_point(|keyframe| keyframe.time_s <= time_s);
        // Times before the first and after the last keyframe belong to the first and the last motion.
        begun.saturating_sub(1).min(keyframes.len() - 2)
    }

    /// Returns the time at which the motion after this one begins, if there is one.
    pub(super) fn next_s(&self, motion: usize) -> Option<f64> {
        match self {
            Self::Between(keyframes) if motion + 2 < keyframes.len() => Some(keyframes[motion + 1].time_s),
            _ => None,
        }
    }

    /// Creates the view of a motion. That of the last motion covers the time up to `last_s`.
    pub(super) fn view<'m>(
        &self,
        scene: &Scene<'a>,
        (motion, last_s): (usize, f64),
        visibility: u32,
        memory: ViewMemory<'m>,
    ) -> View<'m>
    where
        'a: 'm,
    {
        match self {
            Self::Still(moment) => View::new(scene, moment, visibility, memory),
            Self::Between(keyframes) => {
                let [from, to] = [&keyframes[motion], &keyframes[motion + 1]];
                let until = share(from, to, last_s).max(1.0);
                let until = if motion + 2 == keyframes.len() { until } else { 1.0 };
                View::until(scene, (&from.at, Some((to.at, until))), visibility, memory)
            }
        }
    }

    /// Returns the pose of the sensor at a time, and the fraction of the motion that has passed.
    #[inline(always)]
    pub(super) fn pose(&self, motion: usize, time_s: f64) -> (Pose, f64) {
        match self {
            Self::Still(moment) => (moment.world_from_sensor, 0.0),
            Self::Between(keyframes) => {
                let [from, to] = [&keyframes[motion], &keyframes[motion + 1]];
                let share = share(from, to, time_s);
                (from.at.world_from_sensor.interpolate(&to.at.world_from_sensor, share), share)
            }
        }
    }
}

/// Checks that the keyframes cover the frame from its beginning to its end.
fn check_keyframes(scene: &Scene<'_>, keyframes: &[Keyframe<'_>], end_s: f64) -> Result<(), SenseError> {
    let wrong = |keyframe, rule| Err(SenseError::Keyframes { keyframe, rule });
    if keyframes.len() < 2 {
        return wrong(keyframes.len(), "exist: motion needs at least two keyframes");
    }
    for (index, keyframe) in keyframes.iter().enumerate() {
        if !keyframe.time_s.is_finite() {
            return wrong(index, "have a time that is finite");
        }
        if index > 0 && keyframe.time_s <= keyframes[index - 1].time_s {
            return wrong(index, "be later than the previous one");
        }
        check_moment(scene, &keyframe.at)?;
    }
    if keyframes[0].time_s > 0.0 {
        return wrong(0, "be at 0 s, the beginning of the frame, or earlier");
    }
    // A simulator may know its time less precisely than to a nanosecond.
    if keyframes[keyframes.len() - 1].time_s < end_s - 1e-9 {
        return wrong(keyframes.len() - 1, "be at the end of the frame or later");
    }
    Ok(())
}

/// Returns the fraction of the way between two keyframes that has passed at a time.
fn share(from: &Keyframe<'_>, to: &Keyframe<'_>, time_s: f64) -> f64 {
    ((time_s - from.time_s) / (to.time_s - from.time_s)).clamp(0.0, MOST_SHARE)
}
