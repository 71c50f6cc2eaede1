//! Shapes and instances.

use super::kind::{Kind, Solid, Triangles};
use super::{SceneError, limits};
use crate::pose::Pose;
use bytemuck::{Pod, Zeroable};
use glam::DMat3;

/// A shape, centred on the origin of its own frame. Lengths are in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A box.
    Box {
        /// Full edge lengths along x, y and z.
        size: [f64; 3],
    },
    /// The rectangle |x| ≤ `size[0]`/2, |y| ≤ `size[1]`/2 in the plane z = 0, facing +z.
    Rectangle {
        /// Full edge lengths along x and y.
        size: [f64; 2],
    },
    /// The infinite plane z = 0, facing +z. A ray parallel to it misses it.
    Plane,
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// The ellipsoid (x/a)² + (y/b)² + (z/c)² ≤ 1.
    Ellipsoid {
        /// The semi-axes a, b and c.
        radii: [f64; 3],
    },
    /// A closed cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Full length.
        length: f64,
    },
    /// A cylinder along z with hemispherical caps at both ends.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length without the caps.
        length: f64,
    },
    /// A closed cone along z: its base at −`length`/2, its apex at +`length`/2.
    Cone {
        /// Radius of the base.
        radius: f64,
        /// Full length.
        length: f64,
    },
    /// A triangle mesh of the scene.
    Mesh(MeshId),
    /// A height field of the scene, facing +z. Below it, and beyond its edges, there is nothing.
    HeightField(HeightFieldId),
}

/// Index of a mesh in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MeshId(pub u32);

/// Index of a height field in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct HeightFieldId(pub u32);

/// Index of a material in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// Index of an instance in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct InstanceId(pub u32);

/// Bits that determine which sensors see an instance; see [`InstanceConfig::visibility`].
pub mod visibility {
    /// Seen by cameras and depth cameras.
    pub const VISUAL: u32 = 1;
    /// Hit by lidars and range finders.
    pub const COLLISION: u32 = 2;
}

/// The configuration of an [`Instance`].
#[derive(Debug, Clone, Copy)]
pub struct InstanceConfig {
    /// The shape. The default is a box with edges of 1 m.
    pub shape: Shape,
    /// Pose at which the instance is added. A [`SceneBuilder`](super::SceneBuilder) stores it next to the instance,
    /// which itself has no pose. The default is [`Pose::IDENTITY`].
    pub world_from_instance: Pose,
    /// Scale factors along the instance's axes, applied before rotation and translation. Negative factors mirror the
    /// shape. The outside of a shape stays its outside, also for a mirrored mesh. The default is 1 along each axis.
    pub scale: [f64; 3],
    /// The material. Lidars ignore it, except for the intensities of a [`Scanner`](crate::scanner::Scanner). The
    /// default is 0, the scene's first.
    pub material: MaterialId,
    /// Visibility mask. A sensor sees the instance if the two masks share a bit. The default is both bits of
    /// [`visibility`].
    pub visibility: u32,
    /// The intensity that a lidar reports for the instance. The default is 0.
    pub laser_retro: f32,
    /// Semantic class, as reported by [`Truth::class`](crate::trace::Truth::class); 0 means unlabelled. The default is
    /// 0.
    pub class: u32,
}

impl Default for InstanceConfig {
    /// A cube of 1 m at the world's origin, unscaled, in the scene's first material, visible to all sensors, with lidar
    /// intensity 0.
    fn default() -> Self {
        Self {
            shape: Shape::Box { size: [1.0; 3] },
            world_from_instance: Pose::IDENTITY,
            scale: [1.0; 3],
            material: MaterialId(0),
            visibility: visibility::VISUAL | visibility::COLLISION,
            laser_retro: 0.0,
            class: 0,
        }
    }
}

/// An instance as it is stored in a scene. Its pose is given by a [`Moment`](crate::Moment).
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    /// Box and rectangle: half edge lengths. Sphere: radius. Ellipsoid: semi-axes. Cylinder, capsule, cone: radius,
    /// half length.
    pub(crate) size: [f64; 3],
    pub(crate) scale: [f64; 3],
    /// The number of its [`Kind`].
    pub(super) kind: u32,
    /// Index of the mesh or height field, if the kind is one of these.
    pub(crate) mesh: u32,
    pub(crate) material: u32,
    pub(crate) visibility: u32,
    pub(crate) laser_retro: f32,
    pub(crate) class: u32,
}

impl Instance {
    /// Checks and packs a configuration, except for its pose. The scene checks indices when the instance is added.
    ///
    /// # Errors
    /// [`SceneError::BadSize`], [`SceneError::BadScale`], [`SceneError::BadPose`].
    pub fn new(config: &InstanceConfig) -> Result<Self, SceneError> {
        let (kind, size, mesh) = match config.shape {
            Shape::Box { size } => (Kind::Solid(Solid::Box), size.map(|edge| edge * 0.5), 0),
            Shape::Rectangle { size: [x, y] } => (Kind::Solid(Solid::Rectangle), [x * 0.5, y * 0.5, 1.0], 0),
            Shape::Plane => (Kind::Solid(Solid::Plane), [1.0; 3], 0),
            Shape::Sphere { radius } => (Kind::Solid(Solid::Sphere), [radius, 1.0, 1.0], 0),
            Shape::Ellipsoid { radii } => (Kind::Solid(Solid::Ellipsoid), radii, 0),
            Shape::Cylinder { radius, length } => {
                (Kind::Solid(Solid::Cylinder), [radius, length * 0.5, 1.0], 0)
            }
            Shape::Capsule { radius, length } => {
                (Kind::Solid(Solid::Capsule), [radius, length * 0.5, 1.0], 0)
            }
            Shape::Cone { radius, length } => (Kind::Solid(Solid::Cone), [radius, length * 0.5, 1.0], 0),
            Shape::Mesh(mesh) => (Kind::Triangles(Triangles::Mesh), [1.0; 3], mesh.0),
            Shape::HeightField(field) => (Kind::Triangles(Triangles::HeightField), [1.0; 3], field.0),
        };
        let instance = Self {
            size,
            scale: config.scale,
            kind: kind.number(),
            mesh,
            material: config.material.0,
            visibility: config.visibility,
            laser_retro: config.laser_retro,
            class: config.class,
        };
        limits::instance(instance.size, instance.scale)?;
        limits::pose(&config.world_from_instance)?;
        Ok(instance)
    }

    /// The semantic [class](InstanceConfig::class).
    pub const fn class(&self) -> u32 {
        self.class
    }

    /// The kind of the shape.
    #[inline(always)]
    pub(crate) fn kind(&self) -> Kind {
        Kind::of_checked(self.kind)
    }

    /// The instance's axes in the world, rotated and scaled. `axes` are only rotated.
    pub(crate) fn scaled_axes(&self, axes: &DMat3) -> DMat3 {
        let [x, y, z] = self.scale;
        DMat3::from_cols(axes.x_axis * x, axes.y_axis * y, axes.z_axis * z)
    }

    /// The inverse of [`Instance::scaled_axes`].
    pub(crate) fn inverse_scaled_axes(&self, axes: &DMat3) -> DMat3 {
        let [x, y, z] = self.scale;
        DMat3::from_cols(axes.x_axis / x, axes.y_axis / y, axes.z_axis / z).transpose()
    }
}
