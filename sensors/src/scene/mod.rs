//! Scenes: shapes, materials, textures and lights, in borrowed slices.
//!
//! A [`Scene`] borrows plain (`Pod`) data from an owner: a [`SceneBuilder`] with the feature `alloc`, a memory-mapped
//! file ([`Scene::from_baked`]), or the caller's own arrays if there is no heap ([`Scene::from_slices`]). The poses of
//! the instances are not part of the scene; a [`Moment`](crate::Moment) supplies them.
//!
//! The directions of the texture coordinates (u, v), u to the right and v up when the face is seen from outside:
//!
//! | face | right | up |
//! |---|---|---|
//! | box +x / −x | +y / −y | +z |
//! | box +y / −y | −x / +x | +z |
//! | box +z / −z | +x | +y / −y |
//! | rectangle (seen from +z) | +x | +y |
//! | plane (seen from +z) | +x | +y |
//! | height field (seen from above) | +x | +y |
//! | sphere, ellipsoid, capsule, side of cylinder and cone | once around, counter-clockwise from −x seen from +z | −z end to +z end |
//! | ends of a cylinder, base of a cone | +x | +y / −y |
//!
//! Both run from 0 to 1 over a face; on the infinite plane they are metres from its origin. They belong to the shape,
//! so the scale of an instance stretches the texture. Around an ellipsoid, u is the angle of (x/a, y/b). A
//! [`CubeTexture`] needs no coordinates.

mod aabb;
mod air;
#[cfg(feature = "alloc")]
mod baked;
pub mod build;
mod check;
mod cube;
mod fault;
mod height_field;
mod instance;
mod kind;
pub(crate) mod limits;
mod material;
mod mesh_slices;
mod meshes;
mod pbr;
#[cfg(feature = "raw")]
mod single;
mod slices;
mod texture;
pub mod tree;
mod validate;
mod variation;
mod vertices;

#[cfg(feature = "alloc")]
mod builder;

pub use aabb::Aabb;
pub use air::{Air, Fog, FogLaw, Sky};
pub use cube::{CubeTexture, cube_texels, fill_cube};
pub use fault::SceneFault;
pub(crate) use height_field::CORNERS;
pub use height_field::{HeightField, HeightGrid};
pub use instance::{
    HeightFieldId, Instance, InstanceConfig, InstanceId, MaterialId, MeshId, Shape, visibility,
};
pub(crate) use kind::{Kind, Solid, Triangles};
pub(crate) use material::{ALPHA_CUT_OUT, Form, NO_TEXTURE};
pub use material::{
    Environment, Light, LightConfig, LightId, LightKind, MAX_FALLOFF, MAX_SHININESS, Material, MaterialConfig,
};
pub use mesh_slices::MeshSlices;
pub use meshes::{MeshMemory, MeshStore, Meshes};
pub use pbr::Pbr;
#[cfg(feature = "raw")]
pub use single::MeshScene;
pub use slices::SceneSlices;
pub use texture::{
    ColourSpace, Texture, TextureAlpha, TextureId, TextureMode, fill_mip_levels, fill_srgb_mip_levels,
    mip_levels, mip_texels,
};

pub use validate::TreeFault;
#[cfg(feature = "raw")]
pub use validate::{validate_scratch_len, validate_tree};
pub use vertices::MAX_COORDINATE;

#[cfg(feature = "alloc")]
pub use baked::BakedError;
#[cfg(feature = "alloc")]
pub use builder::SceneBuilder;

use crate::simd::WIDTH;
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// A mesh as it is stored in a scene: its ranges of the scene's vertices, triangles and nodes.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Mesh {
    pub(crate) first_vertex: u32,
    pub(crate) vertices: u32,
    pub(crate) first_triangle: u32,
    pub(crate) triangles: u32,
    pub(crate) first_node: u32,
    pub(crate) nodes: u32,
    pub(crate) first_block: u32,
    pub(crate) blocks: u32,
    /// Corners of the bounding box.
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

