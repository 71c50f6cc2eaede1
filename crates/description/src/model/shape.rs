//! Shapes and how they look: visuals, collision shapes and materials.

use crate::diagnostics::Source;
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{Pbr, TextureAlpha};
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;

use super::pbr_maps::PbrMaps;

/// A shape that cameras see.
#[derive(Debug, Clone)]
pub struct Visual {
    /// Name; empty if it has none.
    pub name: String,
    /// Pose of the shape in its link.
    pub link_from_visual: Pose,
    /// The shape.
    pub geometry: Geometry,
    /// Its material.
    pub material: Material,
    /// Its class, if the file labels it or its model.
    pub label: Option<u32>,
    /// A sensor that sees visuals sees it if its mask has one of these bits (`<visibility_flags>`).
    pub visibility_flags: u32,
    /// Reflectivity that a lidar which sees visuals reports as intensity (`<laser_retro>`), 0 if not given.
    pub laser_retro: f32,
    /// Its mirror reflection and transmission, for lidars that see visuals and for depth cameras (`<optics>`).
    pub optics: Optics,
    /// The fiducial tags on it.
    pub fiducials: Vec<Fiducial>,
    /// File and line that define it.
    pub source: Source,
}

/// The part of the light of lidars and depth cameras that a surface does not scatter: `<optics>`, our extension.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Optics {
    /// Share that is reflected as by a mirror.
    pub specular_reflectance: f32,
    /// Share that passes straight through.
    pub transmittance: f32,
}

/// A tag on a surface: `<fiducial>` of a `<visual>`, our extension.
#[derive(Debug, Clone, PartialEq)]
pub struct Fiducial {
    /// Name of the family: `tag36h11`, `qr`.
    pub family: String,
    /// Number of the tag in its family.
    pub id: u32,
    /// Edge length in m without the white margin: of an AprilTag's black border, of a QR code's modules.
    pub size_m: f64,
    /// Pose of its centre in the frame of the visual: x to the reader's right, y up, z towards the reader.
    pub visual_from_fiducial: Pose,
}

/// A shape that collides and that lidars hit.
#[derive(Debug, Clone)]
pub struct Collision {
    /// Name; empty if it has none.
    pub name: String,
    /// The name that Gazebo gives it, behind that of its link: `LINK::COLLISION`. None if it follows from the names of both,
    /// as in SDF.
    pub scoped_name: Option<String>,
    /// Pose of the shape in its link.
    pub link_from_collision: Pose,
    /// The shape.
    pub geometry: Geometry,
    /// Coulomb friction (`mu1` / `<mu>`), if given.
    pub friction: Option<f64>,
    /// Contact parameters.
    pub contact: Contact,
    /// Reflectivity that a lidar reports as intensity (`<laser_retro>`), 0 if not given.
    pub laser_retro: f32,
    /// Its mirror reflection and transmission, for lidars (`<optics>`).
    pub optics: Optics,
    /// File and line that define it.
    pub source: Source,
}

/// Contact parameters of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Ratio of the speeds after and before an impact (`<restitution_coefficient>`).
    pub restitution: f64,
    /// Impact speed from which it bounces, in m/s (`<threshold>`).
    pub bounce_threshold_m_s: f64,
    /// Collision mask: two shapes collide if their masks share a bit (`<collide_bitmask>`).
    pub collide_bitmask: u32,
    /// False if it only detects contacts and exerts no force (`<collide_without_contact>`).
    pub is_solid: bool,
}

impl Default for Contact {
    /// Returns SDF's defaults.
    fn default() -> Self {
        Self { restitution: 0.0, bounce_threshold_m_s: 1e5, collide_bitmask: 0xFFFF, is_solid: true }
    }
}

