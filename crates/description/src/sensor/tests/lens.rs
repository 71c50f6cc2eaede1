//! `<distortion>` and `<lens>`.

use super::*;

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
    // A pinhole's angle of view follows from it.
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
        ("<lens><type>fisheye</type></lens>", "is of type 'fisheye'; choose from gnomonical, "),
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
            "has a <distortion>, which is a pinhole's, and a lens of type kannala_brandt; remove one",
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
