//! Joining a domain and listing its streams.

use std::ffi::c_char;

use belvedere_bridge::{Domain, StreamInfo as Stream};

use crate::status::{Status, close, give, guard, handle_arg, null, str_arg};

/// Membership of a domain.
pub struct Node(pub(crate) belvedere_bridge::Node);

/// An existing stream.
#[repr(C)]
pub struct StreamInfo {
    /// without a leading slash
    pub topic: [c_char; 256],
    /// coordinate frame of the data
    pub frame_id: [c_char; 64],
    /// intended rate; 0 if the stream has no fixed rate
    pub rate_hz: f64,
    /// largest payload in bytes
    pub max_payload_len: u64,
    /// publishers now
    pub publishers: u32,
    /// subscribers now
    pub subscribers: u32,
    /// a bv_kind; 0 unknown
    pub kind: u16,
    /// a bv_encoding; 0 unknown
    pub encoding: u16,
    /// layers of a lidar; 0 unknown
    pub layers: u32,
}

/// Joins a domain under a name, which listings show. If the domain is NULL, it is that of the environment variable
/// BELVEDERE_DOMAIN, or "default". Close the node with bv_node_close; objects made from it remain usable after that.
///
/// # Safety
/// The texts are NUL-terminated or NULL; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_node_open(
    domain: *const c_char,
    name: *const c_char,
    out: *mut *mut Node,
) -> Status {
    guard(|| {
        let domain = if domain.is_null() {
            Domain::from_env()?
        } else {
            // SAFETY: a NUL-terminated text by this function's contract.
            Domain::new(unsafe { str_arg(domain, "domain") }?)?
        };
        // SAFETY: as above.
        let name = unsafe { str_arg(name, "name") }?;
        let node = Node(belvedere_bridge::Node::open(&domain, name)?);
        // SAFETY: `out` can be written by this function's contract.
        unsafe { give(out, node) }
    })
}

/// Leaves the domain; NULL is ignored.
///
/// # Safety
/// `node` came from bv_node_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_node_close(node: *mut Node) {
    // SAFETY: this function's contract.
    unsafe { close(node) };
}

/// Lists the streams of the domain, by topic. Free the array with bv_streams_free.
///
/// # Safety
/// `node` is open; `out` and `count` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_streams(node: *mut Node, out: *mut *mut StreamInfo, count: *mut usize) -> Status {
    guard(|| {
        if out.is_null() || count.is_null() {
            return Err(null("out or count"));
        }
        // SAFETY: an open node by this function's contract.
        let node = unsafe { handle_arg(node, "node") }?;
        let streams: Box<[StreamInfo]> = node.0.streams()?.iter().map(describe).collect();
        // SAFETY: not null, and writable by this function's contract.
        unsafe {
            count.write(streams.len());
            out.write(Box::into_raw(streams).cast());
        }
        Ok(Status::Ok)
    })
}

/// Frees an array from bv_streams; NULL is ignored.
///
/// # Safety
/// `streams` and `count` came from one call of bv_streams and are not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_streams_free(streams: *mut StreamInfo, count: usize) {
    if !streams.is_null() {
        let slice = std::ptr::slice_from_raw_parts_mut(streams, count);
        // SAFETY: this pointer and length were a boxed slice in `bv_streams`; given back once by the contract.
        drop(unsafe { Box::from_raw(slice) });
    }
}

fn describe(stream: &Stream) -> StreamInfo {
    StreamInfo {
        topic: chars(&stream.topic),
        frame_id: chars(&stream.frame_id),
        rate_hz: stream.rate_hz.unwrap_or(0.0),
        max_payload_len: stream.max_payload_len as u64,
        publishers: stream.publishers as u32,
        subscribers: stream.subscribers as u32,
        kind: stream.kind.map_or(0, belvedere_bridge::Kind::to_wire),
        encoding: stream.encoding.map_or(0, belvedere_bridge::Encoding::to_wire),
        layers: stream.layers.unwrap_or(0),
    }
}

/// Returns the first `N − 1` bytes of the text and a NUL. Topics and frames are shorter than that.
fn chars<const N: usize>(text: &str) -> [c_char; N] {
    let mut chars = [0; N];
    for (char, byte) in chars[..N - 1].iter_mut().zip(text.bytes()) {
        *char = byte.cast_signed() as c_char;
    }
    chars
}
