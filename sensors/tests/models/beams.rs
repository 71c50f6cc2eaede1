//! Beams of scanners: returns that depend on their width, on surfaces and on the air, against closed forms.

use crate::common::add_grey;
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scanner::{
    Beam, DropSizes, Echoes, Firing, Intensity, Pattern, Receiver, Returns, Scanner, ScannerConfig, Weather,
    presets,
};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Keyframe, Moment, Pose, Sensor, Shutter};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::DVec3;

const AHEAD: Firing = Firing { time_s: 0.0, origin: DVec3::ZERO, direction: DVec3::X, laser: 0 };

/// Ranges, points and intensities of frame 0.
type Found = (Vec<f32>, Vec<[f32; 3]>, Vec<f32>);

fn sense<'a>(config: ScannerConfig<'_>, scene: &SceneBuilder, shutter: impl Into<Shutter<'a>>) -> Found {
    let scanner = Scanner::new(config).unwrap();
    let values = scanner.most_firings() * scanner.returns();
    let mut found = (vec![7.0; values], vec![[7.0; 3]; values], vec![7.0; values]);
    let (ranges, points, intensities) = &mut found;
    let output = Echoes::new().ranges(ranges).points(points).intensities(intensities);
    let (scene, capture) = (scene.scene(), Capture::new(0, shutter));
    let mut memory = WorkspaceBuf::default();
    scanner
        .sense(&scene, &capture, &mut memory.lend(scanner.workspace_len(&scene, &capture)), output)
        .unwrap();
    found
}

fn still(config: ScannerConfig<'_>, scene: &SceneBuilder) -> Found {
    sense(config, scene, scene.moment(Pose::IDENTITY))
}

fn near(found: f32, expected: f64, within: f64) {
    let found = f64::from(found);
    assert!((found - expected).abs() <= within * expected.abs(), "{found} instead of {expected}");
}

/// A thin plate that faces the sensor and extends from `right` to the left, with a `laser_retro`.
fn add_plate(builder: &mut SceneBuilder, x: f64, right: f64, laser_retro: f32) {
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let config = InstanceConfig {
        shape: Shape::Box { size: [0.01, 10.0, 10.0] },
        world_from_instance: Pose::from_translation(DVec3::new(x + 0.005, right + 5.0, 0.0)),
        laser_retro,
        material,
        ..Default::default()
    };
    builder.add_instance(&config).unwrap();
}

fn beam(rays: u32) -> Beam {
    Beam { divergence_rad: [3e-3, 1.5e-3], aperture_m: [12.7e-3, 9.5e-3], rays }
}

/// The positions of the rays, as fractions of half the width and height: the table of [`Beam`].
fn places(rays: u32) -> Vec<[f64; 2]> {
    let rings: &[(u32, f64)] = match rays {
        7 => &[(1, 0.0), (6, (4.0_f64 / 7.0).sqrt())],
        8 => &[(1, 0.0), (7, 0.75)],
        19 => &[(1, 0.0), (6, (4.0_f64 / 19.0).sqrt()), (12, (13.0_f64 / 19.0).sqrt())],
        _ => &[(1, 0.0)],
    };
    let on_ring = |&(count, radius): &(u32, f64)| {
        let angle = move |ray| TAU * f64::from(ray) / f64::from(count);
        (0..count).map(move |ray| [radius * angle(ray).cos(), radius * angle(ray).sin()])
    };
    rings.iter().flat_map(on_ring).collect()
}

