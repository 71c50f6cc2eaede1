//! A child made by `fork` leaves shared memory to its parent.

use std::{collections::BTreeSet, time::Duration};

use belvedere_bridge::{Encoding, Kind, Node, StreamSpec};

use crate::processes_kit::{PATIENCE, TestDomain};

unsafe extern "C" {
    fn fork() -> i32;
    fn waitpid(child: i32, status: *mut i32, options: i32) -> i32;
    fn _exit(status: i32) -> !;
}

/// Runs `act` in a forked child. Returns true if it completed there.
fn in_a_child(act: impl FnOnce()) -> bool {
    // SAFETY: the child has this thread alone, runs `act` and ends by `_exit`: no other code of the test program runs
    // in it. glibc keeps the allocator usable after `fork`.
    let child = unsafe { fork() };
    if child == 0 {
        let ended = std::panic::catch_unwind(std::panic::AssertUnwindSafe(act)).is_ok();
        // SAFETY: it ends the process, which is allowed at any time.
        unsafe { _exit(i32::from(!ended)) }
    }
    let mut status = -1;
    // SAFETY: `status` is valid for the call.
    let ended = unsafe { waitpid(child, &raw mut status, 0) };
    ended == child && status == 0
}

#[test]
fn objects_dropped_by_a_forked_child_stay_with_its_parent() {
    let mut domain = TestDomain::new("fork");
    let node = Node::open(&domain, "parent").unwrap();
    let publisher = node.publisher(&StreamSpec::new("image", Kind::Image, Encoding::Mono8, 64)).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    let mut earlier = node.subscriber("image").unwrap();
    for subscriber in [&mut subscriber, &mut earlier] {
        assert!(!subscriber.wait(Duration::ZERO).unwrap());
    }
    let send = |value: u8| {
        let mut frame = publisher.loan(64).unwrap();
        frame.header_mut().set_packed(8, 8);
        frame.payload_mut().fill(value);
        frame.send().unwrap();
    };
    send(1);
    assert!(subscriber.wait(PATIENCE).unwrap() && earlier.wait(PATIENCE).unwrap());
    let held = subscriber.take().unwrap().unwrap();
    // Its subscriber is gone before the fork, so that only the frame keeps the port open.
    let alone = earlier.take().unwrap().unwrap();
    drop(earlier);
    let loaned = publisher.loan(64).unwrap();
    let files = || domain.files().into_iter().collect::<BTreeSet<_>>();
    let before = files();

    // `fork` copies memory: the child drops copies of all of these.
    let mut copies = Some((held, alone, loaned, subscriber));
    let parents = Some((node, publisher));
    assert!(in_a_child(|| {
        drop(copies.take());
    }));
    let (held, alone, loaned, mut subscriber) = copies.take().unwrap();
    let mut parents = parents;
    assert!(in_a_child(|| drop(parents.take())));
    let (node, publisher) = parents.take().unwrap();

    assert_eq!(files(), before);
    drop(loaned);
    for value in 2..9 {
        let mut frame = publisher.loan(64).unwrap();
        frame.header_mut().set_packed(8, 8);
        frame.payload_mut().fill(value);
        assert_eq!(frame.send().unwrap(), 2, "both ports are open");
        assert!(subscriber.wait(PATIENCE).unwrap());
        assert_eq!(subscriber.take().unwrap().unwrap().payload(), [value; 64]);
    }
    assert_eq!((held.payload(), alone.payload()), (&[1; 64][..], &[1; 64][..]));
    assert_eq!(node.streams().unwrap().len(), 1);
    drop((held, alone, subscriber, publisher, node));
    domain.assert_nothing_left();
}
