//! Packets in a classic pcap file: Ethernet, IPv4 and UDP before each, as a network card would have seen them.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Bytes of the headers of IPv4 and UDP.
const IP: u16 = 20;
const UDP: u16 = 8;

/// A file that packets are written to.
pub(super) struct Pcap(BufWriter<File>);

impl Pcap {
    /// Begins a file; one that is there is replaced.
    pub(super) fn create(path: &Path) -> io::Result<Self> {
        let mut file = BufWriter::new(File::create(path)?);
        // Times in µs, version 2.4, times of UTC, no packet longer than 65535 bytes, Ethernet.
        for word in [0xA1B2_C3D4_u32, 2 | 4 << 16, 0, 0, 65_535, 1] {
            file.write_all(&word.to_le_bytes())?;
        }
        Ok(Self(file))
    }

    /// Adds a packet that was sent to a port, from the same one, so long after the epoch.
    pub(super) fn write(&mut self, data: &[u8], port: u16, time_ns: u64) -> io::Result<()> {
        let length = u16::try_from(data.len()).map_err(io::Error::other)?;
        let total = 14 + u32::from(IP + UDP + length);
        let (seconds, micros) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000 / 1000);
        for word in [seconds as u32, micros as u32, total, total] {
            self.0.write_all(&word.to_le_bytes())?;
        }
        // To everybody, from an address of Velodyne's.
        self.0.write_all(&[0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x60, 0x76, 0x88, 0, 0, 0, 8, 0])?;
        self.0.write_all(&ip_header(IP + UDP + length))?;
        for word in [port, port, UDP + length, 0] {
            self.0.write_all(&word.to_be_bytes())?;
        }
        self.0.write_all(data)
    }
}

/// From 192.168.1.201 to everybody, with its checksum.
fn ip_header(total: u16) -> [u8; IP as usize] {
    let [high, low] = total.to_be_bytes();
    let mut header = [0x45, 0, high, low, 0, 0, 0x40, 0, 64, 17, 0, 0, 192, 168, 1, 201, 255, 255, 255, 255];
    let sum: u32 = header.as_chunks::<2>().0.iter().map(|word| u32::from(u16::from_be_bytes(*word))).sum();
    let checksum = !((sum & 0xFFFF) + (sum >> 16)) as u16;
    header[10..12].copy_from_slice(&checksum.to_be_bytes());
    header
}
