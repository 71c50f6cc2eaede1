//! Bases by their plugins: each drives a closed path as commanded, publishes odometry under its plugin's names, and
//! keeps its limits. Sizes are varied over a range, not those of one robot.

mod drives;
mod plugins;

use belvedere::description::load;
use belvedere::description::model::Model;
use belvedere::entities::EntityId;
use belvedere::rig::FrameBuf;
use belvedere::robot::Command;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::payload::{Imu, JointState, Message, Odometry, Pose};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::time::Duration;

/// The dimensions of a robot.
#[derive(Clone, Copy, Debug)]
struct Size {
    separation_m: f64,
    radius_m: f64,
    mass_kg: f64,
    /// The distance between the axles of four wheels; for two wheels, that of the casters.
    length_m: f64,
}

const SMALL: Size = Size { separation_m: 0.16, radius_m: 0.033, mass_kg: 1.0, length_m: 0.12 };
const SIZES: [Size; 3] = [
    SMALL,
    Size { separation_m: 0.57, radius_m: 0.165, mass_kg: 46.0, length_m: 0.51 },
    Size { separation_m: 1.1, radius_m: 0.06, mass_kg: 12.0, length_m: 0.4 },
];

fn wheel(name: &str, parent: &str, at: [f64; 3], size: Size) -> String {
    let [x, y, z] = at;
    let Size { radius_m, mass_kg, .. } = size;
    format!(
        "<link name='{name}_link'><collision><origin rpy='1.5707963267948966 0 0'/><geometry><cylinder radius='{radius_m}'
           length='0.02'/></geometry></collision><inertial><mass value='{}'/><inertia ixx='1e-4' iyy='1e-4' izz='1e-4' ixy='0'
           ixz='0' iyz='0'/></inertial></link>
         <joint name='{name}_joint' type='continuous'><parent link='{parent}'/><child link='{name}_link'/>
           <origin xyz='{x} {y} {z}'/><axis xyz='0 1 0'/></joint>",
        0.02 * mass_kg
    )
}

fn chassis(size: Size) -> String {
    let Size { radius_m, mass_kg, length_m, separation_m } = size;
    let inertia = 0.1 * mass_kg * (length_m * length_m + separation_m * separation_m);
    format!(
        "<link name='base_footprint'/><joint name='foot' type='fixed'><parent link='base_footprint'/>
           <child link='chassis'/><origin xyz='0 0 {radius_m}'/></joint>
         <link name='chassis'><visual><geometry><box size='{length_m} {separation_m} 0.02'/></geometry></visual>
           <inertial><mass value='{mass_kg}'/><inertia ixx='{inertia}' iyy='{inertia}' izz='{inertia}' ixy='0' ixz='0'
           iyz='0'/></inertial></link>"
    )
}

/// A robot with two wheels and two casters.
fn two_wheels(size: Size, names: [&str; 2], plugins: &str) -> Model {
    let y = 0.5 * size.separation_m;
    let casters: String = [(0, 0.5), (1, -0.5)]
        .map(|(number, side)| {
            let radius_m = 0.5 * size.radius_m;
            format!(
                "<link name='ball_{number}'><collision><geometry><sphere radius='{radius_m}'/></geometry></collision></link>
                 <joint name='ball_{number}_joint' type='fixed'><parent link='chassis'/><child link='ball_{number}'/>
                   <origin xyz='{} 0 {}'/></joint><gazebo reference='ball_{number}'><mu1>0</mu1></gazebo>",
                side * size.length_m,
                radius_m - size.radius_m
            )
        })
        .concat();
    let [left, right] = names;
    model(&format!(
        "{}{}{}{casters}<gazebo>{plugins}</gazebo>",
        chassis(size),
        wheel(left, "chassis", [0.0, y, 0.0], size),
        wheel(right, "chassis", [0.0, -y, 0.0], size)
    ))
}

fn four_wheels(size: Size, plugins: &str) -> Model {
    let (x, y) = (0.5 * size.length_m, 0.5 * size.separation_m);
    let wheels: String =
        [("front_left", x, y), ("front_right", x, -y), ("rear_left", -x, y), ("rear_right", -x, -y)]
            .map(|(name, x, y)| wheel(name, "chassis", [x, y, 0.0], size))
            .concat();
    model(&format!("{}{wheels}<gazebo>{plugins}</gazebo>", chassis(size)))
}

fn car(size: Size, plugins: &str) -> Model {
    let (x, y) = (0.5 * size.length_m, 0.5 * size.separation_m);
    let steered: String = [("left", y), ("right", -y)]
        .map(|(side, y)| {
            format!(
                "<link name='{side}_steering_link'/><joint name='{side}_steering_joint' type='revolute'>
                   <parent link='chassis'/><child link='{side}_steering_link'/><origin xyz='{x} {y} 0'/><axis xyz='0 0 1'/>
                   <limit lower='-1' upper='1' effort='1' velocity='1'/></joint>{}",
                wheel(&format!("front_{side}"), &format!("{side}_steering_link"), [0.0; 3], size)
            )
        })
        .concat();
    model(&format!(
        "{}{}{}{steered}<gazebo>{plugins}</gazebo>",
        chassis(size),
        wheel("rear_left", "chassis", [-x, y, 0.0], size),
        wheel("rear_right", "chassis", [-x, -y, 0.0], size)
    ))
}

fn model(inside: &str) -> Model {
    load::model(&format!("<robot name='bot'>{inside}</robot>")).unwrap()
}

/// A robot on a floor.
struct Bench {
    simulation: Simulation,
    robot: EntityId,
    start: DVec3,
}

impl Bench {
    fn new(model: &Model) -> Self {
        let mut simulation = Simulation::builder(load::world("empty").unwrap()).seed(7).build().unwrap();
        let robot = simulation.spawn(model, SpawnOptions::default()).unwrap();
        // Wait until it is at rest.
        simulation.run_for(Duration::from_millis(200));
        let start = simulation.pose(robot).unwrap().translation();
        Self { simulation, robot, start }
    }

    fn drive(&mut self, command: Command, seconds: f64) {
        self.simulation.command(self.robot, command).unwrap();
        self.simulation.run_for(Duration::from_secs_f64(seconds));
    }

    /// The position in the frame of its start, in m, and the heading in rad.
    fn place(&self) -> (DVec3, f64) {
        let pose = self.simulation.pose(self.robot).unwrap();
        (pose.translation() - self.start, pose.rpy().z)
    }

    fn newest<T: Message>(&mut self, topic: &str) -> (T, FrameBuf) {
        let mut frame = FrameBuf::default();
        self.simulation.render(topic, &mut frame).unwrap();
        (frame.view().message::<T>().unwrap(), frame)
    }

    fn odometry(&mut self, topic: &str) -> Odometry {
        self.newest(topic).0
    }
}

/// Drives half a circle and a full one to the left, with a radius in m; returns the largest position error in m.
fn circle(bench: &mut Bench, speed_m_s: f64, radius_m: f64) -> f64 {
    let rate = speed_m_s / radius_m;
    bench.drive(Command::new(speed_m_s, rate), PI / rate);
    let (half, _) = bench.place();
    bench.drive(Command::new(speed_m_s, rate), PI / rate);
    let (whole, _) = bench.place();
    (half - DVec3::Y * 2.0 * radius_m).truncate().length().max(whole.truncate().length())
}

fn wheels_of(size: Size) -> String {
    format!(
        "<wheelSeparation>{}</wheelSeparation><wheelDiameter>{}</wheelDiameter><wheelTorque>1000</wheelTorque>",
        size.separation_m,
        2.0 * size.radius_m
    )
}
