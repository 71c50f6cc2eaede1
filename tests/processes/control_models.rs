//! Models of a running simulation are moved, added and removed by another process, as its streams show.

use crate::live::control::{BOX, ROBOT, assert_near, done, done_with, named, state, states, step};
use crate::live::{Simulator, follow, next_frame};
use belvedere_bridge::payload::{Imu, ModelState, Odometry, SimulationCommand};
use belvedere_bridge::{Operation, SimulationControl, StreamSpec, Subscriber, Text};

#[test]
fn models_are_moved_and_put_back() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = simulator.control();
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
    // Slightly ahead of its current position: along its own x, which is the world's y.
    let ahead = SimulationCommand {
        position: [0.2, 0.0, 0.0],
        reference: Text::new("turtlebot::base_footprint").unwrap(),
        ..named(Operation::SetModelState, ROBOT)
    };
    done_with(&mut control, &ahead, "");
    assert_near(state(&mut models, ROBOT).unwrap().position, [0.5, -0.1, 0.0], 1e-4);
    // The base does not report that it was moved by the command.
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
    // A velocity is set together with the pose: thrown upwards at 2 m/s, it is 0.15 m up after 0.1 s.
    let thrown = SimulationCommand {
        position: [0.0, 0.0, 0.5],
        linear: [0.0, 0.0, 2.0],
        ..named(Operation::SetModelState, ROBOT)
    };
    let mut imu = follow(simulator.domain(), "imu", &["mobile_base/sensors/imu_data"]).remove(0);
    done_with(&mut control, &thrown, "");
    let before = state(&mut models, ROBOT).unwrap();
    assert_near(before.linear, [0.0, 0.0, 2.0], 1e-5);
    step(&mut control, 20);
    let robot = state(&mut models, ROBOT).unwrap();
    assert_near(robot.position, [0.0, 0.0, 0.5 + 0.2 - 0.5 * 9.8 * 0.01], 0.02);
    // It falls freely: neither the throw nor the fall is measured as a force.
    let felt: Vec<[f64; 3]> = std::iter::from_fn(|| imu.take().unwrap())
        .map(|frame| frame.message::<Imu>().unwrap().linear_acceleration)
        .collect();
    assert!(!felt.is_empty());
    // The first report still includes the time at rest between the report before and the throw.
    assert!(felt.iter().all(|force| force.iter().all(|along| along.abs() < 10.0)), "{felt:?}");
    assert!(felt.last().unwrap().iter().all(|along| along.abs() < 0.1), "{felt:?}");
    // The models of the world, including static ones.
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

/// The shortest range within 3° of straight ahead in the next scan; the robot is at the origin.
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
    let mut control = simulator.control();
    let mut models = simulator.subscribe(StreamSpec::MODEL_STATES);
    let mut links = simulator.subscribe(StreamSpec::LINK_STATES);
    let mut scans = simulator.subscribe("scan");
    // Add the box.
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
        // A reset of the world moves it back into the air, and so does one of the simulation.
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
fn frames_after_an_answer_show_the_change() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = simulator.control();
    let mut states = simulator.subscribe(StreamSpec::MODEL_STATES);
    next_frame(&mut states);
    assert!(control.is_connected().unwrap());
    assert_eq!(control.answered_ns(), 0);
    for round in 0..40 {
        // While paused and while running.
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
