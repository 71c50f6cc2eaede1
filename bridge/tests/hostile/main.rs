//! Hostile and corrupt headers: every field takes its boundary values and random values, also after sending. A consumer
//! rejects them with a named error, or reads inside the payload; it never panics and never hangs.
//!
//! `.ci/hostile` runs the same publisher against the C++ and Python packages.

#[path = "../processes_kit/mod.rs"]
mod processes_kit;

mod headers;
mod publisher;
mod reader;

use std::time::{Duration, Instant};

use belvedere_bridge::{Domain, Error, FrameError, FrameView, Node};
use headers::PAYLOAD_LEN;
use processes_kit::{PATIENCE, Process, Random, Role, TestDomain, full, report};
use publisher::{END, TOPIC};

fn roles(role: &Role) {
    match role.name.as_str() {
        "attack" => publisher::attack(role),
        "rewrite" => publisher::rewrite(role),
        "consume" => consume(role, false),
        "consume_newest" => consume(role, true),
        name => panic!("no role {name}"),
    }
    // A plain iceoryx2 publisher leaves its counter of nodes; the last node of the bridge removes it.
    drop(Node::open(&role.domain, "last").unwrap());
}

/// Reads every frame completely until the last. Reports how many were valid, and how many were not.
fn consume(role: &Role, newest: bool) {
    let node = Node::open(&role.domain, "consumer").unwrap();
    let mut subscriber = node.subscriber(TOPIC).unwrap();
    let (mut accepted, mut rejected, mut sum) = (0_u64, 0_u64, 0_u64);
    let begin = Instant::now();
    while begin.elapsed() < 3 * PATIENCE {
        subscriber.wait(Duration::from_millis(200)).unwrap();
        loop {
            let taken = if newest { subscriber.take_newest() } else { subscriber.take() };
            match taken {
                Ok(Some(frame)) if frame.header().frame_id.as_str() == END => {
                    return report(format_args!("read {accepted} {rejected} {sum}"));
                }
                Ok(Some(frame)) => {
                    accepted += 1;
                    let name = bytemuck::bytes_of(&frame.header().frame_id);
                    assert_eq!(name.last(), Some(&0), "a name that a reader in C would read past");
                    sum = sum.wrapping_add(reader::read_all(&frame.view()));
                    assert!(frame.age_ns() < u64::MAX);
                    assert!(!format!("{frame:?}").is_empty());
                }
                Ok(None) => break,
                Err(Error::Frame { topic, error }) => {
                    rejected += 1;
                    assert_eq!(topic, TOPIC);
                    assert!(!error.to_string().is_empty());
                }
                Err(error) => panic!("{error}"),
            }
        }
    }
    panic!("no last frame");
}

#[test]
fn every_header_is_rejected_by_name_or_read_within_the_payload() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("attack");
    let at_random = if full() { 2_000_000 } else { 20_000 };
    let attacker = Process::start(&domain, "attack", &[&2, &at_random]);
    attacker.expect("ready");
    let all = Process::start(&domain, "consume", &[]);
    let newest = Process::start(&domain, "consume_newest", &[]);
    let limit = PATIENCE * if full() { 20 } else { 2 };
    let sent = attacker.expect_within("sent", limit);
    let read = all.expect_within("read", limit);
    assert_eq!(read[0], sent[1], "accepted");
    assert_eq!(read[0] + read[1], sent[0], "all came");
    let of_newest = newest.expect_within("read", limit);
    assert!(of_newest[0] > 0 && of_newest[1] > 0, "{of_newest:?}");
    println!("{} hostile frames: {} accepted and read, {} rejected by name", sent[0], read[0], read[1]);
    drop((attacker, all, newest));
    domain.assert_nothing_left_after_the_next_start();
}

#[test]
fn rewritten_headers_lead_nowhere() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("rewrite");
    let duration_ms = if full() { 60_000 } else { 3_000 };
    let attacker = Process::start(&domain, "rewrite", &[&2, &duration_ms]);
    attacker.expect("ready");
    let consumers = ["consume", "consume_newest"].map(|role| Process::start(&domain, role, &[]));
    let limit = PATIENCE + Duration::from_millis(duration_ms);
    let sent = attacker.expect_within("sent", limit);
    for consumer in &consumers {
        let read = consumer.expect_within("read", limit);
        println!("{} sent, rewritten {} times; {} read, {} rejected", sent[0], sent[1], read[0], read[1]);
        assert!(read[0] > 0 && read[1] > 0, "both the rewritten and the honest were seen: {read:?}");
    }
    drop((attacker, consumers));
    domain.assert_nothing_left_after_the_next_start();
}

