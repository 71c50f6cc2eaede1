//! What the publisher writes and what a consumer in another process reads is the same place in the same file.

use std::{
    io::{BufRead as _, BufReader, Write as _},
    process::{Command, Stdio},
    time::Duration,
};

use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};

const DOMAIN: &str = "BRIDGE_TEST_ZERO_COPY_DOMAIN";
const LEN: usize = 640 * 480 * 3;
const FRAMES: u64 = 50;

/// A file in memory and the offset in it that an address of this process stands for.
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

/// Not a test of its own: the consumer. Tells where each frame lies.
#[test]
fn tell_places() {
    let Ok(domain) = std::env::var(DOMAIN) else { return };
    let node = Node::open(&Domain::new(&domain).unwrap(), "consumer").unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    let mut count = 0;
    while count < FRAMES {
        if subscriber.wait(Duration::from_secs(20)).unwrap()
            && let Some(frame) = subscriber.take().unwrap()
        {
            let place = place(frame.payload().as_ptr().addr());
            // Not through `print`, which the test harness captures.
            writeln!(std::io::stderr(), "frame {} {} {place}", frame.header().seq, frame.payload()[LEN - 1])
                .unwrap();
            count += 1;
        }
    }
}

#[test]
fn the_payload_is_read_where_it_was_written() {
    let domain = Domain::new(&format!("zero-{}", std::process::id())).unwrap();
    let node = Node::open(&domain, "publisher").unwrap();
    let publisher = node.publisher(&StreamSpec::new("image", Kind::Image, Encoding::Rgb8, LEN)).unwrap();
    let mut consumer = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "tell_places", "--nocapture"])
        .env(DOMAIN, domain.as_str())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut told = BufReader::new(consumer.stderr.take().unwrap()).lines().map_while(Result::ok);
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
        let there = told.find(|line| line.starts_with("frame ")).unwrap();
        assert_eq!(there, format!("frame {seq} {seq} {here}"));
        places.insert(here);
    }
    assert!(consumer.wait().unwrap().success());
    assert!(places.len() > 1 && places.first().unwrap().starts_with("/dev/shm/"), "{places:?}");
}
