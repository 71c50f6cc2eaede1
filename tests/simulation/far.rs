//! Far from the origin, as at coordinates of UTM, everything moves as at the origin, and sensors measure the same.

use belvedere::description::load;
use belvedere::description::model::World;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere::world::physics::{FARTHEST_M, Physics};
use belvedere_bridge::payload::Imu;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::Duration;

/// UTM coordinates of a place in Germany, and one about as far as commands accept.
const PLACES: [DVec3; 2] = [DVec3::new(448_262.27, 5_428_765.81, 113.4), DVec3::new(9.99e6, -9.99e6, 0.0)];

/// How the crate goes over the floor at first: it slides and turns. One that fell onto its edges would amplify the rounding of
/// its coordinates with each impact, wherever it is.
const PUSH: [DVec3; 2] = [DVec3::new(0.8, 0.3, 0.0), DVec3::new(0.0, 0.0, 2.0)];

/// All shapes have plane faces: where a ray grazes a round one, its depth changes by the root of the smallest shift. None is grazed.
/// Two lamps, a floor and a wall, a block that falls and bounces, and a crate that stands on the floor, around `at`.
fn text(at: DVec3) -> String {
    let place = |x: f64, y: f64, z: f64, turn: &str| {
        format!("<pose>{} {} {} {turn}</pose>", at.x + x, at.y + y, at.z + z)
    };
    let model = |name: &str, place: String, fixed: u8, shape: &str, surface: &str| {
        format!(
            "<model name='{name}'>{place}<static>{fixed}</static><link name='l'><inertial><mass>1</mass>
             <inertia><ixx>.02</ixx><iyy>.02</iyy><izz>.02</izz></inertia></inertial>
             <collision name='c'><geometry>{shape}</geometry>{surface}</collision>
             <visual name='v'><geometry>{shape}</geometry></visual></link></model>"
        )
    };
    let plane = "<plane><normal>0 0 1</normal><size>60 60</size></plane>";
    let smooth = "<surface><friction><ode><mu>.3</mu><mu2>.3</mu2></ode></friction></surface>";
    let bouncing =
        "<surface><bounce><restitution_coefficient>0.8</restitution_coefficient></bounce></surface>";
    [
        format!("<light name='lamp' type='point'>{}</light>", place(1.0, 1.5, 3.0, "0 0 0")),
        "<light name='sun' type='directional'><direction>0.3 0.4 -1</direction></light>".into(),
        model("floor", place(0.0, 0.0, 0.0, "0 0 0"), 1, plane, bouncing),
        model("wall", place(4.0, 0.0, 1.0, "0 0 0.2"), 1, "<box><size>.2 6 3</size></box>", ""),
        model("block", place(2.0, 0.5, 0.8, "0 0 .6"), 0, "<box><size>.3 .4 .4</size></box>", bouncing),
        model("crate", place(2.5, -0.6, 0.25, "0 0 .1"), 0, "<box><size>.4 .3 .5</size></box>", smooth),
    ]
    .concat()
}

/// A floating device with a camera, a depth camera, a planar lidar, a lidar whose beams have times, and an inertial unit.
const DEVICE: &str = "<sdf version='1.6'><model name='device'><link name='l'><gravity>false</gravity>
    <sensor name='eye' type='camera'><topic>picture</topic><camera><horizontal_fov>1.2</horizontal_fov>
      <image><width>160</width><height>120</height></image></camera></sensor>
    <sensor name='deep' type='depth'><camera><horizontal_fov>1.2</horizontal_fov>
      <image><width>160</width><height>120</height></image></camera>
      <plugin name='p' filename='libgazebo_ros_openni_kinect.so'><cameraName>deep</cameraName></plugin></sensor>
    <sensor name='laser' type='ray'><ray><scan><horizontal><samples>181</samples><min_angle>-1</min_angle>
      <max_angle>1</max_angle></horizontal></scan><range><min>.1</min><max>20</max></range></ray>
      <plugin name='p' filename='libgazebo_ros_laser.so'><topicName>scan</topicName></plugin></sensor>
    <sensor name='rings' type='ray'><update_rate>10</update_rate><ray><scan><horizontal><samples>91</samples>
      <min_angle>-1</min_angle><max_angle>1</max_angle></horizontal><vertical><samples>8</samples>
      <min_angle>-.3</min_angle><max_angle>.3</max_angle></vertical></scan><range><min>.1</min><max>20</max></range></ray>
      <plugin name='p' filename='libgazebo_ros_velodyne_laser.so'><topicName>points</topicName></plugin></sensor>
    <sensor name='imu' type='imu'><topic>imu</topic></sensor></link></model></sdf>";

fn world(at: DVec3) -> World {
    crate::sdf::good("1.7", &text(at))
}

