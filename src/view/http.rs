//! The part of HTTP/1.1 that the page needs: one request per connection, read within limits.

use std::io::{self, Read as _, Write as _};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Longest head of a request, in bytes.
const MAX_HEAD_BYTES: usize = 16 << 10;
const MAX_HEADERS: usize = 64;
/// Longest time to receive a request, and to send an answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Longest sleep between two checks of the stop flag.
const NAP: Duration = Duration::from_millis(50);

/// The head of a request.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: String,
    /// The path before `?`, not decoded.
    pub(super) path: String,
    /// The query after `?`.
    pub(super) query: String,
    headers: Vec<(String, String)>,
}

impl Request {
    /// Returns a header by its name in lower case.
    pub(super) fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Returns a value of the query.
    pub(super) fn parameter(&self, name: &str) -> Option<&str> {
        self.query.split('&').find_map(|pair| pair.strip_prefix(name)?.strip_prefix('='))
    }

    /// Returns true if the request asks for a WebSocket.
    pub(super) fn is_upgrade(&self) -> bool {
        self.header("upgrade").is_some_and(|upgrade| upgrade.eq_ignore_ascii_case("websocket"))
    }

    /// Reads a request until it is complete or `stop` is set.
    ///
    /// # Errors
    /// If the connection ends early. The inner error is the status with which an invalid request is answered.
    pub(super) fn read(stream: &mut TcpStream, stop: &AtomicBool) -> io::Result<Result<Self, Status>> {
        let deadline = Instant::now() + PATIENCE;
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.set_read_timeout(Some(NAP))?;
        let mut head = Vec::new();
        let mut part = [0; 2048];
        loop {
            // The deadline holds for the whole request, even if single bytes keep arriving.
            if Instant::now() >= deadline {
                return Ok(Err(Status::TimedOut));
            }
            match stream.read(&mut part) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => head.extend_from_slice(&part[..count]),
                Err(error) if error.kind() != io::ErrorKind::WouldBlock => return Err(error),
                Err(error) if stop.load(Ordering::Relaxed) => return Err(error),
                Err(_) => continue,
            }
            match Self::parse(&head) {
                Some(request) => return Ok(request),
                None if head.len() < MAX_HEAD_BYTES => {}
                None => return Ok(Err(Status::TooLarge)),
            }
        }
    }

    /// Parses a head. Returns `None` if it is not complete yet.
    pub(super) fn parse(head: &[u8]) -> Option<Result<Self, Status>> {
        let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(head) {
            Ok(httparse::Status::Complete(_)) => Some(Self::of(&request)),
            Ok(httparse::Status::Partial) => None,
            Err(httparse::Error::TooManyHeaders) => Some(Err(Status::TooLarge)),
            Err(_) => Some(Err(Status::Bad)),
        }
    }

    fn of(request: &httparse::Request<'_, '_>) -> Result<Self, Status> {
        let target = request.path.unwrap_or_default();
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let mut headers = Vec::new();
        for header in request.headers.iter() {
            let value = str::from_utf8(header.value).map_err(|_| Status::Bad)?;
            headers.push((header.name.to_ascii_lowercase(), value.to_owned()));
        }
        Ok(Self {
            method: request.method.unwrap_or_default().to_owned(),
            path: path.to_owned(),
            query: query.to_owned(),
            headers,
        })
    }
}

/// The status of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Status {
    Ok,
    Elsewhere,
    Bad,
    Forbidden,
    NotFound,
    OtherMethod,
    TimedOut,
    TooLarge,
    Full,
}

impl Status {
    fn line(self) -> &'static str {
        match self {
            Self::Ok => "200 OK",
            Self::Elsewhere => "303 See Other",
            Self::Bad => "400 Bad Request",
            Self::Forbidden => "403 Forbidden",
            Self::NotFound => "404 Not Found",
            Self::OtherMethod => "405 Method Not Allowed",
            Self::TimedOut => "408 Request Timeout",
            Self::TooLarge => "431 Request Header Fields Too Large",
            Self::Full => "503 Service Unavailable",
        }
    }
}

/// Sends an answer, which ends the connection.
pub(super) fn respond(stream: &mut TcpStream, status: Status, kind: &str, body: &[u8]) -> io::Result<()> {
    answer(stream, status, &format!("Content-Type: {kind}\r\n"), body)
}

/// Redirects a browser to another address on this server.
pub(super) fn redirect(stream: &mut TcpStream, target: &str) -> io::Result<()> {
    answer(stream, Status::Elsewhere, &format!("Location: {target}\r\n"), b"")
}

fn answer(stream: &mut TcpStream, status: Status, header: &str, body: &[u8]) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {}\r\n{header}Content-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Content-Security-Policy: default-src 'self'; img-src 'self' blob: data:; connect-src 'self' blob:; \
         style-src 'self' 'unsafe-inline'; frame-ancestors 'none'\r\n\r\n",
        status.line(),
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)?;
    stream.flush()
}

/// Starts an answer that lasts until the connection ends.
pub(super) fn begin(stream: &mut TcpStream, kind: &str) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {}\r\nContent-Type: {kind}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\n\r\n",
        Status::Ok.line()
    );
    stream.write_all(head.as_bytes())
}

/// Answers with a sentence.
pub(super) fn refuse(stream: &mut TcpStream, status: Status, sentence: &str) -> io::Result<()> {
    respond(stream, status, "text/plain; charset=utf-8", format!("{sentence}\n").as_bytes())
}

/// Accepts a WebSocket, with this subprotocol if there is one.
pub(super) fn upgrade(stream: &mut TcpStream, request: &Request, protocol: Option<&str>) -> io::Result<()> {
    let key = request.header("sec-websocket-key").unwrap_or_default();
    let accept = accept_key(key);
    let protocol = protocol.map(|name| format!("Sec-WebSocket-Protocol: {name}\r\n")).unwrap_or_default();
    let head = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {accept}\r\n{protocol}\r\n"
    );
    stream.write_all(head.as_bytes())?;
    stream.flush()
}

/// Returns the answer to a client's key (RFC 6455, 4.2.2): the SHA-1 of the key and a constant, in base 64.
fn accept_key(key: &str) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let hash = sha1_smol::Sha1::from(format!("{key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11")).digest().bytes();
    // 20 bytes are six groups of three and two more, which gives 27 characters.
    let mut text = String::with_capacity(28);
    for part in hash.chunks(3) {
        let word = part.iter().chain(&[0, 0]).take(3).fold(0_u32, |word, byte| word << 8 | u32::from(*byte));
        for letter in 0..=part.len() {
            text.push(char::from(ALPHABET[(word >> (18 - 6 * letter) & 63) as usize]));
        }
    }
    text.push('=');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_answered_as_in_the_standard() {
        assert_eq!(accept_key("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
    }
}
