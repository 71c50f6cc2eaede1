//! Compares packets of random values with the definition of each field.

use crate::columns::{BEAM_ORIGIN_M, Columns, Encoder, OUSTER, VELODYNE};
use lidar_packets::ouster::LidarProfile;

/// Returns the nearest whole number up to `most`, by its definition.
fn rounded(value: f32, most: f32) -> u32 {
    if value.is_nan() { 0 } else { value.clamp(0.0, most).round_ties_even() as u32 }
}

#[test]
fn velodynes_places_tell_any_return() {
    for (model, mode) in VELODYNE {
        let (lasers, returns) = (model.lasers(), mode.returns());
        let mut encoder = Encoder::velodyne(model, mode);
        let step_m = if lasers == 128 { 0.004_f32 } else { 0.002 };
        // The end of a packet with dual returns of 128 lasers is empty.
        let firings = if lasers == 128 && returns == 2 { 128 } else { 384 / returns };
        let columns = Columns::any(60 * firings / lasers, lasers, returns);
        let mut packets = 0;
        for number in 0..columns.len() {
            let Some(packet) = encoder.push(&columns.column(number)).unwrap() else { continue };
            for firing in 0..firings {
                let (column, laser) = (packets * firings / lasers + firing / lasers, firing % lasers);
                let place = |number: usize| {
                    let (range, intensity) = columns.echo(column, laser, number);
                    let steps = range / step_m;
                    let distance = if steps <= 65_535.0 { rounded(steps, 65_535.0) } else { 0 };
                    (distance, if distance == 0 { 0 } else { rounded(intensity, 255.0) })
                };
                for number in 0..returns {
                    let expected = if place(number).0 == 0 { place(0) } else { place(number) };
                    let at = (firing / 32 * returns + number) * 100 + 4 + firing % 32 * 3;
                    let distance = u32::from(packet[at]) | u32::from(packet[at + 1]) << 8;
                    assert_eq!((distance, packet[at + 2].into()), expected, "{model:?} {returns} {firing}");
                }
            }
            let blocks = packet[..12 * 100].chunks_exact(100).take(firings / 32 * returns);
            let marks: Vec<u8> = blocks.map(|block| block[1]).collect();
            let bank = |block: usize| [0xEE, 0xDD, 0xCC, 0xBB][block / returns % lasers.div_ceil(32)];
            assert_eq!(marks, (0..marks.len()).map(bank).collect::<Vec<u8>>(), "{model:?} {returns}");
            packets += 1;
        }
        assert_eq!(packets, 60, "{model:?} {returns}");
    }
}

#[test]
fn ousters_channels_tell_any_return() {
    for (profile, returns) in OUSTER {
        let mut encoder = Encoder::ouster(profile);
        let columns = Columns::any(64, 128, returns);
        let is_legacy = profile == LidarProfile::Legacy;
        let (bits, step_mm) = [(20, 1.0), (15, 8.0), (19, 1.0)][match profile {
            LidarProfile::Legacy => 0,
            LidarProfile::Rng15Rfl8Nir8 => 1,
            _ => 2,
        }];
        let channel = if step_mm > 1.0 { 4 } else { 8 + 4 * returns };
        let (header, column_header, footer) = if is_legacy { (0, 16, 4) } else { (32, 12, 0) };
        for first in [0, 16, 32, 48] {
            let mut packet = None;
            for number in first..first + 16 {
                packet = encoder.push(&columns.column(number)).unwrap().map(<[u8]>::to_vec);
            }
            let packet = packet.unwrap();
            for (column, laser) in (0..16).flat_map(|column| (0..128).map(move |laser| (column, laser))) {
                let expected = |number: usize| {
                    let (range, intensity) = columns.echo(first + column, laser, number);
                    let steps = (f64::from(range) + BEAM_ORIGIN_M) * 1000.0 / step_mm;
                    let steps = if steps > 0.0 { steps.round_ties_even() } else { 0.0 };
                    let signal = if range.is_finite() { rounded(intensity, 65_535.0) } else { 0 };
                    (if steps < f64::from(1 << bits) { steps as u32 } else { 0 }, signal)
                };
                let at = header
                    + column * (column_header + 128 * channel + footer)
                    + column_header
                    + laser * channel;
                let word = |word: usize| u32::from_le_bytes(packet[at + 4 * word..][..4].try_into().unwrap());
                let (range, signal) = expected(0);
                let found: Vec<u32> = (0..channel / 4).map(word).collect();
                let words = match channel {
                    4 => vec![range | signal.min(255) << 16],
                    12 => vec![range, signal.min(255) | signal << 16, 0],
                    _ => {
                        let (second, signal_2) = expected(1);
                        let seconds = second | signal_2.min(255) << 24;
                        vec![range | signal.min(255) << 24, seconds, signal | signal_2 << 16, 0]
                    }
                };
                assert_eq!(found, words, "{profile:?} {column} {laser}");
            }
            if !is_legacy {
                let (text, sum) = packet.split_at(packet.len() - 8);
                assert_eq!(crc_64_xz(text), u64::from_le_bytes(sum.try_into().unwrap()));
            }
        }
    }
}

/// Computes CRC-64/XZ bit by bit: reflected polynomial 0x42F0E1EBA9EA3693, initial value and final mask all ones.
fn crc_64_xz(bytes: &[u8]) -> u64 {
    let bit = |sum: u64| if sum & 1 == 1 { sum >> 1 ^ 0xC96C_5795_D787_0F42 } else { sum >> 1 };
    !bytes.iter().fold(u64::MAX, |sum, byte| (0..8).fold(sum ^ u64::from(*byte), |sum, _| bit(sum)))
}
