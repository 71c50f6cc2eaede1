//! The one typed model that URDF and SDF files are loaded into.
//!
//! Lengths are metres, angles radians, masses kilograms. Poses are named `outer_from_inner`.

use super::diagnostics::Source;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;

/// Index of a link in [`Model::links`].
pub type LinkIndex = usize;

/// A world file: models and light, and how physics is to run.
#[derive(Debug, Clone)]
pub struct World {
    /// Name in the file.
    pub name: String,
    /// Everything that stands or moves in it, robots excepted.
    pub models: Vec<Model>,
    /// Lamps and suns.
    pub lights: Vec<Light>,
    /// Light from everywhere, linear RGB in [0, 1].
    pub ambient: [f32; 3],
    /// Colour where nothing is hit.
    pub background: [f32; 3],
    /// Whether lights cast shadows at all.
    pub shadows: bool,
    /// m/s², in the world frame.
    pub gravity: DVec3,
    /// Physics step in seconds.
    pub max_step_size_s: f64,
    /// The world file.
    pub source: Source,
}

/// A robot or a thing in the world: links joined into trees.
#[derive(Debug, Clone)]
pub struct Model {
    /// Name in the file.
    pub name: String,
    /// Pose of the model frame (for a URDF robot: of its root link).
    pub world_from_model: Pose,
    /// Never moves.
    pub is_static: bool,
    /// Links in the order of the file. A parent may come after its child.
    pub links: Vec<Link>,
    /// Joints in the order of the file.
    pub joints: Vec<Joint>,
    /// Sensors in the order of the file.
    pub sensors: Vec<Sensor>,
    /// Where it stands.
    pub source: Source,
}

impl Model {
    /// Index of the link of that name.
    pub fn link_named(&self, name: &str) -> Option<LinkIndex> {
        self.links.iter().position(|link| link.name == name)
    }

    /// The joint whose child is `link`, if it has a parent.
    pub fn joint_above(&self, link: LinkIndex) -> Option<&Joint> {
        self.joints.iter().find(|joint| joint.child == link)
    }

    /// Pose of each link in the model frame with every joint at zero, in the order of [`Model::links`].
    ///
    /// A URDF link's pose follows from its joints; an SDF link's from its own `<pose>`, which the loader put
    /// into [`Link::model_from_link`]. Both are stored there, so this is a plain read.
    pub fn rest_poses(&self) -> Vec<Pose> {
        self.links.iter().map(|link| link.model_from_link).collect()
    }
}

/// A rigid part.
#[derive(Debug, Clone)]
pub struct Link {
    /// Unique in its model.
    pub name: String,
    /// Pose in the model frame with every joint at zero.
    pub model_from_link: Pose,
    /// Mass and inertia; none for a mere frame.
    pub inertial: Option<Inertial>,
    /// What cameras see.
    pub visuals: Vec<Visual>,
    /// What touches, and what lidars hit.
    pub collisions: Vec<Collision>,
    /// False for `<turnGravityOff>true`.
    pub gravity: bool,
    /// Where it stands.
    pub source: Source,
}

/// Mass properties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// Centre of mass, and the axes of the inertia.
    pub link_from_inertial: Pose,
    /// kg.
    pub mass_kg: f64,
    /// ixx, iyy, izz, ixy, ixz, iyz in kg·m².
    pub inertia: [f64; 6],
}

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
    /// Where it stands.
    pub source: Source,
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
    /// Reflectivity that a lidar reports as intensity (`<laser_retro>`), 0 if not given.
    pub laser_retro: f32,
    /// Where it stands.
    pub source: Source,
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
    /// Triangles from a file, already in metres.
    Mesh(Arc<Mesh>),
}

/// Triangles of a file with the scale of the description applied.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// The file.
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
    /// An image file over the surface.
    pub texture: Option<PathBuf>,
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
            texture: None,
            texture_repeat: [1.0; 2],
        }
    }
}

