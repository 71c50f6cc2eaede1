//! A robot with a Kinect and a lidar, six streams at 30 Hz in their real sizes, and four consumer processes: the use of
//! memory, files and descriptors is constant, and no frame is lost without a reason.
//!
//! Takes 8 seconds, or `BELVEDERE_SOAK_SECONDS`; `BELVEDERE_FULL=1` takes ten minutes.

use std::{
    fs,
    time::{Duration, Instant},
};

use belvedere_bridge::{
    Domain, Encoding, FrameHeader, Kind, Node, Publisher, StreamSpec, Subscriber, payload::CameraInfo,
};
use bytemuck::Zeroable as _;

use crate::processes_kit::{self, PATIENCE, Process, Role, TestDomain, Usage, full, report, skip};

const CONSUMERS: usize = 4;
const RATE_HZ: u64 = 30;
const PERIOD: Duration = Duration::from_nanos(1_000_000_000 / RATE_HZ);
/// Allowed growth of a process's own memory from the first quarter to the end, for the allocator's own use.
const MEMORY_SLACK_KIB: u64 = 256;

struct Stream {
    topic: &'static str,
    kind: Kind,
    encoding: Encoding,
    width: u32,
    height: u32,
}

const STREAMS: [Stream; 6] = [
    Stream::new("camera/rgb/image_raw", Kind::Image, Encoding::Rgb8, 640, 480),
    Stream::new("camera/depth/image_raw", Kind::DepthImage, Encoding::F32C1, 640, 480),
    Stream::new("camera/rgb/camera_info", Kind::CameraInfo, Encoding::Struct, 1, 1),
    Stream::new("camera/depth/camera_info", Kind::CameraInfo, Encoding::Struct, 1, 1),
    Stream::new("camera/depth/points", Kind::PointCloud, Encoding::XyzRgbF32, 640, 480),
    Stream::new("scan", Kind::LaserScan, Encoding::RangesF32, 360, 1),
];

impl Stream {
    const fn new(topic: &'static str, kind: Kind, encoding: Encoding, width: u32, height: u32) -> Self {
        Self { topic, kind, encoding, width, height }
    }

    fn len(&self) -> usize {
        FrameHeader::new(self.kind, self.encoding).set_packed(self.width, self.height)
    }

    fn spec(&self) -> StreamSpec {
        match self.encoding {
            Encoding::Struct => StreamSpec::structs(self.topic, self.kind, 1),
            _ => StreamSpec::new(self.topic, self.kind, self.encoding, self.len()),
        }
        .rate_hz(RATE_HZ as f64)
    }

    fn send(&self, publisher: &Publisher, count: u64) {
        let stamp_ns = count * 1_000_000_000 / RATE_HZ;
        if self.encoding == Encoding::Struct {
            let info = CameraInfo { width: count as u32, ..CameraInfo::zeroed() };
            publisher.send_structs(stamp_ns, &[info]).unwrap();
            return;
        }
        let mut frame = publisher.loan(self.len()).unwrap();
        frame.header_mut().set_packed(self.width, self.height);
        frame.header_mut().stamp_ns = stamp_ns;
        frame.payload_mut().fill(count as u8);
        frame.send().unwrap();
    }
}

fn roles(role: &Role) {
    match role.name.as_str() {
        "publish" => publish(&role.domain),
        "consume" => consume(role),
        name => panic!("no role {name}"),
    }
}

/// Publishes all streams. The frames of a stream are at least a period apart: after a late frame the next ones are not
/// sent faster, which would overflow any buffer.
fn publish(domain: &Domain) {
    let node = Node::open(domain, "robot").unwrap();
    let publishers = STREAMS.map(|stream| node.publisher(&stream.spec()).unwrap());
    for count in 0.. {
        for (stream, publisher) in STREAMS.iter().zip(&publishers) {
            stream.send(publisher, count);
        }
        if count == 0 {
            report("ready");
        }
        std::thread::sleep(PERIOD);
    }
}

/// The counts of one consumer of one stream.
#[derive(Default)]
struct Tally {
    frames: u64,
    missed: u64,
    /// Frames that were lost without being counted, or that the consumer could have taken.
    unexplained: u64,
    worst_age_us: u64,
}

/// Consumes with one thread for each stream, as most programs do. Argument: seconds.
fn consume(role: &Role) {
    let node = Node::open(&role.domain, "consumer").unwrap();
    let duration = Duration::from_secs(role.number(0));
    std::thread::scope(|scope| {
        for (index, stream) in STREAMS.iter().enumerate() {
            let subscriber = node.subscriber(stream.topic).unwrap();
            scope.spawn(move || {
                let Tally { frames, missed, unexplained, worst_age_us } =
                    follow(subscriber, stream, duration);
                report(format_args!("stream {index} {frames} {missed} {unexplained} {worst_age_us}"));
            });
        }
    });
    // Stays, to be inspected, until it is killed.
    std::thread::sleep(PATIENCE);
}

