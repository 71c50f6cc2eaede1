//! Who may look: whoever knows the token, and no page of somebody else's.

use super::http::Request;
use std::fs::File;
use std::io::{self, Read as _};
use std::net::{IpAddr, SocketAddr};

/// What a request must have.
#[derive(Debug)]
pub(super) struct Access {
    token: String,
    address: SocketAddr,
    /// Origins of pages besides our own.
    origins: Vec<String>,
}

impl Access {
    pub(super) fn new(token: String, address: SocketAddr, origins: Vec<String>) -> Self {
        Self { token, address, origins }
    }

    /// # Errors
    /// In a sentence, why the request is refused.
    pub(super) fn check(&self, request: &Request) -> Result<(), String> {
        // A page of somebody else's may lead its own name to this address; its browser still says the name.
        let host = request.header("host").unwrap_or_default();
        if !self.is_ours(host) {
            return Err(format!("'{host}' is not the name of this server; it is {}", self.address));
        }
        if let Some(origin) = request.header("origin") {
            let is_ours = origin.strip_prefix("http://").is_some_and(|host| self.is_ours(host));
            if !is_ours && !self.origins.iter().any(|known| known == origin) {
                return Err(format!(
                    "pages of '{origin}' may not look; start belvedere with --allow-origin {origin}"
                ));
            }
        }
        let given = request.parameter("token").unwrap_or_default();
        if !is_same(given.as_bytes(), self.token.as_bytes()) {
            return Err("the token is missing or wrong; open the address that belvedere printed".to_owned());
        }
        Ok(())
    }

    fn is_ours(&self, host: &str) -> bool {
        let port = self.address.port();
        let (name, given) = host.rsplit_once(':').unwrap_or((host, "80"));
        if given.parse() != Ok(port) {
            return false;
        }
        let is_local = ["127.0.0.1", "localhost", "[::1]"].contains(&name);
        // For all addresses: under any of them as a number, which no page of somebody else's can be.
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        let numeric = bare.parse::<IpAddr>().ok();
        is_local || numeric.is_some_and(|ip| self.address.ip().is_unspecified() || ip == self.address.ip())
    }
}

/// Compares without telling by the time how much of it is right.
fn is_same(one: &[u8], other: &[u8]) -> bool {
    one.len() == other.len() && one.iter().zip(other).fold(0, |found, (a, b)| found | (a ^ b)) == 0
}

/// A token that nobody can guess.
///
/// # Errors
/// When the system gives no random numbers.
pub(super) fn random_token() -> io::Result<String> {
    let mut bytes = [0_u8; 16];
    File::open("/dev/urandom")?.read_exact(&mut bytes)?;
    Ok(format!("{:032x}", u128::from_le_bytes(bytes)))
}

/// A token as a user gives it.
///
/// # Errors
/// In words, when it could not stand in an address.
pub fn token(text: &str) -> Result<String, String> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_');
    if is_plain && text.len() >= 8 {
        Ok(text.to_owned())
    } else {
        Err("write 8 or more letters, digits, - and _".to_owned())
    }
}
