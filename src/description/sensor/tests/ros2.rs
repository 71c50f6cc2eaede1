//! Plugins of ROS 2.

use super::*;

fn scan(inside: &str) -> (Option<Sensor>, Vec<String>) {
    parse(&format!(
        "<sensor name='s' type='ray'><ray><range><min>0.1</min><max>5</max></range></ray>\
         <plugin name='laser' filename='libgazebo_ros_ray_sensor.so'>{inside}</plugin></sensor>"
    ))
}

#[test]
fn lidars_publish_what_they_are_told_to() {
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
fn cameras_are_named_in_small_letters() {
    let plugin = "<plugin name='driver' filename='libgazebo_ros_camera.so'><ros><namespace>n</namespace>\
        <remapping>eye/image_raw:=/look</remapping></ros><camera_name>eye</camera_name>\
        <frame_name>eye_frame</frame_name><hack_baseline>0.07</hack_baseline></plugin>";
    let camera = accepted(&format!("<sensor name='s' type='camera'>{plugin}</sensor>"));
    let SensorKind::Camera(Camera { plugin: Some(p), .. }) = camera.kind else { panic!() };
    assert_eq!((p.image_topic.as_str(), p.camera_info_topic.as_str()), ("/look", "/n/eye/camera_info"));
    assert_eq!((p.frame_name.as_str(), p.hack_baseline_m), ("eye_frame", 0.07));
    // Without a name it is the sensor's; depth has topics beside the picture's.
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
    assert_eq!((p.cutoff_m, p.cutoff_max_m), (0.001, 10.0));
}
