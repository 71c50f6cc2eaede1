//! The publishers and subscribers that have a stream open, living and dead.

use std::collections::{HashMap, HashSet};

use iceoryx2::{
    identifiers::UniqueNodeId,
    node::{Node as IoxNode, NodeState, NodeView as _},
    prelude::CallbackProgression,
    service::port_factory::PortFactory as _,
};

use super::Frames;
use crate::{Consumer, Node, domain::Ipc};

/// Returns the port ids of a stream's subscribers, with one read of shared memory.
pub(crate) fn of_subscribers(frames: &Frames) -> Vec<u128> {
    let mut ports = Vec::new();
    frames.dynamic_config().list_subscribers(|subscriber| {
        ports.push(subscriber.subscriber_id.value());
        CallbackProgression::Continue
    });
    ports
}

/// Returns a checksum of the subscribers' port ids, which changes when the subscribers change.
pub(crate) fn sum_of_ports(frames: &Frames) -> u64 {
    let mut sum = 0_u64;
    frames.dynamic_config().list_subscribers(|subscriber| {
        let port = subscriber.subscriber_id.value();
        sum = sum.wrapping_add((port ^ (port >> 64)) as u64);
        CallbackProgression::Continue
    });
    sum
}

/// Returns the port id and the process of each subscriber of a stream.
///
/// Reads some files for each node of the domain: call it when the subscribers have changed, not for every frame.
pub(crate) fn consumers(node: &Node, frames: &Frames) -> Vec<(u128, Consumer)> {
    let mut ports = Vec::new();
    frames.dynamic_config().list_subscribers(|subscriber| {
        ports.push((subscriber.subscriber_id.value(), subscriber.node_id));
        CallbackProgression::Continue
    });
    if ports.is_empty() {
        return Vec::new();
    }
    let names = node_names(node);
    ports.into_iter().map(|(port, id)| (port, named(&names, id))).collect()
}

/// Returns the process that publishes a stream; with an empty name and pid 0 if there is none.
pub(crate) fn publisher(node: &Node, frames: &Frames) -> Consumer {
    let mut holder = Consumer { name: String::new(), pid: 0 };
    let names = node_names(node);
    frames.dynamic_config().list_publishers(|publisher| {
        holder = named(&names, publisher.node_id);
        CallbackProgression::Stop
    });
    holder
}

/// Returns true if a slot of the stream belongs to a dead process. The slot will soon be free: either another process
/// is already cleaning up, or this function restores the dead node's files so that it can be cleaned up.
pub(crate) fn place_of_the_dead(node: &Node, frames: &Frames) -> bool {
    let (mut living, mut dead) = (HashSet::new(), HashSet::new());
    let listed = IoxNode::<Ipc>::list(node.keeper().config(), |state| {
        let nodes = if matches!(state, NodeState::Dead(_)) { &mut dead } else { &mut living };
        nodes.insert(state.node_id().value());
        CallbackProgression::Continue
    });
    let mut ports: HashMap<u128, Vec<u128>> = HashMap::new();
    frames.dynamic_config().list_publishers(|publisher| {
        ports.entry(publisher.node_id.value()).or_default().push(publisher.publisher_id.value());
        CallbackProgression::Continue
    });
    frames.dynamic_config().list_subscribers(|subscriber| {
        ports.entry(subscriber.node_id.value()).or_default().push(subscriber.subscriber_id.value());
        CallbackProgression::Continue
    });
    ports.retain(|id, _| !living.contains(id));
    if listed.is_ok() {
        for (id, ports) in ports.iter().filter(|(id, _)| !dead.contains(id)) {
            node.keeper().raise(frames.service_hash().as_str(), *id, ports);
        }
    }
    !ports.is_empty()
}

fn named(names: &HashMap<u128, String>, id: UniqueNodeId) -> Consumer {
    Consumer {
        name: names.get(&id.value()).cloned().unwrap_or_default(),
        pid: id.pid::<Ipc>().map_or(0, |pid| pid.value().cast_unsigned()),
    }
}

fn node_names(node: &Node) -> HashMap<u128, String> {
    let mut names = HashMap::new();
    let _ = IoxNode::<Ipc>::list(node.keeper().config(), |state| {
        let details = match &state {
            NodeState::Alive(alive) => alive.details().clone(),
            NodeState::Dead(dead) => dead.details().clone(),
            NodeState::Inaccessible(_) | NodeState::Undefined(_) => None,
        };
        if let Some(details) = details {
            names.insert(state.node_id().value(), details.name().to_string());
        }
        CallbackProgression::Continue
    });
    names
}
