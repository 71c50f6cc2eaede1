//! Sends the data packets of lidars, in their makers' formats, over UDP or into files. The crate lidar-packets encodes
//! them. This module selects the encoder of a preset and sends its packets to their targets.

mod inertial;
mod sink;

use super::Rig;
use super::ouster::head_of;
use crate::description::model::{self, ImuProfile, PacketProfile};
use belvedere_sensors::scanner::Returns;
use belvedere_sensors::scanner::presets::{Maker, Preset};
pub(super) use inertial::ImuPackets;
use lidar_packets::ouster::{self, Device, Identity, LidarEncoder, LidarProfile, ProductLine};
use lidar_packets::velodyne::{self, Model, ReturnMode};
use lidar_packets::{Column, ColumnError};
use sink::PacketSink;
pub use sink::PacketTarget;
use std::io;
use std::str::FromStr;

/// A sensor and the target of its packets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Feed<T> {
    /// Name of the sensor, or one of its topics.
    pub sensor: String,
    /// The target.
    pub to: T,
}

/// Parses `SENSOR=ADDRESS:PORT` or `SENSOR=FILE`.
impl<T: FromStr> FromStr for Feed<T> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (sensor, to) = text
            .split_once('=')
            .filter(|(sensor, _)| !sensor.is_empty())
            .ok_or_else(|| format!("\"{text}\" is not SENSOR=… with the name of a lidar or its topic"))?;
        let to = to
            .parse()
            .map_err(|_| format!("\"{to}\" after = is not ADDRESS:PORT, such as 127.0.0.1:2368"))?;
        Ok(Self { sensor: sensor.into(), to })
    }
}

/// The encoder of a lidar's packets.
enum Encoder {
    Velodyne(Box<velodyne::Encoder>),
    Ouster { encoder: LidarEncoder, metadata: String },
}

impl Encoder {
    /// Creates the encoder of a lidar, or returns `None` if its packets are not supported.
    fn of(lidar: &model::Lidar) -> Option<Self> {
        let preset = lidar.preset?;
        match preset.maker {
            Maker::Velodyne => {
                let mode = return_mode(lidar.physics.returns)?;
                let model = velodyne_model(&preset)?;
                Some(Self::Velodyne(Box::new(velodyne::Encoder::new(model, mode))))
            }
            Maker::Ouster => {
                let device = Device {
                    product_line: product_line(&preset)?,
                    head: head_of(&preset),
                    rate_hz: preset.rate_hz,
                    lidar_profile: lidar_profile(lidar.profile),
                    imu_profile: imu_profile(lidar.imu_profile),
                    identity: Identity::default(),
                };
                let encoder = LidarEncoder::new(&device).ok()?;
                Some(Self::Ouster { encoder, metadata: device.metadata() })
            }
            _ => None,
        }
    }

    /// Returns the UDP port to which the device sends its packets.
    fn port(&self) -> u16 {
        match self {
            Self::Velodyne(_) => velodyne::PORT,
            Self::Ouster { .. } => ouster::LIDAR_PORT,
        }
    }

    fn push(&mut self, column: &Column<'_>) -> Result<Option<&[u8]>, ColumnError> {
        match self {
            Self::Velodyne(encoder) => Ok(encoder.push(column)?.map(<[u8; velodyne::PACKET_LEN]>::as_slice)),
            Self::Ouster { encoder, .. } => encoder.push(column),
        }
    }
}

fn velodyne_model(preset: &Preset) -> Option<Model> {
    match preset.name {
        "vlp16" => Some(Model::Vlp16),
        "hdl32e" => Some(Model::Hdl32e),
        "vls128" => Some(Model::Vls128),
        _ => None,
    }
}

fn return_mode(returns: Returns) -> Option<ReturnMode> {
    match returns {
        Returns::Strongest => Some(ReturnMode::Strongest),
        Returns::Last => Some(ReturnMode::Last),
        Returns::Dual => Some(ReturnMode::Dual),
        _ => None,
    }
}

