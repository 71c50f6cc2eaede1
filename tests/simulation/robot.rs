//! The robot's base in physics: it drives straight, turns, stands still, stops, and does not pass walls.

use crate::robot_models;

use crate::robot_models::{empty_model, ground, kobuki, static_model, world, xyz};
use belvedere::description::model::{Geometry, Model};
use belvedere::robot::{Autopilot, Command, Robot, placement};
use belvedere::world::physics::Physics;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::TAU;

/// The steps in seconds of worlds: corridor, a Gazebo server at 250 Hz, playground.
const STEPS_S: [f64; 3] = [0.001, 0.004, 0.01];

/// How much slower than commanded a loaded motor may run, because rapier's solver is iterative.
const MOTOR_LAG: f64 = 0.07;

struct Bench {
    physics: Physics,
    robot: Robot,
    turned_rad: f64,
    yaw_rad: f64,
    lowest_m: f64,
    highest_m: f64,
}

impl Bench {
    fn new(step_s: f64, mut models: Vec<Model>, start: Pose) -> Self {
        models.insert(0, ground());
        let robot = kobuki();
        let mut physics = Physics::new(&world(step_s, models)).expect("a good world");
        let index = physics.insert_model(&placement(&robot, start)).unwrap();
        let (robot, problem) = Robot::new(&robot, "", index, &mut physics);
        assert_eq!(problem, None);
        let mut bench =
            Self { physics, robot, turned_rad: 0.0, yaw_rad: 0.0, lowest_m: f64::MAX, highest_m: f64::MIN };
        bench.yaw_rad = bench.base().rpy().z;
        bench
    }

    fn base(&self) -> Pose {
        self.robot.world_from_base(&self.physics)
    }

    fn step(&mut self) {
        self.robot.control(&mut self.physics);
        self.physics.step();
        self.robot.observe(&self.physics);
        let base = self.base();
        let yaw = base.rpy().z;
        let turn = yaw - self.yaw_rad;
        self.turned_rad += turn - TAU * (turn / TAU).round();
        self.yaw_rad = yaw;
        self.lowest_m = self.lowest_m.min(base.translation().z);
        self.highest_m = self.highest_m.max(base.translation().z);
    }

    /// Runs for a time; `command` is repeated every 0.1 s, as a user's node would do.
    fn run(&mut self, seconds: f64, command: Option<Command>) {
        let end_ns = self.physics.time_ns() + (seconds * 1e9) as u64;
        let mut next_command_ns = self.physics.time_ns();
        while self.physics.time_ns() < end_ns {
            if let Some(command) = command.filter(|_| self.physics.time_ns() >= next_command_ns) {
                self.robot.command(command, self.physics.time_ns());
                next_command_ns += 100_000_000;
            }
            self.step();
        }
    }
}

fn command(linear_m_s: f64, angular_rad_s: f64) -> Command {
    Command::new(linear_m_s, angular_rad_s)
}

#[test]
fn drives_straight() {
    for step_s in STEPS_S {
        let mut bench = Bench::new(step_s, vec![], Pose::IDENTITY);
        bench.run(1.0, Some(command(0.3, 0.0)));
        let from = bench.base().translation();
        bench.run(5.0, Some(command(0.3, 0.0)));
        let way = bench.base().translation() - from;
        let now_ns = bench.physics.time_ns();
        let odometry = bench.robot.state_at(&bench.physics, now_ns).odometry.expect("a Kobuki has it");
        assert!((odometry.linear_m_s - 0.3).abs() < 0.005, "{odometry:?}");
        let apart = odometry.odom_from_base.translation().distance(bench.base().translation());
        assert!(apart < 0.005, "odometry is {apart} m off");
        assert!((way.x - 1.5).abs() < 0.03 && way.y.abs() < 0.01, "step {step_s}: {way}");
        assert!(bench.yaw_rad.abs() < 0.01, "step {step_s}: yaw {}", bench.yaw_rad);
        assert!(bench.highest_m - bench.lowest_m < 0.003, "{}..{}", bench.lowest_m, bench.highest_m);
    }
}

/// Single precision has a step of 0.5 m at the second place.
#[test]
fn drives_as_far_as_odometry_says_wherever_it_is() {
    for at in [DVec3::new(20_000.0, 30_000.0, 0.0), DVec3::new(448_262.27, 5_428_765.81, 0.0)] {
        let mut bench = Bench::new(0.001, vec![], Pose::from_xyz_rpy(at, DVec3::Z * 0.7));
        let odometry = |bench: &Bench| {
            let state = bench.robot.state_at(&bench.physics, bench.physics.time_ns());
            state.odometry.expect("a Kobuki has it").odom_from_base.translation()
        };
        bench.run(1.0, Some(command(0.3, 0.0)));
        let from = [bench.base().translation(), odometry(&bench)];
        bench.run(4.0, Some(command(0.3, 0.0)));
        let [way, told] =
            [bench.base().translation() - from[0], odometry(&bench) - from[1]].map(DVec3::length);
        assert!(way > 1.1 && (way / told - 1.0).abs() < 1e-4, "{at}: {way} m, odometry says {told} m");
    }
}

