//! Determines which processes are alive, from iceoryx2's nodes and from the process ids in file names.

use std::path::Path;

use iceoryx2::{
    node::{DeadNodeView, Node as IoxNode, NodeState},
    prelude::{CallbackProgression, Config},
};

use super::Ipc;
use crate::clock;

/// An upper bound on the time in which a running process completes a node, a socket or a segment.
const MAKING_NS: u64 = 1_000_000_000;

/// Returns true if a node of the domain is alive, or may be.
pub(super) fn anybody_lives(config: &Config) -> bool {
    let mut lives = false;
    let listed = IoxNode::<Ipc>::list(config, |state| {
        lives |= match state {
            NodeState::Alive(_) | NodeState::Inaccessible(_) => true,
            NodeState::Dead(_) => false,
            // The monitor is damaged, so check its process instead.
            NodeState::Undefined(id) => runs(id.value()),
        };
        CallbackProgression::Continue
    });
    lives || listed.is_err()
}

/// Returns true if the process that made an identifier is running. Bits 64 to 95 of the identifier are the process id.
pub(super) fn runs(id: u128) -> bool {
    Path::new(&format!("/proc/{}", (id >> 64) as u32)).exists()
}

/// Returns true if a process is running whose identifier appears in the name of a file, or of its directory.
pub(super) fn maker_runs(file: &Path) -> bool {
    let names = [file.file_name(), file.parent().and_then(Path::file_name)];
    names.into_iter().flatten().filter_map(|name| name.to_str()).flat_map(identities).any(runs)
}

/// Returns the identifiers in a file's name.
pub(super) fn identities(name: &str) -> impl Iterator<Item = u128> {
    let numbers = name.split(|letter: char| !letter.is_ascii_digit());
    // Shorter numbers belong to a domain, a version or part of a hash.
    numbers.filter(|digits| digits.len() > 20).filter_map(|digits| digits.parse().ok())
}

/// Returns the nodes of the domain whose processes have ended.
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

/// Returns true if an identifier of iceoryx2 0.10 was made more than [`MAKING_NS`] ago: its lowest 32 bits are the
/// seconds of `CLOCK_MONOTONIC` at that time, the next 32 the nanoseconds.
pub(super) fn born_long_ago(id: &str) -> bool {
    let Ok(id) = id.parse::<u128>() else { return false };
    let born_ns = u64::from(id as u32) * 1_000_000_000 + u64::from((id >> 32) as u32);
    // The absolute difference, since the clock of another time namespace may be ahead of this one.
    clock::mono_ns().abs_diff(born_ns) > MAKING_NS
}