/// Checks millions of headers without a transport, each with a payload at the end of its memory.
#[test]
fn no_header_leads_outside_its_payload() {
    let mut random = Random::new(7);
    let bytes: Vec<u8> = (0..PAYLOAD_LEN).map(|_| random.next() as u8).collect();
    let (mut accepted, mut rejected) = (0_u64, 0_u64);
    let mut names = std::collections::BTreeSet::new();
    let mut look = |case: &headers::Case| {
        let payload = &bytes[..case.available];
        let result = FrameView::new(&case.header, payload);
        assert_eq!(
            result.is_ok(),
            headers::is_acceptable(case),
            "{:?}, {} bytes",
            case.header,
            case.available
        );
        match result {
            Ok(view) => {
                accepted += 1;
                reader::read_all(&view);
            }
            Err(error) => {
                rejected += 1;
                names.insert(name_of(error));
            }
        }
    };
    headers::one_field_wrong().iter().for_each(&mut look);
    let count = if full() { 100_000_000 } else { 3_000_000 };
    for _ in 0..count {
        look(&headers::at_random(&mut random));
    }
    assert_eq!(names.len(), 6, "every name of an error is used: {names:?}");
    println!("{accepted} headers accepted and read, {rejected} rejected as {names:?}");
}

fn name_of(error: FrameError) -> &'static str {
    match error {
        FrameError::Magic(_) => "magic",
        FrameError::Schema(_) => "schema",
        FrameError::HeaderLen(_) => "header length",
        FrameError::PayloadLen { .. } => "payload length",
        FrameError::Stride { .. } => "stride",
        FrameError::Extent { .. } => "extent",
        error => panic!("not an error of a header: {error}"),
    }
}

#[test]
fn the_numbers_of_a_refused_frame_are_not_believed() {
    let mut domain = TestDomain::new("numbers");
    let mut send = publisher::one_of_three_is_corrupt(&domain);
    let node = Node::open(&domain, "consumer").unwrap();
    let mut subscriber = node.subscriber(TOPIC).unwrap();
    assert!(subscriber.take().unwrap().is_none());
    (0..3).for_each(|_| send());
    assert_eq!(subscriber.take().unwrap().unwrap().missed(), 0);
    let error = subscriber.take().unwrap_err();
    assert!(matches!(error, Error::Frame { error: FrameError::Magic(0), .. }), "{error}");
    let frame = subscriber.take().unwrap().unwrap();
    assert_eq!((frame.missed(), frame.restarted()), (1, false));
    drop((frame, subscriber, node, send));
    domain.assert_nothing_left_after_the_next_start();
}

#[test]
fn the_domain_of_an_attack_is_usable_afterwards() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("after");
    let attacker = Process::start(&domain, "attack", &[&1, &100]);
    attacker.expect("ready");
    let consumer = Process::start(&domain, "consume", &[]);
    consumer.expect_within("read", 2 * PATIENCE);
    attacker.kill();
    consumer.kill();
    let node = Node::open(&Domain::new(domain.as_str()).unwrap(), "honest").unwrap();
    let spec = belvedere_bridge::StreamSpec::structs(TOPIC, belvedere_bridge::Kind::Clock, 1);
    let mut subscriber = node.subscriber(TOPIC).unwrap();
    let publisher = node.publisher(&spec).unwrap();
    assert!(!subscriber.wait(Duration::from_millis(50)).unwrap());
    publisher.send_structs(3, &[belvedere_bridge::payload::Clock { now_ns: 3 }]).unwrap();
    let frame = processes_kit::next(&mut subscriber);
    assert_eq!(frame.message::<belvedere_bridge::payload::Clock>().unwrap().now_ns, 3);
    drop((frame, publisher, subscriber, node));
    domain.assert_nothing_left();
}
