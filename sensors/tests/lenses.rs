//! Lens models from outside: `project` and `unproject` are inverse to each other in the whole domain, which ends where
//! the image radius stops growing, and nothing panics or returns NaN.
//!
//! `.ci/lenses` checks that the models agree with those of `cv2`.

mod common;

use belvedere_sensors::ParameterError;
use belvedere_sensors::optics::{
    AngleFunction, BrownConrady, DoubleSphere, Equirectangular, Eucm, Intrinsics, KannalaBrandt, Lens,
    Mapping, Mei, Pinhole, WideAngle,
};
use common::random::tries;
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// A lens, the size of its image, and the share of pixels that it sees, in per cent.
struct Case {
    name: &'static str,
    lens: Box<dyn Lens>,
    size: [u32; 2],
    sees: std::ops::RangeInclusive<f64>,
}

fn case(
    name: &'static str,
    lens: Result<impl Lens + 'static, ParameterError>,
    size: [u32; 2],
    sees: std::ops::RangeInclusive<f64>,
) -> Case {
    Case { name, lens: Box::new(lens.unwrap_or_else(|error| panic!("{name}: {error}"))), size, sees }
}

fn intrinsics(fx: f64, fy: f64, cx: f64, cy: f64) -> Intrinsics {
    Intrinsics { fx, fy, cx, cy, skew: 0.0 }
}

/// A webcam, 640 × 480.
fn webcam() -> Intrinsics {
    intrinsics(618.2, 617.4, 321.7, 238.9)
}

/// A 4:3 sensor behind a lens with a field of view of about 120°.
fn wide() -> Intrinsics {
    Intrinsics { fx: 235.0, fy: 236.5, cx: 318.2, cy: 243.1, skew: 0.4 }
}

/// A square sensor behind a fisheye, with `radius` pixels at `angle` degrees.
fn fisheye(radius: f64, angle: f64) -> Intrinsics {
    let focal = radius / angle.to_radians();
    intrinsics(focal, focal * 1.002, 401.3, 397.6)
}

const VGA: [u32; 2] = [640, 480];
const SQUARE: [u32; 2] = [800, 800];
const ALL: std::ops::RangeInclusive<f64> = 100.0..=100.0;