#[test]
fn spins() {
    for step_s in STEPS_S {
        let mut bench = Bench::new(step_s, vec![], Pose::IDENTITY);
        bench.run(TAU, Some(command(0.0, 1.0)));
        bench.robot.command(Command::STOP, bench.physics.time_ns());
        bench.run(1.0, None);
        assert!((bench.turned_rad - TAU).abs() < 0.03 * TAU, "step {step_s}: turned {}", bench.turned_rad);
        assert!(bench.base().translation().truncate().length() < 0.01);
    }
}

#[test]
fn stands_still() {
    for step_s in STEPS_S {
        let mut bench = Bench::new(step_s, vec![], Pose::IDENTITY);
        bench.run(1.0, None);
        let from = bench.base().translation();
        bench.run(10.0, None);
        assert!(bench.base().translation().distance(from) < 1e-3);
        assert!(
            bench.highest_m.abs() < 1e-3 && bench.lowest_m.abs() < 1e-3,
            "{}..{}",
            bench.lowest_m,
            bench.highest_m
        );
    }
}

#[test]
fn stops_at_a_wall() {
    for step_s in STEPS_S {
        let wall =
            static_model("wall", xyz(1.0, 0.0, 0.5), Geometry::Box { size: DVec3::new(0.1, 4.0, 1.0) });
        let mut bench = Bench::new(step_s, vec![wall], Pose::IDENTITY);
        bench.run(6.0, Some(command(0.7, 0.0)));
        let base = bench.base();
        // The wall's face is at 0.95, the base's radius is 0.178.
        assert!((base.translation().x - 0.772).abs() < 0.02, "{}", base.translation());
        assert!(bench.lowest_m > -0.02 && bench.highest_m < 0.05, "{}..{}", bench.lowest_m, bench.highest_m);
        bench.run(2.0, Some(command(-0.3, 0.0)));
        assert!(bench.base().translation().x < 0.5, "it drives away again: {}", bench.base().translation());
    }
}

#[test]
fn stops_without_commands() {
    let mut bench = Bench::new(0.001, vec![], Pose::IDENTITY);
    bench.robot.command(Command::new(0.5, 0.0), 0);
    bench.run(2.0, None);
    let from = bench.base().translation();
    // 0.5 s to accelerate, 0.1 s at full speed, 0.5 s to stop.
    assert!((from.x - 0.3).abs() < 0.01, "{from}");
    bench.run(1.0, None);
    assert!(bench.base().translation().distance(from) < 1e-4);
}

#[test]
fn follows_the_loop() {
    for step_s in STEPS_S {
        let path = belvedere::robot::autopilot::LoopPath::DEFAULT;
        let mut bench = Bench::new(step_s, vec![], Autopilot::Loop.start_pose());
        let mut worst_m: f64 = 0.0;
        while bench.physics.time_ns() < 40_000_000_000 {
            let base = bench.base();
            bench.robot.command(Autopilot::Loop.command(&base), bench.physics.time_ns());
            bench.step();
            worst_m = worst_m.max(path.nearest(bench.base().translation().truncate()).1);
        }
        assert!(worst_m < 0.06, "step {step_s}: {worst_m} m off the path");
        assert!(bench.turned_rad > TAU, "one round and more");
    }
}

#[test]
fn a_box_is_a_passive_robot() {
    let crate_model = empty_model("crate");
    let mut physics = Physics::new(&world(0.01, vec![])).unwrap();
    let index = physics.insert_model(&placement(&crate_model, Pose::IDENTITY)).unwrap();
    let (robot, problem) = Robot::new(&crate_model, "", index, &mut physics);
    assert!(robot.base().is_none());
    assert!(problem.unwrap().to_string().contains("it has no <plugin> of a base"));
}

#[test]
fn stands_and_climbs_on_a_slope() {
    // 10 degrees about y, nose up; friction 1 holds up to 45 degrees.
    let slope = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, -10.0_f64.to_radians(), 0.0));
    let plane = static_model("slope", slope, Geometry::Plane { normal: DVec3::Z, size: [100.0; 2] });
    let mut physics = Physics::new(&world(0.004, vec![plane])).expect("a good world");
    let index = physics.insert_model(&placement(&kobuki(), slope)).unwrap();
    let mut robot = Robot::new(&kobuki(), "", index, &mut physics).0;
    let mut run = |seconds: f64, linear_m_s: f64| {
        for _ in 0..(seconds / 0.004) as usize {
            robot.command(Command::new(linear_m_s, 0.0), physics.time_ns());
            robot.control(&mut physics);
            physics.step();
            robot.observe(&physics);
        }
        (slope.inverse() * robot.world_from_base(&physics)).translation()
    };
    let from = run(1.0, 0.0);
    let stood = run(5.0, 0.0);
    assert!(stood.distance(from) < 1e-3, "{from} to {stood}");
    let climbed = run(5.0, 0.3) - stood;
    assert!((climbed.x - (1.5 - 0.045)).abs() < 0.02, "{climbed}");
}

