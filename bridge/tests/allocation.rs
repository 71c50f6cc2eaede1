//! After set-up, a frame needs one small allocation from `loan` to `drop`: iceoryx2's own record of a loan, which none
//! of its variants avoids. The bridge adds none on either side.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicUsize, Ordering},
    time::Duration,
};

use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
static BYTES: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: every call is passed on to the system's allocator unchanged; counting has no effect on memory.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        BYTES.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's contract is that of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract is that of `System`, where `pointer` came from.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

const ROUNDS: usize = 1050;
const WARM_UP: usize = 50;

#[test]
fn receiving_allocates_nothing_and_sending_one_record_of_the_transport() {
    let domain = Domain::new(&format!("alloc-{}", std::process::id())).unwrap();
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&StreamSpec::new("image", Kind::Image, Encoding::Mono8, 4096)).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    assert!(!subscriber.wait(Duration::from_millis(20)).unwrap());
    let counts = || [ALLOCATIONS.load(Ordering::Relaxed), BYTES.load(Ordering::Relaxed)];
    let since = |before: [usize; 2]| [0, 1].map(|index| counts()[index] - before[index]);
    let (mut loaning, mut sending, mut receiving) = ([0; 2], [0; 2], [0; 2]);
    for round in 0..ROUNDS {
        let before = counts();
        let mut frame = publisher.loan(4096).unwrap();
        let loaned = since(before);
        frame.header_mut().set_packed(64, 64);
        frame.payload_mut().fill(1);
        let before = counts();
        frame.send().unwrap();
        let sent = since(before);
        let before = counts();
        assert!(subscriber.wait(Duration::from_secs(10)).unwrap());
        drop(subscriber.take().unwrap().unwrap());
        let received = since(before);
        if round >= WARM_UP {
            for (total, part) in [(&mut loaning, loaned), (&mut sending, sent), (&mut receiving, received)] {
                *total = [total[0] + part[0], total[1] + part[1]];
            }
        }
    }
    assert_eq!((receiving, sending), ([0; 2], [0; 2]));
    // iceoryx2 0.10 counts the users of a loan in an `Arc` of 104 bytes.
    let [count, bytes] = loaning;
    assert!(count <= ROUNDS - WARM_UP, "{count} allocations in {ROUNDS} frames");
    assert!(bytes <= 128 * (ROUNDS - WARM_UP), "{bytes} bytes in {ROUNDS} frames");
}
