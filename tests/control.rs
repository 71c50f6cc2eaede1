//! A running simulation controlled by another process: what each command does, seen from outside.

mod live;

use belvedere_bridge::payload::{ModelState, Odometry, SimulationCommand, SimulationResult};
use belvedere_bridge::{Domain, Kind, Node, Operation, SimulationControl, StreamSpec, Subscriber, Text};
use live::{PATIENCE, Simulator, next_frame, output};
use rustix::process::Signal;
use std::time::{Duration, Instant};
use xxhash_rust::xxh3::xxh3_128;

const ROBOT: &str = "turtlebot";
const BOX: &str = "<sdf version='1.6'><model name='box'><link name='body'>
  <inertial><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.2</iyy><izz>0.1</izz></inertia></inertial>
  <collision name='c'><geometry><box><size>0.4 0.4 1</size></box></geometry></collision>
  <visual name='v'><geometry><box><size>0.4 0.4 1</size></box></geometry></visual>
</link></model></sdf>";

fn control(simulator: &Simulator) -> SimulationControl {
    let node = Node::open(&Domain::new(simulator.domain()).unwrap(), "control").unwrap();
    SimulationControl::open(&node).unwrap()
}

fn call(control: &mut SimulationControl, command: &SimulationCommand, text: &str) -> SimulationResult {
    control.call(command, text, PATIENCE).unwrap().expect("the simulator answers")
}

/// What was done, and when.
fn done(control: &mut SimulationControl, operation: Operation) -> u64 {
    done_with(control, &SimulationCommand::new(operation), "")
}

fn done_with(control: &mut SimulationControl, command: &SimulationCommand, text: &str) -> u64 {
    let result = call(control, command, text);
    assert_eq!((result.done, result.reason.as_str(), result.id), (1, "", command.id));
    result.time_ns
}

fn refusal(control: &mut SimulationControl, command: &SimulationCommand, text: &str) -> String {
    let result = call(control, command, text);
    assert_eq!((result.done, result.id), (0, command.id), "{command:?}");
    result.reason.as_str().to_owned()
}

fn step(control: &mut SimulationControl, steps: u64) -> u64 {
    done_with(control, &SimulationCommand { steps, ..SimulationCommand::new(Operation::Step) }, "")
}

fn named(operation: Operation, name: &str) -> SimulationCommand {
    SimulationCommand { name: Text::new(name).unwrap(), ..SimulationCommand::new(operation) }
}

/// The newest states of the models, while time stands.
fn states(subscriber: &mut Subscriber) -> Vec<ModelState> {
    while subscriber.take().unwrap().is_some() {}
    let frame = next_frame(subscriber);
    assert_eq!(frame.header().kind(), Some(Kind::ModelStates));
    assert_eq!(frame.header().frame_id.as_str(), "world");
    frame.view().structs().unwrap().collect()
}

fn state(subscriber: &mut Subscriber, name: &str) -> Option<ModelState> {
    states(subscriber).into_iter().find(|state| state.name.as_str() == name)
}

fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
    let off =
        found.iter().zip(expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
    assert!(off <= tolerance, "{found:?} instead of {expected:?}");
}

#[test]
fn while_paused_time_stands_and_commands_and_late_subscribers_are_served() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = control(&simulator);
    let node = simulator.node();
    let mut images = node.subscriber("image_raw").unwrap();
    next_frame(&mut images);
    let paused_ns = done(&mut control, Operation::Pause);
    while images.take().unwrap().is_some() {}
    // Late: each stream that keeps its last message gives it.
    let mut clock = node.subscriber("clock").unwrap();
    let last = next_frame(&mut clock);
    assert!(last.is_from_history() && last.header().stamp_ns <= paused_ns);
    next_frame(&mut node.subscriber("tf_static").unwrap());
    // Nothing moves on.
    assert!(!clock.wait(Duration::from_millis(300)).unwrap() && images.take().unwrap().is_none());
    let mut took: Vec<Duration> = (0..21)
        .map(|_| {
            let started = Instant::now();
            assert_eq!(done(&mut control, Operation::Pause), paused_ns);
            started.elapsed()
        })
        .collect();
    took.sort();
    assert!(took[10] < Duration::from_millis(20), "{took:?}");
    assert_eq!(done(&mut control, Operation::Resume), paused_ns);
    assert!(next_frame(&mut images).header().stamp_ns >= paused_ns);
    let resumed = next_frame(&mut clock).header().stamp_ns;
    assert!((paused_ns..paused_ns + 100_000_000).contains(&resumed), "no time was made up for: {resumed}");
}

