//! The frames of pictures: x right, y down, z forward, whatever frame a camera's plugin names.

use crate::live::{Simulator, next_frame, output};
use belvedere::description::load::{LoadOptions, load_robot};
use belvedere::description::model::Model;
use belvedere::description::models::package_path;
use belvedere::description::optical::{new_frames, optical_frames};
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
    let frames = optical_frames(&model);
    let names: Vec<(&str, &str)> =
        frames.iter().map(|frame| (model.sensors[frame.sensor].name.as_str(), frame.name.as_str())).collect();
    let expected = [
        ("plain", "mast_optical"),
        ("tilted", "mast_tilted_optical"),
        ("unnamed", "head_optical"),
        ("kinect", "base_link_optical"),
    ];
    assert_eq!(names, expected, "those of the others are there, or nobody's to give");
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
    let known = optical_frames(&again);
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
