//! A page in the browser that shows a simulation: a server on one port, of that page and of what it connects to.
//!
//! | file | is |
//! |---|---|
//! | `http` | requests and answers |
//! | `access` | who may look |
//! | `bundle` | the page's files |
//! | `socket` | a WebSocket that keeps no thread waiting |
//! | `waiting` | how a client's thread sleeps |
//! | `foxglove`, `twist` | Foxglove's protocol, for whoever speaks it |
//! | `advertisement` | how its versions make streams known |
//! | `assets` | files that robots name, for its clients |
//! | `page` | what a page of ours says and is told |
//! | `payload`, `pipe` | frames as that page takes them, and the way that they go |
//! | `listing` | which streams there are |
//! | `scene` | the models' shapes |
//! | `commander`, `drivers` | commands to the simulator and to robots |
//!
//! The server is one more consumer of the streams, in the simulator's process or beside it: each client has a thread and
//! subscribers of its own, so that a slow one gets fewer frames and slows nobody.

mod access;
mod advertisement;
mod assets;
mod bundle;
mod commander;
mod drivers;
mod foxglove;
mod http;
mod listing;
mod page;
mod payload;
mod pipe;
mod scene;
mod socket;
mod twist;
mod waiting;

pub use access::token;

use crate::recording::Timeline;
use access::{Access, random_token};
use advertisement::{SUBPROTOCOLS, common_protocol};
use assets::{Assets, is_collada};
use belvedere_bridge::Node;
use foxglove::Foxglove;
use http::{Request, Status, refuse, respond};
use listing::Listing;
use page::Page;
use pipe::{Pipe, Pipes};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use scene::Scene;
use serde_json::{Value, json};
use socket::{Socket, is_complete};
use std::collections::BTreeMap;
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// The port that Foxglove looks at.
pub const DEFAULT_PORT: u16 = 8765;
/// Clients at a time: a stream has room for eight followers, who may be others.
const MAX_CLIENTS: usize = 6;
/// Connections at a time, of any kind.
const MAX_CONNECTIONS: usize = 32;
/// Time between two looks for streams.
const LOOK: Duration = Duration::from_millis(500);
/// Longest sleep before it is looked whether this is to end.
const NAP_NS: i64 = 50_000_000;

/// Where is served, and to whom.
#[derive(Debug, Clone)]
pub struct ViewOptions {
    /// The address to listen at.
    pub address: IpAddr,
    /// The port; 0 for any that is free.
    pub port: u16,
    /// What a client has to know; made up if it is not given.
    pub token: Option<String>,
    /// Origins of other pages that may connect, such as Lichtblick's.
    pub origins: Vec<String>,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self { address: Ipv4Addr::LOCALHOST.into(), port: DEFAULT_PORT, token: None, origins: Vec::new() }
    }
}

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Somebody else listens there.
    #[error("port {} of {} is in use, by another view perhaps; choose another with --port, or --port 0 for any that is free", .0.port(), .0.ip())]
    PortInUse(SocketAddr),
    /// No such address, no right, or no random numbers.
    #[error("cannot serve a page at {address}: {source}")]
    Io {
        /// Where.
        address: SocketAddr,
        /// Why.
        source: io::Error,
    },
}

/// What all clients share.
struct Shared {
    node: Node,
    access: Access,
    listing: Listing,
    scene: Scene,
    /// For Foxglove's clients: what parameters of ROS are.
    parameters: Mutex<BTreeMap<String, Value>>,
    assets: Mutex<Assets>,
    pipes: Pipes,
    /// Of a recording that is played.
    timeline: OnceLock<Arc<Timeline>>,
    /// Another one for each server.
    session: String,
    stop: AtomicBool,
    connections: AtomicUsize,
    clients: AtomicUsize,
}

impl Shared {
    fn is_stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// What is in the file that a client calls so, or why it is not given.
    fn asset(&self, name: &str) -> Result<Vec<u8>, String> {
        let assets = || self.assets.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(path) = assets().path(name) else {
            return Err(format!("no robot's description names '{name}'"));
        };
        let bytes = assets::read(&path, name)?;
        Ok(if is_collada(&path) { assets().rename_pictures(name, &path, bytes) } else { bytes })
    }