/// A scene: everything that sensors can see, borrowed. Cheap to copy.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    pub(crate) instances: &'a [Instance],
    pub(crate) meshes: &'a [Mesh],
    /// One per vertex of the meshes; (0, 0) for meshes without texture coordinates.
    pub(crate) uvs: &'a [[f32; 2]],
    /// One unit normal per vertex, 0 for meshes without; or empty, if no mesh has normals.
    pub(crate) normals: &'a [[f32; 3]],
    /// Vertex indices relative to the first vertex of the mesh, in the order in which the triangles were given.
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) nodes: &'a [tree::WideNode],
    pub(crate) blocks: &'a [tree::TriangleBlock],
    /// Sixteen per block.
    pub(crate) facets: &'a [tree::Facet],
    pub(crate) height_fields: &'a [HeightField],
    pub(crate) heights: &'a [f32],
    /// Least and greatest heights below the nodes of the height fields' trees.
    pub(crate) extents: &'a [[f32; 2]],
    pub(crate) materials: &'a [Material],
    pub(crate) textures: &'a [Texture],
    pub(crate) texels: &'a [[u8; 4]],
    pub(crate) lights: &'a [Light],
    pub(crate) environment: Environment,
    pub(crate) air: Air,
    pub(crate) colour_space: ColourSpace,
}

impl<'a> Scene<'a> {
    /// The empty scene, in Gazebo's default light.
    pub(crate) const EMPTY: Self = Self {
        instances: &[],
        meshes: &[],
        uvs: &[],
        normals: &[],
        triangles: &[],
        nodes: &[],
        blocks: &[],
        facets: &[],
        height_fields: &[],
        heights: &[],
        extents: &[],
        materials: &[],
        textures: &[],
        texels: &[],
        lights: &[],
        environment: Environment::GAZEBO,
        air: Air { fog: None, sky: None },
        colour_space: ColourSpace::AsGiven,
    };

    /// Returns the lower and upper corner of the bounding box of an instance, along its own axes and with its scale
    /// applied, or `None` if there is no such instance. The box of an infinite plane is 2e15 m wide.
    pub fn bounds(&self, instance: usize) -> Option<[DVec3; 2]> {
        let instance = self.instances.get(instance)?;
        let [a, b] = self.local_bounds(instance).map(|corner| corner * DVec3::from_array(instance.scale));
        // A negative scale swaps them.
        Some([a.min(b), a.max(b)])
    }

    /// The instances, in the order in which they were added.
    pub fn instances(&self) -> &'a [Instance] {
        self.instances
    }

    /// The lamps.
    pub fn lights(&self) -> &'a [Light] {
        self.lights
    }

    /// The colour space of materials, textures and the background.
    pub fn colour_space(&self) -> ColourSpace {
        self.colour_space
    }

    /// Returns true if a mesh has normals of its vertices, between which shading interpolates.
    #[inline(always)]
    pub(crate) fn is_smooth(&self, mesh: u32) -> bool {
        // Most scenes have no normals at all.
        !self.normals.is_empty() && self.has_normals(mesh)
    }

    fn has_normals(&self, mesh: u32) -> bool {
        let first = self.meshes[mesh as usize].first_vertex as usize;
        // A mesh has a normal for each of its vertices, or for none.
        self.normals.get(first).is_some_and(|normal| *normal != [0.0; 3])
    }

    /// Returns true if the scene has textures.
    pub(crate) fn has_textures(&self) -> bool {
        !self.textures.is_empty()
    }

    /// Returns true if any lamp casts shadows.
    pub(crate) fn has_shadows(&self) -> bool {
        self.lights.iter().any(|light| light.cast_shadows != 0)
    }

    /// Number of slots of an instance: one per triangle that a ray may hit, one in total for any other shape.
    pub(crate) fn slots(&self, instance: &Instance) -> u32 {
        match instance.kind() {
            Kind::Solid(_) => 1,
            Kind::Triangles(Triangles::Mesh) => self.meshes[instance.mesh as usize].blocks * WIDTH as u32,
            Kind::Triangles(Triangles::HeightField) => {
                self.height_fields[instance.mesh as usize].blocks() * WIDTH as u32
            }
        }
    }

    /// Corners of the bounding box of an instance's surface in its own unscaled frame.
    pub(crate) fn local_bounds(&self, instance: &Instance) -> [DVec3; 2] {
        let corners = match instance.kind() {
            Kind::Solid(solid) => {
                let half = DVec3::from_array(solid.half_extents(instance.size));
                return [-half, half];
            }
            Kind::Triangles(Triangles::Mesh) => {
                let mesh = &self.meshes[instance.mesh as usize];
                [mesh.min, mesh.max]
            }
            Kind::Triangles(Triangles::HeightField) => {
                let field = &self.height_fields[instance.mesh as usize];
                HeightGrid::of(field, self.heights, self.extents).bounds()
            }
        };
        corners.map(|corner| DVec3::from_array(corner.map(f64::from)))
    }
}

