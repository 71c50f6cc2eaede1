//! [`Node`]: this process's membership of a domain.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use iceoryx2::{
    node::{Node as IoxNode, NodeCreationFailure},
    prelude::{Config, LogLevel, NodeBuilder, NodeName, SignalHandlingMode, ipc_threadsafe},
};

use crate::{
    Domain, Error, Publisher, StreamInfo, StreamSpec, Subscriber, clock,
    domain::canonical_topic,
    memory,
    places::{self, Places},
    remains,
    sharing::{self, Sharing},
    stream,
    unborn::Watch,
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
    places: Places,
    /// In a domain that a group shares; after `iox`, whose last files it still opens.
    sharing: Option<Sharing>,
    /// After `iox`, too: what that opens while it is dropped may be what is watched for.
    _watch: Option<Watch>,
    /// Bytes of all pools that this node has made and not dropped.
    pool_bytes: AtomicU64,
    /// When it last looked for dead processes.
    cleaned_mono_ns: AtomicU64,
}

impl Node {
    /// Joins `domain` as `name` (for listings; the program's name is usual). A domain that is shared with no group is
    /// shared with that of the environment variable `BELVEDERE_GROUP`, if there is one.
    ///
    /// No signal handler is installed.
    ///
    /// # Errors
    /// [`Error::Permission`] when the files of another user are in the way, [`Error::InvalidGroup`] when this user is
    /// not of the group, [`Error::SharedMemoryTooSmall`] when nothing is free in `/dev/shm`; [`Error::Transport`]
    /// otherwise.
    pub fn open(domain: &Domain, name: &str) -> Result<Self, Error> {
        // Its messages repeat what the errors say, in other words and on standard error.
        iceoryx2::prelude::set_log_level_from_env_or(LogLevel::Fatal);
        let domain = domain.clone().or_shared_as_env_says()?;
        let config = domain.config()?;
        let places = Places::new(&domain, &config);
        let name = NodeName::new(&name.chars().take(100).collect::<String>())
            .map_err(|error| Error::transport("naming the node", error))?;
        memory::check_room_for_books("a node")?;
        let lock = places.make_and_lock(|| match domain.group() {
            Some(group) => sharing::make_directories(&places, group),
            None => places.make_root_alone(&domain),
        })?;
        let sharing = domain.group().map(|group| Sharing::start(&domain, group, &places)).transpose()?;
        remains::clear_if_deserted(&config, &places);
        let watch = Watch::start(&places);
        let iox = create(&domain, &config, &places, &name)?;
        match &sharing {
            Some(sharing) => sharing.settle(),
            None => places.close_to_others(),
        }
        if sharing.is_some() {
            // Without a group, iceoryx2 has just done it.
            remains::clean_up_dead(&iox, &places, true);
        }
        remains::remove_orphans(&config, &places);
        drop(lock);
        let shared = Shared {
            iox: Some(iox),
            config,
            domain,
            places,
            sharing,
            _watch: watch,
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

    /// Removes what killed processes of the domain have left; done on opening, and by subscribers in silence. In a
    /// domain that a group shares, each user's processes do so for that user.
    pub fn clean_up_dead(&self) {
        self.shared.cleaned_mono_ns.store(clock::mono_ns(), Ordering::Relaxed);
        remains::clean_up_dead(self.iox(), self.places(), self.is_shared());
    }

    /// Opens what has just been made to the group that shares the domain.
    pub(crate) fn settle(&self) {
        if let Some(sharing) = &self.shared.sharing {
            sharing.settle();
        }
    }

    /// What to say when iceoryx2 was refused something: whose file is in the way, if one is.
    pub(crate) fn refused(&self, what: &str) -> Error {
        places::refused(self.domain(), self.places(), what)
    }

    /// A failure of iceoryx2, or what is behind it: another user's file.
    pub(crate) fn failed(&self, what: String, detail: impl std::fmt::Debug) -> Error {
        match self.places().foreign(self.domain().group()) {
            Some((path, uid)) => places::foreign(self.domain(), self.places(), path, uid),
            None => Error::transport(what, detail),
        }
    }

    /// Whether a group shares the domain.
    pub(crate) fn is_shared(&self) -> bool {
        self.shared.sharing.is_some()
    }

    /// How long a refusal may be that of a file that its maker has not yet opened to the group.
    pub(crate) fn patience(&self) -> Duration {
        if self.is_shared() { Duration::from_millis(500) } else { Duration::ZERO }
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

    pub(crate) fn places(&self) -> &Places {
        &self.shared.places
    }

    pub(crate) fn pool_bytes(&self) -> &AtomicU64 {
        &self.shared.pool_bytes
    }
}

fn create(domain: &Domain, config: &Config, places: &Places, name: &NodeName) -> Result<IoxNode<Ipc>, Error> {
    let mut attempts = 0;
    loop {
        let created = NodeBuilder::new()
            .name(name)
            .config(config)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>();
        match created {
            Ok(node) => return Ok(node),
            // The last process of another domain may just be removing the empty directories.
            Err(_) if attempts < 5 => {
                attempts += 1;
                std::thread::sleep(Duration::from_millis(5));
            }
            Err(NodeCreationFailure::InsufficientPermissions) => {
                return Err(places::refused(domain, places, "creating a node"));
            }
            Err(error) => {
                return Err(match places.foreign(domain.group()) {
                    Some((path, uid)) => places::foreign(domain, places, path, uid),
                    None => Error::transport(format!("joining domain \"{domain}\""), error),
                });
            }
        }
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        drop(self.iox.take());
        let _lock = self.places.lock();
        if self.sharing.is_some() {
            remains::remove_own_connections(&self.places);
        }
        if let Err(error) = remains::remove_traces(&self.config, &self.places) {
            tracing::debug!(domain = %self.domain, %error, "some files of the domain are left");
        }
    }
}