#[test]
fn steps_are_counted_exactly() {
    let simulator = Simulator::start(&["--paused"]);
    let mut control = control(&simulator);
    let mut clock = simulator.subscribe("clock");
    let step_ns = step(&mut control, 1);
    assert_eq!(next_frame(&mut clock).header().stamp_ns, 0);
    assert_eq!(step(&mut control, 99), 100 * step_ns);
    assert_eq!(step(&mut control, 7), 107 * step_ns);
    let stamps: Vec<u64> =
        std::iter::from_fn(|| clock.take().unwrap()).map(|frame| frame.header().stamp_ns).collect();
    assert!(!stamps.is_empty() && stamps.iter().all(|stamp| *stamp <= 107 * step_ns), "{stamps:?}");
    // A step command that is ended by another is told so.
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

/// Stamp and hash of every frame of a second from time 0 on.
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
    let node = simulator.node();
    let mut subscribers: Vec<_> = STREAMS.iter().map(|topic| node.subscriber(topic).unwrap()).collect();
    let started = Instant::now();
    for subscriber in &mut subscribers {
        while subscriber.publishers() == 0 {
            subscriber.wait(Duration::from_millis(10)).unwrap();
            assert!(started.elapsed() < PATIENCE);
        }
    }
    (simulator, subscribers)
}

#[test]
fn after_a_reset_the_bytes_of_a_fresh_start_follow() {
    let (simulator, mut subscribers) = start_lossless("3");
    let fresh = first_second(&simulator, &mut subscribers);
    for (topic, frames) in STREAMS.iter().zip(&fresh) {
        assert!(frames.len() >= 6 && frames[0].0 == 0, "{topic}: {} frames", frames.len());
    }
    let mut control = control(&simulator);
    assert_eq!(done(&mut control, Operation::ResetSimulation), 0);
    assert_eq!(first_second(&simulator, &mut subscribers), fresh, "after a reset");
    // Whatever has happened in between.
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
fn models_are_moved_and_put_back() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = control(&simulator);
    let mut models = simulator.subscribe(StreamSpec::MODEL_STATES);
    let mut odometry = simulator.subscribe("odom");
    next_frame(&mut odometry);
    done(&mut control, Operation::Pause);
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    let moved = SimulationCommand {
        position: [0.5, -0.3, 0.0],
        orientation: [0.0, 0.0, quarter, quarter],
        ..named(Operation::SetModelState, ROBOT)
    };
    done_with(&mut control, &moved, "");
    let robot = state(&mut models, ROBOT).unwrap();
    assert_near(robot.position, [0.5, -0.3, 0.0], 1e-6);
    assert!((robot.orientation[2].abs() - quarter).abs() < 1e-6);
    // A little ahead of where it is now: along its own x, which is the world's y.
    let ahead = SimulationCommand {
        position: [0.2, 0.0, 0.0],
        reference: Text::new("turtlebot::base_footprint").unwrap(),
        ..named(Operation::SetModelState, ROBOT)
    };
    done_with(&mut control, &ahead, "");
    assert_near(state(&mut models, ROBOT).unwrap().position, [0.5, -0.1, 0.0], 1e-4);
    // The base does not notice that it was carried.
    while odometry.take().unwrap().is_some() {}
    done(&mut control, Operation::Resume);
    for _ in 0..20 {
        let position = next_frame(&mut odometry).message::<Odometry>().unwrap().position;
        assert_near(position, [0.0; 3], 0.01);
    }
    let reset_ns = done(&mut control, Operation::ResetWorld);
    done(&mut control, Operation::Pause);
    assert!(reset_ns > 0);
    assert_near(state(&mut models, ROBOT).unwrap().position, [0.0; 3], 1e-3);
    // A velocity goes with the pose: thrown upwards at 2 m/s, it is 0.15 m up after 0.1 s.
    let thrown = SimulationCommand {
        position: [0.0, 0.0, 0.5],
        linear: [0.0, 0.0, 2.0],
        ..named(Operation::SetModelState, ROBOT)
    };
    done_with(&mut control, &thrown, "");
    let before = state(&mut models, ROBOT).unwrap();
    assert_near(before.linear, [0.0, 0.0, 2.0], 1e-5);
    step(&mut control, 20);
    let robot = state(&mut models, ROBOT).unwrap();
    assert_near(robot.position, [0.0, 0.0, 0.5 + 0.2 - 0.5 * 9.8 * 0.01], 0.02);
    // The world's own models, static ones too.
    let ceiling =
        SimulationCommand { position: [0.0, 0.0, 3.0], ..named(Operation::SetModelState, "tag_ceiling") };
    let mut images = simulator.subscribe("image_raw");
    let picture = |control: &mut SimulationControl, images: &mut Subscriber| {
        while images.take().unwrap().is_some() {}
        step(control, 10);
        next_frame(images).payload().to_vec()
    };
    let below = picture(&mut control, &mut images);
    done_with(&mut control, &ceiling, "");
    let above = picture(&mut control, &mut images);
    let different = below.iter().zip(&above).filter(|(below, above)| below.abs_diff(**above) > 30).count();
    assert!(different > below.len() / 20, "the ceiling is seen farther away: {different} bytes differ");
    done(&mut control, Operation::ResetWorld);
    assert_near(state(&mut models, "tag_ceiling").unwrap().position, [0.0, 0.0, 2.5], 0.0);
}

