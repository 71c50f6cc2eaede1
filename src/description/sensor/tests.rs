//! The articles' sensors, the defaults, and one error for each wrong value.

use super::parse_sensor;
use crate::description::diagnostics::{Diagnostics, Severity};
use crate::description::model::{
    AngleFunction, AngleMap, AutoExposed, CameraDevice, CameraSensor, LensIntrinsics, LensModel,
    LensProjection, Noise, PixelFormat, Plugin, Radiation, Sensor, SensorKind,
};
use crate::description::xml::Element;
use std::f64::consts::PI;
use std::path::Path;

fn parse(text: &str) -> (Option<Sensor>, Vec<String>) {
    let element = Element::parse(text, Path::new("s.sdf")).unwrap();
    let mut diagnostics = Diagnostics::default();
    let sensor = parse_sensor(&element, 7, &mut diagnostics);
    (sensor, diagnostics.problems().iter().map(ToString::to_string).collect())
}

fn accepted(text: &str) -> Sensor {
    let (sensor, problems) = parse(text);
    assert!(problems.is_empty(), "{problems:?}");
    sensor.unwrap()
}

#[test]
fn defaults_are_those_of_sdf() {
    let camera = accepted("<sensor name='c' type='camera'/>");
    let SensorKind::Camera(c) = &camera.kind else { panic!() };
    assert_eq!((c.width, c.height, c.format), (320, 240, PixelFormat::Rgb8));
    assert_eq!((c.horizontal_fov_rad, c.near_m, c.far_m), (1.047, 0.1, 100.0));
    assert_eq!((camera.update_rate_hz, camera.always_on, camera.link), (None, false, 7));

    let depth = accepted("<sensor name='d' type='depth'/>");
    assert!(matches!(&depth.kind, SensorKind::Depth(d) if d.far_m == 10.0));

    let ray = accepted("<sensor name='r' type='gpu_ray'><ray><range><max>inf</max></range></ray></sensor>");
    let SensorKind::Ray(r) = &ray.kind else { panic!() };
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
    let SensorKind::Camera(camera) = &sensor.kind else { panic!() };
    assert_eq!(camera.noise, Noise { stddev: 0.007, ..Noise::default() });
    let Some(Plugin::Camera(plugin)) = &sensor.plugin else { panic!() };
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
         <distortion_k2>0.5</distortion_k2><useDepth16UC1MM>true</useDepth16UC1MM></plugin>\
         <camera><distortion><k2>0.5</k2></distortion></camera></sensor>",
    );
    let Some(Plugin::DepthCamera(plugin)) = &sensor.plugin else { panic!() };
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
        let Some(Plugin::Laser(plugin)) = sensor.plugin else { panic!() };
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
        let (Some(Plugin::Range(plugin)), SensorKind::Ray(ray)) = (&sensor.plugin, &sensor.kind) else {
            panic!()
        };
        (plugin.clone(), ray.noise.stddev, sensor.effective_rate_hz())
    };
    let (plugin, stddev, rate) = range("");
    assert_eq!((plugin.topic.as_str(), plugin.frame_name.as_str()), ("/range", "/world"));
    assert_eq!((plugin.radiation, plugin.field_of_view_rad), (Radiation::Ultrasound, 0.05));
    assert_eq!((stddev, rate), (0.03, Some(20.0)));
    // The noise of both.
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
    let (Some(Plugin::Laser(plugin)), SensorKind::Ray(ray)) = (&sensor.plugin, &sensor.kind) else {
        panic!()
    };
    assert_eq!(plugin.topic, "/points");
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
        (camera("<image><width>32.5</width></image>"), "<width> of sensor 'c' is 32.5"),
        (camera("<image><height>16385</height></image>"), "<height> of sensor 'c' is 16385"),
        (camera("<image><format>BAYER_RGGB9</format></image>"), "'BAYER_RGGB9'"),
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
        (scan("<min_angle>1</min_angle><max_angle>-1</max_angle>"), "is 1 and <max_angle> is -1"),
        ("<sensor name='r' type='ray'/>".into(), "<min> 0 and <max> 0"),
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
fn what_is_not_simulated_gives_a_warning() {
    let (sensor, problems) = parse("<sensor name='s' type='sonar'/>");
    assert!(sensor.is_none());
    assert!(problems[0].contains(&format!("{}: the sensor 's' has the type 'sonar'", Severity::Warning)));
    let (sensor, problems) =
        parse("<sensor name='s' type='camera'><plugin name='p' filename='libother.so'/></sensor>");
    assert!(sensor.unwrap().plugin.is_none());
    assert!(problems.len() == 1 && problems[0].contains("libgazebo_ros_openni_kinect.so"), "{problems:?}");
}

