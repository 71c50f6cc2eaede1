//! [`Domain`]: the name that separates simulations.

use std::{fmt, path::PathBuf, str::FromStr, time::Duration};

use iceoryx2::prelude::{Config, FileName, Path, SemanticString, ipc_threadsafe};
use rustix::process::geteuid;

use super::Group;
use crate::Error;

/// The iceoryx2 service variant: its ports may move between threads, and it interoperates with `ipc::Service`.
pub(crate) type Ipc = ipc_threadsafe::Service;

/// The name under which one simulation shares its streams. Several simulations run side by side under different names.
///
/// Each user has their own domains: the same name under another user is another domain. A domain is the iceoryx2 prefix
/// `blvd.<name>~<user id>.` and the directory `/tmp/blvd~<user id>`, so its processes see only each other. A name
/// cannot contain the dot, so no domain's prefix is the beginning of another's.
///
/// Only the user who runs its processes can reach it, unless it is [shared with a group](Self::shared_with). A shared
/// domain is separate from the private domain of the same name: its prefix is `blvd.<name>@<group id>.`, its directory
/// `/tmp/blvd-<group id>`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Domain {
    name: String,
    group: Option<Group>,
}

impl Domain {
    /// The default name.
    pub const DEFAULT: &str = "default";
    /// The maximum length of a name: prefix, identifiers and suffix must fit into the 108 bytes of a socket path.
    pub const MAX_LEN: usize = 24;

    /// Creates a domain with this name.
    ///
    /// # Errors
    /// [`Error::InvalidDomain`] unless the name is 1 to 24 of `a-z A-Z 0-9 _ -`.
    pub fn new(name: &str) -> Result<Self, Error> {
        let usable = (1..=Self::MAX_LEN).contains(&name.len())
            && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-');
        if usable {
            Ok(Self { name: name.to_owned(), group: None })
        } else {
            Err(Error::InvalidDomain(name.to_owned()))
        }
    }

    /// Returns the domain that the environment variable `BELVEDERE_DOMAIN` names, or the default one.
    ///
    /// # Errors
    /// [`Error::InvalidDomain`] if the variable holds an unusable name.
    pub fn from_env() -> Result<Self, Error> {
        match std::env::var_os("BELVEDERE_DOMAIN") {
            Some(name) if !name.is_empty() => Self::new(&name.to_string_lossy()),
            _ => Ok(Self::default()),
        }
    }

    /// Returns this domain, shared with the users of a group: they can read all streams and send commands. Every
    /// process of the domain must name the group, or run with it in the environment variable `BELVEDERE_GROUP`, which
    /// [`Node::open`](crate::Node::open) uses if no group is named here.
    #[must_use]
    pub fn shared_with(self, group: Group) -> Self {
        Self { group: Some(group), ..self }
    }

    /// Returns the group that shares the domain.
    #[must_use]
    pub fn group(&self) -> Option<&Group> {
        self.group.as_ref()
    }

    pub(crate) fn or_shared_as_env_says(self) -> Result<Self, Error> {
        match self.group {
            Some(_) => Ok(self),
            None => Ok(Self { group: Group::from_env()?, ..self }),
        }
    }

    /// Returns the domain's name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.name
    }

    /// Returns the prefix of the names of this domain's files.
    #[must_use]
    pub fn prefix(&self) -> String {
        match &self.group {
            Some(group) => format!("blvd.{}@{}.", self.name, group.gid()),
            // All users share one /dev/shm.
            None => format!("blvd.{}~{}.", self.name, geteuid().as_raw()),
        }
    }

    /// Returns the directory for files outside `/dev/shm`. All domains of the user, or of the group, share it. It
    /// exists while one of them has a node.
    #[must_use]
    pub fn directory(&self) -> PathBuf {
        // Ids instead of names keep socket paths within 107 bytes. The path does not depend on the environment
        // (XDG_RUNTIME_DIR), since a service and a shell of one user must find each other.
        PathBuf::from(match &self.group {
            Some(group) => format!("/tmp/blvd-{}", group.gid()),
            None => format!("/tmp/blvd~{}", geteuid().as_raw()),
        })
    }

    /// Returns the configuration that all peers must share. It is built here instead of read from a file, so that no
    /// `config/iceoryx2.toml` in a working directory separates two of them.
    pub(crate) fn config(&self) -> Result<Config, Error> {
        let mut config = Config::default();
        // The timeout for resources that another process is still creating, such as a stream or the connection of a
        // consumer. The whole timeout passes only if that process was killed meanwhile.
        config.global.creation_timeout = Duration::from_millis(200);
        config.global.prefix = FileName::new(self.prefix().as_bytes())
            .map_err(|error| Error::transport("setting the domain's prefix", error))?;
        // Not iceoryx2's default directory: it belongs to the first user of the machine who runs any iceoryx2 program.
        let root = Path::new(self.directory().as_os_str().as_encoded_bytes())
            .map_err(|error| Error::transport("setting the domain's directory", error))?;
        config.global.set_root_path(&root);
        if self.group.is_some() {
            // The timeout also covers the time until another process opens its new files to the group.
            config.global.creation_timeout = Duration::from_millis(500);
            // Each user's processes clean up only their own files: see `remains`.
            config.global.node.cleanup_dead_nodes_on_creation = false;
            config.global.node.cleanup_dead_nodes_on_destruction = false;
            config.global.service.cleanup_dead_nodes_on_open = false;
        }
        Ok(config)
    }
}

impl Default for Domain {
    fn default() -> Self {
        Self { name: Self::DEFAULT.to_owned(), group: None }
    }
}

impl fmt::Display for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.name)
    }
}

impl FromStr for Domain {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::new(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn domain_names() {
        for good in ["a", "default", "robot_2-B", &"x".repeat(24)] {
            assert_eq!(Domain::new(good).unwrap().as_str(), good);
        }
        for bad in ["", "a b", "a/b", "a.b", "ä", &"x".repeat(25)] {
            assert!(Domain::new(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn no_prefix_begins_another() {
        let (short, long) = (Domain::new("a").unwrap(), Domain::new("a_b").unwrap());
        assert!(!long.prefix().starts_with(&short.prefix()));
        let shared = short.clone().shared_with(Group::find("0").unwrap());
        assert!(!shared.prefix().starts_with(&short.prefix()));
        assert!(!short.prefix().starts_with(&shared.prefix()));
    }

    #[test]
    fn the_longest_socket_path_fits_into_sun_path() {
        let name = "x".repeat(Domain::MAX_LEN);
        let group = Group::find(&u32::MAX.to_string()).unwrap();
        for domain in [Domain::new(&name).unwrap(), Domain::new(&name).unwrap().shared_with(group)] {
            let (directory, prefix) = (domain.directory(), domain.prefix());
            // The user id, which is in both, may have more digits on another machine.
            let more = 2 * (u32::MAX.to_string().len() - geteuid().as_raw().to_string().len());
            let longer = if domain.group().is_some() { 0 } else { more };
            let path = format!("{}/{prefix}{}.event", directory.display(), u128::MAX);
            assert!(path.len() + longer <= 107, "{path}");
        }
    }
}
