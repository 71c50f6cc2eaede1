//! Tests: packets of values that nobody chose, each place beside its definition, and how fast they are made
//! (in a release build).

use super::{Column, Packets, Protocol};
use crate::rig::pace::lidar;

const VELODYNE: [(&str, usize, usize); 6] = [
    ("vlp16", 16, 1),
    ("vlp16", 16, 2),
    ("hdl32e", 32, 1),
    ("hdl32e", 32, 2),
    ("vls128", 128, 1),
    ("vls128", 128, 2),
];
const OUSTER: [(&str, usize); 4] = [
    ("LEGACY", 1),
    ("RNG19_RFL8_SIG16_NIR16", 1),
    ("RNG15_RFL8_NIR8", 1),
    ("RNG19_RFL8_SIG16_NIR16_DUAL", 2),
];

fn velodyne(preset: &str, returns: usize) -> Box<dyn Protocol> {
    // The HDL-32E's beams have no width of their own, and a single ray has one return.
    let dual = "<returns>dual</returns><beam_divergence>0.003 0.0015</beam_divergence>";
    let dual = if returns == 2 { dual } else { "" };
    Packets::of(&lidar(&format!("<preset>{preset}</preset>{dual}"))).unwrap().protocol
}

fn ouster(profile: &str) -> Box<dyn Protocol> {
    let own = format!("<preset>os1_128</preset><udp_profile_lidar>{profile}</udp_profile_lidar>");
    Packets::of(&lidar(&own)).unwrap().protocol
}

/// A generator of values: most within what a sensor tells, others negative, huge or no numbers.
struct Values(u64);

impl Values {
    fn next(&mut self) -> u64 {
        // Knuth's MMIX; its upper bits are good.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn value(&mut self, most: f32) -> f32 {
        let share = self.next() as f32 / (1_u64 << 31) as f32;
        match self.next() % 24 {
            0 => f32::INFINITY,
            1 => f32::NAN,
            2 => f32::NEG_INFINITY,
            3 => 1e30,
            4 => -share * most,
            5 => 3.0 * share * most,
            _ => share * most,
        }
    }

    fn values(&mut self, count: usize, most: f32) -> Vec<f32> {
        (0..count).map(|_| self.value(most)).collect()
    }
}

/// Columns that fill packets.
struct Columns {
    columns: Vec<[Vec<f32>; 2]>,
    returns: usize,
}

impl Columns {
    fn any(count: usize, lasers: usize, returns: usize) -> Self {
        let mut values = Values(count as u64);
        let n = lasers * returns;
        let columns = (0..count).map(|_| [values.values(n, 200.0), values.values(n, 260.0)]).collect();
        Self { columns, returns }
    }

    fn column(&self, number: usize) -> Column<'_> {
        let [ranges, intensities] = &self.columns[number % self.columns.len()];
        let (returns, turned) = (self.returns, number as f64 / 1024.0);
        Column { frame: 3, number, time_ns: 55_296 * number as u64, turned, returns, ranges, intensities }
    }

    /// Range and intensity of a return.
    fn echo(&self, column: usize, laser: usize, number: usize) -> (f32, f32) {
        let [ranges, intensities] = &self.columns[column];
        let echo = laser * self.returns + number;
        (ranges[echo], intensities[echo])
    }
}

/// A whole number of so many, as the definition has it.
fn told(value: f32, most: f32) -> u32 {
    if value.is_nan() { 0 } else { value.clamp(0.0, most).round_ties_even() as u32 }
}

#[test]
fn velodynes_places_tell_any_return() {
    for (preset, lasers, returns) in VELODYNE {
        let mut protocol = velodyne(preset, returns);
        let step_m = if lasers == 128 { 0.004_f32 } else { 0.002 };
        // A packet of pairs of 128 lasers has an empty end.
        let firings = if lasers == 128 && returns == 2 { 128 } else { 384 / returns };
        let columns = Columns::any(60 * firings / lasers, lasers, returns);
        let mut packets = 0;
        for number in 0..columns.columns.len() {
            let Some(packet) = protocol.push(&columns.column(number)) else { continue };
            for firing in 0..firings {
                let (column, laser) = (packets * firings / lasers + firing / lasers, firing % lasers);
                let place = |number: usize| {
                    let (range, intensity) = columns.echo(column, laser, number);
                    let steps = range / step_m;
                    let distance = if steps <= 65_535.0 { told(steps, 65_535.0) } else { 0 };
                    (distance, if distance == 0 { 0 } else { told(intensity, 255.0) })
                };
                for number in 0..returns {
                    let expected = if place(number).0 == 0 { place(0) } else { place(number) };
                    let at = (firing / 32 * returns + number) * 100 + 4 + firing % 32 * 3;
                    let distance = u32::from(packet[at]) | u32::from(packet[at + 1]) << 8;
                    assert_eq!((distance, packet[at + 2].into()), expected, "{preset} {returns} {firing}");
                }
            }
            let blocks = packet[..12 * 100].chunks_exact(100).take(firings / 32 * returns);
            let marks: Vec<u8> = blocks.map(|block| block[1]).collect();
            let bank = |block: usize| [0xEE, 0xDD, 0xCC, 0xBB][block / returns % lasers.div_ceil(32)];
            assert_eq!(marks, (0..marks.len()).map(bank).collect::<Vec<u8>>(), "{preset} {returns}");
            packets += 1;
        }
        assert_eq!(packets, 60, "{preset} {returns}");
    }
}

