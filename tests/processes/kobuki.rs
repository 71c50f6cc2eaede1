//! The interface of a Kobuki's driver: inertial measurements, bumpers, cliffs, wheel drops, the reset of odometry and
//! the motors' power.

use crate::live;

use crate::live::{Simulator, next_frame};
use crate::robot_models::{ground, hang, kobuki, static_model, world, xyz};
use belvedere::description::model::{Geometry, Model};
use belvedere::robot::contact::{CLIFF_M, Contact, cliff_reading};
use belvedere::robot::kobuki::Report;
use belvedere::robot::odometry::GYRO_STEP_RAD_S;
use belvedere::robot::{Command, Kobuki, Robot, placement};
use belvedere::world::physics::Physics;
use belvedere_bridge::payload::{
    CoreSensors, Imu, Message, MotorPower, Odometry, ResetOdometry, RobotEvent, VelocityCommand,
};
use belvedere_bridge::{Kind, StreamSpec, Subscriber};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::Instant;

/// The steps in seconds of worlds: corridor, a Gazebo server at 250 Hz, playground, and one that contains two and a
/// half reports.
const STEPS_S: [f64; 4] = [0.001, 0.004, 0.01, 0.05];
const GRAVITY_M_S2: f64 = 9.8;

struct Bench {
    physics: Physics,
    robot: Robot,
}

impl Bench {
    fn new(step_s: f64, models: Vec<Model>) -> Self {
        let mut model = kobuki();
        let base = model.link_named("base_link").unwrap();
        // The centre of mass from the description: in front of the wheels, so that it leans on its front caster.
        model.links[base].inertial.as_mut().unwrap().link_from_inertial = xyz(0.01, 0.0, 0.0);
        let gyro = xyz(0.056, 0.062, 0.0202);
        hang(
            &mut model,
            base,
            "gyro_link",
            "gyro_joint",
            belvedere::description::model::JointKind::Fixed,
            gyro,
        );
        let mut physics = Physics::new(&world(step_s, models)).unwrap();
        let index = physics.insert_model(&placement(&model, Pose::IDENTITY)).unwrap();
        let robot = Robot::new(&model, "", index, &mut physics).0;
        Self { physics, robot }
    }

    fn on_ground(step_s: f64) -> Self {
        Self::new(step_s, vec![ground()])
    }

    fn report(&self) -> Report {
        *self.robot.base().unwrap().downcast_ref::<Kobuki>().unwrap().report_at(self.physics.time_ns())
    }

    fn step(&mut self) -> Report {
        self.robot.control(&mut self.physics);
        self.physics.step();
        self.robot.observe(&self.physics);
        self.report()
    }

    /// Runs for a time with a command at each step, and returns all reports.
    fn drive(&mut self, seconds: f64, linear_m_s: f64, angular_rad_s: f64) -> Vec<Report> {
        let end_ns = self.physics.time_ns() + (seconds * 1e9) as u64;
        let mut reports = Vec::new();
        while self.physics.time_ns() < end_ns {
            self.robot.command(Command::new(linear_m_s, angular_rad_s), self.physics.time_ns());
            reports.push(self.step());
        }
        reports.dedup_by_key(|report| report.odometry.stamp_ns);
        reports
    }

    fn base(&self) -> Pose {
        self.robot.world_from_base(&self.physics)
    }
}

#[test]
fn at_rest_it_measures_only_gravity() {
    for step_s in STEPS_S {
        let mut bench = Bench::on_ground(step_s);
        bench.drive(2.0, 0.0, 0.0);
        for report in bench.drive(1.0, 0.0, 0.0) {
            let imu = report.imu;
            assert_eq!(imu.angular_velocity_rad_s, DVec3::ZERO, "step {step_s}");
            let force = imu.linear_acceleration_m_s2;
            assert!((force.z - GRAVITY_M_S2).abs() < 1e-6, "step {step_s}: {force}");
            assert!(force.truncate().length() < 0.02, "step {step_s}: it leans by {force}");
            assert_eq!(imu.orientation, glam::DQuat::IDENTITY);
            let contact = report.contact;
            assert_eq!(
                (contact.bumper, contact.cliff, contact.wheel_drop),
                ([false; 3], [false; 3], [false; 2])
            );
            for reading in contact.bottom {
                assert!(reading.abs_diff(cliff_reading(0.0316)) < 40, "step {step_s}: {contact:?}");
            }
        }
    }
}

