//! Scanner presets against the figures of their makers.

use belvedere_sensors::scanner::presets::{self, Preset};
use belvedere_sensors::scanner::{Laser, Pattern, Raster, Scanner, ScannerConfig};

fn lasers(preset: &Preset) -> &'static [Laser] {
    let Pattern::Spinning(head) = preset.pattern else { panic!() };
    head.lasers
}

/// Calibrated units of each size: highest and lowest beam, azimuths of four lasers (clockwise), n; and the deviation of
/// such units from the mean of their kind. For one OS1-32 all angles are known: every fourth of 128.
#[test]
fn ousters_presets_are_close_to_calibrated_units() {
    for (presets, [high, low], azimuths, beam_mm, up_mm, [within, across]) in [
        (
            [presets::OS0_128, presets::OS0_64, presets::OS0_32],
            [45.75, -46.26],
            [10.77, 3.59, -3.65, -10.82],
            27.67,
            36.18,
            [0.22, 0.5],
        ),
        (
            [presets::OS1_128, presets::OS1_64, presets::OS1_32],
            [21.51, -21.44],
            [4.25, 1.42, -1.42, -4.25],
            15.806,
            36.18,
            [0.03, 0.05],
        ),
        (
            [presets::OS2_128, presets::OS2_64, presets::OS2_32],
            [10.76, -11.09],
            [2.08, 0.70, -0.68, -2.06],
            13.762,
            78.296,
            [0.02, 0.05],
        ),
    ] {
        let all = lasers(&presets[0]);
        assert_eq!(all.len(), 128);
        let elevation = |row: usize| all[row].elevation_rad.to_degrees();
        assert!(
            (elevation(0) - high).abs() < within && (elevation(127) - low).abs() < within,
            "{}",
            elevation(0)
        );
        assert!((1..128).all(|row| elevation(row) < elevation(row - 1)));
        for (row, azimuth) in azimuths.into_iter().enumerate() {
            assert!((-all[row].azimuth_rad.to_degrees() - azimuth).abs() < across, "{:?}", all[row]);
        }
        for origin in all.iter().map(|laser| laser.origin_m) {
            assert!((origin[0] * 1e3 - beam_mm).abs() < 1e-9 && (origin[2] * 1e3 - up_mm).abs() < 1e-9);
        }
        // The smaller models have some of the lasers, always including the lowest.
        for (preset, step) in [(presets[1], 2), (presets[2], 4)] {
            let some = all.iter().skip(step - 1).step_by(step);
            assert!(lasers(&preset).iter().eq(some), "{}", preset.name);
            assert_eq!(lasers(&preset).len(), 128 / step);
        }
    }
    let small = lasers(&presets::OS1_32);
    assert!((small[0].elevation_rad.to_degrees() - 20.55).abs() < 0.04);
    assert!((small[31].elevation_rad.to_degrees() + 21.48).abs() < 0.05);
    assert!(small.iter().all(|laser| (laser.azimuth_rad.to_degrees() - 4.25).abs() < 1e-9));
}

/// One column per so many nanoseconds: 512, 1024 or 2048 per turn, the first pointing backwards to the plug.
#[test]
fn ousters_columns_follow_lidar_mode() {
    for (columns, rate_hz, column_ns) in [
        (512, 10.0, 195_312.5),
        (512, 20.0, 97_656.25),
        (1024, 10.0, 97_656.25),
        (1024, 20.0, 48_828.125),
        (2048, 10.0, 48_828.125),
    ] {
        let preset = presets::OS1_64.in_mode(Some(columns), Some(rate_hz)).unwrap();
        let scanner = Scanner::new(preset.config()).unwrap();
        assert_eq!(scanner.firings(5), columns as usize * 64);
        for (column, laser) in [(0, 0), (1, 63), (columns as usize - 1, 7)] {
            let firing = scanner.firing(5, column * 64 + laser);
            assert!((firing.time_s * 1e9 - column_ns * column as f64).abs() < 1e-3);
            let turned = core::f64::consts::PI - core::f64::consts::TAU * column as f64 / f64::from(columns);
            assert!((firing.origin.x - 0.015_806 * turned.cos()).abs() < 1e-12);
            assert!((firing.origin.y - 0.015_806 * turned.sin()).abs() < 1e-12);
        }
    }
    assert!(presets::OS1_64.in_mode(Some(2048), Some(20.0)).is_none());
    assert!(presets::OS1_64.in_mode(None, Some(15.0)).is_none());
    assert_eq!(presets::OS0_32.in_mode(None, None), Some(presets::OS0_32));
    assert_eq!(presets::VLP_16.in_mode(None, Some(12.5)).map(|preset| preset.rate_hz), Some(12.5));
    assert!(presets::VLP_16.in_mode(Some(1800), None).is_none());
}

