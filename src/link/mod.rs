//! The streams of a simulator on other machines, over Zenoh.
//!
//! | part | is |
//! |---|---|
//! | [`LinkSender`] | the simulator's side: a consumer of its streams, and a sender of the commands that come |
//! | [`LinkReceiver`] | the other side: the same streams in that machine's shared memory, and commands on their way back |
//! | `mirror` | a stream of the other side's |
//! | `room` | how much shared memory these may take |
//! | `wire` | keys and messages, and the checks of what comes |
//! | `transport` | Zenoh, which no other file knows |
//! | `tally` | what was carried and lost |
//!
//! Keys: `belvedere/DOMAIN/streams` has a list of the streams once a second, so that who comes later knows them in time, and
//! who hears nothing knows that the way is cut; `belvedere/DOMAIN/frames/TOPIC` frames, header and payload as they lie in
//! shared memory; `belvedere/DOMAIN/commands/TOPIC` the same the other way. A key that nobody has subscribed to costs
//! nothing: the stream is not followed, and so not rendered.

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
