//! Handwritten models for tests.

use belvedere::description::Source;
use belvedere::description::model::{
    BasePlugin, Collision, Contact, Drive, Earth, Geometry, Inertial, Joint, JointDynamics, JointKind, Link,
    LinkIndex, Model, ModelPlugin, OdometryOrigin, OdometryPlugin, Wheels, World,
};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::Air;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

pub(crate) fn source() -> Source {
    Source::new("by_hand.urdf", 1)
}

pub(crate) fn xyz(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(DVec3::new(x, y, z))
}

pub(crate) fn link(name: &str, model_from_link: Pose) -> Link {
    Link {
        name: name.into(),
        model_from_link,
        inertial: None,
        visuals: Vec::new(),
        collisions: Vec::new(),
        gravity: true,
        is_kinematic: false,
        velocity_decay: [0.0; 2],
        self_collide: false,
        is_static: false,
        source: source(),
    }
}

pub(crate) fn collision(link_from_collision: Pose, geometry: Geometry) -> Collision {
    Collision {
        name: String::new(),
        scoped_name: None,
        link_from_collision,
        geometry,
        friction: None,
        contact: Contact::default(),
        laser_retro: 0.0,
        optics: belvedere::description::model::Optics::default(),
        source: source(),
    }
}

pub(crate) fn inertial(mass_kg: f64, diagonal: [f64; 3]) -> Inertial {
    let [x, y, z] = diagonal;
    Inertial { link_from_inertial: Pose::IDENTITY, mass_kg, inertia: [x, y, z, 0.0, 0.0, 0.0] }
}

pub(crate) fn empty_model(name: &str) -> Model {
    Model {
        name: name.into(),
        world_from_model: Pose::IDENTITY,
        is_static: false,
        may_sleep: true,
        links: Vec::new(),
        canonical_link: 0,
        joints: Vec::new(),
        sensors: Vec::new(),
        plugins: Vec::new(),
        trajectory: None,
        source: source(),
    }
}

/// Attaches a new link to another one, and returns its index.
pub(crate) fn hang(
    model: &mut Model,
    parent: LinkIndex,
    name: &str,
    joint: &str,
    kind: JointKind,
    parent_from_child: Pose,
) -> LinkIndex {
    let model_from_link = model.links[parent].model_from_link * parent_from_child;
    model.links.push(link(name, model_from_link));
    let child = model.links.len() - 1;
    model.joints.push(Joint {
        name: joint.into(),
        kind,
        parent,
        child,
        parent_from_child,
        axis: DVec3::Z,
        pivot: DVec3::ZERO,
        dynamics: JointDynamics::default(),
        source: source(),
    });
    child
}

/// A Kobuki with the numbers of its description, and a camera mast like the `TurtleBot`'s.
pub(crate) fn kobuki() -> Model {
    let mut robot = empty_model("turtlebot");
    robot.links.push(link("base_footprint", Pose::IDENTITY));
    let base = hang(&mut robot, 0, "base_link", "base_joint", JointKind::Fixed, xyz(0.0, 0.0, 0.0102));
    robot.links[base].inertial = Some(inertial(2.4, [0.019_995, 0.019_995, 0.036_75]));
    robot.links[base].collisions =
        vec![collision(xyz(0.0, 0.0, 0.05949), Geometry::Cylinder { radius: 0.178, length: 0.10938 })];
    for (side, y) in [("left", 0.115), ("right", -0.115)] {
        let mount = Pose::from_xyz_rpy(DVec3::new(0.0, y, 0.0250), DVec3::new(-FRAC_PI_2, 0.0, 0.0));
        let (name, joint) = (format!("wheel_{side}_link"), format!("wheel_{side}_joint"));
        let wheel = hang(&mut robot, base, &name, &joint, JointKind::Continuous, mount);
        robot.links[wheel].inertial = Some(inertial(0.01, [0.001; 3]));
        robot.links[wheel].collisions =
            vec![collision(Pose::IDENTITY, Geometry::Cylinder { radius: 0.035, length: 0.0206 })];
    }
    for (end, x, z) in [("front", 0.115, 0.007), ("back", -0.135, 0.009)] {
        let mount = Pose::from_xyz_rpy(DVec3::new(x, 0.0, z), DVec3::new(-FRAC_PI_2, 0.0, 0.0));
        let name = format!("caster_{end}_link");
        let caster = hang(&mut robot, base, &name, &format!("caster_{end}_joint"), JointKind::Fixed, mount);
        robot.links[caster].inertial = Some(inertial(0.01, [0.001; 3]));
        robot.links[caster].collisions = vec![Collision {
            friction: Some(0.0),
            ..collision(Pose::IDENTITY, Geometry::Cylinder { radius: 0.017, length: 0.0176 })
        }];
    }
    let camera_mount = Pose::from_xyz_rpy(DVec3::new(0.15, 0.0, 0.35), DVec3::new(0.0, -FRAC_PI_2, 0.0));
    let camera = hang(&mut robot, base, "base_camera_link", "camera_joint", JointKind::Fixed, camera_mount);
    robot.links[camera].inertial = Some(inertial(1e-6, [1e-6; 3]));
    robot.plugins = vec![kobuki_plugin([1, 2])];
    robot
}

/// Kobuki's plugin on the joints of the left and the right wheel.
fn kobuki_plugin([left, right]: [usize; 2]) -> ModelPlugin {
    let wheels = Wheels { left: vec![left], right: vec![right], radius_m: None, torque_n_m: 1.0 };
    ModelPlugin::Base(Box::new(BasePlugin {
        drive: Drive::Kobuki(wheels),
        command_topic: "/cmd_vel".into(),
        command_timeout_s: Some(0.6),
        odometry: OdometryPlugin {
            topic: "/odom".into(),
            frame: "odom".into(),
            child_frame: "base_footprint".into(),
            link: 0,
            rate_hz: Some(50.0),
            origin: OdometryOrigin::Encoders,
            is_transform: true,
            pose_variance: [0.1, 0.1, 1e6, 1e6, 1e6, 0.05],
        },
        source: source(),
    }))
}

pub(crate) fn static_model(name: &str, world_from_model: Pose, geometry: Geometry) -> Model {
    let mut body = link("link", Pose::IDENTITY);
    body.collisions.push(collision(Pose::IDENTITY, geometry));
    Model { world_from_model, is_static: true, links: vec![body], ..empty_model(name) }
}

pub(crate) fn ground() -> Model {
    static_model("ground", Pose::IDENTITY, Geometry::Plane { normal: DVec3::Z, size: [100.0; 2] })
}

pub(crate) fn world(max_step_size_s: f64, models: Vec<Model>) -> World {
    World {
        linear_light: false,
        name: "by_hand".into(),
        models,
        lights: Vec::new(),
        ambient: [0.4; 3],
        background: [0.7; 3],
        air: Air::default(),
        shadows: true,
        gravity: DVec3::new(0.0, 0.0, -9.8),
        earth: Earth::default(),
        max_step_size_s,
        source: source(),
    }
}
