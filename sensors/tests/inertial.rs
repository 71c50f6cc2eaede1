//! Readings of inertial units: Allan deviations against the closed forms of the processes, and errors computed by hand.

use belvedere_sensors::imu::{Imu, ImuConfig, InertialReading, presets};
use belvedere_sensors::noise::{Instrument, InstrumentConfig, Stream};
use glam::DVec3;

const STREAM: Stream = Stream { seed: 3, sensor: 5, frame: 0, channel: 18 };

/// Samples of an instrument at rest, axis by axis.
fn at_rest(config: &InstrumentConfig<3>, period_s: f64, count: usize) -> [Vec<f64>; 3] {
    let instrument = Instrument::new(*config).unwrap();
    let mut state = instrument.start(&STREAM);
    let mut axes = [(); 3].map(|()| Vec::with_capacity(count));
    for frame in 0..count as u64 {
        let read = instrument.measure([0.0; 3], period_s, &Stream { frame, ..STREAM }, &mut state);
        axes.iter_mut().zip(read).for_each(|(axis, value)| axis.push(value));
    }
    axes
}

/// The overlapping Allan deviation over `m` samples, of all axes together: D. W. Allan's two-sample variance of means.
fn allan_deviation(axes: &[Vec<f64>; 3], m: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for samples in axes {
        let mut sums = vec![0.0];
        for sample in samples {
            sums.push(sums.last().unwrap() + sample);
        }
        for first in 0..=samples.len() - 2 * m {
            let difference = (sums[first + 2 * m] - 2.0 * sums[first + m] + sums[first]) / m as f64;
            sum += 0.5 * difference * difference;
            count += 1.0;
        }
    }
    (sum / count).sqrt()
}

/// The Allan deviation of a Gauss–Markov process with driving density q.
fn gauss_markov(q: f64, tau: f64, t: f64) -> f64 {
    let x = t / tau;
    q * tau / t.sqrt() * (1.0 - (3.0 - 4.0 * (-x).exp() + (-2.0 * x).exp()) / (2.0 * x)).sqrt()
}

fn assert_near(read: f64, expected: f64, relative: f64, what: &str) {
    assert!((read / expected - 1.0).abs() < relative, "{what}: {read:e}, not {expected:e}");
}

#[test]
fn white_noise_reads_its_density_at_one_second_at_any_rate() {
    let density = presets::adis16448().gyro.density;
    for (rate, seconds) in [(100, 4000), (25, 8000)] {
        let config = InstrumentConfig::default().density(density);
        let axes = at_rest(&config, 1.0 / f64::from(rate), (rate * seconds) as usize);
        let at = |times: f64| allan_deviation(&axes, (times * f64::from(rate)) as usize);
        let (tenth, one, four) = (at(0.2), at(1.0), at(4.0));
        assert_near(one, density[0], 0.03, "at 1 s");
        let slope = (four / tenth).ln() / 20.0_f64.ln();
        assert!((slope + 0.5).abs() < 0.02, "the slope is {slope}");
    }
    // A standard deviation per sample does not depend on the rate; variances add up.
    let both = InstrumentConfig::<3>::default().density([0.3; 3]).stddev([0.4; 3]);
    assert!((both.white_stddev(1.0)[0] - 0.5).abs() < 1e-15 && both.white_stddev(0.0) == [0.4; 3]);
}

#[test]
fn a_drifting_bias_rises_levels_off_and_falls() {
    let (drift, tau) = (0.02, 2.0);
    let config = InstrumentConfig::default().drift([drift; 3]).drift_time_s([tau; 3]);
    let axes = at_rest(&config, 0.05, 600_000);
    for t in [0.2, 0.5, 1.0, 2.0, 1.89 * tau, 8.0, 20.0] {
        let m = (t / 0.05_f64).round();
        let read = allan_deviation(&axes, m as usize);
        assert_near(read, gauss_markov(drift, tau, m * 0.05), 0.03, &format!("over {t} s"));
    }
    // This maximum is reported as bias instability.
    assert_near(gauss_markov(drift, tau, 1.89 * tau), 0.4365 * drift * tau.sqrt(), 0.001, "the summit");

    // Without a correlation time it is a random walk: the slope is +½ at any time, and the deviation after t is q√t.
    let axes = at_rest(&InstrumentConfig::default().drift([drift; 3]), 0.05, 600_000);
    for t in [1.0, 4.0, 20.0] {
        let read = allan_deviation(&axes, (t / 0.05) as usize);
        assert_near(read, drift * (t / 3.0_f64).sqrt(), 0.05, &format!("walk over {t} s"));
    }
}

