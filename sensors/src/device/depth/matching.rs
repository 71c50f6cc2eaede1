//! What a stereo camera finds in its other eye: where there is contrast.

use super::check;
use crate::ParameterError;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16};

/// Pixels to each side of one that its window reaches.
pub(crate) const REACH: usize = 2;

/// A stereo camera finds a pixel in its other eye by what is around it. The contrast there is the root mean square, over
/// 5 × 5 pixels, of half the differences between the neighbours to the left and right in brightness (of lamps and textures, as the
/// camera shades them, at most 1), together with that of the projected pattern, `projector` · cos θ/z²: cos θ of the
/// surface, over that of a plane parallel to the picture. So the share of pixels that have a depth, the fill factor, is
///
/// Φ((contrast/`half` − 1)/`spread`)
///
/// and where the contrast is below `full`, disparities are noisier by `full`/contrast: their variance is as the inverse of the sum
/// of squared gradients (T. Kanade, M. Okutomi, "A stereo matching algorithm with an adaptive window", PAMI 1994).
///
/// ```
/// use belvedere_sensors::device::depth::Matching;
/// let active = Matching { projector: 0.5, half: 0.014, full: 0.025, spread: 0.2 };
/// let passive = Matching { projector: 0.0, ..active };
/// // A white wall, 2 m away.
/// assert!(active.fill_factor(active.projected(2.0)) > 0.999 && passive.fill_factor(passive.projected(2.0)) < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matching {
    /// Contrast of the projected pattern on what faces the camera 1 m away, 0 … 10; 0 without a projector.
    pub projector: f64,
    /// Contrast at which half of the pixels are found, 10⁻⁶ … 1.
    pub half: f64,
    /// Contrast from which on disparities get no better, 0 … 1.
    pub full: f64,
    /// How the contrast that a pixel needs differs from frame to frame, in parts of `half`, 10⁻⁶ … 0.3.
    pub spread: f64,
}

impl Matching {
    /// Contrast of the projected pattern on what faces the camera.
    #[must_use]
    pub fn projected(&self, depth_m: f64) -> f64 {
        self.projector / (depth_m * depth_m)
    }

    /// The share of pixels that are found at a contrast.
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

/// The matching of a checked device.
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

    /// Which of sixteen pixels are found, each with a normal number, and by how much noisier they are: by the sum of squares
    /// of their windows' differences, their depths, and their cosines over those of a plane parallel to the picture.
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
        // Of differences between pixels two columns apart: half of them are meant.
        let scene = squares * (0.25 / window as f32);
        let projected = facing * self.projector / (depths * depths);
        let contrast = (scene + projected * projected).sqrt();
        let is_found = contrast.simd_gt(((normals * self.spread + 1.0) * self.half).max(number(0.0)));
        let noisier = (number(self.full) / contrast).max(number(1.0));
        (is_found, is_found.select(noisier, number(1.0)))
    }
}
