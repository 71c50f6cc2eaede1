//! The poses of everything, and the times of a frame, which are not part of a [`Scene`](crate::scene::Scene).

use crate::pose::Pose;
use core::ops::Range;

/// The poses of the sensor and of all instances at one moment.
///
/// A scene holds shapes and materials but no poses, so one scene can be seen at many moments: those of a rolling
/// shutter, or that of the previous frame.
///
/// ```
/// use belvedere_sensors::{Moment, Pose, scene::*};
/// let mut builder = SceneBuilder::new();
/// let material = builder.add_material(&MaterialConfig::default())?;
/// builder.add_instance(&InstanceConfig { material, ..Default::default() })?;
/// // The poses that the builder keeps …
/// let now = builder.moment(Pose::IDENTITY);
/// // … or others.
/// let moved = [Pose::from_translation(belvedere_sensors::glam::DVec3::X * 2.0)];
/// let later = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &moved };
/// assert_eq!(now.world_from_instance[0].translation().x, 0.0);
/// assert_eq!(later.world_from_instance[0].translation().x, 2.0);
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// Pose of the sensor, which looks along +x; z is up.
    pub world_from_sensor: Pose,
    /// Pose of each instance of the scene, in the order of their indices, one for each instance. An instance whose pose
    /// is not finite is invisible.
    pub world_from_instance: &'a [Pose],
}

/// Some lines of a frame, and the moment at which they are captured.
///
/// The lines of an image are its rows, from the top. The lines of a lidar depend on its [`Sweep`](crate::lidar::Sweep):
/// the columns of a rotating lidar, starting at the first beam of the scan lines, or the scan lines themselves.
///
/// Each slice places all instances of the scene anew and walks its trees once, and rays are traced in blocks of sixteen
/// columns. A [`Lidar`](crate::lidar::Lidar) is therefore fast with slices of sixteen columns or more. In a hall with
/// 48 things, a scan took this many times as long as at one moment (x86-64 with AVX2):
///
/// | columns in a slice | 720 × 1 beams | 1800 × 16 beams | 1024 × 128 beams |
/// |---:|---:|---:|---:|
/// | 1 | 89 | 36 | 8 |
/// | 4 | 23 | 10 | 2.4 |
/// | 16 | 6 | 3 | 1.4 |
/// | 64 | 2.4 | 1.6 | 1.1 |
///
/// A [`Scanner`](crate::scanner::Scanner) with a [moving](Shutter::Moving) shutter gives each firing its own time,
/// without slices.
#[derive(Debug, Clone)]
pub struct Slice<'a> {
    /// The range of lines.
    pub lines: Range<u32>,
    /// The poses at the time of these lines.
    pub at: Moment<'a>,
}

/// A moment, and its time within a frame.
#[derive(Debug, Clone, Copy)]
pub struct Keyframe<'a> {
    /// Time in seconds after the start of the frame.
    pub time_s: f64,
    /// The poses at this time.
    pub at: Moment<'a>,
}

/// The times at which the lines of a frame are captured.
#[derive(Debug, Clone, Copy)]
pub enum Shutter<'a> {
    /// Global shutter: all lines at one moment.
    Global(Moment<'a>),
    /// Slice by slice, ordered by their first lines and by their last lines, without gaps between them.
    ///
    /// Consecutive slices model a rolling shutter. Where slices overlap, the colour of a line is the mean of the
    /// colours at their moments, in linear light: motion blur. Measurements and ground truth are those of the first
    /// slice of a line.
    Slices(&'a [Slice<'a>]),
    /// Each ray at its own time, for sensors whose rays have individual times, such as a
    /// [`Scanner`](crate::scanner::Scanner).
    ///
    /// Contains at least two keyframes in order of time, from the start of the frame (0 s) or before it to its end or
    /// after it. Between two keyframes, the poses of the sensor and of every instance are interpolated by
    /// [`Pose::interpolate`]. If they rotate by less than 0.05 rad between keyframes, this is uniform motion to 1e-6
    /// rad. The steps of a simulation are suitable keyframes.
    Moving(&'a [Keyframe<'a>]),
}

impl<'a, const N: usize> From<&'a [Keyframe<'a>; N]> for Shutter<'a> {
    fn from(keyframes: &'a [Keyframe<'a>; N]) -> Self {
        Self::Moving(keyframes)
    }
}

