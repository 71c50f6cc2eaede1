//! The SIMD level token and the packets that kernels work on.
//!
//! Kernels are plain loops over fixed-size arrays of [`LANES`] values, written with + − × ÷ √ and compares
//! only. [`Simd::vectorize`](fearless_simd::Simd::vectorize) compiles each for every instruction set; the level
//! is chosen once a frame. As no operation is fused or approximated, every level gives the same bits.

pub use fearless_simd::Level;

/// Rays in a packet: a tile of 16 × 4 pixels, or 64 consecutive beams.
pub const LANES: usize = 64;

/// One value per lane.
pub(crate) type Lanes<T> = [T; LANES];

/// The best level of this machine with the feature `std`, else the compilation target's own.
pub fn best_level() -> Level {
    #[cfg(feature = "std")]
    return Level::new();
    #[cfg(not(feature = "std"))]
    return Level::baseline();
}

/// √, correctly rounded everywhere.
#[inline(always)]
pub(crate) fn sqrt(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(x);
}

/// √ in single precision, correctly rounded everywhere.
#[inline(always)]
pub(crate) fn sqrt_f32(x: f32) -> f32 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrtf(x);
}

/// The largest whole number not above x, for |x| < 2⁶³; an instruction or three where the library's is a call.
#[inline(always)]
pub(crate) fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}
