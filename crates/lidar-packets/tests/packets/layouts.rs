//! Checks that each byte is at the place given in the makers' documents.

use crate::columns::os1;
use lidar_packets::ouster::{DeviceError, Identity, ImuEncoder, ImuProfile, LidarEncoder, LidarProfile};
use lidar_packets::velodyne::{Encoder, Model, ReturnMode};
use lidar_packets::{Column, ColumnError, pcap};

const HOUR_NS: u64 = 3_600_000_000_000;

/// The places are those in the manual.
#[test]
fn columns_become_velodynes_packets() {
    for (model, lasers, product) in [(Model::Vlp16, 16, 0x22), (Model::Hdl32e, 32, 0x21)] {
        let mut encoder = Encoder::new(model, ReturnMode::Strongest);
        let mut packet = None;
        let columns = 384 / lasers;
        for column in 0..columns {
            // Laser 3 has no return, and the range of laser 5 is too large for the layout.
            let ranges: Vec<f32> = (0..lasers)
                .map(|id| match id {
                    3 => f32::INFINITY,
                    5 => 131.08,
                    _ => 1.0 + 0.002 * id as f32,
                })
                .collect();
            let column = Column {
                frame: 1,
                number: column,
                time_ns: 2 * HOUR_NS + 1_234_567 + 55_296 * column as u64,
                turned: 0.999_96 + 0.0004 * column as f64,
                ranges_m: &ranges,
                intensities: &vec![[300.0, 200.0, -2.0][column % 3]; lasers],
            };
            assert!(packet.is_none());
            packet = encoder.push(&column).unwrap().copied();
        }
        let packet = packet.unwrap();
        let u16_at = |at: usize| u16::from_le_bytes([packet[at], packet[at + 1]]);
        for block in 0..12 {
            let column = block * 32 / lasers;
            assert_eq!(u16_at(100 * block), 0xEEFF);
            assert_eq!(
                u16_at(100 * block + 2),
                ((35_998.56 + 14.4 * column as f64).round() as u32 % 36_000) as u16
            );
            for place in 0..32 {
                let (id, column) = (place % lasers, column + place / lasers);
                let at = 100 * block + 4 + 3 * place;
                let (distance, reflectivity) =
                    if [3, 5].contains(&id) { (0, 0) } else { (500 + id as u16, [255, 200, 0][column % 3]) };
                assert_eq!((u16_at(at), packet[at + 2]), (distance, reflectivity), "{block} {place}");
            }
        }
        assert_eq!(u32::from_le_bytes(packet[1200..1204].try_into().unwrap()), 1235);
        assert_eq!(packet[1204..1206], [0x37, product]);
    }
}

