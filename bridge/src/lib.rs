//! Sensor frames in shared memory, passed from one process to others without a copy.
//!
//! A *stream* is named like a ROS topic. Its publisher [loans](Publisher::loan) a frame, which is a piece of shared
//! memory, writes a [`FrameHeader`] of 384 bytes and the payload in place, and [sends](LoanedFrame::send) it:
//! subscribers receive its address. A *domain* separates simulations: several run side by side under different names.
//! The transport is iceoryx2. The layout of every byte is in `bridge/WIRE.md`.
//!
//! # Writing
//! ```
//! use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};
//!
//! # fn main() -> Result<(), belvedere_bridge::Error> {
//! # let domain = Domain::new(&format!("doc-w-{}", std::process::id()))?;
//! # /*
//! let domain = Domain::default();
//! # */
//! let node = Node::open(&domain, "my-simulator")?;
//! let spec = StreamSpec::new("camera/rgb/image_raw", Kind::Image, Encoding::Rgb8, 640 * 480 * 3)
//!     .frame_id("camera_rgb_optical_frame")
//!     .rate_hz(30.0);
//! let publisher = node.publisher(&spec)?;
//!
//! if publisher.subscribers() > 0 || true {
//!     let mut frame = publisher.loan(640 * 480 * 3)?;
//!     frame.header_mut().set_packed(640, 480);
//!     frame.header_mut().stamp_ns = 33_333_333;
//!     frame.payload_mut().fill(128); // render here: subscribers read this memory
//!     frame.send()?;
//! }
//! # Ok(())
//! # }
//! ```
//! Small fixed messages are sent by [`Publisher::send_structs`] with a type of [`payload`]. On a stream that is written
//! once or rarely, call [`Publisher::update`] regularly, so that late subscribers receive its last frame.
//!
//! # Reading
//! ```
//! use std::time::Duration;
//! use belvedere_bridge::{Domain, Node, StreamSpec, payload::VelocityCommand};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let domain = Domain::new(&format!("doc-r-{}", std::process::id()))?;
//! # /*
//! let domain = Domain::default();
//! # */
//! let node = Node::open(&domain, "my-consumer")?;
//! let mut subscriber = node.subscriber("/camera/rgb/image_raw")?;
//! while subscriber.wait(Duration::from_millis(10))? {
//!     while let Some(frame) = subscriber.take()? {
//!         println!("{} bytes, {} missed", frame.payload().len(), frame.missed());
//!     }
//! }
//!
//! // Commands go the other way: many processes may send them, and the simulator owns the stream.
//! let spec = StreamSpec::velocity_command("cmd_vel");
//! let mut commands = node.command_subscriber(&spec)?;
//! let driver = node.publisher(&spec)?;
//! driver.send_structs(0, &[VelocityCommand { linear: [0.2, 0.0, 0.0], angular: [0.0; 3] }])?;
//! let command: VelocityCommand = commands.take_newest()?.ok_or("nothing came")?.message()?;
//! assert_eq!(command.linear[0], 0.2);
//! # Ok(())
//! # }
//! ```
//!
//! # Guarantees
//! - `loan` and `send` do not copy the payload, and allocate only iceoryx2's record of a loan (104 bytes).
//! - A slow subscriber loses its own oldest frame and does not slow the publisher, unless the stream is
//!   [`lossless`](Lossless).
//! - A payload begins at a multiple of 64 bytes. The geometry of a [`Frame`] has been checked against its payload.
//! - A [`Subscriber`] may be created before its publisher and outlives it; [`Frame::restarted`] and [`Frame::missed`]
//!   report what happened in between.
//! - All types may move to other threads. One process may open several nodes, of several domains.
//! - Opening a node removes what killed processes of its domain left. The last node to close leaves no file.
//!
//! # Layers
//! - Wire format: [`Text`], [`payload`], [`Kind`], [`Encoding`], [`FrameHeader`].
//! - Payloads by name: [`Describe`], [`Fields`]; as messages of ROS: [`RosMessage`], [`RosBytes`].
//! - Names: [`Domain`]. Membership: [`Node`].
//! - Streams: [`StreamSpec`], [`StreamInfo`].
//! - Their ends: [`Publisher`], [`LoanedFrame`], [`Subscriber`], [`Frame`], [`FrameView`].
//! - Several streams at once: [`Synchronizer`].
//! - Commands to a simulator: [`SimulationControl`].
//! - Failures, and how to resolve them: [`Error`], [`FrameError`].
//!
//! Without the feature `shared-memory`, which is enabled by default, the crate has only the wire format and
//! [`StreamSpec`].
#![deny(unsafe_code)]
// The examples above use shared memory.
#![cfg_attr(not(feature = "shared-memory"), allow(rustdoc::broken_intra_doc_links))]

#[cfg(all(feature = "shared-memory", not(target_os = "linux")))]
compile_error!(
    "the feature `shared-memory` of belvedere-bridge needs Linux; without it (default-features = false) the wire format \
     compiles on any system, as do belvedere without its default features and belvedere-sensors"
);

#[cfg(feature = "shared-memory")]
pub mod clock;
mod consumer;
#[cfg(feature = "shared-memory")]
mod control;
#[cfg(feature = "shared-memory")]
mod domain;
mod error;
#[cfg(feature = "shared-memory")]
mod node;
#[cfg(feature = "shared-memory")]
pub mod open_files;
#[cfg(feature = "shared-memory")]
mod own;
#[cfg(feature = "shared-memory")]
mod publisher;
mod session;
mod spec;
#[cfg(feature = "shared-memory")]
mod stream;
#[cfg(feature = "shared-memory")]
mod subscriber;
#[cfg(feature = "shared-memory")]
mod synchronizer;
mod topic;
mod wire;

pub use consumer::Consumer;
#[cfg(feature = "shared-memory")]
pub use control::SimulationControl;
#[cfg(feature = "shared-memory")]
pub use domain::{Domain, Group};
pub use error::{Error, ICEORYX2_VERSION};
#[cfg(feature = "shared-memory")]
pub use node::Node;
#[cfg(feature = "shared-memory")]
pub use publisher::{LoanedFrame, Publisher};
pub use spec::{Lossless, StreamSpec};
#[cfg(feature = "shared-memory")]
pub use stream::StreamInfo;
#[cfg(feature = "shared-memory")]
pub use subscriber::{Frame, Subscriber};
#[cfg(feature = "shared-memory")]
pub use synchronizer::Synchronizer;
pub use wire::{
    Describe, DistortionModel, Encoding, Fields, FrameError, FrameHeader, FrameView, Intrinsics, Kind,
    MAX_DISTORTION, Operation, Ros, RosBytes, RosMessage, RosPrimitive, RosType, ScanGeometry, Text,
    TextError, Value, payload, point, schema,
};
