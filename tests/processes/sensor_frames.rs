//! The frames of sensors' data: images have x right, y down, z forward, whatever frame a camera's plugin names; other
//! sensors have their own frame, also if they have a `<pose>` and no frame is named.

use crate::live::{Simulator, next_frame, output};
use belvedere::description::load::{LoadOptions, load_robot};
use belvedere::description::model::Model;
use belvedere::description::models::package_path;
use belvedere::description::sensor_frames::{SensorFrame, new_frames, sensor_frames};
use belvedere::description::{Diagnostics, Rules};
use belvedere_bridge::payload::Transform;
use glam::DVec3;
use std::fs;

/// Cameras with every relation to the frame that they name.
fn robot() -> String {
    let joint = |name: &str, parent: &str, kind: &str, origin: &str| {
        format!(
            "<link name='{name}'/><joint name='{name}_joint' type='{kind}'><parent link='{parent}'/><child link='{name}'/>
             <origin {origin}/><axis xyz='0 0 1'/></joint>"
        )
    };
    let camera = |name: &str, link: &str, kind: &str, pose: &str, frame: &str| {
        let plugin = if kind == "depth" { "openni_kinect" } else { "camera" };
        format!(
            "<gazebo reference='{link}'><sensor type='{kind}' name='{name}'><pose>{pose}</pose><update_rate>10</update_rate>
             <camera><horizontal_fov>1</horizontal_fov><image><width>16</width><height>16</height></image></camera>
             <plugin name='{name}' filename='libgazebo_ros_{plugin}.so'><cameraName>{name}</cameraName>
             <imageTopicName>image_raw</imageTopicName>{frame}</plugin></sensor></gazebo>"
        )
    };
    let named = |frame: &str| format!("<frameName>{frame}</frameName>");
    let parts = [
        "<robot name='eyes'><link name='base_link'/>".to_owned(),
        joint("mast", "base_link", "fixed", "xyz='0.1 0 1' rpy='0 -1.5708 0'"),
        joint("head", "mast", "fixed", "xyz='0.3 0.2 0' rpy='0.1 0.2 0.3'"),
        joint(
            "seen",
            "head",
            "fixed",
            "xyz='0.01 0.02 0.03' rpy='-1.5707963267948966 0 -1.5707963267948966'",
        ),
        joint("turret", "head", "continuous", "xyz='0 0 0.1'"),
        camera("plain", "mast", "camera", "0 0 0 0 0 0", &named("mast")),
        camera("tilted", "mast", "camera", "0.1 0 0.2 0 0.5 0", &named("mast")),
        camera("unnamed", "head", "camera", "0 0 0.5 0 0 1", ""),
        camera("kinect", "mast", "depth", "0 0.1 0 0.4 0 0", &named("base_link")),
        camera("optical", "head", "depth", "0 0 0 0 0 0", &named("seen")),
        camera("foreign", "head", "camera", "0 0 0 0 0 0", &named("elsewhere")),
        camera("moving", "turret", "camera", "0 0 0 0 0 0", &named("head")),
        "</robot>".to_owned(),
    ];
    parts.concat()
}

fn load(text: &str) -> Model {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("eyes.urdf");
    fs::write(&file, text).unwrap();
    let options =
        LoadOptions { packages: package_path([], None), rules: Rules::default(), xacro_args: Vec::new() };
    load_robot(file.to_str().unwrap(), &options, &mut Diagnostics::default()).unwrap()
}