impl<'a, const N: usize> From<&'a [Slice<'a>; N]> for Shutter<'a> {
    fn from(slices: &'a [Slice<'a>; N]) -> Self {
        Self::Slices(slices)
    }
}

#[cfg(feature = "alloc")]
impl<'a> From<&'a alloc::vec::Vec<Keyframe<'a>>> for Shutter<'a> {
    fn from(keyframes: &'a alloc::vec::Vec<Keyframe<'a>>) -> Self {
        Self::Moving(keyframes)
    }
}

#[cfg(feature = "alloc")]
impl<'a> From<&'a alloc::vec::Vec<Slice<'a>>> for Shutter<'a> {
    fn from(slices: &'a alloc::vec::Vec<Slice<'a>>) -> Self {
        Self::Slices(slices)
    }
}

impl<'a> From<&'a [Keyframe<'a>]> for Shutter<'a> {
    fn from(keyframes: &'a [Keyframe<'a>]) -> Self {
        Self::Moving(keyframes)
    }
}

impl<'a> From<Moment<'a>> for Shutter<'a> {
    fn from(moment: Moment<'a>) -> Self {
        Self::Global(moment)
    }
}

impl<'a> From<&'a [Slice<'a>]> for Shutter<'a> {
    fn from(slices: &'a [Slice<'a>]) -> Self {
        Self::Slices(slices)
    }
}

impl<'a> Shutter<'a> {
    /// The slices; empty for the other kinds of shutter.
    pub(crate) fn slices(&self) -> &'a [Slice<'a>] {
        match *self {
            Self::Global(_) | Self::Moving(_) => &[],
            Self::Slices(slices) => slices,
        }
    }

    /// The indices of the slices that contain any of the given lines.
    pub(crate) fn covering(&self, lines: Range<u32>) -> Range<usize> {
        let slices = self.slices();
        let first = slices.partition_point(|slice| slice.lines.end <= lines.start);
        let end = slices.partition_point(|slice| slice.lines.start < lines.end);
        first..end
    }

    /// Returns true if a line is in more than one slice.
    pub(crate) fn blurs(&self) -> bool {
        self.slices().windows(2).any(|pair| pair[1].lines.start < pair[0].lines.end)
    }
}

/// A frame to be captured: its number and its shutter.
///
/// ```
/// use belvedere_sensors::{Capture, Moment, Pose, Shutter, Slice, glam::DVec3};
/// let still = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &[] };
/// assert_eq!(Capture::new(7, still).frame, 7);
///
/// // A rolling shutter: the sensor turns by 1 mrad from each of 480 rows to the next.
/// let turned = |row: u32| Pose::from_xyz_rpy(DVec3::ZERO, DVec3::Z * (1e-3 * f64::from(row)));
/// let rows: Vec<_> = (0..480)
///     .map(|row| Slice { lines: row..row + 1, at: Moment { world_from_sensor: turned(row), ..still } })
///     .collect();
/// let rolling = Capture::new(8, &rows);
/// assert!(matches!(rolling.shutter, Shutter::Slices(slices) if slices.len() == 480));
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Capture<'a> {
    /// Number of the frame. Noise is a function of seed, sensor, frame and sample.
    pub frame: u64,
    /// The times at which its lines are captured, and the poses at these times.
    pub shutter: Shutter<'a>,
    /// The shutter of the previous frame, for the backward optical flow.
    pub before: Option<Shutter<'a>>,
    /// The shutter of the next frame, for the forward optical flow.
    pub after: Option<Shutter<'a>>,
}

impl<'a> Capture<'a> {
    /// Creates a frame that is captured at one moment, slice by slice, or with moving keyframes.
    pub fn new(frame: u64, shutter: impl Into<Shutter<'a>>) -> Self {
        Self { frame, shutter: shutter.into(), before: None, after: None }
    }

    /// Sets the shutter of the previous frame.
    #[must_use]
    pub fn before(mut self, shutter: impl Into<Shutter<'a>>) -> Self {
        self.before = Some(shutter.into());
        self
    }

    /// Sets the shutter of the next frame.
    #[must_use]
    pub fn after(mut self, shutter: impl Into<Shutter<'a>>) -> Self {
        self.after = Some(shutter.into());
        self
    }
}
