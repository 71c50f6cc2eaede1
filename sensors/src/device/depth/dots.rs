//! The projected dots of structured light, and the window that they are found by.

use super::check;
use super::lateral::{LateralNoise, Shift};
use crate::ParameterError;
use crate::noise::Stream;

/// Pixels across and down a square of the pattern that has one dot.
const SQUARE: usize = 3;
/// Pixels to each side of a dot that its window reaches.
const REACH: usize = 4;
/// Pixels to each side of a dot that may take its disparity.
const FILL: usize = 3;

/// Depths come from dots of a pattern: one in each square of 3 × 3 pixels, where a random number of the sensor's puts it. A dot
/// is found if, of the dots in the 9 × 9 pixels around it, more than one in 1.2 has a disparity within 0.1 · 1.44 · r² pixels of
/// their mean (r pixels from the dot; 0.1 at the dot itself). Disparities are rounded to eighths of a pixel. Pixels take that of the nearest dot that was
/// found, up to three pixels away; where there is none, the depth is NaN.
///
/// The filter is that of J. Bohg et al., "Robot arm pose estimation through pixel-wise part classification", 2014, and of
/// J. T. Barron, J. Malik, "Intrinsic scene properties from a single RGB-D image", 2013, as ICL-NUIM has it (A. Handa et al.,
/// 2014); their pattern is a picture of a Kinect's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DotWindow {
    /// Focal length in pixels, 10⁻⁶ … 10⁶.
    pub focal_px: f64,
    /// From the projector to the camera, 10⁻⁶ … 1000 m.
    pub baseline_m: f64,
    /// By how much pixels see beside their own ray, before dots are looked for.
    pub lateral: LateralNoise,
}

impl DotWindow {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check("dots.focal_px", self.focal_px, [1e-6, 1e6])?;
        check("dots.baseline_m", self.baseline_m, [1e-6, 1e3])?;
        self.lateral.check()
    }
}

/// The dots of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dots {
    /// Disparity in pixels times depth in metres.
    pub(crate) disparity_at_1m: f32,
    pub(super) shift: Option<Shift>,
}

/// Squares of a picture, across and down.
pub(crate) fn squares([width, height]: [usize; 2]) -> [usize; 2] {
    [width.div_ceil(SQUARE), height.div_ceil(SQUARE)]
}

/// Where the dot of a square is: column and row. It may lie beyond a picture that ends within the square.
#[inline]
pub(crate) fn dot(pattern: &Stream, across: usize, [x, y]: [usize; 2]) -> [usize; 2] {
    let random = u64::from(pattern.word((y * across + x) as u32));
    let place = ((random * (SQUARE * SQUARE) as u64) >> 32) as usize;
    [x * SQUARE + place % SQUARE, y * SQUARE + place / SQUARE]
}

/// The squares whose dots may lie within so many pixels of one.
fn near(pixel: usize, reach: usize, count: usize) -> core::ops::Range<usize> {
    pixel.saturating_sub(reach) / SQUARE..((pixel + reach) / SQUARE + 1).min(count)
}

fn squared_distance(a: [usize; 2], b: [usize; 2]) -> usize {
    let [x, y] = [a[0].abs_diff(b[0]), a[1].abs_diff(b[1])];
    x * x + y * y
}

impl Dots {
    pub(super) fn new(window: &DotWindow) -> Self {
        let disparity_at_1m = (window.focal_px * window.baseline_m) as f32;
        Self { disparity_at_1m, shift: Shift::new(&window.lateral) }
    }

    /// The depth of a pixel, by the disparities that the dots of all squares were found at.
    pub(crate) fn depth(
        self,
        pixel: [usize; 2],
        [width, height]: [usize; 2],
        dots: &[[u16; 2]],
        found: &[f32],
    ) -> f32 {
        let [across, down] = squares([width, height]);
        let (mut nearest, mut disparity) = (FILL * FILL + 1, 0.0);
        for y in near(pixel[1], FILL, down) {
            for x in near(pixel[0], FILL, across) {
                let square = y * across + x;
                let squared = squared_distance(dots[square].map(usize::from), pixel);
                if found[square] > 0.0 && squared < nearest {
                    (nearest, disparity) = (squared, found[square]);
                }
            }
        }
        if disparity > 0.0 { self.disparity_at_1m / disparity } else { f32::NAN }
    }
}

/// More than one in 1.2.
fn is_most(count: usize, all: usize) -> bool {
    6 * count > 5 * all
}

/// The disparity that a dot is found at; 0 if it is not. `disparity` is what pixels have, 0 where there is none, and
/// `dots` are those of all squares.
pub(crate) fn find_dot(
    [column, row]: [usize; 2],
    [width, height]: [usize; 2],
    dots: &[[u16; 2]],
    disparity: &[f32],
) -> f32 {
    if column >= width || row >= height {
        return 0.0;
    }
    let [across, down] = squares([width, height]);
    // At most four squares by four lie near.
    let (mut found, mut count, mut all) = ([(0.0_f32, 0_usize); 16], 0, 0_usize);
    let mut sum = 0.0;
    for y in near(row, REACH, down) {
        for x in near(column, REACH, across) {
            let at = dots[y * across + x].map(usize::from);
            let inside = at[0].abs_diff(column) <= REACH && at[1].abs_diff(row) <= REACH;
            if !inside || at[0] >= width || at[1] >= height {
                continue;
            }
            all += 1;
            let value = disparity[at[1] * width + at[0]];
            if value > 0.0 && count < found.len() {
                found[count] = (value, squared_distance(at, [column, row]));
                count += 1;
                sum += value;
            }
        }
    }
    let own = disparity[row * width + column];
    if own <= 0.0 || !is_most(count, all) {
        return 0.0;
    }
    let mean = sum / count as f32;
    let agrees = |&(value, squared): &(f32, usize)| {
        let limit = if squared == 0 { 0.1 } else { 0.144 * squared as f32 };
        (value - mean).abs() < limit
    };
    let agreeing = found[..count].iter().filter(|dot| agrees(dot)).count();
    if !is_most(agreeing, all) {
        return 0.0;
    }
    let eighths = own * 8.0 + 0.5;
    eighths as u32 as f32 * 0.125
}
