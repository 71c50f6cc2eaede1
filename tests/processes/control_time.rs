//! The time of a simulation controlled by another process: pause, resume, step and reset.

use crate::live::control::{BOX, ROBOT, call, done, done_with, named, step};
use crate::live::{Simulator, belvedere, follow, next_frame, own_domain};
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Domain, Node, Operation, SimulationControl, Subscriber};
use std::process::Stdio;
use std::time::{Duration, Instant};
use xxhash_rust::xxh3::xxh3_128;

#[test]
fn a_paused_simulation_serves_commands_and_late_subscribers() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = simulator.control();
    let node = simulator.node();
    let mut images = node.subscriber("image_raw").unwrap();
    next_frame(&mut images);
    let paused_ns = done(&mut control, Operation::Pause);
    while images.take().unwrap().is_some() {}
    // A late subscriber: each latched stream sends its last message.
    let mut clock = node.subscriber("clock").unwrap();
    let last = next_frame(&mut clock);
    assert!(last.is_from_history() && last.header().stamp_ns <= paused_ns);
    next_frame(&mut node.subscriber("tf_static").unwrap());
    // Nothing advances.
    assert!(!clock.wait(Duration::from_millis(300)).unwrap() && images.take().unwrap().is_none());
    for _ in 0..21 {
        assert_eq!(done(&mut control, Operation::Pause), paused_ns);
    }
    let asked = Instant::now();
    assert_eq!(done(&mut control, Operation::Resume), paused_ns);
    assert!(next_frame(&mut images).header().stamp_ns >= paused_ns);
    let resumed_ns = next_frame(&mut clock).header().stamp_ns;
    // The pause of 300 ms and more is not caught up.
    let went_on = Duration::from_nanos(resumed_ns - paused_ns);
    assert!(went_on <= asked.elapsed() + Duration::from_millis(100), "{went_on:?} in {:?}", asked.elapsed());
}

/// A paused simulation waits for commands and not for its next step, so commands take about as long as in a running
/// one.
#[test]
fn commands_are_as_fast_while_paused_as_while_running() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = simulator.control();
    let mut median_of = |operation| {
        done(&mut control, operation);
        let mut took: Vec<Duration> = (0..21)
            .map(|_| {
                let started = Instant::now();
                done(&mut control, operation);
                started.elapsed()
            })
            .collect();
        took.sort();
        took[10]
    };
    // Other load on the machine may delay either.
    let is_as_soon = |_| {
        let (running, paused) = (median_of(Operation::Resume), median_of(Operation::Pause));
        println!("a command takes {running:?} while running, {paused:?} while paused");
        paused < 4 * running + Duration::from_millis(5)
    };
    assert!((0..5).any(is_as_soon), "a paused simulation delays commands");
}

#[test]
fn steps_are_counted_exactly() {
    let simulator = Simulator::start(&["--paused"]);
    let mut control = simulator.control();
    let mut clock = simulator.subscribe("clock");
    let step_ns = step(&mut control, 1);
    assert_eq!(next_frame(&mut clock).header().stamp_ns, 0);
    assert_eq!(step(&mut control, 99), 100 * step_ns);
    assert_eq!(step(&mut control, 7), 107 * step_ns);
    let stamps: Vec<u64> =
        std::iter::from_fn(|| clock.take().unwrap()).map(|frame| frame.header().stamp_ns).collect();
    assert!(!stamps.is_empty() && stamps.iter().all(|stamp| *stamp <= 107 * step_ns), "{stamps:?}");
    // A step command that is interrupted by another reports that.
    let long = SimulationCommand { steps: 1_000_000, ..SimulationCommand::new(Operation::Step) };
    let domain = simulator.domain().to_owned();
    let waiting = std::thread::spawn(move || {
        let node = Node::open(&Domain::new(&domain).unwrap(), "stepper").unwrap();
        call(&mut SimulationControl::open(&node).unwrap(), &long, "")
    });
    while next_frame(&mut clock).header().stamp_ns < 200 * step_ns {}
    done(&mut control, Operation::Pause);
    let ended = waiting.join().unwrap();
    assert!(ended.done == 0 && ended.reason.as_str().contains("ended by a pause"), "{}", ended.reason);
}

