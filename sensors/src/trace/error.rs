//! The errors of taking a frame.

use crate::ParameterError;

/// The reason why a frame cannot be taken. Nothing is written in that case.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SenseError {
    /// A parameter of the optics is invalid.
    Grid(ParameterError),
    /// The distances are not 0 ≤ least < most.
    Range {
        /// The least distance in metres.
        least: f64,
        /// The greatest distance in metres.
        most: f64,
    },
    /// An input does not have one element per ray.
    Input {
        /// The name of the input.
        parameter: &'static str,
        /// Its number of elements.
        value: usize,
        /// The number of rays.
        need: usize,
    },
    /// An output is not as long as the frame.
    Output {
        /// The name of the output.
        parameter: &'static str,
        /// Its number of elements.
        value: usize,
        /// The number of elements of the frame.
        need: usize,
    },
    /// An [`AnySensor`](crate::AnySensor) was given the output of another kind of sensor.
    OutputKind {
        /// The kind of the sensor.
        sensor: &'static str,
        /// The kind of sensor to which the output belongs.
        output: &'static str,
    },
    /// The workspace is too small.
    Workspace {
        /// The number of cache lines that it has.
        value: usize,
        /// The number of cache lines that the frame needs.
        need: usize,
    },
    /// A moment does not have exactly one pose per instance of the scene.
    Poses {
        /// The number of poses that it has.
        value: usize,
        /// The number of instances.
        need: usize,
    },
    /// The sensor's pose is NaN or infinite.
    Pose,
    /// A landmark refers to an instance that the scene does not have.
    Instance {
        /// The index of the instance.
        value: u32,
        /// The number of instances of the scene.
        instances: usize,
    },
    /// Flow is requested, but the capture lacks the moment for it.
    OtherMoment {
        /// The missing moment: `before` or `after`.
        parameter: &'static str,
    },
    /// Flow is requested of a lidar whose columns are seen at different moments.
    FlowOfColumns,
    /// Flow is requested of a sensor whose rays have different times.
    FlowOfFirings,
    /// The kind of shutter does not suit the sensor: a [`Shutter::Moving`](crate::Shutter::Moving) is given to a sensor
    /// whose rays do not have individual times, or slices to one whose rays do.
    Shutter {
        /// The rule that the shutter must follow.
        rule: &'static str,
    },
    /// The keyframes of a [`Shutter::Moving`](crate::Shutter::Moving) are invalid.
    Keyframes {
        /// The index of the invalid or missing keyframe.
        keyframe: usize,
        /// The rule that the keyframe must follow.
        rule: &'static str,
    },
    /// The slices of a [`Shutter`](crate::Shutter) are invalid.
    Slices {
        /// The index of the invalid or missing slice.
        slice: usize,
        /// The rule that the slice must follow.
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
                write!(f, "flow needs a second moment: set `{parameter}` of the capture")
            }
            Self::FlowOfColumns => f.write_str(
                "flow is not computed for a lidar whose columns are captured at different moments: give all of the \
                 capture's shutters one moment, or leave `flow` and `flow_back` out",
            ),
            Self::FlowOfFirings => f.write_str(
                "flow is not computed for sensors whose rays have individual times: leave `flow` and `flow_back` out",
            ),
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

/// Checks that an output, if there is one, has `need` elements.
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
