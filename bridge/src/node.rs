//! [`Node`]: this process's membership of a domain.

use std::sync::{Arc, atomic::AtomicU64};

use iceoryx2::{node::Node as IoxNode, prelude::LogLevel};

use crate::{
    Domain, Error,
    domain::{Ipc, Keeper, room},
    own::Own,
};

/// This process's membership of a domain; publishers and subscribers are made from it. Clones are the same node.
///
/// Opening one removes what killed processes of the domain have left. When the last node of the domain closes,
/// nothing of it is left in `/dev/shm` and in [its directory](Domain::directory).
///
/// A child made by `fork` must open a node of its own. It may drop, or exit with, its copies of this node and of what was
/// made from it: they are leaked there, and the parent goes on undisturbed.
#[derive(Clone, Debug)]
pub struct Node {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    keeper: Own<Keeper>,
    /// Bytes that are promised to this node's pools and not taken yet.
    promised_bytes: AtomicU64,
}

impl Node {
    /// Joins `domain` as `name` (for listings, which show 100 characters of it, and `?` for those beyond ASCII; the
    /// program's name is usual). A domain that is shared with no group is
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
        let keeper = Keeper::join(domain.clone().or_shared_as_env_says()?, name)?;
        Ok(Self { shared: Arc::new(Shared { keeper: Own::new(keeper), promised_bytes: AtomicU64::new(0) }) })
    }

    /// The domain that was joined.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        self.keeper().domain()
    }

    /// Bytes that are free in `/dev/shm` now, for pools of publishers and all else there.
    ///
    /// # Errors
    /// [`Error::Transport`] when the system does not say.
    pub fn free_shared_memory(&self) -> Result<u64, Error> {
        room::free()
    }

    /// Removes what killed processes of the domain have left; done on opening, and by subscribers in silence. In a
    /// domain that a group shares, each user's processes do so for that user.
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
