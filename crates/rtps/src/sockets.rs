//! The sockets of a participant, and the ports that they listen at (9.6.1).

use std::io::{self, IoSlice};
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::os::fd::{AsFd, OwnedFd};
use std::time::Duration;

use rustix::event::{EventfdFlags, PollFd, PollFlags, Timespec, eventfd, poll};
use rustix::net::{AddressFamily, SendAncillaryBuffer, SendFlags, SocketFlags, SocketType, sockopt};

use crate::peer::Link;

const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 0, 1);

/// What is asked for datagrams that wait; the kernel gives what it allows.
const BUFFER: usize = 4 << 20;

/// How long a datagram waits for room on its way into a network.
const LONGEST_SEND: Duration = Duration::from_millis(10);

/// At most so many participants of a host listen at ports of a domain.
const PARTICIPANTS: u16 = 120;

/// The port at which all participants of a domain listen to the group, and with it the first of the domain.
fn first_port(domain: u16) -> u16 {
    7400 + 250 * domain
}

/// How far a participant is seen, as `ROS_AUTOMATIC_DISCOVERY_RANGE` has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Range {
    /// By all hosts that multicast reaches.
    #[default]
    Subnet,
    /// On this host, and by peers that are named.
    Localhost,
    /// By nobody.
    Off,
}

/// Which networks an announcement has reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Announced {
    Everywhere,
    /// Some of them are down.
    Somewhere,
    Nowhere,
}

/// The sockets of a participant.
#[derive(Debug)]
pub(crate) struct Sockets {
    group: Option<UdpSocket>,
    discovery: UdpSocket,
    user: UdpSocket,
    /// The addresses of this host.
    own: Vec<Ipv4Addr>,
    /// The addresses of the networks whose participants and this one find each other without being named as peers.
    near: Vec<Ipv4Addr>,
    /// Other hosts whose participants are told of this one.
    peers: Vec<Ipv4Addr>,
    range: Range,
    domain: u16,
}

/// Why a participant cannot join a domain.
#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    /// The largest domain is 232.
    #[error("domain {0} does not exist: ports of domains end with 232, so choose one from 0 to 232")]
    Domain(u32),
    /// The name or namespace of the node is none.
    #[error("\"{0}\" is not the {1} of a node; write {2}, with letters, digits and _, at most 255")]
    Node(String, &'static str, &'static str),
    /// All ports are in use, or may not be used.
    #[error(
        "no pair of UDP ports from {first} to {last}, those of domain {domain}, can be listened at: {source}; \
         end programs that use them, or choose another domain (ROS_DOMAIN_ID)"
    )]
    Ports {
        /// The domain.
        domain: u16,
        /// Its first port for a participant.
        first: u16,
        /// Its last one.
        last: u16,
        /// What the last attempt failed with.
        source: io::Error,
    },
    /// Another call of the kernel failed.
    #[error("a socket of the DDS participant cannot be made: {0}")]
    System(#[from] io::Error),
}

impl Sockets {
    /// Listens at the first free ports of a domain.
    pub(crate) fn open(number: u32, range: Range, peers: &[Ipv4Addr]) -> Result<Sockets, JoinError> {
        let domain = u16::try_from(number).ok().filter(|&domain| domain <= 232);
        let domain = domain.ok_or(JoinError::Domain(number))?;
        let first = first_port(domain) + 10;
        let here = vec![Ipv4Addr::LOCALHOST];
        let has_far_peers = range == Range::Localhost && !peers.iter().all(Ipv4Addr::is_loopback);
        let (any, own) = if range == Range::Subnet || has_far_peers {
            (Ipv4Addr::UNSPECIFIED, own_addresses())
        } else {
            (Ipv4Addr::LOCALHOST, here.clone())
        };
        let near = match range {
            Range::Subnet => own.clone(),
            Range::Localhost => here,
            Range::Off => Vec::new(),
        };
        let peers = if range == Range::Off { Vec::new() } else { peers.to_vec() };
        let mut last_error = None;
        for number in 0..PARTICIPANTS {
            let Some(port) = first.checked_add(2 * number).filter(|&port| port < u16::MAX) else { break };
            let pair = UdpSocket::bind((any, port)).and_then(|a| Ok((a, UdpSocket::bind((any, port + 1))?)));
            match pair {
                Ok((discovery, user)) => {
                    for socket in [&discovery, &user] {
                        socket.set_nonblocking(true)?;
                        // What is given may be less, and is enough.
                        let _ = sockopt::set_socket_recv_buffer_size(socket, BUFFER);
                        let _ = sockopt::set_socket_send_buffer_size(socket, BUFFER);
                        socket.set_multicast_loop_v4(true)?;
                    }
                    let group = listen_to_group(first_port(domain), &near)?;
                    return Ok(Sockets { group, discovery, user, own, near, peers, range, domain });
                }
                Err(error) => last_error = Some(error),
            }
        }
        let last = first.saturating_add(2 * PARTICIPANTS - 1);
        let source = last_error.unwrap_or_else(|| io::ErrorKind::AddrInUse.into());
        Err(JoinError::Ports { domain, first, last, source })
    }

