//! [`Keeper`]: joins a domain, cleans up its files, and leaves it.

use std::{
    path::PathBuf,
    sync::atomic::{AtomicU64, Ordering},
    time::{Duration, Instant},
};

use iceoryx2::{
    node::{Node as IoxNode, NodeCreationFailure},
    prelude::{Config, NodeBuilder, NodeName, SignalHandlingMode},
};

use super::{
    Domain, Ipc, places,
    places::Places,
    remains, remnants, room,
    sharing::{self, Sharing},
    unborn::Watch,
};
use crate::{Error, clock};

/// An iceoryx2 node, with the management of its domain's files from joining to leaving.
#[derive(Debug)]
pub(crate) struct Keeper {
    /// `None` only during drop.
    iox: Option<IoxNode<Ipc>>,
    config: Config,
    domain: Domain,
    places: Places,
    /// Present if a group shares the domain. Dropped after `iox`, whose last files it still opens to the group.
    sharing: Option<Sharing>,
    /// Dropped after `iox`, too: closing the node may open files that the watch guards against.
    _watch: Option<Watch>,
    /// Time of the last cleanup of dead processes.
    cleaned_mono_ns: AtomicU64,
}

impl Keeper {
    /// Joins `domain` as `name`.
    ///
    /// # Errors
    /// The errors of [`Node::open`](crate::Node::open).
    pub(crate) fn join(domain: Domain, name: &str) -> Result<Self, Error> {
        let config = domain.config()?;
        let places = Places::new(&domain, &config);
        let name =
            NodeName::new(&listed(name)).map_err(|error| Error::transport("naming the node", error))?;
        Error::check_open_files(|| format!("joining domain \"{domain}\""))?;
        room::check_room_for_books("a node")?;
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
            // Without a group, iceoryx2 has already cleaned up while it created the node.
            remains::clean_up_dead(&iox, &places, true);
        }
        remains::remove_orphans(&config, &places);
        drop(lock);
        Ok(Self {
            iox: Some(iox),
            config,
            domain,
            places,
            sharing,
            _watch: watch,
            cleaned_mono_ns: AtomicU64::new(clock::mono_ns()),
        })
    }

    pub(crate) fn domain(&self) -> &Domain {
        &self.domain
    }

    pub(crate) fn iox(&self) -> &IoxNode<Ipc> {
        self.iox.as_ref().expect("present until dropped")
    }

    pub(crate) fn config(&self) -> &Config {
        &self.config
    }

    /// Returns the domain's files in shared memory.
    pub(crate) fn in_shared_memory(&self) -> impl Iterator<Item = PathBuf> {
        self.places.in_shared_memory()
    }

    /// Returns true if a group shares the domain.
    pub(crate) fn is_shared(&self) -> bool {
        self.sharing.is_some()
    }

    /// Opens newly created files to the group that shares the domain.
    pub(crate) fn settle(&self) {
        if let Some(sharing) = &self.sharing {
            sharing.settle();
        }
    }

    /// Returns how long to retry after a permission error: another process may not yet have opened its new file to the
    /// group.
    pub(crate) fn patience(&self) -> Duration {
        if self.is_shared() { Duration::from_millis(500) } else { Duration::ZERO }
    }

    /// Returns the error for an operation that iceoryx2 refused. It names the owner if another user's file is in the
    /// way.
    pub(crate) fn refused(&self, what: &str) -> Error {
        places::refused(&self.domain, &self.places, what)
    }

    /// Returns the error for a failure of iceoryx2, or the cause behind it: another user's file.
    pub(crate) fn failed(&self, what: String, detail: impl std::fmt::Debug) -> Error {
        places::failed(&self.domain, &self.places, what, detail)
    }

    /// Removes the files that killed processes of the domain left; in a shared domain, only those of this user.
    pub(crate) fn clean_up_dead(&self) {
        self.cleaned_mono_ns.store(clock::mono_ns(), Ordering::Relaxed);
        remains::clean_up_dead(self.iox(), &self.places, self.is_shared());
    }

    /// Removes streams that no process has open. It opens the description of every stream of the domain, so it is called
    /// only when a stream can neither be opened nor created.
    pub(crate) fn remove_deserted_streams(&self) {
        remains::remove_deserted_services(&self.config, &self.places);
        remains::remove_orphans(&self.config, &self.places);
    }

    /// Calls [`clean_up_dead`](Self::clean_up_dead), unless any stream of this node did so within `interval`. A cleanup
    /// reads some files for each node of every domain on the machine, which takes about a millisecond.
    pub(crate) fn clean_up_dead_every(&self, interval: Duration) {
        let since_ns = clock::mono_ns().saturating_sub(self.cleaned_mono_ns.load(Ordering::Relaxed));
        if u128::from(since_ns) > interval.as_nanos() {
            self.clean_up_dead();
        }
    }

    /// Recreates the files of a dead node that still has slots in a stream, so that iceoryx2 can free them.
    pub(crate) fn raise(&self, service: &str, gone: u128, ports: &[u128]) {
        // A failure means that another process is doing the same.
        let _ = remnants::raise(&self.places, self.iox().id().value(), service, gone, ports);
    }
}

/// Converts a name to what iceoryx2 accepts: at most 128 bytes of ASCII without NUL.
fn listed(name: &str) -> String {
    let shown = |letter: char| if letter.is_ascii() && letter != '\0' { letter } else { '?' };
    name.chars().take(100).map(shown).collect()
}

fn create(domain: &Domain, config: &Config, places: &Places, name: &NodeName) -> Result<IoxNode<Ipc>, Error> {
    let started = Instant::now();
    loop {
        let created = NodeBuilder::new()
            .name(name)
            .config(config)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>();
        match created {
            Ok(node) => return Ok(node),
            // The last process of another domain may be removing the empty directories at this moment. On a busy
            // machine it can be interrupted there.
            Err(_) if started.elapsed() < Duration::from_millis(500) => {
                std::thread::sleep(Duration::from_millis(5));
            }
            Err(NodeCreationFailure::InsufficientPermissions) => {
                return Err(places::refused(domain, places, "creating a node"));
            }
            Err(error) => {
                return Err(places::failed(domain, places, format!("joining domain \"{domain}\""), error));
            }
        }
    }
}

impl Drop for Keeper {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_can_be_listed() {
        for (name, expected) in
            [("", ""), ("a b", "a b"), ("Süd\0", "S?d?"), (&"ä".repeat(1000), &*"?".repeat(100))]
        {
            assert_eq!(listed(name), expected);
            NodeName::new(&listed(name)).unwrap();
        }
    }
}
