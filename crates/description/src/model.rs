//! The one typed model that URDF and SDF files are loaded into.
//!
//! Lengths are metres, angles radians, masses kilograms. Poses are named `outer_from_inner`.

mod base;
mod device;
mod earth;
mod joint;
mod lens;
mod plugin;
mod sensor;
mod shape;
mod trajectory;

pub use super::sensor::{
    AirPressure, Altimeter, BeamPhysics, Camera, DepthCamera, ForceTorque, Imu, ImuProfile, InstrumentPlugin,
    Lidar, Magnetometer, MeasureFrame, NavSat, OrientationReference, PacketProfile, PluginField, Rangefinder,
    Sensor, SensorKind, choices,
};
pub use base::{
    AckermannDrive, BasePlugin, DifferentialDrive, Drive, JointStatesPlugin, ModelPlugin, OdometryOrigin,
    OdometryPlugin, PosePlugin, Wheels,
};
pub use belvedere_sensors::camera::{Mosaic, PixelFormat};
pub use device::{AutoExposed, CameraDevice};
pub use earth::Earth;
pub use joint::{Joint, JointDynamics, JointKind, Mimic};
pub use lens::{AngleFunction, AngleMap, Lens, LensIntrinsics, LensModel, LensProjection};
pub use plugin::{CameraPlugin, CloudLayout, DepthCameraPlugin, LaserPlugin, Radiation, RangePlugin};
pub use sensor::{CameraSensor, Noise, RaySensor, ScanAxis};
pub use shape::{Collision, Contact, Fiducial, Geometry, HeightMap, Heights, Material, Mesh, Optics, Visual};
pub use trajectory::{Leg, Trajectory, Waypoint};

use super::diagnostics::{Problem, Source};
use belvedere_sensors::Pose;
use glam::DVec3;

/// Index of a link in [`Model::links`].
pub type LinkIndex = usize;

/// Index of a joint in [`Model::joints`].
pub type JointIndex = usize;

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
    /// Whether colours are sRGB, and light is linear: ours, not Gazebo's.
    pub linear_light: bool,
    /// m/s², in the world frame.
    pub gravity: DVec3,
    /// Where on the earth it is.
    pub earth: Earth,
    /// Physics step in seconds.
    pub max_step_size_s: f64,
    /// The world file.
    pub source: Source,
}

impl World {
    /// Nothing but gravity and light from everywhere: what a world file says that says nothing (sdf/1.6).
    pub fn empty() -> Self {
        Self {
            name: "empty".into(),
            models: Vec::new(),
            lights: Vec::new(),
            ambient: [0.4; 3],
            background: [0.7; 3],
            shadows: true,
            linear_light: false,
            gravity: DVec3::new(0.0, 0.0, -9.8),
            earth: Earth::default(),
            max_step_size_s: 0.001,
            source: Source::new("", 0),
        }
    }
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
    /// May sleep where it rests: false for `<allow_auto_disable>false`.
    pub may_sleep: bool,
    /// Links in the order of the file. A parent may come after its child.
    pub links: Vec<Link>,
    /// The link to which the model frame is attached: the pose of the model follows it.
    pub canonical_link: LinkIndex,
    /// Joints in the order of the file.
    pub joints: Vec<Joint>,
    /// Sensors in the order of the file.
    pub sensors: Vec<Sensor>,
    /// What its own plugins make of it, in the order of the file.
    pub plugins: Vec<ModelPlugin>,
    /// What it follows instead of physics, if it is an actor that moves.
    pub trajectory: Option<Trajectory>,
    /// Where it stands.
    pub source: Source,
}

impl Model {
    /// A model of nothing yet.
    pub(crate) fn empty(name: String, source: Source) -> Self {
        Self {
            name,
            world_from_model: Pose::IDENTITY,
            is_static: false,
            may_sleep: true,
            links: Vec::new(),
            canonical_link: 0,
            joints: Vec::new(),
            sensors: Vec::new(),
            plugins: Vec::new(),
            trajectory: None,
            source,
        }
    }