    pub(crate) fn group(&self) -> SocketAddrV4 {
        SocketAddrV4::new(GROUP, first_port(self.domain))
    }

    /// The group, if others reach this participant by it. On networks where only peers find it, it does not listen to the
    /// group.
    pub(crate) fn announced_group(&self) -> Option<SocketAddrV4> {
        (self.near == self.own).then(|| self.group())
    }

    /// Returns true if this participant neither finds others nor is found by them.
    pub(crate) fn is_off(&self) -> bool {
        self.range == Range::Off
    }

    /// Where the first participants of this host listen, for hosts without a network that carries multicast.
    pub(crate) fn neighbours(&self) -> impl Iterator<Item = SocketAddrV4> {
        let here = (!self.is_off()).then_some(Ipv4Addr::LOCALHOST);
        here.into_iter().flat_map(|here| self.first_participants(here))
    }

    /// Where the first participants of the peers listen.
    pub(crate) fn peers(&self) -> impl Iterator<Item = SocketAddrV4> {
        self.peers.iter().flat_map(|&peer| self.first_participants(peer))
    }

    fn first_participants(&self, host: Ipv4Addr) -> impl Iterator<Item = SocketAddrV4> + use<> {
        let first = first_port(self.domain) + 10;
        (0..10).map(move |number| SocketAddrV4::new(host, first + 2 * number))
    }

    /// The addresses at which others reach this participant: those of networks, or of this host if there is no network.
    fn reachable(&self) -> impl Iterator<Item = Ipv4Addr> {
        let networks = self.own.iter().any(|address| !address.is_loopback());
        self.own.iter().copied().filter(move |address| !networks || !address.is_loopback())
    }

    /// Where the readers and writers of discovery listen.
    pub(crate) fn discovery_locators(&self) -> io::Result<Vec<SocketAddrV4>> {
        let port = self.discovery.local_addr()?.port();
        Ok(self.reachable().map(|address| SocketAddrV4::new(address, port)).collect())
    }

    /// Where the other readers and writers listen.
    pub(crate) fn user_locators(&self) -> io::Result<Vec<SocketAddrV4>> {
        let port = self.user.local_addr()?.port();
        Ok(self.reachable().map(|address| SocketAddrV4::new(address, port)).collect())
    }

    /// Sends to all participants of the domain, on every network. A network that is down does not keep the others from
    /// the datagram.
    pub(crate) fn announce(&self, datagram: &[u8]) -> Announced {
        let reaches = |address: &&Ipv4Addr| {
            sockopt::set_ip_multicast_if(&self.discovery, address).is_ok()
                && self.discovery.send_to(datagram, self.group()).is_ok()
        };
        match self.near.iter().filter(reaches).count() {
            reached if reached == self.near.len() => Announced::Everywhere,
            0 => Announced::Nowhere,
            _ => Announced::Somewhere,
        }
    }

    /// The best of a peer's addresses, if its announcement came from `seen`.
    pub(crate) fn choose(&self, locators: &[SocketAddrV4], seen: Ipv4Addr) -> Option<SocketAddrV4> {
        let is_here = self.own.contains(&seen);
        let find =
            |fits: &dyn Fn(&Ipv4Addr) -> bool| locators.iter().find(|locator| fits(locator.ip())).copied();
        find(&|ip| *ip == seen)
            .or_else(|| find(&|ip| is_here && self.own.contains(ip)))
            .or_else(|| find(&|ip| !ip.is_loopback()))
            .or_else(|| locators.first().copied())
    }