/// While it turns on the spot at ω, the gyro measures ω, and the accelerometer beside the axle measures ω² times its
/// distance, towards the axle.
#[test]
fn turning_is_measured_as_rate_and_centripetal_force() {
    for step_s in STEPS_S {
        let mut bench = Bench::on_ground(step_s);
        bench.drive(2.0, 0.0, 1.5);
        for report in bench.drive(1.0, 0.0, 1.5) {
            let imu = report.imu;
            assert!((imu.angular_velocity_rad_s.z - 1.5).abs() < 0.01, "step {step_s}: {imu:?}");
            let steps = imu.angular_velocity_rad_s.z / GYRO_STEP_RAD_S;
            assert!((steps - steps.round()).abs() < 1e-6, "the chip's steps");
            let force = imu.linear_acceleration_m_s2.truncate();
            let centripetal = -DVec3::new(0.056, 0.062, 0.0).truncate() * 1.5 * 1.5;
            assert!(force.distance(centripetal) < 0.03, "step {step_s}: {force} for {centripetal}");
            let heading = report.odometry.odom_from_base.rotation();
            assert_eq!(imu.orientation, heading, "the heading of odometry");
        }
    }
}

#[test]
fn acceleration_is_measured() {
    let mut bench = Bench::on_ground(0.001);
    bench.drive(1.0, 0.0, 0.0);
    let reports = bench.drive(0.4, 0.6, 0.0);
    let felt = reports[5..15].iter().map(|report| report.imu.linear_acceleration_m_s2.x);
    for force in felt {
        assert!((force - 1.0).abs() < 0.05, "{force} m/s² of 1");
    }
}

#[test]
fn a_post_presses_the_bumper_that_hits_it() {
    for step_s in STEPS_S {
        for (angle_rad, expected) in [
            (0.0, [false, true, false]),
            (60_f64.to_radians(), [false, false, true]),
            (-60_f64.to_radians(), [true, false, false]),
        ] {
            // Driving straight ahead, it hits the post at this angle to its right.
            let post = static_model(
                "post",
                xyz(0.3, -(0.178 + 0.02) * angle_rad.sin(), 0.2),
                Geometry::Cylinder { radius: 0.02, length: 0.4 },
            );
            let mut bench = Bench::new(step_s, vec![ground(), post]);
            bench.drive(0.5, 0.0, 0.0);
            assert_eq!(bench.report().contact.bumper, [false; 3]);
            let pressed = bench
                .drive(2.0, 0.2, 0.0)
                .into_iter()
                .map(|report| report.contact.bumper)
                .find(|bumper| *bumper != [false; 3]);
            assert_eq!(pressed, Some(expected), "step {step_s}, post at {angle_rad} rad");
            if angle_rad == 0.0 {
                assert_eq!(bench.report().contact.bumper, expected, "it still pushes");
                bench.drive(1.0, -0.2, 0.0);
                assert_eq!(bench.report().contact.bumper, [false; 3], "step {step_s}: backed off");
            }
        }
    }
}

/// Over the edge of a platform: first the cliff sensor ahead, then those at the sides, then the wheels.
#[test]
fn an_edge_is_a_cliff_before_a_wheel_drops() {
    for step_s in [0.001, 0.004, 0.01] {
        let platform =
            static_model("platform", xyz(-0.5, 0.0, -0.5), Geometry::Box { size: DVec3::new(2.0, 2.0, 1.0) });
        let mut bench = Bench::new(step_s, vec![platform]);
        let reports = bench.drive(4.0, 0.3, 0.0);
        let first = |what: fn(&Contact) -> bool| reports.iter().position(|report| what(&report.contact));
        let ahead = first(|contact| contact.cliff[1]).expect("a cliff ahead");
        let sides = first(|contact| contact.cliff[0] && contact.cliff[2]).expect("cliffs at the sides");
        let wheels = first(|contact| contact.wheel_drop == [true; 2]).expect("wheels drop");
        assert!(ahead < sides && sides < wheels, "step {step_s}: {ahead}, {sides}, {wheels}");
        // The front sensor is 0.156 m ahead of the axle, the edge at 0.5.
        let at_m = reports[ahead].odometry.odom_from_base.translation().x;
        assert!((at_m - (0.5 - 0.156)).abs() < 0.01, "step {step_s}: a cliff at {at_m}");
        assert!(reports[ahead].contact.bottom[1] < cliff_reading(CLIFF_M));
        assert!(!reports[..wheels].iter().any(|report| report.contact.wheel_drop == [true; 2]));
    }
}