/// What the sensors of a device measure that has moved and turned past the scene for half a second: the picture, and the
/// numbers of each other stream.
fn measured(at: DVec3) -> (Vec<u8>, Vec<(&'static str, Vec<f64>)>) {
    let mut simulation = Simulation::builder(world(at)).build().unwrap();
    let start = Pose::from_xyz_rpy(at + DVec3::new(-0.2, 0.3, 0.7), DVec3::ZERO);
    let options = SpawnOptions { world_from_model: start, ..SpawnOptions::default() };
    let device = simulation.spawn(&load::model(DEVICE).unwrap(), options).unwrap();
    simulation.place(device, &start, DVec3::new(0.4, -0.3, 0.1), DVec3::new(0.1, 0.2, -0.3)).unwrap();
    let sliding = simulation.find("crate").unwrap();
    let place = simulation.pose(sliding).unwrap();
    simulation.place(sliding, &place, PUSH[0], PUSH[1]).unwrap();
    let mut frame = FrameBuf::default();
    // From now on physics remembers poses.
    simulation.render("points", &mut frame).unwrap();
    simulation.run_for(Duration::from_millis(500));
    let mut render = |topic: &str| {
        let mut frame = FrameBuf::default();
        simulation.render(topic, &mut frame).unwrap();
        frame
    };
    let floats = |frame: &FrameBuf| {
        let view = frame.view();
        view.numbers::<f32>(view.rows()).map(f64::from).collect::<Vec<f64>>()
    };
    let picture = render("picture").payload().to_vec();
    let depths = floats(&render("deep/depth/image_raw"));
    let ranges = floats(&render("scan"));
    let cloud = render("points");
    let view = cloud.view();
    let points = view.numbers::<[u8; 22]>(view.rows()).flat_map(|point| {
        [0, 4, 8]
            .map(|at| f64::from(f32::from_le_bytes([point[at], point[at + 1], point[at + 2], point[at + 3]])))
    });
    let points = points.collect();
    let imu: Imu = bytemuck::pod_read_unaligned(render("imu").payload());
    let imu = [&imu.orientation[..], &imu.angular_velocity, &imu.linear_acceleration].concat();
    (picture, vec![("depth", depths), ("ranges", ranges), ("points", points), ("imu", imu)])
}

#[test]
fn sensors_measure_the_same_as_at_the_origin() {
    let (picture, near) = measured(DVec3::ZERO);
    assert!(picture.iter().any(|value| *value != picture[0]), "the picture shows something");
    for at in PLACES {
        let (far_picture, far) = measured(at);
        let most = picture.iter().zip(&far_picture).map(|(near, far)| near.abs_diff(*far)).max();
        assert!(picture.len() == far_picture.len() && most <= Some(1), "{at}: {most:?}");
        for ((name, near), (_, far)) in near.iter().zip(&far) {
            assert!(near.len() == far.len() && near.iter().any(|value| value.is_finite()), "{name}");
            let off = near.iter().zip(far).map(|(near, far)| {
                if near == far || near.is_nan() && far.is_nan() { 0.0 } else { (near - far).abs() }
            });
            let off = off.fold(0.0, |most: f64, off| if off > most || off.is_nan() { off } else { most });
            println!("{at}: {name} differ by {off:.1e} at most, of {}", near.len());
            assert!(off < 1e-5, "{at}: {name} differ by {off}");
        }
    }
}

#[test]
fn bodies_fall_bounce_and_slide_the_same_as_at_the_origin() {
    let places = |at: DVec3| {
        let mut physics = Physics::new(&world(at)).unwrap();
        assert!(physics.take_notes().is_empty());
        let crate_at = physics.world_from_model(3);
        physics.move_model(3, &crate_at, PUSH[0], PUSH[1]);
        (0..1500).for_each(|_| physics.step());
        [2, 3].map(|model| {
            let pose = physics.world_from_model(model);
            (pose.translation() - at, pose.rotation())
        })
    };
    let near = places(DVec3::ZERO);
    assert!(near[1].0.distance(DVec3::new(2.5, -0.6, 0.25)) > 0.05, "the crate slides");
    for at in PLACES {
        for ((near_place, near_turn), (place, turn)) in near.iter().zip(places(at)) {
            let off = near_place.distance(place);
            println!("{at}: {off:.1e} m");
            assert!(off < 1e-5 && near_turn.angle_between(turn) < 1e-5, "{at}: {off} m");
        }
    }
}

#[test]
fn a_model_too_far_away_is_told() {
    let mut physics = Physics::new(&world(DVec3::X * 3.0 * FARTHEST_M)).unwrap();
    let notes = physics.take_notes();
    assert_eq!(notes.len(), 4, "{notes:#?}");
    assert!(notes[0].to_string().contains("model 'floor' is at 30000000 0 0"), "{}", notes[0]);
}
