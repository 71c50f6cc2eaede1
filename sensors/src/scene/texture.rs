//! Textures with mip levels (Williams 1983, "Pyramidal parametrics").

use crate::srgb;
use bytemuck::{Pod, Zeroable};

/// The colour space of materials, textures and the background. Lamps and ambient light are factors of these colours in
/// either space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColourSpace {
    /// Colours are linear light and are output unchanged, as in Gazebo classic: a surface in half the light has half
    /// the value.
    #[default]
    AsGiven,
    /// Colours are sRGB, as in image files. Light is computed in linear values, and images without a
    /// [device](crate::device) are converted back to sRGB; a device has its own tone curve. Colours are clamped to [0,
    /// 1].
    Srgb,
}

/// Index of a texture in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// The meaning of the alpha channel of a material's texture.
///
/// Only cameras see through surfaces by alpha, and through at most four of them; a fifth is opaque. Depths, lidars and
/// the ground truth of a pixel are those of the nearest surface, transparent or not, as in Gazebo, except for
/// [`MaterialConfig::transmittance`](super::MaterialConfig::transmittance). Surfaces with an alpha below 1 or a blended
/// texture cast no shadows; cut-out surfaces cast the shadow of the whole surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TextureAlpha {
    /// Alpha is ignored: the texture is opaque.
    #[default]
    Ignored,
    /// The surface is absent where the alpha of the texture is below `least`.
    CutOut {
        /// The threshold, from 0 to 1.
        least: f32,
    },
    /// Alpha is multiplied by [`MaterialConfig::alpha`](super::MaterialConfig::alpha).
    Blended,
}

/// What the texture of a material is multiplied by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TextureMode {
    /// The diffuse and the ambient reflectance, as in Gazebo.
    #[default]
    Reflectance,
    /// All light of the surface, with highlights and emitted light, after it was limited to 1. This is how OpenGL
    /// without shaders applies a texture (`GL_MODULATE`). The light of each lamp that casts shadows is limited on its
    /// own and then added, as by a program that draws the surface once more for each such lamp. Materials with a
    /// [`Pbr`](super::Pbr) have [`TextureMode::Reflectance`] instead.
    Light,
}

/// Position of a texture's mip levels in the scene's texels. Level 0 is the full image; each further level has half the
/// size, rounded down but at least 1; the last is 1 × 1. Rows run from the top (v = 1) down.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Texture {
    pub(crate) first_texel: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) levels: u32,
    /// What it holds: [`COLOURS`], [`DATA`] or [`CUBE`].
    pub(crate) kind: u32,
}

/// Numbers of [`Texture::kind`]: an image of colours, an image of data that are not colours, and a cube of colours.
pub(crate) const COLOURS: u32 = 0;
pub(crate) const DATA: u32 = 1;
pub(crate) const CUBE: u32 = 2;

impl Texture {
    /// Describes a texture whose texels start at index `first_texel` of the scene's texels: [`mip_texels`] of them, as
    /// filled by [`fill_mip_levels`].
    pub const fn new(width: u32, height: u32, first_texel: u32) -> Self {
        Self { first_texel, width, height, levels: mip_levels(width, height), kind: COLOURS }
    }
}

/// Number of mip levels of an image.
pub const fn mip_levels(width: u32, height: u32) -> u32 {
    let longer = if width > height { width } else { height };
    32 - longer.leading_zeros()
}

/// Number of texels of all mip levels together.
pub const fn mip_texels(width: u32, height: u32) -> usize {
    let (mut width, mut height, mut sum) = (width as usize, height as usize, 0);
    loop {
        sum += width * height;
        if width <= 1 && height <= 1 {
            return sum;
        }
        width = if width > 1 { width / 2 } else { 1 };
        height = if height > 1 { height / 2 } else { 1 };
    }
}

/// Fills all mip levels after the first, each from the previous one. `texels` holds [`mip_texels`] texels, of which the
/// first level is already filled in. Every texel is the mean of the area that it covers, so no row of an image with an
/// odd size is lost.
pub fn fill_mip_levels(width: u32, height: u32, texels: &mut [[u8; 4]]) {
    fill_levels(width, height, texels, ColourSpace::AsGiven);
}

/// Fills the mip levels of a texture in sRGB, like [`fill_mip_levels`]. Colours are averaged in linear light; alpha is
/// linear already.
pub fn fill_srgb_mip_levels(width: u32, height: u32, texels: &mut [[u8; 4]]) {
    fill_levels(width, height, texels, ColourSpace::Srgb);
}

