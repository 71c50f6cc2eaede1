//! The sensors: cameras, depth cameras, lidars and inertial measurement units.
//!
//! A configuration is checked once and becomes a [`Sensor`]. Each of its frames is written to memory that the caller
//! provides.

#[cfg(feature = "alloc")]
pub(crate) mod any;
pub mod camera;
pub mod depth;
pub(crate) mod edges;
pub mod imu;
pub mod lidar;
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
/// The trait is not object-safe because each sensor has its own type of output. For a list of different sensors use a
/// `Vec` of [`AnySensor`](crate::AnySensor).
///
/// ```
/// use belvedere_sensors::{camera::*, lidar::*, optics::PinholeGrid, scene::*, trace::*, Capture, Pose, Sensor};
/// let mut world = SceneBuilder::new();
/// world.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     world_from_instance: Pose::from_translation(belvedere_sensors::glam::DVec3::X * 2.0),
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
    /// The output buffers of a frame: slices that the caller provides. Each of them is optional; parts without a buffer
    /// are not computed.
    type Output<'a>;

    /// Returns the number of cache lines of [`Workspace`] memory that a frame needs.
    ///
    /// It depends on the number of instances in the scene, on the number of slices of the shutter, and on how these
    /// slices divide the lines and overlap. While none of that changes, all frames of a sensor need the same amount.
    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize;

    /// Takes a frame without allocating. Where a heap is available, [`Sensor::sense_in`] is shorter.
    ///
    /// # Errors
    /// Fails if the output buffers, the workspace, the moments or the slices do not fit the frame. Nothing is written
    /// in that case.
    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Self::Output<'_>,
    ) -> Result<(), SenseError>;

    /// Takes a frame in a workspace that grows to the size that the frame needs and is reused by later frames.
    ///
    /// # Errors
    /// Fails if the output buffers, the moments or the slices do not fit the frame. Nothing is written in that case.
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
