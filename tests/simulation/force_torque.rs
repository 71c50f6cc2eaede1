//! Force-torque sensors: what they read of known forces, in which direction, and in which axes.

mod files;

use belvedere::description::load;
use belvedere::description::model::{Model, World};
use belvedere::rig::FrameBuf;
use belvedere::robot::Command;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere::world::physics::{Physics, Placement};
use belvedere_bridge::payload::Wrench;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::Duration;

const G: f64 = 9.8;

fn link(name: &str, pose: &str, mass_kg: f64, inside: &str) -> String {
    format!(
        "<link name='{name}'><pose>{pose}</pose><inertial><mass>{mass_kg}</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy>
           <izz>0.01</izz></inertia></inertial>{inside}</link>"
    )
}

fn sensor(inside: &str) -> String {
    format!(
        "<sensor name='ft' type='force_torque'><update_rate>100</update_rate><topic>ft</topic>
           <force_torque>{inside}</force_torque></sensor>"
    )
}

/// A joint between two links, with more inside.
fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent>{parent}</parent><child>{child}</child>{inside}</joint>"
    )
}

fn model(inside: &str) -> Model {
    load::model(&format!("<sdf version='1.7'><model name='m'>{inside}</model></sdf>")).unwrap()
}

/// A model in an empty world.
fn alone(inside: &str) -> (Physics, usize) {
    let mut physics = Physics::new(&World::empty()).unwrap();
    let index = physics.insert_model(&Placement::of_thing(&model(inside), Pose::IDENTITY)).unwrap();
    (physics, index)
}

/// A floor, and steps of 1 ms.
fn ground() -> World {
    World { max_step_size_s: 0.001, ..load::world("empty").unwrap() }
}

struct Bench {
    simulation: Simulation,
}

impl Bench {
    fn new(world: World, model: &Model, at: Pose) -> Self {
        let mut simulation = Simulation::builder(world).seed(4).build().unwrap();
        let options = SpawnOptions { world_from_model: at, ..SpawnOptions::default() };
        simulation.spawn(model, options).unwrap();
        Self { simulation }
    }

    fn read_from(&mut self, topic: &str) -> (Wrench, String) {
        let mut frame = FrameBuf::default();
        self.simulation.render(topic, &mut frame).unwrap();
        let frame_id = frame.header().frame_id.as_str().to_owned();
        (bytemuck::pod_read_unaligned(frame.payload()), frame_id)
    }

    fn read(&mut self) -> (Wrench, String) {
        self.read_from("ft")
    }

    /// The reading after some time, which is the mean of the last 100 ms of it.
    fn after(&mut self, milliseconds: u64) -> Wrench {
        self.simulation.run_for(Duration::from_millis(milliseconds - 100));
        self.read();
        self.simulation.run_for(Duration::from_millis(100));
        self.read().0
    }
}

fn at(z: f64) -> Pose {
    Pose::from_translation(DVec3::Z * z)
}

/// What such a model reads at rest, 2 m above the ground.
fn at_rest(inside: &str) -> Wrench {
    Bench::new(ground(), &model(inside), at(2.0)).after(400)
}

#[track_caller]
fn near(read: [f64; 3], expected: DVec3, within: f64) {
    assert!((DVec3::from(read) - expected).length() < within, "{read:?}, not {expected}");
}

/// A link that the world holds, and a weight of 1 kg below it on a joint at the link's origin.
fn hanging(kind: &str, force_torque: &str) -> String {
    let axis = if kind == "fixed" { "" } else { "<axis><xyz>0 1 0</xyz></axis>" };
    let inside = format!("<pose>0 0 0.5 0 0 0</pose>{axis}{}", sensor(force_torque));
    link("top", "0 0 0 0 0 0", 3.0, "")
        + &link("weight", "0 0 -0.5 0 0 0", 1.0, "")
        + &joint("held", "fixed", "world", "top", "")
        + &joint("hinge", kind, "top", "weight", &inside)
}

/// The child pulls its parent down: Gazebo's own demo reads −196 N for 20 kg.
#[test]
fn a_weight_of_1_kg_pulls_its_parent_down() {
    for kind in ["fixed", "revolute", "ball"] {
        let read = at_rest(&hanging(kind, ""));
        near(read.force, DVec3::NEG_Z * G, 1e-3);
        near(read.torque, DVec3::ZERO, 1e-3);
        let read = at_rest(&hanging(kind, "<measure_direction>parent_to_child</measure_direction>"));
        near(read.force, DVec3::Z * G, 1e-3);
    }
}

