//! The sensors: what a device makes of a frame.
//!
//! A configuration is checked once, and makes a [`Sensor`]; each of its frames goes into memory of the caller's.

#[cfg(feature = "alloc")]
pub(crate) mod any;
pub mod camera;
pub mod depth;
pub(crate) mod edges;
pub mod imu;
pub mod lidar;
#[cfg(feature = "alloc")]
pub(crate) mod owned;
pub(crate) mod pixel;
pub mod scanner;

use crate::moment::Capture;
use crate::scene::Scene;
#[cfg(feature = "alloc")]
use crate::trace::WorkspaceBuf;
use crate::trace::{SenseError, Workspace};

/// A sensor that takes frames of a scene: [`Camera`](camera::Camera), [`DepthCamera`](depth::DepthCamera),
/// [`Lidar`](lidar::Lidar), [`Scanner`](scanner::Scanner).
///
/// The trait is not object-safe, as each sensor has outputs of its own. A list of different sensors is a
/// `Vec` of [`AnySensor`](crate::AnySensor).
///
/// ```
/// use belvedere_sensors::{camera::*, lidar::*, optics::PinholeGrid, scene::*, trace::*, Capture, Pose, Sensor};
/// let mut world = SceneBuilder::new();
/// world.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     world_from_instance: Pose::from_translation(glam::DVec3::X * 2.0),
///     ..Default::default()
/// })?;
/// let (scene, capture) = (world.scene(), Capture::new(0, world.moment(Pose::IDENTITY)));
/// let mut workspace = WorkspaceBuf::default(); // allocates when a frame needs more memory than any before
///
/// let lidar = Lidar::new(LidarConfig::new(Beams::ONE))?;
/// let mut ranges = [0.0];
/// lidar.sense_in(&mut workspace, &scene, &capture, Scan::new().ranges(&mut ranges))?;
/// assert_eq!(ranges, [1.5]);
///
/// let camera = Camera::new(CameraConfig::new(PinholeGrid::from_fov(64, 48, 1.0)?))?;
/// let mut pixels = vec![0; camera.frame_len()];
/// camera.sense_in(&mut workspace, &scene, &capture, Picture::new().colour(&mut pixels))?;
/// assert_eq!(pixels[..3], [179; 3]); // the background
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Sensor {
    /// Where the parts of a frame go: slices of the caller's, each of which may be left out; what is left out is not
    /// worked out.
    type Output<'a>;

    /// Cache lines of a [`Workspace`] that a frame takes. Frames of one sensor need the same if the scene has as many
    /// instances and the shutter as many slices, that are cut and overlap alike.
    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize;

    /// Takes a frame, and allocates nothing. [`Sensor::sense_in`] is shorter where there is a heap.
    ///
    /// # Errors
    /// When the output, the workspace, the moments or the slices are not as the frame needs them. Nothing is written
    /// then.
    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Self::Output<'_>,
    ) -> Result<(), SenseError>;

    /// Takes a frame in a workspace that grows to what the frame needs, and keeps it for the next ones.
    ///
    /// # Errors
    /// When the output, the moments or the slices are not as the frame needs them. Nothing is written then.
    #[cfg(feature = "alloc")]
    fn sense_in(
        &self,
        workspace: &mut WorkspaceBuf,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        output: Self::Output<'_>,
    ) -> Result<(), SenseError> {
        self.sense(scene, capture, &mut workspace.lend(self.workspace_len(scene, capture)), output)
    }
}