/// Poses of links, the published transforms and the moving links agree, also between steps.
#[test]
fn transforms_agree_with_the_world() {
    let model = kobuki();
    let mut bench = Bench::new(0.01, vec![], Pose::from_xyz_rpy(DVec3::new(3.0, -2.0, 0.0), DVec3::Z * 2.0));
    bench.run(2.0, Some(command(0.4, 0.5)));
    let (index, stamp_ns) = (bench.robot.model(), bench.physics.time_ns() - 3_000_000);
    let state = bench.robot.state_at(&bench.physics, stamp_ns);
    assert_eq!(state.odometry.expect("a Kobuki has it").stamp_ns, 1_980_000_000);
    assert_eq!(&*state.transforms[0].parent, "odom");
    let tree = state.transforms[1..].iter().chain(bench.robot.static_transforms());
    let mut checked = 0;
    for transform in tree {
        let pose = |name: &str| {
            let link = model.link_named(name).expect("a frame is a link");
            bench.physics.world_from_link_at(index, link, stamp_ns)
        };
        let apart =
            (pose(&transform.parent) * transform.parent_from_child).inverse() * pose(&transform.child);
        assert!(apart.translation().length() < 1e-5 && apart.rpy().length() < 1e-3, "{transform:?}");
        checked += 1;
    }
    assert_eq!(checked, model.joints.len());
    assert_eq!(bench.physics.moving_links().count(), model.links.len());
    for (of, link, pose) in bench.physics.moving_links_at(stamp_ns) {
        assert_eq!(pose, bench.physics.world_from_link_at(of, link, stamp_ns));
    }
}

#[test]
fn the_same_run_gives_the_same_bits() {
    let run = || {
        let crate_model = {
            let mut model =
                static_model("crate", xyz(0.8, 0.05, 0.1), Geometry::Box { size: DVec3::splat(0.2) });
            model.is_static = false;
            model.links[0].inertial = Some(robot_models::inertial(0.3, [0.002; 3]));
            model
        };
        let mut bench = Bench::new(0.004, vec![crate_model], Pose::IDENTITY);
        bench.run(3.0, Some(command(0.5, 0.2)));
        bench.physics.moving_links().collect::<Vec<_>>()
    };
    let first = run();
    assert_eq!(first, run());
    let pushed = first[0].2.translation();
    assert!(pushed.x > 0.85 && pushed.z < 0.3, "the robot pushes the crate: {pushed}");
}

/// A pendulum on a motor that holds it level: the effort is m·g·l.
#[test]
fn a_motor_reports_its_effort() {
    use belvedere::description::model::JointKind;
    let mut arm = empty_model("arm");
    arm.links.push(robot_models::link("stand", Pose::IDENTITY));
    arm.links[0].inertial = Some(robot_models::inertial(1e6, [1e6; 3]));
    arm.links[0].gravity = false;
    let mount = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(-std::f64::consts::FRAC_PI_2, 0.0, 0.0));
    let rod = robot_models::hang(&mut arm, 0, "rod", "hinge", JointKind::Continuous, mount);
    let mut inertial = robot_models::inertial(2.0, [0.01; 3]);
    inertial.link_from_inertial = xyz(0.5, 0.0, 0.0);
    arm.links[rod].inertial = Some(inertial);
    let mut physics = Physics::new(&world(0.001, vec![])).expect("a good world");
    let index = physics.insert_model(&placement(&arm, Pose::IDENTITY)).unwrap();
    physics.drive_joint(index, 0, 0.0, 100.0);
    for _ in 0..200 {
        physics.step();
    }
    let state = physics.joint_state(index, 0).expect("it moves");
    // A positive turn about +y lowers the rod, so the motor pushes in the other direction.
    assert!((state.effort.abs() - 2.0 * 9.8 * 0.5).abs() < 0.1, "{state:?}");
    physics.drive_joint(index, 0, -1.0, 100.0);
    for _ in 0..1000 {
        physics.step();
    }
    let state = physics.joint_state(index, 0).expect("it moves");
    assert!(
        (state.position + 1.0).abs() < MOTOR_LAG && (state.velocity + 1.0).abs() < MOTOR_LAG,
        "{state:?}"
    );
}

#[test]
fn a_bad_step_is_refused() {
    for step_s in [0.0, -0.001, f64::NAN, 1e-7, 0.2, f64::INFINITY] {
        let problem = Physics::new(&world(step_s, vec![])).err().expect("refused").to_string();
        assert!(problem.contains("<max_step_size> is") && problem.contains("0.001"), "{problem}");
    }
}
