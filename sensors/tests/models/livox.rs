//! Livox's presets against the scan tables that Livox published for its simulation: some of their directions, and the
//! distribution of their points.

use belvedere_sensors::scanner::presets::{HAP, MID_70, MID_360};
use belvedere_sensors::scanner::{Pattern, Prisms, Scanner};
use glam::DVec3;

/// Azimuth and elevation in degrees.
fn angles(direction: DVec3) -> [f64; 2] {
    [direction.y.atan2(direction.x).to_degrees(), direction.z.asin().to_degrees()]
}

/// The angle in degrees between a direction and an azimuth and elevation in degrees.
fn off(direction: DVec3, [azimuth, elevation]: [f64; 2]) -> f64 {
    let ((sin, cos), (up, level)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
    direction.angle_between(DVec3::new(cos * level, sin * level, up)).to_degrees()
}

/// The percentages of values between successive edges.
fn shares(values: &[f64], edges: &[f64]) -> Vec<f64> {
    let count = |pair: &[f64]| values.iter().filter(|value| (pair[0]..pair[1]).contains(value)).count();
    edges.windows(2).map(|pair| 100.0 * count(pair) as f64 / values.len() as f64).collect()
}

/// The largest difference of two cumulative distributions given as percentages (Kolmogorov and Smirnov's distance, at
/// the edges).
fn apart(ours: &[f64], theirs: &[f64]) -> f64 {
    let sum = |shares: &[f64], count| shares[..count].iter().sum::<f64>() / 100.0;
    (0..=ours.len()).map(|count| (sum(ours, count) - sum(theirs, count)).abs()).fold(0.0, f64::max)
}

/// Volleys of 4 s, 20 µs apart: first and last laser.
#[test]
fn a_mid_360_has_the_directions_of_its_table() {
    let scanner = Scanner::new(MID_360.config().frame_time_ns(1_000_000_000)).unwrap();
    assert_eq!(scanner.firings(0), 200_000);
    for (volley, first, last) in [
        (0, [268.99, 52.162], [269.0, 43.848]),
        (25_000, [197.11, 48.811], [191.0, 46.782]),
        (50_000, [120.48, 44.328], [117.28, 51.576]),
        (75_000, [41.872, 45.001], [46.371, 50.779]),
        (100_000, [326.13, 49.96], [331.64, 45.723]),
        (125_000, [254.88, 51.987], [253.23, 43.99]),
        (150_000, [182.16, 47.726], [175.83, 47.841]),
        (175_000, [104.76, 43.963], [103.1, 52.02]),
        (199_950, [92.377, 43.73], [91.075, 51.987]),
    ] {
        for (laser, expected) in [(0, first), (3, last)] {
            let firing = scanner.firing(volley / 50_000, (volley % 50_000) as usize * 4 + laser);
            assert_eq!(firing.laser as usize, laser);
            assert!((firing.time_s - 2e-5 * (volley % 50_000) as f64).abs() < 1e-12);
            assert!(
                off(firing.direction, expected) < 0.012,
                "volley {volley}: {:?}",
                angles(firing.direction)
            );
        }
    }
}

/// The distribution of the points of 4 s, and the share of all cells of 1° that have a point after 0.1, 0.5, 1 and 4 s.
#[test]
fn a_mid_360_has_the_coverage_of_its_table() {
    let scanner = Scanner::new(MID_360.config().frame_time_ns(1_000_000_000)).unwrap();
    let (mut elevations, mut seen, mut covered) = (Vec::new(), vec![false; 360 * 58], Vec::new());
    for frame in 0..4 {
        for index in 0..200_000 {
            let [azimuth, elevation] = angles(scanner.firing(frame, index).direction);
            if (-6.0..52.0).contains(&elevation) {
                seen[azimuth.rem_euclid(360.0) as usize % 360 * 58 + (elevation + 6.0) as usize] = true;
            }
            elevations.push(elevation);
            if [20_000, 100_000, 200_000, 800_000].contains(&elevations.len()) {
                covered.push(seen.iter().filter(|seen| **seen).count() as f64 / seen.len() as f64);
            }
        }
    }
    let edges = [-7.5, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 52.5];
    let published =
        [1.859, 13.202, 9.314, 8.478, 8.845, 9.177, 8.824, 7.952, 7.217, 7.066, 8.774, 8.253, 1.04];
    for (ours, theirs) in shares(&elevations, &edges).iter().zip(published) {
        assert!((ours - theirs).abs() < 0.02, "{ours} % instead of {theirs} %");
    }
    for (ours, theirs) in covered.iter().zip([0.6349, 0.969, 0.9764, 0.977]) {
        assert!((ours - theirs).abs() < 0.003, "{covered:?}");
    }
    let least = elevations.iter().copied().fold(f64::MAX, f64::min);
    let most = elevations.iter().copied().fold(f64::MIN, f64::max);
    assert!((least + 7.212).abs() < 0.01 && (most - 52.164).abs() < 0.01, "{least} {most}");
}

/// One of its lasers at whole milliseconds, at which the table has had a whole number of firings.
#[test]
fn a_hap_has_the_directions_of_its_table() {
    let Pattern::Prisms(hap) = HAP.pattern else { panic!() };
    for (time_ms, laser, expected) in [
        (1, 3, [19.638, -4.708]),
        (4, 1, [-58.782, 4.163]),
        (13, 4, [-20.245, 8.31]),
        (19, 4, [-42.207, -0.344]),
        (28, 1, [-30.657, 11.493]),
        (36, 5, [-20.736, 6.344]),
        (45, 2, [13.948, 7.217]),
        (54, 5, [49.646, 0.168]),
        (63, 2, [35.002, -9.601]),
        (72, 5, [-3.356, -12.7]),
        (81, 2, [-41.613, -9.039]),
        (100, 1, [19.787, 6.929]),
    ] {
        let lasers_rad = &hap.lasers_rad[laser..=laser];
        let one = Prisms { volley_time_ns: 1_000_000, laser_time_ns: 0, lasers_rad, ..hap };
        let scanner =
            Scanner::new(HAP.config().frame_time_ns(1_000_000_000).pattern(Pattern::Prisms(one))).unwrap();
        let direction = scanner.firing(0, time_ms).direction;
        assert!(off(direction, expected) < 0.02, "{time_ms} ms: {:?}", angles(direction));
    }
}

/// The distribution of the points of a second: the table, which has more points in the middle, differs by at most 2.1
/// %.
#[test]
fn a_hap_has_the_coverage_of_its_table() {
    let scanner = Scanner::new(HAP.config().frame_time_ns(1_000_000_000)).unwrap();
    assert_eq!(scanner.firing(0, 7).laser, 1);
    assert!((scanner.firing(0, 7).time_s - 15.486e-6).abs() < 1e-12);
    let all: Vec<_> =
        (0..scanner.firings(0)).map(|index| angles(scanner.firing(0, index).direction)).collect();
    let across = [-61.0, -50.0, -40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 61.0];
    let up = [-13.3, -10.0, -8.0, -6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 13.3];
    let published = [
        [2.88, 5.94, 11.01, 9.26, 10.44, 10.48, 10.47, 10.42, 9.23, 10.93, 5.99, 2.97],
        [5.18, 6.23, 6.87, 7.64, 10.39, 13.63, 13.56, 10.31, 7.64, 6.91, 6.31, 5.31],
    ];
    for (axis, (edges, most)) in [(across, 60.25), (up, 13.251)].into_iter().enumerate() {
        let values: Vec<f64> = all.iter().map(|angles| angles[axis]).collect();
        let off = apart(&shares(&values, &edges), &published[axis]);
        assert!(off < 0.025, "{off}");
        let widest = values.iter().fold(0.0, |widest: f64, value| widest.max(value.abs()));
        assert!((widest - most).abs() < 0.02, "{widest}");
    }
}

/// One point every 10 µs, the first of the table 10 µs after time 0; and the distribution of their angles from the
/// axis.
#[test]
fn a_mid_70_has_the_directions_of_its_table() {
    let scanner = Scanner::new(MID_70.config().frame_time_ns(1_000_000_000)).unwrap();
    for (firing, expected) in [
        (1, [-35.2147, -0.0242]),
        (1000, [-7.6466, -34.4679]),
        (10_000, [-12.8405, -31.7446]),
        (50_000, [-13.5003, 3.0817]),
        (123_456, [-33.0207, -11.1057]),
        (200_000, [4.8687, -7.9047]),
        (300_000, [-1.0889, 32.7562]),
        (400_000, [-15.0414, -22.1027]),
    ] {
        let direction = scanner.firing(firing / 100_000, (firing % 100_000) as usize).direction;
        assert!(off(direction, expected) < 1e-3, "{firing}: {:?}", angles(direction));
    }
    let from_axis: Vec<f64> = (0..400_000)
        .map(|firing| scanner.firing(firing / 100_000, (firing % 100_000) as usize).direction.x.acos())
        .map(f64::to_degrees)
        .collect();
    let edges = [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 35.3];
    let published = [10.75, 10.82, 10.99, 11.35, 12.11, 13.96, 24.19, 5.82];
    for (ours, theirs) in shares(&from_axis, &edges).iter().zip(published) {
        assert!((ours - theirs).abs() < 0.02, "{ours} % instead of {theirs} %");
    }
}
