//! Sends the streams of a simulator to other machines, over Zenoh.
//!
//! | part | is |
//! |---|---|
//! | [`LinkSender`] | the simulator's side: a consumer of its streams, and a sender of the received commands |
//! | [`LinkReceiver`] | the other side: the same streams in that machine's shared memory, and commands in the other direction |
//! | `mirror` | a stream of the other side |
//! | `room` | limits the shared memory of these streams |
//! | `wire` | keys and messages, and checks of received data |
//! | `transport` | the only file that uses Zenoh |
//! | `tally` | counts carried and lost frames |
//!
//! Keys: `belvedere/DOMAIN/streams` carries a list of the streams once a second, so that a new receiver soon knows
//! them, and a receiver that gets no list knows that the connection is interrupted. `belvedere/DOMAIN/frames/TOPIC`
//! carries frames, header and payload as in shared memory. `belvedere/DOMAIN/commands/TOPIC` carries commands in the
//! other direction. A key without subscribers costs nothing: its stream is neither subscribed to nor rendered.

mod error;
mod mirror;
mod receiver;
mod room;
mod sender;
mod tally;
mod transport;
mod wire;

pub use error::LinkError;
pub use receiver::{LinkReceiver, ReceiverOptions};
pub use sender::{CarriedCommands, LinkSender, SenderOptions};
pub use tally::LinkProgress;
pub use transport::Endpoints;
