//! Meshes put together from boxes, cylinders and grids.

use super::Mesh;
use core::f64::consts::PI;
use glam::DVec3;

/// A mesh to which solids are added; coordinates are converted to single precision at the end.
#[derive(Default)]
pub struct Solids {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

const BOX_FACES: [[u32; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

impl Solids {
    /// Adds vertices, and triangles whose indices start at the first of these vertices.
    pub fn add(
        &mut self,
        vertices: impl IntoIterator<Item = DVec3>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
    ) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(vertices);
        self.triangles.extend(triangles.into_iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }

    /// Adds a box of half edges `half`, rotated about its z axis.
    pub fn cuboid(&mut self, centre: [f64; 3], half: [f64; 3], yaw_rad: f64) {
        let (sin, cos) = libm::sincos(yaw_rad);
        let sign = |corner: u32, bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let corners = (0..8).map(|corner| {
            let [x, y, z] = [0, 1, 2].map(|axis| sign(corner, axis) * half[axis as usize]);
            DVec3::new(x * cos - y * sin, x * sin + y * cos, z) + DVec3::from_array(centre)
        });
        self.add(corners, BOX_FACES);
    }

    /// Adds a closed cylinder along z.
    pub fn cylinder(&mut self, centre: [f64; 3], radius: f64, half_height: f64, sides: u32) {
        let rim = |z: f64| {
            (0..sides).map(move |side| {
                let (sin, cos) = libm::sincos(f64::from(side) * 2.0 * PI / f64::from(sides));
                DVec3::new(cos * radius, sin * radius, z)
            })
        };
        let middles = [DVec3::new(0.0, 0.0, -half_height), DVec3::new(0.0, 0.0, half_height)];
        let vertices = rim(-half_height).chain(rim(half_height)).chain(middles);
        let faces = (0..sides).flat_map(|side| {
            let next = (side + 1) % sides;
            [
                [side, next, sides + next],
                [side, sides + next, sides + side],
                [2 * sides, next, side],
                [2 * sides + 1, sides + side, sides + next],
            ]
        });
        self.add(vertices.map(|vertex| vertex + DVec3::from_array(centre)), faces);
    }

    /// Adds a surface over (`cells` + 1)² points: first all lower, then all upper triangles of the cells. `point`
    /// returns the position of the point in row i and column j; `flipped` reverses the orientation.
    pub fn grid(&mut self, cells: u32, flipped: bool, point: impl Fn(usize, usize) -> DVec3) {
        let points = cells + 1;
        let vertices = (0..points).flat_map(|i| (0..points).map(move |j| (i as usize, j as usize)));
        let cell = move |index: u32| {
            let (i, j) = (index / cells, index % cells);
            let at = |i: u32, j: u32| i * points + j;
            let mut corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if flipped {
                corners.reverse();
            }
            corners
        };
        let lower = (0..cells * cells).map(cell).map(|[a, b, c, _]| [a, b, c]);
        let upper = (0..cells * cells).map(cell).map(|[a, _, c, d]| [a, c, d]);
        self.add(vertices.map(|(i, j)| point(i, j)), lower.chain(upper));
    }

    /// Returns the mesh in single precision.
    pub fn finish(self) -> Mesh {
        Mesh {
            vertices: self.vertices.into_iter().map(|vertex| vertex.as_vec3().to_array()).collect(),
            triangles: self.triangles,
        }
    }
}
