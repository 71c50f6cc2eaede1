//! A sensor of any kind, for lists of different sensors.

use super::Sensor;
use super::camera::{CameraBuf, Picture};
use super::depth::{DepthCameraBuf, DepthFrame};
use super::lidar::{Lidar, Scan};
use super::scanner::{Echoes, ScannerBuf};
use crate::moment::Capture;
use crate::scene::Scene;
use crate::trace::{SenseError, Workspace};

/// A camera, depth camera, lidar or scanner that owns all it needs. An [`Imu`](crate::imu::Imu) is none: it sees no
/// scene.
///
/// ```
/// use belvedere_sensors::{camera::*, lidar::*, optics::PinholeGrid, scene::SceneBuilder, trace::WorkspaceBuf};
/// use belvedere_sensors::{AnyOutput, AnySensor, Capture, Pose, Sensor};
/// let camera = Camera::new(CameraConfig::new(PinholeGrid::from_fov(8, 6, 1.0)?))?;
/// let sensors: Vec<AnySensor> = vec![camera.into(), Lidar::new(LidarConfig::new(Beams::turn(36)))?.into()];
///
/// let world = SceneBuilder::new();
/// let (scene, capture) = (world.scene(), Capture::new(0, world.moment(Pose::IDENTITY)));
/// let mut workspace = WorkspaceBuf::default();
/// let (mut pixels, mut ranges) = (vec![0; 8 * 6 * 3], vec![0.0; 36]);
/// for sensor in &sensors {
///     let output: AnyOutput = match sensor {
///         AnySensor::Camera(_) => Picture::new().colour(&mut pixels).into(),
///         AnySensor::Lidar(_) => Scan::new().ranges(&mut ranges).into(),
///         AnySensor::Depth(_) | AnySensor::Scanner(_) => continue,
///     };
///     sensor.sense_in(&mut workspace, &scene, &capture, output)?;
/// }
/// assert!(pixels.iter().all(|value| *value == 179) && ranges.iter().all(|range| range.is_infinite()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
#[allow(
    clippy::large_enum_variant,
    reason = "the kinds differ by less than a kilobyte, and lists of sensors are short"
)]
pub enum AnySensor {
    /// A colour camera, which fills a [`Picture`].
    Camera(CameraBuf),
    /// A depth camera, which fills a [`DepthFrame`].
    Depth(DepthCameraBuf),
    /// A lidar with a regular grid of beams, which fills a [`Scan`].
    Lidar(Lidar),
    /// A lidar with an arbitrary firing pattern, which fills [`Echoes`].
    Scanner(ScannerBuf),
}

/// The output buffers of a frame of an [`AnySensor`]; the variant must match the kind of sensor.
#[derive(Debug)]
pub enum AnyOutput<'a> {
    /// The output of an [`AnySensor::Camera`].
    Camera(Picture<'a>),
    /// The output of an [`AnySensor::Depth`].
    Depth(DepthFrame<'a>),
    /// The output of an [`AnySensor::Lidar`].
    Lidar(Scan<'a>),
    /// The output of an [`AnySensor::Scanner`].
    Scanner(Echoes<'a>),
}

impl Sensor for AnySensor {
    type Output<'a> = AnyOutput<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        match self {
            Self::Camera(camera) => camera.workspace_len(scene, capture),
            Self::Depth(camera) => camera.workspace_len(scene, capture),
            Self::Lidar(lidar) => lidar.workspace_len(scene, capture),
            Self::Scanner(scanner) => scanner.workspace_len(scene, capture),
        }
    }

    /// Takes a frame.
    ///
    /// # Errors
    /// [`SenseError::OutputKind`] if the output belongs to another kind of sensor; otherwise the errors of the sensor.
    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: AnyOutput<'_>,
    ) -> Result<(), SenseError> {
        match (self, output) {
            (Self::Camera(camera), AnyOutput::Camera(output)) => {
                camera.sense(scene, capture, workspace, output)
            }
            (Self::Depth(camera), AnyOutput::Depth(output)) => {
                camera.sense(scene, capture, workspace, output)
            }
            (Self::Lidar(lidar), AnyOutput::Lidar(output)) => lidar.sense(scene, capture, workspace, output),
            (Self::Scanner(scanner), AnyOutput::Scanner(output)) => {
                scanner.sense(scene, capture, workspace, output)
            }
            (sensor, output) => Err(SenseError::OutputKind { sensor: sensor.kind(), output: output.kind() }),
        }
    }
}

impl AnySensor {
    fn kind(&self) -> &'static str {
        match self {
            Self::Camera(_) => "camera",
            Self::Depth(_) => "depth camera",
            Self::Lidar(_) => "lidar",
            Self::Scanner(_) => "scanner",
        }
    }
}

impl AnyOutput<'_> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Camera(_) => "camera",
            Self::Depth(_) => "depth camera",
            Self::Lidar(_) => "lidar",
            Self::Scanner(_) => "scanner",
        }
    }
}

/// Implements `From` for [`AnySensor`] from each sensor (by value), and for [`AnyOutput`] from each output.
macro_rules! from {
    ($($sensor:ty, $value:ident => $kind:ident($owned:expr), $output:ident;)*) => {$(
        impl From<$sensor> for AnySensor {
            fn from($value: $sensor) -> Self {
                Self::$kind($owned)
            }
        }

        impl<'a> From<$output<'a>> for AnyOutput<'a> {
            fn from(output: $output<'a>) -> Self {
                Self::$kind(output)
            }
        }
    )*};
}

from! {
    super::camera::Camera<'_>, camera => Camera(camera.to_buf()), Picture;
    super::depth::DepthCamera<'_>, camera => Depth(camera.to_buf()), DepthFrame;
    Lidar, lidar => Lidar(lidar), Scan;
    super::scanner::Scanner<'_>, scanner => Scanner(scanner.to_buf()), Echoes;
}
