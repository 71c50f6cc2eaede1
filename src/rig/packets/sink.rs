//! Where packets go.

use lidar_packets::pcap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::net::{SocketAddr, UdpSocket};
use std::path::PathBuf;

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

/// Somebody who gets packets.
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
    /// None if packets go nowhere.
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

    /// Whoever does not get it is told of once; the simulation goes on.
    pub(super) fn send(&mut self, packet: &[u8], port: u16, time_ns: u64) {
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
