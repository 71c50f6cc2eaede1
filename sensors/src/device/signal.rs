//! From light to the numbers of the converter: the camera model of EMVA 1288, a tile at a time.
//!
//! ```text
//! electrons = min(Poisson(light · response · PRNU + dark current · time) + DSNU + N(0, read noise²), full well)
//! DN        = min(round(K · electrons + black level), 2^bits − 1), and 0 at least
//! ```

use super::poisson::{MANY, few, many, many_with_reading, round};
use crate::noise::{Stream, normals64};
use crate::simd::{LANES, Lanes};
use crate::trace::tiling::BLOCKS;
use fearless_simd::Simd;

/// Below this variance of the noise of reading, half an electron squared, whole electrons show.
const WHOLE_ELECTRONS: f32 = 0.25;

/// What of a device the pixels need, in single precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Signal {
    /// Electrons of the dark current in the time of exposure.
    pub(super) dark_e: f32,
    /// Standard deviation of the pixels' response, as a share of it.
    pub(super) prnu: f32,
    /// Standard deviation of the pixels' dark signal.
    pub(super) dsnu_e: f32,
    /// Standard deviation of the noise of reading and converting.
    pub(super) read_e: f32,
    pub(super) full_well_e: f32,
    pub(super) dn_per_electron: f32,
    pub(super) black_level_dn: f32,
    /// The largest number of the converter.
    pub(super) top_dn: f32,
}

impl Signal {
    /// Turns the electrons that light makes on average in the pixels of a tile into DN. `of` gives the
    /// streams of the tile's plane.
    #[inline(always)]
    pub(super) fn read<S: Simd>(
        &self,
        simd: S,
        electrons: &mut Lanes<f32>,
        of: impl Fn(u16) -> Stream,
        samples: [u32; BLOCKS],
    ) {
        let Self { dark_e, prnu, dsnu_e, read_e, full_well_e, dn_per_electron, black_level_dn, top_dn } =
            *self;

        // Step 1: fixed patterns.
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
        let (mut any_none, mut any_few, mut any_many) = (0, 0, 0);
        for lane in 0..LANES {
            electrons[lane] += dark_e;
            let is_many = u32::from(electrons[lane] >= MANY);
            let is_some = u32::from(electrons[lane] > 0.0);
            any_none |= is_some ^ 1;
            any_few |= is_some & (is_many ^ 1);
            any_many |= is_many;
        }

        // Step 2: what is counted, and the noise of reading it.
        let variance = read_e * read_e;
        let is_one = variance >= WHOLE_ELECTRONS;
        let mut shot = [0.0; LANES];
        if is_one || any_many != 0 {
            shot = normals64(simd, &of(Stream::SHOT), samples);
        }
        let mut counts = [0.0; LANES];
        let mut reading = [0.0; LANES];
        if is_one {
            reading = shot;
            if any_many != 0 {
                for lane in 0..LANES {
                    counts[lane] = many_with_reading(electrons[lane], variance, shot[lane]);
                }
            }
        } else {
            if read_e != 0.0 {
                reading = normals64(simd, &of(Stream::READ), samples);
            }
            for lane in 0..LANES {
                counts[lane] = many(electrons[lane], shot[lane]) + read_e * reading[lane];
            }
        }
        if any_few | any_none != 0 {
            // Of no electrons none is counted.
            let mut small = [0.0; LANES];
            if any_few != 0 {
                small = few(simd, electrons, &of(Stream::COUNT).words64(simd, samples));
            }
            for lane in 0..LANES {
                let few = small[lane] + read_e * reading[lane];
                counts[lane] = if electrons[lane] >= MANY { counts[lane] } else { few };
            }
        }

        // Step 3: DN.
        for lane in 0..LANES {
            let collected = counts[lane] + offset[lane];
            let held = if collected < full_well_e { collected } else { full_well_e };
            let level = held * dn_per_electron + black_level_dn;
            let level = if level > 0.0 { level } else { 0.0 };
            electrons[lane] = round(if level < top_dn { level } else { top_dn });
        }
    }
}
