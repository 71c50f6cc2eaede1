//! A camera that owns the ray table that its configuration borrows.

use super::{Camera, Picture};
use crate::moment::Capture;
use crate::optics::{Optics, RayTableBuf, SphericalGrid};
use crate::scene::Scene;
use crate::sensor::Sensor;
use crate::trace::{SenseError, Workspace};

/// A [`Camera`] that owns its ray table, created by [`Camera::to_buf`]. It allows a struct to own a fisheye camera.
///
/// ```
/// use belvedere_sensors::{camera::*, optics::*, scene::SceneBuilder, trace::WorkspaceBuf, Capture, Pose, Sensor};
/// struct Robot {
///     fisheye: CameraBuf,
/// }
/// let intrinsics = Intrinsics { fx: 20.0, fy: 20.0, cx: 31.5, cy: 23.5, skew: 0.0 };
/// let table = RayTableBuf::from_lens(64, 48, &KannalaBrandt::new(intrinsics, [0.0; 4])?)?;
/// let robot = Robot { fisheye: Camera::new(CameraConfig::new(&table))?.to_buf() };
/// drop(table);
///
/// let world = SceneBuilder::new();
/// let capture = Capture::new(0, world.moment(Pose::IDENTITY));
/// let mut pixels = vec![0; robot.fisheye.camera().frame_len()];
/// let picture = Picture::new().colour(&mut pixels);
/// robot.fisheye.sense_in(&mut WorkspaceBuf::default(), &world.scene(), &capture, picture)?;
/// assert_eq!(pixels, [179; 64 * 48 * 3]); // nothing but the background
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CameraBuf {
    /// Its optics are a placeholder if they have a table, so that nothing is borrowed.
    camera: Camera<'static>,
    table: Option<RayTableBuf>,
}

/// Splits optics into a part that borrows nothing and a copy of the table, if there is one.
pub(in crate::sensor) fn own_optics(optics: &Optics<'_>) -> (Optics<'static>, Option<RayTableBuf>) {
    match optics {
        Optics::Pinhole(grid) => (Optics::Pinhole(*grid), None),
        Optics::Spherical(grid) => (Optics::Spherical(*grid), None),
        Optics::Table(table) => {
            let placeholder = SphericalGrid {
                columns: 1,
                rows: 1,
                first_azimuth_rad: 0.0,
                azimuth_step_rad: 0.0,
                first_elevation_rad: 0.0,
                elevation_step_rad: 0.0,
            };
            (Optics::Spherical(placeholder), Some(RayTableBuf::copy_of(table)))
        }
    }
}

/// Puts together the optics that [`own_optics`] split.
pub(in crate::sensor) fn lend_optics<'a>(
    optics: &Optics<'static>,
    table: Option<&'a RayTableBuf>,
) -> Optics<'a> {
    table.map_or(*optics, Optics::from)
}

impl Camera<'_> {
    /// Returns the same camera with its own copy of the ray table.
    pub fn to_buf(&self) -> CameraBuf {
        let (optics, table) = own_optics(&self.config().optics);
        CameraBuf { camera: self.with_optics(&optics), table }
    }
}

impl CameraBuf {
    /// Returns the camera. This copies some hundred bytes, but checks and allocates nothing.
    pub fn camera(&self) -> Camera<'_> {
        self.camera.with_optics(&lend_optics(&self.camera.config().optics, self.table.as_ref()))
    }
}

impl Sensor for CameraBuf {
    type Output<'a> = Picture<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        self.camera().workspace_len(scene, capture)
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Picture<'_>,
    ) -> Result<(), SenseError> {
        self.camera().sense(scene, capture, workspace, output)
    }
}
