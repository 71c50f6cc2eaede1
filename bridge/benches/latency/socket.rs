//! A datagram of eight bytes between two processes, which shows the cost of waking a process on this machine.

use std::{os::unix::net::UnixDatagram, path::PathBuf, time::Duration};

use belvedere_bridge::clock::mono_ns;

use crate::{Sender, consumer::Receiver};

fn path(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("belvedere-{name}"))
}

pub(crate) struct Socket {
    socket: UnixDatagram,
    name: String,
}

impl Socket {
    pub(crate) fn open(name: &str) -> Self {
        Self { socket: UnixDatagram::unbound().expect("a socket"), name: name.to_owned() }
    }
}

impl Sender for Socket {
    fn send(&self) {
        self.socket.send_to(&mono_ns().to_ne_bytes(), path(&self.name)).expect("sent");
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(path(&self.name));
    }
}

pub(crate) struct SocketTaken(UnixDatagram);

impl SocketTaken {
    pub(crate) fn open(name: &str) -> Self {
        let socket = UnixDatagram::bind(path(name)).expect("a socket");
        socket.set_read_timeout(Some(Duration::from_secs(1))).expect("a time-out");
        Self(socket)
    }
}

impl Receiver for SocketTaken {
    fn take(&mut self) -> Option<u64> {
        let mut sent = [0; 8];
        self.0.recv(&mut sent).ok().map(|_| u64::from_ne_bytes(sent))
    }
}
