//! The targets of packets.

use lidar_packets::pcap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::net::{SocketAddr, UdpSocket};
use std::path::PathBuf;

/// A target of packets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PacketTarget {
    /// A UDP address.
    Udp(SocketAddr),
    /// A pcap file, which Wireshark and drivers can read.
    Pcap(PathBuf),
    /// A file for the device's metadata, which a decoder needs. No packets are sent.
    Metadata(PathBuf),
}

/// An open target.
pub(super) struct PacketSink {
    kind: SinkKind,
    name: String,
    has_failed: bool,
}

enum SinkKind {
    Udp(UdpSocket, SocketAddr),
    Pcap(pcap::Writer<BufWriter<File>>),
}

impl PacketSink {
    /// Opens a target. Returns `None` if it receives no packets.
    pub(super) fn open(target: &PacketTarget) -> io::Result<Option<Self>> {
        let (kind, name) = match target {
            PacketTarget::Udp(to) => {
                let any: SocketAddr = if to.is_ipv4() { ([0; 4], 0).into() } else { ([0_u16; 8], 0).into() };
                (SinkKind::Udp(UdpSocket::bind(any)?, *to), to.to_string())
            }
            PacketTarget::Pcap(path) => {
                let file = pcap::Writer::new(BufWriter::new(File::create(path)?))?;
                (SinkKind::Pcap(file), path.display().to_string())
            }
            PacketTarget::Metadata(_) => return Ok(None),
        };
        Ok(Some(Self { kind, name, has_failed: false }))
    }

    /// Sends a packet. A failure is logged once per target; the simulation continues.
    pub(super) fn send(&mut self, packet: &[u8], port: u16, time_ns: u64) {
        let sent = match &mut self.kind {
            SinkKind::Udp(socket, to) => socket.send_to(packet, *to).map(|_| ()),
            SinkKind::Pcap(pcap) => pcap.write(packet, port, time_ns),
        };
        if let Err(error) = sent
            && !std::mem::replace(&mut self.has_failed, true)
        {
            tracing::warn!(to = self.name, %error, "packets of a lidar cannot be sent");
        }
    }
}