fn cases() -> Vec<Case> {
    let brown = |intrinsics, coefficients: &[f64]| BrownConrady::new(intrinsics, coefficients);
    let custom = Mapping { c1: 1.05, c2: 4.0, c3: 0.02, f: 1.0, fun: AngleFunction::Tan };
    let skewed = Intrinsics { skew: 3.0, ..webcam() };
    vec![
        case("pinhole", Pinhole::new(skewed), VGA, ALL),
        case("no distortion", brown(wide(), &[]), VGA, ALL),
        case("webcam", brown(webcam(), &[0.1, -0.25, 8e-4, -3e-4]), VGA, ALL),
        case("barrel", brown(webcam(), &[-0.41, 0.19, -1.2e-3, 9e-4, -0.04]), VGA, ALL),
        // Folds back at r = 1.49; the corners are beyond the largest radius.
        case("strong barrel", brown(wide(), &[-0.15, 0.0, 5e-4, -4e-4, 0.0]), VGA, 50.0..=60.0),
        case("pincushion", brown(wide(), &[0.2, 0.05, 1e-3, 1e-3, 0.01]), VGA, ALL),
        case("decentred", brown(webcam(), &[-0.05, 0.01, 0.03, -0.02, 0.0]), VGA, ALL),
        case("rational", brown(webcam(), &[0.49, -2.71, 4e-4, -2e-4, 1.51, 0.37, -2.53, 1.44]), VGA, ALL),
        case("rational, wide", brown(wide(), &[5.2, 2.4, 3e-5, -1e-4, 0.1, 5.6, 4.1, 0.7]), VGA, ALL),
        case(
            "thin prism",
            brown(wide(), &[0.1, 0.02, 5e-4, -1e-3, 0.0, 0.3, 0.04, 0.0, 4e-3, -1e-3, -3e-3, 8e-4]),
            VGA,
            99.0..=100.0,
        ),
        case(
            "tilt",
            brown(
                webcam(),
                &[-0.2, 0.1, 1e-3, 2e-3, 0.0, 0.02, 0.0, 0.0, 1e-3, 0.0, -1e-3, 0.0, 0.12, -0.08],
            ),
            VGA,
            ALL,
        ),
        case(
            "strong tilt",
            brown(wide(), &[0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.4]),
            VGA,
            50.0..=100.0,
        ),
        case("equidistant", KannalaBrandt::new(fisheye(390.0, 90.0), [0.0; 4]), SQUARE, ALL),
        case(
            "fisheye 185°",
            KannalaBrandt::new(fisheye(400.0, 92.5), [0.03, -0.01, 4e-3, -8e-4]),
            SQUARE,
            97.0..=99.0,
        ),
        case(
            "fisheye 220°",
            KannalaBrandt::new(fisheye(390.0, 110.0), [-0.02, 3e-3, -6e-4, 2e-5]),
            SQUARE,
            70.0..=100.0,
        ),
        case(
            "fisheye with a rim",
            KannalaBrandt::new(fisheye(380.0, 75.0), [-0.08, 0.0, -2e-3, 0.0]),
            SQUARE,
            60.0..=90.0,
        ),
        case("EUCM", Eucm::new(intrinsics(210.0, 211.0, 402.0, 395.0), 0.62, 1.1), SQUARE, 60.0..=100.0),
        case("EUCM, α < ½", Eucm::new(intrinsics(300.0, 301.0, 402.0, 395.0), 0.4, 0.8), SQUARE, ALL),
        case("EUCM, α = 0", Eucm::new(webcam(), 0.0, 1.0), VGA, ALL),
        case("EUCM, α = 1", Eucm::new(intrinsics(380.0, 380.0, 399.5, 399.5), 1.0, 1.0), SQUARE, 60.0..=80.0),
        case(
            "double sphere",
            DoubleSphere::new(intrinsics(313.0, 313.0, 399.0, 401.0), -0.18, 0.59),
            SQUARE,
            ALL,
        ),
        case(
            "double sphere 220°",
            DoubleSphere::new(intrinsics(160.0, 160.0, 399.0, 401.0), -0.2, 0.61),
            SQUARE,
            50.0..=90.0,
        ),
        case("double sphere, ξ > 0", DoubleSphere::new(webcam(), 0.6, 0.45), VGA, ALL),
        case(
            "Mei",
            Mei::new(intrinsics(420.0, 421.0, 398.0, 402.0), 0.9, [-0.05, 0.01, 4e-4, -3e-4]),
            SQUARE,
            99.0..=100.0,
        ),
        case(
            "Mei, mirror",
            Mei::new(intrinsics(420.0, 421.0, 398.0, 402.0), 1.6, [-0.1, 0.02, 1e-3, 1e-3]),
            SQUARE,
            49.0..=51.0,
        ),
        case("equirectangular", Equirectangular::new(1024, 512), [1024, 512], ALL),
        case("gnomonical", WideAngle::from_fov(640, 480, 2.0, Mapping::GNOMONICAL, true, PI), VGA, ALL),
        case(
            "stereographic",
            WideAngle::from_fov(640, 480, PI, Mapping::STEREOGRAPHIC, true, FRAC_PI_2),
            VGA,
            80.0..=95.0,
        ),
        case(
            "equidistant 220°",
            WideAngle::from_fov(800, 800, 3.84, Mapping::EQUIDISTANT, true, 1.92),
            SQUARE,
            78.0..=79.0,
        ),
        case(
            "equisolid",
            WideAngle::from_fov(800, 800, 6.0, Mapping::EQUISOLID_ANGLE, true, PI),
            SQUARE,
            70.0..=90.0,
        ),
        case(
            "orthographic",
            WideAngle::from_fov(800, 800, PI, Mapping::ORTHOGRAPHIC, true, PI),
            SQUARE,
            78.0..=79.0,
        ),
        case("custom", WideAngle::from_fov(800, 800, 3.84, custom, true, PI), SQUARE, 99.0..=100.0),
    ]
}