/// What holds two links together.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Unique in its model.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The link it hangs on.
    pub parent: LinkIndex,
    /// The link that moves.
    pub child: LinkIndex,
    /// Pose of the child at joint position zero.
    pub parent_from_child: Pose,
    /// Unit axis in the child's frame.
    pub axis: DVec3,
    /// Where it stands.
    pub source: Source,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// Not at all.
    Fixed,
    /// Turns without end.
    Continuous,
    /// Turns between two angles in radians.
    Revolute {
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// Slides between two lengths in metres.
    Prismatic {
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// All six degrees of freedom.
    Floating,
}

/// A lamp or a sun.
#[derive(Debug, Clone)]
pub struct Light {
    /// Name in the file.
    pub name: String,
    /// Pose; a directional or spot light shines along [`Light::direction`].
    pub world_from_light: Pose,
    /// What kind.
    pub kind: LightKind,
    /// Colour times brightness.
    pub diffuse: [f32; 3],
    /// Unit direction of the light's travel in its own frame (directional and spot).
    pub direction: DVec3,
    /// Range in metres beyond which it gives nothing; infinite for a sun.
    pub range_m: f64,
    /// Brightness at distance d is 1 / (constant + linear·d + quadratic·d²), at most 1.
    pub attenuation: [f64; 3],
    /// Whether things in its way cast shadows.
    pub cast_shadows: bool,
    /// Where it stands.
    pub source: Source,
}

/// Kinds of [`Light`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// From one point to all sides.
    Point,
    /// Parallel light.
    Directional,
    /// A cone; full angles in radians.
    Spot {
        /// Full brightness inside.
        inner_angle: f64,
        /// Nothing outside.
        outer_angle: f64,
        /// Shape of the fall between the two.
        falloff: f64,
    },
}

/// A sensor on a link.
#[derive(Debug, Clone)]
pub struct Sensor {
    /// Name in the file.
    pub name: String,
    /// The link it is fixed to.
    pub link: LinkIndex,
    /// Pose of the sensor in its link; the sensor looks along its x, z is up.
    pub link_from_sensor: Pose,
    /// `<always_on>`.
    pub always_on: bool,
    /// Rate of the sensor itself; none means every physics step.
    pub update_rate_hz: Option<f64>,
    /// What it measures and how.
    pub kind: SensorKind,
    /// The plugin that publishes it; none means a sensor without topics of its own.
    pub plugin: Option<Plugin>,
    /// Where it stands.
    pub source: Source,
}

/// What a sensor measures.
#[derive(Debug, Clone)]
pub enum SensorKind {
    /// Colour camera.
    Camera(CameraSensor),
    /// Depth camera with a colour camera in the same place.
    Depth(CameraSensor),
    /// Lidar.
    Ray(RaySensor),
}

/// `<camera>` of SDF.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSensor {
    /// Full horizontal angle of view in radians.
    pub horizontal_fov_rad: f64,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Layout of a pixel.
    pub format: PixelFormat,
    /// Nothing nearer is seen.
    pub near_m: f64,
    /// Nothing farther is seen.
    pub far_m: f64,
    /// Noise of a colour value in [0, 1].
    pub noise: Noise,
    /// SDF `<distortion>`: k1, k2, k3, p1, p2.
    pub distortion: [f64; 5],
}

/// `<ray>` or `<lidar>` of SDF.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySensor {
    /// Beams of a scan line.
    pub horizontal: ScanAxis,
    /// Scan lines; one at angle 0 for a 2D lidar.
    pub vertical: ScanAxis,
    /// Nothing nearer is measured.
    pub range_min_m: f64,
    /// Nothing farther is measured.
    pub range_max_m: f64,
    /// `<range><resolution>`; Gazebo never applies it, nor do we.
    pub range_resolution_m: f64,
    /// Noise of a range in metres.
    pub noise: Noise,
}

/// Angles of a lidar along one axis, first and last included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanAxis {
    /// Number of beams, at least 1.
    pub samples: u32,
    /// Angle of the first.
    pub min_angle_rad: f64,
    /// Angle of the last.
    pub max_angle_rad: f64,
}

/// Gazebo's Gaussian noise: out = in + bias + N(mean, stddev), rounded to `precision` if that is not 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Mean of the noise.
    pub mean: f64,
    /// Standard deviation of the noise.
    pub stddev: f64,
    /// The bias is drawn once from N(`bias_mean`, `bias_stddev`), its sign flipped with probability ½.
    pub bias_mean: f64,
    /// See `bias_mean`.
    pub bias_stddev: f64,
    /// Step of `gaussian_quantized`; 0 for none.
    pub precision: f64,
}

