//! The interface: a participant with one node, its writers and its readers.

use std::fmt::Write as _;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::net::Ipv4Addr;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::engine::Engine;
use crate::guid::{EntityId, Guid, Prefix};
use crate::lock::lock;
use crate::mailbox::{Inbox, Mailbox, OnMatched, OnSample, Order, ReaderState, WriterState};
use crate::ros;
use crate::sedp::Endpoint;
use crate::sockets::{JoinError, Range, Sockets, Waker};
use crate::spdp::{Announcement, LEASE, UNKNOWN_VENDOR};

/// What a topic's readers can rely on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Qos {
    /// What is lost on the way is sent again.
    pub reliable: bool,
    /// Readers that join late get the last samples.
    pub transient_local: bool,
    /// How many samples are kept.
    pub depth: usize,
}

impl Qos {
    /// Reliable, so that every reader can use it, and nothing for those that join late.
    pub fn volatile(depth: usize) -> Qos {
        Qos { reliable: true, transient_local: false, depth }
    }

    /// Reliable, and the last sample for those that join late, as of `/tf_static`.
    pub fn latched() -> Qos {
        Qos { reliable: true, transient_local: true, depth: 1 }
    }

    /// What is lost is lost.
    pub fn best_effort(depth: usize) -> Qos {
        Qos { reliable: false, transient_local: false, depth }
    }
}

/// Why a writer or reader cannot be made.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum TopicError {
    /// The name of the topic or service.
    #[error(
        "\"{0}\" is not the name of a topic or service; a name is written as /camera/image_raw, with letters, digits \
         and _, at most 255"
    )]
    Name(String),
    /// Its type.
    #[error("\"{0}\" is not the type of a message; a type is written as sensor_msgs/msg/Image")]
    Type(String),
    /// The type of a service.
    #[error("\"{0}\" is not the type of a service; a type is written as rcl_interfaces/srv/GetParameters")]
    ServiceType(String),
    /// The hash of its type.
    #[error("\"{0}\" is not the hash of a type; it is RIHS01_ and 64 hexadecimal digits, or empty")]
    Hash(String),
}

/// Who joins which domain.
#[derive(Clone, Copy, Debug)]
pub struct Node<'a> {
    /// The domain, as `ROS_DOMAIN_ID` has it.
    pub domain: u32,
    /// How far it is seen.
    pub range: Range,
    /// Hosts whose nodes it finds without multicast, as `ROS_STATIC_PEERS` has them.
    pub peers: &'a [Ipv4Addr],
    /// The namespace of the node, such as `/`.
    pub namespace: &'a str,
    /// The name of the node, such as `belvedere`.
    pub name: &'a str,
}

/// A topic with its type.
#[derive(Clone, Copy, Debug)]
pub struct Topic<'a> {
    /// Its name in ROS, such as `/camera/image_raw`.
    pub name: &'a str,
    /// Its type in ROS, such as `sensor_msgs/msg/Image`.
    pub message: &'a str,
    /// The hash of its type, `RIHS01_` and 64 digits, or nothing.
    pub hash: &'a str,
}

/// What the node has, for `ros2 node info`.
#[derive(Debug)]
pub(crate) struct Graph {
    next: u32,
    pub(crate) readers: Vec<Guid>,
    pub(crate) writers: Vec<Guid>,
}

#[derive(Debug)]
pub(crate) struct Shared {
    prefix: Prefix,
    namespace: String,
    node: String,
    pub(crate) mailbox: Arc<Mailbox>,
    graph: Mutex<Graph>,
}

/// The writer by which the participant says what its node has.
const GRAPH_WRITER: u32 = 1;

impl Shared {
    pub(crate) fn now() -> Duration {
        SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default()
    }

    pub(crate) fn guid(&self, entity: EntityId) -> Guid {
        Guid::new(self.prefix, entity)
    }

    fn endpoint(&self, entity: EntityId, topic: Topic<'_>, qos: Qos) -> Result<Endpoint, TopicError> {
        check(topic.name, topic.hash)?;
        let type_name =
            ros::type_name(topic.message).ok_or_else(|| TopicError::Type(topic.message.to_owned()))?;
        let topic_name = ros::topic(topic.name);
        Ok(endpoint(self.guid(entity), topic_name, type_name, qos, ros::user_data(topic.hash)))
    }

    /// Tells others what the node has now.
    fn tell(&self, graph: &Graph) {
        let participant = self.guid(EntityId::PARTICIPANT);
        let sample = ros::graph(participant, &self.namespace, &self.node, &graph.readers, &graph.writers);
        self.mailbox.post_sample(EntityId::user_writer(GRAPH_WRITER), sample, Shared::now(), 1);
    }

