//! The messages of configuration errors.

use crate::common::camera_of;
use belvedere_sensors::camera::Camera;
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::scanner::{
    Columns, Laser, Mems, MirrorAxis, Pattern, Scanner, ScannerConfig, Spinning, presets,
};

#[test]
fn numbers_are_shown_as_they_were_written() {
    let noise = GaussianNoise::of_stddev(-0.1).unwrap_err();
    assert_eq!(noise.to_string(), "stddev of the noise is -0.1; it must be a finite number, 0 or more");
    let step = GaussianNoise::new(GaussianNoiseConfig::default().precision(-3e-7)).unwrap_err();
    assert!(step.to_string().starts_with("precision of the noise is -0.0000003;"), "{step}");
    let camera = Camera::new(camera_of([8, 6], 1.0).exposure(-0.3)).unwrap_err();
    assert!(camera.to_string().starts_with("exposure of the camera is -0.3;"), "{camera}");
    let camera = Camera::new(camera_of([8, 6], 1.0).near_m(-0.1)).unwrap_err();
    assert!(camera.to_string().starts_with("near_m of the camera is -0.1;"), "{camera}");
}

/// Presets have fixed times of columns, volleys and firings; the user chose the frame time.
#[test]
fn a_frame_time_that_is_too_short_is_named() {
    for preset in presets::ALL {
        let Err(error) = Scanner::new(preset.config().frame_time_ns(1)) else { continue };
        let names_it = error.parameter == "frame_time_ns" && error.value == 1.0
            || error.to_string().contains("frame_time_ns");
        assert!(names_it, "{}: {error}", preset.name);
    }
    let error = Scanner::new(presets::VLP_16.config().frame_time_ns(1000)).unwrap_err();
    let said = "frame_time_ns of the scanner is 1000; it must be at least the time from one firing, volley or column of \
                the pattern to the next";
    assert_eq!(error.to_string(), said);
    // A time of 0 is an error of the parameter that has it.
    let lasers = [Laser::at_degrees(0.0, 0.0)];
    let columns = Columns::Every { time_ns: 0 };
    let spinning = Spinning { lasers: &lasers, columns, first_azimuth_rad: 0.0, clockwise: false };
    let mems = Mems { firing_time_ns: 0, incidence_rad: 0.0, axes: &[MirrorAxis::STILL; 2] };
    for (pattern, parameter) in
        [(Pattern::Spinning(spinning), "time_ns of columns"), (Pattern::Mems(mems), "firing_time_ns")]
    {
        let error = Scanner::new(ScannerConfig::new(pattern)).unwrap_err();
        assert_eq!((error.parameter, error.value), (parameter, 0.0));
    }
}