#[test]
fn odometry_is_reset_at_the_robots_pose() {
    for step_s in STEPS_S {
        let mut bench = Bench::on_ground(step_s);
        bench.drive(2.0, 0.3, 0.4);
        let (before, encoders) = (bench.base(), bench.report().encoders);
        bench.robot.reset_odometry(&bench.physics);
        // It may only contain the motion until the next report.
        let report = loop {
            let report = bench.step();
            if report.odometry.stamp_ns > 2_000_000_000 {
                break report;
            }
        };
        let pose = report.odometry.odom_from_base;
        assert!(pose.translation().length() < 0.3 * 0.05 + 1e-3, "step {step_s}: {}", pose.translation());
        assert!(pose.rpy().z.abs() < 0.4 * 0.05 + 1e-3, "step {step_s}");
        assert!(bench.base().translation().distance(before.translation()) < 0.3 * 0.05 + 1e-3);
        assert!((report.odometry.linear_m_s - 0.3).abs() < 0.01, "its speed is still known: {report:?}");
        assert!(encoders.iter().zip(report.encoders).all(|(before, now)| now.wrapping_sub(*before) < 400));
        // From now on, it contains the motion since then.
        let here = bench.base();
        let from = bench.report().odometry.odom_from_base;
        bench.drive(2.0, 0.3, 0.4);
        let true_way = here.inverse() * bench.base();
        let told_way = from.inverse() * bench.report().odometry.odom_from_base;
        assert!(true_way.translation().distance(told_way.translation()) < 0.03, "step {step_s}");
    }
}

#[test]
fn without_power_it_stops_and_ignores_commands() {
    let mut bench = Bench::on_ground(0.004);
    bench.drive(1.0, 0.3, 0.0);
    bench.robot.set_motor_power(false);
    bench.drive(0.5, 0.3, 0.0);
    let stood = bench.base();
    bench.drive(1.0, 0.3, 0.0);
    assert!(bench.base().translation().distance(stood.translation()) < 1e-4);
    assert_eq!(bench.report().odometry.linear_m_s, 0.0);
    bench.robot.set_motor_power(true);
    bench.drive(1.0, 0.3, 0.0);
    assert!(bench.base().translation().x - stood.translation().x > 0.2, "on again");
}

/// The next message of a stream that fulfils a condition.
fn find<T: Message>(subscriber: &mut Subscriber, wanted: impl Fn(&T) -> bool) -> (u64, T) {
    let started = Instant::now();
    loop {
        let frame = next_frame(subscriber);
        let message = frame.message().unwrap();
        if wanted(&message) {
            return (frame.header().stamp_ns, message);
        }
        assert!(started.elapsed() < live::PATIENCE, "{} does not send it", subscriber.topic());
    }
}

#[test]
fn streams_are_published_and_commands_accepted() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let node = simulator.node();
    let mut imu = node.subscriber("/mobile_base/sensors/imu_data").unwrap();
    let mut core = node.subscriber("/mobile_base/sensors/core").unwrap();
    let mut odometry = node.subscriber("/odom").unwrap();
    let first = next_frame(&mut imu);
    assert_eq!(first.header().frame_id.as_str(), "gyro_link");
    let message: Imu = first.message().unwrap();
    assert_eq!(message.orientation_covariance[8], 0.05);
    assert_eq!(next_frame(&mut imu).header().stamp_ns - first.header().stamp_ns, 20_000_000);
    let (stamp_ns, resting) = find(&mut core, |core: &CoreSensors| core.time_stamp >= 20);
    assert_eq!(u64::from(resting.time_stamp), stamp_ns / 1_000_000 % 65_536);
    assert_eq!((resting.bumper, resting.cliff, resting.wheel_drop, resting.battery), (0, 0, 0, 165));

    let commands = node.publisher(&StreamSpec::velocity_command("/cmd_vel")).unwrap();
    let command = |topic, kind| node.publisher(&StreamSpec::command(topic, kind)).unwrap();
    let power = command("/mobile_base/commands/motor_power", Kind::MotorPower);
    let reset = command("/mobile_base/commands/reset_odometry", Kind::ResetOdometry);
    let forward = || {
        let forward = VelocityCommand { linear: [0.3, 0.0, 0.0], angular: [0.0; 3] };
        commands.send_structs(0, &[forward]).unwrap();
    };
    let far = |odometry: &Odometry| odometry.position[0] > 0.1;
    find(&mut odometry, |message: &Odometry| {
        forward();
        far(message)
    });
    power.send_structs(0, &[MotorPower { state: 0 }]).unwrap();
    let (_, stood) = find(&mut odometry, |message: &Odometry| {
        forward();
        message.linear == [0.0; 3]
    });
    reset.send_structs(0, &[ResetOdometry::default()]).unwrap();
    let (_, zero) = find(&mut odometry, |message: &Odometry| message.position[0] < 0.05);
    assert!(far(&stood));
    assert_eq!((zero.position, zero.orientation), ([0.0; 3], [0.0, 0.0, 0.0, 1.0]));
    let (_, moved) = find(&mut core, |core: &CoreSensors| core.left_encoder != resting.left_encoder);
    assert_eq!(moved.charger, 0);
    power.send_structs(0, &[MotorPower { state: 1 }]).unwrap();
    find(&mut odometry, |message: &Odometry| {
        forward();
        far(message)
    });
}

