//! Who lives: told by iceoryx2's nodes, and by the processes that files are named after.

use std::path::Path;

use iceoryx2::{
    node::{DeadNodeView, Node as IoxNode, NodeState},
    prelude::{CallbackProgression, Config},
};

use super::Ipc;
use crate::clock;

/// Longer than it takes any living process to make a node, a socket or a segment complete.
const MAKING_NS: u64 = 1_000_000_000;

/// Whether a node of the domain is alive, or may be.
pub(super) fn anybody_lives(config: &Config) -> bool {
    let mut lives = false;
    let listed = IoxNode::<Ipc>::list(config, |state| {
        lives |= match state {
            NodeState::Alive(_) | NodeState::Inaccessible(_) => true,
            NodeState::Dead(_) => false,
            // Its monitor has been spoilt: only its process can tell.
            NodeState::Undefined(id) => runs(id.value()),
        };
        CallbackProgression::Continue
    });
    lives || listed.is_err()
}

/// Whether the process that made an identity runs. The third quarter of its bits is the process's number.
pub(super) fn runs(id: u128) -> bool {
    Path::new(&format!("/proc/{}", (id >> 64) as u32)).exists()
}

/// Whether a process runs whose identities are in the name of a file, or of the directory that it is in.
pub(super) fn maker_runs(file: &Path) -> bool {
    let names = [file.file_name(), file.parent().and_then(Path::file_name)];
    names.into_iter().flatten().filter_map(|name| name.to_str()).flat_map(identities).any(runs)
}

/// The identities in a file's name.
pub(super) fn identities(name: &str) -> impl Iterator<Item = u128> {
    let numbers = name.split(|letter: char| !letter.is_ascii_digit());
    // Shorter ones are a domain's, a version's or part of a hash.
    numbers.filter(|digits| digits.len() > 20).filter_map(|digits| digits.parse().ok())
}

/// The nodes of the domain whose processes are no more.
pub(super) fn dead_nodes(config: &Config) -> Vec<DeadNodeView<Ipc>> {
    let mut dead = Vec::new();
    let _ = IoxNode::<Ipc>::list(config, |state| {
        if let NodeState::Dead(node) = state {
            dead.push(node);
        }
        CallbackProgression::Continue
    });
    dead
}

/// Whether an identifier of iceoryx2 0.10 was made more than [`MAKING_NS`] ago: its lowest 32 bits are the seconds of
/// `CLOCK_MONOTONIC` then, the next 32 the nanoseconds.
pub(super) fn born_long_ago(id: &str) -> bool {
    let Ok(id) = id.parse::<u128>() else { return false };
    let born_ns = u64::from(id as u32) * 1_000_000_000 + u64::from((id >> 32) as u32);
    // Either way: a process in another time namespace was not born in this one's future.
    clock::mono_ns().abs_diff(born_ns) > MAKING_NS
}
