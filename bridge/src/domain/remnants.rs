//! Removal of what killed processes leave and iceoryx2's own cleanup does not find.
//!
//! iceoryx2 recognises a dead node by the lock of its monitor, and the node's resources by the tags in its directory: a
//! service tag for each stream, a port tag for each port. A tag is created before its resource and removed after it. A
//! kill at the wrong moment also leaves:
//!
//! - *an incomplete tag*: iceoryx2 does not see the file, removes the node's description and fails to remove the
//!   directory. From then on it looks for the node under the default prefix, since the right one was in the
//!   description;
//! - *an incomplete node*: a description without a monitor, or a monitor that lacks files or its final permissions.
//!   iceoryx2 treats it as being created, for ever;
//! - *a node's directory* whose files were removed first, so that its domain is unknown;
//! - *a listener's socket and counters*, if the process was killed before it registered the listener in its stream: the
//!   tag is removed, these are not;
//! - *a pool* of a publisher that was killed while it was closing;
//! - *a connection* of two ports, one of which was killed while the connection was created, and the other of which has
//!   gone since.
//!
//! The node's resources that other processes need, its slots in streams and its memory, have been released before.

use std::{
    collections::HashSet,
    fs::{self, OpenOptions, Permissions},
    io::{self, Write as _},
    os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _, PermissionsExt as _},
    path::{Path, PathBuf},
};

use iceoryx2::{node::NodeView as _, prelude::Config};

use super::{
    living::{born_long_ago, dead_nodes, runs},
    places::{Places, SHM, entries},
};

/// The permissions of a monitor's context file until the monitor is complete, in iceoryx2 0.10.
const MONITOR_IN_THE_MAKING: u32 = 0o200;

/// Removes what dead processes left in the domain. Failures mean that another process is doing the same, or that the
/// files belong to another user.
pub(crate) fn remove(config: &Config, places: &Places) {
    // A living node is visible only after its description exists.
    for dead in dead_nodes(config).iter().filter(|dead| dead.details().is_none()) {
        places.remove_node(&dead.id().value().to_string());
    }
    places.remove_half_made_nodes();
    places.remove_empty_nodes();
    places.remove_ownerless();
}

/// Recreates the files of a dead node that still has slots in a stream, so that iceoryx2 can free the slots: a
/// description, tags, and an unlocked monitor.
///
/// A process that cleans up removes a port's tag and then frees its slot. If it is killed in between, the next process
/// finds no tag, skips the slot and removes the rest of the node. Without this function the slot would be taken as long
/// as the stream lives.
pub(crate) fn raise(places: &Places, own: u128, service: &str, gone: u128, ports: &[u128]) -> io::Result<()> {
    let (prefix, own, grave) =
        (&places.prefix, places.nodes.join(own.to_string()), places.nodes.join(gone.to_string()));
    let monitor = |suffix| places.nodes.join(format!("{prefix}{gone}.node_monitor{suffix}"));
    // Fails if another process is doing the same, or was killed while it did.
    fs::DirBuilder::new().mode(0o750).create(&grave)?;
    let tag = format!("{prefix}{service}.service_tag");
    for port in ports {
        fs::copy(own.join(&tag), grave.join(format!("{prefix}{port}.port_tag")))?;
    }
    fs::copy(own.join(&tag), grave.join(&tag))?;
    let description = format!("{prefix}node.details");
    fs::copy(own.join(&description), grave.join(&description))?;
    let make = |path: PathBuf| OpenOptions::new().write(true).create_new(true).mode(0o600).open(path);
    make(monitor(""))?;
    make(monitor("_owner_lock"))?;
    // From here on iceoryx2 lists this node. The context names the process that it belongs to, which must not be this
    // one: its monitor would look locked.
    let mut context = make(monitor("_context"))?;
    context.write_all(&gone.to_ne_bytes())?;
    context.set_permissions(Permissions::from_mode(0o400))
}