/// A plate at 10 m that covers a part of the beam from the left, in front of one at 13 m.
#[test]
fn a_beam_that_hits_two_plates_has_two_returns() {
    let table = [AHEAD];
    let half = 0.5 * (12.7e-3 + 2.0 * (1.5e-3_f64).tan() * 10.0);
    for rays in [1, 7, 8, 19] {
        let mut worst = 0.0_f64;
        for step in -20..=20 {
            let edge = 0.0503 * f64::from(step) + 0.0007;
            let mut plates = SceneBuilder::new();
            add_plate(&mut plates, 10.0, edge * half, 20.0);
            add_plate(&mut plates, 13.0, -5.0, 60.0);
            let config = ScannerConfig::new(Pattern::Table(&table)).beam(beam(rays)).pulse_m(1.0);
            let seen = |returns| still(config.returns(returns), &plates);
            let share = places(rays).iter().filter(|[left, _]| *left > edge).count() as f64 / f64::from(rays);
            let (first, last) =
                (if share > 0.0 { 10.0 } else { 13.0 }, if share < 1.0 { 13.0 } else { 10.0 });
            let strongest = if share >= 0.5 { 10.0 } else { 13.0 };
            // Outer rays are longer, by up to 3 µm.
            let is = |found: f32, expected: f64| near(found, expected, 1e-6);
            is(seen(Returns::Strongest).0[0], strongest);
            is(seen(Returns::First).0[0], first);
            is(seen(Returns::Last).0[0], last);
            is(seen(Returns::Mean).0[0], 10.0 * share + 13.0 * (1.0 - share));
            // The last, and the strongest of the others.
            let (ranges, points, retros) = seen(Returns::Dual);
            let (all, _, all_retros) = seen(Returns::Several(5));
            is(ranges[0], last);
            is(all[0], first);
            if first < last {
                is(ranges[1], 10.0);
                is(all[1], 13.0);
                assert_eq!(points[1], [ranges[1], 0.0, 0.0]);
                assert_eq!((&retros[..], &all_retros[..2]), (&[60.0, 20.0][..], &[20.0, 60.0][..]));
            }
            let none = if first < last { 2 } else { 1 };
            assert!(all[none..].iter().all(|range| *range == f32::INFINITY));
            assert!(all_retros[none..].iter().all(|retro| *retro == 0.0));
            assert!(ranges[none..].iter().all(|range| *range == f32::INFINITY));
            assert!(points[none..].iter().all(|point| point[0].is_nan()));
            // The area of a segment of a circle.
            let area = (edge.clamp(-1.0, 1.0).acos() - edge * (1.0 - edge * edge).max(0.0).sqrt()) / PI;
            worst = worst.max((share - area).abs());
        }
        println!("{rays} rays: shares up to {worst} off the area");
        let bound = match rays {
            1 => 0.51,
            19 => 0.12,
            _ => 0.2,
        };
        assert!(worst < bound, "{rays} rays: {worst}");
    }
}

/// Five plates one behind the other, each a little farther into the beam.
#[test]
fn surfaces_closer_than_a_pulse_are_one_return() {
    let table = [AHEAD];
    let edges = [0.7, 0.45, 0.0, -0.35, -5.0];
    let (mut plates, mut shares) = (SceneBuilder::new(), Vec::new());
    let mut before = 0.0;
    for (number, edge) in edges.into_iter().enumerate() {
        let x = 20.0 + 0.8 * number as f64;
        let half = 0.5 * (12.7e-3 + 2.0 * (1.5e-3_f64).tan() * x);
        add_plate(&mut plates, x, edge * half, 0.0);
        let share = places(19).iter().filter(|[left, _]| *left > edge).count() as f64 / 19.0;
        shares.push(share - before);
        before = share;
    }
    let config = ScannerConfig::new(Pattern::Table(&table)).beam(beam(19));
    let mean = |which: core::ops::Range<usize>| {
        let sum: f64 = which.clone().map(|plate| (20.0 + 0.8 * plate as f64) * shares[plate]).sum();
        sum / shares[which].iter().sum::<f64>()
    };
    let seen = |returns, pulse_m| still(config.returns(returns).pulse_m(pulse_m), &plates).0;
    for (plate, range) in seen(Returns::Several(5), 0.7).into_iter().enumerate() {
        near(range, 20.0 + 0.8 * plate as f64, 1e-6);
    }
    let merged = seen(Returns::Several(5), 1.0);
    near(merged[0], mean(0..5), 1e-6);
    assert_eq!(merged[1], f32::INFINITY);
    near(seen(Returns::Mean, 0.0)[0], mean(0..5), 1e-6);
    // If there are more returns than requested, the strongest are reported, ordered by range.
    let mut order: Vec<usize> = (0..5).collect();
    order.sort_by(|a, b| shares[*b].total_cmp(&shares[*a]));
    let mut three = order[..3].to_vec();
    three.sort_unstable();
    for (range, plate) in seen(Returns::Several(3), 0.7).into_iter().zip(three) {
        near(range, 20.0 + 0.8 * plate as f64, 1e-6);
    }
    // The last is the strongest here, so the second strongest is reported with it.
    assert_eq!(order[0], 4);
    let dual = seen(Returns::Dual, 0.7);
    near(dual[0], 23.2, 1e-6);
    near(dual[1], 20.0 + 0.8 * order[1] as f64, 1e-6);
}

