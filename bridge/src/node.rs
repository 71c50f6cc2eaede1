//! [`Node`]: this process's membership of a domain, and what it leaves behind (nothing).

use std::{
    fs,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use iceoryx2::{
    node::{Node as IoxNode, NodeCreationFailure, NodeState, NodeView as _},
    prelude::{
        CallbackProgression, Config, LogLevel, NodeBuilder, NodeName, SignalHandlingMode, ipc_threadsafe,
    },
};

use crate::{
    Domain, Error, Publisher, StreamInfo, StreamSpec, Subscriber, clock, domain::canonical_topic, stream,
};

/// The iceoryx2 variant: ports may move between threads, and it interoperates with `ipc::Service`.
pub(crate) type Ipc = ipc_threadsafe::Service;

/// This process's membership of a domain; publishers and subscribers are made from it. Clones are the same node.
///
/// Opening one removes what killed processes of the domain have left. When the last node of the domain closes,
/// nothing of it is left in `/dev/shm` and `/tmp/iceoryx2`.
#[derive(Clone, Debug)]
pub struct Node {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    /// Only `None` while it is dropped.
    iox: Option<IoxNode<Ipc>>,
    config: Config,
    domain: Domain,
    /// Bytes of all pools that this node has made and not dropped.
    pool_bytes: AtomicU64,
    /// When it last looked for dead processes.
    cleaned_mono_ns: AtomicU64,
}

impl Node {
    /// Joins `domain` as `name` (for listings; the program's name is usual).
    ///
    /// No signal handler is installed.
    ///
    /// # Errors
    /// [`Error::Permission`] when the files of another user are in the way, [`Error::Transport`] otherwise.
    pub fn open(domain: &Domain, name: &str) -> Result<Self, Error> {
        // Its messages repeat what the errors say, in other words and on standard error.
        iceoryx2::prelude::set_log_level_from_env_or(LogLevel::Fatal);
        let config = domain.config()?;
        let name = NodeName::new(&name.chars().take(100).collect::<String>())
            .map_err(|error| Error::transport("naming the node", error))?;
        let mut attempts = 0;
        let iox = loop {
            let created = NodeBuilder::new()
                .name(&name)
                .config(&config)
                .signal_handling_mode(SignalHandlingMode::Disabled)
                .create::<Ipc>();
            match created {
                Ok(node) => break node,
                Err(NodeCreationFailure::InsufficientPermissions) => {
                    return Err(Error::Permission {
                        prefix: domain.prefix(),
                        detail: "creating a node".to_owned(),
                    });
                }
                // The last process of another domain may just be removing the empty directories.
                Err(_) if attempts < 5 => {
                    attempts += 1;
                    std::thread::sleep(Duration::from_millis(5));
                }
                Err(error) if !writable_root(&config) => {
                    return Err(Error::Permission {
                        prefix: domain.prefix(),
                        detail: format!("creating a node: {error:?}"),
                    });
                }
                Err(error) => return Err(Error::transport(format!("joining domain \"{domain}\""), error)),
            }
        };
        let shared = Shared {
            iox: Some(iox),
            config,
            domain: domain.clone(),
            pool_bytes: AtomicU64::new(0),
            cleaned_mono_ns: AtomicU64::new(clock::mono_ns()),
        };
        Ok(Self { shared: Arc::new(shared) })
    }

    /// The domain that was joined.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        &self.shared.domain
    }

    /// Opens a stream for writing.
    ///
    /// # Errors
    /// [`Error::DomainInUse`] when the stream has its publisher already, [`Error::SharedMemoryTooSmall`] when its
    /// pool would not fit into `/dev/shm`, [`Error::Incompatible`] and [`Error::Permission`].
    pub fn publisher(&self, spec: &StreamSpec) -> Result<Publisher, Error> {
        Publisher::open(self, spec)
    }

    /// Follows a stream, whether it exists already or not: see [`Subscriber`].
    ///
    /// # Errors
    /// [`Error::InvalidTopic`].
    pub fn subscriber(&self, topic: &str) -> Result<Subscriber, Error> {
        Ok(Subscriber::watching(self, canonical_topic(topic)?))
    }

    /// The receiving side of a command stream: makes the stream, so that commands have a place to go before
    /// anyone sends one, and keeps it while senders come and go.
    ///
    /// # Errors
    /// [`Error::Incompatible`] and [`Error::Permission`].
    pub fn command_subscriber(&self, spec: &StreamSpec) -> Result<Subscriber, Error> {
        Subscriber::owning(self, spec)
    }

    /// What is published in the domain, by topic.
    ///
    /// # Errors
    /// [`Error::Transport`] when the services cannot be listed.
    pub fn streams(&self) -> Result<Vec<StreamInfo>, Error> {
        stream::list(self)
    }

    /// Removes what killed processes of the domain have left; done on opening, and by subscribers in silence.
    pub fn clean_up_dead(&self) {
        self.shared.cleaned_mono_ns.store(clock::mono_ns(), Ordering::Relaxed);
        self.iox().try_cleanup_dead_nodes();
    }

    /// The same, unless it was done within `interval`, for whichever stream: it reads some files for each node of
    /// every domain of this machine, a millisecond or so.
    pub(crate) fn clean_up_dead_every(&self, interval: Duration) {
        let since_ns = clock::mono_ns().saturating_sub(self.shared.cleaned_mono_ns.load(Ordering::Relaxed));
        if u128::from(since_ns) > interval.as_nanos() {
            self.clean_up_dead();
        }
    }

    pub(crate) fn iox(&self) -> &IoxNode<Ipc> {
        self.shared.iox.as_ref().expect("present until dropped")
    }

    pub(crate) fn config(&self) -> &Config {
        &self.shared.config
    }

    /// Books `bytes` of pool, if they and all pools before fit into what is free of `/dev/shm`.
    ///
    /// A pool takes memory only as its frames are first written, so what is free now has to hold all that was
    /// promised before, too. What of it is written already is counted twice: a stream added late may be refused
    /// a little early, but a full `/dev/shm` would be a bus error in the middle of a frame.
    pub(crate) fn book_pool(&self, topic: &str, bytes: u64) -> Result<PoolBooking, Error> {
        const MIB: u64 = 1 << 20;
        let booked = self.shared.pool_bytes.fetch_add(bytes, Ordering::Relaxed) + bytes;
        let booking = PoolBooking { node: self.clone(), bytes };
        match rustix::fs::statvfs("/dev/shm") {
            Ok(stat) if stat.f_bavail * stat.f_frsize < booked => Err(Error::SharedMemoryTooSmall {
                topic: topic.to_owned(),
                needed_mib: booked.div_ceil(MIB),
                free_mib: stat.f_bavail * stat.f_frsize / MIB,
            }),
            Ok(_) => Ok(booking),
            Err(error) => Err(Error::transport("asking /dev/shm for its free space", error)),
        }
    }
}

