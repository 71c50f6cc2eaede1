//! Finds the user of this machine at the other end of a connection.

use std::fs;
use std::net::{IpAddr, SocketAddr, TcpStream};

/// Returns the id of the user whose process is at the other end, or `None` if that is on another machine.
pub(super) fn user(stream: &TcpStream) -> Option<u32> {
    let (near, far) = (stream.local_addr().ok()?, stream.peer_addr().ok()?);
    // An IPv6 socket may be one end of an IPv4 connection.
    ["/proc/net/tcp", "/proc/net/tcp6"]
        .into_iter()
        .find_map(|table| owner(&fs::read_to_string(table).ok()?, far, near))
}

/// Returns the owner of the connected socket with these ends, in one of the kernel's tables (proc(5)).
fn owner(table: &str, local: SocketAddr, remote: SocketAddr) -> Option<u32> {
    const ESTABLISHED: &str = "01";
    let plain = |address: SocketAddr| SocketAddr::new(address.ip().to_canonical(), address.port());
    let (local, remote) = (plain(local), plain(remote));
    table.lines().skip(1).find_map(|line| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let [_, near, far, state, _, _, _, user, ..] = fields[..] else { return None };
        let is_it = state == ESTABLISHED && address(near) == Some(local) && address(far) == Some(remote);
        is_it.then(|| user.parse().ok()).flatten()
    })
}

/// Parses an address as the kernel writes it: `0100007F:1F90` is 127.0.0.1:8080 on a little-endian machine.
fn address(text: &str) -> Option<SocketAddr> {
    let (ip, port) = text.split_once(':')?;
    let word = |at: usize| Some(u32::from_str_radix(ip.get(at..at + 8)?, 16).ok()?.to_ne_bytes());
    let ip = match ip.len() {
        8 => IpAddr::from(word(0)?),
        32 => {
            let mut bytes = [0; 16];
            for (index, part) in bytes.chunks_exact_mut(4).enumerate() {
                part.copy_from_slice(&word(8 * index)?);
            }
            IpAddr::from(bytes).to_canonical()
        }
        _ => return None,
    };
    Some(SocketAddr::new(ip, u16::from_str_radix(port, 16).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    #[test]
    fn the_other_end_of_a_local_connection_is_this_users() {
        for listen in ["127.0.0.1:0", "[::]:0"] {
            // A container may have no IPv6.
            let Ok(listener) = TcpListener::bind(listen) else { continue };
            let port = listener.local_addr().unwrap().port();
            let _near = TcpStream::connect(("127.0.0.1", port)).unwrap();
            let (far, _) = listener.accept().unwrap();
            assert_eq!(user(&far), Some(rustix::process::getuid().as_raw()), "{listen}");
        }
    }

    #[test]
    fn the_owner_is_found_by_both_ends() {
        let row = |local: &str, remote: &str, state: &str, user: u32| {
            format!(
                "   0: {local} {remote} {state} 00000000:00000000 00:00000000 00000000 {user:5} 0 1 1 0\n"
            )
        };
        let hex =
            |[a, b, c, d]: [u8; 4], port: u16| format!("{:08X}:{port:04X}", u32::from_ne_bytes([a, b, c, d]));
        let (own, other) = ([127, 0, 0, 1], [127, 0, 0, 2]);
        let table = [
            "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid\n".to_owned(),
            row(&hex(own, 8765), &hex(own, 40000), "01", 1),
            row(&hex(other, 40000), &hex(own, 8765), "01", 2),
            row(&hex(own, 40000), &hex(own, 8765), "06", 3),
            row(&hex(own, 40000), &hex(own, 8765), "01", 1000),
        ]
        .concat();
        let at = |port| SocketAddr::from((own, port));
        assert_eq!(owner(&table, at(40000), at(8765)), Some(1000));
        assert_eq!(owner(&table, at(40001), at(8765)), None);
    }
}
