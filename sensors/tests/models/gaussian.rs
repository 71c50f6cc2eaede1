//! Standard normals: each equals Box and Muller's formula for its word in double precision, and many have the right
//! distribution. Seeds are fixed; a correct sampler fails one of the limits once in thousands of seeds.

use belvedere_sensors::noise::{Stream, fill_standard_normal, philox4x32, standard_normal};
use belvedere_sensors::simd::{Level, best_level};
use core::f64::consts::{PI, SQRT_2};

const STREAM: Stream = Stream { seed: 0xDEAD_BEEF, sensor: 77, frame: 5, channel: 100 };

fn normals(stream: Stream, count: usize) -> Vec<f32> {
    let mut normals = vec![0.0; count];
    fill_standard_normal(best_level(), &stream, 0, &mut normals);
    normals
}

/// The two normals of a word, computed from the nearest number that f32 represents.
fn box_muller(word: u32) -> [f64; 2] {
    let golden = u64::from(word) * 0x9E37_79B9 % (1 << 32);
    let radius = (-2.0 * (f64::from((word / 2) as f32 + 0.5) / 2_f64.powi(31)).ln()).sqrt();
    let x = (golden / 512) as f64 / 2_f64.powi(23) - 0.5;
    let (sin, cos) = (0.5 * PI * x).sin_cos();
    let signed = if word & 2 == 0 { radius } else { -radius };
    if word & 1 == 0 { [signed * cos, signed * sin] } else { [signed * sin, signed * cos] }
}

#[test]
fn samples_follow_the_formula() {
    let samples = normals(STREAM, 1 << 16);
    let Stream { seed, sensor, frame, channel } = STREAM;
    for (block, samples) in samples.chunks(16).enumerate() {
        let words = [0, 1].map(|counter| {
            let counter = [2 * block as u32 + counter, frame as u32, u32::from(channel), 0];
            philox4x32::<7>(counter, [seed as u32, sensor])
        });
        for (index, &sample) in samples.iter().enumerate() {
            let (half, which, lane) = (index / 8, index / 4 % 2, index % 4);
            let expected = box_muller(words[lane / 2][2 * half + 1 - lane % 2])[which];
            let error = (f64::from(sample) - expected).abs();
            assert!(
                error < 3e-6 * expected.abs() + 1e-12,
                "sample {index} of block {block}: {sample}, not {expected}"
            );
        }
    }
    let mut plain = vec![0.0; samples.len()];
    fill_standard_normal(Level::baseline(), &STREAM, 0, &mut plain);
    assert_eq!(plain, samples, "the same bits at another level");
    for index in [0, 5, 1023, 65535] {
        assert_eq!(standard_normal(&STREAM, index), samples[index as usize]);
    }
}

fn beyond(limit: f64) -> f64 {
    libm::erfc(limit / SQRT_2)
}

#[test]
fn tails_of_all_words_are_normal() {
    // Only words below this have radii above 4.
    let least = (2_f64.powi(32) * (-8.0_f64).exp()).ceil() as u32;
    let tail: Vec<f64> = (0..=least).flat_map(box_muller).map(f64::abs).collect();
    for (limit, share) in [(4.0, 1e-4), (4.5, 1e-4), (5.0, 1e-3), (5.5, 1e-2), (6.0, 0.1)] {
        let count = tail.iter().filter(|z| **z > limit).count() as f64;
        let expected = 2_f64.powi(33) * beyond(limit);
        assert!((count / expected - 1.0).abs() < share, "{count} beyond {limit}, not {expected}");
    }
}

#[test]
fn samples_have_the_normal_distribution() {
    const COUNT: usize = 1 << 24;
    let n = COUNT as f64;
    let mut samples = normals(STREAM, COUNT);

    let mut sums = [0.0; 5];
    for &z in &samples {
        let z = f64::from(z);
        let z2 = z * z;
        for (sum, power) in sums.iter_mut().zip([z, z2, z2 * z, z2 * z2, z2 * z2 * z2]) {
            *sum += power;
        }
    }
    // Moments, and the variance of a sample's power: E z²ᵏ − (E zᵏ)².
    for (sum, (moment, variance)) in
        sums.into_iter().zip([(0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0), (15.0, 10170.0)])
    {
        let deviation = (sum / n - moment) / (variance / n).sqrt();
        assert!(deviation.abs() < 3.5, "a moment of {} instead of {moment}", sum / n);
    }
    for limit in [3.0, 3.5, 4.0, 4.5, 5.0] {
        let count = samples.iter().filter(|z| f64::from(z.abs()) > limit).count() as f64;
        let expected = n * beyond(limit);
        let deviation = (count - expected) / expected.sqrt();
        assert!(deviation.abs() < 3.5, "{count} beyond {limit}, not {expected}");
    }
    // Kolmogorov and Smirnov's distance, times √n: above 1.95 once in a thousand times.
    samples.sort_unstable_by(f32::total_cmp);
    let distance = samples.iter().enumerate().step_by(16).fold(0.0_f64, |farthest, (index, z)| {
        let below = 0.5 * libm::erfc(-f64::from(*z) / SQRT_2);
        farthest.max((below - (index as f64 + 0.5) / n).abs())
    });
    assert!(distance * n.sqrt() < 1.95, "{}", distance * n.sqrt());
}