/// A VLP-16 that drives and turns in front of walls that are wider than its beams: every ray of a beam has the time of
/// its firing.
#[test]
fn beams_start_at_the_pose_of_the_sensor_at_their_time() {
    let mut walls = SceneBuilder::new();
    for (normal, distance) in [(DVec3::X, 9.0), (DVec3::NEG_X, 7.0), (DVec3::Y, 8.0), (DVec3::NEG_Y, 6.0)] {
        let size = (DVec3::splat(100.0) - normal.abs() * 99.8).to_array();
        add_grey(&mut walls, Shape::Box { size }, Pose::from_translation(normal * (distance + 0.1)));
    }
    let pose = |time: f64| {
        Pose::from_xyz_rpy(DVec3::new(8.0 * time, 0.3, 0.0), DVec3::new(0.02, -0.03, 1.0 + 3.0 * time))
    };
    let times: Vec<_> = (0..=100).map(|step| 1e-3 * f64::from(step)).collect();
    let keyframes: Vec<_> = times
        .iter()
        .map(|&time_s| Keyframe {
            time_s,
            at: Moment { world_from_sensor: pose(time_s), world_from_instance: walls.poses() },
        })
        .collect();
    let config = presets::VLP_16.config().noise(GaussianNoise::NONE).pulse_m(1.0);
    let scanner = Scanner::new(config).unwrap();
    let (ranges, ..) = sense(config.beam(beam(8)), &walls, keyframes.as_slice());
    let (thin, ..) = sense(config, &walls, keyframes.as_slice());
    let mut worst = 0.0_f64;
    for index in 0..scanner.firings(0) {
        let firing = scanner.firing(0, index);
        let at = pose(firing.time_s);
        let left = DVec3::new(-firing.direction.y, firing.direction.x, 0.0).normalize();
        let up = firing.direction.cross(left);
        let to_wall = |[x, y]: [f64; 2]| {
            let aside = left * x * 1.5e-3_f64.tan() + up * y * 0.75e-3_f64.tan();
            let direction = at.transform_vector((firing.direction + aside).normalize());
            let origin = firing.origin + left * x * 6.35e-3 + up * y * 4.75e-3;
            let origin = at.transform_point(origin);
            let along = |from: f64, by: f64, walls: [f64; 2]| {
                if by > 0.0 { (walls[1] - from) / by } else { (walls[0] - from) / by }
            };
            along(origin.x, direction.x, [-7.0, 9.0]).min(along(origin.y, direction.y, [-6.0, 8.0]))
        };
        let expected = places(8).into_iter().map(to_wall).sum::<f64>() / 8.0;
        worst = worst.max((f64::from(ranges[index]) - expected).abs());
        near(thin[index], to_wall([0.0; 2]), 2e-7);
    }
    println!("{worst:e} m off");
    assert!(worst < 4e-6, "{worst:e}");
}

