//! Lasers behind rotating prisms and mirrors, against closed forms and against rosettes.

use belvedere_sensors::scanner::{
    Axis, Face, MAX_WHEELS, Pattern, Prisms, Rosette, Scanner, ScannerConfig, Swing, Wheel, Wheels,
};
use core::f64::consts::{FRAC_PI_2, TAU};
use glam::DVec3;

const GLASS: f64 = 1.6;

const fn into(tilt_rad: f64, index: f64) -> Face {
    Face::Refracting { tilt_rad, index }
}

const fn wheel(speed_rpm: i32, faces: &[Face]) -> Wheel<'_> {
    Wheel { speed_rpm, phase_rad: 0.0, swing: Swing::NONE, faces }
}

fn ahead<'a>(wheels: &'a [Wheel<'a>]) -> Prisms<'a> {
    let wheels = Wheels::new(wheels);
    Prisms { volley_time_ns: 10_000, laser_time_ns: 0, axis: Axis::Ahead, lasers_rad: &[0.0], wheels }
}

fn scanner(prisms: Prisms<'_>) -> Scanner<'_> {
    Scanner::new(ScannerConfig::new(Pattern::Prisms(prisms))).unwrap()
}

/// The same two wedges, given as a rosette and as wheels: with the flat sides outwards, and inwards.
#[test]
fn two_wedges_equal_a_rosette() {
    const TILT: f64 = 0.3;
    let outwards = [
        wheel(7294, const { &[into(0.0, GLASS), into(TILT, 1.0)] }),
        wheel(-4664, const { &[into(-TILT, GLASS), into(0.0, 1.0)] }),
    ];
    let inwards = [
        wheel(7294, const { &[into(-TILT, GLASS), into(0.0, 1.0)] }),
        wheel(-4664, const { &[into(0.0, GLASS), into(TILT, 1.0)] }),
    ];
    for (wheels, is_flat_inwards) in [(outwards, false), (inwards, true)] {
        let rosette = Rosette {
            firing_time_ns: 10_000,
            speeds_rpm: [7294, -4664],
            wedge_rad: TILT,
            refractive_index: GLASS,
            is_flat_inwards,
        };
        let prisms = ahead(&wheels);
        assert!((prisms.half_angle_rad() - rosette.half_angle_rad().unwrap()).abs() < 1e-12);
        let (ours, theirs) =
            (scanner(prisms), Scanner::new(ScannerConfig::new(Pattern::Rosette(rosette))).unwrap());
        for (frame, index) in [(0, 0), (0, 1), (3, 777), (41, 9999), (123_456, 4321)] {
            let (ours, theirs) = (ours.firing(frame, index), theirs.firing(frame, index));
            assert_eq!((ours.time_s, ours.laser), (theirs.time_s, 0));
            assert!((ours.direction - theirs.direction).length() < 1e-14, "{frame} {index}");
        }
    }
}

/// A mirror at 45° above lasers that look up deflects them all around; its angle oscillates as configured.
#[test]
fn a_mirror_deflects_lasers_all_around() {
    let swing = Swing { rad: 0.2, rpm: 1200, phase_rad: 0.5 };
    let mirror = [Face::Mirror { tilt_rad: -TAU / 8.0 }];
    let wheels = [Wheel { speed_rpm: -600, phase_rad: 1.0, swing, faces: &mirror }];
    let prisms = Prisms {
        volley_time_ns: 20_000,
        laser_time_ns: 3000,
        axis: Axis::Up,
        lasers_rad: &[0.0, 0.05, -0.05],
        wheels: Wheels::new(&wheels),
    };
    let scanner = scanner(prisms);
    assert_eq!((scanner.firings(0), scanner.most_firings()), (15_000, 15_000));
    for (frame, index) in [(0, 0), (0, 4), (2, 5), (7, 14_999)] {
        let firing = scanner.firing(frame, index);
        assert_eq!(firing.laser as usize, index % 3);
        assert!((firing.time_s - (20e-6 * (index / 3) as f64 + 3e-6 * (index % 3) as f64)).abs() < 1e-12);
        let time = 0.1 * frame as f64 + firing.time_s;
        let azimuth = 1.0 - TAU * 10.0 * time + 0.2 * (TAU * 20.0 * time + 0.5).sin();
        let out = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        let laser = prisms.lasers_rad[index % 3];
        let up = DVec3::new(0.0, laser.sin(), laser.cos());
        let normal = (DVec3::Z - out).normalize();
        let expected = up - 2.0 * up.dot(normal) * normal;
        assert!((firing.direction - expected).length() < 1e-9, "{firing:?} {expected}");
        // The image of a laser beside the axis rotates with the mirror.
        assert!(index % 3 != 0 || (firing.direction - out).length() < 1e-9);
    }
}

/// A small wedge deflects by (n − 1) times its angle, each on its own.
#[test]
fn thin_wedges_add_up() {
    let thin = [into(0.0, GLASS), into(1e-3, 1.0)];
    let wheels = [wheel(500, &thin), wheel(-7000, &thin), wheel(61, &thin), wheel(7001, &thin)];
    let scanner = scanner(ahead(&wheels));
    for index in (0..10_000).step_by(997) {
        let firing = scanner.firing(2, index);
        let expected: DVec3 = wheels
            .iter()
            .map(|wheel| TAU * f64::from(wheel.speed_rpm) / 60.0 * (0.2 + firing.time_s))
            .map(|angle| DVec3::new(0.0, angle.cos(), angle.sin()) * -0.6e-3)
            .sum();
        assert!((firing.direction - DVec3::X - expected).length() < 1e-5, "{firing:?}");
    }
}

#[test]
fn wheels_that_block_light_are_refused() {
    let plain = [wheel(1, const { &[into(0.0, GLASS), into(0.3, 1.0)] })];
    let steep = [wheel(1, const { &[into(0.0, GLASS), into(0.7, 1.0)] })];
    let bent = [wheel(1, const { &[into(2.0, GLASS), into(0.0, 1.0)] })];
    let dense = [wheel(1, const { &[into(0.0, 5.0), into(0.0, 1.0)] })];
    let open = [wheel(1, const { &[into(0.0, GLASS)] })];
    let empty = [wheel(1, &[])];
    let lost = [Wheel { phase_rad: f64::NAN, ..plain[0] }];
    let wild = [Wheel { swing: Swing { rad: 7.0, ..Swing::NONE }, ..plain[0] }];
    let many = [plain[0]; MAX_WHEELS + 1];
    let good = ahead(&plain);
    for (wrong, parameter) in [
        (ahead(&steep), "lasers_rad"),
        (ahead(&bent), "tilt_rad of a face of wheel"),
        (ahead(&dense), "index of a face of wheel"),
        (ahead(&open), "index of the last face of wheel"),
        (ahead(&empty), "number of faces of wheel"),
        (ahead(&lost), "phase_rad of wheel"),
        (ahead(&wild), "swing's rad of wheel"),
        (ahead(&many), "number of wheels"),
        (ahead(&[]), "number of wheels"),
        (Prisms { volley_time_ns: 0, ..good }, "volley_time_ns"),
        (Prisms { laser_time_ns: 5000, lasers_rad: &[0.0; 3], ..good }, "laser_time_ns"),
        (Prisms { lasers_rad: &[], ..good }, "number of lasers_rad"),
        (Prisms { lasers_rad: &[FRAC_PI_2], ..good }, "lasers_rad"),
    ] {
        let refused = Scanner::new(ScannerConfig::new(Pattern::Prisms(wrong))).unwrap_err();
        assert_eq!(refused.parameter, parameter, "{wrong:?}");
    }
    assert!(Scanner::new(ScannerConfig::new(Pattern::Prisms(good))).is_ok());
}
