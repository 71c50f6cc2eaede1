//! Frames on their way to a page: an answer of HTTP that does not end, which browsers take many times as fast as messages of a
//! WebSocket. What the page says, and what it is told in words, goes by its WebSocket.

use super::http;
use std::collections::HashMap;
use std::io::{self, Write as _};
use std::net::TcpStream;
use std::os::fd::{AsFd as _, BorrowedFd};
use std::sync::{Mutex, PoisonError};

/// A connection that frames are sent on, each after its length in four bytes, little-endian.
#[derive(Debug)]
pub(super) struct Pipe {
    stream: TcpStream,
    /// A frame of which the first bytes have been sent.
    unsent: Vec<u8>,
    sent: usize,
}

impl Pipe {
    /// Begins the answer.
    ///
    /// # Errors
    /// When the page has gone.
    pub(super) fn open(mut stream: TcpStream) -> io::Result<Self> {
        http::begin(&mut stream, "application/octet-stream")?;
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        Ok(Self { stream, unsent: Vec::new(), sent: 0 })
    }

    /// Sends, now or when there is room.
    ///
    /// # Errors
    /// When the page has gone.
    pub(super) fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        self.unsent.extend_from_slice(&(frame.len() as u32).to_le_bytes());
        self.unsent.extend_from_slice(frame);
        self.flush()
    }

    /// Sends what is left.
    ///
    /// # Errors
    /// When the page has gone.
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

    /// Whether something waits for room.
    pub(super) fn has_unsent(&self) -> bool {
        self.sent < self.unsent.len()
    }

    pub(super) fn descriptor(&self) -> BorrowedFd<'_> {
        self.stream.as_fd()
    }
}

/// Pages that are connected, by the names that they were given, with the pipes that they have brought since.
#[derive(Debug, Default)]
pub(super) struct Pipes(Mutex<HashMap<String, Option<Pipe>>>);

impl Pipes {
    /// A page may bring one from now on.
    pub(super) fn expect(&self, page: &str) {
        self.with(|pages| pages.insert(page.to_owned(), None));
    }

    /// Whether this page is there.
    pub(super) fn is_expected(&self, page: &str) -> bool {
        self.with(|pages| pages.contains_key(page))
    }

    /// A page brings one; what it has brought before ends. It ends, too, if the page has gone meanwhile.
    pub(super) fn bring(&self, page: &str, pipe: Pipe) {
        self.with(|pages| {
            if let Some(place) = pages.get_mut(page) {
                *place = Some(pipe);
            }
        });
    }

    /// What a page has brought since it was last asked.
    pub(super) fn take(&self, page: &str) -> Option<Pipe> {
        self.with(|pages| pages.get_mut(page)?.take())
    }

    /// A page has gone.
    pub(super) fn forget(&self, page: &str) {
        self.with(|pages| pages.remove(page));
    }

    fn with<T>(&self, body: impl FnOnce(&mut HashMap<String, Option<Pipe>>) -> T) -> T {
        body(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