/// A camera of 640 × 480 with this inside, and what was warned of.
fn camera_of(kind: &str, inside: &str) -> (Option<CameraSensor>, Vec<String>) {
    let (sensor, problems) = parse(&format!(
        "<sensor name='c' type='{kind}'><camera><image><width>640</width><height>480</height></image>\n{inside}\
         </camera></sensor>"
    ));
    let camera = sensor.map(|sensor| match sensor.kind {
        SensorKind::Camera(camera) | SensorKind::Depth(camera) => camera,
        SensorKind::Ray(_) => panic!(),
    });
    (camera, problems)
}

fn lens_of(kind: &str, inside: &str) -> CameraSensor {
    let (camera, problems) = camera_of(kind, inside);
    assert!(problems.is_empty(), "{inside}: {problems:?}");
    camera.unwrap()
}

#[test]
fn a_distortion_has_as_many_coefficients_as_its_longest_model() {
    let pinhole = lens_of("camera", "<horizontal_fov>1.396</horizontal_fov>");
    assert_eq!(pinhole.lens.model, LensModel::Pinhole);
    let focal = 320.0 / libm::tan(0.698);
    let LensIntrinsics { fx, fy, cx, cy, skew } = pinhole.lens.intrinsics;
    assert!((fx - focal).abs() < 1e-9);
    assert_eq!((fy, cx, cy, skew), (fx, 319.5, 239.5, 0.0));
    for (inside, expected) in [
        ("<k1>.1</k1><p2>.2</p2><k3>.3</k3>", &[0.1, 0.0, 0.0, 0.2, 0.3][..]),
        ("<k1>.1</k1><k6>.6</k6>", &[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.6]),
        ("<s1>.1</s1>", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0]),
        ("<k2>1</k2><tau_y>-.1</tau_y>", &[0., 1., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., -0.1]),
    ] {
        let camera = lens_of("depth", &format!("<distortion>{inside}</distortion>"));
        assert_eq!(camera.lens.model, LensModel::BrownConrady { coefficients: expected.to_vec() });
    }
    let zeros = "<distortion><k1>0</k1><p1>0</p1><center>0.5 0.5</center></distortion>";
    assert_eq!(lens_of("camera", zeros).lens.model, LensModel::Pinhole);
    let off = lens_of("camera", "<distortion><k1>-.2</k1><center>0.25 0.75</center></distortion>");
    assert_eq!((off.lens.intrinsics.cx, off.lens.intrinsics.cy), (159.5, 359.5));
}

