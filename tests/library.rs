//! The library without a simulator process: a robot is stepped, and its sensors are rendered into the test's own
//! memory.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::robot::{Autopilot, Command};
use belvedere::server::{Server, ServerOptions};
use belvedere::simulation::{Simulation, SimulationError, SpawnOptions};
use belvedere_bridge::payload::Odometry;
use belvedere_bridge::{Domain, Node};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::{Duration, Instant};

const LIDAR: &str = "kobuki_nostack_rplidar";

fn empty() -> Simulation {
    Simulation::builder(load::world("empty").unwrap()).seed(7).build().unwrap()
}

fn named(name: &str, x: f64) -> SpawnOptions {
    SpawnOptions {
        name: name.into(),
        namespace: name.into(),
        world_from_model: Pose::from_translation(DVec3::new(x, 0.0, 0.0)),
        is_robot: None,
    }
}

fn ranges(frame: &FrameBuf) -> Vec<f32> {
    let view = frame.view();
    view.numbers(view.rows()).collect()
}

/// The operations of a user's test, which must take less than 0.2 s in at least one of five tries, because the machine
/// may have other load. It runs in a process of its own, because other tests of this program publish into shared
/// memory.
#[test]
fn a_world_a_robot_and_ten_steps_take_no_shared_memory() {
    const ALONE: &str = "BELVEDERE_TEST_ALONE";
    if std::env::var_os(ALONE).is_none() {
        let mut itself = std::process::Command::new(std::env::current_exe().unwrap());
        let name = "a_world_a_robot_and_ten_steps_take_no_shared_memory";
        let output = itself.args(["--exact", name, "--nocapture"]).env(ALONE, "1").output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.contains("1 passed"), "{said}");
        return;
    }
    // The first use of the model files and of the sensors' threads is not measured.
    drop(empty());
    let took: Vec<Duration> = (0..5).map(|_| a_world_a_robot_and_ten_steps()).collect();
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    assert!(!maps.contains("/dev/shm"), "shared memory was mapped");
    println!("a world, a robot, ten steps, a scan: {took:?}");
    assert!(took.iter().any(|took| *took < Duration::from_millis(200)), "{took:?}");
}

fn a_world_a_robot_and_ten_steps() -> Duration {
    let started = Instant::now();
    let mut simulation = empty();
    let robot = simulation.spawn(&load::robot(LIDAR).unwrap(), SpawnOptions::default()).unwrap();
    (0..10).for_each(|_| simulation.step());
    let mut scan = FrameBuf::default();
    simulation.render("scan", &mut scan).unwrap();
    let took = started.elapsed();
    assert_eq!(simulation.time_ns(), 10 * simulation.physics().step_ns());
    assert_eq!(scan.header().stamp_ns, simulation.time_ns());
    assert!(ranges(&scan).iter().all(|range| *range == f32::INFINITY), "there is nothing to be seen");
    assert!(simulation.pose(robot).unwrap().translation().length() < 0.01);
    took
}

/// A picture and its ground truth, including flow, at the same moment; and a stream of another sensor in the same call.
#[test]
fn streams_of_one_frame() {
    let mut simulation = Simulation::builder(load::world("tag_ceiling").unwrap()).build().unwrap();
    let model = load::robot("kobuki_hexagons_kinect").unwrap();
    let robot = simulation.spawn(&model, SpawnOptions::default()).unwrap();
    let topics = [
        "/camera/rgb/image_raw",
        "/camera/rgb/image_raw/truth/flow_back",
        "/camera/rgb/image_raw/truth/flow_forward",
        "/odom",
    ];
    let mut frames: [FrameBuf; 4] = Default::default();
    for step in 0..3 {
        simulation.command(robot, Command::new(0.3, 0.5)).unwrap();
        simulation.run_for(Duration::from_millis(100));
        let filled = simulation.render_all(&topics, &mut frames).unwrap();
        let has_before = step > 0;
        assert_eq!(filled, [true, has_before, has_before, true], "at step {step}");
        let [picture, back, forward, odometry] = &frames;
        assert_eq!(picture.header().stamp_ns, odometry.header().stamp_ns);
        if has_before {
            assert_eq!(back.header().stamp_ns, picture.header().stamp_ns);
            assert_eq!(forward.header().stamp_ns + 100_000_000, picture.header().stamp_ns);
            let most = |frame: &FrameBuf| {
                let view = frame.view();
                view.numbers::<f32>(view.rows())
                    .map(f32::abs)
                    .filter(|flow| flow.is_finite())
                    .fold(0.0, f32::max)
            };
            // It turns by 0.05 rad, which is about 30 pixels.
            assert!((10.0..60.0).contains(&most(back)), "{} pixels", most(back));
        }
    }
    let nothing = simulation.render_all(&["/odom", "/odour"], &mut frames).unwrap_err().to_string();
    assert!(nothing.contains("/odour") && nothing.contains("did you mean '/odom"), "{nothing}");
}

