//! [`Node`]: this process's membership of a domain.

use std::sync::{Arc, atomic::AtomicU64};

use iceoryx2::{node::Node as IoxNode, prelude::LogLevel};

use crate::{
    Domain, Error,
    domain::{Ipc, Keeper, room},
    own::Own,
};

/// This process's membership of a domain, from which publishers and subscribers are created. Clones are the same node.
///
/// Opening a node removes what killed processes of the domain left. When the last node of the domain closes, no file of
/// it is left in `/dev/shm` or in [its directory](Domain::directory).
///
/// A child made by `fork` must open a node of its own. It may drop its copies of this node and of the objects made from
/// it, or exit with them: they are leaked in the child, and the parent is not affected.
#[derive(Clone, Debug)]
pub struct Node {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    keeper: Own<Keeper>,
    /// Bytes that are reserved for this node's pools but not yet allocated.
    promised_bytes: AtomicU64,
}

impl Node {
    /// Joins `domain` as `name`, which listings show: the program's name is usual. Listings show its first 100
    /// characters, and `?` for characters beyond ASCII.
    ///
    /// If `domain` has no group, it is shared with the group that the environment variable `BELVEDERE_GROUP` names, if
    /// any.
    ///
    /// No signal handler is installed.
    ///
    /// # Errors
    /// [`Error::Permission`] if files of another user are in the way, [`Error::InvalidGroup`] if this user does not
    /// belong to the group, [`Error::SharedMemoryTooSmall`] if `/dev/shm` is full; [`Error::Transport`] otherwise.
    pub fn open(domain: &Domain, name: &str) -> Result<Self, Error> {
        // iceoryx2's log messages repeat the errors in other words, on standard error.
        iceoryx2::prelude::set_log_level_from_env_or(LogLevel::Fatal);
        let keeper = Keeper::join(domain.clone().or_shared_as_env_says()?, name)?;
        Ok(Self { shared: Arc::new(Shared { keeper: Own::new(keeper), promised_bytes: AtomicU64::new(0) }) })
    }

    /// Returns the domain that was joined.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        self.keeper().domain()
    }

    /// Returns the bytes that are free in `/dev/shm` now.
    ///
    /// # Errors
    /// [`Error::Transport`] if the system does not report it.
    pub fn free_shared_memory(&self) -> Result<u64, Error> {
        room::free()
    }

    /// Removes what killed processes of the domain left. Opening a node does this, and so do subscribers whose streams
    /// are silent. In a domain that a group shares, each process cleans up only after its own user.
    pub fn clean_up_dead(&self) {
        self.keeper().clean_up_dead();
    }

    pub(crate) fn keeper(&self) -> &Keeper {
        &self.shared.keeper
    }

    pub(crate) fn iox(&self) -> &IoxNode<Ipc> {
        self.keeper().iox()
    }

    pub(crate) fn promised_bytes(&self) -> &AtomicU64 {
        &self.shared.promised_bytes
    }
}
