//! One scene at several moments: poses are not part of the scene.

use crate::common::{LIDAR, Stage, add_grey, camera, picture, scan, scenery};
use belvedere_sensors::lidar::{Beams, Lidar, Scan};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Moment, Pose, SenseError, Sensor};
use glam::{DQuat, DVec3};

/// A ball of 0.5 m, 3 m ahead of the origin.
fn ball() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    add_grey(&mut builder, Shape::Sphere { radius: 0.5 }, Pose::from_translation(DVec3::X * 3.0));
    builder
}

/// The range of a beam along +x from the origin, with the ball at some pose.
fn ahead(builder: &SceneBuilder, ball: Pose) -> f32 {
    let beam = LIDAR.horizontal(Beams::ONE);
    scan((builder.scene(), &[ball][..]), beam, Pose::IDENTITY).0[0]
}

#[test]
fn one_scene_is_seen_at_two_moments() {
    let builder = ball();
    let at = |x| ahead(&builder, Pose::from_translation(DVec3::X * x));
    assert_eq!([at(3.0), at(5.0)], [2.5, 4.5]);
    assert_eq!(builder.poses(), [Pose::from_translation(DVec3::X * 3.0)], "the builder's own stay");
}

#[test]
fn an_instance_that_is_moved_back_looks_the_same() {
    let mut builder = SceneBuilder::new();
    let moving = scenery(&mut builder);
    let sensor = Pose::from_translation(DVec3::new(-3.0, 0.2, 0.5));
    let before = picture(&builder, camera(), sensor);
    let mut poses = builder.poses().to_vec();
    poses[moving.0 as usize] = Pose::from_translation(DVec3::new(-2.0, 0.2, 0.5));
    assert!(picture((builder.scene(), &poses[..]), camera(), sensor) != before);
    builder.set_pose(moving, poses[moving.0 as usize]).unwrap();
    assert!(picture((builder.scene(), &poses[..]), camera(), sensor) == picture(&builder, camera(), sensor));
}

#[test]
fn an_instance_without_a_finite_pose_is_invisible() {
    for nowhere in [
        Pose::from_translation(DVec3::new(f64::NAN, 0.0, 0.0)),
        Pose::from_translation(DVec3::X * f64::INFINITY),
        Pose::new(DVec3::X * 3.0, DQuat::from_array([0.0; 4])),
    ] {
        assert_eq!(ahead(&ball(), nowhere), f32::INFINITY, "{nowhere:?}");
    }
}

#[test]
fn a_pose_is_needed_for_each_instance() {
    let builder = ball();
    let stage = Stage::from((builder.scene(), &[][..]));
    let moment: Moment<'_> = stage.moment(Pose::IDENTITY);
    let lidar = Lidar::new(LIDAR).unwrap();
    let mut ranges = vec![0.0; lidar.beams()];
    let mut workspace = WorkspaceBuf::default();
    let capture = Capture::new(0, moment);
    let workspace = &mut workspace.lend(lidar.workspace_len(&stage.scene, &capture));
    let result = lidar.sense(&stage.scene, &capture, workspace, Scan::new().ranges(&mut ranges));
    assert_eq!(result, Err(SenseError::Poses { value: 0, need: 1 }));
}
