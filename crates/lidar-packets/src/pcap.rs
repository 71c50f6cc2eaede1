//! [`Writer`]: packets in a classic pcap file, which Wireshark and the drivers of lidars read. Each packet has headers of
//! Ethernet, IPv4 and UDP, as if a network card had received it.

use std::io::{self, Write};

/// The sizes of the headers of Ethernet, IPv4 and UDP, in bytes.
const ETHERNET: u16 = 14;
const IP: u16 = 20;
const UDP: u16 = 8;
/// The largest payload of a UDP packet, in bytes.
const MOST: u16 = u16::MAX - IP - UDP;

/// Writes a pcap file. Pass a buffered writer, because headers are written separately.
#[derive(Debug)]
pub struct Writer<W>(W);

impl<W: Write> Writer<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn new(mut file: W) -> io::Result<Self> {
        // Times in µs, version 2.4, times of UTC, no packet longer than 65535 bytes, Ethernet.
        for word in [0xA1B2_C3D4_u32, 2 | 4 << 16, 0, 0, 65_535, 1] {
            file.write_all(&word.to_le_bytes())?;
        }
        Ok(Self(file))
    }

    /// Adds a broadcast UDP packet from 192.168.1.201, with `port` as source and destination. The time is in nanoseconds
    /// since the Unix epoch; the file contains whole microseconds.
    ///
    /// # Errors
    /// If the packet has more than 65,507 bytes, or the file cannot be written.
    pub fn write(&mut self, packet: &[u8], port: u16, time_ns: u64) -> io::Result<()> {
        let length = u16::try_from(packet.len()).ok().filter(|length| *length <= MOST);
        let Some(length) = length else {
            let what = format!("a UDP packet has {} bytes, and at most {MOST} fit", packet.len());
            return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
        };
        let total = u32::from(ETHERNET) + u32::from(IP + UDP + length);
        let (seconds, micros) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000 / 1000);
        for word in [seconds as u32, micros as u32, total, total] {
            self.0.write_all(&word.to_le_bytes())?;
        }
        // Broadcast, from a MAC address of Velodyne.
        self.0.write_all(&[0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x60, 0x76, 0x88, 0, 0, 0, 8, 0])?;
        self.0.write_all(&ip_header(IP + UDP + length))?;
        // Without a checksum, which UDP over IPv4 allows.
        for word in [port, port, UDP + length, 0] {
            self.0.write_all(&word.to_be_bytes())?;
        }
        self.0.write_all(packet)
    }

    /// Returns the underlying writer. It may still have buffered data.
    pub fn into_inner(self) -> W {
        self.0
    }
}

/// Returns the header of an IPv4 packet of this size in bytes, with its checksum.
fn ip_header(total: u16) -> [u8; IP as usize] {
    let [high, low] = total.to_be_bytes();
    let mut header = [0x45, 0, high, low, 0, 0, 0x40, 0, 64, 17, 0, 0, 192, 168, 1, 201, 255, 255, 255, 255];
    let sum: u32 = header.as_chunks::<2>().0.iter().map(|word| u32::from(u16::from_be_bytes(*word))).sum();
    let checksum = !((sum & 0xFFFF) + (sum >> 16)) as u16;
    header[10..12].copy_from_slice(&checksum.to_be_bytes());
    header
}