fn product_line(preset: &Preset) -> Option<ProductLine> {
    match preset.name.get(..3)? {
        "os0" => Some(ProductLine::Os0),
        "os1" => Some(ProductLine::Os1),
        "os2" => Some(ProductLine::Os2),
        _ => None,
    }
}

fn lidar_profile(profile: PacketProfile) -> LidarProfile {
    match profile {
        PacketProfile::Legacy => LidarProfile::Legacy,
        PacketProfile::Rng19Rfl8Sig16Nir16 => LidarProfile::Rng19Rfl8Sig16Nir16,
        PacketProfile::Rng19Rfl8Sig16Nir16Dual => LidarProfile::Rng19Rfl8Sig16Nir16Dual,
        PacketProfile::Rng15Rfl8Nir8 => LidarProfile::Rng15Rfl8Nir8,
    }
}

fn imu_profile(profile: ImuProfile) -> ouster::ImuProfile {
    match profile {
        ImuProfile::Legacy => ouster::ImuProfile::Legacy,
        ImuProfile::Accel32Gyro32Nmea => ouster::ImuProfile::Accel32Gyro32Nmea,
    }
}

/// The packets of a scanner, with all their targets.
pub(super) struct Packets {
    encoder: Encoder,
    sinks: Vec<PacketSink>,
}

impl Packets {
    /// Creates the packets of a lidar, or returns `None` if they are not supported.
    pub(super) fn of(lidar: &model::Lidar) -> Option<Self> {
        Some(Self { encoder: Encoder::of(lidar)?, sinks: Vec::new() })
    }

    /// Returns the error for a lidar without supported packets.
    pub(super) fn unknown() -> io::Error {
        io::Error::other(
            "packets are supported only for presets of Ouster and of Velodyne, and for a Velodyne only with \
             strongest, last or dual returns",
        )
    }

    /// Checks that there is something to write to a target.
    pub(super) fn check(&self, target: &PacketTarget) -> io::Result<()> {
        match (target, &self.encoder) {
            (PacketTarget::Metadata(_), Encoder::Velodyne(_)) => {
                Err(io::Error::other("packets of Velodyne have no metadata; leave out --lidar-metadata"))
            }
            _ => Ok(()),
        }
    }

    /// Adds a target that was checked, or writes the metadata that a decoder needs.
    pub(super) fn open(&mut self, target: &PacketTarget) -> io::Result<()> {
        let file = match target {
            PacketTarget::Metadata(path) => Some(path.clone()),
            PacketTarget::Pcap(path) => Some(path.with_extension("json")),
            PacketTarget::Udp(_) => None,
        };
        if let (Some(file), Encoder::Ouster { metadata, .. }) = (file, &self.encoder) {
            std::fs::write(file, metadata)?;
        }
        self.sinks.extend(PacketSink::open(target)?);
        Ok(())
    }

    pub(super) fn is_wanted(&self) -> bool {
        !self.sinks.is_empty()
    }

    /// Discards the columns of an incomplete packet.
    pub(super) fn restart(&mut self) {
        match &mut self.encoder {
            Encoder::Velodyne(encoder) => encoder.restart(),
            Encoder::Ouster { encoder, .. } => encoder.restart(),
        }
    }

    /// Adds a column to the packet, and sends the packet if it is full.
    pub(super) fn push(&mut self, column: &Column<'_>) {
        let port = self.encoder.port();
        match self.encoder.push(column) {
            Ok(Some(packet)) => {
                self.sinks.iter_mut().for_each(|sink| sink.send(packet, port, column.time_ns));
            }
            Ok(None) => {}
            Err(error) => tracing::error!(%error, "the packets of a lidar lack a column"),
        }
    }
}