/// Groups of eight lasers, one every 2.665 µs, and elevations that are 0.11° apart in the middle.
#[test]
fn a_vls_128_fires_eight_at_once() {
    let all = lasers(&presets::VLS_128);
    for (id, laser) in all.iter().enumerate() {
        let group = id / 8 + usize::from(id >= 64);
        assert!((laser.time_s - 2.665e-6 * group as f64).abs() < 1e-12);
        assert!((laser.azimuth_rad - all[id % 8].azimuth_rad).abs() < 1e-15);
        assert!((laser.origin_m[2] + 0.058_63 * laser.elevation_rad.tan()).abs() < 1e-8);
    }
    assert!((all[0].azimuth_rad + all[7].azimuth_rad).abs() < 1e-15);
    let mut elevations: Vec<f64> = all.iter().map(|laser| laser.elevation_rad.to_degrees()).collect();
    elevations.sort_unstable_by(f64::total_cmp);
    assert!((elevations[0] + 25.0).abs() < 1e-9 && (elevations[127] - 15.0).abs() < 1e-9);
    let steps: Vec<f64> = elevations.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(steps.iter().all(|step| *step > 0.109));
    assert_eq!(steps.iter().filter(|step| (**step - 0.11).abs() < 1e-9).count(), 103);
    let scanner = Scanner::new(presets::VLS_128.config()).unwrap();
    assert!((scanner.firing(0, 128 * 1000 + 127).time_s - 53.3e-3 - 2.665e-6 * 16.0).abs() < 1e-12);
}

/// A cone of 70.4°, one point every 10 µs, and a different path in each frame: 10.7 % of the points are within 5° of
/// the axis.
#[test]
fn a_mid_70_draws_a_rosette() {
    let scanner = Scanner::new(presets::MID_70.config().frame_time_ns(1_000_000_000)).unwrap();
    assert_eq!(scanner.firings(0), 100_000);
    let angle = |index| scanner.firing(0, index).direction.x.acos().to_degrees();
    let (mut most, mut within) = (0.0_f64, 0);
    for index in 0..100_000 {
        most = most.max(angle(index));
        within += u32::from(angle(index) < 5.0);
        assert!((scanner.firing(0, index).time_s - 1e-5 * index as f64).abs() < 1e-12);
    }
    assert!(
        (most - 35.2).abs() < 0.02 && (f64::from(within) / 1e5 - 0.1075).abs() < 0.002,
        "{most} {within}"
    );
    let Pattern::Rosette(rosette) = presets::MID_70.pattern else { panic!() };
    assert!((rosette.half_angle_rad().unwrap().to_degrees() - most).abs() < 0.02);
}

/// Rows from the top down, each from left to right, at the same time or one after the other.
#[test]
fn a_raster_fires_like_the_rows_of_a_picture() {
    let scanner = Scanner::new(presets::HFL_110.config()).unwrap();
    assert_eq!(scanner.firings(7), 128 * 32);
    for (index, azimuth, elevation, row) in [
        (0, 59.531_25, 14.531_25, 0),
        (127, -59.531_25, 14.531_25, 0),
        (31 * 128, 59.531_25, -14.531_25, 31),
        (128 + 64, -0.468_75, 13.593_75, 1),
    ] {
        let firing = scanner.firing(7, index);
        assert_eq!((firing.laser, firing.time_s), (row, 0.0));
        assert!((firing.direction.y.atan2(firing.direction.x).to_degrees() - azimuth).abs() < 1e-9);
        assert!((firing.direction.z.asin().to_degrees() - elevation).abs() < 1e-9);
    }
    let swung = Raster { pixels: [4, 3], field_rad: [1.0, 0.5], pixel_time_ns: 1000, row_time_ns: 5000 };
    let config = ScannerConfig::new(Pattern::Raster(swung)).frame_time_ns(20_000);
    let scanner = Scanner::new(config).unwrap();
    assert!((scanner.firing(0, 11).time_s - 13e-6).abs() < 1e-15);
    for (wrong, parameter) in [
        (Raster { pixels: [0, 3], ..swung }, "pixels"),
        (Raster { field_rad: [f64::NAN, 1.0], ..swung }, "field_rad"),
        (Raster { field_rad: [1.0, 3.2], ..swung }, "field_rad"),
        (Raster { row_time_ns: 2999, ..swung }, "row_time_ns"),
        (Raster { row_time_ns: 8500, ..swung }, "frame_time_ns"),
    ] {
        let refused = Scanner::new(config.pattern(Pattern::Raster(wrong))).unwrap_err();
        assert_eq!(refused.parameter, parameter, "{wrong:?}");
    }
}

/// Every mode of every preset is a valid scanner, found by its name.
#[test]
fn all_presets_are_scanners() {
    for preset in presets::ALL {
        assert_eq!(presets::named(preset.name), Some(*preset));
        let rates = preset.modes.iter().map(|mode| (Some(mode.columns.at_angles() as u32), mode.rate_hz));
        for (columns, rate_hz) in rates.chain([(None, preset.rate_hz)]) {
            let preset = preset.in_mode(columns, Some(rate_hz)).unwrap();
            assert!(preset.rates_hz[0] <= rate_hz && rate_hz <= preset.rates_hz[1]);
            let scanner = Scanner::new(preset.config()).unwrap();
            assert!(scanner.firings(3) > 100, "{}", preset.name);
        }
    }
    // 190° in steps of 1/6° to 1°, with the middle ahead.
    for mode in presets::LMS_511.modes {
        let preset =
            presets::LMS_511.in_mode(Some(mode.columns.at_angles() as u32), Some(mode.rate_hz)).unwrap();
        let scanner = Scanner::new(preset.config()).unwrap();
        let angle = |index| {
            let direction = scanner.firing(1, index).direction;
            direction.y.atan2(direction.x).to_degrees()
        };
        let last = scanner.firings(1) - 1;
        assert!((angle(0) + 95.0).abs() < 1e-9 && (angle(last) - 95.0).abs() < 1e-9, "{}", angle(last));
        assert!(angle(last / 2).abs() < 0.34);
    }
}