    pub(crate) fn change_graph(&self, change: impl FnOnce(&mut Graph)) {
        let mut graph = lock(&self.graph);
        change(&mut graph);
        self.tell(&graph);
    }

    pub(crate) fn number(&self) -> u32 {
        let mut graph = lock(&self.graph);
        graph.next += 1;
        graph.next
    }

    pub(crate) fn remove(&self, entity: EntityId) {
        let guid = self.guid(entity);
        self.mailbox.post(Order::Remove(entity));
        self.change_graph(|graph| {
            graph.readers.retain(|other| *other != guid);
            graph.writers.retain(|other| *other != guid);
        });
    }
}

/// Checks the name and the hash of a topic or service.
pub(crate) fn check(name: &str, hash: &str) -> Result<(), TopicError> {
    if !name.strip_prefix('/').is_some_and(ros::is_name) {
        return Err(TopicError::Name(name.to_owned()));
    }
    let is_hash = |digits: &str| digits.len() == 64 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    if !hash.is_empty() && !hash.strip_prefix("RIHS01_").is_some_and(is_hash) {
        return Err(TopicError::Hash(hash.to_owned()));
    }
    Ok(())
}

pub(crate) fn endpoint(
    guid: Guid,
    topic: String,
    type_name: String,
    qos: Qos,
    user_data: Vec<u8>,
) -> Endpoint {
    Endpoint {
        guid,
        topic,
        type_name,
        reliable: qos.reliable,
        transient: qos.transient_local,
        depth: qos.depth.clamp(1, 100_000) as u32,
        deadline: Duration::MAX,
        liveliness: Duration::MAX,
        locators: Vec::new(),
        user_data,
    }
}

/// A node of ROS 2, as a participant of DDS. It has one thread.
#[derive(Debug)]
pub struct Participant {
    pub(crate) shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Participant {
    /// Joins a domain.
    ///
    /// # Errors
    /// If the node's name is none, or no port can be listened at.
    pub fn join(node: &Node<'_>) -> Result<Participant, JoinError> {
        if node.name.contains('/') || !ros::is_name(node.name) {
            return Err(JoinError::Node(node.name.to_owned(), "name", "belvedere"));
        }
        let inside = node.namespace.strip_prefix('/');
        if !inside.is_some_and(|inside| inside.is_empty() || ros::is_name(inside)) {
            return Err(JoinError::Node(node.namespace.to_owned(), "namespace", "/ or /robot1"));
        }
        let sockets = Sockets::open(node.domain, node.range, node.peers)?;
        let prefix = random_prefix();
        let (discovery, user) = (sockets.discovery_locators()?, sockets.user_locators()?);
        let announcement = Announcement { prefix, discovery, user, lease: LEASE, vendor: UNKNOWN_VENDOR };
        let announcement = announcement.encode(node.domain, sockets.announced_group(), node.name);
        let mailbox = Arc::new(Mailbox::new(Waker::new()?));
        let engine = Engine::new(prefix, sockets, Arc::clone(&mailbox), announcement);
        let thread = std::thread::Builder::new().name("rtps".to_owned()).spawn(move || engine.run())?;
        let shared = Shared {
            prefix,
            namespace: node.namespace.to_owned(),
            node: node.name.to_owned(),
            mailbox,
            graph: Mutex::new(Graph { next: 16, readers: Vec::new(), writers: Vec::new() }),
        };
        let graph = |entity| {
            let guid = Guid::new(prefix, entity);
            let (topic, type_name) = (ros::GRAPH_TOPIC.to_owned(), ros::GRAPH_TYPE.to_owned());
            endpoint(guid, topic, type_name, Qos::latched(), Vec::new())
        };
        let writer = graph(EntityId::user_writer(GRAPH_WRITER));
        shared.mailbox.post(Order::AddWriter(writer, Arc::default()));
        shared.tell(&lock(&shared.graph));
        Ok(Participant { shared: Arc::new(shared), thread: Some(thread) })
    }

    /// Whether the last announcement of the participant has reached no network, so that others cannot find it. It is
    /// announced again every second.
    pub fn is_cut(&self) -> bool {
        self.shared.mailbox.is_cut.load(Ordering::Relaxed)
    }

    /// Writes a topic.
    ///
    /// # Errors
    /// If the topic's name, type or hash is none.
    pub fn writer(&self, topic: Topic<'_>, qos: Qos) -> Result<Writer, TopicError> {
        self.open_writer(topic, qos, None)
    }

    /// Writes a topic, and calls `on_matched` with the number of readers whenever it changes. The call is made by the
    /// participant's thread, which waits for it.
    ///
    /// # Errors
    /// If the topic's name, type or hash is none.
    pub fn watched_writer(
        &self,
        topic: Topic<'_>,
        qos: Qos,
        on_matched: impl FnMut(usize) + Send + 'static,
    ) -> Result<Writer, TopicError> {
        self.open_writer(topic, qos, Some(Box::new(on_matched)))
    }

    fn open_writer(&self, topic: Topic<'_>, qos: Qos, call: Option<OnMatched>) -> Result<Writer, TopicError> {
        let shared = Arc::clone(&self.shared);
        let entity = EntityId::user_writer(shared.number());
        let endpoint = shared.endpoint(entity, topic, qos)?;
        let state = Arc::new(WriterState::new(call));
        let depth = endpoint.depth as usize;
        shared.mailbox.post(Order::AddWriter(endpoint, Arc::clone(&state)));
        shared.change_graph(|graph| graph.writers.push(shared.guid(entity)));
        Ok(Writer { shared, entity, state, depth })
    }

    /// Reads a topic, whose samples have at most `limit` bytes.
    ///
    /// # Errors
    /// If the topic's name, type or hash is none.
    pub fn reader(&self, topic: Topic<'_>, qos: Qos, limit: usize) -> Result<Reader, TopicError> {
        self.open_reader(topic, qos, limit, None)
    }

    /// Reads a topic, and calls `on_sample` with each sample: CDR with its header of four bytes. The call is made by the
    /// participant's thread, which acknowledges the sample only after it. So a writer that has the acknowledgement of
    /// a reliable reader knows that the sample was dealt with. [`Reader::take`] gives nothing then.
    ///
    /// # Errors
    /// If the topic's name, type or hash is none.
    pub fn watched_reader(
        &self,
        topic: Topic<'_>,
        qos: Qos,
        limit: usize,
        on_sample: impl FnMut(&[u8]) + Send + 'static,
    ) -> Result<Reader, TopicError> {
        self.open_reader(topic, qos, limit, Some(Box::new(on_sample)))
    }

    fn open_reader(
        &self,
        topic: Topic<'_>,
        qos: Qos,
        limit: usize,
        call: Option<OnSample>,
    ) -> Result<Reader, TopicError> {
        let shared = Arc::clone(&self.shared);
        let entity = EntityId::user_reader(shared.number());
        let endpoint = shared.endpoint(entity, topic, qos)?;
        let state = Arc::new(ReaderState::new(qos.depth, limit, call));
        shared.mailbox.post(Order::AddReader(endpoint, Inbox::Samples(Arc::clone(&state))));
        shared.change_graph(|graph| graph.readers.push(shared.guid(entity)));
        Ok(Reader { shared, entity, state })
    }
}

impl Drop for Participant {
    fn drop(&mut self) {
        self.shared.mailbox.post(Order::Stop);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so.
            let _ = thread.join();
        }
    }
}