/// A shape, centred on its frame.
#[derive(Debug, Clone)]
pub enum Geometry {
    /// A box. Every face carries the whole texture, upright on the vertical faces: seen from outside,
    /// u grows to the right and v upwards, and the image's first row is the top (v = 1).
    ///
    /// | face | right (u) | up (v) |
    /// |---|---|---|
    /// | +x | +y | +z |
    /// | −x | −y | +z |
    /// | +y | −x | +z |
    /// | −y | +x | +z |
    /// | +z | +x | +y |
    /// | −z | +x | −y |
    Box {
        /// Full edge lengths x, y, z in metres.
        size: DVec3,
    },
    /// A cylinder with its axis along z.
    Cylinder {
        /// Radius in metres.
        radius: f64,
        /// Full length along z in metres.
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius in metres.
        radius: f64,
    },
    /// A capsule with its axis along z.
    Capsule {
        /// Radius in metres.
        radius: f64,
        /// Length without the caps in metres.
        length: f64,
    },
    /// A rectangle through the origin. It collides as an infinite half space. With a normal along an axis its
    /// texture is mapped as on the face of a [`Geometry::Box`] with that normal.
    Plane {
        /// Unit normal.
        normal: DVec3,
        /// Full edge lengths of the visible part in metres.
        size: [f64; 2],
    },
    /// An ellipsoid: the points with (x/a)² + (y/b)² + (z/c)² ≤ 1.
    Ellipsoid {
        /// Semi-axes a, b, c in metres.
        radii: DVec3,
    },
    /// A cone with its axis along z, the base at −`length`/2, the apex at +`length`/2.
    Cone {
        /// Radius of the base in metres.
        radius: f64,
        /// Full length in metres.
        length: f64,
    },
    /// Triangles from a file, already in metres.
    Mesh(Arc<Mesh>),
    /// A terrain, which never moves.
    HeightMap(HeightMap),
}

/// A terrain with the heights of an image.
#[derive(Debug, Clone)]
pub struct HeightMap {
    /// The heights; a visual and its collision share them.
    pub heights: Arc<Heights>,
    /// Position of its centre at height 0.
    pub offset: DVec3,
    /// Its own material: the first of its textures.
    pub material: Option<Box<Material>>,
}

/// Heights on the vertices of a grid.
#[derive(Debug)]
pub struct Heights {
    /// The image file.
    pub path: PathBuf,
    /// Numbers of rows, from +y to −y, and columns, from −x to +x; at least two of each.
    pub grid: [u32; 2],
    /// Full lengths along x and y, in metres.
    pub size: [f64; 2],
    /// Heights in metres, row by row.
    pub metres: Vec<f32>,
}

/// Triangles of a file, with the description's scale applied.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// The file.
    pub path: PathBuf,
    /// Vertices in metres.
    pub positions: Vec<[f32; 3]>,
    /// Texture coordinates per vertex, v up; empty if there are none.
    pub uvs: Vec<[f32; 2]>,
    /// Unit normals per vertex, for shading; empty if the mesh is flat.
    pub normals: Vec<[f32; 3]>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The material in the file itself, which is used if the description gives none.
    pub material: Option<Material>,
}

/// Appearance of a surface. Colours are RGB in [0, 1] as in the file (no gamma, as in Gazebo classic).
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Reflectance for lights; multiplied by the texture if there is one.
    pub diffuse: [f32; 3],
    /// Reflectance for ambient light; multiplied by the texture if there is one.
    pub ambient: [f32; 3],
    /// Emitted light.
    pub emissive: [f32; 3],
    /// Colour of highlights, which [`Material::shininess`] switches on.
    pub specular: [f32; 3],
    /// Exponent of Blinn–Phong highlights; 0 for no highlights, as in Gazebo.
    pub shininess: f32,
    /// Roughness and metalness, for surfaces that have these instead of highlights of Blinn and Phong.
    pub pbr: Option<Pbr>,
    /// Opacity: 1 is opaque, 0 is invisible.
    pub alpha: f32,
    /// How the texture's own alpha is interpreted.
    pub texture_alpha: TextureAlpha,
    /// An image file over the surface.
    pub texture: Option<PathBuf>,
    /// An image file of normals in tangent space.
    pub normal_map: Option<PathBuf>,
    /// Images by which the values of [`Material::pbr`] are multiplied.
    pub pbr_maps: PbrMaps,
    /// An image file by which [`Material::emissive`] is multiplied.
    pub emissive_map: Option<PathBuf>,
    /// Repetitions of the texture and all maps over the surface along u and v (the inverse of Ogre's `scale`).
    pub texture_repeat: [f32; 2],
}

impl Default for Material {
    /// Returns Gazebo's default: light grey, no texture.
    fn default() -> Self {
        Self {
            diffuse: [0.7; 3],
            ambient: [0.7; 3],
            emissive: [0.0; 3],
            specular: [0.0; 3],
            shininess: 0.0,
            pbr: None,
            alpha: 1.0,
            texture_alpha: TextureAlpha::Ignored,
            texture: None,
            normal_map: None,
            pbr_maps: PbrMaps::default(),
            emissive_map: None,
            texture_repeat: [1.0; 2],
        }
    }
}
