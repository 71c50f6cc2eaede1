//! Conversion of light to the numbers of the converter: the camera model of EMVA 1288, one tile at a time.
//!
//! ```text
//! charge = min(Poisson(light · response · PRNU + dark current · time) + DSNU, full well)
//! DN     = min(round(K · (charge + N(0, read noise²)) + black level), 2^bits − 1), and 0 at least
//! ```
//!
//! The well limits the charge, and read noise is added to the limited charge, so a pixel with a full well still has
//! read noise. Shot noise and read noise are drawn as one normal only if the well cannot be full.

use super::poisson::{MANY, few, many, many_with_reading, round};
use crate::noise::{Stream, normals64};
use crate::simd::{LANES, Lanes, sqrt_f32};
use crate::trace::grid::tiling::BLOCKS;
use fearless_simd::Simd;

/// Below this variance of the read noise, half an electron squared, single electrons are visible.
const WHOLE_ELECTRONS: f32 = 0.25;

/// Upper bounds on the magnitude of a normal, and on the electrons by which the transformation of a normal to a count
/// exceeds its standard deviation.
const LARGEST_NORMAL: f32 = 6.6;
const LARGEST_BEND: f32 = 8.0;

/// The parameters of a device that pixels need, in single precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Signal {
    /// Mean number of electrons from the dark current in the exposure time.
    pub(super) dark_e: f32,
    /// Standard deviation of the pixels' response, as a fraction of it.
    pub(super) prnu: f32,
    /// Standard deviation of the pixels' dark signal.
    pub(super) dsnu_e: f32,
    /// Standard deviation of the read and converter noise.
    pub(super) read_e: f32,
    pub(super) full_well_e: f32,
    pub(super) dn_per_electron: f32,
    pub(super) black_level_dn: f32,
    /// The greatest number of the converter.
    pub(super) top_dn: f32,
}

impl Signal {
    /// Converts the mean number of electrons from light in the pixels of a tile to DN. `of` returns the stream of the
    /// tile's plane for a channel.
    #[inline(always)]
    pub(super) fn read<S: Simd>(
        &self,
        simd: S,
        electrons: &mut Lanes<f32>,
        of: impl Fn(u16) -> Stream,
        samples: [u32; BLOCKS],
    ) {
        let offset = self.add_patterns(simd, electrons, &of, samples);
        let (counts, reading) = self.collect(simd, electrons, &offset, &of, samples);
        self.convert(electrons, &counts, &offset, &reading);
    }

    /// Applies the fixed patterns: multiplies the electrons by the response of each pixel, adds the dark current, and
    /// returns the dark signal of each pixel.
    #[inline(always)]
    fn add_patterns<S: Simd>(
        &self,
        simd: S,
        electrons: &mut Lanes<f32>,
        of: &impl Fn(u16) -> Stream,
        samples: [u32; BLOCKS],
    ) -> Lanes<f32> {
        let Self { dark_e, prnu, dsnu_e, .. } = *self;
        if prnu != 0.0 {
            let response = normals64(simd, &Stream { frame: 0, ..of(Stream::RESPONSE) }, samples);
            for lane in 0..LANES {
                let factor = 1.0 + prnu * response[lane];
                electrons[lane] *= if factor > 0.0 { factor } else { 0.0 };
            }
        }
        let mut offset = [0.0; LANES];
        if dsnu_e != 0.0 {
            let dark = normals64(simd, &Stream { frame: 0, ..of(Stream::DARK) }, samples);
            for lane in 0..LANES {
                offset[lane] = dsnu_e * dark[lane];
            }
        }
        for lane in 0..LANES {
            electrons[lane] += dark_e;
        }
        offset
    }

    /// Draws the electrons that are collected and the normals of their read noise, from the mean of each pixel. Where
    /// the well cannot be full, the electrons include both kinds of noise.
    #[inline(always)]
    fn collect<S: Simd>(
        &self,
        simd: S,
        electrons: &Lanes<f32>,
        offset: &Lanes<f32>,
        of: &impl Fn(u16) -> Stream,
        samples: [u32; BLOCKS],
    ) -> (Lanes<f32>, Lanes<f32>) {
        let Self { read_e, full_well_e, .. } = *self;
        let variance = read_e * read_e;
        // Below this, no count reaches the full well, whatever its noise.
        let brim_e = full_well_e - LARGEST_NORMAL * sqrt_f32(full_well_e + variance) - LARGEST_BEND;
        let (mut any_none, mut any_few, mut any_many, mut any_full) = (0, 0, 0, 0);
        for lane in 0..LANES {
            any_full |= u32::from(electrons[lane] >= brim_e || electrons[lane] + offset[lane] >= brim_e);
            let is_many = u32::from(electrons[lane] >= MANY);
            let is_some = u32::from(electrons[lane] > 0.0);
            any_none |= is_some ^ 1;
            any_few |= is_some & (is_many ^ 1);
            any_many |= is_many;
        }

        let is_one = variance >= WHOLE_ELECTRONS;
        let mut shot = [0.0; LANES];
        if is_one || any_many != 0 {
            shot = normals64(simd, &of(Stream::SHOT), samples);
        }
        let mut apart = shot;
        if (!is_one && read_e != 0.0) || (is_one && any_full & any_many != 0) {
            apart = normals64(simd, &of(Stream::READ), samples);
        }
        let mut counts = [0.0; LANES];
        let mut reading = [0.0; LANES];
        if is_one {
            if any_many != 0 {
                for lane in 0..LANES {
                    counts[lane] = many_with_reading(electrons[lane], variance, shot[lane]);
                }
            }
            if any_full & any_many != 0 {
                for lane in 0..LANES {
                    let is_full = electrons[lane] >= brim_e || electrons[lane] + offset[lane] >= brim_e;
                    let count = many(electrons[lane], shot[lane]);
                    counts[lane] = if is_full { count } else { counts[lane] };
                    reading[lane] = if is_full { apart[lane] } else { 0.0 };
                }
            }
        } else {
            if read_e != 0.0 {
                reading = apart;
            }
            for lane in 0..LANES {
                counts[lane] = many(electrons[lane], shot[lane]);
            }
        }
        if any_few | any_none != 0 {
            // A mean of 0 gives a count of 0. A count that used no normal leaves its normal to the read noise.
            let mut small = [0.0; LANES];
            if any_few != 0 {
                small = few(simd, electrons, &of(Stream::COUNT).words64(simd, samples));
            }
            for lane in 0..LANES {
                let is_many = electrons[lane] >= MANY;
                counts[lane] = if is_many { counts[lane] } else { small[lane] };
                if is_one {
                    reading[lane] = if is_many { reading[lane] } else { shot[lane] };
                }
            }
        }
        (counts, reading)
    }

    /// Converts the electrons that were collected to DN.
    #[inline(always)]
    fn convert(
        &self,
        numbers: &mut Lanes<f32>,
        counts: &Lanes<f32>,
        offset: &Lanes<f32>,
        reading: &Lanes<f32>,
    ) {
        let Self { read_e, full_well_e, dn_per_electron, black_level_dn, top_dn, .. } = *self;
        for lane in 0..LANES {
            let collected = counts[lane] + offset[lane];
            let held = if collected < full_well_e { collected } else { full_well_e };
            let level = (held + read_e * reading[lane]) * dn_per_electron + black_level_dn;
            let level = if level > 0.0 { level } else { 0.0 };
            numbers[lane] = round(if level < top_dn { level } else { top_dn });
        }
    }
}