/// The reason why a scene rejects something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneError {
    /// A length is not between 1e-12 m and 1e12 m.
    BadSize,
    /// A pose is not finite, its rotation is not a unit quaternion, or it is more than 1e12 m away along an axis.
    BadScale,
    /// A pose is not finite, its rotation is none, or it is more than 1e12 m away along an axis.
    BadPose,
    /// A lamp's position is not finite, or more than 1e12 m away along an axis.
    BadLight,
    /// The number of repetitions of a texture, or the stretch of a cube texture, is not finite, or beyond ±1e12.
    BadTextureRepeat,
    /// A shininess is not between 0 and [`MAX_SHININESS`].
    BadShininess,
    /// A roughness or metalness is not between 0 and 1.
    BadPbr,
    /// The distances or the density of fog, or a colour of fog or sky, is out of range.
    BadAir,
    /// An alpha, or the threshold of a cut-out texture, is not between 0 and 1.
    BadAlpha,
    /// A specular reflectance or transmittance is not between 0 and 1, or their sum is greater than 1.
    BadShares,
    /// The falloff of a spot is not between 0 and [`MAX_FALLOFF`].
    BadFalloff,
    /// The texture coordinates of the vertex with this index are not finite, or beyond ±1e12.
    BadUv(usize),
    /// The vertex with this index is not finite.
    BadVertex(usize),
    /// The vertex with this index is farther from the mesh's origin than [`MAX_COORDINATE`].
    VertexTooFar(usize),
    /// The triangle with this index refers to a vertex that does not exist.
    BadTriangle(usize),
    /// The number of texture coordinates is neither 0 nor the number of vertices.
    UvCount,
    /// The number of normals is neither 0 nor the number of vertices.
    NormalCount,
    /// The normal of the vertex with this index is not finite, or is 0.
    BadNormal(usize),
    /// A texture has no pixels, or the number of texels is not width × height.
    BadTexture,
    /// A cube texture has no pixels, or its faces are not six squares of one size.
    BadCube,
    /// The texture with this index is a cube texture where another one is expected, or the other way round.
    WrongTexture(u32),
    /// A height field has fewer than 2 × 2 heights.
    HeightFieldTooSmall,
    /// The number of heights is not rows × columns.
    HeightCount,
    /// The height with this index is not finite, or beyond [`MAX_COORDINATE`].
    BadHeight(usize),
    /// The scene has no height field with this index, or it was removed.
    NoSuchHeightField(u32),
    /// The scene has no mesh with this index, or it was removed.
    NoSuchMesh(u32),
    /// The scene has no material with this index, or it was removed.
    NoSuchMaterial(u32),
    /// The scene has no texture with this index, or it was removed.
    NoSuchTexture(u32),
    /// The scene has no instance with this index, or it was removed.
    NoSuchInstance(u32),
    /// The scene has no lamp with this index, or it was removed.
    NoSuchLight(u32),
    /// There is not one replacement for each element of the scene.
    Count {
        /// The kind of the elements: `materials` or `lights`.
        elements: &'static str,
        /// Number of replacements.
        have: usize,
        /// Number of elements of the scene.
        need: usize,
    },
    /// The element that should be removed is still in use.
    InUse {
        /// The kind of the user: `instance`, `material` or `sky`.
        user: &'static str,
        /// The index of the user; of the first one if there are several.
        index: u32,
    },
    /// A buffer that the caller provides is too small.
    BufferTooSmall {
        /// Name of the buffer.
        buffer: &'static str,
        /// Number of elements that the buffer has.
        have: usize,
        /// Number of elements that are needed.
        need: usize,
    },
    /// The node with this index does not belong to a tree over the given triangles.
    BadTree(usize),
    /// There would be more elements of one kind than 32-bit indices can count.
    TooMany,
}

