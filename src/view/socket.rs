//! A WebSocket that never keeps its thread waiting.
//!
//! What a client has not taken yet is kept, and until it has taken it nothing more is read of what it says: so whoever asks and
//! does not read waits for himself, and costs no memory. Who gives no sign of life for a minute is let go: a machine that was
//! switched off says nothing, and its place would be taken for ever.

use super::http::Request;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::os::fd::{AsFd as _, BorrowedFd};
use std::time::{Duration, Instant};
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Bytes, Error, Message, WebSocket};

/// Longest message that a client may send.
const MAX_MESSAGE_BYTES: usize = 64 << 10;
/// A client that has been silent for so long is asked whether it is there, as often.
const QUIET: Duration = Duration::from_secs(20);
/// One that has been silent for so long has gone.
const GONE: Duration = Duration::from_secs(60);

/// What a client says.
#[derive(Debug)]
pub(super) enum Said {
    Text(String),
    Binary(Bytes),
}

/// The server's end.
pub(super) struct Socket {
    web: WebSocket<Watched>,
    unsent: bool,
    asked: Instant,
}

/// A connection, and when its other end was last heard of.
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
            // There is room again, since the other end has taken something.
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
    /// Of a connection that was upgraded.
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

    /// What the client said, if it has said something, and has taken what was sent.
    ///
    /// # Errors
    /// When it has gone, or said what cannot be understood.
    pub(super) fn read(&mut self) -> Result<Option<Said>, Error> {
        while !self.unsent {
            match self.web.read() {
                Ok(Message::Text(text)) => return Ok(Some(Said::Text(text.as_str().to_owned()))),
                Ok(Message::Binary(bytes)) => return Ok(Some(Said::Binary(bytes))),
                // Answered by the library.
                Ok(_) => self.flush()?,
                Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => return Ok(None),
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// Asks a silent client whether it is there.
    ///
    /// # Errors
    /// When it has been silent for too long, or has gone.
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

    /// Sends, now or when there is room.
    ///
    /// # Errors
    /// When the client has gone.
    pub(super) fn send(&mut self, message: Message) -> Result<(), Error> {
        self.unsent = true;
        later(self.web.write(message))?;
        self.flush()
    }

    /// Sends what is left of messages.
    ///
    /// # Errors
    /// When the client has gone.
    pub(super) fn flush(&mut self) -> Result<(), Error> {
        self.unsent = !later(self.web.flush())?;
        Ok(())
    }

    /// Whether something waits for room.
    pub(super) fn has_unsent(&self) -> bool {
        self.unsent
    }

    pub(super) fn descriptor(&self) -> BorrowedFd<'_> {
        self.web.get_ref().stream.as_fd()
    }
}

/// Whether it is done now.
fn later(done: Result<(), Error>) -> Result<bool, Error> {
    match done {
        Ok(()) => Ok(true),
        Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => Ok(false),
        Err(error) => Err(error),
    }
}

/// Whether a request has all that a WebSocket needs.
pub(super) fn is_complete(request: &Request) -> bool {
    request.method == "GET"
        && request.header("sec-websocket-version") == Some("13")
        && request.header("sec-websocket-key").is_some_and(|key| key.len() == 24)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    /// The server's end, and a client's.
    fn ends() -> (Socket, WebSocket<TcpStream>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let stream = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let client = WebSocket::from_raw_socket(stream, Role::Client, None);
        (Socket::new(listener.accept().unwrap().0).unwrap(), client)
    }

    #[test]
    fn a_silent_client_is_asked_and_then_let_go() {
        let (mut socket, mut client) = ends();
        let begun = Instant::now();
        socket.keep_alive(begun + QUIET).unwrap();
        socket.keep_alive(begun + QUIET + QUIET / 2).unwrap();
        assert_eq!(client.read().unwrap(), Message::Ping(Bytes::new()));
        // The pong goes with what the client sends next.
        client.flush().unwrap();
        while socket.web.get_ref().heard < begun + Duration::from_nanos(1) {
            assert!(socket.read().unwrap().is_none());
        }
        let heard = socket.web.get_ref().heard;
        socket.keep_alive(heard + QUIET / 2).unwrap();
        assert!(socket.keep_alive(heard + GONE).is_err());
    }

    #[test]
    fn nothing_is_read_until_what_was_sent_is_taken() {
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
