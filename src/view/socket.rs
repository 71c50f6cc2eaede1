//! [`Socket`]: a WebSocket that never blocks its thread.
//!
//! Data that a client has not received yet is kept, and until it has received everything, none of its messages are
//! read. So a client that sends requests but does not read delays only itself and costs no memory. A client that is
//! silent for a minute is disconnected: a machine that was switched off sends nothing, and its place would otherwise be
//! taken for ever.

use super::http::Request;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::os::fd::{AsFd as _, BorrowedFd};
use std::time::{Duration, Instant};
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Bytes, Error, Message, WebSocket};

/// Longest message that a client may send, in bytes.
const MAX_MESSAGE_BYTES: usize = 64 << 10;
/// Time of silence after which a client is pinged, and the interval between pings.
const QUIET: Duration = Duration::from_secs(20);
/// Time of silence after which a client counts as disconnected.
const GONE: Duration = Duration::from_secs(60);

/// A message of a client.
#[derive(Debug)]
pub(super) enum Said {
    Text(String),
    Binary(Bytes),
}

/// The server's end of a WebSocket.
pub(super) struct Socket {
    web: WebSocket<Watched>,
    unsent: bool,
    asked: Instant,
}

/// A connection, with the time of the last sign of life from its other end.
struct Watched {
    stream: TcpStream,
    heard: Instant,
    is_full: bool,
}

impl Read for Watched {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.stream.read(bytes)?;
        self.heard = Instant::now();
        Ok(count)
    }
}

impl Write for Watched {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.stream.write(bytes);
        match &written {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => self.is_full = true,
            // There is room again, so the other end has received something.
            Ok(_) if self.is_full => (self.is_full, self.heard) = (false, Instant::now()),
            _ => {}
        }
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

impl Socket {
    /// Creates a socket from a connection that was upgraded.
    pub(super) fn new(stream: TcpStream) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        let config = WebSocketConfig::default()
            .read_buffer_size(8 << 10)
            .max_message_size(Some(MAX_MESSAGE_BYTES))
            .max_frame_size(Some(MAX_MESSAGE_BYTES));
        let now = Instant::now();
        let watched = Watched { stream, heard: now, is_full: false };
        let web = WebSocket::from_raw_socket(watched, Role::Server, Some(config));
        Ok(Self { web, unsent: false, asked: now })
    }

    /// Reads the client's next message, if there is one and the client has received everything that was sent.
    ///
    /// # Errors
    /// If the client has disconnected, or sent invalid data.
    pub(super) fn read(&mut self) -> Result<Option<Said>, Error> {
        while !self.unsent {
            match self.web.read() {
                Ok(Message::Text(text)) => return Ok(Some(Said::Text(text.as_str().to_owned()))),
                Ok(Message::Binary(bytes)) => return Ok(Some(Said::Binary(bytes))),
                // The library has prepared the answer to a ping or close.
                Ok(_) => self.flush()?,
                Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => return Ok(None),
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// Pings a silent client.
    ///
    /// # Errors
    /// If the client has been silent for too long, or has disconnected.
    pub(super) fn keep_alive(&mut self, now: Instant) -> Result<(), Error> {
        let silent = now.saturating_duration_since(self.web.get_ref().heard);
        if silent >= GONE {
            return Err(Error::Io(io::ErrorKind::TimedOut.into()));
        }
        if silent >= QUIET && now.saturating_duration_since(self.asked) >= QUIET && !self.unsent {
            self.asked = now;
            self.send(Message::Ping(Bytes::new()))?;
        }
        Ok(())
    }

    /// Sends a message, now or when there is room.
    ///
    /// # Errors
    /// If the client has disconnected.
    pub(super) fn send(&mut self, message: Message) -> Result<(), Error> {
        self.unsent = true;
        later(self.web.write(message))?;
        self.flush()
    }

    /// Sends the data that still waits.
    ///
    /// # Errors
    /// If the client has disconnected.
    pub(super) fn flush(&mut self) -> Result<(), Error> {
        self.unsent = !later(self.web.flush())?;
        Ok(())
    }

    /// Returns true if data waits for room.
    pub(super) fn has_unsent(&self) -> bool {
        self.unsent
    }

    pub(super) fn descriptor(&self) -> BorrowedFd<'_> {
        self.web.get_ref().stream.as_fd()
    }
}

/// Returns false if the operation would block.
fn later(done: Result<(), Error>) -> Result<bool, Error> {
    match done {
        Ok(()) => Ok(true),
        Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => Ok(false),
        Err(error) => Err(error),
    }
}

/// Returns true if a request is a valid WebSocket handshake.
pub(super) fn is_complete(request: &Request) -> bool {
    request.method == "GET"
        && request.header("sec-websocket-version") == Some("13")
        && request.header("sec-websocket-key").is_some_and(|key| key.len() == 24)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    /// Returns the server's end and the client's end of a connection.
    fn ends() -> (Socket, WebSocket<TcpStream>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let stream = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let client = WebSocket::from_raw_socket(stream, Role::Client, None);
        (Socket::new(listener.accept().unwrap().0).unwrap(), client)
    }

    #[test]
    fn a_silent_client_is_pinged_and_then_disconnected() {
        let (mut socket, mut client) = ends();
        let begun = Instant::now();
        socket.keep_alive(begun + QUIET).unwrap();
        socket.keep_alive(begun + QUIET + QUIET / 2).unwrap();
        assert_eq!(client.read().unwrap(), Message::Ping(Bytes::new()));
        // The pong is sent with the client's next message.
        client.flush().unwrap();
        while socket.web.get_ref().heard < begun + Duration::from_nanos(1) {
            assert!(socket.read().unwrap().is_none());
        }
        let heard = socket.web.get_ref().heard;
        socket.keep_alive(heard + QUIET / 2).unwrap();
        assert!(socket.keep_alive(heard + GONE).is_err());
    }

    #[test]
    fn nothing_is_read_until_the_client_has_received_everything() {
        let (mut socket, mut client) = ends();
        client.send(Message::text("first")).unwrap();
        let large = vec![0; 16 << 20];
        while !socket.has_unsent() {
            socket.send(Message::binary(large.clone())).unwrap();
        }
        assert!(socket.read().unwrap().is_none());
        let reader = std::thread::spawn(move || while client.read().is_ok() {});
        while socket.has_unsent() {
            socket.flush().unwrap();
        }
        assert!(matches!(socket.read().unwrap(), Some(Said::Text(text)) if text == "first"));
        drop(socket);
        reader.join().unwrap();
    }
}
