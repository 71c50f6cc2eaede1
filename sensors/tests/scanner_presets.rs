//! Presets of scanners against the numbers of their makers.

use belvedere_sensors::scanner::presets::{self, Preset};
use belvedere_sensors::scanner::{Laser, Pattern, Scanner};

fn lasers(preset: &Preset) -> &'static [Laser] {
    let Pattern::Spinning(head) = preset.pattern else { panic!() };
    head.lasers
}

/// Calibrated units of each size: highest and lowest beam, azimuths of four lasers (clockwise), n; and how far such units
/// are from the middle of their kind. Of one OS1-32, every angle is known: each fourth of 128.
#[test]
fn ousters_heads_are_as_units_of_theirs() {
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
        // The smaller ones have some of them, and always the lowest.
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

/// A column every so many nanoseconds: 512, 1024 or 2048 of them to a turn, the first one looking back at the plug.
#[test]
fn ousters_columns_are_those_of_lidar_mode() {
    for (columns, rate_hz, column_ns) in [
        (512, 10.0, 195_312.5),
        (512, 20.0, 97_656.25),
        (1024, 10.0, 97_656.25),
        (1024, 20.0, 48_828.125),
        (2048, 10.0, 48_828.125),
    ] {
        let preset = presets::OS1_64.in_mode(Some(columns), Some(rate_hz)).unwrap();
        let scanner = Scanner::new(preset.config((1e9 / rate_hz) as u64)).unwrap();
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

/// Every choice of every preset is a scanner, called by its name.
#[test]
fn all_presets_are_scanners() {
    for preset in presets::ALL {
        assert_eq!(presets::named(preset.name), Some(*preset));
        let rates = preset.modes.iter().map(|mode| (Some(mode.columns.at_angles() as u32), mode.rate_hz));
        for (columns, rate_hz) in rates.chain([(None, preset.rate_hz)]) {
            let preset = preset.in_mode(columns, Some(rate_hz)).unwrap();
            assert!(preset.rates_hz[0] <= rate_hz && rate_hz <= preset.rates_hz[1]);
            let scanner = Scanner::new(preset.config((1e9 / rate_hz) as u64)).unwrap();
            assert!(scanner.firings(3) > 100, "{}", preset.name);
        }
    }
    // 190° by steps of 1/6° to 1°, ahead in the middle.
    for mode in presets::LMS_511.modes {
        let preset =
            presets::LMS_511.in_mode(Some(mode.columns.at_angles() as u32), Some(mode.rate_hz)).unwrap();
        let scanner = Scanner::new(preset.config((1e9 / mode.rate_hz) as u64)).unwrap();
        let angle = |index| {
            let direction = scanner.firing(1, index).direction;
            direction.y.atan2(direction.x).to_degrees()
        };
        let last = scanner.firings(1) - 1;
        assert!((angle(0) + 95.0).abs() < 1e-9 && (angle(last) - 95.0).abs() < 1e-9, "{}", angle(last));
        assert!(angle(last / 2).abs() < 0.34);
    }
}