const STREAMS: [&str; 8] = [
    "clock",
    "odom",
    "tf",
    "joint_states",
    "mobile_base/sensors/imu_data",
    "mobile_base/sensors/core",
    "scan",
    "image_raw",
];

/// Timestamp and hash of every frame of a second from time 0 on.
fn first_second(simulator: &Simulator, subscribers: &mut [Subscriber]) -> Vec<Vec<(u64, u128)>> {
    let domain = simulator.domain().to_owned();
    let stepping = std::thread::spawn(move || {
        let node = Node::open(&Domain::new(&domain).unwrap(), "stepper").unwrap();
        let step_ns = step(&mut SimulationControl::open(&node).unwrap(), 1);
        step(&mut SimulationControl::open(&node).unwrap(), 1_000_000_000 / step_ns - 1);
    });
    let mut frames = vec![Vec::new(); subscribers.len()];
    loop {
        let finished = stepping.is_finished();
        for (subscriber, frames) in subscribers.iter_mut().zip(&mut frames) {
            while let Some(frame) = subscriber.take().unwrap() {
                assert_eq!(frame.missed(), 0);
                frames.push((frame.header().stamp_ns, xxh3_128(frame.payload())));
            }
        }
        if finished {
            stepping.join().unwrap();
            return frames;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn start_lossless(seed: &str) -> (Simulator, Vec<Subscriber>) {
    let simulator = Simulator::start(&["--paused", "--rate", "max", "--seed", seed, "--wait-for", "test=8"]);
    let subscribers = follow(simulator.domain(), "test", &STREAMS);
    (simulator, subscribers)
}

#[test]
fn frames_after_a_reset_equal_those_of_a_fresh_start() {
    let (simulator, mut subscribers) = start_lossless("3");
    let fresh = first_second(&simulator, &mut subscribers);
    for (topic, frames) in STREAMS.iter().zip(&fresh) {
        assert!(frames.len() >= 6 && frames[0].0 == 0, "{topic}: {} frames", frames.len());
    }
    let mut control = simulator.control();
    assert_eq!(done(&mut control, Operation::ResetSimulation), 0);
    assert_eq!(first_second(&simulator, &mut subscribers), fresh, "after a reset");
    // The earlier commands have no effect.
    let moved = SimulationCommand { position: [1.0, 1.0, 0.5], ..named(Operation::SetModelState, ROBOT) };
    done_with(&mut control, &moved, "");
    done_with(&mut control, &named(Operation::Spawn, "crate"), BOX);
    done_with(&mut control, &named(Operation::Delete, "crate"), "");
    done(&mut control, Operation::ResetWorld);
    assert_eq!(done(&mut control, Operation::ResetSimulation), 0);
    assert_eq!(first_second(&simulator, &mut subscribers), fresh, "after commands and a reset");
    drop((subscribers, simulator));
    let (another, mut subscribers) = start_lossless("3");
    assert_eq!(first_second(&another, &mut subscribers), fresh, "of another simulator");
}

#[test]
fn a_reset_does_not_lengthen_a_run() {
    let domain = own_domain();
    let run = belvedere()
        .args(["run", "--domain", &domain, "--paused", "--rate", "max", "--duration", "1", "--hash"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    follow(&domain, "waiting", &["clock"]);
    let node = Node::open(&Domain::new(&domain).unwrap(), "control").unwrap();
    let mut control = SimulationControl::open(&node).unwrap();
    let step_ns = step(&mut control, 1);
    let far_ns = step(&mut control, 600_000_000 / step_ns);
    assert!(far_ns > 600_000_000);
    done(&mut control, Operation::ResetSimulation);
    done(&mut control, Operation::Resume);
    let printed = String::from_utf8(run.wait_with_output().unwrap().stdout).unwrap();
    let clock =
        printed.lines().find(|line| line.contains("  /clock  ")).unwrap_or_else(|| panic!("{printed}"));
    // 100 Hz: 61 frames before the reset and 40 after it.
    let frames: u32 = clock.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!((99..=103).contains(&frames), "{clock}");
}
