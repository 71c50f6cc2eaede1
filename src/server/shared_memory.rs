//! [`SharedMemory`]: the sink that publishes streams in shared memory.

use super::post::{Post, Sender};
use super::room::Room;
use crate::rig::sink::{Frame, Port, Sink};
use belvedere_bridge::{Consumer, Error, Lossless, Node, Publisher, StreamSpec};
use std::sync::Arc;

/// Publishes streams of a node.
#[derive(Debug, Clone)]
pub struct SharedMemory {
    /// The node that publishes the streams.
    pub node: Node,
    /// The consumers that every stream waits for, if any.
    pub lossless: Option<Lossless>,
    /// Sends frames that are made ahead of time. Without it, frames are sent when they are made.
    pub post: Option<Arc<Post>>,
    /// Limits the streams' pools.
    pub room: Room,
}

impl SharedMemory {
    /// Creates a sink whose streams wait for no consumer and send frames when they are made.
    pub fn new(node: Node) -> Self {
        Self { node, lossless: None, post: None, room: Room::default() }
    }
}

/// One stream.
struct Stream {
    publisher: Publisher,
    post: Option<Arc<Post>>,
    sender: Arc<Sender>,
    /// Number of frames that may be in the post.
    loaned: usize,
}

impl Sink for SharedMemory {
    fn open(&self, spec: &StreamSpec) -> Result<Box<dyn Port>, Error> {
        let spec = StreamSpec { lossless: self.lossless.clone(), ..self.room.cut(spec) };
        Ok(Box::new(Stream {
            publisher: self.node.publisher(&spec)?,
            post: self.post.clone(),
            sender: Arc::default(),
            loaned: spec.loaned,
        }))
    }
}

impl Port for Stream {
    fn is_wanted(&self) -> bool {
        self.publisher.subscribers() > 0
    }

    fn keeps_messages(&self) -> bool {
        true
    }

    /// A frame in the post remains on loan, so this waits until the post leaves room for the next.
    fn loan(&self, len: usize) -> Result<Frame, Error> {
        if let Some(post) = &self.post {
            post.wait_for_room(&self.sender, self.loaned);
        }
        self.publisher.loan(len).map(Frame::Shared)
    }

    fn send(&self, frame: Frame) -> Result<(), Error> {
        // `loan` returns only shared frames.
        let Frame::Shared(frame) = frame else { return Ok(()) };
        match &self.post {
            Some(post) => post.send(frame, &self.sender),
            None => {
                frame.send()?;
            }
        }
        Ok(())
    }

    fn update(&self) -> Result<(), Error> {
        self.publisher.update()
    }

    fn subscribers(&self) -> usize {
        self.publisher.subscribers()
    }

    fn consumers(&self) -> Vec<Consumer> {
        self.publisher.consumers()
    }

    fn failed(&self) -> u64 {
        self.sender.failed()
    }
}
