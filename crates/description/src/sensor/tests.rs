//! The articles' sensors, the defaults, and one error for each wrong value.

mod camera;
mod device;
mod lens;
mod preset;

use super::{Camera, DepthCamera, KINDS, Kind, Lidar, Rangefinder, kind_of, parse_sensor};
use crate::diagnostics::{Diagnostics, Severity};
use crate::model::{
    AngleFunction, AngleMap, AutoExposed, CameraDevice, CameraSensor, CloudLayout, LensIntrinsics, LensModel,
    LensProjection, Mosaic, Noise, PixelFormat, Radiation, ScanAxis, Sensor, SensorKind,
};
use crate::rules::Rules;
use crate::values::child_pose;
use crate::xml::Element;
use std::f64::consts::PI;
use std::path::Path;

fn parse(text: &str) -> (Option<Sensor>, Vec<String>) {
    parse_with(text, Rules::default())
}

fn parse_with(text: &str, rules: Rules) -> (Option<Sensor>, Vec<String>) {
    let element = Element::parse(text, Path::new("s.sdf")).unwrap();
    let mut diagnostics = Diagnostics::default();
    let pose = child_pose(&element, rules.gazebo_compat, &mut diagnostics);
    let sensor = parse_sensor(&element, 7, pose, rules, &mut diagnostics);
    (sensor, diagnostics.problems().iter().map(ToString::to_string).collect())
}

fn accepted(text: &str) -> Sensor {
    let (sensor, problems) = parse(text);
    assert!(problems.is_empty(), "{problems:?}");
    sensor.unwrap()
}

#[test]
fn a_type_and_a_plugin_name_one_kind() {
    for (number, kind) in KINDS.iter().enumerate() {
        let others =
            || KINDS.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, other)| other);
        for plugin in kind.plugins {
            let is_alike = |other: &Kind| other.types.iter().any(|one| kind.types.contains(one));
            assert!(others().all(|other| !is_alike(other) || !other.plugins.contains(plugin)), "{plugin}");
            assert!(crate::elements::has_context(plugin), "{plugin} has no list of parameters");
            for kind_type in kind.types {
                let text = format!(
                    "<sensor name='s' type='{kind_type}'><plugin filename='lib{plugin}.so'/></sensor>"
                );
                let element = Element::parse(&text, Path::new("s.sdf")).unwrap();
                assert!(std::ptr::eq(kind_of(&element).unwrap(), kind), "{text}");
            }
        }
    }
}

#[test]
fn defaults_are_those_of_sdf() {
    let camera = accepted("<sensor name='c' type='camera'/>");
    let SensorKind::Camera(Camera { camera: c, .. }) = &camera.kind else { panic!() };
    assert_eq!((c.width, c.height, c.format), (320, 240, PixelFormat::Rgb8));
    assert_eq!((c.horizontal_fov_rad, c.near_m, c.far_m), (1.047, 0.1, 100.0));
    assert_eq!((camera.update_rate_hz, camera.always_on, camera.link), (None, false, 7));

    let depth = accepted("<sensor name='d' type='depth'/>");
    assert!(matches!(&depth.kind, SensorKind::Depth(d) if d.camera.far_m == 100.0));

    let ray = accepted("<sensor name='r' type='gpu_ray'><ray><range><max>inf</max></range></ray></sensor>");
    let SensorKind::Ray(Lidar { ray: r, .. }) = &ray.kind else { panic!() };
    assert_eq!((r.horizontal.samples, r.vertical.samples), (640, 1));
    assert_eq!((r.range_min_m, r.range_max_m), (0.0, f64::INFINITY));
}

