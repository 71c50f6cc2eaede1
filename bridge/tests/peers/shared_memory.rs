//! Too little shared memory: an error before the first frame, never a bus error in the middle of one.

use std::{
    fs::{self, File},
    io::Write as _,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    time::Duration,
};

use belvedere_bridge::{Domain, Encoding, Error, Kind, Node, Publisher, StreamSpec, Subscriber};

use crate::{
    processes_kit::domain,
    world::{self, Actor, ROOT},
};

const LEN: usize = 640 * 480 * 3;

#[test]
fn too_little_is_refused_before_the_first_frame() {
    world::run(8, false, too_small);
}

#[test]
fn later_writes_of_other_programs_do_not_use_the_allocated_pages() {
    world::run(48, false, filled_after_the_start);
}

#[test]
fn a_full_shared_memory_is_an_error() {
    world::run(4, false, full);
}

fn spec() -> StreamSpec {
    StreamSpec::new("image_raw", Kind::Image, Encoding::Rgb8, LEN).rate_hz(30.0)
}

fn send(publisher: &Publisher) -> Result<usize, Error> {
    let mut frame = publisher.loan(LEN)?;
    frame.header_mut().set_packed(640, 480);
    frame.payload_mut().fill(200);
    frame.send()
}

fn connected(node: &Node) -> Subscriber {
    let mut subscriber = node.subscriber("image_raw").unwrap();
    assert!(subscriber.wait(Duration::ZERO).is_ok());
    subscriber
}

fn pool_of(domain: &Domain) -> PathBuf {
    let files = world::files_of(domain.as_str());
    files.into_iter().find(|path| path.extension().is_some_and(|kind| kind == "data")).unwrap()
}

fn bytes_taken(pool: &Path) -> u64 {
    fs::metadata(pool).unwrap().blocks() * 512
}

/// Fills `/dev/shm` to its last byte.
fn fill() -> PathBuf {
    let path = PathBuf::from("/dev/shm/of-another-program");
    let mut file = File::create(&path).unwrap();
    for size in [1 << 16, 1 << 12, 1] {
        while file.write_all(&vec![1; size]).is_ok() {}
    }
    path
}

fn too_small() {
    let node = Node::open(&domain("small"), "test").unwrap();
    let error = node.publisher(&spec()).unwrap_err();
    // 35 frames, and 1 MiB for bookkeeping.
    assert!(matches!(error, Error::SharedMemoryTooSmall { needed_mib: 32, free_mib: 7..=8, .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("/dev/shm is too small") && text.contains("--shm-size"), "{text}");
    // A stream that fits is opened; another one that does not fit in addition is refused.
    let smaller = |topic: &str, len| StreamSpec::new(topic, Kind::Image, Encoding::Mono8, len);
    let _first = node.publisher(&smaller("first", 80_000)).unwrap();
    assert!(matches!(node.publisher(&smaller("second", 160_000)), Err(Error::SharedMemoryTooSmall { .. })));
    // A process that simply starts reports the same.
    let mut actor = Actor::start("simulate_large", "large", ROOT, &[]);
    let told = actor.says("error ");
    assert!(told.contains("needs 32 MiB"), "{told}");
}

fn filled_after_the_start() {
    let domain = domain("filled");
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    let mut subscriber = connected(&node);
    // Before the first frame is written, another program fills the rest.
    let filler = fill();
    let mut held = Vec::new();
    for count in 0..200 {
        assert_eq!(send(&publisher).unwrap(), 1);
        let frame = subscriber.take().unwrap().unwrap();
        assert!(frame.payload().iter().all(|&byte| byte == 200), "{count}");
        held.push(frame);
        if held.len() == 2 {
            held.clear();
        }
    }
    // New subscribers and publishers get errors.
    let mut late = node.subscriber("image_raw").unwrap();
    assert!(matches!(late.wait(Duration::ZERO), Err(Error::SharedMemoryTooSmall { .. })));
    fs::remove_file(&filler).unwrap();
    let more = [connected(&node), connected(&node), connected(&node)];
    assert_eq!(send(&publisher).unwrap(), 4);
    let filler = fill();
    let error = publisher.loan(LEN).unwrap_err();
    assert!(matches!(error, Error::SharedMemoryTooSmall { needed_mib: 1..=21, free_mib: 0, .. }), "{error}");
    // It continues once there is room again.
    fs::remove_file(filler).unwrap();
    assert_eq!(send(&publisher).unwrap(), 4);
    drop(more);
}

fn full() {
    let filler = fill();
    let error = Node::open(&domain("full"), "test").unwrap_err();
    assert!(matches!(error, Error::SharedMemoryTooSmall { free_mib: 0, .. }), "{error}");
    fs::remove_file(filler).unwrap();
    assert!(Node::open(&domain("full"), "test").is_ok());
}

/// `Pool` relies on iceoryx2 reusing the frame that was returned last.
#[test]
fn frames_lie_in_allocated_pages() {
    let domain = domain("taken");
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    let pool = pool_of(&domain);
    let whole = fs::metadata(&pool).unwrap().len();
    let at_first = bytes_taken(&pool);
    assert!(at_first < whole / 2, "{at_first} of {whole}");
    let mut subscribers = Vec::new();
    let mut held = std::collections::VecDeque::new();
    for count in 1..=8 {
        subscribers.push(connected(&node));
        send(&publisher).unwrap();
        drop(publisher.loan(LEN).unwrap());
        let taken = bytes_taken(&pool);
        for round in 0..100 {
            let loaned = publisher.loan(LEN).unwrap();
            send(&publisher).unwrap();
            drop(loaned);
            // Some take all frames, some are behind, and all hold as many as they may.
            for subscriber in subscribers.iter_mut().skip(round % 3) {
                match subscriber.take() {
                    Ok(frame) => held.extend(frame),
                    Err(Error::TooManyHeld { .. }) => {}
                    Err(error) => panic!("{error}"),
                }
            }
            while held.len() > 2 * count - round % 2 {
                held.pop_front();
            }
        }
        assert_eq!(bytes_taken(&pool), taken, "{count} subscribers");
    }
    assert!(bytes_taken(&pool) <= whole.next_multiple_of(4096));
}
