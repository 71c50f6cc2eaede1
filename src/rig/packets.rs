//! Data packets as a scanner's maker sends them, over UDP and into files: a file a maker, and a row of it below.

#[cfg(test)]
mod any_input;
mod ouster;
mod pcap;
mod velodyne;

use super::Rig;
use crate::description::model;
use belvedere_sensors::scanner::presets::Maker;
pub(super) use ouster::ImuPackets;
use pcap::Pcap;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::str::FromStr;

/// Where packets go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PacketTarget {
    /// To an address.
    Udp(SocketAddr),
    /// Into a file as Wireshark and drivers read it.
    Pcap(PathBuf),
    /// Nowhere: what a decoder has to know of the device goes into this file.
    Metadata(PathBuf),
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
    /// Number of the frame, and of the column in it.
    pub(super) frame: u64,
    pub(super) number: usize,
    /// Of its first firing, in ns.
    pub(super) time_ns: u64,
    /// Of the head then, clockwise, as a share of a turn.
    pub(super) turned: f64,
    /// Of each laser.
    pub(super) returns: usize,
    /// Metres, those of a laser one after the other; those that are not finite are no return.
    pub(super) ranges: &'a [f32],
    pub(super) intensities: &'a [f32],
}

/// How a maker packs columns.
trait Protocol {
    /// The port that they are sent to.
    fn port(&self) -> u16;

    /// Puts a column into the packet; that, if it is full now.
    fn push(&mut self, column: &Column<'_>) -> Option<&[u8]>;

    /// Forgets what waits.
    fn restart(&mut self);

    /// What a decoder has to know of the device, as JSON; none if packets say it all.
    fn metadata(&self) -> Option<String> {
        None
    }
}

/// Makers whose packets are known, and those of a lidar of theirs.
type Row = (Maker, fn(&model::Lidar) -> Option<Box<dyn Protocol>>);
const PROTOCOLS: [Row; 2] = [(Maker::Ouster, ouster::of), (Maker::Velodyne, velodyne::of)];

/// A scanner's packets, and everybody who gets them.
pub(super) struct Packets {
    protocol: Box<dyn Protocol>,
    sinks: Vec<PacketSink>,
}

impl Packets {
    /// Of a lidar; none if its packets are not known.
    pub(super) fn of(lidar: &model::Lidar) -> Option<Self> {
        let maker = lidar.preset?.maker;
        let (_, open) = PROTOCOLS.iter().find(|(known, _)| *known == maker)?;
        Some(Self { protocol: open(lidar)?, sinks: Vec::new() })
    }

    /// That they are not.
    pub(super) fn unknown() -> io::Error {
        let makers = PROTOCOLS.map(|(maker, _)| format!("{maker:?}"));
        io::Error::other(format!(
            "packets are known of presets of {} alone, Velodyne's of the strongest, the last or dual returns",
            makers.join(" and ")
        ))
    }

    /// Sends them to somebody more, or writes what a decoder has to know of the device.
    pub(super) fn open(&mut self, target: &PacketTarget) -> io::Result<()> {
        let metadata = self.protocol.metadata();
        match (target, metadata) {
            (PacketTarget::Metadata(path), Some(metadata)) => return std::fs::write(path, metadata),
            (PacketTarget::Metadata(_), None) => {
                return Err(io::Error::other("its packets need no metadata"));
            }
            (PacketTarget::Pcap(path), Some(metadata)) => {
                std::fs::write(path.with_extension("json"), metadata)?;
            }
            (PacketTarget::Pcap(_) | PacketTarget::Udp(_), _) => {}
        }
        self.sinks.extend(PacketSink::open(target)?);
        Ok(())
    }

    pub(super) fn is_wanted(&self) -> bool {
        !self.sinks.is_empty()
    }

    /// Forgets what waits.
    pub(super) fn restart(&mut self) {
        self.protocol.restart();
    }

