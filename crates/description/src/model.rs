//! The one typed model that URDF and SDF files are loaded into.
//!
//! Lengths are metres, angles radians, masses kilograms. Poses are named `outer_from_inner`.

mod base;
mod device;
mod earth;
mod joint;
mod lens;
pub(crate) mod pbr_maps;
mod plugin;
mod sensor;
mod shape;
mod trajectory;

pub use super::sensor::{
    AirPressure, Altimeter, BeamPhysics, Camera, ContactSensor, DepthCamera, ForceTorque, Imu, ImuProfile,
    InstrumentPlugin, Lidar, LogicalCamera, Magnetometer, MeasureFrame, NavSat, OrientationReference,
    PacketProfile, PluginField, Rangefinder, Sensor, SensorKind, choices,
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
pub use pbr_maps::{Channel, PbrMaps};
pub use plugin::{CameraPlugin, CloudLayout, DepthCameraPlugin, LaserPlugin, Radiation, RangePlugin};
pub use sensor::{CameraSensor, Noise, RaySensor, ScanAxis};
pub use shape::{Collision, Contact, Fiducial, Geometry, HeightMap, Heights, Material, Mesh, Optics, Visual};
pub use trajectory::{Leg, Trajectory, Waypoint};

use super::diagnostics::{Problem, Source};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::Air;
use glam::DVec3;

/// Index of a link in [`Model::links`].
pub type LinkIndex = usize;

/// Index of a joint in [`Model::joints`].
pub type JointIndex = usize;

/// A world file: models, lights, and the parameters of physics.
#[derive(Debug, Clone)]
pub struct World {
    /// Name in the file.
    pub name: String,
    /// All models in it, robots excepted.
    pub models: Vec<Model>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Ambient light, linear RGB in [0, 1].
    pub ambient: [f32; 3],
    /// Background colour, where no surface is hit.
    pub background: [f32; 3],
    /// Fog and sky.
    pub air: Air,
    /// False if no light casts shadows.
    pub shadows: bool,
    /// True if colours are sRGB and light is linear: our extension, unlike Gazebo.
    pub linear_light: bool,
    /// Gravity in m/s², in the world frame.
    pub gravity: DVec3,
    /// Place on the earth.
    pub earth: Earth,
    /// Physics step in seconds.
    pub max_step_size_s: f64,
    /// The world file.
    pub source: Source,
}

impl World {
    /// Returns a world with gravity and ambient light only: the defaults of a world file (sdf/1.6).
    pub fn empty() -> Self {
        Self {
            name: "empty".into(),
            models: Vec::new(),
            lights: Vec::new(),
            ambient: [0.4; 3],
            background: [0.7; 3],
            air: Air::default(),
            shadows: true,
            linear_light: false,
            gravity: DVec3::new(0.0, 0.0, -9.8),
            earth: Earth::default(),
            max_step_size_s: 0.001,
            source: Source::new("", 0),
        }
    }
}

/// A robot or an object in the world: links joined into trees.
#[derive(Debug, Clone)]
pub struct Model {
    /// Name in the file.
    pub name: String,
    /// Pose of the model frame (for a URDF robot: of its root link) in the world.
    pub world_from_model: Pose,
    /// True if it never moves.
    pub is_static: bool,
    /// True if it may sleep while it rests: false for `<allow_auto_disable>false`.
    pub may_sleep: bool,
    /// Links in the order of the file. A child may come before its parent.
    pub links: Vec<Link>,
    /// The link to which the model frame is attached: the pose of the model follows it.
    pub canonical_link: LinkIndex,
    /// Joints in the order of the file.
    pub joints: Vec<Joint>,
    /// Sensors in the order of the file.
    pub sensors: Vec<Sensor>,
    /// Its own plugins, in the order of the file.
    pub plugins: Vec<ModelPlugin>,
    /// The trajectory that it follows instead of physics, if it is a moving actor.
    pub trajectory: Option<Trajectory>,
    /// File and line that define it.
    pub source: Source,
}

impl Model {
    /// Creates a model without any parts.
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

    /// Returns the index of the link of that name.
    pub fn link_named(&self, name: &str) -> Option<LinkIndex> {
        self.links.iter().position(|link| link.name == name)
    }

    /// Names the topics of sensors for which the file names none, as gz-sim does:
    /// `/world/WORLD/model/NAME/link/LINK/sensor/SENSOR/scan`, or `…/joint/JOINT/…`. The simulation calls it when a model is added to a world.
    /// Returns a warning for each sensor that has the same name as another one.
    pub fn name_sensor_topics(&mut self, world: &str) -> Vec<Problem> {
        let (links, joints) = (&self.links, &self.joints);
        let place = |sensor: &Sensor| place_of(sensor, links, joints);
        super::sensor::gz::name_topics(&mut self.sensors, place, &self.name, world)
    }

    /// The name of the link or the joint that a sensor is on.
    pub(crate) fn place_of(&self, sensor: &Sensor) -> &str {
        place_of(sensor, &self.links, &self.joints).1
    }

    /// Returns the name that Gazebo gives a collision of a link: `LINK::COLLISION`.
    ///
    /// # Panics
    /// If there is no such link or collision.
    pub fn collision_name(&self, link: LinkIndex, collision: usize) -> String {
        let link = &self.links[link];
        let collision = &link.collisions[collision];
        collision.scoped_name.clone().unwrap_or_else(|| format!("{}::{}", link.name, collision.name))
    }

    /// Returns the plugin that drives it, if there is one.
    pub fn base(&self) -> Option<&BasePlugin> {
        self.plugins.iter().find_map(|plugin| match plugin {
            ModelPlugin::Base(base) => Some(&**base),
            _ => None,
        })
    }

    /// Returns the joint above each link: the first of which it is the child.
    pub fn joints_above(&self) -> Vec<Option<JointIndex>> {
        let mut above = vec![None; self.links.len()];
        for (index, joint) in self.joints.iter().enumerate() {
            above[joint.child].get_or_insert(index);
        }
        above
    }

    /// Returns the first link without a joint above it.
    pub fn first_root(&self) -> Option<LinkIndex> {
        self.joints_above().iter().position(Option::is_none)
    }

    /// Returns the joint whose child is `link`, if it has a parent. For all links, use [`Model::joints_above`].
    pub fn joint_above(&self, link: LinkIndex) -> Option<&Joint> {
        self.joints.iter().find(|joint| joint.child == link)
    }

    /// Returns the uppermost of the links that fixed joints join with `link`.
    pub fn rigid_root(&self, mut link: LinkIndex) -> LinkIndex {
        let above = self.joints_above();
        // The path to the root has fewer steps than there are links.
        for _ in 0..self.links.len() {
            match above[link].map(|joint| &self.joints[joint]) {
                Some(joint) if joint.kind == JointKind::Fixed => link = joint.parent,
                _ => break,
            }
        }
        link
    }

    /// Returns the pose of each link in the model frame with every joint at zero, in the order of [`Model::links`].
    ///
    /// The pose of a URDF link follows from its joints, that of an SDF link from its own `<pose>`. The loader stores both in
    /// [`Link::model_from_link`], so this is a plain read.
    pub fn rest_poses(&self) -> Vec<Pose> {
        self.links.iter().map(|link| link.model_from_link).collect()
    }
}

/// Returns whether a sensor is on a link or on a joint, and the name of that link or joint.
fn place_of<'m>(sensor: &Sensor, links: &'m [Link], joints: &'m [Joint]) -> (&'static str, &'m str) {
    match &sensor.kind {
        SensorKind::ForceTorque(it) => ("joint", &joints[it.joint].name),
        _ => ("link", &links[sensor.link].name),
    }
}