#[test]
fn ousters_channels_tell_any_return() {
    for (profile, returns) in OUSTER {
        let mut protocol = ouster(profile);
        let columns = Columns::any(64, 128, returns);
        let is_legacy = profile == "LEGACY";
        let (bits, step_mm) = [(20, 1.0), (15, 8.0), (19, 1.0)][match profile {
            "LEGACY" => 0,
            "RNG15_RFL8_NIR8" => 1,
            _ => 2,
        }];
        let channel = if step_mm > 1.0 { 4 } else { 8 + 4 * returns };
        let (header, column_header, footer) = if is_legacy { (0, 16, 4) } else { (32, 12, 0) };
        for first in [0, 16, 32, 48] {
            let mut packet = None;
            for number in first..first + 16 {
                packet = protocol.push(&columns.column(number)).map(<[u8]>::to_vec);
            }
            let packet = packet.unwrap();
            for (column, laser) in (0..16).flat_map(|column| (0..128).map(move |laser| (column, laser))) {
                let expected = |number: usize| {
                    let (range, intensity) = columns.echo(first + column, laser, number);
                    let steps = (f64::from(range) + 0.015_806) * 1000.0 / step_mm;
                    let steps = if steps > 0.0 { steps.round_ties_even() } else { 0.0 };
                    let signal = if range.is_finite() { told(intensity, 65_535.0) } else { 0 };
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
                assert_eq!(found, words, "{profile} {column} {laser}");
            }
            if !is_legacy {
                let (text, sum) = packet.split_at(packet.len() - 8);
                assert_eq!(crc_64_xz(text), u64::from_le_bytes(sum.try_into().unwrap()));
            }
        }
    }
}

/// CRC-64/XZ bit by bit: polynomial 0x42F0E1EBA9EA3693 reflected, all ones before and after.
fn crc_64_xz(bytes: &[u8]) -> u64 {
    let bit = |sum: u64| if sum & 1 == 1 { sum >> 1 ^ 0xC96C_5795_D787_0F42 } else { sum >> 1 };
    !bytes.iter().fold(u64::MAX, |sum, byte| (0..8).fold(sum ^ u64::from(*byte), |sum, _| bit(sum)))
}

/// A gigabyte a second at 4 GHz, on one core. It is compiled in release builds alone, which `BELVEDERE_FULL=1 .ci/run`
/// tests: the dev profile hardly optimises this crate, so that a speed says nothing there.
#[cfg(not(debug_assertions))]
#[test]
fn packets_are_encoded_at_a_byte_in_four_cycles() {
    use crate::rig::pace::pace;
    use std::hint::black_box;
    let velodynes =
        VELODYNE.map(|(preset, lasers, returns)| (preset, velodyne(preset, returns), lasers, returns));
    let ousters = OUSTER.map(|(profile, returns)| (profile, ouster(profile), 128, returns));
    for (name, mut protocol, lasers, returns) in velodynes.into_iter().chain(ousters) {
        let columns = Columns::any(64, lasers, returns);
        let mut number = 0;
        let [gigabytes_s, ratio] = pace(|| {
            (0..64).fold(0, |bytes, _| {
                number = (number + 1) % 1024;
                bytes
                    + protocol
                        .push(black_box(&columns.column(number)))
                        .map_or(0, |packet| black_box(packet).len())
            })
        });
        println!("{name} {returns}: {gigabytes_s:.2} GB/s, {ratio:.2} times FNV-1a");
        assert!(ratio > 1.0, "{name} {returns}: {gigabytes_s:.2} GB/s, {ratio:.2} times FNV-1a");
    }
}