    /// Puts a column into the packet, and sends that if it is full.
    pub(super) fn push(&mut self, column: &Column<'_>) {
        let port = self.protocol.port();
        if let Some(packet) = self.protocol.push(column) {
            self.sinks.iter_mut().for_each(|sink| sink.send(packet, port, column.time_ns));
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
    /// None if packets go nowhere.
    fn open(target: &PacketTarget) -> io::Result<Option<Self>> {
        let (kind, name) = match target {
            PacketTarget::Udp(to) => {
                let any: SocketAddr = if to.is_ipv4() { ([0; 4], 0).into() } else { ([0_u16; 8], 0).into() };
                (SinkKind::Udp(UdpSocket::bind(any)?, *to), to.to_string())
            }
            PacketTarget::Pcap(path) => (SinkKind::Pcap(Pcap::create(path)?), path.display().to_string()),
            PacketTarget::Metadata(_) => return Ok(None),
        };
        Ok(Some(Self { kind, name, has_failed: false }))
    }

    /// Whoever does not get it is told of once; the simulation goes on.
    fn send(&mut self, packet: &[u8], port: u16, time_ns: u64) {
        let sent = match &mut self.kind {
            SinkKind::Udp(socket, to) => socket.send_to(packet, *to).map(|_| ()),
            SinkKind::Pcap(pcap) => pcap.write(packet, port, time_ns),
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
    use crate::rig::pace::lidar;
    use std::time::Duration;
    use velodyne::HOUR_NS;

    /// Bytes at the places that the manual gives.
    #[test]
    fn columns_become_the_packets_of_the_manual() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        for (preset, lasers, product) in [("vlp16", 16, 0x22), ("hdl32e", 32, 0x21)] {
            let mut packets = Packets::of(&lidar(&format!("<preset>{preset}</preset>"))).unwrap();
            packets.open(&PacketTarget::Udp(receiver.local_addr().unwrap())).unwrap();
            let columns = 384 / lasers;
            for column in 0..columns {
                // No return, and one from farther than can be told.
                let ranges: Vec<f32> = (0..lasers)
                    .map(|id| match id {
                        3 => f32::INFINITY,
                        5 => 131.08,
                        _ => 1.0 + 0.002 * id as f32,
                    })
                    .collect();
                packets.push(&Column {
                    frame: 1,
                    number: column,
                    time_ns: 2 * HOUR_NS + 1_234_567 + 55_296 * column as u64,
                    turned: 0.999_96 + 0.0004 * column as f64,
                    returns: 1,
                    ranges: &ranges,
                    intensities: &vec![[300.0, 200.0, -2.0][column % 3]; lasers],
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
                    let (distance, reflectivity) = if [3, 5].contains(&id) {
                        (0, 0)
                    } else {
                        (500 + id as u16, [255, 200, 0][column % 3])
                    };
                    assert_eq!((u16_at(at), packet[at + 2]), (distance, reflectivity), "{block} {place}");
                }
            }
            assert_eq!(u32::from_le_bytes(packet[1200..1204].try_into().unwrap()), 1235);
            assert_eq!(packet[1204..1206], [0x37, product]);
        }
        assert!(Packets::of(&lidar("<preset>rplidar_a1</preset>")).is_none());
    }

    /// Bytes at the places that Ouster's documents give.
    #[test]
    fn columns_become_the_packets_of_ousters_profiles() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        for (profile, length, header, column_header, channel) in [
            ("LEGACY", 6464, 0, 16, 12),
            ("RNG19_RFL8_SIG16_NIR16", 6400, 32, 12, 12),
            ("RNG15_RFL8_NIR8", 2304, 32, 12, 4),
        ] {
            let own = format!("<preset>os1_32</preset><udp_profile_lidar>{profile}</udp_profile_lidar>");
            let mut packets = Packets::of(&lidar(&own)).unwrap();
            packets.open(&PacketTarget::Udp(receiver.local_addr().unwrap())).unwrap();
            let ranges: Vec<f32> =
                (0..32).map(|id| if id == 3 { f32::INFINITY } else { 1.0 + 0.5 * id as f32 }).collect();
            // What a reset cuts off is not sent.
            for number in (0..5).chain(32..48) {
                packets.push(&Column {
                    frame: 65_536 + 7,
                    number,
                    time_ns: 1_000_000_007 + 97_656 * number as u64,
                    turned: number as f64 / 1024.0,
                    returns: 1,
                    ranges: &ranges,
                    intensities: &[300.0; 32],
                });
            }
            let mut packet = [0; 10_000];
            assert_eq!(receiver.recv(&mut packet).unwrap(), length);
            let u16_at = |at: usize| u16::from_le_bytes([packet[at], packet[at + 1]]);
            let u32_at = |at: usize| u32::from_le_bytes(packet[at..at + 4].try_into().unwrap());
            let is_legacy = profile == "LEGACY";
            if !is_legacy {
                assert_eq!((u16_at(0), u16_at(2), packet[4], packet[7]), (1, 7, 1, 1));
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
