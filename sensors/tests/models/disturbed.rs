//! Disturbances of scanners: blooming of retroreflectors and crosstalk from other lidars, against closed forms.

use belvedere_sensors::scanner::{
    Beam, Crosstalk, Echoes, Firing, Halo, Intensity, Pattern, Receiver, Returns, Scanner, ScannerConfig,
};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use core::f64::consts::{FRAC_PI_4, TAU};
use glam::DVec3;

/// The ranges and intensities of a frame.
fn sense(config: ScannerConfig<'_>, builder: &SceneBuilder, frame: u64) -> (Vec<f32>, Vec<f32>) {
    let scanner = Scanner::new(config).unwrap();
    let values = scanner.most_firings() * scanner.returns();
    let (mut ranges, mut intensities) = (vec![7.0; values], vec![7.0; values]);
    let (scene, capture) = (builder.scene(), Capture::new(frame, builder.moment(Pose::IDENTITY)));
    let mut memory = WorkspaceBuf::default();
    let output = Echoes::new().ranges(&mut ranges).intensities(&mut intensities);
    scanner
        .sense(&scene, &capture, &mut memory.lend(scanner.workspace_len(&scene, &capture)), output)
        .unwrap();
    (ranges, intensities)
}

/// Horizontal firings at evenly spaced slopes to the left.
fn row(count: u32, step: f64) -> Vec<Firing> {
    (0..count)
        .map(|index| {
            let slope = (f64::from(index) - 0.5 * f64::from(count - 1)) * step;
            let direction = DVec3::new(1.0, slope, 0.0).normalize();
            Firing { time_s: 0.0, origin: DVec3::ZERO, direction, laser: 0 }
        })
        .collect()
}

/// A thin plate that faces the sensor, with a `laser_retro`.
fn add_plate(builder: &mut SceneBuilder, x: f64, size: f64, laser_retro: f32) {
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let config = InstanceConfig {
        shape: Shape::Box { size: [0.01, size, size] },
        world_from_instance: Pose::from_translation(DVec3::X * (x + 0.005)),
        laser_retro,
        material,
        ..Default::default()
    };
    builder.add_instance(&config).unwrap();
}

#[test]
fn retroreflectors_bloom_and_others_do_not() {
    // No beam is aimed at the edge of the reflector.
    let (distance, size, wall) = (20.0, 0.497, 30.0);
    let halo = Halo { share: 0.02, radius_rad: 0.02 };
    let table = row(401, 2.5e-4);
    let plain = ScannerConfig::new(Pattern::Table(&table))
        .intensity(Intensity::Power)
        .receiver(Some(Receiver::new(60.0)))
        .returns(Returns::Several(2));
    // With a reflector and a wall behind it: the number of beams that have a return from the reflector.
    let seen = |config: ScannerConfig<'_>, laser_retro: f32| {
        let mut builder = SceneBuilder::new();
        add_plate(&mut builder, distance, size, laser_retro);
        add_plate(&mut builder, wall, 100.0, 90.0);
        let (ranges, powers) = sense(config, &builder, 0);
        let near: Vec<usize> = (0..table.len()).filter(|beam| ranges[2 * beam] < 25.0).collect();
        // A beam that hits the wall keeps its own return, combined with the part of its halo that hits the wall: 2 % of
        // the light, up to 30 m · 0.05 · 0.0141 farther away.
        for (beam, firing) in table.iter().enumerate() {
            let own = if ranges[2 * beam] < 25.0 { 2 * beam + 1 } else { 2 * beam };
            let is_plate = near.contains(&beam) && !ranges[own].is_finite();
            let off = (f64::from(ranges[own]) * firing.direction.x - wall).abs();
            assert!(is_plate || off < 5e-4, "beam {beam}: {:?}", &ranges[2 * beam..2 * beam + 2]);
        }
        (near, ranges, powers)
    };
    let beams = |half: f64| (2.0 * half / 2.5e-4).round();
    // Without a halo, or for a diffuse plate, the plate has its true width.
    let (own, ..) = seen(plain, 255.0);
    assert!((own.len() as f64 - beams(0.5 * size / distance)).abs() <= 1.0, "{}", own.len());
    let (dull, ..) = seen(plain.halo(halo), 90.0);
    assert_eq!(dull, own);
    // A retroreflector appears wider by the halo's rays to either side: some of them are level with the beam.
    let ring = halo.radius_rad * 0.5_f64.sqrt();
    let (bright, ranges, powers) = seen(plain.halo(halo), 255.0);
    let expected = beams(0.5 * size / distance + ring.tan());
    assert!((bright.len() as f64 - expected).abs() <= 2.0, "{} beams, not {expected}", bright.len());
    // Its returns are at its range, with the light of the halo's rays that hit it, a hundred times that of a white
    // surface.
    for beam in &bright {
        let slope = table[*beam].direction.y / table[*beam].direction.x;
        let hits = (0..8).filter(|ray| {
            let angle = TAU * f64::from(*ray) / 8.0;
            let (left, up) = (slope + ring.tan() * angle.cos(), ring.tan() * angle.sin());
            left.abs().max(up.abs()) * distance < 0.5 * size
        });
        let edge = (slope.abs() * distance - 0.5 * size).abs() < 0.02;
        let near_ray = [0.0, FRAC_PI_4, 2.0 * FRAC_PI_4].into_iter().any(|angle| {
            let off = ring.tan() * angle.cos();
            [off, -off].iter().any(|off| ((slope + off).abs() * distance - 0.5 * size).abs() < 0.02)
        });
        if edge || near_ray {
            continue;
        }
        let own = if slope.abs() * distance < 0.5 * size { 1.0 - halo.share } else { 0.0 };
        let range = f64::from(ranges[2 * beam]);
        assert!((range - distance).abs() < 0.02, "{range}");
        let expected = 100.0 * (own + halo.share * hits.count() as f64 / 8.0) / (range * range);
        let power = f64::from(powers[2 * beam]);
        assert!((power / expected - 1.0).abs() < 5e-3, "beam {beam}: {power}, not {expected}");
    }
}