    /// Parameters of these names, or all.
    fn parameters(&self, names: &[String]) -> Vec<Value> {
        let parameters = self.parameters.lock().unwrap_or_else(PoisonError::into_inner);
        let wanted = parameters.iter().filter(|(name, _)| names.is_empty() || names.contains(name));
        wanted.map(|(name, value)| json!({ "name": name, "value": value })).collect()
    }
}

/// A server that runs; [`ViewServer::stop`] ends it, and so does dropping it.
pub struct ViewServer {
    shared: Arc<Shared>,
    url: String,
    threads: Vec<JoinHandle<()>>,
}

impl ViewServer {
    /// Begins to serve what is published in the node's domain.
    ///
    /// # Errors
    /// [`ViewError`].
    pub fn start(node: Node, options: ViewOptions) -> Result<Self, ViewError> {
        let wanted = SocketAddr::new(options.address, options.port);
        let failed = |source: io::Error| match source.kind() {
            io::ErrorKind::AddrInUse => ViewError::PortInUse(wanted),
            _ => ViewError::Io { address: wanted, source },
        };
        let listener = TcpListener::bind(wanted).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let token = options.token.map_or_else(random_token, Ok).map_err(failed)?;
        let shown = if address.ip().is_unspecified() { Ipv4Addr::LOCALHOST.into() } else { address.ip() };
        let url = format!("http://{}/?token={token}", SocketAddr::new(shown, address.port()));
        let parameters = BTreeMap::from([("/use_sim_time".to_owned(), Value::Bool(true))]);
        let session = random_token().map_err(failed)?;
        let shared = Arc::new(Shared {
            listing: Listing::new(node.clone()),
            node,
            access: Access::new(token, address, options.origins),
            scene: Scene::default(),
            parameters: Mutex::new(parameters),
            assets: Mutex::default(),
            pipes: Pipes::default(),
            timeline: OnceLock::new(),
            session,
            stop: AtomicBool::new(false),
            connections: AtomicUsize::new(0),
            clients: AtomicUsize::new(0),
        });
        shared.listing.look();
        let mut server = Self { shared, url, threads: Vec::new() };
        server.spawn("view", move |shared| accept(&listener, shared)).map_err(failed)?;
        server.spawn("view streams", |shared| look(shared)).map_err(failed)?;
        Ok(server)
    }

    fn spawn(&mut self, name: &str, body: impl FnOnce(&Arc<Shared>) + Send + 'static) -> io::Result<()> {
        let shared = self.shared.clone();
        let thread = std::thread::Builder::new().name(name.into()).spawn(move || body(&shared))?;
        self.threads.push(thread);
        Ok(())
    }

    /// The address of the page, with the token.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Shows these models from now on: a binary glTF file.
    pub fn set_scene(&self, glb: Vec<u8>) {
        self.shared.scene.set(glb);
    }

    /// Tells Foxglove's clients of a robot: a plain URDF, which is the parameter `/robot_description`, or
    /// `/NAMESPACE/robot_description`.
    /// They are given its meshes when they ask for them by the names that they find in it.
    pub fn set_robot_description(&self, namespace: &str, urdf: &str) {
        let urdf = self.shared.assets.lock().unwrap_or_else(PoisonError::into_inner).rename(urdf);
        let scope = if namespace.is_empty() { String::new() } else { format!("/{namespace}") };
        let mut parameters = self.shared.parameters.lock().unwrap_or_else(PoisonError::into_inner);
        parameters.insert(format!("{scope}/robot_description"), Value::String(urdf));
    }

    /// Shows where a recording is that is played, and has pages seek in it. A second one is not taken.
    pub fn set_timeline(&self, timeline: Arc<Timeline>) {
        let _ = self.shared.timeline.set(timeline);
    }

    /// Ends it.
    pub fn stop(self) {
        drop(self);
    }
}

impl Drop for ViewServer {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // One that panicked has said so.
            let _ = thread.join();
        }
    }
}