impl Places {
    /// Removes nodes whose files are incomplete.
    ///
    /// It checks names and permissions only: opening and closing a monitor would release its lock if the monitor were
    /// our own.
    fn remove_half_made_nodes(&self) {
        let description = format!("{}node.details", self.prefix);
        let mut ids: HashSet<_> =
            names(&self.nodes).filter(|id| self.nodes.join(id).join(&description).exists()).collect();
        ids.extend(names(&self.nodes).filter_map(|name| {
            Some(name.strip_prefix(&self.prefix)?.strip_suffix(".node_monitor_context")?.to_owned())
        }));
        for id in ids {
            if born_long_ago(&id) && !self.is_complete(&id, &description) {
                self.remove_node(&id);
            }
        }
    }

    /// Removes empty directories of nodes, of any domain. The directory of a living node has its description, and the
    /// process of a node that is being created is running.
    fn remove_empty_nodes(&self) {
        for id in names(&self.nodes) {
            if born_long_ago(&id) && id.parse().is_ok_and(|id| !runs(id)) {
                // Succeeds only if the directory is empty.
                let _ = fs::remove_dir(self.nodes.join(id));
            }
        }
    }

    fn is_complete(&self, id: &str, description: &str) -> bool {
        let monitor = |suffix| self.nodes.join(format!("{}{id}.node_monitor{suffix}", self.prefix));
        self.nodes.join(id).join(description).exists()
            && monitor("").exists()
            && monitor("_owner_lock").exists()
            && fs::symlink_metadata(monitor("_context"))
                .is_ok_and(|found| found.permissions().mode() & 0o777 != MONITOR_IN_THE_MAKING)
    }

    fn remove_node(&self, id: &str) {
        let own = self.nodes.join(id);
        remove_files(&own, &self.prefix);
        let _ = fs::remove_dir(own);
        remove_files(&self.nodes, &format!("{}{id}.", self.prefix));
    }

    /// Removes files of ports that no longer exist.
    ///
    /// A listener has a socket `PREFIX ID.event` in the root directory and counters `PREFIX HASH_ID.event_mgmt` in
    /// shared memory. A publisher has its pool `PREFIX HASH_ID.data`. A publisher and a subscriber share `PREFIX
    /// HASH_ID_ID.connection`, which is valid while one of them lives.
    fn remove_ownerless(&self) {
        let ids_of = |path: &Path| -> Option<Vec<String>> {
            let name = path.file_name()?.to_str()?.strip_prefix(&self.prefix)?;
            let (stem, kind) = name.split_once('.')?;
            let ids = match kind {
                "event" => stem,
                "event_mgmt" | "connection" | "data" => stem.split_once('_')?.1,
                _ => return None,
            };
            Some(ids.split('_').map(str::to_owned).collect())
        };
        let found: Vec<(PathBuf, Vec<String>)> = [self.root.as_path(), Path::new(SHM)]
            .into_iter()
            .flat_map(entries)
            .filter_map(|path| ids_of(&path).map(|ids| (path, ids)))
            .filter(|(_, ids)| ids.iter().all(|id| born_long_ago(id)))
            .collect();
        if found.is_empty() {
            return;
        }
        // The tags are read after the files, so the owner of a file that still has a tag had it then, too.
        let tagged = self.tagged_ports();
        for (path, ids) in found {
            if !ids.iter().any(|id| tagged.contains(id)) {
                let _ = fs::remove_file(path);
            }
        }
    }

    /// Returns the identifiers of all ports: each has a tag in its node's directory.
    pub(crate) fn tagged_ports(&self) -> HashSet<String> {
        names(&self.nodes)
            .flat_map(|id| names(&self.nodes.join(id)))
            .filter_map(|name| Some(name.strip_prefix(&self.prefix)?.strip_suffix(".port_tag")?.to_owned()))
            .collect()
    }
}

fn names(directory: &Path) -> impl Iterator<Item = String> + use<> {
    fs::read_dir(directory)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
}

/// Removes the files of a directory whose names have this prefix.
fn remove_files(directory: &Path, prefix: &str) {
    for name in names(directory) {
        if name.starts_with(prefix) {
            let _ = fs::remove_file(directory.join(name));
        }
    }
}