/// The shortest range within 3° of ahead in the next scan; the robot stands at the origin.
fn ahead_m(control: &mut SimulationControl, scans: &mut Subscriber) -> f32 {
    while scans.take().unwrap().is_some() {}
    step(control, 40);
    let frame = next_frame(scans);
    let geometry = frame.header().scan_geometry().unwrap();
    let view = frame.view();
    let angle = |ray: usize| geometry.angle_min + ray as f64 * geometry.angle_increment;
    view.numbers::<f32>(view.rows())
        .enumerate()
        .filter(|(ray, _)| angle(*ray).abs() < 0.05)
        .map(|(_, range)| range)
        .fold(f32::INFINITY, f32::min)
}

#[test]
fn a_box_in_front_of_the_lidar_is_seen_until_it_is_deleted() {
    let simulator = Simulator::start(&["--drive", "still", "--paused"]);
    let mut control = control(&simulator);
    let mut models = simulator.subscribe(StreamSpec::MODEL_STATES);
    let mut links = simulator.subscribe(StreamSpec::LINK_STATES);
    let mut scans = simulator.subscribe("scan");
    // Now it is there.
    done(&mut control, Operation::Pause);
    let free_m = ahead_m(&mut control, &mut scans);
    for round in 0..3 {
        // It falls from 0.3 m to the ground.
        let spawned = SimulationCommand { position: [1.5, 0.0, 0.8], ..named(Operation::Spawn, "crate") };
        done_with(&mut control, &spawned, BOX);
        assert_near(state(&mut models, "crate").unwrap().position, [1.5, 0.0, 0.8], 1e-6);
        step(&mut control, 200);
        let fallen = state(&mut models, "crate").unwrap();
        assert_near(fallen.position, [1.5, 0.0, 0.5], 0.01);
        assert!(states(&mut links).iter().any(|link| link.name.as_str() == "crate::body"));
        let near_m = ahead_m(&mut control, &mut scans);
        assert!((1.0..1.4).contains(&near_m), "round {round}: {near_m} m, {free_m} m without the box");
        // A reset of the world puts it back into the air, one of the simulation too.
        done(&mut control, Operation::ResetWorld);
        assert_near(state(&mut models, "crate").unwrap().position, [1.5, 0.0, 0.8], 1e-6);
        assert_eq!(done(&mut control, Operation::ResetSimulation), 0);
        assert_near(state(&mut models, "crate").unwrap().position, [1.5, 0.0, 0.8], 1e-6);
        assert!(ahead_m(&mut control, &mut scans) < free_m - 0.5 || near_m < free_m - 0.5);
        done_with(&mut control, &named(Operation::Delete, "crate"), "");
        assert!(state(&mut models, "crate").is_none());
        let again_m = ahead_m(&mut control, &mut scans);
        assert!((again_m - free_m).abs() < 0.1, "round {round}: {again_m} m instead of {free_m} m");
    }
    // A static URDF, in the robot's frame.
    let urdf = "<robot name='post'><link name='post'><visual><geometry><cylinder radius='0.1' length='2'/></geometry></visual>
        <collision><geometry><cylinder radius='0.1' length='2'/></geometry></collision></link>
        <gazebo><static>true</static></gazebo></robot>";
    let spawned = SimulationCommand {
        position: [1.0, 0.0, 1.0],
        reference: Text::new(ROBOT).unwrap(),
        ..SimulationCommand::new(Operation::Spawn)
    };
    done_with(&mut control, &spawned, urdf);
    let near_m = ahead_m(&mut control, &mut scans);
    assert!((0.6..1.0).contains(&near_m), "{near_m}");
}