/// Ground truth is that of the middle ray, and without a width everything is as with a single ray.
#[test]
fn ground_truth_is_that_of_the_middle_ray() {
    let table = [AHEAD, Firing { direction: DVec3::Y, ..AHEAD }];
    let mut plates = SceneBuilder::new();
    add_plate(&mut plates, 10.0, 0.001, 0.0);
    add_plate(&mut plates, 13.0, -5.0, 0.0);
    let config =
        ScannerConfig::new(Pattern::Table(&table)).beam(beam(19)).pulse_m(1.0).returns(Returns::Dual);
    let scanner = Scanner::new(config).unwrap();
    let (mut range, mut instance, mut times, mut lasers) = ([0.0; 2], [0; 2], [1.0; 2], [7; 2]);
    let truth = Truth::new().range(&mut range).instance(&mut instance);
    let (scene, capture) = (plates.scene(), Capture::new(0, plates.moment(Pose::IDENTITY)));
    let mut memory = WorkspaceBuf::default();
    let output = Echoes::new().truth(truth).times(&mut times).lasers(&mut lasers);
    scanner
        .sense(&scene, &capture, &mut memory.lend(scanner.workspace_len(&scene, &capture)), output)
        .unwrap();
    assert_eq!((range, instance), ([13.0, f32::INFINITY], [1, u32::MAX]));
    assert_eq!((times, lasers), ([0.0; 2], [0; 2]));
    let wide = Beam { divergence_rad: [0.0; 2], aperture_m: [0.0; 2], rays: 8 };
    let (dual, ..) = still(config.beam(wide), &plates);
    assert_eq!(dual, [13.0, f32::INFINITY, f32::INFINITY, f32::INFINITY]);
}

/// A board with some reflectivity, rotated by an angle about the vertical, with the scanner in front of its middle.
fn board(range: f64, turned: f64, laser_retro: f32, diffuse: [f32; 3]) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig { diffuse, ..Default::default() }).unwrap();
    let config = InstanceConfig {
        shape: Shape::Rectangle { size: [40.0, 40.0] },
        world_from_instance: Pose::from_xyz_rpy(DVec3::X * range, DVec3::new(0.0, -FRAC_PI_2, 0.0))
            * Pose::from_xyz_rpy(DVec3::ZERO, DVec3::X * turned),
        laser_retro,
        material,
        ..Default::default()
    };
    builder.add_instance(&config).unwrap();
    builder
}

#[test]
fn intensity_depends_on_reflectivity_angle_and_range() {
    let table = [AHEAD];
    let config = ScannerConfig::new(Pattern::Table(&table)).range_max_m(250.0);
    let seen = |intensity, scene: &SceneBuilder| still(config.intensity(intensity), scene).2[0];
    for range in [2.0, 17.0, 90.0] {
        for degrees in [0.0_f64, 30.0, 60.0, 80.0] {
            for (retro, reflectivity) in [(80.0, 0.8), (10.0, 0.1), (0.0, 0.4)] {
                let scene = board(range, degrees.to_radians(), retro, [0.3, 0.6, 0.3]);
                let power = reflectivity * degrees.to_radians().cos() / (range * range);
                near(seen(Intensity::Power, &scene), power, 1e-6);
                near(seen(Intensity::Reflectivity, &scene), 100.0 * power * range * range, 1e-6);
                assert_eq!(seen(Intensity::Retro, &scene), retro);
            }
            // Retroreflectors are equally bright at any angle.
            let sign = board(range, degrees.to_radians(), 178.0, [0.0; 3]);
            near(seen(Intensity::Reflectivity, &sign), 178.0, 1e-6);
            near(seen(Intensity::Power, &sign), (1.0 + 99.0 * 78.0 / 155.0) / (range * range), 1e-6);
        }
    }
    // If a plate covers a share of a beam, that share of the light comes back.
    let mut plate = SceneBuilder::new();
    let half = 0.5 * (12.7e-3 + 2.0 * (1.5e-3_f64).tan() * 10.0);
    add_plate(&mut plate, 10.0, 0.1 * half, 50.0);
    let share = places(19).iter().filter(|[left, _]| *left > 0.1).count() as f64 / 19.0;
    let covered = still(config.beam(beam(19)).intensity(Intensity::Reflectivity), &plate).2[0];
    near(covered, 50.0 * share, 1e-4);
    // Of two surfaces with the same share of the beam, the one with the higher reflectivity is the stronger.
    add_plate(&mut plate, 30.0, -5.0, 200.0);
    let both = config.beam(beam(19)).pulse_m(1.0);
    near(still(both, &plate).0[0], 30.0, 1e-6);
    near(still(both.intensity(Intensity::Power), &plate).0[0], 30.0, 1e-6);
    let mut dim = SceneBuilder::new();
    add_plate(&mut dim, 10.0, 0.1 * half, 50.0);
    add_plate(&mut dim, 30.0, -5.0, 60.0);
    near(still(both, &dim).0[0], 30.0, 1e-6);
    near(still(both.intensity(Intensity::Power), &dim).0[0], 10.0, 1e-6);
}