/// A rigid part of a model.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is an element of its own in the file")]
pub struct Link {
    /// Unique in its model.
    pub name: String,
    /// Pose in the model frame with every joint at zero.
    pub model_from_link: Pose,
    /// Mass and inertia; none for a link that is only a frame.
    pub inertial: Option<Inertial>,
    /// The shapes that cameras see.
    pub visuals: Vec<Visual>,
    /// The shapes that collide and that lidars hit.
    pub collisions: Vec<Collision>,
    /// False for `<turnGravityOff>true`.
    pub gravity: bool,
    /// True if no force moves it: it keeps the velocity that it is given, at first zero (`<kinematic>`).
    pub is_kinematic: bool,
    /// The shares of its linear and its angular velocity that a link loses in each step (`<velocity_decay>`).
    pub velocity_decay: [f64; 2],
    /// True if it collides with links of its model that it is not joined to; one of the two links suffices.
    pub self_collide: bool,
    /// True if it stands still in a model that moves: it belongs to a static nested model, or is fixed to the world. What is
    /// fixed to this link stands still, too.
    pub is_static: bool,
    /// File and line that define it.
    pub source: Source,
}

impl Link {
    /// Creates a link that is only a frame, at the model's own.
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
    /// Pose of the centre of mass and of the inertia's axes in the link.
    pub link_from_inertial: Pose,
    /// Mass in kg.
    pub mass_kg: f64,
    /// Inertia ixx, iyy, izz, ixy, ixz, iyz in kg·m².
    pub inertia: [f64; 6],
}

/// A light.
#[derive(Debug, Clone)]
pub struct Light {
    /// Name in the file.
    pub name: String,
    /// Pose in the world; a directional or spot light shines along [`Light::direction`].
    pub world_from_light: Pose,
    /// Its kind.
    pub kind: LightKind,
    /// Colour times brightness.
    pub diffuse: [f32; 3],
    /// Colour times brightness of its highlights.
    pub specular: [f32; 3],
    /// Unit direction of the light's travel in its own frame (directional and spot).
    pub direction: DVec3,
    /// Range in metres beyond which it has no effect; infinite for a directional light.
    pub range_m: f64,
    /// Coefficients of the attenuation: brightness at distance d is 1 / (constant + linear·d + quadratic·d²), at most 1.
    pub attenuation: [f64; 3],
    /// True if objects cast shadows in it.
    pub cast_shadows: bool,
    /// File and line that define it.
    pub source: Source,
}

/// Kinds of [`Light`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Shines from one point in all directions.
    Point,
    /// Parallel light.
    Directional,
    /// Shines in a cone; full angles in radians.
    Spot {
        /// Full angle inside which it has full brightness.
        inner_angle: f64,
        /// Full angle outside which it has no effect.
        outer_angle: f64,
        /// Exponent of the decrease between the two angles: 1 is linear.
        falloff: f64,
    },
}