#[test]
fn each_camera_has_an_optical_frame() {
    let model = load(&robot());
    let frames = sensor_frames(&model, "");
    let names: Vec<(&str, &str)> =
        frames.iter().map(|frame| (model.sensors[frame.sensor].name.as_str(), frame.name.as_str())).collect();
    let expected = [
        ("plain", "mast_optical"),
        ("tilted", "mast_tilted_optical"),
        ("unnamed", "head_optical"),
        ("kinect", "base_link_optical"),
    ];
    assert_eq!(
        names, expected,
        "the other cameras name a valid optical frame, or one that is not part of the robot"
    );
    for frame in &frames {
        let sensor = &model.sensors[frame.sensor];
        let model_from_sensor = model.links[sensor.link].model_from_link * sensor.link_from_sensor;
        let model_from_frame = model.links[frame.parent].model_from_link * frame.parent_from_frame;
        assert!(
            model_from_frame.translation().distance(model_from_sensor.translation()) < 1e-12,
            "{}",
            frame.name
        );
        for (axis, direction) in [(DVec3::Z, DVec3::X), (DVec3::X, DVec3::NEG_Y), (DVec3::Y, DVec3::NEG_Z)] {
            let [ours, theirs] =
                [model_from_frame.transform_vector(axis), model_from_sensor.transform_vector(direction)];
            assert!(ours.distance(theirs) < 1e-12, "{}: {ours} is not {theirs}", frame.name);
        }
        assert!(!frame.is_link);
    }
    assert_eq!(new_frames(&frames).count(), 4);

    // In the output of `belvedere urdf` for ROS, the robot has links with these names for the same frames.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("eyes.urdf");
    fs::write(&file, robot()).unwrap();
    let printed = output(&["urdf", file.to_str().unwrap()]);
    let again = load(&String::from_utf8(printed.stdout).unwrap());
    assert_eq!(again.links.len(), model.links.len() + 4);
    let known = sensor_frames(&again, "");
    assert!(known.iter().all(|frame| frame.is_link), "{known:#?}");
    assert_eq!(
        known.iter().map(|frame| &frame.name).collect::<Vec<_>>(),
        frames.iter().map(|frame| &frame.name).collect::<Vec<_>>()
    );
}

#[test]
fn the_ceiling_camera_and_tf_use_the_optical_frame() {
    for (arguments, frame) in [
        (&["--world", "empty"][..], "base_camera_link_optical"),
        (&["--world", "empty", "--gazebo-compat"], "base_camera_link"),
    ] {
        let simulator = Simulator::start(arguments);
        for topic in ["/image_raw", "/camera_info"] {
            let header = next_frame(&mut simulator.subscribe(topic));
            assert_eq!(header.header().frame_id.as_str(), frame, "{topic} {arguments:?}");
        }
        let fixed = next_frame(&mut simulator.subscribe("/tf_static"));
        let fixed: Vec<Transform> = fixed.view().structs().unwrap().collect();
        let optical = fixed.iter().find(|transform| transform.child.as_str() == "base_camera_link_optical");
        assert_eq!(optical.is_some(), frame.ends_with("_optical"), "{arguments:?}");
        if let Some(optical) = optical {
            assert_eq!((optical.parent.as_str(), optical.translation), ("base_camera_link", [0.0; 3]));
            let sign = optical.rotation[3].signum();
            for (ours, theirs) in optical.rotation.iter().zip([-0.5, 0.5, -0.5, 0.5]) {
                assert!((ours * sign - theirs).abs() < 1e-12, "{:?}", optical.rotation);
            }
        }
    }
}

/// A robot with a link `base` and these sensors: type, name, pose, what else is in them.
fn robot_with(sensors: &[(&str, &str, &str, &str)]) -> String {
    let sensor = |(kind, name, pose, inside): &(&str, &str, &str, &str)| {
        format!(
            "<sensor name='{name}' type='{kind}'><pose>{pose}</pose><update_rate>10</update_rate>{inside}<ray><scan>
             <horizontal><samples>3</samples><min_angle>-0.5</min_angle><max_angle>0.5</max_angle></horizontal></scan>
             <range><min>0.05</min><max>50</max></range></ray></sensor>"
        )
    };
    let sensors: String = sensors.iter().map(sensor).collect();
    format!(
        "<robot name='r'><link name='base'><inertial><mass value='1'/>
         <inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>
         <gazebo reference='base'>{sensors}</gazebo></robot>"
    )
}

const AHEAD: &str = "1 0 0.5 0 0 1.5707963";

