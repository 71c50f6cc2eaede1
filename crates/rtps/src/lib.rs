#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | `guid`, `bytes`, `numbers`, `parameters` | names, numbers, sets of numbers and parameter lists on the wire |
//! | `message` | datagrams and their submessages |
//! | `spdp`, `sedp` | what participants announce of themselves, and of their readers and writers |
//! | `pacing`, `writer` | when which datagram of a topic is sent, and what is kept for its readers |
//! | `assembly`, `reader` | what has come of a topic, and what is missing |
//! | `answer`, `requests` | requests of services, and how a reply names its request |
//! | `sockets`, `engine` | the ports, and the thread that serves them |
//! | `ros` | what ROS 2 adds: names, hashes of types, the graph of nodes |
//! | `participant`, `service` | the interface |
#![forbid(unsafe_code)]

mod answer;
mod assembly;
mod bytes;
mod engine;
#[cfg(test)]
mod exchange;
mod guid;
mod lock;
mod mailbox;
mod message;
#[cfg(test)]
mod mutated;
mod numbers;
mod pacing;
mod parameters;
mod participant;
mod peer;
mod reader;
mod requests;
mod ros;
mod sedp;
mod service;
mod sockets;
mod spdp;
mod writer;

pub use guid::{EntityId, Guid, Prefix};
pub use participant::{Node, Participant, Qos, Reader, Topic, TopicError, Writer};
pub use requests::{Request, Requests};
pub use service::{Service, ServiceType};
pub use sockets::{JoinError, Range};
