//! Shapes and how they look: what cameras see, what touches, and what lidars hit.

use crate::diagnostics::Source;
use belvedere_sensors::Pose;
use belvedere_sensors::scene::TextureAlpha;
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;

/// A shape that cameras see.
#[derive(Debug, Clone)]
pub struct Visual {
    /// Name, empty if it has none.
    pub name: String,
    /// Pose of the shape in its link.
    pub link_from_visual: Pose,
    /// The shape.
    pub geometry: Geometry,
    /// How it looks.
    pub material: Material,
    /// Its class, if the file labels it or its model.
    pub label: Option<u32>,
    /// A sensor that sees visuals sees it if its mask has one of these bits (`<visibility_flags>`).
    pub visibility_flags: u32,
    /// Reflectivity that a lidar which sees visuals reports as intensity (`<laser_retro>`), 0 if not given.
    pub laser_retro: f32,
    /// What lidars that see visuals, and depth cameras, see by way of it (`<optics>`).
    pub optics: Optics,
    /// The tags that it shows.
    pub fiducials: Vec<Fiducial>,
    /// Where it stands.
    pub source: Source,
}

/// Which part of the light of lidars and depth cameras a surface does not scatter: `<optics>`, which is ours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Optics {
    /// Share that is reflected as by a mirror.
    pub specular_reflectance: f32,
    /// Share that passes straight through.
    pub transmittance: f32,
}

/// A tag on a surface: `<fiducial>` of a `<visual>`, which is ours.
#[derive(Debug, Clone, PartialEq)]
pub struct Fiducial {
    /// What its kind is called: `tag36h11`, `qr`.
    pub family: String,
    /// Its number in the family.
    pub id: u32,
    /// Edge of its square without the white margin: of an AprilTag's black border, of a QR code's modules.
    pub size_m: f64,
    /// Pose of its middle in the frame of the visual: x to the right and y up as one reads it, z towards the reader.
    pub visual_from_fiducial: Pose,
}

/// A shape that touches and that lidars hit.
#[derive(Debug, Clone)]
pub struct Collision {
    /// Name, empty if it has none.
    pub name: String,
    /// Pose of the shape in its link.
    pub link_from_collision: Pose,
    /// The shape.
    pub geometry: Geometry,
    /// Coulomb friction (`mu1` / `<mu>`), if given.
    pub friction: Option<f64>,
    /// How it touches others.
    pub contact: Contact,
    /// Reflectivity that a lidar reports as intensity (`<laser_retro>`), 0 if not given.
    pub laser_retro: f32,
    /// What lidars see by way of it (`<optics>`).
    pub optics: Optics,
    /// Where it stands.
    pub source: Source,
}

/// What happens where a shape meets another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Share of the speed with which it comes off (`<restitution_coefficient>`).
    pub restitution: f64,
    /// It bounces from this speed on, in m/s (`<threshold>`).
    pub bounce_threshold_m_s: f64,
    /// Two shapes touch that have a bit in common (`<collide_bitmask>`).
    pub collide_bitmask: u32,
    /// Whether it holds what it touches; contacts are noticed anyway (`<collide_without_contact>`).
    pub is_solid: bool,
}

impl Default for Contact {
    /// SDF's.
    fn default() -> Self {
        Self { restitution: 0.0, bounce_threshold_m_s: 1e5, collide_bitmask: 0xFFFF, is_solid: true }
    }
}

/// A shape, centred on its frame.
#[derive(Debug, Clone)]
pub enum Geometry {
    /// Full edge lengths. Every face carries the whole texture, upright where there is an up: seen from outside,
    /// u grows to the right and v upwards, and the picture's first row is the top (v = 1).
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
        /// x, y, z.
        size: DVec3,
    },
    /// Axis along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Full length along z.
        length: f64,
    },
    /// A ball.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// Axis along z; `length` is that of the cylindrical part.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length without the caps.
        length: f64,
    },
    /// A rectangle through the origin. It collides as an infinite half space. With a normal along an axis its
    /// texture lies as on the face of a [`Geometry::Box`] with that normal.
    Plane {
        /// Unit normal.
        normal: DVec3,
        /// Full edge lengths of the visible part.
        size: [f64; 2],
    },
    /// The points with (x/a)² + (y/b)² + (z/c)² ≤ 1.
    Ellipsoid {
        /// a, b, c.
        radii: DVec3,
    },
    /// Axis along z, the base at −`length`/2, the apex at +`length`/2.
    Cone {
        /// Radius of the base.
        radius: f64,
        /// Full length.
        length: f64,
    },
    /// Triangles from a file, already in metres.
    Mesh(Arc<Mesh>),
    /// A terrain, which never moves.
    HeightMap(HeightMap),
}

/// A terrain whose heights are a picture's.
#[derive(Debug, Clone)]
pub struct HeightMap {
    /// What the file holds; that of a visual and of its collision are the same.
    pub heights: Arc<Heights>,
    /// Where its middle is at height 0.
    pub offset: DVec3,
    /// Its own look: the first of its textures.
    pub material: Option<Material>,
}

/// Heights at the crossings of a grid.
#[derive(Debug)]
pub struct Heights {
    /// The picture.
    pub path: PathBuf,
    /// Rows from +y to −y, and columns from −x to +x; two of each at least.
    pub grid: [u32; 2],
    /// Full lengths along x and y, in metres.
    pub size: [f64; 2],
    /// Row by row, in metres.
    pub metres: Vec<f32>,
}

/// Triangles of a file with the scale of the description applied.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// The file that it is from.
    pub path: PathBuf,
    /// Vertices in metres.
    pub positions: Vec<[f32; 3]>,
    /// Texture coordinates per vertex, v up; empty if there are none.
    pub uvs: Vec<[f32; 2]>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// What the file itself says of its look, used where the description says nothing.
    pub material: Option<Material>,
}

/// How a surface looks. Colours are RGB in [0, 1] as the file gives them (no gamma, as in Gazebo classic).
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Reflected light of lamps; multiplied by the texture if there is one.
    pub diffuse: [f32; 3],
    /// Reflected ambient light; multiplied by the texture if there is one.
    pub ambient: [f32; 3],
    /// Own light.
    pub emissive: [f32; 3],
    /// Highlights of lamps, which [`Material::shininess`] switches on.
    pub specular: [f32; 3],
    /// Exponent of Blinn's and Phong's highlights; without one, 0, there are none, as in Gazebo.
    pub shininess: f32,
    /// How much of what is seen is the surface: 1 is opaque, 0 not there.
    pub alpha: f32,
    /// What the texture's own alpha means.
    pub texture_alpha: TextureAlpha,
    /// An image file over the surface.
    pub texture: Option<PathBuf>,
    /// An image file of normals in the axes of the surface.
    pub normal_map: Option<PathBuf>,
    /// How often the texture repeats over the surface (Ogre's `scale`, inverted), along u and v.
    pub texture_repeat: [f32; 2],
}

impl Default for Material {
    /// Gazebo's default: white-ish grey, no texture.
    fn default() -> Self {
        Self {
            diffuse: [0.7; 3],
            ambient: [0.7; 3],
            emissive: [0.0; 3],
            specular: [0.0; 3],
            shininess: 0.0,
            alpha: 1.0,
            texture_alpha: TextureAlpha::Ignored,
            texture: None,
            normal_map: None,
            texture_repeat: [1.0; 2],
        }
    }
}