/// The places are those in Ouster's documents.
#[test]
fn columns_become_the_packets_of_ousters_profiles() {
    for (profile, length, header, column_header, channel) in [
        (LidarProfile::Legacy, 6464, 0, 16, 12),
        (LidarProfile::Rng19Rfl8Sig16Nir16, 6400, 32, 12, 12),
        (LidarProfile::Rng15Rfl8Nir8, 2304, 32, 12, 4),
    ] {
        let mut encoder = LidarEncoder::new(&os1(32, profile)).unwrap();
        let mut packets = Vec::new();
        let ranges: Vec<f32> =
            (0..32).map(|id| if id == 3 { f32::INFINITY } else { 1.0 + 0.5 * id as f32 }).collect();
        // Packets that lack columns are not sent: their beginning, a part in the middle, or their end.
        for number in (3..19).chain(20..22).chain(32..48).chain(48..53).chain(65..80) {
            let column = Column {
                frame: 65_536 + 7,
                number,
                time_ns: 1_000_000_007 + 97_656 * number as u64,
                turned: number as f64 / 1024.0,
                ranges_m: &ranges,
                intensities: &[300.0; 32],
            };
            packets.extend(encoder.push(&column).unwrap().map(<[u8]>::to_vec));
        }
        let [packet] = &packets[..] else { panic!("{} packets", packets.len()) };
        assert_eq!(packet.len(), length);
        let u16_at = |at: usize| u16::from_le_bytes([packet[at], packet[at + 1]]);
        let u32_at = |at: usize| u32::from_le_bytes(packet[at..at + 4].try_into().unwrap());
        let is_legacy = profile == LidarProfile::Legacy;
        if !is_legacy {
            assert_eq!((u16_at(0), u16_at(2)), (1, 7));
            assert_eq!(packet[4..12], [0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01]);
            assert!(packet[length - 32..length - 8].iter().all(|byte| *byte == 0));
        }
        let column = column_header + 32 * channel + if is_legacy { 4 } else { 0 };
        for index in 0..16 {
            let at = header + index * column;
            let time = u64::from_le_bytes(packet[at..at + 8].try_into().unwrap());
            assert_eq!(time, 1_000_000_007 + 97_656 * (32 + index as u64));
            assert_eq!(usize::from(u16_at(at + 8)), 32 + index);
            if is_legacy {
                assert_eq!((u16_at(at + 10), u32_at(at + 12)), (7, 88 * (32 + index as u32)));
                assert_eq!(u32_at(at + column - 4), u32::MAX);
            } else {
                assert_eq!(u16_at(at + 10), 1);
            }
            for id in 0..32 {
                let at = at + column_header + id * channel;
                let (hit, millimetres) = (id != 3, 1015.806 + 500.0 * id as f64);
                if channel == 12 {
                    let range = if hit { millimetres.round() as u32 } else { 0 };
                    let signal = if hit { 300 } else { 0 };
                    assert_eq!((u32_at(at), u16_at(at + 6)), (range, signal));
                    assert_eq!(packet[at + 4], if hit { 255 } else { 0 });
                } else {
                    let range = if hit { (millimetres / 8.0).round() as u16 } else { 0 };
                    assert_eq!((u16_at(at), packet[at + 2]), (range, if hit { 255 } else { 0 }));
                }
            }
        }
    }
}

/// The places are those from which ouster-sdk reads.
#[test]
fn readings_become_the_packets_of_an_ousters_inertial_unit() {
    let force = |number: u64| [1.0, 2.0, 9.806_65].map(|value| value + number as f64);
    let turn = |number: u64| [0.1, -0.2, 0.3].map(|value| value * number as f64);
    let stamp = |number: u64| 1_000_000_007 + 1_562_500 * number;
    for (profile, length, samples) in [(ImuProfile::Legacy, 48, 1), (ImuProfile::Accel32Gyro32Nmea, 452, 8)] {
        let mut encoder = ImuEncoder::new(profile, Identity { serial: 0xFF_0000_0001, initialization: 2 });
        // A restart discards samples and resets their number.
        encoder.push(0, force(0), turn(0));
        encoder.restart();
        for number in 0..72 {
            let packet = encoder.push(stamp(number), force(number), turn(number));
            assert_eq!(packet.is_some(), (number + 1).is_multiple_of(samples));
            let Some(packet) = packet else { continue };
            assert_eq!(packet.len(), length);
            let u64_at = |at: usize| u64::from_le_bytes(packet[at..at + 8].try_into().unwrap());
            let u16_at = |at: usize| u16::from_le_bytes([packet[at], packet[at + 1]]);
            let near = |at: usize, unit: f64, expected: [f64; 3]| {
                for (place, expected) in expected.into_iter().enumerate() {
                    let bytes = packet[at + 4 * place..][..4].try_into().unwrap();
                    let found = f64::from(f32::from_le_bytes(bytes)) * unit;
                    assert!((found - expected).abs() < 1e-6 * (1.0 + expected.abs()), "{found} {expected}");
                }
            };
            if length == 48 {
                assert_eq!([0, 8, 16].map(u64_at), [stamp(number); 3]);
                near(24, 9.806_65, force(number));
                near(36, std::f64::consts::PI / 180.0, turn(number));
                continue;
            }
            assert_eq!((u16_at(0), u16_at(2)), (2, (number / 64) as u16));
            assert_eq!(packet[4..12], [2, 0, 0, 1, 0, 0, 0, 0xFF]);
            assert!(packet[12..132].iter().chain(&packet[420..444]).all(|byte| *byte == 0));
            for (place, number) in (number - 7..=number).enumerate() {
                let at = 132 + 36 * place;
                assert_eq!(
                    (u64_at(at), u64::from(u16_at(at + 8)), u16_at(at + 10)),
                    (stamp(number), number % 64, 1)
                );
                near(at + 12, 1.0, force(number));
                near(at + 24, 1.0, turn(number));
            }
        }
    }
}

