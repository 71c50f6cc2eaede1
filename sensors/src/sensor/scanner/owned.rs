//! A scanner that owns the tables that its configuration borrows.

use super::{
    Echoes, Firing, Laser, Mems, MirrorAxis, Pattern, Prisms, Scanner, Spinning, Spread, Wheels, WheelsBuf,
};
use crate::moment::Capture;
use crate::scene::Scene;
use crate::sensor::Sensor;
use crate::trace::{SenseError, Workspace};
use alloc::vec::Vec;

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
