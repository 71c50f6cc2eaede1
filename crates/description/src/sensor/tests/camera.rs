//! Tests of which camera elements have an effect, and of image formats.

use super::*;

#[test]
fn what_a_camera_does_not_honour_gives_a_warning_with_its_line() {
    for (kind, inside, expected) in [
        ("camera", "<save enabled='true'><path>p</path></save>", "<save> of sensor 'c' is not simulated"),
        ("camera", "<depth_camera><output>points</output></depth_camera>", "<depth_camera> of sensor 'c'"),
        ("camera", "<pose>0 0 1 0 0 0</pose>", "write it in <sensor>"),
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
            "each pixel is traced; remove it",
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
            SensorKind::Camera(Camera { camera, .. }) | SensorKind::Depth(DepthCamera { camera, .. }) => {
                camera.anti_aliasing
            }
            other => panic!("{other:?}"),
        });
        assert_eq!(samples, expected, "{problems:?}");
        assert!(problems.iter().all(|problem| problem.contains("write a whole number from 0 to 64")));
        assert_eq!(problems.is_empty(), expected.is_some());
    }
    // Next to the <camera>, and in the plugins of both kinds.
    for (inside, expected) in [
        (
            "<topic>t</topic><plugin name='p' filename='F'/>",
            "<topic> of sensor 'c' is not simulated and is left out; write <imageTopicName>",
        ),
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
    assert!(problems[0].contains("replace those in <distortion>"), "{problems:?}");
    let same = "<distortion><k1>.1</k1><p1>.2</p1></distortion>";
    assert!(plugin(coefficients, same).is_empty());
    let fisheye = "<lens><type>equirectangular</type></lens>";
    assert!(plugin(coefficients, fisheye)[0].contains("camera_info has the parameters of the <lens>"));
}

#[test]
fn mosaics_and_words_are_formats() {
    use crate::model::Mosaic;
    for (name, expected) in [
        ("L16", PixelFormat::Mono16),
        ("R8G8B8A8", PixelFormat::Rgba8),
        ("BAYER_RGGB8", PixelFormat::Bayer8(Mosaic::Rggb)),
        ("BAYER_GRBG16", PixelFormat::Bayer16(Mosaic::Grbg)),
    ] {
        let (sensor, problems) = parse(&format!(
            "<sensor name='c' type='camera'><camera><image><format>{name}</format></image></camera></sensor>"
        ));
        let Some(SensorKind::Camera(Camera { camera, .. })) = sensor.map(|sensor| sensor.kind) else {
            panic!("{problems:?}")
        };
        assert_eq!(camera.format, expected);
    }
}

#[test]
fn the_optical_frame_is_that_of_a_camera_without_a_plugin() {
    let camera = "<camera><optical_frame_id>o</optical_frame_id></camera>";
    let (sensor, problems) = parse(&format!("<sensor name='c' type='camera'>{camera}</sensor>"));
    let SensorKind::Camera(Camera { plugin: Some(plugin), .. }) = sensor.unwrap().kind else { panic!() };
    assert_eq!((plugin.frame_name.as_str(), problems.len()), ("o", 0));
    let plugin = "<plugin filename='libgazebo_ros_camera.so'><frameName>f</frameName></plugin>";
    let (_, problems) = parse(&format!("<sensor name='c' type='camera'>{camera}{plugin}</sensor>"));
    assert!(problems.len() == 1 && problems[0].contains("write <frameName> in the plugin"), "{problems:?}");
}
