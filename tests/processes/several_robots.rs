//! Several robots in one world, and robots that are spawned and deleted while it runs, as seen by another process.

use crate::live::control::{done_with, named, refusal};
use crate::live::{PATIENCE, Simulator, belvedere, files_of, follow, next_frame, own_domain};
use belvedere_bridge::payload::{Odometry, SimulationCommand, Transform, VelocityCommand};
use belvedere_bridge::{Operation, StreamSpec, Text};
use std::process::{Child, Output};
use std::time::{Duration, Instant};

const ROBOT: &str = "kobuki_nostack_rplidar";

/// A run of a simulated second with hashes of all bytes.
fn hashed(robots: &[[&str; 3]], more: &[&str]) -> Output {
    let domain = own_domain();
    let mut arguments = vec!["run", "--domain", &domain, "--rate", "max", "--duration", "1", "--hash"];
    arguments.extend(["--world", "playground", "--drive", "spin"]);
    for option in 0..3 {
        arguments
            .extend(robots.iter().flat_map(|robot| [["--robot", "--name", "--pose"][option], robot[option]]));
    }
    arguments.extend(more);
    belvedere().args(arguments).output().unwrap()
}

#[test]
fn poses_may_be_coordinates_of_utm() {
    let output = hashed(&[[ROBOT, "anna", "448262.27,5428765.81"]], &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = hashed(&[[ROBOT, "anna", "0,1e8"]], &[]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && told.contains("'0,1e8' is too far away"), "{told}");
}

/// The order in which robots are given does not affect any byte; each robot has its own topics.
#[test]
fn bytes_do_not_depend_on_the_order_of_robots() {
    let one = [ROBOT, "anna", "1,0,90"];
    let other = ["kobuki_hexagons_kinect", "bert", "-1,0.5"];
    let [first, turned] = [[one, other], [other, one]].map(|robots| {
        let output = hashed(&robots, &[]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    });
    assert_eq!(first, turned);
    for topic in ["/anna/scan", "/bert/camera/depth/image_raw", "/anna/odom", "/bert/tf", "/clock"] {
        assert!(
            first.lines().any(|line| line.split_whitespace().nth(1) == Some(topic)),
            "{topic} in\n{first}"
        );
    }
}

/// Each moves by its own commands, and reports in its own frames.
#[test]
fn each_robot_has_its_own_commands_and_frames() {
    let robots = ["--robot", ROBOT, "--robot", ROBOT, "--name", "anna", "--name", "bert"];
    let simulator =
        Simulator::start(&[&robots[..], &["--world", "empty", "--pose", "0,0", "--pose", "0,2"]].concat());
    let topics = ["anna/odom", "bert/odom", "anna/tf_static", "bert/tf"];
    let mut streams = follow(simulator.domain(), "test", &topics);
    let sender = simulator.node().publisher(&StreamSpec::velocity_command("anna/cmd_vel")).unwrap();
    let started = Instant::now();
    let driven = loop {
        let forward = VelocityCommand { linear: [0.3, 0.0, 0.0], angular: [0.0; 3] };
        sender.send_structs(0, &[forward]).unwrap();
        let odometry: Odometry = next_frame(&mut streams[0]).message().unwrap();
        if odometry.position[0] > 0.3 {
            break odometry;
        }
        assert!(started.elapsed() < PATIENCE, "anna does not move");
        std::thread::sleep(Duration::from_millis(20));
    };
    assert_eq!(driven.child_frame_id.as_str(), "anna/base_footprint");
    let frame = next_frame(&mut streams[1]);
    assert_eq!(frame.header().frame_id.as_str(), "bert/odom");
    let still: Odometry = frame.message().unwrap();
    assert!(still.position[0].abs() < 1e-3, "anna's commands move bert");
    for (stream, name) in [(2, "anna/"), (3, "bert/")] {
        let transforms: Vec<Transform> = next_frame(&mut streams[stream]).view().structs().unwrap().collect();
        let names = |transform: &Transform| [transform.parent, transform.child];
        assert!(!transforms.is_empty());
        for frame in transforms.iter().flat_map(names) {
            assert!(frame.as_str().starts_with(name), "{frame}");
        }
    }
}

/// A spawned robot has its base and sensors; a deleted one leaves no stream and no file.
#[test]
fn a_spawned_robot_brings_its_sensors_and_leaves_nothing() {
    let urdf = belvedere().args(["urdf", ROBOT]).output().unwrap();
    let urdf = String::from_utf8(urdf.stdout).unwrap();
    let simulator = Simulator::start(&["--robot", "kobuki_hexagons_kinect", "--world", "empty"]);
    let mut control = simulator.control();
    let spawn = SimulationCommand {
        robot_namespace: Text::new("guest").unwrap(),
        position: [2.0, 0.0, 0.0],
        ..named(Operation::Spawn, "guest")
    };
    let mut files = Vec::new();
    for round in 0..5 {
        done_with(&mut control, &spawn, &urdf);
        {
            let mut streams = follow(simulator.domain(), "test", &["guest/scan", "guest/odom"]);
            let scan = next_frame(&mut streams[0]);
            assert!(scan.header().frame_id.as_str().starts_with("guest/"), "{}", scan.header().frame_id);
            assert!((scan.header().position[0] - 2.0).abs() < 0.3, "{:?}", scan.header().position);
            next_frame(&mut streams[1]);
        }
        let again = refusal(&mut control, &spawn, &urdf);
        assert!(again.contains("there is a model 'guest' already"), "{again}");
        let same_topics =
            SimulationCommand { robot_namespace: spawn.robot_namespace, ..named(Operation::Spawn, "other") };
        let taken = refusal(&mut control, &same_topics, &urdf);
        assert!(taken.contains("/guest/") && taken.contains("namespace"), "{taken}");
        done_with(&mut control, &named(Operation::Delete, "guest"), "");
        let node = simulator.node();
        let left: Vec<_> =
            node.streams().unwrap().into_iter().filter(|stream| stream.topic.starts_with("guest/")).collect();
        assert!(left.is_empty(), "{left:?}");
        drop(node);
        // The refused command left nothing either.
        files.push(files_of(simulator.domain()).len());
        assert!(files[round] <= files[0], "files of the domain: {files:?}");
    }
}

/// Each gives one clear error.
#[test]
fn robots_that_cannot_run_together_are_refused() {
    let said = |robots: &[[&str; 3]], more: &[&str]| {
        let output = hashed(robots, more);
        assert!(!output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let twice = said(&[[ROBOT, "anna", "0,0"], [ROBOT, "anna", "1,1"]], &[]);
    assert!(twice.contains("two robots are called 'anna'"), "{twice}");
    let pose = said(&[[ROBOT, "anna", "0;0"]], &[]);
    assert!(pose.contains("X,Y,YAW"), "{pose}");
    let bad = said(&[[ROBOT, "anna", "0,0"], [ROBOT, "2nd", "1,1"]], &[]);
    assert!(bad.contains("'2nd' is not a ROS namespace"), "{bad}");
    let many = said(&[[ROBOT, "anna", "0,0"]], &["--name", "bert"]);
    assert!(many.contains("2 --name for 1 robot"), "{many}");
}

/// Ten `TurtleBot`s with a lidar each in one room run in real time on two cores. Only the processor time of the
/// simulator is measured, so other programs do not matter.
#[test]
fn ten_robots_run_in_real_time() {
    const DURATION: Duration = Duration::from_secs(20);
    let names: Vec<String> = (0..10).map(|number| format!("robot_{number}")).collect();
    let poses: Vec<String> = (0..10).map(|number| format!("{},{}", number % 5 - 2, number / 5)).collect();
    let robots: Vec<[&str; 3]> = names.iter().zip(&poses).map(|(name, pose)| [ROBOT, name, pose]).collect();
    // Pictures would cost more; lidars run at 5.5 Hz each.
    let domain = own_domain();
    let mut arguments =
        vec!["run", "--domain", &domain, "--rate", "max", "--duration", "20", "--drive", "spin"];
    for option in 0..3 {
        arguments
            .extend(robots.iter().flat_map(|robot| [["--robot", "--name", "--pose"][option], robot[option]]));
    }
    let waited = "lidars=10";
    arguments.extend(["--wait-for", waited]);
    let mut simulator = belvedere().args(&arguments).stderr(std::process::Stdio::null()).spawn().unwrap();
    let topics: Vec<String> = names.iter().map(|name| format!("{name}/scan")).collect();
    let topics: Vec<&str> = topics.iter().map(String::as_str).collect();
    let mut streams = follow(&domain, "lidars", &topics);
    let mut scans = 0;
    let started = Instant::now();
    loop {
        let end = Usage::of(&simulator);
        for stream in &mut streams {
            while stream.take().unwrap().is_some() {
                scans += 1;
            }
        }
        if end.has_ended {
            println!(
                "ten robots: {scans} scans, {:?} of processor time for {DURATION:?}",
                end.processor_time
            );
            assert!(end.processor_time < 2 * DURATION, "{:?} of processor time", end.processor_time);
            break;
        }
        assert!(started.elapsed() < PATIENCE, "it does not end");
        let _ = streams[0].wait(Duration::from_millis(1));
    }
    assert!(simulator.wait().unwrap().success());
    assert!(scans >= 1090, "{scans} of 1,100 scans");
}

/// The system's data about a child process that has not been reaped.
struct Usage {
    has_ended: bool,
    processor_time: Duration,
}

impl Usage {
    fn of(child: &Child) -> Self {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
        // The preceding name in parentheses may contain any character.
        let fields: Vec<&str> = stat.rsplit_once(") ").unwrap().1.split(' ').collect();
        let ticks: u64 = fields[11..13].iter().map(|ticks| ticks.parse::<u64>().unwrap()).sum();
        // For programs, a second has a hundred ticks.
        Self { has_ended: fields[0] == "Z", processor_time: Duration::from_millis(10 * ticks) }
    }
}
