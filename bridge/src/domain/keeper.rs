//! [`Keeper`]: joins a domain, keeps what it has on disk in order, and leaves it.

use std::{
    path::PathBuf,
    sync::atomic::{AtomicU64, Ordering},
    time::Duration,
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

/// A node of iceoryx2 and all that is done about the files of its domain, from joining to leaving.
#[derive(Debug)]
pub(crate) struct Keeper {
    /// Only `None` while it is dropped.
    iox: Option<IoxNode<Ipc>>,
    config: Config,
    domain: Domain,
    places: Places,
    /// In a domain that a group shares; after `iox`, whose last files it still opens.
    sharing: Option<Sharing>,
    /// After `iox`, too: what that opens while it is dropped may be what is watched for.
    _watch: Option<Watch>,
    /// When it last looked for dead processes.
    cleaned_mono_ns: AtomicU64,
}

impl Keeper {
    /// Joins `domain` as `name`.
    ///
    /// # Errors
    /// As [`Node::open`](crate::Node::open).
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
            // Without a group, iceoryx2 has just done it.
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

    /// The domain's files in shared memory.
    pub(crate) fn in_shared_memory(&self) -> impl Iterator<Item = PathBuf> {
        self.places.in_shared_memory()
    }

    /// Whether a group shares the domain.
    pub(crate) fn is_shared(&self) -> bool {
        self.sharing.is_some()
    }

    /// Opens what has just been made to the group that shares the domain.
    pub(crate) fn settle(&self) {
        if let Some(sharing) = &self.sharing {
            sharing.settle();
        }
    }

    /// How long a refusal may be that of a file that its maker has not yet opened to the group.
    pub(crate) fn patience(&self) -> Duration {
        if self.is_shared() { Duration::from_millis(500) } else { Duration::ZERO }
    }

    /// What to say when iceoryx2 was refused something: whose file is in the way, if one is.
    pub(crate) fn refused(&self, what: &str) -> Error {
        places::refused(&self.domain, &self.places, what)
    }

    /// A failure of iceoryx2, or what is behind it: another user's file.
    pub(crate) fn failed(&self, what: String, detail: impl std::fmt::Debug) -> Error {
        places::failed(&self.domain, &self.places, what, detail)
    }

    /// Removes what killed processes of the domain have left; where a group shares it, those of this user.
    pub(crate) fn clean_up_dead(&self) {
        self.cleaned_mono_ns.store(clock::mono_ns(), Ordering::Relaxed);
        remains::clean_up_dead(self.iox(), &self.places, self.is_shared());
    }

    /// The same, unless it was done within `interval`, for whichever stream: it reads some files for each node of
    /// every domain of this machine, a millisecond or so.
    pub(crate) fn clean_up_dead_every(&self, interval: Duration) {
        let since_ns = clock::mono_ns().saturating_sub(self.cleaned_mono_ns.load(Ordering::Relaxed));
        if u128::from(since_ns) > interval.as_nanos() {
            self.clean_up_dead();
        }
    }

    /// Gives a node that is gone, and still has places in a stream, what iceoryx2 needs to free them.
    pub(crate) fn raise(&self, service: &str, gone: u128, ports: &[u128]) {
        // A failure: another process does the same.
        let _ = remnants::raise(&self.places, self.iox().id().value(), service, gone, ports);
    }
}

/// A name as iceoryx2 takes it: 128 bytes at most, all of them ASCII and none of them 0.
fn listed(name: &str) -> String {
    let shown = |letter: char| if letter.is_ascii() && letter != '\0' { letter } else { '?' };
    name.chars().take(100).map(shown).collect()
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