    /// Waits until there is something to read, someone wakes the thread, or the time has passed. Then reads up to `most` datagrams
    /// of each socket, and says where each came from.
    pub(crate) fn wait(
        &self,
        waker: &Waker,
        timeout: Duration,
        most: usize,
        buffer: &mut [u8],
        mut take: impl FnMut(&[u8], SocketAddrV4),
    ) {
        let sockets = [Some(&self.discovery), Some(&self.user), self.group.as_ref()];
        let mut files = vec![PollFd::new(&waker.0, PollFlags::IN)];
        files.extend(sockets.into_iter().flatten().map(|socket| PollFd::new(socket, PollFlags::IN)));
        let (tv_sec, tv_nsec) = (timeout.as_secs() as i64, i64::from(timeout.subsec_nanos()));
        if poll(&mut files, Some(&Timespec { tv_sec, tv_nsec })).is_err() {
            // Interrupted: the caller comes back.
            return;
        }
        let ready: Vec<bool> = files.iter().map(|file| !file.revents().is_empty()).collect();
        if ready[0] {
            waker.clear();
        }
        for (socket, _) in sockets.into_iter().flatten().zip(&ready[1..]).filter(|(_, ready)| **ready) {
            for _ in 0..most {
                // An error says that there is nothing, or belongs to an earlier datagram, which nobody took.
                match socket.recv_from(buffer) {
                    Ok((length, std::net::SocketAddr::V4(from))) => {
                        // If another program of this host listens to the group on a network, that network is heard, too.
                        let is_group = self.group.as_ref().is_some_and(|group| std::ptr::eq(group, socket));
                        let is_far = self.range == Range::Localhost && !self.own.contains(from.ip());
                        if !(is_group && is_far) {
                            take(&buffer[..length], from);
                        }
                    }
                    Ok(_) => {}
                    Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                    Err(_) => break,
                }
            }
        }
    }
}

impl Link for &Sockets {
    fn send(&mut self, to: SocketAddrV4, parts: [&[u8]; 3]) {
        let parts = parts.map(IoSlice::new);
        let send = || {
            let mut control = SendAncillaryBuffer::default();
            rustix::net::sendmsg_addr(self.user.as_fd(), &to, &parts, &mut control, SendFlags::empty())
        };
        // A network that is slower than the pace makes the thread wait. A datagram that cannot be sent is lost like others, and
        // asked for again.
        if send() == Err(rustix::io::Errno::WOULDBLOCK) {
            let wait = Timespec { tv_sec: 0, tv_nsec: LONGEST_SEND.as_nanos() as i64 };
            let _ = poll(&mut [PollFd::new(&self.user, PollFlags::OUT)], Some(&wait));
            let _ = send();
        }
    }
}

/// Listens to the group, at the port that all participants share. Without a network that carries it: `None`.
fn listen_to_group(port: u16, own: &[Ipv4Addr]) -> io::Result<Option<UdpSocket>> {
    let flags = SocketFlags::CLOEXEC | SocketFlags::NONBLOCK;
    let socket: OwnedFd = rustix::net::socket_with(AddressFamily::INET, SocketType::DGRAM, flags, None)?;
    sockopt::set_socket_reuseaddr(&socket, true)?;
    rustix::net::bind(&socket, &SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, port))?;
    let mut joined = false;
    for address in own {
        joined |= sockopt::set_ip_add_membership(&socket, &GROUP, address).is_ok();
    }
    Ok(joined.then(|| socket.into()))
}

/// The addresses of this host, from the kernel's table of routes.
fn own_addresses() -> Vec<Ipv4Addr> {
    let table = std::fs::read_to_string("/proc/net/fib_trie").unwrap_or_default();
    let mut own = local_addresses(&table);
    if own.is_empty() {
        own.push(Ipv4Addr::LOCALHOST);
    }
    own
}

/// A line with an address, `|-- 127.0.0.1`, is followed by one that says what it is, `/32 host LOCAL`.
fn local_addresses(table: &str) -> Vec<Ipv4Addr> {
    let mut own = Vec::new();
    let mut address: Option<Ipv4Addr> = None;
    for line in table.lines().map(str::trim) {
        if let Some(leaf) = line.strip_prefix("|-- ") {
            address = leaf.parse().ok();
        } else if line.starts_with("/32 host LOCAL") {
            own.extend(address.take());
        }
    }
    own.sort_unstable();
    own.dedup();
    own
}

/// Ends a wait from another thread.
#[derive(Debug)]
pub(crate) struct Waker(OwnedFd);

impl Waker {
    pub(crate) fn new() -> io::Result<Waker> {
        Ok(Waker(eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?))
    }

    pub(crate) fn wake(&self) {
        // It fails only when it is set already, as often as it can be.
        let _ = rustix::io::write(&self.0, &1_u64.to_ne_bytes());
    }

    fn clear(&self) {
        let _ = rustix::io::read(&self.0, &mut [0; 8]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_addresses_of_the_host_are_those_of_the_table() {
        let table = "Main:\n  +-- 0.0.0.0/0 3 0 5\n     |-- 0.0.0.0\n        /0 universe UNICAST\n     \
                     |-- 172.17.0.0\n        /16 link UNICAST\nLocal:\n     |-- 172.17.0.1\n        /32 host LOCAL\n     \
                     |-- 172.17.255.255\n        /32 link BROADCAST\n        |-- 127.0.0.0\n           /8 host LOCAL\n           \
                     |-- 127.0.0.1\n              /32 host LOCAL\n";
        assert_eq!(local_addresses(table), [Ipv4Addr::LOCALHOST, Ipv4Addr::new(172, 17, 0, 1)]);
    }
}
