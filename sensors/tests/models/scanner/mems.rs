//! Mirrors that oscillate about two axes, against reflection with glam's rotations and against closed forms.

use belvedere_sensors::scanner::{Mems, MirrorAxis, Pattern, Scanner, ScannerConfig, Wave};
use core::f64::consts::TAU;
use glam::{DQuat, DVec3};

const SINE: MirrorAxis =
    MirrorAxis { amplitude_rad: 0.2, cycles_per_min: 96_000, phase_rad: 0.3, wave: Wave::Sine };
const EVEN: MirrorAxis =
    MirrorAxis { amplitude_rad: 0.1, cycles_per_min: 600, phase_rad: 0.0, wave: Wave::Triangle };
const MEMS: Mems<'static> = Mems { firing_time_ns: 7001, incidence_rad: 0.4, axes: &[SINE, EVEN] };

fn config(mems: Mems<'_>) -> ScannerConfig<'_> {
    ScannerConfig::new(Pattern::Mems(mems)).frame_time_ns(100_000_000)
}

/// The angle of the mirror at a time, implemented independently of the library.
fn turned(axis: MirrorAxis, time_s: f64) -> f64 {
    let angle = TAU * f64::from(axis.cycles_per_min) / 60.0 * time_s + axis.phase_rad;
    axis.amplitude_rad
        * match axis.wave {
            Wave::Sine => angle.sin(),
            Wave::Triangle => angle.sin().asin() * 4.0 / TAU,
        }
}

#[test]
fn beams_are_reflected_by_a_mirror_in_a_frame() {
    let scanner = Scanner::new(config(MEMS)).unwrap();
    let mut all = 0;
    for frame in [0, 1, 7, 12_345] {
        for index in (0..scanner.firings(frame)).step_by(97) {
            let firing = scanner.firing(frame, index);
            let tick = (frame * 100_000_000).div_ceil(7001) + index as u64;
            let in_frame_ns = tick * 7001 - frame * 100_000_000;
            assert!((firing.time_s - in_frame_ns as f64 * 1e-9).abs() < 1e-12);
            // Whole minutes are a whole number of cycles.
            let time_s = (tick * 7001 % 60_000_000_000) as f64 * 1e-9;
            // A rotation about −y is upwards.
            let frame_turned = DQuat::from_rotation_y(-turned(EVEN, time_s));
            let mirror =
                frame_turned * DQuat::from_rotation_y(-0.4) * DQuat::from_rotation_z(turned(SINE, time_s));
            let normal = mirror * DVec3::X;
            let beam = DQuat::from_rotation_y(-0.8) * DVec3::NEG_X;
            let expected = beam.reflect(normal);
            assert!((firing.direction - expected).length() < 1e-9, "{frame} {index}");
            assert!((firing.direction.length() - 1.0).abs() < 1e-12);
            all += 1;
        }
    }
    assert!(all > 500);
}

/// A beam along the normal turns by twice the angle of the mirror, and rows of a uniform upward motion are equally
/// spaced.
#[test]
fn a_beam_along_the_normal_turns_twice_as_far() {
    let still = MirrorAxis { amplitude_rad: 0.0, ..SINE };
    let axes = [still, EVEN];
    let scanner = Scanner::new(config(Mems { incidence_rad: 0.0, axes: &axes, ..MEMS })).unwrap();
    let up: Vec<f64> =
        (0..scanner.firings(0)).map(|index| scanner.firing(0, index).direction.z.asin()).collect();
    let most = up.iter().copied().fold(0.0, f64::max);
    assert!((most - 0.2).abs() < 1e-4 && up.iter().all(|angle| angle.abs() <= 0.2), "{most}");
    // It takes a quarter of a tenth of a second to the top.
    let step = 0.2 / 0.025 * 7001e-9;
    let quarter = (0.025_f64 / 7001e-9) as usize;
    assert!(up[..quarter].windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 1e-12));
}

/// Two sines of 10 and 10.5 cycles per second draw the same figure every two seconds.
#[test]
fn a_lissajous_figure_repeats() {
    let across = MirrorAxis { cycles_per_min: 630, ..SINE };
    let up = MirrorAxis { cycles_per_min: 600, wave: Wave::Sine, ..EVEN };
    let axes = [across, up];
    let scanner = Scanner::new(config(Mems { firing_time_ns: 10_000, axes: &axes, ..MEMS })).unwrap();
    let mut apart: f64 = 0.0;
    for index in (0..scanner.firings(0)).step_by(101) {
        let [now, soon, again] = [3, 13, 23].map(|frame| scanner.firing(frame, index).direction);
        assert_eq!(now, again);
        apart = apart.max((now - soon).length());
    }
    assert!(apart > 0.1, "{apart}");
}

#[test]
fn impossible_mirrors_are_refused() {
    let said = |mems: Mems<'_>| Scanner::new(config(mems)).unwrap_err().to_string();
    let axis = |amplitude_rad| MirrorAxis { amplitude_rad, ..SINE };
    let swinging = |axes: [MirrorAxis; 2]| said(Mems { axes: &axes, ..MEMS });
    assert!(said(Mems { firing_time_ns: 0, ..MEMS }).contains("firing_time_ns of the scanner is 0"));
    assert!(swinging([axis(f64::NAN), EVEN]).contains("amplitude_rad of the scanner is NaN"));
    assert!(swinging([SINE, axis(1.6)]).contains("amplitude_rad of the scanner is 1.6"));
    assert!(
        swinging([MirrorAxis { phase_rad: 7.0, ..SINE }, EVEN]).contains("phase_rad of the scanner is 7")
    );
    assert!(swinging([axis(1.2), EVEN]).contains("incidence_rad of the scanner is 0.4"));
    assert!(said(Mems { incidence_rad: -0.1, ..MEMS }).contains("incidence_rad of the scanner is -0.1"));
}
