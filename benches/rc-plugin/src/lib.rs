//! The tracing core as a plugin of a ray casting benchmark: a C interface of six functions (`abi`) over a
//! `caster::Caster`. Rays that turn out to be those of a `sensor` are cast as its frame.
//!
//! `BELVEDERE_SIMD` = `sse2`, `avx2` or `avx512` forces an instruction set.

mod abi;
mod caster;
mod memory;
mod sensor;
