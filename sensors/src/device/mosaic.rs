//! Colour filters over the pixels of a sensor (B. E. Bayer, US patent 3,971,065, 1976).

use crate::shade::Colours;
use crate::simd::{LANES, Lanes, WIDTH};
use crate::trace::grid::tiling::BLOCKS;

/// The colours of the first two pixels of the first row, then of the second row; this square of 2 × 2 repeats.
///
/// ```
/// use belvedere_sensors::camera::Mosaic;
/// assert_eq!(Mosaic::Grbg.channel(0, 0), 1); // green
/// assert_eq!(Mosaic::Grbg.channel(1, 0), 0); // red
/// assert_eq!(Mosaic::Grbg.channel(0, 1), 2); // blue
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mosaic {
    /// Red and green, then green and blue.
    Rggb,
    /// Blue and green, then green and red.
    Bggr,
    /// Green and blue, then red and green.
    Gbrg,
    /// Green and red, then blue and green.
    Grbg,
}

impl Mosaic {
    /// All mosaics.
    pub const ALL: [Self; 4] = [Self::Rggb, Self::Bggr, Self::Gbrg, Self::Grbg];

    /// Returns the colour that the pixel at the given column and row sees: 0 red, 1 green, 2 blue.
    #[must_use]
    pub const fn channel(self, column: usize, row: usize) -> usize {
        let square = match self {
            Self::Rggb => [0, 1, 1, 2],
            Self::Bggr => [2, 1, 1, 0],
            Self::Gbrg => [1, 2, 0, 1],
            Self::Grbg => [1, 0, 2, 1],
        };
        square[row % 2 * 2 + column % 2]
    }

    /// The colour that each pixel of a tile sees. `lines` holds the positions of the first pixels of the tile's lines,
    /// whose columns are even.
    #[inline(always)]
    pub(crate) fn pick(self, colours: &Colours, lines: &[[usize; 2]; BLOCKS]) -> Lanes<f32> {
        let mut seen = [0.0; LANES];
        for (line, seen) in seen.as_chunks_mut::<WIDTH>().0.iter_mut().enumerate() {
            let [_, row] = lines[line];
            let [even, odd] = [0, 1].map(|column| &colours[self.channel(column, row)]);
            for column in 0..WIDTH {
                let lane = line * WIDTH + column;
                seen[column] = if column % 2 == 0 { even[lane] } else { odd[lane] };
            }
        }
        seen
    }
}
