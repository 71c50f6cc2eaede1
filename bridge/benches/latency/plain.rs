//! Transport by iceoryx2 alone with the same settings, as the reference.
#![allow(unsafe_code, reason = "as in the bridge's own `loan`")]

use std::time::{Duration, Instant};

use belvedere_bridge::{StreamSpec, clock::mono_ns};
use iceoryx2::{
    port::{listener::Listener, notifier::Notifier, publisher::Publisher, subscriber::Subscriber},
    prelude::{Config, FileName, LogLevel, NodeBuilder, SemanticString as _, ZeroCopySend, ipc_threadsafe},
    service::port_factory::{event, publish_subscribe},
};

use crate::{Sender, consumer::Receiver};

type Ipc = ipc_threadsafe::Service;

/// A header as large as the bridge's, which holds only the send time.
#[derive(Debug, Default, ZeroCopySend)]
#[repr(C)]
#[repr(align(64))]
pub(crate) struct Header {
    sent_ns: u64,
    rest: [u64; 31],
}

type Frames = publish_subscribe::PortFactory<Ipc, [u8], Header>;
type Events = event::PortFactory<Ipc>;

/// The start of the names of all files in shared memory, of the process whose id is the last but one part of `domain`.
fn prefix(domain: &str) -> String {
    let (process, _number) = domain.rsplit_once('-').expect("a fresh name");
    format!("{process}-plain.")
}

/// Removes the file that iceoryx2 leaves for each prefix.
pub(crate) fn remove_remains() {
    let prefix = prefix(&crate::fresh_name());
    for file in std::fs::read_dir("/dev/shm").into_iter().flatten().flatten() {
        if file.file_name().as_encoded_bytes().starts_with(prefix.as_bytes()) {
            let _ = std::fs::remove_file(file.path());
        }
    }
}

fn open_services(domain: &str) -> (Frames, Events) {
    iceoryx2::prelude::set_log_level(LogLevel::Fatal);
    let mut config = Config::default();
    config.global.prefix = FileName::new(prefix(domain).as_bytes()).expect("a prefix");
    let node = NodeBuilder::new().config(&config).create::<Ipc>().expect("a node");
    let name = domain.try_into().expect("a name");
    let spec = StreamSpec::new("", belvedere_bridge::Kind::Image, belvedere_bridge::Encoding::Mono8, 1);
    let frames = node
        .service_builder(&name)
        .publish_subscribe::<[u8]>()
        .user_header::<Header>()
        .max_publishers(spec.max_publishers)
        .max_subscribers(spec.max_subscribers)
        .subscriber_max_buffer_size(spec.buffer)
        .subscriber_max_borrowed_samples(spec.borrowed)
        .history_size(spec.history)
        .open_or_create()
        .expect("a service");
    (frames, node.service_builder(&name).event().open_or_create().expect("an event service"))
}

pub(crate) struct Plain {
    port: Publisher<Ipc, [u8], Header>,
    notifier: Notifier<Ipc>,
    _services: (Frames, Events),
    size: usize,
}

impl Plain {
    pub(crate) fn open(domain: &str, size: usize) -> Self {
        let (frames, events) = open_services(domain);
        let port = frames.publisher_builder().initial_max_slice_len(size).create().expect("a publisher");
        let notifier = events.notifier_builder().create().expect("a notifier");
        Self { port, notifier, _services: (frames, events), size }
    }
}

impl Sender for Plain {
    fn send(&self) {
        let mut sample = self.port.loan_slice_uninit(self.size).expect("a sample");
        sample.user_header_mut().sent_ns = mono_ns();
        // SAFETY: pages of shared memory are never uninitialised, the kernel gives them out zeroed, and `u8` has no
        // invalid values; `bridge/src/loan.rs` has the long form.
        let sample = unsafe { sample.assume_init() };
        sample.send().expect("sent");
        self.notifier.notify().expect("notified");
    }
}

pub(crate) struct PlainTaken {
    port: Subscriber<Ipc, [u8], Header>,
    listener: Listener<Ipc>,
    _services: (Frames, Events),
}

impl PlainTaken {
    pub(crate) fn open(domain: &str) -> Self {
        let (frames, events) = open_services(domain);
        let listener = events.listener_builder().create().expect("a listener");
        let port = frames.subscriber_builder().create().expect("a subscriber");
        Self { port, listener, _services: (frames, events) }
    }
}

impl Receiver for PlainTaken {
    fn take(&mut self) -> Option<u64> {
        let deadline = Instant::now() + Duration::from_secs(1);
        while !self.port.has_samples().expect("a connection") {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return None;
            }
            self.listener.timed_wait(|_| {}, left).expect("a wait");
        }
        self.port.receive().expect("a sample").map(|sample| sample.user_header().sent_ns)
    }
}
