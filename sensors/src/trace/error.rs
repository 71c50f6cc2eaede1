//! Why a frame cannot be taken.

use crate::ParameterError;

/// Why a frame cannot be taken. Nothing is written then.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SenseError {
    /// The grid of rays.
    Grid(ParameterError),
    /// Not 0 ≤ least < most distance.
    Range {
        /// Least distance in metres.
        least: f64,
        /// Greatest.
        most: f64,
    },
    /// An input is not one element a ray.
    Input {
        /// Which.
        parameter: &'static str,
        /// Its elements.
        value: usize,
        /// How many rays there are.
        need: usize,
    },
    /// An output is not as long as the frame.
    Output {
        /// Which.
        parameter: &'static str,
        /// Its elements.
        value: usize,
        /// Elements of the frame.
        need: usize,
    },
    /// An [`AnySensor`](crate::AnySensor) was given the output of another kind of sensor.
    OutputKind {
        /// The kind of the sensor.
        sensor: &'static str,
        /// The kind of sensor that the output is of.
        output: &'static str,
    },
    /// The workspace is too small.
    Workspace {
        /// Its cache lines.
        value: usize,
        /// Those that it takes.
        need: usize,
    },
    /// A moment does not have one pose for each instance of the scene.
    Poses {
        /// How many it has.
        value: usize,
        /// How many instances there are.
        need: usize,
    },
    /// The sensor's pose is NaN or infinite.
    Pose,
    /// A landmark is on an instance that the scene does not have.
    Instance {
        /// Its index.
        value: u32,
        /// How many there are.
        instances: usize,
    },
    /// A flow is wanted, and the capture has no such moment.
    OtherMoment {
        /// Which: `before` or `after`.
        parameter: &'static str,
    },
    /// Flow is wanted of a lidar whose columns are seen at moments of their own.
    FlowOfColumns,
    /// Flow is wanted of a sensor each of whose rays has a time of its own.
    FlowOfFirings,
    /// The sensor's rays have no times of their own, and a [`Shutter::Moving`](crate::Shutter::Moving) is given; or they
    /// have, and slices are.
    Shutter {
        /// What it takes instead.
        rule: &'static str,
    },
    /// Keyframes that are not as a [`Shutter::Moving`](crate::Shutter::Moving) must have them.
    Keyframes {
        /// Which of them.
        keyframe: usize,
        /// What it must.
        rule: &'static str,
    },
    /// Slices of lines that are not as a [`Shutter`](crate::Shutter) must have them.
    Slices {
        /// Which of them.
        slice: usize,
        /// What it must.
        rule: &'static str,
    },
}

impl core::fmt::Display for SenseError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Grid(error) => error.fmt(f),
            Self::Range { least, most } => {
                write!(f, "the range is {least} to {most} m; it must be 0 <= least < most")
            }
            Self::Input { parameter, value, need } => {
                write!(f, "the input {parameter} holds {value} elements; there are {need} rays")
            }
            Self::Output { parameter, value, need } => {
                write!(f, "the output {parameter} holds {value} elements; the frame has {need}")
            }
            Self::OutputKind { sensor, output } => {
                write!(f, "the output is that of a {output}; the sensor is a {sensor}")
            }
            Self::Workspace { value, need } => {
                write!(f, "the workspace is {value} cache lines long; it must be {need} at least")
            }
            Self::Poses { value, need } => write!(
                f,
                "a moment must have one pose for each instance of the scene: it has {value}, and there are {need}"
            ),
            Self::Pose => f.write_str("the sensor's pose must be finite numbers"),
            Self::Instance { value, instances } => {
                write!(f, "a landmark is on instance {value}; the scene has {instances}, counted from 0")
            }
            Self::OtherMoment { parameter } => {
                write!(f, "flow wants a moment to flow to: give the capture `{parameter}`")
            }
            Self::FlowOfColumns => f.write_str(
                "flow is not worked out for a lidar whose columns have moments of their own: give all of the capture's \
                 shutters one moment, or leave `flow` and `flow_back` out",
            ),
            Self::FlowOfFirings => {
                f.write_str("flow is not worked out where each ray has a time of its own: leave `flow` and `flow_back` out")
            }
            Self::Shutter { rule } => write!(f, "the shutter must {rule}"),
            Self::Keyframes { keyframe, rule } => write!(f, "keyframe {keyframe} of the shutter must {rule}"),
            Self::Slices { slice, rule } => write!(f, "slice {slice} of the shutter must {rule}"),
        }
    }
}

impl core::error::Error for SenseError {}

impl From<ParameterError> for SenseError {
    fn from(error: ParameterError) -> Self {
        Self::Grid(error)
    }
}

/// That an output, if there is one, holds `need` elements.
pub(crate) fn check_output(
    parameter: &'static str,
    length: Option<usize>,
    need: usize,
) -> Result<(), SenseError> {
    match length {
        Some(value) if value != need => Err(SenseError::Output { parameter, value, need }),
        _ => Ok(()),
    }
}
