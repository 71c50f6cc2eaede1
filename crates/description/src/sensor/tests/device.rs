//! Tests of `<device>`: the electronics behind the lens.

use super::*;

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
    // With our plugin, as for lidars and depth cameras; the content of <device> takes precedence.
    let own = |name: &str, inside: &str| {
        format!(
            "<sensor name='c' type='camera'><topic>c</topic><camera>{inside}</camera>\
             <plugin name='p' filename='belvedere'><preset>{name}</preset></plugin></sensor>"
        )
    };
    for name in presets::NAMES {
        for (inside, gain) in [
            ("", presets::named(name).unwrap().config().exposure.gain),
            ("<device><gain>3</gain></device>", 3.0),
        ] {
            let SensorKind::Camera(Camera { camera, plugin }) = accepted(&own(name, inside)).kind else {
                panic!()
            };
            let expected = of(&format!("<preset>{name}</preset><gain>{gain}</gain>"));
            assert_eq!((camera.device, plugin.is_some()), (Some(expected), true), "{name}");
        }
    }
    for (name, inside, expected) in [
        ("webcan", "", "<preset> of sensor 'c' is 'webcan', which does not exist; did you mean 'webcam'?"),
        ("webcam", "<device><preset>webcam</preset></device>", "the camera of sensor 'c' has two presets"),
    ] {
        let (sensor, problems) = parse(&own(name, inside));
        assert!(sensor.is_none() && problems.len() == 1 && problems[0].contains(expected), "{problems:?}");
    }
    // Such images are not anti-aliased.
    for (device, warnings) in [("<device/>", 0), ("<device><preset>webcam</preset></device>", 1)] {
        let (sensor, problems) = parse(&format!(
            "<sensor name='c' type='camera'><camera><image>\n<anti_aliasing>4</anti_aliasing></image>{device}</camera></sensor>"
        ));
        assert!(sensor.is_some() && problems.len() == warnings, "{problems:?}");
        assert!(
            problems
                .iter()
                .all(|problem| problem.starts_with("s.sdf:2: warning: <anti_aliasing> of sensor 'c'")
                    && problem.contains("are not anti-aliased")),
            "{problems:?}"
        );
    }
    for (inside, expected) in [
        ("<preset>webcan</preset>", "did you mean 'webcam'?"),
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
            "<motion_blur_samples> of sensor 'c' is set for exposures of up to 20 s",
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
fn a_readout_longer_than_the_time_between_pictures_gives_a_warning() {
    for (sensor_rate, plugin_rate, readout_s, is_warned) in [
        ("30", "0", 0.05, true),
        ("30", "0", 0.033, false),
        ("0", "50", 0.021, true),
        ("30", "10", 0.05, false),
    ] {
        let (sensor, problems) = parse(&format!(
            "<sensor name='c' type='camera'><update_rate>{sensor_rate}</update_rate><camera>\n\
             <device><readout_time_s>{readout_s}</readout_time_s></device></camera>\
             <plugin name='p' filename='libgazebo_ros_camera.so'><updateRate>{plugin_rate}</updateRate></plugin></sensor>"
        ));
        assert!(sensor.is_some());
        let warned =
            problems.iter().filter(|problem| problem.contains("longer than the time between pictures"));
        assert_eq!(warned.clone().count(), usize::from(is_warned), "{problems:?}");
        for problem in warned {
            assert!(problem.starts_with("s.sdf:2: warning: <readout_time_s> of sensor 'c'"), "{problem}");
        }
    }
}
