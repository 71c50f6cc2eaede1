//! A WebSocket that never keeps its thread waiting.

use super::http::Request;
use std::io;
use std::net::TcpStream;
use std::os::fd::{AsFd as _, BorrowedFd};
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Bytes, Error, Message, WebSocket};

/// Longest message that a client may send.
const MAX_MESSAGE_BYTES: usize = 64 << 10;

/// What a client says.
#[derive(Debug)]
pub(super) enum Said {
    Text(String),
    Binary(Bytes),
}

/// The server's end.
pub(super) struct Socket {
    web: WebSocket<TcpStream>,
    unsent: bool,
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
        Ok(Self { web: WebSocket::from_raw_socket(stream, Role::Server, Some(config)), unsent: false })
    }

    /// What the client said, if it has said something.
    ///
    /// # Errors
    /// When it has gone, or said what cannot be understood.
    pub(super) fn read(&mut self) -> Result<Option<Said>, Error> {
        loop {
            match self.web.read() {
                Ok(Message::Text(text)) => return Ok(Some(Said::Text(text.as_str().to_owned()))),
                Ok(Message::Binary(bytes)) => return Ok(Some(Said::Binary(bytes))),
                // Answered by the library.
                Ok(_) => self.flush()?,
                Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => return Ok(None),
                Err(error) => return Err(error),
            }
        }
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
        self.web.get_ref().as_fd()
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
