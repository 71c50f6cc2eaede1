//! Sensor frames in shared memory, handed from one process to others without a copy.
//!
//! A *stream* has the name of the ROS topic it would have. Its publisher [loans](Publisher::loan) a frame, which
//! is a piece of shared memory, writes a [`FrameHeader`] of 384 bytes and the payload where they lie, and
//! [sends](LoanedFrame::send) it: subscribers get its address. A *domain* is what one simulation shares; several
//! run side by side under different names. The transport is iceoryx2; the layout of every byte is in
//! `bridge/WIRE.md`.
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
//!     frame.payload_mut().fill(128); // render here: this is the subscribers' memory
//!     frame.send()?;
//! }
//! # Ok(())
//! # }
//! ```
//! Small fixed messages: [`Publisher::send_structs`] with a type of [`payload`]. A stream that is written once or
//! seldom calls [`Publisher::update`] now and then, so that late subscribers get its last frame.
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
//! // Commands go the other way: many may send, the simulator keeps the stream.
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
//! # What holds
//! - `loan` and `send` do not copy, nor allocate but for iceoryx2's record of a loan (104 bytes). A slow subscriber loses its own oldest frame and slows nobody,
//!   unless the stream is made [`lossless`](Lossless).
//! - A payload begins at a multiple of 64 bytes. A [`Frame`]'s geometry was checked against its payload.
//! - A [`Subscriber`] may be there before its publisher and outlives it; [`Frame::restarted`] and
//!   [`Frame::missed`] tell what happened in between.
//! - All types may move to other threads. One process may open several nodes, of several domains.
//! - Whoever opens a node removes what killed processes of its domain left; the last one leaves no file.
//!
//! # Layers
//! [`Text`], [`payload`], [`Kind`], [`Encoding`], [`FrameHeader`]: the bytes. [`Domain`]: names. [`Node`]:
//! membership. [`StreamSpec`], [`StreamInfo`]: streams. [`Publisher`], [`LoanedFrame`], [`Subscriber`],
//! [`Frame`], [`FrameView`]: the two ends. [`Synchronizer`]: several streams at once. [`SimulationControl`]: commands to a
//! simulator. [`Error`], [`FrameError`]: what can go wrong, and what to do about it.
//!
//! Without the feature `shared-memory`, which is a default, there are the bytes and [`StreamSpec`] alone.
#![deny(unsafe_code)]
// The examples above are of shared memory.
#![cfg_attr(not(feature = "shared-memory"), allow(rustdoc::broken_intra_doc_links))]

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
    DistortionModel, Encoding, FrameError, FrameHeader, FrameView, Intrinsics, Kind, MAX_DISTORTION,
    Operation, ScanGeometry, Text, TextError, payload, schema,
};