#[test]
fn a_lever_makes_a_torque_about_the_joint() {
    let inside = link("wall", "0 0 0 0 0 0", 3.0, "")
        + &link("arm", "0.5 0 0 0 0 0", 2.0, "")
        + &joint("held", "fixed", "world", "wall", "")
        + &joint("mount", "fixed", "wall", "arm", &format!("<pose>-0.5 0 0 0 0 0</pose>{}", sensor("")));
    let read = at_rest(&inside);
    near(read.force, DVec3::NEG_Z * (2.0 * G), 1e-3);
    // 0.5 m along x times 19.6 N down.
    near(read.torque, DVec3::Y * (0.5 * 2.0 * G), 1e-3);
}

/// What holds everything is a joint with the world.
#[test]
fn a_joint_with_the_world_carries_all_there_is() {
    let inside = link("wall", "0 0 0 0 0 0", 3.0, "")
        + &link("arm", "0.5 0 0 0 0 0", 2.0, "")
        + &joint("held", "fixed", "world", "wall", &sensor(""))
        + &joint("mount", "fixed", "wall", "arm", "");
    let read = at_rest(&inside);
    near(read.force, DVec3::NEG_Z * (5.0 * G), 1e-3);
    near(read.torque, DVec3::Y * (0.5 * 2.0 * G), 1e-3);
}

/// Links and joint are rolled differently, so that each frame has its own down.
#[test]
fn frame_and_direction_are_those_of_the_file() {
    let (parent, child, of_joint, of_sensor) = (-0.3, 0.5, 0.2, 0.4);
    let model_of = |kind: &str, force_torque: &str| {
        let axis = "<axis><xyz>0 1 0</xyz><limit><lower>0</lower><upper>0</upper></limit></axis>";
        let axis = if kind == "fixed" { "" } else { axis };
        let sensor =
            sensor(force_torque).replace("<topic>", &format!("<pose>0 0 0 {of_sensor} 0 0</pose><topic>"));
        let inside = format!("<pose>0 0 0 {of_joint} 0 0</pose>{axis}{sensor}");
        link("top", &format!("0.1 0 0 {parent} 0 0"), 3.0, "")
            + &link("weight", &format!("0 0 -0.5 {child} 0 0"), 1.0, "")
            + &joint("held", "fixed", "world", "top", "")
            + &joint("hinge", kind, "top", "weight", &inside)
    };
    let down = |roll: f64| DVec3::new(0.0, -roll.sin(), -roll.cos()) * G;
    for kind in ["fixed", "revolute", "prismatic"] {
        for (frame, roll, frame_id) in [
            ("child", child, "weight"),
            ("parent", parent, "m/hinge/ft"),
            ("sensor", child + of_joint + of_sensor, "m/hinge/ft"),
        ] {
            let inside = format!("<frame>{frame}</frame>");
            let mut bench = Bench::new(ground(), &model(&model_of(kind, &inside)), at(2.0));
            near(bench.after(400).force, down(roll), 2e-3);
            assert_eq!(bench.read().1, frame_id, "{kind} {frame}");
            let other = inside + "<measure_direction>parent_to_child</measure_direction>";
            near(at_rest(&model_of(kind, &other)).force, -down(roll), 2e-3);
        }
    }
}

#[test]
fn a_torque_is_about_the_place_of_the_sensor() {
    let of = |pose: &str| {
        let sensor = sensor("").replace("<topic>", &format!("<pose>{pose}</pose><topic>"));
        at_rest(
            &(link("wall", "0 0 0 0 0 0", 3.0, "")
                + &link("arm", "0.5 0 0 0 0 0", 2.0, "")
                + &joint("held", "fixed", "world", "wall", "")
                + &joint("mount", "fixed", "wall", "arm", &sensor)),
        )
    };
    // At the centre of mass there is none.
    near(of("0 0 0 0 0 0").torque, DVec3::ZERO, 1e-3);
    near(of("-0.2 0 0 0 0 0").torque, DVec3::Y * (0.2 * 2.0 * G), 1e-3);
    near(of("0 0.3 0 0 0 0").torque, DVec3::X * (0.3 * 2.0 * G), 1e-3);
}

