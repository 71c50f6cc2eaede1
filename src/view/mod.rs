//! Shows a simulation on a page in the browser: a server on one port, for the page and its connections.
//!
//! | file | is |
//! |---|---|
//! | `serving` | accepts connections and dispatches their requests |
//! | `connections` | limits of the number of connections |
//! | `http` | HTTP requests and answers |
//! | `access`, `peer` | access control |
//! | `bundle` | the page's files |
//! | `socket` | a WebSocket that never blocks its thread |
//! | `waiting` | the sleep of a client's thread |
//! | `foxglove`, `twist` | Foxglove's protocol |
//! | `channels`, `advertisement` | its topics, and their announcement in each version of the protocol |
//! | `parameters` | ROS parameters, for its clients |
//! | `assets` | files that robots refer to, for its clients |
//! | `page` | the protocol of the page |
//! | `payload`, `pipe` | the page's format of frames, and the connection for them |
//! | `listing` | the list of streams |
//! | `scene` | the shapes of the models |
//! | `commander`, `drivers` | commands to the simulator and to robots |
//!
//! The server is an ordinary consumer of the streams, in the simulator's process or in another one. Each client has its
//! own thread and its own subscribers, so a slow client gets fewer frames and does not slow down the others.

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

/// The default port of Foxglove.
pub const DEFAULT_PORT: u16 = 8765;
/// Interval at which streams are looked up.
const LOOK: Duration = Duration::from_millis(500);

/// Options of the server.
#[derive(Debug, Clone)]
pub struct ViewOptions {
    /// The address to listen at.
    pub address: IpAddr,
    /// The port; 0 for any free port.
    pub port: u16,
    /// The token that a client must present; random if it is not given.
    pub token: Option<String>,
    /// Origins of other pages that may connect, such as Lichtblick's.
    pub origins: Vec<String>,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self { address: Ipv4Addr::LOCALHOST.into(), port: DEFAULT_PORT, token: None, origins: Vec::new() }
    }
}

/// The reason why the server cannot start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Another program listens on the port.
    #[error("port {} of {} is in use, perhaps by another view; choose another with --port, or --port 0 for any free port", .0.port(), .0.ip())]
    PortInUse(SocketAddr),
    /// The address does not exist, permission is denied, or the system provides no random numbers.
    #[error("cannot serve a page at {address}: {source}")]
    Io {
        /// The address.
        address: SocketAddr,
        /// The system's error.
        source: io::Error,
    },
}

/// The state shared by all clients.
struct Shared {
    node: Node,
    access: Access,
    listing: Listing,
    scene: Scene,
    parameters: Parameters,
    assets: Mutex<Assets>,
    pipes: Pipes,
    /// The timeline of the recording that is played, if any.
    timeline: OnceLock<Arc<Timeline>>,
    /// Unique for each server.
    session: String,
    stop: AtomicBool,
    connections: Arc<Connections>,
}

impl Shared {
    fn is_stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Returns the contents of the file with this name, or a message with the reason why not.
    fn asset(&self, name: &str) -> Result<Vec<u8>, String> {
        let assets = || self.assets.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(path) = assets().path(name) else {
            return Err(format!("no robot's description names '{name}'"));
        };
        let bytes = assets::read(&path, name)?;
        Ok(if is_collada(&path) { assets().rename_pictures(name, &path, bytes) } else { bytes })
    }
}

/// A running server. [`ViewServer::stop`] or dropping it ends it.
pub struct ViewServer {
    shared: Arc<Shared>,
    url: String,
    opening_url: String,
    threads: Vec<JoinHandle<()>>,
}

impl ViewServer {
    /// Starts to serve the streams of the node's domain.
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

    /// Returns the address of the page, with the token.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Returns an address that opens the page once, for this user's browser. Other users of the machine can read the
    /// browser's arguments, and the token in them would give them access.
    pub fn opening_url(&self) -> &str {
        &self.opening_url
    }

    /// Sets the models that are shown, as a binary glTF file.
    pub fn set_scene(&self, glb: Vec<u8>) {
        self.shared.scene.set(glb);
    }

    /// Publishes a robot's description, a plain URDF, to Foxglove clients as the parameter `/robot_description` or
    /// `/NAMESPACE/robot_description`. Clients can request its meshes by the names that they find in it.
    pub fn set_robot_description(&self, namespace: &str, urdf: &str) {
        let urdf = self.shared.assets.lock().unwrap_or_else(PoisonError::into_inner).rename(urdf);
        self.shared.parameters.set(robot_description(namespace), Some(Value::String(urdf)));
    }

    /// Returns true if there is a description of the robot in a namespace.
    pub fn has_robot_description(&self, namespace: &str) -> bool {
        self.shared.parameters.has(&robot_description(namespace))
    }

    /// Removes the description of a deleted robot.
    pub fn remove_robot_description(&self, namespace: &str) {
        self.shared.parameters.set(robot_description(namespace), None);
    }

    /// Shows the position of the recording that is played, and lets pages seek in it. Only the first timeline is used.
    pub fn set_timeline(&self, timeline: Arc<Timeline>) {
        let _ = self.shared.timeline.set(timeline);
    }

    /// Stops the server.
    pub fn stop(self) {
        drop(self);
    }
}

impl Drop for ViewServer {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A panic of the thread has already been reported.
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