impl Rig {
    /// Also sends the data packets of sensors to targets. A sensor is given by its name or one of its topics. All are
    /// checked before the first target is opened.
    ///
    /// # Errors
    /// A message, if there is no such sensor, if it has no packets, or if a target cannot be opened.
    pub fn send_packets(&mut self, feeds: &[(&str, PacketTarget)]) -> Result<(), String> {
        let failed = |sensor: &str, error: io::Error| format!("packets of {sensor}: {error}");
        for (sensor, target) in feeds {
            self.find(sensor)?.channel.check_packets(target).map_err(|error| failed(sensor, error))?;
        }
        for (sensor, target) in feeds {
            self.find(sensor)?.channel.send_packets(target).map_err(|error| failed(sensor, error))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::load;
    use crate::description::model::SensorKind;
    use std::net::SocketAddr;

    /// Returns a lidar whose plugin has these elements.
    fn lidar(own: &str) -> model::Lidar {
        let model = format!(
            "<sdf version='1.6'><model name='m'><link name='l'><sensor name='s' type='ray'>
             <plugin filename='belvedere'>{own}</plugin></sensor></link></model></sdf>"
        );
        let SensorKind::Ray(lidar) = load::model(&model).unwrap().sensors.remove(0).kind else { panic!() };
        lidar
    }

    /// Returns the length of a lidar's packets and the last two bytes of the first one: for a Velodyne, return mode and
    /// model.
    fn first_packet(own: &str) -> Option<(usize, [u8; 2])> {
        let lidar = lidar(own);
        let mut encoder = Encoder::of(&lidar)?;
        let lasers = match lidar.preset?.pattern {
            belvedere_sensors::scanner::Pattern::Spinning(head) => head.lasers.len(),
            _ => return None,
        };
        let values = vec![1.0; lasers * lidar.physics.returns.count()];
        let mut columns = (0..24).map(|number| Column {
            frame: 0,
            number,
            time_ns: 0,
            turned: 0.0,
            ranges_m: &values,
            intensities: &values,
        });
        columns.find_map(|column| {
            let packet = encoder.push(&column).unwrap()?;
            Some((packet.len(), [packet[packet.len() - 2], packet[packet.len() - 1]]))
        })
    }

    #[test]
    fn presets_have_the_packets_of_their_device() {
        for (own, ending) in [
            ("<preset>vlp16</preset>", [0x37, 0x22]),
            (
                "<preset>hdl32e</preset><beam_divergence>0.003 0.0015</beam_divergence><returns>last</returns>",
                [0x38, 0x21],
            ),
            ("<preset>vls128</preset><returns>dual</returns>", [0x39, 0xA1]),
        ] {
            assert_eq!(first_packet(own), Some((1206, ending)), "{own}");
        }
        for (own, length) in [
            ("<preset>os1_32</preset><udp_profile_lidar>LEGACY</udp_profile_lidar>", 6464),
            ("<preset>os1_32</preset>", 6400),
            ("<preset>os0_64</preset><udp_profile_lidar>RNG15_RFL8_NIR8</udp_profile_lidar>", 4352),
            (
                "<preset>os2_128</preset><udp_profile_lidar>RNG19_RFL8_SIG16_NIR16_DUAL</udp_profile_lidar>",
                33_024,
            ),
        ] {
            assert_eq!(first_packet(own).map(|(length, _)| length), Some(length), "{own}");
        }
        assert_eq!(first_packet("<preset>rplidar_a1</preset>"), None);
        assert_eq!(first_packet("<preset>vlp16</preset><returns>mean</returns>"), None);
    }

    #[test]
    fn a_feed_is_a_sensor_and_a_place() {
        let feed: Feed<SocketAddr> = "points=127.0.0.1:2368".parse().unwrap();
        assert_eq!((feed.sensor.as_str(), feed.to.port()), ("points", 2368));
        for (text, says) in [
            ("127.0.0.1:2368", "is not SENSOR="),
            ("=1", "is not SENSOR="),
            ("a=b", "\"b\" after = is not ADDRESS:PORT"),
        ] {
            assert!(text.parse::<Feed<SocketAddr>>().unwrap_err().contains(says), "{text}");
        }
    }
}
