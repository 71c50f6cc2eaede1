//! Cube textures: six square images around a point, which are looked up by a direction.
//!
//! Each mip level has the six faces one after the other. A face is stored with a border of one texel on each side, which
//! belongs to its neighbours, so that linear filtering sees no seam. The texels at the corners of the border are the
//! means of the three that meet there.

use super::texture::{
    CUBE, ColourSpace, Means, Texture, TextureId, fill_levels, mip_levels, mip_texels, span,
};

/// The faces of a cube texture, in their order: the axis on which the face lies, and the directions to the right and
/// down in its image.
const FACES: [[[i32; 3]; 3]; 6] = [
    [[1, 0, 0], [0, 0, -1], [0, -1, 0]],
    [[-1, 0, 0], [0, 0, 1], [0, -1, 0]],
    [[0, 1, 0], [1, 0, 0], [0, 0, 1]],
    [[0, -1, 0], [1, 0, 0], [0, 0, -1]],
    [[0, 0, 1], [1, 0, 0], [0, -1, 0]],
    [[0, 0, -1], [-1, 0, 0], [0, -1, 0]],
];

/// A cube texture around a shape.
///
/// It is looked up by the direction from the shape's origin to the point that was hit, along the shape's own axes, after
/// solids were stretched to reach from −1 to 1 along each axis. Of a capsule, that is done with its straight part, and
/// the ends get a radius of 1. Planes, meshes and height fields are not stretched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeTexture {
    /// The texture, added by [`SceneBuilder::add_cube_texture`](super::SceneBuilder::add_cube_texture).
    pub texture: TextureId,
    /// Factors of the direction along the axes.
    pub stretch: [f32; 3],
}

impl CubeTexture {
    /// A cube texture that fits the shape.
    pub const fn new(texture: TextureId) -> Self {
        Self { texture, stretch: [1.0; 3] }
    }
}

impl Texture {
    /// Describes a cube texture with faces of `size` × `size` texels, which starts at index `first_texel` of the
    /// scene's texels: [`cube_texels`] of them, as filled by [`fill_cube`].
    pub const fn cube(size: u32, first_texel: u32) -> Self {
        Self { first_texel, width: size, height: size, levels: mip_levels(size, size), kind: CUBE }
    }

    /// Returns true for a cube texture.
    #[inline(always)]
    pub(crate) const fn is_cube(&self) -> bool {
        self.kind == CUBE
    }

    /// Number of texels of all mip levels together.
    pub(crate) const fn texels(&self) -> usize {
        if self.is_cube() { cube_texels(self.width) } else { mip_texels(self.width, self.height) }
    }

    /// Fills all mip levels after the first.
    pub(crate) fn fill(&self, texels: &mut [[u8; 4]], space: ColourSpace) {
        if self.is_cube() {
            fill_cube_levels(self.width, texels, space);
        } else {
            fill_levels(self.width, self.height, texels, space);
        }
    }
}

/// Number of texels of all mip levels of a cube texture together, with their borders.
pub const fn cube_texels(size: u32) -> usize {
    let (mut size, mut sum) = (size as usize, 0);
    loop {
        sum += level_texels(size);
        if size <= 1 {
            return sum;
        }
        size /= 2;
    }
}

/// Fills the [`cube_texels`] texels of a cube texture from its six faces of `size` × `size` texels, one after the other.
pub fn fill_cube(size: u32, faces: &[[u8; 4]], texels: &mut [[u8; 4]], space: ColourSpace) {
    let side = size as usize;
    for (number, row) in faces.chunks_exact(side).enumerate() {
        let start = index(side, number / side, number % side + 1, 1);
        texels[start..start + side].copy_from_slice(row);
    }
    fill_cube_levels(size, texels, space);
}

