//! Shapes of parry3d in a scene (feature `parry`).
//!
//! The shapes of parry3d are converted exactly: no round shape is approximated by triangles. A shape becomes one or
//! more [`Part`]s, each with its own pose in the shape's frame, since the cylinders, cones and height fields of parry3d
//! are aligned with y and those of this crate with z, and since a compound consists of several shapes.
//!
//! | parry3d | this crate |
//! |---|---|
//! | `Ball`, `Cuboid`, `Cylinder`, `Cone` | [`Shape::Sphere`], [`Shape::Box`], [`Shape::Cylinder`], [`Shape::Cone`] |
//! | `Capsule` between any two points | [`Shape::Capsule`], or a sphere if the points coincide |
//! | `HalfSpace` | [`Shape::Plane`] |
//! | `HeightField` | [`Shape::HeightField`], or a mesh if cells are removed or split along the other diagonal |
//! | `TriMesh`, `ConvexPolyhedron`, `Triangle`, `Voxels` | [`Shape::Mesh`] |
//! | `Compound` | its parts |
//! | `RoundCuboid` and similar | the shape without rounding if the radius is 0, otherwise [`ParryError::NotTraced`] |
//! | `Segment`, `Polyline`, custom shapes | [`ParryError::NotTraced`] |

mod convert;

use crate::pose::Pose;
use crate::scene::{InstanceConfig, SceneBuilder, SceneError, Shape};
use alloc::vec::Vec;
use glam::DVec3;

/// A part of a parry3d shape, as it will be shown by an instance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// The shape of the part.
    pub shape: Shape,
    /// Pose in the (scaled) frame of the parry3d shape.
    pub shape_from_part: Pose,
    /// Scale along the part's own axes.
    pub scale: [f64; 3],
}

impl Part {
    /// Returns the configuration of an instance that shows this part. `look` describes the whole shape: its `shape` and
    /// `scale` are replaced, and its pose in the world is converted to that of the part.
    #[must_use]
    pub fn instance(&self, look: &InstanceConfig) -> InstanceConfig {
        InstanceConfig {
            shape: self.shape,
            world_from_instance: look.world_from_instance * self.shape_from_part,
            scale: self.scale,
            ..*look
        }
    }
}

/// The reason why a parry3d shape cannot be added to a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ParryError {
    /// There is no exact way to trace shapes of this kind.
    NotTraced(&'static str),
    /// A part of this kind is scaled along axes other than its own, which would shear it.
    Sheared(&'static str),
    /// The scene rejects the shape.
    Scene(SceneError),
}

impl core::fmt::Display for ParryError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotTraced(kind) => {
                write!(
                    f,
                    "a {kind} of parry3d cannot be traced exactly: use another shape, or a TriMesh of it"
                )
            }
            Self::Sheared(kind) => {
                write!(
                    f,
                    "the scale would shear a {kind}: scale all axes alike, or along those of the {kind}"
                )
            }
            Self::Scene(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ParryError {}

impl From<SceneError> for ParryError {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

impl SceneBuilder {
    /// Adds the meshes and height fields of a parry3d shape that is scaled along the axes of its own frame.
    ///
    /// Returns the parts of which the shape consists. Use [`Part::instance`] to make an instance of each, as often as
    /// the shape is to be shown.
    ///
    /// ```
    /// use belvedere_sensors::{Pose, glam::DVec3, scene::*};
    /// use parry3d::shape::Cylinder;
    /// let mut builder = SceneBuilder::new();
    /// let material = builder.add_material(&MaterialConfig::default())?;
    /// // Upright in the world: parry3d's y is turned up.
    /// let upright = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::X * core::f64::consts::FRAC_PI_2);
    /// let look = InstanceConfig { material, world_from_instance: upright, ..Default::default() };
    /// for part in builder.add_parry_shape(&Cylinder::new(0.5, 0.2), [1.0; 3])? {
    ///     assert_eq!(part.shape, Shape::Cylinder { radius: f64::from(0.2_f32), length: 1.0 });
    ///     builder.add_instance(&part.instance(&look))?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ParryError`]; nothing of the shape is then added to the scene.
    pub fn add_parry_shape(
        &mut self,
        shape: &dyn parry3d::shape::Shape,
        scale: [f64; 3],
    ) -> Result<Vec<Part>, ParryError> {
        if !scale.iter().all(|factor| factor.is_finite() && *factor != 0.0) {
            return Err(SceneError::BadScale.into());
        }
        let mut parts = Vec::new();
        let added = convert::Converter { builder: self, scale: DVec3::from_array(scale), parts: &mut parts }
            .add(shape.as_typed_shape(), Pose::IDENTITY);
        if let Err(error) = added {
            self.remove_parry_shape(&parts)?;
            return Err(error);
        }
        Ok(parts)
    }

    /// Removes the meshes and height fields of a shape that [`SceneBuilder::add_parry_shape`] added.
    ///
    /// # Errors
    /// [`SceneError::InUse`] if there are still instances of them.
    pub fn remove_parry_shape(&mut self, parts: &[Part]) -> Result<(), SceneError> {
        parts.iter().try_for_each(|part| match part.shape {
            Shape::Mesh(mesh) => self.remove_mesh(mesh),
            Shape::HeightField(field) => self.remove_height_field(field),
            _ => Ok(()),
        })
    }
}