/// Returns with P < 0.9/reach² are lost.
#[test]
fn dark_surfaces_are_lost_at_shorter_ranges_than_bright_ones() {
    let table = [AHEAD];
    let reached = |receiver: Receiver, retro: f32, degrees: f64, weather: Weather| {
        let config = ScannerConfig::new(Pattern::Table(&table)).range_max_m(300.0).weather(weather);
        let config = config.receiver(Some(receiver));
        let (mut low, mut high) = (1.0, 300.0);
        while high - low > 1e-4 {
            let middle = 0.5 * (low + high);
            let scene = board(middle, degrees.to_radians(), retro, [0.0; 3]);
            let is_seen = still(config.returns(Returns::Last), &scene).0[0] > 0.9 * middle as f32;
            let is_seen = is_seen && still(config.returns(Returns::Last), &scene).0[0].is_finite();
            if is_seen { low = middle } else { high = middle }
        }
        low
    };
    let receiver = Receiver::new(120.0);
    let within = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    within(reached(receiver, 90.0, 0.0, Weather::CLEAR), 120.0);
    within(reached(receiver, 10.0, 0.0, Weather::CLEAR), 40.0);
    within(reached(receiver, 90.0, 60.0, Weather::CLEAR), 120.0 * 0.5_f64.sqrt());
    // Sunlight: with three times the noise added, twice as much power is needed.
    within(
        reached(Receiver { background: 3.0, ..receiver }, 90.0, 0.0, Weather::CLEAR),
        120.0 * 0.5_f64.sqrt(),
    );
    // In haze, the range at which r²·e^(2αr) is the same.
    let haze = Weather { visibility_m: 1000.0, ..Weather::CLEAR };
    let range = reached(receiver, 90.0, 0.0, haze);
    let alpha = 20_f64.ln() / 1000.0;
    within(range * (alpha * range).exp(), 120.0);
}

/// From the centre of a ball of 8 m with reflectivity 0.5.
#[test]
fn range_noise_depends_on_the_returned_power() {
    let mut ball = SceneBuilder::new();
    let material = ball.add_material(&MaterialConfig { diffuse: [0.5; 3], ..Default::default() }).unwrap();
    ball.add_instance(&InstanceConfig {
        shape: Shape::Sphere { radius: 8.0 },
        material,
        ..Default::default()
    })
    .unwrap();
    let table = vec![AHEAD; 40_000];
    let receiver = Receiver { resolution_m: 0.09, ..Receiver::new(20.0) };
    let config = ScannerConfig::new(Pattern::Table(&table)).receiver(Some(receiver)).seed(3);
    let snr = 0.5 / 64.0 / (0.9 / 400.0);
    for stddev in [0.0, 0.03] {
        let noise = GaussianNoise::of_stddev(stddev).unwrap();
        let (ranges, ..) = still(config.noise(noise), &ball);
        let variance = ranges.iter().map(|range| (f64::from(*range) - 8.0).powi(2)).sum::<f64>() / 40_000.0;
        let expected = 0.09_f64.powi(2) / (2.0 * snr) + f64::from(stddev).powi(2);
        assert!((variance.sqrt() / expected.sqrt() - 1.0).abs() < 0.02, "{variance} {expected}");
    }
}

