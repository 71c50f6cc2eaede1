//! The tracing core as a plugin of a ray casting benchmark: a C interface of six functions (`abi`) over a
//! `caster::Caster`. If the rays are those of a `sensor`, they are cast as a frame of it.
//!
//! `BELVEDERE_SIMD` = `sse2`, `avx2` or `avx512` forces an instruction set.

mod abi;
mod caster;
mod memory;
mod sensor;
