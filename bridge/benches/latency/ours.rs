//! Transport by the bridge.

use std::time::Duration;

use belvedere_bridge::{Domain, Encoding, Kind, Node, Publisher, StreamSpec, Subscriber};

use crate::{Sender, consumer::Receiver};

const TOPIC: &str = "frames";

pub(crate) struct Ours {
    publisher: Publisher,
    size: usize,
}

impl Ours {
    pub(crate) fn open(domain: &str, size: usize) -> Self {
        let node = Node::open(&Domain::new(domain).expect("a name"), "bench").expect("a node");
        let spec = StreamSpec::new(TOPIC, Kind::Image, Encoding::Mono8, size);
        Self { publisher: node.publisher(&spec).expect("a publisher"), size }
    }
}

impl Sender for Ours {
    fn send(&self) {
        let mut frame = self.publisher.loan(self.size).expect("a frame");
        frame.header_mut().set_packed(self.size as u32, 1);
        frame.send().expect("sent");
    }
}

pub(crate) struct OursTaken(Subscriber);

impl OursTaken {
    pub(crate) fn open(domain: &str) -> Self {
        let node = Node::open(&Domain::new(domain).expect("a name"), "bench").expect("a node");
        let mut subscriber = node.subscriber(TOPIC).expect("a topic");
        while subscriber.publishers() == 0 {
            subscriber.wait(Duration::from_millis(10)).expect("a stream");
        }
        Self(subscriber)
    }
}

impl Receiver for OursTaken {
    fn take(&mut self) -> Option<u64> {
        self.0.wait(Duration::from_secs(1)).expect("a wait");
        self.0.take().expect("a frame").map(|frame| frame.header().publish_mono_ns)
    }
}
