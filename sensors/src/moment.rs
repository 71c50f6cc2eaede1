//! Where everything is, and when: what a [`Scene`](crate::scene::Scene) leaves open.

use crate::pose::Pose;
use core::ops::Range;

/// Where the sensor and all instances are at one moment.
///
/// A scene holds shapes and looks, and no poses, so that one scene can be seen at many moments: those of a rolling
/// shutter, or the last frame's.
///
/// ```
/// use belvedere_sensors::{Moment, Pose, scene::*};
/// let mut builder = SceneBuilder::new();
/// let material = builder.add_material(&MaterialConfig::default())?;
/// builder.add_instance(&InstanceConfig { material, ..Default::default() })?;
/// // The poses that the builder keeps …
/// let now = builder.moment(Pose::IDENTITY);
/// // … or others.
/// let moved = [Pose::from_translation(glam::DVec3::X * 2.0)];
/// let later = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &moved };
/// assert_eq!(now.world_from_instance[0].translation().x, 0.0);
/// assert_eq!(later.world_from_instance[0].translation().x, 2.0);
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// Where the sensor is. It looks along +x; z is up.
    pub world_from_sensor: Pose,
    /// Where each instance of the scene is, by its index: as many as the scene has instances. One whose pose is not
    /// finite is nowhere, and seen by nobody.
    pub world_from_instance: &'a [Pose],
}

/// Some lines of a frame, and the moment at which they are taken.
///
/// Lines are rows of a picture, from its top. Of a lidar they are what its [`Sweep`](crate::lidar::Sweep) says: columns of
/// one that turns, from the first beam of the scan lines, or scan lines.
///
/// Each slice places all instances of the scene anew and walks its trees once, and rays are traced in blocks of sixteen
/// columns. A [`Lidar`](crate::lidar::Lidar) is therefore fast with slices of sixteen columns or more. In a hall with 48
/// things, a scan took so many times as long as at one moment (x86-64 with AVX2):
///
/// | columns in a slice | 720 × 1 beams | 1800 × 16 beams | 1024 × 128 beams |
/// |---:|---:|---:|---:|
/// | 1 | 89 | 36 | 8 |
/// | 4 | 23 | 10 | 2.4 |
/// | 16 | 6 | 3 | 1.4 |
/// | 64 | 2.4 | 1.6 | 1.1 |
///
/// A [`Scanner`](crate::scanner::Scanner) with a [moving](Shutter::Moving) shutter gives each firing a time of its own without
/// slices.
#[derive(Debug, Clone)]
pub struct Slice<'a> {
    /// Which lines.
    pub lines: Range<u32>,
    /// Where everything is then.
    pub at: Moment<'a>,
}

/// A moment, and when in a frame it is.
#[derive(Debug, Clone, Copy)]
pub struct Keyframe<'a> {
    /// Seconds after the frame's beginning.
    pub time_s: f64,
    /// Where everything is then.
    pub at: Moment<'a>,
}

/// When the lines of a frame are taken.
#[derive(Debug, Clone, Copy)]
pub enum Shutter<'a> {
    /// All at one moment.
    Global(Moment<'a>),
    /// Slice by slice, in the order of their first lines and of their last, without a line between them that none has.
    ///
    /// Slices that follow each other are a rolling shutter. Where slices overlap, the colour of a line is the mean of
    /// what is seen at their moments, in linear light: motion blur. What is measured or told as truth is that of the
    /// first slice of a line.
    Slices(&'a [Slice<'a>]),
    /// Every ray at a time of its own: for sensors whose rays have one, those of a
    /// [`Scanner`](crate::scanner::Scanner).
    ///
    /// Two keyframes or more in the order of their times, from the frame's beginning, 0 s, or before, to its end or after.
    /// Between two, the sensor and every instance go as [`Pose::interpolate`] has it: where they turn by less than
    /// 0.05 rad from one to the next, that is even motion to 1e-6 rad. The steps of a simulation are such moments.
    Moving(&'a [Keyframe<'a>]),
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
    /// The slices; none if all is taken at one moment, or each ray at its own.
    pub(crate) fn slices(&self) -> &'a [Slice<'a>] {
        match *self {
            Self::Global(_) | Self::Moving(_) => &[],
            Self::Slices(slices) => slices,
        }
    }

    /// Which slices have one of these lines.
    pub(crate) fn covering(&self, lines: Range<u32>) -> Range<usize> {
        let slices = self.slices();
        let first = slices.partition_point(|slice| slice.lines.end <= lines.start);
        let end = slices.partition_point(|slice| slice.lines.start < lines.end);
        first..end
    }

    /// Whether a line is in more than one slice.
    pub(crate) fn blurs(&self) -> bool {
        self.slices().windows(2).any(|pair| pair[1].lines.start < pair[0].lines.end)
    }
}

/// A frame to be taken: its number, and when it is taken.
///
/// ```
/// use belvedere_sensors::{Capture, Moment, Pose, Shutter, Slice};
/// let still = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &[] };
/// assert_eq!(Capture::new(7, still).frame, 7);
///
/// // A rolling shutter: the sensor turns by 1 mrad from each of 480 rows to the next.
/// let turned = |row: u32| Pose::from_xyz_rpy(glam::DVec3::ZERO, glam::DVec3::Z * (1e-3 * f64::from(row)));
/// let rows: Vec<_> = (0..480)
///     .map(|row| Slice { lines: row..row + 1, at: Moment { world_from_sensor: turned(row), ..still } })
///     .collect();
/// let rolling = Capture::new(8, rows.as_slice());
/// assert!(matches!(rolling.shutter, Shutter::Slices(slices) if slices.len() == 480));
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Capture<'a> {
    /// Number of the frame. Noise is a function of seed, sensor, frame and sample.
    pub frame: u64,
    /// When its lines are taken, and where everything is then.
    pub shutter: Shutter<'a>,
    /// The frame before, for the flow back to it.
    pub before: Option<Shutter<'a>>,
    /// The frame after, for the flow to it.
    pub after: Option<Shutter<'a>>,
}

impl<'a> Capture<'a> {
    /// A frame that is taken at one moment, or slice by slice.
    pub fn new(frame: u64, shutter: impl Into<Shutter<'a>>) -> Self {
        Self { frame, shutter: shutter.into(), before: None, after: None }
    }

    /// Sets when the frame before was taken.
    #[must_use]
    pub fn before(mut self, shutter: impl Into<Shutter<'a>>) -> Self {
        self.before = Some(shutter.into());
        self
    }

    /// Sets when the frame after is taken.
    #[must_use]
    pub fn after(mut self, shutter: impl Into<Shutter<'a>>) -> Self {
        self.after = Some(shutter.into());
        self
    }
}
