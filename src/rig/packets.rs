//! Data packets as a scanner's maker sends them, over UDP and into files.
//!
//! Of Velodyne (VLP-16 User Manual 63-9243, chapter 9): 1206 bytes, little-endian; 12 blocks of 100 bytes (0xEEFF, azimuth in
//! 0.01° clockwise, 32 × (distance in 2 mm, reflectivity)), time of the first firing in µs after the hour, return mode,
//! product. A block has two columns of 16 lasers, or one of 32, in the order in which they fire; the azimuth is that of its
//! first. Packets go on from frame to frame: what does not fill one waits for the next.

mod pcap;

use super::Rig;
use belvedere_sensors::scanner::presets::Preset;
use pcap::Pcap;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::str::FromStr;

/// Bytes of a packet.
const LEN: usize = 1206;
/// Blocks of a packet, bytes of one, and lasers in it.
const BLOCKS: usize = 12;
const BLOCK: usize = 100;
const LASERS: usize = 32;
/// Metres of a distance of 1.
const STEP_M: f32 = 0.002;
/// Return mode: the strongest.
const STRONGEST: u8 = 0x37;
/// Nanoseconds of an hour, after which the time of packets begins again.
const HOUR_NS: u64 = 3_600_000_000_000;

/// Where packets go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PacketTarget {
    /// To an address.
    Udp(SocketAddr),
    /// Into a file as Wireshark and drivers read it.
    Pcap(PathBuf),
}

/// Whose packets go where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Feed<T> {
    /// Name of the sensor, or a topic that it sends.
    pub sensor: String,
    /// Where to.
    pub to: T,
}

/// `SENSOR=ADDRESS:PORT` or `SENSOR=FILE`.
impl<T: FromStr> FromStr for Feed<T> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (sensor, to) = text
            .split_once('=')
            .filter(|(sensor, _)| !sensor.is_empty())
            .ok_or_else(|| format!("\"{text}\" is not SENSOR=… with the name of a lidar or its topic"))?;
        let to =
            to.parse().map_err(|_| format!("\"{to}\" after = is no address and port, as 127.0.0.1:2368"))?;
        Ok(Self { sensor: sensor.into(), to })
    }
}

/// What is fired together, in the order of the lasers.
pub(super) struct Column<'a> {
    /// Of its first firing, in ns.
    pub(super) time_ns: u64,
    /// Of the head then, clockwise, as a share of a turn.
    pub(super) turned: f64,
    /// Metres; those that are not finite are no return.
    pub(super) ranges: &'a [f32],
    pub(super) intensities: &'a [f32],
}

/// A scanner's packets, and everybody who gets them.
pub(super) struct Packets {
    product: u8,
    packet: [u8; LEN],
    /// Lasers that are in it.
    filled: usize,
    begun_ns: u64,
    sinks: Vec<PacketSink>,
}

impl Packets {
    /// Of a preset; none if its packets are not known.
    pub(super) fn of(preset: &Preset) -> Option<Self> {
        let product = match preset.name {
            "hdl32e" => 0x21,
            "vlp16" => 0x22,
            _ => return None,
        };
        Some(Self { product, packet: [0; LEN], filled: 0, begun_ns: 0, sinks: Vec::new() })
    }

    /// Sends them to somebody more.
    pub(super) fn open(&mut self, target: &PacketTarget) -> io::Result<()> {
        self.sinks.push(PacketSink::open(target)?);
        Ok(())
    }

    pub(super) fn is_wanted(&self) -> bool {
        !self.sinks.is_empty()
    }

    /// Forgets what waits.
    pub(super) fn restart(&mut self) {
        self.filled = 0;
    }

    /// Puts a column into the packet, and sends that if it is full.
    pub(super) fn push(&mut self, column: &Column<'_>) {
        if self.filled == 0 {
            self.begun_ns = column.time_ns;
        }
        let block = &mut self.packet[self.filled / LASERS * BLOCK..][..BLOCK];
        let first = self.filled % LASERS;
        if first == 0 {
            let hundredths = (column.turned * 36_000.0).round().rem_euclid(36_000.0) as u16;
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
            block[2..4].copy_from_slice(&hundredths.to_le_bytes());
        }
        let places = block[4 + 3 * first..].chunks_exact_mut(3);
        for ((place, range), intensity) in places.zip(column.ranges).zip(column.intensities) {
            let distance = if range.is_finite() { (range / STEP_M).round() as u16 } else { 0 };
            place[..2].copy_from_slice(&distance.to_le_bytes());
            place[2] = if distance == 0 { 0 } else { intensity.round() as u8 };
        }
        self.filled += column.ranges.len();
        if self.filled >= BLOCKS * LASERS {
            let micros = (self.begun_ns + 500) / 1000 % (HOUR_NS / 1000);
            self.packet[1200..1204].copy_from_slice(&(micros as u32).to_le_bytes());
            self.packet[1204..].copy_from_slice(&[STRONGEST, self.product]);
            for sink in &mut self.sinks {
                sink.send(&self.packet, column.time_ns);
            }
            self.filled = 0;
        }
    }
}