#[test]
fn crosstalk_has_its_frequency_and_is_uniform_in_range() {
    let table = row(20_000, 1e-5);
    let chance = 0.03;
    let config = ScannerConfig::new(Pattern::Table(&table))
        .range_max_m(80.0)
        .intensity(Intensity::Reflectivity)
        .crosstalk(Crosstalk { chance })
        .seed(5);
    let empty = SceneBuilder::new();
    let (ranges, intensities) = sense(config, &empty, 0);
    let mut heard: Vec<f64> =
        ranges.iter().filter(|range| range.is_finite()).map(|range| f64::from(*range)).collect();
    let count = heard.len() as f64;
    let scatter = (chance * (1.0 - chance) * 20_000.0).sqrt();
    assert!((count - 20_000.0 * chance).abs() < 4.0 * scatter, "{count}");
    // Kolmogorov and Smirnov: ranges are uniformly distributed.
    heard.sort_by(f64::total_cmp);
    let off =
        heard.iter().enumerate().map(|(index, range)| (range / 80.0 - (index as f64 + 0.5) / count).abs());
    assert!(off.fold(0.0, f64::max) * count.sqrt() < 1.63);
    // As strong as a white surface at that range.
    let is_white = |(range, intensity): (&f32, &f32)| !range.is_finite() || (intensity - 100.0).abs() < 1e-3;
    assert!(ranges.iter().zip(&intensities).all(is_white));
    // Other firings in the next frame; none without crosstalk.
    let (other, _) = sense(config, &empty, 1);
    assert!(ranges.iter().zip(&other).filter(|(a, b)| a.is_finite() && b.is_finite()).count() < 60);
    let (none, _) = sense(config.crosstalk(Crosstalk::NONE), &empty, 0);
    assert!(none.iter().all(|range| *range == f32::INFINITY));
    // The wall is still seen: in front of the crosstalk, behind it, or as the stronger of the two.
    let mut walled = SceneBuilder::new();
    add_plate(&mut walled, 10.0, 100.0, 90.0);
    let (both, _) = sense(config.returns(Returns::Several(2)).pulse_m(0.0), &walled, 0);
    for ((beam, alone), firing) in both.chunks(2).zip(&ranges).zip(&table) {
        let wall = (10.0 / firing.direction.x) as f32;
        let mut expected = [wall.min(*alone), wall.max(*alone)];
        expected.sort_by(f32::total_cmp);
        assert!(
            beam.iter().zip(expected).all(|(a, b)| *a == b || (a - b).abs() < 1e-5),
            "{beam:?}, {expected:?}"
        );
    }
}

#[test]
fn invalid_parameters_are_refused() {
    let config = ScannerConfig::new(Pattern::Table(&[]));
    for (config, names) in [
        (config.halo(Halo { share: 0.6, radius_rad: 0.01 }), "share of the halo"),
        (config.halo(Halo { share: 0.1, radius_rad: f64::NAN }), "radius_rad of the halo"),
        (config.crosstalk(Crosstalk { chance: -0.1 }), "chance of crosstalk"),
        (config.crosstalk(Crosstalk { chance: 0.1 }).range_max_m(f64::INFINITY), "range_max_m"),
    ] {
        assert_eq!(Scanner::new(config.beam(Beam::RAY)).unwrap_err().parameter, names);
    }
}