/// Also prints the largest error of each lens.
#[test]
fn every_pixel_survives_a_round_trip() {
    for Case { name, lens, size: [width, height], sees } in cases() {
        let (mut worst, mut seen, mut all) = (0.0_f64, 0, 0);
        for (row, column) in
            (0..height).step_by(2).flat_map(|row| (0..width).step_by(2).map(move |c| (row, c)))
        {
            all += 1;
            let pixel = DVec2::new(f64::from(column), f64::from(row));
            let Some(direction) = lens.unproject(pixel) else { continue };
            seen += 1;
            assert!((direction.length() - 1.0).abs() < 1e-14, "{name}, {pixel}: {direction}");
            let back = lens.project(direction).unwrap_or_else(|| panic!("{name}: {pixel} has only one way"));
            worst = worst.max(back.distance(pixel));
        }
        let share = 100.0 * f64::from(seen) / f64::from(all);
        println!("{name:24} sees {share:5.1} % of its image; {worst:.1e} px after a round trip");
        assert!(worst < 1e-9, "{name}: {worst} px");
        assert!(sees.contains(&share), "{name} sees {share} % of its image");
    }
}

/// Directions evenly over the sphere: a Fibonacci lattice.
fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |index| {
        let z = 1.0 - (2.0 * f64::from(index) + 1.0) / f64::from(count);
        let (sin, cos) = libm::sincos(f64::from(index) * 2.399_963_229_728_653);
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    })
}

/// Towards 90°, the same step of the angle moves a plane's pixel by the square of its distance.
fn tolerance(pixel: DVec2) -> f64 {
    1e-9 + 1e-17 * pixel.length_squared()
}

#[test]
fn every_point_survives_a_round_trip() {
    for Case { name, lens, .. } in cases() {
        let mut seen = 0;
        for direction in directions(40_000) {
            let Some(pixel) = lens.project(direction * 3.7) else { continue };
            seen += 1;
            let back =
                lens.unproject(pixel).unwrap_or_else(|| panic!("{name}: {direction} has only one way"));
            // At a rim, the radius hardly changes with the angle, so the angle is only accurate to √1e-16.
            assert!(back.distance(direction) < 1e-6, "{name}: {direction} came back as {back}");
            let again = lens.project(back).unwrap();
            assert!(again.distance(pixel) < tolerance(pixel), "{name}: {pixel} {again}");
        }
        assert!(seen > 1000, "{name} sees {seen} directions");
    }
}

/// The direction at an angle from the axis, and an angle around it.
fn at(angle: f64, around: f64) -> DVec3 {
    let (sin, cos) = angle.sin_cos();
    DVec3::new(sin * around.cos(), sin * around.sin(), cos)
}

