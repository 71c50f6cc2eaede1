//! Data packets of lidars, as received by programs that do not know belvedere. Their content is decoded by
//! `.ci/packets`.

use crate::live::{output, own_domain};
use std::fs;
use std::net::UdpSocket;
use std::time::Duration;
use tempfile::TempDir;

const ROBOT: &str = include_str!("../lidars/lidar.urdf");

/// Runs a robot with a VLP-16.
fn run(more: &[&str]) -> (bool, String) {
    run_with("<preset>vlp16</preset>", more)
}

/// Runs a robot with a lidar that has this content in our plugin.
fn run_with(own: &str, more: &[&str]) -> (bool, String) {
    let (domain, folder) = (own_domain(), TempDir::new().unwrap());
    let robot = folder.path().join("robot.urdf");
    fs::write(&robot, ROBOT.replace("PRESET", own).replace("RATE", "10")).unwrap();
    let robot = robot.to_str().unwrap();
    let all = ["run", "--robot", robot, "--world", "playground", "--rate", "max", "--duration", "0.5"];
    let output = output(&[&all[..], &["--domain", &domain], more].concat());
    (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn packets_to_an_address_and_in_a_file_are_equal() {
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    receiver.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("a.pcap");
    let (udp, pcap) =
        (format!("points={}", receiver.local_addr().unwrap()), format!("lidar={}", file.display()));
    let (succeeded, said) = run(&["--udp", &udp, "--pcap", &pcap]);
    assert!(succeeded, "{said}");
    let bytes = fs::read(file).unwrap();
    let (head, records) = bytes.split_at(24);
    assert_eq!(head[..4], [0xD4, 0xC3, 0xB2, 0xA1]);
    let records: Vec<_> = records.chunks(16 + 1248).collect();
    // 753.5 per second, for half a second or all but its last frame.
    assert!((300..=377).contains(&records.len()), "{}", records.len());
    // Nothing has been read so far: the first packets, as many as the system buffers.
    let (mut sent, mut packet) = (Vec::new(), [0; 2000]);
    while let Ok(len) = receiver.recv(&mut packet) {
        sent.push(packet[..len].to_vec());
    }
    assert!(sent.len() >= 10 && sent.len() <= records.len(), "{}", sent.len());
    let mut hits = 0;
    for (number, record) in records.iter().enumerate() {
        let packet = &record[16 + 42..];
        assert!(sent.get(number).is_none_or(|sent| sent == packet));
        // The sixteen-bit words of the IPv4 header, including the checksum, sum up to zero.
        let words = record[30..50].chunks(2).map(|word| u32::from(word[0]) << 8 | u32::from(word[1]));
        let sum: u32 = words.sum();
        assert_eq!((sum & 0xFFFF) + (sum >> 16), 0xFFFF);
        let micros = u32::from_le_bytes(packet[1200..1204].try_into().unwrap());
        // The head began to fire one turn before time 0.
        let expected = 1809.0 * 55.296 - 100_000.0 + 24.0 * 55.296 * number as f64;
        assert!((f64::from(micros) - expected).abs() <= 0.5 + 1e-6, "{number}: {micros}");
        assert_eq!(packet[1204..], [0x37, 0x22]);
        for block in packet[..1200].chunks(100) {
            assert_eq!(block[..2], [0xFF, 0xEE]);
            hits += block[4..].chunks(3).filter(|firing| firing[..2] != [0, 0]).count();
        }
    }
    // Half of the beams look down.
    assert!(hits > records.len() * 384 / 2 - 384, "{hits}");
}

/// The two blocks of a pair have the same azimuth, and the same content if there is only one return.
#[test]
fn dual_returns_are_pairs_of_blocks() {
    let folder = TempDir::new().unwrap();
    for (own, mode, per_s, banks) in [
        ("<preset>vlp16</preset><returns>dual</returns>", [0x39, 0x22], 1507.0, &[0xEEFF_u16][..]),
        (
            "<preset>vls128</preset><returns>last</returns>",
            [0x38, 0xA1],
            6253.9,
            &[0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF],
        ),
    ] {
        let file = folder.path().join(format!("{per_s}.pcap"));
        let (succeeded, said) = run_with(own, &["--pcap", &format!("points={}", file.display())]);
        assert!(succeeded, "{said}");
        let bytes = fs::read(&file).unwrap();
        let packets: Vec<_> = bytes[24..].chunks(16 + 1248).map(|record| &record[16 + 42..]).collect();
        assert!((0.4 * per_s - 2.0..=0.5 * per_s).contains(&(packets.len() as f64)), "{}", packets.len());
        let (mut differ, mut hits) = (0, 0);
        for packet in packets {
            assert_eq!(packet[1204..], mode);
            let blocks: Vec<_> = packet[..1200].chunks(100).collect();
            for (index, block) in blocks.iter().enumerate() {
                assert_eq!(u16::from_le_bytes([block[0], block[1]]), banks[index % banks.len()]);
                hits += block[4..].chunks(3).filter(|firing| firing[..2] != [0, 0]).count();
            }
            if mode[0] == 0x39 {
                for pair in blocks.chunks(2) {
                    assert_eq!(pair[0][..4], pair[1][..4]);
                    let places = pair[0][4..].chunks(3).zip(pair[1][4..].chunks(3));
                    for (last, strongest) in places {
                        // If there is no last return, there is no strongest one.
                        assert_eq!(last[..2] == [0, 0], strongest[..2] == [0, 0]);
                        let [last, strongest] =
                            [last, strongest].map(|of| u16::from_le_bytes([of[0], of[1]]));
                        assert!(strongest <= last);
                        differ += u32::from(strongest != last);
                    }
                }
            } else {
                assert!(
                    blocks.chunks(4).all(|column| column.iter().all(|block| block[2..4] == column[0][2..4]))
                );
            }
        }
        assert!(hits > 10_000 && (differ > 100 || mode[0] == 0x38), "{hits} {differ}");
    }
}

#[test]
fn an_ousters_packets_come_with_its_metadata() {
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    receiver.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
    let folder = TempDir::new().unwrap();
    let (file, other) = (folder.path().join("run.pcap"), folder.path().join("other.json"));
    let udp = format!("points={}", receiver.local_addr().unwrap());
    let (pcap, metadata) = (format!("lidar={}", file.display()), format!("lidar={}", other.display()));
    let own = "<preset>os0_32</preset><columns>512</columns>";
    let flags = ["--udp", &udp, "--pcap", &pcap, "--lidar-metadata", &metadata];
    let (succeeded, said) = run_with(own, &flags);
    assert!(succeeded, "{said}");
    let bytes = fs::read(&file).unwrap();
    let records: Vec<_> = bytes[24..].chunks(16 + 42 + 6400).collect();
    // 32 packets per frame of a tenth of a second; those of the first frame would have been before time 0.
    assert!(records.len() >= 3 * 32 && records.len() % 32 == 0, "{}", records.len());
    // From port 7502 to 7502; the same to an address as into the file.
    assert!(records.iter().all(|record| record[16 + 34..16 + 38] == [0x1D, 0x4E, 0x1D, 0x4E]));
    let mut packet = [0; 10_000];
    let mut received = 0;
    while let Ok(len) = receiver.recv(&mut packet) {
        assert_eq!(packet[..len], records[received][16 + 42..]);
        received += 1;
    }
    assert!(received >= 10, "{received}");
    let metadata = fs::read_to_string(other).unwrap();
    assert_eq!(metadata, fs::read_to_string(file.with_extension("json")).unwrap());
    let metadata: serde_json::Value = serde_json::from_str(&metadata).unwrap();
    assert_eq!(metadata["sensor_info"]["prod_line"], "OS-0-32");
    assert_eq!(metadata["config_params"]["lidar_mode"], "512x10");
    assert_eq!(metadata["beam_intrinsics"]["lidar_origin_to_beam_origin_mm"], 27.67);
    assert_eq!(metadata["beam_intrinsics"]["beam_altitude_angles"].as_array().map(Vec::len), Some(32));
}

#[test]
fn errors_of_packet_options_are_named() {
    let folder = TempDir::new().unwrap();
    let nowhere = format!("points={}", folder.path().join("none/a.pcap").display());
    for (flags, says) in [
        (["--udp", "nobody=127.0.0.1:2368"], "there is no sensor 'nobody'"),
        (["--udp", "points=somewhere"], "is not ADDRESS:PORT"),
        (["--udp", "127.0.0.1:2368"], "is not SENSOR="),
        (["--pcap", nowhere.as_str()], "packets of points: "),
        (["--lidar-metadata", "points=a.json"], "packets of Velodyne have no metadata"),
    ] {
        let (succeeded, said) = run(&flags);
        assert!(!succeeded && said.contains(says), "{flags:?}: {said}");
    }
    let (succeeded, said) = run_with("<preset>rplidar_a1</preset>", &["--udp", "points=127.0.0.1:2368"]);
    assert!(!succeeded && said.contains("only for presets of Ouster and of Velodyne"), "{said}");
    // No file is made unless all sensors have packets.
    let file = folder.path().join("a.pcap");
    let pcap = format!("points={}", file.display());
    let (succeeded, said) = run(&["--pcap", &pcap, "--udp", "scan_of_another=127.0.0.1:9"]);
    assert!(!succeeded && said.contains("there is no sensor 'scan_of_another'"), "{said}");
    let (succeeded, said) = run(&["--pcap", &pcap, "--lidar-metadata", "points=a.json"]);
    assert!(!succeeded && !file.exists(), "{said}");
    // Nothing listens there: the run continues.
    let (succeeded, said) = run(&["--udp", "points=127.0.0.1:9"]);
    assert!(succeeded, "{said}");
}