#[test]
fn camera_plugin_resolves_topics_against_the_camera_name() {
    let sensor = accepted(
        "<sensor name='c' type='camera'><update_rate>30</update_rate><camera><noise><type>Gaussian</type>\
         <stddev>0.007</stddev></noise></camera><plugin name='p' filename='libgazebo_ros_camera.so'>\
         <cameraName>head</cameraName><imageTopicName>/image_raw</imageTopicName><updateRate>10</updateRate>\
         <hackBaseline>0.07</hackBaseline><distortionK1>0.1</distortionK1><distortionT2>0.2</distortionT2>\
         <autoDistortion>true</autoDistortion><Cy>12</Cy></plugin></sensor>",
    );
    assert_eq!(sensor.effective_rate_hz(), Some(10.0));
    let SensorKind::Camera(Camera { camera, plugin: Some(plugin) }) = &sensor.kind else { panic!() };
    assert_eq!(camera.noise, Noise { stddev: 0.007, ..Noise::default() });
    assert_eq!(
        (plugin.image_topic.as_str(), plugin.camera_info_topic.as_str()),
        ("/image_raw", "/head/camera_info")
    );
    assert_eq!((plugin.hack_baseline_m, plugin.distortion), (0.07, [0.1, 0.0, 0.0, 0.0, 0.2]));
    assert!(plugin.auto_distortion);
    assert_eq!((plugin.principal_point, plugin.focal_length), ([None, Some(12.0)], None));
}

#[test]
fn kinect_plugin_has_its_own_defaults() {
    let sensor = accepted(
        "<sensor name='k' type='depth'><plugin name='p' filename='libgazebo_ros_openni_kinect.so'>\
         <cameraName>camera</cameraName><pointCloudTopicName>depth/points</pointCloudTopicName>\
         <distortion_k2>0.5</distortion_k2><useDepth16UC1Format>true</useDepth16UC1Format></plugin>\
         <camera><distortion><k2>0.5</k2></distortion></camera></sensor>",
    );
    let SensorKind::Depth(DepthCamera { plugin: Some(plugin), .. }) = &sensor.kind else { panic!() };
    assert_eq!(plugin.camera.image_topic, "/camera/ir/image_raw");
    assert_eq!(plugin.depth_image_topic, "/camera/depth/image_raw");
    assert_eq!(plugin.depth_camera_info_topic, "/camera/depth/camera_info");
    assert_eq!(plugin.point_cloud_topic, "/camera/depth/points");
    assert_eq!((plugin.cutoff_m, plugin.cutoff_max_m, plugin.depth_16uc1), (0.4, 5.0, true));
    assert_eq!(plugin.camera.distortion[1], 0.5);
}

#[test]
fn laser_plugin_defaults_to_world() {
    let laser = |parameters: &str| {
        let sensor = accepted(&format!(
            "<sensor name='l' type='ray'><ray><range><max>6</max></range></ray>\
             <plugin name='p' filename='libgazebo_ros_laser.so'>{parameters}</plugin></sensor>"
        ));
        let SensorKind::Ray(Lidar { plugin: Some(plugin), .. }) = sensor.kind else { panic!() };
        (plugin.topic, plugin.frame_name)
    };
    assert_eq!(laser(""), ("/world".into(), "/world".into()));
    assert_eq!(laser("<topicName>scan</topicName><frameName>l</frameName>"), ("/scan".into(), "l".into()));
}

#[test]
fn a_rangefinder_has_the_plugins_defaults() {
    let range = |parameters: &str| {
        let sensor = accepted(&format!(
            "<sensor name='s' type='ray'><update_rate>20</update_rate>\
             <ray><range><max>4</max></range><noise><stddev>0.03</stddev></noise></ray>\
             <plugin name='p' filename='libgazebo_ros_range.so'>{parameters}</plugin></sensor>"
        ));
        let SensorKind::Range(Rangefinder { ray, plugin: Some(plugin), .. }) = &sensor.kind else { panic!() };
        (plugin.clone(), ray.noise.stddev, sensor.effective_rate_hz())
    };
    let (plugin, stddev, rate) = range("");
    assert_eq!((plugin.topic.as_str(), plugin.frame_name.as_str()), ("/range", "/world"));
    assert_eq!((plugin.radiation, plugin.field_of_view_rad), (Radiation::Ultrasound, 0.05));
    assert_eq!((stddev, rate), (0.03, Some(20.0)));
    // The noises of both add up.
    let (plugin, stddev, rate) = range(
        "<topicName>sonar</topicName><radiation>infrared</radiation><fov>0.3</fov>\
         <gaussianNoise>0.04</gaussianNoise><updateRate>5</updateRate>",
    );
    assert_eq!((plugin.topic.as_str(), plugin.radiation), ("/sonar", Radiation::Infrared));
    assert_eq!((plugin.field_of_view_rad, rate), (0.3, Some(5.0)));
    assert!((stddev - 0.05).abs() < 1e-12);
}

