//! The room with tags on its ceiling, as a scene of Belvedere and of parry3d, and the robot's sensors.

#![allow(dead_code, reason = "each target that includes this module uses a part of it")]
#![allow(unreachable_pub, reason = "a module of several targets, none of which exports it")]

use belvedere::description::load::load_world;
use belvedere::description::model::{Geometry, World};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use belvedere::world::physics::Physics;
use belvedere::world::scene::WorldScene;
use belvedere_sensors::Pose;
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::optics::Intrinsics;
use belvedere_sensors::optics::{Optics, PinholeGrid};
use belvedere_sensors::trace::Faces;
use glam::DVec3;
use parry3d::math::Pose as ParryPose;
use parry3d::query::{Ray, RayCast as _};
use parry3d::shape::{Ball, Compound, Cuboid, Cylinder, SharedShape};
use std::f64::consts::FRAC_PI_2;

/// Loads the description of the world.
pub fn room() -> World {
    let mut diagnostics = Diagnostics::default();
    load_world("tag_ceiling", &package_path([], None), Rules::default(), &mut diagnostics)
        .expect("our own world loads")
}

/// Creates the scene that the sensors see.
pub fn scene(world: &World) -> WorldScene {
    let physics = Physics::new(world).expect("our own world runs");
    WorldScene::new(world, &physics).expect("our own world shows")
}

/// Returns the robot's camera, with noise of the given standard deviation in colour values.
pub fn camera_config(stddev: f32) -> CameraConfig<'static> {
    camera_of_height(480, stddev)
}

/// Returns the same camera with another height of the image.
pub fn camera_of_height(height: u32, stddev: f32) -> CameraConfig<'static> {
    CameraConfig::new(PinholeGrid::from_fov(640, height, 1.396_263_4).expect("in range"))
        .noise(GaussianNoise::of_stddev(stddev).expect("in range"))
        .seed(1)
}

/// Returns the pose of the robot's camera, which looks straight up.
pub fn up() -> Pose {
    Pose::from_xyz_rpy(DVec3::new(0.3, -0.2, 0.36), DVec3::new(0.0, -FRAC_PI_2, 0.0))
}

/// Returns a pose that looks across the room.
pub fn across() -> Pose {
    Pose::from_xyz_rpy(DVec3::new(-1.5, 0.4, 0.6), DVec3::new(0.0, 0.1, 0.3))
}

/// Returns the robot's depth camera.
pub fn depth_camera() -> DepthCamera<'static> {
    let config =
        DepthCameraConfig::new(camera_config(0.0)).faces(Faces::Front).min_depth_m(0.1).max_depth_m(20.0);
    DepthCamera::new(config).expect("in range")
}

/// The scene in parry3d.
pub fn compound(world: &World) -> Compound {
    let mut parts = Vec::new();
    for model in &world.models {
        for link in &model.links {
            for visual in &link.visuals {
                let pose = model.world_from_model * link.model_from_link * visual.link_from_visual;
                let (shape, turn) = match visual.geometry {
                    Geometry::Box { size } => {
                        (SharedShape::new(Cuboid::new((size * 0.5).as_vec3())), Pose::IDENTITY)
                    }
                    Geometry::Sphere { radius } => {
                        (SharedShape::new(Ball::new(radius as f32)), Pose::IDENTITY)
                    }
                    // parry's cylinder is along y.
                    Geometry::Cylinder { radius, length } => (
                        SharedShape::new(Cylinder::new(length as f32 * 0.5, radius as f32)),
                        Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(FRAC_PI_2, 0.0, 0.0)),
                    ),
                    _ => continue,
                };
                let pose = pose * turn;
                parts.push((
                    ParryPose::from_parts(pose.translation().as_vec3(), pose.rotation().as_quat()),
                    shape,
                ));
            }
        }
    }
    Compound::new(parts)
}

/// Casts the rays of the depth camera with parry3d, one by one.
pub fn cast_each(shapes: &Compound, depth: &DepthCamera<'_>, world_from_sensor: &Pose, depths: &mut [f32]) {
    let Optics::Pinhole(grid) = depth.camera().config().optics else { return };
    let (Intrinsics { fx, fy, cx, cy, .. }, [width, _]) = (grid.intrinsics(), grid.size());
    let origin = world_from_sensor.translation().as_vec3();
    for (index, depth) in depths.iter_mut().enumerate() {
        let [column, row] = [index % width as usize, index / width as usize].map(|at| at as f64);
        let ray = DVec3::new(1.0, (cx - column) / fx, (cy - row) / fy);
        let ray = world_from_sensor.transform_vector(ray).as_vec3();
        *depth = shapes
            .cast_ray(&ParryPose::IDENTITY, &Ray::new(origin, ray), 20.0, true)
            .unwrap_or(f32::INFINITY);
    }
}
