//! Streams in shared memory.

use super::post::{Post, Sender};
use super::room::Room;
use crate::rig::sink::{Frame, Port, Sink};
use belvedere_bridge::{Consumer, Error, Lossless, Node, Publisher, StreamSpec};
use std::sync::Arc;

/// The streams of a node.
#[derive(Debug, Clone)]
pub struct SharedMemory {
    /// By which they are published.
    pub node: Node,
    /// Whom every stream waits for, if for anybody.
    pub lossless: Option<Lossless>,
    /// By what frames go that are made ahead of their time; without it they are sent when they are made.
    pub post: Option<Arc<Post>>,
    /// How large their pools may be.
    pub room: Room,
}

impl SharedMemory {
    /// The streams of a node, which wait for nobody and are sent when they are made.
    pub fn new(node: Node) -> Self {
        Self { node, lossless: None, post: None, room: Room::default() }
    }
}

/// One of them.
struct Stream {
    publisher: Publisher,
    post: Option<Arc<Post>>,
    sender: Arc<Sender>,
    /// Frames that may be on their way.
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

    /// A frame is on loan until it is sent: those that wait for their time leave room for the next.
    fn loan(&self, len: usize) -> Result<Frame, Error> {
        if let Some(post) = &self.post {
            post.wait_for_room(&self.sender, self.loaned);
        }
        self.publisher.loan(len).map(Frame::Shared)
    }

    fn send(&self, frame: Frame) -> Result<(), Error> {
        // None other was loaned here.
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
