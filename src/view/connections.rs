//! [`Connections`]: the open connections, with limits for each standing, and the choice of the one that is closed.
//!
//! Any program on the machine can open connections that never present the token. If there are too many of these, the
//! oldest is closed. They take no places from connections that have presented the token, so they cannot lock out the
//! user.

use std::io;
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Most simultaneous connections that have not presented the token.
const MAX_UNKNOWN: usize = 32;
/// Most simultaneous connections that have presented the token, apart from clients.
const MAX_KNOWN: usize = 32;
/// Most simultaneous clients (`WebSocket` connections): a stream has room for eight subscribers, which other programs
/// need as well.
pub(super) const MAX_CLIENTS: usize = 6;

/// The category in which a connection is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// It has not presented the token yet.
    Unknown,
    /// It has presented the token.
    Known,
    /// It is a `WebSocket`.
    Client,
}

/// The open connections, in the order in which they were opened.
#[derive(Debug, Default)]
pub(super) struct Connections(Mutex<Table>);

#[derive(Debug, Default)]
struct Table {
    last_number: u64,
    open: Vec<Open>,
}

#[derive(Debug)]
struct Open {
    number: u64,
    standing: Standing,
    /// A second handle of the connection, used to close it.
    stream: TcpStream,
}

impl Connections {
    /// Registers a new connection. If there are too many unknown ones, the oldest of them is closed.
    ///
    /// # Errors
    /// If the process has no file descriptor left.
    pub(super) fn enter(self: &Arc<Self>, stream: &TcpStream) -> io::Result<Place> {
        let stream = stream.try_clone()?;
        let mut table = self.table();
        if table.count(Standing::Unknown) >= MAX_UNKNOWN
            && let Some(oldest) = table.open.iter().position(|open| open.standing == Standing::Unknown)
        {
            // The connection's thread gets an error from its next read or write and ends.
            let _ = table.open.remove(oldest).stream.shutdown(Shutdown::Both);
        }
        table.last_number += 1;
        let number = table.last_number;
        table.open.push(Open { number, standing: Standing::Unknown, stream });
        Ok(Place { connections: self.clone(), number })
    }

    fn table(&self) -> MutexGuard<'_, Table> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Table {
    fn count(&self, standing: Standing) -> usize {
        self.open.iter().filter(|open| open.standing == standing).count()
    }
}

/// The registration of a connection, released on drop, however its thread ends.
#[derive(Debug)]
pub(super) struct Place {
    connections: Arc<Connections>,
    number: u64,
}

impl Place {
    /// Counts the connection in this category from now on. Returns false if there are too many of them, or if the
    /// connection has been closed meanwhile.
    pub(super) fn rise_to(&self, standing: Standing) -> bool {
        let most = match standing {
            Standing::Unknown => MAX_UNKNOWN,
            Standing::Known => MAX_KNOWN,
            Standing::Client => MAX_CLIENTS,
        };
        let mut table = self.connections.table();
        if table.count(standing) >= most {
            return false;
        }
        let own = table.open.iter_mut().find(|open| open.number == self.number);
        own.map(|own| own.standing = standing).is_some()
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.connections.table().open.retain(|open| open.number != self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read as _;
    use std::net::TcpListener;

    /// A connection's two ends.
    fn connect(listener: &TcpListener) -> (TcpStream, TcpStream) {
        let near = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        (near, listener.accept().unwrap().0)
    }

    #[test]
    fn the_oldest_connection_without_the_token_is_closed() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let connections = Arc::new(Connections::default());
        let mut ends: Vec<_> = (0..=MAX_UNKNOWN).map(|_| connect(&listener)).collect();
        let mut places: Vec<_> =
            ends[..MAX_UNKNOWN].iter().map(|(_, far)| connections.enter(far).unwrap()).collect();
        // The first one has presented the token, so the second is the oldest of those that have not.
        assert!(places[0].rise_to(Standing::Known));
        places.push(connections.enter(&ends[MAX_UNKNOWN].1).unwrap());
        let (more, far) = connect(&listener);
        places.push(connections.enter(&far).unwrap());
        assert_eq!(ends[1].0.read(&mut [0]).unwrap(), 0);
        assert!(!places[1].rise_to(Standing::Known), "a closed connection is not accepted");
        for open in [&ends[0].0, &ends[2].0, &more] {
            open.set_nonblocking(true).unwrap();
            assert_eq!((&*open).read(&mut [0]).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        }
    }

    #[test]
    fn places_are_limited_and_given_back_by_threads_that_panic() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let connections = Arc::new(Connections::default());
        let enter = || {
            let (_, far) = connect(&listener);
            connections.enter(&far).unwrap()
        };
        let clients: Vec<_> = (0..MAX_CLIENTS).map(|_| enter()).collect();
        assert!(clients.iter().all(|place| place.rise_to(Standing::Client)));
        let next = enter();
        assert!(!next.rise_to(Standing::Client));
        let panicking = std::thread::spawn(move || {
            let _places = clients;
            std::panic::resume_unwind(Box::new("on purpose"));
        });
        assert!(panicking.join().is_err());
        assert!(next.rise_to(Standing::Client));
    }
}