/// The image radius grows up to the end of the domain, and there is no pixel beyond.
#[test]
fn domain_ends_where_the_image_stops_growing() {
    let centred = intrinsics(100.0, 100.0, 0.0, 0.0);
    let brown = |coefficients: &[f64]| {
        let lens = BrownConrady::new(centred, coefficients).unwrap();
        (Box::new(lens) as Box<dyn Lens>, lens.max_radius().atan())
    };
    let kannala = |coefficients| {
        let lens = KannalaBrandt::new(centred, coefficients).unwrap();
        (Box::new(lens) as Box<dyn Lens>, lens.max_angle())
    };
    let eucm = |alpha, beta| {
        let lens = Eucm::new(centred, alpha, beta).unwrap();
        (Box::new(lens) as Box<dyn Lens>, lens.max_angle())
    };
    let sphere = |xi, alpha| {
        let lens = DoubleSphere::new(centred, xi, alpha).unwrap();
        (Box::new(lens) as Box<dyn Lens>, lens.max_angle())
    };
    let mapped = |mapping, cutoff| {
        let lens = WideAngle::new(centred, mapping, cutoff).unwrap();
        (Box::new(lens) as Box<dyn Lens>, lens.max_angle())
    };
    // 1 − 0.9r² = 0; 1 − 0.3θ² = 0.
    assert!((brown(&[-0.3, 0.0, 0.0, 0.0]).1 - (1.0 / 0.9_f64).sqrt().atan()).abs() < 1e-12);
    assert!((kannala([-0.1, 0.0, 0.0, 0.0]).1 - (1.0 / 0.3_f64).sqrt()).abs() < 1e-12);

    // `turns`: true if the radius has its maximum at the end, instead of being cut off or infinite.
    for (turns, (lens, end)) in [
        (true, brown(&[-0.3, 0.0, 0.0, 0.0])),
        (true, brown(&[-0.41, 0.19, 0.0, 0.0, -0.04])),
        (true, brown(&[0.3, -0.2, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0])),
        (false, brown(&[-0.3, 0.0, 1e-3, -2e-3])),
        (false, brown(&[0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0])),
        (true, kannala([-0.1, 0.0, 0.0, 0.0])),
        (true, kannala([0.05, -0.03, 0.0, 0.0])),
        (true, eucm(0.62, 1.1)),
        (true, eucm(0.9, 0.5)),
        (false, eucm(0.4, 1.3)),
        (true, sphere(-0.2, 0.6)),
        (true, sphere(0.5, 0.7)),
        (false, sphere(-0.4, 0.3)),
        (true, mapped(Mapping::ORTHOGRAPHIC, PI)),
        (false, mapped(Mapping::GNOMONICAL, PI)),
        (false, mapped(Mapping::EQUISOLID_ANGLE, 2.0)),
    ] {
        assert!(end > 0.3 && end < PI, "{end}");
        for around in [0.0, 0.7, 2.0, 4.0, 5.5] {
            assert_eq!(lens.project(at(end + 1e-7, around)), None, "beyond {end}");
            let radii: Vec<f64> = (0..=1000)
                .map(|step| lens.project(at((end - 1e-7) * f64::from(step) * 1e-3, around)).unwrap().length())
                .collect();
            assert!(radii.windows(2).all(|pair| pair[0] < pair[1]), "the radius falls before {end}");
            let rim = lens.project(at(end - 1e-7, around)).unwrap();
            if turns {
                assert_eq!(lens.unproject(rim * (1.0 + 1e-9)), None, "beyond {rim}");
                assert!(radii[1000] - radii[999] < 3e-2 * (radii[1] - radii[0]), "{end} is no turn");
            }
        }
    }
}

