//! Writes ten turns of a VLP-16 in the middle of a round room as a pcap file, for Wireshark or any decoder of Velodyne's
//! packets.
//! `cargo run -p lidar-packets --example vlp16 -- vlp16.pcap`

use lidar_packets::velodyne::{Encoder, Model, PACKET_LEN, PORT, ReturnMode};
use lidar_packets::{Column, pcap};
use std::fs::File;
use std::io::BufWriter;

/// The time from one firing of all lasers to the next, and of a turn, in nanoseconds.
const COLUMN_NS: u64 = 55_296;
const TURN_NS: u64 = 100_000_000;
/// The elevations of the lasers in degrees, in the order in which they fire.
const ELEVATIONS_DEG: [f32; 16] =
    [-15.0, 1.0, -13.0, 3.0, -11.0, 5.0, -9.0, 7.0, -7.0, 9.0, -5.0, 11.0, -3.0, 13.0, -1.0, 15.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "vlp16.pcap".into());
    let mut file = pcap::Writer::new(BufWriter::new(File::create(&name)?))?;
    let mut encoder = Encoder::new(Model::Vlp16, ReturnMode::Strongest);
    // The wall is at 5 m. Beams that point up or down hit it farther away.
    let ranges_m = ELEVATIONS_DEG.map(|elevation| 5.0 / elevation.to_radians().cos());
    let mut packets = 0;
    for number in 0..10 * TURN_NS / COLUMN_NS {
        let time_ns = number * COLUMN_NS;
        let column = Column {
            frame: time_ns / TURN_NS,
            number: (time_ns % TURN_NS / COLUMN_NS) as usize,
            time_ns,
            turned: (time_ns % TURN_NS) as f64 / TURN_NS as f64,
            ranges_m: &ranges_m,
            intensities: &[50.0; 16],
        };
        let Some(packet) = encoder.push(&column)? else { continue };
        assert_eq!(packet.len(), PACKET_LEN);
        // The second laser, 1° up: 5 m / cos 1° = 5.0008 m, in steps of 2 mm; reflectivity 50.
        assert_eq!(u16::from_le_bytes([packet[7], packet[8]]), 2500);
        assert_eq!(packet[9], 50);
        // The packets of a second are 754 as in the manual, and they are 1.327 ms apart.
        let micros = u32::from_le_bytes([packet[1200], packet[1201], packet[1202], packet[1203]]);
        assert_eq!(micros, ((packets * 24 * COLUMN_NS + 500) / 1000) as u32);
        file.write(packet, PORT, time_ns)?;
        packets += 1;
    }
    assert_eq!(packets, 753);
    println!("{packets} packets in {name}");
    Ok(())
}
