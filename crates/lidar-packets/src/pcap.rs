//! Packets in a classic pcap file, as Wireshark and the drivers of lidars read it. Before each packet are the headers of
//! Ethernet, IPv4 and UDP, as a network card would have received them.

use std::io::{self, Write};

/// The bytes of the headers of Ethernet, IPv4 and UDP.
const ETHERNET: u16 = 14;
const IP: u16 = 20;
const UDP: u16 = 8;
/// The most bytes that an IPv4 packet holds besides its own header and that of UDP.
const MOST: u16 = u16::MAX - IP - UDP;

/// Writes a pcap file. There is a write for each header, so give it a buffered writer.
#[derive(Debug)]
pub struct Writer<W>(W);

impl<W: Write> Writer<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// When it cannot be written to.
    pub fn new(mut file: W) -> io::Result<Self> {
        // Times in µs, version 2.4, times of UTC, no packet longer than 65535 bytes, Ethernet.
        for word in [0xA1B2_C3D4_u32, 2 | 4 << 16, 0, 0, 65_535, 1] {
            file.write_all(&word.to_le_bytes())?;
        }
        Ok(Self(file))
    }

    /// Adds a UDP packet from 192.168.1.201 to everybody, from a port to the same port. The time is in nanoseconds after
    /// the epoch of Unix, of which the file has whole microseconds.
    ///
    /// # Errors
    /// When the packet has more than 65,507 bytes, or the file cannot be written to.
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
        // To everybody, from an address of Velodyne's.
        self.0.write_all(&[0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x60, 0x76, 0x88, 0, 0, 0, 8, 0])?;
        self.0.write_all(&ip_header(IP + UDP + length))?;
        // Without a checksum, which UDP over IPv4 allows.
        for word in [port, port, UDP + length, 0] {
            self.0.write_all(&word.to_be_bytes())?;
        }
        self.0.write_all(packet)
    }

    /// Returns what it writes to. Nothing is left to be written but what that buffers itself.
    pub fn into_inner(self) -> W {
        self.0
    }
}

/// The header of an IPv4 packet of so many bytes, with its checksum.
fn ip_header(total: u16) -> [u8; IP as usize] {
    let [high, low] = total.to_be_bytes();
    let mut header = [0x45, 0, high, low, 0, 0, 0x40, 0, 64, 17, 0, 0, 192, 168, 1, 201, 255, 255, 255, 255];
    let sum: u32 = header.as_chunks::<2>().0.iter().map(|word| u32::from(u16::from_be_bytes(*word))).sum();
    let checksum = !((sum & 0xFFFF) + (sum >> 16)) as u16;
    header[10..12].copy_from_slice(&checksum.to_be_bytes());
    header
}
