//! Sensors by other people: for ROS 2, and with lenses that Gazebo ignores.

use belvedere::description::model::{LensModel, Sensor, SensorKind};
use belvedere::description::sensor::{Camera, DepthCamera, Lidar, parse_sensor};
use belvedere::description::xml::Element;
use belvedere::description::{Diagnostics, Rules};
use belvedere::sensors::Pose;
use std::path::Path;

fn parse_with(text: &str, rules: Rules) -> (Option<Sensor>, Vec<String>) {
    let element = Element::parse(text, Path::new("s.sdf")).unwrap();
    let mut diagnostics = Diagnostics::default();
    let sensor = parse_sensor(&element, 0, Pose::IDENTITY, rules, &mut diagnostics);
    (sensor, diagnostics.problems().iter().map(ToString::to_string).collect())
}

fn parse(text: &str) -> (Option<Sensor>, Vec<String>) {
    parse_with(text, Rules::default())
}

fn accepted(text: &str) -> Sensor {
    let (sensor, problems) = parse(text);
    assert!(problems.is_empty(), "{problems:?}");
    sensor.unwrap()
}

fn scan(inside: &str) -> (Option<Sensor>, Vec<String>) {
    parse(&format!(
        "<sensor name='s' type='ray'><ray><range><min>0.1</min><max>5</max></range></ray>\
         <plugin name='laser' filename='libgazebo_ros_ray_sensor.so'>{inside}</plugin></sensor>"
    ))
}

#[test]
fn the_output_type_of_a_lidar_is_respected() {
    let ros = "<frame_name>base_scan</frame_name><output_type>sensor_msgs/LaserScan</output_type>";
    for (inside, topic, frame, is_cloud) in [
        (format!("<ros><remapping>~/out:=scan</remapping></ros>{ros}"), "/scan", "base_scan", false),
        (format!("<ros><argument>~/out:=scan</argument></ros>{ros}"), "/scan", "base_scan", false),
        (
            "<ros><namespace>/a</namespace><remapping> ~/out := ~/p </remapping></ros>".into(),
            "/a/laser/p",
            "",
            true,
        ),
        (
            "<ros><namespace>a</namespace><remapping>~/in:=x</remapping></ros>".into(),
            "/a/laser/out",
            "",
            true,
        ),
        ("<output_type>sensor_msgs/PointCloud2</output_type>".into(), "/laser/out", "", true),
    ] {
        let (sensor, problems) = scan(&inside);
        assert!(problems.is_empty(), "{problems:?}");
        let SensorKind::Ray(Lidar { plugin: Some(plugin), .. }) = sensor.unwrap().kind else { panic!() };
        assert_eq!((plugin.topic.as_str(), plugin.frame_name.as_str()), (topic, frame));
        assert_eq!(plugin.cloud.is_some(), is_cloud, "{inside}");
    }
    let (sensor, problems) = scan("<output_type>sensor_msgs/Image</output_type>");
    assert!(sensor.is_none() && problems[0].contains("<output_type> of sensor 's' is sensor_msgs/Image"));
}

#[test]
fn camera_topics_are_in_lower_case() {
    let plugin = "<plugin name='driver' filename='libgazebo_ros_camera.so'><ros><namespace>n</namespace>\
        <remapping>eye/image_raw:=/look</remapping></ros><camera_name>eye</camera_name>\
        <frame_name>eye_frame</frame_name><hack_baseline>0.07</hack_baseline></plugin>";
    let camera = accepted(&format!("<sensor name='s' type='camera'>{plugin}</sensor>"));
    let SensorKind::Camera(Camera { plugin: Some(p), .. }) = camera.kind else { panic!() };
    assert_eq!((p.image_topic.as_str(), p.camera_info_topic.as_str()), ("/look", "/n/eye/camera_info"));
    assert_eq!((p.frame_name.as_str(), p.hack_baseline_m), ("eye_frame", 0.07));
    // Without a name, the sensor's is used; a depth camera has topics in addition to the picture's.
    let plugin = "<plugin filename='libgazebo_ros_camera.so'><frame_name>f</frame_name>\
        <min_depth>0.001</min_depth></plugin>";
    let depth = accepted(&format!("<sensor name='s' type='depth'>{plugin}</sensor>"));
    let SensorKind::Depth(DepthCamera { plugin: Some(p), .. }) = depth.kind else { panic!() };
    assert_eq!(
        (p.camera.image_topic.as_str(), p.depth_image_topic.as_str()),
        ("/s/image_raw", "/s/depth/image_raw")
    );
    assert_eq!(
        (p.depth_camera_info_topic.as_str(), p.point_cloud_topic.as_str()),
        ("/s/depth/camera_info", "/s/points")
    );
    assert_eq!((p.cutoff_m, p.cutoff_max_m), (0.001, 100.0));
}

#[test]
fn lens_types_of_plain_cameras_mean_a_pinhole_in_gazebo() {
    let with = |inside: &str, rules: Rules| {
        let text = format!("<sensor name='c' type='camera'><camera><lens>{inside}</lens></camera></sensor>");
        let (sensor, problems) = parse_with(&text, rules);
        let Some(SensorKind::Camera(Camera { camera, .. })) = sensor.map(|sensor| sensor.kind) else {
            panic!("{problems:?}")
        };
        (camera.lens, problems.join("\n"))
    };
    let compat = || Rules { gazebo_compat: true, ..Rules::default() };
    let stereographic = "<type>stereographic</type><scale_to_hfov>1</scale_to_hfov>";
    // Intrinsics take precedence, as in Gazebo.
    let (lens, said) =
        with(&format!("{stereographic}<intrinsics><fx>170</fx></intrinsics>"), Rules::default());
    assert_eq!((lens.model, lens.intrinsics.fx), (LensModel::Pinhole, 170.0));
    assert!(said.contains("the <type> stereographic of sensor 'c' is left out"), "{said}");
    // Without them, the lens has its own type, except for Gazebo's cameras.
    assert!(matches!(with(stereographic, Rules::default()).0.model, LensModel::WideAngle { .. }));
    assert_eq!(with(stereographic, compat()).0.model, LensModel::Pinhole);
    // Types that are unknown to Gazebo never mean a pinhole.
    let (lens, said) = with("<type>equirectangular</type>", compat());
    assert_eq!((lens.model, said.as_str()), (LensModel::Equirectangular, ""));
    // A distortion is ignored in addition to such a lens.
    let text = format!(
        "<sensor name='c' type='camera'><camera><distortion><k1>.1</k1></distortion><lens>{stereographic}</lens>\
         </camera></sensor>"
    );
    let (sensor, problems) = parse(&text);
    assert!(
        sensor.is_some() && problems[0].contains("<distortion> of sensor 'c' is left out"),
        "{problems:?}"
    );
}
