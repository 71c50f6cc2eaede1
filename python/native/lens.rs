//! Lenses, which give the directions of a camera's rays.

use crate::errors::of;
use belvedere_sensors::ParameterError;
use belvedere_sensors::optics::{
    BrownConrady, DoubleSphere, Equirectangular, Eucm, Intrinsics, KannalaBrandt, Lens, Mei, Optics, Pinhole,
    PinholeGrid, RayTableBuf,
};
use pyo3::PyResult;

/// The rays of a camera, in owned memory.
pub(crate) enum Rays {
    Pinhole(PinholeGrid),
    Table(Box<RayTableBuf>),
}

impl Rays {
    /// Creates the rays of a lens by its name; the numbers are fx, fy, cx, cy, skew, followed by those of the model.
    pub(crate) fn new(width: u32, height: u32, lens: &str, numbers: &[f64]) -> PyResult<Self> {
        let (_, own) = MODELS.iter().find(|(name, _)| *name == lens).ok_or_else(|| {
            let names = MODELS.map(|(name, _)| name).join(", ");
            of("lens", format_args!("there is no model {lens:?}; there are {names}"))
        })?;
        let wrong = || {
            let own = if own.is_empty() { String::new() } else { format!(" {own}") };
            let count = numbers.len();
            of("lens", format_args!("{lens}: fx fy cx cy skew{own} are expected, not {count} numbers"))
        };
        let &[fx, fy, cx, cy, skew, ref model @ ..] = numbers else { return Err(wrong()) };
        let intrinsics = Intrinsics { fx, fy, cx, cy, skew };
        match named(lens, intrinsics, model).map_err(|error| of("lens", error))?.ok_or_else(wrong)? {
            Named::Pinhole => {
                let grid =
                    Pinhole::new(intrinsics).and_then(|pinhole| PinholeGrid::new(width, height, pinhole));
                grid.map(Self::Pinhole).map_err(|error| of("lens", error))
            }
            Named::Lens(lens) => {
                let table =
                    RayTableBuf::from_lens(width, height, &*lens).map_err(|error| of("lens", error))?;
                Ok(Self::Table(Box::new(table)))
            }
        }
    }

    /// Creates the rays of a pinhole with square pixels, from the horizontal field of view in radians.
    pub(crate) fn from_fov(width: u32, height: u32, fov: f64) -> PyResult<Self> {
        PinholeGrid::from_fov(width, height, fov).map(Self::Pinhole).map_err(|error| of("fov", error))
    }

    /// Borrows the rays for a sensor.
    pub(crate) fn optics(&self) -> Optics<'_> {
        match self {
            Self::Pinhole(grid) => Optics::Pinhole(*grid),
            Self::Table(table) => Optics::Table(table.table()),
        }
    }

    /// Returns the horizontal focal length in pixels, which depth models need, if the lens is a pinhole.
    pub(crate) fn focal_px(&self) -> Option<f64> {
        match self {
            Self::Pinhole(grid) => Some(grid.intrinsics().fx),
            Self::Table(_) => None,
        }
    }
}

/// The models by name, with their parameters besides fx, fy, cx, cy and skew.
const MODELS: [(&str, &str); 7] = [
    ("pinhole", ""),
    ("brown_conrady", "k1 k2 p1 p2 …"),
    ("kannala_brandt", "k1 k2 k3 k4"),
    ("eucm", "alpha beta"),
    ("double_sphere", "xi alpha"),
    ("mei", "xi k1 k2 p1 p2"),
    ("equirectangular", ""),
];

enum Named {
    /// A pinhole without skew, which needs no table.
    Pinhole,
    Lens(Box<dyn Lens>),
}

/// Returns the model of a lens; `None` if the number of parameters is wrong.
fn named(name: &str, intrinsics: Intrinsics, numbers: &[f64]) -> Result<Option<Named>, ParameterError> {
    Ok(Some(Named::Lens(match (name, numbers) {
        ("pinhole", []) if intrinsics.skew == 0.0 => return Ok(Some(Named::Pinhole)),
        ("pinhole", []) => Box::new(Pinhole::new(intrinsics)?),
        ("brown_conrady", coefficients) => Box::new(BrownConrady::new(intrinsics, coefficients)?),
        ("kannala_brandt", &[k1, k2, k3, k4]) => Box::new(KannalaBrandt::new(intrinsics, [k1, k2, k3, k4])?),
        ("eucm", &[alpha, beta]) => Box::new(Eucm::new(intrinsics, alpha, beta)?),
        ("double_sphere", &[xi, alpha]) => Box::new(DoubleSphere::new(intrinsics, xi, alpha)?),
        ("mei", &[xi, k1, k2, p1, p2]) => Box::new(Mei::new(intrinsics, xi, [k1, k2, p1, p2])?),
        ("equirectangular", []) => Box::new(Equirectangular::with_intrinsics(intrinsics)?),
        _ => return Ok(None),
    })))
}