#[test]
fn what_cannot_be_done_is_refused_in_words() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = control(&simulator);
    let say = |control: &mut SimulationControl, command: &SimulationCommand, text: &str, words: &[&str]| {
        let reason = refusal(control, command, text);
        assert!(words.iter().all(|word| reason.contains(word)), "no {words:?} in: {reason}");
    };
    let unknown = SimulationCommand { operation: 999, ..SimulationCommand::new(Operation::Pause) };
    say(&mut control, &unknown, "", &["operation 999", "1 pause"]);
    say(&mut control, &SimulationCommand::new(Operation::Step), "", &["0 steps"]);
    let endless = SimulationCommand { steps: u64::MAX, ..SimulationCommand::new(Operation::Step) };
    say(&mut control, &endless, "", &["steps cannot be run"]);
    let turtle = named(Operation::SetModelState, "turtlebt");
    say(&mut control, &turtle, "", &["no model 'turtlebt'", "did you mean 'turtlebot'"]);
    let robot = named(Operation::SetModelState, ROBOT);
    let nan = SimulationCommand { position: [f64::NAN, 0.0, 0.0], ..robot };
    say(&mut control, &nan, "", &["position"]);
    let nowhere = SimulationCommand { reference: Text::new("nowhere").unwrap(), ..robot };
    say(&mut control, &nowhere, "", &["no reference frame 'nowhere'"]);
    say(&mut control, &named(Operation::Delete, ROBOT), "", &["is the robot"]);
    say(&mut control, &named(Operation::Delete, "ghost"), "", &["no model 'ghost'"]);
    let spawn = named(Operation::Spawn, "thing");
    say(&mut control, &spawn, "", &["broken XML"]);
    say(&mut control, &spawn, "<sdf version='1.6'>\n<model>", &["thing:", "broken XML"]);
    say(&mut control, &spawn, "<gltf/>", &["<gltf>"]);
    say(&mut control, &named(Operation::Spawn, ROBOT), BOX, &["a model 'turtlebot' already"]);
    say(&mut control, &named(Operation::Spawn, "world"), BOX, &["a model 'world' already"]);
    let sensing = BOX.replace(
        "</link>",
        "<sensor name='eye' type='camera'><camera><horizontal_fov>1</horizontal_fov></camera></sensor></link>",
    );
    say(&mut control, &spawn, &sensing, &["thing:5", "sensor 'eye'", "remove"]);
    let missing =
        BOX.replace("<box><size>0.4 0.4 1</size></box>", "<mesh><uri>model://no/such.dae</uri></mesh>");
    say(&mut control, &spawn, &missing, &["no/such.dae"]);
    let flat = BOX.replace("0.4 0.4 1", "0 1 1");
    say(&mut control, &spawn, &flat, &["size"]);
    let deep = format!("<sdf version='1.6'>{}", "<a>".repeat(200_000));
    refusal(&mut control, &spawn, &deep);
    refusal(&mut control, &spawn, &format!("{deep}{}</sdf>", "</a>".repeat(200_000)));
    // It is as it was.
    let mut models = simulator.subscribe(StreamSpec::MODEL_STATES);
    assert_eq!(states(&mut models).len(), 3);
}

