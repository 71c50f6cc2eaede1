//! A page in the browser that shows a simulation: a server on one port, of that page and of what it connects to.
//!
//! | file | is |
//! |---|---|
//! | `serving` | connections, from their request to who answers them |
//! | `connections` | how many there may be, and which one gives way |
//! | `http` | requests and answers |
//! | `access`, `peer` | who may look |
//! | `bundle` | the page's files |
//! | `socket` | a WebSocket that keeps no thread waiting |
//! | `waiting` | how a client's thread sleeps |
//! | `foxglove`, `twist` | Foxglove's protocol, for whoever speaks it |
//! | `channels`, `advertisement` | the topics of its clients, and how its versions make them known |
//! | `parameters` | parameters of ROS, for its clients |
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
mod channels;
mod commander;
mod connections;
mod drivers;
mod foxglove;
mod http;
mod listing;
mod page;
mod parameters;
mod payload;
mod peer;
mod pipe;
mod scene;
mod serving;
mod socket;
mod twist;
mod waiting;

pub use access::token;

use crate::recording::Timeline;
use access::{Access, random_token};
use assets::{Assets, is_collada};
use belvedere_bridge::Node;
use connections::Connections;
use listing::Listing;
use parameters::Parameters;
use pipe::Pipes;
use scene::Scene;
use serde_json::Value;
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// The port that Foxglove looks at.
pub const DEFAULT_PORT: u16 = 8765;
/// Time between two looks for streams.
const LOOK: Duration = Duration::from_millis(500);

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
    parameters: Parameters,
    assets: Mutex<Assets>,
    pipes: Pipes,
    /// Of a recording that is played.
    timeline: OnceLock<Arc<Timeline>>,
    /// Another one for each server.
    session: String,
    stop: AtomicBool,
    connections: Arc<Connections>,
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
}

/// A server that runs; [`ViewServer::stop`] ends it, and so does dropping it.
pub struct ViewServer {
    shared: Arc<Shared>,
    url: String,
    opening_url: String,
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
        let base = format!("http://{}/", SocketAddr::new(shown, address.port()));
        let code = random_token().map_err(failed)?;
        let (url, opening_url) = (format!("{base}?token={token}"), format!("{base}?code={code}"));
        let session = random_token().map_err(failed)?;
        let shared = Arc::new(Shared {
            listing: Listing::new(node.clone()),
            node,
            access: Access::new(token, code, address, options.origins),
            scene: Scene::default(),
            parameters: Parameters::new(),
            assets: Mutex::default(),
            pipes: Pipes::default(),
            timeline: OnceLock::new(),
            session,
            stop: AtomicBool::new(false),
            connections: Arc::default(),
        });
        shared.listing.look();
        let mut server = Self { shared, url, opening_url, threads: Vec::new() };
        server.spawn("view", move |shared| serving::accept(&listener, shared)).map_err(failed)?;
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

    /// An address that opens the page once, for a browser of this user's: among its arguments, which other users of the
    /// machine can read, the token would let them in.
    pub fn opening_url(&self) -> &str {
        &self.opening_url
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
        self.shared.parameters.set(robot_description(namespace), Some(Value::String(urdf)));
    }

    /// Whether the robot of a namespace is described.
    pub fn has_robot_description(&self, namespace: &str) -> bool {
        self.shared.parameters.has(&robot_description(namespace))
    }

    /// Takes back the description of a robot that is gone.
    pub fn remove_robot_description(&self, namespace: &str) {
        self.shared.parameters.set(robot_description(namespace), None);
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

/// Returns the name of the parameter that describes the robot of a namespace.
fn robot_description(namespace: &str) -> String {
    let scope = if namespace.is_empty() { String::new() } else { format!("/{namespace}") };
    format!("{scope}/robot_description")
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
