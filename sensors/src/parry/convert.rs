//! Conversion of the shapes of parry3d to those of this crate.

use super::{ParryError, Part};
use crate::pose::Pose;
use crate::scene::{SceneBuilder, Shape};
use alloc::vec::Vec;
use core::f64::consts::FRAC_1_SQRT_2;
use glam::{DMat3, DQuat, DVec3};
use parry3d::math::Vector;
use parry3d::shape::{Capsule, HalfSpace, HeightField, HeightFieldCellStatus, TypedShape};

/// Rotates z to the y axis of parry3d, and y to its −z axis.
const Y_FROM_Z: DQuat = DQuat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// Tolerance in radians for a scale to count as aligned with the part's own axes. The rotations of parry3d are no more
/// accurate than that.
const ALIGNED: f64 = 1e-6;

pub(super) struct Converter<'a> {
    pub(super) builder: &'a mut SceneBuilder,
    /// Scale along the axes of the outermost shape.
    pub(super) scale: DVec3,
    pub(super) parts: &'a mut Vec<Part>,
}

impl Converter<'_> {
    /// Adds the parts of a shape; `outer_from_shape` is its pose in the outermost shape before scaling.
    pub(super) fn add(&mut self, shape: TypedShape<'_>, outer_from_shape: Pose) -> Result<(), ParryError> {
        let along_y = Pose::new(DVec3::ZERO, Y_FROM_Z);
        let (name, shape, shape_from_part) = match shape {
            TypedShape::Ball(ball) => {
                ("Ball", Shape::Sphere { radius: f64::from(ball.radius) }, Pose::IDENTITY)
            }
            TypedShape::Cuboid(cuboid) => {
                let size = (cuboid.half_extents.as_dvec3() * 2.0).to_array();
                ("Cuboid", Shape::Box { size }, Pose::IDENTITY)
            }
            TypedShape::Cylinder(cylinder) => {
                let (radius, length) = (f64::from(cylinder.radius), 2.0 * f64::from(cylinder.half_height));
                ("Cylinder", Shape::Cylinder { radius, length }, along_y)
            }
            TypedShape::Cone(cone) => {
                let (radius, length) = (f64::from(cone.radius), 2.0 * f64::from(cone.half_height));
                ("Cone", Shape::Cone { radius, length }, along_y)
            }
            TypedShape::Capsule(one) => {
                let (shape, shape_from_part) = capsule(one);
                ("Capsule", shape, shape_from_part)
            }
            TypedShape::HalfSpace(half_space) => {
                self.half_space(half_space, &outer_from_shape);
                return Ok(());
            }
            TypedShape::HeightField(field) => return self.height_field(field, outer_from_shape),
            TypedShape::Triangle(triangle) => {
                return self.mesh(
                    "Triangle",
                    &[triangle.a, triangle.b, triangle.c],
                    &[[0, 1, 2]],
                    outer_from_shape,
                );
            }
            TypedShape::TriMesh(mesh) => {
                return self.mesh("TriMesh", mesh.vertices(), mesh.indices(), outer_from_shape);
            }
            TypedShape::ConvexPolyhedron(solid) => {
                let (vertices, triangles) = solid.to_trimesh();
                return self.mesh("ConvexPolyhedron", &vertices, &triangles, outer_from_shape);
            }
            TypedShape::Voxels(voxels) => {
                let (vertices, triangles) = voxels.to_trimesh();
                return self.mesh("Voxels", &vertices, &triangles, outer_from_shape);
            }
            TypedShape::Compound(compound) => {
                for (outer_from_inner, inner) in compound.shapes() {
                    self.add(inner.as_typed_shape(), outer_from_shape * Pose::from(*outer_from_inner))?;
                }
                return Ok(());
            }
            TypedShape::RoundCuboid(round) if round.border_radius == 0.0 => {
                return self.add(TypedShape::Cuboid(&round.inner_shape), outer_from_shape);
            }
            TypedShape::RoundTriangle(round) if round.border_radius == 0.0 => {
                return self.add(TypedShape::Triangle(&round.inner_shape), outer_from_shape);
            }
            TypedShape::RoundCylinder(round) if round.border_radius == 0.0 => {
                return self.add(TypedShape::Cylinder(&round.inner_shape), outer_from_shape);
            }
            TypedShape::RoundCone(round) if round.border_radius == 0.0 => {
                return self.add(TypedShape::Cone(&round.inner_shape), outer_from_shape);
            }
            TypedShape::RoundConvexPolyhedron(round) if round.border_radius == 0.0 => {
                return self.add(TypedShape::ConvexPolyhedron(&round.inner_shape), outer_from_shape);
            }
            TypedShape::RoundCuboid(_) => return Err(ParryError::NotTraced("RoundCuboid")),
            TypedShape::RoundTriangle(_) => return Err(ParryError::NotTraced("RoundTriangle")),
            TypedShape::RoundCylinder(_) => return Err(ParryError::NotTraced("RoundCylinder")),
            TypedShape::RoundCone(_) => return Err(ParryError::NotTraced("RoundCone")),
            TypedShape::RoundConvexPolyhedron(_) => {
                return Err(ParryError::NotTraced("RoundConvexPolyhedron"));
            }
            TypedShape::Segment(_) => return Err(ParryError::NotTraced("Segment")),
            TypedShape::Polyline(_) => return Err(ParryError::NotTraced("Polyline")),
            TypedShape::Custom(_) => return Err(ParryError::NotTraced("custom shape")),
        };
        self.place(name, shape, outer_from_shape * shape_from_part, DVec3::ONE)
    }

    /// Adds a part with the pose `outer_from_part` and the scale `own` along its own axes, before the whole shape is
    /// scaled.
    fn place(
        &mut self,
        name: &'static str,
        shape: Shape,
        outer_from_part: Pose,
        own: DVec3,
    ) -> Result<(), ParryError> {
        // S·R = R·(Rᵀ·S·R), where the product in parentheses must be a scale along the axes.
        let rotation = outer_from_part.rotation_matrix();
        let inner = rotation.transpose() * DMat3::from_diagonal(self.scale) * rotation;
        let scale = DVec3::new(inner.x_axis.x, inner.y_axis.y, inner.z_axis.z);
        let rest = inner - DMat3::from_diagonal(scale);
        let most = rest.to_cols_array().into_iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // For uniform scales the difference is only rounding error, so the given scale is used unchanged.
        let uniform = self.scale == DVec3::splat(self.scale.x);
        let scale = if uniform { self.scale } else { scale };
        if !uniform && most > ALIGNED * self.scale.abs().min_element() {
            return Err(ParryError::Sheared(name));
        }
        self.parts.push(Part {
            shape,
            shape_from_part: Pose::new(
                outer_from_part.translation() * self.scale,
                outer_from_part.rotation(),
            ),
            scale: (scale * own).to_array(),
        });
        Ok(())
    }

    /// Adds a half-space, which stays one under any scale; its normal is transformed by the inverse transpose.
    fn half_space(&mut self, half_space: &HalfSpace, outer_from_shape: &Pose) {
        let normal = outer_from_shape.transform_vector(half_space.normal.as_dvec3()) / self.scale;
        self.parts.push(Part {
            shape: Shape::Plane,
            shape_from_part: Pose::new(
                outer_from_shape.translation() * self.scale,
                from_z_to(normal.normalize_or(DVec3::Z)),
            ),
            scale: [1.0; 3],
        });
    }

    fn mesh(
        &mut self,
        name: &'static str,
        vertices: &[Vector],
        triangles: &[[u32; 3]],
        outer_from_shape: Pose,
    ) -> Result<(), ParryError> {
        let positions: Vec<[f32; 3]> = vertices.iter().map(Vector::to_array).collect();
        let mesh = self.builder.add_mesh(&positions, &[], triangles)?;
        self.place(name, Shape::Mesh(mesh), outer_from_shape, DVec3::ONE)
    }

    fn height_field(&mut self, field: &HeightField, outer_from_shape: Pose) -> Result<(), ParryError> {
        let regular = HeightFieldCellStatus::default();
        if field.cells_statuses().data().iter().any(|status| *status != regular) {
            let (vertices, triangles) = field.to_trimesh();
            return self.mesh("HeightField", &vertices, &triangles, outer_from_shape);
        }
        // parry3d stores heights column by column; its rows run along z, which is −y of the part.
        let heights = field.heights();
        let (rows, columns) = (heights.nrows(), heights.ncols());
        let scale = field.scale();
        let row_by_row: Vec<f32> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| heights[(row, column)] * scale.y))
            .collect();
        let size = [f64::from(scale.x.abs()), f64::from(scale.z.abs())];
        let field = self.builder.add_height_field(rows as u32, columns as u32, size, &row_by_row)?;
        let mirror = DVec3::new(f64::from(scale.x.signum()), f64::from(scale.z.signum()), 1.0);
        let outer_from_part = outer_from_shape * Pose::new(DVec3::ZERO, Y_FROM_Z);
        self.place("HeightField", Shape::HeightField(field), outer_from_part, mirror)
    }
}

fn capsule(capsule: &Capsule) -> (Shape, Pose) {
    let (a, b) = (capsule.segment.a.as_dvec3(), capsule.segment.b.as_dvec3());
    let radius = f64::from(capsule.radius);
    let (length, middle) = ((b - a).length(), (a + b) * 0.5);
    if length <= 0.0 {
        return (Shape::Sphere { radius }, Pose::from_translation(middle));
    }
    (Shape::Capsule { radius, length }, Pose::new(middle, from_z_to((b - a) / length)))
}

/// A rotation that maps z to the given unit vector; exactly a quarter turn for ±x and ±y.
fn from_z_to(direction: DVec3) -> DQuat {
    // For −z there is no unique shortest rotation: use half a turn about x.
    if direction.z < -1.0 + 1e-12 {
        return DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    }
    let axis = DVec3::Z.cross(direction);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0 + direction.z).normalize()
}
