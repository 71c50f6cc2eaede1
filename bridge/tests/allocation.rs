//! After set-up a frame goes from `loan` to `drop` with one small allocation: iceoryx2's own record of a loan, which
//! none of its variants avoids. We add nothing to it, on neither side.

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

const ROUNDS: usize = 1000;

#[test]
fn a_frame_costs_no_allocation_of_ours() {
    let domain = Domain::new(&format!("alloc-{}", std::process::id())).unwrap();
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&StreamSpec::new("image", Kind::Image, Encoding::Mono8, 4096)).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    assert!(!subscriber.wait(Duration::from_millis(20)).unwrap());
    let mut round = || {
        let mut frame = publisher.loan(4096).unwrap();
        frame.header_mut().set_packed(64, 64);
        frame.payload_mut().fill(1);
        frame.send().unwrap();
        assert!(subscriber.wait(Duration::from_secs(10)).unwrap());
        drop(subscriber.take().unwrap().unwrap());
    };
    for _ in 0..50 {
        round();
    }
    let counts = || (ALLOCATIONS.load(Ordering::Relaxed), BYTES.load(Ordering::Relaxed));
    let before = counts();
    (0..ROUNDS).for_each(|_| round());
    let after = counts();
    assert!(after.0 - before.0 <= ROUNDS, "{} allocations in {ROUNDS} frames", after.0 - before.0);
    assert!(after.1 - before.1 <= 128 * ROUNDS, "{} bytes in {ROUNDS} frames", after.1 - before.1);
}
