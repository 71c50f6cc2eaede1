//! A consumer in another process reads a frame at the same place of the same file where the publisher wrote it.

use std::time::Duration;

use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};

use crate::processes_kit::{self, PATIENCE, Process, TestDomain, next, report};

const LEN: usize = 640 * 480 * 3;
const FRAMES: u64 = 50;

/// Returns the file and the offset in it that an address of this process maps to.
fn place(address: usize) -> String {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    for line in maps.lines() {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let [range, _rights, offset, _device, _inode, file] = fields[..] else { continue };
        let (start, end) = range.split_once('-').unwrap();
        let [start, end, offset] =
            [start, end, offset].map(|number| usize::from_str_radix(number, 16).unwrap());
        if (start..end).contains(&address) {
            return format!("{file}+{}", address - start + offset);
        }
    }
    panic!("{address:#x} is not mapped from a file");
}

/// Reports where each frame lies.
fn consume(domain: &Domain) {
    let node = Node::open(domain, "consumer").unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    for _ in 0..FRAMES {
        let frame = next(&mut subscriber);
        let place = place(frame.payload().as_ptr().addr());
        report(format_args!("frame {} {} {place}", frame.header().seq, frame.payload()[LEN - 1]));
    }
}

#[test]
fn the_payload_is_read_where_it_was_written() {
    processes_kit::play(|role| consume(&role.domain));
    let domain = TestDomain::new("zero");
    let node = Node::open(&domain, "publisher").unwrap();
    let publisher = node.publisher(&StreamSpec::new("image", Kind::Image, Encoding::Rgb8, LEN)).unwrap();
    let consumer = Process::start(&domain, "consume", &[]);
    while publisher.subscribers() == 0 {
        std::thread::sleep(Duration::from_millis(5));
    }
    let mut places = std::collections::BTreeSet::new();
    for seq in 0..FRAMES {
        let mut frame = publisher.loan(LEN).unwrap();
        frame.header_mut().set_packed(640, 480);
        let here = place(frame.payload().as_ptr().addr());
        frame.payload_mut()[LEN - 1] = seq as u8;
        frame.send().unwrap();
        let there = consumer.next_report(PATIENCE).expect("a consumer that takes");
        assert_eq!(there, format!("frame {seq} {seq} {here}"));
        places.insert(here);
    }
    assert!(consumer.ended_well(PATIENCE));
    assert!(places.len() > 1 && places.first().unwrap().starts_with("/dev/shm/"), "{places:?}");
}