    /// Index of the link of that name.
    pub fn link_named(&self, name: &str) -> Option<LinkIndex> {
        self.links.iter().position(|link| link.name == name)
    }

    /// Names the topics of sensors for which the file names none, as gz-sim does:
    /// `/world/WORLD/model/NAME/link/LINK/sensor/SENSOR/scan`, or `…/joint/JOINT/…`. A simulation calls it when the model comes into a world.
    /// Returns a warning for each sensor that has the name of another one.
    pub fn name_sensor_topics(&mut self, world: &str) -> Vec<Problem> {
        let (links, joints) = (&self.links, &self.joints);
        let place = |sensor: &Sensor| place_of(sensor, links, joints);
        super::sensor::gz::name_topics(&mut self.sensors, place, &self.name, world)
    }

    /// The name of the link or the joint that a sensor is on.
    pub(crate) fn place_of(&self, sensor: &Sensor) -> &str {
        place_of(sensor, &self.links, &self.joints).1
    }

    /// What drives it, if anything does.
    pub fn base(&self) -> Option<&BasePlugin> {
        self.plugins.iter().find_map(|plugin| match plugin {
            ModelPlugin::Base(base) => Some(&**base),
            _ => None,
        })
    }

    /// The joint whose child is `link`, if it has a parent.
    pub fn joint_above(&self, link: LinkIndex) -> Option<&Joint> {
        self.joints.iter().find(|joint| joint.child == link)
    }

    /// The link that stands for all that fixed joints join with `link`: the uppermost.
    pub fn rigid_root(&self, mut link: LinkIndex) -> LinkIndex {
        // A tree has fewer steps to its root than links.
        for _ in 0..self.links.len() {
            match self.joint_above(link) {
                Some(joint) if joint.kind == JointKind::Fixed => link = joint.parent,
                _ => break,
            }
        }
        link
    }

    /// Pose of each link in the model frame with every joint at zero, in the order of [`Model::links`].
    ///
    /// A URDF link's pose follows from its joints; an SDF link's from its own `<pose>`, which the loader put
    /// into [`Link::model_from_link`]. Both are stored there, so this is a plain read.
    pub fn rest_poses(&self) -> Vec<Pose> {
        self.links.iter().map(|link| link.model_from_link).collect()
    }
}

/// Whether a sensor is on a link or on a joint, and its name.
fn place_of<'m>(sensor: &Sensor, links: &'m [Link], joints: &'m [Joint]) -> (&'static str, &'m str) {
    match &sensor.kind {
        SensorKind::ForceTorque(it) => ("joint", &joints[it.joint].name),
        _ => ("link", &links[sensor.link].name),
    }
}

/// A rigid part.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is an element of its own in the file")]
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
    /// No force moves it: it keeps the velocity that it is given, at first none (`<kinematic>`).
    pub is_kinematic: bool,
    /// What share of its linear and its angular velocity a link loses in each step (`<velocity_decay>`).
    pub velocity_decay: [f64; 2],
    /// Touches other links of its model that it is not joined to; two links do if one of them says so.
    pub self_collide: bool,
    /// Stands still in a model that moves: of a static model inside it, or fixed to the world. So does what is fixed
    /// to this link.
    pub is_static: bool,
    /// Where it stands.
    pub source: Source,
}

impl Link {
    /// A mere frame, at the model's own.
    pub(crate) fn empty(name: String, source: Source) -> Self {
        Self {
            name,
            model_from_link: Pose::IDENTITY,
            inertial: None,
            visuals: Vec::new(),
            collisions: Vec::new(),
            gravity: true,
            is_kinematic: false,
            velocity_decay: [0.0; 2],
            self_collide: false,
            is_static: false,
            source,
        }
    }
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
    /// The same of its highlights.
    pub specular: [f32; 3],
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
        /// Exponent of the fall between the two: 1 is linear.
        falloff: f64,
    },
}