#[test]
fn errors_name_parameter_value_and_range() {
    let good = webcam();
    let bad = |change: fn(&mut Intrinsics)| {
        let mut bad = good;
        change(&mut bad);
        Pinhole::new(bad).unwrap_err().to_string()
    };
    for (said, expected) in [
        (bad(|i| i.fx = 0.0), "fx of the lens is 0; it must be a finite number greater than 0"),
        (bad(|i| i.fy = -3.5), "fy of the lens is -3.5; it must be a finite number greater than 0"),
        (bad(|i| i.cx = f64::NAN), "cx of the lens is NaN; it must be a finite number"),
        (bad(|i| i.skew = f64::INFINITY), "skew of the lens is inf; it must be a finite number"),
        (
            Eucm::new(good, 0.5, 0.0).unwrap_err().to_string(),
            "beta of the lens is 0; it must be a finite number greater than 0",
        ),
        (
            DoubleSphere::new(good, -1.0, 0.5).unwrap_err().to_string(),
            "xi of the lens is -1; it must be greater than -1 and at most 1",
        ),
        (
            BrownConrady::new(good, &[0.0, f64::NAN, 0.0, 0.0]).unwrap_err().to_string(),
            "k2 of the lens is NaN; it must be a finite number",
        ),
        (
            WideAngle::from_fov(640, 480, 3.2, Mapping::GNOMONICAL, true, PI).unwrap_err().to_string(),
            "horizontal_fov_rad of the lens is 3.2; it must be greater than 0, at most 2π, and within what the \
             lens' mapping function reaches",
        ),
        (
            Equirectangular::new(0, 512).unwrap_err().to_string(),
            "width of the lens is 0; it must be at least 1",
        ),
    ] {
        assert_eq!(said, expected);
    }
    let six = BrownConrady::new(good, &[0.0; 6]).unwrap_err().to_string();
    assert!(
        six.starts_with("number of coefficients of the lens is 6; it must be 0, 4, 5, 8, 12 or 14"),
        "{six}"
    );
    assert!(Intrinsics::from_fov(640, 480, PI).is_err());
}

/// A hash of the lenses' results, computed on x86-64, which must be the same on every machine.
#[test]
fn bits_are_pinned() {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |value: f64| hash = (hash ^ value.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
    for Case { lens, size: [width, height], .. } in cases() {
        for direction in directions(500) {
            if let Some(pixel) = lens.project(direction) {
                pixel.to_array().into_iter().for_each(&mut add);
            }
        }
        for (row, column) in
            (0..height).step_by(31).flat_map(|row| (0..width).step_by(37).map(move |c| (row, c)))
        {
            if let Some(direction) = lens.unproject(DVec2::new(f64::from(column), f64::from(row))) {
                direction.to_array().into_iter().for_each(&mut add);
            }
        }
    }
    assert_eq!(hash, 0x87b7_fa8f_5150_e5b9, "{hash:#018x}");
}

/// Reasonable numbers, and unreasonable ones.
fn wild() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -2.0..2.0,
        2 => -1000.0..1000.0,
        1 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 5e-324, 1e-200, 1e300]),
    ]
}

/// A lens of the given number, with as many of the parameters as it needs.
fn build(model: u8, i: Intrinsics, p: [f64; 14]) -> Result<Box<dyn Lens>, ParameterError> {
    fn boxed(lens: impl Lens + 'static) -> Box<dyn Lens> {
        Box::new(lens)
    }
    let fun = [AngleFunction::Identity, AngleFunction::Sin, AngleFunction::Tan][usize::from(model) % 3];
    let mapping = Mapping { c1: p[0], c2: p[1], c3: p[2], f: p[3], fun };
    match model {
        0 => Pinhole::new(i).map(boxed),
        1 => BrownConrady::new(i, &p[..4]).map(boxed),
        2 => BrownConrady::new(i, &p[..8]).map(boxed),
        3 => BrownConrady::new(i, &p[..12]).map(boxed),
        4 => BrownConrady::new(i, &p).map(boxed),
        5 => KannalaBrandt::new(i, [p[0], p[1], p[2], p[3]]).map(boxed),
        6 => Eucm::new(i, p[0], p[1]).map(boxed),
        7 => DoubleSphere::new(i, p[0], p[1]).map(boxed),
        8 => Mei::new(i, p[0], [p[1], p[2], p[3], p[4]]).map(boxed),
        9 => Equirectangular::new(p[0] as u32, p[1] as u32).map(boxed),
        10..=12 => WideAngle::new(i, mapping, p[4]).map(boxed),
        _ => WideAngle::from_fov(p[5] as u32, p[6] as u32, p[7], mapping, p[8] > 0.0, p[4]).map(boxed),
    }
}