fn follow(mut subscriber: Subscriber, stream: &Stream, duration: Duration) -> Tally {
    let mut tally = Tally::default();
    let mut last: Option<u64> = None;
    let begin = Instant::now();
    while begin.elapsed() < duration {
        if !subscriber.wait(Duration::from_secs(1)).unwrap() {
            continue;
        }
        while let Some(frame) = subscriber.take().unwrap() {
            let seq = frame.header().seq;
            if let Some(last_seq) = last.replace(seq) {
                let gap = seq - last_seq - 1;
                // A buffer of two overflows if another frame arrives, one period after the oldest.
                let was_waiting = u128::from(frame.age_ns()) >= PERIOD.as_nanos();
                if gap != frame.missed() || (gap > 0 && !was_waiting) {
                    tally.unexplained += gap.max(1);
                }
            }
            if stream.encoding == Encoding::Struct {
                assert_eq!(frame.message::<CameraInfo>().unwrap().width, seq as u32);
            } else {
                assert!(frame.payload().chunks(4096).all(|page| page[0] == seq as u8), "a torn frame");
            }
            tally.frames += 1;
            tally.missed += frame.missed();
            if !frame.is_from_history() {
                tally.worst_age_us = tally.worst_age_us.max(frame.age_ns() / 1000);
            }
        }
    }
    tally
}

/// The resources of a process.
#[derive(Clone, Copy, Debug)]
struct Footprint {
    own_kib: u64,
    shared_kib: u64,
    descriptors: usize,
}

impl Footprint {
    fn of(process: &Process) -> Self {
        let status = fs::read_to_string(format!("/proc/{}/status", process.pid())).unwrap();
        let field = |name: &str| -> u64 {
            let line = status.lines().find(|line| line.starts_with(name)).unwrap();
            line.split_whitespace().nth(1).unwrap().parse().unwrap()
        };
        Self {
            own_kib: field("RssAnon:"),
            shared_kib: field("RssShmem:"),
            descriptors: fs::read_dir(format!("/proc/{}/fd", process.pid())).unwrap().count(),
        }
    }
}

#[test]
fn memory_is_constant_and_no_frame_is_lost_without_a_reason() {
    processes_kit::play(roles);
    let from_environment = std::env::var("BELVEDERE_SOAK_SECONDS").ok().and_then(|text| text.parse().ok());
    let seconds: u64 = from_environment.unwrap_or(if full() { 600 } else { 8 });
    let pools: u64 = STREAMS.iter().map(|stream| stream.spec().pool_bytes()).sum();
    let free = rustix::fs::statvfs("/dev/shm").map_or(0, |stat| stat.f_bavail * stat.f_frsize);
    if free < pools + (64 << 20) {
        let (pools_mib, free_mib) = (pools >> 20, free >> 20);
        return skip(format_args!("the pools take {pools_mib} MiB of /dev/shm, {free_mib} are free"));
    }

    let mut domain = TestDomain::new("soak");
    let publisher = Process::start(&domain, "publish", &[]);
    publisher.expect("ready");
    let consumers: Vec<_> =
        (0..CONSUMERS).map(|_| Process::start(&domain, "consume", &[&(seconds + 1)])).collect();
    let processes: Vec<_> = std::iter::once(&publisher).chain(&consumers).collect();
    let footprints = || processes.iter().map(|process| Footprint::of(process)).collect::<Vec<_>>();
    std::thread::sleep(Duration::from_secs(seconds) / 4);
    let (usage_before, before): (Usage, _) = (domain.usage(), footprints());
    std::thread::sleep(Duration::from_secs(seconds) * 3 / 4);
    let (usage_after, after) = (domain.usage(), footprints());

    let limit = PATIENCE + Duration::from_secs(10);
    let tallies: Vec<Vec<_>> = consumers
        .iter()
        .map(|consumer| {
            let mut lines: Vec<_> = STREAMS.iter().map(|_| consumer.expect_within("stream", limit)).collect();
            lines.sort();
            lines
        })
        .collect();

    println!("{seconds} s at {RATE_HZ} Hz, {} streams, {CONSUMERS} consumers", STREAMS.len());
    println!("process      own memory KiB      shared KiB          descriptors   (first quarter, end)");
    for (index, (before, after)) in before.iter().zip(&after).enumerate() {
        println!(
            "{:<12} {:>8} {:>8}   {:>8} {:>8}   {:>5} {:>5}",
            if index == 0 { "robot".to_owned() } else { format!("consumer {index}") },
            before.own_kib,
            after.own_kib,
            before.shared_kib,
            after.shared_kib,
            before.descriptors,
            after.descriptors,
        );
    }
    println!("/dev/shm: {usage_before:?}, then {usage_after:?}");
    println!("stream                      frames each consumer took, missed, unexplained; worst age");
    for (index, stream) in STREAMS.iter().enumerate() {
        let of = |column: usize| tallies.iter().map(move |lines| lines[index][column]);
        println!(
            "{:<26} {:>6?} {:>4} {:>4}   {:.1} ms",
            stream.topic,
            of(1).collect::<Vec<_>>(),
            of(2).sum::<u64>(),
            of(3).sum::<u64>(),
            of(4).max().unwrap_or(0) as f64 / 1e3,
        );
    }

    assert_eq!(usage_before, usage_after, "files and shared memory");
    for (before, after) in before.iter().zip(&after) {
        assert!(after.own_kib <= before.own_kib + MEMORY_SLACK_KIB, "{before:?}, then {after:?}");
        assert!(after.shared_kib <= pools.div_ceil(1024) + 4096, "{before:?}, then {after:?}");
        assert_eq!(before.descriptors, after.descriptors);
    }
    for line in tallies.iter().flatten() {
        let [_, frames, missed, unexplained, _] = line[..] else { panic!("five numbers: {line:?}") };
        assert_eq!(unexplained, 0, "an unexplained gap: {line:?}");
        // The frames of a robot that is late most of the time, but not none.
        assert!((frames + missed) * 10 >= seconds * RATE_HZ, "{line:?}");
    }
    drop((publisher, consumers));
    domain.assert_nothing_left_after_the_next_start();
}