/// Bytes promised to a publisher's pool, returned when it is dropped.
#[derive(Debug)]
pub(crate) struct PoolBooking {
    node: Node,
    bytes: u64,
}

impl Drop for PoolBooking {
    fn drop(&mut self) {
        self.node.shared.pool_bytes.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        drop(self.iox.take());
        if let Err(error) = remove_traces(&self.config, &self.domain) {
            tracing::debug!(domain = %self.domain, %error, "some files of the domain are left");
        }
    }
}

/// Whether this user can write where iceoryx2 keeps its files; true when there is nothing yet.
fn writable_root(config: &Config) -> bool {
    let root = config.global.root_path().to_string();
    !Path::new(&root).exists()
        || rustix::fs::access(root.as_str(), rustix::fs::Access::WRITE_OK | rustix::fs::Access::EXEC_OK)
            .is_ok()
}

/// Removes what iceoryx2 keeps after the last node of a domain: its node counter, and the directories that all
/// domains share if nobody is left in any of them.
fn remove_traces(config: &Config, domain: &Domain) -> std::io::Result<()> {
    remove_remnants(config, domain);
    let mut others = false;
    let listed = IoxNode::<Ipc>::list(config, |state| {
        others |= !matches!(state, NodeState::Dead(_));
        CallbackProgression::Continue
    });
    if others || listed.is_err() {
        return Ok(());
    }
    let prefix = domain.prefix();
    for entry in fs::read_dir("/dev/shm")? {
        let entry = entry?;
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        if name.starts_with(&prefix) && name.ends_with(".global_mgmt") {
            fs::remove_file(entry.path())?;
        }
    }
    // Only empty directories can be removed this way; while any node of any domain lives, the first is not.
    let root = config.global.root_path().to_string();
    fs::remove_dir(config.global.node_dir().to_string())?;
    fs::remove_dir(config.global.service_dir().to_string())?;
    fs::remove_dir(root)
}

/// Removes nodes whose cleaning iceoryx2 could not finish.
///
/// A process killed while it creates a port leaves a half-made tag. iceoryx2 does not see that file, removes the
/// node's description, fails to remove the directory, and from then on looks for the node under the default prefix,
/// since the right one stood in the description: in another domain than the default it would stay for ever. All that
/// mattered of such a node (its places in streams, its memory) has been released before.
fn remove_remnants(config: &Config, domain: &Domain) {
    let mut ids = Vec::new();
    let _ = IoxNode::<Ipc>::list(config, |state| {
        // A living node has its description before it can be seen.
        if let NodeState::Dead(node) = &state
            && node.details().is_none()
        {
            ids.push(node.id().value().to_string());
        }
        CallbackProgression::Continue
    });
    let nodes = config.global.node_dir().to_string();
    let nodes = Path::new(&nodes);
    for id in ids {
        // Failures mean that another process is just doing the same.
        let own = nodes.join(&id);
        remove_files(&own, &domain.prefix());
        let _ = fs::remove_dir(own);
        remove_files(nodes, &format!("{}{id}.", domain.prefix()));
    }
}

/// Removes the files of a directory whose names begin so.
fn remove_files(directory: &Path, prefix: &str) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        if entry.file_name().as_encoded_bytes().starts_with(prefix.as_bytes()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}
