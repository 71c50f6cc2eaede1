//! The sensors: what a device makes of a frame.
//!
//! A configuration is checked once, and makes a [`Sensor`]; each of its frames goes into memory of the caller's.

pub mod camera;
pub mod depth;
pub(crate) mod edges;
pub mod imu;
pub mod lidar;
pub(crate) mod pixel;
pub mod scanner;

use crate::moment::Capture;
use crate::scene::Scene;
use crate::trace::{SenseError, Workspace};

/// What takes frames of a scene.
///
/// ```
/// use belvedere_sensors::{camera::*, lidar::*, optics::PinholeGrid, scene::*, trace::*, Capture, Pose, Sensor};
/// /// Any sensor's frame, with memory that grows once.
/// fn take<T: Sensor>(sensor: &T, builder: &SceneBuilder, memory: &mut WorkspaceBuf, output: T::Output<'_>) {
///     let scene = builder.scene();
///     let capture = Capture::new(0, builder.moment(Pose::IDENTITY));
///     let workspace = &mut memory.lend(sensor.workspace_len(&scene, &capture));
///     sensor.sense(&scene, &capture, workspace, output).expect("outputs of the frame's size");
/// }
/// let mut builder = SceneBuilder::new();
/// let material = builder.add_material(&MaterialConfig::default())?;
/// builder.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     world_from_instance: Pose::from_translation(glam::DVec3::X * 2.0),
///     material,
///     ..Default::default()
/// })?;
/// let mut memory = WorkspaceBuf::default();
///
/// let lidar = Lidar::new(LidarConfig::new(Beams::ONE))?;
/// let mut ranges = [0.0];
/// take(&lidar, &builder, &mut memory, Scan::new().ranges(&mut ranges));
/// assert_eq!(ranges, [1.5]);
///
/// let camera = Camera::new(CameraConfig::new(PinholeGrid::from_fov(64, 48, 1.0)?))?;
/// let mut pixels = vec![0; camera.frame_len()];
/// take(&camera, &builder, &mut memory, Picture::new().colour(&mut pixels));
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

    /// Takes a frame.
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
}
