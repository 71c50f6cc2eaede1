//! Normals of a solid at the points that rays have hit, sixteen at a time.
//!
//! They are computed in single precision, from the points given by 1/t. The error corresponds to a shift of some 1e-4
//! of a pixel, no more than the rounding of the ray itself.

use crate::optics::rays::Points;
use crate::scene::Solid;
use crate::simd::WIDTH;
use crate::trace::placed::view::Placed;
use crate::trace::shapes::solid_normal;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};
use glam::{DMat3, DVec3};

/// The values that are the same for all points of a solid. Its first size is the unit of length.
#[derive(Clone, Copy)]
pub(crate) struct Curved {
    solid: Solid,
    /// The other sizes.
    size: [f32; 2],
    /// Rows of the matrix from the axes of the points to those of the instance, and the position of the sensor there.
    /// For a ball or an ellipsoid, whose normals are linear in the points, the matrix leads directly to the normals in
    /// the frame.
    rows: [[f32; 3]; 3],
    origin: [f32; 3],
    /// Rows of the matrix from the instance's normals to the frame's, up to a positive factor.
    normal_rows: [[f32; 3]; 3],
}

impl Curved {
    /// Creates the values for points in axes around the sensor. `rows` are those of the matrix from these axes to the
    /// instance's.
    pub(crate) fn new((solid, size): (Solid, [f64; 3]), placed: &Placed, rows: &[[f64; 3]; 3]) -> Self {
        let [per_size, b, c] = [1.0 / size[0], size[1] / size[0], size[2] / size[0]];
        // Scales may be so small or large that their squares would overflow.
        let to_frame = normal_to_frame(placed);
        let most = to_frame.to_cols_array().into_iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let to_frame = to_frame * (1.0 / most);
        let mut to_instance = DMat3::from_cols_array_2d(rows).transpose() * per_size;
        let mut origin = DVec3::from_array(placed.origin_in_instance) * per_size;
        let stretch = match solid {
            Solid::Sphere => Some(DVec3::ONE),
            Solid::Ellipsoid => Some(DVec3::new(1.0, 1.0 / (b * b), 1.0 / (c * c))),
            _ => None,
        };
        if let Some(stretch) = stretch {
            let to_frame = to_frame * DMat3::from_diagonal(stretch);
            (to_instance, origin) = (to_frame * to_instance, to_frame * origin);
        }
        Self {
            solid,
            size: [b as f32, c as f32],
            rows: to_instance.transpose().as_mat3().to_cols_array_2d(),
            origin: origin.as_vec3().to_array(),
            normal_rows: to_frame.transpose().as_mat3().to_cols_array_2d(),
        }
    }

    /// Outward unit normals in the frame at points of the surface; undefined for other points.
    #[inline(always)]
    pub(crate) fn normals<S: Simd>(&self, simd: S, points: &Points<S>) -> Points<S> {
        let mut normals = *points;
        for axis in 0..3 {
            normals[axis] = along(points, self.rows[axis]) + self.origin[axis];
        }
        if !matches!(self.solid, Solid::Sphere | Solid::Ellipsoid) {
            let local = self.of_local(simd, &normals);
            for axis in 0..3 {
                normals[axis] = along(&local, self.normal_rows[axis]);
            }
        }
        let [x, y, z] = normals;
        let length = ((x * x + y * y) + z * z).sqrt();
        let zero = f32x16::splat(simd, 0.0);
        let shorter = length.simd_gt(zero).select(f32x16::splat(simd, 1.0) / length, zero);
        [x * shorter, y * shorter, z * shorter]
    }

    /// Normals in the axes of the instance, of any positive length.
    #[inline(always)]
    fn of_local<S: Simd>(&self, simd: S, points: &Points<S>) -> Points<S> {
        let (mut local, mut normals) = ([[0.0; WIDTH]; 3], [[0.0; WIDTH]; 3]);
        for axis in 0..3 {
            points[axis].store_array(&mut local[axis]);
        }
        let [x, y, z] = &local;
        let size = [1.0, self.size[0], self.size[1]];
        macro_rules! each_lane {
            ($($solid:ident),*) => {
                match self.solid {
                    $(Solid::$solid => for lane in 0..WIDTH {
                        let [a, b, c] = solid_normal(Solid::$solid, size, [x[lane], y[lane], z[lane]]);
                        normals[0][lane] = a;
                        normals[1][lane] = b;
                        normals[2][lane] = c;
                    })*
                }
            };
        }
        each_lane!(Box, Rectangle, Sphere, Cylinder, Capsule, Plane, Ellipsoid, Cone);
        let [x, y, z] = &normals;
        [f32x16::load_array_ref(simd, x), f32x16::load_array_ref(simd, y), f32x16::load_array_ref(simd, z)]
    }
}

/// Normals are transformed by the inverse transpose, whose columns are the rows of the inverse.
pub(in crate::trace) fn normal_to_frame(placed: &Placed) -> DMat3 {
    DMat3::from_cols_array_2d(&placed.inverse)
}

/// Dot products with a vector.
#[inline(always)]
pub(in crate::trace) fn along<S: Simd>([x, y, z]: &Points<S>, [a, b, c]: [f32; 3]) -> f32x16<S> {
    (*x * a + *y * b) + *z * c
}