pub(crate) fn fill_levels(width: u32, height: u32, texels: &mut [[u8; 4]], space: ColourSpace) {
    let means = Means::new(space);
    let (mut width, mut height) = (width as usize, height as usize);
    let mut rest = texels;
    while width > 1 || height > 1 {
        let (fine, coarse) = rest.split_at_mut(width * height);
        let (half_width, half_height) = ((width / 2).max(1), (height / 2).max(1));
        for row in 0..half_height {
            for column in 0..half_width {
                let (across, down) = (span(column, half_width, width), span(row, half_height, height));
                coarse[row * half_width + column] = means.of_area(fine, width, across, down);
            }
        }
        (width, height, rest) = (half_width, half_height, coarse);
    }
}

/// The interval of fine texels that the coarse texel `index` covers: start and end, in units of 1/`coarse` texel.
pub(super) fn span(index: usize, coarse: usize, fine: usize) -> (usize, usize, usize) {
    (index * fine, (index + 1) * fine, coarse)
}

/// Computes means of texels.
pub(super) struct Means {
    colour: Amounts,
    alpha: Amounts,
}

impl Means {
    pub(super) fn new(space: ColourSpace) -> Self {
        Self { colour: Amounts::new(space), alpha: Amounts::new(ColourSpace::AsGiven) }
    }

    /// The mean of an area, which is given by its [spans](span) across and down, of texels in rows of `width`.
    pub(super) fn of_area(
        &self,
        fine: &[[u8; 4]],
        width: usize,
        (left, right, x_unit): (usize, usize, usize),
        (top, bottom, y_unit): (usize, usize, usize),
    ) -> [u8; 4] {
        let mut sum = [0_u64; 4];
        for row in top / y_unit..bottom.div_ceil(y_unit) {
            let y_weight = bottom.min((row + 1) * y_unit) - top.max(row * y_unit);
            for column in left / x_unit..right.div_ceil(x_unit) {
                let weight =
                    (y_weight * (right.min((column + 1) * x_unit) - left.max(column * x_unit))) as u64;
                self.add(&mut sum, fine[row * width + column], weight);
            }
        }
        self.back(sum, ((right - left) * (bottom - top)) as u64)
    }

    /// The mean of three texels.
    pub(super) fn of_three(&self, texels: [[u8; 4]; 3]) -> [u8; 4] {
        let mut sum = [0; 4];
        for texel in texels {
            self.add(&mut sum, texel, 1);
        }
        self.back(sum, 3)
    }

    fn of_channel(&self, channel: usize) -> &Amounts {
        if channel < 3 { &self.colour } else { &self.alpha }
    }

    fn add(&self, sum: &mut [u64; 4], texel: [u8; 4], weight: u64) {
        for (channel, value) in texel.into_iter().enumerate() {
            sum[channel] += weight * u64::from(self.of_channel(channel).of[usize::from(value)]);
        }
    }

    fn back(&self, sum: [u64; 4], weight: u64) -> [u8; 4] {
        core::array::from_fn(|channel| self.of_channel(channel).back((sum[channel] + weight / 2) / weight))
    }
}

/// The linear amount for each byte value, for averaging.
struct Amounts {
    of: [u32; 256],
    space: ColourSpace,
}

impl Amounts {
    /// Full scale in linear light, with enough digits for the darkest sRGB byte.
    const LINEAR: f32 = 16_777_215.0;

    fn new(space: ColourSpace) -> Self {
        let of = core::array::from_fn(|byte| match space {
            ColourSpace::AsGiven => byte as u32,
            ColourSpace::Srgb => (srgb::decode(byte as f32 / 255.0) * Self::LINEAR + 0.5) as u32,
        });
        Self { of, space }
    }

    fn back(&self, mean: u64) -> u8 {
        match self.space {
            ColourSpace::AsGiven => mean as u8,
            ColourSpace::Srgb => (srgb::encode(mean as f32 / Self::LINEAR) * 255.0 + 0.5) as u8,
        }
    }
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn every_level_keeps_the_mean() {
        // 5 × 3, one white texel: an average over the covered area keeps its share at every level.
        let mut texels = vec![[0_u8; 4]; mip_texels(5, 3)];
        texels[14] = [255; 4];
        fill_mip_levels(5, 3, &mut texels);
        assert_eq!(mip_levels(5, 3), 3);
        assert_eq!(texels.len(), 15 + 2 + 1);
        assert_eq!(texels[17][0], 17, "255 / 15, the mean of the picture");
    }
}