/// Layout of a colour pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelFormat {
    /// `R8G8B8`.
    Rgb8,
    /// `B8G8R8`.
    Bgr8,
    /// `L8`.
    Mono8,
}

/// The plugin that publishes a sensor, with its parameters resolved to the plugin's own defaults.
#[derive(Debug, Clone, PartialEq)]
pub enum Plugin {
    /// `libgazebo_ros_camera.so`.
    Camera(CameraPlugin),
    /// `libgazebo_ros_openni_kinect.so`.
    DepthCamera(DepthCameraPlugin),
    /// Those of lidars: `libgazebo_ros_laser.so`, `libgazebo_ros_block_laser.so`, `libgazebo_ros_velodyne_laser.so`, and
    /// their `gpu` sisters.
    Laser(LaserPlugin),
    /// `libgazebo_ros_range.so`.
    Range(RangePlugin),
}

/// Parameters shared by the camera plugins. Topics are resolved: absolute, camera name prefixed unless the
/// topic began with a slash.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPlugin {
    /// `cameraName`.
    pub camera_name: String,
    /// `updateRate`; none if 0 or not given.
    pub update_rate_hz: Option<f64>,
    /// Absolute topic of the picture.
    pub image_topic: String,
    /// Absolute topic of its `CameraInfo`.
    pub camera_info_topic: String,
    /// `frameName`.
    pub frame_name: String,
    /// `hackBaseline` in metres: P\[3\] = −f·baseline.
    pub hack_baseline_m: f64,
    /// k1, k2, k3, t1, t2 as written to `CameraInfo`.
    pub distortion: [f64; 5],
    /// `CxPrime`, `Cx`, `Cy` if given and not 0.
    pub principal_point: [Option<f64>; 2],
    /// `focalLength` in pixels if given and not 0.
    pub focal_length: Option<f64>,
}

/// Parameters of the Kinect plugin.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthCameraPlugin {
    /// Colour picture and info, and what both share.
    pub camera: CameraPlugin,
    /// Absolute topic of the depth picture.
    pub depth_image_topic: String,
    /// Absolute topic of its `CameraInfo`.
    pub depth_camera_info_topic: String,
    /// Absolute topic of the cloud.
    pub point_cloud_topic: String,
    /// `pointCloudCutoff`: depth at or below is invalid.
    pub cutoff_m: f64,
    /// `pointCloudCutoffMax`: depth at or above is invalid.
    pub cutoff_max_m: f64,
    /// True for 16UC1 in millimetres (`useDepth16UC1MM`), false for 32FC1 in metres.
    pub depth_16uc1: bool,
}

/// Parameters of the plugin of rangefinders.
#[derive(Debug, Clone, PartialEq)]
pub struct RangePlugin {
    /// Absolute topic of the range.
    pub topic: String,
    /// `frameName`.
    pub frame_name: String,
    /// `updateRate`; none if 0 or not given.
    pub update_rate_hz: Option<f64>,
    /// `radiation`.
    pub radiation: Radiation,
    /// `fov` in radians, as messages say it; the beams are the sensor's.
    pub field_of_view_rad: f64,
}

/// What a rangefinder sends out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Radiation {
    /// Sound.
    Ultrasound,
    /// Infrared light.
    Infrared,
}

/// Parameters of the laser plugins.
#[derive(Debug, Clone, PartialEq)]
pub struct LaserPlugin {
    /// Absolute topic of the scan.
    pub topic: String,
    /// `frameName`.
    pub frame_name: String,
    /// `updateRate`; none if 0 or not given.
    pub update_rate_hz: Option<f64>,
}

impl Sensor {
    /// The rate that holds for pictures and infos alike: the lower of the sensor's and its plugin's; none means
    /// every physics step.
    pub fn effective_rate_hz(&self) -> Option<f64> {
        let plugin_rate = match &self.plugin {
            Some(Plugin::Camera(camera)) => camera.update_rate_hz,
            Some(Plugin::DepthCamera(depth)) => depth.camera.update_rate_hz,
            Some(Plugin::Laser(laser)) => laser.update_rate_hz,
            Some(Plugin::Range(range)) => range.update_rate_hz,
            None => None,
        };
        match (self.update_rate_hz, plugin_rate) {
            (Some(sensor), Some(plugin)) => Some(sensor.min(plugin)),
            (one, other) => one.or(other),
        }
    }
}