#[test]
fn a_sensor_with_a_pose_and_no_named_frame_has_one_of_its_own() {
    let long = "s".repeat(58);
    let text = robot_with(&[
        ("imu", "imu", "0 0 0 0 1.5707963 0", "<topic>imu</topic>"),
        ("ray", "lid", AHEAD, "<topic>lid</topic>"),
        ("gpu_lidar", "lid", "0 1 0 0 0 0", "<topic>lid2</topic>"),
        ("sonar", "sonar", AHEAD, "<topic>sonar</topic>"),
        ("ray", "ros2", AHEAD, "<plugin name='p' filename='libgazebo_ros_ray_sensor.so'/>"),
        ("magnetometer", &long, AHEAD, "<topic>magnetic</topic>"),
        ("ray", "straight", "0 0 0 0 0 0", "<topic>straight</topic>"),
        ("ray", "named", AHEAD, "<topic>named</topic><gz_frame_id>base</gz_frame_id>"),
        (
            "ray",
            "classic",
            AHEAD,
            "<plugin name='p' filename='libgazebo_ros_laser.so'><topicName>c</topicName><frameName>base</frameName></plugin>",
        ),
    ]);
    let model = load(&text);
    let names = |frames: &[SensorFrame]| frames.iter().map(|frame| frame.name.clone()).collect::<Vec<_>>();
    let frames = sensor_frames(&model, "");
    let without_model = format!("base/{long}");
    assert_eq!(
        names(&frames),
        ["r/base/imu", "r/base/lid", "r/base/lid_2", "r/base/sonar", "r/base/ros2", without_model.as_str()]
    );
    for frame in &frames {
        assert_eq!((frame.parent, frame.is_link), (0, false));
        assert_eq!(frame.parent_from_frame, model.sensors[frame.sensor].link_from_sensor);
    }
    // In a namespace there is less room.
    assert_eq!(names(&sensor_frames(&model, "team")).last(), Some(&long));
    assert_eq!(sensor_frames(&model, "seven_eight").len(), 5);

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("r.urdf");
    fs::write(&file, &text).unwrap();
    let printed = output(&["urdf", file.to_str().unwrap()]);
    let again = load(&String::from_utf8(printed.stdout).unwrap());
    let known = sensor_frames(&again, "");
    assert_eq!(names(&known), names(&frames));
    assert!(known.iter().all(|frame| frame.is_link), "{known:#?}");
}

#[test]
fn data_of_a_sensor_with_a_pose_are_in_a_frame_that_tf_knows() {
    let text = robot_with(&[
        ("imu", "imu", "0 0 0 0 1.5707963 0", "<topic>imu</topic>"),
        ("ray", "lid", AHEAD, "<topic>lid</topic>"),
    ]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("r.urdf");
    fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    for (arguments, expected) in
        [(&[][..], ["r/base/lid", "r/base/imu"]), (&["--gazebo-compat"], ["base", "base"])]
    {
        let simulator = Simulator::start(&[&["--world", "empty", "--robot", file], arguments].concat());
        for (topic, expected) in ["/lid", "/imu"].into_iter().zip(expected) {
            let frame = next_frame(&mut simulator.subscribe(topic));
            assert_eq!(frame.header().frame_id.as_str(), expected, "{topic} {arguments:?}");
        }
        if arguments.is_empty() {
            let fixed = next_frame(&mut simulator.subscribe("/tf_static"));
            let fixed: Vec<Transform> = fixed.view().structs().unwrap().collect();
            let lidar = fixed.iter().find(|transform| transform.child.as_str() == "r/base/lid").unwrap();
            assert_eq!((lidar.parent.as_str(), lidar.translation), ("base", [1.0, 0.0, 0.5]));
            let half = std::f64::consts::FRAC_PI_4.sin();
            for (ours, expected) in lidar.rotation.iter().zip([0.0, 0.0, half, half]) {
                assert!((ours - expected).abs() < 1e-7, "{:?}", lidar.rotation);
            }
        }
    }
}