#[test]
fn a_drifting_bias_is_the_same_process_for_any_period() {
    let (drift, tau) = (0.3, 1.5);
    let config = InstrumentConfig::<3>::default().drift([drift; 3]).drift_time_s([tau; 3]);
    let instrument = Instrument::new(config).unwrap();
    for period_s in [0.01, 0.7, 50.0] {
        // Far from the start, its variance is q²τ/2, whatever the steps.
        let (mut sum, runs) = (0.0, 2000);
        for sensor in 0..runs {
            let stream = Stream { sensor, ..STREAM };
            let mut state = instrument.start(&stream);
            for frame in 0..(8.0 * tau / period_s).ceil() as u64 {
                instrument.measure([0.0; 3], period_s, &Stream { frame, ..stream }, &mut state);
            }
            sum += state.drift.iter().map(|bias| bias * bias).sum::<f64>() / 3.0;
        }
        assert_near(
            sum / f64::from(runs),
            0.5 * drift * drift * tau,
            0.06,
            &format!("steps of {period_s} s"),
        );
    }
}

#[test]
fn scale_misalignment_steps_and_limits_are_exact() {
    let config = InstrumentConfig::default()
        .sensitivity([[1.0, 0.01, -0.02], [0.0, 1.0, 0.03], [0.0, 0.0, 1.0]])
        .scale_errors([0.1, -0.1, 0.0])
        .mean([0.5, 0.0, 0.0]);
    let instrument = Instrument::new(config).unwrap();
    let mut state = instrument.start(&STREAM);
    let read = instrument.measure([1.0, 2.0, -3.0], 0.01, &STREAM, &mut state);
    for (value, by_hand) in read.into_iter().zip([1.1 + 0.02 + 0.06 + 0.5, 1.8 - 0.09, -3.0]) {
        assert!((value - by_hand).abs() < 1e-15, "{read:?}");
    }
    let coarse =
        Instrument::new(InstrumentConfig::default().precision([0.25, 0.0, 0.25]).limit(2.0)).unwrap();
    let read = coarse.measure([0.3, 0.3, -7.0], 0.01, &STREAM, &mut coarse.start(&STREAM));
    assert_eq!(read, [0.25, 0.3, -2.0]);
    assert!(Instrument::new(InstrumentConfig::<1>::default()).unwrap().config().is_exact());
}

#[test]
fn a_run_has_a_bias_of_either_sign() {
    let config = InstrumentConfig::<3>::default().bias_mean([2.0; 3]).bias_stddev([0.1; 3]);
    let instrument = Instrument::new(config).unwrap();
    let runs = |sensor| instrument.start(&Stream { sensor, ..STREAM });
    let all: Vec<f64> = (0..1000).flat_map(|sensor| runs(sensor).bias).collect();
    let above = all.iter().filter(|bias| **bias > 0.0).count();
    assert!((1400..1600).contains(&above), "{above}");
    let sizes: f64 = all.iter().map(|bias| bias.abs()).sum::<f64>() / 3000.0;
    let spread = (all.iter().map(|bias| (bias.abs() - sizes).powi(2)).sum::<f64>() / 3000.0).sqrt();
    assert!((sizes - 2.0).abs() < 0.01 && (spread - 0.1).abs() < 0.006, "{sizes} {spread}");
    // Frames do not change it, and each axis has its own.
    let mut state = runs(7);
    let first = instrument.measure([0.0; 3], 0.1, &Stream { frame: 1, sensor: 7, ..STREAM }, &mut state);
    let later = instrument.measure([0.0; 3], 0.1, &Stream { frame: 9, sensor: 7, ..STREAM }, &mut state);
    assert!(first == later && first[0] != first[1]);
}

