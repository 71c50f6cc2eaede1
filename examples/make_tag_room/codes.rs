//! The codes on the ceiling: AprilTags of family 36h11 and QR codes, with their contents and modules.

use qrcode::types::{Color, QrError};
use qrcode::{EcLevel, QrCode, Version};

/// Bits of the first tags of family 36h11, six rows of six from the top left, most significant first; 1 is white.
/// (E. Olson, "AprilTag: A robust and flexible visual fiducial system", ICRA 2011; J. Wang and E. Olson, IROS 2016.)
const TAG_36H11: [u64; 32] = [
    0xd_5d62_8584,
    0xd_97f1_8b49,
    0xd_d280_910e,
    0xe_479e_9c98,
    0xe_bcbc_a822,
    0xf_31da_b3ac,
    0x0_56a5_d085,
    0x1_0652_e1d4,
    0x2_2b1d_fead,
    0x2_65ad_0472,
    0x3_4fe9_1b86,
    0x3_ff96_2cd5,
    0x4_3a25_329a,
    0x4_74b4_385f,
    0x4_e9d2_43e9,
    0x5_2461_49ae,
    0x5_997f_5538,
    0x6_83bb_6c4c,
    0x6_be4a_7211,
    0x7_e315_8eea,
    0x8_1da4_94af,
    0x8_5833_9a74,
    0x8_cd51_a5fe,
    0x9_f21c_c2d7,
    0xa_2cab_c89c,
    0xa_dc58_d9eb,
    0xb_16e7_dfb0,
    0xb_8c05_eb3a,
    0xd_25ef_139d,
    0xd_607e_1962,
    0xe_4aba_3076,
    0x2_dde6_a3da,
];

/// Pixels of a module in the texture: enough for sharp edges in magnified images.
const PIXELS_PER_MODULE: usize = 16;

/// Places along x and y.
pub(crate) const COLUMNS: usize = 9;
/// See [`COLUMNS`].
pub(crate) const ROWS: usize = 7;
/// Distance between neighbouring places in metres. A QR code's half diagonal (0.543) and an AprilTag's (0.248) fit
/// in between at any angle.
pub(crate) const PITCH_M: f64 = 0.8;

/// Rotations in degrees that are added to multiples of 90°.
const SMALL_TURNS_DEG: [f64; 9] = [0.0, 8.0, -13.0, 0.0, 21.0, -5.0, 0.0, 34.0, -27.0];

/// The content of a code.
#[derive(Clone)]
pub(crate) enum Kind {
    AprilTag { id: usize },
    Qr { number: usize, text: String },
}

/// A code and its place.
pub(crate) struct Code {
    /// Name of its visual, material and texture.
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// Centre on the ceiling in metres.
    pub(crate) center: [f64; 2],
    /// Rotation about the world's z axis in radians, rounded as in the SDF file.
    pub(crate) yaw: f64,
    /// Edge of a module in metres.
    pub(crate) module_m: f64,
    /// Modules along an edge, without the white margin.
    pub(crate) modules: usize,
    /// Modules of the white margin on each side.
    pub(crate) margin: usize,
    /// Whether a module is black, in rows from the top left, without the margin.
    black: Vec<bool>,
}

impl Code {
    /// Returns the edge of the whole plate with its margin, in metres.
    pub(crate) fn plate_m(&self) -> f64 {
        (self.modules + 2 * self.margin) as f64 * self.module_m
    }

    /// Returns the edge of the square without the margin, in metres: for an AprilTag the outer edge of its black border.
    pub(crate) fn edge_m(&self) -> f64 {
        self.modules as f64 * self.module_m
    }

    /// Returns its texture: edge length in pixels, and grey pixels from the top left.
    pub(crate) fn texture(&self) -> (u32, Vec<u8>) {
        let edge = (self.modules + 2 * self.margin) * PIXELS_PER_MODULE;
        let is_black = |column: usize, row: usize| {
            let inside = |at: usize| at.checked_sub(self.margin).filter(|at| *at < self.modules);
            let (Some(column), Some(row)) = (inside(column), inside(row)) else { return false };
            self.black[row * self.modules + column]
        };
        let pixels = (0..edge * edge)
            .map(|at| {
                let (column, row) = (at % edge / PIXELS_PER_MODULE, at / edge / PIXELS_PER_MODULE);
                if is_black(column, row) { 0 } else { 255 }
            })
            .collect();
        (edge as u32, pixels)
    }
}

/// Returns all codes: AprilTags and QR codes alternately, row by row from the corner with the smallest x and y.
pub(crate) fn all() -> Result<Vec<Code>, QrError> {
    let (mut tags, mut qrs) = (0, 0);
    (0..COLUMNS * ROWS)
        .map(|place| {
            let (column, row) = (place % COLUMNS, place / COLUMNS);
            let mut code = if (column + row) % 2 == 0 {
                tags += 1;
                april_tag(tags - 1)
            } else {
                qrs += 1;
                qr(qrs - 1)?
            };
            let along = |index: usize, count: usize| (index as f64 - (count - 1) as f64 / 2.0) * PITCH_M;
            code.center = [round(along(column, COLUMNS)), round(along(row, ROWS))];
            let quarter_turns = place * 7 / 3 % 4;
            let degrees = quarter_turns as f64 * 90.0 + SMALL_TURNS_DEG[place % SMALL_TURNS_DEG.len()];
            code.yaw = round(degrees.to_radians());
            Ok(code)
        })
        .collect()
}

/// Rounds a number as in the SDF file, so that the list of corners matches the numbers in that file exactly.
pub(crate) fn round(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

fn april_tag(id: usize) -> Code {
    let bits = TAG_36H11[id];
    let black = (0..64)
        .map(|at| {
            let (column, row) = (at % 8, at / 8);
            let border = column == 0 || column == 7 || row == 0 || row == 7;
            border || bits >> (35 - ((row - 1) * 6 + column - 1)) & 1 == 0
        })
        .collect();
    Code {
        name: format!("apriltag_{id:02}"),
        kind: Kind::AprilTag { id },
        center: [0.0; 2],
        yaw: 0.0,
        module_m: 0.035,
        modules: 8,
        margin: 1,
        black,
    }
}

/// Returns a QR code of version 1. Its modules are as large as the pitch allows: 4.7 pixels in the robot's camera.
fn qr(number: usize) -> Result<Code, QrError> {
    let text = format!("BV-{number:03}");
    let qr = QrCode::with_version(&text, Version::Normal(1), EcLevel::H)?;
    Ok(Code {
        name: format!("qr_{number:03}"),
        kind: Kind::Qr { number, text },
        center: [0.0; 2],
        yaw: 0.0,
        module_m: 0.0265,
        modules: qr.width(),
        margin: 4,
        black: qr.to_colors().into_iter().map(|color| color == Color::Dark).collect(),
    })
}