fn look(shared: &Shared) {
    let nap = Duration::from_millis(50);
    let mut waited = LOOK;
    while !shared.is_stopping() {
        if waited >= LOOK {
            waited = Duration::ZERO;
            shared.listing.look();
        }
        std::thread::sleep(nap);
        waited += nap;
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while !shared.is_stopping() {
        let mut fds = [PollFd::new(listener, PollFlags::IN)];
        if !poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: NAP_NS })).is_ok_and(|ready| ready > 0) {
            continue;
        }
        threads.retain(|thread| !thread.is_finished());
        // Who has gone meanwhile leaves nothing to be accepted.
        let Ok((mut stream, _)) = listener.accept() else { continue };
        if shared.connections.fetch_add(1, Ordering::Relaxed) >= MAX_CONNECTIONS {
            let _ = refuse(&mut stream, Status::Full, "too many connections; close some pages");
            shared.connections.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let own = shared.clone();
        let thread = std::thread::Builder::new().name("view client".into()).spawn(move || {
            if let Err(error) = serve(stream, &own) {
                tracing::debug!(%error, "a client of the view went");
            }
            own.connections.fetch_sub(1, Ordering::Relaxed);
        });
        match thread {
            Ok(thread) => threads.push(thread),
            Err(error) => {
                shared.connections.fetch_sub(1, Ordering::Relaxed);
                tracing::warn!(%error, "no thread for a client of the view");
            }
        }
    }
    for thread in threads {
        let _ = thread.join();
    }
}

/// Answers a connection's request.
fn serve(mut stream: TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    let request = match Request::read(&mut stream, &shared.stop)? {
        Ok(request) => request,
        Err(status) => return refuse(&mut stream, status, "this is not a request that is understood"),
    };
    if request.method != "GET" {
        return refuse(&mut stream, Status::OtherMethod, "only GET is answered");
    }
    // What is in every copy of the program is no secret; the page itself leads to what is.
    let is_plain = request.path != "/" && bundle::file(&request.path).is_some() && !request.is_upgrade();
    if !is_plain && let Err(sentence) = shared.access.check(&request) {
        return refuse(&mut stream, Status::Forbidden, &sentence);
    }
    if request.is_upgrade() {
        return serve_socket(stream, &request, shared);
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

/// Hands a connection to the thread of the page that it is for.
fn serve_frames(mut stream: TcpStream, request: &Request, shared: &Shared) -> io::Result<()> {
    let page = request.parameter("page").unwrap_or_default();
    if !shared.pipes.is_expected(page) {
        return refuse(&mut stream, Status::NotFound, "there is no such page; its WebSocket comes first");
    }
    shared.pipes.bring(page, Pipe::open(stream)?);
    Ok(())
}

fn serve_socket(mut stream: TcpStream, request: &Request, shared: &Shared) -> io::Result<()> {
    if !is_complete(request) {
        return refuse(&mut stream, Status::Bad, "this is not a WebSocket of version 13");
    }
    let offered = request.header("sec-websocket-protocol");
    let protocol = offered.map(common_protocol);
    if protocol == Some(None) {
        let sentence = format!("of subprotocols {} are spoken", SUBPROTOCOLS.join(" and "));
        return refuse(&mut stream, Status::Bad, &sentence);
    }
    let protocol = protocol.flatten();
    if shared.clients.fetch_add(1, Ordering::Relaxed) >= MAX_CLIENTS {
        shared.clients.fetch_sub(1, Ordering::Relaxed);
        let sentence = format!("{MAX_CLIENTS} clients look already; close one");
        return refuse(&mut stream, Status::Full, &sentence);
    }
    let served =
        http::upgrade(&mut stream, request, protocol).and_then(|()| Socket::new(stream)).and_then(|socket| {
            let served = match protocol {
                Some(protocol) => Foxglove::new(shared, socket, protocol).serve(),
                None => Page::new(shared, random_token()?, socket).serve(),
            };
            served.map_err(io::Error::other)
        });
    shared.clients.fetch_sub(1, Ordering::Relaxed);
    served
}