/// The biases of 90,000 instruments with neighbouring seeds, sensors and channels. For each of about 30 numbers, chance
/// exceeds the limit once in 10,000 times.
#[test]
fn biases_of_runs_are_normal_and_independent() {
    const EACH: usize = 300;
    let instrument = Instrument::new(InstrumentConfig::<3>::default().bias_stddev([1.0; 3])).unwrap();
    let drawn = |seed: usize, sensor: usize, channel: u16| {
        instrument.start(&Stream { seed: seed as u64, sensor: sensor as u32, frame: 0, channel }).bias
    };
    let gyros: Vec<[f64; 3]> = (0..EACH * EACH).map(|i| drawn(i / EACH, i % EACH, 18)).collect();
    let accelerometers: Vec<[f64; 3]> = (0..EACH * EACH).map(|i| drawn(i / EACH, i % EACH, 19)).collect();
    let n = (EACH * EACH) as f64;
    for axis in 0..3 {
        let mut sorted: Vec<f64> = gyros.iter().map(|bias| bias[axis]).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let mean = sorted.iter().sum::<f64>() / n;
        let variance = sorted.iter().map(|bias| bias * bias).sum::<f64>() / n;
        assert!(mean.abs() < 3.9 / n.sqrt(), "axis {axis}: mean {mean}");
        assert!((variance - 1.0).abs() < 3.9 * (2.0 / n).sqrt(), "axis {axis}: variance {variance}");
        let distance = sorted.iter().enumerate().fold(0.0_f64, |farthest, (index, bias)| {
            let below = 0.5 * libm::erfc(-bias / std::f64::consts::SQRT_2);
            farthest.max(below - index as f64 / n).max((index + 1) as f64 / n - below)
        });
        assert!(distance * n.sqrt() < 2.23, "axis {axis}: {}", distance * n.sqrt());
        // The number beyond 3 sigma: 243 are expected, with a standard deviation of 15.6.
        let far = sorted.iter().filter(|bias| bias.abs() > 3.0).count();
        assert!((182..304).contains(&far), "axis {axis}: {far}");
    }
    let near = |what: &str, pairs: &mut dyn Iterator<Item = (f64, f64)>| {
        let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (a, b)| (sum + a * b, count + 1.0));
        assert!(f64::abs(sum) < 3.9 * f64::sqrt(count), "{what}: {}", sum / count);
    };
    for axis in 0..3 {
        let of = |index: usize| gyros[index][axis];
        near("sensors", &mut (0..EACH * EACH - 1).map(|i| (of(i), of(i + 1))));
        near("seeds", &mut (0..EACH * (EACH - 1)).map(|i| (of(i), of(i + EACH))));
        near("channels", &mut (0..EACH * EACH).map(|i| (of(i), accelerometers[i][axis])));
        near("axes", &mut (0..EACH * EACH).map(|i| (of(i), gyros[i][(axis + 1) % 3])));
    }
}

#[test]
fn errors_of_gyro_and_accelerometer_are_independent() {
    let unit = Imu::new(presets::adis16448(), 1, 2).unwrap();
    let mut state = unit.start();
    let truth = InertialReading { angular_velocity: DVec3::X, specific_force: DVec3::Z * 9.81 };
    let reads: Vec<_> = (0..2000).map(|frame| unit.measure(&truth, frame, 0.005, &mut state)).collect();
    let turn = reads.iter().map(|read| read.angular_velocity.y - state.gyro.bias[1]);
    let force = reads.iter().map(|read| read.specific_force.y - state.accelerometer.bias[1]);
    let (mut both, mut squares) = (0.0, [0.0, 0.0]);
    for (turn, force) in turn.zip(force) {
        both += turn * force;
        squares = [squares[0] + turn * turn, squares[1] + force * force];
    }
    let correlation = both / (squares[0] * squares[1]).sqrt();
    assert!(correlation.abs() < 0.1, "{correlation}");
    assert_eq!(presets::named("adis16448").map(|preset| preset.config()), Some(presets::adis16448()));
    assert!(presets::named("adis").is_none());
}

#[test]
fn each_bad_parameter_is_named() {
    let with = |change: fn(InstrumentConfig<3>) -> InstrumentConfig<3>| {
        Instrument::new(change(InstrumentConfig::default())).unwrap_err().to_string()
    };
    let spread = "it must be a finite number, 0 or more";
    assert_eq!(
        with(|config| config.density([0.0, -1.0, 0.0])),
        format!("density 1 of the instrument is -1; {spread}")
    );
    assert_eq!(
        with(|config| config.stddev([f64::NAN; 3])),
        format!("stddev 0 of the instrument is NaN; {spread}")
    );
    assert_eq!(
        with(|config| config.mean([0.0, 0.0, f64::INFINITY])),
        "mean 2 of the instrument is inf; it must be a finite number"
    );
    assert_eq!(
        with(|config| config.drift_time_s([0.0; 3])),
        "drift_time_s 0 of the instrument is 0; it must be more than 0"
    );
    assert_eq!(
        with(|config| config.limit(f64::NAN)),
        "limit of the instrument is NaN; it must be more than 0"
    );
    let unit = Imu::new(ImuConfig::default().gyro(InstrumentConfig::default().drift([-1.0; 3])), 1, 0);
    assert_eq!(unit.unwrap_err().to_string(), format!("drift 0 of the gyro is -1; {spread}"));
}

/// FNV-1a.
fn hash(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes
        .into_iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn bits_are_pinned() {
    let unit = Imu::new(presets::adis16448(), 0x0123_4567_89AB_CDEF, 9).unwrap();
    let mut state = unit.start();
    let truth = InertialReading { angular_velocity: DVec3::new(0.1, -0.2, 0.3), specific_force: DVec3::Z };
    let reads = (0..1000).flat_map(|frame| {
        let read = unit.measure(&truth, frame, 0.00123, &mut state);
        [read.angular_velocity.to_array(), read.specific_force.to_array()].into_iter().flatten()
    });
    assert_eq!(hash(reads.flat_map(f64::to_le_bytes)), 12_634_466_537_894_583_016);
}
