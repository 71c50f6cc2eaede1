//! Data packets of lidars as programs that know nothing of belvedere get them. What is in them is decoded by
//! `.ci/packets`.

mod live;

use live::{output, own_domain};
use std::fs;
use std::net::UdpSocket;
use std::time::Duration;
use tempfile::TempDir;

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/lidars/vlp16.urdf");

fn run(more: &[&str]) -> (bool, String) {
    let domain = own_domain();
    let all = ["run", "--robot", ROBOT, "--world", "playground", "--rate", "max", "--duration", "0.5"];
    let output = output(&[&all[..], &["--domain", &domain], more].concat());
    (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn packets_go_to_an_address_and_into_a_file_alike() {
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
    // 753.5 a second, for half a second or all but the last frame of it.
    assert!((300..=377).contains(&records.len()), "{}", records.len());
    // Nobody has read so far: as many as the system keeps, the first ones.
    let (mut sent, mut packet) = (Vec::new(), [0; 2000]);
    while let Ok(len) = receiver.recv(&mut packet) {
        sent.push(packet[..len].to_vec());
    }
    assert!(sent.len() >= 10 && sent.len() <= records.len(), "{}", sent.len());
    let mut hits = 0;
    for (number, record) in records.iter().enumerate() {
        let packet = &record[16 + 42..];
        assert!(sent.get(number).is_none_or(|sent| sent == packet));
        // Sixteen words of the header of IPv4 add up to zeros with their checksum.
        let words = record[30..50].chunks(2).map(|word| u32::from(word[0]) << 8 | u32::from(word[1]));
        let sum: u32 = words.sum();
        assert_eq!((sum & 0xFFFF) + (sum >> 16), 0xFFFF);
        let micros = u32::from_le_bytes(packet[1200..1204].try_into().unwrap());
        // The head began to fire a turn before time 0.
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

#[test]
fn who_cannot_get_packets_is_told() {
    let folder = TempDir::new().unwrap();
    let nowhere = format!("points={}", folder.path().join("none/a.pcap").display());
    for (flags, says) in [
        (["--udp", "nobody=127.0.0.1:2368"], "there is no sensor 'nobody'"),
        (["--udp", "points=somewhere"], "is no address and port"),
        (["--udp", "127.0.0.1:2368"], "is not SENSOR="),
        (["--pcap", nowhere.as_str()], "packets of points: "),
    ] {
        let (succeeded, said) = run(&flags);
        assert!(!succeeded && said.contains(says), "{flags:?}: {said}");
    }
    // Nobody listens there: the run goes on.
    let (succeeded, said) = run(&["--udp", "points=127.0.0.1:9"]);
    assert!(succeeded, "{said}");
}
