//! [`Pipe`]: sends frames to a page in an HTTP answer that does not end, which browsers receive many times as fast as
//! messages of a WebSocket. All other messages use the page's WebSocket.

use super::http;
use std::collections::HashMap;
use std::io::{self, Write as _};
use std::net::TcpStream;
use std::os::fd::{AsFd as _, BorrowedFd};
use std::sync::{Mutex, PoisonError};

/// A connection for frames, each preceded by its length in four bytes, little-endian.
#[derive(Debug)]
pub(super) struct Pipe {
    stream: TcpStream,
    /// Frames that are not sent yet; the first `sent` bytes are.
    unsent: Vec<u8>,
    sent: usize,
}

impl Pipe {
    /// Starts the answer.
    ///
    /// # Errors
    /// If the page has disconnected.
    pub(super) fn open(mut stream: TcpStream) -> io::Result<Self> {
        http::begin(&mut stream, "application/octet-stream")?;
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        Ok(Self { stream, unsent: Vec::new(), sent: 0 })
    }

    /// Sends a frame, now or when there is room.
    ///
    /// # Errors
    /// If the page has disconnected.
    pub(super) fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        self.unsent.extend_from_slice(&(frame.len() as u32).to_le_bytes());
        self.unsent.extend_from_slice(frame);
        self.flush()
    }

    /// Sends the bytes that still wait.
    ///
    /// # Errors
    /// If the page has disconnected.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        while self.has_unsent() {
            match self.stream.write(&self.unsent[self.sent..]) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => self.sent += count,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.unsent.clear();
        self.sent = 0;
        Ok(())
    }

    /// Returns true if bytes wait for room.
    pub(super) fn has_unsent(&self) -> bool {
        self.sent < self.unsent.len()
    }

    pub(super) fn descriptor(&self) -> BorrowedFd<'_> {
        self.stream.as_fd()
    }
}

/// The connected pages by name, with their new pipes that have not been taken yet.
#[derive(Debug, Default)]
pub(super) struct Pipes(Mutex<HashMap<String, Option<Pipe>>>);

impl Pipes {
    /// Registers a page, which may open a pipe from now on.
    pub(super) fn expect(&self, page: &str) {
        self.with(|pages| pages.insert(page.to_owned(), None));
    }

    /// Returns true if this page is connected.
    pub(super) fn is_expected(&self, page: &str) -> bool {
        self.with(|pages| pages.contains_key(page))
    }

    /// Adds a page's pipe, in place of an earlier one. If the page has disconnected, the pipe is closed.
    pub(super) fn bring(&self, page: &str, pipe: Pipe) {
        self.with(|pages| {
            if let Some(place) = pages.get_mut(page) {
                *place = Some(pipe);
            }
        });
    }

    /// Takes the pipe that a page has opened since the last call.
    pub(super) fn take(&self, page: &str) -> Option<Pipe> {
        self.with(|pages| pages.get_mut(page)?.take())
    }

    /// Removes a page that has disconnected.
    pub(super) fn forget(&self, page: &str) {
        self.with(|pages| pages.remove(page));
    }

    fn with<T>(&self, body: impl FnOnce(&mut HashMap<String, Option<Pipe>>) -> T) -> T {
        body(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
