//! Sensors that own the tables that their configurations borrow.

use super::Sensor;
use super::camera::{Camera, Picture};
use super::depth::{DepthCamera, DepthFrame};
use super::scanner::{
    Echoes, Firing, Laser, Mems, MirrorAxis, Pattern, Prisms, Scanner, Spinning, Spread, Wheels, WheelsBuf,
};
use crate::moment::Capture;
use crate::optics::{Optics, RayTableBuf, SphericalGrid};
use crate::scene::Scene;
use crate::trace::{SenseError, Workspace};
use alloc::vec::Vec;

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

/// A [`DepthCamera`] that owns its ray table, created by [`DepthCamera::to_buf`].
#[derive(Debug, Clone)]
pub struct DepthCameraBuf {
    /// Its optics are a placeholder if they have a table, so that nothing is borrowed.
    camera: DepthCamera<'static>,
    table: Option<RayTableBuf>,
}

/// A [`Scanner`] that owns its lasers, wheels, firings and spreads, created by [`Scanner::to_buf`].
///
/// ```
/// use belvedere_sensors::scanner::{Columns, Laser, Pattern, Scanner, ScannerBuf, ScannerConfig, Spinning};
/// fn head(lasers: u32) -> Result<ScannerBuf, Box<dyn std::error::Error>> {
///     let lasers: Vec<_> = (0..lasers).map(|laser| Laser::at_degrees(f64::from(laser), 0.0)).collect();
///     let columns = Columns::Turn { per_turn: 360, first: 0, count: 360 };
///     let head = Spinning { lasers: &lasers, columns, first_azimuth_rad: 0.0, clockwise: false };
///     Ok(Scanner::new(ScannerConfig::new(Pattern::Spinning(head)))?.to_buf())
/// }
/// assert_eq!(head(16)?.scanner().firings(0), 16 * 360);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScannerBuf {
    /// Its pattern is an empty placeholder, so that nothing is borrowed.
    scanner: Scanner<'static>,
    pattern: PatternBuf,
    spreads: Vec<Spread>,
}

/// Splits optics into a part that borrows nothing and a copy of the table, if there is one.
fn own_optics(optics: &Optics<'_>) -> (Optics<'static>, Option<RayTableBuf>) {
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
fn lend_optics<'a>(optics: &Optics<'static>, table: Option<&'a RayTableBuf>) -> Optics<'a> {
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

impl DepthCamera<'_> {
    /// Returns the same camera with its own copy of the ray table.
    pub fn to_buf(&self) -> DepthCameraBuf {
        let (optics, table) = own_optics(&self.camera().config().optics);
        DepthCameraBuf { camera: self.with_optics(&optics), table }
    }
}

impl DepthCameraBuf {
    /// Returns the camera. This copies some hundred bytes, but checks and allocates nothing.
    pub fn camera(&self) -> DepthCamera<'_> {
        self.camera.with_optics(&lend_optics(&self.camera.camera().config().optics, self.table.as_ref()))
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

impl Sensor for DepthCameraBuf {
    type Output<'a> = DepthFrame<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        self.camera().workspace_len(scene, capture)
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: DepthFrame<'_>,
    ) -> Result<(), SenseError> {
        self.camera().sense(scene, capture, workspace, output)
    }
}

/// A [`Pattern`] that owns its tables.
#[derive(Debug, Clone)]
enum PatternBuf {
    /// A pattern that borrows nothing.
    Plain(Pattern<'static>),
    Spinning(Spinning<'static>, Vec<Laser>),
    Prisms {
        prisms: Prisms<'static>,
        lasers_rad: Vec<f64>,
        wheels: WheelsBuf,
    },
    Mems(Mems<'static>, [MirrorAxis; 2]),
    Table(Vec<Firing>),
}

const STILL: [MirrorAxis; 2] = [MirrorAxis::STILL; 2];

impl PatternBuf {
    fn copy_of(pattern: &Pattern<'_>) -> Self {
        match *pattern {
            Pattern::Rosette(rosette) => Self::Plain(Pattern::Rosette(rosette)),
            Pattern::Raster(raster) => Self::Plain(Pattern::Raster(raster)),
            Pattern::Spinning(Spinning { lasers, columns, first_azimuth_rad, clockwise }) => Self::Spinning(
                Spinning { lasers: &[], columns, first_azimuth_rad, clockwise },
                lasers.to_vec(),
            ),
            Pattern::Prisms(Prisms { volley_time_ns, laser_time_ns, axis, lasers_rad, wheels }) => {
                Self::Prisms {
                    prisms: Prisms {
                        volley_time_ns,
                        laser_time_ns,
                        axis,
                        lasers_rad: &[],
                        wheels: Wheels::new(&[]),
                    },
                    lasers_rad: lasers_rad.to_vec(),
                    wheels: WheelsBuf::copy_of(&wheels),
                }
            }
            Pattern::Mems(Mems { firing_time_ns, incidence_rad, axes }) => {
                Self::Mems(Mems { firing_time_ns, incidence_rad, axes: &STILL }, *axes)
            }
            Pattern::Table(firings) => Self::Table(firings.to_vec()),
        }
    }

    /// Returns the pattern with its tables.
    fn lend(&self) -> Pattern<'_> {
        match self {
            Self::Plain(pattern) => *pattern,
            Self::Spinning(spinning, lasers) => Pattern::Spinning(Spinning { lasers, ..*spinning }),
            Self::Prisms { prisms, lasers_rad, wheels } => {
                Pattern::Prisms(Prisms { lasers_rad, wheels: Wheels::owned(wheels), ..*prisms })
            }
            Self::Mems(mems, axes) => Pattern::Mems(Mems { axes, ..*mems }),
            Self::Table(firings) => Pattern::Table(firings),
        }
    }
}

impl Scanner<'_> {
    /// Returns the same scanner with its own copies of lasers, wheels, firings and spreads.
    pub fn to_buf(&self) -> ScannerBuf {
        let nothing = Pattern::Table(&[]);
        ScannerBuf {
            scanner: self.with_tables(nothing, &[]),
            pattern: PatternBuf::copy_of(&self.config().pattern),
            spreads: self.config().spreads.to_vec(),
        }
    }
}

impl ScannerBuf {
    /// Returns the scanner. This copies some hundred bytes, but checks and allocates nothing.
    pub fn scanner(&self) -> Scanner<'_> {
        self.scanner.with_tables(self.pattern.lend(), &self.spreads)
    }
}

impl Sensor for ScannerBuf {
    type Output<'a> = Echoes<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        self.scanner().workspace_len(scene, capture)
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Echoes<'_>,
    ) -> Result<(), SenseError> {
        self.scanner().sense(scene, capture, workspace, output)
    }
}