/// A slide of 2 kg on which 1 kg is mounted, 0.2 m above its sensor. Its motor gives 6 N.
#[test]
fn a_driven_slide_passes_on_what_accelerates_its_load() {
    let inside = link("rail", "0 0 0 0 0 0", 3.0, "")
        + &link("slide", "0 0 0 0 0 0", 2.0, "")
        + &link("load", "0 0 0.3 0 0 0", 1.0, "")
        + &joint("held", "fixed", "world", "rail", "")
        + &joint(
            "drive",
            "prismatic",
            "rail",
            "slide",
            &format!("<axis><xyz>1 0 0</xyz></axis>{}", sensor("")),
        )
        + &joint("mount", "fixed", "slide", "load", &format!("<pose>0 0 -0.2 0 0 0</pose>{}", sensor("")));
    let (mut physics, index) = alone(&inside);
    assert_eq!(physics.wrench(index, 0), None, "no step has been made");
    physics.drive_joint(index, 0, 100.0, 6.0);
    (0..200).for_each(|_| physics.step());
    // What the parent does to the child: 6 N for 3 kg are 2 m/s².
    let slide = physics.wrench(index, 0).unwrap();
    near(slide.force.to_array(), DVec3::new(6.0, 0.0, 3.0 * G), 5e-3);
    let load = physics.wrench(index, 1).unwrap();
    near(load.force.to_array(), DVec3::new(2.0, 0.0, G), 5e-3);
    near(load.torque.to_array(), DVec3::new(0.0, 0.2 * 2.0, 0.0), 5e-3);
}

#[test]
fn a_pendulum_pulls_hardest_at_the_bottom() {
    let inside = link("top", "0 0 0 0 0 0", 3.0, "")
        + &link("weight", "1 0 0 0 0 0", 1.0, "")
        + &joint("held", "fixed", "world", "top", "")
        + &joint(
            "hinge",
            "revolute",
            "top",
            "weight",
            &format!("<pose>-1 0 0 0 0 0</pose><axis><xyz>0 1 0</xyz></axis>{}", sensor("")),
        );
    let (mut physics, index) = alone(&inside);
    let hardest = (0..1000)
        .map(|_| {
            physics.step();
            physics.wrench(index, 0).unwrap().force.x
        })
        .fold(0.0, f64::min);
    // Along the rod g + ω²·l, with half of I·ω² equal to m·g·l, and I = 1.01 kg·m².
    let expected = -(G + 2.0 * G / 1.01);
    assert!((hardest / expected - 1.0).abs() < 3e-3, "{hardest}, not {expected}");
}

/// Two halves of 1 kg turn about their middle in free space.
#[test]
fn what_holds_a_turning_body_together_is_measured() {
    let inside = link("left", "-0.5 0 0 0 0 0", 1.0, "")
        + &link("right", "0.5 0 0 0 0 0", 1.0, "")
        + &joint("between", "fixed", "left", "right", &sensor(""));
    let model = model(&inside);
    let mut world = World::empty();
    world.gravity = DVec3::ZERO;
    let mut physics = Physics::new(&world).unwrap();
    let index = physics.insert_model(&Placement::of_thing(&model, Pose::IDENTITY)).unwrap();
    physics.move_model(index, &Pose::IDENTITY, DVec3::ZERO, DVec3::Z * 2.0);
    (0..100).for_each(|_| physics.step());
    // m·ω²·r towards the middle.
    near(physics.wrench(index, 0).unwrap().force.to_array(), DVec3::NEG_X * 2.0, 0.01);
}

/// A body of 10 kg on a foot of 1 kg; its centre is 5 cm before the ankle.
fn standing(kind: &str) -> String {
    let axis = "<axis><xyz>0 1 0</xyz><limit><lower>0</lower><upper>0</upper></limit></axis>";
    let axis = if kind == "fixed" { "" } else { axis };
    let inertial = |pose: &str, mass_kg: f64| {
        format!(
            "<inertial><pose>{pose}</pose><mass>{mass_kg}</mass><inertia><ixx>0.2</ixx><iyy>0.2</iyy><izz>0.2</izz>
               </inertia></inertial>"
        )
    };
    format!(
        "<link name='body'><pose>0 0 0.1 0 0 0</pose>{}</link><link name='foot'><pose>0 0 0.1 0 0 0</pose>{}
           <collision name='c'><pose>0 0 -0.075 0 0 0</pose><geometry><box><size>0.4 0.3 0.05</size></box></geometry>
           </collision></link>{}",
        inertial("0.05 0 0.2 0 0 0", 10.0),
        inertial("0 0 -0.075 0 0 0", 1.0),
        joint("ankle", kind, "body", "foot", &format!("{axis}{}", sensor("")))
    )
}