#[test]
fn what_does_not_fit_is_an_error_and_changes_nothing() {
    let mut velodyne = Encoder::new(Model::Vlp16, ReturnMode::Dual);
    let mut ouster = LidarEncoder::new(&os1(16, LidarProfile::default())).unwrap();
    let column = |number, ranges_m, intensities| Column {
        frame: u64::MAX,
        number,
        time_ns: u64::MAX,
        turned: f64::NAN,
        ranges_m,
        intensities,
    };
    let values = [f32::NAN; 32];
    for found in [0, 16, 31] {
        let wrong = column(0, &values[..found], &values[..found]);
        assert_eq!(velodyne.push(&wrong), Err(ColumnError::Ranges { found, lasers: 16, returns: 2 }));
    }
    let wrong = column(0, &values[..31], &values);
    assert_eq!(ouster.push(&wrong), Err(ColumnError::Ranges { found: 31, lasers: 16, returns: 1 }));
    let wrong = column(0, &values, &values[..31]);
    assert_eq!(velodyne.push(&wrong), Err(ColumnError::Intensities { found: 31, ranges: 32 }));
    for number in [1024, usize::MAX] {
        let wrong = column(number, &values, &values);
        assert_eq!(ouster.push(&wrong), Err(ColumnError::Number { number, columns: 1024 }));
        let error = ouster.push(&wrong).unwrap_err().to_string();
        assert_eq!(error, format!("a column has the number {number}, and a frame only 1024 columns"));
    }
    // A Velodyne's columns may have any number, and an Ouster's the last numbers of a frame.
    let full = (0..12).find_map(|_| velodyne.push(&column(usize::MAX, &values, &values)).unwrap().copied());
    assert_eq!(full.unwrap()[1204..], [0x39, 0x22]);
    let full =
        (1008..1024).filter(|number| ouster.push(&column(*number, &values, &values)).unwrap().is_some());
    assert_eq!(full.collect::<Vec<_>>(), [1023]);

    let refused = |change: fn(&mut lidar_packets::ouster::Device)| {
        let mut device = os1(32, LidarProfile::default());
        change(&mut device);
        LidarEncoder::new(&device).unwrap_err()
    };
    assert_eq!(refused(|device| device.head.altitudes_deg.clear()), DeviceError::Beams(0));
    assert_eq!(
        refused(|device| device.head.azimuths_deg.truncate(31)),
        DeviceError::Azimuths { azimuths: 31, altitudes: 32 }
    );
    assert_eq!(refused(|device| device.head.columns_per_frame = 0), DeviceError::Columns(0));
}

#[test]
fn files_have_headers_that_decoders_read() {
    let mut file = pcap::Writer::new(Vec::new()).unwrap();
    file.write(&[7; 1206], 2368, 3_000_001_999).unwrap();
    let refused = file.write(&vec![0; 65_508], 2368, 0).unwrap_err();
    assert_eq!(refused.to_string(), "a UDP packet has 65508 bytes, and at most 65507 fit");
    file.write(&vec![0; 65_507], 2368, 0).unwrap();
    let bytes = file.into_inner();
    assert_eq!(bytes.len(), 24 + 16 + 42 + 1206 + 16 + 42 + 65_507);
    assert_eq!(bytes[..4], 0xA1B2_C3D4_u32.to_le_bytes());
    let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!([24, 28, 32, 36].map(u32_at), [3, 1, 1248, 1248]);
    // Ethernet's type is IPv4. The sum of the words of IPv4's header is all ones, as RFC 791 requires.
    assert_eq!(bytes[52..54], [8, 0]);
    let words = bytes[54..74].chunks(2).map(|word| u32::from(word[0]) << 8 | u32::from(word[1]));
    let sum = words.sum::<u32>();
    assert_eq!((sum & 0xFFFF) + (sum >> 16), 0xFFFF);
    let u16_be_at = |at: usize| u16::from_be_bytes([bytes[at], bytes[at + 1]]);
    assert_eq!([56, 74, 76, 78].map(u16_be_at), [1234, 2368, 2368, 1214]);
    assert_eq!(bytes[82..82 + 1206], [7; 1206]);
}