impl core::fmt::Display for SceneError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::BadSize => f.write_str("a length is not between 1e-12 m and 1e12 m"),
            Self::BadScale => f.write_str("a scale is not between 1e-12 and 1e12 in size"),
            Self::BadPose => f.write_str("a pose is not finite, or is more than 1e12 m away"),
            Self::BadLight => f.write_str("a lamp's position is not finite, or is more than 1e12 m away"),
            Self::BadTextureRepeat => {
                f.write_str("how often a texture repeats, or is stretched, is not finite, or beyond 1e12")
            }
            Self::BadShininess => f.write_str("a shininess is not between 0 and 10000"),
            Self::BadPbr => f.write_str("a roughness or metalness is not between 0 and 1"),
            Self::BadAir => f.write_str(
                "the distances, density or colour of fog, or a colour of the sky, is out of range",
            ),
            Self::BadAlpha => f.write_str("an alpha is not between 0 and 1"),
            Self::BadShares => {
                f.write_str("a specular reflectance and a transmittance are not from 0 to 1, also together")
            }
            Self::BadFalloff => f.write_str("the falloff of a spot is not between 0 and 10000"),
            Self::BadUv(index) => {
                write!(f, "the texture coordinates of vertex {index} are not finite, or beyond 1e12")
            }
            Self::BadVertex(index) => write!(f, "vertex {index} is not finite"),
            Self::VertexTooFar(index) => {
                write!(f, "vertex {index} is farther than 1e12 m from the origin of its mesh")
            }
            Self::BufferTooSmall { buffer, have, need } => {
                write!(f, "the buffer `{buffer}` holds {have} elements, and {need} are needed")
            }
            Self::BadTree(node) => write!(f, "node {node} does not belong to a tree over these triangles"),
            Self::BadTriangle(index) => write!(f, "triangle {index} refers to a vertex that is not there"),
            Self::UvCount => f.write_str("texture coordinates must be none or one per vertex"),
            Self::NormalCount => f.write_str("normals must be none or one per vertex"),
            Self::BadNormal(index) => write!(f, "the normal of vertex {index} is not finite, or is 0"),
            Self::BadTexture => f.write_str("a texture must have width × height texels, both at least 1"),
            Self::BadCube => {
                f.write_str("the faces of a cube texture must be six squares of one size, at least 1")
            }
            Self::WrongTexture(index) => {
                write!(
                    f,
                    "texture {index} is a cube texture where another one is expected, or the other way round"
                )
            }
            Self::HeightFieldTooSmall => f.write_str("a height field must have 2 × 2 heights at least"),
            Self::HeightCount => f.write_str("a height field must have rows × columns heights"),
            Self::BadHeight(index) => write!(f, "height {index} is not finite, or beyond 1e12 m"),
            Self::NoSuchHeightField(index) => write!(f, "the scene has no height field {index}"),
            Self::NoSuchMesh(index) => write!(f, "the scene has no mesh {index}"),
            Self::NoSuchMaterial(index) => write!(f, "the scene has no material {index}"),
            Self::NoSuchTexture(index) => write!(f, "the scene has no texture {index}"),
            Self::NoSuchInstance(index) => write!(f, "the scene has no instance {index}"),
            Self::NoSuchLight(index) => write!(f, "the scene has no lamp {index}"),
            Self::Count { elements, have, need } => {
                write!(f, "there are {have} replacements for the {need} {elements} of the scene")
            }
            Self::InUse { user, index } => write!(f, "it is still used by {user} {index}: remove that first"),
            Self::TooMany => f.write_str("more elements than 32-bit indices can count"),
        }
    }
}

impl core::error::Error for SceneError {}