/// Robots from one file, each in its namespace, with separate frames, topics and noise; the one behind sees the other.
#[test]
fn two_robots_share_a_world() {
    let mut simulation = empty();
    let wall = "<sdf version='1.6'><model name='wall'><pose>0 3 1 0 0 0</pose><static>true</static><link name='l'>
        <collision name='c'><geometry><box><size>60 0.2 2</size></box></geometry></collision></link></model></sdf>";
    simulation.spawn(&load::model(wall).unwrap(), SpawnOptions::default()).unwrap();
    let model = load::robot("kobuki_hexagons_KinectHokuyo").unwrap();
    let first = simulation.spawn(&model, named("first", 0.0)).unwrap();
    let second = simulation.spawn(&model, named("second", 2.0)).unwrap();
    let (mut one, mut other) = (FrameBuf::default(), FrameBuf::default());
    // They face the wall in the same way; only the noise differs.
    simulation.render("/first/rrbot/laser/scan", &mut one).unwrap();
    simulation.render("/second/rrbot/laser/scan", &mut other).unwrap();
    let both = ranges(&one).into_iter().zip(ranges(&other));
    let apart: Vec<f32> =
        both.map(|(one, other)| (one - other).abs()).filter(|apart| apart.is_finite()).collect();
    let differ = apart.iter().filter(|apart| **apart > 0.0).count();
    assert!(differ > 100 && apart.iter().all(|apart| *apart < 0.1), "{differ} of {apart:?}");
    assert!(one.header().frame_id.as_str().starts_with("first/"), "{}", one.header().frame_id);
    let mut nearest = |simulation: &mut Simulation| {
        simulation.render("/first/camera/depth/image_raw", &mut one).unwrap();
        // The lower half of the picture shows the floor.
        let upper = one.header().height as usize / 2;
        one.view().numbers(one.view().rows().take(upper)).fold(f32::INFINITY, f32::min)
    };
    let seen = nearest(&mut simulation);
    assert!((1.5..2.0).contains(&seen), "{seen}");
    simulation.set_autopilot(second, Autopilot::Still).unwrap();
    for _ in 0..20 {
        simulation.command(first, Command::new(0.3, 0.0)).unwrap();
        simulation.run_for(Duration::from_millis(100));
    }
    let mut odometry = FrameBuf::default();
    simulation.render("/first/odom", &mut odometry).unwrap();
    let driven = odometry.view().message::<Odometry>().unwrap();
    assert_eq!(
        (driven.child_frame_id.as_str(), odometry.header().frame_id.as_str()),
        ("first/base_footprint", "first/odom")
    );
    let nearer = nearest(&mut simulation);
    assert!((f64::from(seen - nearer) - driven.position[0]).abs() < 0.05, "{seen} {nearer} {driven:?}");
    assert!(simulation.pose(second).unwrap().translation().x > 1.99, "nobody drove the second");
}

