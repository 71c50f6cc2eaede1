//! What processes leave behind when they end, or are killed, and how it goes.
//!
//! iceoryx2 cleans up after a dead node: its places in streams, its memory, its tags. What is here does the rest: a
//! domain in which nobody lives any more is emptied before anything in it is believed; halves of what was killed while
//! it was made; the last counter and directories; and in a domain that a group shares, where nobody may remove another
//! user's files from `/dev/shm`, what only their own user can remove.

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

/// Younger files may be being made, by a process that takes no [lock](Places::lock): another library's.
const SETTLED: Duration = Duration::from_secs(1);

/// Empties a domain in which nobody lives, so that iceoryx2 need not make sense of what is left in it: files may have
/// been cut or overwritten since, by a full disk, by a power cut, by hand.
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
            // Failures: another process does the same, or it is another user's.
            let _ = fs::remove_file(file);
        }
    }
    for directory in directories {
        // Only when it is empty.
        let _ = fs::remove_dir(directory);
    }
}

fn remove_settled(file: &Path) {
    if is_settled(file) {
        let _ = fs::remove_file(file);
    }
}

/// Compares with the wall clock, as the times of files do. If that is set back, remnants stay until a later start; if it
/// is set forward, a file that a process without our lock is just making may be deleted.
fn is_settled(file: &Path) -> bool {
    let age = |changed: SystemTime| SystemTime::now().duration_since(changed).unwrap_or_default();
    fs::symlink_metadata(file)
        .and_then(|metadata| metadata.modified())
        .is_ok_and(|changed| age(changed) > SETTLED)
}

/// Cleans up after dead nodes: in a domain of one user, all of them; in one that a group shares, this user's.
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

/// Removes the descriptions of streams that nobody has open.
///
/// The last one to leave a stream removes it, and fails to when its book in `/dev/shm` is another user's: the stream
/// would be "just being taken down" for ever. The description lies in the group's directory, where every member can
/// remove it; the book goes as an orphan, at its owner's next start.
fn remove_deserted_services(config: &Config, places: &Places) {
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

/// Removes this user's pools and books of ports and streams that are no more: what another user who was the last to let
/// go of them could not remove.
pub(crate) fn remove_orphans(config: &Config, places: &Places) {
    // In this order: what is made meanwhile is not in the first list.
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
        // A hash of the type, then the identity.
        let is_known = stem.split('_').skip(1).any(|id| known.contains(id));
        if ["data", "dynamic"].contains(&kind) && !is_known {
            remove_settled(file);
        }
    }
}

/// Removes this user's connections of which an end is no more, in a domain that a group shares: who lets go last would
/// remove them, but cannot remove another user's. Who still has one mapped keeps it; nobody opens it again.
pub(crate) fn remove_own_connections(places: &Places) {
    let files: Vec<PathBuf> = places
        .in_shared_memory()
        .filter(|path| path.extension().is_some_and(|kind| kind == "connection"))
        .collect();
    let tagged = places.tagged_ports();
    for file in files.iter().filter(|file| is_own(file)) {
        let stem = file.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        // Behind a hash of the type, the two ends.
        if stem.split('_').skip(1).any(|id| !tagged.contains(id)) {
            let _ = fs::remove_file(file);
        }
    }
}

/// Removes what iceoryx2 keeps after the last node of a domain: its node counter, and the directories that all
/// domains share if nobody is left in any of them.
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
    // Only empty directories can be removed this way; while any node of any domain lives, the first is not.
    places.remove_empty_directories()
}