/// A platform of 2 m with a wall at one end: each event is sent once, and the last one is sent again to late
/// subscribers.
#[test]
fn events_are_sent_once_and_the_last_one_to_late_subscribers() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("platform.world");
    let model = |name: &str, pose: &str, size: &str| {
        format!(
            "<model name='{name}'><static>true</static><pose>{pose} 0 0 0</pose><link name='l'><collision name='c'>\
             <geometry><box><size>{size}</size></box></geometry></collision></link></model>"
        )
    };
    let text = format!(
        "<sdf version='1.6'><world name='platform'>{}{}</world></sdf>",
        model("platform", "-0.5 0 -0.5", "2 2 1"),
        model("wall", "-1 0 0.5", "0.1 2 1")
    );
    std::fs::write(&file, text).unwrap();
    let simulator = Simulator::start(&["--drive", "still", "--world", file.to_str().unwrap()]);
    let node = simulator.node();
    let mut core = node.subscriber("/mobile_base/sensors/core").unwrap();
    next_frame(&mut core);
    let mut cliffs = node.subscriber("/mobile_base/events/cliff").unwrap();
    let mut wheels = node.subscriber("/mobile_base/events/wheel_drop").unwrap();
    // A subscriber connects when it first polls.
    assert!(cliffs.take().unwrap().is_none() && wheels.take().unwrap().is_none(), "nothing has happened");
    let commands = node.publisher(&StreamSpec::velocity_command("/cmd_vel")).unwrap();
    let forward = VelocityCommand { linear: [0.3, 0.0, 0.0], angular: [0.0; 3] };
    let (dropped_ns, _) = find(&mut core, |core: &CoreSensors| {
        commands.send_structs(0, &[forward]).unwrap();
        core.wheel_drop == 3
    });
    let frame = next_frame(&mut cliffs);
    let event: RobotEvent = frame.message().unwrap();
    assert_eq!((event.source, event.index, event.state), (RobotEvent::CLIFF, RobotEvent::CENTRE, 1));
    assert!(event.value < cliff_reading(CLIFF_M).into() && frame.header().stamp_ns < dropped_ns);
    let (_, event) = find(&mut wheels, |event: &RobotEvent| event.state == 1);
    assert_eq!(event.source, RobotEvent::WHEEL_DROP);
    let mut late = node.subscriber("/mobile_base/events/cliff").unwrap();
    let event: RobotEvent = next_frame(&mut late).message().unwrap();
    assert_eq!(event.source, RobotEvent::CLIFF);
}

#[test]
fn a_live_simulator_publishes_bumper_events() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wall.world");
    let text = "<sdf version='1.6'><world name='wall'><model name='floor'><static>true</static><link name='l'>\
        <collision name='c'><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>\
        <model name='wall'><static>true</static><pose>0.5 0 0.5 0 0 0</pose><link name='l'><collision name='c'>\
        <geometry><box><size>0.1 2 1</size></box></geometry></collision></link></model></world></sdf>";
    std::fs::write(&file, text).unwrap();
    let simulator = Simulator::start(&["--drive", "still", "--world", file.to_str().unwrap()]);
    let node = simulator.node();
    let mut core = node.subscriber("/mobile_base/sensors/core").unwrap();
    next_frame(&mut core);
    let mut bumpers = node.subscriber("/mobile_base/events/bumper").unwrap();
    assert!(bumpers.take().unwrap().is_none(), "nothing has happened");
    let commands = node.publisher(&StreamSpec::velocity_command("/cmd_vel")).unwrap();
    let mut seen = Vec::new();
    for (speed_m_s, bits) in [(0.2, 2), (-0.2, 0)] {
        find(&mut core, |core: &CoreSensors| {
            let command = VelocityCommand { linear: [speed_m_s, 0.0, 0.0], angular: [0.0; 3] };
            commands.send_structs(0, &[command]).unwrap();
            core.bumper == bits
        });
        let event: RobotEvent = next_frame(&mut bumpers).message().unwrap();
        seen.push((event.source, event.index, event.state));
    }
    let centre = (RobotEvent::BUMPER, RobotEvent::CENTRE);
    assert_eq!(seen, [(centre.0, centre.1, 1), (centre.0, centre.1, 0)]);
}