#[test]
fn velodynes_plugin_limits_the_range_and_adds_noise() {
    let lidar = |parameters: &str| {
        format!(
            "<sensor name='v' type='gpu_ray'><ray><range><min>0.3</min><max>131</max></range></ray>\
             <plugin name='p' filename='libgazebo_ros_velodyne_gpu_laser.so'><topicName>points</topicName>\
             {parameters}</plugin></sensor>"
        )
    };
    let sensor = accepted(&lidar(
        "<min_range>0.9</min_range><max_range>130</max_range><gaussianNoise>0.008</gaussianNoise>",
    ));
    let SensorKind::Ray(Lidar { ray, plugin: Some(plugin), preset: None, .. }) = &sensor.kind else {
        panic!()
    };
    assert_eq!((plugin.topic.as_str(), plugin.cloud), ("/points", Some(CloudLayout::default())));
    assert_eq!((ray.range_min_m, ray.range_max_m, ray.noise.stddev), (0.9, 130.0, 0.008));
    let (_, problems) = parse(&lidar("<max_range>0.2</max_range>"));
    assert!(
        problems[0].contains("sensor 'v' and its plugin leave the ranges from 0.3 to 0.2 m"),
        "{problems:?}"
    );
}

#[test]
fn every_wrong_value_gives_one_error_that_names_it() {
    let camera = |inside: &str| format!("<sensor name='c' type='camera'><camera>{inside}</camera></sensor>");
    let ray = |inside: &str| {
        format!("<sensor name='r' type='ray'><ray><range><max>5</max></range>{inside}</ray></sensor>")
    };
    let scan = |axis: &str| ray(&format!("<scan><horizontal>{axis}</horizontal></scan>"));
    let cases = [
        (camera("<image><width>0</width></image>"), "<width> of sensor 'c' is 0"),
        (camera("<image><height>16385</height></image>"), "<height> of sensor 'c' is 16385"),
        (camera("<horizontal_fov>3.2</horizontal_fov>"), "<horizontal_fov> of sensor 'c' is 3.2"),
        (camera("<clip><near>0</near></clip>"), "<near> of sensor 'c' is 0"),
        (camera("<clip><near>9</near><far>8</far></clip>"), "<near> of sensor 'c' is 9 and <far> is 8"),
        (camera("<noise><type>salt</type></noise>"), "type 'salt'"),
        (camera("<noise><stddev>-1</stddev></noise>"), "<stddev> of sensor 'c' is -1"),
        (camera("<noise><precision>-1</precision></noise>"), "<precision> of sensor 'c' is -1"),
        (camera("<noise><mean>x</mean></noise>"), "'x' is not a finite number"),
        (
            "<sensor name='c' type='camera'><update_rate>-5</update_rate></sensor>".into(),
            "<update_rate> of sensor 'c' is -5",
        ),
        (scan("<samples>0</samples>"), "<samples> of sensor 'r' is 0"),
        (scan("<samples>32768</samples>"), "<samples> of sensor 'r' is 32768"),
        ("<sensor name='r' type='ray'><ray/></sensor>".into(), "<min> 0 and <max> 0"),
        (
            ray(
                "<scan><horizontal><samples>30000</samples></horizontal><vertical><samples>700</samples></vertical></scan>",
            ),
            "30000 × 700 = 21000000 beams",
        ),
        ("<sensor type='camera'/>".into(), "<sensor> has no name"),
    ];
    for (text, expected) in cases {
        let (sensor, problems) = parse(&text);
        assert!(sensor.is_none(), "{text}");
        assert_eq!(problems.len(), 1, "{text}: {problems:?}");
        assert!(
            problems[0].starts_with("s.sdf:1: error: ") && problems[0].contains(expected),
            "{problems:?}"
        );
        assert!(problems[0].contains("; "), "no remedy: {problems:?}");
    }
}