/// A sender that does not keep to the rules: what can be answered is, the rest is dropped.
#[test]
fn broken_commands_harm_nobody() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = control(&simulator);
    done(&mut control, Operation::Pause);
    let node = simulator.node();
    let mut results = node.subscriber(StreamSpec::SIMULATION_RESULT).unwrap();
    results.take().unwrap();
    let sender = node.publisher(&StreamSpec::simulation_command(1024)).unwrap();
    let mut send = |command: SimulationCommand, tail: &[u8]| {
        let mut frame = sender.loan(256 + tail.len()).unwrap();
        frame.payload_mut()[..256].copy_from_slice(bytemuck::bytes_of(&command));
        frame.payload_mut()[256..].copy_from_slice(tail);
        let header = frame.header_mut();
        (header.width, header.height, header.elem_stride, header.row_stride) = (1, 1, 256, 256);
        frame.send().unwrap();
        let result: SimulationResult = next_frame(&mut results).message().unwrap();
        assert_eq!((result.id, result.done), (command.id, 0));
        result.reason.as_str().to_owned()
    };
    let spawn = |text_len| SimulationCommand { text_len, ..named(Operation::Spawn, "thing") };
    assert!(send(spawn(1000), b"<sdf/>").contains("cut off: 1000 bytes announced, 6 came"));
    assert!(send(spawn(u32::MAX), b"<sdf/>").contains("at most"));
    assert!(send(spawn(4), b"ab\xff\xff").contains("not UTF-8 from byte 2 on"));
    // No command at all.
    let mut frame = sender.loan(100).unwrap();
    let header = frame.header_mut();
    (header.width, header.height, header.elem_stride, header.row_stride) = (0, 0, 0, 0);
    frame.send().unwrap();
    done(&mut control, Operation::Resume);
}

#[test]
fn the_command_line_says_what_was_done_and_why_not() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("box.sdf");
    std::fs::write(&file, BOX).unwrap();
    let file = file.to_str().unwrap();
    let control = |arguments: &[&str]| {
        let output = output(&[&["control", "--domain", simulator.domain()], arguments].concat());
        let said = [output.stdout, output.stderr].concat();
        (output.status.code().unwrap(), String::from_utf8(said).unwrap())
    };
    for (arguments, code, words) in [
        (&["pause"][..], 0, "pause: done at "),
        (&["step", "10"], 0, "step: done at "),
        (&["move", ROBOT, "0.5", "-0.25", "0", "-90"], 0, "move: done"),
        (&["spawn", file, "--name", "crate", "--pose", "-1,-1,0.5,45"], 0, "spawn: done"),
        (&["states"], 0, "crate "),
        (&["states", "--json"], 0, "{\"angular\":"),
        (&["states", "--links"], 0, "crate::body"),
        (&["spawn", file, "--name", "crate"], 1, "spawn was refused: there is a model 'crate' already"),
        (&["delete", "crate"], 0, "delete: done"),
        (&["delete", ROBOT], 1, "is the robot"),
        (&["move", "nobody", "0", "0", "0"], 1, "no model 'nobody'"),
        (&["spawn", "no_such.sdf"], 1, "cannot read no_such.sdf"),
        (&["spawn", file, "--pose", "1,2"], 2, "three or four numbers"),
        (&["step", "0"], 2, "0 is not in"),
        (&["reset-world"], 0, "reset-world: done"),
        (&["reset"], 0, "reset: done at 0.000000000 s"),
        (&["resume"], 0, "resume: done"),
    ] {
        let (found, said) = control(arguments);
        assert!(found == code && said.contains(words), "{arguments:?}: {found}: {said}");
    }
    let nobody = output(&["control", "pause", "--domain", &live::own_domain(), "--timeout", "0.2"]);
    let said = String::from_utf8(nobody.stderr).unwrap();
    assert!(nobody.status.code() == Some(1) && said.contains("belvedere run --domain"), "{said}");
}

