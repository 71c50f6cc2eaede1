//! The projected dot pattern of structured light, and the window in which dots are matched.

use super::check;
use super::lateral::{LateralNoise, Shift};
use crate::ParameterError;
use crate::noise::Stream;

/// Side length in pixels of the squares of the pattern, each of which has one dot.
const SQUARE: usize = 3;
/// Half size in pixels of the window around a dot.
const REACH: usize = 4;
/// Greatest distance in pixels from a pixel to the dot whose disparity it may take.
const FILL: usize = 3;

/// Depths come from the dots of a projected pattern.
///
/// There is one dot in each square of 3 × 3 pixels, at a position given by a random number of the sensor. A dot is
/// found if, of the dots in the 9 × 9 pixels around it, more than one in 1.2 has a disparity within 0.1 · 1.44 · r²
/// pixels of their mean (r is the distance from the dot in pixels; the limit is 0.1 at the dot itself). Disparities are
/// rounded to eighths of a pixel. Pixels take the disparity of the nearest dot that was found, up to three pixels away;
/// if there is none, the depth is NaN.
///
/// The filter is that of J. Bohg et al., "Robot arm pose estimation through pixel-wise part classification", 2014, and
/// of J. T. Barron, J. Malik, "Intrinsic scene properties from a single RGB-D image", 2013, in the form used by
/// ICL-NUIM (A. Handa et al., 2014); their pattern is an image of a Kinect's pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DotWindow {
    /// Focal length in pixels, 10⁻⁶ to 10⁶.
    pub focal_px: f64,
    /// Baseline from the projector to the camera in metres, 10⁻⁶ to 1000.
    pub baseline_m: f64,
    /// Lateral noise, applied before dots are matched.
    pub lateral: LateralNoise,
}

impl DotWindow {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check("dots.focal_px", self.focal_px, [1e-6, 1e6])?;
        check("dots.baseline_m", self.baseline_m, [1e-6, 1e3])?;
        self.lateral.check()
    }
}

/// The dot pattern of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dots {
    /// Disparity in pixels at a depth of 1 m: the product of disparity and depth.
    pub(crate) disparity_at_1m: f32,
    pub(super) shift: Option<Shift>,
}

/// Number of squares of an image across and down.
pub(crate) fn squares([width, height]: [usize; 2]) -> [usize; 2] {
    [width.div_ceil(SQUARE), height.div_ceil(SQUARE)]
}

/// Column and row of the dot of a square. It may be outside the image if the image ends within the square.
#[inline]
pub(crate) fn dot(pattern: &Stream, across: usize, [x, y]: [usize; 2]) -> [usize; 2] {
    let random = u64::from(pattern.word((y * across + x) as u32));
    let place = ((random * (SQUARE * SQUARE) as u64) >> 32) as usize;
    [x * SQUARE + place % SQUARE, y * SQUARE + place / SQUARE]
}

/// The squares whose dots may be within `reach` pixels of a pixel, along one axis.
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

    /// The depth of a pixel, from the disparities at which the dots of all squares were found.
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

/// Returns true if `count` is more than one in 1.2 of `all`.
fn is_most(count: usize, all: usize) -> bool {
    6 * count > 5 * all
}

/// The disparity at which a dot is found; 0 if it is not found. `disparity` holds the disparity of each pixel, 0 where
/// there is none, and `dots` the dots of all squares.
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
    // At most four by four squares are near.
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