#[test]
fn neighbours_frames_sensors_and_channels_are_independent() {
    const COUNT: usize = 1 << 21;
    let first = normals(STREAM, COUNT);
    let shifted = |lag: usize| (format!("a lag of {lag}"), [&first[lag..], &first[..lag]].concat());
    let mut others: Vec<(String, Vec<f32>)> =
        [1, 2, 3, 4, 5, 7, 8, 12, 16, 64, 640, 2560].map(shifted).into();
    for (what, stream) in [
        ("the next frame", Stream { frame: 6, ..STREAM }),
        ("the next sensor", Stream { sensor: 78, ..STREAM }),
        ("the next channel", Stream { channel: 101, ..STREAM }),
        ("another seed", Stream { seed: 1 << 40, ..STREAM }),
    ] {
        others.push((what.into(), normals(stream, COUNT)));
    }
    for (what, other) in others {
        let (mut product, mut squares) = (0.0, 0.0);
        for (&a, &b) in first.iter().zip(&other) {
            let (a, b) = (f64::from(a), f64::from(b));
            product += a * b;
            squares += (a * a - 1.0) * (b * b - 1.0);
        }
        let scale = 1.0 / (COUNT as f64).sqrt();
        let [product, squares] = [product * scale, 0.5 * squares * scale];
        assert!(product.abs() < 3.9 && squares.abs() < 3.9, "{what}: {product} and {squares} sigma");
    }
}

#[test]
fn a_run_continues_past_the_last_index() {
    let mut run = [0.0; 40];
    fill_standard_normal(best_level(), &STREAM, u32::MAX - 7, &mut run);
    let last: Vec<f32> = (u32::MAX - 7..=u32::MAX).map(|index| standard_normal(&STREAM, index)).collect();
    assert_eq!(run[..8], last);
    assert_ne!(run[8..], normals(STREAM, 32), "blocks that no index names");
}

#[test]
fn uniform_numbers_and_normals_of_a_stream_are_independent() {
    // For every pair of a uniform number and a normal near the beginning of a stream, over many frames: correlations
    // with the normal itself and with its magnitude. When both came from the same words, the correlation of uniform
    // number 0 and the magnitude of normal 5 was −0.67.
    const FRAMES: u32 = 40_000;
    let sample = |frame: u32| {
        let stream = Stream { frame: frame.into(), ..STREAM };
        let uniforms: Vec<f64> =
            (0..16).map(|index| (f64::from(stream.uniform(index)) - 0.5) * 12_f64.sqrt()).collect();
        let normals: Vec<f64> = normals(stream, 32).into_iter().map(f64::from).collect();
        (uniforms, normals)
    };
    // The magnitude of a normal has the mean √(2/π) and the variance 1 − 2/π.
    let (mean, spread) = ((2.0 / PI).sqrt(), (1.0 - 2.0 / PI).sqrt());
    let mut sums = [[[0.0; 2]; 32]; 16];
    for (uniforms, normals) in (0..FRAMES).map(sample) {
        for (uniform, sums) in uniforms.iter().zip(&mut sums) {
            for (normal, [itself, size]) in normals.iter().zip(sums) {
                *itself += uniform * normal;
                *size += uniform * (normal.abs() - mean) / spread;
            }
        }
    }
    let sigma = f64::from(FRAMES).sqrt();
    let [_, named] = sums[0][5].map(|sum| sum / sigma);
    assert!(named.abs() < 4.0, "uniform 0 and the size of normal 5: {named} sigma");
    for (uniform, sums) in sums.iter().enumerate() {
        for (normal, pair) in sums.iter().enumerate() {
            // There are 1024 numbers: a correct sampler has one beyond 5 sigma once in 1700 times.
            let [itself, size] = pair.map(|sum| sum / sigma);
            assert!(
                itself.abs() < 5.0 && size.abs() < 5.0,
                "uniform {uniform} and normal {normal}: {itself} and {size} sigma"
            );
        }
    }
}

#[test]
fn uniform_words_are_where_the_table_says() {
    let Stream { seed, sensor, frame, channel } = STREAM;
    for index in [0, 1, 4, 15, 16, 255, 70_000, u32::MAX] {
        let (block, word, lane) = (index / 16, index / 4 % 4, index % 4);
        let counter = [1 << 31 | (4 * block + lane), frame as u32, u32::from(channel), 0];
        let words = philox4x32::<7>(counter, [seed as u32, sensor]);
        assert_eq!(STREAM.word(index), words[word as usize], "word {index}");
    }
}