#[test]
fn a_lens_fits_its_angle_of_view_into_the_picture() {
    let widest = |model: &LensModel| model.widest_view_rad();
    for (inside, fov, model, focal) in [
        (
            "<type>kannala_brandt</type><k1>.1</k1><k4>-.001</k4>",
            3.0,
            LensModel::KannalaBrandt { k: [0.1, 0.0, 0.0, -0.001] },
            // θ = 1.5: 1.5 + 0.1·1.5³ − 0.001·1.5⁹
            320.0 / (1.5 + 0.337_5 - 0.038_443_359_375),
        ),
        (
            "<type>eucm</type><alpha>.5</alpha><beta>1</beta>",
            PI,
            LensModel::Eucm { alpha: 0.5, beta: 1.0 },
            160.0,
        ),
        (
            "<type>double_sphere</type><xi>0</xi><alpha>.5</alpha>",
            PI,
            LensModel::DoubleSphere { xi: 0.0, alpha: 0.5 },
            160.0,
        ),
        (
            "<type>mei</type><xi>1</xi><k1>.5</k1><p1>.01</p1>",
            PI,
            LensModel::Mei { xi: 1.0, k1: 0.5, k2: 0.0, p1: 0.01, p2: 0.0 },
            320.0 / 1.5,
        ),
        ("<type>equirectangular</type>", 6.283_186, LensModel::Equirectangular, 320.0 / PI),
    ] {
        let text = format!("<horizontal_fov>{fov}</horizontal_fov><lens>{inside}</lens>");
        let camera = lens_of("camera", &text);
        assert_eq!(camera.lens.model, model);
        assert!((camera.lens.intrinsics.fx - focal).abs() < 1e-9 * focal, "{inside}: {:?}", camera.lens);
        assert!(camera.horizontal_fov_rad <= widest(&model));
    }
    let lens = "<lens><type>eucm</type><alpha>.6</alpha><beta>1.1</beta><intrinsics><fx>300</fx><fy>301</fy>\
                <cx>320.5</cx><cy>240.5</cy><s>.25</s></intrinsics>\
                <projection><p_fx>290</p_fx><tx>-30</tx></projection></lens>";
    let camera = lens_of("camera", lens);
    let expected = LensIntrinsics { fx: 300.0, fy: 301.0, cx: 320.5, cy: 240.5, skew: 0.25 };
    assert_eq!((camera.lens.intrinsics, camera.lens.has_own_focal_length), (expected, true));
    let expected = LensProjection { fx: 290.0, fy: 301.0, cx: 320.5, cy: 240.5, tx: -30.0, ty: 0.0 };
    assert_eq!(camera.lens.projection, Some(expected));
    // A pinhole's angle of view follows.
    let camera = lens_of("camera", "<lens><intrinsics><fx>320</fx></intrinsics></lens>");
    assert!((camera.horizontal_fov_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!((camera.lens.intrinsics.fy, camera.lens.intrinsics.cx), (320.0, 319.5));
}

#[test]
fn sdfs_wide_angle_lenses_are_maps_of_the_angle() {
    for (kind, c1, c2, function, radius) in [
        ("stereographic", 2.0, 2.0, AngleFunction::Tangent, 2.0 * libm::tan(0.5)),
        ("equidistant", 1.0, 1.0, AngleFunction::Identity, 1.0),
        ("equisolid_angle", 2.0, 2.0, AngleFunction::Sine, 2.0 * libm::sin(0.5)),
        ("orthographic", 1.0, 1.0, AngleFunction::Sine, libm::sin(1.0)),
        ("gnomonical", 1.0, 1.0, AngleFunction::Tangent, libm::tan(1.0)),
    ] {
        let text = format!("<horizontal_fov>2</horizontal_fov><lens><type>{kind}</type></lens>");
        let camera = lens_of("wideanglecamera", &text);
        let focal_px = 320.0 / radius;
        let LensModel::WideAngle { map, scale_to_hfov: true, cutoff_angle_rad } = camera.lens.model else {
            panic!("{:?}", camera.lens)
        };
        assert!((cutoff_angle_rad - 0.5 * PI).abs() < 1e-4);
        assert!(
            (map.focal_px - focal_px).abs() < 1e-9 && (camera.lens.intrinsics.fx - focal_px).abs() < 1e-9
        );
        assert_eq!(map, AngleMap { c1, c2, c3: 0.0, focal_px: map.focal_px, function });
    }
    // Not scaled: <f> is in halves of the width. SDF's default is a stereographic lens.
    let camera = lens_of(
        "wide_angle_camera",
        "<lens><type>custom</type><scale_to_hfov>false</scale_to_hfov><cutoff_angle>2.5</cutoff_angle>\
         <custom_function><c1>1.05</c1><c2>4</c2><f>1.5</f><fun>tan</fun></custom_function></lens>",
    );
    let map = AngleMap { c1: 1.05, c2: 4.0, c3: 0.0, focal_px: 480.0, function: AngleFunction::Tangent };
    let expected = LensModel::WideAngle { map, scale_to_hfov: false, cutoff_angle_rad: 2.5 };
    assert_eq!((camera.lens.model, camera.lens.intrinsics.fx), (expected, 126.0));
    let camera = lens_of("wideanglecamera", "");
    assert!(matches!(camera.lens.model, LensModel::WideAngle { map: AngleMap { c1: 2.0, .. }, .. }));
}

#[test]
fn a_wrong_lens_gives_one_error_with_its_line() {
    for (inside, expected) in [
        (
            "<distortion><k4>nan</k4></distortion>",
            "<k4> of sensor 'c' is 'nan': 'nan' is not a finite number",
        ),
        ("<distortion><tau_x>1.6</tau_x></distortion>", "<tau_x> of sensor 'c' is 1.6; write an angle"),
        ("<distortion><center>0.5</center></distortion>", "<center> of sensor 'c' is '0.5': too few"),
        ("<distortion><center>320 240</center></distortion>", "<center> of sensor 'c' is 320 240; write two"),
        ("<lens><type>fisheye</type></lens>", "is of type 'fisheye'; did you mean"),
        ("<lens><type>custom</type></lens>", "has no <custom_function>; write"),
        ("<lens><type>eucm</type><alpha>1.5</alpha><beta>1</beta></lens>", "<alpha> of sensor 'c' is 1.5"),
        (
            "<lens><type>eucm</type><alpha>.5</alpha></lens>",
            "<beta> of sensor 'c' is missing; write a number",
        ),
        ("<lens><type>double_sphere</type><xi>-1</xi><alpha>.5</alpha></lens>", "<xi> of sensor 'c' is -1"),
        ("<lens><type>mei</type><xi>inf</xi></lens>", "<xi> of sensor 'c' is 'inf'"),
        ("<lens><intrinsics><fx>0</fx></intrinsics></lens>", "<fx> of sensor 'c' is 0; write a focal length"),
        ("<lens><projection><p_fy>-1</p_fy></projection></lens>", "<p_fy> of sensor 'c' is -1"),
        (
            "<lens><type>equidistant</type><cutoff_angle>4</cutoff_angle></lens>",
            "<cutoff_angle> of sensor 'c' is 4",
        ),
        (
            "<lens><type>custom</type><custom_function><fun>cot</fun></custom_function></lens>",
            "<fun> of sensor 'c' is 'cot'; write sin, tan or id",
        ),
        (
            "<lens><type>custom</type><custom_function><c2>0</c2></custom_function></lens>",
            "<c2> of sensor 'c' is 0; write a number above 0",
        ),
        (
            "<horizontal_fov>4</horizontal_fov><lens><type>orthographic</type></lens>",
            "<horizontal_fov> of sensor 'c' is 4; write the full angle in radians, above 0 and at most 3.14159",
        ),
        (
            "<distortion><k1>1</k1></distortion><lens><type>kannala_brandt</type></lens>",
            "has a <distortion>, which is a pinhole's, and a lens of type kannala_brandt; take one",
        ),
        // It folds back at 1.15 rad.
        (
            "<horizontal_fov>2.5</horizontal_fov><lens><type>kannala_brandt</type><k1>-.25</k1></lens>",
            "<horizontal_fov> of sensor 'c' is 2.5; write the full angle in radians, above 0 and at most 2.30",
        ),
    ] {
        let (camera, problems) = camera_of("camera", inside);
        assert!(camera.is_none() && problems.len() == 1, "{inside}: {problems:?}");
        assert!(
            problems[0].starts_with("s.sdf:2: error: ") && problems[0].contains(expected),
            "{problems:?}"
        );
    }
}

#[test]
fn what_a_camera_does_not_honour_gives_a_warning_with_its_line() {
    for (kind, inside, expected) in [
        ("camera", "<save enabled='true'><path>p</path></save>", "<save> of sensor 'c' is not simulated"),
        ("camera", "<depth_camera><output>points</output></depth_camera>", "<depth_camera> of sensor 'c'"),
        ("camera", "<visibility_mask>1</visibility_mask>", "a camera sees every visual"),
        ("camera", "<pose>0 0 1 0 0 0</pose>", "write it in <sensor>"),
        ("camera", "<optical_frame_id>o</optical_frame_id>", "write <frameName> in the plugin"),
        ("camera", "<segmentation_type>semantic</segmentation_type>", "<segmentation_type> of sensor 'c'"),
        ("camera", "<clip><near>.1</near><fog>1</fog></clip>", "<fog> of sensor 'c' is not simulated"),
        ("camera", "<distortion><k7>1</k7></distortion>", "<k7> of sensor 'c' is not simulated"),
        ("camera", "<distortion><center>0 0</center></distortion>", "has no effect: all coefficients are 0"),
        (
            "camera",
            "<distortion><borderCrop>true</borderCrop></distortion>",
            "<borderCrop> of sensor 'c' is not",
        ),
        (
            "camera",
            "<noise><dynamic_bias_stddev>.1</dynamic_bias_stddev></noise>",
            "<dynamic_bias_stddev> of",
        ),
        ("camera", "<noise><type>gaussian</type><seed>1</seed></noise>", "a noise has type, mean, stddev"),
        (
            "camera",
            "<horizontal_fov>1.2</horizontal_fov><lens><intrinsics><fx>400</fx></intrinsics></lens>",
            "<horizontal_fov> of sensor 'c' is left out: it would be a focal length of 467.7 pixels, and <fx> is 400",
        ),
        (
            "camera",
            "<lens><cutoff_angle>1</cutoff_angle></lens>",
            "a lens of type gnomonical has no parameters",
        ),
        (
            "camera",
            "<lens><env_texture_size>512</env_texture_size></lens>",
            "each pixel is traced; take it out",
        ),
        (
            "camera",
            "<lens><type>mei</type><xi>1</xi><k3>1</k3></lens>",
            "a lens of type mei has xi, k1, k2, p1, p2",
        ),
        (
            "wideanglecamera",
            "<lens><intrinsics><fx>300</fx></intrinsics></lens>",
            "<intrinsics> of sensor 'c' is left",
        ),
        (
            "camera",
            "<distortion><k1>1</k1><center>0 0</center></distortion><lens><intrinsics><cx>9</cx></intrinsics></lens>",
            "<center> of sensor 'c' is left out: <intrinsics> gives a principal point",
        ),
    ] {
        let (camera, problems) = camera_of(kind, inside);
        assert!(camera.is_some() && problems.len() == 1, "{inside}: {problems:?}");
        assert!(
            problems[0].starts_with("s.sdf:2: warning: ") && problems[0].contains(expected),
            "{problems:?}"
        );
    }
    let deep = "<image><width>640</width><depth>16</depth></image>";
    let (_, problems) = parse(&format!("<sensor name='c' type='camera'><camera>{deep}</camera></sensor>"));
    assert!(problems.len() == 1 && problems[0].contains("<depth> of sensor 'c'"), "{problems:?}");
    for (text, expected) in [("", Some(0)), ("4", Some(4)), ("-1", None), ("1.5", None)] {
        let element =
            if text.is_empty() { String::new() } else { format!("<anti_aliasing>{text}</anti_aliasing>") };
        let image = format!("<image><width>640</width>{element}</image>");
        let (sensor, problems) =
            parse(&format!("<sensor name='c' type='camera'><camera>{image}</camera></sensor>"));
        let samples = sensor.map(|sensor| match sensor.kind {
            SensorKind::Camera(camera) | SensorKind::Depth(camera) => camera.anti_aliasing,
            SensorKind::Ray(_) => panic!(),
        });
        assert_eq!(samples, expected, "{problems:?}");
        assert!(problems.iter().all(|problem| problem.contains("write a whole number from 0 to 64")));
        assert_eq!(problems.is_empty(), expected.is_some());
    }
    // Beside the <camera>, and in the plugins of both kinds.
    for (inside, expected) in [
        ("<topic>t</topic>", "<topic> of sensor 'c' is not simulated and left out; write <imageTopicName>"),
        ("<gz_frame_id>f</gz_frame_id>", "write <frameName> in the plugin"),
        ("<enable_metrics>true</enable_metrics>", "measure with `belvedere hz`"),
        ("<ray/>", "<ray> of sensor 'c' is not simulated"),
        ("<plugin name='p' filename='F'>\n<borderCrop>true</borderCrop></plugin>", "in black; write false"),
        (
            "<plugin name='p' filename='F'>\n<triggerTopicName>t</triggerTopicName></plugin>",
            "sent at <updateRate>",
        ),
        (
            "<plugin name='p' filename='F'>\n<imageTopicname>t</imageTopicname></plugin>",
            "<imageTopicname> of",
        ),
    ] {
        for (kind, file) in
            [("camera", "libgazebo_ros_camera.so"), ("depth", "libgazebo_ros_openni_kinect.so")]
        {
            let inside = inside.replace('F', file);
            let newline = if inside.contains('\n') { "" } else { "\n" };
            let (sensor, problems) =
                parse(&format!("<sensor name='c' type='{kind}'>{newline}{inside}</sensor>"));
            assert!(sensor.is_some() && problems.len() == 1, "{inside}: {problems:?}");
            let line = problems[0].strip_prefix("s.sdf:2: warning: ");
            assert!(line.is_some_and(|line| line.contains(expected)), "{problems:?}");
        }
    }
    let (_, problems) = parse(
        "<sensor name='c' type='camera'><visualize>true</visualize><enable_metrics>false</enable_metrics>\
         <camera><horizontal_fov>1.2</horizontal_fov><image><width>640</width></image>\
         <noise><dynamic_bias_stddev>0</dynamic_bias_stddev></noise>\
         <lens><intrinsics><fx>468</fx></intrinsics></lens></camera>\
         <plugin name='p' filename='libgazebo_ros_camera.so'><alwaysOn>true</alwaysOn>\
         <borderCrop>false</borderCrop><distortion_k1>0</distortion_k1></plugin></sensor>",
    );
    assert!(problems.is_empty(), "{problems:?}");
    let harmless =
        "<save enabled='false'><path>p</path></save><triggered>false</triggered><pose>0 0 0 0 0 0</pose>";
    lens_of("camera", harmless);

    // A plugin's coefficients are the lens's, unless the camera has others.
    let plugin = |coefficients: &str, lens: &str| {
        parse(&format!(
            "<sensor name='c' type='camera'><camera>{lens}</camera>\
             <plugin name='p' filename='libgazebo_ros_camera.so'>\n{coefficients}</plugin></sensor>"
        ))
        .1
    };
    let coefficients = "<distortionK1>.1</distortionK1><distortionT1>.2</distortionT1>";
    assert!(plugin(coefficients, "").is_empty());
    let problems = plugin(coefficients, "<distortion><k1>.3</k1></distortion>");
    assert!(problems.len() == 1 && problems[0].starts_with("s.sdf:2: warning: "), "{problems:?}");
    assert!(problems[0].contains("hold instead of those in <distortion>"), "{problems:?}");
    let same = "<distortion><k1>.1</k1><p1>.2</p1></distortion>";
    assert!(plugin(coefficients, same).is_empty());
    let fisheye = "<lens><type>equirectangular</type></lens>";
    assert!(plugin(coefficients, fisheye)[0].contains("camera_info has the parameters of the <lens>"));
}

#[test]
fn a_device_is_a_preset_and_what_is_written_besides() {
    use belvedere_sensors::device::{AutoExposureConfig, DeviceConfig, Exposure, Metering, presets};
    assert_eq!(lens_of("camera", "").device, None);
    let momentary = |config| {
        Some(CameraDevice { config, readout_time_s: 0.0, motion_blur_samples: 1, auto_exposure: None })
    };
    assert_eq!(lens_of("camera", "<device/>").device, momentary(DeviceConfig::default()));
    let inside = "<device><preset>webcam</preset><exposure_time_s>0.002</exposure_time_s><gain>2</gain>\
                  <prnu>0</prnu><bits>8</bits></device>";
    let expected = presets::webcam().exposure(Exposure { time_s: 0.002, gain: 2.0 }).prnu(0.0).bits(8);
    for kind in ["camera", "depth", "wideanglecamera"] {
        let device = lens_of(kind, inside).device.unwrap();
        assert_eq!(device.config, expected);
        // Linux's driver: 1104 rows of 1920 × 1080 at 30 Hz and a little more.
        assert!((device.readout_time_s - 1079.0 / 1104.0 * 0.030_48).abs() < 1e-5, "{device:?}");
    }
    let of = |inside: &str| lens_of("camera", &format!("<device>{inside}</device>")).device.unwrap();
    assert_eq!(Some(of("<preset>machine_vision</preset>")), momentary(presets::machine_vision()));
    assert_eq!(
        Some(of("<preset>raspberry_pi_hq</preset><readout_time_s>0</readout_time_s>")),
        momentary(presets::raspberry_pi_hq())
    );
    let device = of("<readout_time_s>0.02</readout_time_s><motion_blur_samples>8</motion_blur_samples>\
         <auto_exposure><target>0.3</target><longest_time_s>0.04</longest_time_s><metering>centre</metering></auto_exposure>");
    let automatic = AutoExposureConfig::default().target(0.3).time_range_s([20e-6, 0.04]);
    let automatic = AutoExposed { config: automatic, metering: Metering::Centre };
    assert_eq!((device.motion_blur_samples, device.auto_exposure), (8, Some(automatic)));
    assert!((device.window_s() - 0.06).abs() < 1e-12 && !device.is_of_one_moment());
    let plain = AutoExposed { config: AutoExposureConfig::default(), metering: Metering::Mean };
    assert_eq!(of("<auto_exposure/>").auto_exposure, Some(plain));
    // Edges of such pictures are not smoothed.
    for (device, warnings) in [("<device/>", 0), ("<device><preset>webcam</preset></device>", 1)] {
        let (sensor, problems) = parse(&format!(
            "<sensor name='c' type='camera'><camera><image>\n<anti_aliasing>4</anti_aliasing></image>{device}</camera></sensor>"
        ));
        assert!(sensor.is_some() && problems.len() == warnings, "{problems:?}");
        assert!(
            problems
                .iter()
                .all(|problem| problem.starts_with("s.sdf:2: warning: <anti_aliasing> of sensor 'c'")
                    && problem.contains("keep sharp edges")),
            "{problems:?}"
        );
    }
    for (inside, expected) in [
        ("<preset>webcan</preset>", "did you mean webcam?"),
        (
            "<read_noise_e>-1</read_noise_e>",
            "<read_noise_e> of sensor 'c' is -1; write a number from 0 to 1000000",
        ),
        (
            "<exposure_time_s>4000</exposure_time_s>",
            "<exposure_time_s> of sensor 'c' is 4000; write a number from 0",
        ),
        ("<bits>17</bits>", "<bits> of sensor 'c' is 17"),
        ("<readout_time_s>11</readout_time_s>", "is 11; write a time in seconds from 0 to 10"),
        ("<motion_blur_samples>0</motion_blur_samples>", "is 0; write a whole number from 1 to 64"),
        (
            "<exposure_time_s>20</exposure_time_s><motion_blur_samples>2</motion_blur_samples>",
            "<motion_blur_samples> of sensor 'c' asks for exposures of up to 20 s",
        ),
        (
            "<auto_exposure><target>2</target></auto_exposure>",
            "<target> of sensor 'c' is 2; write a number from 0.0001",
        ),
        (
            "<auto_exposure><shortest_time_s>0</shortest_time_s></auto_exposure>",
            "<shortest_time_s> of sensor 'c' is 0; write a number from 0.000000001",
        ),
        (
            "<auto_exposure><longest_time_s>1e-6</longest_time_s></auto_exposure>",
            "<longest_time_s> of sensor 'c' is 0.000001; write a number from 0.00002",
        ),
        (
            "<auto_exposure><metering>spot</metering></auto_exposure>",
            "<metering> of sensor 'c' is 'spot'; write mean or",
        ),
        (
            "<exposure_time_s>0</exposure_time_s><auto_exposure/>",
            "<exposure_time_s> of sensor 'c' is 0; write a number from 0.000000001",
        ),
    ] {
        let (camera, problems) = camera_of("camera", &format!("<device>{inside}</device>"));
        assert!(camera.is_none() && problems.len() == 1, "{inside}: {problems:?}");
        assert!(
            problems[0].starts_with("s.sdf:2: error: ") && problems[0].contains(expected),
            "{problems:?}"
        );
    }
    let (camera, problems) = camera_of("camera", "<device><iso>100</iso></device>");
    assert!(camera.is_some() && problems[0].contains("<iso> of sensor 'c' is not simulated"), "{problems:?}");
}

#[test]
fn mosaics_and_words_are_formats() {
    use crate::description::model::Mosaic;
    for (name, expected) in [
        ("L16", PixelFormat::Mono16),
        ("R8G8B8A8", PixelFormat::Rgba8),
        ("BAYER_RGGB8", PixelFormat::Bayer8(Mosaic::Rggb)),
        ("BAYER_GRBG16", PixelFormat::Bayer16(Mosaic::Grbg)),
    ] {
        let (sensor, problems) = parse(&format!(
            "<sensor name='c' type='camera'><camera><image><format>{name}</format></image></camera></sensor>"
        ));
        let Some(SensorKind::Camera(camera)) = sensor.map(|sensor| sensor.kind) else {
            panic!("{problems:?}")
        };
        assert_eq!(camera.format, expected);
    }
}
