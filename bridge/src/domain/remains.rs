//! Removal of what processes leave behind when they end or are killed.
//!
//! iceoryx2 cleans up after a dead node: its slots in streams, its memory, its tags. This module does the rest:
//!
//! - it empties a domain without living nodes before any of its files is trusted;
//! - it removes half-created files, the last node counter and the directories;
//! - in a domain that a group shares, it removes the files in `/dev/shm` that only their owner can remove.

use std::{
    collections::HashSet,
    fs,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use iceoryx2::{
    node::{Node as IoxNode, NodeState, NodeView as _},
    prelude::{CallbackProgression, Config},
    service::Service as _,
};

use super::{
    Ipc,
    living::{anybody_lives, dead_nodes, maker_runs},
    places::Places,
    remnants,
};

/// The minimum age of a file that may be removed. A younger one may still be in creation by a process that does not
/// take the [lock](Places::lock), such as one that uses another library.
const SETTLED: Duration = Duration::from_secs(1);

/// Empties a domain without living nodes, so that iceoryx2 does not have to interpret the files left in it: a full
/// disk, a power failure or a user may have truncated or overwritten them.
pub(crate) fn clear_if_deserted(config: &Config, places: &Places) {
    let files = places.files();
    if files.is_empty() || anybody_lives(config) {
        return;
    }
    let is_one_starting = files.iter().any(|file| !is_settled(file) && maker_runs(file));
    let mut directories = HashSet::new();
    for file in files {
        if let Some(directory) = file.parent()
            && directory.parent() == Some(&places.nodes)
        {
            directories.insert(directory.to_owned());
        }
        if !is_one_starting || is_settled(&file) {
            // A failure means that another process is doing the same, or that the file belongs to another user.
            let _ = fs::remove_file(file);
        }
    }
    for directory in directories {
        // Succeeds only if the directory is empty.
        let _ = fs::remove_dir(directory);
    }
}

fn remove_settled(file: &Path) {
    if is_settled(file) {
        let _ = fs::remove_file(file);
    }
}

/// Returns true if a file is older than [`SETTLED`] by the wall clock, which file times use. If the clock is set back,
/// remnants stay until a later start. If it is set forward, a file that a process without our lock is creating may be
/// removed.
fn is_settled(file: &Path) -> bool {
    let age = |changed: SystemTime| SystemTime::now().duration_since(changed).unwrap_or_default();
    fs::symlink_metadata(file)
        .and_then(|metadata| metadata.modified())
        .is_ok_and(|changed| age(changed) > SETTLED)
}

/// Cleans up after dead nodes: all of them in a domain of one user, this user's in a shared one.
pub(crate) fn clean_up_dead(node: &IoxNode<Ipc>, places: &Places, is_shared: bool) {
    if !is_shared {
        node.try_cleanup_dead_nodes();
        remnants::remove(node.config(), places);
        return;
    }
    remove_deserted_services(node.config(), places);
    for dead in dead_nodes(node.config()) {
        if is_own(&places.nodes.join(format!("{}{}.node_monitor", places.prefix, dead.id().value()))) {
            let _ = dead.try_remove_stale_resources();
        }
    }
    remnants::remove(node.config(), places);
}

fn is_own(path: &Path) -> bool {
    let own = rustix::process::geteuid();
    own.is_root() || fs::symlink_metadata(path).is_ok_and(|metadata| metadata.uid() == own.as_raw())
}

/// Removes the descriptions of streams that no process has open.
///
/// The last process to leave a stream, or to clean up after a killed one, marks the stream as removed and then removes
/// its files. If it does not get to the files, the stream stays marked for ever: no process can open it or create it
/// again. There are two reasons: the process is killed in between, or the stream's dynamic part in `/dev/shm` belongs to
/// another user. In the second case the description is in the group's directory, where every member can remove it. The
/// dynamic part is removed as an orphan when its owner next starts a process.
pub(crate) fn remove_deserted_services(config: &Config, places: &Places) {
    let mut deserted = Vec::new();
    let _ = Ipc::list(config, |service| {
        if service.dynamic_details.is_none_or(|details| details.nodes.is_empty()) {
            deserted.push(service.static_details.service_hash().as_str().to_owned());
        }
        CallbackProgression::Continue
    });
    for hash in deserted {
        remove_settled(&places.services.join(format!("{}{hash}.service", places.prefix)));
    }
}

/// Removes this user's pools and dynamic parts of ports and streams that no longer exist. They remain if the last
/// process that used them belonged to another user, who could not remove them.
pub(crate) fn remove_orphans(config: &Config, places: &Places) {
    // In this order, so that files created meanwhile are not in the first list.
    let files: Vec<PathBuf> = places.in_shared_memory().collect();
    let mut known = places.tagged_ports();
    let listed = Ipc::list(config, |service| {
        known.insert(service.static_details.unique_service_id().value().to_string());
        CallbackProgression::Continue
    });
    if listed.is_err() {
        return;
    }
    for file in files.iter().filter(|file| is_own(file)) {
        let Some(name) = file.file_name().and_then(|name| name.to_str()) else { continue };
        let Some((stem, kind)) = name[places.prefix.len()..].split_once('.') else { continue };
        // The name is a hash of the type, then the identifier.
        let is_known = stem.split('_').skip(1).any(|id| known.contains(id));
        if ["data", "dynamic"].contains(&kind) && !is_known {
            remove_settled(file);
        }
    }
}

/// Removes this user's connections that have lost an end, in a domain that a group shares: the last process to release
/// one would remove it, but cannot remove another user's file. A process that has the connection mapped keeps it; no
/// process opens it again.
pub(crate) fn remove_own_connections(places: &Places) {
    let files: Vec<PathBuf> = places
        .in_shared_memory()
        .filter(|path| path.extension().is_some_and(|kind| kind == "connection"))
        .collect();
    let tagged = places.tagged_ports();
    for file in files.iter().filter(|file| is_own(file)) {
        let stem = file.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        // The hash of the type is followed by the two ends.
        if stem.split('_').skip(1).any(|id| !tagged.contains(id)) {
            let _ = fs::remove_file(file);
        }
    }
}

/// Removes what iceoryx2 keeps after the last node of a domain: its node counter, and the directories that all domains
/// share if no domain has a node left.
pub(crate) fn remove_traces(config: &Config, places: &Places) -> std::io::Result<()> {
    remnants::remove(config, places);
    let mut others = false;
    let listed = IoxNode::<Ipc>::list(config, |state| {
        others |= !matches!(state, NodeState::Dead(_));
        CallbackProgression::Continue
    });
    if others || listed.is_err() {
        return Ok(());
    }
    for path in places.in_shared_memory() {
        if path.extension().is_some_and(|kind| kind == "global_mgmt") {
            fs::remove_file(path)?;
        }
    }
    // This removes only empty directories; while a node of any domain lives, the first one is not empty.
    places.remove_empty_directories()
}