/// Writes samples of a topic.
#[derive(Debug)]
pub struct Writer {
    shared: Arc<Shared>,
    entity: EntityId,
    state: Arc<WriterState>,
    depth: usize,
}

impl Writer {
    /// How many readers the topic has.
    pub fn matched(&self) -> usize {
        self.state.matched.load(Ordering::Relaxed)
    }

    /// An empty buffer, with the memory of an earlier sample if there is one.
    pub fn buffer(&self) -> Vec<u8> {
        let mut buffer = self.state.buffer();
        buffer.clear();
        buffer
    }

    /// Sends a sample: CDR with its header of four bytes. It returns at once.
    pub fn write(&self, sample: Vec<u8>) {
        self.shared.mailbox.post_sample(self.entity, ros::padded(sample), Shared::now(), self.depth);
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.shared.remove(self.entity);
    }
}

/// Reads samples of a topic.
#[derive(Debug)]
pub struct Reader {
    shared: Arc<Shared>,
    entity: EntityId,
    state: Arc<ReaderState>,
}

impl Reader {
    /// How many writers the topic has.
    pub fn matched(&self) -> usize {
        self.state.matched.load(Ordering::Relaxed)
    }

    /// The oldest sample that was not taken yet: CDR with its header of four bytes. Waits for one until the timeout.
    pub fn take(&self, timeout: Duration) -> Option<Vec<u8>> {
        self.state.take(timeout)
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.shared.remove(self.entity);
    }
}

/// A name that no other participant has: from the random keys of the standard library's maps, time and process.
fn random_prefix() -> Prefix {
    let mut name = String::new();
    let _ = write!(name, "{:?} {}", Shared::now(), std::process::id());
    let random = || {
        let mut hasher = RandomState::new().build_hasher();
        hasher.write(name.as_bytes());
        hasher.finish().to_le_bytes()
    };
    let mut prefix = [0; 12];
    prefix[..8].copy_from_slice(&random());
    prefix[8..].copy_from_slice(&random()[..4]);
    Prefix(prefix)
}