/// Fills the borders, and all mip levels after the first.
fn fill_cube_levels(size: u32, texels: &mut [[u8; 4]], space: ColourSpace) {
    let means = Means::new(space);
    let (mut size, mut rest) = (size as usize, texels);
    loop {
        let (fine, coarse) = rest.split_at_mut(level_texels(size));
        fill_borders(size, fine, &means);
        if size <= 1 {
            return;
        }
        let half = size / 2;
        for face in 0..6 {
            let own = &fine[index(size, face, 1, 1)..];
            for row in 0..half {
                for column in 0..half {
                    let (across, down) = (span(column, half, size), span(row, half, size));
                    coarse[index(half, face, row + 1, column + 1)] =
                        means.of_area(own, size + 2, across, down);
                }
            }
        }
        (size, rest) = (half, coarse);
    }
}

/// Number of texels of a mip level.
const fn level_texels(size: usize) -> usize {
    6 * (size + 2) * (size + 2)
}

/// The index of a texel in its level. Rows and columns count from the border.
const fn index(size: usize, face: usize, row: usize, column: usize) -> usize {
    (face * (size + 2) + row) * (size + 2) + column
}

fn fill_borders(size: usize, level: &mut [[u8; 4]], means: &Means) {
    // In units of half a texel, a face lies at a distance of `size` and has its texels at `place`.
    let (edge, last) = (size as i32, size as i32 - 1);
    for (face, &[axis, right, down]) in FACES.iter().enumerate() {
        for number in 0..size {
            let place = 2 * number as i32 - last;
            for (row, column, x, y) in [
                (number + 1, 0, -edge, place),
                (number + 1, size + 1, edge, place),
                (0, number + 1, place, -edge),
                (size + 1, number + 1, place, edge),
            ] {
                // The texel is beyond the edge, and so half a texel away from it on the next face.
                let beyond = [0, 1, 2].map(|i| axis[i] * last + right[i] * x + down[i] * y);
                level[index(size, face, row, column)] = level[texel_at(size, beyond)];
            }
        }
        for (row, inner_row) in [(0, 1), (size + 1, size)] {
            for (column, inner_column) in [(0, 1), (size + 1, size)] {
                let three = [(inner_row, inner_column), (inner_row, column), (row, inner_column)];
                let three = three.map(|(row, column)| level[index(size, face, row, column)]);
                level[index(size, face, row, column)] = means.of_three(three);
            }
        }
    }
}

/// The index of the texel whose centre is at a point on a face, in units of half a texel.
fn texel_at(size: usize, point: [i32; 3]) -> usize {
    let along = |axis: [i32; 3]| axis[0] * point[0] + axis[1] * point[1] + axis[2] * point[2];
    let face = FACES.iter().position(|[axis, ..]| along(*axis) == size as i32).unwrap_or(0);
    let [_, right, down] = FACES[face].map(|axis| (along(axis) + size as i32 + 1) as usize / 2);
    index(size, face, down, right)
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use alloc::vec;
    use alloc::vec::Vec;

    #[test]
    fn borders_continue_on_the_next_face() {
        // Each texel of the faces has its own value.
        let faces: Vec<[u8; 4]> = (0..6 * 9).map(|value| [value; 4]).collect();
        let mut texels = vec![[0; 4]; cube_texels(3)];
        fill_cube(3, &faces, &mut texels, ColourSpace::AsGiven);
        assert_eq!(texels.len(), 6 * 25 + 6 * 9);
        let at = |face, row, column| texels[index(3, face, row, column)][0];
        let face = |face: u8, row: u8, column: u8| 9 * face + 3 * row + column;
        // +x (0) is to the right of +z (4), −x (1) to its left, +y (2) above and −y (3) below.
        for i in 0..3 {
            let row = usize::from(i) + 1;
            assert_eq!(at(4, row, 4), face(0, i, 0));
            assert_eq!(at(4, row, 0), face(1, i, 2));
            assert_eq!(at(4, 0, row), face(2, 2, i));
            assert_eq!(at(4, 4, row), face(3, 0, i));
            // Above +x, +y is turned: the edge at its right, from below upwards.
            assert_eq!(at(0, 0, row), face(2, 2 - i, 2));
        }
        let three = [face(4, 0, 2), face(0, 0, 0), face(2, 2, 2)].map(u32::from);
        assert_eq!(u32::from(at(4, 0, 4)), (three.iter().sum::<u32>() + 1) / 3);
    }
}
