//! Access control: a request needs the token, and must not come from a foreign page.

use super::http::Request;
use super::peer;
use crate::description::shell::quoted;
use rustix::process::getuid;
use std::fs::{self, File};
use std::io::{self, Read as _};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::sync::{Mutex, PoisonError};

/// Checks what a request must have.
#[derive(Debug)]
pub(super) struct Access {
    token: String,
    /// Given to the user's own browser in place of the token, because other users can read its arguments. Valid for one
    /// request.
    code: Mutex<Option<String>>,
    address: SocketAddr,
    /// Origins of foreign pages that are allowed.
    origins: Vec<String>,
    /// This machine's name, if it has one.
    host_name: Option<String>,
}

impl Access {
    pub(super) fn new(token: String, code: String, address: SocketAddr, origins: Vec<String>) -> Self {
        let host_name = fs::read_to_string("/proc/sys/kernel/hostname").ok();
        let host_name = host_name.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty());
        Self { token, code: Mutex::new(Some(code)), address, origins, host_name }
    }

    /// Checks host, origin and token of a request.
    ///
    /// # Errors
    /// A sentence with the reason for the refusal.
    pub(super) fn check(&self, request: &Request) -> Result<(), String> {
        let host = self.check_host(request)?;
        if let Some(origin) = request.header("origin") {
            let authority = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
            let is_ours = authority.is_some_and(|authority| authority.eq_ignore_ascii_case(host));
            if !is_ours && !self.origins.iter().any(|known| known == origin) {
                return Err(format!(
                    "pages of '{origin}' have no access; start belvedere with --allow-origin {}",
                    quoted(origin)
                ));
            }
        }
        let given = request.parameter("token").unwrap_or_default();
        if !is_same(given.as_bytes(), self.token.as_bytes()) {
            return Err("the token is missing or wrong; open the address that belvedere printed".to_owned());
        }
        Ok(())
    }

    /// Exchanges the code that the user's browser was started with for the token.
    ///
    /// # Errors
    /// A sentence, if the code is wrong or was used before, or if another user's process sent it.
    pub(super) fn exchange(&self, request: &Request, code: &str, stream: &TcpStream) -> Result<&str, String> {
        self.check_host(request)?;
        if peer::user(stream) != Some(getuid().as_raw()) {
            return Err("this address is for the browser of the user who started belvedere; open the one that it printed".to_owned());
        }
        let mut known = self.code.lock().unwrap_or_else(PoisonError::into_inner);
        if !known.as_ref().is_some_and(|known| is_same(known.as_bytes(), code.as_bytes())) {
            return Err("this address was valid only once; open the one that belvedere printed".to_owned());
        }
        *known = None;
        Ok(&self.token)
    }

    /// Returns the host that a request names, if it is this machine's.
    ///
    /// A foreign page can make its own host name resolve to this address. The browser then treats both as the same
    /// origin, but still sends the page's host name. So the name is checked, but not the port, which a tunnel changes.
    fn check_host<'a>(&self, request: &'a Request) -> Result<&'a str, String> {
        let host = request.header("host").unwrap_or_default();
        if self.is_ours(name_of(host)) {
            return Ok(host);
        }
        Err(format!(
            "'{host}' is not the name of this server; open http://{}, or start belvedere with --allow-origin {}",
            self.address,
            quoted(format!("http://{host}"))
        ))
    }

    /// Returns true if a name is this machine's: an IP address, which cannot be redirected; its own name; or one that
    /// the user allows.
    fn is_ours(&self, name: &str) -> bool {
        let is = |known: &str| known.eq_ignore_ascii_case(name);
        let is_allowed =
            |origin: &String| origin.split_once("://").is_some_and(|(_, host)| is(name_of(host)));
        name.parse::<IpAddr>().is_ok()
            || is("localhost")
            || self.host_name.as_deref().is_some_and(|own| is(own) || is(&format!("{own}.local")))
            || self.origins.iter().any(is_allowed)
    }
}

/// Returns the host without the port and without an IPv6 address's brackets.
fn name_of(host: &str) -> &str {
    match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.rsplit_once(':').map_or(host, |(name, _)| name),
    }
}

/// Compares in constant time, which reveals nothing about the number of matching bytes.
fn is_same(one: &[u8], other: &[u8]) -> bool {
    one.len() == other.len() && one.iter().zip(other).fold(0, |found, (a, b)| found | (a ^ b)) == 0
}

/// Returns a random token.
///
/// # Errors
/// If the system provides no random numbers.
pub(super) fn random_token() -> io::Result<String> {
    let mut bytes = [0_u8; 16];
    File::open("/dev/urandom")?.read_exact(&mut bytes)?;
    Ok(format!("{:032x}", u128::from_le_bytes(bytes)))
}

/// Checks a token given by the user.
///
/// # Errors
/// A message, if the token is too short or cannot be part of a URL.
pub fn token(text: &str) -> Result<String, String> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_');
    if is_plain && text.len() >= 8 {
        Ok(text.to_owned())
    } else {
        Err("write 8 or more letters, digits, - and _".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_names_are_checked_and_ports_are_not() {
        let origins = vec!["http://robot.lab.example:8765".to_owned()];
        let access = Access {
            token: "token-of-the-test".into(),
            code: Mutex::default(),
            address: "0.0.0.0:8765".parse().unwrap(),
            origins,
            host_name: Some("Robot".into()),
        };
        let check = |host: &str, origin: Option<&str>| {
            let origin = origin.map(|origin| format!("Origin: {origin}\r\n")).unwrap_or_default();
            let head = format!("GET /?token=token-of-the-test HTTP/1.1\r\nHost: {host}\r\n{origin}\r\n");
            access.check(&Request::parse(head.as_bytes()).unwrap().unwrap())
        };
        for host in [
            "127.0.0.1:8765",
            "localhost:9000",
            "LOCALHOST",
            "[::1]:8765",
            "192.168.7.3:80",
            "robot:8765",
            "robot.local",
            "robot.lab.example",
        ] {
            assert_eq!(check(host, None), Ok(()), "{host}");
            assert_eq!(check(host, Some(&format!("http://{host}"))), Ok(()), "{host}");
            assert_eq!(check(host, Some(&format!("https://{host}"))), Ok(()), "{host}");
            assert_eq!(check(host, Some("http://robot.lab.example:8765")), Ok(()), "{host}");
            for other in ["http://6.6.6.6:8765", "http://evil.example", "http://localhost:3000", "null"] {
                assert!(check(host, Some(other)).unwrap_err().contains("--allow-origin"), "{host} {other}");
            }
        }
        for host in ["", "evil.example:8765", "127.0.0.1.evil.example", "robot.evil.example", "[evil]:8765"] {
            assert!(check(host, None).unwrap_err().contains("not the name"), "{host}");
        }
    }
}
