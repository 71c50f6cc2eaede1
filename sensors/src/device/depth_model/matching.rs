//! Stereo matching: which pixels have enough contrast to be matched.

use super::check;
use crate::ParameterError;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16};

/// Half size in pixels of the window around a pixel.
pub(crate) const REACH: usize = 2;

/// Stereo matching finds a pixel in the second image by the contrast around it.
///
/// The contrast is the root mean square over 5 × 5 pixels of half the difference in brightness between the left and
/// right neighbours (of lamps and textures, as the camera shades them, at most 1), combined with the contrast of the
/// projected pattern, `projector` · cos θ/z², where cos θ of the surface is relative to that of a plane parallel to the
/// image. The fill factor, the fraction of pixels that have a depth, is
///
/// Φ((contrast/`half` − 1)/`spread`)
///
/// Where the contrast is below `full`, the noise of disparities is multiplied by `full`/contrast: their variance is
/// inversely proportional to the sum of squared gradients (T. Kanade, M. Okutomi, "A stereo matching algorithm with an
/// adaptive window", PAMI 1994).
///
/// ```
/// use belvedere_sensors::device::depth_model::Matching;
/// let active = Matching { projector: 0.5, half: 0.014, full: 0.025, spread: 0.2 };
/// let passive = Matching { projector: 0.0, ..active };
/// // A white wall, 2 m away.
/// assert!(active.fill_factor(active.projected(2.0)) > 0.999 && passive.fill_factor(passive.projected(2.0)) < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matching {
    /// Contrast of the projected pattern on a surface that faces the camera at a distance of 1 m, 0 to 10; 0 without a
    /// projector.
    pub projector: f64,
    /// Contrast at which half of the pixels are matched, 10⁻⁶ to 1.
    pub half: f64,
    /// Contrast above which disparities do not improve, 0 to 1.
    pub full: f64,
    /// Standard deviation from frame to frame of the contrast that a pixel needs, as a fraction of `half`, 10⁻⁶ to 0.3.
    pub spread: f64,
}

impl Matching {
    /// Returns the contrast of the projected pattern on a surface that faces the camera.
    #[must_use]
    pub fn projected(&self, depth_m: f64) -> f64 {
        self.projector / (depth_m * depth_m)
    }

    /// Returns the fraction of pixels that are matched at the given contrast.
    #[must_use]
    pub fn fill_factor(&self, contrast: f64) -> f64 {
        0.5 * libm::erfc((1.0 - contrast / self.half) / (self.spread * core::f64::consts::SQRT_2))
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check("matching.projector", self.projector, [0.0, 10.0])?;
        check("matching.half", self.half, [1e-6, 1.0])?;
        check("matching.full", self.full, [0.0, 1.0])?;
        check("matching.spread", self.spread, [1e-6, 0.3])
    }
}

/// The stereo matching of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Matcher {
    projector: f32,
    half: f32,
    full: f32,
    spread: f32,
}

impl Matcher {
    pub(super) fn new(matching: &Matching) -> Self {
        let Matching { projector, half, full, spread } = *matching;
        let [projector, half, full, spread] = [projector, half, full, spread].map(|value| value as f32);
        Self { projector, half, full, spread }
    }

    /// A mask of the pixels that are matched, of sixteen with a normal number each, and the factors by which their
    /// noise increases. The inputs are the sums of squares of the differences in their windows, their depths, and their
    /// cosines relative to those of a plane parallel to the image.
    #[inline(always)]
    pub(crate) fn find<S: Simd>(
        self,
        simd: S,
        squares: f32x16<S>,
        [depths, facing]: [f32x16<S>; 2],
        normals: f32x16<S>,
    ) -> (mask32x16<S>, f32x16<S>) {
        let number = |value: f32| f32x16::splat(simd, value);
        let window = (2 * REACH + 1) * (2 * REACH + 1);
        // The differences are between pixels two columns apart, and half of each is needed.
        let scene = squares * (0.25 / window as f32);
        let projected = facing * self.projector / (depths * depths);
        let contrast = (scene + projected * projected).sqrt();
        let is_found = contrast.simd_gt(((normals * self.spread + 1.0) * self.half).max(number(0.0)));
        let noisier = (number(self.full) / contrast).max(number(1.0));
        (is_found, is_found.select(noisier, number(1.0)))
    }
}