#[test]
fn what_gazebo_goes_on_with_is_a_warning() {
    let camera = |inside: &str, words: &str| {
        let (sensor, problems) = parse(&format!("<sensor name='c' type='camera'>{inside}</sensor>"));
        assert!(problems.len() == usize::from(!words.is_empty()), "{inside}: {problems:?}");
        assert!(
            problems.iter().all(|problem| problem.contains("warning: ") && problem.contains(words)),
            "{problems:?}"
        );
        let sensor = sensor.unwrap();
        let SensorKind::Camera(Camera { camera, .. }) = sensor.kind else { panic!() };
        (sensor.update_rate_hz, camera.width, camera.format)
    };
    let image = |inside: &str| format!("<camera><image>{inside}</image></camera>");
    assert_eq!(camera(&image("<width>32.5</width>"), "<width> of sensor 'c' is 32.5").1, 32);
    for odd in ["BAYER_RGGB9", "R_FLOAT32"] {
        let format =
            camera(&image(&format!("<format>{odd}</format>")), &format!("'{odd}', which no colour")).2;
        assert_eq!(format, PixelFormat::Rgb8);
    }
    // The format of a depth camera's depths does not set that of its colours.
    accepted(
        "<sensor name='d' type='depth'><camera><image><format>R_FLOAT32</format></image></camera></sensor>",
    );
    for (name, format) in [
        ("RGB8", PixelFormat::Rgb8),
        ("BGR8", PixelFormat::Bgr8),
        ("L16", PixelFormat::Mono16),
        ("BAYER_GRBG8", PixelFormat::Bayer8(Mosaic::Grbg)),
    ] {
        assert_eq!(camera(&image(&format!("<format>{name}</format>")), "").2, format, "{name}");
    }
    let rate = |text: &str, words: &str| camera(&format!("<update_rate>{text}</update_rate>"), words).0;
    assert_eq!(rate("1e6", ""), Some(1e6));
    assert_eq!(rate("2e6", "<update_rate> of sensor 'c' is 2000000 Hz: it measures at every step"), None);
    assert_eq!(rate("1e-7", "is 0.0000001 Hz: it measures every 1000000 s"), Some(1e-6));
    let (sensor, problems) = parse(
        "<sensor name='r' type='ray'><ray><range><max>5</max></range><scan><horizontal><samples>20.9</samples>\
         <min_angle>1</min_angle><max_angle>-2</max_angle></horizontal></scan></ray></sensor>",
    );
    let SensorKind::Ray(Lidar { ray, .. }) = sensor.unwrap().kind else { panic!() };
    let ScanAxis { samples, min_angle_rad, max_angle_rad } = ray.horizontal;
    assert_eq!((samples, min_angle_rad, max_angle_rad), (20, -2.0, 1.0));
    assert!(problems.len() == 2 && problems[1].contains("is 1 and <max_angle> is -2"), "{problems:?}");
}

#[test]
fn a_mask_of_a_lidar_that_hits_collision_shapes_is_without_effect() {
    let lidar = |kind: &str, mask: &str| {
        let text = format!(
            "<sensor name='s' type='{kind}'><lidar><range><max>5</max></range><visibility_mask>{mask}</visibility_mask></lidar></sensor>"
        );
        let (sensor, problems) = parse(&text);
        let mask = sensor.and_then(|sensor| sensor.kind.ray().map(|ray| ray.visibility_mask));
        (mask, problems.concat())
    };
    for kind in ["gpu_ray", "gpu_lidar"] {
        assert_eq!(lidar(kind, "0xFFFFFFFD"), (Some(0xFFFF_FFFD), String::new()));
    }
    for kind in ["ray", "lidar"] {
        assert_eq!(lidar(kind, "0xffffffff"), (Some(u32::MAX), String::new()));
        assert!(lidar(kind, "1").1.contains("warning: <visibility_mask> of sensor 's' is without effect"));
    }
    // libsdformat reads such numbers as C does: they wrap round at 2³².
    for (text, bits) in [("-1", u32::MAX), ("-2", u32::MAX - 1), ("+3", 3), ("0XfF", 0xff), ("true", 1)] {
        assert_eq!(lidar("gpu_ray", text), (Some(bits), String::new()), "{text}");
    }
    let (mask, problems) = lidar("gpu_ray", "0x100000003");
    assert_eq!(mask, Some(3));
    assert!(
        problems.contains("warning: <visibility_mask> is '0x100000003', more than 32 bits"),
        "{problems}"
    );
    for text in ["", "-", "0x", "0x-1", "--1", "all", "1.5", "99999999999999999999"] {
        let (mask, problems) = lidar("gpu_ray", text);
        assert!(mask.is_none() && problems.contains("error: <visibility_mask> is '"), "{text}: {problems}");
    }
}

