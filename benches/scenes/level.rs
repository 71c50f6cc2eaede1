//! Names of SIMD levels.

use belvedere_sensors::simd::Level;

/// All names, narrowest level first.
pub const NAMES: [&str; 5] = ["fallback", "neon", "sse2", "avx2", "avx512"];

/// Returns the name of a level.
pub fn name(level: Level) -> &'static str {
    #[cfg(target_arch = "x86_64")]
    match level {
        Level::Avx512(_) => return "avx512",
        Level::Avx2(_) => return "avx2",
        // The kernels have no version of their own for SSE4.2.
        Level::Sse4_2(_) | Level::Sse2(_) => return "sse2",
        _ => {}
    }
    #[cfg(target_arch = "aarch64")]
    if level.as_neon().is_some() {
        return "neon";
    }
    let _ = level;
    "fallback"
}

/// Returns the level with a name, if this machine has it.
pub fn named(name: &str) -> Option<Level> {
    let best = belvedere_sensors::simd::best_level();
    #[cfg(target_arch = "x86_64")]
    let level = match name {
        "avx512" => best.as_avx512().map(Level::Avx512),
        "avx2" => best.as_avx2().map(Level::Avx2),
        "sse2" => best.as_sse2().map(Level::Sse2),
        _ => None,
    };
    #[cfg(not(target_arch = "x86_64"))]
    let level = (name == self::name(best)).then_some(best);
    level
}