/// Hahner et al. 2021, equations 8 to 13, as sums of small steps.
#[test]
fn fog_attenuates_surfaces_and_scatters_light_back() {
    let alpha = 0.06_f64;
    let fog = Weather { visibility_m: 20_f64.ln() / alpha, ..Weather::CLEAR };
    assert!((fog.visibility_m - 49.93).abs() < 0.005 && (fog.extinction_per_m() - alpha).abs() < 1e-12);
    let soft = |range: f64| {
        let steps = 20_000;
        let dt = 40e-9 / f64::from(steps);
        let at = |step| {
            let t = (f64::from(step) + 0.5) * dt;
            let x = range - 0.5 * 299_792_458.0 * t;
            let seen = ((x - 0.9) / 0.1).clamp(0.0, 1.0);
            if x <= 0.9 {
                0.0
            } else {
                (PI * t / 40e-9).sin().powi(2) * (-2.0 * alpha * x).exp() / (x * x) * seen
            }
        };
        (0..steps).map(at).sum::<f64>() * dt
    };
    let ranges = (90..1000).map(|step| 0.01 * f64::from(step));
    let (power, range) = ranges.map(|range| (soft(range), range)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let power = power * (0.046 * alpha / 20_f64.ln()) / (1e-6 / PI);
    println!("fog sends {power:e} back, from {range} m");
    let table = [AHEAD];
    let config = ScannerConfig::new(Pattern::Table(&table)).weather(fog).receiver(Some(Receiver::new(1e6)));
    let config = config.intensity(Intensity::Power).returns(Returns::Several(2)).pulse_m(1.0);
    for metres in [10.0, 20.0, 40.0, 80.0] {
        let scene = board(metres, 0.0, 100.0, [0.0; 3]);
        let (ranges, _, powers) = still(config, &scene);
        near(ranges[0], range, 0.01);
        near(powers[0], power, 2e-3);
        near(ranges[1], metres, 1e-6);
        let hard = (-2.0 * alpha * metres).exp() / (metres * metres);
        near(powers[1], hard, 1e-5);
        let strongest = still(config.returns(Returns::Strongest), &scene).0[0];
        near(strongest, if hard > power { metres } else { range }, 0.01);
    }
    // In front of a wall that is nearer than that, fog has no return; with nothing else in range, it has the only one.
    assert_eq!(still(config, &board(2.0, 0.0, 100.0, [0.0; 3])).0, [2.0, f32::INFINITY]);
    near(still(config, &SceneBuilder::new()).0[0], range, 0.01);
}

/// Marshall and Palmer's drops in a cone of 3 mrad, by their integral over ranges.
#[test]
fn the_number_of_detected_drops_is_as_expected() {
    for (weather, sizes) in [
        (Weather { rain_mm_per_h: 30.0, ..Weather::CLEAR }, DropSizes::rain(30.0).unwrap()),
        (Weather { snow_mm_per_h: 2.0, ..Weather::CLEAR }, DropSizes::snow(2.0).unwrap()),
    ] {
        let table = vec![AHEAD; 200_000];
        let reach = 100.0;
        let config = ScannerConfig::new(Pattern::Table(&table)).weather(weather).intensity(Intensity::Power);
        let config = config.returns(Returns::Several(5)).seed(11);
        let (ranges, _, powers) = still(config, &SceneBuilder::new());
        let least = 0.9 / (reach * reach);
        let drops: Vec<_> = ranges.iter().zip(&powers).filter(|(range, _)| range.is_finite()).collect();
        // The expected number between two ranges whose power is so many times the least.
        let expected = |from: f64, to: f64, times: f64| {
            let steps = 10_000;
            let dr = (to - from) / f64::from(steps);
            let at = |step| {
                let r = from + (f64::from(step) + 0.5) * dr;
                let covered = (times * least * r * r / sizes.reflectivity).sqrt();
                let area = FRAC_PI_2 * 0.5 * (3e-3 * r).powi(2);
                if covered > 1.0 { 0.0 } else { area * sizes.per_m3(1e3 * covered * 3e-3 * r) }
            };
            (0..steps).map(at).sum::<f64>() * dr * table.len() as f64
        };
        for (from, to, times) in [
            (0.0, 1.0, 1.0),
            (1.0, 2.0, 1.0),
            (2.0, 3.0, 1.0),
            (3.0, 9.0, 1.0),
            (0.0, 2.0, 4.0),
            (1.0, 9.0, 2.0),
        ] {
            let is_one = |(range, power): &&(&f32, &f32)| {
                (from..to).contains(&f64::from(**range)) && f64::from(**power) >= times * least
            };
            let (found, expected) = (drops.iter().filter(is_one).count() as f64, expected(from, to, times));
            println!("{from} to {to} m, {times} times: {found} of {expected}");
            // Extinction takes one per cent; the rest of the tolerance is for chance.
            assert!(
                (found - expected).abs() < 0.015 * expected + 4.0 * expected.sqrt(),
                "{found} {expected}"
            );
        }
        assert!(drops.len() > 2000);
    }
    // k = 1.45·30^0.64 dB/km.
    let rain = Weather { rain_mm_per_h: 30.0, ..Weather::CLEAR };
    let db_per_km = 1e4 * rain.extinction_per_m() / 10_f64.ln();
    assert!((db_per_km - 1.45 * 30_f64.powf(0.64)).abs() < 1e-9);
}

#[test]
fn invalid_parameters_are_refused() {
    let table = [AHEAD];
    let plain = ScannerConfig::new(Pattern::Table(&table));
    let said = |config: ScannerConfig<'_>| Scanner::new(config).unwrap_err().to_string();
    let wide = |divergence_rad, aperture_m, rays| said(plain.beam(Beam { divergence_rad, aperture_m, rays }));
    assert_eq!(
        wide([3e-3, f64::NAN], [0.0; 2], 8),
        "divergence_rad of the beam of the scanner is NaN; it must be 0 to 0.2 rad"
    );
    assert!(
        wide([-1e-3, 0.0], [0.0; 2], 8).starts_with("divergence_rad of the beam of the scanner is -0.001")
    );
    assert!(wide([0.0; 2], [0.0, 1.0], 8).starts_with("aperture_m of the beam of the scanner is 1"));
    assert_eq!(
        wide([0.0; 2], [0.0; 2], 20),
        "rays of the beam of the scanner is 20; it must be 1, 7, 8 or 19"
    );
    assert_eq!(
        said(plain.returns(Returns::Several(6))),
        "number of returns of the scanner is 6; it must be 1 to 5"
    );
    assert!(said(plain.returns(Returns::Several(0))).starts_with("number of returns of the scanner is 0"));
    assert_eq!(said(plain.pulse_m(-1.0)), "pulse_m of the scanner is -1; it must be 0 or more, and finite");
    let receiver = |receiver| said(plain.receiver(Some(receiver)));
    let dark = Receiver::new(100.0);
    assert_eq!(
        receiver(Receiver::new(0.0)),
        "reach_m of the receiver of the scanner is 0; it must be more than 0, and finite"
    );
    assert!(
        receiver(Receiver { resolution_m: f64::NAN, ..dark })
            .contains("resolution_m of the receiver of the scanner is NaN")
    );
    assert!(
        receiver(Receiver { background: -1.0, ..dark })
            .contains("background of the receiver of the scanner is -1")
    );
    let air = |weather| said(plain.weather(weather));
    let clear = Weather::CLEAR;
    assert!(
        air(Weather { visibility_m: 0.5, ..clear })
            .contains("visibility_m of the weather of the scanner is 0.5")
    );
    assert!(
        air(Weather { rain_mm_per_h: f64::NAN, ..clear })
            .contains("rain_mm_per_h of the weather of the scanner is NaN")
    );
    assert!(
        air(Weather { snow_mm_per_h: 51.0, ..clear })
            .contains("snow_mm_per_h of the weather of the scanner is 51")
    );
    let endless = plain.range_max_m(f64::INFINITY).weather(Weather { rain_mm_per_h: 1.0, ..clear });
    assert!(
        said(endless)
            .starts_with("range_max_m of the scanner is inf; it must be finite where there is weather")
    );
    // An output for one return is too short for two.
    let scanner = Scanner::new(plain.returns(Returns::Dual)).unwrap();
    let builder = SceneBuilder::new();
    let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(Pose::IDENTITY)));
    let mut memory = WorkspaceBuf::default();
    let short = scanner.sense_in(&mut memory, &scene, &capture, Echoes::new().ranges(&mut [0.0]));
    assert_eq!(short.unwrap_err().to_string(), "the output ranges holds 1 elements; the frame has 2");
}