/// The library renders the same bytes that a server of the same simulation publishes.
#[test]
fn a_server_publishes_what_the_library_renders() {
    let build = || {
        let mut simulation = empty();
        simulation.spawn(&load::robot("kobuki_hexagons_kinect").unwrap(), SpawnOptions::default()).unwrap();
        simulation
    };
    let topics = ["/camera/depth/image_raw", "/camera/rgb/image_raw", "/camera/depth/points"];
    let mut served = build();
    let domain = Domain::new(&format!("library-{}", std::process::id())).unwrap();
    let (node, reader) = (Node::open(&domain, "belvedere").unwrap(), Node::open(&domain, "reader").unwrap());
    let mut server = Server::attach(&mut served, &node, ServerOptions::default()).unwrap();
    let mut subscribers = topics.map(|topic| reader.subscriber(topic).unwrap());
    // A server finds its subscribers when it sends; the first frames of all streams are due at 0.
    for subscriber in &mut subscribers {
        assert!(subscriber.take().unwrap().is_none());
    }
    server.advance();
    for (topic, subscriber) in topics.into_iter().zip(&mut subscribers) {
        assert!(subscriber.wait(Duration::from_secs(60)).unwrap(), "{topic} sends nothing");
        let published = subscriber.take().unwrap().expect("a frame");
        // A separate simulation for each, because the noise of a sensor's next frame differs.
        let mut frame = FrameBuf::default();
        build().render(topic, &mut frame).unwrap();
        assert_eq!(frame.header().stamp_ns, published.header().stamp_ns);
        assert_eq!(frame.header().block, published.header().block, "{topic}");
        assert_eq!(frame.header().position, published.header().position, "{topic}");
        assert!(frame.payload() == published.payload(), "{topic} differs");
    }
}

/// A model with sensors never falls asleep, whether it is called a robot or not, because its rays would move.
#[test]
fn models_with_sensors_never_sleep() {
    const SENSOR: &str =
        "<sensor name='s' type='ray'><pose>0 0 0.5 0 0 0</pose><topic>scan</topic><ray><range><min>0.1</min>
        <max>9</max></range></ray></sensor>";
    let stands = |sensor, is_robot| {
        let mut simulation = Simulation::builder(load::world("playground").unwrap()).seed(7).build().unwrap();
        let text = format!(
            "<sdf version='1.6'><model name='m'><pose>0 0 0.2 0 0 0</pose><link name='l'><inertial><mass>50</mass>
            <inertia><ixx>4</ixx><iyy>4</iyy><izz>4</izz></inertia></inertial><collision name='c'><geometry><box>
            <size>0.6 0.6 0.4</size></box></geometry></collision>{sensor}</link></model></sdf>"
        );
        let options = SpawnOptions { is_robot, ..SpawnOptions::default() };
        let id = simulation.spawn(&load::model(&text).unwrap(), options).unwrap();
        simulation.run_for(Duration::from_millis(1500));
        simulation.pose(id).unwrap()
    };
    assert_eq!(stands(SENSOR, None), stands(SENSOR, Some(true)));
    assert_ne!(stands("", None), stands("", Some(true)));
}

/// Each gives one clear error.
#[test]
fn invalid_requests_are_refused() {
    let mut simulation = empty();
    let model = load::robot(LIDAR).unwrap();
    let wall = load::model(
        "<sdf version='1.6'><model name='wall'><static>true</static><link name='l'/></model></sdf>",
    );
    let wall = simulation.spawn(&wall.unwrap(), SpawnOptions::default()).unwrap();
    simulation.spawn(&model, SpawnOptions::default()).unwrap();
    let said = |result: Result<_, SimulationError>| result.expect_err("refused").to_string();
    let twice = said(simulation.spawn(&model, SpawnOptions::default()).map(|_| ()));
    assert!(twice.contains("already") && twice.contains("another name"), "{twice}");
    for namespace in ["1st", "a b", "a//b", "ä"] {
        let options =
            SpawnOptions { name: "other".into(), namespace: namespace.into(), ..SpawnOptions::default() };
        let error = said(simulation.spawn(&model, options).map(|_| ()));
        assert!(error.contains(namespace) && error.contains("robot_1"), "{error}");
    }
    let command = Command::new(1.0, 0.0);
    assert!(said(simulation.command(wall, command)).contains("'wall' has no base"));
    let mut frame = FrameBuf::default();
    let topic = said(simulation.render("/scam", &mut frame));
    assert!(topic.contains("did you mean '/scan'?"), "{topic}");
    // Two robots whose streams have the same names.
    let beside = Pose::from_translation(DVec3::new(-1.0, 0.0, 0.0));
    let options = SpawnOptions { name: "other".into(), world_from_model: beside, ..SpawnOptions::default() };
    simulation.spawn(&model, options).unwrap();
    let both = said(simulation.render("/scan", &mut frame));
    assert!(both.contains("two streams") && both.contains("namespace"), "{both}");
}
