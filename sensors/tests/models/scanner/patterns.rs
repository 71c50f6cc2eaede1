//! Firing patterns, and the noise of their ranges.

use super::*;

/// Beams of an even grid from one point at one moment are those of a lidar.
#[test]
fn at_one_moment_a_scanner_is_a_lidar() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let heights: Vec<f32> = (0..24 * 24).map(|cell| 0.2 * ((cell * 7 % 13) as f32 / 13.0) - 0.8).collect();
    let field = builder.add_height_field(24, 24, [12.0, 12.0], &heights).unwrap();
    add_grey(&mut builder, Shape::HeightField(field), Pose::IDENTITY);
    let vertical = Beams { samples: 16, min_angle_rad: -0.4, max_angle_rad: 0.3 };
    let horizontal = Beams { samples: 360, min_angle_rad: 0.0, max_angle_rad: TAU * 359.0 / 360.0 };
    let lidar = Lidar::new(LidarConfig::new(horizontal).vertical(vertical)).unwrap();
    let pose = Pose::from_xyz_rpy(DVec3::new(-1.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let capture = Capture::new(0, builder.moment(pose));
    let mut expected = vec![0.0; lidar.beams()];
    let scene = builder.scene();
    let mut memory = WorkspaceBuf::default();
    lidar.sense_in(&mut memory, &scene, &capture, Scan::new().ranges(&mut expected)).unwrap();
    let lasers: Vec<_> = (0..16)
        .map(|row| Laser { elevation_rad: vertical.angle(row), ..Laser::at_degrees(0.0, 0.0) })
        .collect();
    let columns = Columns::Turn { per_turn: 360, first: 0, count: 360 };
    let pattern = Spinning { lasers: &lasers, columns, first_azimuth_rad: 0.0, clockwise: false };
    let config = ScannerConfig::new(Pattern::Spinning(pattern)).range_max_m(30.0);
    let scanner = Scanner::new(config).unwrap();
    let (ranges, _) = scan(&scanner, &builder, &capture, Execution::default());
    let mut differ = 0;
    for (index, range) in ranges.iter().enumerate() {
        let (row, column) = (index % 16, index / 16);
        let expected = expected[row * 360 + column];
        differ += usize::from(!(range == &expected || (range / expected - 1.0).abs() < 1e-5));
    }
    // Some beams are at an edge.
    assert!(differ <= 2, "{differ} of {}", ranges.len());
    let met = ranges.iter().filter(|range| range.is_finite()).count();
    assert!(met > 2500, "{met}");
}

/// Columns that are fired at fixed times continue from frame to frame without a gap, and so does the rotation of the
/// head.
#[test]
fn columns_at_fixed_times_continue_from_frame_to_frame() {
    let tower = tower();
    let scanner = Scanner::new(ScannerConfig::new(tower_of(&tower))).unwrap();
    let mut before: Option<(f64, f64)> = None;
    let mut counts = Vec::new();
    for frame in 0..40 {
        let count = scanner.firings(frame);
        counts.push(count / 16);
        for index in (0..count).step_by(16) {
            let firing = scanner.firing(frame, index);
            let time = 0.1 * frame as f64 + firing.time_s;
            let azimuth = -firing.direction.y.atan2(firing.direction.x);
            if let Some((last, angle)) = before {
                assert!((time - last - 55.296e-6).abs() < 1e-12, "frame {frame}, firing {index}");
                let turned = (azimuth - angle).rem_euclid(TAU);
                assert!((turned - TAU * 55.296e-5).abs() < 1e-9, "frame {frame}, firing {index}: {turned}");
            }
            before = Some((time, azimuth));
        }
    }
    assert_eq!(counts.iter().sum::<usize>(), (4e9_f64 / 55_296.0).ceil() as usize);
    assert!(counts.iter().all(|count| [1808, 1809].contains(count)));
    assert_eq!(scanner.most_firings(), 1809 * 16);
}

/// Brazeal's model of a Mid-40 (2021) with the angle of a Mid-70: everything is within 35.2° of the axis, most of it
/// near the rim and the middle, and the figure repeats after 30 s.
#[test]
fn two_prisms_draw_a_rosette() {
    let rosette = Rosette {
        firing_time_ns: 10_000,
        speeds_rpm: [7294, -4664],
        wedge_rad: 29.68_f64.to_radians(),
        refractive_index: 1.51,
        is_flat_inwards: false,
    };
    let scanner = Scanner::new(ScannerConfig::new(Pattern::Rosette(rosette))).unwrap();
    assert_eq!(scanner.most_firings(), 10_000);
    let (mut most, mut near, mut all) = (0.0_f64, 0, 0);
    for frame in 0..300 {
        assert_eq!(scanner.firings(frame), 10_000);
        for index in (0..10_000).step_by(7) {
            let direction = scanner.firing(frame, index).direction;
            assert!((direction.length() - 1.0).abs() < 1e-12);
            let angle = direction.x.acos().to_degrees();
            most = most.max(angle);
            near += u32::from(angle < 5.0);
            all += 1;
        }
    }
    assert!((most - 35.2).abs() < 0.05, "{most}");
    let share = 100.0 * f64::from(near) / f64::from(all);
    assert!((share - 8.7).abs() < 0.1, "{share} % within 5° of the axis");
    let again = |frame| (0..100).map(|index| scanner.firing(frame, index).direction).collect::<Vec<_>>();
    assert_eq!(again(0), again(300));
    assert_ne!(again(0), again(150));
    // A small wedge deflects by (n − 1) times its angle, each on its own.
    let thin = Rosette { wedge_rad: 1e-3, ..rosette };
    let thin = Scanner::new(ScannerConfig::new(Pattern::Rosette(thin))).unwrap();
    for index in 0..1000 {
        let firing = thin.firing(2, index);
        let turn = |rpm: f64| TAU * rpm / 60.0 * (0.2 + firing.time_s);
        let (a, b) = (turn(7294.0), turn(-4664.0));
        let expected = DVec3::new(0.0, a.cos() + b.cos(), a.sin() + b.sin()) * -0.51e-3;
        let off = (firing.direction - DVec3::X - expected).length();
        assert!(off < 2e-6, "{off}");
    }
}

/// From the centre of a ball of 8 m whose surface has an intensity of 40.
#[test]
fn ranges_have_the_configured_noise() {
    let mut ball = SceneBuilder::new();
    let material = ball.add_material(&MaterialConfig::default()).unwrap();
    let config = InstanceConfig {
        shape: Shape::Sphere { radius: 8.0 },
        laser_retro: 40.0,
        material,
        ..Default::default()
    };
    ball.add_instance(&config).unwrap();
    let capture = Capture::new(3, ball.moment(Pose::IDENTITY));
    let noise =
        GaussianNoise::new(GaussianNoiseConfig::default().mean(0.1).stddev(0.02).precision(0.002)).unwrap();
    let config = presets::VLP_16.config().noise(noise).seed(5);
    let scanner = Scanner::new(config).unwrap();
    let (count, most) = (scanner.firings(3), scanner.most_firings());
    let (mut ranges, mut points) = (vec![0.0; most], vec![[0.0; 3]; most]);
    let (mut intensities, mut times, mut lasers) = (vec![0.0; most], vec![0.0; most], vec![0; most]);
    let output = Echoes::new().ranges(&mut ranges).points(&mut points).intensities(&mut intensities);
    let output = output.times(&mut times).lasers(&mut lasers);
    take(&scanner, &ball, &capture, Execution::default(), output).unwrap();
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..count {
        let firing = scanner.firing(3, index);
        let range = f64::from(ranges[index]);
        let point = firing.origin + firing.direction * range;
        assert!((point - DVec3::from(points[index].map(f64::from))).length() < 1e-6);
        assert!((range / 0.002 - (range / 0.002).round()).abs() < 1e-3, "{range}");
        assert_eq!((intensities[index], times[index], lasers[index]), (40.0, firing.time_s, firing.laser));
        // Origins are up to 11 mm from the centre.
        let truth = -firing.origin.dot(firing.direction)
            + (64.0 + firing.origin.dot(firing.direction).powi(2) - firing.origin.length_squared()).sqrt();
        let error = range - truth;
        (sum, squares) = (sum + error, squares + error * error);
    }
    let mean = sum / count as f64;
    let stddev = (squares / count as f64 - mean * mean).sqrt();
    // Rounding to 2 mm adds its own variance.
    let expected = (0.02_f64.powi(2) + 0.002_f64.powi(2) / 12.0).sqrt();
    assert!((mean - 0.1).abs() < 4.0 * 0.02 / (count as f64).sqrt(), "{mean}");
    assert!((stddev / expected - 1.0).abs() < 0.02, "{stddev}");
    assert!(count < most && times[count..].iter().all(|time| time.is_nan()));
    // Beyond the largest range there are no returns, and surfaces nearer than the smallest are too near.
    let limited = |range: [f64; 2]| {
        let config = config.range_min_m(range[0]).range_max_m(range[1]);
        scan(&Scanner::new(config).unwrap(), &ball, &capture, Execution::default()).0[..count].to_vec()
    };
    assert!(limited([0.0, 7.9]).iter().all(|range| *range == f32::INFINITY));
    assert!(limited([8.1, 9.0]).iter().all(|range| *range == f32::NEG_INFINITY));
}

/// The rings of the manuals' tables; and the beams that leave the window of a VLP-16 intersect behind it.
#[test]
fn presets_follow_their_manuals() {
    let elevations = |preset: &presets::Preset| {
        let Pattern::Spinning(head) = preset.pattern else { panic!() };
        let degrees = head.lasers.iter().map(|laser| laser.elevation_rad.to_degrees());
        (degrees.collect::<Vec<_>>(), head.lasers.to_vec())
    };
    let (vlp, lasers) = elevations(&presets::VLP_16);
    assert!(
        (0..16).all(|id| (vlp[id] - if id % 2 == 0 { id as f64 - 15.0 } else { id as f64 }).abs() < 1e-12)
    );
    for (laser, id) in lasers.iter().zip(0..) {
        assert!((laser.time_s - 2.304e-6 * f64::from(id)).abs() < 1e-15);
        assert!((laser.origin_m[2] + 0.041_91 * laser.elevation_rad.tan()).abs() < 1e-7);
    }
    let (hdl, lasers) = elevations(&presets::HDL_32E);
    for id in 0..32 {
        let expected = if id % 2 == 0 { -92.0 / 3.0 } else { -28.0 / 3.0 } + (id / 2) as f64 * 4.0 / 3.0;
        assert!((hdl[id] - expected).abs() < 0.0034, "{id}: {}", hdl[id]);
        assert!((lasers[id].time_s - 1.152e-6 * id as f64).abs() < 1e-15);
    }
    assert!(
        (lasers[0].origin_m[2] - 0.017_17).abs() < 1e-5 && (lasers[31].origin_m[2] + 0.005_45).abs() < 1e-5
    );
    // 753.5 packets of 384 firings per second, and 1808.4 packets (at 46.08 µs per column) for the other.
    let rate = |preset: &presets::Preset| {
        let scanner = Scanner::new(preset.config().frame_time_ns(100_000_000)).unwrap();
        (0..100).map(|frame| scanner.firings(frame)).sum::<usize>() as f64 / 384.0 / 10.0
    };
    assert!((rate(&presets::VLP_16) - 753.5).abs() < 0.1, "{}", rate(&presets::VLP_16));
    assert!((rate(&presets::HDL_32E) - 1808.4).abs() < 0.1, "{}", rate(&presets::HDL_32E));
    assert_eq!(presets::named("vlp16"), Some(presets::VLP_16));
    assert_eq!(presets::named("vlp17"), None);
}

#[test]
fn invalid_patterns_are_refused() {
    let drum = drum();
    let said = |config: ScannerConfig<'_>| Scanner::new(config).unwrap_err().to_string();
    let with = |change: &dyn Fn(&mut Vec<Laser>)| {
        let mut lasers = drum.clone();
        change(&mut lasers);
        said(ScannerConfig::new(drum_of(&lasers)))
    };
    assert_eq!(
        with(&|lasers| lasers[3].elevation_rad = f64::NAN),
        "elevation_rad of laser 3 of the scanner is NaN; it must be -π/2 to π/2"
    );
    assert_eq!(
        with(&|lasers| lasers[2].time_s = 1e-6),
        "time_s of laser 3 of the scanner is 0; it must be not before that of the previous laser, and less than a \
         column's (frame_time_ns / per_turn)"
    );
    assert!(
        with(&|lasers| lasers[31].time_s = 1e-3).starts_with("time_s of laser 31 of the scanner is 0.001")
    );
    assert!(
        with(&|lasers| lasers[5].origin_m[1] = f64::INFINITY)
            .starts_with("origin_m of laser 5 of the scanner is inf")
    );
    assert!(with(&|lasers| lasers[5].azimuth_rad = f64::NAN).starts_with("azimuth_rad of laser 5"));
    assert_eq!(with(&Vec::clear), "number of lasers of the scanner is 0; it must be 1 to 4096");
    let many = vec![Laser::at_degrees(0.0, 0.0); 4096];
    let columns = |per_turn| Columns::Turn { per_turn, first: 0, count: per_turn };
    let head = |lasers, columns| Spinning { lasers, columns, first_azimuth_rad: 0.0, clockwise: true };
    let of = |spinning| said(ScannerConfig::new(Pattern::Spinning(spinning)));
    assert_eq!(
        of(head(&many, columns(4097))),
        "firings of a frame of the scanner is 16781312; it must be 1 to 16777216"
    );
    assert!(of(head(&many, columns(0))).starts_with("per_turn of the scanner is 0"));
    assert!(
        of(head(&many, Columns::Turn { per_turn: 9, first: 5, count: 5 }))
            .starts_with("first + count of the scanner is 10")
    );
    assert!(
        of(head(&many, Columns::Every { time_ns: 0 })).starts_with("time_ns of columns of the scanner is 0")
    );
    for first_azimuth_rad in [f64::NAN, f64::NEG_INFINITY, 6.3, -6.3, 1e15] {
        let turned = Spinning { first_azimuth_rad, ..head(&many, columns(8)) };
        assert_eq!(
            of(turned),
            format!("first_azimuth_rad of the scanner is {first_azimuth_rad}; it must be -2π to 2π")
        );
    }
    let ahead = Firing { time_s: 0.0, origin: DVec3::ZERO, direction: DVec3::X, laser: 0 };
    let table = |firings: &[Firing]| said(ScannerConfig::new(Pattern::Table(firings)));
    assert!(table(&[]).starts_with("firings of a frame of the scanner is 0"));
    assert!(
        table(&[ahead, Firing { direction: DVec3::ZERO, ..ahead }])
            .starts_with("length of the direction of firing 1 of the scanner is 0")
    );
    assert!(
        table(&[Firing { time_s: 0.01, ..ahead }, ahead])
            .starts_with("time_s of firing 1 of the scanner is 0")
    );
    assert!(
        table(&[Firing { time_s: 0.1, ..ahead }]).starts_with("time_s of firing 0 of the scanner is 0.1")
    );
    let table = [ahead];
    let plain = ScannerConfig::new(Pattern::Table(&table));
    assert_eq!(
        said(plain.range_min_m(f64::NAN)),
        "range_min_m of the scanner is NaN; it must be 0 or more, and finite"
    );
    assert!(said(plain.range_min_m(100.0)).starts_with("range_max_m of the scanner is 100"));
    assert!(said(plain.frame_time_ns(0)).starts_with("frame_time_ns of the scanner is 0"));
    let rosette = Rosette {
        firing_time_ns: 1000,
        speeds_rpm: [1, 2],
        wedge_rad: FRAC_PI_2,
        refractive_index: 1.5,
        is_flat_inwards: false,
    };
    assert!(said(plain.pattern(Pattern::Rosette(rosette))).starts_with("wedge_rad of the scanner is 1.57"));

    let scanner = Scanner::new(plain).unwrap();
    let builder = SceneBuilder::new();
    let at = builder.moment(Pose::IDENTITY);
    let refused = |shutter: Shutter<'_>| {
        let mut ranges = [0.0];
        let output = Echoes::new().ranges(&mut ranges);
        take(&scanner, &builder, &Capture::new(0, shutter), Execution::default(), output)
            .unwrap_err()
            .to_string()
    };
    let keys = |times: &[f64]| times.iter().map(|&time_s| Keyframe { time_s, at }).collect::<Vec<_>>();
    let moving = |times: &[f64]| refused(Shutter::Moving(&keys(times)));
    assert_eq!(moving(&[0.0]), "keyframe 1 of the shutter must exist: motion needs at least two keyframes");
    assert_eq!(moving(&[0.0, 0.1, 0.1]), "keyframe 2 of the shutter must be later than the previous one");
    assert_eq!(moving(&[0.0, f64::NAN]), "keyframe 1 of the shutter must have a time that is finite");
    assert_eq!(
        moving(&[0.01, 0.1]),
        "keyframe 0 of the shutter must be at 0 s, the beginning of the frame, or earlier"
    );
    assert_eq!(moving(&[0.0, 0.09]), "keyframe 1 of the shutter must be at the end of the frame or later");
    let slices = [Slice { lines: 0..1, at }];
    assert!(refused(Shutter::Slices(&slices)).starts_with("the shutter must be one moment or keyframes"));
    let lost = Moment { world_from_sensor: Pose::from_translation(DVec3::NAN), ..at };
    assert_eq!(refused(Shutter::Global(lost)), "the sensor's pose must be finite numbers");
    let short =
        take(&scanner, &builder, &Capture::new(0, at), Execution::default(), Echoes::new().ranges(&mut []));
    assert_eq!(short.unwrap_err().to_string(), "the output ranges holds 0 elements; the frame has 1");
    let mut flow = [[0.0; 2]];
    let flow = Echoes::new().truth(Truth::new().flow(&mut flow));
    let flow = take(&scanner, &builder, &Capture::new(0, at), Execution::default(), flow);
    assert!(flow.unwrap_err().to_string().starts_with("flow is not computed for sensors whose rays"));
    // A lidar's beams have no individual times.
    let lidar = Lidar::new(LidarConfig::new(Beams::ONE)).unwrap();
    let (keyframes, mut ranges) = (keys(&[0.0, 1.0]), [0.0]);
    let (scene, capture) = (builder.scene(), Capture::new(0, keyframes.as_slice()));
    let mut memory = WorkspaceBuf::default();
    let said = lidar.sense_in(&mut memory, &scene, &capture, Scan::new().ranges(&mut ranges)).unwrap_err();
    assert_eq!(
        said.to_string(),
        "the shutter must be one moment or slices: this sensor's rays have no individual times"
    );
}