/// Focal lengths at which the squares of a pixel's coordinates overflow or lose their digits.
#[test]
fn rays_are_of_unit_length_at_any_focal_length() {
    let ordinary = [0.9, 1.2, -0.3, 1.5, 1.3, 640.0, 480.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for model in 0..14 {
        for fx in [1e-300, 1e-150, 1e150, 3.7e158, 1e300] {
            for fy in [1e-300, 1e-150, 1e150, 3.7e158, 1e300] {
                let intrinsics = Intrinsics { fx, fy, cx: 0.0, cy: 0.0, skew: 0.0 };
                let Ok(lens) = build(model, intrinsics, ordinary) else { continue };
                for pixel in
                    [DVec2::ONE, DVec2::new(0.0, -0.7), DVec2::new(-0.7, 0.0), DVec2::new(3.0, 400.0)]
                {
                    if let Some(direction) = lens.unproject(pixel) {
                        let length = direction.length();
                        assert!((length - 1.0).abs() < 1e-12, "{model} {fx} {fy} {pixel}: {direction}");
                    }
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(tries(100_000))]

    #[test]
    fn nothing_panics_or_is_nan(
        model in 0_u8..14,
        five in prop::array::uniform5(wild()),
        ordinary in any::<bool>(),
        parameters in prop::collection::vec(wild(), 14),
        point in prop::array::uniform3(wild()),
        pixel in prop::array::uniform2(wild()),
    ) {
        let [fx, fy, cx, cy, skew] = five;
        let intrinsics = if ordinary { webcam() } else { Intrinsics { fx, fy, cx, cy, skew } };
        let Ok(lens) = build(model, intrinsics, parameters.try_into().unwrap()) else { return Ok(()) };
        let point = DVec3::from_array(point);
        for point in [point, point.abs(), DVec3::Z, DVec3::NEG_Z, DVec3::X] {
            if let Some(pixel) = lens.project(point) {
                prop_assert!(pixel.is_finite(), "{point} → {pixel}");
                if let Some(direction) = lens.unproject(pixel) {
                    prop_assert!((direction.length() - 1.0).abs() < 1e-12, "{point} → {pixel} → {direction}");
                }
            }
        }
        let pixel = DVec2::from_array(pixel);
        for pixel in [pixel, pixel * 300.0, DVec2::new(cx, cy)] {
            if let Some(direction) = lens.unproject(pixel) {
                prop_assert!((direction.length() - 1.0).abs() < 1e-12, "{pixel} → {direction}");
            }
        }
    }

    /// Whatever the parameters: the pixel of a point leads back to the direction of that point, and so to the pixel.
    #[test]
    fn every_projected_point_can_be_unprojected(
        model in 1_u8..14,
        parameters in prop::collection::vec(-0.8..0.8, 14),
        across in prop::array::uniform2(-2.0..2.0),
        z in -0.5..1.5,
    ) {
        let mut parameters: [f64; 14] = parameters.try_into().unwrap();
        match model {
            3 | 4 => [2, 3, 8, 9, 10, 11].iter().for_each(|&index: &usize| parameters[index] *= 0.1),
            6 | 7 => parameters[1] = parameters[1].abs().max(0.1),
            9..=13 => parameters = parameters.map(|p| p.abs() + 0.1),
            _ => {}
        }
        (parameters[5], parameters[6]) = if model == 13 { (640.0, 480.0) } else { (parameters[5], parameters[6]) };
        let Ok(lens) = build(model, wide(), parameters) else { return Ok(()) };
        let Some(direction) = DVec3::new(across[0], across[1], z).try_normalize() else { return Ok(()) };
        let Some(pixel) = lens.project(direction) else { return Ok(()) };
        let back = lens.unproject(pixel);
        prop_assert!(back.is_some(), "{direction} → {pixel} → nothing");
        let again = lens.project(back.unwrap()).unwrap();
        prop_assert!(again.distance(pixel) < 10.0 * tolerance(pixel), "{pixel} {again}");
    }
}