#[test]
fn what_is_sent_after_an_answer_shows_what_was_changed() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = control(&simulator);
    let mut states = simulator.subscribe(StreamSpec::MODEL_STATES);
    next_frame(&mut states);
    assert!(control.is_connected().unwrap());
    assert_eq!(control.answered_ns(), 0);
    for round in 0..40 {
        // In a pause and out of it.
        done(&mut control, if round % 2 == 0 { Operation::Pause } else { Operation::Resume });
        let x = f64::from(round) * 0.1 - 2.0;
        let moved =
            SimulationCommand { position: [x, 0.0, 2.5], ..named(Operation::SetModelState, "tag_ceiling") };
        done_with(&mut control, &moved, "");
        let frame = loop {
            let frame = next_frame(&mut states);
            if frame.header().publish_mono_ns > control.answered_ns() {
                break frame;
            }
        };
        let mut models = frame.view().structs::<ModelState>().unwrap();
        let ceiling = models.find(|model| model.name.as_str() == "tag_ceiling").unwrap();
        assert_near(ceiling.position, [x, 0.0, 2.5], 1e-6);
    }
}

#[test]
fn the_end_of_a_simulator_is_noticed_while_its_answer_is_waited_for() {
    let domain = live::own_domain();
    let node = Node::open(&Domain::new(&domain).unwrap(), "control").unwrap();
    let mut control = SimulationControl::open(&node).unwrap();
    assert!(!control.is_connected().unwrap());
    let simulator = Simulator::start_in(domain.clone(), &["--drive", "still"]);
    done(&mut control, Operation::Pause);
    simulator.signal(Signal::STOP);
    let ended = std::thread::scope(|scope| {
        let waiting = scope.spawn(|| {
            let asked = Instant::now();
            let pause = SimulationCommand::new(Operation::Pause);
            assert!(control.call(&pause, "", 10 * PATIENCE).unwrap().is_none());
            asked.elapsed()
        });
        std::thread::sleep(Duration::from_millis(200));
        simulator.kill();
        waiting.join().unwrap()
    });
    assert!(ended < PATIENCE, "{ended:?}");
    assert!(!control.is_connected().unwrap());
    let _successor = Simulator::start_in(domain, &["--drive", "still"]);
    done(&mut control, Operation::Pause);
    assert!(control.is_connected().unwrap());
}

#[test]
fn a_robot_can_be_given_a_name() {
    let simulator = Simulator::start(&["--drive", "still", "--name", "mobile_base"]);
    let mut control = control(&simulator);
    done_with(&mut control, &named(Operation::SetModelState, "mobile_base"), "");
    let mut links = simulator.subscribe(StreamSpec::LINK_STATES);
    assert!(state(&mut links, "mobile_base::base_link").is_some());
    for (name, words) in [
        ("world", "is the world itself"),
        ("", "is the world itself"),
        ("a::b", "'::' stands between"),
        (&"n".repeat(64), "more than 63 bytes"),
        ("tag_room", "a model of the world is called 'tag_room'"),
    ] {
        let refused = output(&["run", "--name", name, "--domain", &live::own_domain()]);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(!refused.status.success() && said.contains(words), "{name}: {said}");
    }
}