#[test]
fn a_foot_on_the_ground_carries_the_bodys_weight() {
    for kind in ["fixed", "revolute"] {
        let mut bench = Bench::new(ground(), &model(&standing(kind)), Pose::IDENTITY);
        let read = bench.after(2000);
        near(read.force, DVec3::Z * (10.0 * G), 0.05);
        near(read.torque, DVec3::NEG_Y * (0.05 * 10.0 * G), 0.05);
    }
}

/// Gravity has a part along the ground, which friction holds.
#[test]
fn friction_of_a_foot_passes_through_its_ankle() {
    let mut world = ground();
    world.gravity = DVec3::new(1.5, -1.0, -G);
    let mut bench = Bench::new(world, &model(&standing("fixed")), Pose::IDENTITY);
    near(bench.after(2000).force, DVec3::new(-1.5, 1.0, G) * 10.0, 0.1);
}

/// Whatever the impact is like: from rest to rest, the joint has given what gravity has taken.
#[test]
fn an_impact_is_measured_as_a_whole() {
    for kind in ["fixed", "revolute"] {
        let model = model(&standing(kind));
        let mut physics = Physics::new(&ground()).unwrap();
        let index = physics.insert_model(&Placement::of_thing(&model, at(0.2))).unwrap();
        // Along the axes of the world, since the model rocks after the impact.
        let mut passed = DVec3::ZERO;
        for _ in 0..3000 {
            let before = physics.world_from_link(index, 1);
            physics.step();
            let during = before.interpolate(&physics.world_from_link(index, 1), 0.5);
            passed += during.transform_vector(physics.wrench(index, 0).unwrap().force) * physics.step_s();
        }
        assert_eq!(physics.time_ns(), 3_000_000_000);
        near((passed / (10.0 * G * 3.0)).to_array(), DVec3::NEG_Z, 1e-5);
    }
}

/// What the sensor reads of the foot is what accelerates the body, in each step.
#[test]
fn each_step_is_measured_exactly() {
    for kind in ["fixed", "revolute"] {
        let model = model(&standing(kind));
        let mut world = ground();
        world.gravity = DVec3::new(0.8, -0.5, -G);
        let mut physics = Physics::new(&world).unwrap();
        let index = physics.insert_model(&Placement::of_thing(&model, at(0.05))).unwrap();
        // The centre of the body.
        let velocity = |physics: &Physics| {
            let (linear, turn) = physics.link_velocity(index, 0);
            let arm = physics.world_from_link(index, 0).transform_vector(DVec3::new(0.05, 0.0, 0.2));
            linear + turn.cross(arm)
        };
        let mut before = velocity(&physics);
        let mut worst = 0.0_f64;
        for _ in 0..1000 {
            physics.step();
            let after = velocity(&physics);
            let expected = ((after - before) / physics.step_s() - physics.gravity()) * 10.0;
            before = after;
            let read = physics.wrench(index, 0).unwrap().force;
            let read = physics.world_from_link(index, 1).transform_vector(read);
            worst = worst.max((read + expected).length() / (1.0 + expected.length()));
        }
        assert!(worst < 0.01, "{kind}: {worst}");
    }
}

/// The air takes momentum from a link that loses velocity; what it takes does not pass through the joint.
#[test]
fn velocity_that_decays_is_no_force_of_the_joint() {
    let decay = "<velocity_decay><linear>0.001</linear><angular>0.001</angular></velocity_decay>";
    let inside = link("body", "0 0 0 0 0 0", 1.0, decay)
        + &link("load", "0 0 1 0 0 0", 1.0, decay)
        + &joint("mount", "fixed", "body", "load", &sensor(""));
    let (mut physics, index) = alone(&inside);
    (0..1000).for_each(|_| physics.step());
    let read = physics.wrench(index, 0).unwrap();
    near(read.force.to_array(), DVec3::ZERO, 0.01);
}