/// Somebody who gets packets.
struct PacketSink {
    kind: SinkKind,
    name: String,
    has_failed: bool,
}

enum SinkKind {
    Udp(UdpSocket, SocketAddr),
    Pcap(Pcap),
}

impl PacketSink {
    fn open(target: &PacketTarget) -> io::Result<Self> {
        let (kind, name) = match target {
            PacketTarget::Udp(to) => {
                let any: SocketAddr = if to.is_ipv4() { ([0; 4], 0).into() } else { ([0_u16; 8], 0).into() };
                (SinkKind::Udp(UdpSocket::bind(any)?, *to), to.to_string())
            }
            PacketTarget::Pcap(path) => (SinkKind::Pcap(Pcap::create(path)?), path.display().to_string()),
        };
        Ok(Self { kind, name, has_failed: false })
    }

    /// Whoever does not get it is told of once; the simulation goes on.
    fn send(&mut self, packet: &[u8; LEN], time_ns: u64) {
        let sent = match &mut self.kind {
            SinkKind::Udp(socket, to) => socket.send_to(packet, *to).map(|_| ()),
            SinkKind::Pcap(pcap) => pcap.write(packet, time_ns),
        };
        if let Err(error) = sent
            && !std::mem::replace(&mut self.has_failed, true)
        {
            tracing::warn!(to = self.name, %error, "packets of a lidar do not arrive");
        }
    }
}

impl Rig {
    /// Sends the data packets of a lidar, named or told by a topic that it sends, to somebody as well.
    ///
    /// # Errors
    /// In words: there is no such sensor, it has no packets, or they cannot go there.
    pub fn send_packets(&mut self, sensor: &str, target: &PacketTarget) -> Result<(), String> {
        self.find(sensor)?
            .channel
            .send_packets(target)
            .map_err(|error| format!("packets of {sensor}: {error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_sensors::scanner::presets::{HDL_32E, RPLIDAR_A1, VLP_16};
    use std::time::Duration;

    /// Bytes at the places that the manual gives.
    #[test]
    fn columns_become_the_packets_of_the_manual() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        for (preset, lasers, product) in [(VLP_16, 16, 0x22), (HDL_32E, 32, 0x21)] {
            let mut packets = Packets::of(&preset).unwrap();
            packets.open(&PacketTarget::Udp(receiver.local_addr().unwrap())).unwrap();
            let columns = 384 / lasers;
            for column in 0..columns {
                let ranges: Vec<f32> = (0..lasers)
                    .map(|id| if id == 3 { f32::INFINITY } else { 1.0 + 0.002 * id as f32 })
                    .collect();
                packets.push(&Column {
                    time_ns: 2 * HOUR_NS + 1_234_567 + 55_296 * column as u64,
                    turned: 0.999_96 + 0.0004 * column as f64,
                    ranges: &ranges,
                    intensities: &vec![300.0 - 100.0 * (column % 3) as f32; lasers],
                });
            }
            let mut packet = [0; 2000];
            assert_eq!(receiver.recv(&mut packet).unwrap(), 1206);
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
                        if id == 3 { (0, 0) } else { (500 + id as u16, [255, 200, 100][column % 3]) };
                    assert_eq!((u16_at(at), packet[at + 2]), (distance, reflectivity), "{block} {place}");
                }
            }
            assert_eq!(u32::from_le_bytes(packet[1200..1204].try_into().unwrap()), 1235);
            assert_eq!(packet[1204..1206], [0x37, product]);
        }
        assert!(Packets::of(&RPLIDAR_A1).is_none());
    }

    #[test]
    fn a_feed_is_a_sensor_and_a_place() {
        let feed: Feed<SocketAddr> = "points=127.0.0.1:2368".parse().unwrap();
        assert_eq!((feed.sensor.as_str(), feed.to.port()), ("points", 2368));
        for (text, says) in [
            ("127.0.0.1:2368", "is not SENSOR="),
            ("=1", "is not SENSOR="),
            ("a=b", "\"b\" after = is no address"),
        ] {
            assert!(text.parse::<Feed<SocketAddr>>().unwrap_err().contains(says), "{text}");
        }
    }
}
