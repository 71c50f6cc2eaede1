//! Accepts connections and dispatches their requests.

use super::access::random_token;
use super::advertisement::{SUBPROTOCOLS, common_protocol};
use super::connections::{MAX_CLIENTS, Place, Standing};
use super::foxglove::Foxglove;
use super::http::{self, Request, Status, redirect, refuse, respond};
use super::page::Page;
use super::pipe::Pipe;
use super::socket::{Socket, is_complete};
use super::{Shared, bundle};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::io;
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest sleep between two checks of the stop flag.
const NAP: Duration = Duration::from_millis(50);

/// Accepts connections until the server stops, and serves each in a thread of its own.
pub(super) fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while !shared.is_stopping() {
        let mut fds = [PollFd::new(listener, PollFlags::IN)];
        if !poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: i64::from(NAP.subsec_nanos()) }))
            .is_ok_and(|ready| ready > 0)
        {
            continue;
        }
        threads.retain(|thread| !thread.is_finished());
        let (stream, place) = match listener.accept().and_then(|(stream, _)| {
            let place = shared.connections.enter(&stream)?;
            Ok((stream, place))
        }) {
            Ok(accepted) => accepted,
            // The client has disconnected meanwhile.
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => continue,
            Err(error) => {
                tracing::debug!(%error, "a connection of the view could not be accepted");
                std::thread::sleep(NAP);
                continue;
            }
        };
        let own = shared.clone();
        let thread = std::thread::Builder::new().name("view client".into()).spawn(move || {
            if let Err(error) = serve(stream, &own, &place) {
                tracing::debug!(%error, "a client of the view disconnected");
            }
        });
        match thread {
            Ok(thread) => threads.push(thread),
            Err(error) => tracing::warn!(%error, "no thread for a client of the view"),
        }
    }
    for thread in threads {
        let _ = thread.join();
    }
}

/// Answers a connection's request.
fn serve(mut stream: TcpStream, shared: &Shared, place: &Place) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    let request = match Request::read(&mut stream, &shared.stop)? {
        Ok(request) => request,
        Err(status) => return refuse(&mut stream, status, "this request is not understood"),
    };
    if request.method != "GET" {
        return refuse(&mut stream, Status::OtherMethod, "only GET is answered");
    }
    // Files that are in every copy of the program are public. The page itself is not, because it leads to the data.
    let is_plain = request.path != "/" && bundle::file(&request.path).is_some() && !request.is_upgrade();
    if request.path == "/"
        && let Some(code) = request.parameter("code")
    {
        return match shared.access.exchange(&request, code, &stream) {
            Ok(token) => redirect(&mut stream, &format!("/?token={token}")),
            Err(sentence) => refuse(&mut stream, Status::Forbidden, &sentence),
        };
    }
    if !is_plain {
        if let Err(sentence) = shared.access.check(&request) {
            return refuse(&mut stream, Status::Forbidden, &sentence);
        }
        if !place.rise_to(Standing::Known) {
            return refuse(&mut stream, Status::Full, "too many connections; close some pages");
        }
    }
    if request.is_upgrade() {
        return serve_socket(stream, &request, shared, place);
    }
    if request.path == "/frames" {
        return serve_frames(stream, &request, shared);
    }
    match bundle::file(&request.path) {
        Some((kind, bytes)) => respond(&mut stream, Status::Ok, kind, bytes),
        None if request.path == "/scene.glb" => {
            respond(&mut stream, Status::Ok, "model/gltf-binary", &shared.scene.bytes())
        }
        None => refuse(&mut stream, Status::NotFound, "there is no such file; the page is at /"),
    }
}

/// Passes a connection for frames on to the thread of its page.
fn serve_frames(mut stream: TcpStream, request: &Request, shared: &Shared) -> io::Result<()> {
    let page = request.parameter("page").unwrap_or_default();
    if !shared.pipes.is_expected(page) {
        return refuse(&mut stream, Status::NotFound, "there is no such page; open its WebSocket first");
    }
    shared.pipes.bring(page, Pipe::open(stream)?);
    Ok(())
}

fn serve_socket(mut stream: TcpStream, request: &Request, shared: &Shared, place: &Place) -> io::Result<()> {
    if !is_complete(request) {
        return refuse(&mut stream, Status::Bad, "this is not a WebSocket of version 13");
    }
    let offered = request.header("sec-websocket-protocol");
    let protocol = offered.map(common_protocol);
    if protocol == Some(None) {
        let sentence = format!("supported subprotocols: {}", SUBPROTOCOLS.join(", "));
        return refuse(&mut stream, Status::Bad, &sentence);
    }
    let protocol = protocol.flatten();
    if !place.rise_to(Standing::Client) {
        let sentence = format!("{MAX_CLIENTS} clients are connected already; close one");
        return refuse(&mut stream, Status::Full, &sentence);
    }
    http::upgrade(&mut stream, request, protocol)?;
    let socket = Socket::new(stream)?;
    let served = match protocol {
        Some(protocol) => Foxglove::new(shared, socket, protocol).serve(),
        None => Page::new(shared, random_token()?, socket).serve(),
    };
    served.map_err(io::Error::other)
}