#[test]
fn noise_has_its_deviation_and_is_the_same_again() {
    let noise =
        |stddev: f64| format!("<noise type='gaussian'><mean>0</mean><stddev>{stddev}</stddev></noise>");
    let inside = format!(
        "<force><x>{}</x><z>{}</z></force><torque><y>{}</y></torque>",
        noise(0.5),
        noise(2.0),
        noise(0.1)
    );
    let readings = || -> Vec<[f64; 6]> {
        let mut bench = Bench::new(ground(), &model(&hanging("fixed", &inside)), at(2.0));
        let mut read = || {
            bench.simulation.run_for(Duration::from_millis(10));
            let wrench = bench.read().0;
            let ([x, y, z], [a, b, c]) = (wrench.force, wrench.torque);
            [x, y, z, a, b, c]
        };
        (0..1000).map(|_| read()).collect()
    };
    let found = readings();
    assert_eq!(found, readings());
    for (axis, (mean, stddev)) in
        [(0.0, 0.5), (0.0, 0.0), (-G, 2.0), (0.0, 0.0), (0.0, 0.1), (0.0, 0.0)].into_iter().enumerate()
    {
        let average = found.iter().map(|wrench| wrench[axis]).sum::<f64>() / 1000.0;
        let variance = found.iter().map(|wrench| (wrench[axis] - mean).powi(2)).sum::<f64>() / 1000.0;
        // Three standard errors from 1000 samples.
        assert!((average - mean).abs() < 0.1 * stddev + 1e-3, "{axis}: {average}, not {mean}");
        assert!((variance.sqrt() - stddev).abs() < 0.07 * stddev + 1e-3, "{axis}: {variance}");
    }
}

/// A plate of 1 kg on a base of 5 kg with two wheels, which is driven by them. The plate is the root.
fn driving(on_wheel: &str, on_plate: &str) -> String {
    let wheel = |side: &str, y: f64, inside: &str| {
        let shape =
            "<collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>";
        let inside = format!("<axis><xyz>0 1 0</xyz></axis>{inside}");
        link(side, &format!("0 {y} 0.1 0 0 0"), 1.0, shape)
            + &joint(&format!("{side}_joint"), "revolute", "base", side, &inside)
    };
    let slider =
        "<collision name='s'><pose>-0.2 0 -0.05 0 0 0</pose><geometry><sphere><radius>0.05</radius></sphere>
        </geometry><surface><friction><ode><mu>0</mu></ode></friction></surface></collision>
        <collision name='t'><pose>0.2 0 -0.05 0 0 0</pose><geometry><sphere><radius>0.05</radius></sphere>
        </geometry><surface><friction><ode><mu>0</mu></ode></friction></surface></collision>";
    link("plate", "0.1 0 0.3 0 0 0", 1.0, "")
        + &link("base", "0 0 0.1 0 0 0", 5.0, slider)
        + &joint("mount", "fixed", "plate", "base", on_plate)
        + &wheel("left", 0.2, on_wheel)
        + &wheel("right", -0.2, "")
        + "<plugin name='d' filename='libgazebo_ros_diff_drive.so'><leftJoint>left_joint</leftJoint>
           <rightJoint>right_joint</rightJoint><wheelSeparation>0.4</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
           <robotBaseFrame>base</robotBaseFrame></plugin>"
}

/// What drives a base acts on its wheels, and reaches the plate through the joint.
#[test]
fn a_base_that_drives_carries_its_plate_along() {
    let mut simulation = Simulation::builder(ground()).seed(4).build().unwrap();
    let id = simulation.spawn(&model(&driving("", &sensor(""))), SpawnOptions::default()).unwrap();
    let index = id.index();
    simulation.run_for(Duration::from_millis(500));
    let mut before = simulation.physics().link_velocity(index, 0).0;
    let (mut worst, mut fastest) = (0.0_f64, 0.0_f64);
    for step in 0..1000 {
        let turn = if step < 500 { 0.0 } else { 1.5 };
        simulation.command(id, Command::new(0.5, turn)).unwrap();
        simulation.step();
        let physics = simulation.physics();
        let after = physics.link_velocity(index, 0).0;
        let acceleration = (after - before) / physics.step_s();
        before = after;
        let read = physics.wrench(index, 0).unwrap().force;
        // The parent is the plate: what it does to the base is the opposite of what carries it.
        let read = physics.world_from_link(index, 1).transform_vector(read);
        let expected = physics.gravity() - acceleration;
        worst = worst.max((read - expected).length() / (1.0 + expected.length()));
        fastest = fastest.max(DVec3::new(acceleration.x, acceleration.y, 0.0).length());
    }
    assert!(fastest > 0.3, "it has not driven: {fastest}");
    assert!(worst < 0.02, "{worst}");
}