#[test]
fn beams_may_be_told_by_the_plugin_alone() {
    let ray = |max: &str| {
        format!(
            "<ray><scan><horizontal><samples>100</samples><max_angle>6.28</max_angle></horizontal></scan>\
             <range><min>0.1</min><max>{max}</max></range></ray>"
        )
    };
    let livox = |inside: &str| {
        format!(
            "<sensor name='s' type='ray'>{inside}<plugin filename='liblivox_laser_simulation.so'>{}</plugin></sensor>",
            ray("200")
        )
    };
    let (sensor, problems) = parse(&livox(""));
    let SensorKind::Ray(lidar) = sensor.unwrap().kind else { panic!() };
    assert_eq!((lidar.ray.horizontal.samples, lidar.ray.range_max_m), (100, 200.0));
    assert!(problems.iter().all(|problem| problem.contains(": warning: ")), "{problems:?}");
    assert!(
        problems.concat().contains("has the beams of that in the plugin 'liblivox_laser_simulation.so'"),
        "{problems:?}"
    );
    // A sensor's own come first.
    let (sensor, _) = parse(&livox(&ray("50")));
    let SensorKind::Ray(lidar) = sensor.unwrap().kind else { panic!() };
    assert_eq!(lidar.ray.range_max_m, 50.0);
    let (sensor, problems) = parse("<sensor name='s' type='gpu_lidar'/>");
    let [only] = &problems[..] else { panic!("{problems:?}") };
    assert!(sensor.is_none() && only.contains("warning: sensor 's' has no <ray> and no <lidar>"), "{only}");
}

#[test]
fn what_is_not_simulated_gives_a_warning() {
    let (sensor, problems) = parse("<sensor name='s' type='thermal_camera'/>");
    assert!(sensor.is_none());
    assert!(
        problems[0].contains(&format!("{}: the sensor 's' has the type 'thermal_camera'", Severity::Warning))
    );
    let (sensor, problems) =
        parse("<sensor name='s' type='camera'><plugin name='p' filename='libother.so'/></sensor>");
    assert!(
        matches!(sensor.unwrap().kind, SensorKind::Camera(Camera { plugin: Some(p), .. }) if p.image_topic == "/{sensor}/image")
    );
    assert!(problems.len() == 1 && problems[0].contains("libgazebo_ros_openni_kinect.so"), "{problems:?}");
    assert_eq!(problems[0].matches("libgazebo_ros_camera.so").count(), 1, "{problems:?}");
    let (_, problems) = parse(
        "<sensor name='s' type='ray'><ray><range><max>5</max></range></ray><plugin filename='libgazebo_ros_lasr.so'/></sensor>",
    );
    assert!(problems[0].contains("did you mean libgazebo_ros_laser.so? these are"), "{problems:?}");
    let (_, problems) = parse("<sensor name='s' type='lasr'/>");
    assert_eq!(problems[0].matches(" gpu_ray").count(), 1, "{problems:?}");
}

/// Returns a camera of 640 × 480 with this content, and its warnings.
fn camera_of(kind: &str, inside: &str) -> (Option<CameraSensor>, Vec<String>) {
    let (sensor, problems) = parse(&format!(
        "<sensor name='c' type='{kind}'><camera><image><width>640</width><height>480</height></image>\n{inside}\
         </camera></sensor>"
    ));
    let camera = sensor.map(|sensor| match sensor.kind {
        SensorKind::Camera(Camera { camera, .. }) | SensorKind::Depth(DepthCamera { camera, .. }) => camera,
        other => panic!("{other:?}"),
    });
    (camera, problems)
}

fn lens_of(kind: &str, inside: &str) -> CameraSensor {
    let (camera, problems) = camera_of(kind, inside);
    assert!(problems.is_empty(), "{inside}: {problems:?}");
    camera.unwrap()
}
