//! A publisher on plain iceoryx2, which can write any header. See bridge/WIRE.md.

use std::{
    os::unix::fs::FileExt as _,
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Encoding, FrameHeader, Kind, Text};
use bytemuck::Zeroable as _;
use iceoryx2::{
    port::{backpressure_strategy::BackpressureStrategy, notifier::Notifier, publisher::Publisher},
    prelude::ipc,
    service::port_factory::{PortFactory as _, event, publish_subscribe},
};

use crate::{
    headers::{self, Case, PAYLOAD_LEN},
    processes_kit::{PATIENCE, Random, Role, TestDomain, plain, report},
};

pub(crate) const TOPIC: &str = "hostile";
/// The `frame_id` of the last frame, which is valid.
pub(crate) const END: &str = "end";

struct Hostile {
    port: Publisher<ipc::Service, [u8], FrameHeader>,
    notifier: Notifier<ipc::Service>,
    frames: publish_subscribe::PortFactory<ipc::Service, [u8], FrameHeader>,
    _events: event::PortFactory<ipc::Service>,
    sent: u64,
}

impl Hostile {
    fn open(domain: &Domain, max_len: usize, overflow: bool) -> Self {
        let (node, name) = (plain::node(domain), plain::service(TOPIC));
        let frames = node
            .service_builder(&name)
            .publish_subscribe::<[u8]>()
            .user_header::<FrameHeader>()
            .subscriber_max_buffer_size(16)
            .history_size(0)
            .enable_safe_overflow(overflow)
            .create()
            .unwrap();
        let events = node.service_builder(&name).event().open_or_create().unwrap();
        let port = frames
            .publisher_builder()
            .initial_max_slice_len(max_len)
            .backpressure_strategy(BackpressureStrategy::RetryUntilDelivered)
            .create()
            .unwrap();
        let notifier = events.notifier_builder().create().unwrap();
        Self { port, notifier, frames, _events: events, sent: 0 }
    }

    fn subscribers(&self) -> usize {
        self.frames.dynamic_config().number_of_subscribers()
    }

    fn wait_for(&self, what: impl Fn(usize) -> bool) {
        let deadline = Instant::now() + PATIENCE;
        while !what(self.subscribers()) && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn send(&mut self, header: &FrameHeader, payload: &[u8]) {
        let mut sample = self.port.loan_slice(payload.len()).unwrap();
        *sample.user_header_mut() = *header;
        sample.payload_mut().copy_from_slice(payload);
        sample.send().unwrap();
        let _ = self.notifier.notify();
        self.sent += 1;
    }

    /// Sends the valid last frame until all subscribers have received it and gone.
    fn end(mut self) {
        let mut header = FrameHeader::new(Kind::Clock, Encoding::Struct);
        header.frame_id = Text::new(END).unwrap();
        header.payload_len = header.set_packed(1, 1) as u64;
        let deadline = Instant::now() + 3 * PATIENCE;
        while self.subscribers() > 0 && Instant::now() < deadline {
            self.send(&header, &[0; 8]);
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// Sends a valid frame of session 77, a corrupt one that claims another session, and a valid one.
pub(crate) fn one_of_three_is_corrupt(domain: &Domain) -> impl FnMut() {
    let mut hostile = Hostile::open(domain, PAYLOAD_LEN, true);
    let mut seq = 0;
    move || {
        let mut header = FrameHeader::new(Kind::Clock, Encoding::Struct);
        header.payload_len = header.set_packed(1, 1) as u64;
        header.session = 77;
        header.seq = seq;
        if seq == 1 {
            header = FrameHeader { magic: 0, session: 5, seq: 1 << 40, ..header };
        }
        hostile.send(&header, &[0; 8]);
        seq += 1;
    }
}

/// Sends hostile headers. Arguments: the number of subscribers to wait for, the number of random headers. Reports how
/// many frames were sent, and how many of them are valid.
pub(crate) fn attack(role: &Role) {
    let mut hostile = Hostile::open(&role.domain, PAYLOAD_LEN, false);
    let mut random = Random::new(5);
    let payload: Vec<u8> = (0..PAYLOAD_LEN).map(|_| random.next() as u8).collect();
    report("ready");
    let expected = role.number(0) as usize;
    hostile.wait_for(|subscribers| subscribers >= expected);
    let mut acceptable = 0_u64;
    let mut send = |case: &Case| {
        acceptable += u64::from(headers::is_acceptable(case));
        hostile.send(&case.header, &payload[..case.available]);
    };
    headers::one_field_wrong().iter().for_each(&mut send);
    for _ in 0..role.number(1) {
        send(&headers::at_random(&mut random));
    }
    let sent = hostile.sent;
    report(format_args!("sent {sent} {acceptable}"));
    hostile.end();
}

/// Sends valid images and rewrites their headers and payloads all the time, through its own mapping of the pool's file.
/// Arguments: the number of subscribers to wait for, the duration in milliseconds.
pub(crate) fn rewrite(role: &Role) {
    let mut hostile = Hostile::open(&role.domain, PAYLOAD_LEN, true);
    report("ready");
    let expected = role.number(0) as usize;
    hostile.wait_for(|subscribers| subscribers >= expected);

    let mut honest = FrameHeader::new(Kind::Image, Encoding::Mono8);
    honest.payload_len = honest.set_packed(64, 64) as u64;
    let end = Instant::now() + Duration::from_millis(role.number(1));
    let domain = role.domain.clone();
    let rewriter = std::thread::spawn(move || {
        let pool = TestDomain::pools_of(&domain).remove(0);
        let file = std::fs::OpenOptions::new().read(true).write(true).open(&pool).unwrap();
        let mut random = Random::new(6);
        let mut rewritten = 0_u64;
        let mut places = Vec::new();
        while Instant::now() < end {
            if places.len() < 8 {
                // Every frame that has been used had a valid header once.
                let bytes = std::fs::read(&pool).unwrap();
                let magic = FrameHeader::MAGIC.to_le_bytes();
                places = (0..bytes.len().saturating_sub(PAYLOAD_LEN + 384))
                    .step_by(64)
                    .filter(|&at| bytes[at..at + 4] == magic)
                    .collect();
            }
            for &place in &places {
                let case = headers::at_random(&mut random);
                let header = if random.below(2) == 0 { honest } else { case.header };
                file.write_all_at(bytemuck::bytes_of(&header), place as u64).unwrap();
                let at = place as u64 + 384 + random.below(PAYLOAD_LEN as u64 - 64);
                file.write_all_at(&[random.next() as u8; 64], at).unwrap();
                rewritten += 1;
            }
        }
        rewritten
    });
    let mut header = FrameHeader::zeroed();
    while Instant::now() < end {
        header = FrameHeader { seq: header.seq + 1, ..honest };
        hostile.send(&header, &[7; PAYLOAD_LEN]);
        std::thread::sleep(Duration::from_micros(200));
    }
    let rewritten = rewriter.join().unwrap();
    report(format_args!("sent {} {rewritten}", hostile.sent));
    hostile.end();
}
